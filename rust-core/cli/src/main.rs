//! The `trapeze` program: it reads arguments, calls the library crates and writes what they return.
//!
//! Figures go to standard output (as JSON with `--json`), everything else to standard error. The
//! exit code is 0 only on success; an error is one line.

mod commands;
mod dataset_input;
mod error;
mod measure;
mod output;
mod report;
mod scene_input;
mod search;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use tracing_subscriber::EnvFilter;

use commands::Command;

/// Train, play, select and search 3D and 4D Gaussian-splat scenes.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_env_filter(
            EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("warn")),
        )
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .without_time()
        .with_target(false)
        .init();
    match Arguments::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // One line, whatever the parts of the message hold.
            eprintln!("error: {}", error.to_string().replace('\n', " "));
            ExitCode::FAILURE
        }
    }
}
