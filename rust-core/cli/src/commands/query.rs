//! `trapeze query`.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use trapeze_query::crops::CropOptions;
use trapeze_query::ranking::QueryOptions;

use crate::error::CliError;
use crate::output::{print_json, print_line};
use crate::scene_input::{SceneArguments, Up};
use crate::search::{Found, SearchArguments, SearchReport, search};

/// Clusters are looked at once; their features are kept beside the scene (features.bin) and made anew
/// for clusters that changed.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// What to look for; each text is a question of its own.
    #[arg(required = true)]
    text: Vec<String>,
    /// Most matches of a text.
    #[arg(long, default_value_t = 3)]
    top_k: usize,
    /// Least score of a match, 0-1; the model's own by default.
    #[arg(long, value_parser = parse_share)]
    threshold: Option<f32>,
    /// Folder with image.onnx, text.onnx and model.json.
    #[arg(long, value_name = "DIR", default_value = "assets/search-model")]
    models: PathBuf,
    /// Write a contact sheet: a row per text, the score as a bar.
    #[arg(long, value_name = "PNG")]
    out: Option<PathBuf>,
    /// Keep features here instead of beside the scene.
    #[arg(long, value_name = "FILE")]
    features: Option<PathBuf>,
    /// Views of a cluster.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=64))]
    views: u32,
    /// Side of a view in pixels.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(32..=2048))]
    crop_size: u32,
    /// The scene's up direction: clusters are looked at from above the horizon.
    #[arg(long, value_enum, default_value_t)]
    up: Up,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = Arc::new(arguments.scene.load()?);
    let report = search(
        &scene,
        &SearchArguments {
            path: &arguments.scene.scene,
            phrases: &arguments.text,
            models: &arguments.models,
            features: arguments.features.as_deref(),
            crops: CropOptions {
                views: arguments.views as usize,
                size: arguments.crop_size,
                up: arguments.up.direction(),
                ..CropOptions::default()
            },
            query: QueryOptions { top_k: arguments.top_k, threshold: arguments.threshold },
            sheet: arguments.out.as_deref(),
        },
    )?;
    if arguments.json {
        print_json(&report)
    } else {
        print_line(text(arguments, &report).trim_end())
    }
}

/// The report for people.
fn text(arguments: &Arguments, report: &SearchReport) -> String {
    let mut text = String::new();
    let describe = |found: &Found| {
        let name = found.name.as_ref().map(|name| format!(" ({name})")).unwrap_or_default();
        format!("cluster {}{name}  {:.3}", found.cluster, found.score)
    };
    for phrase in &arguments.text {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{phrase}");
        for found in report.results.iter().filter(|found| found.text == *phrase) {
            let _ = writeln!(text, "  {}", describe(found));
        }
        for nearest in report.nearest.iter().filter(|found| found.text == *phrase) {
            let threshold = report.threshold;
            let _ = writeln!(
                text,
                "  no match (threshold {threshold}); nearest: {}",
                describe(nearest)
            );
        }
    }
    for out in &report.left_out {
        let _ = writeln!(text, "cluster {} left out: {}", out.cluster, out.reason);
    }
    for merge in &report.merge_suggestions {
        let [a, b] = merge.clusters;
        let _ = writeln!(text, "clusters {a} and {b} may be parts of one object");
    }
    text
}

fn parse_share(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|share| (0.0..=1.0).contains(share))
        .ok_or_else(|| "expected a number from 0 to 1".into())
}
