//! The number types of PLY, in either byte order.

use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// Bytes of a binary number.
pub(super) fn size_of(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Whether single precision holds every value of the type.
pub(super) fn fits_single_precision(scalar: &ScalarType) -> bool {
    !matches!(scalar, ScalarType::Int | ScalarType::UInt | ScalarType::Double)
}

/// The number in `bytes`, which are [`size_of`] the type long. Every PLY number is exact in f64.
pub(super) fn decode(scalar: &ScalarType, bytes: &[u8], order: ByteOrder) -> f64 {
    match scalar {
        ScalarType::Char => f64::from(i8::from_le_bytes(little_endian(bytes, order))),
        ScalarType::UChar => f64::from(u8::from_le_bytes(little_endian(bytes, order))),
        ScalarType::Short => f64::from(i16::from_le_bytes(little_endian(bytes, order))),
        ScalarType::UShort => f64::from(u16::from_le_bytes(little_endian(bytes, order))),
        ScalarType::Int => f64::from(i32::from_le_bytes(little_endian(bytes, order))),
        ScalarType::UInt => f64::from(u32::from_le_bytes(little_endian(bytes, order))),
        ScalarType::Float => f64::from(f32::from_le_bytes(little_endian(bytes, order))),
        ScalarType::Double => f64::from_le_bytes(little_endian(bytes, order)),
    }
}

fn little_endian<const N: usize>(bytes: &[u8], order: ByteOrder) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(bytes);
    if order == ByteOrder::Big {
        array.reverse();
    }
    array
}

/// Where a scalar property lies in a binary row of fixed length.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Bytes from the start of the row.
    pub(super) offset: usize,
    /// Type of the number.
    pub(super) scalar: ScalarType,
}

impl Column {
    /// The value in a row.
    pub(super) fn read(&self, row: &[u8], order: ByteOrder) -> f64 {
        let bytes = &row[self.offset..self.offset + size_of(&self.scalar)];
        decode(&self.scalar, bytes, order)
    }
}

/// The columns of an element in the order of its properties, and the length of a row; `None` when
/// a list makes the length vary.
pub(super) fn fixed_columns(element: &ElementDef) -> Option<(Vec<Column>, usize)> {
    let mut stride = 0;
    let mut columns = Vec::with_capacity(element.properties.len());
    for property in element.properties.values() {
        let PropertyType::Scalar(scalar) = &property.data_type else { return None };
        columns.push(Column { offset: stride, scalar: scalar.clone() });
        stride += size_of(scalar);
    }
    Some((columns, stride))
}

/// Bytes that no row of the element can be shorter than.
pub(super) fn shortest_row(element: &ElementDef) -> usize {
    let property_size = |data_type: &PropertyType| match data_type {
        PropertyType::Scalar(scalar) => size_of(scalar),
        PropertyType::List(count, _) => size_of(count),
    };
    element.properties.values().map(|p| property_size(&p.data_type)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_is_decoded_in_both_byte_orders() {
        let cases: [(ScalarType, &[u8], f64); 8] = [
            (ScalarType::Char, &[0xfe], -2.0),
            (ScalarType::UChar, &[0xfe], 254.0),
            (ScalarType::Short, &[0xfe, 0xff], -2.0),
            (ScalarType::UShort, &[0xfe, 0xff], 65534.0),
            (ScalarType::Int, &[0xfe, 0xff, 0xff, 0xff], -2.0),
            (ScalarType::UInt, &[0xfe, 0xff, 0xff, 0xff], 4294967294.0),
            (ScalarType::Float, &1.5f32.to_le_bytes(), 1.5),
            (ScalarType::Double, &(-1e300f64).to_le_bytes(), -1e300),
        ];
        for (scalar, little, value) in cases {
            assert_eq!(size_of(&scalar), little.len());
            assert_eq!(decode(&scalar, little, ByteOrder::Little), value);
            let big: Vec<u8> = little.iter().rev().copied().collect();
            assert_eq!(decode(&scalar, &big, ByteOrder::Big), value);
        }
    }
}
