//! PlayCanvas's compressed PLY: 16 bytes per splat, bounds per chunk of 256 splats.
//!
//! | element | per | properties |
//! |---|---|---|
//! | `chunk` | 256 splats | float `min_x` … `max_z`, `min_scale_x` … `max_scale_z` (log-scales), `min_r` … `max_b` (display colour; absent in older files: 0 and 1) |
//! | `vertex` | splat | uint `packed_position` and `packed_scale` (11-10-11 bits between the chunk's bounds), `packed_rotation` (2-10-10-10: the index of the largest component and the others), `packed_color` (8-8-8-8; the colour between the chunk's bounds, the opacity itself) |
//! | `sh`, optional | splat | uchar `f_rest_*`, channel-major, −4 to 4 |
//!
//! Source: PlayCanvas's `splat-transform`.

mod pack;
mod read;
mod write;

pub(super) use read::{is_compressed, read_compressed};
pub use write::{encode_compressed_ply, write_compressed_ply};

/// Splats that share their bounds.
const CHUNK: usize = 256;
