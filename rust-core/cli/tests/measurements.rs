//! `trapeze bench` and `trapeze report`: speed beside error.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{json, refusal, succeed, thinned_scene};

fn expect_timing_and_machine(report: &Value) {
    let timing = &report["timing"];
    assert_eq!(timing["runs"], 3);
    let at = |name: &str| timing[name].as_f64().unwrap();
    assert!(at("min_ms") > 0.0 && at("min_ms") <= at("p10_ms"));
    assert!(at("p10_ms") <= at("median_ms") && at("median_ms") <= at("p90_ms"));
    for key in ["cpu", "simd", "os"] {
        assert!(!report["machine"][key].as_str().unwrap().is_empty(), "{key}");
    }
}

#[test]
fn frames_are_timed_by_stage_with_their_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let mut arguments = arguments!["bench", "render", scene, "--json", "--runs", "3"].to_vec();
    arguments.extend(["--size", "64x48", "--time", "0.5"].map(Into::into));
    let report = json(&arguments);
    expect_timing_and_machine(&report);
    for stage in ["deform", "project", "sort", "bin", "rasterize"] {
        assert!(report["detail"]["median_stage_ms"][stage].is_f64(), "{stage}");
    }
    let error = &report["error_against_f64"];
    assert!(error["psnr"].as_f64().unwrap() > 40.0, "{error}");
    assert!(error["max"].is_f64() && error["p999"].is_f64());
}

#[test]
fn the_network_is_timed_with_its_error() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let bench = |options: &[&str]| {
        let mut arguments = arguments!["bench", "deform", &scene, "--json", "--runs", "3"].to_vec();
        arguments.extend(options.iter().map(Into::into));
        let report = json(&arguments);
        expect_timing_and_machine(&report);
        // The bound that the network is held to against its training code.
        assert!(report["error_against_f64"]["max"].as_f64().unwrap() < 2e-5, "{report}");
        report["detail"]["dynamic_splats"].as_u64().unwrap()
    };
    let all = bench(&[]);
    assert_eq!(all, 867);
    let half = bench(&["--static-percentile", "50"]);
    assert!(half.abs_diff(all / 2) <= 1, "{half}");
}

#[test]
fn loading_is_timed_on_a_file_or_on_one_that_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    for (source, splats) in
        [(scene.join("point_cloud.ply").into_os_string(), 867), ("--splats=1000".into(), 1000)]
    {
        let report = json(&arguments!["bench", "load", source, "--json", "--runs", "3"]);
        expect_timing_and_machine(&report);
        assert_eq!(report["splats"], splats);
        assert!(report["detail"]["bytes"].as_u64().unwrap() >= 4 * 62 * splats);
    }
}

#[test]
fn a_bench_of_what_is_absent_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let message = refusal(&arguments!["bench", "deform", scene.join("point_cloud.ply")]);
    assert_eq!(message, "SCENE: expected a scene with a deformation network, found none");
}

#[test]
fn a_report_has_a_row_per_variant_in_all_three_forms() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let out = folder.path().join("report");
    let mut arguments = arguments!["report", scene, "--out", &out].to_vec();
    arguments.extend(["--size", "32x24", "--views", "1", "--backend", "all"].map(Into::into));
    let printed = succeed(&arguments);
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let (markdown, svg) = (read("report.md"), read("report.svg"));
    assert_eq!(printed, markdown);
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    let report: Value = serde_json::from_str(&read("report.json")).unwrap();
    assert!(!report["machine"]["cpu"].as_str().unwrap().is_empty());
    let rows = report["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row["variant"].as_str().unwrap()).collect();
    for expected in ["f64 reference", "scalar", "50 % static", "45 % static (recommended)"] {
        assert!(names.contains(&expected), "{names:?}");
    }
    assert!(names.contains(&"SH degree 0"), "{names:?}");
    // On machines with a GPU, or with software Vulkan, its variants stand beside the CPU's.
    if report["device"].is_object() {
        for expected in ["GPU f32", "GPU f16 network", "GPU 8-bit SH", "GPU 50 % of the splats"] {
            assert!(names.contains(&expected), "{names:?}");
        }
        let figure = |name: &str, key: &str| {
            let row = rows.iter().find(|row| row["variant"] == name).unwrap();
            row[key].as_f64().unwrap_or_else(|| panic!("{name} has no {key}"))
        };
        assert!(figure("GPU f32", "psnr") >= 60.0);
        assert!(figure("GPU f16 network", "psnr") >= 45.0);
        let bytes = |name: &str| figure(name, "device_bytes");
        assert!(bytes("GPU 8-bit SH") < bytes("GPU f16 SH"));
        assert!(bytes("GPU f16 SH") < bytes("GPU f32"));
        assert!(bytes("GPU 25 % of the splats") < bytes("GPU 50 % of the splats"));
    } else {
        eprintln!("SKIPPED: the report's GPU variants need a Vulkan or Metal device");
    }
    for row in rows {
        let name = row["variant"].as_str().unwrap();
        assert!(markdown.contains(&format!("| {name} ")), "{name}");
        let number = |key: &str| row[key].as_f64().unwrap();
        assert!(number("median_ms") > 0.0 && number("speed_up") > 0.0, "{name}");
        assert!(number("max") >= 0.0 && number("p999") >= 0.0, "{name}");
        assert!(name == "f64 reference" || number("frames") >= 20.0, "{name}");
    }
    let points = svg.matches("<circle").count();
    assert!(points >= rows.len(), "{points} points for {} rows", rows.len());
}

#[test]
fn training_is_timed_beside_the_reference_and_what_moves_trains_its_network() {
    let photographs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sample-dataset");
    let bench = |options: &[&str]| {
        let mut arguments = arguments!["bench", "train", &photographs, "--json"].to_vec();
        arguments.extend(["--downscale", "4", "--random-splats", "60"].map(Into::into));
        arguments.extend(["--steps", "6", "--reference-steps", "3"].map(Into::into));
        arguments.extend(options.iter().map(Into::into));
        json(&arguments)
    };
    let psnr = |report: &Value| {
        let early = |row: &Value| row["psnr_at_reference_steps"].as_f64().unwrap();
        report["rows"].as_array().unwrap().iter().map(early).collect::<Vec<_>>()
    };
    for options in [&["--static"][..], &[]] {
        let report = bench(options);
        assert_eq!((&report["splats"], &report["reference_steps"]), (&60.into(), &3.into()));
        assert_eq!(report["rows"][0]["variant"], "f64 reference");
        let rows = report["rows"].as_array().unwrap();
        assert!(rows.len() >= 2, "{report}");
        assert!(rows.iter().all(|row| row["steps_per_second"].as_f64().unwrap() > 0.0));
        let levels = psnr(&report);
        // Three steps of Adam from the same start: what rounds to either side of zero moves by a rate.
        assert!(levels.iter().all(|psnr| (psnr - levels[0]).abs() < 1e-2), "{levels:?}");
    }
    let (at_rest, moving) = (psnr(&bench(&["--static"])), psnr(&bench(&[])));
    assert_ne!(at_rest, moving);
}
