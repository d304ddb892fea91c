//! Animated WebP.

use std::io::Write;
use std::path::Path;

use trapeze_formats::write_atomically;
use trapeze_scene::Rgba8;
use webp::{AnimEncoder, AnimFrame, WebPConfig};

use crate::error::CliError;

/// Quality of the lossy frames, 0–100: artefacts below what a browser shows.
const QUALITY: f32 = 82.0;

/// Writes frames of one size as an animation that repeats for ever, each frame shown for
/// `frame_milliseconds`.
pub(crate) fn write_animation(
    path: &Path,
    frames: &[Rgba8],
    frame_milliseconds: u32,
) -> Result<(), CliError> {
    let refuse = |reason: String| CliError::Encode { path: path.into(), reason };
    let first = frames.first().ok_or_else(|| refuse("no frames".into()))?;
    let mut config = WebPConfig::new().map_err(|()| refuse("encoder not available".into()))?;
    config.quality = QUALITY;
    let mut encoder = AnimEncoder::new(first.width, first.height, &config);
    encoder.set_loop_count(0);
    for (i, frame) in frames.iter().enumerate() {
        let time = i32::try_from(i as u64 * u64::from(frame_milliseconds))
            .map_err(|_| refuse("longer than 24 days".into()))?;
        encoder.add_frame(AnimFrame::from_rgba(&frame.pixels, frame.width, frame.height, time));
    }
    let bytes = encoder.try_encode().map_err(|error| refuse(format!("{error:?}")))?;
    write_atomically(path, |file| file.write_all(&bytes))?;
    Ok(())
}
