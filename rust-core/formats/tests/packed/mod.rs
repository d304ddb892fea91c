//! Builds SPZ and SOG files byte by byte, independently of the crate's own writers.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use std::io::{Cursor, Write};

use fastrand::Rng;
use flate2::{Compression, write::GzEncoder};
use image_webp::{ColorType, WebPEncoder};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use zip::write::SimpleFileOptions;

/// Bytes of each SPZ stream for one splat.
pub(crate) fn spz_stream_bytes(version: u32, sh_degree: u8) -> [usize; 6] {
    let bands = usize::from(sh_degree) + 1;
    [9, 1, 3, 3, if version == 2 { 3 } else { 4 }, 3 * (bands * bands - 1)]
}

/// The 16-byte header of SPZ versions 2 and 3; its first 15 bytes start version 4 as well.
pub(crate) fn spz_header(version: u32, splats: u32, sh_degree: u8, flags: u8) -> Vec<u8> {
    let mut header = b"NGSP".to_vec();
    header.extend(version.to_le_bytes());
    header.extend(splats.to_le_bytes());
    header.extend([sh_degree, 12, flags, 0]);
    header
}

/// Header and streams of random quantised splats, before compression. Any byte is a legal value.
pub(crate) fn spz_payload(version: u32, splats: u32, sh_degree: u8, flags: u8) -> Vec<u8> {
    let mut rng = Rng::with_seed(u64::from(version) * 100 + u64::from(sh_degree));
    let per_splat: usize = spz_stream_bytes(version, sh_degree).iter().sum();
    let mut payload = spz_header(version, splats, sh_degree, flags);
    payload.extend((0..per_splat * splats as usize).map(|_| rng.u8(..)));
    payload
}

pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// A version-4 file from a payload as [`spz_payload`] makes it: the body is cut where streams of
/// `splats` splats of `sh_degree` end, the last stream takes the rest.
pub(crate) fn spz_v4(payload: &[u8], splats: usize, sh_degree: u8) -> Vec<u8> {
    let (header, mut body) = payload.split_at(payload.len().min(16));
    let mut streams = Vec::new();
    for size in spz_stream_bytes(4, sh_degree).map(|bytes| bytes * splats) {
        if size > 0 {
            let (stream, rest) = body.split_at(body.len().min(size));
            streams.push(stream.to_vec());
            body = rest;
        }
    }
    streams.last_mut().unwrap().extend(body);
    let frames: Vec<_> =
        streams.iter().map(|s| compress_to_vec(&s[..], CompressionLevel::Fastest)).collect();
    let mut file = header[..header.len().min(15)].to_vec();
    file.push(frames.len() as u8);
    file.extend(32_u32.to_le_bytes());
    file.extend([0; 12]);
    for (stream, frame) in streams.iter().zip(&frames) {
        file.extend((frame.len() as u64).to_le_bytes());
        file.extend((stream.len() as u64).to_le_bytes());
    }
    file.extend(frames.into_iter().flatten());
    file
}

/// The images of a SOG scene by name, and its description.
#[derive(Clone)]
pub(crate) struct SogFiles {
    pub(crate) meta: String,
    pub(crate) images: Vec<(&'static str, Vec<u8>)>,
}

pub(crate) const SOG_SPLATS: usize = 250;
const SIDE: u32 = 16;

/// A random SOG scene of [`SOG_SPLATS`] splats; a palette of 128 entries when `sh_degree` > 0.
pub(crate) fn sog_files(version: u32, sh_degree: u32) -> SogFiles {
    let mut rng = Rng::with_seed(u64::from(version * 10 + sh_degree));
    let mut image = |width, height, fix: fn(&mut [u8; 4])| {
        let mut pixels: Vec<[u8; 4]> =
            (0..width * height).map(|_| rng.u32(..).to_le_bytes()).collect();
        pixels.iter_mut().for_each(fix);
        webp(&pixels, width)
    };
    let mut images = vec![
        ("means_l.webp", image(SIDE, SIDE, |p| p[3] = 255)),
        ("means_u.webp", image(SIDE, SIDE, |p| p[3] = 255)),
        ("scales.webp", image(SIDE, SIDE, |p| p[3] = 255)),
        ("quats.webp", image(SIDE, SIDE, |p| p[3] |= 252)),
        ("sh0.webp", image(SIDE, SIDE, |_| ())),
    ];
    if sh_degree > 0 {
        let coefficients = (sh_degree + 1).pow(2) - 1;
        images.push(("shN_centroids.webp", image(64 * coefficients, 2, |p| p[3] = 255)));
        images.push(("shN_labels.webp", image(SIDE, SIDE, |p| *p = [p[0] & 127, 0, 0, 255])));
    }
    SogFiles { meta: if version == 1 { meta_v1(sh_degree) } else { meta_v2(sh_degree) }, images }
}

fn meta_v1(sh_degree: u32) -> String {
    let palette = r#","shN":{"mins":-0.5,"maxs":0.75,"quantization":8,
        "files":["shN_centroids.webp","shN_labels.webp"]}"#;
    format!(
        r#"{{"means":{{"shape":[{SOG_SPLATS},3],"mins":[-1.5,-2,-3],"maxs":[1,2.5,3],
        "files":["means_l.webp","means_u.webp"]}},
        "scales":{{"mins":[-9,-8,-7],"maxs":[-1,0,1],"files":["scales.webp"]}},
        "quats":{{"files":["quats.webp"]}},
        "sh0":{{"mins":[-1,-2,-3,-4],"maxs":[1,2,3,9],"files":["sh0.webp"]}}{}}}"#,
        if sh_degree > 0 { palette } else { "" }
    )
}

fn meta_v2(sh_degree: u32) -> String {
    let codebook = |low: f64, high: f64| {
        let values = (0..256).map(|i| (low + (high - low) * f64::from(i) / 255.0).to_string());
        values.collect::<Vec<_>>().join(",")
    };
    let palette = format!(
        r#","shN":{{"count":128,"bands":{sh_degree},"codebook":[{}],
        "files":["shN_centroids.webp","shN_labels.webp"]}}"#,
        codebook(-0.5, 0.75)
    );
    format!(
        r#"{{"version":2,"count":{SOG_SPLATS},"antialias":false,
        "means":{{"mins":[-1.5,-2,-3],"maxs":[1,2.5,3],"files":["means_l.webp","means_u.webp"]}},
        "scales":{{"codebook":[{}],"files":["scales.webp"]}},
        "quats":{{"files":["quats.webp"]}},
        "sh0":{{"codebook":[{}],"files":["sh0.webp"]}}{}}}"#,
        codebook(-9.0, 1.0),
        codebook(-2.0, 2.0),
        if sh_degree > 0 { &palette } else { "" }
    )
}

/// A lossless WebP image.
pub(crate) fn webp(pixels: &[[u8; 4]], width: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let height = pixels.len() as u32 / width;
    WebPEncoder::new(&mut file)
        .encode(pixels.as_flattened(), width, height, ColorType::Rgba8)
        .unwrap();
    file
}

/// A zip archive, stored or deflated.
pub(crate) fn zip(entries: &[(&str, &[u8])], deflated: bool) -> Vec<u8> {
    let method =
        if deflated { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
    let options = SimpleFileOptions::default().compression_method(method);
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        writer.start_file(*name, options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

impl SogFiles {
    /// The archive of the scene.
    pub(crate) fn zip(&self) -> Vec<u8> {
        let images = self.images.iter().map(|(name, bytes)| (*name, &bytes[..]));
        zip(&images.chain([("meta.json", self.meta.as_bytes())]).collect::<Vec<_>>(), false)
    }

    /// The scene with another image called `name`.
    pub(crate) fn with_image(&self, name: &str, bytes: &[u8]) -> Self {
        let mut changed = self.clone();
        changed.images.iter_mut().find(|(n, _)| *n == name).unwrap().1 = bytes.to_vec();
        changed
    }

    /// The scene with another description.
    pub(crate) fn with_meta(&self, from: &str, to: &str) -> Self {
        assert!(self.meta.contains(from), "{from}");
        Self { meta: self.meta.replace(from, to), ..self.clone() }
    }
}
