//! Trainable splats on the GPU: the stored parameters, array by array.
//!
//! The arrays hold what a file holds (log-scales, logits, quaternions of any length), as `f32`s in
//! the layout of [`Splats`]: whatever is in them can be written to a file and read back without
//! arithmetic. Gradients and the moments of an optimiser have the same type, so a kernel that
//! walks one of them walks all.

use bytemuck::AnyBitPattern;
use trapeze_scene::{ShDegree, Splats};

use crate::{Gpu, GpuError, readback};

/// Six arrays of `f32`, tightly packed; room for `capacity` splats, of which the first `count` are
/// there. What lies behind them is unspecified.
///
/// | buffer | floats per splat |
/// |---|---|
/// | `positions` | 3 |
/// | `log_scales` | 3 |
/// | `rotations` | 4: w, x, y, z |
/// | `opacity_logits` | 1 |
/// | `sh_dc` | 3: r g b |
/// | `sh_rest` | 3 · ((degree + 1)² − 1), coefficient-major, r g b innermost |
///
/// Every buffer has the usages `STORAGE | COPY_SRC | COPY_DST`. The fields are public because
/// kernels outside this crate bind them; clones share the buffers.
#[derive(Clone, Debug)]
pub struct ParameterBuffers {
    /// Centres.
    pub positions: wgpu::Buffer,
    /// Natural logarithms of the standard deviations.
    pub log_scales: wgpu::Buffer,
    /// Quaternions.
    pub rotations: wgpu::Buffer,
    /// Opacities before the logistic function.
    pub opacity_logits: wgpu::Buffer,
    /// Band 0 of the spherical harmonics.
    pub sh_dc: wgpu::Buffer,
    /// Bands 1…degree; a few unused bytes at degree 0.
    pub sh_rest: wgpu::Buffer,
    /// Splats that are there.
    pub count: u32,
    /// Splats that there is room for.
    pub capacity: u32,
    /// Degree of `sh_rest`.
    pub sh_degree: ShDegree,
}

/// One of the six arrays.
#[derive(Clone, Copy, Debug)]
pub struct ParameterArray<'a> {
    /// Name of the array in [`Splats`].
    pub name: &'static str,
    /// The array.
    pub buffer: &'a wgpu::Buffer,
    /// Floats per splat; 0 for `sh_rest` at degree 0.
    pub stride: u32,
}

impl ParameterBuffers {
    /// Room for `capacity` splats, of which none are there; all zero.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] names the array that does not fit into one binding of the device,
    /// or into its memory.
    pub fn zeroed(gpu: &Gpu, capacity: u32, sh_degree: ShDegree) -> Result<Self, GpuError> {
        let array = |name: &'static str, stride: u32| {
            let bytes = u64::from(capacity) * u64::from(stride) * 4;
            let have = gpu.max_binding();
            if bytes > have {
                return Err(GpuError::OutOfMemory { what: name, need: bytes, have });
            }
            gpu.storage(name, bytes)
        };
        let [positions, log_scales, rotations, opacity_logits, sh_dc, sh_rest] = strides(sh_degree);
        Ok(Self {
            positions: array("positions", positions)?,
            log_scales: array("log_scales", log_scales)?,
            rotations: array("rotations", rotations)?,
            opacity_logits: array("opacity_logits", opacity_logits)?,
            sh_dc: array("sh_dc", sh_dc)?,
            sh_rest: array("sh_rest", sh_rest)?,
            count: 0,
            capacity,
            sh_degree,
        })
    }

    /// Buffers of the splats' own degree that hold `splats` and have room for `capacity` of them
    /// (at least for those that are there).
    ///
    /// # Errors
    /// Those of [`zeroed`](Self::zeroed), and [`GpuError::Scene`] when the arrays do not fit
    /// together.
    pub fn from_splats(gpu: &Gpu, splats: &Splats, capacity: u32) -> Result<Self, GpuError> {
        splats.validate()?;
        let capacity = capacity.max(splats.len() as u32);
        let mut buffers = Self::zeroed(gpu, capacity, splats.sh_degree)?;
        buffers.write(gpu, splats)?;
        Ok(buffers)
    }

    /// Bytes that `capacity` splats of a degree take.
    #[must_use]
    pub fn bytes(capacity: u32, sh_degree: ShDegree) -> u64 {
        strides(sh_degree).iter().map(|&stride| u64::from(stride) * 4).sum::<u64>()
            * u64::from(capacity)
    }

    /// The arrays, in the order of the fields.
    #[must_use]
    pub fn arrays(&self) -> [ParameterArray<'_>; 6] {
        let strides = strides(self.sh_degree);
        let buffers = [
            ("positions", &self.positions),
            ("log_scales", &self.log_scales),
            ("rotations", &self.rotations),
            ("opacity_logits", &self.opacity_logits),
            ("sh_dc", &self.sh_dc),
            ("sh_rest", &self.sh_rest),
        ];
        std::array::from_fn(|i| {
            let (name, buffer) = buffers[i];
            ParameterArray { name, buffer, stride: strides[i] }
        })
    }

    /// Replaces what is there by `splats`, whose degree must be that of the buffers, before
    /// anything that is submitted from now on.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when there is no room, [`GpuError::Scene`] when the arrays do not
    /// fit together or have another degree, [`GpuError::Device`] when the device is lost.
    pub fn write(&mut self, gpu: &Gpu, splats: &Splats) -> Result<(), GpuError> {
        splats.validate()?;
        if splats.sh_degree != self.sh_degree {
            return Err(GpuError::Scene(trapeze_scene::SceneError::Length {
                field: "sh_rest",
                expected: splats.len() * self.sh_degree.rest_coefficients() * 3,
                found: splats.sh_rest.len(),
            }));
        }
        let count = splats.len() as u32;
        if count > self.capacity {
            let bytes = |n| Self::bytes(n, self.sh_degree);
            let (need, have) = (bytes(count), bytes(self.capacity));
            return Err(GpuError::OutOfMemory { what: "splats", need, have });
        }
        gpu.write(&self.positions, splats.positions.as_flattened())?;
        gpu.write(&self.log_scales, splats.log_scales.as_flattened())?;
        gpu.write(&self.rotations, splats.rotations.as_flattened())?;
        gpu.write(&self.opacity_logits, &splats.opacity_logits)?;
        gpu.write(&self.sh_dc, splats.sh_dc.as_flattened())?;
        gpu.write(&self.sh_rest, &splats.sh_rest)?;
        self.count = count;
        Ok(())
    }

    /// The splats that are there, and waits for them.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read(&self, gpu: &Gpu) -> Result<Splats, GpuError> {
        let n = u64::from(self.count);
        let rest = self.sh_degree.rest_coefficients() as u64 * 3;
        Ok(Splats {
            positions: read(gpu, &self.positions, n)?,
            log_scales: read(gpu, &self.log_scales, n)?,
            rotations: read(gpu, &self.rotations, n)?,
            opacity_logits: read(gpu, &self.opacity_logits, n)?,
            sh_dc: read(gpu, &self.sh_dc, n)?,
            sh_rest: read(gpu, &self.sh_rest, n * rest)?,
            sh_degree: self.sh_degree,
        })
    }

    /// Whether both are the same buffers.
    pub(crate) fn shares_buffers_with(&self, other: &Self) -> bool {
        self.arrays().iter().zip(other.arrays()).all(|(a, b)| a.buffer == b.buffer)
    }

    /// Records setting every float to zero.
    pub fn record_clear(&self, encoder: &mut wgpu::CommandEncoder) {
        for array in self.arrays() {
            encoder.clear_buffer(array.buffer, 0, None);
        }
    }
}

/// Floats per splat of each array.
fn strides(sh_degree: ShDegree) -> [u32; 6] {
    [3, 3, 4, 1, 3, sh_degree.rest_coefficients() as u32 * 3]
}

fn read<T: AnyBitPattern>(gpu: &Gpu, buffer: &wgpu::Buffer, n: u64) -> Result<Vec<T>, GpuError> {
    if n == 0 { Ok(Vec::new()) } else { readback::read(gpu, buffer, n) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel_tests::device;

    fn splats(n: usize, sh_degree: ShDegree) -> Splats {
        let value = |i: usize, k: usize| (i * 64 + k) as f32 * 0.25 - 7.0;
        let rest = sh_degree.rest_coefficients() * 3;
        Splats {
            positions: (0..n).map(|i| std::array::from_fn(|c| value(i, c))).collect(),
            log_scales: (0..n).map(|i| std::array::from_fn(|c| value(i, 3 + c))).collect(),
            rotations: (0..n).map(|i| std::array::from_fn(|c| value(i, 6 + c))).collect(),
            opacity_logits: (0..n).map(|i| value(i, 10)).collect(),
            sh_dc: (0..n).map(|i| std::array::from_fn(|c| value(i, 11 + c))).collect(),
            sh_rest: (0..n * rest).map(|j| value(j / rest, 14 + j % rest)).collect(),
            sh_degree,
        }
    }

    #[test]
    fn splats_come_back_as_they_were_written() {
        let Some(gpu) = device() else { return };
        for sh_degree in ShDegree::ALL {
            let some = splats(37, sh_degree);
            let mut buffers = ParameterBuffers::from_splats(&gpu, &some, 100).unwrap();
            assert_eq!((buffers.count, buffers.capacity), (37, 100));
            assert_eq!(buffers.read(&gpu).unwrap(), some);
            let others = splats(100, sh_degree);
            buffers.write(&gpu, &others).unwrap();
            assert_eq!(buffers.read(&gpu).unwrap(), others);
            let none = splats(0, sh_degree);
            buffers.write(&gpu, &none).unwrap();
            assert_eq!(buffers.read(&gpu).unwrap(), none);
        }
    }

    #[test]
    fn clearing_leaves_zeros_and_the_count() {
        let Some(gpu) = device() else { return };
        let some = splats(5, ShDegree::One);
        let buffers = ParameterBuffers::from_splats(&gpu, &some, 5).unwrap();
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        buffers.record_clear(&mut encoder);
        gpu.queue().submit([encoder.finish()]);
        let cleared = buffers.read(&gpu).unwrap();
        assert_eq!(cleared.positions, [[0.0; 3]; 5]);
        assert!(cleared.sh_rest.len() == 45 && cleared.sh_rest.iter().all(|&c| c == 0.0));
    }

    #[test]
    fn more_splats_than_fit_are_refused_with_need_and_have() {
        let Some(gpu) = device() else { return };
        let mut buffers = ParameterBuffers::zeroed(&gpu, 4, ShDegree::Zero).unwrap();
        let error = buffers.write(&gpu, &splats(5, ShDegree::Zero)).unwrap_err();
        assert!(matches!(error, GpuError::OutOfMemory { need: 280, have: 224, .. }), "{error}");
        assert!(matches!(buffers.write(&gpu, &splats(2, ShDegree::One)), Err(GpuError::Scene(_))));
        let most = (gpu.max_binding() / 180) as u32;
        let error = ParameterBuffers::zeroed(&gpu, most + 1, ShDegree::Three).unwrap_err();
        assert!(matches!(error, GpuError::OutOfMemory { what: "sh_rest", .. }), "{error}");
    }
}
