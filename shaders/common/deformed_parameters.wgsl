// Limits of the scales that a deformation gives; those of common/deform_splat.wgsl, and their
// logarithms, by which the backward pass tells that a scale was held there.

const MIN_DEFORMED_SCALE: f32 = 1e-6;
const MAX_SCALE: f32 = 1e12;
const LOWEST_LOG_SCALE: f32 = -13.815511;
const HIGHEST_LOG_SCALE: f32 = 27.631021;
