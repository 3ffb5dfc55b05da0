//! Domain decomposition: subdomains of a grid, each on its own thread.
//!
//! In each pass over memory a subdomain receives a halo of [`HALO`] cells per step of the pass (more along the first
//! axis for alternating sweeps, see [`Decomposition`]) and recomputes it redundantly. Every cell undergoes the same
//! operations as without decomposition, and sums are exact: results are identical bit for bit. Along the last axis,
//! layers are exchanged during the pass; the upper halo is received last, so that a thread can run almost one block of
//! rows ahead of its upper neighbour and short delays do not propagate. Along the other axes the exchange precedes the
//! pass, see [`HaloExchange`](crate::solid::domain::HaloExchange).

mod channels;
mod plan;

use crate::simd::Instructions;
use crate::solid::axis_permutation::AxisPermutation;
use crate::solid::boundary::Boundary;
use crate::solid::domain::{Domain, SolverReal};
use crate::solid::ledger::{Energy, EnergySums, Ledger, LedgerSums, WorkSums};
use crate::solid::line::HALO;
use crate::solid::problem::{DomainError, Problem};
use crate::solid::region::Region;
use channels::{Channels, Disconnected};
use models::solid::waves::Field;

pub use crate::solid::snapshot::Snapshot;
pub use plan::Decomposition;

/// A subdomain with its halo.
struct Subdomain<T: SolverReal, const D: usize> {
    domain: Domain<T, D>,
    region: Region<D>,
    halo: Channels<T::Lanes, D>,
    /// Cells recorded after each step: index in the list of all watched cells, index in the subdomain.
    watched: Vec<(usize, usize)>,
    /// Records of these cells: all fields, by step and cell.
    records: Vec<f64>,
}

impl<T: SolverReal, const D: usize> Subdomain<T, D> {
    fn advance(&mut self, steps: usize) -> Result<(), Disconnected> {
        let Self { domain, halo, records, .. } = self;
        // A panic drops the channels, so that `recv` of the neighbours fails instead of blocking.
        let mut own = std::mem::take(halo);
        let mut left = steps;
        while left > 0 {
            let steps = left.min(domain.most_steps());
            domain.pass(steps, &mut own)?;
            domain.drain_records(records);
            left -= steps;
        }
        *halo = own;
        Ok(())
    }

    /// Returns position and memory of the interlayers at the lower faces of owned cells. Position: layer, axis, global
    /// cell above the face, wave pair.
    fn interlayers(&self, layer_cells: usize) -> Vec<([usize; 4], [T; 2])> {
        let cells = self.region.own_global_cells();
        let own = self.domain.interlayers().into_iter();
        own.map(|([axis, cell, pair], memory)| {
            ([cells[cell] / layer_cells, axis, cells[cell], pair], memory)
        })
        .collect()
    }
}

/// A domain decomposed into subdomains.
pub struct DecomposedDomain<T: SolverReal, const D: usize> {
    parts: Vec<Subdomain<T, D>>,
    /// Permutation from the axes of the problem to those of the subdomains.
    permutation: AxisPermutation<D>,
    /// Number of cells of the whole grid along each permuted axis.
    cells: [usize; D],
    /// Number of watched cells.
    watched: usize,
}

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// A domain at rest, decomposed into `count` subdomains along its last axis.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>, count: usize) -> Result<Self, DomainError> {
        Self::with_first_axis(0, problem, count)
    }

    /// Returns the maximum number of subdomains along the last axis.
    pub fn max_parts(first_axis: usize, problem: &Problem<D>) -> usize {
        let permutation = AxisPermutation::with_first(first_axis, &problem.grid);
        (permutation.grid(&problem.grid).cells[D - 1] / HALO).max(1)
    }

    /// A domain at rest in `count` subdomains, with `axis` swept first. The other axes keep their order; the domain is
    /// cut along the last of them.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_first_axis(
        axis: usize,
        problem: &Problem<D>,
        count: usize,
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first(axis, &problem.grid);
        let mut parts = [1; D];
        parts[D - 1] = count;
        Self::in_parts(problem, permutation, parts)
    }

    /// A domain at rest, in `parts` subdomains along each axis of the problem, with `first_axis` swept first.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn in_box(
        first_axis: usize,
        problem: &Problem<D>,
        parts: [usize; D],
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first(first_axis, &problem.grid);
        Self::in_parts(problem, permutation, permutation.along(parts))
    }

    /// A domain at rest, in `parts` subdomains along each permuted axis.
    fn in_parts(
        problem: &Problem<D>,
        permutation: AxisPermutation<D>,
        parts: [usize; D],
    ) -> Result<Self, DomainError> {
        let problem = &permutation.checked(problem)?;
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        let plan = Decomposition::new(&problem.grid, is_periodic, &problem.scheme, parts)?;
        let part = |region: &Region<D>| Subdomain {
            domain: Domain::of_region(&problem.restricted(region), region, plan.most_steps()),
            region: region.clone(),
            halo: Channels::default(),
            watched: Vec::new(),
            records: Vec::new(),
        };
        let mut parts: Vec<_> = plan.regions().iter().map(part).collect();
        let mut channels: Vec<_> = parts.iter().map(|_| Channels::default()).collect();
        for (index, part) in parts.iter().enumerate() {
            for axis in 0..D {
                if let Some(next) = plan.neighbour(index, axis, 1) {
                    let room = part.domain.messages_ahead(axis);
                    Channels::connect(&mut channels, axis, [index, next], room);
                }
            }
        }
        for (part, halo) in parts.iter_mut().zip(channels) {
            part.halo = halo;
        }
        Ok(Self { parts, permutation, cells: problem.grid.cells, watched: 0 })
    }

    /// Selects the instruction set; results do not depend on it.
    pub fn set_instructions(&mut self, instructions: Instructions) {
        for part in &mut self.parts {
            part.domain.set_instructions(instructions);
        }
    }

    /// See [`Domain::map_stresses_one_by_one`].
    #[doc(hidden)]
    pub fn map_stresses_one_by_one(&mut self) {
        for part in &mut self.parts {
            part.domain.map_stresses_one_by_one();
        }
    }

    /// Advances all fields by `steps` time steps, each subdomain on its own thread.
    pub fn advance(&mut self, steps: usize) {
        // A neighbour's thread ends early only by a panic, which the scope propagates.
        if let [part] = self.parts.as_mut_slice() {
            let _ = part.advance(steps);
            return;
        }
        std::thread::scope(|scope| {
            for part in &mut self.parts {
                scope.spawn(move || part.advance(steps));
            }
        });
    }

    /// Returns the maximum number of steps per pass over memory; a pass reads and writes each field once.
    pub fn most_steps(&self) -> usize {
        self.parts.first().map_or(1, |part| part.domain.most_steps())
    }

    /// Returns the time, s.
    pub fn time(&self) -> f64 {
        self.parts.first().map_or(0.0, |part| part.domain.time())
    }

    /// Returns the fields of the state.
    pub fn fields(&self) -> &[Field] {
        self.parts.first().map_or(&[], |part| part.domain.fields())
    }

    /// Returns the number of output quantities per cell: fields and time integrals.
    pub fn width(&self) -> usize {
        let integrals = self.parts.first().map_or(0, |part| part.domain.integral_count());
        self.fields().len() + integrals
    }

    /// Records all fields of these cells after each step and discards earlier records; cells outside the grid give
    /// zeros.
    pub fn watch(&mut self, cells: &[usize]) {
        self.watched = cells.len();
        for part in &mut self.parts {
            part.records.clear();
            let all = cells.iter().enumerate();
            part.watched = all
                .filter_map(|(place, cell)| {
                    let cell = self.permutation.permuted_cell(*cell);
                    Some((place, part.region.own_number(cell)?))
                })
                .collect();
            part.watched.sort_by_key(|(_, cell)| *cell);
            part.domain.watch(part.watched.iter().map(|(_, cell)| *cell));
        }
    }

    /// Returns the records since the last call, by step, watched cell and field; values as in [`Domain::output_cell`].
    pub fn records(&mut self) -> Vec<f64> {
        let width = self.width();
        let steps = self
            .parts
            .iter()
            .filter(|part| !part.watched.is_empty())
            .map(|part| part.records.len() / (part.watched.len() * width))
            .max()
            .unwrap_or(0);
        let mut all = vec![0.0; steps * self.watched * width];
        for part in &mut self.parts {
            let own = part.watched.len();
            for (index, values) in part.records.chunks_exact(width).enumerate() {
                let (step, place) = (index / own, part.watched[index % own].0);
                let start = (step * self.watched + place) * width;
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
            steps: self.parts.first().map_or(0, |part| part.domain.steps()),
            fields: fields.into_iter().filter_map(|field| self.inner_values(field)).collect(),
            work: self.work().parts(),
            sums: self.sums(),
            interlayers: self.interlayer_memory(),
        }
    }

    /// Returns the work sums of all subdomains.
    fn work(&self) -> WorkSums {
        let mut sums = WorkSums::default();
        self.parts.iter().for_each(|part| sums.merge(part.domain.work()));
        sums
    }

    /// Returns to the state of rest before the first step.
    pub(crate) fn reset(&mut self) {
        let mut sums = self.sums();
        sums.iter_mut().for_each(|own| own.fill(0.0));
        for part in &mut self.parts {
            part.domain.clear();
            part.domain.restore_work(0, WorkSums::default());
        }
        self.set_sums(&sums);
    }

    /// Restores a snapshot; `false` if it belongs to another problem.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        let cells: usize = self.cells.iter().product();
        let fields = self.fields().to_vec();
        if snapshot.fields.len() != fields.len()
            || snapshot.fields.iter().any(|values| values.len() != cells)
            || snapshot.sums.iter().map(Vec::len).ne(self.sums().iter().map(Vec::len))
            || snapshot.interlayers.len() != self.interlayer_memory().len()
        {
            return false;
        }
        for part in &mut self.parts {
            part.domain.clear();
        }
        for (field, values) in fields.into_iter().zip(&snapshot.fields) {
            self.set_inner(field, values);
        }
        // The first subdomain holds the work sums of all; those of the others are zero.
        let mut work = WorkSums::from_parts(&snapshot.work);
        for part in &mut self.parts {
            part.domain.restore_work(snapshot.steps, std::mem::take(&mut work));
        }
        self.set_sums(&snapshot.sums);
        self.set_interlayer_memory(&snapshot.interlayers);
        true
    }

    /// Returns the plastic dissipation by cell, J/m³; empty if no medium yields.
    pub fn dissipated(&self) -> Vec<f64> {
        self.permutation.unpermute(self.sums().swap_remove(0))
    }

    /// Returns the sums stored per cell of the whole grid, by kind.
    fn sums(&self) -> Vec<Vec<f64>> {
        let of_parts: Vec<_> = self.parts.iter().map(|part| part.domain.sums()).collect();
        let kinds = of_parts.first().map_or(0, Vec::len);
        (0..kinds).map(|kind| self.gather(of_parts.iter().map(|sums| sums[kind].clone()))).collect()
    }

    fn set_sums(&mut self, sums: &[Vec<f64>]) {
        for part in &mut self.parts {
            let cells = part.region.own_global_cells();
            let of_part = |all: &Vec<f64>| {
                let own = cells.iter().filter(|_| !all.is_empty());
                own.map(|cell| all[*cell]).collect()
            };
            part.domain.set_sums(&sums.iter().map(of_part).collect::<Vec<_>>());
        }
    }

    /// Gathers values of the whole grid from those of the owned cells of all subdomains; empty if these are.
    fn gather<V: Copy>(&self, mut of_parts: impl Iterator<Item = Vec<V>>) -> Vec<V> {
        if self.parts.len() == 1 {
            return of_parts.next().unwrap_or_default();
        }
        let mut all = Vec::new();
        for (part, values) in self.parts.iter().zip(of_parts) {
            // Any value for initialisation: all cells are overwritten.
            let Some(first) = values.first() else { continue };
            all.resize(self.cells.iter().product(), *first);
            for (cell, value) in part.region.own_global_cells().into_iter().zip(values) {
                all[cell] = value;
            }
        }
        all
    }

    /// Returns work and dissipation of the steps so far, J.
    pub fn ledger(&self) -> Ledger {
        let mut sums = LedgerSums::default();
        let of_parts = self.of_parts(|domain| domain.ledger_sums());
        of_parts.iter().for_each(|own| sums.merge(own));
        sums.ledger(self.volume())
    }

    /// Returns the energy of the deviation from the initial stress, J.
    pub fn energy(&self) -> Energy {
        let mut sums = EnergySums::default();
        let of_parts = self.of_parts(|domain| domain.energy_sums());
        of_parts.iter().for_each(|own| sums.merge(own));
        sums.energy(self.volume())
    }

    /// Returns the volume of a cell, m³.
    fn volume(&self) -> f64 {
        self.parts.first().map_or(0.0, |part| part.domain.grid().volume())
    }

    /// Evaluates `of` for each subdomain, each on its own thread.
    fn of_parts<V: Send + Default>(&self, of: impl Fn(&Domain<T, D>) -> V + Sync) -> Vec<V> {
        if let [part] = self.parts.as_slice() {
            return vec![of(&part.domain)];
        }
        let of = &of;
        std::thread::scope(|scope| {
            let domains = self.parts.iter().map(|part| &part.domain);
            let threads: Vec<_> = domains.map(|domain| scope.spawn(move || of(domain))).collect();
            threads.into_iter().map(|thread| thread.join().unwrap_or_default()).collect()
        })
    }

    /// Returns field and cell of the first non-finite value.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let own = |part: &Subdomain<T, D>| {
            let (field, cell) = part.domain.first_non_finite()?;
            Some((part.region.own_global_cell(cell), field))
        };
        let (cell, field) = self.parts.iter().filter_map(own).min_by_key(|own| own.0)?;
        Some((field, self.permutation.original_cell(cell)))
    }

    /// Records all fields of the watched cells in the present state.
    pub fn record(&mut self) {
        for part in &mut self.parts {
            let sides = part.domain.closing_boundaries();
            for &(_, cell) in &part.watched {
                part.domain.output_cell_between(cell, sides.as_ref(), &mut part.records);
            }
        }
    }

    /// Returns the first cell whose stress is outside its yield set.
    pub fn first_beyond_yield(&self) -> Option<usize> {
        let own = |part: &Subdomain<T, D>| {
            Some(part.region.own_global_cell(part.domain.first_beyond_yield()?))
        };
        let first = self.parts.iter().filter_map(own).min();
        first.map(|cell| self.permutation.original_cell(cell))
    }

    /// Returns the output quantities by cell (first axis fastest), see [`Domain::output_cell`].
    pub fn output_fields(&self) -> Vec<Vec<f64>> {
        let of_part = |domain: &Domain<T, D>| {
            let mut fields = vec![Vec::new(); self.width()];
            let (sides, mut state) = (domain.closing_boundaries(), Vec::new());
            for cell in 0..domain.grid().count() {
                state.clear();
                domain.output_cell_between(cell, sides.as_ref(), &mut state);
                for (values, value) in fields.iter_mut().zip(&state) {
                    values.push(*value);
                }
            }
            fields
        };
        let mut of_parts: Vec<_> = self.parts.iter().map(|part| of_part(&part.domain)).collect();
        let fields = 0..self.width();
        let gathered = fields.map(|field| {
            let own = of_parts.iter_mut().map(|fields| std::mem::take(&mut fields[field]));
            self.permutation.unpermute(self.gather(own))
        });
        gathered.collect()
    }

    /// Returns the stored values of a field (first axis fastest), without completing the step; `None` if there is no
    /// such field.
    pub fn values(&self, field: Field) -> Option<Vec<T>> {
        self.inner_values(field).map(|values| self.permutation.unpermute(values))
    }

    /// Returns the stored values of a field by cell of the whole grid, with permuted axes.
    fn inner_values(&self, field: Field) -> Option<Vec<T>> {
        let of_parts = self.parts.iter().map(|part| part.domain.values(field));
        let of_parts = of_parts.collect::<Option<Vec<_>>>()?;
        Some(self.gather(of_parts.into_iter()))
    }

    /// Returns position and memory of all interlayers, in the order of [`Domain::interlayer_memory`] of the whole grid.
    fn interlayers(&self) -> Vec<([usize; 4], [T; 2])> {
        let layer: usize = self.cells[..D - 1].iter().product();
        let mut all: Vec<_> = self.parts.iter().flat_map(|part| part.interlayers(layer)).collect();
        all.sort_unstable_by_key(|own| own.0);
        all
    }

    /// Returns V and S of all interlayers, in the order of [`Domain::interlayer_memory`] of the whole grid.
    pub fn interlayer_memory(&self) -> Vec<[T; 2]> {
        self.interlayers().into_iter().map(|own| own.1).collect()
    }

    fn set_interlayer_memory(&mut self, memory: &[[T; 2]]) {
        let places: Vec<_> = self.interlayers().into_iter().map(|own| own.0).collect();
        let layer: usize = self.cells[..D - 1].iter().product();
        for part in &mut self.parts {
            let own = part.interlayers(layer).into_iter();
            let memory = own.map(|(place, _)| {
                let index = places.partition_point(|other| *other < place);
                memory.get(index).copied().unwrap_or([T::ZERO; 2])
            });
            part.domain.set_interlayer_memory(&mut memory.collect::<Vec<_>>().into_iter());
        }
    }

    /// Initialises interlayers with the motion of the adjacent cells, see [`Domain::initialise_interlayers`].
    pub fn initialise_interlayers(&mut self) {
        let fields = self.fields().to_vec();
        let values: Vec<_> = fields.iter().map(|&field| self.inner_values(field)).collect();
        let value = |field: Field, cell: usize| {
            let index = fields.iter().position(|own| *own == field);
            let values = index.and_then(|index| values[index].as_ref());
            values.map_or(T::ZERO, |values| values[cell])
        };
        for part in &mut self.parts {
            let cells = part.region.own_global_cells();
            let memory = part.domain.interlayers_at_start(&self.cells, |cell| cells[cell], value);
            part.domain.set_interlayer_memory(&mut memory.into_iter());
        }
    }

    /// Sets the values of a field by cell (first axis fastest).
    pub fn set(&mut self, field: Field, values: &[T]) {
        self.set_inner(field, &self.permutation.permute(values));
    }

    /// Sets the values of a field by cell of the whole grid with permuted axes, halos included, since output may read
    /// them.
    fn set_inner(&mut self, field: Field, values: &[T]) {
        if let [part] = self.parts.as_mut_slice() {
            return part.domain.set(field, values);
        }
        for part in &mut self.parts {
            let cells = part.region.global_cells();
            part.domain.set_all(field, |cell| values.get(cells[cell]).copied());
        }
    }
}
