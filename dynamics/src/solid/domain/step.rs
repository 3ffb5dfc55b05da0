//! Time step by operator splitting.
//!
//! A step of Δt of the state U is two-cyclic (Marchuk 1968; Strang 1968): with x, y, z the sweeps of half a step along
//! the axes, K the action of sources and gravity over half a step, and Q that of the cell laws over a whole step,
//!
//! ```text
//! U ← x y z  then  K Q K  then  z y x.
//! ```
//!
//! Q is the rotation of spins against antisymmetric stress and the [relaxation](super::relaxation) of stresses, which
//! commute. In curved blocks half a [rotation by the curvature](super::curvilinear) precedes and half a rotation
//! follows them; alone, it is applied once over a whole step. Laws of interlayers act in the sweeps, at the faces of
//! the interlayers.
//!
//! The flow of the fluid along saturated interlayers is a stage of Δt before K Q K ([`super::fluid`]).
//!
//! The step is of second order in smooth solutions, since the product is symmetric and its factors are of second order
//! (except with `Slopes::Godunov`). Without sources, gravity and work at boundaries each factor conserves or lowers the
//! energy at Courant numbers c(Δt/2)/h ≤ 1, and so does the step. Boundary values are those in the middle of each half
//! step. With yield sets, the projection P onto the yield set in the energy norm is applied as return mapping either at
//! the end, or as the reflection 2P − I, which is also non-expansive, in the middle between two halves of Q
//! ([`PlasticStep`]). In media with contacts the law of the contact completes each sweep, and each rotation by the
//! curvature ([`super::contacts`]).
//!
//! With alternating sweeps ([`Splitting::Alternating`](crate::solid::problem::Splitting)) the step is
//!
//! ```text
//! U ← x y z  then  K √Q x √Q K  then  z y  then  P,
//! ```
//!
//! where √x is a sweep of a quarter of a step, which replaces the first x of a run, and √Q is Q over half a step.
//! Without P, n steps are (√x y z … x … z y √x)ⁿ except for the last √x; for output, `completion` applies that √x to a
//! copy of each cell. Near reflecting boundaries output is the mean of the states before and after x instead. Each
//! factor conserves or lowers the energy.
//!
//! Sweeps along idle axes, of one cell and periodic, change nothing ([`super::idle_axes`]).
//!
//! [`Domain::advance_pass`] advances memory by one or two such steps, a block of rows and a few layers at a time, as
//! [`super::schedule`] states; [`Domain::advance_layers`] is the step above on those layers.

use super::halo::HaloExchange;
use super::layout::RowSegment;
use super::material_table::WavePair;
use super::schedule::{CHUNK_SIZE, MAX_PASS_STEPS, stage_progress, stage_ranges};
use super::{Domain, SolverReal};
use crate::solid::cell_laws::LawInterval;
use crate::solid::problem::PlasticStep;
use std::ops::Range;

/// Layers in the three stages of a step: x y z (stage 0), K Q K z (stage 1) and y x P (stage 2).
pub(super) struct StepStages<'a> {
    /// By stage, the layers that pass it now.
    pub(super) layers: &'a [Range<usize>; 3],
    /// By stage, all layers that pass it in this pass.
    pub(super) pass_layers: &'a [Range<usize>; 3],
    /// Rows of these layers that are advanced.
    pub(super) block: &'a Range<usize>,
    /// Index of the first of the two half steps, counted from the start of the pass.
    pub(super) first_half: usize,
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Advances all fields by Δt.
    pub fn advance(&mut self) {
        let Ok(()) = self.advance_pass(1, &mut ());
    }

    /// Advances all fields by `steps` steps in one pass over the memory, clamped to at least one and at most
    /// [`Self::max_pass_steps`]; [`Self::time`] states the time reached. Neighbours must make the same passes.
    ///
    /// # Errors
    /// Errors of the halo exchange. The pass is incomplete then, and the fields are invalid.
    pub fn advance_pass<H: HaloExchange<T::Lanes>>(
        &mut self,
        steps: usize,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        self.begin_pass(neighbours)?;
        self.complete_pass(steps, neighbours)
    }

    /// Advances all fields as [`Self::advance_pass`] does, after [`Self::begin_pass`].
    ///
    /// # Errors
    /// See [`Self::advance_pass`].
    pub(crate) fn complete_pass<H: HaloExchange<T::Lanes>>(
        &mut self,
        steps: usize,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let steps = steps.clamp(1, self.schedule.max_pass_steps);
        self.exchange_halo(neighbours)?;
        if self.schedule.steps == 0 && !self.scheme.is_alternating() {
            let all_cells = 0..self.layout.layers() * self.layout.layer_cells();
            self.accumulate_integrals(all_cells, 0.5);
        }
        self.schedule.steps += steps;
        self.schedule.pass_steps = steps;
        self.set_times();
        if self.fluid.is_some() {
            return self.advance_step_with_fluid(neighbours);
        }
        let rows = self.layout.rows;
        let mut loaded = 0;
        while loaded < rows {
            let block =
                loaded..rows.min(loaded.saturating_add(self.schedule.tile_sizes.block_rows));
            loaded = block.end;
            self.advance_block(&block, steps, neighbours)?;
        }
        Ok(())
    }

    /// Advances a block of rows by `steps` steps in all layers. Its last rows, whose stencils reach into the next
    /// block, are completed with the next block.
    fn advance_block<H: HaloExchange<T::Lanes>>(
        &mut self,
        block: &Range<usize>,
        steps: usize,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let (layer_count, owned, rows) =
            (self.layout.layers(), self.layout.owned_layers(), self.layout.rows);
        let ghosts = self.layout.ghosts;
        let swept = self.row_progress(block.start)[1]..self.row_progress(block.end)[1];
        self.sweep_and_send(block, &swept, neighbours)?;
        if self.layout.is_periodic_in_place {
            self.fill_periodic_halo(&swept);
        }
        self.receive_layers(0, &swept, neighbours)?;
        let mut ready = [[0; 3]; MAX_PASS_STEPS];
        while ready[steps - 1][2] < layer_count {
            let mut loaded =
                layer_count.min(ready[0][0].saturating_add(self.schedule.tile_sizes.layers));
            // Received as late as possible, since a neighbour may lag behind.
            if ready[0][0] <= owned.end && owned.end < loaded {
                self.receive_layers(1, &swept, neighbours)?;
            }
            for (step, ready) in ready[..steps].iter_mut().enumerate() {
                let before = std::mem::replace(ready, stage_progress(loaded, layer_count, ghosts));
                // Layers that no later sweep reads are skipped: each sweep reads as many layers beyond those it writes.
                let stage_layers = std::array::from_fn(|stage| {
                    let margin = 2 * (steps - 1 - step) * ghosts + (2 - stage) * ghosts;
                    owned.start.saturating_sub(margin)..layer_count.min(owned.end + margin)
                });
                let layers = std::array::from_fn(|stage| {
                    let Range { start, end } = stage_layers[stage];
                    before[stage].clamp(start, end)..ready[stage].clamp(start, end)
                });
                let stages = StepStages {
                    layers: &layers,
                    pass_layers: &stage_layers,
                    block,
                    first_half: 2 * step,
                };
                T::advance_layers(self, &stages);
                // A layer is complete with its last block of rows.
                if block.end == rows {
                    self.record_completed_layers(&layers[2], step);
                }
                loaded = ready[2];
            }
        }
        Ok(())
    }

    /// Returns the progress of the rows of a layer of which `loaded` have been loaded; see [`stage_progress`].
    pub(super) fn row_progress(&self, loaded: usize) -> [usize; 3] {
        stage_progress(loaded, self.layout.rows, self.layout.ghosts)
    }

    /// Accumulates time integrals and records watched cells, in layers that have completed a step.
    pub(super) fn record_completed_layers(&mut self, layers: &Range<usize>, step: usize) {
        if !self.scheme.is_alternating() {
            let layer = self.layout.layer_cells();
            self.accumulate_integrals(layers.start * layer..layers.end * layer, 1.0);
        }
        self.record_watched_layers(layers.clone(), step);
    }

    /// Advances layers by one step, each stage in its layers. Within a layer, each sweep across rows trails the
    /// previous stage by as many rows as there are ghosts, as sweeps across layers trail it by as many layers.
    pub(super) fn advance_layers(&mut self, stages: &StepStages<'_>) {
        let &StepStages { layers, pass_layers: ends, block, first_half: first } = stages;
        let (row_count, second) = (self.layout.rows, first + 1);
        let steps_done = self.schedule.steps - self.schedule.pass_steps + first / 2 + 1;
        let tile_layers_and_rows = (self.schedule.tile_sizes.layers, row_count);
        let mut ready = self.row_progress(block.start);
        while ready[0] < block.end {
            let rows = self.schedule.next_rows(ready[0], block, tile_layers_and_rows);
            let before = std::mem::replace(&mut ready, self.row_progress(rows.end));
            let rows = stage_ranges(before, ready);
            // Sweeps x y; `sweep_and_send` or a neighbour has already applied them to exchanged layers.
            for layer in layers[0].clone() {
                if first > 0 || !self.layout.is_in_any_halo(layer) {
                    self.sweep_layer(layer, &rows, first);
                }
            }
            // Sweeps z, then K Q K, then z.
            match self.scheme.is_alternating() {
                true => self.apply_alternating_operators(layers, ends, &rows[1], first),
                false => {
                    let groups = self.layout.groups;
                    for tile in rows[1].clone().flat_map(|row| RowSegment::split_row(row, groups)) {
                        self.sweep_last_axis(&layers[0], &ends[0], &tile, first);
                        self.apply_cell_operators(&layers[1], &tile, first);
                        self.sweep_last_axis(&layers[1], &ends[1], &tile, second);
                    }
                }
            }
            // Sweeps y x, then P.
            for layer in layers[2].clone() {
                self.sweep_layer(layer, &rows, second);
                if self.scheme.plastic_step == PlasticStep::ReturnMapping {
                    // Row by row, since buffers hold one row.
                    for row in rows[2].clone() {
                        let tile = self.layout.row_segment(row);
                        self.apply_return_mapping(&(layer..layer + 1), &tile, false);
                    }
                }
                self.flush_subnormals(layer, &rows[2], steps_done);
            }
        }
    }

    /// Completes the sweep along the last axis in media with contacts, then applies K Q K, with relaxation, and with the
    /// reflection 2P − I if it is applied in the middle of the step.
    fn apply_cell_operators(&mut self, layers: &Range<usize>, tile: &RowSegment, first: usize) {
        if self.lane_laws.contacts.is_some() {
            for layer in layers.clone() {
                self.apply_contact_laws_to_segment(layer, tile);
            }
        }
        self.apply_sources(layers, tile, first);
        if self.scheme.plastic_step == PlasticStep::MidpointReflection
            && !self.diagnostics.dissipation.plastic_dissipation.is_empty()
        {
            self.rotate_by_curvature(layers, tile, LawInterval::HalfStep);
            self.rotate_spins(layers, tile, LawInterval::HalfStep);
            self.relax(layers, tile, LawInterval::HalfStep);
            self.apply_return_mapping(layers, tile, true);
            self.relax(layers, tile, LawInterval::HalfStep);
            self.rotate_spins(layers, tile, LawInterval::HalfStep);
            self.rotate_by_curvature(layers, tile, LawInterval::HalfStep);
        } else {
            // The rotation by the curvature does not commute with the other cell laws: half of the rotation before and
            // half after them.
            let has_other_laws =
                !self.lane_laws.rotated_offsets.is_empty() || self.lane_laws.relaxations.is_some();
            let interval = if has_other_laws { LawInterval::HalfStep } else { LawInterval::Step };
            self.rotate_by_curvature(layers, tile, interval);
            self.rotate_spins(layers, tile, LawInterval::Step);
            self.relax(layers, tile, LawInterval::Step);
            self.relax_contacts(layers, tile);
            if has_other_laws {
                self.rotate_by_curvature(layers, tile, interval);
            }
        }
        self.apply_sources(layers, tile, first + 1);
    }

    /// Applies the sweeps along the last axis and the middle of the step between them, for alternating sweeps.
    /// [`CHUNK_SIZE`] rows pass the middle together, since their ghosts are computed in lanes.
    fn apply_alternating_operators(
        &mut self,
        layers: &[Range<usize>; 3],
        ends: &[Range<usize>; 3],
        rows: &Range<usize>,
        first: usize,
    ) {
        let groups = self.layout.groups;
        for start in rows.clone().step_by(CHUNK_SIZE) {
            let chunk = start..rows.end.min(start + CHUNK_SIZE);
            for tile in chunk.clone().flat_map(|row| RowSegment::split_row(row, groups)) {
                self.sweep_last_axis(&layers[0], &ends[0], &tile, first);
            }
            self.sweep_at_mid_step(&layers[1], &chunk, first);
            for tile in chunk.flat_map(|row| RowSegment::split_row(row, groups)) {
                self.sweep_last_axis(&layers[1], &ends[1], &tile, first + 1);
            }
        }
    }

    /// Applies K √Q x √Q K. Time integrals use the mean of the states before and after x, which is second order at
    /// mid-step.
    fn sweep_at_mid_step(&mut self, layers: &Range<usize>, rows: &Range<usize>, first: usize) {
        for row in rows.clone() {
            let tile = self.layout.row_segment(row);
            self.apply_sources(layers, &tile, first);
            self.rotate_spins(layers, &tile, LawInterval::HalfStep);
            self.relax(layers, &tile, LawInterval::HalfStep);
            self.accumulate_row_integrals(layers, row);
        }
        if D == 2 {
            // Layers are rows here.
            self.sweep_rows(layers.clone(), first + 1);
        } else {
            for layer in layers.clone() {
                let start = layer * self.layout.rows;
                self.sweep_rows(start + rows.start..start + rows.end, first + 1);
            }
        }
        for row in rows.clone() {
            let tile = self.layout.row_segment(row);
            self.accumulate_row_integrals(layers, row);
            self.relax(layers, &tile, LawInterval::HalfStep);
            self.rotate_spins(layers, &tile, LawInterval::HalfStep);
            self.apply_sources(layers, &tile, first + 1);
        }
    }

    /// Adds the values in a row of some layers to the time integrals, weighted by half a step.
    fn accumulate_row_integrals(&mut self, layers: &Range<usize>, row: usize) {
        let length = self.layout.cells[0];
        for layer in layers.clone() {
            let row = layer * self.layout.rows + row;
            self.accumulate_integrals(row * length..(row + 1) * length, 0.5);
        }
    }

    /// Returns the pairs of waves for the sweep along an axis in half step `half` of the pass.
    pub(super) fn sweep_waves(&self, axis: usize, half: usize) -> &[WavePair] {
        match self.scheme.is_alternating() && axis == 0 && self.schedule.is_first_half_step(half) {
            true => &self.materials.quarter_step_waves,
            false => match &self.materials.row_constants {
                Some(rows) if axis == 0 => &rows.waves,
                _ if self.shear_duration(half) == 0.0 => &self.materials.held_shear_waves[axis],
                _ => &self.materials.waves[axis],
            },
        }
    }

    /// Returns the duration of the sweeps of shear waves in half step `half` of the pass by that of longitudinal waves.
    pub(super) fn shear_duration(&self, half: usize) -> f64 {
        let before = self.schedule.steps - self.schedule.pass_steps;
        self.shear_steps.relative_duration(before + half / 2)
    }

    /// Evaluates boundary values and sources for the half steps of the pass.
    fn set_times(&mut self) {
        let before = self.schedule.steps - self.schedule.pass_steps;
        for half in 0..2 * self.schedule.pass_steps {
            let start = (before + half / 2) as f64 * self.step;
            let end = (before + half / 2 + 1) as f64 * self.step;
            let middle = start + 0.5 * self.step;
            // Time at the middle of each sweep along the first axis.
            let first = self.scheme.is_alternating().then(|| match half % 2 {
                0 if self.schedule.is_first_half_step(half) => start + 0.125 * self.step,
                0 => start,
                _ => middle,
            });
            let shear_middle =
                self.shear_steps.sweep_middle((before + half / 2, half % 2), self.step);
            let middles = [start + [0.25, 0.75][half % 2] * self.step, shear_middle];
            self.boundaries.set_times(half, middles, first);
            if first.is_some() && half % 2 == 1 {
                self.boundaries.closing_boundaries[half / 2].set_time(end, self.step);
            }
            let interval = [[start, middle], [middle, end]][half % 2];
            for source in &mut self.sources.cell_sources {
                source.set_time(half, interval);
            }
        }
    }
}
