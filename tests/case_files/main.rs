//! Tests of case files: accepted input, refused input with its messages, and absence of panics.

mod conversion;
mod fuzzing;
#[path = "../mutation/mod.rs"]
mod mutation;
mod reading;
mod refusals;
mod support;
mod templates;
