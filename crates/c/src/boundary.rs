//! Arrays, texts, errors and panics at the boundary to C.
#![allow(unsafe_code, reason = "arrays and texts come from C as pointers")]

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static LAST_ERROR: RefCell<Option<CString>> = const { RefCell::new(None) };
}

/// Does what a function of the library does. An error, or a panic, is kept for [`last_error`], and nothing is answered.
///
/// What a panic leaves behind is a handle as it was before or, of tolerances, with or without the value that was to be set: all of them can
/// be used, so nothing is lost by [`AssertUnwindSafe`].
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Option<T> {
    let outcome = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(of_panic(&*panic)));
    LAST_ERROR.with_borrow_mut(|last| *last = outcome.as_ref().err().map(|error| text(error)));
    outcome.ok()
}

fn of_panic(panic: &(dyn Any + Send)) -> String {
    let said = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    format!("a mistake in Rockproof: {}", said.unwrap_or("it panicked"))
}

/// The text of the last error of this thread, or null.
pub(crate) fn last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|last| last.as_ref().map_or(std::ptr::null(), |error| error.as_ptr()))
}

/// A text for C, which ends at a zero byte.
pub(crate) fn text(text: &str) -> CString {
    CString::new(text.replace('\0', "\\0")).unwrap_or_default()
}

/// The elements of an array of C.
///
/// # Safety
/// `pointer` is null, or the start of `length` elements that nobody changes while the answer is in use.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize, what: &str) -> Result<&'a [T], String> {
    if length == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() || !pointer.is_aligned() {
        let found = if pointer.is_null() { "null" } else { "not aligned as its type asks" };
        return Err(format!("{what} is {found}; allowed is an array of {length} elements"));
    }
    if length > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(format!("{what} has {length} elements, more than a memory holds"));
    }
    // SAFETY: not null, aligned and no longer than an object can be, as just seen; the caller answers for the elements.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// A text of C in UTF-8.
///
/// # Safety
/// `pointer` is null, or the start of bytes that end with a zero and that nobody changes while the answer is in use.
pub(crate) unsafe fn str_of<'a>(pointer: *const c_char, what: &str) -> Result<&'a str, String> {
    if pointer.is_null() {
        return Err(format!("{what} is null; allowed is a text"));
    }
    // SAFETY: not null, as just seen; the caller answers for the bytes and their end.
    let bytes = unsafe { CStr::from_ptr(pointer) };
    bytes.to_str().map_err(|error| format!("{what} is not UTF-8: {error}"))
}
