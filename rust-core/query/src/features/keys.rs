//! What a cluster is made of, as a number: when it changes, the cluster is looked at again.

use crc32fast::Hasher;
use trapeze_scene::{Clusters, DeformationNetwork, Scene};

/// A checksum per cluster over its splats in their order, and over the network that moves them.
pub(crate) fn cluster_keys(scene: &Scene, clusters: &Clusters) -> Vec<u32> {
    let mut common = Hasher::new();
    scene.origin.to_array().iter().for_each(|c| common.update(&c.to_le_bytes()));
    if let Some(network) = &scene.deformation {
        hash_network(network, &mut common);
    }
    let mut hashers = vec![common; clusters.table.len()];
    let splats = &scene.splats;
    let mut bytes = Vec::new();
    for (i, &label) in clusters.labels.iter().enumerate() {
        bytes.clear();
        let numbers = splats.positions[i]
            .iter()
            .chain(&splats.log_scales[i])
            .chain(&splats.rotations[i])
            .chain(std::slice::from_ref(&splats.opacity_logits[i]))
            .chain(&splats.sh_dc[i])
            .chain(splats.sh_rest_of(i));
        numbers.for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        hashers[label as usize].update(&bytes);
    }
    hashers.into_iter().map(Hasher::finalize).collect()
}

fn hash_network(network: &DeformationNetwork, hasher: &mut Hasher) {
    hasher.update(network.describe().as_bytes());
    for layer in network.layers() {
        for number in layer.weight.iter().chain(&layer.bias) {
            hasher.update(&number.to_le_bytes());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_scene::two_boxes;

    #[test]
    fn only_the_cluster_that_changed_gets_another_key() {
        let scene = two_boxes();
        let clusters = scene.clusters.as_ref().unwrap();
        let before = cluster_keys(&scene, clusters);
        let mut changed = scene.clone();
        let last = changed.len() - 1;
        changed.splats.opacity_logits[last] += 1e-3;
        let after = cluster_keys(&changed, clusters);
        let touched = clusters.labels[last] as usize;
        for label in 0..clusters.table.len() {
            assert_eq!(before[label] == after[label], label != touched, "{label}");
        }
    }
}
