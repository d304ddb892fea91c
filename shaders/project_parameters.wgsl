// Stage 2 in training: from stored parameters to ellipses on the image.
//
// Needs: common/dispatch, common/frame, common/numbers, common/projection, common/activation,
// common/rotation, common/splat_count.
//
// One thread per splat that there is room for. The twin of project.wgsl for splats that change
// with every frame; colours are a kernel of their own (color_parameters.wgsl), so that both stay
// within ten storage buffers.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> splats: SplatCount;
@group(0) @binding(2) var<storage, read> positions: array<f32>;
@group(0) @binding(3) var<storage, read> log_scales: array<f32>;
@group(0) @binding(4) var<storage, read> rotations: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> opacity_logits: array<f32>;
/// As in project.wgsl.
@group(0) @binding(6) var<storage, read_write> centres: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> extents: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> sort_keys: array<u32>;
@group(0) @binding(9) var<storage, read_write> sort_keys_low: array<u32>;
/// 1 for splats that the frame draws, else 0.
@group(0) @binding(10) var<storage, read_write> visible: array<u32>;
/// First slot of each splat; NO_SLOT until the backward pass finds it.
@group(0) @binding(11) var<storage, read_write> first_slots: array<u32>;

const NO_SLOT: u32 = 0xffffffffu;

@compute @workgroup_size(256)
fn project(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let splat = flat_group(group, groups) * 256u + thread;
    if (splat >= splats.capacity) {
        return;
    }
    sort_keys[splat] = NOT_DRAWN;
    sort_keys_low[splat] = 0u;
    visible[splat] = 0u;
    first_slots[splat] = NO_SLOT;
    if (splat >= splats.count) {
        return;
    }
    let position =
        vec3<f32>(positions[3u * splat], positions[3u * splat + 1u], positions[3u * splat + 2u]);
    let scale = vec3<f32>(
        linear_scale(log_scales[3u * splat]),
        linear_scale(log_scales[3u * splat + 1u]),
        linear_scale(log_scales[3u * splat + 2u]),
    );
    if (any(scale < vec3<f32>(0.0))) {
        return;
    }
    let log2_opacity = log2_opacity_of(opacity_logits[splat]);
    let rotation = unit_rotation(rotations[splat]).rotation;
    let ellipse = project_ellipse(position, rotation, scale, log2_opacity);
    if (!ellipse.drawn) {
        return;
    }
    centres[splat] = vec4<f32>(ellipse.centre, ellipse.factor.xy);
    extents[splat] =
        vec4<f32>(ellipse.factor.z, log2_opacity, ellipse.depth.x, ellipse.half_height);
    sort_keys[splat] = bitcast<u32>(ellipse.depth.x);
    sort_keys_low[splat] = low_key(ellipse.depth);
    visible[splat] = 1u;
}
