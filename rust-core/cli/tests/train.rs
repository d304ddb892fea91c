//! `trapeze train` and `trapeze eval`, on the bundled photographs at a fraction of their size.

mod support;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use support::{json, load, refusal, succeed};
use trapeze_scene::DeformationNetwork;

fn photographs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sample-dataset/transforms_static.json")
}

/// `train` with 800 splats on images of 50 × 50 pixels.
fn training(out: &Path, extra: &[&str]) -> Vec<OsString> {
    let mut words = arguments!["train", photographs(), "--out", out].to_vec();
    words.extend(["--downscale", "4", "--random-splats", "800", "--static"].map(Into::into));
    words.extend(extra.iter().map(Into::into));
    words
}

fn splats_of(folder: &Path) -> Vec<u8> {
    std::fs::read(folder.join("point_cloud.ply")).unwrap()
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_run_reports_as_json_lines_and_leaves_a_scene_that_eval_agrees_with() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("scene");
    let options = ["--steps", "150", "--fixed", "--sh-degree", "1", "--preview", "100", "--json"];
    let lines = lines(&succeed(&training(&out, &options)));
    let (last, reports) = lines.split_last().unwrap();
    assert_eq!(reports.len(), 15);
    for (i, report) in reports.iter().enumerate() {
        assert_eq!(report["step"].as_u64().unwrap() as usize, 10 * (i + 1));
        assert_eq!(report["splats"], 800);
        for key in ["seconds", "loss", "psnr"] {
            assert!(report[key].as_f64().unwrap() > 0.0, "{report}");
        }
    }
    let loss = |report: &Value| report["loss"].as_f64().unwrap();
    assert!(loss(&reports[14]) < 0.8 * loss(&reports[0]), "{reports:?}");
    assert_eq!(
        (&last["done"], &last["steps"], &last["splats"]),
        (&true.into(), &150.into(), &800.into())
    );
    assert!(last["steps_per_second"].as_f64().unwrap() > 0.0);

    assert_eq!(load(&out).len(), 800);
    assert!(!out.join("checkpoints").exists());
    assert!(out.join("previews/step-000100.png").is_file());
    let summary: Value =
        serde_json::from_slice(&std::fs::read(out.join("training.json")).unwrap()).unwrap();
    assert_eq!(summary["config"]["steps"], 150);

    let eval = arguments!["eval", &out, photographs(), "--downscale", "4", "--json"];
    let figures = json(&eval);
    assert_eq!(figures["psnr"], last["test_psnr"]);
    assert_eq!(figures["ssim"], last["test_ssim"]);
    assert_eq!(figures["views"].as_array().unwrap().len(), 2);
    for view in figures["views"].as_array().unwrap() {
        assert!(view["name"].is_string() && view["psnr"].is_f64() && view["ssim"].is_f64());
    }
    // Noise has about 8 dB.
    assert!(figures["psnr"].as_f64().unwrap() > 14.0, "{figures}");
    // The same command with --resume finds the run complete.
    let again = [&options[..], &["--resume"]].concat();
    let text = succeed(&training(&out, &again));
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), *last);
}

#[test]
fn photographs_of_many_times_make_a_scene_folder_that_moves() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("scene");
    let photographs = photographs().with_file_name("");
    let mut words = arguments!["train", &photographs, "--out", &out, "--json"].to_vec();
    let options = "--downscale 8 --random-splats 300 --steps 60 --warm-up 20 --fixed --sh-degree 0";
    words.extend(options.split(' ').map(Into::into));
    let lines = lines(&succeed(&words));
    let last = lines.last().unwrap();
    assert_eq!(last["done"], true);

    let scene = load(&out);
    assert!(scene.deformation.as_ref().is_some_and(DeformationNetwork::is_standard));
    let motion = scene.motion.as_ref().unwrap();
    assert!(motion.values.len() == 300 && motion.values.iter().any(|&v| v > 0.0));
    assert!(motion.recommended_percentile.is_some());
    for name in ["point_cloud.ply", "weights.bin", "mask.bin", "mask.json", "training.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let summary: Value =
        serde_json::from_slice(&std::fs::read(out.join("training.json")).unwrap()).unwrap();
    assert_eq!(summary["config"]["deformation"]["warm_up"], 20);
    assert_eq!(summary["config"]["deformation"]["time_noise"], 0.0);
    assert_eq!(summary["config"]["background"], "random");
    assert!(summary["motion"]["moving_splats"].as_u64().unwrap() <= 300);

    let figures = json(&arguments!["eval", &out, &photographs, "--downscale", "8", "--json"]);
    assert_eq!(figures["psnr"], last["test_psnr"]);
    let described = json(&arguments!["info", &out, "--json"]);
    assert!(described["deformation"].is_object() || described["deformation"].is_string());
    let image = folder.path().join("image.png");
    let render = arguments!["render", &out, "--time", "0.5", "--size", "64x48", "--out", &image];
    succeed(&render);
    assert!(image.is_file());
}

#[test]
fn the_gpu_trains_and_evaluates_with_the_same_commands() {
    if let Err(trapeze_gpu::GpuError::NoAdapter { .. }) =
        trapeze_gpu::Gpu::open(&trapeze_gpu::GpuOptions::default())
    {
        eprintln!("SKIPPED: GPU tests need a Vulkan or Metal device (mesa-vulkan-drivers)");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("scene");
    let options = ["--steps", "60", "--fixed", "--sh-degree", "1", "--backend", "gpu", "--json"];
    let lines = lines(&succeed(&training(&out, &options)));
    let (last, reports) = lines.split_last().unwrap();
    let loss = |report: &Value| report["loss"].as_f64().unwrap();
    assert!(loss(&reports[reports.len() - 1]) < loss(&reports[0]), "{reports:?}");
    assert_eq!((&last["done"], &last["splats"]), (&true.into(), &800.into()));
    let psnr = |backend: &str| {
        let eval = ["--downscale", "4", "--json", "--backend", backend];
        let mut words = arguments!["eval", &out, photographs()].to_vec();
        words.extend(eval.map(Into::into));
        json(&words)["psnr"].as_f64().unwrap()
    };
    assert_eq!(psnr("gpu"), last["test_psnr"].as_f64().unwrap());
    // Images agree to 2e-3 at worst, and errors of photographs are a hundred times that.
    assert!((psnr("cpu") - psnr("gpu")).abs() < 0.01);
}

#[test]
fn a_search_keeps_its_evidence_and_a_packed_scene_loads() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("scene");
    let metrics = folder.path().join("metrics.json");
    let mut words = training(&out, &["--steps", "140", "--format", "spz", "--sh-degree", "1"]);
    words.extend(arguments!["--json", &metrics]);
    assert_eq!(succeed(&words), "");
    let text = std::fs::read_to_string(&metrics).unwrap();
    assert_eq!(lines(&text).last().unwrap()["done"], true);
    let summary: Value =
        serde_json::from_slice(&std::fs::read(out.join("training.json")).unwrap()).unwrap();
    let search = &summary["search"];
    let trials = search["trials"].as_array().unwrap();
    assert!(!trials.is_empty() && search["ended_at"].is_u64(), "{search}");
    for trial in trials {
        let number = |key: &str| trial[key].as_f64().unwrap();
        let kept = number("psnr_with") - number("psnr_without") >= number("required_gain");
        assert_eq!(trial["kept"], kept, "{trial}");
    }
    assert_eq!(load(&out).len() as u64, search["splats"].as_u64().unwrap());
}

const RESUMED: [&str; 7] =
    ["--steps", "700", "--max-splats", "1200", "--sh-degree", "1", "--seed=3"];

fn uninterrupted(folder: &Path) -> Vec<u8> {
    let out = folder.join("uninterrupted");
    succeed(&training(&out, &RESUMED));
    splats_of(&out)
}

fn start_resuming(out: &Path) -> std::process::Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trapeze"));
    command.args(training(out, &RESUMED)).arg("--resume");
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// The short version of `scripts/soak`.
#[test]
fn a_run_that_is_killed_again_and_again_ends_bit_identical() {
    let folder = tempfile::tempdir().unwrap();
    let expected = uninterrupted(folder.path());
    let out = folder.path().join("killed");
    for milliseconds in [5, 60, 150, 400] {
        let mut child = start_resuming(&out);
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(start_resuming(&out).wait().unwrap().success());
    assert_eq!(splats_of(&out), expected);
}

#[cfg(unix)]
#[test]
fn a_run_that_is_interrupted_saves_says_so_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let expected = uninterrupted(folder.path());
    let out = folder.path().join("interrupted");
    let child = start_resuming(&out);
    let first = out.join("checkpoints/step-0000000000.checkpoint");
    while !first.exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    // The start has been saved: from here on Ctrl-C is listened to within a few steps.
    std::thread::sleep(Duration::from_millis(20));
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(signal.success());
    let output = child.wait_with_output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("of 700 steps; the same command with --resume goes on"), "{errors}");
    assert!(start_resuming(&out).wait().unwrap().success());
    assert_eq!(splats_of(&out), expected);
}

/// A limit on the size of files stands in for a full disk: a write ends in the middle with an error.
#[cfg(target_os = "linux")]
#[test]
fn a_checkpoint_that_does_not_fit_is_named_and_the_last_one_stays() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("settings.json");
    let growing = r#"{"checkpoint_interval": 100, "densification": {"start": 200, "growth": 0.5}}"#;
    std::fs::write(&settings, growing).unwrap();
    let settings = settings.to_str().unwrap();
    let options = ["--steps", "400", "--max-splats", "1200", "--settings", settings, "--resume"];
    let out = folder.path().join("full");
    // A checkpoint of 800 splats of SH degree 0 has 135 KB, one of 1 200 has 203.
    let limited = r#"trap '' XFSZ; exec prlimit --fsize=170000 "$0" "$@""#;
    let output = Command::new("sh")
        .args(["-c", limited, env!("CARGO_BIN_EXE_trapeze")])
        .args(training(&out, &options))
        .output()
        .unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    let last = errors.lines().last().unwrap();
    assert!(last.starts_with("error: ") && last.contains(".checkpoint: "), "{errors}");
    let kept: Vec<_> = std::fs::read_dir(out.join("checkpoints")).unwrap().collect();
    assert!(
        !kept.is_empty()
            && kept.iter().all(|file| file.as_ref().unwrap().metadata().unwrap().len() < 170_000)
    );

    succeed(&training(&out, &options));
    let whole = folder.path().join("whole");
    succeed(&training(&whole, &options));
    assert_eq!(splats_of(&out), splats_of(&whole));
}

#[test]
fn runs_that_cannot_begin_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |extra: &[&str]| refusal(&training(&folder.path().join("new"), extra));
    let message = refuse(&["--memory-limit", "1", "--steps", "10", "--max-splats", "9000"]);
    assert!(message.starts_with("memory: ") && message.contains("photographs"), "{message}");
    let used = folder.path().join("used");
    std::fs::create_dir(&used).unwrap();
    std::fs::write(used.join("mine.txt"), b"x").unwrap();
    let message = refusal(&training(&used, &["--steps", "10"]));
    assert!(message.starts_with("--out: expected an empty folder, or --resume"), "{message}");
    let message = refusal(&arguments!["train", "nowhere", "--out", folder.path().join("x")]);
    assert!(message.starts_with("nowhere: "), "{message}");
    let message = refuse(&["--holdout", "1"]);
    assert!(message.starts_with("--holdout: "), "{message}");
}
