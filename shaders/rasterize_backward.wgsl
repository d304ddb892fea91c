// The mirror of stage 5: ∂L/∂image → sums over the pixels of each tile entry.
//
// Needs: common/dispatch, common/region, common/blend.
//
// A tile is blended once more, front to back, by the functions of the forward pass, so both make
// the same decisions. What is behind a contributor is not accumulated from the back: the whole sum
// Σ w v of a pixel is known from the image, and each contributor is taken off it in turn. So
// nothing per contributor is stored between the passes and their number has no bound.
//
// One workgroup of 64 threads per tile, four pixels of a row per thread. Four splats make a round:
// every thread adds up its pixels' part in each of them (all that a row has in common, dy, comes
// later), the parts meet in workgroup memory, and the sums of an entry go into a slot of its own.
// No atomics, no subgroups; the order of every sum is fixed, so two runs give the same bits.

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var<storage, read> tile_starts: array<u32>;
@group(0) @binding(2) var<storage, read> entry_splats: array<u32>;
@group(0) @binding(3) var<storage, read> entry_slots: array<u32>;
@group(0) @binding(4) var<storage, read> centres: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> extents: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> colors: array<vec4<f32>>;
/// What the forward pass drew.
@group(0) @binding(7) var<storage, read> image: array<vec4<f32>>;
/// ∂L/∂(r, g, b premultiplied, alpha).
@group(0) @binding(8) var<storage, read> by_image: array<vec4<f32>>;
/// ∂L/∂ Σ w z and what the depth says about Σ w. One element unless DEPTH.
@group(0) @binding(9) var<storage, read> by_depth_sums: array<vec2<f32>>;
/// The sums of each entry: Σ w g (3), Σ q, Σ q dy, Σ q dy², Σ q v₁, Σ q v₁ dy, Σ q v₁², and with DEPTH
/// Σ w ∂L/∂(Σ w z), where w = αT, g = ∂L/∂rgb, and q = α ∂L/∂α where α is below its ceiling, else 0.
@group(0) @binding(10) var<storage, read_write> slots: array<f32>;

override DEPTH: bool = false;

const THREADS: u32 = 64u;
/// Entries that are fetched together.
const BATCH: u32 = 64u;
/// Splats of a round.
const ROUND: u32 = 4u;
/// Numbers of a thread's part: Σ w g (3), Σ q, Σ q v₁, Σ q v₁², Σ w by_weighted_depth.
const PARTS: u32 = 7u;
/// Words from one splat's parts to the next: neighbouring splats' are in other banks.
const PART_STRIDE: u32 = 464u;
/// Threads that add up the parts of one splat.
const ADDERS: u32 = 16u;
/// Words from one sum's terms to the next, likewise.
const TERM_STRIDE: u32 = 17u;

var<workgroup> batch_centres: array<vec4<f32>, 64>;
var<workgroup> batch_extents: array<vec4<f32>, 64>;
var<workgroup> batch_colors: array<vec4<f32>, 64>;
var<workgroup> batch_slots: array<u32, 64>;
var<workgroup> parts: array<f32, 1856>;
var<workgroup> terms: array<f32, 680>;
/// Whether any pixel is unfinished, of even and of odd batches.
var<workgroup> open_pixels: array<atomic<u32>, 2>;

/// Sums of an entry.
fn sum_count() -> u32 {
    return select(9u, 10u, DEPTH);
}

/// Four pixels of a row.
struct Pixels {
    /// T, as in the forward pass.
    transmittance: vec4<f32>,
    /// Σ w v of the contributors that are still to come, v what a unit of weight adds to L.
    behind: vec4<f32>,
    /// ∂L/∂ Σ w r, Σ w g, Σ w b, Σ w.
    by_red: vec4<f32>,
    by_green: vec4<f32>,
    by_blue: vec4<f32>,
    by_weight: vec4<f32>,
    /// ∂L/∂ Σ w z.
    by_weighted_depth: vec4<f32>,
}

/// One pixel of the image and of the gradients.
struct Pixel {
    transmittance: f32,
    behind: f32,
    by: vec4<f32>,
    by_weighted_depth: f32,
}

fn load_pixel(pixel: vec2<u32>, inside_region: bool) -> Pixel {
    if (!inside_region || any(pixel >= region.image)) {
        return Pixel(0.0, 0.0, vec4<f32>(0.0), 0.0);
    }
    let at = pixel - region.output_origin;
    let index = at.y * region.output_stride + at.x;
    var by = by_image[index];
    // The depth's two parts together add nothing.
    let behind = dot(by, image[index]);
    var by_weighted_depth = 0.0;
    if (DEPTH) {
        let by_sums = by_depth_sums[index];
        by_weighted_depth = by_sums.x;
        by.w += by_sums.y;
    }
    return Pixel(1.0, behind, by, by_weighted_depth);
}

fn load_pixels(first: vec2<u32>, inside_region: bool) -> Pixels {
    let a = load_pixel(first, inside_region);
    let b = load_pixel(first + vec2<u32>(1u, 0u), inside_region);
    let c = load_pixel(first + vec2<u32>(2u, 0u), inside_region);
    let d = load_pixel(first + vec2<u32>(3u, 0u), inside_region);
    return Pixels(
        vec4<f32>(a.transmittance, b.transmittance, c.transmittance, d.transmittance),
        vec4<f32>(a.behind, b.behind, c.behind, d.behind),
        vec4<f32>(a.by.x, b.by.x, c.by.x, d.by.x),
        vec4<f32>(a.by.y, b.by.y, c.by.y, d.by.y),
        vec4<f32>(a.by.z, b.by.z, c.by.z, d.by.z),
        vec4<f32>(a.by.w, b.by.w, c.by.w, d.by.w),
        vec4<f32>(
            a.by_weighted_depth, b.by_weighted_depth, c.by_weighted_depth, d.by_weighted_depth),
    );
}

/// Blends splat `i` of the batch into four pixels as the forward pass did, and stores their part in
/// its sums. `x`: columns, `y`: row of the pixels' centres.
fn blend_backward(
    pixels: ptr<function, Pixels>,
    i: u32,
    x: vec4<f32>,
    y: f32,
    thread: u32,
) {
    let centre = batch_centres[i];
    let extent = batch_extents[i];
    let part = (i % ROUND) * PART_STRIDE + thread;
    let dx = x - centre.x;
    let dy = y - centre.y;
    let a = place_of(centre, extent.x, vec2<f32>(dx.x, dy));
    let b = place_of(centre, extent.x, vec2<f32>(dx.y, dy));
    let c = place_of(centre, extent.x, vec2<f32>(dx.z, dy));
    let d = place_of(centre, extent.x, vec2<f32>(dx.w, dy));
    let before = (*pixels).transmittance;
    let seen = vec4<bool>(
        is_seen(a.power, extent.y),
        is_seen(b.power, extent.y),
        is_seen(c.power, extent.y),
        is_seen(d.power, extent.y),
    ) & (before > vec4<f32>(0.0));
    if (!any(seen)) {
        parts[part] = 0.0;
        parts[part + THREADS] = 0.0;
        parts[part + 2u * THREADS] = 0.0;
        parts[part + 3u * THREADS] = 0.0;
        parts[part + 4u * THREADS] = 0.0;
        parts[part + 5u * THREADS] = 0.0;
        if (DEPTH) {
            parts[part + 6u * THREADS] = 0.0;
        }
        return;
    }
    let zero = vec4<f32>(0.0);
    let free = vec4<f32>(
        free_alpha(a.power, extent.y),
        free_alpha(b.power, extent.y),
        free_alpha(c.power, extent.y),
        free_alpha(d.power, extent.y),
    );
    let alpha = select(zero, min(free, vec4<f32>(ALPHA_MAX)), seen);
    let after = vec4<f32>(
        transmittance_after(before.x, alpha.x),
        transmittance_after(before.y, alpha.y),
        transmittance_after(before.z, alpha.z),
        transmittance_after(before.w, alpha.w),
    );
    let stays_open =
        !vec4<bool>(fills(after.x), fills(after.y), fills(after.z), fills(after.w));
    let weight = select(zero, alpha * before, stays_open);
    (*pixels).transmittance = select(zero, after, stays_open);

    let color = batch_colors[i];
    var value = (*pixels).by_weight + (*pixels).by_red * color.x;
    value += (*pixels).by_green * color.y;
    value += (*pixels).by_blue * color.z;
    if (DEPTH) {
        value += (*pixels).by_weighted_depth * extent.z;
    }
    let behind = (*pixels).behind - weight * value;
    (*pixels).behind = behind;
    // α·∂L/∂α = T α v − α·behind / (1 − α) = w·(v − behind / T after), since w = T α and
    // T after = T (1 − α). At the ceiling α is a constant.
    let counts = seen & stays_open & (free < vec4<f32>(ALPHA_MAX));
    let left = select(vec4<f32>(1.0), after, counts);
    let q = select(zero, weight * (value - behind / left), counts);

    let v1 = vec4<f32>(a.v1, b.v1, c.v1, d.v1);
    let q_v = q * v1;
    let one = vec4<f32>(1.0);
    parts[part] = dot(weight, (*pixels).by_red);
    parts[part + THREADS] = dot(weight, (*pixels).by_green);
    parts[part + 2u * THREADS] = dot(weight, (*pixels).by_blue);
    parts[part + 3u * THREADS] = dot(q, one);
    parts[part + 4u * THREADS] = dot(q_v, one);
    parts[part + 5u * THREADS] = dot(q_v, v1);
    if (DEPTH) {
        parts[part + 6u * THREADS] = dot(weight, (*pixels).by_weighted_depth);
    }
}

/// What one adder has of a splat's sums.
struct Terms {
    color: vec3<f32>,
    /// Σ q, Σ q dy, Σ q dy².
    q: vec3<f32>,
    /// Σ q v₁, Σ q v₁ dy, Σ q v₁².
    q_v: vec3<f32>,
    depth: f32,
}

/// Adds the part of the thread whose parts start at `part`, whose row is `dy` from the centre.
fn add_part(sum: ptr<function, Terms>, part: u32, dy: f32) {
    let q = parts[part + 3u * THREADS];
    let q_v = parts[part + 4u * THREADS];
    (*sum).color += vec3<f32>(parts[part], parts[part + THREADS], parts[part + 2u * THREADS]);
    (*sum).q += vec3<f32>(q, q * dy, q * dy * dy);
    (*sum).q_v += vec3<f32>(q_v, q_v * dy, parts[part + 5u * THREADS]);
    if (DEPTH) {
        (*sum).depth += parts[part + 6u * THREADS];
    }
}

/// Adds up a quarter of a sum's terms.
fn four_terms(first: u32) -> f32 {
    return (terms[first] + terms[first + 1u]) + (terms[first + 2u] + terms[first + 3u]);
}

/// From the parts of the round's splats, the first of which is the batch's `first_splat`-th, to the
/// slots of their entries. `first_row`: the tile's first row of pixel centres.
fn store_sums(first_splat: u32, entries: u32, first_row: f32, thread: u32) {
    workgroupBarrier();
    {
        // The parts of thread u are of row u / 4: adder s takes rows s / 4, s / 4 + 4, ….
        let splat = thread / ADDERS;
        let adder = thread % ADDERS;
        let dy = first_row + f32(adder / 4u) - batch_centres[first_splat + splat].y;
        let part = splat * PART_STRIDE + adder;
        var sum = Terms(vec3<f32>(0.0), vec3<f32>(0.0), vec3<f32>(0.0), 0.0);
        add_part(&sum, part, dy);
        add_part(&sum, part + ADDERS, dy + 4.0);
        add_part(&sum, part + 2u * ADDERS, dy + 8.0);
        add_part(&sum, part + 3u * ADDERS, dy + 12.0);
        let term = splat * sum_count() * TERM_STRIDE + adder;
        terms[term] = sum.color.x;
        terms[term + TERM_STRIDE] = sum.color.y;
        terms[term + 2u * TERM_STRIDE] = sum.color.z;
        terms[term + 3u * TERM_STRIDE] = sum.q.x;
        terms[term + 4u * TERM_STRIDE] = sum.q.y;
        terms[term + 5u * TERM_STRIDE] = sum.q.z;
        terms[term + 6u * TERM_STRIDE] = sum.q_v.x;
        terms[term + 7u * TERM_STRIDE] = sum.q_v.y;
        terms[term + 8u * TERM_STRIDE] = sum.q_v.z;
        if (DEPTH) {
            terms[term + 9u * TERM_STRIDE] = sum.depth;
        }
    }
    workgroupBarrier();
    let splat = first_splat + thread / sum_count();
    if (thread < ROUND * sum_count() && splat < entries) {
        let term = thread * TERM_STRIDE;
        let sum = (four_terms(term) + four_terms(term + 4u))
            + (four_terms(term + 8u) + four_terms(term + 12u));
        slots[batch_slots[splat] * sum_count() + thread % sum_count()] = sum;
    }
}

/// Entries that no pixel came to.
fn clear_slots(first: u32, end: u32, thread: u32) {
    for (var entry = first + thread; entry < end; entry += THREADS) {
        let slot = entry_slots[entry] * sum_count();
        slots[slot] = 0.0;
        slots[slot + 1u] = 0.0;
        slots[slot + 2u] = 0.0;
        slots[slot + 3u] = 0.0;
        slots[slot + 4u] = 0.0;
        slots[slot + 5u] = 0.0;
        slots[slot + 6u] = 0.0;
        slots[slot + 7u] = 0.0;
        slots[slot + 8u] = 0.0;
        if (DEPTH) {
            slots[slot + 9u] = 0.0;
        }
    }
}

@compute @workgroup_size(64)
fn rasterize_backward(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let tile = flat_group(group, groups);
    let inside_region = tile < region.tiles.x * region.tiles.y;
    let column = region.first_tile.x + tile % region.tiles.x;
    let row = region.first_tile.y + tile / region.tiles.x;
    let corner = vec2<u32>(column, row) * TILE;
    let first_pixel = corner + vec2<u32>(thread % 4u * 4u, thread / 4u);
    let x = f32(first_pixel.x) + vec4<f32>(0.5, 1.5, 2.5, 3.5);
    let y = f32(first_pixel.y) + 0.5;
    let first_row = f32(corner.y) + 0.5;

    var first = 0u;
    var end = 0u;
    if (inside_region) {
        first = tile_starts[tile];
        end = tile_starts[tile + 1u];
    }
    var pixels = load_pixels(first_pixel, inside_region);
    if (thread < 2u) {
        atomicStore(&open_pixels[thread], 0u);
    }
    var parity = 0u;
    var batch = first;
    for (; batch < end; batch += BATCH) {
        // Nobody reads the last batch any more.
        workgroupBarrier();
        let entry = batch + thread;
        if (entry < end) {
            let splat = entry_splats[entry];
            batch_slots[thread] = entry_slots[entry];
            batch_centres[thread] = centres[splat];
            batch_extents[thread] = extents[splat];
            batch_colors[thread] = colors[splat];
        } else {
            // Seen nowhere.
            batch_centres[thread] = vec4<f32>(0.0);
            batch_extents[thread] = vec4<f32>(0.0, -1e3, 0.0, 0.0);
        }
        if (any(pixels.transmittance > vec4<f32>(0.0))) {
            atomicOr(&open_pixels[parity], 1u);
        }
        workgroupBarrier();
        if (atomicLoad(&open_pixels[parity]) == 0u) {
            break;
        }
        // The next batch's flag was last read before the barrier above.
        parity = 1u - parity;
        if (thread == 0u) {
            atomicStore(&open_pixels[parity], 0u);
        }
        let entries = min(BATCH, end - batch);
        for (var i = 0u; i < entries; i += ROUND) {
            blend_backward(&pixels, i, x, y, thread);
            blend_backward(&pixels, i + 1u, x, y, thread);
            blend_backward(&pixels, i + 2u, x, y, thread);
            blend_backward(&pixels, i + 3u, x, y, thread);
            store_sums(i, entries, first_row, thread);
        }
    }
    clear_slots(batch, end, thread);
}
