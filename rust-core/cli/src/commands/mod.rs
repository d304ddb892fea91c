//! One file per command.

mod bench;
mod bench_gpu;
mod cluster;
mod convert;
mod demo;
mod eval;
mod gpu_check;
mod info;
mod motion;
mod query;
mod render;
mod report;
mod train;

use clap::Subcommand;

use crate::error::CliError;

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// What a scene holds: splats, bounds, clusters, deformation, memory.
    Info(info::Arguments),
    /// Convert between formats, and keep part of a scene.
    Convert(convert::Arguments),
    /// Render an image, raw values, a sequence or an animation.
    Render(render::Arguments),
    /// Measure how far each splat moves and recommend which can rest.
    Motion(motion::Arguments),
    /// Speed against error of every variant, as JSON, Markdown and SVG.
    Report(report::Arguments),
    /// Time one part: render, deform or load.
    #[command(subcommand)]
    Bench(bench::Bench),
    /// Train a scene from posed photographs.
    Train(train::Arguments),
    /// Compare a scene with photographs: PSNR and SSIM.
    Eval(eval::Arguments),
    /// Group splats into clusters, for scenes that come without.
    Cluster(cluster::Arguments),
    /// Find the clusters that a text means.
    Query(query::Arguments),
    /// Run the main job on a scene and write a page that shows it.
    Demo(demo::Arguments),
}

impl Command {
    pub(crate) fn run(&self) -> Result<(), CliError> {
        match self {
            Self::Info(arguments) => info::run(arguments),
            Self::Convert(arguments) => convert::run(arguments),
            Self::Render(arguments) => render::run(arguments),
            Self::Motion(arguments) => motion::run(arguments),
            Self::Report(arguments) => report::run(arguments),
            Self::Bench(bench) => bench.run(),
            Self::Train(arguments) => train::run(arguments),
            Self::Eval(arguments) => eval::run(arguments),
            Self::Cluster(arguments) => cluster::run(arguments),
            Self::Query(arguments) => query::run(arguments),
            Self::Demo(arguments) => demo::run(arguments),
        }
    }
}
