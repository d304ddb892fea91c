//! `trapeze render --path`: sequences and animations.

mod support;

use std::fs::File;
use std::io::BufReader;
use std::time::Duration;

use image::AnimationDecoder;
use image::codecs::webp::WebPDecoder;
use support::{refusal, succeed, thinned_scene};

#[test]
fn a_path_to_png_is_a_numbered_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let out = folder.path().join("turn.png");
    let path = ["--path", "turntable", "--frames", "3", "--size", "64x48"];
    let mut arguments = arguments!["render", scene, "--out", &out].to_vec();
    arguments.extend(path.map(Into::into));
    succeed(&arguments);
    let frame =
        |i: u32| image::open(folder.path().join(format!("turn-{i:04}.png"))).unwrap().to_rgb8();
    let frames = [frame(0), frame(1), frame(2)];
    assert!(frames.iter().all(|f| f.dimensions() == (64, 48)));
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    assert!(!out.exists() && !folder.path().join("turn-0003.png").exists());
}

#[test]
fn a_path_to_webp_is_one_animation() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    for path in ["turntable", "time"] {
        let out = folder.path().join(format!("{path}.webp"));
        let mut arguments = arguments!["render", &scene, "--out", &out, "--path", path].to_vec();
        arguments.extend(["--frames", "4", "--fps", "10", "--size", "64x48"].map(Into::into));
        succeed(&arguments);
        let decoder = WebPDecoder::new(BufReader::new(File::open(&out).unwrap())).unwrap();
        assert!(decoder.has_animation());
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 4, "{path}");
        for frame in frames {
            assert_eq!(frame.buffer().dimensions(), (64, 48));
            assert_eq!(Duration::from(frame.delay()), Duration::from_millis(100), "{path}");
        }
    }
}

#[test]
fn raw_values_have_no_path() {
    let folder = tempfile::tempdir().unwrap();
    let scene = thinned_scene(folder.path());
    let out = folder.path().join("turn.npy");
    let message = refusal(&arguments!["render", scene, "--out", out, "--path", "time"]);
    assert_eq!(message, "--out: expected a file ending in .webp or .png, found npy");
}
