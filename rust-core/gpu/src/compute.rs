//! What a crate needs that runs kernels of its own on a [`Gpu`](crate::Gpu): the loss, the
//! optimiser and whatever else works on the buffers of a frame.
//!
//! A kernel is WGSL whose bindings are numbered from 0 in group 0, all of them buffers.
//! [`Interface`] compiles it and makes pipelines and bind groups; [`dispatch`] runs it over any
//! number of workgroups, in rows of at most 65 535, which the kernel counts with `flat_group` of
//! [`common::DISPATCH`](crate::shaders::common::DISPATCH). Buffers come from
//! [`Gpu::storage`](crate::Gpu::storage) and its neighbours, so that
//! [`Gpu::created`](crate::Gpu::created) counts them.
//!
//! Results come back late, through [`LateReader`]; [`read`] waits.

pub use crate::kernel::{Binding, Interface, part, whole};
pub use crate::late_reader::{LateReader, Words};
pub use crate::layout::counter;
pub use crate::readback::read;
pub use crate::stage_pass::{Groups, dispatch};
pub use wgpu;
