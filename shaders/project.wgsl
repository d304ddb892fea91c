// Stage 2: from splats in the world to ellipses on the image.
//
// Needs: common/dispatch, common/frame, common/numbers, common/projection, common/harmonics.
//
// One thread per splat. What is drawn gets a sort key, what is not gets the key NOT_DRAWN.

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
/// How coefficients are stored. 0: floats; 1: half floats, two to a word; 2: band 0 and a step for
/// each higher band as half floats, then bytes, four to a word, that count steps.
override HARMONICS_STORAGE: u32 = 0u;

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
    if (clusters[pose.label].shown == 0u) {
        return;
    }
    let ellipse = project_ellipse(pose.position, pose.rotation, pose.scale, pose.log2_opacity);
    if (!ellipse.drawn) {
        return;
    }
    let color = splat_color(local, pose.label, from_camera(pose.position), ellipse.depth.x);
    centres[splat] = vec4<f32>(ellipse.centre, ellipse.factor.xy);
    extents[splat] =
        vec4<f32>(ellipse.factor.z, pose.log2_opacity, ellipse.depth.x, ellipse.half_height);
    colors[splat] = vec4<f32>(color, bitcast<f32>(pose.label));
    sort_keys[splat] = bitcast<u32>(ellipse.depth.x);
    sort_keys_low[splat] = low_key(ellipse.depth);
}

fn splat_color(local: u32, label: u32, to_splat: vec3<f32>, depth: f32) -> vec3<f32> {
    if (frame.color_source == 1u) {
        return clusters[label].color;
    }
    if (frame.color_source == 2u) {
        return motion_heat(motion[min(local, arrayLength(&motion) - 1u)] * frame.heat_scale);
    }
    if (frame.color_source == 3u) {
        return vec3<f32>(clamp(1.0 - (depth - frame.depth_near) * frame.depth_slope, 0.0, 1.0));
    }
    let degree = min(STORED_SH_DEGREE, frame.sh_degree);
    return limited_color(view_color(local, degree, direction(to_splat)));
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

/// Word `index` of a splat's coefficients.
fn harmonics_word(local: u32, index: u32) -> u32 {
    let coefficients = 3u * (STORED_SH_DEGREE + 1u) * (STORED_SH_DEGREE + 1u);
    var words = coefficients;
    if (HARMONICS_STORAGE == 1u) {
        words = (coefficients + 1u) / 2u;
    } else if (HARMONICS_STORAGE == 2u) {
        // (coefficients − 3) / 4, rounded up.
        words = HEADER_WORDS + coefficients / 4u;
    }
    return harmonics[((local / 32u) * words + index) * 32u + local % 32u];
}

/// Words of band 0 and of the steps.
override HEADER_WORDS: u32 = (STORED_SH_DEGREE + 4u) / 2u;

/// Half float `index` of a splat.
fn half_coefficient(local: u32, index: u32) -> f32 {
    return unpack2x16float(harmonics_word(local, index / 2u))[index % 2u];
}

/// Coefficient `index` ≥ 3 in steps of its band: −127 … 127, or −128 where it is not a number.
fn byte_coefficient(local: u32, index: u32) -> f32 {
    let word = harmonics_word(local, HEADER_WORDS + (index - 3u) / 4u);
    let steps = bitcast<i32>(word << (24u - 8u * ((index - 3u) % 4u))) >> 24u;
    if (steps == -128) {
        return bitcast<f32>(0x7fc00000u + frame.zero);
    }
    // Bands 1, 2 and 3 start at coefficients 1, 4 and 9 of each channel.
    let band = 1u + u32(index >= 12u) + u32(index >= 27u);
    return f32(steps) * half_coefficient(local, 2u + band);
}

/// Coefficient `index` of one channel after the other: r g b of band 0, r g b of the next, ….
fn coefficient(local: u32, index: u32) -> f32 {
    if (HARMONICS_STORAGE == 0u) {
        return bitcast<f32>(harmonics_word(local, index));
    }
    if (HARMONICS_STORAGE == 1u || index < 3u) {
        return half_coefficient(local, index);
    }
    return byte_coefficient(local, index);
}

fn coefficients(local: u32, k: u32) -> vec3<f32> {
    return vec3<f32>(
        coefficient(local, 3u * k),
        coefficient(local, 3u * k + 1u),
        coefficient(local, 3u * k + 2u),
    );
}
