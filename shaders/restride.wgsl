// More SH bands: every splat's coefficients move apart, and the new ones are zero.
//
// Needs: common/dispatch.

struct Strides {
    /// Numbers per splat before and after.
    before: u32,
    after: u32,
    /// Numbers of all splats after.
    total: u32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> strides: Strides;
@group(0) @binding(1) var<storage, read> narrow: array<f32>;
@group(0) @binding(2) var<storage, read_write> spread: array<f32>;

@compute @workgroup_size(256)
fn restride(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 256u + thread;
    if (i >= strides.total) {
        return;
    }
    let column = i % strides.after;
    var value = 0.0;
    if (column < strides.before) {
        value = narrow[i / strides.after * strides.before + column];
    }
    spread[i] = value;
}
