// What every variant of the deformation network shares: the work list, the encoding of positions,
// and what the outputs do to a splat. The rules for degenerate values are those of the f64
// reference.
//
// Needs: common/frame, common/numbers, common/trigonometry, common/deformation, and the bindings
// `deformation`, `canonical_poses`, `dynamic_splats` and `counts`.

const MIN_ROTATION_NORM: f32 = 1e-6;
const MIN_DEFORMED_SCALE: f32 = 1e-6;
const MAX_SCALE: f32 = 1e12;

/// The splat that position `i` of the work list names.
fn listed_splat(i: u32) -> u32 {
    let last = evaluated_splats() - 1u;
    let at = min(i, last);
    if (deformation.masked != 0u) {
        return dynamic_splats[at];
    }
    return at;
}

fn evaluated_splats() -> u32 {
    if (deformation.masked != 0u) {
        return counts[DYNAMIC];
    }
    return deformation.splats;
}

/// sin and cos of 2^octave times one coordinate of four world positions.
struct Waves {
    sine: vec4<f32>,
    cosine: vec4<f32>,
}

fn waves_of(coordinates: vec4<f32>, axis: u32, octave: u32) -> Waves {
    let scale = f32(1u << octave);
    let offset = deformation.origin_turns[octave][axis];
    let a = sin_cos_of_turns(turns_of(coordinates.x), scale, offset);
    let b = sin_cos_of_turns(turns_of(coordinates.y), scale, offset);
    let c = sin_cos_of_turns(turns_of(coordinates.z), scale, offset);
    let d = sin_cos_of_turns(turns_of(coordinates.w), scale, offset);
    return Waves(vec4<f32>(a.x, b.x, c.x, d.x), vec4<f32>(a.y, b.y, c.y, d.y));
}

/// One coordinate of four splats of the work list, from `first` on.
fn four_coordinates(first: u32, axis: u32) -> vec4<f32> {
    return vec4<f32>(
        canonical_poses[listed_splat(first)].position[axis],
        canonical_poses[listed_splat(first + 1u)].position[axis],
        canonical_poses[listed_splat(first + 2u)].position[axis],
        canonical_poses[listed_splat(first + 3u)].position[axis],
    );
}

/// Adds the network's outputs to a splat. `a`, `b`, `c`, `d`: the outputs in order, padded with
/// zeros: displacement 3 (or screw axis 6), rotation 4, scale 3.
fn apply_outputs(canonical: Pose, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) -> Pose {
    var displacement = a.xyz;
    var d_rotation = vec4<f32>(a.w, b.xyz);
    var d_scale = vec3<f32>(b.w, c.xy);
    if (deformation.screw != 0u) {
        let world = canonical.position + deformation.origin.xyz;
        displacement = screw_displacement(a.xyz, vec3<f32>(a.w, b.xy), world);
        d_rotation = vec4<f32>(b.zw, c.xy);
        d_scale = vec3<f32>(c.zw, d.x);
    }
    var pose = canonical;
    pose.position = canonical.position + displacement;
    pose.rotation = combined_rotation(canonical.rotation + d_rotation);
    let scale = canonical.scale + d_scale;
    pose.scale = vec3<f32>(deformed_scale(scale.x), deformed_scale(scale.y), deformed_scale(scale.z));
    return pose;
}

fn combined_rotation(sum: vec4<f32>) -> vec4<f32> {
    let largest = max(max(abs(sum.x), abs(sum.y)), max(abs(sum.z), abs(sum.w)));
    let finite = is_finite(sum.x) && is_finite(sum.y) && is_finite(sum.z) && is_finite(sum.w);
    let identity = vec4<f32>(1.0, 0.0, 0.0, 0.0);
    if (!finite || largest == 0.0) {
        return identity;
    }
    // Divided by the largest component first: squares of what a network can say leave f32.
    let scaled = sum / largest;
    let norm = sqrt(dot(scaled, scaled));
    if (norm * largest < MIN_ROTATION_NORM) {
        return identity;
    }
    return select(scaled / norm, sum, deformation.as_trained != 0u);
}

/// Floor and ceiling of a scale; what is not a number stays, and the splat is not drawn.
fn deformed_scale(scale: f32) -> f32 {
    if (is_nan(scale)) {
        return scale;
    }
    return clamp(scale, MIN_DEFORMED_SCALE, MAX_SCALE);
}

/// exp([S] θ) x − x for the screw axis S = (w/θ + 1e-5, v/θ + 1e-5), θ = ‖w‖ (Lynch & Park, "Modern
/// Robotics", eq. 3.88; the 1e-5 is upstream's). θ → 0 is the translation by v. 1 − cos θ is
/// computed as 2 sin²(θ/2) and θ − sin θ as a series where it would cancel.
fn screw_displacement(w: vec3<f32>, v: vec3<f32>, x: vec3<f32>) -> vec3<f32> {
    let theta = sqrt(dot(w, w));
    if (theta < 1.2e-38) {
        return v;
    }
    let axis = w / theta + 1e-5;
    let pitch = v / theta + 1e-5;
    let turns = turns_of(theta);
    let sine = sin_cos_of_turns(turns, 1.0, 0.0).x;
    let half_sine = sin_cos_of_turns(turns, 0.5, 0.0).x;
    let one_minus_cosine = 2.0 * half_sine * half_sine;
    let t2 = theta * theta;
    var theta_minus_sine = theta - sine;
    if (theta < 0.5) {
        theta_minus_sine = theta * t2 * (1.0 / 6.0 - t2 * (1.0 / 120.0 - t2 / 5040.0));
    }
    let turned = sine * cross(axis, x) + one_minus_cosine * cross(axis, cross(axis, x));
    let moved = theta * pitch + one_minus_cosine * cross(axis, pitch)
        + theta_minus_sine * cross(axis, cross(axis, pitch));
    return turned + moved;
}
