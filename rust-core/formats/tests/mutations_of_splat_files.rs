//! Broken PLY, compressed PLY and `.splat` files: a scene or a one-line error, nothing else.

mod scenes;
mod support;

use scenes::{numbered_features, random_scene};
use support::mutate_and_parse;
use trapeze_formats::ply::{encode_compressed_ply, encode_ply, parse_ply};
use trapeze_formats::splat_file::{parse_splat_file, write_splat_file};
use trapeze_scene::{Scene, ShDegree};

const RUNS: usize = 3000;

fn plain(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_ply(scene, &mut bytes).unwrap();
    bytes
}

fn compressed(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_compressed_ply(scene, &mut bytes).unwrap();
    bytes
}

/// Two splats in text, between elements with lists.
fn text() -> Vec<u8> {
    let mut file = "ply\nformat ascii 1.0\ncomment text\nelement face 2\n\
                    property list uchar int vertex_indices\nelement vertex 2\n"
        .to_owned();
    let names =
        "x y z opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3 f_dc_0 f_dc_1 f_dc_2";
    for name in names.split(' ') {
        file += &format!("property double {name}\n");
    }
    file += "property list ushort float extra\nelement edge 1\nproperty int a\nend_header\n";
    file += "3 0 1 2\n0\n";
    file += "1.5 -2 3e-1 nan 0 0 0 1 0 0 0 .5 .5 .5 2 1 1\n";
    file += "1.5 -2 3e-1 inf 0 0 0 1 0 0 0 .5 .5 .5 0\n7\n";
    file.into_bytes()
}

/// The same elements in binary, big-endian.
fn big_endian_with_lists() -> Vec<u8> {
    let header = String::from_utf8(text()).unwrap().replace("ascii", "binary_big_endian");
    let mut file = header.as_bytes()[..header.find("end_header\n").unwrap() + 11].to_vec();
    file.push(3);
    [0i32, 1, 2].iter().for_each(|i| file.extend(i.to_be_bytes()));
    file.push(0);
    for row in 0..2u16 {
        (0..14).for_each(|i| file.extend((f64::from(i) * 0.5).to_be_bytes()));
        file.extend(row.to_be_bytes());
        (0..row).for_each(|_| file.extend(1.0f32.to_be_bytes()));
    }
    file.extend(7i32.to_be_bytes());
    file
}

#[test]
fn mutated_ply_files_are_scenes_or_errors() {
    let mut with_features = random_scene(5, ShDegree::One, 1);
    with_features.features = Some(numbered_features(5, 3));
    let mut far = random_scene(4, ShDegree::Zero, 2);
    far.origin.x = 1e6;
    let corpus = [
        plain(&with_features),
        plain(&random_scene(3, ShDegree::Three, 3)),
        plain(&far),
        plain(&Scene::default()),
        text(),
        big_endian_with_lists(),
    ];
    mutate_and_parse("ply", &corpus, RUNS, parse_ply);
}

#[test]
fn mutated_compressed_ply_files_are_scenes_or_errors() {
    let corpus = [
        compressed(&random_scene(300, ShDegree::Zero, 4)),
        compressed(&random_scene(7, ShDegree::Two, 5)),
        compressed(&Scene::default()),
    ];
    mutate_and_parse("compressed_ply", &corpus, RUNS, parse_ply);
}

#[test]
fn mutated_splat_files_are_scenes_or_errors() {
    let path = tempfile::NamedTempFile::new().unwrap();
    write_splat_file(path.path(), &random_scene(9, ShDegree::Zero, 6)).unwrap();
    let corpus = [std::fs::read(path.path()).unwrap(), vec![0xff; 64], Vec::new()];
    mutate_and_parse("splat_file", &corpus, RUNS, parse_splat_file);
}
