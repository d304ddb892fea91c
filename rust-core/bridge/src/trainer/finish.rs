//! The end of a run: its scene as a file, and how good that is.

use std::path::Path;
use std::sync::Arc;

use trapeze_formats::dataset::Dataset;
use trapeze_formats::{load_scene, save_scene_folder, write_atomically};
use trapeze_scene::FrameSettings;
use trapeze_train::evaluation::evaluate;
use trapeze_train::with_measured_motion;

use super::checkpoints;
use super::run::TrainingRun;
use crate::device::Device;
use crate::failure::Failure;
use crate::ffi::{Stage, TestFigures};
use crate::renderer::{Backend, Options};
use crate::work::Work;

/// Name of the summary in the folder of a run: with it the run is complete.
const SUMMARY: &str = "training.json";

/// A folder whose run is complete has nothing to go on with, and is not written over.
pub(super) fn refuse_finished(folder: &Path) -> Result<(), Failure> {
    if is_complete(folder) {
        let found = format!("a complete run in {}", folder.display());
        return Err(Failure::argument("training folder", "a new run, or one to go on with", found));
    }
    Ok(())
}

pub(super) fn is_complete(folder: &Path) -> bool {
    folder.join(SUMMARY).exists()
}

/// Writes the scene and the summary, and removes the checkpoints.
pub(super) fn finish(
    run: &mut dyn TrainingRun,
    device: &Device,
    dataset: &Dataset,
    folder: &Path,
    work: &Work,
) -> Result<TestFigures, Failure> {
    let mut summary = run.summary();
    let scene = run.scene()?;
    summary.count(&scene);
    let (scene, motion) =
        with_measured_motion(scene, dataset, || work.flow(Stage::Measuring, None))?;
    summary.motion = motion;
    work.step(Stage::Writing, None)?;
    save_scene_folder(folder, &scene)?;
    // The files are evaluated, as anyone else would load them, not what was in memory.
    let scene = Arc::new(load_scene(folder)?);
    let mut renderer = Backend::new(device, scene, Options::default())?;
    let views: Vec<usize> = dataset.test_views().collect();
    let mut done = 0;
    summary.test = evaluate(dataset, &views, None, |index| {
        work.step(Stage::Measuring, Some(f64::from(done) / views.len() as f64))?;
        done += 1;
        let view = &dataset.views[index];
        let time = view.time.unwrap_or(0.0);
        let settings = FrameSettings { time, ..FrameSettings::default() };
        renderer.render(&view.camera, &settings)
    })?;
    write_atomically(&folder.join(SUMMARY), |file| {
        serde_json::to_writer_pretty(&mut *file, &summary)?;
        std::io::Write::write_all(file, b"\n")
    })?;
    checkpoints(folder).remove()?;
    let mean = summary.test.map(|test| test.mean);
    Ok(TestFigures {
        psnr: mean.map_or(f64::NAN, |mean| mean.psnr),
        ssim: mean.map_or(f64::NAN, |mean| mean.ssim),
    })
}
