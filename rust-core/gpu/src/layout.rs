//! The structs that kernels and host share. A test compares sizes and offsets with the WGSL.

use bytemuck::{Pod, Zeroable};

/// `Frame` of common/frame.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Frame {
    pub rotation_x: [f32; 4],
    pub rotation_y: [f32; 4],
    pub rotation_z: [f32; 4],
    pub centre_high: [f32; 4],
    pub centre_low: [f32; 4],
    pub rotation_z_low: [f32; 4],
    pub focal: [f32; 2],
    pub principal: [f32; 2],
    pub slope_min: [f32; 2],
    pub slope_max: [f32; 2],
    pub image: [f32; 2],
    pub sh_degree: u32,
    pub color_source: u32,
    pub heat_scale: f32,
    pub zero: u32,
    pub depth_near: f32,
    pub depth_slope: f32,
}

/// `Pose` of common/frame.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Pose {
    pub position: [f32; 3],
    pub log2_opacity: f32,
    pub rotation: [f32; 4],
    pub scale: [f32; 3],
    pub label: u32,
}

/// `Window` of project.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Window {
    pub first: u32,
    pub count: u32,
    pub padding_1: u32,
    pub padding_2: u32,
}

/// `Cluster` of project.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Cluster {
    pub color: [f32; 3],
    pub shown: u32,
}

/// `SplatCount` of common/splat_count.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct SplatCount {
    pub count: u32,
    pub capacity: u32,
    pub stored_degree: u32,
    pub degree: u32,
}

/// `SortPass` of sort.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct SortPass {
    pub shift: u32,
    pub count: u32,
    pub keys_per_thread: u32,
    pub max_blocks: u32,
}

/// `Region` of common/region.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Region {
    pub first_tile: [u32; 2],
    pub tiles: [u32; 2],
    pub image: [u32; 2],
    pub output_origin: [u32; 2],
    pub output_stride: u32,
    pub capacity: u32,
    pub sort_keys_per_thread: u32,
    pub halts: u32,
}

/// `Sizes` of arguments.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Sizes {
    pub depth_block: u32,
    pub network_splats: u32,
    pub padding_1: u32,
    pub padding_2: u32,
}

/// `Deformation` of common/deformation.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Deformation {
    pub origin: [f32; 4],
    pub origin_turns: [[f32; 4]; 24],
    pub splats: u32,
    pub masked: u32,
    pub threshold: f32,
    pub octaves: u32,
    pub depth: u32,
    pub skip_layer: u32,
    pub input_rows: u32,
    pub screw: u32,
    pub as_trained: u32,
    pub zero: u32,
    pub padding_1: u32,
    pub padding_2: u32,
}

/// `NetworkChunk` of common/network.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct NetworkChunk {
    pub first: u32,
    pub splats: u32,
    pub steps: u32,
    pub starts_sum: u32,
    pub octaves: u32,
    pub time_features: u32,
    pub encoding_row: u32,
    pub row_vectors: u32,
    pub time: [[f32; 4]; 13],
}

/// `NetworkLayer` of common/network.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct NetworkLayer {
    pub inputs: u32,
    pub outputs: u32,
    pub input_row: u32,
    pub output_row: u32,
    pub weights: u32,
    pub encoded_inputs: u32,
    pub row_vectors: u32,
    pub most_parts: u32,
    pub head_row: u32,
}

/// `Presentation` of present.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Presentation {
    pub background: [f32; 4],
    pub image: [u32; 2],
    pub texture: [u32; 2],
}

/// Indices into the counts of a frame, as in common/counters.wgsl.
pub mod counter {
    /// Splats that the frame draws, after culling.
    pub const VISIBLE: usize = 0;
    pub(crate) const SORTED_ENTRIES: usize = 2;
    pub(crate) const DYNAMIC: usize = 3;
    /// Most tile entries of any frame since the host last cleared it; 2³² − 1 stands for more than
    /// can be counted.
    pub const MOST_ENTRIES: usize = 4;
    /// In training: 1 from a frame whose entries did not fit until the host clears it.
    pub const HALTED: usize = 5;
    /// In training: frames drawn since the host last cleared it.
    pub const DRAWN_FRAMES: usize = 6;
    /// Words of the buffer.
    pub const COUNT: usize = 8;
}

/// Slots of arguments.wgsl.
pub(crate) mod argument {
    pub(crate) const DEPTH_SORT: u64 = 0;
    pub(crate) const BIN: u64 = 1;
    pub(crate) const EMIT: u64 = 2;
    pub(crate) const ENTRY_SORT: u64 = 3;
    pub(crate) const RASTERIZE: u64 = 4;
    pub(crate) const NETWORK: u64 = 5;
    pub(crate) const ENTRY_CHUNKS: u64 = 6;
    /// Bytes from one slot to the next.
    pub(crate) const STRIDE: u64 = 16;
    /// Bytes of the buffer.
    pub(crate) const BYTES: u64 = 8 * STRIDE;
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use crate::shaders::{self, Shader};

    /// Size of a struct, and the offset of each of its members, in the module.
    fn wgsl_layout(shader: Shader, name: &str) -> (usize, Vec<(String, usize)>) {
        let module = naga::front::wgsl::parse_str(&shader.source()).unwrap();
        let (_, ty) = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name))
            .unwrap_or_else(|| panic!("{} has no struct {name}", shader.name));
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct")
        };
        let offsets = members
            .iter()
            .map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize))
            .collect();
        (*span as usize, offsets)
    }

    macro_rules! assert_same_layout {
        ($shader:expr, $name:ident, $($field:ident),+ $(,)?) => {
            let (size, offsets) = wgsl_layout($shader, stringify!($name));
            assert_eq!(size, size_of::<super::$name>(), stringify!($name));
            let ours = vec![$((stringify!($field).to_owned(), offset_of!(super::$name, $field))),+];
            assert_eq!(offsets, ours, stringify!($name));
        };
    }

    #[test]
    fn structs_are_laid_out_as_the_kernels_read_them() {
        assert_same_layout!(
            shaders::PROJECT,
            Frame,
            rotation_x,
            rotation_y,
            rotation_z,
            centre_high,
            centre_low,
            rotation_z_low,
            focal,
            principal,
            slope_min,
            slope_max,
            image,
            sh_degree,
            color_source,
            heat_scale,
            zero,
            depth_near,
            depth_slope,
        );
        assert_same_layout!(shaders::PROJECT, Pose, position, log2_opacity, rotation, scale, label,);
        assert_same_layout!(shaders::PROJECT, Window, first, count, padding_1, padding_2);
        assert_same_layout!(shaders::PROJECT, Cluster, color, shown);
        assert_same_layout!(
            shaders::PROJECT_PARAMETERS,
            SplatCount,
            count,
            capacity,
            stored_degree,
            degree,
        );
        assert_same_layout!(shaders::SORT, SortPass, shift, count, keys_per_thread, max_blocks,);
        assert_same_layout!(
            shaders::BIN,
            Region,
            first_tile,
            tiles,
            image,
            output_origin,
            output_stride,
            capacity,
            sort_keys_per_thread,
            halts,
        );
        assert_same_layout!(
            shaders::ARGUMENTS,
            Sizes,
            depth_block,
            network_splats,
            padding_1,
            padding_2,
        );
        assert_same_layout!(
            shaders::network::ENCODE,
            NetworkChunk,
            first,
            splats,
            steps,
            starts_sum,
            octaves,
            time_features,
            encoding_row,
            row_vectors,
            time,
        );
        assert_same_layout!(
            shaders::network::LAYER,
            NetworkLayer,
            inputs,
            outputs,
            input_row,
            output_row,
            weights,
            encoded_inputs,
            row_vectors,
            most_parts,
            head_row,
        );
        assert_same_layout!(shaders::PRESENT, Presentation, background, image, texture);
        assert_same_layout!(
            shaders::DEFORM,
            Deformation,
            origin,
            origin_turns,
            splats,
            masked,
            threshold,
            octaves,
            depth,
            skip_layer,
            input_rows,
            screw,
            as_trained,
            zero,
            padding_1,
            padding_2,
        );
    }

    #[test]
    fn counters_and_argument_slots_have_one_numbering() {
        let constants = |shader: Shader| -> std::collections::HashMap<String, u32> {
            let module = naga::front::wgsl::parse_str(&shader.source()).unwrap();
            module
                .constants
                .iter()
                .filter_map(|(_, c)| {
                    let naga::Expression::Literal(naga::Literal::U32(value)) =
                        module.global_expressions[c.init]
                    else {
                        return None;
                    };
                    Some((c.name.clone()?, value))
                })
                .collect()
        };
        let found = constants(shaders::ARGUMENTS);
        use super::{argument, counter};
        for (name, value) in [
            ("VISIBLE", counter::VISIBLE as u64),
            ("SORTED_ENTRIES", counter::SORTED_ENTRIES as u64),
            ("DYNAMIC", counter::DYNAMIC as u64),
            ("MOST_ENTRIES", counter::MOST_ENTRIES as u64),
            ("HALTED", counter::HALTED as u64),
            ("DRAWN_FRAMES", counter::DRAWN_FRAMES as u64),
            ("DEPTH_SORT", argument::DEPTH_SORT),
            ("BIN", argument::BIN),
            ("EMIT", argument::EMIT),
            ("ENTRY_SORT", argument::ENTRY_SORT),
            ("RASTERIZE", argument::RASTERIZE),
            ("NETWORK", argument::NETWORK),
            ("ENTRY_CHUNKS", argument::ENTRY_CHUNKS),
        ] {
            assert_eq!(u64::from(found[name]), value, "{name}");
        }
    }

    #[test]
    fn every_shader_is_valid() {
        for shader in shaders::every_shader() {
            let module = naga::front::wgsl::parse_str(&shader.source()).unwrap_or_else(|e| {
                panic!("{}: {}", shader.name, e.emit_to_string(&shader.source()))
            });
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::all(),
            )
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}: {}", shader.name, e.emit_to_string(&shader.source())));
        }
    }
}
