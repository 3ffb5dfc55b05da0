//! Check of a model given as equations: its linearised equations against differences of the equations,
//! and its dispersion roots against waves followed in time.

use super::max_with_nan_largest;
use crate::Error;
use crate::case::Case;
use crate::setup;
use crate::study::{ProgressCallback, report_progress};
use agreement::equations::evolution::{Evolution, ModeEvolution, WaveEvolution};
use agreement::equations::{SYMBOL_TOLERANCE, WaveComparison, compare_waves};
use serde::Serialize;

/// Check result of a model given as equations.
#[derive(Clone, Debug, Serialize)]
pub struct EquationsCheck {
    /// Comparison at each wave.
    #[serde(rename = "rows")]
    pub wave_checks: Vec<WaveCheck>,
    /// Largest relative difference of symbols allowed.
    pub tolerance: f64,
    /// Number of waves that could not be followed in time, since the equations are singular: they do not determine how
    /// their unknowns evolve.
    pub singular_count: usize,
}

/// Comparison of both symbols, and of the evolution in time, at one wave vector.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WaveCheck {
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
    #[serde(skip)]
    pub is_symbol_in_agreement: bool,
    /// Evolution in time; `None` if the equations are singular, and for waves that were not followed.
    pub evolution: Option<EvolutionCheck>,
    /// Whether both symbols, and the evolution in time, agree.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
}

/// Evolution in time of the waves of one wave vector, compared with the dispersion roots.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EvolutionCheck {
    /// Modes of simple roots.
    pub modes: Vec<ModeCheck>,
    /// Number of finite roots.
    pub root_count: usize,
    /// Number of independent solutions in time.
    pub solution_count: usize,
    /// Number of times that constraints were differentiated.
    pub differentiation_count: usize,
    /// Largest residual of the undifferentiated constraints, relative to the state.
    pub constraint_residual: f64,
    /// Largest difference between predicted and measured rates, relative to the largest root.
    pub max_relative_difference: f64,
    /// Residual of the recurrence of the roots for a state of all modes, relative to its terms.
    pub recurrence_error: f64,
    /// Largest residual of the recurrence allowed.
    pub recurrence_tolerance: f64,
}

/// Rate of a mode in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeCheck {
    /// Root of the dispersion relation, Re ς and Im ς, 1/s, in the frame of the background velocity.
    pub predicted: [f64; 2],
    /// Rate fitted to the amplitude, 1/s.
    pub measured: [f64; 2],
    /// Largest difference allowed, 1/s.
    #[serde(rename = "rate_tolerance")]
    pub tolerance: f64,
    /// Whether both agree.
    #[serde(rename = "agrees")]
    pub is_in_agreement: bool,
}

impl From<&ModeEvolution> for ModeCheck {
    fn from(own: &ModeEvolution) -> Self {
        Self {
            predicted: [own.predicted.re, own.predicted.im],
            measured: [own.measured.re, own.measured.im],
            tolerance: own.tolerance,
            is_in_agreement: own.is_within_tolerance(),
        }
    }
}

impl From<&WaveEvolution> for EvolutionCheck {
    fn from(own: &WaveEvolution) -> Self {
        Self {
            modes: own.modes.iter().map(ModeCheck::from).collect(),
            root_count: own.root_count,
            solution_count: own.solution_count,
            differentiation_count: own.differentiation_count,
            constraint_residual: own.constraint_residual,
            max_relative_difference: own.max_relative_difference(),
            recurrence_error: own.recurrence_error,
            recurrence_tolerance: own.recurrence_tolerance(),
        }
    }
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
    let found = compare_waves(model, &mut state, wave_number, wave_count)
        .map_err(|error| setup::locate_map_point_error(case, error))?;
    report_progress(on_progress, 1, 1)?;
    let singular_count = found.iter().filter(|own| own.evolution == Evolution::Singular).count();
    let to_check = |WaveComparison { symbol, evolution }: WaveComparison| {
        let followed = match &evolution {
            Evolution::Followed(own) => Some(own),
            Evolution::Singular | Evolution::NotFollowed => None,
        };
        WaveCheck {
            is_symbol_in_agreement: symbol.is_within_tolerance(),
            is_in_agreement: symbol.is_within_tolerance()
                && followed.is_none_or(WaveEvolution::is_in_agreement),
            rate: [symbol.rate.re, symbol.rate.im],
            error: symbol.error,
            equation: model.equations()[symbol.worst_entry.0],
            unknown: model.unknowns()[symbol.worst_entry.1].name,
            wave_vector: symbol.wave_vector,
            evolution: followed.map(EvolutionCheck::from),
        }
    };
    Ok(EquationsCheck {
        wave_checks: found.into_iter().map(to_check).collect(),
        tolerance: SYMBOL_TOLERANCE,
        singular_count,
    })
}

impl EquationsCheck {
    pub(crate) fn is_in_agreement(&self) -> bool {
        self.wave_checks.iter().all(|own| own.is_in_agreement)
    }

    pub(super) fn item_and_failure_counts(&self) -> [usize; 2] {
        let failed = self.wave_checks.iter().filter(|own| !own.is_in_agreement).count();
        [self.wave_checks.len(), failed]
    }

    pub(super) fn max_relative_difference(&self) -> Option<f64> {
        let evolutions = self.wave_checks.iter().filter_map(|own| own.evolution.as_ref());
        let rates = evolutions.map(|own| own.max_relative_difference);
        max_with_nan_largest(self.wave_checks.iter().map(|own| own.error).chain(rates))
    }
}
