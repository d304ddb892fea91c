//! The committed model of MobileCLIP's graph family against what PyTorch and Pillow gave for it, and
//! model folders that do not fit together.

use std::path::{Path, PathBuf};

use image::RgbImage;
use trapeze_query::models::{Embedder, ModelError, OnnxModel, find_runtime, normalised, prepare};
use trapeze_query::tokenizer::Tokenizer;

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/clip")
}

/// Without a runtime there is nothing to compare; `scripts/test` fetches one.
fn runtime_is_here(what: &str) -> bool {
    let found = find_runtime();
    if let Err(error) = &found {
        eprintln!("SKIPPED: {what} needs ONNX Runtime: {error}");
    }
    found.is_ok()
}

fn model() -> OnnxModel {
    OnnxModel::open(&fixture()).unwrap()
}

/// The numbers of an .npy file of version 1, `N` bytes each.
fn npy<const N: usize, T>(name: &str, from: fn([u8; N]) -> T) -> Vec<T> {
    let bytes = std::fs::read(fixture().join(name)).unwrap();
    assert_eq!(&bytes[..7], b"\x93NUMPY\x01");
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[header..].chunks_exact(N).map(|chunk| from(chunk.try_into().unwrap())).collect()
}

/// Largest difference between features and those that PyTorch gave, which are not normalised.
fn largest_difference(features: &[Vec<f32>], expected: &[f32]) -> f32 {
    let dimension = expected.len() / features.len();
    features
        .iter()
        .zip(expected.chunks_exact(dimension))
        .flat_map(|(feature, expected)| {
            let expected = normalised(expected).unwrap();
            feature.iter().zip(expected).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
        })
        .fold(0.0, f32::max)
}

#[test]
fn towers_give_what_pytorch_gives() {
    if !runtime_is_here("parity of the towers") {
        return;
    }
    let mut model = model();
    let images = model.embed_prepared(npy("images.npy", f32::from_le_bytes)).unwrap();
    let difference = largest_difference(&images, &npy("image-features.npy", f32::from_le_bytes));
    assert!(difference <= 1e-4, "image tower: {difference}");
    let texts = model.embed_tokens(npy("tokens.npy", i64::from_le_bytes)).unwrap();
    let difference = largest_difference(&texts, &npy("text-features.npy", f32::from_le_bytes));
    assert!(difference <= 1e-4, "text tower: {difference}");
}

#[test]
fn texts_become_the_tokens_of_the_fixture() {
    let texts =
        ["a red ball", "blue and yellow box", "", "The quick brown fox jumps over the lazy dog"];
    let tokenizer = Tokenizer::new();
    let tokens: Vec<i64> =
        texts.iter().flat_map(|text| tokenizer.encode(text)).map(i64::from).collect();
    assert_eq!(tokens, npy("tokens.npy", i64::from_le_bytes));
}

#[test]
fn pictures_are_resized_as_pillow_does_within_one_level() {
    let json = std::fs::read(fixture().join("model.json")).unwrap();
    let description = trapeze_query::models::parse_description(&fixture(), &json).unwrap();
    let open = |name: String| -> RgbImage {
        image::open(fixture().join("resize").join(name)).unwrap().to_rgb8()
    };
    for name in ["grow", "same", "shrink", "tall", "wide"] {
        let (picture, expected) = (open(format!("{name}.png")), open(format!("{name}-64.png")));
        let mut planes = vec![0.0; 3 * 64 * 64];
        prepare(&picture, &description.image, &mut planes);
        let mut largest = 0.0_f32;
        for (channel, plane) in planes.chunks_exact(64 * 64).enumerate() {
            for (value, pixel) in plane.iter().zip(expected.pixels()) {
                largest = largest.max((value - f32::from(pixel.0[channel]) / 255.0).abs());
            }
        }
        // One level of 8 bits, and the rounding of the division.
        assert!(largest <= 1.0 / 255.0 + 1e-6, "{name}: {largest}");
    }
}

#[test]
fn features_have_unit_length_and_do_not_depend_on_the_batch() {
    if !runtime_is_here("batches") {
        return;
    }
    let mut model = model();
    let pictures: Vec<RgbImage> = (1..12_u32)
        .map(|i| RgbImage::from_fn(20 + i, 30, |x, y| image::Rgb([(x * i) as u8, y as u8, 90])))
        .collect();
    let together = model.embed_images(&pictures.iter().collect::<Vec<_>>()).unwrap();
    for (picture, feature) in pictures.iter().zip(&together) {
        let length: f32 = feature.iter().map(|v| v * v).sum();
        assert!((length - 1.0).abs() < 1e-5);
        let alone = &model.embed_images(&[picture]).unwrap()[0];
        // The runtime's sums may be ordered otherwise for another batch.
        let largest = alone.iter().zip(feature).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(largest < 1e-5, "{largest}");
    }
}

#[test]
fn a_text_that_the_model_would_cut_is_refused() {
    if !runtime_is_here("long texts") {
        return;
    }
    let refused = model().embed_texts(&["dog ".repeat(2_500)]).unwrap_err().to_string();
    assert_eq!(refused, "text: expected at most 75 tokens with its template, found 2500");
}

/// A copy of the model folder that may be spoilt.
struct Copy(tempfile::TempDir);

impl Copy {
    fn of(folder: &Path) -> Self {
        let copy = tempfile::tempdir().unwrap();
        for name in ["image.onnx", "text.onnx", "model.json"] {
            std::fs::copy(folder.join(name), copy.path().join(name)).unwrap();
        }
        Self(copy)
    }

    fn edit_json(&self, from: &str, to: &str) {
        let path = self.0.path().join("model.json");
        let json = std::fs::read_to_string(&path).unwrap();
        assert!(json.contains(from), "{from}");
        std::fs::write(path, json.replacen(from, to, 1)).unwrap();
    }

    /// What is said about the folder, after the folder's name.
    fn refusal(&self) -> String {
        let error: ModelError = OnnxModel::open(self.0.path()).err().expect("refused");
        let message = error.to_string();
        assert!(!message.contains('\n'), "{message}");
        let folder = format!("{}/", self.0.path().display());
        message.strip_prefix(&folder).unwrap_or_else(|| panic!("{message}")).to_owned()
    }
}

#[test]
fn files_that_do_not_belong_together_are_refused_by_name() {
    if !runtime_is_here("model folders") {
        return;
    }
    let other_release = Copy::of(&fixture());
    other_release.edit_json("small random 3", "small random 4");
    let message = other_release.refusal();
    assert_eq!(
        message,
        "image.onnx: release: expected \"small random 4\" as in model.json, found small random 3"
    );

    let swapped = Copy::of(&fixture());
    std::fs::copy(fixture().join("image.onnx"), swapped.0.path().join("text.onnx")).unwrap();
    assert!(swapped.refusal().starts_with("text.onnx: input "), "{}", swapped.refusal());

    // A text tower of another training: the colour model's, with its names.
    let mixed = Copy::of(&fixture());
    let colours = fixture().join("../colour-model");
    std::fs::copy(colours.join("text.onnx"), mixed.0.path().join("text.onnx")).unwrap();
    mixed.edit_json("\"dimension\": 32", "\"dimension\": 4");
    let message = mixed.refusal();
    assert!(message.starts_with("image.onnx: output embedding: expected"), "{message}");

    let checksum = Copy::of(&fixture());
    checksum.edit_json("3167ceab", "00000000");
    let message = checksum.refusal();
    assert!(message.starts_with("image.onnx: checksum: expected 00000000"), "{message}");

    for (from, to, expected) in [
        ("\"size\": 64", "\"size\": 32", "image.onnx: input image: expected"),
        ("\"context_length\": 77", "\"context_length\": 50", "text.onnx: input "),
        ("\"output\": \"embedding\"", "\"output\": \"x\"", "image.onnx: output x: expected"),
    ] {
        let copy = Copy::of(&fixture());
        copy.edit_json(from, to);
        assert!(copy.refusal().starts_with(expected), "{}", copy.refusal());
    }
}

#[test]
fn files_that_are_missing_or_damaged_are_refused_by_name() {
    if !runtime_is_here("model folders") {
        return;
    }
    for name in ["image.onnx", "text.onnx", "model.json"] {
        let copy = Copy::of(&fixture());
        let path = copy.0.path().join(name);
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 1, bytes.len() / 2, bytes.len() - 2] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            assert!(copy.refusal().starts_with(name), "{name} cut to {length}: {}", copy.refusal());
        }
        std::fs::remove_file(&path).unwrap();
        assert!(copy.refusal().contains("No such file"), "{}", copy.refusal());
        std::fs::create_dir(&path).unwrap();
        assert!(copy.refusal().contains("file: expected a file"), "{}", copy.refusal());
    }
}
