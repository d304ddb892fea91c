// Weights and hidden vectors of the deformation network in single precision.
//
// Needs: the constants HIDDEN_VECTORS and SPLATS.

alias Stored = vec4<f32>;

var<workgroup> hidden: array<Stored, HIDDEN_VECTORS>;

/// Keeps four outputs of one splat, where the hidden vectors were.
fn keep_outputs(task: u32, outputs: vec4<f32>) {
    hidden[task] = outputs;
}

fn kept_outputs(task: u32) -> vec4<f32> {
    return hidden[task];
}
