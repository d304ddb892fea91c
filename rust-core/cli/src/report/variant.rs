//! What the report compares.

use trapeze_cpu::RendererOptions as CpuOptions;
use trapeze_gpu::{HarmonicsStorage, NetworkPrecision, RendererOptions as GpuOptions};
use trapeze_scene::{FrameSettings, Scene, ShDegree};

use crate::measure::{level_name, simd_levels};

/// One way of rendering the same frames.
pub(crate) struct Variant {
    pub(crate) name: String,
    pub(crate) backend: VariantBackend,
    pub(crate) settings: FrameSettings,
}

/// What renders a variant.
#[derive(Clone, Copy)]
pub(crate) enum VariantBackend {
    Cpu(CpuOptions),
    Gpu(GpuOptions),
}

/// Shares of static splats that are compared, percent.
const STATIC_SHARES: [f32; 4] = [25.0, 50.0, 75.0, 90.0];
/// Shares of the splats that GPU tiers keep, percent.
const KEPT_SHARES: [u32; 2] = [50, 25];

/// All CPU variants that the scene has a use for: SIMD levels, static shares where it has motion
/// values, lower SH degrees where it has higher bands.
pub(crate) fn cpu_variants(scene: &Scene) -> Vec<Variant> {
    let plain = FrameSettings::default();
    let mut variants: Vec<Variant> = simd_levels()
        .into_iter()
        .map(|level| Variant {
            name: level_name(level).into(),
            backend: VariantBackend::Cpu(CpuOptions { level, ..CpuOptions::default() }),
            settings: plain.clone(),
        })
        .collect();
    variants.extend(static_shares(scene).into_iter().map(|(name, settings)| Variant {
        name,
        backend: VariantBackend::Cpu(CpuOptions::default()),
        settings,
    }));
    variants.extend(lower_degrees(scene).map(|degree| Variant {
        name: format!("SH degree {}", degree as u32),
        backend: VariantBackend::Cpu(CpuOptions::default()),
        settings: FrameSettings { max_sh_degree: degree, ..plain.clone() },
    }));
    variants
}

/// All GPU variants that the scene has a use for: precisions, static shares, and the tiers of
/// memory, each by itself.
pub(crate) fn gpu_variants(scene: &Scene) -> Vec<Variant> {
    let plain = GpuOptions::default();
    let variant = |name: String, options| Variant {
        name: format!("GPU {name}"),
        backend: VariantBackend::Gpu(options),
        settings: FrameSettings::default(),
    };
    let mut variants = vec![variant("f32".into(), plain)];
    if scene.deformation.is_some() {
        let precision = NetworkPrecision::Half;
        variants.push(variant("f16 network".into(), GpuOptions { precision, ..plain }));
    }
    variants.extend(static_shares(scene).into_iter().map(|(name, settings)| Variant {
        name: format!("GPU {name}"),
        backend: VariantBackend::Gpu(plain),
        settings,
    }));
    for (name, harmonics) in
        [("f16 SH", HarmonicsStorage::Half), ("8-bit SH", HarmonicsStorage::Byte)]
    {
        variants.push(variant(name.into(), GpuOptions { harmonics, ..plain }));
    }
    variants.extend(lower_degrees(scene).map(|max_sh_degree| {
        let harmonics = HarmonicsStorage::Byte;
        let options = GpuOptions { harmonics, max_sh_degree, ..plain };
        variant(format!("8-bit SH degree {}", max_sh_degree as u32), options)
    }));
    variants.extend(KEPT_SHARES.map(|share| {
        let most = scene.len() as u64 * u64::from(share) / 100;
        let options = GpuOptions { max_splats: Some(most as u32), ..plain };
        variant(format!("{share} % of the splats"), options)
    }));
    variants
}

/// Degrees below the scene's, highest first.
fn lower_degrees(scene: &Scene) -> impl Iterator<Item = ShDegree> + use<> {
    let used = scene.splats.used_sh_degree();
    ShDegree::ALL.into_iter().filter(move |&degree| degree < used).rev()
}

/// Names and settings of the static shares; none for scenes without network or motion values.
fn static_shares(scene: &Scene) -> Vec<(String, FrameSettings)> {
    let (Some(motion), Some(_)) = (&scene.motion, &scene.deformation) else { return Vec::new() };
    let recommended = motion.recommended_percentile.into_iter();
    let mut shares: Vec<f32> = STATIC_SHARES.into_iter().chain(recommended).collect();
    shares.sort_by(f32::total_cmp);
    shares.dedup();
    let named = |share: f32| {
        let mark = if motion.recommended_percentile == Some(share) { " (recommended)" } else { "" };
        let threshold = motion.threshold_at_percentile(share);
        let settings =
            FrameSettings { static_threshold: Some(threshold), ..FrameSettings::default() };
        (format!("{share} % static{mark}"), settings)
    };
    shares.into_iter().map(named).collect()
}
