//! `trapeze bench search`: looking at every cluster, and answering a text.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use serde::Serialize;
use trapeze_query::crops::CropOptions;
use trapeze_query::models::{Embedder, OnnxModel};
use trapeze_query::ranking::QueryOptions;
use trapeze_query::{SearchError, Searcher};
use trapeze_scene::Scene;

use crate::error::CliError;
use crate::measure::{Machine, Timing, time_runs};
use crate::output::{print_json, print_line};
use crate::scene_input::{SceneArguments, Up};
use crate::search::CpuCropRenderer;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Folder with image.onnx, text.onnx and model.json.
    #[arg(long, value_name = "DIR", default_value = "assets/search-model")]
    models: PathBuf,
    /// The text that is timed.
    #[arg(long, default_value = "red ball")]
    text: String,
    /// Views of a cluster.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=64))]
    views: u32,
    /// Side of a view in pixels.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(32..=2048))]
    crop_size: u32,
    /// The scene's up direction.
    #[arg(long, value_enum, default_value_t)]
    up: Up,
    /// Timed runs.
    #[arg(long, default_value_t = 20)]
    runs: usize,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct SearchBench {
    machine: Machine,
    model: String,
    splats: usize,
    clusters: usize,
    views: u32,
    crop_size: u32,
    crops: usize,
    /// All clusters: views chosen, crops rendered, image tower.
    encode: Timing,
    /// One text: templates, text tower, ranking.
    query: Timing,
    /// Clusters with a name, and those among them that their name finds first.
    named: usize,
    found_by_name: usize,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = Arc::new(arguments.scene.load()?);
    let model = OnnxModel::open(&arguments.models).map_err(SearchError::from)?;
    let name = model.description().name.clone();
    let options = CropOptions {
        views: arguments.views as usize,
        size: arguments.crop_size,
        up: arguments.up.direction(),
        ..CropOptions::default()
    };
    let mut searcher = Searcher::new(Arc::clone(&scene), Box::new(model), options)?;
    let mut renderer = CpuCropRenderer::new(Arc::clone(&scene));
    let mut crops = 0;
    let encode = time_runs(arguments.runs, || -> Result<(), CliError> {
        searcher.forget();
        crops = searcher.encode(&mut renderer, |_, _| ControlFlow::Continue(()))?.crops;
        Ok(())
    })?;
    let text = [arguments.text.as_str()];
    let query = time_runs(arguments.runs, || -> Result<(), CliError> {
        searcher.query(&text, &QueryOptions::default())?;
        Ok(())
    })?;
    let (named, found_by_name) = found_by_name(&mut searcher, &scene)?;
    let report = SearchBench {
        machine: Machine::this(),
        model: name,
        splats: scene.len(),
        clusters: scene.clusters.as_ref().map_or(0, |clusters| clusters.table.len()),
        views: arguments.views,
        crop_size: arguments.crop_size,
        crops,
        encode,
        query,
        named,
        found_by_name,
    };
    if arguments.json {
        return print_json(&report);
    }
    print_line(&format!(
        "{}: {} crops of {} clusters in {:.0} ms (p10-p90 {:.0}-{:.0}), a text in {:.1} ms ({:.1}-{:.1}); \
         {} of {} names find their cluster first",
        report.model,
        report.crops,
        report.clusters,
        report.encode.median_ms,
        report.encode.p10_ms,
        report.encode.p90_ms,
        report.query.median_ms,
        report.query.p10_ms,
        report.query.p90_ms,
        report.found_by_name,
        report.named,
    ))
}

/// How many clusters have a name, and how many of them it finds first.
fn found_by_name(searcher: &mut Searcher, scene: &Scene) -> Result<(usize, usize), CliError> {
    let Some(clusters) = &scene.clusters else { return Ok((0, 0)) };
    let options = QueryOptions { top_k: 1, threshold: Some(0.0) };
    let (mut named, mut found) = (0, 0);
    for cluster in &clusters.table {
        let Some(name) = &cluster.name else { continue };
        let answer = searcher.query(&[name.as_str()], &options)?;
        let best = answer.phrases.first().and_then(|phrase| phrase.matches.first());
        named += 1;
        found += usize::from(best.is_some_and(|best| best.cluster == cluster.id));
    }
    Ok((named, found))
}
