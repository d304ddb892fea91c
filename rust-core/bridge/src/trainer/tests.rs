//! Runs as Swift drives them, on either kind of device.

use super::*;
use crate::dataset::inspect_dataset;
use crate::device::open_device;
use crate::failure::Code;
use crate::ffi::Backend;

const STEPS: u32 = 24;

/// 50 × 50 pixels a view, every eighth held out.
fn dataset() -> Dataset {
    photographs("transforms_static.json")
}

fn photographs(file: &str) -> Dataset {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/sample-dataset");
    inspect_dataset(format!("{folder}/{file}"), 4, 8).unwrap()
}

fn device(backend: Backend) -> Result<Device, Failure> {
    open_device(backend, &Work::new())
}

fn trainer(device: &Device, backend: Backend, folder: &Path) -> Result<Trainer, Failure> {
    let parameters = TrainParameters {
        steps: STEPS,
        max_splats: 2_000,
        harmonics_degree: 0,
        memory_limit: 0,
        backend,
    };
    make_trainer(device, &dataset(), parameters, folder.to_str().unwrap().into(), &Work::new())
}

/// A view as the app's screen shows it.
fn preview(trainer: &Trainer) -> Image {
    preview_of(trainer, &dataset(), dataset().view_time(0))
}

/// The first view of a dataset at a time.
fn preview_of(trainer: &Trainer, dataset: &Dataset, time: f32) -> Image {
    trainer.preview(dataset.view_lens(0), &dataset.view_world_to_camera(0), time).unwrap()
}

/// Mean of the squared differences of 8-bit values.
fn squared_error(a: &Image, b: &Image) -> f64 {
    assert_eq!(a.rgba().len(), b.rgba().len());
    let pairs = a.rgba().iter().zip(b.rgba());
    let sum: f64 = pairs.map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
    sum / a.rgba().len() as f64
}

fn advance_to(trainer: &Trainer, step: u32) {
    while trainer.current_step() < step {
        trainer.advance(&Work::new()).unwrap();
    }
}

#[test]
fn a_run_that_was_paused_on_the_graphics_device_goes_on_there_and_on_the_cpu() {
    let gpu = match device(Backend::Gpu) {
        Ok(gpu) => gpu,
        Err(error) => {
            eprintln!("SKIPPED: training on a graphics device: {}", error.message());
            return;
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let first = trainer(&gpu, Backend::Gpu, folder.path()).unwrap();
    assert_eq!(first.device_name(), gpu.name());
    let start = preview(&first);
    first.advance(&Work::new()).unwrap();
    let reached = first.current_step();
    assert!((1..=STEPS).contains(&reached), "{reached}");
    let cancelled = Work::new();
    cancelled.cancel();
    assert_eq!(first.advance(&cancelled).unwrap_err().kind(), Code::Cancelled);
    assert_eq!(first.current_step(), reached, "nothing is done for who has cancelled");
    first.checkpoint().unwrap();
    let shown = preview(&first);
    drop(first);

    // The other kind of device shows the same state: frames agree to 60 dB, so levels differ by one.
    let second = trainer(&gpu, Backend::Cpu, folder.path()).unwrap();
    assert_eq!((second.device_name().as_str(), second.current_step()), ("CPU", reached));
    assert!(squared_error(&shown, &preview(&second)) < 1.0);
    drop(second);

    let third = trainer(&gpu, Backend::Gpu, folder.path()).unwrap();
    assert_eq!(third.current_step(), reached);
    advance_to(&third, STEPS);
    assert!(third.is_finished());
    assert!(squared_error(&start, &preview(&third)) > 1.0, "it has learned something");
    let test = third.finish(&Work::new()).unwrap();
    assert!(test.psnr > 5.0 && test.ssim > 0.0, "{} dB, {}", test.psnr, test.ssim);
    assert!(third.report().loss.is_finite() && third.report().step == STEPS);
    let splats = u64::from(third.report().splats);
    assert_eq!(third.trained_scene().unwrap().figures().splats, splats);
}

#[test]
fn what_it_trains_on_is_chosen_by_the_settings_and_the_device() {
    let folder = tempfile::tempdir().unwrap();
    let cpu = device(Backend::Cpu).unwrap();
    let refused = trainer(&cpu, Backend::Gpu, folder.path()).unwrap_err();
    assert_eq!(refused.kind(), Code::NoDevice);
    assert_eq!(trainer(&cpu, Backend::Automatic, folder.path()).unwrap().device_name(), "CPU");
    let Ok(gpu) = device(Backend::Gpu) else {
        eprintln!("SKIPPED: choice of a graphics device for training: there is none");
        return;
    };
    let is_software = gpu.gpu().unwrap().unwrap().is_software();
    let expected = if is_software { "CPU".into() } else { gpu.name() };
    assert_eq!(trainer(&gpu, Backend::Automatic, folder.path()).unwrap().device_name(), expected);
}

#[test]
fn a_run_on_the_cpu_is_paused_shown_and_finished() {
    let folder = tempfile::tempdir().unwrap();
    let cpu = device(Backend::Cpu).unwrap();
    let run = trainer(&cpu, Backend::Automatic, folder.path()).unwrap();
    advance_to(&run, STEPS);
    assert!(preview(&run).rgba().iter().any(|&value| value > 0));
    let mut reports = 0;
    loop {
        let event = run.next_event();
        if !event.is_event {
            break;
        }
        reports += u32::from(matches!(event.kind, TrainEventKind::Report));
    }
    assert!(reports > 0);
    assert!(run.finish(&Work::new()).unwrap().psnr > 5.0);
    assert!(folder.path().join("point_cloud.ply").exists());
    let again = trainer(&cpu, Backend::Automatic, folder.path()).unwrap_err();
    assert_eq!(again.kind(), Code::InvalidArgument);
}

#[test]
fn photographs_of_many_times_leave_a_scene_folder_that_moves() {
    let folder = tempfile::tempdir().unwrap();
    let cpu = device(Backend::Cpu).unwrap();
    let parameters = TrainParameters {
        steps: STEPS,
        max_splats: 300,
        harmonics_degree: 0,
        memory_limit: 0,
        backend: Backend::Cpu,
    };
    let path = folder.path().to_str().unwrap();
    let moving = photographs("transforms_train.json");
    let run = make_trainer(&cpu, &moving, parameters, path.into(), &Work::new()).unwrap();
    advance_to(&run, STEPS);
    let times: Vec<f32> = (0..moving.figures().views).map(|i| moving.view_time(i)).collect();
    let [first, .., last] = times[..] else { panic!("{times:?}") };
    assert!(first != last && moving.view_time(times.len()) == 0.0);
    let [early, late] = [first, last].map(|time| preview_of(&run, &moving, time));
    assert!(squared_error(&early, &late) > 0.0, "each moment looks as it is");
    assert!(run.finish(&Work::new()).unwrap().psnr > 5.0);
    for file in ["point_cloud.ply", "weights.bin", "mask.bin", "mask.json", "training.json"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
    let figures = run.trained_scene().unwrap().figures();
    assert!(figures.deformable && figures.splats > 0);
}
