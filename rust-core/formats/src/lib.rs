//! Every reader and writer. The only crate that parses bytes.
//!
//! Every input is hostile until it is parsed. A parser works on a byte slice, returns a
//! [`ParseError`] that names field and expectation, and allocates nothing for a count that the
//! bytes left over cannot fill; the functions that take a path add its name ([`ReadError`]) and
//! bound what they read. Nothing here panics on any input. Writers go through
//! [`write_atomically`]: the old file or the new one, never half of either.
//!
//! [`load_scene`] and [`save_scene`] find the format by themselves; each format's own functions are
//! public beside them.

mod atomic_write;
mod bytes;
mod camera_json;
mod cluster_names;
mod clusters_bin;
pub mod dataset;
mod decompression;
mod error;
mod json;
mod load;
mod mask;
mod npy;
mod npz;
mod open;
pub mod ply;
mod quantised;
mod recentre;
mod regular_file;
mod save;
mod scene_path;
pub mod sog;
mod splat_block;
pub mod splat_file;
pub mod spz;
mod torch;
mod weights_bin;
mod zip_members;

pub use atomic_write::write_atomically;
pub use camera_json::{
    View, parse_camera, parse_views, read_camera, read_views, write_camera, write_views,
};
pub use cluster_names::{
    ClusterNames, apply_cluster_names, parse_cluster_names, read_cluster_names, write_cluster_names,
};
pub use clusters_bin::{parse_clusters_bin, read_clusters_bin, write_clusters_bin};
pub use error::{ParseError, ReadError, WriteError};
pub use load::{LoadPart, load_scene, load_scene_with};
pub use mask::{
    MaskSettings, parse_mask_bin, parse_mask_json, read_mask_bin, read_mask_json, write_mask_bin,
    write_mask_json,
};
pub use npy::{NpyArray, NpyValues, parse_npy, read_npy, write_npy};
pub use npz::{parse_npz, read_npz};
pub use save::{save_scene, save_scene_folder};
pub use scene_path::SplatFormat;
pub use torch::{parse_clusters_pt, parse_deform_pth, read_clusters_pt, read_deform_pth};
pub use weights_bin::{WEIGHTS_BIN_BYTES, parse_weights_bin, read_weights_bin, write_weights_bin};
