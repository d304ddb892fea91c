//! Splats at the near plane, and outside the frustum with extents inside it.

use glam::DVec3;
use trapeze_cpu::reference::NEAR_PLANE;
use trapeze_scene::{Camera, NO_SPLAT};
use trapeze_tests::{
    Random, Splat, assert_agrees, assert_agrees_within, camera_at_origin, everything,
    rounding_bound, scene_of,
};

#[test]
fn a_splat_is_drawn_just_before_the_near_plane_and_not_at_or_behind_it() {
    let near = NEAR_PLANE as f32;
    let cases = [
        (near.next_up(), true),
        (near * 1.001, true),
        (near, false),
        (near.next_down(), false),
        (0.0, false),
        (f32::MIN_POSITIVE, false),
        (-near, false),
        (-3.0, false),
    ];
    let camera = camera_at_origin(64, 48);
    for (z, drawn) in cases {
        // At the near plane a pixel is 2e-4 world units wide.
        let splat =
            Splat { position: [0.0, 0.0, z], log_scale: [2e-3f32.ln(); 3], ..Splat::default() };
        let frame = assert_agrees(&scene_of(&[splat]), &camera, &everything());
        let centre = frame.top_contributor[24 * 64 + 32];
        assert_eq!(centre, if drawn { 0 } else { NO_SPLAT }, "z = {z}");
    }
}

#[test]
fn splats_at_the_far_end_of_the_numbers_leave_the_image_finite() {
    // Products and sums of the view transform overflow here; a splat whose view depth f32 cannot
    // hold has no place in the order and is not drawn.
    let near = Splat { position: [0.3, 0.1, 3.0], ..Splat::default() };
    let far = [1e18, 1e20, 1e30, 3e38, f32::MAX];
    for (eye, target) in [([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]), ([1.0, 2.0, -3.0], [4.0, 5.0, 9.0])] {
        let camera = Camera::look_at(eye.into(), target.into(), DVec3::Y, 0.8, (64, 48));
        for z in far {
            for position in [[0.0, 0.0, z], [z, z, z], [z, 0.0, z], [z, -z, z], [-z, z, z / 2.0]] {
                for log_scale in [-2.0, 20.0, 88.0] {
                    let splat = Splat { position, log_scale: [log_scale; 3], logit: 3.0, ..near };
                    let _ = assert_agrees(&scene_of(&[splat, near]), &camera, &everything());
                }
            }
        }
    }
}

#[test]
fn a_huge_splat_just_before_the_near_plane_covers_the_screen_evenly() {
    let splat =
        Splat { position: [0.0, 0.0, 0.010_1], log_scale: [3.0f32.ln(); 3], ..Splat::default() };
    let frame = assert_agrees(&scene_of(&[splat]), &camera_at_origin(64, 48), &everything());
    // σ = 3 · 48 / 0.0101 ≈ 14 000 px: α is the opacity to within (40 / 14 000)².
    assert!(frame.color.iter().all(|c| (c[3] - 0.5).abs() < 1e-5));
}

#[test]
fn centres_outside_the_frustum_with_extents_inside_are_drawn() {
    let camera = camera_at_origin(64, 48);
    // The frustum's half-widths at unit depth are 2/3 and 1/2.
    for (position, size) in [
        ([3.0, 0.0, 1.0], 1.5),
        ([-3.0, 0.0, 1.0], 1.5),
        ([0.0, 4.0, 1.0], 2.0),
        ([0.0, -4.0, 1.0], 2.0),
        ([-30.0, 20.0, 5.0], 20.0),
        ([5.0, 5.0, 0.05], 3.0),
    ] {
        let splat =
            Splat { position, log_scale: [f32::ln(size); 3], logit: 2.0, ..Splat::default() };
        let frame = assert_agrees(&scene_of(&[splat]), &camera, &everything());
        let seen = frame.top_contributor.iter().filter(|&&top| top == 0).count();
        assert!(seen > 0, "{position:?}: a centre outside must not hide the splat");
    }
}

#[test]
fn splats_all_around_the_frustum_edges_agree_with_the_reference() {
    let camera = camera_at_origin(80, 60);
    for seed in 0..8 {
        let mut random = Random::new(seed);
        let splats: Vec<Splat> = (0..60)
            .map(|_| {
                let z = random.between(-0.5, 4.0);
                // Up to three half-widths from the axis.
                let reach = z.abs().max(0.05) * 2.0;
                Splat {
                    position: [random.signed() * reach, random.signed() * reach, z],
                    log_scale: std::array::from_fn(|_| random.between(-5.0, 0.0)),
                    rotation: random.vector(1.0),
                    logit: random.between(-4.0, 4.0),
                    dc: random.vector(1.5),
                }
            })
            .collect();
        let _ = assert_agrees(&scene_of(&splats), &camera, &everything());
    }
}

#[test]
fn grazing_splats_at_the_near_plane_agree_within_what_their_centre_is_known_to() {
    // x/z up to 100: the centre lies up to 100 focal lengths off the image, and its rounding,
    // ε·6000 px, is compared with ellipses down to √0.3 px wide.
    let camera = camera_at_origin(80, 60);
    let mut random = Random::new(11);
    let splats: Vec<Splat> = (0..200)
        .map(|_| Splat {
            position: [random.signed(), random.signed(), random.between(0.0101, 0.02)],
            log_scale: std::array::from_fn(|_| random.between(-4.0, 0.0)),
            rotation: random.vector(1.0),
            logit: random.between(-4.0, 0.0),
            dc: random.vector(1.0),
        })
        .collect();
    let scene = scene_of(&splats);
    let bound = rounding_bound(&scene, &camera, &everything());
    assert!(bound < 1.0, "the comparison would say nothing: {bound}");
    let _ =
        assert_agrees_within(bound.max(trapeze_tests::TOLERANCE), &scene, &camera, &everything());
}
