//! The GPU that tests run on: a real one, or software Vulkan.

use std::sync::{Arc, OnceLock};

use trapeze_gpu::{DeviceProfile, Gpu, GpuOptions, Renderer};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene};

/// The device with a profile, opened once; `None`, loudly, on machines without Vulkan or Metal.
///
/// # Panics
/// When there is a device that cannot be opened.
#[must_use]
pub fn gpu(profile: DeviceProfile) -> Option<Gpu> {
    static DEVICES: [OnceLock<Option<Gpu>>; 3] =
        [OnceLock::new(), OnceLock::new(), OnceLock::new()];
    let open = || match Gpu::open(&GpuOptions { profile, ..GpuOptions::default() }) {
        Ok(gpu) => Some(gpu),
        Err(trapeze_gpu::GpuError::NoAdapter { .. }) => {
            eprintln!("SKIPPED: GPU tests need a Vulkan or Metal device (mesa-vulkan-drivers)");
            None
        }
        Err(error) => panic!("{error}"),
    };
    DEVICES[profile as usize].get_or_init(open).clone()
}

/// Renders one frame on the GPU.
///
/// # Panics
/// When it cannot be rendered.
#[must_use]
pub fn render_gpu(gpu: &Gpu, scene: &Scene, camera: &Camera, settings: &FrameSettings) -> Frame {
    let mut renderer = Renderer::new(gpu, Arc::new(scene.clone())).expect("the scene fits");
    renderer.render(camera, settings).expect("the frame fits")
}
