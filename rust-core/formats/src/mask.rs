//! `mask.bin` and `mask.json`: how far each splat moves, and which share of the splats the scene's
//! maker recommends to treat as static.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use trapeze_scene::{Clusters, Motion, MotionMeasure};

use crate::bytes::f32s_from_le;
use crate::error::InFile;
use crate::json::{MAX_JSON_BYTES, parse_json};
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, WriteError, write_atomically};

/// What `mask.json` says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaskSettings {
    /// Share of static splats, 0–100.
    pub recommended_percentile: Option<f32>,
    /// How the values were measured; [`MotionMeasure::Unknown`] in files of the original app.
    pub measure: Option<MotionMeasure>,
}

/// `mask.json`. `measure` is an addition of this program; the original app ignores keys that it
/// does not know.
#[derive(Deserialize, Serialize)]
struct MaskJson {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    recommended_percentile: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    measure: Option<String>,
}

const MEASURES: [(MotionMeasure, &str); 2] = [
    (MotionMeasure::PositionAndCovariance, "position_and_covariance"),
    (MotionMeasure::PositionOnly, "position"),
];

/// Parses `mask.bin`: one value per splat or, in masks that were made by hand, one per cluster in
/// the order of their ids. Where both would fit the values belong to the splats.
///
/// # Errors
/// [`ParseError`] when the count fits neither, or a value is negative. NaN counts as moving.
pub fn parse_mask_bin(
    bytes: &[u8],
    splats: usize,
    clusters: Option<&Clusters>,
) -> Result<Vec<f32>, ParseError> {
    let per_cluster = clusters.filter(|clusters| bytes.len() == clusters.table.len() * 4);
    if bytes.len() != splats * 4 && per_cluster.is_none() {
        let mut expected = format!("{splats} values (one per splat)");
        if let Some(clusters) = clusters {
            expected += &format!(" or {} (one per cluster)", clusters.table.len());
        }
        let found = match bytes.len() % 4 {
            0 => format!("{} values", bytes.len() / 4),
            _ => format!("{} bytes", bytes.len()),
        };
        return Err(ParseError::value("motion values", expected, found));
    }
    let values: Vec<f32> = f32s_from_le(bytes).collect();
    if let Some(index) = values.iter().position(|&value| value < 0.0) {
        let field = format!("motion value {index}");
        return Err(ParseError::value(field, "a number not below 0", values[index]));
    }
    Ok(match per_cluster {
        Some(clusters) if values.len() != splats => {
            clusters.labels.iter().map(|&label| values[label as usize]).collect()
        }
        _ => values,
    })
}

/// Reads `mask.bin`; see [`parse_mask_bin`].
///
/// # Errors
/// [`ReadError`] with the path and what does not fit.
pub fn read_mask_bin(
    path: &Path,
    splats: usize,
    clusters: Option<&Clusters>,
) -> Result<Vec<f32>, ReadError> {
    let bytes = read_regular_file(path, u64::from(u32::MAX) * 4)?;
    parse_mask_bin(&bytes, splats, clusters).in_file(path)
}

/// Parses `mask.json`.
///
/// # Errors
/// [`ParseError`] names the key that has another type, or a percentile outside 0–100.
pub fn parse_mask_json(bytes: &[u8]) -> Result<MaskSettings, ParseError> {
    let json: MaskJson = parse_json(bytes)?;
    if let Some(percentile) = json.recommended_percentile
        && !(0.0..=100.0).contains(&percentile)
    {
        return Err(ParseError::value("recommended_percentile", "0 to 100", percentile));
    }
    // A measure that a later version may add is one that this version does not know.
    let measure = json.measure.map(|name| {
        MEASURES
            .into_iter()
            .find(|(_, known)| *known == name)
            .map_or(MotionMeasure::Unknown, |(measure, _)| measure)
    });
    Ok(MaskSettings { recommended_percentile: json.recommended_percentile, measure })
}

/// Reads `mask.json`.
///
/// # Errors
/// [`ReadError`] with the path and the key that is wrong.
pub fn read_mask_json(path: &Path) -> Result<MaskSettings, ReadError> {
    parse_mask_json(&read_regular_file(path, MAX_JSON_BYTES)?).in_file(path)
}

/// Writes `mask.bin`, one value per splat.
///
/// # Errors
/// [`WriteError::Io`].
pub fn write_mask_bin(path: &Path, motion: &Motion) -> Result<(), WriteError> {
    write_atomically(path, |file| {
        motion.values.iter().try_for_each(|value| file.write_all(&value.to_le_bytes()))
    })
}

/// Writes `mask.json`: the recommended percentile and how the values were measured, where known.
///
/// # Errors
/// [`WriteError::Io`].
pub fn write_mask_json(path: &Path, motion: &Motion) -> Result<(), WriteError> {
    let measure = MEASURES.into_iter().find(|(measure, _)| *measure == motion.measure);
    let json = MaskJson {
        recommended_percentile: motion.recommended_percentile,
        measure: measure.map(|(_, name)| name.to_owned()),
    };
    write_atomically(path, |file| {
        serde_json::to_writer(&mut *file, &json)?;
        file.write_all(b"\n")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(values: &[f32]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    fn clusters() -> Clusters {
        Clusters::from_ids(&[7, 3, 7, 7], &[[0.0; 3]; 4]).unwrap()
    }

    #[test]
    fn values_per_cluster_are_spread_over_its_splats() {
        let clusters = clusters();
        let values = parse_mask_bin(&bytes(&[0.0, 1.0]), 4, Some(&clusters)).unwrap();
        assert_eq!(values, [1.0, 0.0, 1.0, 1.0], "cluster 3 comes before cluster 7");
    }

    #[test]
    fn where_both_counts_fit_the_values_belong_to_splats() {
        let clusters = Clusters::from_ids(&[9, 2], &[[0.0; 3]; 2]).unwrap();
        let values = parse_mask_bin(&bytes(&[0.5, 1.0]), 2, Some(&clusters)).unwrap();
        assert_eq!(values, [0.5, 1.0]);
    }

    #[test]
    fn counts_that_fit_nothing_are_refused_with_all_numbers() {
        let refused = |values: &[u8], clusters: Option<&Clusters>| {
            parse_mask_bin(values, 4, clusters).unwrap_err().to_string()
        };
        let clusters = clusters();
        assert_eq!(
            refused(&bytes(&[0.0; 3]), Some(&clusters)),
            "motion values: expected 4 values (one per splat) or 2 (one per cluster), found 3 values"
        );
        assert_eq!(
            refused(&bytes(&[0.0; 2]), None),
            "motion values: expected 4 values (one per splat), found 2 values"
        );
        assert!(refused(&[0; 15], Some(&clusters)).ends_with("found 15 bytes"));
        assert!(refused(&[], None).ends_with("found 0 values"));
    }

    #[test]
    fn nan_passes_as_moving_and_negative_values_are_refused_by_index() {
        let values = parse_mask_bin(&bytes(&[f32::NAN, f32::INFINITY]), 2, None).unwrap();
        assert!(values[0].is_nan() && values[1].is_infinite());
        let error = parse_mask_bin(&bytes(&[0.0, -1.0]), 2, None).unwrap_err().to_string();
        assert_eq!(error, "motion value 1: expected a number not below 0, found -1");
    }

    #[test]
    fn mask_json_reads_the_original_and_our_own() {
        let original = parse_mask_json(br#"{"recommended_percentile": 45.0}"#).unwrap();
        assert_eq!(original, MaskSettings { recommended_percentile: Some(45.0), measure: None });
        assert_eq!(parse_mask_json(br#"{"other": [1]}"#).unwrap(), MaskSettings::default());
        let later = parse_mask_json(br#"{"measure": "something new"}"#).unwrap();
        assert_eq!(later.measure, Some(MotionMeasure::Unknown));

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mask.json");
        for measure in [MotionMeasure::PositionAndCovariance, MotionMeasure::PositionOnly] {
            let motion =
                Motion { measure, recommended_percentile: Some(12.5), ..Motion::default() };
            write_mask_json(&path, &motion).unwrap();
            let settings = read_mask_json(&path).unwrap();
            assert_eq!(settings.measure, Some(measure));
            assert_eq!(settings.recommended_percentile, Some(12.5));
        }
        write_mask_json(&path, &Motion { measure: MotionMeasure::Unknown, ..Motion::default() })
            .unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "{}\n");
    }

    #[test]
    fn wrong_settings_are_refused_by_key() {
        for (json, expected) in [
            (r#"{"recommended_percentile": 101}"#, "recommended_percentile: expected 0 to 100"),
            (r#"{"recommended_percentile": -0.5}"#, "recommended_percentile: expected 0 to 100"),
            (r#"{"recommended_percentile": "x"}"#, "recommended_percentile: invalid type"),
            (r#"{"recommended_percentile": NaN}"#, "recommended_percentile: expected"),
            (r#"{"measure": 3}"#, "measure: invalid type"),
            ("", "JSON: EOF"),
        ] {
            let error = parse_mask_json(json.as_bytes()).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn values_survive_the_round_trip_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mask.bin");
        let motion = Motion { values: vec![0.0, 1e-30, 3.5], ..Motion::default() };
        write_mask_bin(&path, &motion).unwrap();
        assert_eq!(read_mask_bin(&path, 3, None).unwrap(), motion.values);
    }
}
