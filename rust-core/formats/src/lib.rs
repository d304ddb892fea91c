//! Every reader and writer. The only crate that parses bytes.

mod atomic_write;
mod bytes;
mod error;

pub use atomic_write::write_atomically;
pub use error::{ParseError, ReadError, WriteError};
