//! The zip archive that `torch.save` writes: `NAME/data.pkl`, `NAME/byteorder`, `NAME/data/KEY`.

use std::collections::BTreeMap;

use super::machine::{Entry, MAX_PICKLE_BYTES, unpickle_dictionary};
use super::tensor::StoredTensor;
use crate::ParseError;
use crate::zip_members::ZipMembers;

/// `torch.save` stores without compression. An archive that was packed again may decode to a
/// multiple of its length; these bound the multiple, and with it what a bomb can do.
const DECODED_BYTES_PER_BYTE: u64 = 4;
const DECODED_BYTES_BESIDES: u64 = 64 << 20;

/// First bytes of what `torch.save` wrote before version 1.6: a pickle of the number
/// 0x1950a86a20f9469cfc6c.
const LEGACY_MAGIC: &[u8] = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19";

/// A dictionary of tensors whose numbers are still in the archive.
pub(super) struct Checkpoint<'a> {
    members: ZipMembers<'a>,
    /// NAME above.
    folder: String,
    pub(super) entries: BTreeMap<String, Entry>,
}

impl<'a> Checkpoint<'a> {
    /// Executes the pickle; the storages are read later, one by one.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, ParseError> {
        refuse_other_containers(bytes)?;
        let budget = DECODED_BYTES_BESIDES + DECODED_BYTES_PER_BYTE * bytes.len() as u64;
        let mut members = ZipMembers::open(bytes, budget)?;
        let folder = members
            .names()
            .find_map(|name| {
                let folder = name.strip_suffix("/data.pkl")?;
                (!folder.contains('/')).then(|| folder.to_owned())
            })
            .ok_or_else(|| ParseError::value("zip archive", "a member NAME/data.pkl", "none"))?;
        let byteorder = format!("{folder}/byteorder");
        if members.contains(&byteorder) {
            let order = members.read_up_to(&byteorder, 16)?;
            if order.trim_ascii() != b"little" {
                return Err(ParseError::value("byteorder", "little", order.escape_ascii()));
            }
        }
        let pickle = members.read_up_to(&format!("{folder}/data.pkl"), MAX_PICKLE_BYTES)?;
        let entries = unpickle_dictionary(&pickle)?;
        Ok(Self { members, folder, entries })
    }

    /// The storage of a tensor. Each tensor is charged for its whole storage, so that many views
    /// of one storage cannot decode to more than the archive may.
    pub(super) fn storage_of(&mut self, tensor: &StoredTensor) -> Result<Vec<u8>, ParseError> {
        let storage = tensor.storage();
        let member = format!("{}/data/{}", self.folder, storage.key);
        let data = self.members.read(&member)?;
        let expected = storage.count.checked_mul(storage.element.bytes() as u64);
        if expected != Some(data.len() as u64) {
            let expected = format!("{} elements of {:?}", storage.count, storage.element);
            let found = format!("{} bytes", data.len());
            return Err(ParseError::value(format!("zip member {member}"), expected, found));
        }
        Ok(data)
    }
}

fn refuse_other_containers(bytes: &[u8]) -> Result<(), ParseError> {
    if bytes.starts_with(b"PK\x03\x04") {
        return Ok(());
    }
    let found = if bytes.starts_with(LEGACY_MAGIC) {
        "a pickle of torch before 1.6 (save it again with a current torch)".to_owned()
    } else if bytes.get(257..262) == Some(b"ustar") {
        "a tar archive of torch before 0.4".to_owned()
    } else {
        format!("bytes {}", bytes[..bytes.len().min(8)].escape_ascii())
    };
    Err(ParseError::value("format", "a zip checkpoint of torch 1.6 or later", found))
}
