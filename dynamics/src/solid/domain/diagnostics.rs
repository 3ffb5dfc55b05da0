//! Diagnostics of a domain: energy ledger, sums over time by cell, and output of watched cells.

use super::buffers::allocate_zeros;
use super::layout::Layout;
use crate::simd::{LaneGroup, Real};
use crate::solid::ledger::{CellDissipation, WorkSums};
use crate::solid::problem::{DomainError, Problem};
use models::solid::waves::SolidField;

/// Sums over time by cell, work sums, and records. Sums over cells are exact: they depend neither on the tiling nor on
/// the number of subdomains.
#[derive(Clone)]
pub(super) struct Diagnostics {
    /// Work sums over owned cells and boundary faces.
    pub(super) work: WorkSums,
    /// Dissipation of the laws of cells, by group and lane.
    pub(super) dissipation: CellDissipation,
    /// Offsets of the integrated velocities and spins, and by cell the sums of their time integrals: for two-cyclic
    /// sweeps by the trapezoidal rule without its end correction −½Δt × last value, which output adds; for alternating
    /// sweeps by the midpoint rule.
    pub(super) time_integrals: Vec<(usize, Vec<f64>)>,
    /// Owned cells that are recorded after each step, in ascending order.
    pub(super) watched_cells: Vec<usize>,
    /// By step of the pass, the output quantities of all watched cells.
    pub(super) records: Vec<Vec<f64>>,
}

impl Diagnostics {
    /// Creates empty sums and records for a subdomain of a problem with these fields.
    ///
    /// # Errors
    /// There is not enough memory.
    pub(super) fn new<T: Real, const D: usize>(
        layout: &Layout<D>,
        problem: &Problem<D>,
        fields: &[SolidField],
        max_pass_steps: usize,
    ) -> Result<Self, DomainError> {
        let cells = layout.layers() * layout.layer_cells();
        let lanes = layout.layers() * layout.layer_groups() * T::Lanes::COUNT;
        let field_offset =
            |field| Some(fields.iter().position(|own| *own == field)? * layout.pitch);
        let integrals = problem.integrated_fields.iter().filter_map(|&field| field_offset(field));
        Ok(Self {
            work: WorkSums::default(),
            dissipation: CellDissipation::new(problem, || allocate_zeros(lanes))?,
            time_integrals: integrals
                .map(|field_offset| (field_offset, vec![0.0; cells]))
                .collect(),
            watched_cells: Vec::new(),
            records: vec![Vec::new(); max_pass_steps],
        })
    }
}
