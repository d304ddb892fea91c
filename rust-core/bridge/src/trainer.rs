//! A training run, driven a few steps at a time.

mod finish;
mod run;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use glam::DVec3;
use trapeze_formats::dataset;
use trapeze_scene::{Rgba8, ShDegree};
use trapeze_train::checkpoint::CheckpointFolder;
use trapeze_train::config::{Background, TrainingConfig};
use trapeze_train::trainer::{Event, Report};
use trapeze_train::{
    TrainerOptions, background_for_training, deformation_for_training, prepare_for_motion,
    search_for_training,
};

use crate::dataset::Dataset;
use crate::device::Device;
use crate::failure::{Contained, Failure, guarded, guarded_or, poisoned};
use crate::ffi::{
    Lens, Stage, TestFigures, TrainEventFigures, TrainEventKind, TrainFigures, TrainParameters,
};
use crate::frame::camera;
use crate::image::Image;
use crate::scene::Scene;
use crate::work::Work;
use run::TrainingRun;

/// A run, and what it has told.
///
/// What it tells can be asked for while another thread takes steps; everything else waits for the
/// steps that are being taken.
pub(crate) struct Trainer {
    dataset: Arc<dataset::Dataset>,
    folder: PathBuf,
    device: Device,
    run: Mutex<Contained<Box<dyn TrainingRun>>>,
    news: Mutex<News>,
}

/// What a run has told, and nobody has asked for yet.
struct News {
    step: u32,
    is_finished: bool,
    report: TrainFigures,
    events: VecDeque<Event>,
    rollback_reason: String,
}

/// Events that are kept for a reader that does not come: the oldest reports go first.
const MOST_EVENTS: usize = 1000;
/// How long steps are taken before news are looked at.
const TURN: Duration = Duration::from_millis(100);

/// Prepares a run, or goes on with the one whose checkpoints are in `folder`: on `device`, unless the
/// parameters or what it is say otherwise.
pub(crate) fn make_trainer(
    device: &Device,
    dataset: &Dataset,
    parameters: TrainParameters,
    folder: String,
    work: &Work,
) -> Result<Trainer, Failure> {
    guarded(|| {
        work.step(Stage::Preparing, None)?;
        let folder = PathBuf::from(folder);
        finish::refuse_finished(&folder)?;
        let memory = match parameters.memory_limit {
            0 => available_memory(),
            limit => Some(limit),
        };
        let config = configuration(dataset, &parameters, memory)?;
        work.step(Stage::Compiling, None)?;
        let device = run::training_device(device, parameters.backend)?;
        let options = TrainerOptions {
            checkpoints: Some(checkpoints(&folder)),
            memory_limit: memory,
            report_interval: run::report_interval(&device, config.steps)?,
            ..TrainerOptions::default()
        };
        let run = run::resume(&device, dataset.shared(), config, options)?;
        let news = News {
            step: run.step(),
            is_finished: run.is_finished(),
            report: nothing_yet(run.as_ref()),
            events: VecDeque::new(),
            rollback_reason: String::new(),
        };
        Ok(Trainer {
            dataset: dataset.shared().clone(),
            folder,
            device,
            run: Mutex::new(Contained::new(run)),
            news: Mutex::new(news),
        })
    })
}

fn checkpoints(folder: &Path) -> CheckpointFolder {
    CheckpointFolder::new(folder.join("checkpoints"))
}

fn configuration(
    dataset: &Dataset,
    parameters: &TrainParameters,
    memory: Option<u64>,
) -> Result<TrainingConfig, Failure> {
    let steps = parameters.steps;
    let degree = ShDegree::try_from(parameters.harmonics_degree)?;
    let photographs = dataset.shared();
    let config = match parameters.max_splats {
        0 => search_for_training(photographs, steps, memory.unwrap_or(u64::MAX), degree),
        splats => TrainingConfig::growing(steps, splats),
    };
    // Geographic captures are trained as if nothing moved: the network sees coordinates near 0 only.
    let deformation = match photographs.origin {
        DVec3::ZERO => deformation_for_training(photographs, steps)?,
        _ => None,
    };
    let mut config = TrainingConfig {
        sh_degree: parameters.harmonics_degree,
        holdout: dataset.holdout(),
        background: background_for_training(photographs)?,
        deformation,
        ..config
    };
    if config.deformation.is_some() {
        prepare_for_motion(&mut config);
    }
    Ok(config)
}

/// Bytes that may be taken without pushing others out; `None` where the system does not say.
#[cfg(not(target_os = "ios"))]
fn available_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    Some(system.available_memory().min(container))
}

/// The app is told by the system, and tells us.
#[cfg(target_os = "ios")]
fn available_memory() -> Option<u64> {
    None
}

fn nothing_yet(run: &dyn TrainingRun) -> TrainFigures {
    TrainFigures {
        step: run.step(),
        steps: run.config().steps,
        seconds: run.progress().seconds,
        steps_per_second: 0.0,
        loss: f64::NAN,
        psnr: f64::NAN,
        splats: run.splat_count(),
    }
}

fn figures(report: &Report) -> TrainFigures {
    TrainFigures {
        step: report.step,
        steps: report.steps,
        seconds: report.seconds,
        steps_per_second: report.steps_per_second,
        loss: report.loss,
        psnr: report.psnr,
        splats: report.splats,
    }
}

fn copy(f: &TrainFigures) -> TrainFigures {
    TrainFigures { ..*f }
}

impl std::fmt::Debug for Trainer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Trainer").field("folder", &self.folder).finish_non_exhaustive()
    }
}

impl Trainer {
    /// What it trains on.
    pub(crate) fn device_name(&self) -> String {
        self.device.name()
    }

    pub(crate) fn current_step(&self) -> u32 {
        guarded_or(0, || self.news.lock().map_or(0, |news| news.step))
    }

    pub(crate) fn is_finished(&self) -> bool {
        guarded_or(true, || self.news.lock().is_ok_and(|news| news.is_finished))
    }

    pub(crate) fn report(&self) -> TrainFigures {
        let unknown = TrainFigures {
            step: 0,
            steps: 0,
            seconds: 0.0,
            steps_per_second: 0.0,
            loss: f64::NAN,
            psnr: f64::NAN,
            splats: 0,
        };
        guarded_or(copy(&unknown), || self.news.lock().map_or(unknown, |news| copy(&news.report)))
    }

    pub(crate) fn advance(&self, work: &Work) -> Result<(), Failure> {
        self.with(|run| {
            let start = Instant::now();
            loop {
                work.check()?;
                run.advance(&mut |event| self.tell(event))?;
                let mut news = self.news.lock().map_err(poisoned)?;
                news.step = run.step();
                news.is_finished = run.is_finished();
                if news.is_finished || start.elapsed() >= TURN {
                    return Ok(());
                }
            }
        })
    }

    pub(crate) fn next_event(&self) -> TrainEventFigures {
        let nothing = || TrainEventFigures {
            is_event: false,
            kind: TrainEventKind::Report,
            report: self.report(),
            step: 0,
            to: 0,
        };
        let Ok(Some(event)) = self.news.lock().map(|mut news| news.events.pop_front()) else {
            return nothing();
        };
        match event {
            Event::Report(report) => {
                TrainEventFigures { is_event: true, report: figures(&report), ..nothing() }
            }
            Event::Saved { step, .. } => {
                TrainEventFigures { is_event: true, kind: TrainEventKind::Saved, step, ..nothing() }
            }
            Event::RolledBack { step, to, reason, .. } => {
                if let Ok(mut news) = self.news.lock() {
                    news.rollback_reason = reason;
                }
                let kind = TrainEventKind::RolledBack;
                TrainEventFigures { is_event: true, kind, step, to, ..nothing() }
            }
            // They are not kept.
            Event::Trial(_) | Event::SearchEnded { .. } => nothing(),
        }
    }

    pub(crate) fn rollback_reason(&self) -> String {
        self.news.lock().map_or_else(|_| String::new(), |news| news.rollback_reason.clone())
    }

    /// Saves the state on disk, so that another process can go on with the same bits.
    pub(crate) fn checkpoint(&self) -> Result<(), Failure> {
        self.with(|run| Ok(run.save(&mut |event| self.tell(event))?))
    }

    pub(crate) fn finish(&self, work: &Work) -> Result<TestFigures, Failure> {
        self.with(|run| finish::finish(run, &self.device, &self.dataset, &self.folder, work))
    }

    /// The splats as they are now at a time, from a camera in world coordinates.
    pub(crate) fn preview(
        &self,
        lens: Lens,
        world_to_camera: &[f64],
        time: f32,
    ) -> Result<Image, Failure> {
        self.with(|run| {
            let origin = DVec3::from(run.progress().origin);
            let camera = camera(&lens, world_to_camera)?.relative_to(origin);
            let background = match run.config().background {
                Background::Fixed(color) => color,
                Background::Random => [0.0; 3],
            };
            let frame = run.render(&camera, time)?;
            Ok(Image::new(Rgba8::of_colors(&frame, Some(background))))
        })
    }

    /// The scene as it is now; of a complete run as its files have it, with what was measured.
    pub(crate) fn trained_scene(&self) -> Result<Scene, Failure> {
        self.with(|run| {
            Ok(Scene::new(match finish::is_complete(&self.folder) {
                true => trapeze_formats::load_scene(&self.folder)?,
                false => run.scene()?,
            }))
        })
    }

    fn with<T>(
        &self,
        body: impl FnOnce(&mut dyn TrainingRun) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        guarded(|| body(self.run.lock().map_err(poisoned)?.get_mut().as_mut()))
    }

    /// Keeps an event until somebody asks.
    fn tell(&self, event: Event) {
        let Ok(mut news) = self.news.lock() else { return };
        match &event {
            Event::Report(report) => news.report = figures(report),
            Event::Trial(_) | Event::SearchEnded { .. } => return,
            Event::Saved { .. } | Event::RolledBack { .. } => {}
        }
        if news.events.len() == MOST_EVENTS {
            news.events.pop_front();
        }
        news.events.push_back(event);
    }
}

#[cfg(test)]
mod tests;
