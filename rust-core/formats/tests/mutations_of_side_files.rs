//! Broken files beside the splats: networks, clusters, masks, checkpoints, cameras and arrays. A
//! value or a one-line error, nothing else.

#[path = "support/checkpoint.rs"]
mod checkpoint;
mod support;

use std::io::Cursor;

use fastrand::Rng;
use support::mutate_and_parse;
use trapeze_formats::{
    ParseError, WEIGHTS_BIN_BYTES, parse_camera, parse_cluster_names, parse_clusters_bin,
    parse_clusters_pt, parse_deform_pth, parse_mask_bin, parse_mask_json, parse_npy, parse_npz,
    parse_views, parse_weights_bin,
};
use trapeze_scene::Clusters;
use zip::CompressionMethod;

const RUNS: usize = 3000;

/// Bytes at the start of a file that count as its header in the truncation tests.
const HEADER_BYTES: usize = 512;

/// A file that was cut short is refused, wherever it was cut.
fn refuses_truncation<T>(name: &str, good: &[u8], parse: impl Fn(&[u8]) -> Result<T, ParseError>) {
    assert!(parse(good).is_ok(), "{name}: the whole file parses");
    let mut rng = Rng::with_seed(12);
    let in_header = 0..good.len().min(HEADER_BYTES);
    let in_body = (0..100).map(|_| rng.usize(..good.len()));
    for length in in_header.chain(in_body) {
        let Err(error) = parse(&good[..length]) else { panic!("{name}: cut at {length} parses") };
        let message = error.to_string();
        assert!(!message.is_empty() && !message.contains('\n'), "{name}, {length}: {message}");
    }
}

fn check<T>(name: &str, corpus: &[Vec<u8>], parse: impl Fn(&[u8]) -> Result<T, ParseError>) {
    for good in corpus {
        refuses_truncation(name, good, &parse);
    }
    mutate_and_parse(name, corpus, RUNS, parse);
}

#[test]
fn weights() {
    let bytes = (0..WEIGHTS_BIN_BYTES / 4).flat_map(|i| (i as f32).to_le_bytes()).collect();
    check("weights.bin", &[bytes], parse_weights_bin);
}

#[test]
fn clusters() {
    let file = |ids: &[u32]| {
        let header = [*b"CLST", 1_u32.to_le_bytes(), (ids.len() as u32).to_le_bytes()].concat();
        let colors = vec![0.5_f32; ids.len() * 3];
        [header, ids.iter().flat_map(|id| id.to_le_bytes()).collect(), checkpoint::floats(&colors)]
            .concat()
    };
    let corpus = [file(&[1, 2, 2, 700]), file(&(0..100).collect::<Vec<_>>())];
    check("clusters.bin", &corpus, parse_clusters_bin);
}

#[test]
fn cluster_names() {
    let json = br#"{"1": "plate", "2": "monkey \u00e9 head", "4294967295": ""}"#;
    check("cluster-names.json", &[json.to_vec()], parse_cluster_names);
}

#[test]
fn masks() {
    let clusters = Clusters::from_ids(&[4, 4, 9, 9, 9, 4], &[[0.0; 3]; 6]).unwrap();
    let per_splat = checkpoint::floats(&[0.0, 0.5, 1e-9, f32::INFINITY, f32::NAN, 3.0]);
    let per_cluster = checkpoint::floats(&[0.0, 1.0]);
    let parse = |bytes: &[u8]| parse_mask_bin(bytes, 6, Some(&clusters));
    // Cut at 8 bytes, the values of the splats are those of two clusters.
    check("mask.bin", std::slice::from_ref(&per_cluster), parse);
    mutate_and_parse("mask.bin per splat", &[per_splat, per_cluster], RUNS, parse);

    let ours = br#"{"recommended_percentile": 45.0, "measure": "position"}"#;
    check("mask.json", &[ours.to_vec(), b"{}".to_vec()], parse_mask_json);
}

#[test]
fn checkpoints() {
    check("deform.pth", &[checkpoint::tiny_network()], parse_deform_pth);
    check("clusters.pt", &[checkpoint::tiny_clusters()], parse_clusters_pt);
}

/// The checksum of a zip member would refuse nearly every change of the pickle before the machine
/// sees it, so here the pickle is packed after it was changed.
#[test]
fn pickles() {
    let pickle = |checkpoint: &[u8]| {
        let mut archive = zip::ZipArchive::new(Cursor::new(checkpoint)).unwrap();
        let mut bytes = Vec::new();
        std::io::copy(&mut archive.by_name("archive/data.pkl").unwrap(), &mut bytes).unwrap();
        bytes
    };
    let network = pickle(&checkpoint::tiny_network());
    let clusters = pickle(&checkpoint::tiny_clusters());
    let ids: Vec<u8> = [3_i64, 8, 3, 3].iter().flat_map(|id| id.to_le_bytes()).collect();
    let colors = checkpoint::floats(&[0.5; 12]);
    let pack = |bytes: &[u8]| checkpoint::checkpoint(bytes, &[("0", &ids), ("1", &colors)]);
    check("clusters pickle", std::slice::from_ref(&clusters), |bytes| {
        parse_clusters_pt(&pack(bytes))
    });
    // Both kinds in one corpus, so that pieces of one end up in the other.
    mutate_and_parse("pickle", &[clusters, network], 2 * RUNS, |bytes| {
        match parse_clusters_pt(&pack(bytes)) {
            // The longer pickle is of a network, which is no cluster file but a good corpus entry.
            Err(error) if error.to_string().starts_with("id: expected a tensor, found nothing") => {
                Ok(())
            }
            other => other.map(drop),
        }
    });
}

#[test]
fn cameras() {
    let camera = br#"{"width": 640, "height": 480, "fx": 5e2, "fy": 500.25, "cx": 320, "cy": 240,
        "world_to_camera": [[1, 0, 0, 0.5], [0, 1, 0, -2], [0, 0, 1, 1e3], [0, 0, 0, 1]]}"#;
    let views =
        [b"[{\"camera\": ", &camera[..], b", \"time\": 0.5, \"image\": \"a.png\"}]"].concat();
    check("camera.json", &[camera.to_vec()], parse_camera);
    check("views.json", &[views, camera.to_vec()], parse_views);
}

fn npy(shape: &str, count: usize, fortran_order: bool) -> Vec<u8> {
    let order = if fortran_order { "True" } else { "False" };
    let header = format!("{{'descr': '<f4', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    let values = checkpoint::floats(&vec![0.5; count]);
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &values].concat()
}

#[test]
fn arrays() {
    let corpus = [npy("(4, 5, 4)", 80, false), npy("(30,)", 30, false), npy("(2, 3)", 6, true)];
    check("npy", &corpus, parse_npy);
    let members = [("a.npy", &corpus[0][..]), ("b.npy", &corpus[1])];
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        check("npz", &[checkpoint::zip_of(&members, method)], parse_npz);
    }
}
