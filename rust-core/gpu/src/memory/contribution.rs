//! Which splats a scene can do without.

use trapeze_scene::{Clusters, Motion, Scene, Splats, sigmoid};

use crate::RendererOptions;

/// Indices of the splats that go onto the device, when the options allow fewer than there are.
pub(crate) fn kept_splats(scene: &Scene, options: &RendererOptions) -> Option<Vec<u32>> {
    let most = options.max_splats.map(|most| most as usize).filter(|&most| most < scene.len())?;
    Some(most_contributing(&scene.splats, most))
}

/// The scene of these splats. Labels stay those of the whole scene, and features are left out.
pub(crate) fn part_of(scene: &Scene, kept: &[u32]) -> Scene {
    let gather = |values: &[f32]| kept.iter().map(|&i| values[i as usize]).collect();
    Scene {
        splats: scene.splats.gather(kept),
        origin: scene.origin,
        deformation: scene.deformation.clone(),
        clusters: scene.clusters.as_ref().map(|clusters| Clusters {
            labels: kept.iter().map(|&i| clusters.labels[i as usize]).collect(),
            table: clusters.table.clone(),
        }),
        motion: scene
            .motion
            .as_ref()
            .map(|motion| Motion { values: gather(&motion.values), ..motion.clone() }),
        features: None,
        antialiased: scene.antialiased,
    }
}

/// Indices, ascending, of the `count` splats that contribute most: by opacity times the area of the
/// broadest side, which is what a splat adds to an image seen from there at unit distance, up to a
/// factor. Equal ones by index.
fn most_contributing(splats: &Splats, count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..splats.len() as u32).collect();
    if count >= order.len() {
        return order;
    }
    let contribution: Vec<f64> = (0..splats.len()).map(|i| contribution(splats, i)).collect();
    order.select_nth_unstable_by(count, |&a, &b| {
        contribution[b as usize].total_cmp(&contribution[a as usize]).then(a.cmp(&b))
    });
    order.truncate(count);
    order.sort_unstable();
    order
}

/// log₂(opacity · largest scale · second largest scale); lowest where it is not a number.
fn contribution(splats: &Splats, i: usize) -> f64 {
    let mut scales = splats.log_scales[i].map(f64::from);
    scales.sort_by(f64::total_cmp);
    let value = sigmoid(f64::from(splats.opacity_logits[i])).ln() + scales[2] + scales[1];
    if value.is_nan() { f64::NEG_INFINITY } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_large_and_the_opaque_stay_in_their_order() {
        let splats = Splats {
            positions: vec![[0.0; 3]; 5],
            // Large and opaque, a needle, small, large but clear, not a number.
            log_scales: vec![[0.0; 3], [-9.0, -9.0, 1.0], [-3.0; 3], [0.0; 3], [f32::NAN; 3]],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; 5],
            opacity_logits: vec![2.0, 2.0, 2.0, -9.0, 2.0],
            sh_dc: vec![[0.0; 3]; 5],
            ..Splats::default()
        };
        assert_eq!(most_contributing(&splats, 1), [0]);
        assert_eq!(most_contributing(&splats, 2), [0, 2]);
        assert_eq!(most_contributing(&splats, 4), [0, 1, 2, 3]);
        assert_eq!(most_contributing(&splats, 9), [0, 1, 2, 3, 4]);
    }
}
