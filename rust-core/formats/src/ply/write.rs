//! Splats to PLY, with the properties and the order of the INRIA implementation.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;
use trapeze_scene::{Features, Scene};

use crate::{WriteError, write_atomically};

/// Writes a binary little-endian PLY file: positions, zero normals, colour, `f_rest_*`
/// channel-major, opacity, scales, rotation, then `gaussian_feats_*` if the scene has them.
///
/// Positions are in world coordinates, as double where [`Scene::origin`] is not zero. At an origin
/// below 2²³ = 8.4e6 a double resolves 2⁻³⁰ units, a nanometre in metres, which is all that the
/// addition can cost.
///
/// # Errors
/// [`WriteError::Io`] with the operating system's reason.
pub fn write_ply(path: &Path, scene: &Scene) -> Result<(), WriteError> {
    write_atomically(path, |out| encode_ply(scene, out))
}

/// Writes the bytes of a PLY file, see [`write_ply`].
///
/// # Errors
/// Those of `out`.
pub fn encode_ply(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    write_header(out, scene)?;
    let splats = &scene.splats;
    let coefficients = splats.sh_degree.rest_coefficients();
    let mut row = Vec::new();
    for i in 0..splats.len() {
        row.clear();
        put_position(&mut row, scene, i);
        put(&mut row, [0.0; 3]);
        put(&mut row, splats.sh_dc[i]);
        let rest = splats.sh_rest_of(i);
        for channel in 0..3 {
            put(&mut row, (0..coefficients).map(|j| rest[j * 3 + channel]));
        }
        put(&mut row, [splats.opacity_logits[i]]);
        put(&mut row, splats.log_scales[i]);
        put(&mut row, splats.rotations[i]);
        if let Some(Features { dimensions, values }) = &scene.features {
            put(&mut row, values[i * dimensions..(i + 1) * dimensions].iter().copied());
        }
        out.write_all(&row)?;
    }
    Ok(())
}

fn put(row: &mut Vec<u8>, values: impl IntoIterator<Item = f32>) {
    values.into_iter().for_each(|value| row.extend_from_slice(&value.to_le_bytes()));
}

fn put_position(row: &mut Vec<u8>, scene: &Scene, i: usize) {
    let position = scene.splats.positions[i];
    if scene.origin == DVec3::ZERO {
        return put(row, position);
    }
    let world = DVec3::from(position.map(f64::from)) + scene.origin;
    world.to_array().iter().for_each(|value| row.extend_from_slice(&value.to_le_bytes()));
}

fn write_header(out: &mut impl Write, scene: &Scene) -> io::Result<()> {
    let splats = &scene.splats;
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", splats.len())?;
    let position_type = if scene.origin == DVec3::ZERO { "float" } else { "double" };
    for axis in ["x", "y", "z"] {
        writeln!(out, "property {position_type} {axis}")?;
    }
    for normal in ["nx", "ny", "nz"] {
        writeln!(out, "property float {normal}")?;
    }
    floats(out, "f_dc_", 3)?;
    floats(out, "f_rest_", splats.sh_rest_stride())?;
    writeln!(out, "property float opacity")?;
    floats(out, "scale_", 3)?;
    floats(out, "rot_", 4)?;
    floats(out, "gaussian_feats_", scene.features.as_ref().map_or(0, |f| f.dimensions))?;
    writeln!(out, "end_header")
}

fn floats(out: &mut impl Write, prefix: &str, count: usize) -> io::Result<()> {
    (0..count).try_for_each(|i| writeln!(out, "property float {prefix}{i}"))
}
