//! Why a model cannot be used.

use std::path::PathBuf;

use thiserror::Error;

/// A runtime, a model or a text that cannot be used. Each message is one line.
#[derive(Debug, Error)]
pub enum ModelError {
    /// ONNX Runtime is not on this machine.
    #[error(
        "ONNX Runtime: expected its library at ORT_DYLIB_PATH, beside the program, in {} or in Python's \
         onnxruntime, found none; scripts/fetch-onnxruntime gets it", cache.display()
    )]
    RuntimeMissing {
        /// Folder that the script fills.
        cache: PathBuf,
    },
    /// A library was found and cannot be used.
    #[error("{}: ONNX Runtime: {reason}", path.display())]
    RuntimeUnusable {
        /// The library.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file of the model folder cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file holds something else than it should.
    #[error("{}: {field}: expected {expected}, found {found}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        field: String,
        /// What it should be.
        expected: String,
        /// What it is, shortened.
        found: String,
    },
    /// The runtime refuses a tower.
    #[error("{}: {reason}", path.display())]
    Tower {
        /// The ONNX file.
        path: PathBuf,
        /// Why, on one line.
        reason: String,
    },
    /// A text has more tokens than the model reads.
    #[error("text: expected at most {expected} tokens with its template, found {found}")]
    TextTooLong {
        /// Tokens that fit.
        expected: usize,
        /// Tokens that it has.
        found: usize,
    },
}

impl ModelError {
    pub(super) fn value(
        path: impl Into<PathBuf>,
        field: impl Into<String>,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::Value {
            path: path.into(),
            field: one_line(field.into(), 80),
            expected: expected.into(),
            found: one_line(found, 80),
        }
    }

    pub(super) fn tower(path: impl Into<PathBuf>, reason: impl std::fmt::Display) -> Self {
        Self::Tower { path: path.into(), reason: one_line(reason, 200) }
    }
}

/// Text that a file or library gave, as part of a one-line message.
pub(crate) fn one_line(text: impl std::fmt::Display, limit: usize) -> String {
    let text = text.to_string();
    let mut line: String =
        text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(limit).collect();
    if text.chars().nth(limit).is_some() {
        line.push('…');
    }
    line
}
