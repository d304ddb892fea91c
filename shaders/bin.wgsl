// Stage 4: which tiles each splat touches.
//
// Needs: common/dispatch, common/counters, common/scan, common/region, and common/entries or
// common/numbered_entries.
//
// Splats come in drawing order. A splat touches bands (rows of tiles), and in each band a run of
// tiles, by the exact interval of x in which its ellipse meets the band's strip of pixel centres.
// A workgroup takes 64 splats, lays their bands side by side and gives one to each thread, so that
// a splat which covers the screen is shared out; then it lays the tiles of 256 bands side by side
// and writes them in the same way. `count` only counts, `offset` turns counts into positions,
// `emit` writes (tile, splat) pairs; within a tile they stay in drawing order.

@group(0) @binding(0) var<uniform> region: Region;
/// Indices of the splats in drawing order.
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> centres: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> extents: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> counts: array<u32>;
/// Entries of each group of 64 splats; after `offset`, where they start.
@group(0) @binding(5) var<storage, read_write> group_entries: array<u32>;

const SPLATS_PER_GROUP: u32 = 64u;
const LOG2_255: f32 = 7.994353437;
/// Slack in pixels on all sides of an ellipse's exact interval: rounding in the interval, which is
/// relative to the distances involved, must not lose a pixel that the α test would keep.
const SLACK: f32 = 0.01;

/// The group's splats: centre and U's first row; U's second row, log₂ opacity, half height.
var<workgroup> group_centres: array<vec4<f32>, 64>;
var<workgroup> group_extents: array<vec4<f32>, 64>;
var<workgroup> group_splats: array<u32, 64>;
/// First band of each splat, and the number of bands of the splats up to and including it.
var<workgroup> first_bands: array<u32, 64>;
var<workgroup> band_sums: array<u32, 64>;
var<workgroup> all_bands: u32;

/// Loads the group's splats. All threads take part; ends with a barrier.
fn load_group(group: u32, thread: u32) {
    var bands = vec2<u32>(0u);
    if (thread < SPLATS_PER_GROUP) {
        let rank = group * SPLATS_PER_GROUP + thread;
        if (rank < counts[VISIBLE]) {
            let splat = order[rank];
            let extent = extents[splat];
            let centre = centres[splat];
            group_splats[thread] = splat;
            group_centres[thread] = centre;
            group_extents[thread] = vec4<f32>(extent.xy, extent.w, 0.0);
            bands = bands_of(centre.y, extent.w);
            first_bands[thread] = bands.x;
        }
    }
    let sum = inclusive_scan(thread, bands.y - bands.x);
    if (thread < SPLATS_PER_GROUP) {
        band_sums[thread] = sum;
    }
    if (thread == 0u) {
        all_bands = scan_values[255];
    }
    workgroupBarrier();
}

/// Bands of the region that hold a pixel centre inside the splat's box: first, and one after the
/// last.
fn bands_of(y: f32, half_height: f32) -> vec2<u32> {
    let size = f32(TILE);
    let first = floor(floor(y - half_height - 0.5) / size);
    let last = floor(ceil(y + half_height - 0.5) / size);
    let low = f32(region.first_tile.y);
    let high = f32(region.first_tile.y + region.tiles.y);
    let from_band = clamp(first, low, high);
    let to_band = clamp(last + 1.0, from_band, high);
    return vec2<u32>(u32(from_band), u32(to_band));
}

/// The splat (0 … 63) that has the group's `item`-th band.
fn splat_of_band(item: u32) -> u32 {
    var splat = 0u;
    for (var step = SPLATS_PER_GROUP / 2u; step > 0u; step /= 2u) {
        if (band_sums[splat + step - 1u] <= item) {
            splat += step;
        }
    }
    return splat;
}

struct TileRun {
    /// Tile number of the first tile in the region.
    first: u32,
    count: u32,
}

/// Tiles that the group's `item`-th band contributes.
fn tile_run(item: u32, splat: u32) -> TileRun {
    var before = 0u;
    if (splat > 0u) {
        before = band_sums[splat - 1u];
    }
    let band = first_bands[splat] + item - before;
    let interval = x_interval(group_centres[splat], group_extents[splat], band);
    // Tile t holds pixel centres from 16 t + 0.5 to 16 t + 15.5.
    let low = f32(region.first_tile.x);
    let high = f32(region.first_tile.x + region.tiles.x);
    let first = floor((interval.x - 0.5) / f32(TILE));
    let last = floor((interval.y - 0.5) / f32(TILE));
    let from_tile = clamp(first, low, high);
    let to_tile = clamp(last + 1.0, from_tile, high);
    let row = (band - region.first_tile.y) * region.tiles.x;
    return TileRun(row + u32(from_tile) - region.first_tile.x, u32(to_tile - from_tile));
}

/// Interval of x in which the ellipse α ≥ 1/255 meets a band's strip of pixel centres, with slack;
/// empty (max before min) when it does not.
///
/// On the ellipse at height dy, x = centre + slope·dy ± √(cutoff − (u22 dy)²) / u11. Over the strip
/// the extremes are at the ellipse's own left and right ends if those lie inside, else at the
/// nearer edge: the ellipse is convex.
fn x_interval(centre: vec4<f32>, extent: vec4<f32>, band: u32) -> vec2<f32> {
    let u11 = centre.z;
    let u12 = centre.w;
    let u22 = extent.x;
    let half_height = extent.z;
    let y_first = f32(band * TILE) + 0.5;
    let y_last = y_first + f32(TILE - 1u);
    let low = max(y_first - SLACK - centre.y, -half_height);
    let high = min(y_last + SLACK - centre.y, half_height);
    if (low > high) {
        return vec2<f32>(1.0, -1.0e9);
    }
    let slope = -u12 / u11;
    let cutoff = max(extent.y + LOG2_255, 0.0);
    // Where the ellipse's right end is; the left end mirrors it.
    let slope_u22 = slope * u11 / u22;
    let right_end = slope_u22 * sqrt(cutoff) / (u22 * sqrt(1.0 + slope_u22 * slope_u22));
    let at_right = clamp(right_end, low, high);
    let at_left = clamp(-right_end, low, high);
    let right = centre.x + slope * at_right + half_width_at(at_right, u11, u22, cutoff);
    let left = centre.x + slope * at_left - half_width_at(at_left, u11, u22, cutoff);
    // Relative slack for splats that reach far.
    let slack = SLACK + 1.0e-5 * (right - left);
    return vec2<f32>(left - slack, right + slack);
}

fn half_width_at(dy: f32, u11: f32, u22: f32, cutoff: f32) -> f32 {
    let v = u22 * dy;
    return sqrt(max(cutoff - v * v, 0.0)) / u11;
}

@compute @workgroup_size(256)
fn count(
    @builtin(workgroup_id) group_id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = flat_group(group_id, groups);
    load_group(group, thread);
    var entries = 0u;
    for (var item = thread; item < all_bands; item += 256u) {
        entries = saturating_add(entries, tile_run(item, splat_of_band(item)).count);
    }
    workgroupBarrier();
    let sum = inclusive_scan(thread, entries);
    if (thread == 255u && group * SPLATS_PER_GROUP < counts[VISIBLE]) {
        group_entries[group] = sum;
    }
}

/// Runs of tiles of 256 bands: their splats and first tiles.
var<workgroup> run_splats: array<u32, 256>;
var<workgroup> run_tiles: array<u32, 256>;

@compute @workgroup_size(256)
fn emit(
    @builtin(workgroup_id) group_id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = flat_group(group_id, groups);
    load_group(group, thread);
    var position = 0u;
    if (group * SPLATS_PER_GROUP < counts[VISIBLE]) {
        position = group_entries[group];
    }
    let bands = all_bands;
    for (var first_item = 0u; first_item < bands; first_item += 256u) {
        let item = first_item + thread;
        var run = TileRun(0u, 0u);
        if (item < bands) {
            let splat = splat_of_band(item);
            run = tile_run(item, splat);
            run_splats[thread] = group_splats[splat];
        }
        let sum = inclusive_scan(thread, run.count);
        // The tile of a run's entry e is run_tiles + e.
        run_tiles[thread] = run.first - (sum - run.count);
        workgroupBarrier();
        let entries = scan_values[255];
        for (var entry = thread; entry < entries; entry += 256u) {
            let run_index = run_of_entry(entry);
            let target_index = position + entry;
            if (target_index < region.capacity) {
                write_entry(target_index, run_tiles[run_index] + entry, run_splats[run_index]);
            }
        }
        position += entries;
        workgroupBarrier();
    }
}

/// The run that holds the `entry`-th tile of the runs side by side: the first whose running sum
/// (in `scan_values`) is above it.
fn run_of_entry(entry: u32) -> u32 {
    var run = 0u;
    for (var step = 128u; step > 0u; step /= 2u) {
        if (scan_values[run + step - 1u] <= entry) {
            run += step;
        }
    }
    return run;
}
