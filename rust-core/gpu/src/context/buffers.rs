//! Making buffers and filling them, counted.

use std::sync::atomic::{AtomicU64, Ordering};

use wgpu::util::DeviceExt;

use crate::{Gpu, GpuError};

/// Objects created since the device was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Created {
    /// Buffers.
    pub buffers: u64,
    /// Their bytes.
    pub buffer_bytes: u64,
    /// Bind groups.
    pub bind_groups: u64,
    /// Pipelines.
    pub pipelines: u64,
    /// Times that the CPU waited for the GPU.
    pub waits: u64,
}

#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) buffers: AtomicU64,
    pub(super) buffer_bytes: AtomicU64,
    pub(super) bind_groups: AtomicU64,
    pub(super) pipelines: AtomicU64,
    pub(super) waits: AtomicU64,
}

/// Bytes of one write of an upload.
const UPLOAD_PIECE: usize = 16 << 20;

impl Gpu {
    /// A buffer of at least `bytes`, zeroed.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when it is larger than a buffer may be, or than what is left.
    pub fn buffer(
        &self,
        label: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        // wgpu refuses empty bindings, and structs of kernels are up to 48 bytes.
        let size = bytes.max(256).next_multiple_of(16);
        let have = self.limits().max_buffer_size;
        if size > have {
            return Err(GpuError::OutOfMemory { what: label, need: size, have });
        }
        self.count_buffer(size);
        let scope = self.device().push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(buffer),
            Some(_) => Err(GpuError::OutOfMemory { what: label, need: size, have: 0 }),
        }
    }

    /// A storage buffer of at least `bytes` that can also be copied from and written to.
    ///
    /// # Errors
    /// Those of [`buffer`](Self::buffer).
    pub fn storage(&self, label: &'static str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC;
        self.buffer(label, bytes, usage)
    }

    /// A storage buffer that holds `data`.
    ///
    /// # Errors
    /// Those of [`buffer`](Self::buffer), and [`GpuError::Device`] when the device is lost.
    pub fn storage_of<T: bytemuck::NoUninit>(
        &self,
        label: &'static str,
        data: &[T],
    ) -> Result<wgpu::Buffer, GpuError> {
        let buffer = self.storage(label, size_of_val(data) as u64)?;
        self.write(&buffer, data)?;
        Ok(buffer)
    }

    /// Writes `data` to the start of a buffer, before anything that is submitted from now on. Large
    /// data go in pieces, with a wait now and then, so that the staging memory stays small.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn write<T: bytemuck::NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        data: &[T],
    ) -> Result<(), GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        for (i, piece) in bytes.chunks(UPLOAD_PIECE).enumerate() {
            self.queue().write_buffer(buffer, (i * UPLOAD_PIECE) as u64, piece);
            if i % 8 == 7 {
                self.queue().submit([]);
                self.wait()?;
            }
        }
        Ok(())
    }

    /// A uniform buffer that holds `data` and can be written to.
    pub fn uniform_of(&self, label: &'static str, data: &[u8]) -> wgpu::Buffer {
        self.count_buffer(data.len() as u64);
        self.device().create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: data,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        })
    }

    fn count_buffer(&self, bytes: u64) {
        self.inner.created.buffers.fetch_add(1, Ordering::Relaxed);
        self.inner.created.buffer_bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    pub(crate) fn count_bind_group(&self) {
        self.inner.created.bind_groups.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn count_pipeline(&self) {
        self.inner.created.pipelines.fetch_add(1, Ordering::Relaxed);
    }
}
