//! Reading named members of a zip archive within a budget of decoded bytes.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::ParseError;

/// A zip archive in memory. All members together may decode to no more than the budget, so that
/// neither a member that inflates without end nor many members that share one compressed stream
/// can fill the memory.
#[derive(Debug)]
pub(crate) struct ZipMembers<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    budget: u64,
}

impl<'a> ZipMembers<'a> {
    /// Reads the directory of the archive.
    pub(crate) fn open(bytes: &'a [u8], budget: u64) -> Result<Self, ParseError> {
        let archive = ZipArchive::new(Cursor::new(bytes))
            .map_err(|error| ParseError::value("zip archive", "a readable directory", error))?;
        // Of two members with one name, each program may read another.
        if archive.has_duplicate_names() {
            return Err(ParseError::value("zip archive", "each name once", "a name twice"));
        }
        Ok(Self { archive, budget })
    }

    /// Names of the members, in the order of the directory; names that are not text are left out.
    pub(crate) fn names(&self) -> impl Iterator<Item = String> + '_ {
        (0..self.archive.len())
            .filter_map(|i| Some(self.archive.name_for_index(i)?.ok()?.into_owned()))
    }

    /// Whether there is a member with this name.
    pub(crate) fn contains(&self, name: &str) -> bool {
        self.archive.index_for_name(name).is_some()
    }

    /// Decoded content of a member, stored or deflated, its checksum verified.
    pub(crate) fn read(&mut self, name: &str) -> Result<Vec<u8>, ParseError> {
        self.read_up_to(name, self.budget)
    }

    /// As [`Self::read`], for a member that has no reason to be longer than `limit` bytes.
    pub(crate) fn read_up_to(&mut self, name: &str, limit: u64) -> Result<Vec<u8>, ParseError> {
        let limit = limit.min(self.budget);
        let field = || format!("zip member {name}");
        let mut member = self
            .archive
            .by_name(name)
            .map_err(|error| ParseError::value(field(), "a readable member", error))?;
        let size = member.size();
        if size > limit {
            let expected = format!("at most {limit} decoded bytes");
            return Err(ParseError::value(field(), expected, size));
        }
        // The directory's size is a claim: the buffer grows with the bytes that are really there.
        let mut bytes = Vec::new();
        (&mut member)
            .take(size + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| ParseError::value(field(), "intact data", error))?;
        if bytes.len() as u64 != size {
            let expected = format!("{size} decoded bytes as in the directory");
            return Err(ParseError::value(field(), expected, bytes.len()));
        }
        self.budget -= size;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    use super::*;

    fn archive(members: &[(&str, &[u8])], method: CompressionMethod) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in members {
            let options = SimpleFileOptions::default().compression_method(method);
            writer.start_file(*name, options).unwrap();
            writer.write_all(content).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn stored_and_deflated_members_are_read() {
        for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
            let bytes = archive(&[("a", b"one"), ("b/c", &[9; 1000])], method);
            let mut members = ZipMembers::open(&bytes, 2000).unwrap();
            assert_eq!(members.names().collect::<Vec<_>>(), ["a", "b/c"]);
            assert!(members.contains("a") && !members.contains("c"));
            assert_eq!(members.read("b/c").unwrap(), [9; 1000]);
            assert_eq!(members.read("a").unwrap(), b"one");
            let error = members.read("d").unwrap_err().to_string();
            assert!(error.starts_with("zip member d: expected a readable member"), "{error}");
        }
    }

    #[test]
    fn members_over_the_budget_are_refused_one_by_one_and_together() {
        let zeros = vec![0; 1 << 20];
        let bytes = archive(&[("a", &zeros), ("b", &zeros)], CompressionMethod::Deflated);
        assert!(bytes.len() < 10_000, "the archive itself is small");
        let mut members = ZipMembers::open(&bytes, (1 << 20) - 1).unwrap();
        assert!(members.read("a").unwrap_err().to_string().contains("at most 1048575"));
        let mut members = ZipMembers::open(&bytes, 3 << 19).unwrap();
        assert!(members.read("a").is_ok());
        assert!(members.read("b").unwrap_err().to_string().contains("at most 524288"));
    }

    #[test]
    fn a_member_with_another_size_than_the_directory_says_is_refused() {
        let bytes = archive(&[("a", &[7; 1000])], CompressionMethod::Deflated);
        let directory = bytes.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
        for claimed in [10_u32, 5000] {
            let mut lying = bytes.clone();
            // The uncompressed size is 24 bytes into the directory's entry.
            lying[directory + 24..][..4].copy_from_slice(&claimed.to_le_bytes());
            let error = ZipMembers::open(&lying, 1 << 20).unwrap().read("a").unwrap_err();
            assert!(error.to_string().starts_with("zip member a: "), "{error}");
        }
    }

    #[test]
    fn a_name_that_occurs_twice_is_refused() {
        // The writer refuses it too, so the second member gets its name afterwards.
        let mut bytes = archive(&[("first", b"1"), ("other", b"2")], CompressionMethod::Stored);
        while let Some(at) = bytes.windows(5).position(|w| w == b"other") {
            bytes[at..at + 5].copy_from_slice(b"first");
        }
        let error = ZipMembers::open(&bytes, 100).err().unwrap().to_string();
        assert_eq!(error, "zip archive: expected each name once, found a name twice");
    }

    #[test]
    fn damaged_data_is_refused_by_its_checksum() {
        let mut bytes = archive(&[("a", &[7; 1000])], CompressionMethod::Stored);
        let data = bytes.windows(4).position(|w| w == [7; 4]).unwrap();
        bytes[data] = 8;
        let error = ZipMembers::open(&bytes, 1 << 20).unwrap().read("a").unwrap_err();
        assert!(error.to_string().contains("intact data"), "{error}");
    }
}
