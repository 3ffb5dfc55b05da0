//! Domain decomposition: subdomains of a grid, each on its own thread.
//!
//! In each pass over memory a subdomain receives a halo of [`HALO`] cells per step of the pass (more along the first
//! axis for alternating sweeps, see [`Decomposition`]) and advances the halo cells redundantly. Every cell undergoes
//! the same operations as without decomposition, and sums over cells are exact: results are identical bit for bit.
//! Along the last axis, layers are exchanged during the pass. The upper halo is received last: a subdomain can
//! therefore be almost one block of rows ahead of its upper neighbour, and short delays do not propagate. Along the
//! other axes the exchange precedes the pass, see [`HaloExchange`](crate::solid::domain::HaloExchange).

mod channels;
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

/// A subdomain with its halo.
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
        let mut own = std::mem::take(channels);
        let mut remaining = steps;
        while remaining > 0 {
            let steps = remaining.min(domain.max_pass_steps());
            domain.advance_pass(steps, &mut own)?;
            domain.drain_records(records);
            remaining -= steps;
        }
        *channels = own;
        Ok(())
    }

    /// Returns positions and numbers of history variables of the interlayers at the lower faces of owned cells.
    /// Position: layer of the whole grid across the last axis, axis normal to the face, and global cell above the face.
    /// `layer_cells`: number of cells of a layer of the whole grid.
    fn interlayers(&self, layer_cells: usize) -> Vec<([usize; 3], usize)> {
        let cells = self.region.owned_global_cells();
        let own = self.domain.interlayer_faces().into_iter();
        own.map(|[axis, cell, variables]| {
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
    watched_count: usize,
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
        let mut parts = [1; D];
        parts[D - 1] = count;
        Self::with_permuted_subdomains(problem, permutation, parts)
    }

    /// Creates a domain at rest, with `parts` subdomains along each axis of the problem and with `first_axis` swept
    /// first.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_subdomains(
        first_axis: usize,
        problem: &Problem<D>,
        parts: [usize; D],
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(first_axis, &problem.grid);
        Self::with_permuted_subdomains(problem, permutation, permutation.permute_axis_values(parts))
    }

    /// Creates a domain at rest, with `parts` subdomains along each permuted axis.
    fn with_permuted_subdomains(
        problem: &Problem<D>,
        permutation: AxisPermutation<D>,
        parts: [usize; D],
    ) -> Result<Self, DomainError> {
        let problem = &permutation.check_and_permute(problem)?;
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        let plan = Decomposition::new(&problem.grid, is_periodic, problem.pass_limits(), parts)?;
        let part = |region: &Region<D>| {
            let restricted = problem.restrict_to(region);
            Ok(Subdomain {
                domain: Domain::new_unchecked(&restricted, region, plan.max_pass_steps())?,
                region: region.clone(),
                channels: Channels::default(),
                watched_cells: Vec::new(),
                records: Vec::new(),
            })
        };
        let parts: Result<Vec<_>, DomainError> = plan.regions().iter().map(part).collect();
        let mut parts = parts?;
        let mut channels: Vec<_> = parts.iter().map(|_| Channels::default()).collect();
        for (index, part) in parts.iter().enumerate() {
            for axis in 0..D {
                if let Some(next) = plan.neighbour(index, axis, 1) {
                    let capacity = part.domain.message_capacity(axis);
                    Channels::connect(&mut channels, axis, [index, next], capacity);
                }
            }
        }
        for (part, channels) in parts.iter_mut().zip(channels) {
            part.channels = channels;
        }
        Ok(Self { subdomains: parts, permutation, cells: problem.grid.cells, watched_count: 0 })
    }

    /// Selects the instruction set; results do not depend on it.
    pub fn set_instructions(&mut self, instructions: InstructionSet) {
        for part in &mut self.subdomains {
            part.domain.set_instructions(instructions);
        }
    }

    /// See [`Domain::use_scalar_mapping`].
    #[doc(hidden)]
    pub fn use_scalar_mapping(&mut self) {
        for part in &mut self.subdomains {
            part.domain.use_scalar_mapping();
        }
    }

    /// Advances all fields by `steps` time steps: a single subdomain on the calling thread, several on a thread each.
    ///
    /// # Errors
    /// A thread cannot be started; the state is unchanged.
    pub fn advance(&mut self, steps: usize) -> Result<(), ThreadStartError> {
        self.advance_with(&mut SystemThreads, steps)
    }

    /// Advances as [`advance`](Self::advance) does, on threads of `starter`.
    #[doc(hidden)]
    pub fn advance_with(
        &mut self,
        starter: &mut impl ThreadStarter,
        steps: usize,
    ) -> Result<(), ThreadStartError> {
        // A neighbour's thread ends early only by a panic, which the scope propagates.
        if let [part] = self.subdomains.as_mut_slice() {
            let _ = part.advance(steps);
            return Ok(());
        }
        let task = |part| {
            move || {
                let _ = Subdomain::advance(part, steps);
            }
        };
        run_concurrently(starter, self.subdomains.iter_mut().map(task))
    }

    /// Returns the maximum number of steps per pass over memory; a pass reads and writes each field once.
    pub fn max_pass_steps(&self) -> usize {
        self.subdomains.first().map_or(1, |part| part.domain.max_pass_steps())
    }

    /// Returns the time, s.
    pub fn time(&self) -> f64 {
        self.subdomains.first().map_or(0.0, |part| part.domain.time())
    }

    /// Returns the fields of the state.
    pub fn fields(&self) -> &[SolidField] {
        self.subdomains.first().map_or(&[], |part| part.domain.fields())
    }

    /// Returns the number of output quantities per cell: fields and time integrals.
    pub fn quantity_count(&self) -> usize {
        let integrals = self.subdomains.first().map_or(0, |part| part.domain.integral_count());
        self.fields().len() + integrals
    }

    /// Records all output quantities of these cells after each step and discards earlier records; cells outside the
    /// grid give zeros.
    pub fn watch_cells(&mut self, cells: &[usize]) {
        self.watched_count = cells.len();
        for part in &mut self.subdomains {
            part.records.clear();
            let all = cells.iter().enumerate();
            part.watched_cells = all
                .filter_map(|(place, cell)| {
                    let cell = self.permutation.permuted_cell(*cell);
                    Some((place, part.region.owned_index(cell)?))
                })
                .collect();
            part.watched_cells.sort_by_key(|(_, cell)| *cell);
            part.domain.watch_cells(part.watched_cells.iter().map(|(_, cell)| *cell));
        }
    }

    /// Returns the records since the last call, by step, watched cell and output quantity; values as in
    /// [`Domain::output_cell`].
    pub fn take_records(&mut self) -> Vec<f64> {
        let width = self.quantity_count();
        let steps = self
            .subdomains
            .iter()
            .filter(|part| !part.watched_cells.is_empty())
            .map(|part| part.records.len() / (part.watched_cells.len() * width))
            .max()
            .unwrap_or(0);
        let mut all = vec![0.0; steps * self.watched_count * width];
        for part in &mut self.subdomains {
            let own = part.watched_cells.len();
            for (index, values) in part.records.chunks_exact(width).enumerate() {
                let (step, place) = (index / own, part.watched_cells[index % own].0);
                let start = (step * self.watched_count + place) * width;
                all[start..start + width].copy_from_slice(values);
            }
            part.records.clear();
        }
        all
    }

    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot<T> {
        let fields = self.fields().to_vec();
        Snapshot {
            steps: self.subdomains.first().map_or(0, |part| part.domain.steps()),
            fields: fields.into_iter().filter_map(|field| self.permuted_values(field)).collect(),
            work_sums: self.work_sums().to_partial_sums(),
            cell_sums: self.cell_sums(),
            interlayer_history: self.interlayer_history(),
        }
    }

    /// Returns the work sums of all subdomains.
    fn work_sums(&self) -> WorkSums {
        let mut sums = WorkSums::default();
        self.subdomains.iter().for_each(|part| sums.merge(part.domain.work()));
        sums
    }

    /// Returns to the state of rest before the first step.
    pub(crate) fn reset(&mut self) {
        let mut sums = self.cell_sums();
        sums.iter_mut().for_each(|own| own.fill(0.0));
        for part in &mut self.subdomains {
            part.domain.clear();
            part.domain.restore_work(0, WorkSums::default());
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
        for part in &mut self.subdomains {
            part.domain.clear();
        }
        for (field, values) in fields.into_iter().zip(&snapshot.fields) {
            self.set_permuted(field, values);
        }
        // The first subdomain holds the work sums of all; those of the others are zero.
        let mut work = WorkSums::from_partial_sums(&snapshot.work_sums);
        for part in &mut self.subdomains {
            part.domain.restore_work(snapshot.steps, std::mem::take(&mut work));
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
            self.subdomains.iter().map(|part| part.domain.cell_sums()).collect();
        let kinds = by_subdomain.first().map_or(0, Vec::len);
        (0..kinds)
            .map(|kind| {
                self.assemble_grid_values(by_subdomain.iter().map(|sums| sums[kind].clone()))
            })
            .collect()
    }

    fn set_cell_sums(&mut self, sums: &[Vec<f64>]) {
        for part in &mut self.subdomains {
            let cells = part.region.owned_global_cells();
            let of_part = |all: &Vec<f64>| {
                let own = cells.iter().filter(|_| !all.is_empty());
                own.map(|cell| all[*cell]).collect()
            };
            part.domain.set_cell_sums(&sums.iter().map(of_part).collect::<Vec<_>>());
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
        let mut all = Vec::new();
        for (part, values) in self.subdomains.iter().zip(by_subdomain) {
            // Any value for initialisation: all cells are overwritten.
            let Some(first) = values.first() else { continue };
            all.resize(self.cells.iter().product(), *first);
            for (cell, value) in part.region.owned_global_cells().into_iter().zip(values) {
                all[cell] = value;
            }
        }
        all
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
        self.subdomains.first().map_or(0.0, |part| part.domain.grid().volume())
    }

    /// Calls `evaluate` for each subdomain: a single one on the calling thread, several on a thread each if it starts.
    fn map_subdomains<V: Send>(&self, evaluate: impl Fn(&Domain<T, D>) -> V + Sync) -> Vec<V> {
        if let [part] = self.subdomains.as_slice() {
            return vec![evaluate(&part.domain)];
        }
        let domains = self.subdomains.iter().map(|part| &part.domain);
        evaluate_each(&mut SystemThreads, domains, evaluate)
    }

    /// Returns field and cell of a non-finite value (for interlayers, the cell above the face); `None` if all are
    /// finite. Each subdomain reports its first one; that with the lowest cell in the order of permuted axes is
    /// returned.
    pub fn first_non_finite(&self) -> Option<(SolidField, usize)> {
        let own = |part: &Subdomain<T, D>| {
            let (field, cell) = part.domain.first_non_finite()?;
            Some((part.region.owned_global_cell(cell), field))
        };
        let (cell, field) = self.subdomains.iter().filter_map(own).min_by_key(|own| own.0)?;
        Some((field, self.permutation.original_cell(cell)))
    }

    /// Records all output quantities of the watched cells in the present state.
    pub fn record_watched(&mut self) {
        for part in &mut self.subdomains {
            let boundaries = part.domain.closing_boundaries();
            for &(_, cell) in &part.watched_cells {
                part.domain.output_cell_with(cell, boundaries.as_ref(), &mut part.records);
            }
        }
    }

    /// Returns the first cell, in the order of permuted axes, whose stress is outside its yield set; `None` if there is
    /// none.
    pub fn first_beyond_yield(&self) -> Option<usize> {
        let own = |part: &Subdomain<T, D>| {
            Some(part.region.owned_global_cell(part.domain.first_beyond_yield()?))
        };
        let first = self.subdomains.iter().filter_map(own).min();
        first.map(|cell| self.permutation.original_cell(cell))
    }

    /// Returns the output quantities by cell (first axis fastest), see [`Domain::output_cell`].
    pub fn output_values(&self) -> Vec<Vec<f64>> {
        let of_part = |domain: &Domain<T, D>| {
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
            self.subdomains.iter().map(|part| of_part(&part.domain)).collect();
        let fields = 0..self.quantity_count();
        let gathered = fields.map(|field| {
            let own = by_subdomain.iter_mut().map(|fields| std::mem::take(&mut fields[field]));
            self.permutation.unpermute(self.assemble_grid_values(own))
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
        let by_subdomain = self.subdomains.iter().map(|part| part.domain.values(field));
        let by_subdomain = by_subdomain.collect::<Option<Vec<_>>>()?;
        Some(self.assemble_grid_values(by_subdomain.into_iter()))
    }

    /// Returns the position of each interlayer as [`Subdomain::interlayers`] does, in the order of
    /// [`Domain::interlayer_history`] of the whole grid, and the range of its history variables in that order.
    fn interlayers(&self) -> Vec<([usize; 3], Range<usize>)> {
        let layer: usize = self.cells[..D - 1].iter().product();
        let mut all: Vec<_> =
            self.subdomains.iter().flat_map(|part| part.interlayers(layer)).collect();
        all.sort_unstable();
        let mut end = 0;
        let range = |(position, variables): ([usize; 3], usize)| {
            end += variables;
            (position, end - variables..end)
        };
        all.into_iter().map(range).collect()
    }

    /// Returns the history variables of all interlayers, in the order of [`Domain::interlayer_history`] of the whole
    /// grid.
    pub fn interlayer_history(&self) -> Vec<T> {
        if let [part] = self.subdomains.as_slice() {
            return part.domain.interlayer_history();
        }
        let places = self.interlayers();
        let layer: usize = self.cells[..D - 1].iter().product();
        let mut all = vec![T::ZERO; places.last().map_or(0, |own| own.1.end)];
        for part in &self.subdomains {
            let mut history = part.domain.interlayer_history().into_iter();
            for (place, _) in part.interlayers(layer) {
                let index = places.partition_point(|other| other.0.cmp(&place).is_lt());
                let own = all[places[index].1.clone()].iter_mut();
                own.zip(&mut history).for_each(|(own, value)| *own = value);
            }
        }
        all
    }

    fn set_interlayer_history(&mut self, history: &[T]) {
        let places = self.interlayers();
        let layer: usize = self.cells[..D - 1].iter().product();
        for part in &mut self.subdomains {
            let own = part.interlayers(layer).into_iter();
            let history = own.flat_map(|(place, _)| {
                let index = places.partition_point(|other| other.0.cmp(&place).is_lt());
                history.get(places[index].1.clone()).unwrap_or_default()
            });
            let history: Vec<T> = history.copied().collect();
            part.domain.set_interlayer_history(&mut history.into_iter());
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
        for part in &mut self.subdomains {
            let cells = part.region.owned_global_cells();
            let history =
                part.domain.initial_interlayer_history(&self.cells, |cell| cells[cell], value);
            part.domain.set_interlayer_history(&mut history.into_iter());
        }
    }

    /// Sets the values of a field by cell (first axis fastest).
    pub fn set(&mut self, field: SolidField, values: &[T]) {
        self.set_permuted(field, &self.permutation.permute(values));
    }

    /// Sets the values of a field by cell of the whole grid with permuted axes, in owned cells and halos, since output
    /// may read the halos.
    fn set_permuted(&mut self, field: SolidField, values: &[T]) {
        if let [part] = self.subdomains.as_mut_slice() {
            return part.domain.set(field, values);
        }
        for part in &mut self.subdomains {
            let cells = part.region.global_cells();
            part.domain.set_in_all_cells(field, |cell| values.get(cells[cell]).copied());
        }
    }
}
