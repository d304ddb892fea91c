// The mirror of stage 2: sums over the pixels of each splat → ∂L/∂(position, log-scale, quaternion).
//
// Needs: common/dispatch, common/frame, common/numbers, common/projection, common/activation,
// common/rotation, common/splat_count.
//
// One thread per splat. The plain twin is `Projection::project_backward` of the f64 reference;
// what comes through the colour is added by color_backward.wgsl.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> splats: SplatCount;
@group(0) @binding(2) var<storage, read> positions: array<f32>;
@group(0) @binding(3) var<storage, read> log_scales: array<f32>;
@group(0) @binding(4) var<storage, read> rotations: array<vec4<f32>>;
/// As the forward pass left them.
@group(0) @binding(5) var<storage, read> centres: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> extents: array<vec4<f32>>;
/// See sum_slots.wgsl.
@group(0) @binding(7) var<storage, read> sums: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> by_positions: array<f32>;
@group(0) @binding(9) var<storage, read_write> by_log_scales: array<f32>;
@group(0) @binding(10) var<storage, read_write> by_rotations: array<vec4<f32>>;

const LN_2: f32 = 0.69314718;

struct Geometry {
    position: vec3<f32>,
    log_scale: vec3<f32>,
    rotation: vec4<f32>,
}

/// Sums over the pixels of one splat, as `SplatSums` of the CPU.
struct Sums {
    q: f32,
    q_dy: f32,
    q_dy_dy: f32,
    q_v: f32,
    q_v_dy: f32,
    q_v_v: f32,
    depth: f32,
}

@compute @workgroup_size(256)
fn project_backward(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let splat = flat_group(group, groups) * 256u + thread;
    if (splat >= splats.count) {
        return;
    }
    var gradient = Geometry(vec3<f32>(0.0), vec3<f32>(0.0), vec4<f32>(0.0));
    let last = sums[3u * splat + 2u];
    if (last.z != 0.0) {
        let middle = sums[3u * splat + 1u];
        let depth = sums[3u * splat].w;
        gradient = geometry_backward(
            splat, Sums(middle.x, middle.y, middle.z, middle.w, last.x, last.y, depth));
    }
    by_positions[3u * splat] = gradient.position.x;
    by_positions[3u * splat + 1u] = gradient.position.y;
    by_positions[3u * splat + 2u] = gradient.position.z;
    by_log_scales[3u * splat] = gradient.log_scale.x;
    by_log_scales[3u * splat + 1u] = gradient.log_scale.y;
    by_log_scales[3u * splat + 2u] = gradient.log_scale.z;
    by_rotations[splat] = gradient.rotation;
}

fn geometry_backward(splat: u32, s: Sums) -> Geometry {
    let position =
        vec3<f32>(positions[3u * splat], positions[3u * splat + 1u], positions[3u * splat + 2u]);
    let scale = vec3<f32>(
        linear_scale(log_scales[3u * splat]),
        linear_scale(log_scales[3u * splat + 1u]),
        linear_scale(log_scales[3u * splat + 2u]),
    );
    let unit = unit_rotation(rotations[splat]);
    let axes = rotation_matrix(unit.rotation);
    let to_splat = from_camera(position);
    let inverse_z = 1.0 / extents[splat].z;
    let slope = view_slope(to_splat, inverse_z);
    let limited = clamp(slope, frame.slope_min, frame.slope_max);
    let gain = frame.focal * inverse_z;
    // t: the rows of J W; M = t R S.
    let tx = gain.x * (frame.rotation_x.xyz - limited.x * frame.rotation_z.xyz);
    let ty = gain.y * (frame.rotation_y.xyz - limited.y * frame.rotation_z.xyz);
    let local_x = tx * axes;
    let local_y = ty * axes;
    let mx = local_x * scale;
    let my = local_y * scale;

    // With c = Σ'yy, σ = Σ'xy / c, D = |Σ'| / c the factor is u22 = k/√c, u11 = k/√D, u12 = −σ u11,
    // k² = log₂e / 2. D = |mx − σ my|² + 0.3 (1 + σ²), so ∂D/∂mx = 2 (mx − σ my) = 2 r and
    // ∂D/∂my = −2σ r; ∂σ/∂mx = my / c, ∂σ/∂my = (r − σ my) / c, ∂c/∂my = 2 my.
    let u11 = centres[splat].z;
    let u12 = centres[splat].w;
    let u22 = extents[splat].x;
    let lean = -u12 / u11;
    let by_d = 2.0 * LN_2 * LN_2 * (u11 * u11) * s.q_v_v;
    // ∂L/∂σ · 1/c.
    let by_lean = 4.0 * LN_2 * LN_2 * (u11 * s.q_v_dy) * (u22 * u22);
    let by_c = 2.0 * LN_2 * LN_2 * (u22 * u22) * ((u22 * u22) * s.q_dy_dy);
    let r = mx - lean * my;
    let by_mx = 2.0 * by_d * r + by_lean * my;
    let by_my = by_lean * (r - lean * my) - 2.0 * lean * by_d * r + 2.0 * by_c * my;
    let by_centre =
        2.0 * LN_2 * vec2<f32>(u11 * s.q_v, u12 * s.q_v + (u22 * u22) * s.q_dy);

    // By S, and by R S where S is taken into the rows of M.
    let is_free = (scale > vec3<f32>(0.0)) & (scale < vec3<f32>(MAX_SCALE));
    let by_scale = select(vec3<f32>(0.0), by_mx * local_x + by_my * local_y, is_free);
    let scaled_x = by_mx * scale;
    let scaled_y = by_my * scale;
    let by_tx = axes * scaled_x;
    let by_ty = axes * scaled_y;

    // t = f/z (w_axis − limited·w_z).
    let along = gain * vec2<f32>(dot(by_tx, frame.rotation_z.xyz), dot(by_ty, frame.rotation_z.xyz));
    let follows = (slope > frame.slope_min) & (slope < frame.slope_max);
    let by_slope = frame.focal * by_centre - select(vec2<f32>(0.0), along, follows);
    let turned = dot(by_tx, tx) + dot(by_ty, ty) + dot(by_slope, slope);
    let by_view = vec3<f32>(by_slope * inverse_z, s.depth - turned * inverse_z);

    var gradient: Geometry;
    gradient.position = by_view.x * frame.rotation_x.xyz + by_view.y * frame.rotation_y.xyz
        + by_view.z * frame.rotation_z.xyz;
    gradient.log_scale = by_scale * scale;
    gradient.rotation = unit_backward(unit, rotation_backward(unit.rotation, tx, ty, scaled_x, scaled_y));
    return gradient;
}

/// ∂L/∂(w, x, y, z) of the unit quaternion, from ∂L/∂R[r][c] = tx[r] sx[c] + ty[r] sy[c].
fn rotation_backward(
    q: vec4<f32>,
    tx: vec3<f32>,
    ty: vec3<f32>,
    sx: vec3<f32>,
    sy: vec3<f32>,
) -> vec4<f32> {
    // Rows of ∂L/∂R.
    let g0 = tx.x * sx + ty.x * sy;
    let g1 = tx.y * sx + ty.y * sy;
    let g2 = tx.z * sx + ty.z * sy;
    let w = q.x;
    let x = q.y;
    let y = q.z;
    let z = q.w;
    let turn = vec3<f32>(g2.y - g1.z, g0.z - g2.x, g1.x - g0.y);
    let shear = vec3<f32>(g2.y + g1.z, g0.z + g2.x, g1.x + g0.y);
    return 2.0 * vec4<f32>(
        x * turn.x + y * turn.y + z * turn.z,
        y * shear.z + z * shear.y + w * turn.x - 2.0 * x * (g1.y + g2.z),
        x * shear.z + z * shear.x + w * turn.y - 2.0 * y * (g0.x + g2.z),
        x * shear.y + y * shear.x + w * turn.z - 2.0 * z * (g0.x + g1.y),
    );
}
