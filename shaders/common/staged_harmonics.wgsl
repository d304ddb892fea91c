// The coefficients of 64 splats in workgroup memory: in their file's layout a splat's are far apart
// for neighbouring threads, and near each other for one thread after the other.
//
// Needs: common/splat_count, and the bindings `splats`, `sh_dc` and `sh_rest`.

const STAGED_SPLATS: u32 = 64u;
/// Floats of bands 1 to 3.
const MOST_REST: u32 = 45u;

/// Bands 1…`splats.degree`, splat by splat.
var<workgroup> staged_rest: array<f32, 2880>;
/// Whether the coefficients of a splat are wanted.
var<workgroup> staged_wanted: array<u32, 64>;

/// Loads the coefficients of the group's splats that are wanted. All 64 threads take part.
fn stage_rest(group: u32, thread: u32, wanted: bool) {
    staged_wanted[thread] = select(0u, 1u, wanted);
    workgroupBarrier();
    let floats = rest_floats(splats.degree);
    let stride = rest_floats(splats.stored_degree);
    let first = group * STAGED_SPLATS * stride;
    for (var i = thread; i < STAGED_SPLATS * floats; i += STAGED_SPLATS) {
        let at = i / floats;
        if (staged_wanted[at] != 0u) {
            staged_rest[i] = sh_rest[first + at * stride + i % floats];
        }
    }
    workgroupBarrier();
}

/// r g b of coefficient `k` of the splat that is the group's `at`-th.
fn coefficients(at: u32, k: u32) -> vec3<f32> {
    if (k == 0u) {
        return staged_dc;
    }
    let first = at * rest_floats(splats.degree) + 3u * (k - 1u);
    return vec3<f32>(staged_rest[first], staged_rest[first + 1u], staged_rest[first + 2u]);
}

/// Band 0 of this thread's splat.
var<private> staged_dc: vec3<f32>;

fn load_dc(splat: u32) -> vec3<f32> {
    return vec3<f32>(sh_dc[3u * splat], sh_dc[3u * splat + 1u], sh_dc[3u * splat + 2u]);
}
