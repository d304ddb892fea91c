//! Search as the commands use it: the CPU renderer as the source of crops, features beside the scene,
//! and the contact sheet.

mod contact_sheet;
mod crop_renderer;
mod session;

pub(crate) use contact_sheet::contact_sheet;
pub(crate) use crop_renderer::{CpuCropRenderer, positions_at};
pub(crate) use session::{Found, SearchArguments, SearchReport, search};
