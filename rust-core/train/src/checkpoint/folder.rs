//! The checkpoints of one run.

use std::path::{Path, PathBuf};

use trapeze_formats::{ReadError, WriteError};

use super::{Checkpoint, read_checkpoint, write_checkpoint};

/// Checkpoints that are kept.
const KEPT: usize = 2;
const SUFFIX: &str = ".checkpoint";
const PREFIX: &str = "step-";
const PAUSED: &str = "paused.checkpoint";
const BRANCH: &str = "branch.checkpoint";

/// A folder with the checkpoints of one run: the two newest that it can return to,
/// `step-<number>.checkpoint`, and, where it was stopped between two of them, `paused.checkpoint`.
/// While a trial goes on, `branch.checkpoint` is the end of its first branch; it belongs to the
/// process that wrote it, and no run is taken up from there.
///
/// A pause is kept apart because it must not change what a run returns to: a run that was paused
/// and diverges later goes back as far as the one that was never paused.
#[derive(Clone, Debug)]
pub struct CheckpointFolder {
    path: PathBuf,
}

impl CheckpointFolder {
    /// The folder at `path`, which is made when the first checkpoint is saved.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// Saves a checkpoint, then removes all but the two newest.
    ///
    /// # Errors
    /// [`WriteError`] with the operating system's reason; the older checkpoints are untouched.
    pub fn save(&self, checkpoint: &Checkpoint) -> Result<PathBuf, WriteError> {
        std::fs::create_dir_all(&self.path)
            .map_err(|source| WriteError::Io { path: self.path.clone(), source })?;
        let path = self.path_of(checkpoint.state.step);
        write_checkpoint(&path, checkpoint)?;
        for (_, old) in self.newest_first().into_iter().skip(KEPT) {
            if let Err(error) = std::fs::remove_file(&old) {
                tracing::warn!("{}: an old checkpoint stays: {error}", old.display());
            }
        }
        Ok(path)
    }

    /// Saves where a run was stopped, in place of an earlier stop.
    ///
    /// # Errors
    /// [`WriteError`] with the operating system's reason.
    pub fn save_paused(&self, checkpoint: &Checkpoint) -> Result<PathBuf, WriteError> {
        let path = self.path.join(PAUSED);
        write_checkpoint(&path, checkpoint)?;
        Ok(path)
    }

    /// Saves the end of a branch, in place of an earlier one.
    ///
    /// # Errors
    /// [`WriteError`] with the operating system's reason.
    pub fn save_branch(&self, checkpoint: &Checkpoint) -> Result<(), WriteError> {
        write_checkpoint(&self.path.join(BRANCH), checkpoint)
    }

    /// The end of the branch that was saved last.
    ///
    /// # Errors
    /// [`ReadError`] when it is missing or damaged.
    pub fn load_branch(&self) -> Result<Checkpoint, ReadError> {
        read_checkpoint(&self.path.join(BRANCH))
    }

    /// Removes the end of a branch, if there is one.
    pub fn remove_branch(&self) {
        let path = self.path.join(BRANCH);
        if path.exists() {
            remove_or_warn(&path);
        }
    }

    /// The checkpoint of one step.
    ///
    /// # Errors
    /// [`ReadError`] when it is missing or damaged.
    pub fn load(&self, step: u32) -> Result<Checkpoint, ReadError> {
        read_checkpoint(&self.path_of(step))
    }

    /// Where a run goes on that has `good` as its newest good state: the last stop after it, else
    /// there. A stop before the run was last rolled back is passed over, and so is a damaged one.
    #[must_use]
    pub fn load_paused(&self, good: &Checkpoint) -> Option<Checkpoint> {
        let path = self.path.join(PAUSED);
        if !path.exists() {
            return None;
        }
        let paused = read_checkpoint(&path)
            .inspect_err(|error| tracing::warn!("{error}; going on from the checkpoint before it"))
            .ok()?;
        let is_newer = paused.state.step > good.state.step;
        let is_same_line = paused.progress.rollbacks == good.progress.rollbacks
            && paused.progress.search == good.progress.search;
        (is_newer && is_same_line).then_some(paused)
    }

    /// Removes every checkpoint of the run, and the folder when nothing else is in it.
    ///
    /// # Errors
    /// [`WriteError`] with the operating system's reason.
    pub fn remove(&self) -> Result<(), WriteError> {
        let checkpoints = self.newest_first().into_iter().map(|(_, path)| path);
        let others = [PAUSED, BRANCH].map(|name| self.path.join(name));
        for path in checkpoints.chain(others.into_iter().filter(|path| path.exists())) {
            std::fs::remove_file(&path).map_err(|source| WriteError::Io { path, source })?;
        }
        // Files that are not ours stay, and the folder with them.
        let _ = std::fs::remove_dir(&self.path);
        Ok(())
    }

    fn path_of(&self, step: u32) -> PathBuf {
        self.path.join(format!("{PREFIX}{step:010}{SUFFIX}"))
    }

    /// The newest checkpoint that can be read; a damaged one is reported and passed over. `None`
    /// when there is none.
    ///
    /// # Errors
    /// [`ReadError`] of the newest when there are checkpoints and none can be read.
    pub fn load_newest(&self) -> Result<Option<Checkpoint>, ReadError> {
        let mut first_error = None;
        for (_, path) in self.newest_first() {
            match read_checkpoint(&path) {
                Ok(checkpoint) => return Ok(Some(checkpoint)),
                Err(error) => {
                    tracing::warn!("{error}; trying the checkpoint before it");
                    first_error.get_or_insert(error);
                }
            }
        }
        first_error.map_or(Ok(None), Err)
    }

    /// Removes what a killed process left: half-written files, and the branch of its trial. Only for
    /// the one process that owns the run, before it saves.
    pub fn remove_litter(&self) {
        self.remove_branch();
        for path in files(&self.path) {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            if name.starts_with(".trapeze-") && name.ends_with(".tmp") {
                remove_or_warn(&path);
            }
        }
    }

    /// Step and path of every checkpoint.
    fn newest_first(&self) -> Vec<(u32, PathBuf)> {
        let mut found: Vec<(u32, PathBuf)> = files(&self.path)
            .filter_map(|path| {
                let name = path.file_name()?.to_str()?;
                let step = name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.parse().ok()?;
                Some((step, path))
            })
            .collect();
        found.sort_unstable_by(|a, b| b.cmp(a));
        found
    }
}

fn remove_or_warn(path: &Path) {
    if let Err(error) = std::fs::remove_file(path) {
        tracing::warn!("{}: cannot be removed: {error}", path.display());
    }
}

/// What is in a folder; nothing when it does not exist.
fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path())
}

#[cfg(test)]
mod tests {
    use super::super::Progress;
    use super::*;
    use crate::TrainingState;
    use crate::config::TrainingConfig;
    use crate::parameters::tests::random_splats;

    fn checkpoint(step: u32) -> Checkpoint {
        let splats = random_splats(step.into(), 9, trapeze_scene::ShDegree::Zero);
        Checkpoint {
            config: TrainingConfig::default(),
            progress: Progress::default(),
            state: TrainingState { step, ..TrainingState::new(splats) },
        }
    }

    #[test]
    fn the_two_newest_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let checkpoints = CheckpointFolder::new(folder.path().join("new"));
        assert!(checkpoints.load_newest().unwrap().is_none());
        for step in [500, 1000, 10_000, 100_000] {
            checkpoints.save(&checkpoint(step)).unwrap();
        }
        let steps: Vec<u32> =
            checkpoints.newest_first().into_iter().map(|(step, _)| step).collect();
        assert_eq!(steps, [100_000, 10_000]);
        assert_eq!(checkpoints.load_newest().unwrap().unwrap(), checkpoint(100_000));
    }

    #[test]
    fn a_damaged_newest_gives_way_to_the_one_before() {
        let folder = tempfile::tempdir().unwrap();
        let checkpoints = CheckpointFolder::new(folder.path());
        checkpoints.save(&checkpoint(1)).unwrap();
        let newest = checkpoints.save(&checkpoint(2)).unwrap();
        let bytes = std::fs::read(&newest).unwrap();
        std::fs::write(&newest, &bytes[..bytes.len() / 2]).unwrap();
        assert_eq!(checkpoints.load_newest().unwrap().unwrap().state.step, 1);
        std::fs::write(folder.path().join("step-0000000001.checkpoint"), b"").unwrap();
        let error = checkpoints.load_newest().unwrap_err().to_string();
        assert!(error.contains("step-0000000002.checkpoint"), "{error}");
    }

    #[test]
    fn a_pause_is_taken_up_unless_the_run_went_another_way() {
        let folder = tempfile::tempdir().unwrap();
        let checkpoints = CheckpointFolder::new(folder.path().join("run"));
        checkpoints.save(&checkpoint(500)).unwrap();
        assert!(checkpoints.load_paused(&checkpoint(500)).is_none());
        checkpoints.save_paused(&checkpoint(730)).unwrap();
        assert_eq!(checkpoints.load_newest().unwrap().unwrap().state.step, 500);
        assert_eq!(checkpoints.load_paused(&checkpoint(500)), Some(checkpoint(730)));
        assert!(checkpoints.load_paused(&checkpoint(1000)).is_none());
        let mut rolled_back = checkpoint(500);
        rolled_back.progress.rollbacks = 1;
        assert!(checkpoints.load_paused(&rolled_back).is_none());
        std::fs::write(folder.path().join("run/paused.checkpoint"), b"half").unwrap();
        assert!(checkpoints.load_paused(&checkpoint(500)).is_none());
        checkpoints.remove().unwrap();
        assert!(!folder.path().join("run").exists());
    }

    #[test]
    fn a_branch_is_never_taken_up_and_goes_with_its_process_or_with_the_run() {
        let folder = tempfile::tempdir().unwrap();
        let checkpoints = CheckpointFolder::new(folder.path().join("run"));
        checkpoints.save(&checkpoint(500)).unwrap();
        checkpoints.save_branch(&checkpoint(600)).unwrap();
        assert_eq!(checkpoints.load_branch().unwrap(), checkpoint(600));
        assert_eq!(checkpoints.load_newest().unwrap(), Some(checkpoint(500)));
        assert!(checkpoints.load_paused(&checkpoint(500)).is_none());
        checkpoints.remove_litter();
        assert!(checkpoints.load_branch().is_err());
        checkpoints.remove_branch();
        checkpoints.save_branch(&checkpoint(600)).unwrap();
        checkpoints.remove().unwrap();
        assert!(!folder.path().join("run").exists());
    }

    #[test]
    fn half_written_files_are_removed_and_foreign_ones_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let checkpoints = CheckpointFolder::new(folder.path());
        for name in [".trapeze-abc.tmp", "notes.txt", "step-x.checkpoint"] {
            std::fs::write(folder.path().join(name), b"x").unwrap();
        }
        checkpoints.remove_litter();
        checkpoints.save(&checkpoint(3)).unwrap();
        let mut names: Vec<_> =
            files(folder.path()).map(|path| path.file_name().unwrap().to_owned()).collect();
        names.sort();
        assert_eq!(names, ["notes.txt", "step-0000000003.checkpoint", "step-x.checkpoint"]);
    }
}
