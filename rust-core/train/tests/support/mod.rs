//! What the tests of whole backends train on.

use trapeze_scene::Splats;
use trapeze_train::ParameterGroup;
use trapeze_train::config::TrainingConfig;
use trapeze_train::loss::{Channels, TargetImage};

/// Splats in a cube around the origin, all different, of SH degree 0.
pub(crate) fn splats(n: usize) -> Splats {
    // Steps of the golden ratio and its relatives fill the unit cube evenly.
    let place = |i: usize, k: usize| {
        let step = [0.819_172_5, 0.671_043_6, 0.549_700_5, 0.754_877_7][k % 4];
        (((i + 1) * (k / 4 + 1)) as f64 * step).fract() as f32
    };
    let three = |first: usize, scale: f32, offset: f32| {
        (0..n).map(|i| [0, 1, 2].map(|k| offset + scale * place(i, first + k))).collect()
    };
    Splats {
        positions: three(0, 2.0, -1.0),
        log_scales: three(4, 1.0, -3.0),
        rotations: (0..n).map(|i| [0, 1, 2, 3].map(|k| place(i, 8 + k) - 0.4)).collect(),
        opacity_logits: (0..n).map(|i| 4.0 * place(i, 12) - 2.0).collect(),
        sh_dc: three(13, 3.0, -1.5),
        ..Splats::default()
    }
}

/// A photograph with a gradient and stripes; another one for each view.
pub(crate) fn photograph(view: u32, (width, height): (u32, u32)) -> TargetImage {
    let pixel = |i: u32| {
        let (x, y) = (i % width, i / width);
        [(x * 5) as u8, (y * 7) as u8, if (x + view).is_multiple_of(4) { 200 } else { 60 }]
    };
    let pixels = (0..width * height).flat_map(pixel).collect();
    TargetImage::new(width, height, Channels::Rgb, pixels).unwrap()
}

/// Multiplies every learning rate.
pub(crate) fn multiply_rates(config: &mut TrainingConfig, factor: f64) {
    let rates = &mut config.rates;
    for rate in [
        &mut rates.positions_start,
        &mut rates.positions_end,
        &mut rates.log_scales,
        &mut rates.rotations,
        &mut rates.opacity_logits,
        &mut rates.sh_dc,
        &mut rates.sh_rest,
    ] {
        *rate *= factor;
    }
}

pub(crate) fn is_finite(splats: &Splats) -> bool {
    ParameterGroup::ALL.iter().all(|group| group.of(splats).iter().all(|v| v.is_finite()))
}
