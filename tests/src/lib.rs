//! What the cross-crate tests share: scenes made by hand, networks with chosen outputs, and the
//! comparison of an image with the f64 reference.
//!
//! The tests themselves are in `tests/`, one file or folder per topic.

mod compare;
mod conditioning;
mod gpu;
mod gradients;
mod image;
mod levels;
mod networks;
mod random;
mod scenes;

pub use compare::{Comparison, MARGIN, TOLERANCE, compare};
pub use conditioning::rounding_bound;
pub use gpu::{gpu, render_gpu};
pub use gradients::{
    GRADIENT_TOLERANCE, assert_finite_gradients, assert_gradients_agree, assert_gradients_follow,
    cpu_gradients, gpu_gradients, gradient_weights, gradients,
};
pub use image::{
    assert_agrees, assert_agrees_within, assert_close_color, assert_finite, assert_same_color,
    everything, largest_difference, render, render_crop,
};
pub use levels::{available_levels, on_threads};
pub use networks::{HeadBiases, constant_network, sliding_network};
pub use random::Random;
pub use scenes::{Splat, camera_at_origin, cloud, cloud_camera, scene_of};
