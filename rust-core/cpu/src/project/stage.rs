//! Projecting all splats of a frame.

use glam::DVec3;
use rayon::prelude::*;
use trapeze_scene::{Camera, ColorSource, FrameSettings, Scene, ShDegree, Splats, sigmoid};

use super::color::{flat_color, limit_channel, motion_reference, sh_basis_f32, sh_color};
use super::{ProjectedSplat, ProjectedSplats};
use crate::deform::Deformed;
use crate::reference::{ALPHA_MIN, JACOBIAN_MARGIN, NEAR_PLANE};

/// Splats whose opacities one task computes.
const CHUNK: usize = 1024;

/// What the projection needs of a scene and does not change with the frame.
#[derive(Clone, Debug, Default)]
pub struct ProjectionStage {
    /// Opacity of each splat, 0–1; 0 for NaN logits.
    opacities: Vec<f32>,
    motion_reference: f32,
    sh_degree: ShDegree,
}

impl ProjectionStage {
    /// Prepares a scene: opacities, and the SH bands that are not zero everywhere.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let mut stage = Self {
            opacities: Vec::new(),
            motion_reference: motion_reference(scene),
            sh_degree: scene.splats.used_sh_degree(),
        };
        stage.set_opacities(&scene.splats.opacity_logits);
        stage
    }

    /// Prepares splats that change from frame to frame: all their SH bands count, zero or not.
    pub(crate) fn set_splats(&mut self, splats: &Splats) {
        self.set_opacities(&splats.opacity_logits);
        self.sh_degree = splats.sh_degree;
        self.motion_reference = 1.0;
    }

    /// Opacity of each splat, 0–1.
    pub(crate) fn opacities(&self) -> &[f32] {
        &self.opacities
    }

    fn set_opacities(&mut self, logits: &[f32]) {
        let opacity = |&logit: &f32| sigmoid(f64::from(logit)) as f32;
        logits.par_iter().with_min_len(CHUNK).map(opacity).collect_into_vec(&mut self.opacities);
    }
}

/// The camera in single precision, arranged so that nothing large is subtracted from something
/// large: the position is split into two floats, and splats are taken relative to the first part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) rotation: [[f32; 3]; 3],
    centre_high: [f32; 3],
    centre_low: [f32; 3],
    pub(crate) focal: [f32; 2],
    principal: [f32; 2],
    /// Camera centre and third row of the rotation, for the depth.
    centre: [f64; 3],
    forward: [f64; 3],
    pub(crate) slope_min: [f32; 2],
    pub(crate) slope_max: [f32; 2],
    /// Pixel bounds of what is drawn: splats whose box lies outside are dropped.
    image: [f32; 2],
}

impl View {
    pub(crate) fn new(camera: &Camera) -> Self {
        let centre = camera.centre();
        let high = centre.to_array().map(|v| v as f32);
        let low = (centre - DVec3::from(high.map(f64::from))).to_array().map(|v| v as f32);
        let size = [f64::from(camera.width), f64::from(camera.height)];
        let focal = [camera.fx, camera.fy];
        let principal = [camera.cx, camera.cy];
        let margin: [f64; 2] =
            std::array::from_fn(|i| JACOBIAN_MARGIN * size[i] / (2.0 * focal[i]));
        Self {
            rotation: camera
                .rotation()
                .transpose()
                .to_cols_array_2d()
                .map(|row| row.map(|v| v as f32)),
            centre_high: high,
            centre_low: low,
            focal: focal.map(|v| v as f32),
            principal: principal.map(|v| v as f32),
            centre: centre.to_array(),
            forward: camera.rotation().row(2).to_array(),
            slope_min: std::array::from_fn(|i| -(principal[i] / focal[i] + margin[i]) as f32),
            slope_max: std::array::from_fn(|i| {
                ((size[i] - principal[i]) / focal[i] + margin[i]) as f32
            }),
            image: size.map(|v| v as f32),
        }
    }
}

impl View {
    /// View z in double precision: an order by f32 depths would differ from the reference's
    /// wherever two splats are closer than 10⁻⁷ of their distance, and large splats then show it
    /// in all pixels that they share.
    #[inline(always)]
    fn depth(&self, position: [f32; 3]) -> f64 {
        (0..3).map(|c| self.forward[c] * (f64::from(position[c]) - self.centre[c])).sum()
    }

    /// The vector from the camera to a position, world axes.
    #[inline(always)]
    pub(crate) fn offset(&self, position: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|c| (position[c] - self.centre_high[c]) - self.centre_low[c])
    }

    /// x/z or y/z as the Jacobian takes it.
    #[inline(always)]
    pub(crate) fn limited_slope(&self, axis: usize, slope: f32) -> f32 {
        slope.clamp(self.slope_min[axis], self.slope_max[axis])
    }

    /// A row of J W, pixels per world unit: J has f/z on the axis and −f·slope/z on z.
    #[inline(always)]
    pub(crate) fn jacobian_row(&self, axis: usize, limited: f32, inverse_z: f32) -> [f32; 3] {
        let gain = self.focal[axis] * inverse_z;
        let w = &self.rotation;
        std::array::from_fn(|c| gain * (w[axis][c] - limited * w[2][c]))
    }
}

/// Projects the visible splats of a frame into `out`, in the order of the scene. `camera` is
/// relative to the scene's origin.
pub fn project(
    scene: &Scene,
    stage: &ProjectionStage,
    deformed: &Deformed,
    camera: &Camera,
    settings: &FrameSettings,
    out: &mut ProjectedSplats,
) {
    let view = View::new(camera);
    let input = Input { scene, stage, deformed, settings };
    out.fill(scene.len(), |i| input.project(i, &view));
}

struct Input<'a> {
    scene: &'a Scene,
    stage: &'a ProjectionStage,
    deformed: &'a Deformed,
    settings: &'a FrameSettings,
}

impl Input<'_> {
    /// The plain twin of this function is `Projection::project` of the f64 reference.
    #[inline(always)]
    fn project(&self, i: usize, view: &View) -> Option<ProjectedSplat> {
        let opacity = self.stage.opacities[i];
        if opacity < ALPHA_MIN as f32 || !self.is_shown(i) {
            return None;
        }
        let position = self.deformed.positions[i];
        let offset = view.offset(position);
        let p = multiply(&view.rotation, offset);
        // False for NaN.
        if !(p[2] > NEAR_PLANE as f32) {
            return None;
        }
        let inverse_z = 1.0 / p[2];
        let slope = [p[0] * inverse_z, p[1] * inverse_z];
        let centre: [f32; 2] =
            std::array::from_fn(|c| view.focal[c] * slope[c] + view.principal[c]);
        let [mx, my] = self.image_factor(i, view, slope, inverse_z);
        let mut splat = ProjectedSplat::from_factor(centre, mx, my, opacity)?;
        let inside = splat.x + splat.half_width > 0.0
            && splat.x - splat.half_width < view.image[0]
            && splat.y + splat.half_height > 0.0
            && splat.y - splat.half_height < view.image[1];
        if !inside {
            return None;
        }
        let depth = view.depth(position);
        splat.depth = depth as f32;
        // A depth that single precision cannot hold has no place in the order.
        if !splat.depth.is_finite() {
            return None;
        }
        splat.depth_low = (depth - f64::from(splat.depth)) as f32;
        splat.index = i as u32;
        splat.color = self.color(i, offset, splat.depth);
        Some(splat)
    }

    fn is_shown(&self, i: usize) -> bool {
        match &self.scene.clusters {
            Some(clusters) => self.settings.selection.shows(clusters.labels[i]),
            None => true,
        }
    }

    /// The rows of M = J W R S, pixels.
    #[inline(always)]
    fn image_factor(
        &self,
        i: usize,
        view: &View,
        slope: [f32; 2],
        inverse_z: f32,
    ) -> [[f32; 3]; 2] {
        let scale = self.deformed.scales[i];
        let rotation = rotation_matrix(self.deformed.rotations[i]);
        std::array::from_fn(|axis| {
            let row = view.jacobian_row(axis, view.limited_slope(axis, slope[axis]), inverse_z);
            std::array::from_fn(|column| {
                let dot = row[0] * rotation[0][column]
                    + row[1] * rotation[1][column]
                    + row[2] * rotation[2][column];
                dot * scale[column]
            })
        })
    }

    #[inline(always)]
    fn color(&self, i: usize, to_splat: [f32; 3], depth: f32) -> [f32; 3] {
        let source = self.settings.color_source;
        if source != ColorSource::SphericalHarmonics {
            return flat_color(self.scene, source, i, self.stage.motion_reference, depth);
        }
        let splats = &self.scene.splats;
        let degree = self.stage.sh_degree.min(self.settings.max_sh_degree);
        let basis = sh_basis_f32(direction(to_splat), degree);
        let rest = &splats.sh_rest_of(i)[..degree.rest_coefficients() * 3];
        sh_color(&basis, splats.sh_dc[i], rest).map(limit_channel)
    }
}

/// v / ‖v‖, or z where v has no direction.
#[inline(always)]
pub(crate) fn direction(v: [f32; 3]) -> [f32; 3] {
    let length_squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if length_squared > f32::MIN_POSITIVE && length_squared < f32::MAX {
        let inverse = 1.0 / length_squared.sqrt();
        return v.map(|c| c * inverse);
    }
    // Squares out of range: divide by the largest component first.
    let largest = v.iter().fold(0.0f32, |m, c| m.max(c.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return [0.0, 0.0, 1.0];
    }
    let v = v.map(|c| c / largest);
    let inverse = 1.0 / (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|c| c * inverse)
}

#[inline(always)]
pub(crate) fn multiply(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2])
}

/// Row-major matrix of a quaternion (w, x, y, z), by the formula for unit quaternions.
#[inline(always)]
pub(crate) fn rotation_matrix([w, x, y, z]: [f32; 4]) -> [[f32; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
