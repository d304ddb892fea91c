//! The text header, bounded before it is parsed.

use std::borrow::Cow;
use std::collections::HashSet;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Header, Version};

use crate::ParseError;

/// Longest header that is read. That of a splat file is a few kilobytes; only comments and
/// features can make it longer.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// Longest name of an element or a property: they go into messages.
const MAX_NAME_BYTES: usize = 64;

const LAST_LINE: &[u8] = b"end_header";

/// The parsed header and the bytes after it.
pub(super) fn split_header(bytes: &[u8]) -> Result<(Header, &[u8]), ParseError> {
    let (text, body) = split_text(bytes)?;
    let mut reader = Reader::new(text.as_bytes());
    let header = Parser::<DefaultElement>::new().read_header(&mut reader).map_err(|error| {
        match error.line().and_then(|line| Some((line, text.lines().nth(line.checked_sub(1)?)?))) {
            Some((line, found)) => ParseError::value(
                format!("header line {line}"),
                "a PLY declaration (format, element, property, comment)",
                format!("{found:?}"),
            ),
            None => ParseError::value("header", "a PLY header", error),
        }
    })?;
    if header.version != (Version { major: 1, minor: 0 }) {
        return Err(ParseError::value("format", "version 1.0", header.version));
    }
    check_names(&text)?;
    Ok((header, body))
}

/// Finds the end of the header without looking further than it may reach.
fn split_text(bytes: &[u8]) -> Result<(Cow<'_, str>, &[u8]), ParseError> {
    let is_ply =
        bytes.strip_prefix(b"ply").is_some_and(|r| r.starts_with(b"\n") || r.starts_with(b"\r\n"));
    if !is_ply {
        let start = String::from_utf8_lossy(&bytes[..bytes.len().min(16)]);
        return Err(ParseError::value("magic", "\"ply\" and a line break", format!("{start:?}")));
    }
    let searched = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
    let mut end = 0;
    for line in searched.split_inclusive(|&b| b == b'\n') {
        end += line.len();
        if line.trim_ascii_end() == LAST_LINE {
            // Comments may be in any encoding; names and numbers that are not ASCII are refused.
            return Ok((String::from_utf8_lossy(&bytes[..end]), &bytes[end..]));
        }
    }
    let expected = format!("a line end_header within {MAX_HEADER_BYTES} bytes");
    Err(ParseError::value("header", expected, format!("none in {} bytes", searched.len())))
}

/// Refuses names that are too long, and names that are declared twice: of those the header parser
/// keeps one, which would shift every value behind it.
fn check_names(text: &str) -> Result<(), ParseError> {
    let mut elements = HashSet::new();
    let mut properties = HashSet::new();
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        let (what, name) = match words.next() {
            Some("element") => ("element", words.next().unwrap_or_default()),
            Some("property") => ("property", words.last().unwrap_or_default()),
            _ => continue,
        };
        if name.len() > MAX_NAME_BYTES {
            let expected = format!("a name of at most {MAX_NAME_BYTES} characters");
            return Err(ParseError::value(format!("header {what}"), expected, name));
        }
        let is_new = if what == "element" {
            properties.clear();
            elements.insert(name)
        } else {
            properties.insert(name)
        };
        if !is_new {
            let field = format!("header {what} {name}");
            return Err(ParseError::value(field, "one declaration", "a second one"));
        }
    }
    Ok(())
}

/// The element with this name, which the file must have.
pub(super) fn required_element<'a>(
    header: &'a Header,
    name: &str,
) -> Result<&'a ElementDef, ParseError> {
    header.elements.get(name).ok_or_else(|| {
        let found: Vec<&str> = header.elements.keys().map(String::as_str).collect();
        ParseError::value(format!("element {name}"), "a declaration", format!("{found:?}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(header: &str) -> String {
        split_header(header.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn line_ends_comments_and_foreign_encodings_are_accepted() {
        let text = b"ply\r\nformat binary_little_endian 1.0\r\ncomment caf\xe9\r\nobj_info x\r\n\
                     element vertex 3\r\nproperty float x\r\nend_header\r\n\nbody";
        let (header, body) = split_header(text).unwrap();
        assert_eq!(body, b"\nbody", "the body starts right behind the line break");
        assert_eq!(header.elements["vertex"].count, 3);
        assert_eq!(header.elements["vertex"].properties.len(), 1);
    }

    #[test]
    fn a_header_without_end_is_refused_after_a_bounded_search() {
        let mut long = b"ply\nformat ascii 1.0\n".to_vec();
        long.resize(MAX_HEADER_BYTES + 1000, b'a');
        long.extend_from_slice(b"\nend_header\n");
        let error = split_header(&long).unwrap_err().to_string();
        assert!(error.contains("end_header within 1048576 bytes, found none"), "{error}");
    }

    #[test]
    fn faults_are_named() {
        assert!(error("plx\n").starts_with("magic: expected \"ply\""));
        assert!(error("ply\nend_header\n").contains("No format line"));
        assert!(error("ply\nformat ascii 1.1\nend_header\n").contains("version 1.0, found 1.1"));
        let bad = error("ply\nformat ascii 1.0\nelement vertex many\nend_header\n");
        assert!(bad.starts_with("header line 3: ") && bad.contains("element vertex many"), "{bad}");
        let huge =
            error("ply\nformat ascii 1.0\nelement vertex 18446744073709551616\nend_header\n");
        assert!(huge.starts_with("header line 3: "), "{huge}");
        let name = "a".repeat(100_000);
        let long = error(&format!("ply\nformat ascii 1.0\nelement {name} 1\nend_header\n"));
        assert!(long.starts_with("header element: expected a name") && long.len() < 200, "{long}");
    }

    #[test]
    fn repeated_names_are_refused_because_they_would_shift_the_columns() {
        let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n";
        let twice = error(&format!("{head}property list uchar int x\nend_header\n"));
        assert!(twice.starts_with("header property x: expected one declaration"), "{twice}");
        let twice = error(&format!("{head}element vertex 1\nend_header\n"));
        assert!(twice.starts_with("header element vertex: expected one declaration"), "{twice}");
        let other = format!("{head}element face 1\nproperty float x\nend_header\n");
        assert!(split_header(other.as_bytes()).is_ok(), "each element has its own names");
    }
}
