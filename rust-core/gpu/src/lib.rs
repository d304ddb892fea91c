//! The renderer on the GPU: the stages of a frame as WGSL kernels (in `shaders/`), hosted by wgpu,
//! on Metal and Vulkan from one set of sources.

mod activate;
pub mod compute;
mod context;
mod deform;
mod device_report;
mod differentiable;
mod differentiable_deformation;
mod error;
mod harmonics;
mod kernel;
mod kernels;
mod late_reader;
mod layout;
mod memory;
mod parameters;
mod project;
mod readback;
mod region;
mod renderer;
mod scene_buffers;
mod self_check;
pub mod shaders;
mod sort;
mod stage_pass;
mod surface;
mod tiles;
mod timing;

pub use context::{Created, DeviceProfile, Gpu, GpuOptions};
pub use deform::NetworkPrecision;
pub use device_report::DeviceReport;
pub use differentiable::{
    DifferentiableRenderer, ForwardSettings, FrameStatus, ImageGradientBuffers, PassTimes,
};
pub use differentiable_deformation::{
    DeformationTimes, DifferentiableDeformation, NetworkProducts,
};
pub use error::GpuError;
pub use harmonics::HarmonicsStorage;
pub use memory::{MemoryPlan, MemoryRequest, PlannedBuffer, SceneSize};
pub use parameters::{ParameterArray, ParameterBuffers};
pub use renderer::{Pick, PickTicket, Renderer, RendererOptions};
pub use self_check::{Against, Check, Checked, SelfCheckReport, self_check};
pub use surface::{Presented, SurfaceOptions, WindowSurface};
pub use timing::StageTimes;

#[cfg(test)]
mod kernel_tests;
