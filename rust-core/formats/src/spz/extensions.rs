//! Extension records: `u32 type, u32 length, payload`, back to back.

use super::AxisSigns;
use crate::ParseError;
use crate::bytes::ByteReader;

/// Replaces the fixed quantisation of SH; written for a short time in 2025.
const SH_QUANTIZATION: u32 = 0xadbe_0001;
/// Stores the splats along other axes than right, up, back.
const COORDINATE_SYSTEM: u32 = 0xadbe_0003;

/// Reads the records that change what the splats mean. Others (camera limits, geographic
/// references) are left out with a warning that gives their type.
pub(super) fn parse(bytes: &[u8]) -> Result<AxisSigns, ParseError> {
    let mut reader = ByteReader::new(bytes);
    let mut signs = AxisSigns::right_up_back().clone();
    while reader.remaining() > 0 {
        let kind = reader.u32("extension type")?;
        if kind == SH_QUANTIZATION {
            return Err(ParseError::value(
                "extension type",
                "none that changes the quantisation",
                "0xadbe0001 (SPZ_ADOBE_sh_quantization)",
            ));
        }
        let length = reader.u32("extension length")?;
        let payload = reader.take_array(length.into(), 1, "extension payload")?;
        if kind == COORDINATE_SYSTEM {
            signs = axes(ByteReader::new(payload).u32("extension coordinate_system")?)?;
        } else {
            tracing::warn!("SPZ extension {kind:#010x} ({length} bytes) is not read");
        }
    }
    Ok(signs)
}

/// Systems 1 to 8 count left/right, down/up and back/front in binary; 9 to 16 exchange y and z
/// and are not supported. 0 is unspecified and means the default.
fn axes(system: u32) -> Result<AxisSigns, ParseError> {
    let sign = |reversed: bool| if reversed { -1.0 } else { 1.0 };
    match system {
        0 => Ok(AxisSigns::right_up_back().clone()),
        1..=8 => {
            let bits = system - 1;
            // Ours are right (bit set), down (bit clear) and front (bit set).
            Ok(AxisSigns::new([sign(bits & 1 == 0), sign(bits & 2 != 0), sign(bits & 4 == 0)]))
        }
        _ => Err(ParseError::value("extension coordinate_system", "0 to 8", system)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(kind: u32, payload: &[u8]) -> Vec<u8> {
        [&kind.to_le_bytes()[..], &(payload.len() as u32).to_le_bytes(), payload].concat()
    }

    #[test]
    fn stored_axes_are_honoured() {
        let signs_of = |system: u32| parse(&record(COORDINATE_SYSTEM, &system.to_le_bytes()));
        // Right-up-back is 4 and the default, right-down-front is 6 and ours, left-up-front is 7.
        assert_eq!(&signs_of(4).unwrap(), AxisSigns::right_up_back());
        assert_eq!(&signs_of(0).unwrap(), AxisSigns::right_up_back());
        assert_eq!(signs_of(6).unwrap().position, [1.0, 1.0, 1.0]);
        assert_eq!(signs_of(7).unwrap().position, [-1.0, -1.0, 1.0]);
        let error = signs_of(12).unwrap_err().to_string();
        assert!(error.starts_with("extension coordinate_system: expected 0 to 8"), "{error}");
    }

    #[test]
    fn records_that_change_nothing_are_passed_over() {
        let bytes = [record(0xadbe_0002, &[0; 12]), record(0x1234_5678, &[])].concat();
        assert_eq!(&parse(&bytes).unwrap(), AxisSigns::right_up_back());
    }

    #[test]
    fn another_sh_quantisation_is_refused_by_name() {
        let error = parse(&record(SH_QUANTIZATION, &[0; 10])).unwrap_err().to_string();
        assert!(error.contains("SPZ_ADOBE_sh_quantization"), "{error}");
    }

    #[test]
    fn a_length_beyond_the_block_is_refused() {
        let mut bytes = record(0x1234_5678, &[1, 2, 3]);
        bytes[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = parse(&bytes).unwrap_err().to_string();
        assert!(error.starts_with("extension payload: expected 4294967295 bytes"), "{error}");
    }
}
