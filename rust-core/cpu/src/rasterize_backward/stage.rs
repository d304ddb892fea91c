//! The backward pass of all tiles of a frame.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;
use trapeze_scene::Frame;

use super::sums::{LANES, SplatSums};
use super::tile::{BandPixels, TileMemory, backward_tile};
use crate::bin::{BandEntry, BandLists, BandTiles, TileSize};
use crate::gradient::ImageGradient;
use crate::project::ProjectedSplat;
use crate::rasterize::TileRect;

/// A frame and how it was rasterised, with ∂L/∂frame.
#[derive(Clone, Copy, Debug)]
pub struct BackwardInput<'a> {
    /// Splats in drawing order.
    pub splats: &'a [ProjectedSplat],
    /// Their bands.
    pub bands: &'a BandLists,
    /// What [`rasterize`](crate::rasterize::rasterize()) made of them.
    pub frame: &'a Frame,
    /// What the loss says about it.
    pub gradient: ImageGradient<'a>,
    /// Tile size.
    pub tile: TileSize,
    /// SIMD level.
    pub level: Level,
}

/// Working memory, reused from frame to frame.
#[derive(Debug, Default)]
pub struct BackwardMemory {
    /// The lanes of the splats of every band.
    bands: Vec<Vec<[f32; LANES]>>,
    /// The lanes of every splat.
    splats: Vec<[f32; LANES]>,
    sums: Vec<SplatSums>,
}

/// Working memory of one task.
#[derive(Default)]
struct Scratch {
    entries: Vec<BandEntry>,
    tiles: BandTiles,
    tile: TileMemory,
}

/// The sums of every splat, in drawing order.
///
/// # Panics
/// When the gradient has another number of pixels than the frame, or asks for depth that the frame
/// does not have.
#[must_use]
pub fn rasterize_backward<'a>(
    input: &BackwardInput<'_>,
    memory: &'a mut BackwardMemory,
) -> &'a [SplatSums] {
    let BackwardInput { frame, gradient, .. } = input;
    assert!(gradient.fits(frame.color.len()), "one gradient per pixel");
    if gradient.expected_depth.is_some() {
        assert_eq!(frame.expected_depth.len(), frame.color.len(), "a frame with depth");
    }
    let count = frame.height.div_ceil(input.tile.height()) as usize;
    memory.bands.resize_with(count, Vec::new);
    let bands = memory.bands.par_iter_mut().enumerate();
    bands.for_each_init(Scratch::default, |scratch, (band, sums)| {
        sum_band(input, band, scratch, sums);
    });
    memory.splats.resize(input.splats.len(), [0.0; LANES]);
    memory.sums.resize(input.splats.len(), SplatSums::default());
    input.bands.sum_by_rank(memory);
    &memory.sums
}

fn sum_band(
    input: &BackwardInput<'_>,
    band: usize,
    Scratch { entries, tiles, tile: memory }: &mut Scratch,
    sums: &mut Vec<[f32; LANES]>,
) {
    let size = input.tile;
    let y = band as u32 * size.height();
    let height = size.height().min(input.frame.height - y);
    let pixels = band_pixels(input.frame, &input.gradient, (y as usize, height as usize));
    entries.clear();
    entries.extend(input.bands.band(band));
    tiles.fill_positions(entries, input.frame.width, size);
    sums.clear();
    sums.resize(entries.len(), [0.0; LANES]);
    for (positions, x) in tiles.lists().zip((0..).step_by(size.width() as usize)) {
        let tile = TileRect { x, y, width: size.width(), height };
        let list = (&entries[..], positions);
        dispatch!(input.level, simd => if pixels.by_depth.is_empty() {
            backward_tile::<_, false>(simd, input.splats, list, tile, memory, &pixels, sums);
        } else {
            backward_tile::<_, true>(simd, input.splats, list, tile, memory, &pixels, sums);
        });
    }
}

/// The rows of a band; arrays that are not there give empty slices.
fn band_pixels<'a>(
    frame: &'a Frame,
    gradient: &ImageGradient<'a>,
    (y, height): (usize, usize),
) -> BandPixels<'a> {
    let width = frame.width as usize;
    let rows = y * width..(y + height) * width;
    BandPixels {
        width,
        color: &frame.color[rows.clone()],
        depth: frame.expected_depth.get(rows.clone()).unwrap_or_default(),
        by_color: &gradient.color[rows.clone()],
        by_depth: gradient.expected_depth.map_or(&[], |depth| &depth[rows]),
    }
}

impl BandLists {
    /// Adds up what every splat got in each band, band by band, in drawing order.
    fn sum_by_rank(&self, memory: &mut BackwardMemory) {
        let BackwardMemory { bands, splats, sums } = memory;
        // Chunks own disjoint runs of ranks; within a band they follow each other.
        let mut starts = vec![0; bands.len()];
        let mut tasks = Vec::new();
        let chunks = splats.chunks_mut(Self::CHUNK).zip(sums.chunks_mut(Self::CHUNK));
        for (chunk, (lanes, sums)) in chunks.enumerate() {
            tasks.push((chunk, lanes, sums, starts.clone()));
            for (start, entries) in starts.iter_mut().zip(self.chunk(chunk)) {
                *start += entries.len();
            }
        }
        tasks.into_par_iter().for_each(|(chunk, lanes, sums, starts)| {
            lanes.fill([0.0; LANES]);
            for ((entries, found), start) in self.chunk(chunk).iter().zip(&*bands).zip(starts) {
                for (entry, found) in entries.iter().zip(&found[start..]) {
                    let lanes = &mut lanes[entry.rank as usize - chunk * Self::CHUNK];
                    for (total, sum) in lanes.iter_mut().zip(found) {
                        *total += sum;
                    }
                }
            }
            for (sums, lanes) in sums.iter_mut().zip(lanes) {
                *sums = SplatSums::from_lanes(lanes);
            }
        });
    }
}
