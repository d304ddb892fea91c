//! Every pipeline of a device, made once and shared by its renderers.

use std::collections::HashMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use trapeze_scene::ShDegree;

use crate::deform::NetworkPrecision;
use crate::differentiable::DifferentiableKernels;
use crate::differentiable_deformation::{DeformationKernels, NetworkProducts};
use crate::harmonics::HarmonicsStorage;
use crate::kernel::{Binding, Interface};
use crate::sort::SortKernels;
use crate::tiles::TileKernels;
use crate::{Gpu, shaders};

/// Pipelines and their interfaces. Those with constants that depend on the scene are made when the
/// first scene asks for them.
#[derive(Debug)]
pub(crate) struct Kernels {
    pub sort: SortKernels,
    pub tiles: TileKernels,
    pub mask_interface: Interface,
    pub mask: wgpu::ComputePipeline,
    pub project_interface: Interface,
    project: Mutex<HashMap<(ShDegree, HarmonicsStorage), wgpu::ComputePipeline>>,
    deform_single: Interface,
    deform: Mutex<HashMap<NetworkShape, wgpu::ComputePipeline>>,
    deform_half: OnceLock<Interface>,
    deform_matrix: OnceLock<(Interface, wgpu::ComputePipeline)>,
    differentiable: OnceLock<DifferentiableKernels>,
    deformation: OnceLock<DeformationKernels>,
    deformation_split: OnceLock<DeformationKernels>,
    split_products_agree: OnceLock<bool>,
}

/// Bindings of the network's kernels.
const NETWORK_BINDINGS: [Binding; 7] = [
    Binding::Uniform,
    Binding::Read,
    Binding::Write,
    Binding::Read,
    Binding::Read,
    Binding::Read,
    Binding::Read,
];

/// What a pipeline of the network is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct NetworkShape {
    /// Padded width of the hidden layers.
    pub width: u32,
    /// Padded width of γ(xyz).
    pub input_rows: u32,
    /// Splats per workgroup.
    pub splats: u32,
    /// Precision of weights and hidden vectors.
    pub precision: NetworkPrecision,
}

impl NetworkShape {
    /// Vectors of four features in workgroup memory.
    fn hidden_vectors(self) -> u32 {
        self.width.max(self.input_rows) * self.splats / 4
    }
}

impl Kernels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, Write};
        let mask_interface = Interface::new(
            gpu,
            "mask",
            &shaders::MASK.source(),
            &[Uniform, Read, Read, Write, Write, Write],
        );
        Self {
            sort: SortKernels::new(gpu),
            tiles: TileKernels::new(gpu),
            mask: mask_interface.pipeline(gpu, "mask", &[]),
            mask_interface,
            project_interface: Interface::new(
                gpu,
                "project",
                &shaders::PROJECT.source(),
                &[Uniform, Uniform, Read, Read, Read, Read, Write, Write, Write, Write, Write],
            ),
            project: Mutex::default(),
            deform_single: Interface::new(
                gpu,
                "deform",
                &shaders::DEFORM.source(),
                &NETWORK_BINDINGS,
            ),
            deform: Mutex::default(),
            deform_half: OnceLock::new(),
            deform_matrix: OnceLock::new(),
            differentiable: OnceLock::new(),
            deformation: OnceLock::new(),
            deformation_split: OnceLock::new(),
            split_products_agree: OnceLock::new(),
        }
    }

    /// The projection of scenes with harmonics of this degree and storage.
    pub(crate) fn project(
        &self,
        gpu: &Gpu,
        degree: ShDegree,
        storage: HarmonicsStorage,
    ) -> wgpu::ComputePipeline {
        let mut pipelines = self.project.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || {
            let constants = [
                ("STORED_SH_DEGREE", f64::from(degree as u32)),
                ("HARMONICS_STORAGE", f64::from(storage as u32)),
            ];
            self.project_interface.pipeline(gpu, "project", &constants)
        };
        pipelines.entry((degree, storage)).or_insert_with(make).clone()
    }

    /// Bindings of the network; in half precision only for devices that have it.
    pub(crate) fn deform_interface(&self, gpu: &Gpu, precision: NetworkPrecision) -> &Interface {
        match precision {
            NetworkPrecision::Single => &self.deform_single,
            NetworkPrecision::Half => self.deform_half.get_or_init(|| {
                let source = shaders::DEFORM_HALF.source();
                Interface::new(gpu, "deform_half", &source, &NETWORK_BINDINGS)
            }),
        }
    }

    /// The network of this shape.
    pub(crate) fn deform(&self, gpu: &Gpu, shape: NetworkShape) -> wgpu::ComputePipeline {
        let mut pipelines = self.deform.lock().unwrap_or_else(PoisonError::into_inner);
        let make = || {
            let constants = [
                ("WIDTH", f64::from(shape.width)),
                ("SPLATS", f64::from(shape.splats)),
                ("THREADS", f64::from(shape.width / 4 * shape.splats / 16)),
                ("HIDDEN_VECTORS", f64::from(shape.hidden_vectors())),
            ];
            self.deform_interface(gpu, shape.precision).pipeline(gpu, "deform", &constants)
        };
        pipelines.entry(shape).or_insert_with(make).clone()
    }

    /// The passes over trainable parameters.
    pub(crate) fn differentiable(&self, gpu: &Gpu) -> &DifferentiableKernels {
        self.differentiable.get_or_init(|| DifferentiableKernels::new(gpu))
    }

    /// The passes over a network under training; with split products only for devices that have
    /// cooperative matrices.
    pub(crate) fn deformation(&self, gpu: &Gpu, products: NetworkProducts) -> &DeformationKernels {
        let kernels = match products {
            NetworkProducts::Single => &self.deformation,
            NetworkProducts::Split => &self.deformation_split,
        };
        kernels.get_or_init(|| DeformationKernels::new(gpu, products))
    }

    /// Whether split products are what they should be on this device; found out by `probe` once.
    pub(crate) fn split_products_agree(&self, probe: impl FnOnce() -> bool) -> bool {
        *self.split_products_agree.get_or_init(probe)
    }

    /// The network on cooperative matrices; only for devices that have them.
    pub(crate) fn deform_matrix(&self, gpu: &Gpu) -> &(Interface, wgpu::ComputePipeline) {
        self.deform_matrix.get_or_init(|| {
            let source = shaders::DEFORM_MATRIX.source();
            let interface = Interface::new(gpu, "deform_matrix", &source, &NETWORK_BINDINGS);
            let pipeline = interface.pipeline(gpu, "deform_matrix", &[]);
            (interface, pipeline)
        })
    }
}
