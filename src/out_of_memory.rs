//! The system's allocator, which says what to do where it has no memory left.
//!
//! The standard library says how many bytes failed, and aborts. This ends the program with
//! [`NOT_CONVERGED`]: what was computed is kept. Of what is done then nothing takes memory.

use std::alloc::{GlobalAlloc, Layout, System};
use std::fmt;

use asperity::internals::cli::error::NOT_CONVERGED;
use asperity::internals::memory::explain_failure;

/// [`System`], but a failure ends the program with advice.
pub struct Explained;

// SAFETY: every call goes to the system's allocator as it is; a null pointer is never returned.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Explained {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's.
        there(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's.
        there(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's.
        there(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    #[inline]
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[inline]
fn there(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() {
        end(bytes);
    }
    pointer
}

/// Says so, and ends the program.
#[cold]
#[inline(never)]
fn end(bytes: usize) -> ! {
    let mut text = Text { bytes: [0; 1024], length: 0 };
    // What does not fit is left out.
    let _ = explain_failure(&mut text, bytes);
    say_and_exit(&text.bytes[..text.length])
}

/// A text of limited length, without an allocation.
struct Text {
    bytes: [u8; 1024],
    length: usize,
}

impl fmt::Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let left = &mut self.bytes[self.length..];
        let count = left.len().min(text.len());
        left[..count].copy_from_slice(&text.as_bytes()[..count]);
        self.length += count;
        Ok(())
    }
}

/// By the system alone: a lock of the standard library may be held, and what it runs at the end of
/// a program may want memory.
#[cfg(unix)]
#[allow(unsafe_code)]
fn say_and_exit(text: &[u8]) -> ! {
    unsafe extern "C" {
        fn write(file: std::ffi::c_int, bytes: *const u8, count: usize) -> isize;
        fn _exit(code: std::ffi::c_int) -> !;
    }
    // SAFETY: both are of POSIX, and may be called at any time; the bytes are those of the slice.
    unsafe {
        write(2, text.as_ptr(), text.len());
        _exit(NOT_CONVERGED.into())
    }
}

#[cfg(not(unix))]
fn say_and_exit(text: &[u8]) -> ! {
    let _ = std::io::Write::write_all(&mut std::io::stderr(), text);
    std::process::exit(NOT_CONVERGED.into())
}
