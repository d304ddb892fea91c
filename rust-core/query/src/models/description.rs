//! `model.json`: what the two towers take and give (docs/formats.md).

use std::path::Path;

use serde::Deserialize;

use super::ModelError;
use crate::tokenizer::CONTEXT_LENGTH;

/// The version of the description that this program reads.
const FORMAT: u32 = 1;
/// Bounds that no model of this kind comes near; a typing error does.
const MAX_DIMENSION: usize = 8192;
const MAX_SIZE: u32 = 1024;

/// A model: two towers of one training.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct ModelDescription {
    /// Version of the description.
    pub format: u32,
    /// Name for people.
    pub name: String,
    /// The training that both towers come from.
    pub release: String,
    /// Numbers in a feature.
    pub dimension: usize,
    /// Factor on a cosine in the softmax.
    pub logit_scale: f32,
    /// The image tower.
    pub image: ImageTower,
    /// The text tower.
    pub text: TextTower,
    /// How to ask it.
    #[serde(default)]
    pub search: SearchSettings,
}

/// What the image tower takes and gives.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct ImageTower {
    /// Name of the input tensor, f32 [n, 3, size, size].
    pub input: String,
    /// Name of the output tensor, f32 [n, dimension].
    pub output: String,
    /// CRC-32 of the ONNX file, eight hexadecimal digits.
    pub crc32: String,
    /// Side of the input in pixels.
    pub size: u32,
    /// How a picture becomes a square.
    pub resize: ResizeRule,
    /// Interpolation, antialiased.
    pub filter: Filter,
    /// Subtracted from r g b in 0–1.
    pub mean: [f32; 3],
    /// Divides what is left.
    pub std: [f32; 3],
}

/// How a picture becomes a square.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum ResizeRule {
    /// The shorter side to the size, and the centre.
    Shortest,
    /// The longer side to the size, and grey beside it.
    Longest,
    /// Both sides to the size.
    Squash,
}

/// Interpolation of the resize.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Filter {
    /// Triangle.
    Bilinear,
    /// Cubic with a = −0.5.
    Bicubic,
}

/// What the text tower takes and gives.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct TextTower {
    /// Name of the input tensor, i64 [n, context_length].
    pub input: String,
    /// Name of the output tensor, f32 [n, dimension].
    pub output: String,
    /// CRC-32 of the ONNX file, eight hexadecimal digits.
    pub crc32: String,
    /// Tokens of a text.
    pub context_length: usize,
}

/// How to ask a model: prompts and threshold.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(default)]
pub struct SearchSettings {
    /// Sentences with one `{}` that a phrase is put into; their features are averaged.
    pub templates: Vec<String>,
    /// Texts that a phrase has to beat.
    pub background: Vec<String>,
    /// The least score of a match, 0–1.
    pub threshold: f32,
}

impl Default for SearchSettings {
    fn default() -> Self {
        let owned = |texts: &[&str]| texts.iter().map(|&text| text.into()).collect();
        Self {
            templates: owned(&["a photo of a {}.", "a rendering of a {}.", "{}"]),
            background: owned(&[
                "a photo of something.",
                "a rendering of an object.",
                "a blurry picture.",
                "a grey background.",
            ]),
            threshold: 0.5,
        }
    }
}

/// Parses `model.json`; `path` is for the messages.
///
/// # Errors
/// [`ModelError::Value`] names the first member that is missing or cannot be right.
pub fn parse_description(path: &Path, json: &[u8]) -> Result<ModelDescription, ModelError> {
    let mut deserializer = serde_json::Deserializer::from_slice(json);
    let description: ModelDescription = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|error| {
            let field = error.path().to_string();
            let field = if field == "." { "description".into() } else { field };
            ModelError::value(path, field, "a search model's description", error.into_inner())
        })?;
    deserializer.end().map_err(|e| ModelError::value(path, "description", "one object", e))?;
    description.check(path)?;
    Ok(description)
}

impl ModelDescription {
    fn check(&self, path: &Path) -> Result<(), ModelError> {
        let refuse = |field: &str, expected: &str, found: String| {
            Err(ModelError::value(path, field, expected, found))
        };
        let positive = |v: f32| v.is_finite() && v > 0.0;
        if self.format != FORMAT {
            return refuse("format", "1", self.format.to_string());
        }
        if self.release.trim().is_empty() {
            return refuse("release", "a name", "nothing".into());
        }
        if !(1..=MAX_DIMENSION).contains(&self.dimension) {
            return refuse("dimension", "1 to 8192", self.dimension.to_string());
        }
        if !positive(self.logit_scale) {
            return refuse("logit_scale", "a positive number", self.logit_scale.to_string());
        }
        if !(1..=MAX_SIZE).contains(&self.image.size) {
            return refuse("image.size", "1 to 1024", self.image.size.to_string());
        }
        if !self.image.mean.iter().all(|v| v.is_finite()) {
            return refuse("image.mean", "finite numbers", format!("{:?}", self.image.mean));
        }
        if !self.image.std.iter().all(|&v| positive(v)) {
            return refuse("image.std", "positive numbers", format!("{:?}", self.image.std));
        }
        if !(3..=CONTEXT_LENGTH).contains(&self.text.context_length) {
            let found = self.text.context_length.to_string();
            return refuse("text.context_length", "3 to 77", found);
        }
        for (field, crc) in [("image.crc32", &self.image.crc32), ("text.crc32", &self.text.crc32)] {
            if crc.len() != 8 || u32::from_str_radix(crc, 16).is_err() {
                return refuse(field, "eight hexadecimal digits", crc.clone());
            }
        }
        self.check_search(path)
    }

    fn check_search(&self, path: &Path) -> Result<(), ModelError> {
        let SearchSettings { templates, background, threshold } = &self.search;
        if templates.is_empty() {
            return Err(ModelError::value(path, "search.templates", "at least one", "none"));
        }
        if let Some(other) = templates.iter().find(|t| t.matches("{}").count() != 1) {
            return Err(ModelError::value(path, "search.templates", "one {} in each", other));
        }
        if background.is_empty() {
            return Err(ModelError::value(path, "search.background", "at least one", "none"));
        }
        if !(0.0..=1.0).contains(threshold) {
            return Err(ModelError::value(path, "search.threshold", "0 to 1", threshold));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{"format": 1, "name": "n", "release": "r", "dimension": 4, "logit_scale": 10,
        "image": {"input": "image", "output": "embedding", "crc32": "00000000", "size": 8,
                  "resize": "shortest", "filter": "bilinear", "mean": [0, 0, 0], "std": [1, 1, 1]},
        "text": {"input": "tokens", "output": "embedding", "crc32": "0000ffff", "context_length": 77}}"#;

    fn refusal(from: &str, to: &str) -> String {
        assert!(GOOD.contains(from));
        let json = GOOD.replacen(from, to, 1);
        parse_description(Path::new("m/model.json"), json.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn search_settings_may_be_left_out() {
        let description = parse_description(Path::new("m"), GOOD.as_bytes()).unwrap();
        assert_eq!(description.search, SearchSettings::default());
        let json = GOOD.replacen("\"image\"", "\"search\": {\"threshold\": 0.7}, \"image\"", 1);
        let description = parse_description(Path::new("m"), json.as_bytes()).unwrap();
        assert_eq!(description.search.threshold, 0.7);
        assert_eq!(description.search.templates, SearchSettings::default().templates);
    }

    #[test]
    fn a_member_that_cannot_be_right_is_refused_by_name() {
        for (from, to, expected) in [
            ("\"format\": 1", "\"format\": 2", "format: expected 1, found 2"),
            ("\"dimension\": 4", "\"dimension\": 0", "dimension: expected 1 to 8192, found 0"),
            ("\"dimension\": 4", "\"dimension\": -1", "dimension: "),
            ("\"logit_scale\": 10", "\"logit_scale\": 0", "logit_scale: expected a positive"),
            ("\"size\": 8", "\"size\": 100000", "image.size: expected 1 to 1024"),
            ("[1, 1, 1]", "[1, 0, 1]", "image.std: expected positive"),
            ("[0, 0, 0]", "[0, 0]", "image.mean: "),
            ("shortest", "widest", "image.resize: "),
            ("00000000", "0x000000", "image.crc32: expected eight hexadecimal digits"),
            ("77}", "78}", "text.context_length: expected 3 to 77, found 78"),
            ("\"r\"", "\" \"", "release: expected a name"),
            (
                "77}}",
                "77}, \"search\": {\"templates\": [\"a\"]}}",
                "search.templates: expected one {}",
            ),
            (
                "77}}",
                "77}, \"search\": {\"background\": []}}",
                "search.background: expected at least",
            ),
            ("77}}", "77}, \"search\": {\"threshold\": 2}}", "search.threshold: expected 0 to 1"),
            ("77}}", "77}} x", "description: "),
        ] {
            let message = refusal(from, to);
            assert!(message.starts_with(&format!("m/model.json: {expected}")), "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }
}
