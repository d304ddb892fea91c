// The mirror of stage 2's colours: sums over the pixels of each splat → ∂L/∂(SH coefficients,
// opacity logit), and what the direction adds to ∂L/∂position.
//
// Needs: common/dispatch, common/frame, common/numbers, common/projection, common/harmonics,
// common/activation, common/splat_count, common/staged_harmonics.
//
// One thread per splat; the coefficients and their gradients pass through workgroup memory. Runs
// after project_backward.wgsl, which has written ∂L/∂position.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> splats: SplatCount;
@group(0) @binding(2) var<storage, read> positions: array<f32>;
@group(0) @binding(3) var<storage, read> sh_dc: array<f32>;
@group(0) @binding(4) var<storage, read> sh_rest: array<f32>;
@group(0) @binding(5) var<storage, read> opacity_logits: array<f32>;
/// See sum_slots.wgsl.
@group(0) @binding(6) var<storage, read> sums: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> by_positions: array<f32>;
@group(0) @binding(8) var<storage, read_write> by_sh_dc: array<f32>;
@group(0) @binding(9) var<storage, read_write> by_sh_rest: array<f32>;
@group(0) @binding(10) var<storage, read_write> by_opacity_logits: array<f32>;

/// By the basis function that an index names, for each of the channels that move: Yₖ · by_color.
fn store_basis(at: u32, k: u32, by_color: vec3<f32>, basis: f32) {
    let first = at * rest_floats(splats.degree) + 3u * (k - 1u);
    staged_rest[first] = by_color.x * basis;
    staged_rest[first + 1u] = by_color.y * basis;
    staged_rest[first + 2u] = by_color.z * basis;
}

/// Takes coefficient `k` out of the stage and puts its gradient there; returns ∂L/∂Yₖ.
fn exchange(at: u32, k: u32, by_color: vec3<f32>, basis: f32) -> f32 {
    let coefficient = coefficients(at, k);
    store_basis(at, k, by_color, basis);
    // A channel that moves has finite coefficients; the others' may be anything.
    let still = by_color == vec3<f32>(0.0);
    return dot(by_color, select(coefficient, vec3<f32>(0.0), still));
}

/// Replaces the staged coefficients of bands 1…degree by their gradients, and returns
/// Σ (∂L/∂Yₖ) ∂Yₖ/∂d, each component of the direction d taken as free.
fn bands_backward(at: u32, d: vec3<f32>, by_color: vec3<f32>) -> vec3<f32> {
    let degree = splats.degree;
    if (degree == 0u) {
        return vec3<f32>(0.0);
    }
    let y1 = exchange(at, 1u, by_color, -SH_C1 * d.y);
    let y2 = exchange(at, 2u, by_color, SH_C1 * d.z);
    let y3 = exchange(at, 3u, by_color, -SH_C1 * d.x);
    var sum = SH_C1 * vec3<f32>(-y3, -y1, y2);
    if (degree == 1u) {
        return sum;
    }
    let s = d * d;
    let a = 1.0925485 * exchange(at, 4u, by_color, 1.0925485 * d.x * d.y);
    let b = -1.0925485 * exchange(at, 5u, by_color, -1.0925485 * d.y * d.z);
    let c = 0.31539157 * exchange(at, 6u, by_color, 0.31539157 * (2.0 * s.z - s.x - s.y));
    let e = -1.0925485 * exchange(at, 7u, by_color, -1.0925485 * d.x * d.z);
    let f = 0.54627424 * exchange(at, 8u, by_color, 0.54627424 * (s.x - s.y));
    sum += vec3<f32>(
        a * d.y - 2.0 * c * d.x + e * d.z + 2.0 * f * d.x,
        a * d.x + b * d.z - 2.0 * c * d.y - 2.0 * f * d.y,
        b * d.y + 4.0 * c * d.z + e * d.x,
    );
    if (degree == 2u) {
        return sum;
    }
    let difference = s.x - s.y;
    let flat = 4.0 * s.z - s.x - s.y;
    let h0 = -0.5900436 * exchange(at, 9u, by_color, -0.5900436 * d.y * (3.0 * s.x - s.y));
    let h1 = 2.8906114 * exchange(at, 10u, by_color, 2.8906114 * d.x * d.y * d.z);
    let h2 = -0.4570458 * exchange(at, 11u, by_color, -0.4570458 * d.y * flat);
    let h3 = 0.37317634
        * exchange(at, 12u, by_color, 0.37317634 * d.z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y));
    let h4 = -0.4570458 * exchange(at, 13u, by_color, -0.4570458 * d.x * flat);
    let h5 = 1.4453057 * exchange(at, 14u, by_color, 1.4453057 * d.z * difference);
    let h6 = -0.5900436 * exchange(at, 15u, by_color, -0.5900436 * d.x * (s.x - 3.0 * s.y));
    let xy = d.x * d.y;
    let yz = d.y * d.z;
    let xz = d.x * d.z;
    sum += vec3<f32>(
        6.0 * h0 * xy + h1 * yz - 2.0 * h2 * xy - 6.0 * h3 * xz
            + h4 * (4.0 * s.z - 3.0 * s.x - s.y) + 2.0 * h5 * xz + 3.0 * h6 * difference,
        3.0 * h0 * difference + h1 * xz + h2 * (4.0 * s.z - s.x - 3.0 * s.y) - 6.0 * h3 * yz
            - 2.0 * h4 * xy - 2.0 * h5 * yz - 6.0 * h6 * xy,
        h1 * xy + 8.0 * h2 * yz + h3 * (6.0 * s.z - 3.0 * (s.x + s.y)) + 8.0 * h4 * xz
            + h5 * difference,
    );
    return sum;
}

/// Whether a channel is inside its limits.
fn is_free(channel: f32) -> bool {
    return channel > 0.0 && channel < MAX_CHANNEL && !is_nan(channel);
}

/// The gradients of a splat that pixels saw, but for the bands above 0, which go to the stage.
fn seen_backward(splat: u32, at: u32) -> array<vec3<f32>, 2> {
    staged_dc = load_dc(splat);
    let position =
        vec3<f32>(positions[3u * splat], positions[3u * splat + 1u], positions[3u * splat + 2u]);
    let to_splat = from_camera(position);
    let d = direction(to_splat);
    // Channels at their limits do not move.
    let color = view_color(at, splats.degree, d);
    let free = vec3<bool>(is_free(color.x), is_free(color.y), is_free(color.z));
    let by_color = select(vec3<f32>(0.0), sums[3u * splat].xyz, free);
    let by_direction = bands_backward(at, d, by_color);
    let length = dot(to_splat, d);
    var by_position = vec3<f32>(0.0);
    if (length > 0.0 && is_finite(length)) {
        by_position = (by_direction - dot(d, by_direction) * d) / length;
    }
    return array<vec3<f32>, 2>(SH_C0 * by_color, by_position);
}

@compute @workgroup_size(64)
fn color_backward(
    @builtin(workgroup_id) group_id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = flat_group(group_id, groups);
    let splat = group * STAGED_SPLATS + thread;
    let inside = splat < splats.count;
    var seen = false;
    if (inside) {
        seen = sums[3u * splat + 2u].z != 0.0;
    }
    stage_rest(group, thread, seen);
    var by_dc = vec3<f32>(0.0);
    var by_logit = 0.0;
    if (seen) {
        let found = seen_backward(splat, thread);
        by_dc = found[0];
        by_positions[3u * splat] += found[1].x;
        by_positions[3u * splat + 1u] += found[1].y;
        by_positions[3u * splat + 2u] += found[1].z;
        // ∂L/∂ log₂ o = ln 2 Σ q, and d log₂ σ(x) = (1 − σ(x)) / ln 2 dx.
        by_logit = sums[3u * splat + 1u].x * transparency_of(opacity_logits[splat]);
    }
    if (inside) {
        by_sh_dc[3u * splat] = by_dc.x;
        by_sh_dc[3u * splat + 1u] = by_dc.y;
        by_sh_dc[3u * splat + 2u] = by_dc.z;
        by_opacity_logits[splat] = by_logit;
    }
    workgroupBarrier();
    unstage_rest(group, thread);
}

/// Writes the staged gradients; zeros for splats that were not seen and for bands that the frame
/// did not evaluate. All 64 threads take part.
fn unstage_rest(group: u32, thread: u32) {
    let floats = rest_floats(splats.degree);
    let stride = rest_floats(splats.stored_degree);
    let first = group * STAGED_SPLATS * stride;
    let here = min(STAGED_SPLATS, splats.count - min(splats.count, group * STAGED_SPLATS));
    for (var i = thread; i < here * stride; i += STAGED_SPLATS) {
        let at = i / stride;
        let float = i % stride;
        var value = 0.0;
        if (staged_wanted[at] != 0u && float < floats) {
            value = staged_rest[at * floats + float];
        }
        by_sh_rest[first + i] = value;
    }
}
