//! `trapeze convert --merge`.

mod support;

use support::{json, load, refusal, succeed, thinned_scene};
use trapeze_scene::ShDegree;

#[test]
fn a_static_scene_is_placed_into_a_deformable_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let scene = load(&path);
    let added = folder.path().join("added");
    succeed(&arguments!["convert", &path, &added, "--time", "0", "--sh-degree", "1"]);
    let still = load(&added);
    let out = folder.path().join("merged");
    let place = ["--place", "-1,0,-2,0.25"];
    let mut arguments = arguments!["convert", &path, &out, "--merge", &added].to_vec();
    arguments.extend(place.map(Into::into));
    succeed(&arguments);

    let merged = load(&out);
    let n = scene.len();
    assert_eq!(merged.len(), 2 * n);
    assert_eq!(merged.splats.sh_degree, ShDegree::Three);
    assert_eq!(merged.deformation, scene.deformation);
    let own: Vec<u32> = (0..n as u32).collect();
    assert_eq!(merged.gather(&own).splats, scene.splats);
    let [x, y, z] = still.splats.positions[5].map(f64::from);
    let expected = [-1.0 + 0.25 * x, 0.25 * y, -2.0 + 0.25 * z];
    assert_eq!(merged.splats.positions[n + 5], expected.map(|c| c as f32));
    let motion = merged.motion.unwrap();
    assert_eq!(motion.values[..n], scene.motion.unwrap().values);
    assert!(motion.values[n..].iter().all(|&value| value == 0.0));
    let info = json(&arguments!["info", &out, "--json"]);
    let clusters = info["clusters"].as_array().unwrap();
    let ids: Vec<_> = clusters.iter().map(|c| c["id"].as_u64().unwrap()).collect();
    assert_eq!(ids, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    assert_eq!(clusters[6]["name"], "monkey head");
}

#[test]
fn a_second_network_is_refused_by_the_name_of_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = thinned_scene(folder.path());
    let out = folder.path().join("merged");
    let message = refusal(&arguments!["convert", &path, &out, "--merge", &path]);
    let found = format!("found one in {}", path.display());
    assert_eq!(
        message,
        format!("--merge: expected a scene without a deformation network, {found}")
    );
    assert!(!out.exists());
}
