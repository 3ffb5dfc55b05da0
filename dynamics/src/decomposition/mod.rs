//! Domain decomposition: parts of a grid, each in a thread of its own.
//!
//! In each pass over memory a part receives a halo of [`HALO`] cells for each step of the pass from
//! its neighbours (and more along the first axis where sweeps alternate, see [`Decomposition`]) and recomputes it redundantly. Every cell sees the same operations as in the whole, and sums are exact: the
//! same bits. Along the last axis layers are exchanged while the pass goes on: the upper halo is received last, so that a
//! thread can run almost one block of rows ahead of its upper neighbour, and one that is delayed for a moment does not delay
//! the others. Along the other axes all is exchanged before a pass begins, see [`HaloExchange`](crate::solid::domain::HaloExchange).

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

/// A part with its halo.
struct Part<T: SolverReal, const D: usize> {
    domain: Domain<T, D>,
    region: Region<D>,
    halo: Channels<T::Lanes, D>,
    /// Cells to be recorded after each step, in their order: places in the list of all, and own cells.
    watched: Vec<(usize, usize)>,
    /// All fields of those cells by step and cell.
    records: Vec<f64>,
}

impl<T: SolverReal, const D: usize> Part<T, D> {
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

    /// Places of interlayers in front of own cells: by layer, axis of the face, cell behind it among all, pair of waves.
    fn interlayers(&self, layer_cells: usize) -> Vec<([usize; 4], [T; 2])> {
        let cells = self.region.own_global_cells();
        let own = self.domain.interlayers().into_iter();
        own.map(|([axis, cell, pair], memory)| {
            ([cells[cell] / layer_cells, axis, cells[cell], pair], memory)
        })
        .collect()
    }
}

/// A domain in parts.
pub struct DecomposedDomain<T: SolverReal, const D: usize> {
    parts: Vec<Part<T, D>>,
    /// From the axes and cells of the problem to those of the parts.
    permutation: AxisPermutation<D>,
    /// Cells of the whole along each axis of the parts.
    cells: [usize; D],
    /// Number of watched cells.
    watched: usize,
}

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// A domain at rest, in `count` parts along its last axis.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>, count: usize) -> Result<Self, DomainError> {
        Self::with_first_axis(0, problem, count)
    }

    /// The largest number of parts a domain may be cut into along its last axis.
    pub fn max_parts(first_axis: usize, problem: &Problem<D>) -> usize {
        let permutation = AxisPermutation::with_first(first_axis, &problem.grid);
        (permutation.grid(&problem.grid).cells[D - 1] / HALO).max(1)
    }

    /// A domain in `count` parts with `axis` swept as the first one. The others keep their order; the domain is cut along the last of
    /// them.
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

    /// A domain at rest, in a box of so many parts along each axis of the problem, with `first_axis` swept as the first one.
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

    /// So many parts along each permuted axis.
    fn in_parts(
        problem: &Problem<D>,
        permutation: AxisPermutation<D>,
        parts: [usize; D],
    ) -> Result<Self, DomainError> {
        let problem = &permutation.checked(problem)?;
        let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
        let plan = Decomposition::new(&problem.grid, is_periodic, &problem.scheme, parts)?;
        let part = |region: &Region<D>| Part {
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

    /// Uses other instructions than the best; results do not depend on them.
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

    /// Advances all fields by `steps` time steps, each part in a thread of its own.
    pub fn advance(&mut self, steps: usize) {
        // The thread of a neighbour is gone only if it has panicked, and then the scope panics as well.
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

    /// Steps that a pass over the memory makes at most: each field goes in and out of the memory once in it.
    pub fn most_steps(&self) -> usize {
        self.parts.first().map_or(1, |part| part.domain.most_steps())
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.parts.first().map_or(0.0, |part| part.domain.time())
    }

    /// The components of the state.
    pub fn fields(&self) -> &[Field] {
        self.parts.first().map_or(&[], |part| part.domain.fields())
    }

    /// Numbers that are shown of a cell: its fields and the integrals of the problem.
    pub fn width(&self) -> usize {
        let integrals = self.parts.first().map_or(0, |part| part.domain.integral_count());
        self.fields().len() + integrals
    }

    /// Records all fields of these cells after each step, and forgets what was recorded of others; of cells
    /// that are not there zeros.
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

    /// What was recorded since the last call: by step, then by watched cell, then by field, as
    /// [`Domain::output_cell`] gives them.
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

    /// All that the steps to come depend on.
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

    /// What steps added up in all parts.
    fn work(&self) -> WorkSums {
        let mut sums = WorkSums::default();
        self.parts.iter().for_each(|part| sums.merge(part.domain.work()));
        sums
    }

    /// Goes back to rest, before the first step.
    pub(crate) fn reset(&mut self) {
        let mut sums = self.sums();
        sums.iter_mut().for_each(|own| own.fill(0.0));
        for part in &mut self.parts {
            part.domain.clear();
            part.domain.restore_work(0, WorkSums::default());
        }
        self.set_sums(&sums);
    }

    /// Goes back, or on, to a snapshot of the same problem; `false` where it is one of another.
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
        // The first part takes the sums of all parts, the others none.
        let mut work = WorkSums::from_parts(&snapshot.work);
        for part in &mut self.parts {
            part.domain.restore_work(snapshot.steps, std::mem::take(&mut work));
        }
        self.set_sums(&snapshot.sums);
        self.set_interlayer_memory(&snapshot.interlayers);
        true
    }

    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    pub fn dissipated(&self) -> Vec<f64> {
        self.permutation.unpermute(self.sums().swap_remove(0))
    }

    /// By kind and cell of the whole.
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

    /// Values of the whole, from those of the own cells of all parts; none where these have none.
    fn gather<V: Copy>(&self, mut of_parts: impl Iterator<Item = Vec<V>>) -> Vec<V> {
        if self.parts.len() == 1 {
            return of_parts.next().unwrap_or_default();
        }
        let mut all = Vec::new();
        for (part, values) in self.parts.iter().zip(of_parts) {
            // To begin with, any values.
            let Some(first) = values.first() else { continue };
            all.resize(self.cells.iter().product(), *first);
            for (cell, value) in part.region.own_global_cells().into_iter().zip(values) {
                all[cell] = value;
            }
        }
        all
    }

    /// What steps did to the energy so far.
    pub fn ledger(&self) -> Ledger {
        let mut sums = LedgerSums::default();
        let of_parts = self.of_parts(|domain| domain.ledger_sums());
        of_parts.iter().for_each(|own| sums.merge(own));
        sums.ledger(self.volume())
    }

    /// Energy of the deviation from the initial stress.
    pub fn energy(&self) -> Energy {
        let mut sums = EnergySums::default();
        let of_parts = self.of_parts(|domain| domain.energy_sums());
        of_parts.iter().for_each(|own| sums.merge(own));
        sums.energy(self.volume())
    }

    /// Volume of a cell, m³.
    fn volume(&self) -> f64 {
        self.parts.first().map_or(0.0, |part| part.domain.grid().volume())
    }

    /// Something of each part, each in a thread of its own.
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

    /// The first value that is not finite: its field and its cell.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let own = |part: &Part<T, D>| {
            let (field, cell) = part.domain.first_non_finite()?;
            Some((part.region.own_global_cell(cell), field))
        };
        let (cell, field) = self.parts.iter().filter_map(own).min_by_key(|own| own.0)?;
        Some((field, self.permutation.original_cell(cell)))
    }

    /// Records all fields of the watched cells as they are.
    pub fn record(&mut self) {
        for part in &mut self.parts {
            let sides = part.domain.closing_boundaries();
            for &(_, cell) in &part.watched {
                part.domain.output_cell_between(cell, sides.as_ref(), &mut part.records);
            }
        }
    }

    /// The first cell whose stress is not in its yield set.
    pub fn first_beyond_yield(&self) -> Option<usize> {
        let own = |part: &Part<T, D>| {
            Some(part.region.own_global_cell(part.domain.first_beyond_yield()?))
        };
        let first = self.parts.iter().filter_map(own).min();
        first.map(|cell| self.permutation.original_cell(cell))
    }

    /// The values of all fields, the first axis running fastest, as [`Domain::output_cell`] gives them.
    pub fn shown(&self) -> Vec<Vec<f64>> {
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

    /// The values of a field as they are computed with, the first axis running fastest; `None` if there is
    /// no such field.
    pub fn values(&self, field: Field) -> Option<Vec<T>> {
        self.inner_values(field).map(|values| self.permutation.unpermute(values))
    }

    /// By cell of the whole, with the axes of the parts.
    fn inner_values(&self, field: Field) -> Option<Vec<T>> {
        let of_parts = self.parts.iter().map(|part| part.domain.values(field));
        let of_parts = of_parts.collect::<Option<Vec<_>>>()?;
        Some(self.gather(of_parts.into_iter()))
    }

    /// Places of all interlayers and their memories, in the order of [`Domain::interlayer_memory`] of the whole.
    fn interlayers(&self) -> Vec<([usize; 4], [T; 2])> {
        let layer: usize = self.cells[..D - 1].iter().product();
        let mut all: Vec<_> = self.parts.iter().flat_map(|part| part.interlayers(layer)).collect();
        all.sort_unstable_by_key(|own| own.0);
        all
    }

    /// V and S of all faces with interlayers, in the order of [`Domain::interlayer_memory`] of the whole.
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

    /// Lets interlayers move with the cells beside them, as [`Domain::initialise_interlayers`].
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

    /// Sets the values of a field, the first axis running fastest: as many as there are cells.
    pub fn set(&mut self, field: Field, values: &[T]) {
        self.set_inner(field, &self.permutation.permute(values));
    }

    /// By cell of the whole, with the axes of the parts; those of halos as well, which output may look at.
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
