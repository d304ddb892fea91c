//! A search with a model that knows the mean colour, and a renderer that draws discs.

use std::error::Error;

use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT};

use super::*;
use crate::models::{ModelDescription, ModelError, parse_description};
use crate::test_scene::two_boxes;

/// Feature of a picture: its mean colour less grey; of a text: the colours that it names.
struct ColourModel(ModelDescription);

impl ColourModel {
    fn new() -> Self {
        let json = include_bytes!("../../../../tests/fixtures/colour-model/model.json");
        Self(parse_description(std::path::Path::new("colour"), json).unwrap())
    }
}

impl Embedder for ColourModel {
    fn description(&self) -> &ModelDescription {
        &self.0
    }

    fn image_key(&self) -> u32 {
        1
    }

    fn embed_images(&mut self, images: &[&RgbImage]) -> Result<Vec<Vec<f32>>, ModelError> {
        let mean = |image: &RgbImage| {
            let count = image.pixels().len() as f32;
            let mut mean: Vec<f32> = (0..3)
                .map(|c| image.pixels().map(|p| f32::from(p.0[c]) - 128.0).sum::<f32>() / count)
                .collect();
            mean.push(1.0);
            normalised(&mean).unwrap()
        };
        Ok(images.iter().copied().map(mean).collect())
    }

    fn embed_texts(&mut self, texts: &[String]) -> Result<Vec<Vec<f32>>, ModelError> {
        let feature = |text: &String| {
            let mut sum = [0.0, 0.0, 0.0, 0.1];
            for (word, color) in [("red", [1.0, -1.0, -1.0]), ("blue", [-1.0, -1.0, 1.0])] {
                if text.contains(word) {
                    (0..3).for_each(|c| sum[c] += color[c]);
                }
            }
            normalised(&sum).unwrap()
        };
        Ok(texts.iter().map(feature).collect())
    }
}

/// Draws each splat as a disc of its colour, the nearest in front.
struct Discs(Arc<Scene>);

impl CropRenderer for Discs {
    fn positions(&mut self, _: f32) -> Vec<[f32; 3]> {
        self.0.splats.positions.clone()
    }

    fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, Box<dyn Error + Send + Sync>> {
        let size = (camera.width * camera.height) as usize;
        let mut frame = Frame { width: camera.width, height: camera.height, ..Frame::default() };
        frame.color = vec![[0.0; 4]; size];
        frame.top_contributor = vec![NO_SPLAT; size];
        let mut depth = vec![f64::INFINITY; size];
        let clusters = self.0.clusters.as_ref().unwrap();
        for (i, &position) in self.0.splats.positions.iter().enumerate() {
            if !settings.selection.shows(clusters.labels[i]) {
                continue;
            }
            let p = camera.world_to_camera.transform_point3(glam::Vec3::from(position).as_dvec3());
            let (u, v) = (camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy);
            let radius = 0.1 * camera.fx / p.z;
            let range = |centre: f64, end: u32| {
                let clamp = |x: f64| x.clamp(0.0, f64::from(end)) as u32;
                clamp(centre - radius)..clamp(centre + radius)
            };
            for y in range(v, camera.height) {
                for x in range(u, camera.width) {
                    let at = (y * camera.width + x) as usize;
                    if p.z < depth[at] {
                        depth[at] = p.z;
                        let [r, g, b] = self.0.splats.sh_dc[i].map(|c| 0.5 + 0.282_094_8 * c);
                        frame.color[at] = [r, g, b, 1.0];
                        frame.top_contributor[at] = i as u32;
                    }
                }
            }
        }
        Ok(frame)
    }
}

fn searcher(scene: Scene) -> (Searcher, Discs) {
    let scene = Arc::new(scene);
    let options = CropOptions { size: 96, ..CropOptions::default() };
    let searcher =
        Searcher::new(Arc::clone(&scene), Box::new(ColourModel::new()), options).unwrap();
    (searcher, Discs(scene))
}

fn encode(searcher: &mut Searcher, discs: &mut Discs) -> Encoded {
    searcher.encode(discs, |_, _| ControlFlow::Continue(())).unwrap()
}

#[test]
fn a_phrase_finds_its_cluster_and_says_what_took_no_part() {
    let (mut searcher, mut discs) = searcher(two_boxes());
    assert_eq!(encode(&mut searcher, &mut discs), Encoded { clusters: 2, crops: 16 });
    let answer = searcher.query(&["red thing", "the blue one"], &QueryOptions::default()).unwrap();
    let best = |i: usize| answer.phrases[i].matches.first().map(|found| found.cluster);
    assert_eq!((best(0), best(1)), (Some(3), Some(8)));
    assert_eq!(answer.left_out.len(), 1);
    assert_eq!((answer.left_out[0].cluster, answer.left_out[0].reason), (9, "too small"));
}

#[test]
fn a_phrase_that_means_nothing_has_no_match_but_a_nearest() {
    let (mut searcher, mut discs) = searcher(two_boxes());
    encode(&mut searcher, &mut discs);
    let options = QueryOptions { threshold: Some(0.9), ..QueryOptions::default() };
    let answer = searcher.query(&["qwrtz"], &options).unwrap();
    assert!(answer.phrases[0].matches.is_empty());
    assert!(answer.phrases[0].nearest.is_some());
}

#[test]
fn stored_features_serve_until_a_cluster_changes() {
    let scene = two_boxes();
    let (mut first, mut discs) = searcher(scene.clone());
    encode(&mut first, &mut discs);
    let store = first.store();

    let (mut again, _) = searcher(scene.clone());
    assert_eq!(again.restore(store.clone()), 3);
    assert_eq!(again.outdated(), 0);
    assert_eq!(
        again.query(&["red"], &QueryOptions::default()).unwrap(),
        first.query(&["red"], &QueryOptions::default()).unwrap()
    );

    let mut changed = scene.clone();
    changed.splats.sh_dc[0][1] += 0.1;
    let (mut changed, mut discs) = searcher(changed);
    assert_eq!(changed.restore(store.clone()), 2);
    assert_eq!(encode(&mut changed, &mut discs).clusters, 1);

    let (mut other_model, _) = searcher(scene);
    assert_eq!(other_model.restore(FeatureStore { image_key: 2, ..store.clone() }), 0);
    assert_eq!(other_model.restore(FeatureStore { crop_key: 2, ..store }), 0);
}

#[test]
fn breaking_off_keeps_what_was_finished() {
    let (mut searcher, mut discs) = searcher(two_boxes());
    let result = searcher.encode(&mut discs, |done, all| {
        assert_eq!(all, 2);
        if done == 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(result, Err(SearchError::Cancelled)));
    assert_eq!(searcher.outdated(), 1);
    let refused = searcher.query(&["red"], &QueryOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("1 clusters without"), "{refused}");
}

#[test]
fn what_others_hide_from_every_side_is_never_visible() {
    let mut scene = two_boxes();
    // The blue box shrinks to half its size and moves into the red one.
    let clusters = scene.clusters.as_ref().unwrap();
    for i in 0..scene.len() {
        if clusters.labels[i] == 1 {
            let [x, y, z] = scene.splats.positions[i];
            scene.splats.positions[i] = [(x - 1.0) / 2.0 - 1.0, y / 2.0, z / 2.0];
        }
    }
    let (mut searcher, mut discs) = searcher(scene);
    encode(&mut searcher, &mut discs);
    let answer = searcher.query(&["blue"], &QueryOptions::default()).unwrap();
    let reasons: Vec<_> = answer.left_out.iter().map(|out| (out.cluster, out.reason)).collect();
    assert_eq!(reasons, [(8, "never visible"), (9, "too small")]);
}

#[test]
fn nothing_to_look_for_and_nowhere_to_look_are_refused() {
    let (mut searcher, mut discs) = searcher(two_boxes());
    encode(&mut searcher, &mut discs);
    for phrases in [&[][..], &[" \t"], &["red", ""]] {
        let refused = searcher.query(phrases, &QueryOptions::default());
        assert!(matches!(refused, Err(SearchError::EmptyText)));
    }
    let scene = Arc::new(Scene { clusters: None, ..two_boxes() });
    let refused = Searcher::new(scene, Box::new(ColourModel::new()), CropOptions::default());
    assert!(matches!(refused, Err(SearchError::NoClusters)));
}
