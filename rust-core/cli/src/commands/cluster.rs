//! `trapeze cluster`.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use serde::Serialize;
use trapeze_formats::{write_cluster_names, write_clusters_bin};
use trapeze_query::cluster::{
    ClusterOptions, adjusted_rand_index, by_features, by_geometry, is_unassigned,
};
use trapeze_scene::{Clusters, Scene};

use crate::error::CliError;
use crate::output::{print_json, print_line};
use crate::scene_input::SceneArguments;
use crate::search::positions_at;

/// From the feature vectors in the PLY (gaussian_feats_*) where there are some, else from place, motion
/// and colour.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Where to write; clusters.bin in the scene folder by default. Names go beside it.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace clusters that are there.
    #[arg(long)]
    force: bool,
    /// What to group by.
    #[arg(long, value_enum, default_value_t)]
    by: By,
    /// Splats in the sample; time and memory grow with its square.
    #[arg(long, default_value_t = 4000, value_parser = clap::value_parser!(u32).range(100..=20_000))]
    sample: u32,
    /// The smallest cluster, in percent of the splats.
    #[arg(long, default_value_t = 1.0, value_parser = parse_percent)]
    least_percent: f64,
    /// Times at which a scene with a network is compared.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=256))]
    times: u32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum By {
    /// Features where there are some, else geometry.
    #[default]
    Auto,
    /// gaussian_feats_* of the PLY.
    Features,
    /// Place, motion and colour.
    Geometry,
}

#[derive(Debug, Serialize)]
struct ClusterReport {
    splats: usize,
    by: &'static str,
    clusters: Vec<ClusterSize>,
    unassigned: usize,
    seconds: f64,
    /// Adjusted Rand index against the clusters that the scene came with.
    #[serde(skip_serializing_if = "Option::is_none")]
    agreement: Option<f64>,
    file: String,
}

#[derive(Debug, Serialize)]
struct ClusterSize {
    id: u32,
    splats: usize,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let out = output(arguments)?;
    let scene = arguments.scene.load()?;
    let start = Instant::now();
    let (clusters, by) = grouped(&scene, arguments)?;
    let seconds = start.elapsed().as_secs_f64();
    write_clusters_bin(&out, &clusters)?;
    write_cluster_names(&out.with_file_name("cluster-names.json"), &clusters)?;
    let sizes = clusters.sizes();
    let mut report = ClusterReport {
        splats: scene.len(),
        by,
        clusters: Vec::new(),
        unassigned: 0,
        seconds,
        agreement: scene
            .clusters
            .as_ref()
            .map(|c| adjusted_rand_index(&c.labels, &clusters.labels)),
        file: out.display().to_string(),
    };
    for (cluster, splats) in clusters.table.iter().zip(sizes) {
        if is_unassigned(cluster) {
            report.unassigned = splats;
        } else {
            report.clusters.push(ClusterSize { id: cluster.id, splats });
        }
    }
    if arguments.json { print_json(&report) } else { print_line(&text(&report)) }
}

/// Where the clusters go; what is there is not replaced unasked.
fn output(arguments: &Arguments) -> Result<PathBuf, CliError> {
    let scene = &arguments.scene.scene;
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None if scene.is_dir() => scene.join("clusters.bin"),
        None => {
            let found = scene.display();
            return Err(CliError::argument(
                "--out",
                "a file, for a scene that is no folder",
                found,
            ));
        }
    };
    if out.exists() && !arguments.force {
        let found = out.display();
        return Err(CliError::argument("--out", "a new file, or --force to replace it", found));
    }
    Ok(out)
}

fn grouped(scene: &Scene, arguments: &Arguments) -> Result<(Clusters, &'static str), CliError> {
    let options = ClusterOptions {
        sample: arguments.sample as usize,
        least_share: arguments.least_percent / 100.0,
    };
    match (arguments.by, &scene.features) {
        (By::Features, None) => {
            Err(CliError::argument("--by features", "a PLY with gaussian_feats_*", "none"))
        }
        (By::Auto | By::Features, Some(features)) => {
            let grouping = by_features(features, &scene.splats.positions, &options)?;
            Ok((grouping.into_clusters(), "features"))
        }
        _ => {
            let times = if scene.deformation.is_some() { arguments.times } else { 1 };
            let times: Vec<f32> =
                (0..times).map(|i| i as f32 / times.saturating_sub(1).max(1) as f32).collect();
            let grouping = by_geometry(scene, &positions_at(scene, &times), &options)?;
            Ok((grouping.into_clusters(), "geometry"))
        }
    }
}

fn text(report: &ClusterReport) -> String {
    let mut lines = vec![format!(
        "{} clusters of {} splats by {} in {:.1} s",
        report.clusters.len(),
        report.splats,
        report.by,
        report.seconds
    )];
    let size = |cluster: &ClusterSize| format!("  {:>4}  {} splats", cluster.id, cluster.splats);
    lines.extend(report.clusters.iter().map(size));
    lines.push(format!("  unassigned  {} splats", report.unassigned));
    lines.extend(report.agreement.map(|index| format!("adjusted Rand index {index:.4}")));
    lines.push(report.file.clone());
    lines.join("\n")
}

fn parse_percent(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|percent| *percent > 0.0 && *percent <= 50.0)
        .ok_or_else(|| "expected a percentage above 0, at most 50".into())
}
