//! Fluid in saturated interlayers: a stage in the middle of the step.
//!
//! The flow along a layer couples cells in all directions, unlike the sweeps: a step with fluid passes all layers of the
//! grid in two parts, before and after the stage, instead of tile by tile.

use super::halo::HaloExchange;
use super::interlayer_faces::{HistorySite, LaneInterlayers};
use super::layout::Layout;
use super::step::StepStages;
use super::{Domain, SolverReal};
use crate::simd::Real;
use crate::solid::boundary::Boundary;
use crate::solid::fluid_network::{FluidNetwork, NetworkGrid};
use crate::solid::interlayers::InterlayerLaw;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::region::Region;

/// Network of the saturated interlayers of a domain, and the sites of their history variables.
#[derive(Clone)]
pub(super) struct FluidStage<T> {
    network: FluidNetwork<T>,
    sites: Vec<HistorySite>,
}

impl<T: Real> FluidStage<T> {
    /// Creates the network of a region of a problem; `None` without saturated interlayers.
    pub(super) fn new<const D: usize>(
        problem: &Problem<D>,
        layout: &Layout<D>,
        region: &Region<D>,
        interlayers: &LaneInterlayers<T, D>,
    ) -> Option<Self> {
        if !problem.has_fluid() {
            return None;
        }
        let [first, second] = [0, 1];
        let at_boundary = |axis: usize, end: usize| {
            region.halo(axis)[end] == 0 && problem.boundaries[axis][0] != Boundary::Periodic
        };
        let grid = NetworkGrid {
            cells: [layout.cells[first], layout.cells[second]],
            spacing: [problem.grid.spacing[first], problem.grid.spacing[second]],
            is_periodic: [first, second].map(|axis| {
                problem.boundaries[axis][0] == Boundary::Periodic && region.halo(axis) == [0, 0]
            }),
            is_open: [first, second].map(|axis| {
                [0, 1].map(|end| at_boundary(axis, end) && problem.has_open_layers_along(axis))
            }),
        };
        let all = layout.cells.map(|count| 0..count);
        let law = |site: &HistorySite| match interlayers.law(site) {
            Some(InterlayerLaw::Plane(law, _)) if law.fluid().is_some() => Some(*law),
            _ => None,
        };
        let mut sites = interlayers.sites_in_box(layout, &all);
        sites.retain(|site| law(site).is_some());
        let position = |site: &HistorySite| {
            let place = [site.cell % grid.cells[0], site.cell / grid.cells[0]];
            ((site.axis, place), law(site))
        };
        let faces = sites.iter().map(position);
        let faces = faces.filter_map(|(position, law)| Some((position, law?)));
        let network = FluidNetwork::new(faces, &grid, problem.step);
        Some(Self { network, sites })
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Advances all fields by a step with the stage of the fluid in its middle.
    ///
    /// # Errors
    /// Errors of the halo exchange.
    pub(super) fn advance_step_with_fluid<H: HaloExchange<T::Lanes>>(
        &mut self,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let (all, own, rows) = (self.layout.layers(), self.layout.owned_layers(), self.layout.rows);
        let block = 0..rows;
        self.sweep_and_send(&block, &block, neighbours)?;
        if self.layout.is_periodic_in_place {
            self.fill_periodic_halo(&block);
        }
        for end in 0..2 {
            self.receive_layers(end, &block, neighbours)?;
        }
        // Each sweep reads GHOSTS layers beyond those it writes.
        let needed = std::array::from_fn(|stage| {
            let beyond = (2 - stage) * GHOSTS;
            own.start.saturating_sub(beyond)..all.min(own.end + beyond)
        });
        let empty = |stage: usize| -> std::ops::Range<usize> {
            let range: &std::ops::Range<usize> = &needed[stage];
            range.start..range.start
        };
        let before = [needed[0].clone(), empty(1), empty(2)];
        let after = [empty(0), needed[1].clone(), needed[2].clone()];
        let stages =
            |layers| StepStages { layers, pass_layers: &needed, block: &block, first_half: 0 };
        T::advance_layers(self, &stages(&before));
        self.advance_fluid();
        T::advance_layers(self, &stages(&after));
        self.record_completed_layers(&needed[2], 0);
        Ok(())
    }

    /// Advances the flow along the layers by Δt.
    fn advance_fluid(&mut self) {
        let Some(FluidStage { mut network, sites }) = self.fluid.take() else { return };
        for (history, site) in network.history_mut().iter_mut().zip(&sites) {
            for (own, value) in history.iter_mut().zip(self.interfaces.history(site)) {
                *own = value;
            }
        }
        network.advance(self.step);
        for (history, site) in network.history_mut().iter().zip(&sites) {
            self.interfaces.set_history(site, &mut history.iter().copied());
        }
        self.fluid = Some(FluidStage { network, sites });
        self.interfaces.synchronise_copies(&self.layout);
    }
}
