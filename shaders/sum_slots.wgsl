// From the sums of tile entries to the sums of splats, without atomics and in a fixed order.
//
// Needs: common/dispatch, common/counters, common/splat_count.
//
// Slots are in the order of splats, so a splat's are a run. `sum_chunks` adds up the part of each
// run in each chunk of 256 slots, by doubling distances (Hillis & Steele 1986), and leaves it in
// the part's first slot; `sum_splats` adds the parts of a run: one, unless it crosses chunks.

@group(0) @binding(0) var<uniform> splats: SplatCount;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read> slot_splats: array<u32>;
@group(0) @binding(3) var<storage, read_write> slots: array<f32>;
@group(0) @binding(4) var<storage, read_write> first_slots: array<u32>;
/// Σ w g and Σ w ∂L/∂(Σ w z); Σ q, Σ q dy, Σ q dy², Σ q v₁; Σ q v₁ dy, Σ q v₁², whether there is any.
@group(0) @binding(5) var<storage, read_write> sums: array<vec4<f32>>;

override DEPTH: bool = false;

const CHUNK: u32 = 256u;
const NO_SLOT: u32 = 0xffffffffu;

var<workgroup> chunk_a: array<vec4<f32>, 256>;
var<workgroup> chunk_b: array<vec4<f32>, 256>;
var<workgroup> chunk_c: array<vec2<f32>, 256>;
var<workgroup> chunk_splats: array<u32, 256>;

struct SlotSums {
    a: vec4<f32>,
    b: vec4<f32>,
    /// The second only with DEPTH.
    c: vec2<f32>,
}

fn sum_count() -> u32 {
    return select(9u, 10u, DEPTH);
}

fn load_slot(slot: u32) -> SlotSums {
    let at = slot * sum_count();
    var depth = 0.0;
    if (DEPTH) {
        depth = slots[at + 9u];
    }
    return SlotSums(
        vec4<f32>(slots[at], slots[at + 1u], slots[at + 2u], slots[at + 3u]),
        vec4<f32>(slots[at + 4u], slots[at + 5u], slots[at + 6u], slots[at + 7u]),
        vec2<f32>(slots[at + 8u], depth),
    );
}

fn store_slot(slot: u32, value: SlotSums) {
    let at = slot * sum_count();
    slots[at] = value.a.x;
    slots[at + 1u] = value.a.y;
    slots[at + 2u] = value.a.z;
    slots[at + 3u] = value.a.w;
    slots[at + 4u] = value.b.x;
    slots[at + 5u] = value.b.y;
    slots[at + 6u] = value.b.z;
    slots[at + 7u] = value.b.w;
    slots[at + 8u] = value.c.x;
    if (DEPTH) {
        slots[at + 9u] = value.c.y;
    }
}

/// Adds to each thread's sums those of the threads behind it that have the same splat, up to twice
/// the distance it had.
fn add_behind(value: SlotSums, thread: u32, distance: u32) -> SlotSums {
    chunk_a[thread] = value.a;
    chunk_b[thread] = value.b;
    chunk_c[thread] = value.c;
    workgroupBarrier();
    var sum = value;
    let other = thread + distance;
    if (other < CHUNK) {
        if (chunk_splats[other] == chunk_splats[thread]) {
            sum = SlotSums(
                value.a + chunk_a[other], value.b + chunk_b[other], value.c + chunk_c[other]);
        }
    }
    workgroupBarrier();
    return sum;
}

@compute @workgroup_size(256)
fn sum_chunks(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let slot = flat_group(group, groups) * CHUNK + thread;
    let inside = slot < counts[SORTED_ENTRIES];
    // No splat has this index: the slots behind the last entry are a run of their own.
    var splat = NO_SLOT;
    var value = SlotSums(vec4<f32>(0.0), vec4<f32>(0.0), vec2<f32>(0.0));
    if (inside) {
        splat = slot_splats[slot];
        value = load_slot(slot);
    }
    chunk_splats[thread] = splat;
    value = add_behind(value, thread, 1u);
    value = add_behind(value, thread, 2u);
    value = add_behind(value, thread, 4u);
    value = add_behind(value, thread, 8u);
    value = add_behind(value, thread, 16u);
    value = add_behind(value, thread, 32u);
    value = add_behind(value, thread, 64u);
    value = add_behind(value, thread, 128u);
    if (!inside) {
        return;
    }
    var starts_run = true;
    var starts_part = true;
    if (slot > 0u) {
        starts_run = slot_splats[slot - 1u] != splat;
        starts_part = starts_run || thread == 0u;
    }
    if (starts_part) {
        store_slot(slot, value);
    }
    if (starts_run) {
        first_slots[splat] = slot;
    }
}

@compute @workgroup_size(256)
fn sum_splats(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let splat = flat_group(group, groups) * 256u + thread;
    if (splat >= splats.count) {
        return;
    }
    let first = first_slots[splat];
    if (first == NO_SLOT) {
        sums[3u * splat] = vec4<f32>(0.0);
        sums[3u * splat + 1u] = vec4<f32>(0.0);
        sums[3u * splat + 2u] = vec4<f32>(0.0);
        return;
    }
    var total = load_slot(first);
    let end = counts[SORTED_ENTRIES];
    for (var slot = (first / CHUNK + 1u) * CHUNK; slot < end; slot += CHUNK) {
        if (slot_splats[slot] != splat) {
            break;
        }
        let part = load_slot(slot);
        total = SlotSums(total.a + part.a, total.b + part.b, total.c + part.c);
    }
    sums[3u * splat] = vec4<f32>(total.a.xyz, total.c.y);
    sums[3u * splat + 1u] = vec4<f32>(total.a.w, total.b.xyz);
    sums[3u * splat + 2u] = vec4<f32>(total.b.w, total.c.x, 1.0, 0.0);
}
