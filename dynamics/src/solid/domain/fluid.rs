//! Flow of the fluid in saturated interlayers: a stage in the middle of a time step.
//!
//! The flow along interlayers couples cells in all directions, unlike sweeps. In a step with fluid, all layers of the
//! grid therefore pass the first stage of the step, then the fluid is advanced, then all layers pass the other stages;
//! there are no tiles.

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
    /// By cell of the network, the site of the history variables of its face.
    sites: Vec<HistorySite>,
}

impl<T: Real> FluidStage<T> {
    /// Creates the stage for a region of a problem; `None` without saturated interlayers.
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
        let is_at_boundary = |axis: usize, end: usize| {
            region.halo(axis)[end] == 0 && problem.boundaries[axis][0] != Boundary::Periodic
        };
        let grid = NetworkGrid {
            cells: [layout.cells[first], layout.cells[second]],
            spacing: [problem.grid.spacing[first], problem.grid.spacing[second]],
            is_periodic: [first, second].map(|axis| {
                problem.boundaries[axis][0] == Boundary::Periodic && region.halo(axis) == [0, 0]
            }),
            is_open: [first, second].map(|axis| {
                [0, 1].map(|end| is_at_boundary(axis, end) && problem.has_open_layers_along(axis))
            }),
        };
        let all_cells = layout.cells.map(|count| 0..count);
        let law = |site: &HistorySite| match interlayers.law(site) {
            Some(InterlayerLaw::Plane(law, _)) if law.fluid().is_some() => Some(*law),
            _ => None,
        };
        let mut sites = interlayers.sites_in_box(layout, &all_cells);
        sites.retain(|site| law(site).is_some());
        let position = |site: &HistorySite| {
            let coordinates = [site.cell % grid.cells[0], site.cell / grid.cells[0]];
            ((site.axis, coordinates), law(site))
        };
        let faces = sites.iter().map(position);
        let faces = faces.filter_map(|(position, law)| Some((position, law?)));
        let network = FluidNetwork::new(faces, &grid, problem.step);
        Some(Self { network, sites })
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Advances all fields by a time step, with the flow of the fluid in the middle of the step.
    ///
    /// # Errors
    /// Errors of the halo exchange.
    pub(super) fn advance_step_with_fluid<H: HaloExchange<T::Lanes>>(
        &mut self,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let (layer_count, owned, rows) =
            (self.layout.layers(), self.layout.owned_layers(), self.layout.rows);
        let block = 0..rows;
        self.sweep_and_send(&block, &block, neighbours)?;
        if self.layout.is_periodic_in_place {
            self.fill_periodic_halo(&block);
        }
        for end in 0..2 {
            self.receive_layers(end, &block, neighbours)?;
        }
        // Each sweep reads GHOSTS layers beyond those it writes.
        let stage_layers = std::array::from_fn(|stage| {
            let margin = (2 - stage) * GHOSTS;
            owned.start.saturating_sub(margin)..layer_count.min(owned.end + margin)
        });
        let empty = |stage: usize| -> std::ops::Range<usize> {
            let range: &std::ops::Range<usize> = &stage_layers[stage];
            range.start..range.start
        };
        let layers_before_fluid = [stage_layers[0].clone(), empty(1), empty(2)];
        let layers_after_fluid = [empty(0), stage_layers[1].clone(), stage_layers[2].clone()];
        let stages = |layers| StepStages {
            layers,
            pass_layers: &stage_layers,
            block: &block,
            first_half: 0,
        };
        T::advance_layers(self, &stages(&layers_before_fluid));
        self.advance_fluid();
        T::advance_layers(self, &stages(&layers_after_fluid));
        self.record_completed_layers(&stage_layers[2], 0);
        Ok(())
    }

    /// Advances the flow of the fluid along all saturated interlayers by the time step Δt.
    fn advance_fluid(&mut self) {
        let Some(FluidStage { mut network, sites }) = self.fluid.take() else { return };
        for (history, site) in network.history_mut().iter_mut().zip(&sites) {
            for (variable, value) in history.iter_mut().zip(self.interfaces.history(site)) {
                *variable = value;
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
