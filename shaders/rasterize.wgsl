// Stage 5: blending, front to back (Porter & Duff 1984; Kerbl et al. 2023).
//
// Needs: common/dispatch, common/region, common/blend.
//
// One workgroup per tile, one thread per pixel. The workgroup fetches its splats 256 at a time;
// each pixel blends them in drawing order, four to a turn of the loop, until a blend would leave
// T ≤ 10⁻⁴, and the workgroup ends when all its pixels have.

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var<storage, read> tile_starts: array<u32>;
@group(0) @binding(2) var<storage, read> entry_splats: array<u32>;
@group(0) @binding(3) var<storage, read> centres: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> extents: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> colors: array<vec4<f32>>;
/// Premultiplied r g b, and alpha = 1 − T.
@group(0) @binding(6) var<storage, read_write> image: array<vec4<f32>>;
/// Bits of expected and median depth, top contributor, its cluster's label. One element when
/// neither DEPTH nor TOP_CONTRIBUTOR.
@group(0) @binding(7) var<storage, read_write> layers: array<vec4<u32>>;

override DEPTH: bool = false;
override TOP_CONTRIBUTOR: bool = false;

/// Largest alpha of a pixel: 1 − 10⁻⁴, rounded down. T stays above its minimum by rule; rounding
/// in the sum of weights must not say otherwise.
const MAX_IMAGE_ALPHA: f32 = 0.9999;
const MAX_FLOAT: f32 = 3.4028234e38;
const NAN_BITS: u32 = 0x7fc00000u;
const NO_SPLAT: u32 = 0xffffffffu;

var<workgroup> batch_centres: array<vec4<f32>, 256>;
var<workgroup> batch_extents: array<vec4<f32>, 256>;
var<workgroup> batch_colors: array<vec4<f32>, 256>;
var<workgroup> batch_splats: array<u32, 256>;
/// Whether any pixel is unfinished, of even and of odd batches.
var<workgroup> open_pixels: array<atomic<u32>, 2>;

/// What has been accumulated in one pixel.
struct Pixel {
    /// T; 0 once a blend would have left too little, after which nothing has weight.
    transmittance: f32,
    color: vec3<f32>,
    weight: f32,
    weighted_depth: f32,
    median_depth: u32,
    top_weight: f32,
    top: u32,
    top_label: u32,
}

/// Blends splat `i` of the batch.
fn blend(pixel: ptr<function, Pixel>, i: u32, point: vec2<f32>) {
    let centre = batch_centres[i];
    let extent = batch_extents[i];
    let power = place_of(centre, extent.x, point - centre.xy).power;
    if (!is_seen(power, extent.y)) {
        return;
    }
    let before = (*pixel).transmittance;
    let alpha = min(free_alpha(power, extent.y), ALPHA_MAX);
    let full = alpha * before;
    let after = transmittance_after(before, alpha);
    if (fills(after)) {
        (*pixel).transmittance = 0.0;
        return;
    }
    let color = batch_colors[i];
    (*pixel).color += full * color.xyz;
    (*pixel).weight += full;
    if (DEPTH) {
        (*pixel).weighted_depth += full * extent.z;
        if (before > 0.5 && after <= 0.5) {
            (*pixel).median_depth = bitcast<u32>(extent.z);
        }
    }
    if (TOP_CONTRIBUTOR) {
        if (full > (*pixel).top_weight) {
            (*pixel).top_weight = full;
            (*pixel).top = batch_splats[i];
            (*pixel).top_label = bitcast<u32>(color.w);
        }
    }
    (*pixel).transmittance = after;
}

@compute @workgroup_size(256)
fn rasterize(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let tile = flat_group(group, groups);
    let inside_region = tile < region.tiles.x * region.tiles.y;
    let column = region.first_tile.x + tile % region.tiles.x;
    let row = region.first_tile.y + tile / region.tiles.x;
    let pixel = vec2<u32>(column, row) * TILE + vec2<u32>(thread % TILE, thread / TILE);
    let inside = inside_region && all(pixel < region.image);
    let point = vec2<f32>(pixel) + 0.5;

    var first = 0u;
    var end = 0u;
    if (inside_region) {
        first = tile_starts[tile];
        end = tile_starts[tile + 1u];
    }

    var state = Pixel(
        select(0.0, 1.0, inside), vec3<f32>(0.0), 0.0, 0.0, NAN_BITS, 0.0, NO_SPLAT, 0u);
    if (thread < 2u) {
        atomicStore(&open_pixels[thread], 0u);
    }
    var parity = 0u;
    for (var batch = first; batch < end; batch += 256u) {
        // Nobody reads the last batch any more.
        workgroupBarrier();
        let entry = batch + thread;
        if (entry < end) {
            let splat = entry_splats[entry];
            batch_centres[thread] = centres[splat];
            batch_extents[thread] = extents[splat];
            batch_colors[thread] = colors[splat];
            if (TOP_CONTRIBUTOR) {
                batch_splats[thread] = splat;
            }
        } else {
            // Seen nowhere.
            batch_centres[thread] = vec4<f32>(0.0);
            batch_extents[thread] = vec4<f32>(0.0, -1e3, 0.0, 0.0);
        }
        if (state.transmittance > 0.0) {
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
        let size = min(256u, end - batch);
        for (var i = 0u; i < size && state.transmittance > 0.0; i += 4u) {
            blend(&state, i, point);
            blend(&state, i + 1u, point);
            blend(&state, i + 2u, point);
            blend(&state, i + 3u, point);
        }
    }

    if (inside) {
        let at = pixel - region.output_origin;
        let index = at.y * region.output_stride + at.x;
        image[index] = vec4<f32>(state.color, min(state.weight, MAX_IMAGE_ALPHA));
        if (DEPTH || TOP_CONTRIBUTOR) {
            var expected = NAN_BITS;
            if (state.weight > 0.0) {
                // A quotient of finite sums, which rounding must not carry past the largest float.
                expected = bitcast<u32>(min(state.weighted_depth / state.weight, MAX_FLOAT));
            }
            layers[index] = vec4<u32>(expected, state.median_depth, state.top, state.top_label);
        }
    }
}
