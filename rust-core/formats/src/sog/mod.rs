//! SOG, the compressed splat files of PlayCanvas: images of one pixel per splat, described by
//! `meta.json`, in a folder or in a zip archive (`.sog`).
//!
//! | image | content of a pixel |
//! |---|---|
//! | means_l, means_u | low and high byte of 16-bit x, y, z; sign(x)·ln(1 + abs(x)) between `mins` and `maxs` |
//! | scales | an entry of a table of log-scales, per axis |
//! | quats | three smallest components over [−√½, √½], then 252 + the index of the largest in (w, x, y, z) |
//! | sh0 | an entry of a table of SH band 0, per channel, then the opacity |
//! | shN_labels | 16-bit index into a palette of higher SH bands |
//! | shN_centroids | the palette, 64 entries a row, one pixel per coefficient |
//!
//! Version 1 gives each table by its first and last value and stores the opacity's logit, version 2
//! gives 256 values and stores the opacity itself. Both become tables of 256 values here
//! (`meta::Meta`), and one decoder reads either. Axes are those of a PLY file.
//!
//! Source: the format's specification,
//! <https://developer.playcanvas.com/user-manual/gaussian-splatting/formats/sog/>, and for version 1
//! the reader of <https://github.com/playcanvas/splat-transform>.

mod decode;
mod image;
mod meta;
mod source;

use std::path::Path;

use trapeze_scene::Scene;

use crate::decompression::unpacked_limit;
use crate::error::InFile;
use crate::zip_members::ZipMembers;
use crate::{ParseError, ReadError, open};

use source::{Folder, Source};

/// Name of the description in a folder or an archive.
const META_NAME: &str = "meta.json";

/// Reads a scene from the bytes of a zipped SOG (`.sog`).
///
/// # Errors
/// [`ParseError`] names the image or the field that is missing, damaged or not supported.
pub fn parse_sog_zip(bytes: &[u8]) -> Result<Scene, ParseError> {
    parse(META_NAME, &mut ZipMembers::open(bytes, unpacked_limit(bytes.len()))?)
}

/// Reads a SOG scene from a folder that holds `meta.json` and its images.
///
/// # Errors
/// [`ReadError`] names the folder, and the image or the field.
pub fn read_sog_folder(folder: &Path) -> Result<Scene, ReadError> {
    parse(META_NAME, &mut Folder::new(folder)).in_file(folder)
}

/// Reads a SOG scene: a zipped file, a folder, or the path of a folder's description (`.json`).
///
/// # Errors
/// [`ReadError`] names the file, and the image or the field.
pub fn read_sog(path: &Path) -> Result<Scene, ReadError> {
    if path.is_dir() {
        return read_sog_folder(path);
    }
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or(META_NAME);
        return parse(name, &mut Folder::new(folder)).in_file(path);
    }
    let bytes = open::map(path).in_file(path)?;
    parse_sog_zip(&bytes).in_file(path)
}

fn parse(meta_name: &str, source: &mut dyn Source) -> Result<Scene, ParseError> {
    let meta = meta::parse(&source.load(meta_name)?)?;
    if meta.antialiased {
        tracing::warn!(
            "SOG flag `antialias`: the splats were trained with the 2-D Mip filter, which is not \
             applied; small splats may look too large or too bright"
        );
    }
    decode::scene(&meta, &image::load_all(&meta, source)?)
}
