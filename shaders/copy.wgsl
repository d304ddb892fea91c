// One array of the splats that moved or are new becomes that of their hosts; the optimiser forgets
// both.
//
// Needs: common/dispatch, common/densification.
//
// One thread per number. A host is never moved itself, so nothing is read that is written.

@group(0) @binding(0) var<uniform> densification: Densification;
@group(0) @binding(1) var<storage, read> hosts: array<u32>;
@group(0) @binding(2) var<storage, read> copies: array<u32>;
@group(0) @binding(3) var<storage, read_write> parameters: array<f32>;
@group(0) @binding(4) var<storage, read_write> first_moments: array<f32>;
@group(0) @binding(5) var<storage, read_write> second_moments: array<f32>;

/// Numbers per splat.
override WIDTH: u32 = 1u;

@compute @workgroup_size(256)
fn copy(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    let splat = i / WIDTH;
    if (splat >= densification.count) {
        return;
    }
    let host = hosts[splat];
    if (host < densification.splats) {
        parameters[i] = parameters[host * WIDTH + i % WIDTH];
    } else if (splat >= densification.splats || copies[splat] == 0u) {
        return;
    }
    first_moments[i] = 0.0;
    second_moments[i] = 0.0;
}
