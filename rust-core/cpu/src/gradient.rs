//! What goes into a backward pass and what comes out of it.

use trapeze_scene::Splats;

use crate::deform_backward::OutputGradient;

/// ∂L/∂image, for any loss L of a rendered frame.
#[derive(Clone, Copy, Debug)]
pub struct ImageGradient<'a> {
    /// ∂L/∂(r, g, b premultiplied over black, alpha), one entry per pixel, rows top to bottom.
    ///
    /// A loss on the image over a background b, rgb + (1 − alpha)·b, has −Σ b·∂L/∂rgb as its part
    /// of the derivative by alpha.
    pub color: &'a [[f32; 4]],
    /// ∂L/∂(expected depth), one entry per pixel. Pixels where nothing was hit have no depth;
    /// their entry is not read.
    pub expected_depth: Option<&'a [f32]>,
}

impl ImageGradient<'_> {
    /// Whether the arrays belong to an image of this many pixels.
    pub(crate) fn fits(&self, pixels: usize) -> bool {
        self.color.len() == pixels && self.expected_depth.is_none_or(|d| d.len() == pixels)
    }
}

/// ∂L/∂(pose): by what the deformation stage hands to the projection, one entry per splat; zero
/// for splats that no pixel saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseGradients {
    /// By the centre, 1/world units.
    pub positions: Vec<[f32; 3]>,
    /// By the quaternion (w, x, y, z) that enters the covariance, each component taken as free.
    pub rotations: Vec<[f32; 4]>,
    /// By the standard deviations (linear, not their logarithms), 1/world units.
    pub scales: Vec<[f32; 3]>,
}

/// Gives `gradients` the shape of `splats`. What is in it is anything; [`GradientChunk::clear`] makes it
/// zero.
pub(crate) fn shape_like(gradients: &mut Splats, splats: &Splats) {
    let n = splats.len();
    gradients.positions.resize(n, [0.0; 3]);
    gradients.log_scales.resize(n, [0.0; 3]);
    gradients.rotations.resize(n, [0.0; 4]);
    gradients.opacity_logits.resize(n, 0.0);
    gradients.sh_dc.resize(n, [0.0; 3]);
    gradients.sh_rest.resize(splats.sh_rest.len(), 0.0);
    gradients.sh_degree = splats.sh_degree;
}

/// Splats that one task carries back; fixed, like every other cut.
const CHUNK: usize = 1024;

/// The gradients of consecutive splats.
pub(crate) struct GradientChunk<'a> {
    /// Index of the first.
    pub(crate) first: usize,
    pub(crate) positions: &'a mut [[f32; 3]],
    pub(crate) log_scales: &'a mut [[f32; 3]],
    pub(crate) rotations: &'a mut [[f32; 4]],
    pub(crate) opacity_logits: &'a mut [f32],
    pub(crate) sh_dc: &'a mut [[f32; 3]],
    sh_rest: &'a mut [f32],
    pub(crate) poses: Option<PoseChunk<'a>>,
    /// By what the deformation network adds.
    pub(crate) outputs: Option<&'a mut [OutputGradient]>,
}

/// The pose gradients of consecutive splats.
pub(crate) struct PoseChunk<'a> {
    pub(crate) positions: &'a mut [[f32; 3]],
    pub(crate) rotations: &'a mut [[f32; 4]],
    pub(crate) scales: &'a mut [[f32; 3]],
}

impl GradientChunk<'_> {
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    /// Makes the gradients by the splats zero; those by poses and outputs are from the start.
    pub(crate) fn clear(&mut self) {
        self.positions.fill([0.0; 3]);
        self.log_scales.fill([0.0; 3]);
        self.rotations.fill([0.0; 4]);
        self.opacity_logits.fill(0.0);
        self.sh_dc.fill([0.0; 3]);
        self.sh_rest.fill(0.0);
    }

    /// The higher SH bands of entry `at`.
    pub(crate) fn sh_rest_of(&mut self, at: usize) -> &mut [f32] {
        let stride = self.sh_rest.len() / self.positions.len();
        &mut self.sh_rest[at * stride..(at + 1) * stride]
    }
}

/// Cuts gradients into chunks that can be written side by side. `poses` and `outputs` take the
/// length of the splats.
pub(crate) fn gradient_chunks<'a>(
    splats: &'a mut Splats,
    poses: Option<&'a mut PoseGradients>,
    outputs: Option<&'a mut Vec<OutputGradient>>,
) -> Vec<GradientChunk<'a>> {
    let n = splats.len();
    let stride = splats.sh_rest_stride();
    let mut rest = &mut splats.sh_rest[..];
    let mut poses = poses.map(|poses| {
        poses.positions.clear();
        poses.positions.resize(n, [0.0; 3]);
        poses.rotations.clear();
        poses.rotations.resize(n, [0.0; 4]);
        poses.scales.clear();
        poses.scales.resize(n, [0.0; 3]);
        (
            poses.positions.chunks_mut(CHUNK),
            poses.rotations.chunks_mut(CHUNK),
            poses.scales.chunks_mut(CHUNK),
        )
    });
    let mut outputs = outputs.map(|outputs| {
        outputs.clear();
        outputs.resize(n, OutputGradient::default());
        outputs.chunks_mut(CHUNK)
    });
    let mut log_scales = splats.log_scales.chunks_mut(CHUNK);
    let mut rotations = splats.rotations.chunks_mut(CHUNK);
    let mut opacity_logits = splats.opacity_logits.chunks_mut(CHUNK);
    let mut sh_dc = splats.sh_dc.chunks_mut(CHUNK);
    splats
        .positions
        .chunks_mut(CHUNK)
        .zip((0..).step_by(CHUNK))
        .map(|(positions, first)| {
            let (sh_rest, after) = std::mem::take(&mut rest).split_at_mut(positions.len() * stride);
            rest = after;
            GradientChunk {
                first,
                positions,
                log_scales: log_scales.next().unwrap_or_default(),
                rotations: rotations.next().unwrap_or_default(),
                opacity_logits: opacity_logits.next().unwrap_or_default(),
                sh_dc: sh_dc.next().unwrap_or_default(),
                sh_rest,
                poses: poses.as_mut().map(|(positions, rotations, scales)| PoseChunk {
                    positions: positions.next().unwrap_or_default(),
                    rotations: rotations.next().unwrap_or_default(),
                    scales: scales.next().unwrap_or_default(),
                }),
                outputs: outputs.as_mut().map(|outputs| outputs.next().unwrap_or_default()),
            }
        })
        .collect()
}
