//! Loading of case files, with hints on standard error.

use super::{CommandError, Options};
use crate::case::Case;
use std::io::Write;

/// Loads the case file of a verb for flows and solids and prints hints on former key names in it.
///
/// # Errors
/// The case is invalid, or describes a rheological scheme.
pub(super) fn load_case(options: &Options) -> Result<Case, CommandError> {
    let case = Case::load(&options.case_path, &options.settings)?;
    print_hints(&case);
    case.require_model()?;
    Ok(case)
}

/// Prints the hints on former key names in a case to standard error.
pub(super) fn print_hints(case: &Case) {
    for hint in case.hints() {
        // A closed standard error is ignored.
        let _ = writeln!(std::io::stderr(), "warning: {hint}");
    }
}
