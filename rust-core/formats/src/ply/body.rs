//! Walking over the elements of the body: what is not wanted is passed over, what has rows of
//! varying length is read row by row.

use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};

use super::scalar::{ByteOrder, decode, shortest_row, size_of};
use crate::ParseError;
use crate::bytes::ByteReader;

/// The bytes behind the header, read from front to back.
pub(super) struct Body<'a> {
    reader: ByteReader<'a>,
    encoding: Encoding,
}

impl<'a> Body<'a> {
    pub(super) fn new(header: &Header, bytes: &'a [u8]) -> Self {
        Self { reader: ByteReader::new(bytes), encoding: header.encoding }
    }

    /// The byte order of a binary body; `None` for text.
    pub(super) fn byte_order(&self) -> Option<ByteOrder> {
        match self.encoding {
            Encoding::Ascii => None,
            Encoding::BinaryLittleEndian => Some(ByteOrder::Little),
            Encoding::BinaryBigEndian => Some(ByteOrder::Big),
        }
    }

    /// Checks that all rows of an element can be there, before memory is taken for them.
    pub(super) fn expect_rows(&self, element: &ElementDef) -> Result<(), ParseError> {
        let count = element.count as u64;
        let (rows, size) = match self.encoding {
            // A digit and a space or line break for each value; the last line may lack its break.
            Encoding::Ascii => {
                let values = count.saturating_mul(element.properties.len() as u64);
                (values.saturating_mul(2).saturating_sub(1), 1)
            }
            _ => (count, shortest_row(element)),
        };
        self.reader.clone().take_array(rows, size, &element.name).map(drop)
    }

    /// All rows of an element whose rows are `stride` bytes long.
    pub(super) fn take_rows(
        &mut self,
        element: &ElementDef,
        stride: usize,
    ) -> Result<&'a [u8], ParseError> {
        self.reader.take_array(element.count as u64, stride, &element.name)
    }

    /// Passes over an element.
    pub(super) fn skip(&mut self, element: &ElementDef) -> Result<(), ParseError> {
        // Rows without values have no bytes; a hostile count of them would keep a loop busy.
        if element.properties.is_empty() {
            return Ok(());
        }
        let Some(order) = self.byte_order() else {
            return (0..element.count).try_for_each(|i| self.next_line(element, i).map(drop));
        };
        let is_list = |p: &PropertyType| matches!(p, PropertyType::List(..));
        if !element.properties.values().any(|p| is_list(&p.data_type)) {
            return self.take_rows(element, shortest_row(element)).map(drop);
        }
        (0..element.count).try_for_each(|_| self.binary_row(element, order, |_| {}))
    }

    /// Reads row `index` of an element of any kind into `row`, one value per property; a list
    /// gives NaN.
    pub(super) fn read_row(
        &mut self,
        element: &ElementDef,
        index: usize,
        row: &mut Vec<f64>,
    ) -> Result<(), ParseError> {
        row.clear();
        match self.byte_order() {
            Some(order) => self.binary_row(element, order, |value| row.push(value)),
            None => {
                let line = self.next_line(element, index)?;
                parse_line(line, element, index, row)
            }
        }
    }

    fn binary_row(
        &mut self,
        element: &ElementDef,
        order: ByteOrder,
        mut value: impl FnMut(f64),
    ) -> Result<(), ParseError> {
        for (name, property) in &element.properties {
            match &property.data_type {
                PropertyType::Scalar(scalar) => {
                    let bytes = self.reader.take(size_of(scalar), name)?;
                    value(decode(scalar, bytes, order));
                }
                PropertyType::List(count, item) => {
                    let bytes = self.reader.take(size_of(count), name)?;
                    let length = list_length(count, decode(count, bytes, order), name)?;
                    self.reader.take_array(length, size_of(item), name)?;
                    value(f64::NAN);
                }
            }
        }
        Ok(())
    }

    /// The next line that is not blank.
    fn next_line(&mut self, element: &ElementDef, index: usize) -> Result<&'a [u8], ParseError> {
        loop {
            let rest = self.reader.rest();
            if rest.is_empty() {
                let field = format!("{} row {index}", element.name);
                return Err(ParseError::value(field, "a line", "end of file (file truncated?)"));
            }
            let length = rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |end| end + 1);
            let line = self.reader.take(length, &element.name)?.trim_ascii();
            if !line.is_empty() {
                return Ok(line);
            }
        }
    }
}

fn list_length(scalar: &ScalarType, length: f64, name: &str) -> Result<u64, ParseError> {
    let is_integer = !matches!(scalar, ScalarType::Float | ScalarType::Double);
    if is_integer && length >= 0.0 {
        return Ok(length as u64);
    }
    Err(ParseError::value(name, "a list length (an integer, 0 or more)", length))
}

/// The values of one text line. Numbers as Rust reads them, which includes what C and Python print
/// for values that are not finite.
fn parse_line(
    line: &[u8],
    element: &ElementDef,
    index: usize,
    row: &mut Vec<f64>,
) -> Result<(), ParseError> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let field = |name: &str| format!("{} row {index}, {name}", element.name);
    let mut next = |name: &str| {
        let word = words.next().ok_or_else(|| {
            ParseError::value(field(name), "a number", "end of line (file truncated?)")
        })?;
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f64>().ok());
        number.ok_or_else(|| {
            let start = &word[..word.len().min(64)];
            ParseError::value(field(name), "a number", String::from_utf8_lossy(start))
        })
    };
    for (name, property) in &element.properties {
        let value = next(name)?;
        match &property.data_type {
            PropertyType::Scalar(_) => row.push(value),
            PropertyType::List(count, _) => {
                let length = list_length(count, value, name)?;
                (0..length).try_for_each(|_| next(name).map(drop))?;
                row.push(f64::NAN);
            }
        }
    }
    match words.next() {
        None => Ok(()),
        Some(_) => {
            let expected = format!("{} values", element.properties.len());
            Err(ParseError::value(format!("{} row {index}", element.name), expected, "more"))
        }
    }
}
