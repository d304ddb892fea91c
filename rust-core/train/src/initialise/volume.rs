//! Where to put splats when nothing but the cameras is known.

use glam::{DMat3, DVec3};
use trapeze_scene::{Bounds, Camera};

use super::extent::{camera_spread, centres};
use crate::random::{Purpose, Stream};

/// Axes that are all within about 6° of one another meet nowhere in particular: the smallest
/// eigenvalue of the mean of 1 − ddᵀ is then sin² of that angle or less.
const LEAST_SPREAD: f64 = 0.01;
/// How far a scene is taken to be, in units of the spread of cameras that look the same way: the
/// parallax over the capture is then a few degrees, as in hand-held forward-facing captures.
const FORWARD_DISTANCE: f64 = 10.0;

/// The cube that the cameras look at. `None` without cameras.
///
/// * Cameras around a scene: the middle is the point nearest to all optical axes (least squares),
///   the size what an average camera sees at that distance.
/// * Cameras that look the same way: the middle is in front of them, at ten times their spread.
/// * Cameras that look outwards, or a single one without a distance: a cube around them all.
#[must_use]
pub fn viewed_volume(cameras: &[Camera]) -> Option<Bounds> {
    if cameras.is_empty() {
        return None;
    }
    let centres = centres(cameras);
    let (mean, spread) = camera_spread(&centres);
    let unit = if spread > 0.0 { spread } else { 1.0 };
    let forward: Vec<DVec3> = cameras.iter().map(forward).collect();
    let ahead = forward.iter().sum::<DVec3>() / forward.len() as f64;
    let focus = match common_point(&centres, &forward) {
        Some(point) => point,
        // Nearly parallel axes have a mean direction of nearly unit length.
        None => mean + ahead.normalize_or(DVec3::Z) * (FORWARD_DISTANCE * unit),
    };
    let in_front = centres.iter().zip(&forward).filter(|(c, f)| (focus - **c).dot(**f) > 0.0);
    if 2 * in_front.count() <= cameras.len() {
        return Some(cube(mean, 2.0 * unit));
    }
    let seen = |(camera, centre): (&Camera, &DVec3)| centre.distance(focus) * half_view(camera);
    let total: f64 = cameras.iter().zip(&centres).map(seen).sum();
    Some(cube(focus, total / cameras.len() as f64))
}

/// `count` points evenly distributed in `bounds`, with random colours, drawn from the stream of
/// [`Purpose::Initialisation`].
#[must_use]
pub fn random_points(bounds: &Bounds, count: u32, seed: u64) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let stream = Stream::new(seed, Purpose::Initialisation, 0);
    (0..count)
        .map(|i| {
            let [x, y, z, r] = stream.uniforms(i);
            let [g, b, ..] = stream.more_words(i, 1).map(crate::random::uniform);
            let at = DVec3::new(x.into(), y.into(), z.into());
            let position = bounds.min + at * (bounds.max - bounds.min);
            (position.as_vec3().to_array(), [r, g, b])
        })
        .unzip()
}

/// The direction of the optical axis in the world, of unit length.
fn forward(camera: &Camera) -> DVec3 {
    camera.rotation().transpose().z_axis.normalize_or(DVec3::Z)
}

/// Tangent of half the narrower field of view.
fn half_view(camera: &Camera) -> f64 {
    let x = f64::from(camera.width) / (2.0 * camera.fx);
    let y = f64::from(camera.height) / (2.0 * camera.fy);
    x.min(y)
}

/// The point with the least sum of squared distances to the lines; `None` when they are so nearly
/// parallel that it is anywhere.
fn common_point(origins: &[DVec3], directions: &[DVec3]) -> Option<DVec3> {
    let n = origins.len() as f64;
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (&origin, &d) in origins.iter().zip(directions) {
        let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        matrix += across * (1.0 / n);
        right += across * origin * (1.0 / n);
    }
    // The eigenvalues are at most 1 and sum to 2, so the larger two have a product of ½ to 1: the
    // determinant says how large the smallest is.
    (matrix.determinant() > LEAST_SPREAD).then(|| matrix.inverse() * right)
}

fn cube(centre: DVec3, half: f64) -> Bounds {
    Bounds { min: centre - half, max: centre + half }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(eye: DVec3, target: DVec3) -> Camera {
        Camera::look_at(eye, target, DVec3::Y, 0.7, (400, 400))
    }

    #[test]
    fn cameras_around_an_object_find_it() {
        let target = DVec3::new(3.0, -1.0, 2.0);
        let cameras: Vec<Camera> = (0..20)
            .map(|i| {
                let angle = f64::from(i) * 0.7;
                let side = DVec3::new(angle.cos(), 0.3 * (2.0 * angle).sin(), angle.sin());
                camera(target + 4.0 * side, target)
            })
            .collect();
        let volume = viewed_volume(&cameras).unwrap();
        assert!(volume.centre().distance(target) < 1e-9);
        // 4 to 4.2 units away, half a view of 0.7 rad.
        let half = volume.max.x - target.x;
        assert!((4.0 * 0.35f64.tan()..=4.2 * 0.35f64.tan()).contains(&half), "{half}");
    }

    #[test]
    fn cameras_that_look_the_same_way_look_at_what_is_ahead() {
        let cameras: Vec<Camera> = (-2..=2)
            .map(|i| {
                let eye = DVec3::X * f64::from(i);
                camera(eye, eye + DVec3::Z)
            })
            .collect();
        let volume = viewed_volume(&cameras).unwrap();
        assert!((volume.centre() - DVec3::Z * 20.0).length() < 1e-9);
        assert!(cameras.iter().all(|c| !volume.contains(c.centre())));
    }

    #[test]
    fn cameras_that_look_outwards_are_inside() {
        let cameras: Vec<Camera> = (0..12)
            .map(|i| {
                let angle = f64::from(i) * 0.52;
                let side = DVec3::new(angle.cos(), 0.0, angle.sin());
                camera(side, 5.0 * side)
            })
            .collect();
        let volume = viewed_volume(&cameras).unwrap();
        assert!(cameras.iter().all(|c| volume.contains(c.centre())));
    }

    #[test]
    fn one_camera_has_a_volume_before_it_and_none_has_none() {
        let volume = viewed_volume(&[camera(DVec3::ZERO, DVec3::Z)]).unwrap();
        assert!((volume.centre() - DVec3::Z * 10.0).length() < 1e-9);
        assert!(viewed_volume(&[]).is_none());
    }

    #[test]
    fn random_points_fill_the_volume_and_depend_on_the_seed_alone() {
        let bounds = cube(DVec3::new(1.0, 2.0, 3.0), 0.5);
        let (positions, colors) = random_points(&bounds, 2000, 4);
        assert_eq!((positions.len(), colors.len()), (2000, 2000));
        let inside = |p: &[f32; 3]| bounds.contains(DVec3::from(p.map(f64::from)));
        assert!(positions.iter().all(inside));
        let found = Bounds::around(positions.iter().map(|p| DVec3::from(p.map(f64::from))));
        // The gap at each face is above 0.02 with probability 0.98²⁰⁰⁰ = 3e-18.
        let found = found.unwrap();
        assert!((found.min - bounds.min).max_element() < 0.02);
        assert!((bounds.max - found.max).max_element() < 0.02);
        assert_eq!(positions, random_points(&bounds, 2000, 4).0);
        assert_ne!(positions, random_points(&bounds, 2000, 5).0);
    }
}
