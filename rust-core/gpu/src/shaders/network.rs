//! Kernels of the deformation network under training, layer by layer, forward and backward.

use super::Shader;
use super::common::{DISPATCH, EXPONENTIAL, NUMBERS, ROTATION, TRIGONOMETRY};

macro_rules! wgsl {
    ($path:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders/", $path, ".wgsl"))
    };
}

const NETWORK: &str = wgsl!("common/network");
const MATRIX_TILE: &str = wgsl!("common/matrix_tile");
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
    parts: &[NETWORK, MATRIX_TILE, ACTIVATION_BLOCK, WEIGHT_BLOCK, wgsl!("deform_layer")],
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
    parts: &[NETWORK, MATRIX_TILE, ACTIVATION_BLOCK, WEIGHT_BLOCK, wgsl!("deform_layer_backward")],
};
/// The mirror of a layer by its parameters, in parts.
pub const WEIGHTS_BACKWARD: Shader = Shader {
    name: "deform_weights_backward",
    parts: &[NETWORK, MATRIX_TILE, ACTIVATION_BLOCK, wgsl!("deform_weights_backward")],
};
/// The sum of these parts.
pub const WEIGHTS_SUM: Shader =
    Shader { name: "deform_weights_sum", parts: &[DISPATCH, NETWORK, wgsl!("deform_weights_sum")] };

/// All of them.
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
