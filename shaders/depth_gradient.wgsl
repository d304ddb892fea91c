// What the gradient by expected depth says about the sums of each pixel.
//
// Needs: common/dispatch, common/region.
//
// D = Z / W with Z = Σ w z and W = Σ w, so ∂L/∂Z = g / W and ∂L/∂W = −g D / W. Where nothing was hit
// there is no depth, and nothing is said.

@group(0) @binding(0) var<uniform> region: Region;
@group(0) @binding(1) var<storage, read> image: array<vec4<f32>>;
/// Bits of the expected depth first.
@group(0) @binding(2) var<storage, read> layers: array<vec4<u32>>;
/// ∂L/∂D.
@group(0) @binding(3) var<storage, read> by_depth: array<f32>;
/// ∂L/∂Z, ∂L/∂W.
@group(0) @binding(4) var<storage, read_write> by_depth_sums: array<vec2<f32>>;

@compute @workgroup_size(256)
fn depth_gradient(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let pixel = flat_group(group, groups) * 256u + thread;
    if (pixel >= region.image.x * region.image.y) {
        return;
    }
    let weight = image[pixel].w;
    var sums = vec2<f32>(0.0);
    if (weight > 0.0) {
        let by_weighted = by_depth[pixel] / weight;
        sums = vec2<f32>(by_weighted, -by_weighted * bitcast<f32>(layers[pixel].x));
    }
    by_depth_sums[pixel] = sums;
}
