//! Assembles PyTorch checkpoints, well-formed and hostile ones, byte by byte.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// `GLOBAL module name`.
pub(crate) fn global(module: &str, name: &str) -> Vec<u8> {
    format!("c{module}\n{name}\n").into_bytes()
}

/// `BINUNICODE text`.
pub(crate) fn text(text: &str) -> Vec<u8> {
    [b"X", &(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// `LONG1 number`, 8 bytes long.
pub(crate) fn integer(number: i64) -> Vec<u8> {
    [&[0x8a, 8][..], &number.to_le_bytes()].concat()
}

/// `MARK items TUPLE`.
pub(crate) fn tuple(items: &[Vec<u8>]) -> Vec<u8> {
    [b"(", &items.concat()[..], b"t"].concat()
}

/// A tensor's place in its storage.
pub(crate) struct View<'a> {
    pub(crate) storage: &'a str,
    pub(crate) key: &'a str,
    pub(crate) count: i64,
    pub(crate) offset: i64,
    pub(crate) shape: &'a [i64],
    pub(crate) strides: &'a [i64],
}

impl View<'_> {
    /// `_rebuild_tensor_v2(storage, offset, shape, strides, False, OrderedDict())`.
    pub(crate) fn pickle(&self) -> Vec<u8> {
        let id = [
            text("storage"),
            global("torch", self.storage),
            text(self.key),
            text("cuda:0"),
            integer(self.count),
        ];
        let integers =
            |numbers: &[i64]| tuple(&numbers.iter().map(|&n| integer(n)).collect::<Vec<_>>());
        let arguments = [
            [tuple(&id), b"Q".to_vec()].concat(),
            integer(self.offset),
            integers(self.shape),
            integers(self.strides),
            vec![0x89],
            [global("collections", "OrderedDict"), b")R".to_vec()].concat(),
        ];
        [global("torch._utils", "_rebuild_tensor_v2"), tuple(&arguments), b"R".to_vec()].concat()
    }
}

/// A row-major f32 view of a whole storage.
pub(crate) fn float_tensor(key: &str, shape: &[i64]) -> Vec<u8> {
    let strides: Vec<i64> = (0..shape.len()).map(|i| shape[i + 1..].iter().product()).collect();
    let count = shape.iter().product();
    View { storage: "FloatStorage", key, count, offset: 0, shape, strides: &strides }.pickle()
}

/// `OrderedDict` of the entries, as `torch.save(module.state_dict())` pickles it.
pub(crate) fn state_dict(entries: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let items: Vec<u8> =
        entries.iter().flat_map(|(name, value)| [text(name), value.clone()].concat()).collect();
    let metadata = [b"}".to_vec(), text("_metadata"), b"}sb".to_vec()].concat();
    [&[0x80, 2][..], &global("collections", "OrderedDict"), b")R(", &items, b"u", &metadata, b"."]
        .concat()
}

/// A zip archive of the given members.
pub(crate) fn zip_of(members: &[(&str, &[u8])], method: CompressionMethod) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in members {
        let options = SimpleFileOptions::default().compression_method(method);
        writer.start_file(*name, options).expect("in memory");
        writer.write_all(content).expect("in memory");
    }
    writer.finish().expect("in memory").into_inner()
}

/// The archive that `torch.save` makes of a pickle and its storages.
pub(crate) fn checkpoint(pickle: &[u8], storages: &[(&str, &[u8])]) -> Vec<u8> {
    let names: Vec<String> =
        storages.iter().map(|(key, _)| format!("archive/data/{key}")).collect();
    let mut members = vec![("archive/data.pkl", pickle), ("archive/byteorder", &b"little"[..])];
    members.extend(names.iter().zip(storages).map(|(name, &(_, data))| (name.as_str(), data)));
    members.push(("archive/version", b"3\n"));
    zip_of(&members, CompressionMethod::Stored)
}

/// Little-endian bytes of floats.
pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// `deform.pth` of the smallest network that the architecture allows: three layers of two.
pub(crate) fn tiny_network() -> Vec<u8> {
    let layers = [
        ("linear.0", 2, 24),
        ("linear.1", 2, 2),
        ("linear.2", 2, 26),
        ("gaussian_warp", 3, 2),
        ("gaussian_rotation", 4, 2),
        ("gaussian_scaling", 3, 2),
    ];
    let mut entries = Vec::new();
    let mut storages = Vec::new();
    for (name, outputs, inputs) in layers {
        for (part, shape) in [("weight", vec![outputs, inputs]), ("bias", vec![outputs])] {
            let key = storages.len().to_string();
            let count = shape.iter().product::<i64>();
            let values: Vec<f32> = (0..count).map(|i| i as f32 * 0.25).collect();
            entries.push((format!("{name}.{part}"), float_tensor(&key, &shape)));
            storages.push((key, floats(&values)));
        }
    }
    let entries: Vec<(&str, Vec<u8>)> =
        entries.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
    let storages: Vec<(&str, &[u8])> =
        storages.iter().map(|(key, data)| (key.as_str(), data.as_slice())).collect();
    checkpoint(&state_dict(&entries), &storages)
}

/// `clusters.pt` of four splats in two clusters.
pub(crate) fn tiny_clusters() -> Vec<u8> {
    let id =
        View { storage: "LongStorage", key: "0", count: 4, offset: 0, shape: &[4], strides: &[1] };
    let ids: Vec<u8> = [3_i64, 8, 3, 3].iter().flat_map(|id| id.to_le_bytes()).collect();
    let rgb = floats(&[0.5, 0.25, 0.0, 1.0, 0.0, 0.5, 0.5, 0.25, 0.0, 0.5, 0.25, 0.0]);
    let entries = [("id", id.pickle()), ("rgb", float_tensor("1", &[4, 3]))];
    checkpoint(&state_dict(&entries), &[("0", &ids), ("1", &rgb)])
}
