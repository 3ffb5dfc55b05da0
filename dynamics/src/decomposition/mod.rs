//! Domain decomposition: subdomains of a grid, each on its own thread.
//!
//! In each pass over memory a subdomain receives a halo of [`HALO`] cells per step of the pass (more along the first
//! axis for alternating sweeps, see [`Decomposition`]) and advances the halo cells redundantly. Every cell undergoes
//! the same operations as without decomposition, and sums over cells are exact: results are identical bit for bit.
//! Along the last axis, layers are exchanged during the pass. The upper halo is received last: a subdomain can
//! therefore be almost one block of rows ahead of its upper neighbour, and short delays do not propagate. Along the
//! other axes the exchange precedes the pass, see [`HaloExchange`](crate::solid::domain::HaloExchange).

mod channels;
pub mod communicator;
#[cfg(unix)]
pub mod mpi;
mod plan;
mod threads;

use crate::simd::InstructionSet;
use crate::solid::axis_permutation::AxisPermutation;
use crate::solid::boundary::Boundary;
use crate::solid::domain::{Domain, SolverReal};
use crate::solid::ledger::{Energy, EnergySums, Ledger, LedgerSums, WorkSums};
use crate::solid::line::HALO;
use crate::solid::problem::{DomainError, Problem};
use crate::solid::region::Region;
use channels::{Channels, Disconnected};
use models::solid::waves::SolidField;
use std::ops::Range;
use threads::{SystemThreads, evaluate_each, run_concurrently};

pub use crate::solid::snapshot::Snapshot;
pub use plan::Decomposition;
pub use threads::ThreadStartError;
#[doc(hidden)]
pub use threads::ThreadStarter;

/// A subdomain with its halo, channels and records.
struct Subdomain<T: SolverReal, const D: usize> {
    domain: Domain<T, D>,
    region: Region<D>,
    channels: Channels<T::Lanes, D>,
    /// Cells recorded after each step: index in the list of all watched cells, and index among the owned cells.
    watched_cells: Vec<(usize, usize)>,
    /// Records of the watched cells: all output quantities, by step and cell.
    records: Vec<f64>,
}

impl<T: SolverReal, const D: usize> Subdomain<T, D> {
    fn advance(&mut self, steps: usize) -> Result<(), Disconnected> {
        let Self { domain, channels, records, .. } = self;
        // A panic drops the channels, so that receiving fails in the neighbouring threads instead of blocking.
        let mut own_channels = std::mem::take(channels);
        let mut remaining = steps;
        while remaining > 0 {
            let steps = remaining.min(domain.max_pass_steps());
            domain.advance_pass(steps, &mut own_channels)?;
            domain.drain_records(records);
            remaining -= steps;
        }
        *channels = own_channels;
        Ok(())
    }

    /// Returns positions and numbers of history variables of the interlayers at the lower faces of owned cells.
    /// Position: layer of the whole grid across the last axis, axis normal to the face, and global cell above the face.
    /// `layer_cells`: number of cells of a layer of the whole grid.
    fn interlayer_positions(&self, layer_cells: usize) -> Vec<([usize; 3], usize)> {
        let cells = self.region.owned_global_cells();
        let faces = self.domain.interlayer_faces().into_iter();
        faces
            .map(|[axis, cell, variables]| {
                ([cells[cell] / layer_cells, axis, cells[cell]], variables)
            })
            .collect()
    }
}

/// A domain decomposed into subdomains.
pub struct DecomposedDomain<T: SolverReal, const D: usize> {
    subdomains: Vec<Subdomain<T, D>>,
    /// Permutation from the axes of the problem to those of the subdomains.
    permutation: AxisPermutation<D>,
    /// Number of cells of the whole grid along each permuted axis.
    cells: [usize; D],
    /// Number of watched cells, those outside the grid included.
    watched_cell_count: usize,
}

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// Creates a domain at rest, decomposed into `count` subdomains along its last axis.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>, count: usize) -> Result<Self, DomainError> {
        Self::with_first_axis(0, problem, count)
    }

    /// Returns the maximum number of subdomains along the last axis of a domain with `first_axis` swept first.
    pub fn max_subdomains(first_axis: usize, problem: &Problem<D>) -> usize {
        let permutation = AxisPermutation::with_first_axis(first_axis, &problem.grid);
        (permutation.permute_grid(&problem.grid).cells[D - 1] / HALO).max(1)
    }

    /// Creates a domain at rest in `count` subdomains, with `axis` swept first. The other axes keep their order; the
    /// domain is decomposed along the last of them.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_first_axis(
        axis: usize,
        problem: &Problem<D>,
        count: usize,
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(axis, &problem.grid);
        let mut subdomain_counts = [1; D];
        subdomain_counts[D - 1] = count;
        Self::with_permuted_subdomains(problem, permutation, subdomain_counts)
    }

    /// Creates a domain at rest, with `subdomain_counts` subdomains along each axis of the problem and with
    /// `first_axis` swept first.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_subdomains(
        first_axis: usize,
        problem: &Problem<D>,
        subdomain_counts: [usize; D],
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(first_axis, &problem.grid);
        Self::with_permuted_subdomains(
            problem,
            permutation,
            permutation.permute_axis_values(subdomain_counts),
        )
    }

    /// Creates a domain at rest, with `subdomain_counts` subdomains along each permuted axis.
    fn with_permuted_subdomains(
        problem: &Problem<D>,
        permutation: AxisPermutation<D>,
        subdomain_counts: [usize; D],
    ) -> Result<Self, DomainError> {
        let problem = &permutation.check_and_permute(problem)?;
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        let plan = Decomposition::new(
            &problem.grid,
            is_periodic,
            problem.pass_limits(),
            subdomain_counts,
        )?;
        let create_subdomain = |region: &Region<D>| {
            let restricted = problem.restrict_to(region);
            Ok(Subdomain {
                domain: Domain::new_unchecked(&restricted, region, plan.max_pass_steps())?,
                region: region.clone(),
                channels: Channels::default(),
                watched_cells: Vec::new(),
                records: Vec::new(),
            })
        };
        let subdomains: Result<Vec<_>, DomainError> =
            plan.regions().iter().map(create_subdomain).collect();
        let mut subdomains = subdomains?;
        let mut channels: Vec<_> = subdomains.iter().map(|_| Channels::default()).collect();
        for (index, subdomain) in subdomains.iter().enumerate() {
            for axis in 0..D {
                if let Some(next) = plan.neighbour(index, axis, 1) {
                    let capacity = subdomain.domain.message_capacity(axis);
                    Channels::connect(&mut channels, axis, [index, next], capacity);
                }
            }
        }
        for (subdomain, channels) in subdomains.iter_mut().zip(channels) {
            subdomain.channels = channels;
        }
        Ok(Self { subdomains, permutation, cells: problem.grid.cells, watched_cell_count: 0 })
    }

    /// Selects the instruction set; results do not depend on it.
    pub fn set_instructions(&mut self, instructions: InstructionSet) {
        for subdomain in &mut self.subdomains {
            subdomain.domain.set_instructions(instructions);
        }
    }

    /// Selects the scalar return mapping in all subdomains, see [`Domain::use_scalar_mapping`].
    #[doc(hidden)]
    pub fn use_scalar_mapping(&mut self) {
        for subdomain in &mut self.subdomains {
            subdomain.domain.use_scalar_mapping();
        }
    }

    /// Advances all fields by `steps` time steps: a single subdomain on the calling thread, several on a thread each.
    ///
    /// # Errors
    /// A thread cannot be started; the state is unchanged.
    pub fn advance(&mut self, steps: usize) -> Result<(), ThreadStartError> {
        self.advance_with(&mut SystemThreads, steps)
    }

    /// Advances as [`advance`](Self::advance) does, on threads that `starter` starts.
    #[doc(hidden)]
    pub fn advance_with(
        &mut self,
        starter: &mut impl ThreadStarter,
        steps: usize,
    ) -> Result<(), ThreadStartError> {
        // A neighbour's thread ends early only by a panic, which the scope propagates.
        if let [subdomain] = self.subdomains.as_mut_slice() {
            let _ = subdomain.advance(steps);
            return Ok(());
        }
        let task = |subdomain| {
            move || {
                let _ = Subdomain::advance(subdomain, steps);
            }
        };
        run_concurrently(starter, self.subdomains.iter_mut().map(task))
    }

    /// Returns the maximum number of steps per pass over memory; a pass reads and writes each field once.
    pub fn max_pass_steps(&self) -> usize {
        self.subdomains.first().map_or(1, |subdomain| subdomain.domain.max_pass_steps())
    }

    /// Returns the time of the present state, s.
    pub fn time(&self) -> f64 {
        self.subdomains.first().map_or(0.0, |subdomain| subdomain.domain.time())
    }

    /// Returns the fields of the state, in their order.
    pub fn fields(&self) -> &[SolidField] {
        self.subdomains.first().map_or(&[], |subdomain| subdomain.domain.fields())
    }

    /// Returns the number of output quantities per cell: fields and time integrals.
    pub fn quantity_count(&self) -> usize {
        let integrals =
            self.subdomains.first().map_or(0, |subdomain| subdomain.domain.integral_count());
        self.fields().len() + integrals
    }

    /// Records all output quantities of these cells after each step and discards earlier records; cells outside the
    /// grid give zeros.
    pub fn watch_cells(&mut self, cells: &[usize]) {
        self.watched_cell_count = cells.len();
        for subdomain in &mut self.subdomains {
            subdomain.records.clear();
            let numbered_cells = cells.iter().enumerate();
            subdomain.watched_cells = numbered_cells
                .filter_map(|(watched_index, cell)| {
                    let cell = self.permutation.permuted_cell(*cell);
                    Some((watched_index, subdomain.region.owned_index(cell)?))
                })
                .collect();
            subdomain.watched_cells.sort_by_key(|(_, cell)| *cell);
            subdomain.domain.watch_cells(subdomain.watched_cells.iter().map(|(_, cell)| *cell));
        }
    }

    /// Returns the records since the last call, by step, watched cell and output quantity; values as in
    /// [`Domain::output_cell`].
    pub fn take_records(&mut self) -> Vec<f64> {
        let width = self.quantity_count();
        let steps = self
            .subdomains
            .iter()
            .filter(|subdomain| !subdomain.watched_cells.is_empty())
            .map(|subdomain| subdomain.records.len() / (subdomain.watched_cells.len() * width))
            .max()
            .unwrap_or(0);
        let mut gathered = vec![0.0; steps * self.watched_cell_count * width];
        for subdomain in &mut self.subdomains {
            let cell_count = subdomain.watched_cells.len();
            for (index, values) in subdomain.records.chunks_exact(width).enumerate() {
                let (step, watched_index) =
                    (index / cell_count, subdomain.watched_cells[index % cell_count].0);
                let start = (step * self.watched_cell_count + watched_index) * width;
                gathered[start..start + width].copy_from_slice(values);
            }
            subdomain.records.clear();
        }
        gathered
    }

    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot<T> {
        let fields = self.fields().to_vec();
        Snapshot {
            steps: self.subdomains.first().map_or(0, |subdomain| subdomain.domain.steps()),
            fields: fields.into_iter().filter_map(|field| self.permuted_values(field)).collect(),
            work_sums: self.work_sums().to_partial_sums(),
            cell_sums: self.cell_sums(),
            interlayer_history: self.interlayer_history(),
        }
    }

    /// Returns the work sums of all subdomains.
    fn work_sums(&self) -> WorkSums {
        let mut sums = WorkSums::default();
        self.subdomains.iter().for_each(|subdomain| sums.merge(subdomain.domain.work()));
        sums
    }

    /// Returns to the state of rest before the first step.
    pub(crate) fn reset(&mut self) {
        let mut sums = self.cell_sums();
        sums.iter_mut().for_each(|own| own.fill(0.0));
        for subdomain in &mut self.subdomains {
            subdomain.domain.clear();
            subdomain.domain.restore_work(0, WorkSums::default());
        }
        self.set_cell_sums(&sums);
    }

    /// Restores a snapshot; `false` if it belongs to another problem.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        let cells: usize = self.cells.iter().product();
        let fields = self.fields().to_vec();
        if snapshot.fields.len() != fields.len()
            || snapshot.fields.iter().any(|values| values.len() != cells)
            || snapshot.cell_sums.iter().map(Vec::len).ne(self.cell_sums().iter().map(Vec::len))
            || snapshot.interlayer_history.len() != self.interlayer_history().len()
        {
            return false;
        }
        for subdomain in &mut self.subdomains {
            subdomain.domain.clear();
        }
        for (field, values) in fields.into_iter().zip(&snapshot.fields) {
            self.set_permuted_values(field, values);
        }
        // The first subdomain holds the work sums of all; those of the others are zero.
        let mut work = WorkSums::from_partial_sums(&snapshot.work_sums);
        for subdomain in &mut self.subdomains {
            subdomain.domain.restore_work(snapshot.steps, std::mem::take(&mut work));
        }
        self.set_cell_sums(&snapshot.cell_sums);
        self.set_interlayer_history(&snapshot.interlayer_history);
        true
    }

    /// Returns the plastic dissipation by cell, J/m³; empty if no medium yields.
    pub fn plastic_dissipation(&self) -> Vec<f64> {
        self.permutation.unpermute(self.cell_sums().swap_remove(0))
    }

    /// Returns the sums stored per cell, by kind of sum (see [`Domain::cell_sums`]) and cell of the whole grid.
    fn cell_sums(&self) -> Vec<Vec<f64>> {
        let by_subdomain: Vec<_> =
            self.subdomains.iter().map(|subdomain| subdomain.domain.cell_sums()).collect();
        let kinds = by_subdomain.first().map_or(0, Vec::len);
        (0..kinds)
            .map(|kind| {
                self.assemble_grid_values(by_subdomain.iter().map(|sums| sums[kind].clone()))
            })
            .collect()
    }

    fn set_cell_sums(&mut self, sums: &[Vec<f64>]) {
        for subdomain in &mut self.subdomains {
            let cells = subdomain.region.owned_global_cells();
            let select_owned = |grid_values: &Vec<f64>| {
                let needed_cells = cells.iter().filter(|_| !grid_values.is_empty());
                needed_cells.map(|cell| grid_values[*cell]).collect()
            };
            subdomain.domain.set_cell_sums(&sums.iter().map(select_owned).collect::<Vec<_>>());
        }
    }

    /// Gathers values by cell of the whole grid from those of the owned cells of all subdomains; empty if no subdomain
    /// has values.
    fn assemble_grid_values<V: Copy>(
        &self,
        mut by_subdomain: impl Iterator<Item = Vec<V>>,
    ) -> Vec<V> {
        if self.subdomains.len() == 1 {
            return by_subdomain.next().unwrap_or_default();
        }
        let mut gathered = Vec::new();
        for (subdomain, values) in self.subdomains.iter().zip(by_subdomain) {
            // Any value for initialisation: all cells are overwritten.
            let Some(first) = values.first() else { continue };
            gathered.resize(self.cells.iter().product(), *first);
            for (cell, value) in subdomain.region.owned_global_cells().into_iter().zip(values) {
                gathered[cell] = value;
            }
        }
        gathered
    }

    /// Returns work and dissipation of the steps so far, J.
    pub fn ledger(&self) -> Ledger {
        let mut sums = LedgerSums::default();
        let by_subdomain = self.map_subdomains(|domain| domain.ledger_sums());
        by_subdomain.iter().for_each(|own| sums.merge(own));
        sums.to_ledger(self.cell_volume())
    }

    /// Returns the energy of the deviation from the initial stress, J.
    pub fn energy(&self) -> Energy {
        let mut sums = EnergySums::default();
        let by_subdomain = self.map_subdomains(|domain| domain.energy_sums());
        by_subdomain.iter().for_each(|own| sums.merge(own));
        sums.to_energy(self.cell_volume())
    }

    /// Returns the volume of a cell, m³.
    fn cell_volume(&self) -> f64 {
        self.subdomains.first().map_or(0.0, |subdomain| subdomain.domain.grid().volume())
    }

    /// Calls `evaluate` for each subdomain: a single one on the calling thread, several on a thread each if it starts.
    fn map_subdomains<V: Send>(&self, evaluate: impl Fn(&Domain<T, D>) -> V + Sync) -> Vec<V> {
        if let [subdomain] = self.subdomains.as_slice() {
            return vec![evaluate(&subdomain.domain)];
        }
        let domains = self.subdomains.iter().map(|subdomain| &subdomain.domain);
        evaluate_each(&mut SystemThreads, domains, evaluate)
    }

    /// Returns field and cell of a non-finite value (for interlayers, the cell above the face); `None` if all are
    /// finite. Each subdomain reports its first one; that with the lowest cell in the order of permuted axes is
    /// returned.
    pub fn first_non_finite(&self) -> Option<(SolidField, usize)> {
        let locate = |subdomain: &Subdomain<T, D>| {
            let (field, cell) = subdomain.domain.first_non_finite()?;
            Some((subdomain.region.owned_global_cell(cell), field))
        };
        let (cell, field) =
            self.subdomains.iter().filter_map(locate).min_by_key(|located| located.0)?;
        Some((field, self.permutation.original_cell(cell)))
    }

    /// Records all output quantities of the watched cells in the present state.
    pub fn record_watched_cells(&mut self) {
        for subdomain in &mut self.subdomains {
            let boundaries = subdomain.domain.closing_boundaries();
            for &(_, cell) in &subdomain.watched_cells {
                subdomain.domain.output_cell_with(
                    cell,
                    boundaries.as_ref(),
                    &mut subdomain.records,
                );
            }
        }
    }

    /// Returns the first cell, in the order of permuted axes, whose stress is outside its yield set; `None` if there is
    /// none.
    pub fn first_cell_outside_yield_set(&self) -> Option<usize> {
        let locate = |subdomain: &Subdomain<T, D>| {
            Some(
                subdomain
                    .region
                    .owned_global_cell(subdomain.domain.first_cell_outside_yield_set()?),
            )
        };
        let first = self.subdomains.iter().filter_map(locate).min();
        first.map(|cell| self.permutation.original_cell(cell))
    }

    /// Returns the output quantities by cell (first axis fastest), see [`Domain::output_cell`].
    pub fn output_values(&self) -> Vec<Vec<f64>> {
        let evaluate_output = |domain: &Domain<T, D>| {
            let mut fields = vec![Vec::new(); self.quantity_count()];
            let (boundaries, mut state) = (domain.closing_boundaries(), Vec::new());
            for cell in 0..domain.grid().count() {
                state.clear();
                domain.output_cell_with(cell, boundaries.as_ref(), &mut state);
                for (values, value) in fields.iter_mut().zip(&state) {
                    values.push(*value);
                }
            }
            fields
        };
        let mut by_subdomain: Vec<_> =
            self.subdomains.iter().map(|subdomain| evaluate_output(&subdomain.domain)).collect();
        let fields = 0..self.quantity_count();
        let gathered = fields.map(|field| {
            let parts = by_subdomain.iter_mut().map(|fields| std::mem::take(&mut fields[field]));
            self.permutation.unpermute(self.assemble_grid_values(parts))
        });
        gathered.collect()
    }

    /// Returns the stored values of a field (first axis fastest), without the completion of the step that output
    /// applies for alternating sweeps; `None` if there is no such field.
    pub fn values(&self, field: SolidField) -> Option<Vec<T>> {
        self.permuted_values(field).map(|values| self.permutation.unpermute(values))
    }

    /// Returns the stored values of a field by cell of the whole grid, with permuted axes.
    fn permuted_values(&self, field: SolidField) -> Option<Vec<T>> {
        let by_subdomain = self.subdomains.iter().map(|subdomain| subdomain.domain.values(field));
        let by_subdomain = by_subdomain.collect::<Option<Vec<_>>>()?;
        Some(self.assemble_grid_values(by_subdomain.into_iter()))
    }

    /// Returns the position of each interlayer as [`Subdomain::interlayer_positions`] does, in the order of
    /// [`Domain::interlayer_history`] of the whole grid, and the range of its history variables in that order.
    fn interlayer_history_ranges(&self) -> Vec<([usize; 3], Range<usize>)> {
        let layer: usize = self.cells[..D - 1].iter().product();
        let mut positions: Vec<_> = self
            .subdomains
            .iter()
            .flat_map(|subdomain| subdomain.interlayer_positions(layer))
            .collect();
        positions.sort_unstable();
        let mut end = 0;
        let range = |(position, variables): ([usize; 3], usize)| {
            end += variables;
            (position, end - variables..end)
        };
        positions.into_iter().map(range).collect()
    }

    /// Returns the history variables of all interlayers, in the order of [`Domain::interlayer_history`] of the whole
    /// grid.
    pub fn interlayer_history(&self) -> Vec<T> {
        if let [subdomain] = self.subdomains.as_slice() {
            return subdomain.domain.interlayer_history();
        }
        let ranges = self.interlayer_history_ranges();
        let layer: usize = self.cells[..D - 1].iter().product();
        let mut gathered = vec![T::ZERO; ranges.last().map_or(0, |(_, range)| range.end)];
        for subdomain in &self.subdomains {
            let mut history = subdomain.domain.interlayer_history().into_iter();
            for (position, _) in subdomain.interlayer_positions(layer) {
                let index = ranges.partition_point(|other| other.0.cmp(&position).is_lt());
                let variables = gathered[ranges[index].1.clone()].iter_mut();
                variables.zip(&mut history).for_each(|(variable, value)| *variable = value);
            }
        }
        gathered
    }

    fn set_interlayer_history(&mut self, history: &[T]) {
        let ranges = self.interlayer_history_ranges();
        let layer: usize = self.cells[..D - 1].iter().product();
        for subdomain in &mut self.subdomains {
            let positions = subdomain.interlayer_positions(layer).into_iter();
            let history = positions.flat_map(|(position, _)| {
                let index = ranges.partition_point(|other| other.0.cmp(&position).is_lt());
                history.get(ranges[index].1.clone()).unwrap_or_default()
            });
            let history: Vec<T> = history.copied().collect();
            subdomain.domain.set_interlayer_history(&mut history.into_iter());
        }
    }

    /// Initialises interlayers with the mean velocity of the adjacent cells and without stress, see
    /// [`Domain::initialise_interlayers`].
    pub fn initialise_interlayers(&mut self) {
        let fields = self.fields().to_vec();
        let values: Vec<_> = fields.iter().map(|&field| self.permuted_values(field)).collect();
        let value = |field: SolidField, cell: usize| {
            let index = fields.iter().position(|own| *own == field);
            let values = index.and_then(|index| values[index].as_ref());
            values.map_or(T::ZERO, |values| values[cell])
        };
        for subdomain in &mut self.subdomains {
            let cells = subdomain.region.owned_global_cells();
            let history =
                subdomain.domain.initial_interlayer_history(&self.cells, |cell| cells[cell], value);
            subdomain.domain.set_interlayer_history(&mut history.into_iter());
        }
    }

    /// Sets the values of a field by cell (first axis fastest).
    pub fn set_field(&mut self, field: SolidField, values: &[T]) {
        self.set_permuted_values(field, &self.permutation.permute(values));
    }

    /// Sets the values of a field by cell of the whole grid with permuted axes, in owned cells and halos, since output
    /// may read the halos.
    fn set_permuted_values(&mut self, field: SolidField, values: &[T]) {
        if let [subdomain] = self.subdomains.as_mut_slice() {
            return subdomain.domain.set_field(field, values);
        }
        for subdomain in &mut self.subdomains {
            let cells = subdomain.region.global_cells();
            subdomain.domain.set_in_all_cells(field, |cell| values.get(cells[cell]).copied());
        }
    }
}
