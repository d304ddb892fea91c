//! The stability suite: every hard case that needs no training, on the CPU and, through the same
//! comparison with the reference, on the GPU (software Vulkan where there is no other).
//!
//! Each test checks three things: nothing in the image is NaN or infinite (depth: NaN exactly
//! where nothing was hit), the behaviour that is stated for the case, and agreement with the f64
//! reference. The modules are numbered as the cases are in `docs/numerics.md`.

mod case_01_near_plane;
mod case_02_shapes;
mod case_03_rotations;
mod case_04_opacity;
mod case_05_far_from_the_origin;
mod case_06_order;
mod case_07_sizes;
mod case_08_scales;
mod case_09_time;
mod case_10_colour;
mod case_11_empty_views;
