//! Running the program, and scenes to run it on.

#![allow(dead_code, reason = "each test file uses its own part")]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use trapeze_formats::{load_scene, read_npy, save_scene};
use trapeze_scene::Scene;

/// Size of all images here: the reference renderer is slow.
pub(crate) const SIZE: [usize; 2] = [64, 48];

/// Every how many-th splat of the sample scene a thinned scene keeps.
const THINNING: usize = 40;

/// The committed sample scene: 34 670 splats, five clusters, network, motion values.
pub(crate) fn sample_scene() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sample-scene")
}

/// A copy of the sample scene with a 40th of its splats, in `folder`/scene.
pub(crate) fn thinned_scene(folder: &Path) -> PathBuf {
    let scene = load_scene(&sample_scene()).unwrap();
    let kept: Vec<u32> = (0..scene.len() as u32).step_by(THINNING).collect();
    let path = folder.join("scene");
    save_scene(&path, &scene.gather(&kept)).unwrap();
    path
}

pub(crate) fn load(path: &Path) -> Scene {
    load_scene(path).unwrap()
}

pub(crate) fn run(environment: &[(&str, &OsStr)], arguments: &[impl AsRef<OsStr>]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trapeze"))
        .args(arguments)
        .env_remove("RUST_LOG")
        .envs(environment.iter().copied())
        .output()
        .unwrap()
}

/// Runs the program and expects success; returns what it printed.
pub(crate) fn succeed(arguments: &[impl AsRef<OsStr>]) -> String {
    let output = run(&[], arguments);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{errors}");
    assert!(!errors.contains('\u{1b}'), "colours in a pipe: {errors:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the program and expects JSON.
pub(crate) fn json(arguments: &[impl AsRef<OsStr>]) -> Value {
    let text = succeed(arguments);
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e} in {text}"))
}

/// Runs the program and expects it to refuse: another exit code than 0, nothing on standard output
/// and exactly one line on standard error. Returns what follows `error: `.
pub(crate) fn refusal(arguments: &[impl AsRef<OsStr>]) -> String {
    refusal_in(&[], arguments)
}

/// The same, with environment variables set.
pub(crate) fn refusal_in(
    environment: &[(&str, &OsStr)],
    arguments: &[impl AsRef<OsStr>],
) -> String {
    let output = run(environment, arguments);
    let errors = String::from_utf8(output.stderr).unwrap();
    // A crash by signal has no code, a panic has 101.
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(output.stdout.is_empty());
    assert!(!errors.contains("panicked"), "{errors}");
    let mut lines = errors.lines();
    let message = lines.next().and_then(|line| line.strip_prefix("error: ")).unwrap_or_default();
    assert!(!message.is_empty() && lines.next().is_none(), "not one line: {errors:?}");
    message.to_owned()
}

/// Arguments as one list, from text and paths.
#[macro_export]
macro_rules! arguments {
    ($($argument:expr),* $(,)?) => {
        [$(std::ffi::OsString::from($argument)),*]
    };
}

/// Renders raw values of a small image and returns their shape and values.
pub(crate) fn raw(scene: &Path, options: &[&str]) -> (Vec<usize>, Vec<f64>) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.npy");
    let mut arguments = arguments!["render", scene, "--size", "64x48", "--out", &out].to_vec();
    arguments.extend(options.iter().map(Into::into));
    succeed(&arguments);
    let array = read_npy(&out).unwrap();
    (array.shape.clone(), array.values.to_f64())
}

/// Share of the values that differ by more than `tolerance`; NaN agrees with NaN alone.
pub(crate) fn differing(a: &[f64], b: &[f64], tolerance: impl Fn(f64) -> f64) -> f64 {
    assert_eq!(a.len(), b.len());
    let differs =
        |&(&a, &b): &(&f64, &f64)| !((a.is_nan() && b.is_nan()) || (a - b).abs() <= tolerance(b));
    a.iter().zip(b).filter(differs).count() as f64 / a.len() as f64
}
