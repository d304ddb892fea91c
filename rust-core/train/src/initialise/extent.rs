//! How large a scene is, from where its cameras stand.

use glam::DVec3;
use trapeze_scene::Camera;

/// Room beyond the outermost camera (Kerbl et al. 2023, after NeRF++).
const MARGIN: f64 = 1.1;

/// The unit of the learning rate of positions: 1.1 times the largest distance of a camera from the
/// middle of all; 1 where all cameras stand in one place.
#[must_use]
pub fn scene_extent(cameras: &[Camera]) -> f64 {
    let radius = camera_spread(&centres(cameras)).1;
    if radius > 0.0 { MARGIN * radius } else { 1.0 }
}

pub(super) fn centres(cameras: &[Camera]) -> Vec<DVec3> {
    cameras.iter().map(Camera::centre).collect()
}

/// Mean of the points, and the largest distance from it; zero without points.
pub(super) fn camera_spread(centres: &[DVec3]) -> (DVec3, f64) {
    let mean = centres.iter().sum::<DVec3>() / centres.len().max(1) as f64;
    (mean, centres.iter().map(|centre| centre.distance(mean)).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extent_is_that_of_the_cameras() {
        let at = |x: f64| Camera::look_at(DVec3::X * x, DVec3::ZERO, DVec3::Y, 0.8, (4, 4));
        assert!((scene_extent(&[at(1.0), at(5.0)]) - 2.2).abs() < 1e-12);
        assert_eq!(scene_extent(&[at(3.0)]), 1.0);
        assert_eq!(scene_extent(&[]), 1.0);
    }
}
