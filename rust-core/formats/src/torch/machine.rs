//! The pickle virtual machine.
//!
//! Objects live in one array and refer to each other by index. So a list may contain itself, an
//! object may be mentioned a million times, and nesting may be as deep as the file is long: nothing
//! here recurses, and no opcode makes more than one object, so memory is bounded by the length of
//! the pickle.

use std::collections::{BTreeMap, HashMap};

use super::globals::{Global, resolve};
use super::opcodes as op;
use super::tensor::{MAX_DIMENSIONS, Storage, StoredTensor};
use crate::ParseError;
use crate::bytes::ByteReader;

/// Longest pickle that is executed: 2 kB hold the network that this program is about.
pub(super) const MAX_PICKLE_BYTES: u64 = 1 << 20;

/// Longest name of a tensor or a storage. Names are copied and compared each time that they are
/// mentioned, which a memo makes cheap to do often.
const MAX_NAME_BYTES: usize = 256;

const HIGHEST_PROTOCOL: u8 = 5;

/// Index of an object.
type Handle = usize;

#[derive(Debug)]
enum Object<'a> {
    None,
    Bool,
    Int(i64),
    Float,
    Text(&'a str),
    Tuple(Vec<Handle>),
    List(Vec<Handle>),
    Dict(Vec<(Handle, Handle)>),
    Global(Global),
    Storage(Box<Storage>),
    Tensor(Box<StoredTensor>),
}

impl Object<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool => "a boolean",
            Self::Int(_) => "an integer",
            Self::Float => "a float",
            Self::Text(_) => "text",
            Self::Tuple(_) => "a tuple",
            Self::List(_) => "a list",
            Self::Dict(_) => "a dictionary",
            Self::Global(_) => "a Python name",
            Self::Storage(_) => "a storage",
            Self::Tensor(_) => "a tensor",
        }
    }
}

/// A value of the dictionary that a checkpoint is.
#[derive(Debug, PartialEq)]
pub(super) enum Entry {
    Tensor(StoredTensor),
    /// Something else, by its kind.
    Other(&'static str),
}

/// Executes a pickle of a dictionary with text keys; of equal keys the last one counts.
pub(super) fn unpickle_dictionary(pickle: &[u8]) -> Result<BTreeMap<String, Entry>, ParseError> {
    let mut machine = Machine::new(pickle);
    while machine.step()? {}
    let root = machine.pop("STOP")?;
    machine.reader.expect_end("data.pkl")?;
    machine.entries(root)
}

/// Names end up in messages as well, which are one line.
fn is_plain_name(name: &str) -> bool {
    name.len() <= MAX_NAME_BYTES && !name.chars().any(char::is_control)
}

struct Machine<'a> {
    reader: ByteReader<'a>,
    length: usize,
    objects: Vec<Object<'a>>,
    stack: Vec<Handle>,
    /// Heights of the stack at which MARK was executed.
    marks: Vec<usize>,
    memo: HashMap<u32, Handle>,
}

impl<'a> Machine<'a> {
    fn new(pickle: &'a [u8]) -> Self {
        Self {
            reader: ByteReader::new(pickle),
            length: pickle.len(),
            objects: Vec::new(),
            stack: Vec::new(),
            marks: Vec::new(),
            memo: HashMap::new(),
        }
    }

    fn entries(&self, root: Handle) -> Result<BTreeMap<String, Entry>, ParseError> {
        let Object::Dict(items) = &self.objects[root] else {
            let found = self.objects[root].kind();
            return Err(ParseError::value("data.pkl", "a dictionary of tensors", found));
        };
        let mut entries = BTreeMap::new();
        for &(key, value) in items {
            let name = match self.objects[key] {
                Object::Text(name) if is_plain_name(name) => name,
                Object::Text(name) => {
                    let expected = "at most 256 printable characters";
                    return Err(ParseError::value("key in data.pkl", expected, name));
                }
                ref other => {
                    return Err(ParseError::value("key in data.pkl", "text", other.kind()));
                }
            };
            entries.insert(name, value);
        }
        let entry = |(name, value): (&str, Handle)| {
            let entry = match &self.objects[value] {
                Object::Tensor(tensor) => Entry::Tensor((**tensor).clone()),
                other => Entry::Other(other.kind()),
            };
            (name.to_owned(), entry)
        };
        Ok(entries.into_iter().map(entry).collect())
    }

    /// Executes one opcode; `false` after STOP.
    fn step(&mut self) -> Result<bool, ParseError> {
        let opcode = self.reader.u8("opcode in data.pkl")?;
        match opcode {
            op::STOP => return Ok(false),
            op::PROTO => {
                let protocol = self.reader.u8("PROTO")?;
                if protocol > HIGHEST_PROTOCOL {
                    return Err(self.refused("pickle protocol", "at most 5", protocol));
                }
            }
            op::FRAME => {
                self.reader.u64("FRAME")?;
            }
            op::MARK => self.marks.push(self.stack.len()),
            op::POP => {
                self.pop("POP")?;
            }
            op::POP_MARK => {
                self.pop_to_mark("POP_MARK")?;
            }
            op::DUP => {
                let top = self.top("DUP")?;
                self.stack.push(top);
            }
            op::NONE => self.push(Object::None),
            op::NEWTRUE | op::NEWFALSE => self.push(Object::Bool),
            op::BININT1 | op::BININT2 | op::BININT | op::LONG1 => {
                let number = self.integer(opcode)?;
                self.push(Object::Int(number));
            }
            op::BINFLOAT => {
                self.reader.u64("BINFLOAT")?;
                self.push(Object::Float);
            }
            op::SHORT_BINUNICODE | op::BINUNICODE => {
                let text = self.text(opcode)?;
                self.push(Object::Text(text));
            }
            op::EMPTY_TUPLE => self.push(Object::Tuple(Vec::new())),
            op::TUPLE1 => self.tuple(1)?,
            op::TUPLE2 => self.tuple(2)?,
            op::TUPLE3 => self.tuple(3)?,
            op::TUPLE => {
                let items = self.pop_to_mark("TUPLE")?;
                self.push(Object::Tuple(items));
            }
            op::EMPTY_LIST => self.push(Object::List(Vec::new())),
            op::APPEND => {
                let item = self.pop("APPEND")?;
                self.append("APPEND", vec![item])?;
            }
            op::APPENDS => {
                let items = self.pop_to_mark("APPENDS")?;
                self.append("APPENDS", items)?;
            }
            op::EMPTY_DICT => self.push(Object::Dict(Vec::new())),
            op::SETITEM => {
                let (value, key) = (self.pop("SETITEM")?, self.pop("SETITEM")?);
                self.set_items("SETITEM", &[key, value])?;
            }
            op::SETITEMS => {
                let items = self.pop_to_mark("SETITEMS")?;
                self.set_items("SETITEMS", &items)?;
            }
            op::BINPUT | op::LONG_BINPUT | op::MEMOIZE => self.memoize(opcode)?,
            op::BINGET | op::LONG_BINGET => self.recall(opcode)?,
            op::GLOBAL | op::STACK_GLOBAL => self.global(opcode)?,
            op::BINPERSID => self.persistent_id()?,
            op::REDUCE => self.reduce()?,
            op::BUILD => self.build()?,
            _ => {
                let found = format!("{} ({opcode:#04x})", op::refused_name(opcode));
                return Err(self.refused("opcode", "one that dictionaries of tensors use", found));
            }
        }
        Ok(true)
    }

    /// An error at the current position of the pickle.
    fn refused(
        &self,
        what: &str,
        expected: impl Into<String>,
        found: impl std::fmt::Display,
    ) -> ParseError {
        let position = self.length - self.reader.remaining();
        ParseError::value(format!("data.pkl, {what} before byte {position}"), expected, found)
    }

    fn push(&mut self, object: Object<'a>) {
        self.stack.push(self.objects.len());
        self.objects.push(object);
    }

    /// The floor below which an opcode must not take objects: they belong to an open MARK.
    fn floor(&self) -> usize {
        self.marks.last().copied().unwrap_or(0)
    }

    fn top(&self, opcode: &str) -> Result<Handle, ParseError> {
        match self.stack.last() {
            Some(&top) if self.stack.len() > self.floor() => Ok(top),
            _ => Err(self.refused(opcode, "an object on the stack", "none")),
        }
    }

    fn pop(&mut self, opcode: &str) -> Result<Handle, ParseError> {
        let top = self.top(opcode)?;
        self.stack.pop();
        Ok(top)
    }

    fn pop_to_mark(&mut self, opcode: &str) -> Result<Vec<Handle>, ParseError> {
        match self.marks.pop() {
            Some(mark) => Ok(self.stack.split_off(mark)),
            None => Err(self.refused(opcode, "a MARK before it", "none")),
        }
    }

    fn integer(&mut self, opcode: u8) -> Result<i64, ParseError> {
        Ok(match opcode {
            op::BININT1 => self.reader.u8("BININT1")?.into(),
            op::BININT2 => u16::from_le_bytes(self.reader.array("BININT2")?).into(),
            op::BININT => i32::from_le_bytes(self.reader.array("BININT")?).into(),
            _ => {
                let length = self.reader.u8("LONG1")?;
                if length > 8 {
                    return Err(self.refused("LONG1", "at most 8 bytes", length));
                }
                let bytes = self.reader.take(length.into(), "LONG1")?;
                // Two's complement of any length: the top bit of the last byte is the sign.
                let sign = bytes.last().map_or(0, |&last| if last >= 0x80 { 0xff } else { 0 });
                let mut extended = [sign; 8];
                extended[..bytes.len()].copy_from_slice(bytes);
                i64::from_le_bytes(extended)
            }
        })
    }

    fn text(&mut self, opcode: u8) -> Result<&'a str, ParseError> {
        let length = match opcode {
            op::SHORT_BINUNICODE => self.reader.u8("SHORT_BINUNICODE")?.into(),
            _ => self.reader.u32("BINUNICODE")?,
        };
        let bytes = self.reader.take_array(length.into(), 1, "text in data.pkl")?;
        std::str::from_utf8(bytes).map_err(|_| self.refused("text", "UTF-8", bytes.escape_ascii()))
    }

    fn tuple(&mut self, length: usize) -> Result<(), ParseError> {
        if self.stack.len() - self.floor() < length {
            let found = self.stack.len() - self.floor();
            return Err(self.refused("TUPLE", format!("{length} objects on the stack"), found));
        }
        let items = self.stack.split_off(self.stack.len() - length);
        self.push(Object::Tuple(items));
        Ok(())
    }

    fn append(&mut self, opcode: &str, items: Vec<Handle>) -> Result<(), ParseError> {
        let target = self.top(opcode)?;
        match &mut self.objects[target] {
            Object::List(list) => list.extend(items),
            other => {
                let found = other.kind();
                return Err(self.refused(opcode, "a list", found));
            }
        }
        Ok(())
    }

    fn set_items(&mut self, opcode: &str, items: &[Handle]) -> Result<(), ParseError> {
        let target = self.top(opcode)?;
        if !items.len().is_multiple_of(2) {
            return Err(self.refused(opcode, "a value for each key", items.len()));
        }
        match &mut self.objects[target] {
            Object::Dict(dict) => {
                dict.extend(items.chunks_exact(2).map(|pair| (pair[0], pair[1])));
            }
            other => {
                let found = other.kind();
                return Err(self.refused(opcode, "a dictionary", found));
            }
        }
        Ok(())
    }

    fn memoize(&mut self, opcode: u8) -> Result<(), ParseError> {
        let slot = match opcode {
            op::BINPUT => self.reader.u8("BINPUT")?.into(),
            op::LONG_BINPUT => self.reader.u32("LONG_BINPUT")?,
            // At most one entry for each byte of the pickle, so the number fits.
            _ => self.memo.len() as u32,
        };
        let top = self.top("memo")?;
        self.memo.insert(slot, top);
        Ok(())
    }

    fn recall(&mut self, opcode: u8) -> Result<(), ParseError> {
        let slot = match opcode {
            op::BINGET => self.reader.u8("BINGET")?.into(),
            _ => self.reader.u32("LONG_BINGET")?,
        };
        match self.memo.get(&slot) {
            Some(&handle) => self.stack.push(handle),
            None => return Err(self.refused("memo", "a slot that was filled", slot)),
        }
        Ok(())
    }

    fn global(&mut self, opcode: u8) -> Result<(), ParseError> {
        let (module, name) = if opcode == op::GLOBAL {
            (self.line()?, self.line()?)
        } else {
            let (name, module) = (self.pop("STACK_GLOBAL")?, self.pop("STACK_GLOBAL")?);
            match (&self.objects[module], &self.objects[name]) {
                (&Object::Text(module), &Object::Text(name)) => (module, name),
                (module, _) => {
                    return Err(self.refused("STACK_GLOBAL", "two names", module.kind()));
                }
            }
        };
        let global = resolve(module, name).ok_or_else(|| {
            let expected = "a name that tensors need";
            self.refused("global", expected, format!("{module}.{name}"))
        })?;
        self.push(Object::Global(global));
        Ok(())
    }

    fn line(&mut self) -> Result<&'a str, ParseError> {
        let bytes = self.reader.take_line("GLOBAL")?;
        std::str::from_utf8(bytes)
            .map_err(|_| self.refused("GLOBAL", "UTF-8", bytes.escape_ascii()))
    }

    /// ('storage', type, key, device, number of elements); the device does not matter here.
    fn persistent_id(&mut self) -> Result<(), ParseError> {
        let id = self.pop("BINPERSID")?;
        let storage = self.storage(id).ok_or_else(|| {
            let expected = "('storage', type, key, device, count)";
            self.refused("BINPERSID", expected, self.objects[id].kind())
        })?;
        self.push(Object::Storage(Box::new(storage)));
        Ok(())
    }

    fn storage(&self, id: Handle) -> Option<Storage> {
        let Object::Tuple(items) = &self.objects[id] else { return None };
        let &[kind, element, key, _, count] = items.as_slice() else { return None };
        match (
            &self.objects[kind],
            &self.objects[element],
            &self.objects[key],
            &self.objects[count],
        ) {
            (
                Object::Text("storage"),
                &Object::Global(Global::Storage(element)),
                &Object::Text(key),
                &Object::Int(count),
            ) if is_plain_name(key) => {
                Some(Storage { element, key: key.to_owned(), count: u64::try_from(count).ok()? })
            }
            _ => None,
        }
    }

    /// Calls one of the allowed functions.
    fn reduce(&mut self) -> Result<(), ParseError> {
        let (arguments, function) = (self.pop("REDUCE")?, self.pop("REDUCE")?);
        let Object::Global(function) = self.objects[function] else {
            let found = self.objects[function].kind();
            return Err(self.refused("REDUCE", "a function that tensors need", found));
        };
        let Object::Tuple(arguments) = &self.objects[arguments] else {
            let found = self.objects[arguments].kind();
            return Err(self.refused("REDUCE", "a tuple of arguments", found));
        };
        match (function, &arguments[..]) {
            (Global::OrderedDict, []) => self.push(Object::Dict(Vec::new())),
            (Global::Parameter, &[tensor, ..])
                if matches!(self.objects[tensor], Object::Tensor(_)) =>
            {
                self.stack.push(tensor);
            }
            (Global::RebuildTensor, &[storage, offset, shape, strides, ..]) => {
                let tensor = self.rebuild_tensor(storage, offset, shape, strides)?;
                self.push(Object::Tensor(Box::new(tensor)));
            }
            _ => {
                let found = format!("{} arguments for {function:?}", arguments.len());
                return Err(self.refused("REDUCE", "a call that tensors need", found));
            }
        }
        Ok(())
    }

    fn rebuild_tensor(
        &self,
        storage: Handle,
        offset: Handle,
        shape: Handle,
        strides: Handle,
    ) -> Result<StoredTensor, ParseError> {
        match (
            &self.objects[storage],
            &self.objects[offset],
            self.integers(shape),
            self.integers(strides),
        ) {
            (Object::Storage(storage), &Object::Int(offset), Some(shape), Some(strides)) => {
                StoredTensor::new((**storage).clone(), offset, &shape, &strides)
            }
            (storage, ..) => {
                let expected = "(storage, offset, shape, strides)";
                Err(self.refused("_rebuild_tensor_v2", expected, storage.kind()))
            }
        }
    }

    /// BUILD sets attributes. A state dict has `_metadata`, which says nothing about tensors.
    fn build(&mut self) -> Result<(), ParseError> {
        self.pop("BUILD")?;
        let target = self.top("BUILD")?;
        match &self.objects[target] {
            Object::Dict(_) => Ok(()),
            other => Err(self.refused("BUILD", "a dictionary", other.kind())),
        }
    }

    /// A short tuple of integers: a shape or strides.
    fn integers(&self, handle: Handle) -> Option<Vec<i64>> {
        let Object::Tuple(items) = &self.objects[handle] else { return None };
        if items.len() > MAX_DIMENSIONS {
            return None;
        }
        items
            .iter()
            .map(|&item| match self.objects[item] {
                Object::Int(number) => Some(number),
                _ => None,
            })
            .collect()
    }
}
