//! Plain points with colours, as reconstructions write them beside their poses.

use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};

use super::body::Body;
use super::header::{required_element, split_header};
use super::layout::scalar_index;
use crate::ParseError;
use crate::dataset::WorldPoints;

/// Parses the vertices of a PLY file of any encoding: x, y, z and, if they are there, red, green
/// and blue, as bytes or as fractions of one; mid grey without them. Points that are not finite are
/// left out.
///
/// # Errors
/// [`ParseError`] names what is missing in the header or the row that cannot be read.
pub(crate) fn parse_points(bytes: &[u8]) -> Result<WorldPoints, ParseError> {
    let (header, body) = split_header(bytes)?;
    let vertex = required_element(&header, "vertex")?;
    let position_at = find_three(vertex, ["x", "y", "z"])?;
    let color_at = match vertex.properties.contains_key("red") {
        true => Some(find_three(vertex, ["red", "green", "blue"])?),
        false => None,
    };
    let mut body = Body::new(&header, body);
    for element in header.elements.values().take_while(|element| element.name != vertex.name) {
        body.skip(element)?;
    }
    body.expect_rows(vertex)?;
    let mut points = WorldPoints::default();
    let mut row = Vec::with_capacity(vertex.properties.len());
    for index in 0..vertex.count {
        body.read_row(vertex, index, &mut row)?;
        let position = position_at.map(|(property, _)| row[property]);
        if position.iter().all(|coordinate| coordinate.is_finite()) {
            points.positions.push(position);
            points.colors.push(color_at.map_or([128; 3], |color| color.map(|c| byte(c, &row))));
        }
    }
    Ok(points)
}

/// A property and whether its numbers are floating-point.
type Column = (usize, bool);

fn find_three(vertex: &ElementDef, names: [&str; 3]) -> Result<[Column; 3], ParseError> {
    let find = |name: &str| -> Result<Column, ParseError> {
        let data_type = vertex.properties.get(name).map(|property| &property.data_type);
        let is_float =
            matches!(data_type, Some(PropertyType::Scalar(ScalarType::Float | ScalarType::Double)));
        Ok((scalar_index(vertex, name)?, is_float))
    };
    Ok([find(names[0])?, find(names[1])?, find(names[2])?])
}

fn byte((property, is_float): Column, row: &[f64]) -> u8 {
    // The cast saturates, and takes NaN to 0.
    let scale = if is_float { 255.0 } else { 1.0 };
    (row[property] * scale + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_bytes_fractions_or_absent() {
        let text = |ty: &str, row: &str| {
            format!(
                "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int v\nelement vertex 2\n\
                 property double z\nproperty double y\nproperty double x\n\
                 property {ty} red\nproperty {ty} green\nproperty {ty} blue\nend_header\n\
                 1 7\n3 2 500000.125 {row}\n0 nan 0 0 0 0\n"
            )
        };
        for (ty, row) in [("uchar", "255 0 51"), ("float", "1 -0.5 0.2")] {
            let points = parse_points(text(ty, row).as_bytes()).unwrap();
            assert_eq!(points.positions, [[500000.125, 2.0, 3.0]]);
            assert_eq!(points.colors, [[255, 0, 51]]);
        }
        let grey = text("uchar", "1 2 3").replace(" red", " r").replace(" green", " g");
        assert_eq!(parse_points(grey.as_bytes()).unwrap().colors, [[128; 3]]);
    }

    #[test]
    fn what_is_missing_is_named() {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4294967296\n\
                      property float x\nproperty float y\nproperty float z\nend_header\n";
        let message = |text: &str| parse_points(text.as_bytes()).unwrap_err().to_string();
        assert!(message(header).contains("vertex: expected 51539607552 bytes, found 0"));
        let flat = header.replace("property float z\n", "");
        assert!(message(&flat).contains("vertex property z"), "{}", message(&flat));
    }
}
