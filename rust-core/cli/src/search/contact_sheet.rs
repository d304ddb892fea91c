//! What was found, as one picture.

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use trapeze_query::Searcher;
use trapeze_query::crops::CropRenderer;
use trapeze_scene::Rgba8;

use super::Found;
use crate::error::CliError;

/// Side of a picture in the sheet, pixels.
const TILE: u32 = 160;
/// Space around each, and height of the bar that shows its score.
const GAP: u32 = 12;
const BAR: u32 = 6;

const PAPER: Rgb<u8> = Rgb([250; 3]);
const EMPTY_BAR: Rgb<u8> = Rgb([221; 3]);
const FULL_BAR: Rgb<u8> = Rgb([40, 110, 200]);

/// One row per phrase, its matches from left to right, the best first; the bar under each is its score.
pub(crate) fn contact_sheet(
    searcher: &Searcher,
    renderer: &mut dyn CropRenderer,
    phrases: &[&[Found]],
) -> Result<Rgba8, CliError> {
    let columns = phrases.iter().map(|row| row.len()).max().unwrap_or(0).max(1) as u32;
    let (step_x, step_y) = (TILE + GAP, TILE + BAR + GAP);
    let size = (GAP + columns * step_x, GAP + phrases.len().max(1) as u32 * step_y);
    let mut sheet = RgbImage::from_pixel(size.0, size.1, PAPER);
    for (row, found) in (0..).zip(phrases) {
        for (column, found) in (0..).zip(*found) {
            let Some(picture) = searcher.picture(renderer, found.cluster)? else { continue };
            let tile = imageops::resize(&picture, TILE, TILE, FilterType::Triangle);
            let (x, y) = (GAP + column * step_x, GAP + row * step_y);
            imageops::replace(&mut sheet, &tile, x.into(), y.into());
            let full = (found.score.clamp(0.0, 1.0) * TILE as f32).round() as u32;
            for bar_x in 0..TILE {
                let color = if bar_x < full { FULL_BAR } else { EMPTY_BAR };
                (0..BAR).for_each(|bar_y| sheet.put_pixel(x + bar_x, y + TILE + bar_y, color));
            }
        }
    }
    let pixels = sheet.pixels().flat_map(|p| [p.0[0], p.0[1], p.0[2], 255]).collect();
    Ok(Rgba8 { width: size.0, height: size.1, pixels })
}
