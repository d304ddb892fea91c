//! Kernels of the deformation network under training, layer by layer, forward and backward.

use super::Shader;
use super::common::{DISPATCH, EXPONENTIAL, NUMBERS, ROTATION, TRIGONOMETRY};

macro_rules! wgsl {
    ($path:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders/", $path, ".wgsl"))
    };
}

const NETWORK: &str = wgsl!("common/network");
const ENABLE_MATRIX: &str = wgsl!("common/enable_matrix");
const MATRIX_BLOCK: &str = wgsl!("common/matrix_block");
const MATRIX_TILE: &str = wgsl!("common/matrix_tile");
const MATRIX_TILE_SPLIT: &str = wgsl!("common/matrix_tile_split");
const HALF_SCALE: &str = wgsl!("common/half_scale");
const ACTIVATION_BLOCK: &str = wgsl!("common/activation_block");
const WEIGHT_BLOCK: &str = wgsl!("common/weight_block");
const DEFORMED_PARAMETERS: &str = wgsl!("common/deformed_parameters");
const DEFORMED_SPLAT: &str = wgsl!("common/deformed_splat");

/// Splats → input of the network.
pub const ENCODE: Shader = Shader {
    name: "deform_encode",
    parts: &[DISPATCH, NUMBERS, TRIGONOMETRY, NETWORK, wgsl!("deform_encode")],
};
/// A hidden layer.
pub const LAYER: Shader = Shader {
    name: "deform_layer",
    parts: &[
        NETWORK,
        MATRIX_BLOCK,
        MATRIX_TILE,
        ACTIVATION_BLOCK,
        WEIGHT_BLOCK,
        wgsl!("deform_layer"),
    ],
};
/// [`LAYER`] on cooperative matrices; only where the device has them, as the two below.
pub const LAYER_SPLIT: Shader = Shader {
    name: "deform_layer_split",
    parts: &[
        ENABLE_MATRIX,
        NETWORK,
        MATRIX_BLOCK,
        MATRIX_TILE_SPLIT,
        HALF_SCALE,
        ACTIVATION_BLOCK,
        WEIGHT_BLOCK,
        wgsl!("deform_layer"),
        wgsl!("deform_layer_scales"),
    ],
};
/// The heads, and the deformed splats.
pub const APPLY: Shader = Shader {
    name: "deform_apply",
    parts: &[
        DISPATCH,
        NUMBERS,
        ROTATION,
        EXPONENTIAL,
        NETWORK,
        DEFORMED_PARAMETERS,
        DEFORMED_SPLAT,
        wgsl!("deform_apply"),
    ],
};
/// The mirror of [`APPLY`], without the heads.
pub const APPLY_BACKWARD: Shader = Shader {
    name: "deform_apply_backward",
    parts: &[
        DISPATCH,
        NUMBERS,
        ROTATION,
        EXPONENTIAL,
        NETWORK,
        DEFORMED_PARAMETERS,
        DEFORMED_SPLAT,
        wgsl!("deform_apply_backward"),
    ],
};
/// Splats that rest, without the network.
pub const HOLD: Shader = Shader {
    name: "deform_hold",
    parts: &[
        DISPATCH,
        NUMBERS,
        ROTATION,
        EXPONENTIAL,
        NETWORK,
        DEFORMED_PARAMETERS,
        DEFORMED_SPLAT,
        wgsl!("deform_hold"),
    ],
};
/// The mirror of [`HOLD`].
pub const HOLD_BACKWARD: Shader = Shader {
    name: "deform_hold_backward",
    parts: &[
        DISPATCH,
        NUMBERS,
        ROTATION,
        EXPONENTIAL,
        NETWORK,
        DEFORMED_PARAMETERS,
        DEFORMED_SPLAT,
        wgsl!("deform_hold_backward"),
    ],
};
/// The mirror of a layer by its input.
pub const LAYER_BACKWARD: Shader = Shader {
    name: "deform_layer_backward",
    parts: &[
        NETWORK,
        MATRIX_BLOCK,
        MATRIX_TILE,
        ACTIVATION_BLOCK,
        WEIGHT_BLOCK,
        wgsl!("deform_layer_backward"),
    ],
};
/// [`LAYER_BACKWARD`] on cooperative matrices.
pub const LAYER_BACKWARD_SPLIT: Shader = Shader {
    name: "deform_layer_backward_split",
    parts: &[
        ENABLE_MATRIX,
        NETWORK,
        MATRIX_BLOCK,
        MATRIX_TILE_SPLIT,
        HALF_SCALE,
        ACTIVATION_BLOCK,
        WEIGHT_BLOCK,
        wgsl!("deform_layer_backward"),
        wgsl!("deform_layer_backward_scales"),
    ],
};
/// The mirror of a layer by its parameters, in parts.
pub const WEIGHTS_BACKWARD: Shader = Shader {
    name: "deform_weights_backward",
    parts: &[
        NETWORK,
        MATRIX_BLOCK,
        MATRIX_TILE,
        ACTIVATION_BLOCK,
        wgsl!("deform_weights_backward"),
    ],
};
/// [`WEIGHTS_BACKWARD`] on cooperative matrices.
pub const WEIGHTS_BACKWARD_SPLIT: Shader = Shader {
    name: "deform_weights_backward_split",
    parts: &[
        ENABLE_MATRIX,
        NETWORK,
        MATRIX_BLOCK,
        MATRIX_TILE_SPLIT,
        HALF_SCALE,
        ACTIVATION_BLOCK,
        wgsl!("deform_weights_backward"),
        wgsl!("deform_weights_backward_scales"),
    ],
};
/// The sum of these parts.
pub const WEIGHTS_SUM: Shader =
    Shader { name: "deform_weights_sum", parts: &[DISPATCH, NETWORK, wgsl!("deform_weights_sum")] };

/// All that any device can run.
pub const ALL: [Shader; 9] = [
    ENCODE,
    LAYER,
    APPLY,
    HOLD,
    HOLD_BACKWARD,
    APPLY_BACKWARD,
    LAYER_BACKWARD,
    WEIGHTS_BACKWARD,
    WEIGHTS_SUM,
];

/// Those that need cooperative matrices.
pub const OPTIONAL: [Shader; 3] = [LAYER_SPLIT, LAYER_BACKWARD_SPLIT, WEIGHTS_BACKWARD_SPLIT];
