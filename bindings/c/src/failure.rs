//! How a call ends: a status for the program, a message for its user, and no panic that leaves Rust.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, c_char};
use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use upglow::{CubeFileError, LookupError, ReadCubeError};
use upglow_color::{ContractError, IlluminantError, ReducedBasisError, RgbSpaceError};

/// How a call ended. On any status but `UPGLOW_STATUS_OK` the call has not written its results, and
/// `upglow_message` returns the reason.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpglowStatus {
    /// Success.
    Ok = 0,
    /// A pointer that must point to something is null.
    NullPointer = 1,
    /// An argument does not meet the requirements in the function's documentation.
    InvalidArgument = 2,
    /// A file cannot be read.
    File = 3,
    /// A file or its content is not a cube that this version reads.
    NotACube = 4,
    /// A color is outside the cube, or NaN.
    Outside = 5,
    /// An error in this library, which can still be used; please report it.
    Internal = 6,
}

/// Why a call failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{argument} is null, expected a pointer")]
    Null { argument: &'static str },
    #[error("{argument} is at address {address:#x}, expected a multiple of {alignment}")]
    Misaligned { argument: &'static str, address: usize, alignment: usize },
    #[error("{argument} has {found} values, expected at most {most}")]
    TooMany { argument: &'static str, found: usize, most: usize },
    #[error("{argument} is not UTF-8, expected text")]
    NotText { argument: &'static str },
    #[error("material is empty, expected one that upglow_look_up filled")]
    EmptyMaterial,
    #[error("{argument} overlaps rgb, expected separate memory")]
    Overlap { argument: &'static str },
    #[error(transparent)]
    File(#[from] CubeFileError),
    #[error(transparent)]
    Cube(#[from] ReadCubeError),
    #[error(transparent)]
    Lookup(#[from] LookupError),
    #[error(transparent)]
    Illuminant(#[from] IlluminantError),
    #[error(transparent)]
    Contract(#[from] ContractError),
    #[error(transparent)]
    ReducedBasis(#[from] ReducedBasisError),
    #[error(transparent)]
    RgbSpace(#[from] RgbSpaceError),
}

impl Failure {
    fn status(&self) -> UpglowStatus {
        match self {
            Self::Null { .. } => UpglowStatus::NullPointer,
            Self::File(CubeFileError::Io { .. }) => UpglowStatus::File,
            Self::File(_) | Self::Cube(_) => UpglowStatus::NotACube,
            Self::Lookup(_) => UpglowStatus::Outside,
            _ => UpglowStatus::InvalidArgument,
        }
    }
}

/// Does the work of a call. It catches panics, which would abort the program if they reached C.
#[inline(always)]
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> UpglowStatus {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => UpglowStatus::Ok,
        Ok(Err(failure)) => failed(&failure),
        Err(payload) => panicked(payload),
    }
}

#[cold]
fn failed(failure: &Failure) -> UpglowStatus {
    keep(format_args!("{failure}"));
    failure.status()
}

#[cold]
fn panicked(payload: Box<dyn Any + Send>) -> UpglowStatus {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
    keep(format_args!("internal error of upglow: {}", text.unwrap_or("no reason given")));
    // Dropping the payload could panic again.
    std::mem::forget(payload);
    UpglowStatus::Internal
}

/// Room for a message, with its final zero byte; a longer one is truncated. The size is fixed, so
/// that a look-up that fails does not allocate either.
const MESSAGE_BYTES: usize = 1024;

/// Text that ends with a zero byte.
struct Message {
    bytes: [u8; MESSAGE_BYTES],
    length: usize,
}

thread_local! {
    static MESSAGE: RefCell<Message> =
        const { RefCell::new(Message { bytes: [0; MESSAGE_BYTES], length: 0 }) };
}

impl Write for Message {
    /// Appends whole characters while there is room, and skips zero bytes, which would end the text.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars().filter(|character| *character != '\0') {
            let end = self.length + character.len_utf8();
            if end >= MESSAGE_BYTES {
                return Err(fmt::Error);
            }
            character.encode_utf8(&mut self.bytes[self.length..end]);
            self.length = end;
        }
        Ok(())
    }
}

fn keep(text: fmt::Arguments<'_>) {
    MESSAGE.with_borrow_mut(|message| {
        message.length = 0;
        // Fails if the text does not fit; the truncated message stays.
        message.write_fmt(text).ok();
        message.bytes[message.length] = 0;
    });
}

/// The reason of the last failure on this thread: one line of English in UTF-8, without a period;
/// empty if no call has failed yet.
///
/// Each thread has its own message. It is valid until the thread's next failure or its end; copy it
/// to keep it longer. Calls that succeed do not change it.
#[unsafe(no_mangle)]
pub extern "C" fn upglow_message() -> *const c_char {
    MESSAGE.with(|message| {
        let message = message.as_ptr();
        // SAFETY: the thread's message is alive, and only the address of a field is taken.
        unsafe { (&raw const (*message).bytes).cast() }
    })
}

/// The name of a status, such as `UPGLOW_STATUS_OUTSIDE`. Any number is allowed; the name of an
/// unknown one is "unknown status". The text is valid until the program ends.
#[unsafe(no_mangle)]
pub extern "C" fn upglow_status_name(status: i32) -> *const c_char {
    name(status).as_ptr()
}

fn name(status: i32) -> &'static CStr {
    /// `[status]`.
    const NAMES: [&CStr; 7] = [
        c"UPGLOW_STATUS_OK",
        c"UPGLOW_STATUS_NULL_POINTER",
        c"UPGLOW_STATUS_INVALID_ARGUMENT",
        c"UPGLOW_STATUS_FILE",
        c"UPGLOW_STATUS_NOT_A_CUBE",
        c"UPGLOW_STATUS_OUTSIDE",
        c"UPGLOW_STATUS_INTERNAL",
    ];
    let name = usize::try_from(status).ok().and_then(|status| NAMES.get(status));
    name.copied().unwrap_or(c"unknown status")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message() -> String {
        // SAFETY: the message ends with a zero byte and is not written to meanwhile.
        unsafe { CStr::from_ptr(upglow_message()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn a_panic_becomes_a_status_and_a_message() {
        assert_eq!(guarded(|| panic!("{} bells", 3)), UpglowStatus::Internal);
        assert_eq!(message(), "internal error of upglow: 3 bells");
        assert_eq!(guarded(|| std::panic::panic_any(3)), UpglowStatus::Internal);
        assert_eq!(message(), "internal error of upglow: no reason given");
    }

    #[test]
    fn each_thread_has_its_own_message_which_success_does_not_change() {
        assert_eq!(
            guarded(|| Err(Failure::Overlap { argument: "xyz" })),
            UpglowStatus::InvalidArgument
        );
        std::thread::spawn(|| assert_eq!(message(), "")).join().unwrap();
        assert_eq!(guarded(|| Ok(())), UpglowStatus::Ok);
        assert_eq!(message(), "xyz overlaps rgb, expected separate memory");
    }

    #[test]
    fn a_long_message_is_truncated_between_characters() {
        keep(format_args!("{}", "é".repeat(MESSAGE_BYTES)));
        assert_eq!(message(), "é".repeat((MESSAGE_BYTES - 1) / 2));
        keep(format_args!("a\0b"));
        assert_eq!(message(), "ab");
    }

    #[test]
    fn every_status_has_its_name() {
        assert_eq!(name(UpglowStatus::Internal as i32), c"UPGLOW_STATUS_INTERNAL");
        assert_eq!(name(UpglowStatus::File as i32), c"UPGLOW_STATUS_FILE");
        for odd in [-1, 7, i32::MIN, i32::MAX] {
            assert_eq!(name(odd), c"unknown status");
        }
    }
}
