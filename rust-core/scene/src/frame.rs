//! What a renderer is asked for, and what it answers: the contract of every backend.

use glam::DVec3;

use crate::{Bounds, Camera, Selection, ShDegree};

/// Where a splat's colour comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ColorSource {
    /// max(0, 0.5 + SH(direction)): the trained colour.
    #[default]
    SphericalHarmonics,
    /// The display colour of the splat's cluster; grey without clusters.
    Clusters,
    /// A heat map of the motion values, black at 0 and white at the scene's 99th percentile.
    Motion,
    /// A grey by the depth of the splat's centre: see [`depth_grey`].
    Depth(DepthRange),
}

/// Depths along the view axis that are told apart, world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// What is here or nearer is white.
    pub near: f32,
    /// What is here or farther is black.
    pub far: f32,
}

impl DepthRange {
    /// The depths of a box, in front of the camera. Both are in the camera's coordinates, or both
    /// relative to the scene's origin.
    #[must_use]
    pub fn of(bounds: &Bounds, camera: &Camera) -> Self {
        let depth = |corner: DVec3| camera.world_to_camera.transform_point3(corner).z;
        let depths = bounds.corners().map(depth);
        Self {
            near: depths.iter().copied().fold(f64::INFINITY, f64::min).max(0.0) as f32,
            far: depths.iter().copied().fold(0.0, f64::max) as f32,
        }
    }

    /// What one unit of depth takes off the grey; 0 for a range without an extent.
    #[must_use]
    pub fn slope(&self) -> f32 {
        let extent = self.far - self.near;
        if extent > 0.0 && extent.is_finite() { 1.0 / extent } else { 0.0 }
    }
}

/// 1 at the near end of a range, 0 at its far end, linear in between.
#[must_use]
pub fn depth_grey(depth: f32, range: DepthRange) -> f32 {
    let grey = 1.0 - (depth - range.near) * range.slope();
    // Also takes what is not a number to 0.
    grey.max(0.0).min(1.0)
}

/// One frame's request. Everything may change from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSettings {
    /// Time for the deformation network; any number. NaN is taken as 0.
    pub time: f32,
    /// Splats whose motion value is at most this hold their state at t = 0; `None` evaluates the
    /// network for every splat.
    pub static_threshold: Option<f32>,
    /// Highest SH degree to evaluate, when lower than the scene's.
    pub max_sh_degree: ShDegree,
    /// Which clusters are drawn.
    pub selection: Selection,
    /// Where colour comes from.
    pub color_source: ColorSource,
    /// Whether expected and median depth are wanted.
    pub depth: bool,
    /// Whether the top contributor of each pixel is wanted.
    pub top_contributor: bool,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            time: 0.0,
            static_threshold: None,
            max_sh_degree: ShDegree::Three,
            selection: Selection::All,
            color_source: ColorSource::SphericalHarmonics,
            depth: false,
            top_contributor: false,
        }
    }
}

/// No splat contributes to this pixel.
pub const NO_SPLAT: u32 = u32::MAX;

/// A rendered image, rows top to bottom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Premultiplied r g b over black, then alpha = 1 − T; display space, as trained.
    pub color: Vec<[f32; 4]>,
    /// Σ w z / Σ w, world units along the view axis; NaN where nothing was hit. Empty unless asked for.
    pub expected_depth: Vec<f32>,
    /// z of the splat at which transmittance first falls to ≤ 0.5; NaN where it never does. Empty
    /// unless asked for.
    pub median_depth: Vec<f32>,
    /// Index of the splat with the largest α·T, the first in order on ties; [`NO_SPLAT`] where
    /// nothing was hit. Empty unless asked for.
    pub top_contributor: Vec<u32>,
}

impl Frame {
    /// r g b over a constant background, and alpha.
    #[must_use]
    pub fn over(&self, background: [f32; 3]) -> Vec<[f32; 4]> {
        self.color
            .iter()
            .map(|&[r, g, b, a]| {
                let t = 1.0 - a;
                [r + t * background[0], g + t * background[1], b + t * background[2], a]
            })
            .collect()
    }
}

/// Display colour of a motion value that has been divided by the scene's reference value:
/// black, purple, orange, white (a four-point approximation of Matplotlib's *inferno*).
#[must_use]
pub fn motion_heat(relative: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 4] =
        [[0.0, 0.0, 0.0], [0.47, 0.11, 0.43], [0.93, 0.41, 0.15], [0.99, 1.0, 0.64]];
    let x = if relative.is_nan() { 1.0 } else { relative.clamp(0.0, 1.0) } * 3.0;
    let i = (x as usize).min(2);
    let f = x - i as f32;
    std::array::from_fn(|c| STOPS[i][c] + f * (STOPS[i + 1][c] - STOPS[i][c]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_go_from_white_to_black_over_the_range() {
        let range = DepthRange { near: 2.0, far: 4.0 };
        for (depth, grey) in [(1.0, 1.0), (2.0, 1.0), (2.5, 0.75), (4.0, 0.0), (1e30, 0.0)] {
            assert_eq!(depth_grey(depth, range), grey);
        }
        for near in [4.0, 5.0, f32::NAN] {
            assert!((0.0..=1.0).contains(&depth_grey(3.0, DepthRange { near, far: 4.0 })));
        }
    }

    #[test]
    fn the_depths_of_a_box_are_those_in_front_of_the_camera() {
        let bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::new(1.0, 1.0, 3.0) };
        let camera = |eye: f64| {
            let eye = DVec3::new(0.0, 0.0, eye);
            Camera::look_at(eye, eye + DVec3::Z, DVec3::NEG_Y, 0.8, (8, 6))
        };
        let range = DepthRange::of(&bounds, &camera(-5.0));
        assert!((range.near - 4.0).abs() < 1e-6 && (range.far - 8.0).abs() < 1e-6, "{range:?}");
        let inside = DepthRange::of(&bounds, &camera(1.0));
        assert!(inside.near == 0.0 && (inside.far - 2.0).abs() < 1e-6, "{inside:?}");
        let behind = DepthRange::of(&bounds, &camera(9.0));
        assert_eq!((behind.near, behind.far, behind.slope()), (0.0, 0.0, 0.0));
    }

    #[test]
    fn background_shows_through_what_alpha_leaves() {
        let frame = Frame {
            width: 2,
            height: 1,
            color: vec![[0.2, 0.0, 0.0, 0.5], [0.0; 4]],
            ..Frame::default()
        };
        assert_eq!(frame.over([1.0; 3]), [[0.7, 0.5, 0.5, 0.5], [1.0, 1.0, 1.0, 0.0]]);
    }

    #[test]
    fn heat_grows_brighter_and_takes_any_number() {
        let brightness = |x: f32| motion_heat(x).iter().sum::<f32>();
        for i in 0..100 {
            assert!(brightness(i as f32 / 100.0) < brightness((i + 1) as f32 / 100.0));
        }
        assert_eq!(motion_heat(f32::NAN), motion_heat(1.0));
        assert_eq!(motion_heat(f32::INFINITY), motion_heat(1.0));
        assert_eq!(motion_heat(-1.0), [0.0; 3]);
    }
}
