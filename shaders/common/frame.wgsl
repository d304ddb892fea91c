// The frame's uniform block and a splat's geometry; `rust-core/gpu/src/layout.rs` has the same
// structs, and a test compares sizes and offsets.

/// One frame: camera and settings.
struct Frame {
    /// Rows of the world-to-camera rotation.
    rotation_x: vec4<f32>,
    rotation_y: vec4<f32>,
    rotation_z: vec4<f32>,
    /// Camera centre as a sum of two floats, world units relative to the scene's origin.
    centre_high: vec4<f32>,
    centre_low: vec4<f32>,
    /// What `rotation_z` lost to rounding.
    rotation_z_low: vec4<f32>,
    /// Focal lengths and principal point, pixels.
    focal: vec2<f32>,
    principal: vec2<f32>,
    /// Range of x/z and y/z that the Jacobian follows.
    slope_min: vec2<f32>,
    slope_max: vec2<f32>,
    /// Width and height, pixels.
    image: vec2<f32>,
    /// Highest SH degree to evaluate.
    sh_degree: u32,
    /// 0: spherical harmonics, 1: cluster colours, 2: motion heat,
    /// 3: depth.
    color_source: u32,
    /// 1 / (motion value that is drawn white).
    heat_scale: f32,
    /// 0, which no compiler knows (see numbers.wgsl).
    zero: u32,
    /// Depth that is drawn white, and what a unit of depth takes off that.
    depth_near: f32,
    depth_slope: f32,
}

/// A splat in world space at the time of the frame, activated.
struct Pose {
    /// Centre, relative to the scene's origin.
    position: vec3<f32>,
    /// log₂ of the opacity; below −log₂ 255 the splat is never drawn.
    log2_opacity: f32,
    /// Quaternion (w, x, y, z) as it enters the covariance.
    rotation: vec4<f32>,
    /// Standard deviations along the local axes, world units.
    scale: vec3<f32>,
    /// Row of the cluster table.
    label: u32,
}
