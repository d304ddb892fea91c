//! Grouping made-up splats.

use trapeze_scene::{Features, Scene, Splats};

use super::*;

/// Pseudo-random numbers in −1–1 (xorshift).
struct Random(u64);

impl Random {
    fn signed(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 40) as f32 / (1_u64 << 23) as f32) - 1.0
    }
}

/// `objects` balls of splats with 32 numbers each: a direction per object and noise; every tenth splat
/// has a direction of its own. Returns the object of each splat, [`UNASSIGNED`] for those.
fn noisy_features(objects: u32, splats: usize) -> (Features, Vec<[f32; 3]>, Vec<u32>) {
    const DIMENSIONS: usize = 32;
    let mut random = Random(0x5eed);
    let axes: Vec<Vec<f32>> =
        (0..objects).map(|_| (0..DIMENSIONS).map(|_| random.signed()).collect()).collect();
    let (mut values, mut positions, mut truth) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..splats {
        let object = (i as u32 * objects) / splats as u32;
        let noise = i % 10 == 3;
        for axis in &axes[object as usize] {
            let own = random.signed();
            values.push(if noise { own } else { 3.0 * axis + 1.5 * own });
        }
        let centre = [object as f32 * 3.0, 0.0, 0.0];
        positions.push(centre.map(|c| c + random.signed()));
        truth.push(if noise { UNASSIGNED } else { object });
    }
    (Features { dimensions: DIMENSIONS, values }, positions, truth)
}

#[test]
fn noisy_features_with_a_tenth_of_noise_are_grouped() {
    let (features, positions, truth) = noisy_features(7, 20_000);
    let grouping = by_features(&features, &positions, &ClusterOptions::default()).unwrap();
    let index = adjusted_rand_index(&truth, &grouping.groups);
    assert!(index >= 0.95, "adjusted Rand index {index}, {} groups", grouping.count);
    assert_eq!(grouping.count, 7);
    let clusters = grouping.into_clusters();
    assert!(is_unassigned(&clusters.table[0]) && clusters.table.len() == 8);
}

#[test]
fn an_instance_that_was_split_is_merged_and_no_other() {
    let (features, positions, truth) = noisy_features(3, 9_000);
    // Object 1, at x = 3, cut in two by a plane.
    let split: Vec<u32> = truth
        .iter()
        .zip(&positions)
        .map(|(&object, position)| if object == 1 && position[0] > 3.2 { 3 } else { object })
        .collect();
    assert!(split.iter().filter(|&&group| group == 3).count() > 500);
    let of = |i: usize| &features.values[i * 32..][..32];
    let merged = by_features::merged(&Grouping { groups: split, count: 4 }, &positions, of);
    assert_eq!(merged.count, 3);
    assert_eq!(adjusted_rand_index(&truth, &merged.groups), 1.0);
}

#[test]
fn what_moves_together_is_one_object() {
    // A slab at rest, and a box that touches it and turns.
    let mut splats = Splats::default();
    let mut random = Random(77);
    let mut later = Vec::new();
    let mut truth = Vec::new();
    for i in 0..4000 {
        let on_box = i % 4 == 0;
        let p = [random.signed(), random.signed(), random.signed()];
        let p =
            if on_box { p.map(|c| 0.3 * c) } else { [2.0 * p[0], 2.0 * p[1], -0.35 + 0.05 * p[2]] };
        splats.positions.push(p);
        splats.sh_dc.push([0.0; 3]);
        let (sin, cos) = 1.0_f32.sin_cos();
        later.push(if on_box {
            [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2] + 0.2]
        } else {
            p
        });
        truth.push(u32::from(on_box));
    }
    let n = splats.positions.len();
    splats.log_scales = vec![[-3.0; 3]; n];
    splats.rotations = vec![[1.0, 0.0, 0.0, 0.0]; n];
    splats.opacity_logits = vec![2.0; n];
    let first = splats.positions.clone();
    let scene = Scene::from_splats(splats);
    let grouping = by_geometry(&scene, &[first, later], &ClusterOptions::default()).unwrap();
    let index = adjusted_rand_index(&truth, &grouping.groups);
    assert!(index >= 0.9, "adjusted Rand index {index}, {} groups", grouping.count);
}

#[test]
fn hostile_splats_are_grouped_or_refused_without_a_panic() {
    let scene_of = |positions: Vec<[f32; 3]>| {
        let n = positions.len();
        Scene::from_splats(Splats {
            positions,
            log_scales: vec![[0.0; 3]; n],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; n],
            opacity_logits: vec![0.0; n],
            sh_dc: vec![[0.0; 3]; n],
            ..Splats::default()
        })
    };
    let group = |scene: &Scene| {
        by_geometry(
            scene,
            std::slice::from_ref(&scene.splats.positions),
            &ClusterOptions::default(),
        )
    };
    assert!(group(&scene_of(vec![])).is_err());
    assert!(group(&scene_of(vec![[f32::NAN; 3]; 100])).is_err());
    let same = group(&scene_of(vec![[1.0; 3]; 500])).unwrap();
    assert_eq!(same.count, 1, "identical splats are one cluster");
    let mut mixed = vec![[f32::INFINITY, 0.0, 0.0]; 20];
    mixed.extend((0..200_u16).map(|i| [f32::from(i), 0.0, 1e30]));
    assert_eq!(group(&scene_of(mixed)).unwrap().groups[..20], [UNASSIGNED; 20]);
    let nothing = Features { dimensions: 4, values: vec![0.0; 400] };
    assert!(by_features(&nothing, &[[0.0; 3]; 100], &ClusterOptions::default()).is_err());
}
