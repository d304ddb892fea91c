//! Pictures of a run.

use std::path::PathBuf;

use trapeze_scene::Rgba8;
use trapeze_train::Trainer;
use trapeze_train::backend::TrainingBackend;
use trapeze_train::config::Background;

use super::output::OutputFolder;
use crate::error::CliError;
use crate::output::write_png;

/// Writes the first training view every so often: `previews/step-000500.png`.
pub(super) struct Previews {
    folder: PathBuf,
    every: u32,
    next: u32,
}

impl Previews {
    pub(super) fn new(folder: &OutputFolder, every: u32, step: u32) -> Self {
        Self { folder: folder.join("previews"), every, next: next_multiple(step, every) }
    }

    pub(super) fn write_if_due<B: TrainingBackend>(
        &mut self,
        trainer: &mut Trainer<B>,
    ) -> Result<(), CliError> {
        let step = trainer.step();
        if step < self.next && !trainer.is_finished() {
            return Ok(());
        }
        self.next = next_multiple(step, self.every);
        std::fs::create_dir_all(&self.folder).map_err(|e| CliError::file(&self.folder, e))?;
        let view = trainer.view(0).clone();
        let frame = trainer.render(&view.camera, view.time)?;
        let path = self.folder.join(format!("step-{step:06}.png"));
        let background = match trainer.config().background {
            Background::Fixed(color) => Some(color),
            Background::Random => None,
        };
        write_png(&path, &Rgba8::of_colors(&frame, background))
    }
}

/// The first multiple of `every` after `step`.
fn next_multiple(step: u32, every: u32) -> u32 {
    (step / every).saturating_add(1).saturating_mul(every)
}
