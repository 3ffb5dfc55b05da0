//! A frozen state: from the numbers of a case to an assessed system. What all verbs share.

use crate::Error;
use crate::case::Case;
use analysis::AnalysisError;
use analysis::growth::{self, Assessment};
use analysis::pencil::Pencil;
use models::LinearisedSystem;
use models::granular_flow::state::{Background, Flow};
use models::granular_flow::{InputError, Model};

/// Memory for one state after another; one per thread.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// The linearised equations of the last state.
    pub system: LinearisedSystem<2>,
    /// What the analysis made of them.
    pub pencil: Pencil,
}

/// Why a state cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateError {
    /// The model does not take it.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The analysis does not.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
}

impl StateError {
    /// With the place in the case file.
    pub fn locate(self, case: &Case) -> Error {
        case.locate(self.into_input()).into()
    }

    /// The same for a state of the case's map, whose swept numbers stand in \[map\].
    pub fn locate_in_map(self, case: &Case) -> Error {
        case.locate_in_map(self.into_input()).into()
    }

    fn into_input(self) -> InputError {
        match self {
            Self::Input(error) => error,
            Self::Analysis(error) => InputError {
                key: "background",
                found: "a state that cannot be analysed".into(),
                allowed: error.to_string(),
            },
        }
    }
}

/// A state that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub enum Frozen {
    /// Fully deforming, and judged.
    Flowing {
        /// The background.
        flow: Flow,
        /// The verdict with its evidence.
        assessment: Assessment,
    },
    /// Not fully deforming: nothing to judge.
    Elsewhere(Background),
}

impl Workspace {
    /// Judges the state of a case.
    ///
    /// # Errors
    /// See [`StateError`].
    pub fn judge(&mut self, case: &Case) -> Result<(Model, Frozen), StateError> {
        let model = Model::new(case.kind, &case.parameters())?;
        let background = model.background(&case.state())?;
        let Background::FullyDeforming(flow) = background else {
            return Ok((model, Frozen::Elsewhere(background)));
        };
        model.symbol(&flow, &mut self.system);
        self.pencil.update(&self.system)?;
        let assessment = growth::assess(&self.pencil);
        Ok((model, Frozen::Flowing { flow, assessment }))
    }

    /// Whether the powers of a wave number (1/m) in the dispersion polynomial of the last state hold
    /// in doubles with room to spare.
    pub fn reaches(&self, k: f64) -> bool {
        (1e-30..1e30).contains(&(k / self.pencil.polynomial.wave_number))
    }

    /// Greatest Re ς of the last state, 1/s, at the wave number `k` (1/m) and direction (rad); NaN
    /// where there is no finite root, or where the wave is out of reach.
    pub fn growth(&self, k: f64, direction: f64) -> f64 {
        if !self.reaches(k) {
            return f64::NAN;
        }
        let roots = self.pencil.polynomial.roots(k, direction, &[]);
        roots.iter().map(|root| root.re).fold(f64::NAN, f64::max)
    }
}
