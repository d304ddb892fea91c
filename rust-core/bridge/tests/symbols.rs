//! The static library holds every function that the headers declare.

use std::collections::BTreeSet;
use std::path::PathBuf;

use object::read::archive::ArchiveFile;
use object::{Object, ObjectSymbol};

/// The library that was built with this test: the newest beside it.
fn library() -> PathBuf {
    let executable = std::env::current_exe().unwrap();
    let is_library = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("libtrapeze_bridge") && name.ends_with(".a")
    };
    std::fs::read_dir(executable.parent().unwrap())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(is_library)
        .max_by_key(|path| path.metadata().unwrap().modified().unwrap())
        .expect("cargo test builds the static library")
}

/// Names of the functions in a header: what stands before the parenthesis of their arguments.
fn declared(header: &str) -> BTreeSet<String> {
    header
        .lines()
        .filter(|line| line.trim_end().ends_with(");") && !line.starts_with("typedef"))
        .filter_map(|line| line.split_once('(')?.0.rsplit([' ', '*']).next())
        .filter(|name| name.starts_with("__swift_bridge__$"))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_declared_function_is_defined_in_the_static_library() {
    let mut declarations = declared(include_str!(concat!(env!("OUT_DIR"), "/trapeze/trapeze.h")));
    declarations.extend(declared(include_str!(concat!(env!("OUT_DIR"), "/SwiftBridgeCore.h"))));
    for known in ["__swift_bridge__$open_scene", "__swift_bridge__$Renderer$draw"] {
        assert!(declarations.contains(known), "{known} is not among {}", declarations.len());
    }
    let path = library();
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let archive = ArchiveFile::parse(bytes.as_slice()).unwrap();
    for member in archive.members() {
        let member = member.unwrap().data(bytes.as_slice()).unwrap();
        // Some members are no objects: the compiler's metadata.
        let Ok(file) = object::File::parse(member) else { continue };
        for symbol in file.symbols().filter(|symbol| symbol.is_definition() && symbol.is_global()) {
            let name = symbol.name().unwrap_or_default();
            // Mach-O puts an underscore in front.
            declarations.remove(name);
            declarations.remove(name.strip_prefix('_').unwrap_or(name));
        }
    }
    assert!(declarations.is_empty(), "declared, but not in the library: {declarations:#?}");
}
