//! Cutting an image into regions whose tile entries fit into the entry buffers.

use crate::layout::Region;

/// Width and height of a tile, pixels.
pub(crate) const TILE: u32 = 16;

/// A rectangle of tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileRect {
    pub first: [u32; 2],
    pub tiles: [u32; 2],
}

impl TileRect {
    pub(crate) fn count(self) -> u32 {
        self.tiles[0] * self.tiles[1]
    }
}

/// Tiles across and down of an image.
pub(crate) fn image_tiles([width, height]: [u32; 2]) -> [u32; 2] {
    [width.div_ceil(TILE), height.div_ceil(TILE)]
}

/// Cuts an image into at least `pieces` regions of about equal size, whole rows of tiles as long
/// as there are enough of them, each of at most `max_rows` rows.
pub(crate) fn cut(image: [u32; 2], pieces: u32, max_rows: u32) -> Vec<TileRect> {
    let [across, down] = image_tiles(image);
    let row_pieces = pieces.max(down.div_ceil(max_rows)).min(down);
    let column_pieces = pieces.div_ceil(row_pieces).min(across);
    let mut regions = Vec::with_capacity((row_pieces * column_pieces) as usize);
    for r in 0..row_pieces {
        let (y, y_end) = (share(down, r, row_pieces), share(down, r + 1, row_pieces));
        for c in 0..column_pieces {
            let (x, x_end) = (share(across, c, column_pieces), share(across, c + 1, column_pieces));
            regions.push(TileRect { first: [x, y], tiles: [x_end - x, y_end - y] });
        }
    }
    regions
}

fn share(total: u32, i: u32, pieces: u32) -> u32 {
    (u64::from(total) * u64::from(i) / u64::from(pieces)) as u32
}

/// The uniform block of a region that is stored from its first row of tiles on.
pub(crate) fn uniform(
    rect: TileRect,
    image: [u32; 2],
    output_origin: [u32; 2],
    output_stride: u32,
    capacity: u32,
    sort_keys_per_thread: u32,
) -> Region {
    Region {
        first_tile: rect.first,
        tiles: rect.tiles,
        image,
        output_origin,
        output_stride,
        capacity,
        sort_keys_per_thread,
        halts: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_covers(image: [u32; 2], pieces: u32, max_rows: u32) -> usize {
        let regions = cut(image, pieces, max_rows);
        let [across, down] = image_tiles(image);
        let mut seen = vec![0; (across * down) as usize];
        for region in &regions {
            assert!(region.count() > 0 && region.tiles[1] <= max_rows, "{region:?}");
            for y in region.first[1]..region.first[1] + region.tiles[1] {
                for x in region.first[0]..region.first[0] + region.tiles[0] {
                    seen[(y * across + x) as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|&n| n == 1), "{image:?} {pieces} {max_rows}");
        regions.len()
    }

    #[test]
    fn every_tile_is_in_one_region() {
        for image in [[1, 1], [16, 16], [17, 3], [640, 480], [1920, 1080], [7680, 4320]] {
            for pieces in [1, 2, 3, 7, 64, 1000] {
                for max_rows in [1, 5, 1024] {
                    let count = assert_covers(image, pieces, max_rows);
                    let [across, down] = image_tiles(image);
                    assert!(count as u32 >= pieces.min(across * down));
                }
            }
        }
    }

    #[test]
    fn a_frame_that_fits_is_one_region() {
        let whole = TileRect { first: [0, 0], tiles: [120, 68] };
        assert_eq!(cut([1920, 1080], 1, 1024), [whole]);
    }
}
