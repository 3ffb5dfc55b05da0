//! Check of a model given as equations: its linearised equations against differences of the equations.

use super::max_with_nan_largest;
use crate::Error;
use crate::case::Case;
use crate::setup;
use crate::study::{ProgressCallback, report_progress};
use agreement::equations::{SYMBOL_TOLERANCE, SymbolComparison, compare_symbols};
use serde::Serialize;

/// Check result of a model given as equations.
#[derive(Clone, Debug, Serialize)]
pub struct EquationsCheck {
    /// Comparison at each wave.
    #[serde(rename = "rows")]
    pub wave_checks: Vec<SymbolCheck>,
    /// Largest relative difference allowed.
    pub tolerance: f64,
    /// What was not compared.
    pub not_measured: &'static str,
}

/// Comparison of both symbols at one wave.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SymbolCheck {
    /// Wave vector, 1/m.
    pub wave_vector: Vec<f64>,
    /// Real and imaginary part of the rate ς at which the symbols are compared, 1/s.
    pub rate: [f64; 2],
    /// Largest difference of an entry of the symbol, relative to the sum of the sizes of its terms.
    pub error: f64,
    /// Equation of this entry.
    pub equation: &'static str,
    /// Unknown of this entry.
    pub unknown: &'static str,
    /// Whether both symbols agree.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
}

/// Compares the linearised equations of a case with differences of the equations at `wave_count` waves.
pub(super) fn check_equations(
    case: &Case,
    wave_count: usize,
    on_progress: ProgressCallback,
) -> Result<EquationsCheck, Error> {
    let equations = case.require_equations()?;
    let model = &equations.model;
    let mut state = equations.state(&case.material.numbers);
    let wave_number = case.material.numbers.wave.wave_number;
    let found = compare_symbols(model, &mut state, wave_number, wave_count)
        .map_err(|error| setup::locate_map_point_error(case, error))?;
    report_progress(on_progress, 1, 1)?;
    let to_check = |own: SymbolComparison| SymbolCheck {
        is_in_agreement: own.is_within_tolerance(),
        rate: [own.rate.re, own.rate.im],
        error: own.error,
        equation: model.equations()[own.worst_entry.0],
        unknown: model.unknowns()[own.worst_entry.1].name,
        wave_vector: own.wave_vector,
    };
    Ok(EquationsCheck {
        wave_checks: found.into_iter().map(to_check).collect(),
        tolerance: SYMBOL_TOLERANCE,
        not_measured: "evolution in time: models given as equations have no solver",
    })
}

impl EquationsCheck {
    pub(super) fn is_in_agreement(&self) -> bool {
        self.wave_checks.iter().all(|own| own.is_in_agreement)
    }

    pub(super) fn item_and_failure_counts(&self) -> [usize; 2] {
        let failed = self.wave_checks.iter().filter(|own| !own.is_in_agreement).count();
        [self.wave_checks.len(), failed]
    }

    pub(super) fn max_relative_difference(&self) -> Option<f64> {
        max_with_nan_largest(self.wave_checks.iter().map(|own| own.error))
    }
}
