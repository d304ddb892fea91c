//! Rendering a view of a cluster, and cutting it out.

use image::{Rgb, RgbImage, imageops};
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, Selection};

use super::{BACKGROUND, Crop, CropKind, CropRenderer, Member};
use crate::SearchError;

/// Room around what is seen, as a share of the longer side of its box.
const PADDING: f64 = 0.1;
/// Pixels of a view, per 256², below which a cluster is not judged by it: the original app's limit
/// (a 2000th of the view, at least 50).
const LEAST_PIXELS_OF_256: f64 = 50.0;
/// Opacity above which a pixel of the isolated cluster counts as covered.
const COVERED: f32 = 0.5;

/// Two crops of a view at `time`, or fewer where too little is seen: the cluster alone, and in the
/// scene.
///
/// # Errors
/// [`SearchError::Render`] when the backend fails.
pub fn crops_from(
    renderer: &mut dyn CropRenderer,
    scene: &Scene,
    label: u32,
    camera: &Camera,
    time: f32,
) -> Result<Vec<Crop>, SearchError> {
    let Some(clusters) = &scene.clusters else { return Err(SearchError::NoClusters) };
    let member = Member { clusters, label };
    let mut render = |selection: Selection, top_contributor: bool| {
        let settings = FrameSettings { time, selection, top_contributor, ..Default::default() };
        renderer.render(camera, &settings).map_err(SearchError::Render)
    };
    let alone = render(Selection::Isolate([label].into_iter().collect()), false)?;
    let whole = render(Selection::All, true)?;

    let covered: Vec<bool> = alone.color.iter().map(|pixel| pixel[3] > COVERED).collect();
    let seen: Vec<bool> = whole.top_contributor.iter().map(|&splat| member.owns(splat)).collect();
    let count = |mask: &[bool]| mask.iter().filter(|&&shown| shown).count();
    let (covered_count, seen_count) = (count(&covered), count(&seen));
    let pixels = f64::from(camera.width) * f64::from(camera.height);
    let least = LEAST_PIXELS_OF_256 * pixels / 65_536.0;
    let share = |count: usize| count as f64 / pixels;
    let visible = (seen_count as f64 / covered_count.max(1) as f64).min(1.0);

    let mut crops = Vec::new();
    if covered_count as f64 >= least {
        let image = cut(&over_grey(&alone, None), &covered, alone.width);
        crops.push(Crop { image, kind: CropKind::Isolated, weight: share(covered_count) as f32 });
    }
    if seen_count as f64 >= least {
        let image = cut(&over_grey(&whole, Some(&seen)), &seen, whole.width);
        let weight = (share(seen_count) * visible) as f32;
        crops.push(Crop { image, kind: CropKind::InContext, weight });
    }
    Ok(crops)
}

/// The frame in 8 bits over grey; where a mask is given, all grey outside it.
fn over_grey(frame: &Frame, mask: Option<&[bool]>) -> RgbImage {
    let grey = f32::from(BACKGROUND) / 255.0;
    let quantised = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    let mut image = RgbImage::from_pixel(frame.width, frame.height, Rgb([BACKGROUND; 3]));
    for (i, (pixel, color)) in image.pixels_mut().zip(frame.over([grey; 3])).enumerate() {
        if mask.is_none_or(|mask| mask[i]) {
            *pixel = Rgb([color[0], color[1], color[2]].map(quantised));
        }
    }
    image
}

/// The square around the pixels of the mask, with room; grey where it leaves the image.
fn cut(image: &RgbImage, mask: &[bool], width: u32) -> RgbImage {
    let (mut min, mut max) = ([u32::MAX; 2], [0; 2]);
    for (i, _) in (0_u32..).zip(mask).filter(|&(_, &shown)| shown) {
        let at = [i % width, i / width];
        for axis in 0..2 {
            min[axis] = min[axis].min(at[axis]);
            max[axis] = max[axis].max(at[axis] + 1);
        }
    }
    if min[0] > max[0] {
        return image.clone();
    }
    let longer = f64::from((max[0] - min[0]).max(max[1] - min[1]));
    let side = (longer * (1.0 + 2.0 * PADDING)).round().max(1.0) as u32;
    let mut square = RgbImage::from_pixel(side, side, Rgb([BACKGROUND; 3]));
    // Where the square's corner is in the image; negative where it sticks out.
    let corner =
        |axis: usize| (i64::from(min[axis]) + i64::from(max[axis]) - i64::from(side)).div_euclid(2);
    imageops::replace(&mut square, image, -corner(0), -corner(1));
    square
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crop_is_a_padded_square_around_the_mask_even_at_the_border() {
        let image = RgbImage::from_fn(20, 20, |x, y| Rgb([x as u8, y as u8, 7]));
        let mut mask = vec![false; 400];
        // x 10–19, y 0–3: wider than high, in a corner.
        for y in 0..4 {
            mask[y * 20 + 10..y * 20 + 20].fill(true);
        }
        let crop = cut(&image, &mask, 20);
        assert_eq!(crop.dimensions(), (12, 12));
        // The box's centre (15, 2) is the crop's centre (6, 6).
        assert_eq!(crop.get_pixel(6, 6).0, [15, 2, 7]);
        assert_eq!(crop.get_pixel(1, 4).0, [10, 0, 7]);
        assert_eq!(crop.get_pixel(11, 6).0, [BACKGROUND; 3], "beyond the image");
        assert_eq!(crop.get_pixel(6, 0).0, [BACKGROUND; 3]);
    }

    #[test]
    fn what_belongs_to_others_is_grey() {
        let frame = Frame {
            width: 3,
            height: 1,
            color: vec![[0.5, 0.0, 0.0, 0.5], [1.0; 4], [0.0; 4]],
            ..Frame::default()
        };
        let image = over_grey(&frame, Some(&[true, false, true]));
        assert_eq!(image.get_pixel(0, 0).0, [192, 64, 64]);
        assert_eq!(image.get_pixel(1, 0).0, [BACKGROUND; 3]);
        assert_eq!(image.get_pixel(2, 0).0, [BACKGROUND; 3]);
    }
}
