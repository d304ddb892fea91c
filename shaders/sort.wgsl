// Stable radix sort of (key, value) pairs, eight bits a pass, least significant first.
//
// Needs: common/dispatch, common/counters, common/scan.
//
// A pass is three dispatches: `histogram` counts the digits of each block of keys, `scan_digits`
// turns the counts of each digit into positions, `scatter` moves the pairs. Nothing waits for
// another workgroup, so no forward progress is assumed, and no subgroup operation is used: lanes
// with the same digit find each other through bit masks in workgroup memory. The result does not
// depend on the order in which the masks' bits are set, so it is the same in every run.
//
// How many pairs there are is read from `counts`; the first pass of the depth sort also drops the
// splats that are not drawn, and makes the values of the others.

struct SortPass {
    /// Lowest bit of the digit.
    shift: u32,
    /// Index in `counts` of the number of pairs; with DROPS_NOT_DRAWN, that number itself.
    count: u32,
    /// Keys per thread; a block is 256 times as many.
    keys_per_thread: u32,
    /// Blocks that the histogram has room for.
    max_blocks: u32,
}

@group(0) @binding(0) var<uniform> sort_pass: SortPass;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> keys_in: array<u32>;
@group(0) @binding(3) var<storage, read> values_in: array<u32>;
@group(0) @binding(4) var<storage, read_write> keys_out: array<u32>;
@group(0) @binding(5) var<storage, read_write> values_out: array<u32>;
/// Digit-major: counts of digit d in block b at d · max_blocks + b.
@group(0) @binding(6) var<storage, read_write> block_counts: array<u32>;
/// Pairs with each digit.
@group(0) @binding(7) var<storage, read_write> digit_counts: array<u32>;

/// First pass of the depth sort: pair i is (keys_in[i], i), its digit are the low bits that
/// values_in[i] holds, and pairs with the key NOT_DRAWN are left out.
override DROPS_NOT_DRAWN: bool = false;

const DIGITS: u32 = 256u;
const NOT_DRAWN: u32 = 0xffffffffu;

fn pair_count() -> u32 {
    if (DROPS_NOT_DRAWN) {
        return sort_pass.count;
    }
    return counts[sort_pass.count];
}

fn is_kept(key: u32) -> bool {
    return !DROPS_NOT_DRAWN || key != NOT_DRAWN;
}

fn digit_of(i: u32, key: u32) -> u32 {
    if (DROPS_NOT_DRAWN) {
        return values_in[i] & 0xffu;
    }
    return (key >> sort_pass.shift) & 0xffu;
}

var<workgroup> block_histogram: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn histogram(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let block = flat_group(group, groups);
    let count = pair_count();
    atomicStore(&block_histogram[thread], 0u);
    workgroupBarrier();
    for (var round = 0u; round < sort_pass.keys_per_thread; round++) {
        let i = (block * sort_pass.keys_per_thread + round) * 256u + thread;
        if (i < count) {
            let key = keys_in[i];
            if (is_kept(key)) {
                atomicAdd(&block_histogram[digit_of(i, key)], 1u);
            }
        }
    }
    workgroupBarrier();
    if (block < sort_pass.max_blocks) {
        block_counts[thread * sort_pass.max_blocks + block] = atomicLoad(&block_histogram[thread]);
    }
}

/// One workgroup per digit: counts of blocks → positions within the digit.
@compute @workgroup_size(256)
fn scan_digits(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let row = group.x * sort_pass.max_blocks;
    let blocks = divide_up(pair_count(), sort_pass.keys_per_thread * 256u);
    var before = 0u;
    for (var first = 0u; first < blocks; first += SCAN_WIDTH) {
        let block = first + thread;
        var count = 0u;
        if (block < blocks) {
            count = block_counts[row + block];
        }
        let sum = inclusive_scan(thread, count);
        if (block < blocks) {
            block_counts[row + block] = before + sum - count;
        }
        before += scan_values[255];
        scan_barrier();
    }
    if (thread == 0u) {
        digit_counts[group.x] = before;
    }
}

/// For each digit, which of the 256 threads hold it: eight words of 32 bits.
var<workgroup> holders: array<atomic<u32>, 2048>;
/// For each digit, where its next pair goes.
var<workgroup> next_position: array<u32, 256>;

@compute @workgroup_size(256)
fn scatter(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let block = flat_group(group, groups);
    let count = pair_count();
    let of_digit = digit_counts[thread];
    let first_of_digit = inclusive_scan(thread, of_digit) - of_digit;
    let in_digit = block_counts[thread * sort_pass.max_blocks + min(block, sort_pass.max_blocks - 1u)];
    next_position[thread] = first_of_digit + in_digit;
    for (var word = thread; word < 2048u; word += 256u) {
        atomicStore(&holders[word], 0u);
    }
    workgroupBarrier();

    let own_word = thread / 32u;
    let own_bit = 1u << (thread % 32u);
    for (var round = 0u; round < sort_pass.keys_per_thread; round++) {
        let i = (block * sort_pass.keys_per_thread + round) * 256u + thread;
        var key = 0u;
        var digit = 0u;
        var kept = false;
        if (i < count) {
            key = keys_in[i];
            kept = is_kept(key);
            digit = digit_of(i, key);
        }
        if (kept) {
            atomicOr(&holders[digit * 8u + own_word], own_bit);
        }
        workgroupBarrier();
        var position = 0u;
        var is_last = false;
        if (kept) {
            // Threads before this one with the same digit, and all with it.
            var before = 0u;
            var all = 0u;
            for (var word = 0u; word < 8u; word++) {
                let bits = atomicLoad(&holders[digit * 8u + word]);
                let here = countOneBits(bits);
                all += here;
                if (word < own_word) {
                    before += here;
                } else if (word == own_word) {
                    before += countOneBits(bits & (own_bit - 1u));
                }
            }
            position = next_position[digit] + before;
            is_last = before + 1u == all;
        }
        workgroupBarrier();
        if (kept) {
            atomicStore(&holders[digit * 8u + own_word], 0u);
            if (is_last) {
                next_position[digit] = position + 1u;
            }
            keys_out[position] = key;
            if (DROPS_NOT_DRAWN) {
                values_out[position] = i;
            } else {
                values_out[position] = values_in[i];
            }
        }
        workgroupBarrier();
    }
}
