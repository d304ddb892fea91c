//! Plans against what is really allocated, and tiers against budgets.

use std::path::Path;
use std::sync::Arc;

use trapeze_scene::{Camera, Frame, FrameSettings, NO_SPLAT, Scene, ShDegree, Splats, psnr};

use super::{MemoryPlan, MemoryRequest, SceneSize};
use crate::kernel_tests::device;
use crate::{Gpu, GpuError, HarmonicsStorage, Renderer, RendererOptions};

const IMAGE: [u32; 2] = [64, 48];

/// Numbers from 0 to 1 that look random, the same every time (Weyl's sequence of the golden ratio).
fn scattered(i: usize, salt: f64) -> f32 {
    ((i as f64 + 1.0) * 0.618_033_988_749_895 * (1.0 + salt)).fract() as f32
}

/// A cloud with colours that change with the view.
fn cloud(n: usize) -> Scene {
    let rest = 3 * ShDegree::Three.rest_coefficients();
    Scene::from_splats(Splats {
        positions: (0..n)
            .map(|i| [0.0, 1.0, 2.0].map(|c| scattered(i, c) * 2.0 - 1.0))
            .map(|[x, y, z]| [x, y * 0.7, z + 3.0])
            .collect(),
        log_scales: (0..n).map(|i| [-4.0 + 2.0 * scattered(i, 3.0); 3]).collect(),
        rotations: vec![[1.0, 0.0, 0.0, 0.0]; n],
        opacity_logits: (0..n).map(|i| scattered(i, 4.0) * 6.0 - 3.0).collect(),
        sh_dc: (0..n).map(|i| [5.0, 6.0, 7.0].map(|c| scattered(i, c) * 2.0 - 1.0)).collect(),
        sh_rest: (0..n * rest).map(|i| scattered(i, 8.0) * 0.3 - 0.15).collect(),
        sh_degree: ShDegree::Three,
    })
}

fn camera() -> Camera {
    Camera {
        width: IMAGE[0],
        height: IMAGE[1],
        fx: 50.0,
        fy: 50.0,
        cx: 32.0,
        cy: 24.0,
        world_to_camera: glam::DMat4::IDENTITY,
    }
}

fn render(gpu: &Gpu, scene: &Arc<Scene>, options: RendererOptions) -> Frame {
    let settings = FrameSettings { top_contributor: true, ..FrameSettings::default() };
    let mut renderer = Renderer::with_options(gpu, scene.clone(), options).unwrap();
    renderer.render(&camera(), &settings).unwrap()
}

#[test]
fn a_plan_is_what_is_allocated() {
    let Some(gpu) = device() else { return };
    let scene = Arc::new(cloud(20_000));
    let size = SceneSize::of(&scene).unwrap();
    for options in [
        RendererOptions::default(),
        RendererOptions { harmonics: HarmonicsStorage::Byte, ..RendererOptions::default() },
        RendererOptions { max_splats: Some(5000), ..RendererOptions::default() },
    ] {
        let plan = MemoryPlan::new(&size, &options, IMAGE, false);
        let before = gpu.created().buffer_bytes;
        let mut renderer = Renderer::with_options(&gpu, scene.clone(), options).unwrap();
        renderer.draw(&camera(), &FrameSettings::default()).unwrap();
        let allocated = gpu.created().buffer_bytes - before;
        // The promise of `MemoryPlan`: no more than 64 KiB are left out.
        assert!(
            allocated >= plan.total() && allocated - plan.total() < 64 << 10,
            "{allocated} and {plan:#?}"
        );
    }
}

#[test]
fn a_plan_of_a_moving_scene_is_what_is_allocated() {
    let Some(gpu) = device() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/sample-scene");
    // Few, because uploading evaluates the network for all of them at t = 0.
    let few: Vec<u32> = (0..1000).collect();
    let scene = Arc::new(trapeze_formats::load_scene(&folder).unwrap().gather(&few));
    let size = SceneSize::of(&scene).unwrap();
    assert!(size.network_bytes.is_some() && size.motion && size.clusters > 1);
    let options = RendererOptions::default();
    let plan = MemoryPlan::new(&size, &options, [0, 0], false);
    let before = gpu.created().buffer_bytes;
    let _renderer = Renderer::with_options(&gpu, scene, options).unwrap();
    let allocated = gpu.created().buffer_bytes - before;
    assert!(
        allocated >= plan.total() && allocated - plan.total() < 64 << 10,
        "{allocated} and {plan:#?}"
    );
}

#[test]
fn a_million_splats_with_all_bands_and_a_network_fit_into_a_gigabyte_and_a_half() {
    let Some(gpu) = device() else { return };
    let size = SceneSize {
        splats: 1_000_000,
        sh_degree: ShDegree::Three,
        clusters: 100,
        network_bytes: Some(2_100_000),
        motion: true,
    };
    let request = MemoryRequest { budget: 1_500_000_000, image: [1920, 1080], layers: true };
    let (options, plan) = RendererOptions::default().within(&gpu, &size, &request).unwrap();
    assert_eq!((options.harmonics, options.max_splats), (HarmonicsStorage::Single, None));
    assert!(plan.total() <= request.budget, "{plan:#?}");
    // Without giving up anything, and with room for 20 tiles a splat.
    assert!(options.max_entries.unwrap() >= 20_000_000, "{options:?}");
}

#[test]
fn smaller_budgets_give_up_more_and_are_kept() {
    let Some(gpu) = device() else { return };
    let scene = Arc::new(cloud(4000));
    let size = SceneSize::of(&scene).unwrap();
    let exact = render(&gpu, &scene, RendererOptions::default());
    let mut seen = Vec::new();
    let mut budget = 2_000_000;
    loop {
        let request = MemoryRequest { budget, image: IMAGE, layers: true };
        let found = RendererOptions::default().within(&gpu, &size, &request);
        let (options, plan) = match found {
            Ok(found) => found,
            Err(GpuError::OutOfMemory { need, have, .. }) => {
                assert!(need > have && have == budget, "{need} {have}");
                break;
            }
            Err(error) => panic!("{error}"),
        };
        assert!(plan.total() <= budget, "{budget}: {plan:#?}");
        let before = gpu.created().buffer_bytes;
        let frame = render(&gpu, &scene, options);
        let allocated = gpu.created().buffer_bytes - before;
        // Buffers that were replaced by larger ones count twice here, and reading back adds the
        // image twice.
        let image = u64::from(IMAGE[0] * IMAGE[1]) * 32;
        assert!(allocated <= 2 * budget + image + (64 << 10), "{budget}: {allocated}");
        let known = |splat: u32| splat == NO_SPLAT || (splat as usize) < scene.len();
        assert!(frame.top_contributor.iter().all(|&splat| known(splat)));
        seen.push((options, psnr(&frame.color, &exact.color)));
        budget = budget * 9 / 10;
    }
    let harmonics = |wanted| seen.iter().any(|(options, _)| options.harmonics == wanted);
    assert!(HarmonicsStorage::ALL.into_iter().all(harmonics), "{seen:#?}");
    assert!(seen.iter().any(|(options, _)| options.max_sh_degree < ShDegree::Three));
    assert!(seen.iter().any(|(options, _)| options.max_splats.is_some()), "{seen:#?}");
    // Bytes with all bands: ±½ step of 1/127 of coefficients up to 0.15 in fifteen terms of about
    // 0.6 are 1e-3 a splat, 60 dB, and a pixel averages over several. Bands up to 0.15 that are
    // missing cost about 0.2 a splat, half of the splats more: such tiers still show the scene.
    for (options, quality) in &seen {
        let least = match (options.harmonics, options.max_sh_degree, options.max_splats) {
            (HarmonicsStorage::Single, _, None) => 90.0,
            (HarmonicsStorage::Half, _, None) => 70.0,
            (HarmonicsStorage::Byte, ShDegree::Three, None) => 55.0,
            _ => 12.0,
        };
        assert!(*quality >= least, "{options:?}: {quality} dB");
    }
}

#[test]
fn splats_that_were_left_out_keep_their_neighbours_indices() {
    let Some(gpu) = device() else { return };
    // The first splat is too small to stay; the second one fills the image.
    let mut scene = cloud(2);
    scene.splats.positions = vec![[0.0, 0.0, 2.0], [0.0, 0.0, 3.0]];
    scene.splats.log_scales = vec![[-9.0; 3], [0.0; 3]];
    scene.splats.opacity_logits = vec![3.0; 2];
    let options = RendererOptions { max_splats: Some(1), ..RendererOptions::default() };
    let frame = render(&gpu, &Arc::new(scene), options);
    assert_eq!(frame.top_contributor[(24 * 64 + 32) as usize], 1);
}
