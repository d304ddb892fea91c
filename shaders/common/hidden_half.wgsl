// Weights and hidden vectors of the deformation network in half precision. Sums are in single
// precision, and so are the outputs: they are world units.
//
// Needs: common/enable_half, and the constants HIDDEN_VECTORS and SPLATS.

alias Stored = vec4<f16>;

var<workgroup> hidden: array<Stored, HIDDEN_VECTORS>;
var<workgroup> outputs_of_splats: array<vec4<f32>, OUTPUT_VECTORS>;

override OUTPUT_VECTORS: u32 = 4u * SPLATS;

/// Keeps four outputs of one splat.
fn keep_outputs(task: u32, outputs: vec4<f32>) {
    outputs_of_splats[task] = outputs;
}

fn kept_outputs(task: u32) -> vec4<f32> {
    return outputs_of_splats[task];
}
