//! Whole runs under the trainer, on the bundled photographs at low resolution.

use fearless_simd::Level;
use trapeze_formats::dataset::{Dataset, DatasetOptions, load_dataset};
use trapeze_train::checkpoint::CheckpointFolder;
use trapeze_train::trainer::Event;
use trapeze_train::{CpuBackend, CpuBackendOptions, TrainError, Trainer, TrainerOptions};

use super::*;

fn dataset(downscale: u32) -> Dataset {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../assets/sample-dataset/transforms_static.json");
    let options = DatasetOptions { downscale: Some(downscale), ..DatasetOptions::default() };
    load_dataset(&path, &options).unwrap()
}

/// Growth from 300 splats on, over a fixed background.
fn config(steps: u32) -> TrainingConfig {
    let mut config = TrainingConfig::growing(steps, 500);
    config.initial.random_count = 300;
    config.sh_interval = 100;
    config.checkpoint_interval = 50;
    if let Some(densification) = &mut config.densification {
        densification.start = 50;
        densification.interval = 50;
    }
    config
}

fn options(folder: Option<&CheckpointFolder>) -> TrainerOptions {
    TrainerOptions {
        checkpoints: folder.cloned(),
        report_interval: 20,
        ..TrainerOptions::default()
    }
}

fn cpu(level: Level) -> CpuBackend {
    CpuBackend::new(CpuBackendOptions { level, ..CpuBackendOptions::default() })
}

/// Mean losses of every twenty steps, and the PSNR reported last.
fn finish<B: TrainingBackend>(trainer: &mut Trainer<B>) -> (Vec<f64>, f64) {
    let (mut losses, mut psnr) = (Vec::new(), f64::NAN);
    trainer
        .advance(u32::MAX, &mut |event| match event {
            Event::Report(report) => {
                losses.push(report.loss);
                psnr = report.psnr;
            }
            Event::RolledBack { reason, .. } => panic!("{reason}"),
            _ => {}
        })
        .unwrap();
    (losses, psnr)
}

fn curve<B: TrainingBackend>(dataset: &Dataset, backend: B, config: TrainingConfig) -> Vec<f64> {
    finish(&mut Trainer::start(dataset, config, backend, options(None)).unwrap()).0
}

#[test]
fn three_hundred_steps_follow_the_cpus_loss_curve() {
    let Some(gpu) = device() else { return };
    let dataset = dataset(5);
    let found = curve(&dataset, backend(&gpu), config(300));
    let expected = curve(&dataset, cpu(Level::new()), config(300));
    let rounded = curve(&dataset, cpu(Level::baseline()), config(300));
    assert_eq!((found.len(), expected.len()), (15, 15));
    // How far two runs come apart that differ by rounding alone, the CPU on two instruction sets,
    // is what can be asked: ten times that, for roundings that are a few times larger on a GPU and
    // for where draws that hang on one of them fall otherwise; and in any case half a percent, the
    // least by which views' losses are known in 20 steps.
    let apart = expected.iter().zip(&rounded).map(|(a, b)| (a - b).abs() / a).fold(0.0, f64::max);
    let band = (10.0 * apart).max(5e-3);
    eprintln!("CPU with itself {apart:.2e}, band {band:.2e}");
    for (i, (f, e)) in found.iter().zip(&expected).enumerate() {
        assert!((f - e).abs() <= band * e, "report {i}: {f} {e}, band {band:e}");
    }
    assert!(found[14] < 0.5 * found[0], "{found:?}");
}

#[test]
fn a_run_resumes_on_the_other_backend_with_the_same_step_and_state() {
    let Some(gpu) = device() else { return };
    let dataset = dataset(8);
    let config = config(150);
    let whole = curve(&dataset, cpu(Level::new()), config.clone());
    for gpu_first in [true, false] {
        let temporary = tempfile::tempdir().unwrap();
        let folder = CheckpointFolder::new(temporary.path());
        let options = || options(Some(&folder));
        let first = |steps: u32| {
            if gpu_first {
                let mut trainer =
                    Trainer::start(&dataset, config.clone(), backend(&gpu), options()).unwrap();
                trainer.advance(steps, &mut |_| ()).unwrap();
                trainer.save(&mut |_| ()).unwrap();
                (trainer.backend().state().unwrap(), trainer.progress().clone())
            } else {
                let mut trainer =
                    Trainer::start(&dataset, config.clone(), CpuBackend::default(), options())
                        .unwrap();
                trainer.advance(steps, &mut |_| ()).unwrap();
                trainer.save(&mut |_| ()).unwrap();
                (trainer.backend().state().unwrap(), trainer.progress().clone())
            }
        };
        // Between two good states, two changes of the set and one of the bands.
        let (state, progress) = first(113);
        let (losses, splats) = if gpu_first {
            let mut trainer =
                Trainer::resume(&dataset, config.clone(), CpuBackend::default(), options())
                    .unwrap();
            assert_eq!(trainer.backend().state().unwrap(), state);
            assert_eq!(*trainer.progress(), progress);
            assert_eq!(trainer.step(), 113);
            (finish(&mut trainer).0, trainer.splat_count())
        } else {
            let mut trainer =
                Trainer::resume(&dataset, config.clone(), backend(&gpu), options()).unwrap();
            assert_eq!(trainer.backend().state().unwrap(), state);
            assert_eq!(*trainer.progress(), progress);
            assert_eq!(trainer.step(), 113);
            (finish(&mut trainer).0, trainer.splat_count())
        };
        assert_eq!(splats, 300 * 105 / 100 * 105 / 100);
        let (last, expected) = (losses[losses.len() - 1], whole[whole.len() - 1]);
        // Same views, backgrounds and draws; see the loss curve's test.
        assert!((last - expected).abs() <= 2e-2 * expected, "{last} {expected}");
    }
}

#[test]
fn exploding_rates_recover_or_stop_with_the_last_good_state() {
    let Some(gpu) = device() else { return };
    let dataset = dataset(10);
    for factor in [1e3, 1e7] {
        let mut config = config(100);
        multiply_rates(&mut config, factor);
        let mut rollbacks = 0;
        let mut trainer = Trainer::start(&dataset, config, backend(&gpu), options(None)).unwrap();
        let result = trainer.advance(u32::MAX, &mut |event| {
            rollbacks += u32::from(matches!(event, Event::RolledBack { .. }));
        });
        match result {
            Ok(_) => assert!(is_finite(&trainer.scene().unwrap().splats), "{factor:e}"),
            Err(error) => assert!(matches!(error, TrainError::Diverged { .. }), "{error}"),
        }
        eprintln!("rates times {factor:e}: {rollbacks} roll-backs");
    }
}
