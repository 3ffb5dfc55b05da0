//! Tests of case files: accepted input, refused input with its messages, and absence of panics.

mod conversion;
mod full_case;
mod fuzzing;
mod parsing;
mod refusals;
mod templates;
