//! The loss against the CPU's and against its f64 specification.

use trapeze_gpu::Gpu;
use trapeze_gpu::compute::{read, whole};

use super::super::kernels::TrainingKernels;
use super::super::layout::{TrainingStep, report};
use super::super::loss_stage::{LossBuffers, record_loss};
use super::super::reports::{RawReport, SLOTS};
use super::super::targets::GpuTarget;
use super::{device, run};
use crate::config::{Background, TrainingConfig};
use crate::loss::reference::{ReferenceLoss, reference_loss};
use crate::loss::{Channels, ImageLoss, LossValue, TargetImage};
use crate::random::{Purpose, Stream, uniform};

struct Case {
    render: Vec<[f32; 4]>,
    target: TargetImage,
    background: [f32; 3],
}

impl Case {
    /// Random pixels, alpha and weights.
    fn random(seed: u64, [width, height]: [u32; 2], channels: Channels, masked: bool) -> Self {
        let stream = Stream::new(seed, Purpose::Initialisation, 0);
        let pixels = width * height;
        let byte = |i: u32| (stream.words(i)[0] >> 24) as u8;
        let bytes = (0..pixels * channels as u32).map(byte).collect();
        let mut target = TargetImage::new(width, height, channels, bytes).unwrap();
        if masked {
            let mask = (0..pixels).map(|i| byte(5 * pixels + i).saturating_mul(2)).collect();
            target = target.with_mask(mask).unwrap();
        }
        let render = (0..pixels)
            .map(|i| {
                let [r, g, b, a] = stream.more_words(i, 1).map(uniform);
                [r * a, g * a, b * a, a]
            })
            .collect();
        Self { render, target, background: [0.25, 0.5, 0.875] }
    }

    /// One grey for the render, another for the target.
    fn constant([width, height]: [u32; 2], render: f32, target: u8) -> Self {
        let bytes = vec![target; (3 * width * height) as usize];
        Self {
            render: vec![[render, render, render, 1.0]; (width * height) as usize],
            target: TargetImage::new(width, height, Channels::Rgb, bytes).unwrap(),
            background: [0.0; 3],
        }
    }

    /// The render is the target to the last bit.
    fn equal(size: [u32; 2]) -> Self {
        let mut case = Self::random(3, size, Channels::Rgb, false);
        let unit = 1.0 / 255.0f32;
        let (pixels, _) = case.target.pixels().as_chunks::<3>();
        case.render = pixels
            .iter()
            .map(|&[r, g, b]| [f32::from(r) * unit, f32::from(g) * unit, f32::from(b) * unit, 1.0])
            .collect();
        case
    }

    fn on_gpu(&self, gpu: &Gpu, kernels: &TrainingKernels) -> (LossValue, Vec<[f32; 4]>) {
        let target = GpuTarget::upload(gpu, &self.target).unwrap();
        let mut config = TrainingConfig::fixed(10);
        config.background = Background::Fixed(self.background);
        let plan = config.step_plan(7, 1.0, 1.0);
        let numbers = TrainingStep::new(&plan, 1, target.size, target.is_weighted, 3);
        let step = gpu.uniform_of("step", bytemuck::bytes_of(&numbers));
        let render = gpu.storage_of("render", &self.render).unwrap();
        let mut buffers = LossBuffers::new(gpu).unwrap();
        buffers.prepare(gpu, target.size).unwrap();
        let bind_group = buffers.bind(gpu, kernels, &step, &render, &target);
        let counts = gpu.storage_of("counts", &[5u32, 6, 6, 0, 6, 0, 1, 0]).unwrap();
        let reports =
            gpu.storage("reports", 4 * u64::from(SLOTS) * u64::from(report::WORDS)).unwrap();
        let buffer_list =
            [whole(&step), whole(&buffers.tile_sums), whole(&counts), whole(&reports)];
        let report_group = kernels.report_interface.bind(gpu, &buffer_list);
        run(gpu, |pass| {
            record_loss(kernels, pass, &bind_group, target.size);
            pass.set_pipeline(&kernels.report);
            pass.set_bind_group(0, &report_group, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
        let words: Vec<u32> = read(gpu, &reports, u64::from(4 * report::WORDS)).unwrap();
        let found = RawReport::from_words(&words[3 * report::WORDS as usize..]);
        assert_eq!((found.step, found.visible, found.entries, found.halted), (7, 5, 6, false));
        let value = found.loss(self.target.len(), plan.ssim_weight);
        (value, read(gpu, &buffers.gradient, self.target.len() as u64).unwrap())
    }

    fn on_cpu(&self) -> LossValue {
        let mut gradient = vec![[0.0; 4]; self.render.len()];
        ImageLoss::default()
            .evaluate(&self.render, &self.target, self.background, 0.2, &mut gradient)
            .unwrap()
    }

    fn exact(&self) -> ReferenceLoss {
        let render: Vec<[f64; 4]> = self.render.iter().map(|p| p.map(f64::from)).collect();
        reference_loss(&render, &self.target, self.background.map(f64::from), 0.2).unwrap()
    }

    /// Whether rounding decides the sign of render − target in a channel of this pixel.
    fn sign_is_in_doubt(&self, i: usize) -> bool {
        let background = self.background.map(f64::from);
        let (y, _) = self.target.over(i, background);
        let p = self.render[i].map(f64::from);
        (0..3).any(|c| (p[c] + (1.0 - p[3]) * background[c] - y[c]).abs() < 1e-6)
    }

    /// The variances are differences of windowed squares below 4 (s = x + y ≤ 2, shifted by its
    /// middle), each a sum of 22 rounded products, and the divisor is C₂ = 9e-4 at least: 22·2⁻²⁴·4
    /// / 9e-4 = 6e-3 at the very worst, on constant images, where it cancels; half a percent of that
    /// on images with structure (D₂ ~ 0.05, errors of random sign).
    fn assert_agrees(&self, gpu: &Gpu, kernels: &TrainingKernels) {
        let (value, gradient) = self.on_gpu(gpu, kernels);
        let exact = self.exact();
        let size = [self.target.width(), self.target.height()];
        // A photograph's byte in single precision is off by up to 2⁻²⁴: all that is left of the
        // relative precision of a difference of one level in 255.
        let bound = |expected: f64| 1e-5 * expected + f64::from(f32::EPSILON) / 2.0;
        assert!((value.total - exact.total).abs() <= bound(exact.total), "{size:?} {value:?}");
        assert!((value.l1 - exact.l1).abs() <= bound(exact.l1), "{size:?} {value:?}");
        assert!((value.ssim - exact.ssim).abs() <= 2e-5, "{size:?} {value:?} {}", exact.ssim);
        let largest = exact.gradient.iter().flatten().fold(0.0f64, |m, g| m.max(g.abs()));
        for (i, (found, expected)) in gradient.iter().zip(&exact.gradient).enumerate() {
            for c in (0..4).filter(|_| !self.sign_is_in_doubt(i)) {
                let error = (f64::from(found[c]) - expected[c]).abs();
                assert!(error <= 1e-4 * largest, "{size:?} {i} {c}: {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn the_loss_and_its_gradient_are_those_of_the_cpu() {
    let Some(gpu) = device() else { return };
    let kernels = TrainingKernels::new(&gpu);
    let sizes = [[1, 1], [17, 3], [3, 17], [16, 16], [15, 40], [33, 5], [101, 47], [1, 60]];
    for (seed, size) in sizes.into_iter().enumerate() {
        for channels in [Channels::Rgb, Channels::Rgba] {
            let case = Case::random(seed as u64, size, channels, seed % 2 == 1);
            case.assert_agrees(&gpu, &kernels);
            let (found, expected) = (case.on_gpu(&gpu, &kernels).0.total, case.on_cpu().total);
            assert!((found - expected).abs() <= 1e-5 * expected, "{size:?}: {found} {expected}");
        }
    }
}

#[test]
fn constant_images_have_the_loss_and_the_gradient_of_the_specification() {
    let Some(gpu) = device() else { return };
    let kernels = TrainingKernels::new(&gpu);
    for (render, target) in [(0.0, 255), (1.0, 0), (0.5, 100), (1.0, 254)] {
        Case::constant([40, 23], render, target).assert_agrees(&gpu, &kernels);
    }
}

#[test]
fn a_render_equal_to_the_target_has_exactly_no_loss_and_no_gradient() {
    let Some(gpu) = device() else { return };
    let kernels = TrainingKernels::new(&gpu);
    let masked = {
        let case = Case::random(4, [30, 20], Channels::Rgba, false);
        let target = case.target.clone().with_mask(vec![0; 600]).unwrap();
        Case { target, ..case }
    };
    for case in [Case::equal([1, 1]), Case::equal([70, 33]), masked] {
        let (value, gradient) = case.on_gpu(&gpu, &kernels);
        assert_eq!(value, LossValue { l1: 0.0, ssim: 1.0, total: 0.0 });
        assert!(gradient.iter().flatten().all(|&g| g == 0.0));
    }
}

#[test]
fn bright_images_stay_finite_and_poisoned_ones_are_told() {
    let Some(gpu) = device() else { return };
    let kernels = TrainingKernels::new(&gpu);
    for brightness in [1e3, 65_504.0] {
        let (value, gradient) = Case::constant([30, 20], brightness, 77).on_gpu(&gpu, &kernels);
        assert!(value.total.is_finite() && value.ssim.abs() <= 1.001, "{value:?}");
        assert!(gradient.iter().flatten().all(|g| g.is_finite()));
    }
    for poison in [f32::NAN, f32::INFINITY] {
        let mut case = Case::random(6, [40, 40], Channels::Rgb, false);
        case.render[777][1] = poison;
        assert!(case.on_gpu(&gpu, &kernels).0.total.is_nan());
    }
}
