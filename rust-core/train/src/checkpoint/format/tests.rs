//! Files that come back as they were, and files that are refused.

use fearless_simd::Level;
use trapeze_scene::deformation::RotationRule;

use super::*;
use crate::optimizer::{AdamConstants, adam_step_of_network};
use crate::parameters::tests::random_splats;
use crate::random::{Purpose, Stream, below};
use crate::schedule::NetworkStep;

fn checkpoint(degree: ShDegree) -> Checkpoint {
    let mut state = TrainingState::new(random_splats(1, 21, degree));
    state.first_moments = random_splats(2, 21, degree);
    state.second_moments = random_splats(3, 21, degree);
    state.step = 1234;
    Checkpoint {
        config: TrainingConfig { seed: u64::MAX, ..TrainingConfig::default() },
        progress: Progress {
            // Not a short decimal: survives only if JSON keeps every bit.
            rate_factor: 0.1 + 0.2,
            extent: std::f64::consts::PI / 3.0,
            dataset: "fern, 17 views".into(),
            ..Progress::default()
        },
        state,
    }
}

fn bytes_of(checkpoint: &Checkpoint) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    write_checkpoint(&path, checkpoint).unwrap();
    std::fs::read(&path).unwrap()
}

fn parse_bytes(bytes: &[u8]) -> Result<Checkpoint, ParseError> {
    parse(bytes, bytes.len() as u64)
}

#[test]
fn a_checkpoint_is_read_as_it_was_written_bit_for_bit() {
    for degree in ShDegree::ALL {
        let mut written = checkpoint(degree);
        written.state.splats.positions[3][1] = -0.0;
        written.state.splats.positions[3][2] = f32::from_bits(1);
        let read = parse_bytes(&bytes_of(&written)).unwrap();
        assert_eq!(read, written);
        assert_eq!(read.state.splats.positions[3][1].to_bits(), (-0.0f32).to_bits());
    }
}

fn with_network() -> Checkpoint {
    let mut checkpoint = checkpoint(ShDegree::Zero);
    let mut trained = TrainedNetwork::standard(9);
    let step =
        NetworkStep { time_offset: 0.0, rate: 1e-3, adam: AdamConstants::default().at_step(1) };
    let gradients = network_parameters(&TrainedNetwork::standard(10).network);
    adam_step_of_network(Level::baseline(), &mut trained, &gradients, &step);
    checkpoint.state.network = Some(trained);
    let held = (0..19).map(|i| [i as f32, -0.5, 0.0, 1e-30, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    checkpoint.state.resting = Some(RestingSplats::new(vec![4, 20], held.collect()).unwrap());
    checkpoint
}

#[test]
fn a_network_comes_back_with_its_moments_bit_for_bit() {
    let written = with_network();
    let read = parse_bytes(&bytes_of(&written)).unwrap();
    assert_eq!(read, written);
    let trained = read.state.network.unwrap();
    assert!(trained.first_moments.iter().any(|&m| m != 0.0));
    let (bytes, without) = (bytes_of(&written), bytes_of(&checkpoint(ShDegree::Zero)));
    assert!((bytes.len() - without.len()) as u64 >= TrainedNetwork::bytes() - 1);
    for length in [bytes.len() - 1, bytes.len() / 2, without.len()] {
        let error = parse_bytes(&bytes[..length]).unwrap_err().to_string();
        assert!(error.starts_with("checkpoint: expected"), "{error}");
    }
    let mut damaged = bytes;
    let middle = damaged.len() / 2;
    damaged[middle] ^= 4;
    let error = parse_bytes(&damaged).unwrap_err().to_string();
    assert!(error.starts_with("checksum: "), "{error}");
}

#[test]
fn another_network_than_the_standard_one_is_not_written() {
    let mut checkpoint = with_network();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    if let Some(trained) = &mut checkpoint.state.network {
        trained.network.rotation_rule = RotationRule::AsTrained;
    }
    let error = write_checkpoint(&path, &checkpoint).unwrap_err().to_string();
    assert!(error.contains("deformation network") && !path.exists(), "{error}");
}

#[test]
fn a_file_of_the_first_version_is_still_read() {
    let written = checkpoint(ShDegree::Two);
    let bytes = bytes_of(&written);
    let header_length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let header = std::str::from_utf8(&bytes[16..16 + header_length]).unwrap();
    // The first version's header had neither of these.
    let header = header.replace("\"network\":false,", "").replace("\"deformation\":null,", "");
    let mut first = MAGIC.to_vec();
    first.extend(1u32.to_le_bytes());
    first.extend((header.len() as u32).to_le_bytes());
    first.extend(header.bytes());
    first.extend(&bytes[16 + header_length..bytes.len() - 4]);
    let mut hasher = Hasher::new();
    hasher.update(&first);
    first.extend(hasher.finalize().to_le_bytes());
    assert!(first.len() < bytes.len());
    assert_eq!(parse_bytes(&first).unwrap(), written);
}

#[test]
fn every_truncation_is_refused_in_one_line() {
    let bytes = bytes_of(&checkpoint(ShDegree::Zero));
    for length in 0..bytes.len() {
        let error = parse_bytes(&bytes[..length]).unwrap_err().to_string();
        assert!(error.contains("expected") && !error.contains('\n'), "{length}: {error}");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    let error = parse_bytes(&longer).unwrap_err().to_string();
    assert!(error.starts_with("length: "), "{error}");
}

#[test]
fn two_thousand_damaged_files_are_all_refused() {
    let bytes = bytes_of(&checkpoint(ShDegree::One));
    let stream = Stream::new(11, Purpose::Initialisation, 0);
    for trial in 0..2500 {
        let mut damaged = bytes.clone();
        let [count, ..] = stream.words(trial);
        for i in 0..=below(count, 4) {
            let [place, bit, kind, value] = stream.more_words(trial, i + 1);
            let place = below(place, damaged.len() as u32) as usize;
            match kind % 4 {
                0 => damaged[place] ^= 1 << (bit % 8),
                1 => damaged[place] = value as u8,
                2 => drop(damaged.remove(place)),
                _ => damaged.insert(place, value as u8),
            }
        }
        if damaged == bytes {
            continue;
        }
        let error = parse_bytes(&damaged).unwrap_err().to_string();
        assert!(!error.contains('\n') && error.len() < 400, "{error}");
    }
}

#[test]
fn hostile_counts_are_refused_before_anything_is_allocated() {
    for splats in [1u64 << 31, (1 << 32) - 1, 1 << 32, 1 << 63] {
        let header = serde_json::to_string(&Header {
            step: 0,
            splats: 777_777,
            sh_degree: 3,
            network: true,
            moving: Some(0),
            config: TrainingConfig::default(),
            progress: Progress::default(),
        })
        .unwrap()
        .replace("777777", &splats.to_string());
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(header.bytes());
        assert!(parse_bytes(&bytes).is_err());
        for length in [u32::MAX, LONGEST_HEADER + 1] {
            bytes[12..16].copy_from_slice(&length.to_le_bytes());
            let error = parse_bytes(&bytes).unwrap_err().to_string();
            assert!(error.starts_with("header length: "), "{error}");
        }
    }
}

#[test]
fn other_files_and_versions_are_refused_by_field() {
    let mut bytes = bytes_of(&checkpoint(ShDegree::Zero));
    bytes[8] = 9;
    let error = parse_bytes(&bytes).unwrap_err().to_string();
    assert_eq!(error, "version: expected 1 to 3, found 9");
    let error = parse_bytes(b"ply\nformat ascii 1.0\n").unwrap_err().to_string();
    assert!(error.starts_with("magic: expected \"TRPZCKPT\""), "{error}");
    let folder = tempfile::tempdir().unwrap();
    assert!(read_checkpoint(folder.path()).is_err());
}

#[test]
fn splats_that_rest_and_are_not_there_are_refused() {
    let written = with_network();
    let header_of = |moving: u32| Header {
        step: 0,
        splats: 21,
        sh_degree: 0,
        network: true,
        moving: Some(moving),
        config: written.config.clone(),
        progress: Progress::default(),
    };
    let header = serde_json::to_string(&header_of(22)).unwrap();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header.bytes());
    let error = parse_bytes(&bytes).unwrap_err().to_string();
    assert_eq!(error, "moving: expected at most 21 splats, found 22");
    // The indices are the first of what is behind the network, the checksum is the last.
    let mut bytes = bytes_of(&written);
    let first = bytes.len() - 4 - 40 * 19 - 4 * 2;
    bytes[first..first + 4].copy_from_slice(&20u32.to_le_bytes());
    let end = bytes.len() - 4;
    let checksum = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    let error = parse_bytes(&bytes).unwrap_err().to_string();
    assert!(error.starts_with("moving: expected ascending indices"), "{error}");
}
