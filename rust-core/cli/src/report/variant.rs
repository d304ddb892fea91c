//! What the report compares.

use trapeze_cpu::RendererOptions;
use trapeze_scene::{FrameSettings, Scene, ShDegree};

use crate::measure::{level_name, simd_levels};

/// One way of rendering the same frames.
pub(crate) struct Variant {
    pub(crate) name: String,
    pub(crate) options: RendererOptions,
    pub(crate) settings: FrameSettings,
}

/// Shares of static splats that are compared, percent.
const STATIC_SHARES: [f32; 4] = [25.0, 50.0, 75.0, 90.0];

/// All variants that the scene has a use for: SIMD levels, static shares where it has motion
/// values, lower SH degrees where it has higher bands.
pub(crate) fn variants(scene: &Scene) -> Vec<Variant> {
    let plain = FrameSettings::default();
    let mut variants: Vec<Variant> = simd_levels()
        .into_iter()
        .map(|level| Variant {
            name: level_name(level).into(),
            options: RendererOptions { level, ..RendererOptions::default() },
            settings: plain.clone(),
        })
        .collect();
    if let (Some(motion), Some(_)) = (&scene.motion, &scene.deformation) {
        let recommended = motion.recommended_percentile.into_iter();
        let mut shares: Vec<f32> = STATIC_SHARES.into_iter().chain(recommended).collect();
        shares.sort_by(f32::total_cmp);
        shares.dedup();
        variants.extend(shares.into_iter().map(|share| {
            let mark =
                if motion.recommended_percentile == Some(share) { " (recommended)" } else { "" };
            let threshold = motion.threshold_at_percentile(share);
            Variant {
                name: format!("{share} % static{mark}"),
                options: RendererOptions::default(),
                settings: FrameSettings { static_threshold: Some(threshold), ..plain.clone() },
            }
        }));
    }
    let used = scene.splats.used_sh_degree();
    variants.extend(ShDegree::ALL.into_iter().filter(|&d| d < used).rev().map(|degree| Variant {
        name: format!("SH degree {}", degree as u32),
        options: RendererOptions::default(),
        settings: FrameSettings { max_sh_degree: degree, ..plain.clone() },
    }));
    variants
}
