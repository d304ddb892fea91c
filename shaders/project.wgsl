// Stage 2: from splats in the world to ellipses on the image.
//
// Needs: common/dispatch, common/frame, common/numbers.
//
// One thread per splat. What is drawn gets a sort key, what is not gets the key NOT_DRAWN. The
// ellipse is kept as the Cholesky factor U of Σ'⁻¹ · (log₂e / 2), so that α = 2^(log₂o − ‖U d‖²);
// |Σ'| is a sum of squares (Cauchy–Binet), so needles keep their width (docs/numerics.md). The
// plain twin is `Projection::project` of the f64 reference.

/// Part of the splats that one dispatch covers: buffers larger than a binding may be are bound in
/// windows.
struct Window {
    /// Index of the first splat.
    first: u32,
    /// Number of splats.
    count: u32,
    padding_1: u32,
    padding_2: u32,
}

/// A row of the cluster table.
struct Cluster {
    color: vec3<f32>,
    /// Whether its splats are drawn.
    shown: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> window: Window;
/// The window's splats.
@group(0) @binding(2) var<storage, read> poses: array<Pose>;
/// SH coefficients of the window's splats, in groups of 32 splats: coefficient-major within a
/// group, so that neighbouring threads read neighbouring words. STORED_SH_DEGREE says how many.
@group(0) @binding(3) var<storage, read> harmonics: array<u32>;
@group(0) @binding(4) var<storage, read> clusters: array<Cluster>;
/// Motion values of the window's splats, or one zero for all of them.
@group(0) @binding(5) var<storage, read> motion: array<f32>;
/// Centre (x, y) in pixels, and U's first row.
@group(0) @binding(6) var<storage, read_write> centres: array<vec4<f32>>;
/// U's second row, log₂ opacity, depth, half the height of the box around α = 1/255.
@group(0) @binding(7) var<storage, read_write> extents: array<vec4<f32>>;
/// r g b, and the cluster label's bits.
@group(0) @binding(8) var<storage, read_write> colors: array<vec4<f32>>;
/// Bits of the depth, or NOT_DRAWN.
@group(0) @binding(9) var<storage, read_write> sort_keys: array<u32>;
/// What the depth lost to rounding, as 8 bits: orders near-ties.
@group(0) @binding(10) var<storage, read_write> sort_keys_low: array<u32>;

/// SH degree in the buffer.
override STORED_SH_DEGREE: u32 = 0u;
/// Whether coefficients are stored as half floats, two to a word.
override HALF_HARMONICS: bool = false;

const NOT_DRAWN: u32 = 0xffffffffu;
const NEAR_PLANE: f32 = 0.01;
const LOW_PASS: f32 = 0.3;
const LOG2_255: f32 = 7.994353437;
/// √(log₂e / 2).
const FACTOR_SCALE: f32 = 0.849321800288;
const MAX_CHANNEL: f32 = 65504.0;
const MIN_NORMAL: f32 = 1.17549435e-38;

const SH_C0: f32 = 0.28209479;
const SH_C1: f32 = 0.4886025;

@compute @workgroup_size(256)
fn project(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let local = flat_group(group, groups) * 256u + thread;
    if (local >= window.count) {
        return;
    }
    let splat = window.first + local;
    sort_keys[splat] = NOT_DRAWN;
    sort_keys_low[splat] = 0u;

    let pose = poses[local];
    if (!(pose.log2_opacity >= -LOG2_255) || clusters[pose.label].shown == 0u) {
        return;
    }
    let to_splat = (pose.position - frame.centre_high.xyz) - frame.centre_low.xyz;
    let depth = view_depth(pose.position);
    if (!(depth.x > NEAR_PLANE && is_finite(depth.x))) {
        return;
    }
    let inverse_z = 1.0 / depth.x;
    let slope = vec2<f32>(dot(frame.rotation_x.xyz, to_splat), dot(frame.rotation_y.xyz, to_splat))
        * inverse_z;
    let centre = frame.focal * slope + frame.principal;

    // Rows of M = J W R S, pixels, so that Σ' = M Mᵀ + 0.3 I.
    let limited = clamp(slope, frame.slope_min, frame.slope_max);
    let gain = frame.focal * inverse_z;
    let row_x = gain.x * (frame.rotation_x.xyz - limited.x * frame.rotation_z.xyz);
    let row_y = gain.y * (frame.rotation_y.xyz - limited.y * frame.rotation_z.xyz);
    let axes = rotation_matrix(pose.rotation);
    let mx = (row_x * axes) * pose.scale;
    let my = (row_y * axes) * pose.scale;

    let xx = dot(mx, mx);
    let yy = dot(my, my);
    // Dividing the minors by √Σ'yy first keeps their squares inside f32.
    let inverse_deviation_y = 1.0 / sqrt(yy + LOW_PASS);
    let minors = cross(mx, my) * inverse_deviation_y;
    let rest = (LOW_PASS * inverse_deviation_y) * ((xx + yy + LOW_PASS) * inverse_deviation_y);
    let inverse_deviation_x = 1.0 / sqrt(dot(minors, minors) + rest);
    let lean = (dot(mx, my) * inverse_deviation_y) * inverse_deviation_y;
    let reach = sqrt(max(pose.log2_opacity + LOG2_255, 0.0)) / FACTOR_SCALE;
    let half_size = reach * sqrt(vec2<f32>(xx, yy) + LOW_PASS);

    let factor = vec3<f32>(
        inverse_deviation_x,
        -lean * inverse_deviation_x,
        inverse_deviation_y,
    ) * FACTOR_SCALE;
    let finite = is_finite(centre.x) && is_finite(centre.y) && is_finite(factor.x)
        && is_finite(factor.y) && is_finite(half_size.x) && is_finite(half_size.y);
    if (!finite || any(centre + half_size <= vec2<f32>(0.0))
        || any(centre - half_size >= frame.image)) {
        return;
    }
    centres[splat] = vec4<f32>(centre, factor.xy);
    extents[splat] = vec4<f32>(factor.z, pose.log2_opacity, depth.x, half_size.y);
    colors[splat] = vec4<f32>(splat_color(local, pose.label, to_splat), bitcast<f32>(pose.label));
    sort_keys[splat] = bitcast<u32>(depth.x);
    sort_keys_low[splat] = low_key(depth);
}

/// View z as (rounded, rest). An order by rounded depths would differ from the exact one wherever
/// two splats are closer than 10⁻⁷ of their distance, and large splats then show it in every pixel
/// that they share.
fn view_depth(position: vec3<f32>) -> vec2<f32> {
    var sum = vec2<f32>(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let difference = two_sum(position[axis], -frame.centre_high[axis], frame.zero);
        let low = difference.y - frame.centre_low[axis];
        let exact = two_product(difference.x, frame.rotation_z[axis], frame.zero);
        let rest = low * frame.rotation_z[axis] + difference.x * frame.rotation_z_low[axis];
        sum = add_two_floats(sum, vec2<f32>(exact.x, exact.y + rest), frame.zero);
    }
    return sum;
}

/// The rest of a depth, −½ … ½ of its last place, as 0 … 255.
fn low_key(depth: vec2<f32>) -> u32 {
    let exponent = bitcast<u32>(depth.x) >> 23u;
    // 2²³ / 2^exponent, for depths above the near plane (biased exponent ≥ 120).
    let per_last_place = bitcast<f32>((277u - exponent) << 23u);
    let share = depth.y * per_last_place + 0.5;
    return u32(clamp(share * 256.0, 0.0, 255.0));
}

/// Columns of the matrix of a quaternion (w, x, y, z), by the formula for unit quaternions.
fn rotation_matrix(q: vec4<f32>) -> mat3x3<f32> {
    let w = q.x;
    let x = q.y;
    let y = q.z;
    let z = q.w;
    return mat3x3<f32>(
        vec3<f32>(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        vec3<f32>(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        vec3<f32>(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    );
}

fn splat_color(local: u32, label: u32, to_splat: vec3<f32>) -> vec3<f32> {
    if (frame.color_source == 1u) {
        return clusters[label].color;
    }
    if (frame.color_source == 2u) {
        return motion_heat(motion[min(local, arrayLength(&motion) - 1u)] * frame.heat_scale);
    }
    return limited_color(view_color(local, direction(to_splat)));
}

/// max(0, x), at most MAX_CHANNEL; what is not a number is 0.
fn limited_color(color: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(limited_channel(color.x), limited_channel(color.y), limited_channel(color.z));
}

fn limited_channel(x: f32) -> f32 {
    return select(clamp(x, 0.0, MAX_CHANNEL), 0.0, is_nan(x));
}

/// Black, purple, orange, white for 0 … 1; what is not a number moves without bound: white.
fn motion_heat(relative: f32) -> vec3<f32> {
    let x = select(clamp(relative, 0.0, 1.0), 1.0, is_nan(relative)) * 3.0;
    let black = vec3<f32>(0.0);
    let purple = vec3<f32>(0.47, 0.11, 0.43);
    let orange = vec3<f32>(0.93, 0.41, 0.15);
    let white = vec3<f32>(0.99, 1.0, 0.64);
    if (x < 1.0) {
        return black + x * (purple - black);
    }
    if (x < 2.0) {
        return purple + (x - 1.0) * (orange - purple);
    }
    return orange + (x - 2.0) * (white - orange);
}

/// v / ‖v‖, or z where v has no direction.
fn direction(v: vec3<f32>) -> vec3<f32> {
    let squared = dot(v, v);
    if (squared > MIN_NORMAL && is_finite(squared)) {
        return v / sqrt(squared);
    }
    // Squares out of range: divide by the largest component first.
    let largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (!(largest > 0.0 && is_finite(largest))) {
        return vec3<f32>(0.0, 0.0, 1.0);
    }
    let scaled = v / largest;
    return scaled / sqrt(dot(scaled, scaled));
}

/// Word `index` of a splat's coefficients.
fn harmonics_word(local: u32, index: u32) -> u32 {
    let coefficients = 3u * (STORED_SH_DEGREE + 1u) * (STORED_SH_DEGREE + 1u);
    let words = select(coefficients, (coefficients + 1u) / 2u, HALF_HARMONICS);
    return harmonics[((local / 32u) * words + index) * 32u + local % 32u];
}

/// Coefficient `index` of one channel after the other: r g b of band 0, r g b of the next, ….
fn coefficient(local: u32, index: u32) -> f32 {
    if (HALF_HARMONICS) {
        return unpack2x16float(harmonics_word(local, index / 2u))[index % 2u];
    }
    return bitcast<f32>(harmonics_word(local, index));
}

fn coefficients(local: u32, k: u32) -> vec3<f32> {
    return vec3<f32>(
        coefficient(local, 3u * k),
        coefficient(local, 3u * k + 1u),
        coefficient(local, 3u * k + 2u),
    );
}

/// 0.5 + Σ cₖ Yₖ(d), before the clamp, up to the degree that the frame asks for.
fn view_color(local: u32, d: vec3<f32>) -> vec3<f32> {
    var color = 0.5 + SH_C0 * coefficients(local, 0u);
    let degree = min(STORED_SH_DEGREE, frame.sh_degree);
    if (degree == 0u) {
        return color;
    }
    color += (-SH_C1 * d.y) * coefficients(local, 1u);
    color += (SH_C1 * d.z) * coefficients(local, 2u);
    color += (-SH_C1 * d.x) * coefficients(local, 3u);
    if (degree == 1u) {
        return color;
    }
    let s = d * d;
    color += (1.0925485 * d.x * d.y) * coefficients(local, 4u);
    color += (-1.0925485 * d.y * d.z) * coefficients(local, 5u);
    color += (0.31539157 * (2.0 * s.z - s.x - s.y)) * coefficients(local, 6u);
    color += (-1.0925485 * d.x * d.z) * coefficients(local, 7u);
    color += (0.54627424 * (s.x - s.y)) * coefficients(local, 8u);
    if (degree == 2u) {
        return color;
    }
    color += (-0.5900436 * d.y * (3.0 * s.x - s.y)) * coefficients(local, 9u);
    color += (2.8906114 * d.x * d.y * d.z) * coefficients(local, 10u);
    color += (-0.4570458 * d.y * (4.0 * s.z - s.x - s.y)) * coefficients(local, 11u);
    color += (0.37317634 * d.z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y)) * coefficients(local, 12u);
    color += (-0.4570458 * d.x * (4.0 * s.z - s.x - s.y)) * coefficients(local, 13u);
    color += (1.4453057 * d.z * (s.x - s.y)) * coefficients(local, 14u);
    color += (-0.5900436 * d.x * (s.x - 3.0 * s.y)) * coefficients(local, 15u);
    return color;
}
