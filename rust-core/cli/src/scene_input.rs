//! Arguments that several commands share: which scene, seen from where.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use glam::DVec3;
use trapeze_formats::{load_scene, read_camera};
use trapeze_scene::deformation::RotationRule;
use trapeze_scene::{Bounds, Camera, Orbit, Scene};

use crate::error::CliError;

/// The scene to work on.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// A splat file (.ply, .compressed.ply, .splat, .spz, .sog, meta.json) or a scene folder.
    pub(crate) scene: PathBuf,
    /// Use the sum of canonical rotation and delta without normalising it again, as upstream's
    /// CUDA rasteriser does.
    #[arg(long)]
    pub(crate) as_trained_rotation: bool,
}

impl SceneArguments {
    pub(crate) fn load(&self) -> Result<Scene, CliError> {
        let mut scene = load_scene(&self.scene)?;
        if let (true, Some(network)) = (self.as_trained_rotation, &mut scene.deformation) {
            network.rotation_rule = RotationRule::AsTrained;
        }
        Ok(scene)
    }
}

/// Which way is up in the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    X,
    Y,
    #[default]
    Z,
    MinusX,
    MinusY,
    MinusZ,
}

impl Up {
    pub(crate) fn direction(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
            Self::MinusX => DVec3::NEG_X,
            Self::MinusY => DVec3::NEG_Y,
            Self::MinusZ => DVec3::NEG_Z,
        }
    }
}

/// From where the scene is seen: a camera file, or an orbit that frames the scene by itself.
#[derive(Debug, Args)]
pub(crate) struct ViewArguments {
    /// Camera as JSON: width, height, fx, fy, cx, cy, world_to_camera.
    #[arg(long)]
    pub(crate) camera: Option<PathBuf>,
    /// Frame the scene from this azimuth and elevation, in degrees.
    #[arg(long, value_name = "AZIMUTH,ELEVATION", conflicts_with = "camera",
          allow_hyphen_values = true, value_parser = parse_pair)]
    pub(crate) orbit: Option<(f64, f64)>,
    /// The scene's up direction, for `--orbit` and paths.
    #[arg(long, value_enum, default_value_t)]
    pub(crate) up: Up,
    /// Vertical field of view in degrees, for `--orbit` and paths.
    #[arg(long, default_value_t = 40.0)]
    pub(crate) fov: f64,
    /// Enlarge the image around its centre, for `--orbit` and paths.
    #[arg(long, default_value_t = 1.0)]
    pub(crate) zoom: f64,
    /// Image size in pixels; the camera file's own by default, else 960x540.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub(crate) size: Option<(u32, u32)>,
}

/// Size of images when nothing says otherwise.
const DEFAULT_SIZE: (u32, u32) = (960, 540);
/// Where the scene is seen from when nothing says otherwise, degrees.
const DEFAULT_ORBIT: (f64, f64) = (30.0, 20.0);

impl ViewArguments {
    /// The camera that these arguments describe.
    pub(crate) fn camera(&self, scene: &Scene) -> Result<Camera, CliError> {
        if let Some(path) = &self.camera {
            let camera = read_camera(path)?;
            return Ok(match self.size {
                Some((width, height)) => camera.resized(width, height),
                None => camera,
            });
        }
        self.orbit_camera(scene, self.orbit.unwrap_or(DEFAULT_ORBIT))
    }

    /// A camera on the orbit around the scene, at (azimuth, elevation) in degrees.
    pub(crate) fn orbit_camera(
        &self,
        scene: &Scene,
        (azimuth, elevation): (f64, f64),
    ) -> Result<Camera, CliError> {
        if !(self.fov > 0.0 && self.fov < 180.0) {
            return Err(CliError::argument("--fov", "more than 0 and less than 180", self.fov));
        }
        if !(self.zoom > 0.0 && self.zoom.is_finite()) {
            return Err(CliError::argument("--zoom", "a positive number", self.zoom));
        }
        let unit = Bounds { min: DVec3::splat(-1.0), max: DVec3::ONE };
        let bounds = scene.framing_bounds().unwrap_or(unit);
        let orbit = Orbit { azimuth, elevation, up: self.up.direction() };
        let size = self.size.unwrap_or(DEFAULT_SIZE);
        let mut camera = orbit.frame(&bounds, self.fov.to_radians(), size);
        camera.fx *= self.zoom;
        camera.fy *= self.zoom;
        camera.validate()?;
        Ok(camera)
    }
}

fn parse_pair(text: &str) -> Result<(f64, f64), String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[a, b]) => Ok((a, b)),
        _ => Err("expected two numbers, as in 30,20".into()),
    }
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    text.split_once(['x', 'X'])
        .and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)))
        .filter(|&(w, h): &(u32, u32)| {
            let sides = 1..=trapeze_scene::MAX_IMAGE_SIDE;
            sides.contains(&w) && sides.contains(&h)
        })
        .ok_or_else(|| "expected a size from 1x1 to 16384x16384, as in 960x540".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_and_sizes_are_read_or_refused_with_an_example() {
        assert_eq!(parse_pair("-30, 20.5"), Ok((-30.0, 20.5)));
        assert!(parse_pair("30").unwrap_err().contains("30,20"));
        assert!(parse_pair("nan,1").is_err());
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        for bad in ["640", "0x10", "99999x10", "axb"] {
            assert!(parse_size(bad).unwrap_err().contains("960x540"));
        }
    }
}
