//! Cameras as JSON: one camera, or a list of views `{"camera": …, "time": …, "image": …}`.

use std::io::Write;
use std::path::Path;

use glam::DMat4;
use serde::{Deserialize, Serialize};
use trapeze_scene::Camera;

use crate::error::InFile;
use crate::json::{MAX_JSON_BYTES, parse_json};
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, WriteError, write_atomically};

/// A camera, the moment that it looks at, and the image that it made.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Time for the deformation network; 0 where the file does not say.
    pub time: f32,
    /// Name of the image file, relative to the JSON.
    pub image: Option<String>,
}

/// A camera as the file has it; `world_to_camera` is row-major.
#[derive(Deserialize, Serialize)]
struct CameraJson {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    world_to_camera: [[f64; 4]; 4],
}

#[derive(Deserialize, Serialize)]
struct ViewJson {
    camera: CameraJson,
    #[serde(default)]
    time: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    image: Option<String>,
}

impl CameraJson {
    fn from_camera(camera: &Camera) -> Self {
        Self {
            width: camera.width,
            height: camera.height,
            fx: camera.fx,
            fy: camera.fy,
            cx: camera.cx,
            cy: camera.cy,
            world_to_camera: camera.world_to_camera.transpose().to_cols_array_2d(),
        }
    }

    fn validated(self) -> Result<Camera, ParseError> {
        let camera = Camera {
            width: self.width,
            height: self.height,
            fx: self.fx,
            fy: self.fy,
            cx: self.cx,
            cy: self.cy,
            world_to_camera: DMat4::from_cols_array_2d(&self.world_to_camera).transpose(),
        };
        camera.validate()?;
        Ok(camera)
    }
}

/// Parses a single camera.
///
/// # Errors
/// [`ParseError`] names the field that is missing, of another type or not usable.
pub fn parse_camera(bytes: &[u8]) -> Result<Camera, ParseError> {
    if first_character(bytes) == Some(b'[') {
        return Err(ParseError::value("camera", "a single camera {…}", "a list"));
    }
    parse_json::<CameraJson>(bytes)?.validated()
}

/// Parses a list of views. A single camera counts as a list of one, at time 0.
///
/// # Errors
/// [`ParseError`] names the view and the field that is missing, of another type or not usable.
pub fn parse_views(bytes: &[u8]) -> Result<Vec<View>, ParseError> {
    if first_character(bytes) == Some(b'{') {
        return Ok(vec![View { camera: parse_camera(bytes)?, time: 0.0, image: None }]);
    }
    let views: Vec<ViewJson> = parse_json(bytes)?;
    views
        .into_iter()
        .enumerate()
        .map(|(i, view)| {
            let camera = view
                .camera
                .validated()
                .map_err(|error| ParseError::json(format!("[{i}].camera"), error))?;
            Ok(View { camera, time: view.time, image: view.image })
        })
        .collect()
}

fn first_character(bytes: &[u8]) -> Option<u8> {
    bytes.trim_ascii_start().first().copied()
}

/// Reads a single camera.
///
/// # Errors
/// [`ReadError`] with the path and the field that is wrong.
pub fn read_camera(path: &Path) -> Result<Camera, ReadError> {
    parse_camera(&read_regular_file(path, MAX_JSON_BYTES)?).in_file(path)
}

/// Reads a list of views, or a single camera as a list of one.
///
/// # Errors
/// [`ReadError`] with the path, the view and the field that is wrong.
pub fn read_views(path: &Path) -> Result<Vec<View>, ReadError> {
    parse_views(&read_regular_file(path, MAX_JSON_BYTES)?).in_file(path)
}

/// Writes a single camera.
///
/// # Errors
/// [`WriteError::Io`].
pub fn write_camera(path: &Path, camera: &Camera) -> Result<(), WriteError> {
    write_json(path, &CameraJson::from_camera(camera))
}

/// Writes a list of views.
///
/// # Errors
/// [`WriteError::Io`].
pub fn write_views(path: &Path, views: &[View]) -> Result<(), WriteError> {
    let views: Vec<ViewJson> = views
        .iter()
        .map(|view| ViewJson {
            camera: CameraJson::from_camera(&view.camera),
            time: view.time,
            image: view.image.clone(),
        })
        .collect();
    write_json(path, &views)
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), WriteError> {
    write_atomically(path, |file| {
        serde_json::to_writer_pretty(&mut *file, value)?;
        file.write_all(b"\n")
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(1.1, 2.0, 5.0), DVec3::ZERO, DVec3::Y, 0.8, (640, 480))
    }

    const CAMERA: &str = r#"{"width": 4, "height": 3, "fx": 5.0, "fy": 6, "cx": 2.0, "cy": 1.5,
        "world_to_camera": [[1,0,0,7],[0,1,0,8],[0,0,1,9],[0,0,0,1]], "note": "ignored"}"#;

    #[test]
    fn the_matrix_is_row_major() {
        let camera = parse_camera(CAMERA.as_bytes()).unwrap();
        assert_eq!(camera.world_to_camera.w_axis.truncate(), DVec3::new(7.0, 8.0, 9.0));
        assert_eq!((camera.width, camera.height, camera.fx, camera.fy), (4, 3, 5.0, 6.0));
    }

    #[test]
    fn cameras_and_views_survive_the_round_trip_exactly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("camera.json");
        write_camera(&path, &camera()).unwrap();
        assert_eq!(read_camera(&path).unwrap(), camera());
        let single = View { camera: camera(), time: 0.0, image: None };
        assert_eq!(read_views(&path).unwrap(), std::slice::from_ref(&single));

        let views =
            [View { time: 0.1, image: Some("view 1.npy".into()), ..single.clone() }, single];
        write_views(&path, &views).unwrap();
        assert_eq!(read_views(&path).unwrap(), views);
    }

    #[test]
    fn what_is_missing_or_wrong_is_refused_by_field() {
        let with = |from: &str, to: &str| CAMERA.replacen(from, to, 1);
        for (json, expected) in [
            (with(r#""fx": 5.0, "#, ""), "missing field `fx`"),
            (with("5.0", "NaN"), "fx: expected value"),
            (with("5.0", "null"), "fx: invalid type: null"),
            (with("5.0", "-5"), "camera fx: expected a positive focal length"),
            (with("4,", "4.5,"), "width: invalid type: floating point `4.5`, expected u32"),
            (with("4,", "0,"), "camera width: expected 1 to 16384 pixels, found 0"),
            (with("4,", "-1,"), "width: invalid value: integer `-1`, expected u32"),
            (with("[1,0,0,7]", "[1,0,0]"), "world_to_camera[0]: invalid length 3"),
            (with("[0,0,0,1]]", "[0,0,1,1]]"), "camera world_to_camera: expected last row"),
            (with("7]", "\"x\"]"), "world_to_camera[0][3]: invalid type"),
            (format!("[{CAMERA}]"), "camera: expected a single camera {…}, found a list"),
        ] {
            let error = parse_camera(json.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(expected) && !error.contains('\n'), "{json} gave {error}");
        }
    }

    #[test]
    fn errors_in_a_list_name_the_view() {
        let list = |view: &str| format!(r#"[{{"camera": {CAMERA}, "time": 0.5}}, {view}]"#);
        for (view, expected) in [
            (r#"{"time": 1}"#.to_owned(), "[1]: missing field `camera`"),
            (format!(r#"{{"camera": {CAMERA}, "time": "now"}}"#), "[1].time: invalid type"),
            (format!(r#"{{"camera": {CAMERA}, "time": 1e300}}"#), "[1].time: number out of range"),
            (
                format!(r#"{{"camera": {}}}"#, CAMERA.replace("5.0", "0")),
                "[1].camera: camera fx: expected a positive focal length",
            ),
        ] {
            let error = parse_views(list(&view).as_bytes()).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        assert!(parse_views(b"[]").unwrap().is_empty());
    }
}
