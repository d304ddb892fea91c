//! Speed and error of ways to draw a scene: never one without the other.

use std::sync::Arc;
use std::time::Instant;

use trapeze_gpu::NetworkPrecision;
use trapeze_scene::{Camera, Frame, FrameSettings, ImageError, Scene, ShDegree};

use crate::device::Device;
use crate::failure::Failure;
use crate::ffi::{MeasurementFigures, Stage};
use crate::renderer::{Backend, Options};
use crate::work::Work;

/// A way to draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Variant {
    precision: NetworkPrecision,
    /// Share of the splats that rest, 0–100.
    static_percentile: Option<f32>,
}

/// What was measured, variant by variant.
#[derive(Debug)]
pub(crate) struct Measurements(Vec<Measurement>);

#[derive(Clone, Copy, Debug)]
struct Measurement {
    frame_milliseconds: f64,
    psnr: f64,
}

impl Measurements {
    pub(crate) fn measurement(&self, index: usize) -> MeasurementFigures {
        let nothing = Measurement { frame_milliseconds: f64::NAN, psnr: f64::NAN };
        let Measurement { frame_milliseconds, psnr } =
            self.0.get(index).copied().unwrap_or(nothing);
        MeasurementFigures { frame_milliseconds, psnr }
    }
}

pub(crate) fn variants(
    half_precision: &[u8],
    percentiles: &[f64],
) -> Result<Vec<Variant>, Failure> {
    if half_precision.len() != percentiles.len() {
        let expected = half_precision.len();
        return Err(Failure::argument("percentiles", expected, percentiles.len()));
    }
    let variant = |(&half, &percentile): (&u8, &f64)| match percentile {
        p if p.is_nan() || (0.0..=100.0).contains(&p) => Ok(Variant {
            precision: if half == 0 { NetworkPrecision::Single } else { NetworkPrecision::Half },
            static_percentile: (!p.is_nan()).then_some(p as f32),
        }),
        p => Err(Failure::argument("percentile", "0 to 100", p)),
    };
    half_precision.iter().zip(percentiles).map(variant).collect()
}

/// Frames that each variant draws at least, so that its median means something.
const LEAST_FRAMES: usize = 9;

/// Draws the same frames with every variant; the error is against single precision with every
/// splat moving.
pub(crate) fn measure(
    device: &Device,
    scene: &Arc<Scene>,
    max_sh_degree: ShDegree,
    camera: &Camera,
    times: &[f64],
    variants: &[Variant],
    work: &Work,
) -> Result<Measurements, Failure> {
    let exact = Variant { precision: NetworkPrecision::Single, static_percentile: None };
    let mut course =
        Course { scene, camera, times, work, max_sh_degree, done: 0, of: 1 + variants.len() };
    let (references, _) = course.run(device, exact)?;
    let mut results = Vec::with_capacity(variants.len());
    for &variant in variants {
        let (frames, milliseconds) = course.run(device, variant)?;
        let errors = frames.iter().zip(&references);
        let worst = errors
            .map(|(frame, exact)| ImageError::between(&frame.color, &exact.color))
            .reduce(ImageError::worst);
        let psnr = worst.map_or(f64::INFINITY, |error| error.psnr);
        results.push(Measurement { frame_milliseconds: milliseconds, psnr });
    }
    Ok(Measurements(results))
}

/// The frames that every variant draws.
struct Course<'a> {
    scene: &'a Arc<Scene>,
    camera: &'a Camera,
    times: &'a [f64],
    work: &'a Work,
    max_sh_degree: ShDegree,
    done: usize,
    of: usize,
}

impl Course<'_> {
    /// The frames of a variant, and the median of what they took in milliseconds.
    fn run(&mut self, device: &Device, variant: Variant) -> Result<(Vec<Frame>, f64), Failure> {
        let options = Options { precision: variant.precision, max_sh_degree: self.max_sh_degree };
        let mut backend = Backend::new(device, self.scene.clone(), options)?;
        let threshold = variant.static_percentile.and_then(|percentile| {
            Some(self.scene.motion.as_ref()?.threshold_at_percentile(percentile))
        });
        let at = |time: f64| FrameSettings {
            time: time as f32,
            static_threshold: threshold,
            max_sh_degree: self.max_sh_degree,
            ..FrameSettings::default()
        };
        let mut frames = Vec::with_capacity(self.times.len());
        for &time in self.times {
            self.step(frames.len() as f64 / self.times.len() as f64 / 2.0)?;
            frames.push(backend.render(self.camera, &at(time))?);
        }
        let mut milliseconds = Vec::new();
        let rounds = LEAST_FRAMES.max(self.times.len());
        for (i, &time) in self.times.iter().cycle().take(rounds).enumerate() {
            self.step(0.5 + i as f64 / rounds as f64 / 2.0)?;
            // No two frames in a row show the same moment, or the second would cost nothing.
            let settings = at(time + 1e-4 * (i + 1) as f64);
            let start = Instant::now();
            let cost = backend.draw_timed(self.camera, &settings)?;
            let seconds = cost.map_or_else(|| start.elapsed().as_secs_f64(), |cost| cost.frame);
            milliseconds.push(seconds * 1e3);
        }
        milliseconds.sort_unstable_by(f64::total_cmp);
        self.done += 1;
        let median = milliseconds.get(milliseconds.len() / 2).copied().unwrap_or(f64::NAN);
        Ok((frames, median))
    }

    fn step(&self, share: f64) -> Result<(), Failure> {
        let fraction = (self.done as f64 + share) / self.of as f64;
        self.work.step(Stage::Measuring, Some(fraction))
    }
}
