//! Tests of case files: accepted input, refused input with its messages, and absence of panics.

mod conversion;
mod full_case;
mod fuzzing;
#[path = "../mutation/mod.rs"]
mod mutation;
mod parsing;
mod refusals;
#[path = "../support/mod.rs"]
mod support;
mod templates;
