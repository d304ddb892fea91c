//! How a run begins, is saved and is taken up again.

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec3;
use trapeze_formats::dataset::Dataset;

use super::anchor::Anchor;
use super::initial::initial_splats;
use super::photographs::Photographs;
use super::proposal::Proposal;
use super::trial::RunningTrial;
use super::views::Views;
use super::{Event, Figures, Search, TrainError, Trainer, TrainerOptions, TrainingMemory};
use crate::backend::TrainingBackend;
use crate::checkpoint::{Checkpoint, CheckpointFolder, Progress};
use crate::config::TrainingConfig;
use crate::defaults::distinct_times;
use crate::initialise::scene_extent;
use crate::{TrainedNetwork, TrainingState};

impl<B: TrainingBackend> Trainer<B> {
    /// A new run. With a checkpoint folder its start is saved, so that it can be killed from here
    /// on.
    ///
    /// # Errors
    /// [`TrainError`] when the settings are out of range, the dataset cannot be trained on, or the
    /// run would not fit into the memory.
    pub fn start(
        dataset: &Dataset,
        config: TrainingConfig,
        backend: B,
        options: TrainerOptions,
    ) -> Result<Self, TrainError> {
        config.validate()?;
        if config.deformation.is_some() {
            expect_moving_scene(dataset)?;
        }
        let views = Views::new(dataset, &config)?;
        let cameras = views.cameras();
        let extent = scene_extent(&cameras);
        let splats = initial_splats(dataset, &cameras, &config, extent)?;
        let searched = config.search.is_some() && config.densification.is_some();
        let search = searched.then(|| Search::new(splats.len() as u32));
        let progress = Progress {
            extent,
            origin: dataset.origin.to_array(),
            dataset: fingerprint(dataset),
            search,
            ..Progress::default()
        };
        let network = config.deformation.map(|_| TrainedNetwork::standard(config.seed));
        let state = TrainingState { network, ..TrainingState::new(splats) };
        let start = Checkpoint { config, progress, state };
        let run = Run { dataset, views, backend, options };
        run.check_memory(&start)?;
        if let Some(folder) = &run.options.checkpoints {
            folder.remove_litter();
        }
        let anchor = Anchor::first(run.options.checkpoints.clone(), &start)?;
        run.enter(anchor, start)
    }

    /// Goes on with the run whose checkpoints are in `options.checkpoints`, or starts it when there
    /// are none yet. It ends as if it had never been interrupted.
    ///
    /// # Errors
    /// [`TrainError::OtherRun`] when the dataset or the settings are not those of the checkpoints;
    /// else as [`start`](Self::start).
    pub fn resume(
        dataset: &Dataset,
        config: TrainingConfig,
        backend: B,
        options: TrainerOptions,
    ) -> Result<Self, TrainError> {
        let newest = options.checkpoints.as_ref().map(CheckpointFolder::load_newest).transpose()?;
        let (Some(folder), Some(good)) = (&options.checkpoints, newest.flatten()) else {
            return Self::start(dataset, config, backend, options);
        };
        folder.remove_litter();
        expect_same_run(&good, &config, dataset)?;
        let paused = folder.load_paused(&good);
        let views = Views::new(dataset, &config)?;
        let anchor = Anchor::Folder(folder.clone(), good.state.step);
        let run = Run { dataset, views, backend, options };
        run.check_memory(&good)?;
        run.enter(anchor, paused.unwrap_or(good))
    }

    /// Makes a checkpoint the present state.
    pub(super) fn enter(&mut self, checkpoint: Checkpoint) -> Result<(), TrainError> {
        let capacity = self.capacity(&checkpoint);
        let step = checkpoint.state.step;
        self.backend.load(checkpoint.state, capacity)?;
        self.step = step;
        // Work that was undone was work.
        let seconds = self.progress.seconds.max(checkpoint.progress.seconds);
        self.progress = Progress { seconds, ..checkpoint.progress };
        let search = self.progress.search.as_ref();
        self.views.set_validation_aside(search.is_some_and(Search::sets_views_aside));
        Ok(())
    }

    /// The most splats that will be asked for before the next load. A search grows in trials, and
    /// each begins with a load.
    fn capacity(&self, checkpoint: &Checkpoint) -> u32 {
        let largest = match (&checkpoint.progress.search, &self.trial) {
            (None, _) => self.config.densification.map_or(0, |d| d.max_splats),
            (Some(_), Some(RunningTrial { proposal: Proposal::Splats(splats), .. })) => *splats,
            (Some(_), _) => 0,
        };
        largest.max(checkpoint.state.splats.len() as u32)
    }

    /// The present state, taken from the backend, which has to get it back or another. Waits.
    pub(super) fn take_checkpoint(&mut self) -> Result<Checkpoint, TrainError> {
        self.count_seconds();
        let state = self.backend.take_state()?;
        Ok(Checkpoint { config: self.config.clone(), progress: self.progress.clone(), state })
    }

    /// Saves the run as it is, so that this process may end; returns the checkpoint that
    /// [`resume`](Self::resume) will take. Without a folder, during a trial, or when the run is found
    /// to be unsound, nothing is written and the last good state is what there is.
    ///
    /// # Errors
    /// [`TrainError::Write`] when the disk is full, for one; the older checkpoints are untouched.
    pub fn save(&mut self, observer: &mut dyn FnMut(Event)) -> Result<Option<PathBuf>, TrainError> {
        let Some(folder) = self.options.checkpoints.clone() else { return Ok(None) };
        if self.trial.is_some() || self.step == self.anchor.step() {
            return Ok(None);
        }
        if !self.settle(observer)? {
            return Ok(None);
        }
        let checkpoint = self.take_checkpoint()?;
        let saved = folder.save_paused(&checkpoint);
        self.backend.put_back(checkpoint.state);
        let path = saved?;
        observer(Event::Saved { step: self.step, path: path.clone() });
        Ok(Some(path))
    }

    /// Adds the time since the last call to the seconds of the run.
    pub(super) fn count_seconds(&mut self) {
        let now = Instant::now();
        self.progress.seconds += (now - self.figures.counted).as_secs_f64();
        self.figures.counted = now;
    }
}

/// What a trainer is made of, before it has a state.
struct Run<'a, B> {
    dataset: &'a Dataset,
    views: Views,
    backend: B,
    options: TrainerOptions,
}

impl<B: TrainingBackend> Run<'_, B> {
    fn memory(&self, start: &Checkpoint) -> TrainingMemory {
        let initial = start.state.splats.len() as u32;
        TrainingMemory::of(&start.config, &self.views, &self.backend, initial, &self.options)
    }

    fn check_memory(&self, start: &Checkpoint) -> Result<(), TrainError> {
        self.options.memory_limit.map_or(Ok(()), |limit| self.memory(start).check(limit))
    }

    /// A trainer that stands at `start` and returns to `anchor`.
    fn enter(self, anchor: Anchor, start: Checkpoint) -> Result<Trainer<B>, TrainError> {
        let memory = self.memory(&start);
        let indices = self.views.dataset_indices();
        let photographs = Photographs::new(self.dataset, indices, self.options.photograph_budget);
        let mut trainer = Trainer {
            backend: self.backend,
            config: start.config.clone(),
            options: self.options,
            memory,
            views: self.views,
            photographs,
            step: 0,
            progress: Progress::default(),
            anchor,
            trial: None,
            figures: Figures::new(),
            losses: 0,
        };
        trainer.enter(start)?;
        Ok(trainer)
    }
}

/// What a network can learn from: photographs of more than one time, in coordinates that it can
/// tell apart. The files of a scene say what the network sees in world coordinates, and sines of
/// geographic ones are noise.
fn expect_moving_scene(dataset: &Dataset) -> Result<(), TrainError> {
    if distinct_times(dataset).len() < 2 {
        let expected = "more than one, for a scene that moves";
        return Err(TrainError::dataset("times of the training views", expected, "one"));
    }
    if dataset.origin != DVec3::ZERO {
        let expected = "coordinates near 0, for a scene that moves";
        return Err(TrainError::dataset("origin", expected, dataset.origin));
    }
    Ok(())
}

impl Figures {
    fn new() -> Self {
        let now = Instant::now();
        Self {
            loss: 0.0,
            steps: 0,
            since: now,
            taken: 0,
            counted: now,
            steps_per_second: 0.0,
            psnr: f64::NAN,
        }
    }
}

fn expect_same_run(
    checkpoint: &Checkpoint,
    config: &TrainingConfig,
    dataset: &Dataset,
) -> Result<(), TrainError> {
    let expected = &checkpoint.progress.dataset;
    let found = fingerprint(dataset);
    if *expected != found {
        return Err(TrainError::OtherRun { field: "dataset", expected: expected.clone(), found });
    }
    if checkpoint.config == *config {
        return Ok(());
    }
    let (expected, found) = first_difference(&checkpoint.config, config);
    Err(TrainError::OtherRun { field: "settings", expected, found })
}

/// The first setting that two configurations do not share, as `name value`.
fn first_difference(a: &TrainingConfig, b: &TrainingConfig) -> (String, String) {
    let fields = |config| match serde_json::to_value(config) {
        Ok(serde_json::Value::Object(fields)) => fields,
        _ => serde_json::Map::new(),
    };
    let (a, b) = (fields(a), fields(b));
    let differing = a.iter().find(|(name, value)| b.get(*name) != Some(value));
    let text = |name: &str, value: Option<&serde_json::Value>| {
        format!("{name} {}", value.map_or("none".into(), ToString::to_string))
    };
    differing.map_or_else(
        || ("these".into(), "others".into()),
        |(name, value)| (text(name, Some(value)), text(name, b.get(name))),
    )
}

/// What tells one dataset, read with one set of options, from another: the number and size of the
/// training views and a checksum of their names, cameras, lenses and times.
fn fingerprint(dataset: &Dataset) -> String {
    let mut hasher = crc32fast::Hasher::new();
    let mut views = 0;
    let mut size = [0, 0];
    for index in dataset.training_views() {
        let view = &dataset.views[index];
        let camera = &view.camera;
        views += 1;
        size = [camera.width, camera.height];
        hasher.update(view.name.as_bytes());
        hasher.update(format!("{:?}{}", view.distortion, view.reduction).as_bytes());
        for value in [camera.fx, camera.fy, camera.cx, camera.cy]
            .into_iter()
            .chain(camera.world_to_camera.to_cols_array())
        {
            hasher.update(&value.to_le_bytes());
        }
        hasher.update(bytemuck::cast_slice(&size));
        if let Some(time) = view.time {
            hasher.update(&time.to_le_bytes());
        }
    }
    let points = dataset.points.as_ref().map_or(0, trapeze_formats::dataset::PointCloud::len);
    let [width, height] = size;
    format!("{views} views of {width} x {height}, {points} points, {:08x}", hasher.finalize())
}
