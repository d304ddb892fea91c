//! Progress of long work, on a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar over `length` steps on standard error; invisible where that is not a terminal.
pub(crate) fn progress_bar(length: u64, what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:12} {wide_bar} {pos}/{len} {eta}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style).with_message(what)
}
