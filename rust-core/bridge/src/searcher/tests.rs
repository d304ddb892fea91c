//! Search as Swift would call it, with the model that comes with the app.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use trapeze_query::models::find_runtime;

use super::*;
use crate::device::{Device, open_device};
use crate::edits::Edits;
use crate::failure::Code;
use crate::ffi::{Backend, RendererParameters};
use crate::renderer::make_renderer;
use crate::scene::open_scene;

/// Phrases, and the ids of the clusters that they mean (cluster-names.json).
const PHRASES: [(&str, u32); 4] =
    [("red ball", 3), ("green ball", 4), ("blue and yellow box", 5), ("checkered floor", 1)];

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(name)
}

fn text(path: &Path) -> String {
    path.to_str().expect("a path in UTF-8").into()
}

fn sample_scene() -> Scene {
    open_scene(text(&asset("sample-scene")), &Work::new()).unwrap()
}

/// The scene with these clusters alone.
fn part(scene: &Scene, clusters: &[u32]) -> Scene {
    let edits = Edits::new();
    edits.keep_clusters(clusters);
    scene.edited(&edits, &Work::new()).unwrap()
}

/// The model of the app; `None`, loudly, without ONNX Runtime.
fn bundled_model() -> Option<SearchModel> {
    if let Err(error) = find_runtime() {
        eprintln!("SKIPPED: text search through the bridge needs ONNX Runtime: {error}");
        return None;
    }
    Some(open_search_model(text(&asset("search-model")), &Work::new()).unwrap())
}

fn cpu() -> Device {
    open_device(Backend::Cpu, &Work::new()).unwrap()
}

fn renderer_on(device: &Device, scene: &Scene) -> Renderer {
    let options = RendererParameters { half_precision: false, max_harmonics_degree: 0 };
    make_renderer(device, scene, options, &Work::new()).unwrap()
}

/// Ids of the clusters, the best first.
fn found(searcher: &Searcher, phrase: &str) -> Vec<u32> {
    let hits = searcher.search(phrase.into()).unwrap();
    let scores: Vec<f64> = (0..hits.count()).map(|i| hits.hit(i).score).collect();
    assert!(scores.is_sorted_by(|a, b| a >= b) && scores.iter().all(|s| (0.0..=1.0).contains(s)));
    (0..hits.count()).map(|i| hits.hit(i).cluster).collect()
}

/// Clusters that have to be looked at when what is kept was taken over.
fn outdated(searcher: &Searcher, cache: Option<&Path>) -> usize {
    searcher
        .with(|state| {
            state.kept.restore(&mut state.searcher, cache);
            Ok(state.searcher.outdated())
        })
        .unwrap()
}

#[test]
fn phrases_find_their_clusters_at_once_and_from_kept_features() {
    let Some(model) = bundled_model() else { return };
    assert_eq!((model.name().as_str(), model.threshold() as f32), ("trapeze-objects", 0.02));
    let scene = sample_scene();
    let renderer = renderer_on(&cpu(), &scene);
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("made/on/demand");
    let searcher = make_searcher(&model, &scene).unwrap();
    assert_eq!(outdated(&searcher, Some(&cache)), 5);
    searcher.encode(&renderer, text(&cache), &Work::new()).unwrap();
    assert_eq!(searcher.encoded_clusters(), [1, 2, 3, 4, 5]);
    for (phrase, cluster) in PHRASES {
        let found = found(&searcher, phrase);
        assert_eq!((found[0], found.len()), (cluster, 5), "{phrase}: every cluster once");
    }

    // The red ball's picture is red in its middle, and is there once.
    let picture = searcher.take_picture(3).unwrap();
    assert_eq!((picture.width(), picture.height()), (PICTURE_SIDE, PICTURE_SIDE));
    let middle = 4 * (PICTURE_SIDE * PICTURE_SIDE / 2 + PICTURE_SIDE / 2) as usize;
    let [red, green, blue, alpha] = [0, 1, 2, 3].map(|channel| picture.rgba()[middle + channel]);
    assert!(red > 100 && green < red / 2 && blue < red / 2 && alpha == 255, "{red} {green} {blue}");
    assert_eq!(searcher.take_picture(3).unwrap_err().kind(), Code::InvalidArgument);

    // Another process, which finds everything in the cache; and what is left after an edit, too.
    for scene in [sample_scene(), part(&sample_scene(), &[3, 4])] {
        let again = make_searcher(&model, &scene).unwrap();
        assert_eq!(outdated(&again, Some(&cache)), 0);
        again.encode(&renderer, text(&cache), &Work::new()).unwrap();
        assert_eq!(found(&again, "red ball")[0], 3);
        assert!(again.take_picture(3).is_ok());
    }

    // A scene that was encoded by the command line has its features beside it.
    let copy = folder.path().join("scene");
    std::fs::create_dir(&copy).unwrap();
    let files = std::fs::read_dir(asset("sample-scene")).unwrap().chain(cache.read_dir().unwrap());
    for file in files.map(|entry| entry.unwrap().path()) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let name = if name.ends_with(".features.bin") { "features.bin".into() } else { name };
        if file.is_file() {
            std::fs::copy(&file, copy.join(name)).unwrap();
        }
    }
    let copied = open_scene(text(&copy), &Work::new()).unwrap();
    assert_eq!(outdated(&make_searcher(&model, &copied).unwrap(), None), 0);
}

#[test]
fn a_cancelled_encoding_stops_soon_and_keeps_what_was_finished() {
    let Some(model) = bundled_model() else { return };
    let scene = part(&sample_scene(), &[1, 3]);
    let renderer = renderer_on(&cpu(), &scene);
    let folder = tempfile::tempdir().unwrap();
    let searcher = make_searcher(&model, &scene).unwrap();
    let work = Work::new();
    let mut news = Vec::new();
    let cancelled = std::thread::scope(|scope| {
        let encoding = scope.spawn(|| searcher.encode(&renderer, text(folder.path()), &work));
        while !encoding.is_finished() {
            let progress = work.progress();
            news.push(progress.fraction);
            // The floor, which rests, takes one turn of four; the ball moves and takes three.
            if matches!(progress.stage, Stage::Encoding) && progress.fraction > 0.0 {
                work.cancel();
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        let start = Instant::now();
        (encoding.join().unwrap(), start.elapsed())
    });
    let (result, waited) = cancelled;
    assert_eq!(result.unwrap_err().kind(), Code::Cancelled);
    // One frame of a crop, and at most the features of eight crops: tenths of a second.
    assert!(waited < Duration::from_secs(5), "{waited:?}");
    assert!(news.iter().any(|&fraction| fraction > 0.0), "{news:?}");
    assert_eq!(searcher.search("red ball".into()).unwrap_err().kind(), Code::InvalidArgument);

    let again = make_searcher(&model, &scene).unwrap();
    assert_eq!(outdated(&again, Some(folder.path())), 1);
    again.encode(&renderer, text(folder.path()), &Work::new()).unwrap();
    assert_eq!(found(&again, "red ball")[0], 3);
}

#[test]
fn a_cache_that_cannot_be_used_costs_no_search() {
    let Some(model) = bundled_model() else { return };
    let scene = part(&sample_scene(), &[3]);
    let renderer = renderer_on(&cpu(), &scene);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("not-a-folder");
    std::fs::write(&file, "x").unwrap();
    let searcher = make_searcher(&model, &scene).unwrap();
    searcher.encode(&renderer, text(&file), &Work::new()).unwrap();
    assert_eq!(found(&searcher, "red ball"), [3]);

    // A file that is cut short is made anew.
    searcher.encode(&renderer, text(folder.path()), &Work::new()).unwrap();
    assert_eq!(folder.path().read_dir().unwrap().count(), 1, "nothing is new, nothing is written");
    let save = |state: &mut State| {
        state.kept.save(&state.searcher, folder.path());
        Ok(())
    };
    searcher.with(save).unwrap();
    let again = || make_searcher(&model, &scene).unwrap();
    assert_eq!(outdated(&again(), Some(folder.path())), 0);
    for entry in folder.path().read_dir().unwrap() {
        std::fs::write(entry.unwrap().path(), "TZFT").unwrap();
    }
    assert_eq!(outdated(&again(), Some(folder.path())), 1);
}

#[test]
fn models_that_are_missing_or_broken_are_told_by_file() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |folder: &Path| open_search_model(text(folder), &Work::new()).unwrap_err();
    let missing = refused(folder.path());
    assert_eq!(missing.kind(), Code::ModelsMissing);
    assert!(missing.message().contains("model.json"), "{}", missing.message());

    let description = std::fs::read(asset("search-model/model.json")).unwrap();
    std::fs::write(folder.path().join("model.json"), &description).unwrap();
    let missing = refused(folder.path());
    assert_eq!(missing.kind(), Code::ModelsMissing);
    assert!(missing.message().contains("image.onnx"), "{}", missing.message());

    std::fs::write(folder.path().join("model.json"), &description[..40]).unwrap();
    let broken = refused(folder.path());
    assert_eq!(broken.kind(), Code::MalformedFile);
    assert!(broken.message().contains("model.json"), "{}", broken.message());

    let work = Work::new();
    work.cancel();
    let cancelled = open_search_model(text(&asset("search-model")), &work).unwrap_err();
    assert_eq!(cancelled.kind(), Code::Cancelled);
}

#[test]
fn nothing_to_look_for_and_nowhere_to_look_are_refused() {
    let Some(model) = bundled_model() else { return };
    let whole = sample_scene();
    let bare =
        Scene::new(trapeze_scene::Scene { clusters: None, ..whole.shared().as_ref().clone() });
    let refused = make_searcher(&model, &bare).unwrap_err();
    assert_eq!(refused.kind(), Code::InvalidArgument);
    assert!(refused.message().starts_with("scene: expected clusters"), "{}", refused.message());

    let searcher = make_searcher(&model, &part(&whole, &[4])).unwrap();
    let early = searcher.search("green ball".into()).unwrap_err();
    assert!(early.message().starts_with("features: "), "{}", early.message());
    for (phrase, start) in [(String::new(), "text: "), (" \t".into(), "text: ")] {
        let refused = searcher.search(phrase).unwrap_err();
        assert_eq!(refused.kind(), Code::InvalidArgument);
        assert!(refused.message().starts_with(start), "{}", refused.message());
    }
    let renderer = renderer_on(&cpu(), &whole);
    searcher.encode(&renderer, String::new(), &Work::new()).unwrap();
    let refused = searcher.search("ball ".repeat(2_000)).unwrap_err();
    assert_eq!(refused.kind(), Code::InvalidArgument);
    assert!(refused.message().contains("tokens"), "{}", refused.message());

    renderer.suspend().unwrap();
    let asleep = searcher.encode(&renderer, String::new(), &Work::new()).unwrap_err();
    assert_eq!(asleep.kind(), Code::DeviceFailed);
}

#[test]
fn crops_of_a_graphics_device_have_the_features_of_those_of_the_cpu() {
    let Some(model) = bundled_model() else { return };
    let gpu = match open_device(Backend::Gpu, &Work::new()) {
        Ok(gpu) => gpu,
        Err(error) => {
            eprintln!("SKIPPED: search on a graphics device: {}", error.message());
            return;
        }
    };
    let scene = part(&sample_scene(), &[3, 4]);
    let scores = [cpu(), gpu].map(|device| {
        let searcher = make_searcher(&model, &scene).unwrap();
        searcher.encode(&renderer_on(&device, &scene), String::new(), &Work::new()).unwrap();
        assert_eq!(found(&searcher, "red ball"), [3, 4]);
        searcher.search("red ball".into()).unwrap().hit(0).score
    });
    // Frames agree to 60 dB and better: crops differ by single levels of 8 bits at edges.
    assert!((scores[0] - scores[1]).abs() < 0.02, "{scores:?}");
}

#[test]
fn a_failure_of_the_crops_keeps_its_kind() {
    let own = Failure::new(Code::OutOfMemory, "device: 3 MB are missing");
    let wrapped = trapeze_query::SearchError::Render(Box::new(own.clone()));
    assert_eq!(Failure::from(wrapped), own);
    let foreign = trapeze_query::SearchError::Render("odd".into());
    assert_eq!(Failure::from(foreign).kind(), Code::InternalFault);
}
