//! Case files bundled with the program.

// `CASES`: path and text of every file in the folders of cases, sorted by path.
include!(concat!(env!("OUT_DIR"), "/cases.rs"));
