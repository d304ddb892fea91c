//! What Swift is told when something goes wrong, and the net under every entry.

use std::any::Any;
#[cfg(feature = "search")]
use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::PoisonError;

use trapeze_formats::{ParseError, ReadError, WriteError};
use trapeze_gpu::GpuError;
#[cfg(feature = "search")]
use trapeze_query::{SearchError, models::ModelError};
use trapeze_scene::SceneError;
use trapeze_scene::edit::EditError;
use trapeze_train::TrainError;
use trapeze_train::backend::BackendError;

/// Kinds of failures. The numbers are part of the surface: Swift's `EngineError.Code` has them too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
#[allow(dead_code, reason = "a number keeps its meaning, whether it is in use or not")]
pub(crate) enum Code {
    /// The caller asked for it to stop.
    Cancelled = 0,
    /// A file or folder that is not there or not readable.
    UnreadableFile = 1,
    /// A file whose content is not what its format says.
    MalformedFile = 2,
    /// A file that cannot be written; a full disk is the usual reason.
    UnwritableFile = 3,
    /// An argument outside its range.
    InvalidArgument = 4,
    /// More memory than there is.
    OutOfMemory = 5,
    /// No usable graphics device.
    NoDevice = 6,
    /// The graphics device was lost, or refused the work.
    DeviceFailed = 7,
    /// The models for text search are not there.
    ModelsMissing = 8,
    /// A dataset that cannot be trained on.
    UnusableDataset = 9,
    /// Training went wrong in spite of lower rates; the last good state is kept.
    TrainingDiverged = 10,
    /// An edit that would leave nothing, or names what is not there.
    InvalidEdit = 11,
    /// A fault of the program: a panic that was caught at the border.
    InternalFault = 12,
}

/// A failure: what kind it is, and one line of English that names file, field and expectation.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{message}")]
pub(crate) struct Failure {
    code: Code,
    message: String,
}

impl Failure {
    /// A failure of this kind.
    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    /// An argument that is not what it should be.
    pub(crate) fn argument(
        name: &str,
        expected: impl std::fmt::Display,
        found: impl std::fmt::Display,
    ) -> Self {
        Self::new(Code::InvalidArgument, format!("{name}: expected {expected}, found {found}"))
    }

    #[cfg(test)]
    pub(crate) fn kind(&self) -> Code {
        self.code
    }

    pub(crate) fn code(&self) -> i32 {
        self.code as i32
    }

    pub(crate) fn message(&self) -> String {
        self.message.clone()
    }

    /// `&*payload`: the box itself is an `Any` too.
    fn of_panic(payload: &(dyn Any + Send)) -> Self {
        let text = payload
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| payload.downcast_ref::<&str>().copied())
            .unwrap_or("a panic without a message");
        // One line, like every other message.
        Self::new(Code::InternalFault, text.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

/// Runs the body of an entry. A panic becomes [`Code::InternalFault`]: it must not reach Swift's
/// frames, which no Rust panic may unwind through.
///
/// Unwinding out of `body` is safe for whoever uses the same objects afterwards, because all that
/// entries change is behind mutexes, which a panic poisons: see [`poisoned`].
pub(crate) fn guarded<T>(body: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(body))
        .unwrap_or_else(|payload| Err(Failure::of_panic(payload.as_ref())))
}

/// Runs the body of an entry that has no way to fail, and answers a panic with `fallback`.
pub(crate) fn guarded_or<T>(fallback: T, body: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or(fallback)
}

/// What a mutex says whose holder has panicked: its content may be half changed and is not used
/// any more.
pub(crate) fn poisoned<T>(_: PoisonError<T>) -> Failure {
    Failure::new(
        Code::InternalFault,
        "expected an object in order, found one whose last call ended with a fault; make it again",
    )
}

/// Something whose destructor is not ours (a device, a trainer): should it panic, the panic ends
/// here and not in Swift's `deinit`.
#[derive(Debug)]
pub(crate) struct Contained<T>(Option<T>);

impl<T> Contained<T> {
    pub(crate) fn new(content: T) -> Self {
        Self(Some(content))
    }

    pub(crate) fn get_mut(&mut self) -> &mut T {
        self.0.as_mut().expect("taken by drop only")
    }
}

impl<T> Drop for Contained<T> {
    fn drop(&mut self) {
        let content = self.0.take();
        // Nobody is left who could be told.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(content)));
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        let code = match &error.source {
            ParseError::Io(_) => Code::UnreadableFile,
            ParseError::OutOfMemory { .. } => Code::OutOfMemory,
            _ => Code::MalformedFile,
        };
        Self::new(code, error.to_string())
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        let code = match &error {
            WriteError::Io { .. } => Code::UnwritableFile,
            WriteError::Unrepresentable { .. } => Code::InvalidArgument,
        };
        Self::new(code, error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::new(Code::InvalidArgument, error.to_string())
    }
}

impl From<EditError> for Failure {
    fn from(error: EditError) -> Self {
        Self::new(Code::InvalidEdit, error.to_string())
    }
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        let code = match &error {
            GpuError::NoAdapter { .. } | GpuError::TooWeak { .. } => Code::NoDevice,
            GpuError::OutOfMemory { .. } => Code::OutOfMemory,
            GpuError::Scene(_) => Code::InvalidArgument,
            _ => Code::DeviceFailed,
        };
        Self::new(code, error.to_string())
    }
}

impl From<TrainError> for Failure {
    fn from(error: TrainError) -> Self {
        let code = match error {
            // Keeps the kind of what could not be read or written.
            TrainError::Read(error) => return error.into(),
            TrainError::Write(error) => return error.into(),
            TrainError::Backend(error) => return error.into(),
            TrainError::Config(_) | TrainError::OtherRun { .. } => Code::InvalidArgument,
            TrainError::Dataset { .. } => Code::UnusableDataset,
            TrainError::Memory { .. } => Code::OutOfMemory,
            TrainError::Diverged { .. } => Code::TrainingDiverged,
        };
        Self::new(code, error.to_string())
    }
}

impl From<BackendError> for Failure {
    fn from(error: BackendError) -> Self {
        let code = match &error {
            BackendError::DeviceLost(_) => Code::DeviceFailed,
            BackendError::OutOfMemory { .. } => Code::OutOfMemory,
            BackendError::View { .. } => Code::UnusableDataset,
            BackendError::Render(_) => Code::InvalidArgument,
            BackendError::MissingTarget { .. } => Code::InternalFault,
        };
        Self::new(code, error.to_string())
    }
}

#[cfg(feature = "search")]
impl From<SearchError> for Failure {
    fn from(error: SearchError) -> Self {
        let code = match error {
            SearchError::Model(error) => return error.into(),
            // Crops are rendered by this crate: what comes back is its own.
            SearchError::Render(source) => {
                let own = source.downcast::<Self>();
                return own
                    .map_or_else(|e| Self::new(Code::InternalFault, e.to_string()), |own| *own);
            }
            SearchError::Cancelled => return crate::work::Work::cancelled(),
            SearchError::NoClusters | SearchError::EmptyText | SearchError::NotEncoded { .. } => {
                Code::InvalidArgument
            }
        };
        Self::new(code, error.to_string())
    }
}

#[cfg(feature = "search")]
impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        let code = match &error {
            ModelError::RuntimeMissing { .. } | ModelError::RuntimeUnusable { .. } => {
                Code::ModelsMissing
            }
            ModelError::File { source, .. } if source.kind() == ErrorKind::NotFound => {
                Code::ModelsMissing
            }
            ModelError::File { .. } => Code::UnreadableFile,
            ModelError::Value { .. } | ModelError::Tower { .. } => Code::MalformedFile,
            ModelError::TextTooLong { .. } => Code::InvalidArgument,
        };
        Self::new(code, error.to_string())
    }
}

/// Panics with this message, so that a test on the other side of the border can see what becomes
/// of it.
pub(crate) fn provoke_panic(message: String) -> Result<(), Failure> {
    guarded(|| panic!("{message}"))
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn a_panic_becomes_one_line_of_an_internal_fault() {
        let failure = provoke_panic("first\n  second".into()).unwrap_err();
        assert_eq!(failure, Failure::new(Code::InternalFault, "first second"));
        let failure = guarded::<()>(|| std::panic::panic_any(7)).unwrap_err();
        assert_eq!(failure.message(), "a panic without a message");
        assert_eq!(guarded_or(3, || panic!("x")), 3);
    }

    #[test]
    fn what_a_panic_left_half_changed_is_not_used_again() {
        let state = Mutex::new(1);
        let change = || {
            guarded(|| {
                let mut value = state.lock().map_err(poisoned)?;
                *value += 1;
                assert!(*value != 2, "half-way");
                Ok(())
            })
        };
        assert_eq!(change().unwrap_err().message(), "half-way");
        assert!(change().unwrap_err().message().contains("make it again"));
    }

    #[test]
    fn a_destructor_that_panics_is_contained() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("in drop");
            }
        }
        drop(Contained::new(Bomb));
    }
}
