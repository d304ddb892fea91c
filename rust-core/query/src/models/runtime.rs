//! ONNX Runtime: where its library is, and the one environment that a process may have.

#[cfg(not(target_os = "ios"))]
use std::path::Path;
use std::path::PathBuf;
use std::sync::Mutex;

use ort::environment::Environment;

use super::ModelError;

/// Where a runtime library was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RuntimeSource {
    /// Linked into the program (iOS).
    Linked,
    /// A library file.
    Library(PathBuf),
}

/// The folder that `scripts/fetch-onnxruntime` fills.
#[must_use]
pub fn runtime_cache() -> PathBuf {
    let variable = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let home = || PathBuf::from(variable("HOME").unwrap_or_else(|| ".".into()));
    let caches = match variable("XDG_CACHE_HOME") {
        Some(folder) => folder.into(),
        None if cfg!(target_vendor = "apple") => home().join("Library/Caches"),
        None => home().join(".cache"),
    };
    caches.join("trapeze/onnxruntime")
}

/// The runtime's library: at `ORT_DYLIB_PATH`, beside the program, among the frameworks of a Mac's app,
/// in the cache folder ([`runtime_cache`]) or in Python's `onnxruntime` package.
///
/// # Errors
/// [`ModelError::RuntimeMissing`] when it is nowhere, [`ModelError::File`] when `ORT_DYLIB_PATH`
/// names no file.
#[cfg(not(target_os = "ios"))]
pub fn find_runtime() -> Result<RuntimeSource, ModelError> {
    if let Some(path) = std::env::var_os("ORT_DYLIB_PATH").filter(|path| !path.is_empty()) {
        let path = PathBuf::from(path);
        return match std::fs::metadata(&path) {
            Ok(_) => Ok(RuntimeSource::Library(path)),
            Err(source) => Err(ModelError::File { path, source }),
        };
    }
    let beside = std::env::current_exe().ok().and_then(|exe| exe.parent().map(Path::to_owned));
    let cache = runtime_cache();
    let frameworks = beside.as_ref().map(|folder| folder.join("../Frameworks"));
    beside
        .and_then(|folder| library_in(&folder))
        .or_else(|| frameworks.and_then(|folder| library_in(&folder)))
        .or_else(|| library_in(&cache))
        .or_else(|| python_package().and_then(|folder| library_in(&folder.join("capi"))))
        .map(RuntimeSource::Library)
        .ok_or(ModelError::RuntimeMissing { cache })
}

/// The runtime is part of the program.
///
/// # Errors
/// None.
#[cfg(target_os = "ios")]
pub fn find_runtime() -> Result<RuntimeSource, ModelError> {
    Ok(RuntimeSource::Linked)
}

/// The runtime's library in a folder, under any version.
#[cfg(not(target_os = "ios"))]
fn library_in(folder: &Path) -> Option<PathBuf> {
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| is_library_name(&path.file_name().unwrap_or_default().to_string_lossy()))
        .collect();
    // The plain name, where there is one, then the highest version.
    found.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    found.pop()
}

/// Libraries of execution providers lie beside the runtime's and are none.
#[cfg(not(target_os = "ios"))]
fn is_library_name(name: &str) -> bool {
    let Some(rest) = name.strip_prefix("libonnxruntime") else { return name == "onnxruntime.dll" };
    rest.starts_with(".so") || (rest.starts_with('.') && rest.ends_with(".dylib"))
}

/// Folder of the Python package; it is looked up, not imported.
#[cfg(not(target_os = "ios"))]
fn python_package() -> Option<PathBuf> {
    const SCRIPT: &str = "import importlib.util as u; s = u.find_spec('onnxruntime'); \
                          print(s.submodule_search_locations[0] if s else '')";
    let output = std::process::Command::new("python3").args(["-c", SCRIPT]).output().ok()?;
    let folder = String::from_utf8(output.stdout).ok()?;
    let folder = folder.trim();
    (output.status.success() && !folder.is_empty()).then(|| folder.into())
}

/// The process's environment. ONNX Runtime allows one, and its library cannot be exchanged once it
/// is loaded; that is why this is the crate's only global state.
static ENVIRONMENT: Mutex<Option<Environment>> = Mutex::new(None);

/// Loads the runtime, once.
pub(super) fn environment() -> Result<Environment, ModelError> {
    let mut held = ENVIRONMENT.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(environment) = &*held {
        return Ok(environment.clone());
    }
    let source = find_runtime()?;
    let unusable = |error: String| ModelError::RuntimeUnusable {
        path: match &source {
            RuntimeSource::Library(path) => path.clone(),
            RuntimeSource::Linked => PathBuf::new(),
        },
        reason: super::error::one_line(error, 200),
    };
    let builder = load(&source).map_err(unusable)?;
    let environment =
        builder.with_telemetry(false).build().map_err(|error| unusable(error.to_string()))?;
    // Its warnings concern whoever exports a model; what fails comes back as an error.
    environment.set_log_level(ort::logging::LogLevel::Error);
    Ok(held.insert(environment).clone())
}

#[cfg(not(target_os = "ios"))]
fn load(source: &RuntimeSource) -> Result<ort::environment::EnvironmentBuilder, String> {
    match source {
        RuntimeSource::Library(path) => ort::init_from(path).map_err(|error| error.to_string()),
        RuntimeSource::Linked => Ok(ort::init()),
    }
}

#[cfg(target_os = "ios")]
fn load(_: &RuntimeSource) -> Result<ort::environment::EnvironmentBuilder, String> {
    Ok(ort::init())
}

#[cfg(all(test, not(target_os = "ios")))]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_told_from_its_neighbours() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(library_in(folder.path()), None);
        for name in ["libonnxruntime_providers_shared.so", "onnxruntime_pybind11_state.so", "x.so"]
        {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        assert_eq!(library_in(folder.path()), None);
        let library = folder.path().join("libonnxruntime.so.1.22.0");
        std::fs::write(&library, "").unwrap();
        assert_eq!(library_in(folder.path()), Some(library));
        assert!(is_library_name("libonnxruntime.1.22.0.dylib"));
        assert!(!is_library_name("libonnxruntime4j_jni.so"));
    }
}
