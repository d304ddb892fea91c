// World → ellipse on the image, for every kernel that projects.
//
// Needs: common/frame, common/numbers, and the binding `frame`.
//
// The ellipse is kept as the Cholesky factor U of Σ'⁻¹ · (log₂e / 2), so that α = 2^(log₂o − ‖U d‖²);
// |Σ'| is a sum of squares (Cauchy–Binet), so needles keep their width (docs/numerics.md). The
// plain twin is `Projection::project` of the f64 reference.

const NOT_DRAWN: u32 = 0xffffffffu;
const NEAR_PLANE: f32 = 0.01;
const LOW_PASS: f32 = 0.3;
const LOG2_255: f32 = 7.994353437;
/// √(log₂e / 2).
const FACTOR_SCALE: f32 = 0.849321800288;

/// A splat on the image.
struct Ellipse {
    /// Whether any of it is drawn; the rest is unspecified where not.
    drawn: bool,
    /// Pixels.
    centre: vec2<f32>,
    /// u11, u12, u22, 1/px.
    factor: vec3<f32>,
    /// Half the height of the box around α = 1/255, pixels.
    half_height: f32,
    /// View z as (rounded, rest).
    depth: vec2<f32>,
}

/// The vector from the camera's centre.
fn from_camera(position: vec3<f32>) -> vec3<f32> {
    return (position - frame.centre_high.xyz) - frame.centre_low.xyz;
}

/// x/z and y/z in camera coordinates, of a splat at `to_splat` from the camera.
fn view_slope(to_splat: vec3<f32>, inverse_z: f32) -> vec2<f32> {
    return vec2<f32>(dot(frame.rotation_x.xyz, to_splat), dot(frame.rotation_y.xyz, to_splat))
        * inverse_z;
}

/// Projects a splat; `rotation` is of unit length.
fn project_ellipse(
    position: vec3<f32>,
    rotation: vec4<f32>,
    scale: vec3<f32>,
    log2_opacity: f32,
) -> Ellipse {
    var ellipse: Ellipse;
    ellipse.drawn = false;
    if (!(log2_opacity >= -LOG2_255)) {
        return ellipse;
    }
    let to_splat = from_camera(position);
    let depth = view_depth(position);
    if (!(depth.x > NEAR_PLANE && is_finite(depth.x))) {
        return ellipse;
    }
    let inverse_z = 1.0 / depth.x;
    let slope = view_slope(to_splat, inverse_z);
    let centre = frame.focal * slope + frame.principal;

    // Rows of M = J W R S, pixels, so that Σ' = M Mᵀ + 0.3 I.
    let limited = clamp(slope, frame.slope_min, frame.slope_max);
    let gain = frame.focal * inverse_z;
    let row_x = gain.x * (frame.rotation_x.xyz - limited.x * frame.rotation_z.xyz);
    let row_y = gain.y * (frame.rotation_y.xyz - limited.y * frame.rotation_z.xyz);
    let axes = rotation_matrix(rotation);
    let mx = (row_x * axes) * scale;
    let my = (row_y * axes) * scale;

    let xx = dot(mx, mx);
    let yy = dot(my, my);
    // Dividing the minors by √Σ'yy first keeps their squares inside f32.
    let inverse_deviation_y = 1.0 / sqrt(yy + LOW_PASS);
    let minors = cross(mx, my) * inverse_deviation_y;
    let rest = (LOW_PASS * inverse_deviation_y) * ((xx + yy + LOW_PASS) * inverse_deviation_y);
    let inverse_deviation_x = 1.0 / sqrt(dot(minors, minors) + rest);
    let lean = (dot(mx, my) * inverse_deviation_y) * inverse_deviation_y;
    let reach = sqrt(max(log2_opacity + LOG2_255, 0.0)) / FACTOR_SCALE;
    let half_size = reach * sqrt(vec2<f32>(xx, yy) + LOW_PASS);

    let factor = vec3<f32>(
        inverse_deviation_x,
        -lean * inverse_deviation_x,
        inverse_deviation_y,
    ) * FACTOR_SCALE;
    let finite = is_finite(centre.x) && is_finite(centre.y) && is_finite(factor.x)
        && is_finite(factor.y) && is_finite(half_size.x) && is_finite(half_size.y);
    let misses = any(centre + half_size <= vec2<f32>(0.0))
        || any(centre - half_size >= frame.image);
    ellipse.drawn = finite && !misses;
    ellipse.centre = centre;
    ellipse.factor = factor;
    ellipse.half_height = half_size.y;
    ellipse.depth = depth;
    return ellipse;
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
