//! Whether the kernels tell the truth on the device at hand: for users' devices, which no test has
//! seen.

mod scene;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::Serialize;
use trapeze_scene::{FrameSettings, Scene, psnr};

use crate::{
    DeviceReport, Gpu, GpuError, HarmonicsStorage, NetworkPrecision, Renderer, RendererOptions,
};

/// Least PSNR against the f64 reference of kernels that round and do nothing else, dB.
const PLAIN_PSNR: f64 = 60.0;
/// Least PSNR of a variant against the plain kernels, dB.
const VARIANT_PSNR: f64 = 45.0;
/// Time of the moving images.
const TIME: f32 = 0.37;
/// Motion value below which splats rest in the masked image.
const THRESHOLD: f32 = 0.5;

/// What a check compares with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    /// An image of the f64 reference, kept in this crate. Without it nothing can be drawn.
    Golden,
    /// The image of the plain kernels on the same device. Without it the variant is not used.
    PlainKernels,
}

/// What a check is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Checked {
    /// All stages but the network.
    Still,
    /// The network in single precision.
    Moving,
    /// The list of moving splats.
    Masked,
    /// SH in 16 bits.
    HalfHarmonics,
    /// SH in 8 bits.
    ByteHarmonics,
    /// The network in half precision.
    HalfNetwork,
}

/// One image compared with what it should be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What was drawn.
    pub checked: Checked,
    /// What it was compared with.
    pub against: Against,
    /// Kernel of the network, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub network: Option<&'static str>,
    /// dB; absent for equal images, and where nothing could be drawn.
    pub psnr: Option<f64>,
    /// What was asked for, dB.
    pub least_psnr: f64,
    /// Time of a frame: the GPU's own where it has a clock, else until the frame has been read back.
    pub milliseconds: f64,
    /// Whether it is good enough.
    pub passed: bool,
    /// Why nothing could be drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// All checks of a device.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SelfCheckReport {
    /// The device.
    pub device: DeviceReport,
    /// Whether the plain kernels can be relied on.
    pub usable: bool,
    /// Each kernel variant, the plain ones first.
    pub checks: Vec<Check>,
}

impl SelfCheckReport {
    fn new(device: DeviceReport, checks: Vec<Check>) -> Self {
        let golden = |check: &&Check| check.against == Against::Golden;
        let usable = checks.iter().filter(golden).all(|check| check.passed);
        Self { device, usable, checks }
    }

    /// Whether what was checked is good enough; `false` for what was not.
    #[must_use]
    pub fn passed(&self, checked: Checked) -> bool {
        self.checks.iter().any(|check| check.checked == checked && check.passed)
    }

    /// The options with every variant that has failed replaced by the next more precise one.
    #[must_use]
    pub fn allowed(&self, mut options: RendererOptions) -> RendererOptions {
        use HarmonicsStorage::{Byte, Half, Single};
        if options.harmonics == Byte && !self.passed(Checked::ByteHarmonics) {
            options.harmonics = Half;
        }
        if options.harmonics == Half && !self.passed(Checked::HalfHarmonics) {
            options.harmonics = Single;
        }
        if !self.passed(Checked::HalfNetwork) {
            options.precision = NetworkPrecision::Single;
        }
        options
    }
}

type Image = Vec<[f32; 4]>;

/// Draws small images with every variant of the kernels, and compares them: the plain ones with
/// images of the f64 reference, the others with the plain ones. Takes well under a second on a GPU,
/// most of it to compile.
#[must_use]
pub fn self_check(gpu: &Gpu) -> SelfCheckReport {
    let (still, moving) = (Arc::new(scene::still()), Arc::new(scene::moving()));
    let plain = RendererOptions::default();
    let at_time = FrameSettings { time: TIME, ..FrameSettings::default() };
    let masked = FrameSettings { static_threshold: Some(THRESHOLD), ..at_time.clone() };
    let mut checks = Vec::new();
    let mut images = Vec::new();
    for (checked, scene, settings) in [
        (Checked::Still, &still, &FrameSettings::default()),
        (Checked::Moving, &moving, &at_time),
        (Checked::Masked, &moving, &masked),
    ] {
        let drawn = draw(gpu, scene, plain, settings);
        checks.push(check(checked, Against::Golden, &drawn, golden(checked).as_deref()));
        images.push(drawn.ok().map(|drawn| drawn.image));
    }
    for (checked, scene, twin, options, settings) in [
        (
            Checked::HalfHarmonics,
            &still,
            &images[0],
            RendererOptions { harmonics: HarmonicsStorage::Half, ..plain },
            &FrameSettings::default(),
        ),
        (
            Checked::ByteHarmonics,
            &still,
            &images[0],
            RendererOptions { harmonics: HarmonicsStorage::Byte, ..plain },
            &FrameSettings::default(),
        ),
        (
            Checked::HalfNetwork,
            &moving,
            &images[1],
            RendererOptions { precision: NetworkPrecision::Half, ..plain },
            &at_time,
        ),
    ] {
        let drawn = draw(gpu, scene, options, settings);
        checks.push(check(checked, Against::PlainKernels, &drawn, twin.as_deref()));
    }
    SelfCheckReport::new(DeviceReport::of(gpu), checks)
}

/// A frame, the kernel of its network, and its time.
struct Drawn {
    image: Image,
    network: Option<&'static str>,
    time: Duration,
}

fn draw(
    gpu: &Gpu,
    scene: &Arc<Scene>,
    options: RendererOptions,
    settings: &FrameSettings,
) -> Result<Drawn, GpuError> {
    let camera = scene::camera();
    let mut renderer = Renderer::with_options(gpu, scene.clone(), options)?;
    // The first frame compiles kernels.
    let image = renderer.render(&camera, settings)?.color;
    renderer.forget_deformation();
    let start = Instant::now();
    let stages = renderer.draw_timed(&camera, settings)?;
    let time = stages.map_or_else(|| start.elapsed(), |stages| stages.total);
    Ok(Drawn { image, network: renderer.network_kernel(), time })
}

fn check(
    checked: Checked,
    against: Against,
    drawn: &Result<Drawn, GpuError>,
    expected: Option<&[[f32; 4]]>,
) -> Check {
    let least_psnr = match against {
        Against::Golden => PLAIN_PSNR,
        Against::PlainKernels => VARIANT_PSNR,
    };
    let quality = match (drawn, expected) {
        (Ok(drawn), Some(expected)) if drawn.image.len() == expected.len() => {
            psnr(&drawn.image, expected)
        }
        _ => f64::NEG_INFINITY,
    };
    Check {
        checked,
        against,
        network: drawn.as_ref().ok().and_then(|drawn| drawn.network),
        psnr: quality.is_finite().then_some(quality),
        least_psnr,
        milliseconds: drawn.as_ref().map_or(0.0, |drawn| drawn.time.as_secs_f64() * 1e3),
        passed: quality >= least_psnr,
        error: drawn.as_ref().err().map(ToString::to_string),
    }
}

/// The reference's image: little-endian floats, r g b a, as tests/goldens/README.md says.
fn golden(checked: Checked) -> Option<Image> {
    let bytes: &[u8] = match checked {
        Checked::Still => include_bytes!("../../../../tests/goldens/self-check/still.f32"),
        Checked::Moving => include_bytes!("../../../../tests/goldens/self-check/moving.f32"),
        Checked::Masked => include_bytes!("../../../../tests/goldens/self-check/masked.f32"),
        Checked::HalfHarmonics | Checked::ByteHarmonics | Checked::HalfNetwork => return None,
    };
    let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let pixel = |p: &[u8]| std::array::from_fn(|c| float(&p[4 * c..4 * c + 4]));
    Some(bytes.chunks_exact(16).map(pixel).collect())
}
