//! Why a simulation ends early, or does not begin.

use analysis::growth::Growth;
use dynamics::flow::Left;
use models::solid::waves::Field;

/// A run that ended by its own state.
#[derive(Clone, Debug, PartialEq)]
pub struct Stopped {
    /// Cause, with position.
    pub cause: StopCause,
    /// Time of detection, s.
    pub time: f64,
    /// The time of the last state without fault, s.
    pub saved: f64,
}

impl std::error::Error for Stopped {}

/// Cause of stopping a simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum StopCause {
    /// A field of a solid is not finite.
    Field {
        /// Which.
        field: Field,
        /// The centre of the first such cell, m.
        place: Vec<f64>,
    },
    /// The energy of a solid is not finite, though all fields are.
    Energy,
    /// A flow has left what is solved.
    Flow {
        /// Event with its values.
        what: String,
        /// Position in initial coordinates of the box, m; `None` if it is not local.
        at: Option<[f64; 2]>,
    },
}

impl From<&Left> for StopCause {
    fn from(left: &Left) -> Self {
        Self::Flow { what: left.what.clone(), at: left.at }
    }
}

/// Short waves of a flow grow without bound: what is solved in time depends on the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct IllPosed {
    /// Growth rate as k → ∞, and where; `None` where it is unbounded at finite k.
    pub growth: Option<Growth>,
    /// The worst direction of the wave vector, degrees.
    pub direction_deg: f64,
    /// The greatest wave number of the grid, 1/m.
    pub number: f64,
}
