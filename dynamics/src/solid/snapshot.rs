//! The state of a solid, as solvers save and restore it.

use crate::solid::ledger::WorkParts;

/// All that the steps to come depend on, whichever solver makes them and in however many parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<T> {
    /// Steps done.
    pub steps: usize,
    /// Values by field, then by cell, the axis of the first sweeps running fastest.
    pub fields: Vec<Vec<T>>,
    /// Work of boundaries and sources, and dissipation of the scheme.
    pub work: WorkParts,
    /// By cell: plastic dissipation, work of the initial stress and dissipation of dashpots, J/m³, where there are such; then
    /// the sums of the problem's integrals.
    pub sums: Vec<Vec<f64>>,
    /// V and S of interlayers, in the order of [`Domain::interlayer_memory`](crate::solid::domain::Domain::interlayer_memory).
    pub interlayers: Vec<[T; 2]>,
}
