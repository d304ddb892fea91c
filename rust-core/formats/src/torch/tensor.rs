//! Tensors as views of storages, with bounds that are checked when the view is made.

use half::{bf16, f16};

use crate::ParseError;

/// More dimensions than any tensor that is read here has.
pub(super) const MAX_DIMENSIONS: usize = 8;

/// Type of a storage's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementType {
    F16,
    BF16,
    F32,
    F64,
    U8,
    I8,
    I16,
    I32,
    I64,
    Bool,
}

impl ElementType {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 | Self::Bool => 1,
            Self::F16 | Self::BF16 | Self::I16 => 2,
            Self::F32 | Self::I32 => 4,
            Self::F64 | Self::I64 => 8,
        }
    }
}

/// A storage by the name of its zip member.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Storage {
    pub(super) element: ElementType,
    /// Name of the member below `data/`.
    pub(super) key: String,
    /// Elements.
    pub(super) count: u64,
}

/// A strided view of a storage. Made by [`StoredTensor::new`] only, so every element is inside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StoredTensor {
    storage: Storage,
    offset: usize,
    shape: Vec<usize>,
    strides: Vec<usize>,
}

impl StoredTensor {
    /// Checks that the view lies inside its storage and repeats nothing: a tensor with more
    /// elements than its storage (a stride of 0) could ask for any amount of memory.
    pub(super) fn new(
        storage: Storage,
        offset: i64,
        shape: &[i64],
        strides: &[i64],
    ) -> Result<Self, ParseError> {
        let found = || {
            format!("shape {shape:?}, strides {strides:?}, offset {offset} of {}", storage.count)
        };
        let refused = |expected: &str| ParseError::value("tensor", expected, found());
        if shape.len() != strides.len() || shape.len() > MAX_DIMENSIONS {
            return Err(refused("a stride for each of at most 8 dimensions"));
        }
        let not_negative = |numbers: &[i64]| {
            numbers.iter().map(|&n| usize::try_from(n).ok()).collect::<Option<Vec<usize>>>()
        };
        let (Some(shape_), Some(strides_), Ok(offset_)) =
            (not_negative(shape), not_negative(strides), usize::try_from(offset))
        else {
            return Err(refused("no negative number"));
        };
        let count = shape_.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
        let inside = count.is_some_and(|count| {
            count as u64 <= storage.count
                && (count == 0
                    || last_element(offset_, &shape_, &strides_)
                        .is_some_and(|last| (last as u64) < storage.count))
        });
        if !inside {
            return Err(refused("elements inside the storage"));
        }
        Ok(Self { storage, offset: offset_, shape: shape_, strides: strides_ })
    }

    pub(super) fn shape(&self) -> &[usize] {
        &self.shape
    }

    pub(super) fn storage(&self) -> &Storage {
        &self.storage
    }

    pub(super) fn element(&self) -> ElementType {
        self.storage.element
    }

    /// The numbers in row-major order, when they are floats; `data` is the whole storage.
    pub(super) fn floats(&self, data: &[u8]) -> Option<Vec<f32>> {
        Some(match self.element() {
            ElementType::F16 => self.elements(data, |b| f16::from_le_bytes(b).to_f32()),
            ElementType::BF16 => self.elements(data, |b| bf16::from_le_bytes(b).to_f32()),
            ElementType::F32 => self.elements(data, f32::from_le_bytes),
            ElementType::F64 => self.elements(data, |b| f64::from_le_bytes(b) as f32),
            _ => return None,
        })
    }

    /// The numbers in row-major order, when they are integers; `data` is the whole storage.
    pub(super) fn integers(&self, data: &[u8]) -> Option<Vec<i64>> {
        Some(match self.element() {
            ElementType::U8 | ElementType::Bool => self.elements(data, |[b]| b.into()),
            ElementType::I8 => self.elements(data, |b| i8::from_le_bytes(b).into()),
            ElementType::I16 => self.elements(data, |b| i16::from_le_bytes(b).into()),
            ElementType::I32 => self.elements(data, |b| i32::from_le_bytes(b).into()),
            ElementType::I64 => self.elements(data, i64::from_le_bytes),
            _ => return None,
        })
    }

    /// Walks the view in row-major order.
    fn elements<const N: usize, T>(&self, data: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
        let stored = data.as_chunks::<N>().0;
        let count = self.shape.iter().product();
        let mut numbers = Vec::with_capacity(count);
        let mut index = vec![0; self.shape.len()];
        let mut position = self.offset;
        for _ in 0..count {
            numbers.push(number(stored[position]));
            for axis in (0..index.len()).rev() {
                index[axis] += 1;
                if index[axis] < self.shape[axis] {
                    position += self.strides[axis];
                    break;
                }
                position -= (index[axis] - 1) * self.strides[axis];
                index[axis] = 0;
            }
        }
        numbers
    }
}

/// Position in the storage of the last element of a view without an extent of zero.
fn last_element(offset: usize, shape: &[usize], strides: &[usize]) -> Option<usize> {
    shape.iter().zip(strides).try_fold(offset, |last, (&extent, &stride)| {
        last.checked_add((extent - 1).checked_mul(stride)?)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(count: u64, offset: i64, shape: &[i64], strides: &[i64]) -> Result<Vec<i64>, String> {
        let storage = Storage { element: ElementType::U8, key: "0".into(), count };
        let tensor =
            StoredTensor::new(storage, offset, shape, strides).map_err(|e| e.to_string())?;
        let data: Vec<u8> = (0..count as u8).collect();
        Ok(tensor.integers(&data).unwrap())
    }

    #[test]
    fn strides_and_offsets_are_honoured() {
        assert_eq!(view(6, 0, &[2, 3], &[3, 1]).unwrap(), [0, 1, 2, 3, 4, 5]);
        assert_eq!(view(6, 0, &[3, 2], &[1, 3]).unwrap(), [0, 3, 1, 4, 2, 5], "transposed");
        assert_eq!(view(9, 4, &[2, 2], &[3, 1]).unwrap(), [4, 5, 7, 8], "a corner of a 3 × 3");
        assert_eq!(view(6, 5, &[], &[]).unwrap(), [5], "a single number");
        assert!(view(6, 6, &[0, 3], &[3, 1]).unwrap().is_empty());
    }

    #[test]
    fn views_that_leave_their_storage_are_refused() {
        for (offset, shape, strides) in [
            (0, &[7][..], &[1][..]),
            (1, &[6], &[1]),
            (0, &[2, 3], &[4, 1]),
            (6, &[], &[]),
            (i64::MAX, &[1], &[1]),
            (0, &[2], &[i64::MAX]),
            (1, &[2], &[i64::MAX]),
            (0, &[i64::MAX, i64::MAX], &[0, 0]),
            (0, &[1 << 40], &[0]),
            (0, &[7], &[0]),
        ] {
            let error = view(6, offset, shape, strides).unwrap_err();
            assert!(error.contains("elements inside the storage"), "{error}");
        }
        for (offset, shape, strides) in
            [(-1, &[1][..], &[1][..]), (0, &[-1], &[1]), (5, &[2], &[-1])]
        {
            let error = view(6, offset, shape, strides).unwrap_err();
            assert!(error.contains("no negative number"), "{error}");
        }
        assert!(view(6, 0, &[2], &[1, 1]).unwrap_err().contains("a stride for each"));
        assert!(view(6, 0, &[1; 9], &[1; 9]).unwrap_err().contains("at most 8 dimensions"));
    }

    #[test]
    fn every_element_type_is_converted() {
        let tensor = |element, count| {
            let storage = Storage { element, key: "0".into(), count };
            StoredTensor::new(storage, 0, &[count as i64], &[1]).unwrap()
        };
        let halves = [1.5_f32, -2.0].map(|x| f16::from_f32(x).to_le_bytes()).concat();
        assert_eq!(tensor(ElementType::F16, 2).floats(&halves).unwrap(), [1.5, -2.0]);
        let brains = [1.5_f32, -2.0].map(|x| bf16::from_f32(x).to_le_bytes()).concat();
        assert_eq!(tensor(ElementType::BF16, 2).floats(&brains).unwrap(), [1.5, -2.0]);
        let doubles = [0.1_f64, 1e300].map(f64::to_le_bytes).concat();
        assert_eq!(tensor(ElementType::F64, 2).floats(&doubles).unwrap(), [0.1, f32::INFINITY]);
        assert_eq!(tensor(ElementType::I8, 2).integers(&[255, 127]).unwrap(), [-1, 127]);
        let shorts = [-300_i16, 7].map(i16::to_le_bytes).concat();
        assert_eq!(tensor(ElementType::I16, 2).integers(&shorts).unwrap(), [-300, 7]);
        let longs = [i64::MIN, 1].map(i64::to_le_bytes).concat();
        assert_eq!(tensor(ElementType::I64, 2).integers(&longs).unwrap(), [i64::MIN, 1]);
        assert_eq!(tensor(ElementType::I64, 2).floats(&longs), None);
        assert_eq!(tensor(ElementType::F64, 2).integers(&doubles), None);
    }
}
