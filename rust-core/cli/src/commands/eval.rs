//! `trapeze eval`.

use std::path::Path;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use trapeze_formats::dataset::Dataset;
use trapeze_scene::{FrameSettings, Scene};
use trapeze_train::evaluation::{Evaluation, evaluate};

use super::render::{Backend, Painter};
use crate::dataset_input::{DatasetArguments, parse_color};
use crate::error::CliError;
use crate::output::{print_json, print_line, progress_bar};
use crate::scene_input::SceneArguments;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    dataset: DatasetArguments,
    /// Which views to compare.
    #[arg(long, value_enum, default_value_t)]
    views: Views,
    /// What renders the views.
    #[arg(long, value_enum, default_value_t)]
    backend: Backend,
    /// Compare over this colour: black, white or r,g,b. By default photographs with transparency
    /// over white, the others over black.
    #[arg(long, value_parser = parse_color)]
    background: Option<[f32; 3]>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Views {
    /// The held-out ones.
    #[default]
    Test,
    /// The training views.
    Train,
    /// Every view.
    All,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = arguments.scene.load()?;
    let dataset = arguments.dataset.load()?;
    let views: Vec<usize> = match arguments.views {
        Views::Test => dataset.test_views().collect(),
        Views::Train => dataset.training_views().collect(),
        Views::All => (0..dataset.views.len()).collect(),
    };
    let (background, backend) = (arguments.background, arguments.backend);
    let evaluation = evaluate_scene(scene, &dataset, &views, background, backend)?;
    let Some(evaluation) = evaluation else {
        return Err(CliError::argument("DATASET", "a view to compare with", "none of that kind"));
    };
    if arguments.json {
        print_json(&evaluation)
    } else {
        print_text(&evaluation, &arguments.scene.scene)
    }
}

/// Figures of a scene on some views of a dataset.
pub(super) fn evaluate_scene(
    scene: Scene,
    dataset: &Dataset,
    views: &[usize],
    background: Option<[f32; 3]>,
    backend: Backend,
) -> Result<Option<Evaluation>, CliError> {
    let mut painter = Painter::new(backend, Arc::new(scene))?;
    let progress = progress_bar(views.len() as u64, "comparing");
    let evaluation = evaluate(dataset, views, background, |index| {
        let view = &dataset.views[index];
        let settings = FrameSettings { time: view.time.unwrap_or(0.0), ..FrameSettings::default() };
        let frame = painter.paint(&view.camera, &settings)?;
        progress.inc(1);
        Ok::<_, CliError>(frame)
    });
    progress.finish_and_clear();
    evaluation
}

fn print_text(evaluation: &Evaluation, scene: &Path) -> Result<(), CliError> {
    let mean = &evaluation.mean;
    for view in &evaluation.views {
        let metrics = &view.metrics;
        print_line(&format!("{}: {:.2} dB, SSIM {:.4}", view.name, metrics.psnr, metrics.ssim))?;
    }
    print_line(&format!(
        "{}: {:.2} dB, SSIM {:.4} (in 8 bits {:.2} dB, {:.4}), mean of {} views",
        scene.display(),
        mean.psnr,
        mean.ssim,
        mean.psnr_8bit,
        mean.ssim_8bit,
        evaluation.views.len(),
    ))
}
