// The part of the image that binning and blending work on: a frame whose tile entries do not fit
// into one buffer is drawn in several regions, and a picked pixel is a region of one tile.

/// Width and height of a tile, pixels.
const TILE: u32 = 16u;

struct Region {
    /// First tile.
    first_tile: vec2<u32>,
    /// Tiles across and down.
    tiles: vec2<u32>,
    /// Width and height of the image, pixels.
    image: vec2<u32>,
    /// The pixel that is stored at the start of the output.
    output_origin: vec2<u32>,
    /// Pixels per row of the output.
    output_stride: u32,
    /// Entries that the entry buffers hold.
    capacity: u32,
    /// Keys per thread of the entries' sort.
    sort_keys_per_thread: u32,
    /// Whether a frame that does not fit stops those after it (training).
    halts: u32,
}
