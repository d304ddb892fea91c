//! The blit onto offscreen textures of every format that a surface may have.

use std::sync::Arc;

use trapeze_scene::{Camera, Frame, FrameSettings, Scene, Splats};
use wgpu::TextureFormat;

use super::Blit;
use super::format::{Encoding, encoding};
use crate::kernel_tests::device;
use crate::{Gpu, Renderer, readback};

const SIZE: [u32; 2] = [64, 48];
const BACKGROUND: [f32; 3] = [0.25, 0.5, 1.0];

/// Two large soft splats: every alpha, and channels from 0 to beyond 1.
fn rendered(gpu: &Gpu) -> (Renderer, Frame) {
    let splats = Splats {
        positions: vec![[-0.4, 0.0, 3.0], [0.5, 0.2, 4.0]],
        log_scales: vec![[-0.7; 3], [0.0; 3]],
        rotations: vec![[1.0, 0.0, 0.0, 0.0]; 2],
        opacity_logits: vec![3.0, 1.0],
        sh_dc: vec![[3.0, -0.5, 0.1], [-1.0, 0.8, 0.4]],
        ..Splats::default()
    };
    let camera = Camera {
        width: SIZE[0],
        height: SIZE[1],
        fx: 50.0,
        fy: 50.0,
        cx: 32.0,
        cy: 24.0,
        world_to_camera: glam::DMat4::IDENTITY,
    };
    let mut renderer = Renderer::new(gpu, Arc::new(Scene::from_splats(splats))).unwrap();
    let frame = renderer.render(&camera, &FrameSettings::default()).unwrap();
    (renderer, frame)
}

/// Shows the renderer's image on a texture, and returns the texture's bytes, rows joined.
fn shown(gpu: &Gpu, renderer: &Renderer, format: TextureFormat, size: [u32; 2]) -> Vec<u8> {
    let extent = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let mut blit = Blit::new(gpu, format).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let view = texture.create_view(&Default::default());
    blit.record(gpu, &mut encoder, renderer.image(), BACKGROUND, &view, size).unwrap();
    let pixel_bytes = format.block_copy_size(None).unwrap();
    // A multiple of 256 bytes, as copies want it.
    let row = (size[0] * pixel_bytes).next_multiple_of(256);
    let bytes = gpu.storage("texture", u64::from(row * size[1])).unwrap();
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &bytes,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        extent,
    );
    gpu.queue().submit([encoder.finish()]);
    let padded: Vec<u8> = readback::read(gpu, &bytes, u64::from(row * size[1])).unwrap();
    padded
        .chunks_exact(row as usize)
        .flat_map(|line| &line[..(size[0] * pixel_bytes) as usize])
        .copied()
        .collect()
}

fn decoded(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// r g b a of a texture as the numbers that were stored.
fn stored(format: TextureFormat, bytes: &[u8]) -> Vec<[f32; 4]> {
    let byte = |b: u8| f32::from(b) / 255.0;
    match format {
        TextureFormat::Rgba16Float => bytes
            .chunks_exact(8)
            .map(|p| {
                let half = |i: usize| half::f16::from_le_bytes([p[2 * i], p[2 * i + 1]]).to_f32();
                [half(0), half(1), half(2), half(3)]
            })
            .collect(),
        TextureFormat::Rgb10a2Unorm => bytes
            .chunks_exact(4)
            .map(|p| {
                let word = u32::from_le_bytes([p[0], p[1], p[2], p[3]]);
                let ten = |shift: u32| (word >> shift & 1023) as f32 / 1023.0;
                [ten(0), ten(10), ten(20), (word >> 30) as f32 / 3.0]
            })
            .collect(),
        TextureFormat::Bgra8Unorm | TextureFormat::Bgra8UnormSrgb => bytes
            .chunks_exact(4)
            .map(|p| [byte(p[2]), byte(p[1]), byte(p[0]), byte(p[3])])
            .collect(),
        _ => bytes.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]].map(byte)).collect(),
    }
}

#[test]
fn every_format_shows_the_image_over_the_background() {
    let Some(gpu) = device() else { return };
    let (renderer, frame) = rendered(&gpu);
    let expected = frame.over(BACKGROUND);
    // All levels of coverage are there, and a channel that a screen cannot show.
    assert!(frame.color.iter().any(|p| p[3] == 0.0) && frame.color.iter().any(|p| p[0] > 1.0));
    // Storing a number may go to either of its two neighbours (Vulkan 1.3, 49.1.2); encoding on
    // write adds an error of 0.6 levels.
    for (format, tolerance) in [
        (TextureFormat::Bgra8Unorm, 1.0 / 255.0),
        (TextureFormat::Rgba8Unorm, 1.0 / 255.0),
        (TextureFormat::Rgb10a2Unorm, 1.0 / 1023.0),
        (TextureFormat::Bgra8UnormSrgb, 1.6 / 255.0),
        (TextureFormat::Rgba8UnormSrgb, 1.6 / 255.0),
        // Linear light reaches about 2.2 here, where neighbouring halves are 2⁻⁹ apart.
        (TextureFormat::Rgba16Float, 1.0 / 512.0),
    ] {
        let pixels = stored(format, &shown(&gpu, &renderer, format, SIZE));
        assert_eq!(pixels.len(), expected.len());
        let linear = format == TextureFormat::Rgba16Float;
        for (i, (ours, want)) in pixels.iter().zip(&expected).enumerate() {
            assert_eq!(ours[3], 1.0, "{format:?}: the background is part of the image");
            for c in 0..3 {
                let want = if linear { decoded(want[c]) } else { want[c].min(1.0) };
                assert!(
                    (ours[c] - want).abs() <= tolerance + 1e-6,
                    "{format:?}, pixel {i}, channel {c}: {} and {want}",
                    ours[c]
                );
            }
        }
    }
}

#[test]
fn formats_that_encode_are_fed_linear_light() {
    assert_eq!(encoding(TextureFormat::Bgra8Unorm), Some(Encoding::Display));
    assert_eq!(encoding(TextureFormat::Bgra8UnormSrgb), Some(Encoding::Linear));
    assert_eq!(encoding(TextureFormat::Depth32Float), None);
}

#[test]
fn an_image_of_another_size_is_stretched_without_shifting() {
    let Some(gpu) = device() else { return };
    let (renderer, frame) = rendered(&gpu);
    let size = [SIZE[0] * 2, SIZE[1] * 2];
    let format = TextureFormat::Rgba8Unorm;
    let pixels = stored(format, &shown(&gpu, &renderer, format, size));
    // Four shown pixels lie around the centre of each pixel of the image; bilinear values at ±¼ of
    // a pixel average to the pixel plus a 32nd of its second differences.
    let expected = frame.over(BACKGROUND);
    let at = |x: u32, y: u32| pixels[(y * size[0] + x) as usize];
    let mut worst = 0f32;
    for y in 1..SIZE[1] - 1 {
        for x in 1..SIZE[0] - 1 {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)];
            for c in 0..3 {
                let mean = four.iter().map(|(i, j)| at(2 * x + i, 2 * y + j)[c]).sum::<f32>() / 4.0;
                let want = expected[(y * SIZE[0] + x) as usize][c].min(1.0);
                worst = worst.max((mean - want).abs());
            }
        }
    }
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn before_the_first_frame_the_background_is_shown() {
    let Some(gpu) = device() else { return };
    let renderer = Renderer::new(&gpu, Arc::new(Scene::default())).unwrap();
    let format = TextureFormat::Rgba8Unorm;
    let pixels = stored(format, &shown(&gpu, &renderer, format, [5, 3]));
    assert!(pixels.iter().all(|p| (p[0] - 0.25).abs() < 0.003 && p[2] == 1.0), "{pixels:?}");
}

#[test]
fn showing_the_same_image_again_creates_nothing() {
    let Some(gpu) = device() else { return };
    let (renderer, _) = rendered(&gpu);
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Bgra8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let mut blit = Blit::new(&gpu, TextureFormat::Bgra8Unorm).unwrap();
    let mut before = None;
    for _ in 0..3 {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        blit.record(&gpu, &mut encoder, renderer.image(), BACKGROUND, &view, [8, 8]).unwrap();
        gpu.queue().submit([encoder.finish()]);
        let created = gpu.created();
        assert_eq!(*before.get_or_insert(created), created);
    }
}
