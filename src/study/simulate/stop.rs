//! Reasons for stopping or refusing a simulation.

use analysis::growth::Growth;
use dynamics::flow::Left;
use models::solid::waves::Field;

/// Report of a simulation stopped by its own state.
#[derive(Clone, Debug, PartialEq)]
pub struct Stopped {
    /// Cause, with position.
    pub cause: StopCause,
    /// Simulated time of detection, s.
    pub time: f64,
    /// Time of the last valid state, s.
    pub saved: f64,
}

impl std::error::Error for Stopped {}

/// Cause of stopping a simulation.
#[derive(Clone, Debug, PartialEq)]
pub enum StopCause {
    /// A field of a solid is not finite.
    Field {
        /// Field that is not finite.
        field: Field,
        /// Centre of the first such cell, m.
        place: Vec<f64>,
    },
    /// The energy of a solid is not finite, although all fields are.
    Energy,
    /// A flow has left the domain of the solver.
    Flow {
        /// Description of the event with its values.
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

/// Ill-posedness of a flow: short waves grow without bound, so that numerical solutions depend on the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct IllPosed {
    /// Order and coefficient of the growth rate as k → ∞; `None` if it is unbounded at finite k.
    pub growth: Option<Growth>,
    /// Direction of the wave vector of fastest growth, degrees.
    pub direction_deg: f64,
    /// Greatest wave number of the grid, 1/m.
    pub number: f64,
}
