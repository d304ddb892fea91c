//! Every reader and writer. The only crate that parses bytes.

mod atomic_write;
mod bytes;
mod error;
mod open;
mod quantised;
mod recentre;
mod splat_block;

pub use atomic_write::write_atomically;
pub use error::{ParseError, ReadError, WriteError};
