//! The trainer against a backend of known behaviour.

mod captures;
mod faults;
mod mosaic;
mod moving;
mod resume;
mod searches;

use captures::capture;
use mosaic::Mosaic;
use tempfile::TempDir;
use trapeze_formats::dataset::Dataset;

use super::{Event, Report, TrainError, Trainer, TrainerOptions};
use crate::checkpoint::CheckpointFolder;
use crate::config::{InitialSplats, TrainingConfig};

/// A capture, and a folder for checkpoints beside it.
struct Workplace {
    folder: TempDir,
    dataset: Dataset,
}

impl Workplace {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let dataset = capture(&folder.path().join("capture"), 18);
        Self { folder, dataset }
    }

    fn checkpoints(&self) -> CheckpointFolder {
        CheckpointFolder::new(self.folder.path().join("checkpoints"))
    }

    fn options(&self) -> TrainerOptions {
        TrainerOptions {
            checkpoints: Some(self.checkpoints()),
            report_interval: 20,
            ..TrainerOptions::default()
        }
    }

    fn start(&self, config: TrainingConfig, backend: Mosaic) -> Trainer<Mosaic> {
        Trainer::start(&self.dataset, config, backend, self.options()).unwrap()
    }

    fn resume(&self, config: &TrainingConfig, backend: Mosaic) -> Trainer<Mosaic> {
        Trainer::resume(&self.dataset, config.clone(), backend, self.options()).unwrap()
    }
}

/// 40 splats at random places, growing.
fn config(steps: u32) -> TrainingConfig {
    let mut config = TrainingConfig::growing(steps, 100);
    config.initial = InitialSplats { random_count: 40, ..config.initial };
    config.checkpoint_interval = 50;
    config.sh_degree = 1;
    config.sh_interval = 70;
    config.rates.sh_dc = 0.02;
    if let Some(densification) = &mut config.densification {
        densification.start = 30;
        densification.interval = 30;
    }
    config
}

fn finish(trainer: &mut Trainer<Mosaic>) -> Vec<Event> {
    let mut events = Vec::new();
    while !trainer.is_finished() {
        trainer.advance(7, &mut |event| events.push(event)).unwrap();
    }
    events
}

fn reports(events: &[Event]) -> Vec<Report> {
    let report = |event: &Event| match event {
        Event::Report(report) => Some(*report),
        _ => None,
    };
    events.iter().filter_map(report).collect()
}

#[test]
fn a_run_takes_its_steps_grows_and_reports_a_falling_loss() {
    let place = Workplace::new();
    let mut trainer = place.start(config(300), Mosaic::default());
    assert_eq!((trainer.view_count(), trainer.splat_count()), (15, 40));
    let events = finish(&mut trainer);
    let reports = reports(&events);
    assert!(reports.iter().map(|report| report.step).eq((20..=300).step_by(20)));
    let (first, last) = (reports[0], reports[reports.len() - 1]);
    assert!(last.loss < 0.7 * first.loss && last.psnr > first.psnr + 3.0, "{first:?} {last:?}");
    assert!(last.splats > first.splats && last.splats <= 100);
    assert_eq!(last.sh_degree, 1);
    assert!(reports.iter().all(|report| report.seconds_left() >= 0.0));
    assert_eq!(reports[14].seconds_left(), 0.0);
    let summary = trainer.summary();
    assert_eq!((summary.steps, summary.splats, summary.rollbacks), (300, last.splats, 0));
    let scene = trainer.scene().unwrap();
    assert_eq!(scene.len() as u32, last.splats);
    // Its bands never had a gradient.
    assert_eq!(scene.splats.sh_degree, trapeze_scene::ShDegree::Zero);
}

#[test]
fn splats_that_no_pixel_can_show_stay_out_of_the_scene_and_are_counted() {
    let place = Workplace::new();
    let mut trainer =
        place.start(TrainingConfig { densification: None, ..config(20) }, Mosaic::default());
    finish(&mut trainer);
    let logits = &mut trainer.backend().state.splats.opacity_logits;
    logits.iter_mut().skip(1).step_by(4).for_each(|logit| *logit = -5.6);
    logits[0] = -5.5;
    let trained = trainer.backend().state.splats.clone();
    let scene = trainer.scene().unwrap();
    // 1/255 is a logit of −5.537.
    let kept: Vec<u32> = (0..40).filter(|i| i % 4 != 1).collect();
    assert_eq!(scene.splats.positions, trained.gather(&kept).positions);
    let mut summary = trainer.summary();
    summary.count(&scene);
    assert_eq!((summary.splats, summary.left_out), (30, 10));
    trainer.backend().state.splats.opacity_logits.fill(-9.0);
    assert_eq!(trainer.scene().unwrap().len(), 40, "a scene of nothing helps nobody");
}

#[test]
fn held_out_photographs_are_never_decoded() {
    let place = Workplace::new();
    for index in place.dataset.test_views().collect::<Vec<_>>() {
        // Headers were read with the dataset; from here on the file would be refused.
        std::fs::write(&place.dataset.views[index].image_path, b"damaged").unwrap();
    }
    let mut trainer = place.start(config(100), Mosaic::default());
    finish(&mut trainer);
    assert_eq!(trainer.step(), 100);
}

#[test]
fn a_photograph_that_is_gone_ends_the_run_by_name_and_a_resumed_run_goes_on() {
    let place = Workplace::new();
    let lost = &place.dataset.views[place.dataset.training_views().nth(5).unwrap()].image_path;
    let bytes = std::fs::read(lost).unwrap();
    std::fs::remove_file(lost).unwrap();
    let mut trainer = place.start(config(100), Mosaic::default());
    let error = trainer.advance(100, &mut |_| ()).unwrap_err().to_string();
    assert!(error.contains(&lost.display().to_string()) && !error.contains('\n'), "{error}");
    std::fs::write(lost, bytes).unwrap();
    let mut trainer = place.resume(&config(100), Mosaic::default());
    finish(&mut trainer);
    assert_eq!(trainer.step(), 100);
}

#[test]
fn the_result_does_not_depend_on_how_many_photographs_are_kept_or_steps_taken_at_once() {
    let place = Workplace::new();
    let whole = {
        let mut trainer = place.start(config(120), Mosaic::default());
        trainer.advance(u32::MAX, &mut |_| ()).unwrap();
        trainer.scene().unwrap()
    };
    for (steps, keeps) in [(1, Some(1)), (13, Some(3))] {
        let backend = Mosaic { keeps, ..Mosaic::default() };
        let mut trainer = place.start(config(120), backend);
        while trainer.advance(steps, &mut |_| ()).unwrap() > 0 {}
        assert_eq!(trainer.scene().unwrap(), whole);
    }
}

#[test]
fn a_run_that_would_not_fit_is_refused_with_its_parts() {
    let place = Workplace::new();
    let options = TrainerOptions { memory_limit: Some(1 << 20), ..place.options() };
    let config = TrainingConfig::growing(100, 100_000);
    let result = Trainer::start(&place.dataset, config, Mosaic::default(), options);
    let Err(error @ TrainError::Memory { .. }) = result else { panic!("not refused") };
    let message = error.to_string();
    assert!(message.contains("photographs") && message.contains("1 MB"), "{message}");
    assert!(place.checkpoints().load_newest().unwrap().is_none());
}

#[test]
fn datasets_without_views_to_train_on_are_refused() {
    let mut place = Workplace::new();
    for view in &mut place.dataset.views {
        view.split = trapeze_formats::dataset::Split::Test;
    }
    let result = Trainer::start(&place.dataset, config(10), Mosaic::default(), place.options());
    let message = result.err().unwrap().to_string();
    assert!(message.starts_with("dataset: training views: expected at least one"), "{message}");
}
