//! Stable radix sort of (key, value) pairs whose number the GPU knows.

mod plan;

pub(crate) use plan::{PairBuffers, SortPlan, keys_per_thread};

use crate::kernel::{Binding, Interface};
use crate::{Gpu, shaders};

/// Lowest bits of the digits of a depth.
pub(crate) const DEPTH_SHIFTS: [u32; 4] = [0, 8, 16, 24];

/// Pipelines of the sort.
#[derive(Debug)]
pub(crate) struct SortKernels {
    interface: Interface,
    plain: Pipelines,
    /// First pass of the depth sort, which drops splats that are not drawn.
    dropping: Pipelines,
}

#[derive(Debug)]
struct Pipelines {
    histogram: wgpu::ComputePipeline,
    scan_digits: wgpu::ComputePipeline,
    scatter: wgpu::ComputePipeline,
}

impl SortKernels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, Write};
        let bindings = [Uniform, Read, Read, Read, Write, Write, Write, Write];
        let interface = Interface::new(gpu, "sort", &shaders::SORT.source(), &bindings);
        let pipelines = |drops: bool| {
            let constants = [("DROPS_NOT_DRAWN", f64::from(u8::from(drops)))];
            Pipelines {
                histogram: interface.pipeline(gpu, "histogram", &constants),
                scan_digits: interface.pipeline(gpu, "scan_digits", &constants),
                scatter: interface.pipeline(gpu, "scatter", &constants),
            }
        };
        Self { plain: pipelines(false), dropping: pipelines(true), interface }
    }

    fn pipelines(&self, drops: bool) -> &Pipelines {
        if drops { &self.dropping } else { &self.plain }
    }
}
