//! What is written comes back, what is broken is refused by name, what is far away is moved.

mod scenes;

use glam::DVec3;
use scenes::{numbered_features, random_scene};
use trapeze_formats::ply::{
    encode_compressed_ply, encode_ply, parse_ply, read_ply, write_compressed_ply, write_ply,
};
use trapeze_scene::{SH_C0, Scene, ShDegree, sigmoid};

fn encoded(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_ply(scene, &mut bytes).unwrap();
    bytes
}

fn error_of(bytes: &[u8]) -> String {
    parse_ply(bytes).unwrap_err().to_string()
}

/// The file with a piece of its header replaced.
fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|w| w == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("{from} is not in the file"));
    let mut bytes = bytes.to_vec();
    bytes.splice(at..at + from.len(), to.bytes());
    bytes
}

#[test]
fn a_written_scene_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ply");
    for degree in ShDegree::ALL {
        // More splats than one task reads.
        let mut scene = random_scene(5000, degree, 1);
        scene.features = Some(numbered_features(5000, 16));
        write_ply(&path, &scene).unwrap();
        assert_eq!(read_ply(&path).unwrap(), scene);
    }
    write_ply(&path, &Scene::default()).unwrap();
    assert_eq!(read_ply(&path).unwrap(), Scene::default());
}

#[test]
fn features_are_ordered_by_their_number() {
    let mut scene = random_scene(2, ShDegree::Zero, 1);
    scene.features = Some(numbered_features(2, 11));
    // The same columns declared the other way round, through names that are not taken yet. As
    // text, gaussian_feats_10 would come before gaussian_feats_2.
    let mut bytes = encoded(&scene);
    for i in 0..=10 {
        let (from, to) = (format!("float gaussian_feats_{i}\n"), format!("float f{}\n", 10 - i));
        bytes = replaced(&bytes, &from, &to);
    }
    for i in 0..=10 {
        let (from, to) = (format!("float f{i}\n"), format!("float gaussian_feats_{i}\n"));
        bytes = replaced(&bytes, &from, &to);
    }
    let features = parse_ply(&bytes).unwrap().features.unwrap();
    assert_eq!(features.values[..11], [10., 9., 8., 7., 6., 5., 4., 3., 2., 1., 0.]);
}

#[test]
fn a_missing_property_is_refused_by_name() {
    let bytes = encoded(&random_scene(1, ShDegree::One, 1));
    let names =
        "x y z opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3 f_dc_0 f_dc_1 f_dc_2";
    for name in names.split(' ') {
        let stranger = format!("property float {}\n", "q".repeat(name.len()));
        let bytes = replaced(&bytes, &format!("property float {name}\n"), &stranger);
        let error = error_of(&bytes);
        assert_eq!(error, format!("vertex property {name}: expected a declaration, found none"));
    }
}

#[test]
fn a_number_of_harmonics_between_two_degrees_is_refused() {
    for count in [1, 3, 8, 12, 44, 48, 72] {
        let mut file =
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float opacity\n".to_owned();
        for name in
            "x y z scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3 f_dc_0 f_dc_1 f_dc_2".split(' ')
        {
            file += &format!("property float {name}\n");
        }
        (0..count).for_each(|i| file += &format!("property float f_rest_{i}\n"));
        let error = error_of(format!("{file}end_header\n").as_bytes());
        assert!(error.starts_with("f_rest_*: expected 0, 9, 24 or 45 properties"), "{error}");
        assert!(error.ends_with(&format!("found {count}")), "{error}");
    }
}

#[test]
fn a_point_cloud_is_refused_for_what_it_is() {
    let cloud = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                 property float z\nproperty uchar red\nend_header\n0 0 0 255\n";
    let error = error_of(cloud.as_bytes());
    assert!(error.starts_with("element vertex: expected Gaussian splats (opacity"), "{error}");
    assert!(error.ends_with("found only points (x y z red)"), "{error}");
}

#[test]
fn a_list_where_a_number_belongs_is_refused() {
    let bytes = encoded(&random_scene(1, ShDegree::Zero, 1));
    let list = "property list uchar float opacity";
    let error = error_of(&replaced(&bytes, "property float opacity", list));
    assert_eq!(error, "vertex property opacity: expected a number, found a list");
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let mut with_lists = b"ply\nformat binary_little_endian 1.0\nelement face 3\n\
        property list uint double w\n"
        .to_vec();
    let plain = encoded(&random_scene(40, ShDegree::Two, 1));
    let vertex = plain.windows(7).position(|w| w == b"element").unwrap();
    let body = plain.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    with_lists.extend_from_slice(&plain[vertex..body]);
    let with_lists_body = with_lists.len();
    for length in [2u32, 0, 5] {
        with_lists.extend(length.to_le_bytes());
        with_lists.resize(with_lists.len() + 8 * length as usize, 1);
    }
    with_lists.extend_from_slice(&plain[body..]);
    let mut compressed = Vec::new();
    encode_compressed_ply(&random_scene(300, ShDegree::One, 2), &mut compressed).unwrap();
    let compressed_body = compressed.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;

    let mut rng = fastrand::Rng::with_seed(9);
    for (file, body) in
        [(plain, body), (with_lists, with_lists_body), (compressed, compressed_body)]
    {
        assert!(parse_ply(&file).is_ok());
        for cut in (0..body).chain((0..100).map(|_| rng.usize(body..file.len()))) {
            let error = error_of(&file[..cut]);
            assert!(error.contains(": expected "), "cut at {cut}: {error}");
        }
    }
}

#[test]
fn counts_beyond_the_file_are_refused_before_memory_is_taken() {
    let bytes = encoded(&random_scene(2, ShDegree::Zero, 1));
    for count in ["1000", "4294967296", "9223372036854775808", "18446744073709551615"] {
        for format in ["binary_little_endian", "binary_big_endian", "ascii"] {
            let hostile = format!("element vertex {count}");
            let bytes = replaced(&bytes, "element vertex 2", &hostile);
            let error = error_of(&replaced(&bytes, "binary_little_endian", format));
            assert!(error.contains("truncated"), "{count} {format}: {error}");
        }
    }
}

#[test]
fn a_hostile_element_without_properties_costs_nothing() {
    for format in ["binary_little_endian", "ascii"] {
        let hostile = "element void 18446744073709551615\nelement vertex 0";
        let bytes = replaced(&encoded(&Scene::default()), "element vertex 0", hostile);
        let bytes = replaced(&bytes, "binary_little_endian", format);
        assert!(parse_ply(&bytes).unwrap().is_empty());
    }
}

#[test]
fn a_folder_or_an_absent_file_is_a_one_line_error() {
    let folder = tempfile::tempdir().unwrap();
    let error = read_ply(folder.path()).unwrap_err().to_string();
    assert!(error.contains("found a folder"), "{error}");
    let error = read_ply(&folder.path().join("none.ply")).unwrap_err().to_string();
    assert!(error.contains("none.ply: "), "{error}");
}

/// A geo-referenced capture: the same scene far away, in double precision.
#[test]
fn double_precision_coordinates_near_a_million_are_kept_on_reading_and_writing() {
    let near = random_scene(200, ShDegree::One, 5);
    let mut far = near.clone();
    far.origin = DVec3::new(432_100.0, 5_812_345.0, 0.0);
    let bytes = encoded(&far);
    assert!(String::from_utf8_lossy(&bytes).contains("property double x"));
    let read = parse_ply(&bytes).unwrap();
    assert_eq!(read.origin.z, 0.0);
    for (i, (n, r)) in near.splats.positions.iter().zip(&read.splats.positions).enumerate() {
        for axis in 0..3 {
            let world = f64::from(n[axis]) + far.origin[axis];
            let error = f64::from(r[axis]) + read.origin[axis] - world;
            // Written with one rounding to f64 at 5.8e6 (half of 2⁻³⁰), read with one to f32 at
            // less than 16 from the origin (half of 2⁻²⁰).
            let bound = f64::exp2(-31.0) + f64::exp2(-21.0);
            assert!(error.abs() <= bound, "splat {i} axis {axis}: {error}");
        }
    }
    // From then on nothing changes any more.
    assert_eq!(parse_ply(&encoded(&read)).unwrap(), read);
    assert_eq!(read.splats.sh_rest, near.splats.sh_rest);
}

#[test]
fn single_precision_coordinates_near_a_million_are_moved_without_loss() {
    let mut quantised = random_scene(100, ShDegree::Zero, 6);
    for p in &mut quantised.splats.positions {
        p[1] += 1e6;
    }
    let read = parse_ply(&encoded(&quantised)).unwrap();
    assert!((read.origin.y - 1e6).abs() <= 5.0 && read.origin.x == 0.0, "{}", read.origin);
    for (q, r) in quantised.splats.positions.iter().zip(&read.splats.positions) {
        assert_eq!(f64::from(r[1]) + read.origin.y, f64::from(q[1]));
    }
}

#[test]
fn a_compressed_scene_comes_back_within_its_quantisation() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.compressed.ply");
    for (degree, origin) in
        [(ShDegree::Zero, DVec3::ZERO), (ShDegree::Three, DVec3::new(0.0, 1e6, 0.0))]
    {
        let mut scene = random_scene(1000, degree, 7);
        scene.origin = origin;
        write_compressed_ply(&path, &scene).unwrap();
        let read = read_ply(&path).unwrap();
        read.validate().unwrap();
        assert_eq!((read.len(), read.splats.sh_degree), (1000, degree));
        for i in 0..1000 {
            assert_splat_is_close(&scene, &read, i);
        }
    }
}

fn assert_splat_is_close(scene: &Scene, read: &Scene, i: usize) {
    let (a, b) = (&scene.splats, &read.splats);
    let within = |what: &str, x: f64, y: f64, bound: f64| {
        assert!(
            (x - y).abs() <= bound,
            "splat {i} {what}: {x} and {y} differ by more than {bound}"
        );
    };
    for axis in 0..3 {
        let levels = if axis == 1 { 1023.0 } else { 2047.0 };
        // Half a level of a chunk as wide as the values can be (10, 9 and 1.7·2·C0 units; the
        // bounds are rounded outwards by up to 2⁻⁴ each near 1e6), and single precision.
        let slack = if scene.origin[axis] == 0.0 { 1e-5 } else { 0.125 / levels + 1e-5 };
        let world = |s: &Scene| f64::from(s.splats.positions[i][axis]) + s.origin[axis];
        within("position", world(scene), world(read), 10.0 / levels / 2.0 + slack);
        let scales = (f64::from(a.log_scales[i][axis]), f64::from(b.log_scales[i][axis]));
        within("log-scale", scales.0, scales.1, 9.0 / levels / 2.0 + 1e-5);
        let colors = (f64::from(a.sh_dc[i][axis]) * SH_C0, f64::from(b.sh_dc[i][axis]) * SH_C0);
        within("colour", colors.0, colors.1, 3.4 * SH_C0 / 255.0 / 2.0 + 1e-6);
    }
    let opacity = |logit: f32| sigmoid(f64::from(logit));
    within(
        "opacity",
        opacity(a.opacity_logits[i]),
        opacity(b.opacity_logits[i]),
        0.5 / 255.0 + 1e-6,
    );
    for (x, y) in a.sh_rest_of(i).iter().zip(b.sh_rest_of(i)) {
        // The middle of one of 256 intervals between −4 and 4.
        within("coefficient", f64::from(*x), f64::from(*y), 4.0 / 256.0 + 1e-6);
    }
    let norm = a.rotations[i].iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    let cosine: f64 =
        (0..4).map(|k| f64::from(a.rotations[i][k]) * f64::from(b.rotations[i][k])).sum::<f64>()
            / norm;
    // See `ply::compressed::pack`: three components err by up to √2/2046 each, the fourth follows.
    within("rotation", 1.0, cosine.abs(), 6.0 * (2f64.sqrt() / 2046.0).powi(2) + 1e-6);
}

#[test]
fn values_that_are_not_finite_can_be_compressed() {
    let mut scene = random_scene(3, ShDegree::One, 8);
    scene.splats.positions[0] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    scene.splats.log_scales[1] = [f32::NEG_INFINITY, f32::NAN, f32::INFINITY];
    scene.splats.opacity_logits = vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    scene.splats.sh_dc[2] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    scene.splats.sh_rest[..3].copy_from_slice(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
    let mut bytes = Vec::new();
    encode_compressed_ply(&scene, &mut bytes).unwrap();
    let read = parse_ply(&bytes).unwrap().splats;
    assert!(read.positions.iter().chain(&read.log_scales).flatten().all(|v| v.is_finite()));
    assert!(read.sh_dc.iter().flatten().chain(&read.opacity_logits).all(|v| v.is_finite()));
    assert_eq!(read.sh_rest[..3], [-4.0, 4.0, -4.0]);
}

#[test]
fn a_compressed_file_whose_elements_do_not_match_is_refused() {
    let mut bytes = Vec::new();
    encode_compressed_ply(&random_scene(300, ShDegree::One, 2), &mut bytes).unwrap();
    let error_after = |from: &str, to: &str| error_of(&replaced(&bytes, from, to));
    let error = error_after("element chunk 2", "element chunk 1");
    assert_eq!(error, "element chunk: expected 2 for 300 splats, found 1");
    let error = error_after("element sh 300", "element sh 299");
    assert_eq!(error, "element sh: expected 300 rows, found 299");
    let error = error_after("uint packed_color", "float packed_color");
    assert_eq!(error, "vertex property packed_color: expected UInt, found Float");
    let error = error_after("float max_scale_y", "float max_scale_w");
    assert_eq!(error, "chunk property max_scale_y: expected Float, found none");
    let error = error_after("uchar f_rest_8", "uchar f_rest_9");
    assert_eq!(error, "sh property f_rest_8: expected UChar, found none");
    let error = error_after("little_endian", "big_endian");
    assert!(error.starts_with("format: expected binary_little_endian"), "{error}");
}

#[test]
fn an_older_compressed_file_without_colour_bounds_spans_zero_to_one() {
    let mut file = b"ply\nformat binary_little_endian 1.0\nelement chunk 1\n".to_vec();
    for name in ["x", "y", "z", "scale_x", "scale_y", "scale_z"] {
        file.extend(format!("property float min_{name}\nproperty float max_{name}\n").bytes());
    }
    file.extend(b"element vertex 1\n");
    for name in ["position", "rotation", "scale", "color"] {
        file.extend(format!("property uint packed_{name}\n").bytes());
    }
    file.extend(b"end_header\n");
    [-1.0f32, 3.0].repeat(6).iter().for_each(|bound| file.extend(bound.to_le_bytes()));
    // Position at the upper ends, scale at the lower; the identity; red 255, green 0, blue 51.
    for packed in [u32::MAX, 512 << 20 | 512 << 10 | 512, 0, 0xff00_33ff] {
        file.extend(packed.to_le_bytes());
    }
    let splats = parse_ply(&file).unwrap().splats;
    assert_eq!(splats.positions[0], [3.0; 3]);
    assert_eq!(splats.log_scales[0], [-1.0; 3]);
    assert!((splats.rotations[0][0] - 1.0).abs() < 1e-6);
    let color = splats.sh_dc[0].map(|c| f64::from(c) * SH_C0 + 0.5);
    for (found, expected) in color.into_iter().zip([1.0, 0.0, 0.2]) {
        assert!((found - expected).abs() < 1e-7, "{color:?}");
    }
    assert!(splats.opacity_logits[0] > 6.0 && splats.opacity_logits[0].is_finite());
}
