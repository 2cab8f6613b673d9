//! How a call ends: a status for the program, a message for its user, and no panic across the edge.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, c_char};
use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use upglow::{CubeFileError, LookupError, ReadCubeError};
use upglow_color::{ContractError, IlluminantError};

/// How a call ended. On any status but `UPGLOW_STATUS_OK` what the call would have written is
/// untouched, and `upglow_message` says why.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpglowStatus {
    /// The call did what it should.
    Ok = 0,
    /// A pointer that must point to something is null.
    NullPointer = 1,
    /// An argument is not what the function's text asks for.
    InvalidArgument = 2,
    /// A file cannot be read.
    File = 3,
    /// A file or its content is no cube that this version reads.
    NotACube = 4,
    /// A color is outside the cube, or no number.
    Outside = 5,
    /// A fault of this library, which it survived; please report it.
    Internal = 6,
}

/// Why a call failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{argument} is null, expected a pointer")]
    Null { argument: &'static str },
    #[error("{argument} is at address {address:#x}, expected a multiple of {alignment}")]
    Misaligned { argument: &'static str, address: usize, alignment: usize },
    #[error("{argument} has {found} {what}, expected at most {most}")]
    TooMany { argument: &'static str, what: &'static str, found: usize, most: usize },
    #[error("{argument} is not UTF-8, expected text")]
    NotText { argument: &'static str },
    #[error("material is empty, expected one that upglow_look_up filled")]
    EmptyMaterial,
    #[error("{argument} overlaps rgb, expected memory of its own")]
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
}

impl Failure {
    fn status(&self) -> UpglowStatus {
        match self {
            Self::Null { .. } => UpglowStatus::NullPointer,
            Self::File(CubeFileError::Read { .. }) => UpglowStatus::File,
            Self::File(_) | Self::Cube(_) => UpglowStatus::NotACube,
            Self::Lookup(_) => UpglowStatus::Outside,
            _ => UpglowStatus::InvalidArgument,
        }
    }
}

/// Does the work of a call. A panic ends here: across the edge it would end the program.
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
    keep(format_args!("a fault of upglow: {}", text.unwrap_or("no reason given")));
    // Dropping it could panic again.
    std::mem::forget(payload);
    UpglowStatus::Internal
}

/// Room for a message, with its final zero. Messages of half this length are rare; a longer one is
/// cut. It is fixed so that a failed look-up allocates no more than one that succeeds.
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
    /// Takes whole characters while there is room, and no zero byte, which would end the text.
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
        // What does not fit is cut: half a reason is better than none.
        message.write_fmt(text).ok();
        message.bytes[message.length] = 0;
    });
}

/// Why the last call that failed on this thread did so: one line of English in UTF-8, without a
/// period; empty if none failed yet.
///
/// It is this thread's own and lasts until the thread's next failure or its end; copy what must
/// last longer. Calls that succeed leave it as it is.
#[unsafe(no_mangle)]
pub extern "C" fn upglow_message() -> *const c_char {
    MESSAGE.with(|message| {
        let message = message.as_ptr();
        // SAFETY: the thread's message is alive, and only the address of a field is taken.
        unsafe { (&raw const (*message).bytes).cast() }
    })
}

/// The name of a status, as in `UPGLOW_STATUS_OUTSIDE`. Any number is allowed: one that is no
/// status is "unknown status". It lives as long as the program.
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
        assert_eq!(message(), "a fault of upglow: 3 bells");
        assert_eq!(guarded(|| std::panic::panic_any(3)), UpglowStatus::Internal);
        assert_eq!(message(), "a fault of upglow: no reason given");
    }

    #[test]
    fn a_message_is_its_threads_own_and_outlasts_success() {
        assert_eq!(
            guarded(|| Err(Failure::Overlap { argument: "xyz" })),
            UpglowStatus::InvalidArgument
        );
        std::thread::spawn(|| assert_eq!(message(), "")).join().unwrap();
        assert_eq!(guarded(|| Ok(())), UpglowStatus::Ok);
        assert_eq!(message(), "xyz overlaps rgb, expected memory of its own");
    }

    #[test]
    fn a_long_message_is_cut_between_characters() {
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
