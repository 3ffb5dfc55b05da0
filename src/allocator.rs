//! Global allocator of the program. Rust aborts the process when an allocation fails; if a request below
//! `MIN_FALLIBLE_SIZE` fails, this allocator ends the process with an error message and exit code 2, as for every other
//! case that is too large for the memory. The results folder is left as if the process had been killed, so that a run
//! can be resumed.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// Size, bytes, from which on the failure of a request is returned to the caller. Fields, maps and archives are
/// reserved with fallible methods, and the calling code reports which of them does not fit.
const MIN_FALLIBLE_SIZE: usize = 1 << 28;

/// Whether errors are printed as JSON.
pub static PRINTS_JSON_ERRORS: AtomicBool = AtomicBool::new(false);

/// Allocator of the system that ends the program with an error message if a request below `MIN_FALLIBLE_SIZE` fails.
pub struct ReportingAllocator;

// SAFETY: all requests are passed to the system's allocator unchanged, and its pointers are returned unchanged.
unsafe impl GlobalAlloc for ReportingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller fulfils the contract of `GlobalAlloc::alloc`, which is that of `System.alloc`.
        exit_if_null(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller fulfils the contract of `GlobalAlloc::alloc_zeroed`, which is that of
        // `System.alloc_zeroed`.
        exit_if_null(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller fulfils the contract of `GlobalAlloc::realloc`, which is that of `System.realloc`.
        exit_if_null(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller fulfils the contract of `GlobalAlloc::dealloc`, which is that of `System.dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

fn exit_if_null(pointer: *mut u8, size: usize) -> *mut u8 {
    if pointer.is_null() && size < MIN_FALLIBLE_SIZE {
        exit_out_of_memory(size);
    }
    pointer
}

/// Prints the error message for a failed request of `size` bytes and ends the program with exit code 2. It neither
/// allocates nor locks standard error, since this thread may hold that lock already.
#[cold]
fn exit_out_of_memory(size: usize) -> ! {
    let mut text = [0; 320];
    let mut rest = &mut text[..];
    let message = format_args!("no memory left for {size} bytes; ask for fewer cells or points");
    // The message is shorter than the array `text`, so that `writeln!` cannot fail.
    let _ = if PRINTS_JSON_ERRORS.load(Ordering::Relaxed) {
        writeln!(
            rest,
            r#"{{"schema":1,"kind":"memory","message":"{message}","exit_code":2,"file":null,"line":null,"option":null,"key":null,"found":null,"allowed":null}}"#
        )
    } else {
        writeln!(rest, "error: {message}")
    };
    let length = 320 - rest.len();
    // SAFETY: the first `length` bytes of `text` are initialised; `_exit` ends the process without running destructors.
    unsafe {
        libc::write(2, text.as_ptr().cast(), length);
        libc::_exit(2)
    }
}
