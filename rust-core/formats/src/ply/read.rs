//! Splats from a vertex element.
//!
//! Binary rows of fixed length are read in parallel, straight from the mapped file into columns:
//! files of little-endian floats, which is what trainers write, with the offsets known at once;
//! all others through the decoder of [`super::scalar`]. Text, and binary rows with lists in them,
//! have to be read from front to back.
//!
//! The grammar of the header is `ply-rs-bw`'s. Its reader of the body is not used: it makes a call
//! by property name for each number (four times slower than reading the rows in place), refuses
//! `nan` and `inf` in text files, and counts to the end of a hostile element whose rows have no
//! properties. Its writer makes the files of the tests.

use glam::DVec3;
use ply_rs_bw::ply::{ElementDef, Header, ScalarType};
use rayon::prelude::*;
use trapeze_scene::{Features, Scene, SceneError, Splats};

use super::body::Body;
use super::header::required_element;
use super::layout::{Layout, Row};
use super::scalar::{ByteOrder, Column, fits_single_precision, fixed_columns};
use crate::ParseError;
use crate::recentre::{recentre_f32, recentre_f64};
use crate::splat_block::{SplatBlock, zeroed_splats};

/// Reads the splats of a file whose header is parsed.
pub(super) fn read_splats(header: &Header, bytes: &[u8]) -> Result<Scene, ParseError> {
    let vertex = required_element(header, "vertex")?;
    let layout = Layout::of(vertex)?;
    let mut body = Body::new(header, bytes);
    for element in header.elements.values().take_while(|element| element.name != vertex.name) {
        body.skip(element)?;
    }
    body.expect_rows(vertex)?;
    if vertex.count > u32::MAX as usize {
        return Err(SceneError::TooManySplats { found: vertex.count }.into());
    }
    let mut target = Target {
        splats: zeroed_splats(vertex.count, layout.sh_degree)?,
        features: vec![0.0; vertex.count * layout.feature_dimensions()],
    };
    let origin = match (body.byte_order(), fixed_columns(vertex)) {
        (Some(order), Some((columns, stride))) => {
            let rows = body.take_rows(vertex, stride)?;
            target.fill_from_table(&layout, &Table { rows, stride, columns, order })
        }
        _ => target.fill_row_by_row(&layout, vertex, &mut body)?,
    };
    Ok(target.into_scene(&layout, origin))
}

/// What is being filled.
struct Target {
    splats: Splats,
    features: Vec<f32>,
}

/// Binary rows of fixed length.
struct Table<'a> {
    rows: &'a [u8],
    stride: usize,
    columns: Vec<Column>,
    order: ByteOrder,
}

impl Table<'_> {
    fn row(&self, index: usize) -> &[u8] {
        &self.rows[index * self.stride..][..self.stride]
    }

    fn is_little_endian_floats(&self) -> bool {
        self.order == ByteOrder::Little
            && self.columns.iter().all(|column| column.scalar == ScalarType::Float)
    }
}

/// Little-endian floats and nothing else.
struct FloatRow<'a>(&'a [u8]);

impl Row for FloatRow<'_> {
    #[inline]
    fn value(&self, property: usize) -> f32 {
        let b = &self.0[property * 4..property * 4 + 4];
        f32::from_le_bytes([b[0], b[1], b[2], b[3]])
    }
}

/// Numbers of any type and byte order.
struct TypedRow<'a> {
    bytes: &'a [u8],
    table: &'a Table<'a>,
}

impl Row for TypedRow<'_> {
    fn value(&self, property: usize) -> f32 {
        self.table.columns[property].read(self.bytes, self.table.order) as f32
    }
}

/// A row that has been read already.
struct ReadRow<'a>(&'a [f64]);

impl Row for ReadRow<'_> {
    fn value(&self, property: usize) -> f32 {
        self.0[property] as f32
    }
}

impl Target {
    /// Returns the origin.
    fn fill_from_table(&mut self, layout: &Layout, table: &Table<'_>) -> DVec3 {
        let block = SplatBlock::all(&mut self.splats, &mut self.features);
        if table.is_little_endian_floats() {
            fill(block, layout, |index| FloatRow(table.row(index)));
        } else {
            fill(block, layout, |index| TypedRow { bytes: table.row(index), table });
        }
        if layout.positions.iter().all(|&p| fits_single_precision(&table.columns[p].scalar)) {
            return recentre_f32(&mut self.splats.positions);
        }
        let position =
            |index| layout.positions.map(|p| table.columns[p].read(table.row(index), table.order));
        let world: Vec<[f64; 3]> = (0..self.splats.len()).into_par_iter().map(position).collect();
        self.recentre(&world)
    }

    /// Returns the origin.
    fn fill_row_by_row(
        &mut self,
        layout: &Layout,
        vertex: &ElementDef,
        body: &mut Body<'_>,
    ) -> Result<DVec3, ParseError> {
        let mut world = Vec::with_capacity(self.splats.len());
        let mut row = Vec::with_capacity(vertex.properties.len());
        let mut block = SplatBlock::all(&mut self.splats, &mut self.features);
        for index in 0..block.len() {
            body.read_row(vertex, index, &mut row)?;
            layout.store(&ReadRow(&row), &mut block, index);
            world.push(layout.positions.map(|p| row[p]));
        }
        Ok(self.recentre(&world))
    }

    fn recentre(&mut self, world: &[[f64; 3]]) -> DVec3 {
        let (relative, origin) = recentre_f64(world);
        self.splats.positions = relative;
        origin
    }

    fn into_scene(self, layout: &Layout, origin: DVec3) -> Scene {
        let dimensions = layout.feature_dimensions();
        let features = (dimensions > 0).then_some(Features { dimensions, values: self.features });
        Scene { origin, features, ..Scene::from_splats(self.splats) }
    }
}

fn fill<R: Row>(all: SplatBlock<'_>, layout: &Layout, row: impl Fn(usize) -> R + Sync) {
    all.for_each_part(&|mut block| {
        for i in 0..block.len() {
            let row = row(block.first + i);
            layout.store(&row, &mut block, i);
        }
    });
}
