//! Kernels of training beside the renderer's own: loss, optimiser, densification. They live here
//! because they share files with the renderer's and are checked and translated to Metal with them;
//! `trapeze-train` runs them.

use super::Shader;
use super::common::{COUNTERS, DISPATCH, EXPONENTIAL, NUMBERS, SCAN};

macro_rules! wgsl {
    ($path:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shaders/", $path, ".wgsl"))
    };
}

const RANDOM: &str = wgsl!("common/random");
const TRAINING: &str = wgsl!("common/training");
const DENSIFICATION: &str = wgsl!("common/densification");

/// L1 and SSIM, and their gradient by the image.
pub const LOSS: Shader = Shader { name: "loss", parts: &[NUMBERS, TRAINING, wgsl!("loss")] };
/// What a step found, for the host.
pub const REPORT: Shader = Shader { name: "report", parts: &[COUNTERS, TRAINING, wgsl!("report")] };
/// The update of one array of parameters.
pub const ADAM: Shader = Shader {
    name: "adam",
    parts: &[DISPATCH, COUNTERS, NUMBERS, EXPONENTIAL, TRAINING, wgsl!("adam")],
};
/// Exploration noise of the positions.
pub const NOISE: Shader = Shader {
    name: "noise",
    parts: &[DISPATCH, COUNTERS, NUMBERS, EXPONENTIAL, RANDOM, TRAINING, wgsl!("noise")],
};
/// Weights of the splats, and which are dead.
pub const WEIGH: Shader =
    Shader { name: "weigh", parts: &[DISPATCH, NUMBERS, SCAN, DENSIFICATION, wgsl!("weigh")] };
/// Where dead and new splats go.
pub const RELOCATE: Shader = Shader {
    name: "relocate",
    parts: &[
        DISPATCH,
        COUNTERS,
        NUMBERS,
        SCAN,
        EXPONENTIAL,
        RANDOM,
        DENSIFICATION,
        wgsl!("relocate"),
    ],
};
/// Carries one array of parameters along with the splats that moved.
pub const COPY: Shader = Shader { name: "copy", parts: &[DISPATCH, DENSIFICATION, wgsl!("copy")] };
/// Makes room for more SH bands.
pub const RESTRIDE: Shader = Shader { name: "restride", parts: &[DISPATCH, wgsl!("restride")] };

/// All of them.
pub const ALL: [Shader; 8] = [LOSS, REPORT, ADAM, NOISE, WEIGH, RELOCATE, COPY, RESTRIDE];
