//! Every reader and writer. The only crate that parses bytes.

mod atomic_write;
mod bytes;
mod error;
mod open;
pub mod ply;
mod quantised;
mod recentre;
mod splat_block;
pub mod splat_file;

pub use atomic_write::write_atomically;
pub use error::{ParseError, ReadError, WriteError};
