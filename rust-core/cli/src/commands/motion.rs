//! `trapeze motion`.

use std::ops::ControlFlow;
use std::sync::Arc;

use clap::Args;
use serde::Serialize;
use trapeze_cpu::motion::{
    MotionOptions, RECOMMENDED_MIN_PSNR, ShareOutcome, compare_static_shares, measure_motion,
    recommended_percentile,
};
use trapeze_formats::{write_mask_bin, write_mask_json};
use trapeze_scene::{Camera, Motion, MotionMeasure, Scene};

use crate::error::CliError;
use crate::output::{print_json, progress_bar};
use crate::scene_input::{SceneArguments, ViewArguments};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    view: ViewArguments,
    /// Measure as the original app does: positions only, at 11 times.
    #[arg(long)]
    original_measure: bool,
    /// Give every splat the highest value of its cluster, so that objects rest as a whole.
    #[arg(long)]
    per_cluster: bool,
    /// Times after 0 at which the scene is compared with t = 0.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(64..=4096))]
    times: u32,
    /// Write mask.bin and mask.json into the scene folder.
    #[arg(long)]
    write: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct MotionReport {
    splats: usize,
    measure: &'static str,
    recommended_percentile: f32,
    min_psnr: f64,
    views: usize,
    times: usize,
    shares: Vec<Share>,
}

#[derive(Debug, Serialize)]
struct Share {
    static_percentile: f32,
    threshold: f32,
    dynamic_splats: usize,
    network_ms: f64,
    speed_up: f64,
    worst_psnr: Option<f64>,
    worst_max: f64,
    worst_p999: f64,
}

/// Shares that are compared, percent; the recommended one is then found to a percent.
const SHARES: [f32; 16] =
    [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0, 70.0, 80.0, 85.0, 90.0, 95.0];
/// Views and times on which the worst error is taken; the product is what a share must survive.
const AZIMUTHS: u32 = 8;
const TIMES: [f32; 8] = [0.06, 0.19, 0.31, 0.44, 0.56, 0.69, 0.81, 0.94];

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let mut scene = arguments.scene.load()?;
    if scene.deformation.is_none() {
        return Err(CliError::argument("SCENE", "a scene with a deformation network", "none"));
    }
    if arguments.write && !arguments.scene.scene.is_dir() {
        return Err(CliError::argument(
            "--write",
            "a scene folder",
            arguments.scene.scene.display(),
        ));
    }
    scene.motion = Some(measured(&scene, arguments)?);
    let scene = Arc::new(scene);
    let views = views(&scene, arguments)?;
    let progress = progress_bar(SHARES.len() as u64, "comparing");
    let outcomes = compare_static_shares(&scene, &SHARES, &views, &TIMES, |done| {
        progress.set_position(done as u64);
        ControlFlow::Continue(())
    })?;
    progress.finish_and_clear();
    let recommended = recommended_percentile(&outcomes);
    if let (true, Some(motion)) = (arguments.write, &scene.motion) {
        let motion = Motion { recommended_percentile: Some(recommended), ..motion.clone() };
        write_mask_bin(&arguments.scene.scene.join("mask.bin"), &motion)?;
        write_mask_json(&arguments.scene.scene.join("mask.json"), &motion)?;
    }
    let report = MotionReport {
        splats: scene.len(),
        measure: if arguments.original_measure {
            "position only"
        } else {
            "position and covariance"
        },
        recommended_percentile: recommended,
        min_psnr: RECOMMENDED_MIN_PSNR,
        views: views.len(),
        times: TIMES.len(),
        shares: outcomes.iter().map(Share::from).collect(),
    };
    if arguments.json { print_json(&report) } else { print_text(&report) }
}

fn measured(scene: &Scene, arguments: &Arguments) -> Result<Motion, CliError> {
    let times = (1..=arguments.times).map(|i| i as f32 / arguments.times as f32).collect();
    let options = MotionOptions {
        per_cluster: arguments.per_cluster,
        ..if arguments.original_measure {
            MotionOptions::original()
        } else {
            let measure = MotionMeasure::PositionAndCovariance;
            MotionOptions { measure, times, ..MotionOptions::default() }
        }
    };
    let progress = progress_bar(options.times.len() as u64, "measuring");
    let motion = measure_motion(scene, &options, |done, _| {
        progress.set_position(done as u64);
        ControlFlow::Continue(())
    });
    progress.finish_and_clear();
    motion.ok_or(CliError::Cancelled)
}

/// Views all around the scene, and the one that was asked for.
fn views(scene: &Scene, arguments: &Arguments) -> Result<Vec<Camera>, CliError> {
    let elevation = arguments.view.orbit.map_or(20.0, |(_, elevation)| elevation);
    let mut views: Vec<Camera> = (0..AZIMUTHS)
        .map(|i| {
            let azimuth = 360.0 * f64::from(i) / f64::from(AZIMUTHS);
            let camera = arguments.view.orbit_camera(scene, (azimuth, elevation))?;
            // Without a size of its own, half the default is enough to judge by.
            Ok(match arguments.view.size {
                Some(_) => camera,
                None => camera.resized(camera.width / 2, camera.height / 2),
            })
        })
        .collect::<Result<_, CliError>>()?;
    if arguments.view.camera.is_some() {
        views.push(arguments.view.camera(scene)?);
    }
    Ok(views)
}

impl From<&ShareOutcome> for Share {
    fn from(outcome: &ShareOutcome) -> Self {
        Self {
            static_percentile: outcome.percentile,
            threshold: outcome.threshold,
            dynamic_splats: outcome.dynamic_splats,
            network_ms: outcome.network_ms,
            speed_up: outcome.speed_up,
            // JSON has no infinity: equal images have no finite PSNR.
            worst_psnr: outcome.worst.psnr.is_finite().then_some(outcome.worst.psnr),
            worst_max: outcome.worst.max,
            worst_p999: outcome.worst.p999,
        }
    }
}

fn print_text(report: &MotionReport) -> Result<(), CliError> {
    use std::fmt::Write;
    let mut text = format!(
        "static    dynamic  network        speed-up   worst of {} views x {} times\n",
        report.views, report.times
    );
    for share in &report.shares {
        let psnr = share.worst_psnr.map_or("equal".into(), |p| format!("{p:.1} dB"));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:5.0} % {:10} {:8.2} ms {:10.2}x   {psnr:>9}, max {:.4}",
            share.static_percentile,
            share.dynamic_splats,
            share.network_ms,
            share.speed_up,
            share.worst_max,
        );
    }
    let _ = writeln!(
        text,
        "recommended: {} % static (at least {} dB in every view)",
        report.recommended_percentile, report.min_psnr
    );
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes()).map_err(CliError::Output)
}
