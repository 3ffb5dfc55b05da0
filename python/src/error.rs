//! Conversion of errors to Python exceptions.

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use wellposed::Error;
use wellposed::case::{CaseError, SourcePosition};

/// Name in messages of a case that is not read from a file; it also names the case.
pub const TEXT_NAME: &str = "case.toml";

/// Converts an error of a study to the exception of the same kind in `wellposed._errors`.
pub fn to_exception(py: Python<'_>, error: &Error, has_lines: bool) -> PyErr {
    match error {
        Error::Case(error) => to_case_exception(py, error, has_lines),
        // A study is cancelled by a signal, whose exception replaces this one if it has its own.
        Error::Cancelled => PyKeyboardInterrupt::new_err(()),
        Error::IllPosed(found) => {
            let message = format!("{found}; accept_ill_posed=True runs it all the same");
            create(py, "IllPosedError", (message,))
        }
        other => create(py, "StudyError", (other.to_string(),)),
    }
}

/// Converts an error of a case, with its key, line, found and allowed values.
pub fn to_case_exception(py: Python<'_>, error: &CaseError, has_lines: bool) -> PyErr {
    let line = |position: &SourcePosition| match position {
        SourcePosition::Line { line, .. } => has_lines.then_some(*line),
        _ => None,
    };
    let (key, line, found, allowed) = match error {
        CaseError::Unreadable { cause, .. } => (None, None, Some(cause.as_str()), None),
        CaseError::Syntax { position, cause, remedy } => {
            (None, line(position), Some(cause.as_str()), Some(*remedy))
        }
        CaseError::Key { position, key, found, allowed } => {
            (Some(key.as_str()), line(position), Some(found.as_str()), Some(allowed.as_str()))
        }
    };
    let message = error.to_string();
    let message = match message.strip_prefix(TEXT_NAME).and_then(|rest| rest.split_once(": ")) {
        Some((_, rest)) if !has_lines => format!("case: {rest}"),
        _ => message,
    };
    create(py, "CaseError", (message, key, line, found, allowed))
}

/// Creates an exception of the class `name` of `wellposed._errors`.
fn create<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let class = py.import("wellposed._errors").and_then(|module| module.getattr(name));
    match class.and_then(|class| class.call1(arguments)) {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}
