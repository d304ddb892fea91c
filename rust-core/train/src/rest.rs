//! Splats of a moving scene that never move, and leave the network while it trains.
//!
//! In most scenes that move, many of the splats do not. What the network says of them is nearly the
//! same at all times; to ask it in every step, and to carry gradients back through it, is nine tenths
//! of what such a splat costs. So now and then the trainer looks at all splats at a few times. Those
//! that no camera sees move hold the mean of what the network gave them until the next look, and the
//! network is trained on the others. A look asks for every splat anew: one that the network has begun
//! to move moves again.

use fearless_simd::Level;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use trapeze_cpu::deform::{DeformationOptions, DeformationStage, Deformed};
use trapeze_scene::deformation::{DeformationOutputs, RestingSplats};
use trapeze_scene::{Camera, Scene, Splats};

/// Times at which a look sees the splats, at most.
pub const MOST_MOMENTS: usize = 6;

/// What a look sees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// As stored: unit quaternions, standard deviations.
    pub stored: DeformedGeometry,
    /// At each of the times.
    pub moments: Vec<DeformedGeometry>,
}

/// Splats of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeformedGeometry {
    /// Centres.
    pub positions: Vec<[f32; 3]>,
    /// Unit quaternion and its addition, w x y z, before they are normalised together.
    pub rotations: Vec<[f32; 4]>,
    /// Standard deviations, world units.
    pub scales: Vec<[f32; 3]>,
}

impl DeformedGeometry {
    /// Poses of a renormalising network.
    #[must_use]
    pub fn of_poses(poses: &Deformed) -> Self {
        let rotations = poses.rotations.iter().zip(&poses.rotation_lengths);
        Self {
            positions: poses.positions.clone(),
            rotations: rotations.map(|(rotation, length)| rotation.map(|c| c * length)).collect(),
            scales: poses.scales.clone(),
        }
    }

    /// Splats as they are stored.
    #[must_use]
    pub fn of_stored(
        positions: Vec<[f32; 3]>,
        log_scales: &[[f32; 3]],
        rotations: &[[f32; 4]],
    ) -> Self {
        let scale = |log_scale: &[f32; 3]| log_scale.map(f32::exp);
        Self {
            positions,
            rotations: rotations.iter().map(|&q| unit(q).map(|c| c as f32)).collect(),
            scales: log_scales.iter().map(scale).collect(),
        }
    }

    /// The numbers of splat `i`: centre, rotation, standard deviations.
    fn numbers(&self, i: usize) -> [f64; 10] {
        let [x, y, z] = self.positions[i];
        let [qw, qx, qy, qz] = self.rotations[i];
        let [a, b, c] = self.scales[i];
        [x, y, z, qw, qx, qy, qz, a, b, c].map(f64::from)
    }
}

/// The splats of a scene at some times, evaluated on the processor.
pub(crate) fn look_at(scene: &Scene, level: Level, times: &[f32]) -> Look {
    let options = DeformationOptions { level, position_term_budget: 0 };
    let mut stage = DeformationStage::with_options(scene, options);
    let moment = |&time: &f32| DeformedGeometry::of_poses(stage.evaluate(time, None));
    let moments = times.iter().map(moment).collect();
    let Splats { positions, log_scales, rotations, .. } = &scene.splats;
    Look { stored: DeformedGeometry::of_stored(positions.clone(), log_scales, rotations), moments }
}

/// How much a run made use of what rests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RestRecord {
    /// Splats that rested at the last look.
    pub resting: u32,
    /// Times that a step would have evaluated the network for a splat.
    pub evaluations: u64,
    /// Those that did not take place.
    pub spared: u64,
}

impl RestRecord {
    /// Counts a step with `splats` splats.
    pub fn count(&mut self, splats: u32) {
        self.evaluations += u64::from(splats);
        self.spared += u64::from(self.resting);
    }

    /// Share of the network's evaluations that did not take place.
    #[must_use]
    pub fn spared_share(&self) -> f64 {
        self.spared as f64 / self.evaluations.max(1) as f64
    }
}

/// The splats that no camera sees move by more than `within` pixels from their mean at any moment of a
/// look; they hold that mean. A splat that is not finite moves.
#[must_use]
pub fn find_resting(look: &Look, cameras: &[Camera], within: f64) -> RestingSplats {
    let splats = look.stored.positions.len();
    let held_by = |i: usize| {
        let mean = mean(&look.moments, i);
        let allowed = within * world_per_pixel(cameras, [mean[0], mean[1], mean[2]]);
        let rests = look.moments.iter().all(|moment| shift(mean, moment.numbers(i)) <= allowed);
        let stored = look.stored.numbers(i);
        rests.then(|| std::array::from_fn(|c| (mean[c] - stored[c]) as f32))
    };
    let held: Vec<Option<DeformationOutputs>> = (0..splats).into_par_iter().map(held_by).collect();
    let moving = (0..splats as u32).filter(|&i| held[i as usize].is_none()).collect();
    // Ascending and in range by construction.
    RestingSplats::new(moving, held.into_iter().flatten().collect()).unwrap_or_default()
}

fn mean(moments: &[DeformedGeometry], i: usize) -> [f64; 10] {
    let mut mean = [0.0; 10];
    for moment in moments {
        for (mean, value) in mean.iter_mut().zip(moment.numbers(i)) {
            *mean += value / moments.len() as f64;
        }
    }
    mean
}

/// How far the outline of a splat, at two standard deviations, is from where it was: world units.
fn shift(from: [f64; 10], to: [f64; 10]) -> f64 {
    let distance = |range: std::ops::Range<usize>| {
        range.map(|c| (from[c] - to[c]).powi(2)).sum::<f64>().sqrt()
    };
    // |q − q'| of unit quaternions is 2 sin(θ/4) for a turn by θ. They are a few degrees apart where it
    // matters, so their mean has the length of one.
    let length = (3..7).map(|c| from[c] * from[c]).sum::<f64>().sqrt();
    let angle = 2.0 * distance(3..7) / length;
    let largest = from[7].max(from[8]).max(from[9]);
    distance(0..3) + 2.0 * (distance(7..10) + angle * largest)
}

/// World units that a pixel covers at a place, in the camera that shows it largest; infinite where no
/// camera looks.
fn world_per_pixel(cameras: &[Camera], position: [f64; 3]) -> f64 {
    let place = glam::DVec3::from(position);
    let depth_by_focal = cameras.iter().map(|camera| {
        let depth = camera.world_to_camera.transform_point3(place).z;
        if depth > 0.0 { depth / camera.fx.max(camera.fy) } else { f64::INFINITY }
    });
    depth_by_focal.fold(f64::INFINITY, f64::min)
}

/// The identity where there is no direction.
fn unit(rotation: [f32; 4]) -> [f64; 4] {
    let rotation = rotation.map(f64::from);
    let length = rotation.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length > 0.0 { rotation.map(|c| c / length) } else { [1.0, 0.0, 0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// A camera at distance 4 with a focal length of 100 pixels: a pixel is 0.04 wide at the origin.
    fn camera() -> Camera {
        let mut camera =
            Camera::look_at(DVec3::new(0.0, 0.0, -4.0), DVec3::ZERO, DVec3::NEG_Y, 0.7, (80, 60));
        (camera.fx, camera.fy) = (100.0, 100.0);
        camera
    }

    fn stored(n: usize) -> DeformedGeometry {
        let rotations = vec![[2.0, 0.0, 0.0, 0.0]; n];
        DeformedGeometry::of_stored(vec![[0.0; 3]; n], &vec![[0.1f32.ln(); 3]; n], &rotations)
    }

    #[test]
    fn what_shifts_turns_or_grows_by_more_than_a_part_of_a_pixel_moves() {
        let stored = stored(8);
        // Each of two moments is half of their difference from the mean: a quarter of a pixel is 0.01,
        // so what lies between them may be 0.02.
        let mut later = stored.clone();
        later.positions[0][0] = 0.019;
        later.positions[1][1] = 0.021;
        // The outline at 0.2 turns by 0.08 rad, 0.016, and by 0.12, 0.024.
        for (i, angle) in [(2, 0.08f32), (3, 0.12)] {
            later.rotations[i] = [(0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0];
        }
        later.scales[4] = [0.1, 0.1, 0.109];
        later.scales[5] = [0.1, 0.111, 0.1];
        later.positions[6][2] = f32::NAN;
        let look = Look { moments: vec![stored.clone(), later], stored };
        let moving =
            |cameras: &[Camera], within| find_resting(&look, cameras, within).moving().to_vec();
        assert_eq!(moving(&[camera()], 0.25), [1, 3, 5, 6]);
        assert_eq!(moving(&[], 0.25), [6]);
        assert_eq!(moving(&[camera()], 0.0), [0, 1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn what_rests_holds_the_mean_of_what_it_was_given() {
        let stored = stored(2);
        let mut moments = vec![stored.clone(), stored.clone()];
        for (moment, sign) in moments.iter_mut().zip([-1.0, 1.0]) {
            moment.positions[1] = [0.5 + 0.001 * sign, -0.25, 1.0];
            moment.rotations[1] = [1.5, 0.25, 0.001 * sign, -1.0];
            moment.scales[1] = [0.2, 0.1 - 0.001 * sign, 0.4];
        }
        let resting = find_resting(&Look { stored, moments }, &[camera()], 0.5);
        assert!(resting.moving().is_empty());
        let expected = [0.5, -0.25, 1.0, 0.5, 0.25, 0.0, -1.0, 0.1, 0.0, 0.3];
        for (held, expected) in resting.held()[1].iter().zip(expected) {
            assert!((held - expected).abs() < 1e-7, "{held} {expected}");
        }
    }

    #[test]
    fn the_spared_share_is_of_all_evaluations() {
        let mut record = RestRecord::default();
        assert_eq!(record.spared_share(), 0.0);
        record.count(100);
        record.resting = 60;
        record.count(100);
        assert_eq!(record.spared_share(), 0.3);
    }
}
