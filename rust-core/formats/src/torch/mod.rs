//! PyTorch checkpoints (`torch.save` since 1.6): a zip archive of a pickle and raw storages.
//!
//! Unpickling in Python can run any code. Here a pickle is only *read*: [`pickle`] is a virtual
//! machine for the opcodes that tensors in dictionaries use, it knows a fixed list of globals
//! ([`globals`]) and refuses everything else by name. What comes out are [`tensor::StoredTensor`]s,
//! views of storages whose bounds are checked before a number is read.

mod archive;
mod globals;
mod machine;
mod network;
mod opcodes;
mod tensor;

mod clusters;

pub use clusters::{parse_clusters_pt, read_clusters_pt};
pub use network::{parse_deform_pth, read_deform_pth};

/// Longest checkpoint that is read, and most bytes that its storages may decode to.
const MAX_CHECKPOINT_BYTES: u64 = 2 << 30;
