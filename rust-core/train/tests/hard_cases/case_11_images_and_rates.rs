//! Degenerate images, and rates that explode.

use trapeze_formats::dataset::{DatasetOptions, load_dataset};
use trapeze_train::trainer::Event;
use trapeze_train::{TrainError, Trainer, TrainerOptions};

use super::*;

#[test]
fn constant_and_one_pixel_wide_photographs_train() {
    for (width, height) in [(1, 1), (1, 40), (40, 1), (2, 3), (24, 18)] {
        let pixels = vec![128; (width * height * 3) as usize];
        let constant = TargetImage::new(width, height, Channels::Rgb, pixels).unwrap();
        for target in [constant, photograph(0, (width, height))] {
            let (mut backend, view) = loaded(splats(100), camera(width, height), target);
            let reports = take_steps(&mut backend, &view, &TrainingConfig::growing(10, 100));
            assert!(reports.iter().all(StepReport::is_sound), "{width} x {height}: {reports:?}");
            assert!(is_finite(&backend.state().unwrap().splats));
        }
    }
}

#[test]
fn a_view_without_a_visible_splat_changes_nothing() {
    let before = splats(100);
    let away = Camera::look_at(
        DVec3::new(0.0, 0.0, -4.0),
        DVec3::NEG_Z * 9.0,
        DVec3::NEG_Y,
        0.7,
        (20, 15),
    );
    let (mut backend, view) = loaded(before.clone(), away, photograph(0, (20, 15)));
    let reports = take_steps(&mut backend, &view, &TrainingConfig::fixed(5));
    assert!(reports.iter().all(|report| report.is_sound() && report.visible == 0));
    assert_eq!(backend.state().unwrap().splats, before);
}

#[test]
fn a_photograph_equal_to_the_render_is_a_place_of_rest() {
    // Nothing is visible over black, and the photograph is black: loss and gradient are zero.
    let mut before = splats(100);
    before.sh_dc.fill([-9.0; 3]);
    let black = TargetImage::new(20, 15, Channels::Rgb, vec![0; 900]).unwrap();
    let (mut backend, view) = loaded(before.clone(), camera(20, 15), black);
    let reports = take_steps(&mut backend, &view, &TrainingConfig::fixed(5));
    assert!(reports.iter().all(|report| report.is_sound() && report.visible > 0));
    // One f32 SSIM of 1 is off by a few ulp.
    assert!(reports.iter().all(|report| report.loss.total.abs() < 1e-6), "{reports:?}");
    assert_eq!(backend.state().unwrap().splats, before);
}

/// How a run went: the trainer at its end, roll-backs, and the mean losses that it reported.
struct Run {
    result: Result<Trainer<CpuBackend>, TrainError>,
    rollbacks: u32,
    losses: Vec<f64>,
}

/// Trains on the bundled photographs at an eighth of their size with all rates times `factor`.
fn run_with_rates(factor: f64) -> Run {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/sample-dataset/transforms_static.json");
    let options = DatasetOptions { downscale: Some(8), ..DatasetOptions::default() };
    let dataset = load_dataset(&path, &options).unwrap();
    let mut config = TrainingConfig::growing(200, 400);
    config.initial.random_count = 300;
    config.checkpoint_interval = 50;
    multiply_rates(&mut config, factor);
    let (mut rollbacks, mut losses) = (0, Vec::new());
    let options = TrainerOptions { report_interval: 20, ..TrainerOptions::default() };
    let mut trainer = Trainer::start(&dataset, config, CpuBackend::default(), options).unwrap();
    let result = trainer.advance(u32::MAX, &mut |event| match event {
        Event::RolledBack { reason, .. } => {
            eprintln!("  {reason}");
            rollbacks += 1;
        }
        Event::Report(report) => losses.push(report.loss),
        _ => {}
    });
    Run { result: result.map(|_| trainer), rollbacks, losses }
}

#[test]
fn exploding_rates_recover_or_stop_with_the_last_good_state() {
    for factor in [1.0, 1e2, 1e4, 1e7] {
        let Run { result, rollbacks, losses } = run_with_rates(factor);
        match result {
            Ok(mut trainer) => {
                let scene = trainer.scene().unwrap();
                eprintln!("rates times {factor:e}: {rollbacks} roll-backs, losses {losses:.3?}");
                assert!(is_finite(&scene.splats), "{factor:e}");
                assert_eq!(rollbacks > 0, trainer.progress().rate_factor < 1.0);
                assert!(factor > 1.0 || rollbacks == 0);
                assert!(losses[losses.len() - 1] < losses[0], "{factor:e}: {losses:?}");
            }
            Err(error) => {
                eprintln!("rates times {factor:e}: {error}");
                assert!(factor > 1.0 && matches!(error, TrainError::Diverged { .. }), "{error}");
            }
        }
    }
}
