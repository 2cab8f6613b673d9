//! Pointers from C, checked as far as possible.

use std::ffi::{CStr, c_char};
use std::ptr::NonNull;

use crate::failure::{Failure, UpglowStatus, guarded};

fn checked<T>(pointer: *const T, argument: &'static str) -> Result<NonNull<T>, Failure> {
    let checked = NonNull::new(pointer.cast_mut()).ok_or(Failure::Null { argument })?;
    if !checked.is_aligned() {
        let (address, alignment) = (pointer.addr(), align_of::<T>());
        return Err(Failure::Misaligned { argument, address, alignment });
    }
    Ok(checked)
}

/// The value that a pointer points to.
///
/// # Safety
///
/// It is null or points to a `T` that lives, and is not written to, for `'a`.
#[inline(always)]
pub(crate) unsafe fn borrowed<'a, T>(
    pointer: *const T,
    argument: &'static str,
) -> Result<&'a T, Failure> {
    let pointer = checked(pointer, argument)?;
    // SAFETY: it is neither null nor misaligned, and the caller promises the rest.
    Ok(unsafe { pointer.as_ref() })
}

/// The first `N` values of an array.
///
/// # Safety
///
/// It is null or points to `N` values.
#[inline(always)]
pub(crate) unsafe fn array<T: Copy, const N: usize>(
    pointer: *const T,
    argument: &'static str,
) -> Result<[T; N], Failure> {
    // SAFETY: an array has the layout of its values; the caller promises the rest.
    unsafe { borrowed(pointer.cast::<[T; N]>(), argument) }.copied()
}

/// An array of `length` values; empty for length 0, whatever the pointer.
///
/// # Safety
///
/// It is null or points to `length` values that live, and are not written to, for `'a`.
pub(crate) unsafe fn slice<'a, T>(
    pointer: *const T,
    length: usize,
    argument: &'static str,
) -> Result<&'a [T], Failure> {
    let values = checked_values(pointer, length, argument)?;
    // SAFETY: neither null nor misaligned, no larger than any object; the caller promises the rest.
    Ok(unsafe { values.as_ref() })
}

/// An array of `length` values to write; empty for length 0, whatever the pointer.
///
/// # Safety
///
/// It is null or points to `length` values that nobody else touches for `'a`; those that were never
/// written are not read.
pub(crate) unsafe fn slice_mut<'a, T>(
    pointer: *mut T,
    length: usize,
    argument: &'static str,
) -> Result<&'a mut [T], Failure> {
    let mut values = checked_values(pointer.cast_const(), length, argument)?;
    // SAFETY: neither null nor misaligned, no larger than any object; the caller promises the rest.
    Ok(unsafe { values.as_mut() })
}

/// An array of `length` values, of any address for length 0.
fn checked_values<T>(
    pointer: *const T,
    length: usize,
    argument: &'static str,
) -> Result<NonNull<[T]>, Failure> {
    // No object is larger; a greater length is often a negative number, converted.
    let most = isize::MAX.unsigned_abs() / size_of::<T>();
    if length > most {
        return Err(Failure::TooMany { argument, found: length, most });
    }
    let first = if length == 0 { NonNull::dangling() } else { checked(pointer, argument)? };
    Ok(NonNull::slice_from_raw_parts(first, length))
}

/// Refuses to write `count` values where as many colors are read: Rust requires them not to overlap.
pub(crate) fn refuse_overlap<T>(
    rgb: *const f32,
    written: *const T,
    count: usize,
    argument: &'static str,
) -> Result<(), Failure> {
    let [read, write] =
        [size_of::<[f32; 3]>(), size_of::<T>()].map(|size| count.saturating_mul(size));
    let (rgb, written) = (rgb.addr(), written.addr());
    let apart = rgb.saturating_add(read) <= written || written.saturating_add(write) <= rgb;
    if count == 0 || rgb == 0 || written == 0 || apart {
        return Ok(());
    }
    Err(Failure::Overlap { argument })
}

/// Text that ends with a zero byte.
///
/// # Safety
///
/// It is null or points to bytes that live, and are not written to, for `'a`; one of them is zero.
pub(crate) unsafe fn text<'a>(
    pointer: *const c_char,
    argument: &'static str,
) -> Result<&'a CStr, Failure> {
    let pointer = checked(pointer, argument)?;
    // SAFETY: it is not null, and the caller promises the rest.
    Ok(unsafe { CStr::from_ptr(pointer.as_ptr()) })
}

/// Memory for a result, which is written at the end of a call that succeeds, and never otherwise.
#[derive(Debug)]
pub(crate) struct Output<T>(NonNull<T>);

impl<T> Output<T> {
    /// # Safety
    ///
    /// The pointer is null or points to memory for a `T`, initialized or not, that nobody else
    /// touches until it is written.
    #[inline(always)]
    pub(crate) unsafe fn new(pointer: *mut T, argument: &'static str) -> Result<Self, Failure> {
        checked(pointer, argument).map(Self)
    }

    /// The same memory, for a `U`.
    ///
    /// # Safety
    ///
    /// There is room for a `U`, which is aligned no more strictly than a `T`.
    #[inline(always)]
    pub(crate) unsafe fn narrowed<U>(self) -> Output<U> {
        Output(self.0.cast())
    }

    #[inline(always)]
    pub(crate) fn write(self, value: T) {
        // SAFETY: `new` refused what is null or misaligned, and its caller promised the rest.
        unsafe { self.0.write(value) };
    }
}

/// Frees what `Box::into_raw` made; null does nothing. Returns the status of the call.
///
/// # Safety
///
/// The pointer is null or came from `Box::into_raw`, was not freed before, and nobody uses it.
pub(crate) unsafe fn destroy<T>(pointer: *mut T) -> UpglowStatus {
    guarded(|| {
        if !pointer.is_null() {
            // SAFETY: the caller's promise.
            drop(unsafe { Box::from_raw(pointer) });
        }
        Ok(())
    })
}

/// Compiles only if threads may share a `T`.
pub(crate) const fn assert_shared_by_threads<T: Send + Sync>() {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_null_or_misaligned_is_refused_by_name() {
        // SAFETY: null is refused.
        let null = unsafe { array::<f32, 3>(std::ptr::null(), "rgb") }.unwrap_err();
        assert_eq!(null.to_string(), "rgb is null, expected a pointer");
        let odd = std::ptr::without_provenance::<f32>(0x1002);
        // SAFETY: a misaligned pointer is refused.
        let odd = unsafe { array::<f32, 3>(odd, "rgb") }.unwrap_err();
        assert_eq!(odd.to_string(), "rgb is at address 0x1002, expected a multiple of 4");
    }

    #[test]
    fn arrays_that_share_a_byte_overlap_and_neighbors_do_not() {
        let at = std::ptr::without_provenance::<f32>;
        let xyz =
            |rgb, xyz, count| refuse_overlap::<[f32; 3]>(at(rgb), at(xyz).cast(), count, "xyz");
        assert!(xyz(1000, 1024, 2).is_ok() && xyz(1024, 1000, 2).is_ok());
        assert!(xyz(1000, 1000, 0).is_ok());
        for overlapping in [1000, 1020, 980] {
            assert!(xyz(1000, overlapping, 2).is_err());
        }
        let wide = |rgb, written| refuse_overlap::<[u64; 32]>(at(rgb), at(written).cast(), 2, "x");
        assert!(wide(1512, 1000).is_ok() && wide(1508, 1000).is_err());
        assert!(wide(1000, 1024).is_ok() && wide(1000, 1020).is_err());
    }

    #[test]
    fn an_array_of_nothing_may_be_null_and_none_is_larger_than_memory() {
        // SAFETY: null is no array of anything.
        assert_eq!(unsafe { slice::<u8>(std::ptr::null(), 0, "bytes") }.unwrap(), [0; 0]);
        let one = [0_u8];
        // SAFETY: the length is refused before anything is read.
        let all = unsafe { slice(one.as_ptr(), usize::MAX, "bytes") }.unwrap_err();
        assert!(all.to_string().starts_with("bytes has 18446744073709551615 values"), "{all}");
    }
}
