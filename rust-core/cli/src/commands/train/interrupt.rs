//! Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a shell reports for a program that Ctrl-C ended.
const EXIT_CODE: i32 = 130;

/// Whether the user, or the system, asked the program to stop.
pub(super) struct Interrupt {
    asked: Arc<AtomicBool>,
}

impl Interrupt {
    /// From here on the first Ctrl-C (or SIGTERM) asks, and a second one ends the program at once,
    /// which loses nothing but the steps since the last checkpoint.
    pub(super) fn listen() -> Self {
        let asked = Arc::new(AtomicBool::new(false));
        let for_handler = Arc::clone(&asked);
        let result = ctrlc::set_handler(move || {
            if for_handler.swap(true, Ordering::Relaxed) {
                std::process::exit(EXIT_CODE);
            }
        });
        if let Err(error) = result {
            tracing::warn!("Ctrl-C will not save: {error}");
        }
        Self { asked }
    }

    pub(super) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }
}
