//! The image cache: same images whatever the budget and the timing, never more than the budget.

use std::path::Path;
use std::sync::Arc;

use trapeze_formats::dataset::{
    Dataset, DatasetOptions, Image, ImageCache, load_dataset, load_image,
};

use crate::written::{write_image, write_text};

const VIEWS: usize = 12;
/// 16 × 8 pixels of three bytes.
const IMAGE_BYTES: usize = 384;

fn dataset(root: &Path) -> Dataset {
    let frames: Vec<_> = (0..VIEWS)
        .map(|index| {
            write_image(&root.join(format!("images/{index:02}.png")), 16, 8, index as u8 * 20);
            format!(
                r#"{{"file_path": "images/{index:02}.png",
                    "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]]}}"#
            )
        })
        .collect();
    let text = format!(r#"{{"fl_x": 20.0, "frames": [{}]}}"#, frames.join(","));
    write_text(&root.join("transforms.json"), &text);
    load_dataset(root, &DatasetOptions::default()).unwrap()
}

fn decoded(dataset: &Dataset) -> Vec<Image> {
    dataset.views.iter().map(|view| load_image(view).unwrap()).collect()
}

#[test]
fn every_image_is_the_decoded_file_under_every_budget_and_order() {
    let root = tempfile::tempdir().unwrap();
    let dataset = dataset(root.path());
    let expected = decoded(&dataset);
    // A cache of nothing, of less than one image, of some, of all.
    for budget in [0, 100, 2_000, 1 << 20] {
        let cache = ImageCache::new(&dataset, budget);
        for round in 0..20 {
            // Steps coprime to 12 visit every view once; some rounds are not announced, and some
            // are announced in another order than they are asked for.
            let step = [1, 5, 7, 11][round % 4];
            let order: Vec<_> = (0..VIEWS).map(|i| (i * step + round) % VIEWS).collect();
            match round % 3 {
                0 => cache.prefetch(&order),
                1 => cache.prefetch(&order.iter().rev().copied().collect::<Vec<_>>()),
                _ => {}
            }
            for &view in &order {
                assert_eq!(*cache.get(view).unwrap(), expected[view]);
                assert!(cache.resident_bytes() <= budget);
            }
        }
    }
}

#[test]
fn what_was_fetched_ahead_stays_until_it_is_asked_for() {
    let root = tempfile::tempdir().unwrap();
    let dataset = dataset(root.path());
    // Room for four images, at the five bytes a pixel that are reserved before decoding.
    let cache = ImageCache::new(&dataset, 4 * 16 * 8 * 5);
    cache.prefetch(&[3, 1, 2]);
    while cache.resident_bytes() < 3 * IMAGE_BYTES {
        std::thread::yield_now();
    }
    // The files are gone: from here on only the cache can have the images.
    std::fs::remove_dir_all(root.path().join("images")).unwrap();
    for view in [3, 1, 2, 3] {
        assert_eq!(cache.get(view).unwrap().values[0], view as u8 * 20);
    }
}

#[test]
fn the_least_recently_used_image_leaves_first() {
    let root = tempfile::tempdir().unwrap();
    let dataset = dataset(root.path());
    let cache = ImageCache::new(&dataset, 3 * IMAGE_BYTES);
    for view in [0, 1, 2, 0, 3] {
        cache.get(view).unwrap();
    }
    assert_eq!(cache.resident_bytes(), 3 * IMAGE_BYTES);
    std::fs::remove_dir_all(root.path().join("images")).unwrap();
    for view in [0, 2, 3] {
        assert!(cache.get(view).is_ok(), "{view}");
    }
    assert!(cache.get(1).is_err());
}

#[test]
fn an_unreadable_image_is_named_each_time_it_is_asked_for_and_harms_no_other() {
    let root = tempfile::tempdir().unwrap();
    let dataset = dataset(root.path());
    let path = root.path().join("images/05.png");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let cache = ImageCache::new(&dataset, 1 << 20);
    cache.prefetch(&[4, 5, 6]);
    for _ in 0..2 {
        let message = cache.get(5).unwrap_err().to_string();
        assert!(message.contains("05.png: image: expected a readable PNG"), "{message}");
    }
    assert!(cache.get(4).is_ok() && cache.get(6).is_ok());

    // An image that was replaced by one of another size after the dataset was read.
    write_image(&path, 8, 8, 0);
    let message = cache.get(5).unwrap_err().to_string();
    assert!(message.contains("image size: expected 16 x 8 pixels"), "{message}");
}

#[test]
fn threads_that_ask_for_the_same_images_get_the_same_images() {
    let root = tempfile::tempdir().unwrap();
    let dataset = dataset(root.path());
    let expected = decoded(&dataset);
    let cache = Arc::new(ImageCache::new(&dataset, 5 * IMAGE_BYTES));
    std::thread::scope(|scope| {
        for offset in 0..4 {
            let (cache, expected) = (&cache, &expected);
            scope.spawn(move || {
                for turn in 0..100 {
                    let view = (turn * (offset + 1) + offset) % VIEWS;
                    assert_eq!(*cache.get(view).unwrap(), expected[view]);
                }
            });
        }
    });
}
