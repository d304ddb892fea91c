//! `trapeze query`, with a model that knows colours and nothing else (tests/fixtures/colour-model).

mod support;

use std::path::{Path, PathBuf};

use support::{json, refusal, refusal_in, sample_scene, succeed, thinned_scene};
use trapeze_query::models::find_runtime;

fn colour_model() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/colour-model")
}

/// Without a runtime no model runs; `scripts/test` fetches one.
fn runtime_is_here(what: &str) -> bool {
    let found = find_runtime();
    if let Err(error) = &found {
        eprintln!("SKIPPED: {what} needs ONNX Runtime: {error}");
    }
    found.is_ok()
}

#[test]
fn a_colour_finds_the_ball_of_that_colour_and_features_are_kept() {
    if !runtime_is_here("search on the sample scene") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (features, sheet) = (folder.path().join("features.bin"), folder.path().join("sheet.png"));
    let query = |texts: &[&str]| {
        let mut line = arguments![
            "query",
            sample_scene(),
            "--models",
            colour_model(),
            "--features",
            &features,
            "--views",
            "2",
            "--crop-size",
            "96",
            "--threshold",
            "0",
            "--json",
            "--out",
            &sheet
        ]
        .to_vec();
        line.extend(texts.iter().map(Into::into));
        json(&line)
    };
    let first = query(&["red ball", "a green thing"]);
    assert_eq!(first["encoded_clusters"], 5);
    let best = |text: &str| {
        let results = first["results"].as_array().unwrap();
        results.iter().find(|found| found["text"] == text).map(|found| found["name"].clone())
    };
    assert_eq!(best("red ball").unwrap(), "red ball", "{first}");
    assert_eq!(best("a green thing").unwrap(), "green ball", "{first}");
    let picture = image::open(&sheet).unwrap();
    assert!(picture.width() >= 160 && picture.height() >= 2 * 160, "{picture:?}");

    // The second time nothing is rendered, and the answer is the same.
    let second = query(&["red ball", "a green thing"]);
    assert_eq!(second["encoded_clusters"], 0);
    assert_eq!(second["results"], first["results"]);

    // A damaged file is told and made anew.
    let mut bytes = std::fs::read(&features).unwrap();
    bytes[70] ^= 1;
    std::fs::write(&features, bytes).unwrap();
    let third = query(&["red ball", "a green thing"]);
    assert_eq!(third["encoded_clusters"], 5);
    assert_eq!(third["results"], first["results"]);
}

#[test]
fn what_cannot_be_searched_is_refused_before_the_long_work() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let message = refusal(&arguments!["query", &scene, " \t"]);
    assert_eq!(message, "text: expected a word or more, found none");
    let nowhere = folder.path().join("nowhere");
    let message = refusal(&arguments!["query", &scene, "red ball", "--models", &nowhere]);
    assert!(message.starts_with(&nowhere.join("model.json").display().to_string()), "{message}");
    let splats = scene.join("point_cloud.ply");
    let message = refusal(&arguments!["query", &splats, "red ball"]);
    assert!(
        message.starts_with("scene: expected clusters (clusters.bin), found none"),
        "{message}"
    );
    if runtime_is_here("a text of 10 000 characters") {
        let text = "long ".repeat(2_000);
        let message = refusal(&arguments!["query", &scene, text, "--models", colour_model()]);
        assert_eq!(message, "text: expected at most 75 tokens with its template, found 2000");
    }
}

#[test]
fn a_missing_runtime_is_told_with_what_to_do_and_stops_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let query = arguments!["query", &scene, "red ball", "--models", colour_model()];
    // No program on the path, no cache, no variable.
    let nothing = folder.path().as_os_str();
    let bare = [
        ("PATH", nothing),
        ("HOME", nothing),
        ("XDG_CACHE_HOME", nothing),
        ("ORT_DYLIB_PATH", "".as_ref()),
    ];
    let message = refusal_in(&bare, &query);
    assert!(
        message.starts_with("ONNX Runtime: expected its library at ORT_DYLIB_PATH"),
        "{message}"
    );
    assert!(message.contains("scripts/fetch-onnxruntime"), "{message}");

    let wrong = folder.path().join("none.so");
    let message = refusal_in(&[("ORT_DYLIB_PATH", wrong.as_os_str())], &query);
    assert!(message.starts_with(&wrong.display().to_string()), "{message}");
    std::fs::write(&wrong, "no library").unwrap();
    let message = refusal_in(&[("ORT_DYLIB_PATH", wrong.as_os_str())], &query);
    assert!(message.contains("ONNX Runtime: "), "{message}");

    succeed(&arguments!["info", &scene]);
}
