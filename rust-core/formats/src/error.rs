//! Errors of reading and writing: one line that names the file, the field and what was expected.

use std::path::{Path, PathBuf};

use thiserror::Error;
use trapeze_scene::{ArchitectureError, SceneError};

/// Why bytes were refused, without the name of the file that held them.
///
/// Parsers work on byte slices and know no path; [`ReadError`] adds it at the crate's border.
#[derive(Debug, Error)]
pub enum ParseError {
    /// The data ends before a field does.
    #[error("{field}: expected {expected} bytes, found {found} (file truncated?)")]
    Truncated {
        /// What was being read.
        field: String,
        /// Bytes that it needs.
        expected: u64,
        /// Bytes that are left.
        found: u64,
    },
    /// A field holds a value that the format or this program does not allow.
    #[error("{field}: expected {expected}, found {found}")]
    Value {
        /// Name of the field.
        field: String,
        /// What would have been accepted.
        expected: String,
        /// What was there, shortened to be printable on one line.
        found: String,
    },
    /// A JSON value is missing or of another type than its field.
    #[error("{field}: {message}")]
    Json {
        /// Path of the field in the document, such as `[3].camera.fx`.
        field: String,
        /// What was expected and found, and the line.
        message: String,
    },
    /// The parts of the file do not describe one scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The tensors are not a known network.
    #[error(transparent)]
    Architecture(#[from] ArchitectureError),
    /// There is no memory for what the file holds.
    #[error("{field}: {bytes} bytes are needed, the system has not that many")]
    OutOfMemory {
        /// What it is for.
        field: String,
        /// Bytes that it takes.
        bytes: u64,
    },
    /// The operating system failed to deliver the data.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

impl ParseError {
    /// A value that is not what the field allows. Control characters and lengths are tamed, so
    /// that the message stays one short line whatever the file holds: names of fields may come
    /// from the file as well.
    pub fn value(
        field: impl Into<String>,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::Value {
            field: printable(field.into(), 100),
            expected: expected.into(),
            found: printable(found, 60),
        }
    }

    /// A JSON field that does not hold what it should, with the parser's own words.
    pub(crate) fn json(field: impl std::fmt::Display, message: impl std::fmt::Display) -> Self {
        Self::Json { field: printable(field, 60), message: printable(message, 120) }
    }

    /// The same error of a field inside `part`, such as `frames[3]`.
    pub(crate) fn within(mut self, part: &str) -> Self {
        if let Self::Truncated { field, .. }
        | Self::Value { field, .. }
        | Self::Json { field, .. } = &mut self
        {
            *field = printable(format!("{part}.{field}"), 120);
        }
        self
    }
}

/// At most `limit` characters of `text`, control characters replaced.
pub(crate) fn printable(text: impl std::fmt::Display, limit: usize) -> String {
    let text = text.to_string();
    let mut short: String =
        text.chars().take(limit).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(limit).is_some() {
        short.push('…');
    }
    short
}

/// Why a file could not be read.
#[derive(Debug, Error)]
#[error("{}: {source}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What was wrong with it.
    #[source]
    pub source: ParseError,
}

impl ReadError {
    /// Names the file that a parse error belongs to.
    pub fn new(path: impl Into<PathBuf>, source: impl Into<ParseError>) -> Self {
        Self { path: path.into(), source: source.into() }
    }
}

/// Adds the path to a parse error.
pub(crate) trait InFile<T> {
    fn in_file(self, path: &Path) -> Result<T, ReadError>;
}

impl<T, E: Into<ParseError>> InFile<T> for Result<T, E> {
    fn in_file(self, path: &Path) -> Result<T, ReadError> {
        self.map_err(|error| ReadError::new(path, error))
    }
}

/// Why a file could not be written. The file that was there before is untouched.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        #[source]
        source: std::io::Error,
    },
    /// The format cannot hold this scene.
    #[error("{}: {what}: expected {expected}, found {found}", path.display())]
    Unrepresentable {
        /// The file.
        path: PathBuf,
        /// The part that does not fit.
        what: String,
        /// What the format can hold.
        expected: String,
        /// What the scene has.
        found: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_stays_one_short_line_whatever_the_file_holds() {
        let error = ParseError::value("magic", "\"ply\"", "a\nb\u{1b}[31m".repeat(100));
        let message = ReadError::new("scene.ply", error).to_string();
        assert!(message.starts_with("scene.ply: magic: expected \"ply\", found "), "{message}");
        assert!(!message.contains(['\n', '\u{1b}']) && message.chars().count() < 150, "{message}");
        let message = ParseError::value("a\nname".repeat(100), "text", 1).to_string();
        assert!(!message.contains('\n') && message.chars().count() < 150, "{message}");
    }
}
