//! Datasets on disk, from the file to the pixel: layouts written by the tests, and captures of
//! other people's tools where TRAPEZE_DATA names a folder with them.

mod cache;
mod colmap_layout;
mod phone_layouts;
mod real_captures;
mod sample_dataset;
mod transforms_layout;
mod written;
