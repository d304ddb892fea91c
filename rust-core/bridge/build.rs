//! Writes the C headers and the Swift code of the surface in `src/ffi.rs` to `OUT_DIR`.

use std::path::PathBuf;

fn main() {
    let surface = "src/ffi.rs";
    println!("cargo::rerun-if-changed={surface}");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));
    swift_bridge_build::parse_bridges([surface]).write_all_concatenated(out, "trapeze");
}
