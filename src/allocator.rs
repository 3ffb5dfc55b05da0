//! Allocator of the program. Where memory runs out Rust aborts; here the program ends with an error message and exit code
//! 2, as for every other input that does not fit. Its folder of results is left as by a kill: a run can be resumed.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// Size from which a failure is left to the caller, bytes: fields, maps and archives are reserved fallibly, and report
/// what they are.
const FALLIBLE_SIZE: usize = 1 << 28;

/// Whether errors are printed as JSON.
pub static JSON_ERRORS: AtomicBool = AtomicBool::new(false);

/// The system's allocator with an error message where it fails.
pub struct ReportingAllocator;

// SAFETY: all requests are passed to the system's allocator, unchanged.
unsafe impl GlobalAlloc for ReportingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the contract of the caller.
        checked(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the contract of the caller.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the contract of the caller.
        checked(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the contract of the caller.
        unsafe { System.dealloc(pointer, layout) }
    }
}

fn checked(pointer: *mut u8, size: usize) -> *mut u8 {
    if pointer.is_null() && size < FALLIBLE_SIZE {
        end_without_memory(size);
    }
    pointer
}

/// Ends the program, without allocating and without a lock of standard error, which this thread may hold.
#[cold]
fn end_without_memory(size: usize) -> ! {
    let mut text = [0; 320];
    let mut rest = &mut text[..];
    let message = format_args!("no memory left for {size} bytes; ask for fewer cells or points");
    // The text is shorter than the array.
    let _ = if JSON_ERRORS.load(Ordering::Relaxed) {
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
