//! The Python names that a checkpoint may mention. There is no other way for a pickle to reach
//! anything, so a name that is not here cannot do harm: the file is refused.

use super::tensor::ElementType;

/// What an allowed name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Global {
    /// A dictionary; the order is kept by ours as well.
    OrderedDict,
    /// (storage, offset, shape, strides, …) → tensor.
    RebuildTensor,
    /// (tensor, …) → the tensor.
    Parameter,
    /// The type of a storage, named in its persistent id.
    Storage(ElementType),
}

/// Looks a name up in the list.
pub(super) fn resolve(module: &str, name: &str) -> Option<Global> {
    Some(match (module, name) {
        ("collections", "OrderedDict") => Global::OrderedDict,
        ("torch._utils", "_rebuild_tensor_v2") => Global::RebuildTensor,
        ("torch._utils", "_rebuild_parameter") | ("torch.nn.parameter", "Parameter") => {
            Global::Parameter
        }
        ("torch", storage) => Global::Storage(match storage {
            "HalfStorage" => ElementType::F16,
            "BFloat16Storage" => ElementType::BF16,
            "FloatStorage" => ElementType::F32,
            "DoubleStorage" => ElementType::F64,
            "ByteStorage" => ElementType::U8,
            "CharStorage" => ElementType::I8,
            "ShortStorage" => ElementType::I16,
            "IntStorage" => ElementType::I32,
            "LongStorage" => ElementType::I64,
            "BoolStorage" => ElementType::Bool,
            _ => return None,
        }),
        _ => return None,
    })
}
