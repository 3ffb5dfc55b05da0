//! Reasons for stopping or refusing a simulation.

use analysis::growth::Growth;
use dynamics::flow::LeftDomain;
use models::solid::waves::SolidField;

/// Report of a simulation that was stopped by its state, such as a non-finite field.
#[derive(Clone, Debug, PartialEq)]
pub struct StopReport {
    /// Cause of the stop, with its position if there is one.
    pub cause: StopCause,
    /// Simulated time at which the cause was detected, s.
    pub detection_time: f64,
    /// Simulated time of the last valid state, s: of a solid the last one whose energy and ledger are finite, which may
    /// be outside its yield set if the return mapping overflowed; of a flow the last one in the domain of the solver.
    pub last_valid_time: f64,
}

impl std::error::Error for StopReport {}

/// Cause for which a simulation was stopped.
#[derive(Clone, Debug, PartialEq)]
pub enum StopCause {
    /// A field of a solid is not finite.
    NonFiniteField {
        /// Field of the solid that is not finite.
        field: SolidField,
        /// Centre of the first cell where the field is not finite, m.
        cell_centre: Vec<f64>,
    },
    /// The energy of a solid is not finite, although all fields are.
    NonFiniteEnergy,
    /// A flow has left the domain of the solver.
    FlowDomainExit {
        /// Description of the event with the values that caused it.
        description: String,
        /// Position in initial coordinates of the box, m; `None` if the event is not local.
        position: Option<[f64; 2]>,
    },
}

impl From<&LeftDomain> for StopCause {
    fn from(left: &LeftDomain) -> Self {
        Self::FlowDomainExit { description: left.description.clone(), position: left.position }
    }
}

/// Ill-posedness of a flow: short waves grow without bound, so that numerical solutions depend on the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct IllPosedness {
    /// Order and coefficient of the growth rate as k → ∞; `None` if the growth rate is unbounded at finite k.
    pub growth: Option<Growth>,
    /// Direction of the wave vector of fastest or unbounded growth, from x₁, degrees.
    pub direction_deg: f64,
    /// Largest initial wave number of the modes of the grid along an axis, 1/m.
    pub max_wave_number: f64,
}
