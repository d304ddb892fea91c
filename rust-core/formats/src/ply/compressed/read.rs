//! Compressed PLY to splats.

use ply_rs_bw::ply::{ElementDef, Header, ScalarType};
use rayon::prelude::*;
use trapeze_scene::{Scene, SceneError, ShDegree};

use super::CHUNK;
use super::pack::{unpack_11_10_11, unpack_rotation};
use crate::ParseError;
use crate::bytes::f32s_from_le;
use crate::ply::body::Body;
use crate::ply::header::required_element;
use crate::ply::layout::{sh_degree_of, sh_rest_in_memory_order};
use crate::ply::scalar::{ByteOrder, fixed_columns};
use crate::quantised::{logit_of_byte, sh_dc_of_color};
use crate::recentre::recentre_f64;
use crate::splat_block::{SplatBlock, zeroed_splats};

/// Whether the header is that of a compressed file.
pub(in crate::ply) fn is_compressed(header: &Header) -> bool {
    let vertex = header.elements.get("vertex");
    vertex.is_some_and(|vertex| vertex.properties.contains_key("packed_position"))
}

/// Reads the splats of a compressed file whose header is parsed.
pub(in crate::ply) fn read_compressed(header: &Header, bytes: &[u8]) -> Result<Scene, ParseError> {
    let file = CompressedFile::locate(header, bytes)?;
    let mut splats = zeroed_splats(file.count, file.sh_degree())?;
    SplatBlock::all(&mut splats, &mut []).for_each_part(&|mut block| {
        for i in 0..block.len() {
            file.store(block.first + i, &mut block, i);
        }
    });
    let world: Vec<[f64; 3]> =
        (0..file.count).into_par_iter().map(|index| file.world_position(index)).collect();
    let (positions, origin) = recentre_f64(&world);
    splats.positions = positions;
    Ok(Scene { origin, ..Scene::from_splats(splats) })
}

/// The parts of a compressed file, checked against each other.
struct CompressedFile<'a> {
    count: usize,
    chunks: Vec<Chunk>,
    vertices: Section<'a>,
    /// Byte offsets of `packed_position`, `_rotation`, `_scale`, `_color` in a row.
    packed: [usize; 4],
    sh: Option<Harmonics<'a>>,
}

/// Bounds of 256 splats, for each coordinate from its lowest to its highest value.
struct Chunk {
    position: [(f64, f64); 3],
    log_scale: [(f64, f64); 3],
    color: [(f64, f64); 3],
}

struct Harmonics<'a> {
    rows: Section<'a>,
    /// Byte offsets in the order of [`trapeze_scene::Splats::sh_rest`].
    offsets: Vec<usize>,
    degree: ShDegree,
}

impl<'a> CompressedFile<'a> {
    fn locate(header: &'a Header, bytes: &'a [u8]) -> Result<Self, ParseError> {
        let sections = Section::all(header, bytes)?;
        let section = |name: &str| {
            let element = required_element(header, name)?;
            // `all` has one section for each element of the header.
            let found = sections.iter().find(|section| section.element.name == element.name);
            found.cloned().ok_or_else(|| ParseError::value(name, "an element", "none"))
        };
        let vertices = section("vertex")?;
        let count = vertices.element.count;
        if count > u32::MAX as usize {
            return Err(SceneError::TooManySplats { found: count }.into());
        }
        let chunk_rows = section("chunk")?;
        let chunks = chunk_rows.element.count;
        if chunks != count.div_ceil(CHUNK) {
            let expected = format!("{} for {count} splats", count.div_ceil(CHUNK));
            return Err(ParseError::value("element chunk", expected, chunks));
        }
        let packed = |name: &str| vertices.offset(name, &ScalarType::UInt);
        let packed = [
            packed("packed_position")?,
            packed("packed_rotation")?,
            packed("packed_scale")?,
            packed("packed_color")?,
        ];
        let sh = header.elements.get("sh").map(|_| Harmonics::of(section("sh")?, count));
        Ok(Self { count, chunks: read_chunks(&chunk_rows)?, vertices, packed, sh: sh.transpose()? })
    }

    fn sh_degree(&self) -> ShDegree {
        self.sh.as_ref().map_or(ShDegree::Zero, |sh| sh.degree)
    }

    fn packed(&self, index: usize, field: usize) -> u32 {
        let b = &self.vertices.row(index)[self.packed[field]..][..4];
        u32::from_le_bytes([b[0], b[1], b[2], b[3]])
    }

    fn world_position(&self, index: usize) -> [f64; 3] {
        let fractions = unpack_11_10_11(self.packed(index, 0));
        between(&self.chunks[index / CHUNK].position, fractions)
    }

    /// Writes everything but the position of splat `index` into splat `i` of the block.
    fn store(&self, index: usize, block: &mut SplatBlock<'_>, i: usize) {
        let chunk = &self.chunks[index / CHUNK];
        block.rotations[i] = unpack_rotation(self.packed(index, 1));
        let scale = unpack_11_10_11(self.packed(index, 2));
        block.log_scales[i] = between(&chunk.log_scale, scale).map(|s| s as f32);
        let [red, green, blue, alpha] = self.packed(index, 3).to_be_bytes();
        let color = [red, green, blue].map(|c| f64::from(c) / 255.0);
        block.sh_dc[i] = between(&chunk.color, color).map(sh_dc_of_color);
        block.opacity_logits[i] = logit_of_byte(alpha);
        if let Some(sh) = &self.sh {
            let row = sh.rows.row(index);
            let stride = sh.offsets.len();
            let values = &mut block.sh_rest[i * stride..(i + 1) * stride];
            for (value, &offset) in values.iter_mut().zip(&sh.offsets) {
                *value = coefficient_of_byte(row[offset]);
            }
        }
    }
}

impl<'a> Harmonics<'a> {
    fn of(rows: Section<'a>, count: usize) -> Result<Self, ParseError> {
        if rows.element.count != count {
            return Err(ParseError::value(
                "element sh",
                format!("{count} rows"),
                rows.element.count,
            ));
        }
        let degree = sh_degree_of(rows.element.properties.len())?;
        let offsets =
            sh_rest_in_memory_order(degree, |name| rows.offset(name, &ScalarType::UChar))?;
        Ok(Self { rows, offsets, degree })
    }
}

fn between(bounds: &[(f64, f64); 3], fractions: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let ((low, high), t) = (bounds[axis], fractions[axis]);
        low * (1.0 - t) + high * t
    })
}

/// The middle of the interval that the encoder takes to this byte; the ends stand for ±4 itself.
fn coefficient_of_byte(byte: u8) -> f32 {
    match byte {
        0 => -4.0,
        255 => 4.0,
        _ => (f32::from(byte) + 0.5) / 32.0 - 4.0,
    }
}

fn read_chunks(section: &Section<'_>) -> Result<Vec<Chunk>, ParseError> {
    let pair = |name: &str| -> Result<(usize, usize), ParseError> {
        let offset = |end: &str| section.offset(&format!("{end}_{name}"), &ScalarType::Float);
        Ok((offset("min")?, offset("max")?))
    };
    let three =
        |names: [&str; 3]| Ok::<_, ParseError>([pair(names[0])?, pair(names[1])?, pair(names[2])?]);
    let position = three(["x", "y", "z"])?;
    let log_scale = three(["scale_x", "scale_y", "scale_z"])?;
    let has_colors = section.element.properties.contains_key("min_r");
    let color = if has_colors { Some(three(["r", "g", "b"])?) } else { None };
    let read = |row: &[u8], offset: usize| {
        f32s_from_le(&row[offset..offset + 4]).next().map_or(f64::NAN, f64::from)
    };
    let chunk = |index: usize| {
        let row = section.row(index);
        let bounds = |offsets: [(usize, usize); 3]| {
            offsets.map(|(low, high)| (read(row, low), read(row, high)))
        };
        Chunk {
            position: bounds(position),
            log_scale: bounds(log_scale),
            color: color.map_or([(0.0, 1.0); 3], bounds),
        }
    };
    Ok((0..section.element.count).map(chunk).collect())
}

/// The rows of one element.
#[derive(Clone)]
struct Section<'a> {
    element: &'a ElementDef,
    rows: &'a [u8],
    stride: usize,
}

impl<'a> Section<'a> {
    /// All elements of the file; refuses what the compressed form never has.
    fn all(header: &'a Header, bytes: &'a [u8]) -> Result<Vec<Self>, ParseError> {
        let mut body = Body::new(header, bytes);
        if body.byte_order() != Some(ByteOrder::Little) {
            let expected = "binary_little_endian for a compressed file";
            return Err(ParseError::value("format", expected, header.encoding));
        }
        let section = |element: &'a ElementDef| {
            let (_, stride) = fixed_columns(element).ok_or_else(|| {
                let field = format!("element {}", element.name);
                ParseError::value(field, "numbers in a compressed file", "a list")
            })?;
            Ok(Self { element, rows: body.take_rows(element, stride)?, stride })
        };
        header.elements.values().map(section).collect()
    }

    fn row(&self, index: usize) -> &'a [u8] {
        &self.rows[index * self.stride..][..self.stride]
    }

    /// Byte offset of a property in a row; it must have the type.
    fn offset(&self, name: &str, scalar: &ScalarType) -> Result<usize, ParseError> {
        let index = self.element.properties.get_index_of(name);
        let column = index.and_then(|index| fixed_columns(self.element)?.0.into_iter().nth(index));
        let found = match column {
            Some(column) if column.scalar == *scalar => return Ok(column.offset),
            Some(column) => format!("{:?}", column.scalar),
            None => "none".into(),
        };
        let field = format!("{} property {name}", self.element.name);
        Err(ParseError::value(field, format!("{scalar:?}"), found))
    }
}
