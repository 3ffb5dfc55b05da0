//! Case files: what is read, what is refused and in which words, and that nothing panics.

mod conversion;
mod fuzzing;
#[path = "../mutation/mod.rs"]
mod mutation;
mod reading;
mod refusals;
mod support;
mod templates;
