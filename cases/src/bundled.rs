//! Case files bundled with the program.

// `CASES`: path and text of every bundled case file, sorted by path.
include!(concat!(env!("OUT_DIR"), "/cases.rs"));
