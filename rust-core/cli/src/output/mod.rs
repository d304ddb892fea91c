//! Images, JSON and progress.

mod animation;
mod image_file;
mod json;
mod progress;

pub(crate) use animation::write_animation;
pub(crate) use image_file::write_png;
pub(crate) use json::{print_json, print_line};
pub(crate) use progress::progress_bar;
