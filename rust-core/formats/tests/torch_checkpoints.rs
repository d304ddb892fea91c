//! PyTorch checkpoints: the ones that exist are read, and a pickle can do nothing but describe
//! tensors.

#[path = "support/checkpoint.rs"]
mod checkpoint;

use std::path::PathBuf;

use checkpoint::{
    View, checkpoint as archive, float_tensor, floats, global, integer, state_dict, text,
    tiny_clusters, tiny_network, tuple, zip_of,
};
use trapeze_formats::{parse_clusters_pt, parse_deform_pth, read_deform_pth, read_weights_bin};
use trapeze_scene::ArchitectureError;
use zip::CompressionMethod;

/// The folder of test data, or a loud skip.
fn data(path: &str) -> Option<PathBuf> {
    let found = std::env::var_os("TRAPEZE_DATA").map(|root| PathBuf::from(root).join(path));
    let found = found.filter(|path| path.exists());
    if found.is_none() {
        eprintln!("SKIPPED: {path} needs TRAPEZE_DATA");
    }
    found
}

fn refused(bytes: &[u8]) -> String {
    let message = parse_deform_pth(bytes).expect_err("hostile").to_string();
    assert!(message.len() < 400 && !message.contains('\n'), "{message}");
    message
}

/// The message for a pickle without storages.
fn refused_pickle(pickle: &[u8]) -> String {
    refused(&archive(pickle, &[]))
}

#[test]
fn the_sample_checkpoint_equals_the_sample_weights_bit_for_bit() {
    let Some(folder) = data("sample-scene") else { return };
    let from_torch = read_deform_pth(&folder.join("deform.pth")).unwrap();
    let from_bin = read_weights_bin(&folder.join("weights.bin")).unwrap();
    assert!(from_torch.is_standard());
    for (a, b) in from_torch.layers().zip(from_bin.layers()) {
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!((a.inputs, a.outputs), (b.inputs, b.outputs));
        assert_eq!(bits(&a.weight), bits(&b.weight));
        assert_eq!(bits(&a.bias), bits(&b.bias));
    }
}

#[test]
fn a_network_with_a_narrower_encoding_is_read_by_its_shapes() {
    let Some(path) = data("deform-variants/width42.pth") else { return };
    let network = read_deform_pth(&path).unwrap();
    assert_eq!(network.input_width(), 42);
    assert_eq!(network.position_encoding.octaves, 3);
    assert_eq!(network.time_encoding.octaves, 10);
    assert!(!network.is_standard());
    // Evidence in the weights that the last 21 inputs are the time with 10 octaves: training
    // treats the sine and the cosine of one octave alike, so their columns have like norms. Layer
    // 5, which sees the input again, shows it over a range of 4 from octave to octave.
    let skip = &network.hidden[5];
    let norm = |column: usize| {
        let square = |row: &[f32]| f64::from(row[column]).powi(2);
        skip.weight.chunks_exact(skip.inputs).map(square).sum::<f64>().sqrt()
    };
    for octave in 0..10 {
        let (sine, cosine) = (norm(22 + 2 * octave), norm(23 + 2 * octave));
        assert!((sine / cosine).ln().abs() < 0.15, "octave {octave}: {sine} and {cosine}");
    }
    assert!(norm(34) / norm(40) > 4.0);
}

#[test]
fn a_network_of_another_kind_is_refused_by_a_tensor_name() {
    let Some(path) = data("deform-variants/learned-encoder-unsupported.pth") else { return };
    let message = read_deform_pth(&path).unwrap_err().to_string();
    assert!(message.contains("not part of a known architecture"), "{message}");
    assert!(message.contains("deformation_network.0.bias"), "{message}");
}

#[test]
fn the_smallest_network_is_read_stored_or_compressed() {
    let network = parse_deform_pth(&tiny_network()).unwrap();
    assert_eq!((network.width(), network.input_width(), network.skip_after), (2, 24, 1));
    assert_eq!(network.hidden[2].weight[51], 51.0 * 0.25);

    let entries = [("a", float_tensor("0", &[2]))];
    let members = [("x/data.pkl", &state_dict(&entries)[..]), ("x/data/0", &floats(&[1.0, 2.0]))];
    let packed = zip_of(&members, CompressionMethod::Deflated);
    let error = parse_deform_pth(&packed).unwrap_err().to_string();
    let expected = ArchitectureError::Unknown { name: "a".into() }.to_string();
    assert_eq!(error, expected, "the tensor itself was read");
}

#[test]
fn clusters_are_read_with_float_and_byte_colours() {
    let clusters = parse_clusters_pt(&tiny_clusters()).unwrap();
    assert_eq!(clusters.labels, [0, 1, 0, 0]);
    assert_eq!((clusters.table[0].id, clusters.table[1].id), (3, 8));
    assert_eq!(clusters.table[1].color, [1.0, 0.0, 0.5]);

    let view = |storage, key, shape| View {
        storage,
        key,
        count: 3,
        offset: 0,
        shape,
        strides: &[3, 1][2 - <[i64]>::len(shape)..],
    };
    let id = View { count: 1, ..view("IntStorage", "0", &[1]) };
    let entries = [("id", id.pickle()), ("rgb", view("ByteStorage", "1", &[1, 3]).pickle())];
    let bytes = archive(&state_dict(&entries), &[("0", &[5, 0, 0, 0]), ("1", &[0, 51, 255])]);
    assert_eq!(parse_clusters_pt(&bytes).unwrap().table[0].color, [0.0, 0.2, 1.0]);
}

#[test]
fn clusters_of_another_shape_type_or_range_are_refused_by_entry() {
    let refused = |entries: &[(&str, Vec<u8>)], ids: &[u8]| {
        let bytes = archive(&state_dict(entries), &[("0", ids), ("1", &floats(&[0.0; 3]))]);
        parse_clusters_pt(&bytes).unwrap_err().to_string()
    };
    let id =
        View { storage: "IntStorage", key: "0", count: 1, offset: 0, shape: &[1], strides: &[1] };
    let rgb = float_tensor("1", &[1, 3]);
    let cases = [
        (vec![("rgb", rgb.clone())], "id: expected a tensor, found nothing"),
        (vec![("id", id.pickle())], "rgb: expected a tensor, found nothing"),
        (vec![("id", integer(3)), ("rgb", rgb.clone())], "id: expected a tensor, found an integer"),
        (vec![("id", float_tensor("1", &[3]))], "id: expected integers, found F32"),
        (vec![("id", float_tensor("1", &[1, 3]))], "id: expected shape [n], found [1, 3]"),
        (
            vec![("id", id.pickle()), ("rgb", float_tensor("1", &[3]))],
            "rgb: expected shape [1, 3], found [3]",
        ),
    ];
    for (entries, expected) in cases {
        assert_eq!(refused(&entries, &[1, 0, 0, 0]), expected);
    }
    let negative = refused(&[("id", id.pickle()), ("rgb", rgb)], &[255; 4]);
    assert_eq!(negative, "id: expected numbers from 0 to 2^32 - 1, found -1");
}

#[test]
fn a_call_of_another_function_is_refused_by_its_name() {
    for (module, name) in
        [("os", "system"), ("posix", "system"), ("builtins", "eval"), ("torch", "load")]
    {
        let call = [global(module, name), tuple(&[text("touch /tmp/x")]), b"R.".to_vec()].concat();
        let message = refused_pickle(&[&[0x80, 2][..], &call].concat());
        assert!(message.contains(&format!("{module}.{name}")), "{message}");
        assert!(message.contains("global"), "{message}");
        // The same through STACK_GLOBAL of protocol 4.
        let call = [vec![0x80, 4], text(module), text(name), vec![0x93]].concat();
        assert!(refused_pickle(&call).contains(&format!("{module}.{name}")));
    }
}

#[test]
fn opcodes_that_make_other_objects_are_refused_by_their_name() {
    for (opcode, name) in [
        (&b"i"[..], "INST"),
        (b"o", "OBJ"),
        (b"\x81", "NEWOBJ"),
        (b"\x92", "NEWOBJ_EX"),
        (b"\x82", "EXT1"),
        (b"P0\n", "PERSID"),
        (b"\x8b\xff\xff\xff\x7f", "LONG4"),
        (b"\xff", "no opcode"),
    ] {
        let message = refused_pickle(&[&[0x80, 2][..], opcode].concat());
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn calls_with_other_arguments_are_refused() {
    let ordered_dict = global("collections", "OrderedDict");
    for pickle in [
        [&ordered_dict[..], b"(K\x01tR."].concat(),
        [&ordered_dict[..], b"K\x01R."].concat(),
        [&global("torch._utils", "_rebuild_tensor_v2")[..], b")R."].concat(),
        [&global("torch._utils", "_rebuild_parameter")[..], b"K\x01\x85R."].concat(),
        [&global("torch", "FloatStorage")[..], b")R."].concat(),
        b"K\x01)R.".to_vec(),
        b"K\x01Q.".to_vec(),
        b"K\x01K\x02b.".to_vec(),
        b"K\x01K\x02a.".to_vec(),
        b"}K\x01K\x02K\x03s.".to_vec(),
        b"}(K\x01u.".to_vec(),
        b"t.".to_vec(),
        b"(0.".to_vec(),
        b"R.".to_vec(),
        b"\x85.".to_vec(),
        b"h\x07.".to_vec(),
        b"\x80\x09.".to_vec(),
        b"K\x01\x8a\x09".to_vec(),
        b"X\xff\xff\xff\xff".to_vec(),
        b"cno newline".to_vec(),
        b"]".to_vec(),
        b"].".to_vec(),
        b"}K\x01K\x02s.".to_vec(),
        b"}. more".to_vec(),
    ] {
        refused_pickle(&pickle);
    }
}

#[test]
fn nesting_as_deep_as_the_file_is_long_is_survived() {
    // (((( … )))) as tuples in tuples, 200 000 levels, then as lists.
    let tuples = [&b")"[..], &b"\x85".repeat(200_000), b"."].concat();
    assert!(refused_pickle(&tuples).contains("expected a dictionary of tensors, found a tuple"));
    let lists = [&b"]".repeat(200_000)[..], &b"a".repeat(199_999), b"."].concat();
    assert!(refused_pickle(&lists).contains("found a list"));
    let marks = b"(".repeat(200_000);
    assert!(refused_pickle(&marks).contains("expected 1 bytes, found 0"));
}

#[test]
fn lists_and_dictionaries_that_contain_themselves_are_survived() {
    let list = b"]q\x00h\x00a.";
    assert!(refused_pickle(list).contains("found a list"));
    let dict = [&b"}q\x00"[..], &text("self"), b"h\x00s."].concat();
    let message = refused_pickle(&dict);
    assert!(message.contains("self: expected a tensor, found a dictionary"), "{message}");
}

#[test]
fn memo_bombs_stay_as_small_as_their_file() {
    // l1 = [l0] * 10, l2 = [l1] * 10, …: 10^50 mentions.
    let mut pickle = b"]q\x00".to_vec();
    for level in 0..50_u8 {
        pickle.extend(b"](");
        pickle.extend([b'h', level].repeat(10));
        pickle.extend([b'e', b'q', level + 1]);
    }
    pickle.push(b'.');
    assert!(refused_pickle(&pickle).contains("found a list"));

    // The highest slot of the memo must not make a table of that size.
    assert!(refused_pickle(b"]r\xff\xff\xff\xffj\xff\xff\xff\xff.").contains("found a list"));

    // A long key that is mentioned very often.
    let mut pickle = [b"}".to_vec(), text(&"k".repeat(100_000)), b"q\x000".to_vec()].concat();
    pickle.push(b'(');
    pickle.extend(b"h\x00N".repeat(100_000));
    pickle.extend(b"u.");
    assert!(refused_pickle(&pickle).contains("at most 256 printable characters"));

    // A long tuple that is used as the shape of very many tensors.
    let view = View {
        storage: "FloatStorage",
        key: "0",
        count: 1,
        offset: 0,
        shape: &[1; 20_000],
        strides: &[1; 20_000],
    };
    assert!(refused_pickle(&state_dict(&[("a", view.pickle())])).contains("_rebuild_tensor_v2"));
}

#[test]
fn a_pickle_or_storage_out_of_proportion_is_refused_before_it_is_read() {
    let pickle = vec![b'N'; 2 << 20];
    assert!(refused_pickle(&pickle).contains("data.pkl: expected at most 1048576 decoded bytes"));

    let zeros = vec![0; 80 << 20];
    let entries = [("a", float_tensor("0", &[20 << 20]))];
    let members = [("x/data.pkl", &state_dict(&entries)[..]), ("x/data/0", &zeros)];
    let bomb = zip_of(&members, CompressionMethod::Deflated);
    assert!(bomb.len() < 100_000);
    let message = refused(&bomb);
    assert!(message.contains("zip member x/data/0: expected at most"), "{message}");

    // Many views of one storage: each is charged for the whole.
    let zeros = vec![0; 8 << 20];
    let views: Vec<(String, Vec<u8>)> =
        (0..100).map(|i| (format!("t{i}"), float_tensor("0", &[2 << 20]))).collect();
    let views: Vec<(&str, Vec<u8>)> =
        views.iter().map(|(name, view)| (name.as_str(), view.clone())).collect();
    let members = [("x/data.pkl", &state_dict(&views)[..]), ("x/data/0", &zeros)];
    let message = refused(&zip_of(&members, CompressionMethod::Deflated));
    assert!(message.contains("zip member x/data/0: expected at most"), "{message}");
}

#[test]
fn tensors_that_leave_their_storage_are_refused() {
    let tensor = |count, offset, shape: &[i64], strides: &[i64]| {
        let view = View { storage: "FloatStorage", key: "0", count, offset, shape, strides };
        refused(&archive(&state_dict(&[("linear.0.weight", view.pickle())]), &[("0", &[0; 16])]))
    };
    for (count, offset, shape, strides) in [
        (4, 1, &[4][..], &[1][..]),
        (4, i64::MAX, &[1], &[1]),
        (4, 0, &[2, 2], &[i64::MAX, 1]),
        (4, 0, &[i64::MAX, i64::MAX], &[1, 1]),
        (4, 0, &[1 << 40], &[0]),
        (4, -1, &[1], &[1]),
    ] {
        let message = tensor(count, offset, shape, strides);
        assert!(message.starts_with("tensor: expected"), "{message}");
    }
    for count in [1, 5, 1 << 62, i64::MAX] {
        let message = tensor(count, 0, &[1], &[1]);
        assert!(message.starts_with("zip member archive/data/0: expected"), "{message}");
    }
    assert!(tensor(-1, 0, &[1], &[1]).contains("BINPERSID"));
}

#[test]
fn storages_that_are_missing_or_elsewhere_are_refused_by_member() {
    for key in ["7", "../../etc/passwd", "/etc/passwd", ""] {
        let entries = [("linear.0.weight", float_tensor(key, &[1]))];
        let message = refused_pickle(&state_dict(&entries));
        let expected = format!("zip member archive/data/{key}: expected a readable member");
        assert!(message.starts_with(&expected), "{message}");
    }
}

#[test]
fn other_containers_and_byte_orders_are_refused_by_name() {
    assert!(refused(b"").contains("expected a zip checkpoint"));
    let legacy = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.";
    assert!(refused(legacy).contains("a pickle of torch before 1.6"));
    let mut tar = vec![0; 512];
    tar[257..262].copy_from_slice(b"ustar");
    assert!(refused(&tar).contains("a tar archive"));
    assert!(refused(b"ply\nformat").contains("found bytes ply\\nform"));
    assert!(refused(&zip_of(&[], CompressionMethod::Stored)).starts_with("format: expected"));
    let other = zip_of(&[("a", b"b")], CompressionMethod::Stored);
    assert!(refused(&other).contains("a member NAME/data.pkl, found none"));

    let pickle = state_dict(&[]);
    let members = [("x/data.pkl", &pickle[..]), ("x/byteorder", b"big")];
    let big = zip_of(&members, CompressionMethod::Stored);
    assert_eq!(refused(&big), "byteorder: expected little, found big");
}

#[test]
fn integer_tensors_and_other_values_are_no_network() {
    let ids =
        View { storage: "LongStorage", key: "0", count: 1, offset: 0, shape: &[1], strides: &[1] };
    let bytes = archive(&state_dict(&[("linear.0.weight", ids.pickle())]), &[("0", &[0; 8])]);
    assert_eq!(refused(&bytes), "linear.0.weight: expected a tensor of floats, found I64");
    let message = refused_pickle(&state_dict(&[("two\nlines", integer(3))]));
    assert!(message.contains("printable characters"), "{message}");
    let message = refused_pickle(&state_dict(&[("epoch", integer(3))]));
    assert_eq!(message, "epoch: expected a tensor, found an integer");
}
