//! `trapeze convert`.

use std::path::PathBuf;

use clap::Args;
use glam::DVec3;
use trapeze_cpu::deform::DeformationStage;
use trapeze_formats::{load_scene, save_scene};
use trapeze_scene::edit::{
    FloaterRule, Placement, bake, crop_box, drop_clusters, keep_clusters, merge, min_opacity,
    without_floaters,
};
use trapeze_scene::{Bounds, Scene, ShDegree};

use crate::error::CliError;
use crate::scene_input::SceneArguments;

/// A merge comes first. Filters apply in the order in which they are listed here; weights, clusters and motion values
/// follow the splats that are left.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Where to write: .ply, .compressed.ply, .splat or .spz for the splats alone, anything else
    /// for a scene folder.
    output: PathBuf,
    /// Add the splats of another scene, which has no deformation network of its own.
    #[arg(long, value_name = "SCENE")]
    merge: Option<PathBuf>,
    /// Where the added scene goes: it is enlarged by SCALE, then moved by X, Y, Z.
    #[arg(long, value_name = "X,Y,Z,SCALE", requires = "merge", allow_hyphen_values = true,
          value_parser = parse_placement)]
    place: Option<Placement>,
    /// Keep only these clusters.
    #[arg(long, value_name = "IDS", value_delimiter = ',', conflicts_with = "drop_clusters")]
    keep_clusters: Vec<u32>,
    /// Drop these clusters.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    drop_clusters: Vec<u32>,
    /// Keep splats whose centre is inside this box, in world coordinates.
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true, value_parser = parse_box)]
    crop: Option<Bounds>,
    /// Keep splats with at least this opacity (0-1).
    #[arg(long, value_name = "ALPHA")]
    min_opacity: Option<f64>,
    /// Drop splats that are far from all others.
    #[arg(long)]
    remove_floaters: bool,
    /// Highest SH degree to keep.
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=3))]
    sh_degree: Option<u32>,
    /// Freeze a deformable scene at this time: the result is static.
    #[arg(long, allow_hyphen_values = true)]
    time: Option<f32>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let scene = with_merged(arguments.scene.load()?, arguments)?;
    let before = scene.len();
    let scene = frozen(filtered(scene, arguments)?, arguments.time)?;
    if scene.is_empty() && before > 0 {
        tracing::warn!("no splat is left after filtering");
    }
    save_scene(&arguments.output, &scene)?;
    eprintln!("{}: {} of {before} splats", arguments.output.display(), scene.len());
    Ok(())
}

fn with_merged(scene: Scene, arguments: &Arguments) -> Result<Scene, CliError> {
    let Some(path) = &arguments.merge else { return Ok(scene) };
    let added = load_scene(path)?;
    if added.deformation.is_some() {
        return Err(CliError::argument(
            "--merge",
            "a scene without a deformation network",
            format!("one in {}", path.display()),
        ));
    }
    Ok(merge(&scene, &added, &arguments.place.unwrap_or_default())?)
}

fn filtered(mut scene: Scene, arguments: &Arguments) -> Result<Scene, CliError> {
    if !arguments.keep_clusters.is_empty() {
        scene = scene.gather(&keep_clusters(&scene, &arguments.keep_clusters)?);
    }
    if !arguments.drop_clusters.is_empty() {
        scene = scene.gather(&drop_clusters(&scene, &arguments.drop_clusters)?);
    }
    if let Some(bounds) = &arguments.crop {
        scene = scene.gather(&crop_box(&scene, bounds));
    }
    if let Some(opacity) = arguments.min_opacity {
        if !(0.0..=1.0).contains(&opacity) {
            return Err(CliError::argument("--min-opacity", "0 to 1", opacity));
        }
        scene = scene.gather(&min_opacity(&scene, opacity));
    }
    if arguments.remove_floaters {
        scene = scene.gather(&without_floaters(&scene, &FloaterRule::default()));
    }
    if let Some(degree) = arguments.sh_degree {
        let degree = ShDegree::try_from(degree)?.min(scene.splats.sh_degree);
        scene.splats = scene.splats.with_sh_degree(degree);
    }
    Ok(scene)
}

/// The scene at one moment, without network; unchanged when no time is given.
fn frozen(scene: Scene, time: Option<f32>) -> Result<Scene, CliError> {
    let Some(time) = time else { return Ok(scene) };
    if scene.deformation.is_none() {
        return Err(CliError::argument("--time", "a scene with a deformation network", "none"));
    }
    let mut stage = DeformationStage::new(&scene);
    let pose = stage.evaluate(time, None).clone();
    Ok(bake(&scene, pose.positions, pose.rotations, &pose.scales)?)
}

fn parse_box(text: &str) -> Result<Bounds, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|part| part.trim().parse().ok().filter(|n: &f64| !n.is_nan()))
        .collect();
    let [x0, y0, z0, x1, y1, z1] = numbers[..] else {
        return Err("expected six numbers, as in -1,-1,0,1,1,2".into());
    };
    let (a, b) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
    Ok(Bounds { min: a.min(b), max: a.max(b) })
}

fn parse_placement(text: &str) -> Result<Placement, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[x, y, z, scale]) if scale > 0.0 => {
            Ok(Placement { translation: DVec3::new(x, y, z), scale })
        }
        _ => Err("expected three numbers and a scale above 0, as in 0,0,-1,0.5".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_placement_is_three_numbers_and_a_positive_scale() {
        let placement = parse_placement("-1, 2,0.5,0.25").unwrap();
        assert_eq!(placement.translation, DVec3::new(-1.0, 2.0, 0.5));
        assert_eq!(placement.scale, 0.25);
        for bad in ["1,2,3", "1,2,3,0", "1,2,3,-1", "1,2,nan,1", "1,a,2,3,4"] {
            assert!(parse_placement(bad).unwrap_err().contains("0,0,-1,0.5"), "{bad}");
        }
    }

    #[test]
    fn the_corners_of_a_box_may_come_in_any_order() {
        let bounds = parse_box("1,-1,0, -1,1,2").unwrap();
        assert_eq!(bounds.min, DVec3::new(-1.0, -1.0, 0.0));
        assert_eq!(bounds.max, DVec3::new(1.0, 1.0, 2.0));
        assert!(parse_box("1,2,3").unwrap_err().contains("six"));
    }
}
