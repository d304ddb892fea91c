//! Input that cannot be used ends in one line that names the file or argument, the field and what
//! was expected ([`support::refusal`] checks the rest).

mod support;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use support::{refusal, sample_scene, succeed, thinned_scene};

const CAMERA: &str = r#"{"width": 8, "height": 6, "fx": 9, "fy": 9, "cx": 4, "cy": 3,
    "world_to_camera": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}"#;

/// A thinned scene in a folder that is removed with it.
struct Fixture {
    folder: tempfile::TempDir,
    scene: PathBuf,
}

impl Fixture {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = thinned_scene(folder.path());
        Self { folder, scene }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// What `render` refuses with these options.
    fn render(&self, options: &[&str]) -> String {
        let out = self.path("out.png");
        let mut arguments = arguments!["render", &self.scene, "--size", "8x8"].to_vec();
        if !options.contains(&"--out") {
            arguments.extend(["--out".into(), out.into_os_string()]);
        }
        arguments.extend(options.iter().map(OsString::from));
        refusal(&arguments)
    }
}

fn info(path: &Path) -> String {
    refusal(&arguments!["info", path])
}

/// Checks that the message names the path and then says each of `parts`.
fn expect(message: &str, path: &Path, parts: &[&str]) {
    let name = path.display().to_string();
    assert!(message.starts_with(&name), "{message} does not name {name}");
    for part in parts {
        assert!(message.contains(part), "{message} does not say {part}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let fixture = Fixture::new();
    for name in ["none.ply", "none.spz", "none"] {
        let path = fixture.path(name);
        expect(&info(&path), &path, &["No such file"]);
    }
    let camera = fixture.path("none.json");
    let message = fixture.render(&["--camera", camera.to_str().unwrap()]);
    expect(&message, &camera, &["No such file"]);
}

#[test]
fn a_folder_in_place_of_a_file_is_refused_as_one() {
    let fixture = Fixture::new();
    let empty = fixture.path("empty");
    std::fs::create_dir(&empty).unwrap();
    expect(&info(&empty), &empty, &["expected point_cloud.ply"]);
    let message = fixture.render(&["--camera", empty.to_str().unwrap()]);
    expect(&message, &empty, &["expected a regular file, found a folder"]);
    for part in ["weights.bin", "clusters.bin", "mask.bin", "mask.json"] {
        let fixture = Fixture::new();
        let path = fixture.scene.join(part);
        std::fs::remove_file(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        expect(&info(&fixture.scene), &path, &["expected a regular file, found a folder"]);
    }
}

#[test]
fn a_format_that_is_not_known_is_refused_with_those_that_are() {
    let fixture = Fixture::new();
    let notes = fixture.write("notes.txt", "not a scene");
    expect(&info(&notes), &notes, &["format: expected a splat file (.ply", ".spz"]);
    let mesh = fixture.write("mesh.ply", "not a scene");
    expect(&info(&mesh), &mesh, &["expected"]);
    let message = fixture.render(&["--out", "image.jpg"]);
    assert_eq!(message, "--out: expected a file ending in .png or .npy, found jpg");
    let sog = fixture.path("out.sog");
    let message = refusal(&arguments!["convert", &fixture.scene, &sog]);
    expect(&message, &sog, &["format: expected .ply", "found .sog"]);
}

#[test]
fn truncated_parts_of_a_scene_are_refused_by_name() {
    for part in ["point_cloud.ply", "weights.bin", "clusters.bin", "mask.bin"] {
        let fixture = Fixture::new();
        let path = fixture.scene.join(part);
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 3, bytes.len() / 2 + 1, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let message = info(&fixture.scene);
            expect(&message, &path, &["expected"]);
        }
    }
}

#[test]
fn truncated_splat_files_are_refused_by_name() {
    let fixture = Fixture::new();
    for name in ["cut.compressed.ply", "cut.splat", "cut.spz"] {
        let path = fixture.path(name);
        succeed(&arguments!["convert", &fixture.scene, &path]);
        let bytes = std::fs::read(&path).unwrap();
        for length in [3, bytes.len() / 2 + 1, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            expect(&info(&path), &path, &[]);
        }
    }
}

#[test]
fn a_cluster_that_does_not_exist_is_refused_with_those_that_do() {
    let fixture = Fixture::new();
    let expected = "cluster: expected one of 1, 2, 3, 4, 5, found 99";
    assert_eq!(fixture.render(&["--isolate", "2,99"]), expected);
    assert_eq!(fixture.render(&["--hide", "99"]), expected);
    let out = fixture.path("out.ply");
    for option in ["--keep-clusters", "--drop-clusters"] {
        let message = refusal(&arguments!["convert", &fixture.scene, &out, option, "99"]);
        assert_eq!(message, "cluster 99: expected one of 1, 2, 3, 4, 5");
        assert!(!out.exists());
    }
    let plain = fixture.scene.join("point_cloud.ply");
    let message = refusal(&arguments!["convert", plain, &out, "--keep-clusters", "1"]);
    assert_eq!(message, "clusters: expected a scene with clusters, found none");
}

#[test]
fn shares_outside_of_their_range_are_refused() {
    let fixture = Fixture::new();
    for share in ["150", "NaN", "inf"] {
        let message = fixture.render(&["--static-percentile", share]);
        assert_eq!(message, format!("--static-percentile: expected 0 to 100, found {share}"));
    }
    let out = fixture.path("out.ply");
    let message = refusal(&arguments!["convert", &fixture.scene, &out, "--min-opacity", "1.5"]);
    assert_eq!(message, "--min-opacity: expected 0 to 1, found 1.5");
    let mask = fixture.scene.join("mask.json");
    std::fs::write(&mask, r#"{"recommended_percentile": 150}"#).unwrap();
    expect(&info(&fixture.scene), &mask, &["recommended_percentile: expected 0 to 100, found 150"]);
}

#[test]
fn a_mask_is_needed_where_it_is_asked_for() {
    let fixture = Fixture::new();
    std::fs::remove_file(fixture.scene.join("mask.bin")).unwrap();
    let message = fixture.render(&["--static-percentile", "50"]);
    assert!(message.starts_with("--static-percentile: expected a scene with motion values"));
}

#[test]
fn cameras_that_cannot_project_are_refused_by_field() {
    let fixture = Fixture::new();
    for (from, to, expected) in [
        (r#""fx": 9"#, r#""fx": NaN"#, "fx: expected value"),
        (r#""fx": 9"#, r#""fx": null"#, "fx: invalid type: null"),
        (r#""fx": 9"#, r#""fx": 0"#, "camera fx: expected a positive focal length"),
        (r#""width": 8"#, r#""width": 0"#, "camera width: expected 1 to 16384 pixels"),
        (r#""cy": 3,"#, "", "missing field `cy`"),
        ("[0,0,1,4]", "[0,0,0,4]", "camera world_to_camera: expected an invertible matrix"),
    ] {
        let camera = fixture.write("camera.json", CAMERA.replacen(from, to, 1));
        let message = fixture.render(&["--camera", camera.to_str().unwrap()]);
        expect(&message, &camera, &[expected]);
    }
}

#[test]
fn parts_of_another_scene_are_refused_with_both_counts() {
    let fixture = Fixture::new();
    let copy = |part: &str| {
        let path = fixture.scene.join(part);
        std::fs::copy(sample_scene().join(part), &path).unwrap();
        path
    };
    let mask = copy("mask.bin");
    let counts = "motion values: expected 867 values (one per splat) or 5 (one per cluster)";
    expect(&info(&fixture.scene), &mask, &[counts, "found 34670 values"]);
    let clusters = copy("clusters.bin");
    expect(&info(&fixture.scene), &clusters, &["expected 867, one per splat, found 34670"]);
}

#[test]
fn output_that_cannot_be_written_is_named() {
    let fixture = Fixture::new();
    // A file where a folder would have to be: refused to every user, root as well.
    let file = fixture.write("file", "");
    for name in ["out.png", "out.npy"] {
        let out = file.join(name);
        let message = fixture.render(&["--out", out.to_str().unwrap()]);
        expect(&message, &out, &["Not a directory"]);
    }
    for name in ["out.ply", "out.splat", "out"] {
        let out = file.join(name);
        let message = refusal(&arguments!["convert", &fixture.scene, &out]);
        expect(&message, &out, &["Not a directory"]);
    }
    let missing = fixture.path("missing/out.png");
    expect(&fixture.render(&["--out", missing.to_str().unwrap()]), &missing, &["No such file"]);
    let plain = fixture.scene.join("point_cloud.ply");
    let message = refusal(&arguments!["motion", plain, "--write"]);
    assert!(message.starts_with("SCENE: expected"), "{message}");
}
