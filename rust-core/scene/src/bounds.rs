//! Extent of a scene, and a camera that shows it.

use glam::DVec3;

use crate::{Camera, Splats, sigmoid};

/// Axis-aligned box in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

impl Bounds {
    /// The smallest box around all finite points; `None` when there is none.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().filter(|p| p.is_finite()).fold(None, |bounds, p| {
            Some(bounds.map_or(Self { min: p, max: p }, |b: Self| Self {
                min: b.min.min(p),
                max: b.max.max(p),
            }))
        })
    }

    /// Middle of the box.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        self.min.midpoint(self.max)
    }

    /// Half the diagonal.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.max.distance(self.min) / 2.0
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick =
                |axis: usize| if i >> axis & 1 == 1 { self.max[axis] } else { self.min[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Whether the point is inside or on the faces.
    #[must_use]
    pub fn contains(&self, p: DVec3) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }
}

/// Share of the splats that auto-framing leaves out at each end of each axis: captures have a few
/// far-away floaters that would push the camera out of the room.
const FRAMING_TRIM: f64 = 0.02;
/// Splats below this opacity do not count for auto-framing: training by MCMC scatters the faint ones, up to
/// a half of them, a hundred times as far as the scene is wide.
const FRAMING_OPACITY: f64 = 0.05;

impl Splats {
    /// Box around all finite centres, relative to the scene's origin.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::around(self.positions.iter().map(|&p| DVec3::from(p.map(f64::from))))
    }

    /// Box from the 2nd to the 98th percentile of each coordinate, relative to the scene's origin, of the
    /// splats that are not faint; of all where nothing else is there.
    #[must_use]
    pub fn framing_bounds(&self) -> Option<Bounds> {
        let is_faint = |i: usize| {
            let logit = self.opacity_logits.get(i);
            logit.is_some_and(|&logit| sigmoid(f64::from(logit)) < FRAMING_OPACITY)
        };
        let finite = || self.positions.iter().copied().enumerate().filter(|(_, p)| is_finite(p));
        let solid: Vec<[f32; 3]> =
            finite().filter(|&(i, _)| !is_faint(i)).map(|(_, p)| p).collect();
        if solid.is_empty() {
            return trimmed_bounds(&finite().map(|(_, p)| p).collect::<Vec<_>>());
        }
        trimmed_bounds(&solid)
    }
}

/// Whether a position is one that can be framed, searched or measured from.
pub(crate) fn is_finite(position: &[f32; 3]) -> bool {
    position.iter().all(|c| c.is_finite())
}

/// Box from the 2nd to the 98th percentile of each coordinate of finite points; `None` of none.
fn trimmed_bounds(finite: &[[f32; 3]]) -> Option<Bounds> {
    let last = finite.len().checked_sub(1)?;
    let trim = (last as f64 * FRAMING_TRIM).floor() as usize;
    let mut bounds = Bounds { min: DVec3::ZERO, max: DVec3::ZERO };
    for axis in 0..3 {
        let mut values: Vec<f32> = finite.iter().map(|p| p[axis]).collect();
        let (_, &mut low, _) = values.select_nth_unstable_by(trim, f32::total_cmp);
        let (_, &mut high, _) = values.select_nth_unstable_by(last - trim, f32::total_cmp);
        bounds.min[axis] = f64::from(low);
        bounds.max[axis] = f64::from(high);
    }
    Some(bounds)
}

/// View direction for auto-framing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Degrees around `up`; 0 looks along +z's negative side, from the front.
    pub azimuth: f64,
    /// Degrees above the horizon.
    pub elevation: f64,
    /// The direction that is up in the image.
    pub up: DVec3,
}

impl Orbit {
    /// A camera on the orbit, far enough that a sphere around the bounds fills the frame.
    #[must_use]
    pub fn frame(&self, bounds: &Bounds, vertical_fov: f64, size: (u32, u32)) -> Camera {
        let up = self.up.try_normalize().unwrap_or(DVec3::Y);
        // Two horizontal axes: "front" is the world axis that is least along `up`, z if possible.
        let helper = if up.z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
        let front = (helper - up * helper.dot(up)).normalize();
        let side = up.cross(front);
        let (sa, ca) = self.azimuth.to_radians().sin_cos();
        let (se, ce) = self.elevation.to_radians().sin_cos();
        let direction = (front * ca + side * sa) * ce + up * se;

        let aspect = f64::from(size.0) / f64::from(size.1);
        let half_vertical = vertical_fov / 2.0;
        let half_narrow = (half_vertical.tan() * aspect.min(1.0)).atan();
        let radius = bounds.radius().max(1e-6);
        let eye = bounds.centre() + direction * (radius / half_narrow.sin());
        Camera::look_at(eye, bounds.centre(), up, vertical_fov, size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_ignore_points_that_are_not_finite() {
        let points = [DVec3::ONE, DVec3::new(f64::NAN, 0.0, 0.0), DVec3::new(3.0, -1.0, 2.0)];
        let bounds = Bounds::around(points).unwrap();
        assert_eq!(bounds.min, DVec3::new(1.0, -1.0, 1.0));
        assert_eq!(bounds.max, DVec3::new(3.0, 1.0, 2.0));
        assert_eq!(Bounds::around([]), None);
    }

    #[test]
    fn framing_leaves_out_what_is_faint_unless_nothing_else_is_there() {
        let positions: Vec<[f32; 3]> =
            (0..100).map(|i| [if i % 2 == 0 { 1.0 } else { 90.0 }, i as f32, 0.0]).collect();
        let logits = |faint: f32| (0..100).map(|i| if i % 2 == 0 { 0.0 } else { faint }).collect();
        let splats = |opacity_logits| Splats {
            positions: positions.clone(),
            opacity_logits,
            ..Splats::default()
        };
        let width = |splats: &Splats| splats.framing_bounds().unwrap().max.x;
        assert_eq!(width(&splats(logits(-5.0))), 1.0);
        assert_eq!(width(&splats(logits(-2.0))), 90.0);
        assert_eq!(width(&splats(vec![-5.0; 100])), 90.0);
        assert_eq!(width(&splats(Vec::new())), 90.0);
    }

    #[test]
    fn framing_leaves_out_a_far_floater() {
        let mut splats = Splats::default();
        splats.positions.extend((0..1000).map(|i| [(i % 10) as f32, 0.0, 0.0]));
        splats.positions.push([1e9, 0.0, 0.0]);
        let bounds = splats.framing_bounds().unwrap();
        assert!(bounds.max.x <= 9.0, "{bounds:?}");
    }

    #[test]
    fn framing_shows_every_corner_of_the_box() {
        let bounds = Bounds { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 1.0, 7.0) };
        for size in [(640, 480), (300, 900)] {
            for (azimuth, elevation) in [(0.0, 0.0), (130.0, 45.0), (-70.0, 90.0), (10.0, -90.0)] {
                let orbit = Orbit { azimuth, elevation, up: DVec3::NEG_Y };
                let camera = orbit.frame(&bounds, 0.9, size);
                for world in bounds.corners() {
                    let p = camera.world_to_camera.transform_point3(world);
                    let u = camera.fx * p.x / p.z + camera.cx;
                    let v = camera.fy * p.y / p.z + camera.cy;
                    assert!(p.z > 0.0);
                    assert!((0.0..=f64::from(size.0)).contains(&u), "{u}");
                    assert!((0.0..=f64::from(size.1)).contains(&v), "{v}");
                }
            }
        }
    }
}
