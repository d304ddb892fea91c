//! The headers and the Swift code that the app's package holds are those of the surface as it is.
//!
//! `scripts/build-bridge` sets TRAPEZE_WRITE_BRIDGE, and then they are written instead.

use std::path::{Path, PathBuf};

/// The package's copies of what `build.rs` has generated.
fn generated() -> [(PathBuf, String); 4] {
    let out = Path::new(env!("OUT_DIR"));
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../apple-app/TrapezeKit/Sources");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    // The C functions are a module of their own, and Swift 6 wants to be told that a conformance
    // to a protocol of its own library is meant.
    let swift = |name: &str| {
        let code = read(name)
            .replace(
                "extension RustStr: Identifiable",
                "extension RustStr: @retroactive Identifiable",
            )
            .replace("extension RustStr: Equatable", "extension RustStr: @retroactive Equatable");
        format!("import CTrapeze\n\n{}\n", code.trim())
    };
    let header = |name: &str| format!("{}\n", read(name).trim());
    let (headers, code) =
        (sources.join("CTrapeze/include"), sources.join("TrapezeBridge/Generated"));
    [
        (headers.join("SwiftBridgeCore.h"), header("SwiftBridgeCore.h")),
        (headers.join("trapeze.h"), header("trapeze/trapeze.h")),
        (code.join("SwiftBridgeCore.swift"), swift("SwiftBridgeCore.swift")),
        (code.join("Trapeze.swift"), swift("trapeze/trapeze.swift")),
    ]
}

#[test]
fn the_package_holds_the_headers_and_code_of_this_surface() {
    for (path, expected) in generated() {
        if std::env::var_os("TRAPEZE_WRITE_BRIDGE").is_some() {
            std::fs::write(&path, &expected).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(found == expected, "{}: run ./scripts/build-bridge", path.display());
    }
}
