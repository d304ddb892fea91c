//! `meta.json`, brought to one form for both versions.

use serde::Deserialize;
use trapeze_scene::ShDegree;

use crate::ParseError;
use crate::json::parse_json;
use crate::quantised::logit_of_byte;

/// Largest ln(1 + |x|) of a coordinate that single precision holds: e⁸⁸ ≈ 1.7e38.
const MAX_LOG_COORDINATE: f64 = 88.0;

/// The value of each byte.
pub(super) type Table = [f32; 256];

/// What the images of a scene mean.
pub(super) struct Meta {
    /// Number of splats.
    pub(super) count: u64,
    /// Lowest and highest sign(x)·ln(1 + |x|) per axis.
    pub(super) means: [[f64; 2]; 3],
    /// Log-scale per axis.
    pub(super) scales: Box<[Table; 3]>,
    /// SH coefficient of band 0 per channel.
    pub(super) sh0: Box<[Table; 3]>,
    /// Opacity logit.
    pub(super) opacity: Box<Table>,
    /// Higher SH bands, when the scene has them.
    pub(super) palette: Option<Palette>,
    /// Trained with the 2-D Mip filter.
    pub(super) antialiased: bool,
    /// File names of means_l, means_u, scales, quats and sh0.
    pub(super) files: [String; 5],
}

/// The palette of higher SH bands.
pub(super) struct Palette {
    /// SH coefficient.
    pub(super) table: Box<Table>,
    /// Version 2 states it; in version 1 the width of the image tells it.
    pub(super) degree: Option<ShDegree>,
    /// Number of entries; version 1 fills its image.
    pub(super) entries: Option<u64>,
    /// File names of the centroids and the labels.
    pub(super) files: [String; 2],
}

#[derive(Deserialize)]
struct Version {
    version: Option<u64>,
}

#[derive(Deserialize)]
struct Means {
    /// Version 1 only: splats × 3.
    shape: Option<(u64, u64)>,
    mins: [f64; 3],
    maxs: [f64; 3],
    files: [String; 2],
}

/// Version 1: a table by its ends. `V` is a number or an array with one number per channel.
#[derive(Deserialize)]
struct Ranges<V, F> {
    mins: V,
    maxs: V,
    files: F,
}

/// Version 2: a table by its values.
#[derive(Deserialize)]
struct Codebook {
    codebook: Vec<f64>,
    files: [String; 1],
}

#[derive(Deserialize)]
struct PaletteV2 {
    count: u64,
    bands: u32,
    codebook: Vec<f64>,
    files: [String; 2],
}

#[derive(Deserialize)]
struct Quats {
    files: [String; 1],
}

#[derive(Deserialize)]
struct MetaV1 {
    means: Means,
    scales: Ranges<[f64; 3], [String; 1]>,
    quats: Quats,
    sh0: Ranges<[f64; 4], [String; 1]>,
    #[serde(rename = "shN")]
    palette: Option<Ranges<f64, [String; 2]>>,
    #[serde(default)]
    antialias: bool,
}

#[derive(Deserialize)]
struct MetaV2 {
    count: u64,
    means: Means,
    scales: Codebook,
    quats: Quats,
    sh0: Codebook,
    #[serde(rename = "shN")]
    palette: Option<PaletteV2>,
    #[serde(default)]
    antialias: bool,
}

/// Parses a description of either version; version 1 does not state its number.
pub(super) fn parse(bytes: &[u8]) -> Result<Meta, ParseError> {
    match parse_json::<Version>(bytes)?.version {
        None => parse_json::<MetaV1>(bytes)?.try_into(),
        Some(2) => parse_json::<MetaV2>(bytes)?.try_into(),
        Some(other) => Err(ParseError::value("version", "2, or none for version 1", other)),
    }
}

impl TryFrom<MetaV1> for Meta {
    type Error = ParseError;

    fn try_from(meta: MetaV1) -> Result<Self, ParseError> {
        let Some((count, _)) = meta.means.shape else {
            return Err(ParseError::value("means.shape", "[splats, 3]", "nothing"));
        };
        let [scales] = meta.scales.files;
        let [sh0] = meta.sh0.files;
        let [quats] = meta.quats.files;
        let [means_l, means_u] = meta.means.files;
        let (s, c) = ((meta.scales.mins, meta.scales.maxs), (meta.sh0.mins, meta.sh0.maxs));
        let palette = match meta.palette {
            None => None,
            Some(range) => Some(Palette {
                table: Box::new(linear_table("shN", range.mins, range.maxs)?),
                degree: None,
                entries: None,
                files: range.files,
            }),
        };
        Ok(Self {
            count,
            means: checked_means(meta.means.mins, meta.means.maxs)?,
            scales: Box::new([
                linear_table("scales", s.0[0], s.1[0])?,
                linear_table("scales", s.0[1], s.1[1])?,
                linear_table("scales", s.0[2], s.1[2])?,
            ]),
            sh0: Box::new([
                linear_table("sh0", c.0[0], c.1[0])?,
                linear_table("sh0", c.0[1], c.1[1])?,
                linear_table("sh0", c.0[2], c.1[2])?,
            ]),
            opacity: Box::new(linear_table("sh0", c.0[3], c.1[3])?),
            palette,
            antialiased: meta.antialias,
            files: [means_l, means_u, scales, quats, sh0],
        })
    }
}

impl TryFrom<MetaV2> for Meta {
    type Error = ParseError;

    fn try_from(meta: MetaV2) -> Result<Self, ParseError> {
        let [scales] = meta.scales.files;
        let [sh0] = meta.sh0.files;
        let [quats] = meta.quats.files;
        let [means_l, means_u] = meta.means.files;
        let palette = match meta.palette {
            None => None,
            Some(palette) => Some(Palette {
                table: Box::new(codebook_table("shN.codebook", &palette.codebook)?),
                degree: Some(ShDegree::try_from(palette.bands)?),
                entries: Some(palette.count),
                files: palette.files,
            }),
        };
        Ok(Self {
            count: meta.count,
            means: checked_means(meta.means.mins, meta.means.maxs)?,
            scales: Box::new([codebook_table("scales.codebook", &meta.scales.codebook)?; 3]),
            sh0: Box::new([codebook_table("sh0.codebook", &meta.sh0.codebook)?; 3]),
            opacity: Box::new(std::array::from_fn(|byte| logit_of_byte(byte as u8))),
            palette,
            antialiased: meta.antialias,
            files: [means_l, means_u, scales, quats, sh0],
        })
    }
}

/// The range of each axis, small enough for the coordinates to be finite.
fn checked_means(mins: [f64; 3], maxs: [f64; 3]) -> Result<[[f64; 2]; 3], ParseError> {
    for value in mins.into_iter().chain(maxs) {
        if value.abs() > MAX_LOG_COORDINATE {
            let expected = format!("logarithms between ±{MAX_LOG_COORDINATE}");
            return Err(ParseError::value("means.mins and .maxs", expected, value));
        }
    }
    Ok(std::array::from_fn(|axis| [mins[axis], maxs[axis]]))
}

/// 256 values from `min` to `max` in equal steps.
fn linear_table(field: &str, min: f64, max: f64) -> Result<Table, ParseError> {
    if !((min as f32).is_finite() && (max as f32).is_finite()) {
        let expected = "numbers that single precision holds";
        return Err(ParseError::value(format!("{field}.mins and .maxs"), expected, min.max(max)));
    }
    Ok(std::array::from_fn(|byte| (min + (max - min) * (byte as f64 / 255.0)) as f32))
}

/// The 256 values of a codebook.
fn codebook_table(field: &str, codebook: &[f64]) -> Result<Table, ParseError> {
    let found = format!("{} numbers", codebook.len());
    let values: &[f64; 256] =
        codebook.try_into().map_err(|_| ParseError::value(field, "256 numbers", found))?;
    let table = values.map(|value| value as f32);
    match table.iter().position(|value| !value.is_finite()) {
        None => Ok(table),
        Some(i) => Err(ParseError::value(field, "numbers that single precision holds", values[i])),
    }
}
