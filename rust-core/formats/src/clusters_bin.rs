//! `clusters.bin`: which cluster each splat belongs to, and the clusters' colours.

use std::io::Write;
use std::path::Path;

use trapeze_scene::Clusters;

use crate::bytes::{ByteReader, f32s_from_le};
use crate::error::InFile;
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, WriteError, write_atomically};

const MAGIC: &[u8; 4] = b"CLST";
const VERSION: u32 = 1;

/// Magic, version, count.
const HEADER_BYTES: u64 = 12;
/// One id and three colour channels.
const BYTES_PER_SPLAT: u64 = 16;

/// Parses `clusters.bin`. A cluster takes the colour of its first splat; see
/// `clusters_with_valid_colors` for colours that are none.
///
/// # Errors
/// [`ParseError`] for another magic or version, or a length that the count does not give.
pub fn parse_clusters_bin(bytes: &[u8]) -> Result<Clusters, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let magic = reader.array::<4>("magic")?;
    if &magic != MAGIC {
        return Err(ParseError::value("magic", "\"CLST\"", magic.escape_ascii()));
    }
    let version = reader.u32("version")?;
    if version != VERSION {
        return Err(ParseError::value("version", VERSION.to_string(), version));
    }
    let count = reader.u32("splat count")?;
    let ids: Vec<u32> = reader
        .take_array(count.into(), 4, "cluster ids")?
        .chunks_exact(4)
        .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    let mut channels = f32s_from_le(reader.take_array(count.into(), 12, "cluster colours")?);
    let colors: Vec<[f32; 3]> =
        ids.iter().map(|_| std::array::from_fn(|_| channels.next().unwrap_or_default())).collect();
    reader.expect_end("cluster colours")?;
    clusters_with_valid_colors(&ids, &colors)
}

/// Clusters from per-splat ids and colours. Channels outside 0–1 are clamped; a colour with a
/// channel that is not a number is replaced by one of the palette, so that the cluster stays
/// visible and distinct.
///
/// # Errors
/// [`ParseError::Scene`] when there is not one colour per id.
pub(crate) fn clusters_with_valid_colors(
    ids: &[u32],
    colors: &[[f32; 3]],
) -> Result<Clusters, ParseError> {
    let mut clusters = Clusters::from_ids(ids, colors)?;
    for (label, cluster) in (0..).zip(&mut clusters.table) {
        cluster.color = if cluster.color.iter().any(|channel| channel.is_nan()) {
            Clusters::palette(label)
        } else {
            cluster.color.map(|channel| channel.clamp(0.0, 1.0))
        };
    }
    Ok(clusters)
}

/// Reads `clusters.bin`.
///
/// # Errors
/// [`ReadError`] with the path and the field that is wrong.
pub fn read_clusters_bin(path: &Path) -> Result<Clusters, ReadError> {
    let limit = HEADER_BYTES + u64::from(u32::MAX) * BYTES_PER_SPLAT;
    parse_clusters_bin(&read_regular_file(path, limit)?).in_file(path)
}

/// Writes `clusters.bin`. Names are not part of it: see
/// [`write_cluster_names`](crate::write_cluster_names).
///
/// # Errors
/// [`WriteError::Unrepresentable`] for more splats than a 32-bit count, [`WriteError::Io`].
pub fn write_clusters_bin(path: &Path, clusters: &Clusters) -> Result<(), WriteError> {
    let count = u32::try_from(clusters.labels.len()).map_err(|_| WriteError::Unrepresentable {
        path: path.into(),
        what: "splat count".into(),
        expected: format!("at most {}", u32::MAX),
        found: clusters.labels.len().to_string(),
    })?;
    let of_each_splat = || clusters.labels.iter().map(|&label| &clusters.table[label as usize]);
    write_atomically(path, |file| {
        file.write_all(MAGIC)?;
        file.write_all(&VERSION.to_le_bytes())?;
        file.write_all(&count.to_le_bytes())?;
        for cluster in of_each_splat() {
            file.write_all(&cluster.id.to_le_bytes())?;
        }
        for channel in of_each_splat().flat_map(|cluster| cluster.color) {
            file.write_all(&channel.to_le_bytes())?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u32, count: u32, ids: &[u32], colors: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = b"CLST".to_vec();
        bytes.extend(version.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(ids.iter().flat_map(|id| id.to_le_bytes()));
        bytes.extend(colors.iter().flatten().flat_map(|c| c.to_le_bytes()));
        bytes
    }

    #[test]
    fn ids_and_colours_survive_the_round_trip() {
        let bytes = file(1, 3, &[9, 4_000_000_000, 9], &[[0.5; 3], [0.25, 0.0, 1.0], [0.5; 3]]);
        let clusters = parse_clusters_bin(&bytes).unwrap();
        assert_eq!(clusters.labels, [0, 1, 0]);
        assert_eq!(clusters.table[1].color, [0.25, 0.0, 1.0]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clusters.bin");
        write_clusters_bin(&path, &clusters).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
        assert_eq!(read_clusters_bin(&path).unwrap(), clusters);
    }

    #[test]
    fn an_empty_file_of_zero_splats_is_valid() {
        assert_eq!(parse_clusters_bin(&file(1, 0, &[], &[])).unwrap(), Clusters::default());
    }

    #[test]
    fn colours_that_are_none_are_made_displayable() {
        let colors = [[f32::NAN, 0.0, 0.0], [-1.0, 7.0, f32::INFINITY], [f32::NEG_INFINITY; 3]];
        let clusters = parse_clusters_bin(&file(1, 3, &[1, 2, 3], &colors)).unwrap();
        assert_eq!(clusters.table[0].color, Clusters::palette(0));
        assert_eq!(clusters.table[1].color, [0.0, 1.0, 1.0]);
        assert_eq!(clusters.table[2].color, [0.0; 3]);
    }

    #[test]
    fn wrong_headers_and_lengths_are_refused_by_field() {
        let one = |version, count| file(version, count, &[1], &[[0.0; 3]]);
        let trailing = [one(1, 1), vec![0]].concat();
        for (bytes, expected) in [
            (b"ply\n".to_vec(), "magic: expected \"CLST\", found ply\\n"),
            (one(2, 1), "version: expected 1, found 2"),
            (one(1, 2), "cluster colours: expected 24 bytes, found 8"),
            (one(1, u32::MAX), "cluster ids: expected 17179869180 bytes, found 16"),
            (one(1, 0), "cluster colours: expected end of file, found 16 more bytes"),
            (trailing, "cluster colours: expected end of file, found 1 more bytes"),
        ] {
            let error = parse_clusters_bin(&bytes).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        let whole = one(1, 1);
        for length in 0..whole.len() {
            let error = parse_clusters_bin(&whole[..length]).unwrap_err();
            assert!(matches!(error, ParseError::Truncated { .. }), "{length}: {error}");
        }
    }
}
