//! The pass that puts an image from a buffer onto a texture.

use super::format::{Encoding, encoding};
use crate::kernel::{part, whole};
use crate::layout::Presentation;
use crate::tiles::PIXEL_BYTES;
use crate::{Gpu, GpuError, shaders};

/// An image on the GPU: premultiplied r g b and alpha, display values, rows of `size[0]` pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageView<'a> {
    pub buffer: &'a wgpu::Buffer,
    pub size: [u32; 2],
}

/// Puts images onto textures of one format.
#[derive(Debug)]
pub(crate) struct Blit {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    uniform: wgpu::Buffer,
    /// What the uniform holds.
    written: Option<Presentation>,
    /// Buffer and bytes of the image that was shown last, bound.
    bound: Option<(wgpu::Buffer, u64, wgpu::BindGroup)>,
}

impl Blit {
    /// # Errors
    /// [`GpuError::Surface`] for formats that are not presented.
    pub(crate) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        let encoding = encoding(format).ok_or_else(|| GpuError::Surface {
            expected: "a format of display values or of linear light",
            found: format!("{format:?}"),
        })?;
        let layout = bind_group_layout(gpu);
        let pipeline = pipeline(gpu, &layout, format, encoding);
        let uniform = gpu.uniform_of("presentation", &[0; size_of::<Presentation>()]);
        Ok(Self { layout, pipeline, uniform, written: None, bound: None })
    }

    /// Records drawing `image` over a background onto the whole of a texture of `size` pixels.
    pub(crate) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        image: ImageView<'_>,
        background: [f32; 3],
        texture: &wgpu::TextureView,
        size: [u32; 2],
    ) -> Result<(), GpuError> {
        let [r, g, b] = background;
        let block = Presentation { background: [r, g, b, 1.0], image: image.size, texture: size };
        if self.written != Some(block) {
            gpu.queue().write_buffer(&self.uniform, 0, bytemuck::bytes_of(&block));
            self.written = Some(block);
        }
        let bytes = u64::from(image.size[0]) * u64::from(image.size[1]) * PIXEL_BYTES;
        let have = gpu.max_binding();
        if bytes > have {
            return Err(GpuError::OutOfMemory { what: "a presented image", need: bytes, have });
        }
        let bind_group = self.bind(gpu, image.buffer, bytes);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: texture,
                depth_slice: None,
                resolve_target: None,
                // Every pixel is written.
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_bind_group(0, &bind_group, &[]);
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
        Ok(())
    }

    fn bind(&mut self, gpu: &Gpu, image: &wgpu::Buffer, bytes: u64) -> wgpu::BindGroup {
        if let Some((buffer, bound, group)) = &self.bound
            && (buffer, *bound) == (image, bytes)
        {
            return group.clone();
        }
        gpu.count_bind_group();
        let entry = |binding, buffer| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::Buffer(buffer),
        };
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("present"),
            layout: &self.layout,
            entries: &[entry(0, whole(&self.uniform)), entry(1, part(image, 0, bytes))],
        });
        self.bound = Some((image.clone(), bytes, group.clone()));
        group
    }
}

fn bind_group_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("present"),
        entries: &[
            entry(0, wgpu::BufferBindingType::Uniform),
            entry(1, wgpu::BufferBindingType::Storage { read_only: true }),
        ],
    })
}

fn pipeline(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
    encoding: Encoding,
) -> wgpu::RenderPipeline {
    gpu.count_pipeline();
    // With wgpu's own checks: it runs once a frame, and sizes come from a window.
    let module = gpu.device().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("present"),
        source: wgpu::ShaderSource::Wgsl(shaders::PRESENT.source().into()),
    });
    let layout = gpu.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("present"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let constants = [("LINEAR", f64::from(u8::from(encoding == Encoding::Linear)))];
    gpu.device().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("present"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("cover"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("present"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            targets: &[Some(format.into())],
        }),
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        multiview_mask: None,
        cache: None,
    })
}
