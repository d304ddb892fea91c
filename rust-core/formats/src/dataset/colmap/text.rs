//! `cameras.txt`, `images.txt` and `points3D.txt`.

use std::str::{FromStr, SplitAsciiWhitespace};

use super::model::{
    CameraModel, ModelCamera, ModelCameras, ModelImage, finite_position, rigid_transform,
};
use crate::ParseError;
use crate::dataset::points::WorldPoints;

/// Lines of `CAMERA_ID MODEL WIDTH HEIGHT PARAMS…`.
pub(super) fn parse_cameras(bytes: &[u8]) -> Result<ModelCameras, ParseError> {
    let mut cameras = ModelCameras::new();
    for line in lines(bytes)?.filter(|line| holds_data(line)) {
        let mut fields = Fields::of(line);
        let id = fields.next("camera id")?;
        let model = CameraModel::from_name(fields.word("camera model")?)?;
        let size = [fields.next("camera width")?, fields.next("camera height")?];
        let mut parameters = Vec::with_capacity(model.parameter_count());
        while !fields.is_empty() {
            parameters.push(fields.next("camera parameters")?);
        }
        cameras.insert(id, ModelCamera::new(model, size, &parameters)?);
    }
    Ok(cameras)
}

/// Pairs of lines: `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, then the 2-D points, which are
/// not read and whose line may be empty.
pub(super) fn parse_images(bytes: &[u8]) -> Result<Vec<ModelImage>, ParseError> {
    let mut images = Vec::new();
    let mut lines = lines(bytes)?;
    while let Some(line) = lines.next() {
        if !holds_data(line) {
            continue;
        }
        let mut fields = Fields::of(line);
        fields.next::<u32>("image id")?;
        let rotation = fields.numbers::<4>("image rotation")?;
        let translation = fields.numbers::<3>("image translation")?;
        let camera_id = fields.next("image's camera id")?;
        let name = fields.rest("image name")?.to_owned();
        let world_to_camera = rigid_transform(rotation, translation)?;
        images.push(ModelImage { name, camera_id, world_to_camera });
        lines.next();
    }
    Ok(images)
}

/// Lines of `POINT3D_ID X Y Z R G B ERROR TRACK…`.
pub(super) fn parse_points(bytes: &[u8]) -> Result<WorldPoints, ParseError> {
    let mut points = WorldPoints::default();
    for line in lines(bytes)?.filter(|line| holds_data(line)) {
        let mut fields = Fields::of(line);
        fields.next::<u64>("point id")?;
        points.positions.push(finite_position(fields.numbers("point position")?)?);
        let mut color = [0; 3];
        for channel in &mut color {
            *channel = fields.next("point colour")?;
        }
        points.colors.push(color);
    }
    Ok(points)
}

fn lines(bytes: &[u8]) -> Result<std::str::Lines<'_>, ParseError> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.lines()),
        Err(error) => Err(ParseError::value("text", "UTF-8", error)),
    }
}

fn holds_data(line: &str) -> bool {
    let line = line.trim_start();
    !line.is_empty() && !line.starts_with('#')
}

/// The fields of a line, separated by white space.
struct Fields<'a> {
    words: SplitAsciiWhitespace<'a>,
    line: &'a str,
}

impl<'a> Fields<'a> {
    fn of(line: &'a str) -> Self {
        Self { words: line.split_ascii_whitespace(), line }
    }

    fn is_empty(&self) -> bool {
        self.words.clone().next().is_none()
    }

    fn word(&mut self, field: &str) -> Result<&'a str, ParseError> {
        let missing = || ParseError::value(field, "a value", format!("only \"{}\"", self.line));
        self.words.next().ok_or_else(missing)
    }

    fn next<T: FromStr>(&mut self, field: &str) -> Result<T, ParseError> {
        let word = self.word(field)?;
        let expected = || format!("a number ({})", std::any::type_name::<T>());
        word.parse().map_err(|_| ParseError::value(field, expected(), word))
    }

    fn numbers<const N: usize>(&mut self, field: &str) -> Result<[f64; N], ParseError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.next(field)?;
        }
        Ok(numbers)
    }

    /// What is left of the line, spaces inside it kept.
    fn rest(mut self, field: &str) -> Result<&'a str, ParseError> {
        let first = self.word(field)?;
        // A word is a part of the line, so the distance of their starts is its offset.
        let offset = first.as_ptr() as usize - self.line.as_ptr() as usize;
        Ok(self.line[offset..].trim_end())
    }
}
