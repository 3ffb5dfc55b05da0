//! State of a solid for checkpoints.

use crate::solid::ledger::WorkPartialSums;

/// State of a solid, independent of the solver and of the number of subdomains; sufficient to continue the simulation
/// bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<T> {
    /// Number of steps done since time 0.
    pub steps: usize,
    /// Values by field and cell; the axis that is swept first runs fastest.
    pub fields: Vec<Vec<T>>,
    /// Sums of boundary work, source work and numerical dissipation, and the smallest dissipation ratio.
    pub work_sums: WorkPartialSums,
    /// Lists by cell, in the order of `fields`: plastic dissipation, work of the initial stress and dissipation of
    /// dashpots, J/m³, each empty if the problem does not need it; then one list for each time integral, without its
    /// end correction.
    pub cell_sums: Vec<Vec<f64>>,
    /// History variables of interlayers, in the order of
    /// [`Domain::interlayer_history`](crate::solid::domain::Domain::interlayer_history).
    pub interlayer_history: Vec<T>,
}

/// A snapshot without fields, which belongs to no problem.
impl<T> Default for Snapshot<T> {
    fn default() -> Self {
        Self {
            steps: 0,
            fields: Vec::new(),
            work_sums: Default::default(),
            cell_sums: Vec::new(),
            interlayer_history: Vec::new(),
        }
    }
}
