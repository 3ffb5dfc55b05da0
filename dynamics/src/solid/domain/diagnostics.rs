//! What a domain records beside its fields: the energy ledger, sums over time by cell, and output of watched cells.

use super::layout::Layout;
use super::memory::zeros;
use crate::simd::{Group, Real};
use crate::solid::ledger::{Ledger, Total};
use models::solid::waves::Field;
use std::ops::Range;

/// Sums and records. Sums have a fixed order: they depend neither on the tiling nor on the number of parts.
#[derive(Clone)]
pub(super) struct Diagnostics {
    /// By half step of the pass and by layer across the last axis; two more entries hold the boundary work at
    /// the ends of that axis. Each half step has sums of its own, so that the order of additions does not
    /// depend on the tiling.
    pub(super) ledgers: Vec<Vec<Ledger>>,
    /// Of all steps before, by own layer.
    pub(super) totals: Vec<Total>,
    /// Plastic dissipation by group and lane, J/m³; empty where nothing yields.
    pub(super) dissipated: Vec<f64>,
    /// Places of velocities and spins, and Δt times the sum of their values, the first one halved, by cell.
    pub(super) integrals: Vec<(usize, Vec<f64>)>,
    /// Own cells that are recorded after each step, in their order.
    pub(super) watched: Vec<usize>,
    /// By step of the pass: all output of the watched cells.
    pub(super) records: Vec<Vec<f64>>,
}

impl Diagnostics {
    /// Nothing yet; `fields` and `integrals` are those of the problem.
    pub(super) fn new<T: Real, const D: usize>(
        layout: &Layout<D>,
        (fields, integrals): (&[Field], &[Field]),
        is_plastic: bool,
        most_steps: usize,
    ) -> Self {
        let cells = layout.layers() * layout.layer_cells();
        let lanes = layout.layers() * layout.layer_groups() * T::Lanes::COUNT;
        let place = |field| Some(fields.iter().position(|own| *own == field)? * layout.pitch);
        let integrals = integrals.iter().filter_map(|&field| place(field));
        Self {
            ledgers: vec![vec![Ledger::default(); layout.layers() + 2]; 2 * most_steps],
            totals: vec![Total::default(); layout.own_layers().len()],
            dissipated: zeros(if is_plastic { lanes } else { 0 }),
            integrals: integrals.map(|place| (place, vec![0.0; cells])).collect(),
            watched: Vec::new(),
            records: vec![Vec::new(); most_steps],
        }
    }

    /// Adds the ledgers of the half steps of a pass to the totals, in order.
    pub(super) fn close_pass(&mut self, own: Range<usize>, halves: usize) {
        for ledgers in &mut self.ledgers[..halves] {
            let layers = ledgers.len() - 2;
            for (end, layer) in [own.start, own.end - 1].into_iter().enumerate() {
                ledgers[layer].inflow += ledgers[layers + end].inflow;
            }
            for (total, step) in self.totals.iter_mut().zip(&ledgers[own.clone()]) {
                total.add(*step);
            }
            ledgers.fill(Ledger::default());
        }
    }
}
