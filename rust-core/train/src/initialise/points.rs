//! Splats in the places of points.

use trapeze_scene::{Neighbours, SH_C0, ShDegree, Splats};

use crate::config::InitialSplats;
use crate::densify::logit;

/// Neighbours whose mean distance is the size of a splat (Kerbl et al. 2023).
const NEIGHBOURS: usize = 3;
/// Sizes are kept within this factor of the median. Copies of a point would give splats of size
/// zero, which no gradient reaches, and a far outlier one that covers every image.
const LARGEST_RATIO: f64 = 100.0;

/// One splat of SH degree 0 per point: round, as large as `initial.scale` times the mean distance
/// to its three nearest neighbours, of opacity `initial.opacity` and the point's colour. Points that
/// are not finite are left out. Where no point has a neighbour, `extent` / 100 is taken as distance.
///
/// `colors` are r g b in 0–1, one per point.
///
/// # Panics
/// When there are not as many colours as points.
#[must_use]
pub fn splats_from_points(
    positions: &[[f32; 3]],
    colors: &[[f32; 3]],
    initial: &InitialSplats,
    extent: f64,
) -> Splats {
    assert_eq!(positions.len(), colors.len(), "one colour per point");
    let finite = |p: &[f32; 3]| p.iter().all(|c| c.is_finite());
    let (positions, colors): (Vec<_>, Vec<_>) =
        positions.iter().zip(colors).filter(|&(p, _)| finite(p)).map(|(p, c)| (*p, *c)).unzip();
    let n = positions.len();
    let opacity = logit(initial.opacity) as f32;
    Splats {
        log_scales: spacings(&positions, extent)
            .into_iter()
            .map(|spacing| [(initial.scale * spacing).ln() as f32; 3])
            .collect(),
        rotations: vec![[1.0, 0.0, 0.0, 0.0]; n],
        opacity_logits: vec![opacity; n],
        sh_dc: colors.into_iter().map(|color| color.map(color_to_sh)).collect(),
        sh_rest: Vec::new(),
        sh_degree: ShDegree::Zero,
        positions,
    }
}

/// The band-0 coefficient whose colour, 0.5 + C₀·dc, is `color`.
fn color_to_sh(color: f32) -> f32 {
    ((f64::from(color) - 0.5) / SH_C0) as f32
}

/// The mean distance of every point to its nearest neighbours, within reason.
fn spacings(positions: &[[f32; 3]], extent: f64) -> Vec<f64> {
    let neighbours = Neighbours::of(positions, NEIGHBOURS);
    let distance = |i| neighbours.mean_distance(i).filter(|&d| d > 0.0);
    let mut known: Vec<f64> = (0..positions.len()).filter_map(distance).collect();
    let median = if known.is_empty() {
        extent / LARGEST_RATIO
    } else {
        let middle = known.len() / 2;
        *known.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let (low, high) = (median / LARGEST_RATIO, median * LARGEST_RATIO);
    (0..positions.len())
        .map(|i| neighbours.mean_distance(i).map_or(median, |d| d.clamp(low, high)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn initial() -> InitialSplats {
        InitialSplats { opacity: 0.1, scale: 1.0, random_count: 0 }
    }

    #[test]
    fn a_splat_has_the_colour_of_its_point_and_the_size_of_its_surroundings() {
        // The corners of a unit square: neighbours at 1, 1 and √2.
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let colors = [[0.0, 0.25, 1.0]; 4];
        let splats = splats_from_points(&positions, &colors, &initial(), 5.0);
        splats.validate().unwrap();
        let expected = ((2.0 + 2.0f64.sqrt()) / 3.0).ln();
        for i in 0..4 {
            assert!(splats.log_scales[i].iter().all(|&s| (f64::from(s) - expected).abs() < 1e-6));
            let opacity = trapeze_scene::sigmoid(f64::from(splats.opacity_logits[i]));
            assert!((opacity - 0.1).abs() < 1e-7);
            for c in 0..3 {
                let color = 0.5 + SH_C0 * f64::from(splats.sh_dc[i][c]);
                assert!((color - f64::from(colors[i][c])).abs() < 1e-6);
            }
        }
        let small = InitialSplats { scale: 0.1, ..initial() };
        let splats = splats_from_points(&positions, &colors, &small, 5.0);
        assert!((f64::from(splats.log_scales[0][0]) - (expected + 0.1f64.ln())).abs() < 1e-6);
    }

    #[test]
    fn copies_and_outliers_have_sizes_that_training_can_change() {
        let mut positions: Vec<[f32; 3]> = (0..100).map(|i| [i as f32, 0.0, 0.0]).collect();
        positions.extend([[5.0, 0.0, 0.0]; 4]);
        positions.push([1e9, 0.0, 0.0]);
        let colors = vec![[0.5; 3]; positions.len()];
        let splats = splats_from_points(&positions, &colors, &initial(), 5.0);
        for log_scales in &splats.log_scales {
            let scale = f64::from(log_scales[0]).exp();
            // The median spacing on the line is (1 + 1 + 2)/3.
            assert!((0.0132..=134.0).contains(&scale), "{scale}");
        }
    }

    #[test]
    fn few_points_and_points_that_are_not_finite_are_taken_as_they_come() {
        assert!(splats_from_points(&[], &[], &initial(), 1.0).is_empty());
        let positions = [[1.0, 2.0, 3.0], [f32::NAN, 0.0, 0.0], [f32::INFINITY; 3]];
        let splats = splats_from_points(&positions, &[[0.5; 3]; 3], &initial(), 2.0);
        assert_eq!(splats.len(), 1);
        assert!((f64::from(splats.log_scales[0][0]) - 0.02f64.ln()).abs() < 1e-6);
        let twice = splats_from_points(&[[1.0; 3]; 2], &[[0.5; 3]; 2], &initial(), 2.0);
        assert!(twice.log_scales.as_flattened().iter().all(|s| s.is_finite()));
    }
}
