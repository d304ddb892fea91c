//! The radix sort, and the prefix sums inside it, at every size that is special.

use super::device;
use crate::layout::counter;
use crate::sort::{PairBuffers, SortPlan};
use crate::stage_pass::Groups;
use crate::{Gpu, readback};

/// Sizes around those of a workgroup, of a block of few and of many keys per thread, and large
/// ones.
const SIZES: [u32; 14] = [
    0,
    1,
    2,
    255,
    256,
    257,
    1023,
    1024,
    1025,
    65_535,
    (1 << 18) + 17,
    1 << 20,
    (1 << 20) + 4097,
    1 << 22,
];

/// Keys that a radix sort may stumble over, by name.
fn key_sets(n: u32) -> Vec<(&'static str, Vec<u32>)> {
    let mixed = |i: u32| i.wrapping_mul(2_654_435_761).rotate_left(13) ^ i;
    let make = |f: &dyn Fn(u32) -> u32| (0..n).map(f).collect();
    vec![
        ("mixed", make(&mixed)),
        ("equal", make(&|_| 0xdead_beef)),
        ("falling", make(&|i| u32::MAX - i)),
        ("two values", make(&|i| if mixed(i) & 1 == 0 { 0 } else { u32::MAX })),
        ("one digit", make(&|i| (mixed(i) & 0xff) << 16)),
        ("one odd one", make(&|i| u32::from(i == n / 2))),
    ]
}

/// Sorts on the device. The buffers have room for `capacity` pairs.
fn sort(gpu: &Gpu, keys: &[u32], capacity: u32) -> (Vec<u32>, Vec<u32>) {
    let kernels = &gpu.kernels().sort;
    let pairs = PairBuffers::new(gpu, ["keys", "values"], capacity).unwrap();
    let counts = gpu.storage("counts", 4 * counter::COUNT as u64).unwrap();
    let n = keys.len() as u32;
    gpu.queue().write_buffer(&counts, 4 * counter::VISIBLE as u64, bytemuck::bytes_of(&n));
    gpu.queue().write_buffer(&pairs.keys[0], 0, bytemuck::cast_slice(keys));
    let values: Vec<u32> = (0..n).collect();
    gpu.queue().write_buffer(&pairs.values[0], 0, bytemuck::cast_slice(&values));
    let plan =
        SortPlan::new(gpu, kernels, &pairs, &counts, counter::VISIBLE, &[0, 8, 16, 24], false)
            .unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for i in 0..plan.len() {
            // More workgroups than blocks, as a folded dispatch may have.
            let groups = Groups::Direct(n.div_ceil(plan.block) + 3);
            plan.record(kernels, &mut pass, i, groups);
        }
    }
    gpu.queue().submit([encoder.finish()]);
    let result = plan.len() % 2;
    let read = |buffer| readback::read(gpu, buffer, u64::from(n)).unwrap();
    (read(&pairs.keys[result]), read(&pairs.values[result]))
}

#[test]
fn keys_of_any_size_and_kind_are_sorted_stably() {
    let Some(gpu) = device() else { return };
    for n in SIZES {
        for (name, keys) in key_sets(n) {
            // The largest size once: software devices take a second for it.
            if n > 1 << 20 && name != "mixed" {
                continue;
            }
            let (sorted, values) = sort(&gpu, &keys, n.max(1));
            let mut expected: Vec<u32> = (0..n).collect();
            expected.sort_by_key(|&i| keys[i as usize]);
            assert!(values == expected, "{n} keys, {name}: values");
            let expected: Vec<u32> = expected.iter().map(|&i| keys[i as usize]).collect();
            assert!(sorted == expected, "{n} keys, {name}: keys");
        }
    }
}

#[test]
fn a_count_below_the_capacity_leaves_the_rest_alone() {
    let Some(gpu) = device() else { return };
    for (n, capacity) in [(0, 5000), (1, 1 << 20), (3000, 3001), (5000, 1 << 21)] {
        let keys: Vec<u32> = (0..n).map(|i: u32| i.wrapping_mul(0x9e37_79b9)).collect();
        let (sorted, _) = sort(&gpu, &keys, capacity);
        let mut expected = keys;
        expected.sort_unstable();
        assert!(sorted == expected, "{n} of {capacity}");
    }
}

#[test]
fn the_depth_sort_drops_what_is_not_drawn_and_orders_near_ties() {
    let Some(gpu) = device() else { return };
    const NOT_DRAWN: u32 = u32::MAX;
    for n in [1, 300, 5000, 70_000] {
        let keys: Vec<u32> = (0..n)
            .map(|i: u32| if i.is_multiple_of(3) { NOT_DRAWN } else { i.wrapping_mul(77) % 50 })
            .collect();
        let low: Vec<u32> = (0..n).map(|i: u32| i.wrapping_mul(31) % 7).collect();
        // The counter is set to the number that is drawn, as the arguments kernel does.
        let drawn: Vec<u32> = (0..n).filter(|&i| keys[i as usize] != NOT_DRAWN).collect();
        let mut expected = drawn.clone();
        expected.sort_by_key(|&i| (keys[i as usize], low[i as usize]));
        let values = depth_sort(&gpu, &keys, &low, drawn.len() as u32);
        assert!(values == expected, "{n} splats");
    }
}

/// The first pass over all splats, the others over those that are drawn.
fn depth_sort(gpu: &Gpu, keys: &[u32], low: &[u32], drawn: u32) -> Vec<u32> {
    let kernels = &gpu.kernels().sort;
    let n = keys.len() as u32;
    let pairs = PairBuffers::new(gpu, ["keys", "values"], n).unwrap();
    let counts = gpu.storage("counts", 4 * counter::COUNT as u64).unwrap();
    gpu.queue().write_buffer(&counts, 4 * counter::VISIBLE as u64, bytemuck::bytes_of(&drawn));
    gpu.queue().write_buffer(&pairs.keys[0], 0, bytemuck::cast_slice(keys));
    gpu.queue().write_buffer(&pairs.values[0], 0, bytemuck::cast_slice(low));
    let plan =
        SortPlan::new(gpu, kernels, &pairs, &counts, counter::VISIBLE, &[0, 8, 16, 24], true)
            .unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for i in 0..plan.len() {
            plan.record(kernels, &mut pass, i, Groups::Direct(n.div_ceil(plan.block)));
        }
    }
    gpu.queue().submit([encoder.finish()]);
    readback::read(gpu, &pairs.values[1], u64::from(drawn)).unwrap()
}
