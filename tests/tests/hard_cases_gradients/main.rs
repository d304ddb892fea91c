//! The hard cases for gradients: finite everywhere, the stated zero or limit, and the f64
//! specification within rounding. Cases carry the numbers of those for images.

mod case_01_near_plane;
mod case_02_shapes;
mod case_03_rotations;
mod case_04_opacity;
mod case_05_far_from_the_origin;
mod case_07_sizes;
mod case_08_scales;
mod case_09_time;
mod case_10_colour;
mod case_11_poison;
