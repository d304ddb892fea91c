//! Which property of a vertex element holds what.

use ply_rs_bw::ply::{ElementDef, PropertyType};
use trapeze_scene::ShDegree;

use crate::ParseError;
use crate::splat_block::SplatBlock;

/// What every splat file has. A file with none of them is one of plain points.
const SPLAT_PROPERTIES: [&str; 11] = [
    "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "f_dc_0",
    "f_dc_1", "f_dc_2",
];

/// Property indices of what a splat is made of, in the order of [`trapeze_scene::Splats`].
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) positions: [usize; 3],
    log_scales: [usize; 3],
    rotations: [usize; 4],
    opacity_logits: usize,
    sh_dc: [usize; 3],
    /// Coefficient-major, r g b innermost; the file numbers them channel-major.
    sh_rest: Vec<usize>,
    /// TRASE's `gaussian_feats_*` by their number.
    features: Vec<usize>,
    pub(super) sh_degree: ShDegree,
}

/// A row of the vertex element, whatever its encoding.
pub(super) trait Row {
    /// Value of the property with this index.
    fn value(&self, property: usize) -> f32;
}

impl Layout {
    /// Finds the properties of a splat by name; others are ignored.
    pub(super) fn of(vertex: &ElementDef) -> Result<Self, ParseError> {
        refuse_plain_points(vertex)?;
        let one = |name: &str| scalar_index(vertex, name);
        let three = |prefix: &str| -> Result<[usize; 3], ParseError> {
            Ok([
                one(&format!("{prefix}0"))?,
                one(&format!("{prefix}1"))?,
                one(&format!("{prefix}2"))?,
            ])
        };
        let (sh_rest, sh_degree) = sh_rest_indices(vertex)?;
        Ok(Self {
            positions: [one("x")?, one("y")?, one("z")?],
            log_scales: three("scale_")?,
            rotations: [one("rot_0")?, one("rot_1")?, one("rot_2")?, one("rot_3")?],
            opacity_logits: one("opacity")?,
            sh_dc: three("f_dc_")?,
            sh_rest,
            features: feature_indices(vertex)?,
            sh_degree,
        })
    }

    /// Length of a splat's feature vector.
    pub(super) fn feature_dimensions(&self) -> usize {
        self.features.len()
    }

    /// Writes a row into splat `i` of a block.
    #[inline]
    pub(super) fn store(&self, row: &impl Row, block: &mut SplatBlock<'_>, i: usize) {
        block.positions[i] = self.positions.map(|p| row.value(p));
        block.log_scales[i] = self.log_scales.map(|p| row.value(p));
        block.rotations[i] = self.rotations.map(|p| row.value(p));
        block.opacity_logits[i] = row.value(self.opacity_logits);
        block.sh_dc[i] = self.sh_dc.map(|p| row.value(p));
        store_run(row, &self.sh_rest, block.sh_rest, i);
        store_run(row, &self.features, block.features, i);
    }
}

#[inline]
fn store_run(row: &impl Row, properties: &[usize], column: &mut [f32], i: usize) {
    let stride = properties.len();
    for (value, &property) in column[i * stride..(i + 1) * stride].iter_mut().zip(properties) {
        *value = row.value(property);
    }
}

/// A point cloud is the PLY file that people most often open by mistake: one line says what it is.
fn refuse_plain_points(vertex: &ElementDef) -> Result<(), ParseError> {
    if SPLAT_PROPERTIES.iter().any(|name| vertex.properties.contains_key(*name)) {
        return Ok(());
    }
    let names: Vec<&str> = vertex.properties.keys().map(String::as_str).collect();
    let found = format!("only points ({})", names.join(" "));
    Err(ParseError::value(
        "element vertex",
        "Gaussian splats (opacity, scale_0…2, rot_0…3, f_dc_0…2)",
        found,
    ))
}

/// Where the property of that name is, if it is a number.
pub(super) fn scalar_index(vertex: &ElementDef, name: &str) -> Result<usize, ParseError> {
    let field = || format!("vertex property {name}");
    match vertex.properties.get_full(name) {
        Some((index, _, property)) => match property.data_type {
            PropertyType::Scalar(_) => Ok(index),
            PropertyType::List(..) => Err(ParseError::value(field(), "a number", "a list")),
        },
        None => Err(ParseError::value(field(), "a declaration", "none")),
    }
}

/// The `f_rest_*` in memory order, and the degree that their number means.
fn sh_rest_indices(vertex: &ElementDef) -> Result<(Vec<usize>, ShDegree), ParseError> {
    let found = numbered(vertex, "f_rest_").len();
    let degree = sh_degree_of(found)?;
    Ok((sh_rest_in_memory_order(degree, |name| scalar_index(vertex, name))?, degree))
}

/// The degree of a file with `count` properties named `f_rest_*`.
pub(super) fn sh_degree_of(count: usize) -> Result<ShDegree, ParseError> {
    let degree =
        (count.is_multiple_of(3)).then(|| ShDegree::from_rest_coefficients(count / 3)).flatten();
    degree.ok_or_else(|| {
        ParseError::value("f_rest_*", "0, 9, 24 or 45 properties (SH degree 0 to 3)", count)
    })
}

/// Looks up `f_rest_*` in the order in which [`trapeze_scene::Splats`] stores them: the file
/// counts all coefficients of red, then green, then blue; memory has r g b of each coefficient.
pub(super) fn sh_rest_in_memory_order<T>(
    degree: ShDegree,
    mut find: impl FnMut(&str) -> Result<T, ParseError>,
) -> Result<Vec<T>, ParseError> {
    let coefficients = degree.rest_coefficients();
    let mut found = Vec::with_capacity(coefficients * 3);
    for coefficient in 0..coefficients {
        for channel in 0..3 {
            found.push(find(&format!("f_rest_{}", channel * coefficients + coefficient))?);
        }
    }
    Ok(found)
}

/// The `gaussian_feats_*`, by their number; gaps are allowed.
fn feature_indices(vertex: &ElementDef) -> Result<Vec<usize>, ParseError> {
    let mut named = numbered(vertex, "gaussian_feats_");
    named.sort_by_key(|&(number, _)| number);
    named.into_iter().map(|(_, name)| scalar_index(vertex, name)).collect()
}

/// Properties whose name is the prefix and a number.
fn numbered<'a>(vertex: &'a ElementDef, prefix: &str) -> Vec<(u32, &'a str)> {
    let number = |name: &'a String| Some((name.strip_prefix(prefix)?.parse().ok()?, name.as_str()));
    vertex.properties.keys().filter_map(number).collect()
}
