//! `cameras.bin`, `images.bin` and `points3D.bin`.

use super::model::{
    CameraModel, ModelCamera, ModelCameras, ModelImage, finite_position, rigid_transform,
};
use crate::ParseError;
use crate::bytes::ByteReader;
use crate::dataset::points::WorldPoints;

/// Bytes of a 2-D point in `images.bin`: x, y, id of the 3-D point.
const POINT_2D_BYTES: usize = 24;
/// Bytes of a track element in `points3D.bin`: image id, index of the 2-D point.
const TRACK_ELEMENT_BYTES: usize = 8;
/// Bytes of a 3-D point without its track.
const POINT_3D_BYTES: u64 = 51;
/// Longest image name.
const MAX_NAME_BYTES: usize = 4096;

pub(super) fn parse_cameras(bytes: &[u8]) -> Result<ModelCameras, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let count = reader.u64("number of cameras")?;
    let mut cameras = ModelCameras::new();
    for _ in 0..count {
        let id = reader.u32("camera id")?;
        let model = CameraModel::from_id(reader.u32("camera model")?)?;
        let size = [reader.u64("camera width")?, reader.u64("camera height")?];
        let mut parameters = Vec::with_capacity(model.parameter_count());
        for _ in 0..model.parameter_count() {
            parameters.push(f64(&mut reader, "camera parameters")?);
        }
        cameras.insert(id, ModelCamera::new(model, size, &parameters)?);
    }
    reader.expect_end("cameras")?;
    Ok(cameras)
}

pub(super) fn parse_images(bytes: &[u8]) -> Result<Vec<ModelImage>, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let count = reader.u64("number of images")?;
    let mut images = Vec::new();
    for _ in 0..count {
        reader.u32("image id")?;
        let rotation = f64s::<4>(&mut reader, "image rotation")?;
        let translation = f64s::<3>(&mut reader, "image translation")?;
        let camera_id = reader.u32("image's camera id")?;
        let name = name(&mut reader)?;
        let points = reader.u64("number of 2-D points")?;
        reader.take_array(points, POINT_2D_BYTES, "2-D points")?;
        let world_to_camera = rigid_transform(rotation, translation)?;
        images.push(ModelImage { name, camera_id, world_to_camera });
    }
    reader.expect_end("images")?;
    Ok(images)
}

pub(super) fn parse_points(bytes: &[u8]) -> Result<WorldPoints, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let count = reader.u64("number of points")?;
    if count > reader.remaining() as u64 / POINT_3D_BYTES {
        return Err(ParseError::Truncated {
            field: "points".into(),
            expected: count.saturating_mul(POINT_3D_BYTES),
            found: reader.remaining() as u64,
        });
    }
    let mut points = WorldPoints::default();
    for _ in 0..count {
        reader.u64("point id")?;
        points.positions.push(finite_position(f64s(&mut reader, "point position")?)?);
        points.colors.push(reader.array("point colour")?);
        f64(&mut reader, "point error")?;
        let track = reader.u64("track length")?;
        reader.take_array(track, TRACK_ELEMENT_BYTES, "track")?;
    }
    reader.expect_end("points")?;
    Ok(points)
}

/// A name that ends with a zero byte.
fn name(reader: &mut ByteReader<'_>) -> Result<String, ParseError> {
    let mut name = Vec::new();
    loop {
        match reader.u8("image name")? {
            0 => break,
            byte if name.len() < MAX_NAME_BYTES => name.push(byte),
            _ => {
                let expected = format!("at most {MAX_NAME_BYTES} bytes");
                return Err(ParseError::value("image name", expected, "more"));
            }
        }
    }
    String::from_utf8(name)
        .map_err(|error| ParseError::value("image name", "UTF-8", error.utf8_error()))
}

fn f64(reader: &mut ByteReader<'_>, field: &str) -> Result<f64, ParseError> {
    Ok(f64::from_le_bytes(reader.array(field)?))
}

fn f64s<const N: usize>(reader: &mut ByteReader<'_>, field: &str) -> Result<[f64; N], ParseError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = f64(reader, field)?;
    }
    Ok(values)
}
