//! The end of a run: its scene as a file, and how good that is.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use trapeze_formats::dataset::Dataset;
use trapeze_formats::{
    load_scene, ply, write_atomically, write_mask_bin, write_mask_json, write_weights_bin,
};
use trapeze_scene::{Camera, FrameSettings, Scene};
use trapeze_train::evaluation::evaluate;
use trapeze_train::with_measured_motion;

use super::checkpoints;
use super::run::TrainingRun;
use crate::device::Device;
use crate::failure::Failure;
use crate::ffi::{Stage, TestFigures};
use crate::renderer::{Backend, Options};
use crate::work::Work;

/// Name of the splats in the folder of a run.
const SPLATS: &str = "point_cloud.ply";
/// Name of the deformation network there, of a scene that moves.
const NETWORK: &str = "weights.bin";
/// Name of the summary: with it a run is complete.
const SUMMARY: &str = "training.json";

/// A folder whose run is complete has nothing to go on with, and is not written over.
pub(super) fn refuse_finished(folder: &Path) -> Result<(), Failure> {
    if folder.join(SUMMARY).exists() {
        let found = format!("a complete run in {}", folder.display());
        return Err(Failure::argument("training folder", "a new run, or one to go on with", found));
    }
    Ok(())
}

/// What is to be loaded of a complete run: the file of a scene that rests, the folder of one that
/// moves.
pub(super) fn result(folder: &Path) -> Option<PathBuf> {
    folder.join(SUMMARY).exists().then(|| scene_in(folder))
}

fn scene_in(folder: &Path) -> PathBuf {
    if folder.join(NETWORK).exists() { folder.into() } else { folder.join(SPLATS) }
}

/// Writes the splats, and of a scene that moves the original app's files beside them.
fn save(scene: &Scene, folder: &Path) -> Result<(), Failure> {
    ply::write_ply(&folder.join(SPLATS), scene)?;
    let Some(network) = &scene.deformation else { return Ok(()) };
    write_weights_bin(&folder.join(NETWORK), network)?;
    if let Some(motion) = &scene.motion {
        write_mask_bin(&folder.join("mask.bin"), motion)?;
        write_mask_json(&folder.join("mask.json"), motion)?;
    }
    Ok(())
}

/// Writes the scene and the summary, and removes the checkpoints.
pub(super) fn finish(
    run: &mut dyn TrainingRun,
    device: &Device,
    dataset: &Dataset,
    folder: &Path,
    work: &Work,
) -> Result<TestFigures, Failure> {
    work.step(Stage::Writing, None)?;
    let mut summary = run.summary();
    let cameras: Vec<Camera> =
        dataset.training_views().map(|index| dataset.views[index].camera.clone()).collect();
    let (scene, motion) = with_measured_motion(run.scene()?, &cameras)?;
    summary.motion = motion;
    save(&scene, folder)?;
    // The files are evaluated, as anyone else would load them, not what was in memory.
    let scene = Arc::new(load_scene(&scene_in(folder))?);
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
