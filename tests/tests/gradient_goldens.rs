//! Gradients against those that gsplat's CUDA kernels gave for the same scenes and camera.
//!
//! The loss is Σ image·W with W[y, x] = (cos(.05x + .03y), sin(.04x − .02y), cos(.02x + .05y + 1)).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DMat4;
use trapeze_cpu::{ImageGradient, reference};
use trapeze_formats::{NpyArray, load_scene, read_npz};
use trapeze_gpu::DeviceProfile;
use trapeze_scene::{Camera, FrameSettings, Scene};
use trapeze_tests::{cpu_gradients, gpu, gpu_gradients};

const SIZE: (u32, u32) = (480, 320);

/// Least cosine between the gradients of a group. Both are single precision sums over up to 10⁵
/// pixels, and a threshold that flips in one pixel changes a splat's entry in the fourth digit.
const COSINE: f64 = 0.9999;
/// Largest median of |g − g*| / |g*| over the entries of a group.
const MEDIAN_ERROR: f64 = 0.01;

struct Golden {
    arrays: BTreeMap<String, NpyArray>,
    scene: Scene,
}

fn golden(name: &str) -> Option<Golden> {
    let data = std::env::var_os("TRAPEZE_DATA").map(PathBuf::from).filter(|data| data.is_dir());
    let Some(data) = data else {
        eprintln!("SKIPPED: gradient goldens of {name} need TRAPEZE_DATA");
        return None;
    };
    Some(Golden {
        arrays: read_npz(&data.join(format!("goldens/grad_{name}.npz"))).unwrap(),
        scene: load_scene(&data.join(Path::new("splats")).join(format!("{name}.ply"))).unwrap(),
    })
}

impl Golden {
    fn numbers(&self, array: &str) -> Vec<f64> {
        self.arrays[array].values.to_f64()
    }

    fn camera(&self) -> Camera {
        let (k, rows) = (self.numbers("K"), self.numbers("w2c"));
        Camera {
            width: SIZE.0,
            height: SIZE.1,
            fx: k[0],
            fy: k[4],
            cx: k[2],
            cy: k[5],
            world_to_camera: DMat4::from_cols_array(&std::array::from_fn(|i| rows[i])).transpose(),
        }
    }

    fn indices(&self) -> Vec<usize> {
        self.numbers("index").iter().map(|&i| i as usize).collect()
    }

    fn assert_group(&self, path: &str, array: &str, found: &[f64]) {
        let expected = self.numbers(array);
        assert_eq!(found.len(), expected.len(), "{array}");
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let cosine = dot(found, &expected) / (dot(found, found) * dot(&expected, &expected)).sqrt();
        let mut errors: Vec<f64> = found
            .iter()
            .zip(&expected)
            .filter(|(_, expected)| **expected != 0.0)
            .map(|(found, expected)| (found - expected).abs() / expected.abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let median = errors[errors.len() / 2];
        println!("{path} {array}: cosine 1 - {:.1e}, median error {median:.1e}", 1.0 - cosine);
        assert!(cosine >= COSINE, "{path} {array}: cosine {cosine}");
        assert!(median <= MEDIAN_ERROR, "{path} {array}: median error {median}");
    }
}

fn weights() -> Vec<[f32; 4]> {
    let (width, height) = SIZE;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (f64::from(x), f64::from(y))));
    let weight = |(x, y): (f64, f64)| {
        [
            (0.05 * x + 0.03 * y).cos(),
            (0.04 * x - 0.02 * y).sin(),
            (0.02 * x + 0.05 * y + 1.0).cos(),
            0.0,
        ]
    };
    pixels.map(|at| weight(at).map(|w| w as f32)).collect()
}

fn assert_gradients(name: &str) {
    let Some(golden) = golden(name) else { return };
    let (scene, camera, settings) = (&golden.scene, golden.camera(), FrameSettings::default());
    let color = weights();
    let gradient = ImageGradient { color: &color, expected_depth: None };

    let indices = golden.indices();
    let gather = |numbers: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64> {
        indices.iter().flat_map(|&i| numbers(i)).collect()
    };
    let mut backends = vec![("CPU", cpu_gradients(scene, &camera, &settings, &gradient))];
    if let Some(gpu) = gpu(DeviceProfile::Full) {
        backends.push(("GPU", gpu_gradients(&gpu, scene, &camera, &settings, &gradient)));
    }
    let wide = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect::<Vec<f64>>();
    for (path, found) in &backends {
        let check = |array: &str, numbers: &dyn Fn(usize) -> Vec<f64>| {
            golden.assert_group(path, array, &gather(numbers));
        };
        check("means", &|i| wide(&found.positions[i]));
        check("quats", &|i| wide(&found.rotations[i]));
        check("log_scales", &|i| wide(&found.log_scales[i]));
        check("opacity_logits", &|i| vec![f64::from(found.opacity_logits[i])]);
        check("sh", &|i| [wide(&found.sh_dc[i]), wide(found.sh_rest_of(i))].concat());
    }

    let exact = reference::gradients(scene, &camera, &settings, &gradient).splats;
    let coefficients = scene.splats.sh_degree.coefficients();
    let check = |array: &str, numbers: &dyn Fn(usize) -> Vec<f64>| {
        golden.assert_group("reference", array, &gather(numbers));
    };
    check("means", &|i| exact[i].position.to_array().to_vec());
    check("quats", &|i| exact[i].rotation.to_vec());
    check("log_scales", &|i| exact[i].log_scale.to_array().to_vec());
    check("opacity_logits", &|i| vec![exact[i].opacity_logit]);
    check("sh", &|i| exact[i].sh[..coefficients].as_flattened().to_vec());
}

#[test]
fn gradients_of_a_capture_are_those_of_an_independent_implementation() {
    assert_gradients("guitar");
}

#[test]
fn gradients_of_a_capture_with_harmonics_are_those_of_an_independent_implementation() {
    assert_gradients("stone");
}
