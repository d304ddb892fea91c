//! `trapeze info`.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use trapeze_formats::load_scene;
use trapeze_scene::{MotionMeasure, Scene};

use super::gpu_check;
use crate::error::CliError;
use crate::output::print_json;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A splat file (.ply, .compressed.ply, .splat, .spz, .sog, meta.json) or a scene folder.
    #[arg(required_unless_present = "gpu")]
    scene: Option<PathBuf>,
    /// Tell what the GPU is, and check its kernels: on built-in images, and on the scene if one is
    /// given, with what it takes on the device; always JSON. Fails when no kernel can be relied on.
    #[arg(long)]
    gpu: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Info {
    splats: usize,
    sh_degree: u32,
    /// Highest band that is not zero everywhere.
    used_sh_degree: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    bounds: Option<BoundsInfo>,
    /// World position of the stored coordinates' zero; absent when it is the zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clusters: Option<Vec<ClusterInfo>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    deformation: Option<DeformationInfo>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<MotionInfo>,
    #[serde(skip_serializing_if = "Option::is_none")]
    feature_dimensions: Option<usize>,
    antialiased: bool,
    memory_bytes: u64,
}

#[derive(Debug, Serialize)]
struct BoundsInfo {
    min: [f64; 3],
    max: [f64; 3],
}

#[derive(Debug, Serialize)]
struct ClusterInfo {
    id: u32,
    splats: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
}

#[derive(Debug, Serialize)]
struct DeformationInfo {
    architecture: String,
    standard: bool,
    parameters: usize,
    multiply_adds_per_splat: usize,
}

#[derive(Debug, Serialize)]
struct MotionInfo {
    measure: &'static str,
    max: f32,
    #[serde(skip_serializing_if = "Option::is_none")]
    recommended_percentile: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dynamic_splats_at_recommendation: Option<usize>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = arguments.scene.as_deref().map(load_scene).transpose()?;
    if arguments.gpu {
        let check = gpu_check::check(scene)?;
        print_json(&check)?;
        return match check.report.usable {
            true => Ok(()),
            false => Err(CliError::NoWorkingKernel { gpu: check.report.device.name }),
        };
    }
    let Some(scene) = scene else {
        return Err(CliError::argument("SCENE", "a splat file or a scene folder", "nothing"));
    };
    let info = describe(&scene);
    if arguments.json { print_json(&info) } else { print_text(&info) }
}

fn describe(scene: &Scene) -> Info {
    let bounds = scene.bounds();
    Info {
        splats: scene.len(),
        sh_degree: scene.splats.sh_degree as u32,
        used_sh_degree: scene.splats.used_sh_degree() as u32,
        bounds: bounds.map(|b| BoundsInfo { min: b.min.to_array(), max: b.max.to_array() }),
        origin: (scene.origin != glam::DVec3::ZERO).then(|| scene.origin.to_array()),
        clusters: scene.clusters.as_ref().map(|clusters| {
            let sizes = clusters.sizes();
            let entries = clusters.table.iter().zip(sizes);
            entries
                .map(|(c, splats)| ClusterInfo { id: c.id, splats, name: c.name.clone() })
                .collect()
        }),
        deformation: scene.deformation.as_ref().map(|network| DeformationInfo {
            architecture: network.describe(),
            standard: network.is_standard(),
            parameters: network.parameter_count(),
            multiply_adds_per_splat: network.multiply_adds(),
        }),
        motion: scene.motion.as_ref().map(|motion| MotionInfo {
            measure: match motion.measure {
                MotionMeasure::PositionAndCovariance => "position and covariance",
                MotionMeasure::PositionOnly => "position only",
                MotionMeasure::Unknown => "not stated",
            },
            max: motion.values.iter().copied().fold(0.0, f32::max),
            recommended_percentile: motion.recommended_percentile,
            dynamic_splats_at_recommendation: motion
                .recommended_percentile
                .map(|p| motion.dynamic_indices(motion.threshold_at_percentile(p)).len()),
        }),
        feature_dimensions: scene.features.as_ref().map(|f| f.dimensions),
        antialiased: scene.antialiased,
        memory_bytes: scene.memory().total(),
    }
}

fn print_text(info: &Info) -> Result<(), CliError> {
    use std::fmt::Write;
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:14}{value}");
    };
    line("splats", info.splats.to_string());
    line(
        "SH degree",
        match info.sh_degree == info.used_sh_degree {
            true => info.sh_degree.to_string(),
            false => format!("{} ({} used)", info.sh_degree, info.used_sh_degree),
        },
    );
    if let Some(b) = &info.bounds {
        line("bounds", format!("{:.3?} to {:.3?}", b.min, b.max));
    }
    if let Some(origin) = &info.origin {
        line("origin", format!("{origin:?}"));
    }
    if let Some(deformation) = &info.deformation {
        line("deformation", deformation.architecture.clone());
    }
    if let Some(motion) = &info.motion {
        let recommended = motion
            .recommended_percentile
            .map_or(String::new(), |p| format!(", {p} % recommended to rest"));
        line("motion", format!("up to {:.4} ({}){recommended}", motion.max, motion.measure));
    }
    for cluster in info.clusters.iter().flatten() {
        let name = cluster.name.as_deref().unwrap_or("");
        line("cluster", format!("{:>4} {:>9} splats  {name}", cluster.id, cluster.splats));
    }
    if let Some(dimensions) = info.feature_dimensions {
        line("features", format!("{dimensions} per splat"));
    }
    if info.antialiased {
        line("antialiased", "trained with a 2-D Mip filter, which is not applied".into());
    }
    line("memory", format!("{:.1} MB", info.memory_bytes as f64 / 1e6));
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes()).map_err(CliError::Output)
}
