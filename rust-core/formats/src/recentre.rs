//! Moving geo-referenced captures to where single precision can hold them.
//!
//! A splat keeps its centre in single precision, relative to [`Scene::origin`]
//! (trapeze_scene). For a capture in geographic coordinates (UTM: 1e5 … 1e7 metres) the origin
//! carries the large part.
//!
//! # The rule
//!
//! An axis whose median coordinate is [`FAR_FROM_ZERO`] or more away from zero is moved by that
//! median, rounded to an integer; the other axes stay. The median, because captures have floaters
//! that would drag a mean or a box centre; axis by axis and by the signed median, because a scene
//! that is merely large (say ±20 000 around zero) has nothing to gain from being moved and its
//! small coordinates have bits to lose.
//!
//! # What it costs
//!
//! Double-precision coordinates are moved in double precision and rounded once, at a distance from
//! the origin where single precision is fine. Single-precision coordinates were rounded when the
//! file was written, and moving them adds nothing in almost all cases: for x between origin/2 and
//! 2·origin the difference of two floating-point numbers is exact (Sterbenz 1974; the origin is an
//! integer, so it is such a number in f64, and x − origin then has no more bits than x). Only a
//! floater farther from the origin than that is rounded, to half a unit in the last place of its
//! distance.

use glam::DVec3;

/// Median coordinate from which an axis is moved, world units.
///
/// At 4096 = 2¹² single precision resolves 2⁻¹¹ units: half a millimetre in a scene measured in
/// metres, about the smallest splats of a capture. Below it nothing visible can be won; at 1e6
/// the resolution is 6 cm and the capture falls apart.
pub(crate) const FAR_FROM_ZERO: f64 = 4096.0;

/// Beyond 2⁵³ a double no longer tells neighbouring integers apart: no coordinate of a place.
const NO_PLACE: f64 = 9_007_199_254_740_992.0;

/// Moves single-precision world positions in place and returns the origin to add back.
pub(crate) fn recentre_f32(positions: &mut [[f32; 3]]) -> DVec3 {
    let origin = choose_origin(positions);
    if origin != DVec3::ZERO {
        for p in positions {
            *p = (DVec3::from(p.map(f64::from)) - origin).as_vec3().to_array();
        }
    }
    origin
}

/// Rounds double-precision world positions to single precision, relative to the returned origin.
pub(crate) fn recentre_f64(positions: &[[f64; 3]]) -> (Vec<[f32; 3]>, DVec3) {
    let origin = choose_origin(positions);
    let relative = positions.iter().map(|&p| (DVec3::from(p) - origin).as_vec3().to_array());
    (relative.collect(), origin)
}

/// The origin for positions in world coordinates, by the rule of this module. Values that are not
/// finite have no say.
fn choose_origin<T: Copy + Into<f64>>(positions: &[[T; 3]]) -> DVec3 {
    DVec3::from([0, 1, 2].map(|axis| {
        let coordinates = positions.iter().map(|p| p[axis].into());
        // Almost every scene is decided by counting; only the others need the median itself.
        let far =
            coordinates.clone().filter(|c: &f64| c.is_nan() || c.abs() >= FAR_FROM_ZERO).count();
        if far * 2 < positions.len() {
            return 0.0;
        }
        let median = median(coordinates.filter(|c| c.is_finite()).collect());
        if (FAR_FROM_ZERO..NO_PLACE).contains(&median.abs()) { median.round() } else { 0.0 }
    }))
}

/// Lower median; zero of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    *values.select_nth_unstable_by(last / 2, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_scene_around_zero_is_not_touched_however_large() {
        let mut positions: Vec<[f32; 3]> =
            (-50..=50).map(|i| [i as f32 * 400.0, 0.1, i as f32 * 1e-3]).collect();
        let before = positions.clone();
        assert_eq!(recentre_f32(&mut positions), DVec3::ZERO);
        assert_eq!(positions, before);
    }

    #[test]
    fn only_the_far_axes_move_and_by_whole_units() {
        let positions = [[500_000.4, 4_649_776.6, 12.3], [500_001.4, 4_649_777.5, 12.9]];
        let (relative, origin) = recentre_f64(&positions);
        assert_eq!(origin, DVec3::new(500_000.0, 4_649_777.0, 0.0));
        for (p, r) in positions.iter().zip(relative) {
            for axis in 0..3 {
                // One rounding to f32 at |r| < 16: half of 2⁻²⁰. The f64 inputs hold 2⁻³⁰.
                let error = f64::from(r[axis]) + origin[axis] - p[axis];
                assert!(error.abs() <= f64::exp2(-21.0) + f64::exp2(-30.0), "{error}");
            }
        }
    }

    #[test]
    fn floaters_and_values_that_are_not_finite_do_not_choose_the_origin() {
        let mut positions = vec![[1e6f32, 0.0, 0.0]; 10];
        positions.push([f32::NAN; 3]);
        positions.push([f32::INFINITY; 3]);
        positions.push([1e30; 3]);
        let origin = recentre_f32(&mut positions);
        assert_eq!(origin, DVec3::new(1e6, 0.0, 0.0));
        assert!(positions[10][0].is_nan() && positions[11][0] == f32::INFINITY);
    }

    #[test]
    fn no_position_or_no_finite_position_gives_the_zero_origin() {
        assert_eq!(recentre_f32(&mut []), DVec3::ZERO);
        assert_eq!(recentre_f32(&mut [[f32::NAN; 3]; 4]), DVec3::ZERO);
        assert_eq!(recentre_f64(&[[1e300; 3]; 4]).1, DVec3::ZERO);
    }

    proptest! {
        #[test]
        fn moving_single_precision_positions_loses_nothing(
            centre in 4100.0f32..2e7,
            offsets in prop::collection::vec(-1.0f32..1.0, 1..50),
        ) {
            // Offsets of up to a third of the centre keep x within [origin/2, 2·origin].
            let world: Vec<[f32; 3]> =
                offsets.iter().map(|o| [centre + o * centre / 4.0, 1.0, 2.0]).collect();
            let mut moved = world.clone();
            let origin = recentre_f32(&mut moved);
            for (w, m) in world.iter().zip(&moved) {
                prop_assert_eq!(f64::from(m[0]) + origin.x, f64::from(w[0]));
            }
        }
    }
}
