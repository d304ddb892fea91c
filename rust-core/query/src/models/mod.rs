//! The models: an image tower and a text tower that put pictures and words into one space.
//!
//! Everything above this module speaks to an [`Embedder`]; the one that runs ONNX files is
//! [`OnnxModel`]. Which pictures and words a model wants is in its description
//! ([`ModelDescription`]), so that a new model needs files and no code.

mod description;
mod error;
mod onnx;
mod preprocess;
mod runtime;

use image::RgbImage;

pub use description::{
    Filter, ImageTower, ModelDescription, ResizeRule, SearchSettings, TextTower, parse_description,
};
pub use error::ModelError;
pub use onnx::OnnxModel;
pub use preprocess::prepare;
pub use runtime::{RuntimeSource, find_runtime, runtime_cache};

/// Turns pictures and texts into features: vectors of unit length in one space, in which what means
/// the same is near.
pub trait Embedder: Send {
    /// What the model is.
    fn description(&self) -> &ModelDescription;

    /// A number that differs between models whose image features cannot be compared.
    fn image_key(&self) -> u32;

    /// Features of pictures of any size, in their order, each of
    /// [`ModelDescription::dimension`] numbers and unit length.
    ///
    /// # Errors
    /// [`ModelError`] when the model cannot be run or gives numbers that are none.
    fn embed_images(&mut self, images: &[&RgbImage]) -> Result<Vec<Vec<f32>>, ModelError>;

    /// Features of texts, in their order, likewise.
    ///
    /// # Errors
    /// [`ModelError`] when a text is too long, or as above.
    fn embed_texts(&mut self, texts: &[String]) -> Result<Vec<Vec<f32>>, ModelError>;
}

/// The vector scaled to unit length; `None` when it has no direction or is not finite.
#[must_use]
pub fn normalised(vector: &[f32]) -> Option<Vec<f32>> {
    let length = vector.iter().map(|&v| f64::from(v) * f64::from(v)).sum::<f64>().sqrt();
    (length.is_finite() && length > 0.0)
        .then(|| vector.iter().map(|&v| (f64::from(v) / length) as f32).collect())
}

/// Scalar product; the cosine of two vectors of unit length.
#[must_use]
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum::<f64>() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_without_direction_has_no_unit_vector() {
        assert_eq!(normalised(&[3.0, 4.0]), Some(vec![0.6, 0.8]));
        // The squares overflow in single precision.
        assert_eq!(normalised(&[0.0, 1e30]), Some(vec![0.0, 1.0]));
        assert_eq!(normalised(&[0.0; 3]), None);
        assert_eq!(normalised(&[f32::NAN, 1.0]), None);
        assert_eq!(normalised(&[f32::INFINITY, 1.0]), None);
    }
}
