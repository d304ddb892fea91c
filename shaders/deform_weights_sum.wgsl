// ∂L/∂(W, b) of a layer: adds up the parts that deform_weights_backward.wgsl has left, in their
// order, and those of the chunks before.
//
// Needs: common/dispatch, common/network.

@group(0) @binding(0) var<uniform> chunk: NetworkChunk;
@group(0) @binding(1) var<uniform> layer: NetworkLayer;
@group(0) @binding(2) var<storage, read> parts: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> gradients: array<vec4<f32>>;

@compute @workgroup_size(64)
fn deform_weights_sum(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let i = flat_group(group, groups) * 64u + thread;
    let vectors = (layer.outputs * layer.inputs + layer.outputs) / 4u;
    if (i >= vectors) {
        return;
    }
    var sum = vec4<f32>(0.0);
    if (chunk.starts_sum == 0u) {
        sum = gradients[layer.weights + i];
    }
    let count = sum_parts(chunk.steps, layer.most_parts);
    for (var part = 0u; part < count; part++) {
        sum += parts[part * vectors + i];
    }
    gradients[layer.weights + i] = sum;
}
