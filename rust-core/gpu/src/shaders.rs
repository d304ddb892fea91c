//! The WGSL sources, put together: WGSL has no include, so a stage's source is its common files
//! followed by its own.

pub mod network;
pub mod training;

/// A shader: its name, and the files that make it.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Name of the stage's file, without extension.
    pub name: &'static str,
    /// The files' contents, in order.
    parts: &'static [&'static str],
}

impl Shader {
    /// A shader made of `parts`, for example files of [`common`] and one of its own.
    #[must_use]
    pub const fn new(name: &'static str, parts: &'static [&'static str]) -> Self {
        Self { name, parts }
    }

    /// The source of the whole module.
    #[must_use]
    pub fn source(&self) -> String {
        self.parts.join("\n")
    }
}

macro_rules! wgsl {
    ($path:literal) => {
        include_str!(concat!("../../../shaders/", $path, ".wgsl"))
    };
}

/// Files that several shaders share. Each says at its start what it needs before it.
pub mod common {
    /// Counting through folded dispatches: `flat_group`, `folded`, `divide_up`.
    pub const DISPATCH: &str = wgsl!("common/dispatch");
    /// Indices into the counts of a frame.
    pub const COUNTERS: &str = wgsl!("common/counters");
    /// Prefix sums of one workgroup of 256.
    pub const SCAN: &str = wgsl!("common/scan");
    /// The frame's uniform block and a splat's pose.
    pub const FRAME: &str = wgsl!("common/frame");
    /// Numbers that are not finite, and sums of two floats.
    pub const NUMBERS: &str = wgsl!("common/numbers");
    /// The part of the image at hand.
    pub const REGION: &str = wgsl!("common/region");
    /// World → ellipse on the image.
    pub const PROJECTION: &str = wgsl!("common/projection");
    /// Colour by spherical harmonics.
    pub const HARMONICS: &str = wgsl!("common/harmonics");
    /// One blend and its decisions.
    pub const BLEND: &str = wgsl!("common/blend");
    /// Tile entries for rendering.
    pub const ENTRIES: &str = wgsl!("common/entries");
    /// Tile entries for the backward pass.
    pub const NUMBERED_ENTRIES: &str = wgsl!("common/numbered_entries");
    /// From stored parameters to what they stand for.
    pub const ACTIVATION: &str = wgsl!("common/activation");
    /// Quaternions of any length.
    pub const ROTATION: &str = wgsl!("common/rotation");
    /// exp, ln and the logistic function to a few ulp.
    pub const EXPONENTIAL: &str = wgsl!("common/exponential");
    /// How many trainable splats there are.
    pub const SPLAT_COUNT: &str = wgsl!("common/splat_count");
    /// Coefficients of 64 splats in workgroup memory.
    pub const STAGED_HARMONICS: &str = wgsl!("common/staged_harmonics");
    /// sin and cos of any octave.
    pub const TRIGONOMETRY: &str = wgsl!("common/trigonometry");
    /// The uniform block of the deformation stage.
    pub const DEFORMATION: &str = wgsl!("common/deformation");
    /// What every variant of the network shares.
    pub const DEFORM_SPLAT: &str = wgsl!("common/deform_splat");
}

use common::{
    ACTIVATION, BLEND, COUNTERS, DEFORM_SPLAT, DEFORMATION, DISPATCH, ENTRIES, FRAME, HARMONICS,
    NUMBERED_ENTRIES, NUMBERS, PROJECTION, REGION, ROTATION, SCAN, SPLAT_COUNT, STAGED_HARMONICS,
    TRIGONOMETRY,
};

/// Which splats move.
pub const MASK: Shader = Shader {
    name: "mask",
    parts: &[DISPATCH, COUNTERS, FRAME, NUMBERS, DEFORMATION, wgsl!("mask")],
};
/// The deformation network in single precision.
pub const DEFORM: Shader = Shader {
    name: "deform",
    parts: &[
        DISPATCH,
        COUNTERS,
        FRAME,
        NUMBERS,
        TRIGONOMETRY,
        DEFORMATION,
        DEFORM_SPLAT,
        wgsl!("common/hidden_single"),
        wgsl!("deform"),
    ],
};
/// The deformation network with weights and hidden vectors in half precision; only where the device
/// has it.
pub const DEFORM_HALF: Shader = Shader {
    name: "deform_half",
    parts: &[
        wgsl!("common/enable_half"),
        DISPATCH,
        COUNTERS,
        FRAME,
        NUMBERS,
        TRIGONOMETRY,
        DEFORMATION,
        DEFORM_SPLAT,
        wgsl!("common/hidden_half"),
        wgsl!("deform"),
    ],
};
/// The deformation network on cooperative matrices; only where the device has them.
pub const DEFORM_MATRIX: Shader = Shader {
    name: "deform_matrix",
    parts: &[
        wgsl!("common/enable_matrix"),
        DISPATCH,
        COUNTERS,
        FRAME,
        NUMBERS,
        TRIGONOMETRY,
        DEFORMATION,
        DEFORM_SPLAT,
        wgsl!("deform_matrix"),
    ],
};
/// World → image.
pub const PROJECT: Shader = Shader {
    name: "project",
    parts: &[DISPATCH, FRAME, NUMBERS, PROJECTION, HARMONICS, wgsl!("project")],
};
/// Stable radix sort.
pub const SORT: Shader = Shader { name: "sort", parts: &[DISPATCH, COUNTERS, SCAN, wgsl!("sort")] };
/// Sizes of later dispatches.
pub const ARGUMENTS: Shader =
    Shader { name: "arguments", parts: &[DISPATCH, COUNTERS, SCAN, REGION, wgsl!("arguments")] };
/// Splats × tiles.
pub const BIN: Shader =
    Shader { name: "bin", parts: &[DISPATCH, COUNTERS, SCAN, REGION, ENTRIES, wgsl!("bin")] };
/// Splats × tiles, for the backward pass.
pub const BIN_NUMBERED: Shader = Shader {
    name: "bin_numbered",
    parts: &[DISPATCH, COUNTERS, SCAN, REGION, NUMBERED_ENTRIES, wgsl!("bin")],
};
/// Where each tile's entries start.
pub const RANGES: Shader =
    Shader { name: "ranges", parts: &[DISPATCH, COUNTERS, REGION, wgsl!("ranges")] };
/// Blending.
pub const RASTERIZE: Shader =
    Shader { name: "rasterize", parts: &[DISPATCH, REGION, BLEND, wgsl!("rasterize")] };

/// Onto the screen.
pub const PRESENT: Shader = Shader { name: "present", parts: &[wgsl!("present")] };

/// World → image, from stored parameters.
pub const PROJECT_PARAMETERS: Shader = Shader {
    name: "project_parameters",
    parts: &[
        DISPATCH,
        FRAME,
        NUMBERS,
        PROJECTION,
        ACTIVATION,
        ROTATION,
        SPLAT_COUNT,
        wgsl!("project_parameters"),
    ],
};
/// Colours, from stored parameters.
pub const COLOR_PARAMETERS: Shader = Shader {
    name: "color_parameters",
    parts: &[
        DISPATCH,
        FRAME,
        NUMBERS,
        PROJECTION,
        HARMONICS,
        SPLAT_COUNT,
        STAGED_HARMONICS,
        wgsl!("color_parameters"),
    ],
};
/// The splat of each sorted entry.
pub const RESOLVE_ENTRIES: Shader =
    Shader { name: "resolve_entries", parts: &[DISPATCH, COUNTERS, wgsl!("resolve_entries")] };
/// What a gradient by depth says about each pixel's sums.
pub const DEPTH_GRADIENT: Shader =
    Shader { name: "depth_gradient", parts: &[DISPATCH, REGION, wgsl!("depth_gradient")] };
/// The mirror of blending.
pub const RASTERIZE_BACKWARD: Shader = Shader {
    name: "rasterize_backward",
    parts: &[DISPATCH, REGION, BLEND, wgsl!("rasterize_backward")],
};
/// From the sums of entries to those of splats.
pub const SUM_SLOTS: Shader =
    Shader { name: "sum_slots", parts: &[DISPATCH, COUNTERS, SPLAT_COUNT, wgsl!("sum_slots")] };
/// The mirror of the projection.
pub const PROJECT_BACKWARD: Shader = Shader {
    name: "project_backward",
    parts: &[
        DISPATCH,
        FRAME,
        NUMBERS,
        PROJECTION,
        ACTIVATION,
        ROTATION,
        SPLAT_COUNT,
        wgsl!("project_backward"),
    ],
};
/// The mirror of the colours.
pub const COLOR_BACKWARD: Shader = Shader {
    name: "color_backward",
    parts: &[
        DISPATCH,
        FRAME,
        NUMBERS,
        PROJECTION,
        HARMONICS,
        ACTIVATION,
        SPLAT_COUNT,
        STAGED_HARMONICS,
        wgsl!("color_backward"),
    ],
};

/// Every shader that any device can run.
pub const ALL: [Shader; 18] = [
    MASK,
    DEFORM,
    PROJECT,
    SORT,
    ARGUMENTS,
    BIN,
    BIN_NUMBERED,
    RANGES,
    RASTERIZE,
    PROJECT_PARAMETERS,
    COLOR_PARAMETERS,
    RESOLVE_ENTRIES,
    DEPTH_GRADIENT,
    RASTERIZE_BACKWARD,
    SUM_SLOTS,
    PROJECT_BACKWARD,
    COLOR_BACKWARD,
    PRESENT,
];

/// Shaders that need features which not every device has.
pub const OPTIONAL: [Shader; 2] = [DEFORM_HALF, DEFORM_MATRIX];

/// All shaders: what is validated and translated to Metal.
#[cfg(test)]
pub(crate) fn every_shader() -> impl Iterator<Item = Shader> {
    let optional = OPTIONAL.into_iter().chain(network::OPTIONAL);
    ALL.into_iter().chain(optional).chain(network::ALL).chain(training::ALL)
}

/// The common files behind the positional encoding, for its test.
#[cfg(test)]
pub(crate) fn encoding_source() -> String {
    [DISPATCH, TRIGONOMETRY].join("\n")
}
