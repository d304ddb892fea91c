//! The Metal source of every kernel, as wgpu hands it to Metal devices, kept in shaders/metal.

use std::fmt::Write;
use std::path::Path;

use naga::back::msl;
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::shaders::Shader;
use crate::shaders::every_shader;

/// Metal Shading Language 3.0 of all entry points, with the default values of overridable constants.
fn translate(shader: Shader) -> String {
    let module = naga::front::wgsl::parse_str(&shader.source()).unwrap();
    let info =
        Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module).unwrap();
    let constants = naga::back::PipelineConstants::default();
    let (module, info) =
        naga::back::pipeline_constants::process_overrides(&module, &info, None, &constants)
            .unwrap();
    let options = msl::Options {
        lang_version: (3, 0),
        fake_missing_bindings: true,
        zero_initialize_workgroup_memory: false,
        force_loop_bounding: false,
        ..msl::Options::default()
    };
    let pipeline = msl::PipelineOptions::default();
    let (source, _) = msl::write_string(&module, &info, &options, &pipeline).unwrap();
    let mut text = format!("// Made from shaders/{}.wgsl by scripts/export-msl.\n\n", shader.name);
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}", source.trim_end());
    text
}

#[test]
fn the_kept_metal_source_is_that_of_the_kernels() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders/metal");
    let export = std::env::var_os("TRAPEZE_EXPORT_MSL").is_some();
    for shader in every_shader() {
        let path = folder.join(format!("{}.metal", shader.name));
        let text = translate(shader);
        if export {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&path, &text).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(kept == text, "{}: run scripts/export-msl", path.display());
    }
}
