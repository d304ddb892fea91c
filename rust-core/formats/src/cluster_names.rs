//! `cluster-names.json`: people's names for clusters, `{"1": "plate", "2": "monkey head"}`.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use trapeze_scene::Clusters;

use crate::error::InFile;
use crate::json::{MAX_JSON_BYTES, parse_json};
use crate::regular_file::read_regular_file;
use crate::{ParseError, ReadError, WriteError, write_atomically};

/// Names by cluster id.
pub type ClusterNames = BTreeMap<u32, String>;

/// Parses `cluster-names.json`.
///
/// # Errors
/// [`ParseError`] names the key that is not a cluster id, or the value that is not text.
pub fn parse_cluster_names(bytes: &[u8]) -> Result<ClusterNames, ParseError> {
    let named: BTreeMap<String, String> = parse_json(bytes)?;
    named
        .into_iter()
        .map(|(id, name)| match id.parse() {
            Ok(id) => Ok((id, name)),
            Err(_) => Err(ParseError::value("cluster id", "a number below 2^32", id)),
        })
        .collect()
}

/// Reads `cluster-names.json`.
///
/// # Errors
/// [`ReadError`] with the path and the key that is wrong.
pub fn read_cluster_names(path: &Path) -> Result<ClusterNames, ReadError> {
    parse_cluster_names(&read_regular_file(path, MAX_JSON_BYTES)?).in_file(path)
}

/// Writes `cluster-names.json` with the clusters that have a name.
///
/// # Errors
/// [`WriteError::Io`].
pub fn write_cluster_names(path: &Path, clusters: &Clusters) -> Result<(), WriteError> {
    let names: BTreeMap<u32, &str> = clusters
        .table
        .iter()
        .filter_map(|cluster| Some((cluster.id, cluster.name.as_deref()?)))
        .collect();
    write_atomically(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &names)?;
        file.write_all(b"\n")
    })
}

/// Puts names on clusters. Names of clusters that no splat belongs to are left out: a file of
/// names often outlives splats that were removed.
pub fn apply_cluster_names(clusters: &mut Clusters, mut names: ClusterNames) {
    for cluster in &mut clusters.table {
        cluster.name = names.remove(&cluster.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_survive_the_round_trip_and_strangers_are_left_out() {
        let mut clusters = Clusters::from_ids(&[1, 2, 30], &[[0.0; 3]; 3]).unwrap();
        let json = br#"{"1": "plate", "30": "a \"quoted\" name", "7": "gone"}"#;
        apply_cluster_names(&mut clusters, parse_cluster_names(json).unwrap());
        let names = clusters.table.iter().map(|c| c.name.as_deref()).collect::<Vec<_>>();
        assert_eq!(names, [Some("plate"), None, Some("a \"quoted\" name")]);

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cluster-names.json");
        write_cluster_names(&path, &clusters).unwrap();
        let mut again = Clusters::from_ids(&[1, 2, 30], &[[0.0; 3]; 3]).unwrap();
        apply_cluster_names(&mut again, read_cluster_names(&path).unwrap());
        assert_eq!(again, clusters);
    }

    #[test]
    fn wrong_keys_and_values_are_refused_by_name() {
        for (json, expected) in [
            (r#"{"plate": "1"}"#, "cluster id: expected a number below 2^32, found plate"),
            (r#"{"-1": "x"}"#, "cluster id: expected a number below 2^32, found -1"),
            (r#"{"4294967296": "x"}"#, "cluster id: expected a number below 2^32"),
            (r#"{"3": 5}"#, "3: invalid type: integer `5`, expected a string"),
            ("[1]", "JSON: invalid type: sequence, expected a map"),
        ] {
            let error = parse_cluster_names(json.as_bytes()).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
