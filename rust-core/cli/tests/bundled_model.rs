//! Text search on the sample scene with the bundled model.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use trapeze_cpu::Renderer;
use trapeze_formats::load_scene;
use trapeze_query::Searcher;
use trapeze_query::crops::{CropOptions, CropRenderer};
use trapeze_query::features::FeatureStore;
use trapeze_query::models::{OnnxModel, find_runtime};
use trapeze_query::ranking::{Answer, QueryOptions};
use trapeze_scene::{Camera, Frame, FrameSettings, Orbit, Scene, Selection};

/// Phrases, and the ids of the clusters that they mean (cluster-names.json).
const PHRASES: [(&str, u32); 4] =
    [("red ball", 3), ("green ball", 4), ("blue and yellow box", 5), ("checkered floor", 1)];

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(name)
}

fn sample_scene() -> Arc<Scene> {
    Arc::new(load_scene(&asset("sample-scene")).unwrap())
}

fn searcher(scene: &Arc<Scene>) -> Searcher {
    let model = OnnxModel::open(&asset("search-model")).unwrap();
    Searcher::new(Arc::clone(scene), Box::new(model), CropOptions::default()).unwrap()
}

fn ask(searcher: &mut Searcher) -> Answer {
    let phrases = PHRASES.map(|(phrase, _)| phrase);
    let options = QueryOptions { top_k: 5, threshold: Some(0.0) };
    searcher.query(&phrases, &options).unwrap()
}

fn assert_each_phrase_finds_its_cluster(answer: &Answer) {
    for ((phrase, cluster), found) in PHRASES.iter().zip(&answer.phrases) {
        assert_eq!(
            found.matches.first().map(|best| best.cluster),
            Some(*cluster),
            "{phrase}: {found:?}"
        );
    }
}

/// A renderer that a screen uses too.
struct SharedRenderer(Renderer);

impl SharedRenderer {
    /// A renderer for the scene.
    fn new(scene: Arc<Scene>) -> Self {
        Self(Renderer::new(scene))
    }

    /// Draws a frame as a screen would.
    fn draw(&mut self, camera: &Camera, settings: &FrameSettings) -> Frame {
        self.0.render(camera, settings).expect("a usable camera")
    }
}

impl CropRenderer for SharedRenderer {
    fn positions(&mut self, time: f32) -> Vec<[f32; 3]> {
        self.0.positions(time).to_vec()
    }

    fn render(
        &mut self,
        camera: &Camera,
        settings: &FrameSettings,
    ) -> Result<Frame, Box<dyn Error + Send + Sync>> {
        Ok(self.0.render(camera, settings)?)
    }
}

/// Features that were made while a screen showed the scene from `azimuth` with every cluster but one
/// hidden, written and read again.
fn stored_features(scene: &Arc<Scene>, azimuth: f64, time: f32) -> FeatureStore {
    let mut renderer = SharedRenderer::new(Arc::clone(scene));
    let orbit = Orbit { azimuth, elevation: 15.0, up: DVec3::Z };
    let camera = orbit.frame(&scene.framing_bounds().unwrap(), 0.7, (160, 120));
    let settings = FrameSettings {
        time,
        selection: Selection::Isolate([1].into_iter().collect()),
        ..FrameSettings::default()
    };
    renderer.draw(&camera, &settings);
    let mut first = searcher(scene);
    first.encode(&mut renderer, |_, _| ControlFlow::Continue(())).unwrap();
    let store = FeatureStore::parse(&first.store().to_bytes()).unwrap();
    assert_eq!(store, first.store());
    store
}

#[test]
fn literal_phrases_find_their_clusters_whatever_a_screen_shows() {
    if let Err(error) = find_runtime() {
        eprintln!("SKIPPED: search on the sample scene needs ONNX Runtime: {error}");
        return;
    }
    let scene = sample_scene();
    let mut stores = Vec::new();
    for (azimuth, time) in [(35.0, 0.0), (160.0, 0.4), (280.0, 0.9)] {
        let store = stored_features(&scene, azimuth, time);
        let mut again = searcher(&scene);
        assert_eq!(again.restore(store.clone()), 5);
        assert_each_phrase_finds_its_cluster(&ask(&mut again));
        stores.push(store);
    }
    // Nothing of the screen is in the features.
    assert!(stores.windows(2).all(|pair| pair[0] == pair[1]));
}
