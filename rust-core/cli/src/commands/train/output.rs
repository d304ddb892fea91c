//! The folder of a run: checkpoints while it goes on, then the scene and its summary.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use trapeze_formats::spz::{SpzOptions, write_spz};
use trapeze_formats::{
    ParseError, ReadError, ply, write_atomically, write_mask_bin, write_mask_json,
    write_weights_bin,
};
use trapeze_scene::Scene;
use trapeze_train::checkpoint::CheckpointFolder;
use trapeze_train::trainer::TrainingSummary;

use crate::error::CliError;

/// Name of the summary: with it a run is complete.
const SUMMARY: &str = "training.json";

/// How the splats are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum SceneFormat {
    /// Every bit.
    #[default]
    Ply,
    /// Packed, about a tenth of the size.
    Spz,
}

pub(super) struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// A new or empty folder; with `resume` also that of a run.
    pub(super) fn open(path: &Path, resume: bool) -> Result<Self, CliError> {
        let in_folder = |error| CliError::file(path, error);
        std::fs::create_dir_all(path).map_err(in_folder)?;
        let is_empty = std::fs::read_dir(path).map_err(in_folder)?.next().is_none();
        if !is_empty && !resume {
            let found = format!("{} with files in it", path.display());
            return Err(CliError::argument("--out", "an empty folder, or --resume", found));
        }
        Ok(Self { path: path.into() })
    }

    pub(super) fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    pub(super) fn checkpoints(&self) -> CheckpointFolder {
        CheckpointFolder::new(self.join("checkpoints"))
    }

    /// The summary of a run that is complete.
    pub(super) fn finished_run(&self) -> Result<Option<TrainingSummary>, CliError> {
        let path = self.join(SUMMARY);
        if !path.exists() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(&path).map_err(|error| CliError::file(&path, error))?;
        let summary = serde_json::from_str(&text).map_err(|error| {
            let error = ParseError::value("summary", "that of a training run", error);
            ReadError::new(&path, error)
        })?;
        Ok(Some(summary))
    }

    /// Writes the splats, and of a scene that moves the original app's files beside them. Returns what
    /// is to be loaded: the file, or this folder.
    pub(super) fn save_scene(
        &self,
        scene: &Scene,
        format: SceneFormat,
    ) -> Result<PathBuf, CliError> {
        let path = match format {
            SceneFormat::Ply => self.join("point_cloud.ply"),
            SceneFormat::Spz => self.join("point_cloud.spz"),
        };
        match format {
            SceneFormat::Ply => ply::write_ply(&path, scene)?,
            SceneFormat::Spz => write_spz(&path, scene, &SpzOptions::default())?,
        }
        let Some(network) = &scene.deformation else { return Ok(path) };
        write_weights_bin(&self.join("weights.bin"), network)?;
        if let Some(motion) = &scene.motion {
            write_mask_bin(&self.join("mask.bin"), motion)?;
            write_mask_json(&self.join("mask.json"), motion)?;
        }
        Ok(self.path.clone())
    }

    /// Writes the summary; then nothing is left to resume and the checkpoints go.
    pub(super) fn finish(&self, summary: &TrainingSummary) -> Result<(), CliError> {
        let path = self.join(SUMMARY);
        write_atomically(&path, |file| {
            serde_json::to_writer_pretty(&mut *file, summary)?;
            std::io::Write::write_all(file, b"\n")
        })?;
        self.checkpoints().remove()?;
        Ok(())
    }
}
