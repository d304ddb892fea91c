//! Memory for planes: floats that begin on a cache line.

use std::ops::{Deref, DerefMut};

use bytemuck::{Pod, Zeroable};

/// One cache line. A vector load that crosses from one line into the next takes twice as long.
#[repr(C, align(64))]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Line([f32; Line::FLOATS]);

impl Line {
    const FLOATS: usize = 16;
}

/// Floats that begin on a cache line.
#[derive(Default)]
pub(super) struct Plane(Vec<Line>);

impl Plane {
    /// At least `floats` zeros.
    pub(super) fn zeros(floats: usize) -> Self {
        Self(vec![Line::zeroed(); floats.div_ceil(Line::FLOATS)])
    }
}

impl Deref for Plane {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        bytemuck::cast_slice(&self.0)
    }
}

impl DerefMut for Plane {
    fn deref_mut(&mut self) -> &mut [f32] {
        bytemuck::cast_slice_mut(&mut self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_begin_on_a_cache_line() {
        for floats in [0, 1, 16, 17, 5000] {
            let plane = Plane::zeros(floats);
            assert!(plane.len() >= floats && plane.iter().all(|&v| v == 0.0));
            assert!(plane.as_ptr().addr().is_multiple_of(64));
        }
    }
}
