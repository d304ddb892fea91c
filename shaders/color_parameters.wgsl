// Stage 2 in training: the colours of the splats that are drawn.
//
// Needs: common/dispatch, common/frame, common/numbers, common/projection, common/harmonics,
// common/splat_count, common/staged_harmonics.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> splats: SplatCount;
@group(0) @binding(2) var<storage, read> positions: array<f32>;
@group(0) @binding(3) var<storage, read> sh_dc: array<f32>;
@group(0) @binding(4) var<storage, read> sh_rest: array<f32>;
@group(0) @binding(5) var<storage, read> visible: array<u32>;
/// r g b, and 0.
@group(0) @binding(6) var<storage, read_write> colors: array<vec4<f32>>;

@compute @workgroup_size(64)
fn color(
    @builtin(workgroup_id) group_id: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = flat_group(group_id, groups);
    let splat = group * STAGED_SPLATS + thread;
    var drawn = false;
    if (splat < splats.count) {
        drawn = visible[splat] != 0u;
    }
    stage_rest(group, thread, drawn);
    if (!drawn) {
        return;
    }
    staged_dc = load_dc(splat);
    let position =
        vec3<f32>(positions[3u * splat], positions[3u * splat + 1u], positions[3u * splat + 2u]);
    let seen = view_color(thread, splats.degree, direction(from_camera(position)));
    colors[splat] = vec4<f32>(limited_color(seen), 0.0);
}
