//! Exploration: positions wander in the shape of their splat, where it is nearly transparent.

use fearless_simd::{Level, Simd, dispatch};
use fearless_simd_macros::simd;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use trapeze_scene::Splats;

use crate::exponential::{exp, sigmoid};
use crate::random::{Purpose, Stream};

/// The noise of "3D Gaussian Splatting as Markov Chain Monte Carlo", eq. 8 and §4.2:
/// Δμ = rate · `scale` · σ(−k·(o − t)) · Σ η with η ~ N(0, I).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PositionNoise {
    /// Times the learning rate of positions.
    pub scale: f64,
    /// k: how sharply the gate closes.
    pub gate_steepness: f64,
    /// t: the opacity at which the gate is half closed.
    pub gate_opacity: f64,
}

impl Default for PositionNoise {
    /// The paper's 5e5, and the gate of its reference code, σ(100·((1 − o) − 0.995)).
    fn default() -> Self {
        Self { scale: 5e5, gate_steepness: 100.0, gate_opacity: 0.005 }
    }
}

/// Splats per task.
const CHUNK: usize = 1024;

impl PositionNoise {
    /// Moves every position. `rate` is the step's learning rate of positions. A position that
    /// would not be finite stays.
    ///
    /// Splat i draws from index i of the stream of [`Purpose::PositionNoise`] at `step`: its first
    /// three numbers are η along the splat's own axes. (Σ = R S² Rᵀ, and Rᵀη is as normal as η, so
    /// Σ η is drawn as R S² η.)
    pub fn add(&self, level: Level, splats: &mut Splats, rate: f64, seed: u64, step: u32) {
        let stream = Stream::new(seed, Purpose::PositionNoise, step);
        let gate = Gate {
            amplitude: (rate * self.scale) as f32,
            steepness: self.gate_steepness as f32,
            opacity: self.gate_opacity as f32,
        };
        let Splats { positions, log_scales, rotations, opacity_logits, .. } = splats;
        positions
            .par_chunks_mut(CHUNK)
            .zip(log_scales.par_chunks(CHUNK))
            .zip(rotations.par_chunks(CHUNK))
            .zip(opacity_logits.par_chunks(CHUNK))
            .enumerate()
            .for_each(|(chunk, (((positions, log_scales), rotations), logits))| {
                let shape = Shapes { first: (chunk * CHUNK) as u32, log_scales, rotations, logits };
                dispatch!(level, simd => perturb(simd, positions, &shape, stream, gate));
            });
    }
}

#[derive(Clone, Copy)]
struct Gate {
    amplitude: f32,
    steepness: f32,
    opacity: f32,
}

struct Shapes<'a> {
    /// Index of the first splat.
    first: u32,
    log_scales: &'a [[f32; 3]],
    rotations: &'a [[f32; 4]],
    logits: &'a [f32],
}

#[simd]
fn perturb<S: Simd>(
    _: S,
    positions: &mut [[f32; 3]],
    shapes: &Shapes<'_>,
    stream: Stream,
    gate: Gate,
) {
    let shape = shapes.log_scales.iter().zip(shapes.rotations).zip(shapes.logits);
    for (i, (position, ((log_scales, rotation), &logit))) in
        positions.iter_mut().zip(shape).enumerate()
    {
        let normals = stream.normals(shapes.first.wrapping_add(i as u32));
        let open = sigmoid(gate.steepness * (gate.opacity - sigmoid(logit)));
        let amplitude = gate.amplitude * open;
        let along_axes =
            std::array::from_fn(|axis| amplitude * exp(2.0 * log_scales[axis]) * normals[axis]);
        let step = rotate(*rotation, along_axes);
        let moved: [f32; 3] = std::array::from_fn(|axis| position[axis] + step[axis]);
        let usable = moved[0].is_finite() & moved[1].is_finite() & moved[2].is_finite();
        for axis in 0..3 {
            position[axis] = if usable { moved[axis] } else { position[axis] };
        }
    }
}

/// `v` turned by a quaternion (w, x, y, z) of any length; by none where the length is zero.
#[inline(always)]
fn rotate(q: [f32; 4], v: [f32; 3]) -> [f32; 3] {
    // Divided by the largest component first: the square of 1e-20 is not a normal number.
    let largest = q[0].abs().max(q[1].abs()).max(q[2].abs().max(q[3].abs()));
    let inverse = 1.0 / largest.max(f32::MIN_POSITIVE);
    let [w, x, y, z] = q.map(|c| c * inverse);
    let square = (w * w + x * x) + (y * y + z * z);
    // v + 2·(w·(u × v) + u × (u × v)) / |q|²; a zero quaternion has u = 0.
    let factor = 2.0 / square.max(f32::MIN_POSITIVE);
    let cross = |a: [f32; 3], b: [f32; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let once = cross([x, y, z], v);
    let twice = cross([x, y, z], once);
    std::array::from_fn(|i| v[i] + factor * (w * once[i] + twice[i]))
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat, DVec3};
    use trapeze_scene::ShDegree;

    use super::*;
    use crate::parameters::tests::random_splats;

    /// The covariance of a splat in double precision.
    fn covariance(log_scales: [f32; 3], [w, x, y, z]: [f32; 4]) -> DMat3 {
        let [x, y, z, w] = [x, y, z, w].map(f64::from);
        let r = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize());
        let s = DMat3::from_diagonal(DVec3::from(log_scales.map(|l| f64::from(l).exp())));
        r * s * s * r.transpose()
    }

    #[test]
    fn the_noise_has_the_covariance_of_the_paper() {
        // Δ = a·Σ η has covariance a²·Σ².
        let one = random_splats(4, 1, ShDegree::Zero);
        let n = 40_000;
        let mut splats = one.gather(&vec![0; n]);
        splats.positions.fill([0.0; 3]);
        splats.opacity_logits.fill(-6.0);
        let noise = PositionNoise::default();
        noise.add(Level::new(), &mut splats, 1e-3, 7, 3);
        let opacity = trapeze_scene::sigmoid(-6.0);
        let a = 1e-3 * 5e5 * trapeze_scene::sigmoid(100.0 * (0.005 - opacity));
        let sigma = covariance(one.log_scales[0], one.rotations[0]);
        let expected = sigma * sigma * (a * a);
        let moment = |i: usize, j: usize| {
            let pairs = splats.positions.iter().map(|p| f64::from(p[i]) * f64::from(p[j]));
            pairs.sum::<f64>() / n as f64
        };
        for i in 0..3 {
            for j in 0..3 {
                let (e, ii, jj) = (expected.col(j)[i], expected.col(i)[i], expected.col(j)[j]);
                // The variance of a sample second moment of normals is (ΣᵢᵢΣⱼⱼ + Σᵢⱼ²)/n; 5 σ.
                let bound = 5.0 * ((ii * jj + e * e) / n as f64).sqrt();
                assert!((moment(i, j) - e).abs() <= bound, "{i} {j}: {} {e}", moment(i, j));
            }
        }
    }

    #[test]
    fn opaque_splats_stay_and_transparent_ones_move() {
        let mut splats = random_splats(4, 100, ShDegree::Zero);
        splats.opacity_logits[..50].fill(0.0);
        splats.opacity_logits[50..].fill(-7.0);
        let before = splats.positions.clone();
        PositionNoise::default().add(Level::new(), &mut splats, 1e-3, 7, 3);
        let moved = |i: usize| {
            (0..3).map(|c| (splats.positions[i][c] - before[i][c]).abs()).fold(0.0, f32::max)
        };
        // σ(100·(0.005 − 0.5)) = 3e-22.
        assert!((0..50).all(|i| moved(i) == 0.0));
        assert!((50..100).all(|i| moved(i) > 0.0));
    }

    #[test]
    fn degenerate_splats_keep_finite_positions() {
        let mut splats = random_splats(4, 7, ShDegree::Zero);
        splats.opacity_logits.fill(-20.0);
        splats.rotations[0] = [0.0; 4];
        splats.rotations[1] = [1e-20, 0.0, 1e-20, 0.0];
        splats.rotations[2] = [1e20, 1e20, 0.0, 0.0];
        splats.rotations[3] = [f32::NAN; 4];
        splats.log_scales[4] = [40.0, -40.0, 1e9];
        splats.opacity_logits[5] = f32::NAN;
        let before = splats.clone();
        PositionNoise::default().add(Level::new(), &mut splats, 1e-3, 7, 3);
        assert!(splats.positions.as_flattened().iter().all(|p| p.is_finite()));
        assert_ne!(splats.positions[..3], before.positions[..3]);
        assert_eq!(splats.positions[3], before.positions[3]);
        assert_eq!(splats.positions[5], before.positions[5]);
    }

    #[test]
    fn a_quaternion_turns_as_its_matrix_does_whatever_its_length() {
        for length in [1e-20f32, 1.0, 1e19] {
            for q in random_splats(8, 50, ShDegree::Zero).rotations {
                let v = DVec3::new(0.3, -1.0, 2.0);
                let [w, x, y, z] = q.map(f64::from);
                let expected = DQuat::from_xyzw(x, y, z, w).normalize() * v;
                let found = rotate(q.map(|c| c * length), [0.3, -1.0, 2.0]);
                // About 20 operations on values of at most 2·|v|, each within half an ulp.
                let error = (DVec3::from(found.map(f64::from)) - expected).length();
                assert!(error <= 20.0 * 2.3 * f64::from(f32::EPSILON), "{error:e}");
            }
        }
    }

    #[test]
    fn threads_and_vector_width_change_no_bit() {
        let run = |threads: usize, level: Level| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut splats = random_splats(4, 5000, ShDegree::Zero);
            let noise = PositionNoise::default();
            pool.install(|| noise.add(level, &mut splats, 1e-3, 7, 3));
            splats.positions
        };
        let expected = run(1, Level::baseline());
        assert_eq!(run(3, Level::new()), expected);
    }
}
