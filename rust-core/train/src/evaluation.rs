//! How well a scene reproduces photographs.
//!
//! PSNR and SSIM of every view on RGB clamped to [0, 1], also after an 8-bit round trip, and their
//! means over the views ([`ViewMetrics`]). Who renders is the caller's choice: a closure.

use serde::{Deserialize, Serialize};
use trapeze_formats::dataset::{Dataset, Image, load_image};
use trapeze_formats::{ParseError, ReadError};
use trapeze_scene::Frame;

use crate::loss::TargetImage;
use crate::loss::metrics::ViewMetrics;
use crate::trainer::target_image;

/// What photographs with transparency are compared over, unless something else is asked for.
const BEHIND_ALPHA: [f32; 3] = [1.0; 3];

/// Figures of a set of views.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Mean over the views.
    #[serde(flatten)]
    pub mean: ViewMetrics,
    /// View by view.
    pub views: Vec<ViewEvaluation>,
}

/// Figures of one view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewEvaluation {
    /// The view's name in the dataset.
    pub name: String,
    /// The figures.
    #[serde(flatten)]
    pub metrics: ViewMetrics,
}

/// The colour over which a photograph is compared: `background`, else white for photographs with
/// transparency and black, which nothing of an opaque photograph shows, for the others.
#[must_use]
pub fn background_for(image: &Image, background: Option<[f32; 3]>) -> [f32; 3] {
    background.unwrap_or(if image.has_alpha() { BEHIND_ALPHA } else { [0.0; 3] })
}

/// Renders the views `views` of a dataset and compares them with their photographs, one after the
/// other, so that one photograph at a time is in memory. `None` without views.
///
/// `render` gets the index of a view in the dataset.
///
/// # Errors
/// The first error of `render`, or of a photograph that cannot be read.
pub fn evaluate<E: From<ReadError>>(
    dataset: &Dataset,
    views: &[usize],
    background: Option<[f32; 3]>,
    mut render: impl FnMut(usize) -> Result<Frame, E>,
) -> Result<Option<Evaluation>, E> {
    let mut figures = Vec::with_capacity(views.len());
    for &index in views {
        let view = &dataset.views[index];
        let image = load_image(view)?;
        let frame = render(index)?;
        let behind = background_for(&image, background).map(f64::from);
        let refused = |error| {
            ReadError::new(
                &view.image_path,
                ParseError::value("image", "one of the camera's size", error),
            )
        };
        let target = target_image(&image).map_err(refused)?;
        let metrics = ViewMetrics::of(&frame.color, &target, behind).map_err(refused)?;
        figures.push(ViewEvaluation { name: view.name.clone(), metrics });
    }
    let all: Vec<ViewMetrics> = figures.iter().map(|view| view.metrics).collect();
    Ok(ViewMetrics::mean(&all).map(|mean| Evaluation { mean, views: figures }))
}

/// PSNR alone, dB, as [`ViewMetrics`] has it: for reports during training, where SSIM would cost
/// as much as a step. NaN when the sizes differ or every pixel is masked.
#[must_use]
pub fn psnr_of(render: &[[f32; 4]], target: &TargetImage, background: [f32; 3]) -> f64 {
    if render.len() != target.len() {
        return f64::NAN;
    }
    let background = background.map(f64::from);
    let (mut squares, mut total) = (0.0, 0.0);
    for (i, pixel) in render.iter().enumerate() {
        let (color, weight) = target.over(i, background);
        let through = 1.0 - f64::from(pixel[3]);
        for c in 0..3 {
            let rendered = f64::from(pixel[c]) + through * background[c];
            squares += weight * (rendered.clamp(0.0, 1.0) - color[c]).powi(2);
        }
        total += 3.0 * weight;
    }
    -10.0 * (squares / total).log10()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loss::Channels;

    #[test]
    fn the_quick_psnr_is_that_of_the_metrics() {
        let bytes: Vec<u8> = (0..12 * 10 * 4).map(|i| (i * 37 % 256) as u8).collect();
        let mask: Vec<u8> = (0..120).map(|i| (i * 11 % 256) as u8).collect();
        let target =
            TargetImage::new(12, 10, Channels::Rgba, bytes).unwrap().with_mask(mask).unwrap();
        let render: Vec<[f32; 4]> =
            (0..120).map(|i| [i as f32 / 90.0, 0.3, -0.1, (i % 10) as f32 / 10.0]).collect();
        let quick = psnr_of(&render, &target, [0.2, 0.5, 1.0]);
        let full =
            ViewMetrics::of(&render, &target, [0.2f32, 0.5, 1.0].map(f64::from)).unwrap().psnr;
        // The same sums in another order.
        assert!((quick - full).abs() < 1e-9, "{quick} {full}");
        assert!(psnr_of(&render[1..], &target, [0.0; 3]).is_nan());
    }

    #[test]
    fn photographs_with_transparency_are_compared_over_white() {
        let image = |channels: u8| Image {
            width: 1,
            height: 1,
            channels,
            values: vec![0; channels.into()],
            weights: None,
        };
        assert_eq!(background_for(&image(4), None), [1.0; 3]);
        assert_eq!(background_for(&image(3), None), [0.0; 3]);
        assert_eq!(background_for(&image(4), Some([0.5; 3])), [0.5; 3]);
    }
}
