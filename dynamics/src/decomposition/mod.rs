//! Domain decomposition: slabs along the last axis, each in a thread of its own.
//!
//! In each pass over memory a subdomain receives [`HALO`] layers for each of its steps from its neighbours and
//! recomputes them redundantly. Every cell sees the same operations as in the whole, and sums are made by
//! layers: the same bits. The upper halo is received last, so that a thread can run almost one block of rows
//! ahead of its upper neighbour: a thread that is delayed for a moment does not delay the others.

mod axis_permutation;

use crate::simd::Instructions;
use crate::solid::boundary::Boundary;
use crate::solid::domain::{Domain, Halo, SolverReal, most_steps};
use crate::solid::ledger::{Energy, Ledger, Total};
use crate::solid::line::HALO;
use crate::solid::problem::{DomainError, Problem};
use axis_permutation::AxisPermutation;
use models::solid::waves::Field;
use std::ops::Range;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// The halo of a part whose neighbours are other threads of the process.
#[derive(Debug)]
struct Channels<T> {
    neighbours: [Option<Neighbour<T>>; 2],
}

impl<T> Default for Channels<T> {
    fn default() -> Self {
        Self { neighbours: [None, None] }
    }
}

/// A neighbour, and messages that came from it, to be filled anew.
#[derive(Debug)]
struct Neighbour<T> {
    to: SyncSender<Vec<T>>,
    from: Receiver<Vec<T>>,
    spare: Vec<Vec<T>>,
}

impl<T: Copy> Halo<T> for Channels<T> {
    fn begin(&mut self, end: usize, data: &[T], pieces: impl Iterator<Item = Range<usize>>) {
        if let Some(neighbour) = &mut self.neighbours[end] {
            let mut message = neighbour.spare.pop().unwrap_or_default();
            message.clear();
            pieces.for_each(|piece| message.extend_from_slice(&data[piece]));
            // A neighbour that is gone has panicked, as the thread that joins it will.
            let _ = neighbour.to.send(message);
        }
    }

    fn finish(&mut self, end: usize, data: &mut [T], pieces: impl Iterator<Item = Range<usize>>) {
        if let Some(neighbour) = &mut self.neighbours[end]
            && let Ok(received) = neighbour.from.recv()
        {
            let mut rest = received.as_slice();
            for piece in pieces {
                let (own, others) = rest.split_at(piece.len());
                data[piece].copy_from_slice(own);
                rest = others;
            }
            debug_assert!(rest.is_empty());
            neighbour.spare.push(received);
        }
    }
}

/// A slab with its halo.
struct Part<T: SolverReal, const D: usize> {
    domain: Domain<T, D>,
    halo: Channels<T::Lanes>,
    /// Its first cell.
    first: usize,
    /// Cells to be recorded after each step, in their order: places in the list of all, and own cells.
    watched: Vec<(usize, usize)>,
    /// All fields of those cells by step and cell.
    records: Vec<f64>,
}

impl<T: SolverReal, const D: usize> Part<T, D> {
    fn advance(&mut self, steps: usize) {
        let Self { domain, halo, records, .. } = self;
        // A panic drops the channels, so that `recv` of the neighbours fails instead of blocking.
        let mut own = std::mem::take(halo);
        let mut left = steps;
        while left > 0 {
            let steps = left.min(domain.most_steps());
            domain.pass(steps, &mut own);
            domain.drain_records(records);
            left -= steps;
        }
        *halo = own;
    }
}

/// All that the steps to come depend on, however many parts there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<T> {
    /// Steps done.
    pub steps: usize,
    /// Values by field, then by cell, the axis of the first sweeps running fastest.
    pub fields: Vec<Vec<T>>,
    /// The ledger by layer across the axis along which the domain is cut.
    pub totals: Vec<[f64; 14]>,
    /// Plastic dissipation by cell, where anything yields, J/m³; then the sums of the problem's integrals.
    pub sums: Vec<Vec<f64>>,
    /// V and S of interlayers, in the order of [`Domain::interlayer_memory`].
    pub interlayers: Vec<[T; 2]>,
}

/// A domain in parts.
pub struct Split<T: SolverReal, const D: usize> {
    parts: Vec<Part<T, D>>,
    /// From the axes and cells of the problem to those of the parts.
    permutation: AxisPermutation<D>,
    /// Number of watched cells.
    watched: usize,
}

impl<T: SolverReal, const D: usize> Split<T, D> {
    /// A domain at rest, in `count` parts.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>, count: usize) -> Result<Self, DomainError> {
        Self::with_first_axis(0, problem, count)
    }

    /// The largest number of parts a domain may be cut into.
    pub fn max_parts(first_axis: usize, problem: &Problem<D>) -> usize {
        let permutation = AxisPermutation::with_first(first_axis, &problem.grid);
        (permutation.grid(&problem.grid).cells[D - 1] / HALO).max(1)
    }

    /// The same with this axis swept as the first one. The others keep their order; the domain is cut along the last of
    /// them.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_first_axis(
        axis: usize,
        problem: &Problem<D>,
        count: usize,
    ) -> Result<Self, DomainError> {
        problem.check()?;
        let permutation = AxisPermutation::with_first(axis, &problem.grid);
        let problem = &permutation.problem(problem);
        let layers = problem.grid.cells[D - 1];
        if count == 0 || (count > 1 && layers / count < HALO) {
            return Err(DomainError::Parts { found: count, cells: layers });
        }
        let is_periodic = problem.boundaries[D - 1][0] == Boundary::Periodic;
        let mut parts = Vec::with_capacity(count);
        for index in 0..count {
            let range = index * layers / count..(index + 1) * layers / count;
            let is_cut =
                [index > 0, index + 1 < count].map(|inside| count > 1 && (inside || is_periodic));
            let first = range.start * problem.grid.faces(D - 1);
            parts.push(Part {
                domain: Domain::slab(problem, range, is_cut, most_steps::<D>(layers / count)),
                halo: Channels::default(),
                first,
                watched: Vec::new(),
                records: Vec::new(),
            });
        }
        for index in 0..count {
            let next = (index + 1) % count;
            if count == 1 || (next == 0 && !is_periodic) {
                continue;
            }
            // Channel capacity: the halo layers of two blocks of rows.
            // Interlayers send a second message for each layer.
            let messages = if problem.interlayers.is_empty() { 1 } else { 2 };
            let bound = messages * 2 * HALO * most_steps::<D>(layers / count);
            let ((forth, from_behind), (back, from_ahead)) =
                (sync_channel(bound), sync_channel(bound));
            let neighbour = |to, from| Some(Neighbour { to, from, spare: Vec::new() });
            parts[index].halo.neighbours[1] = neighbour(forth, from_ahead);
            parts[next].halo.neighbours[0] = neighbour(back, from_behind);
        }
        Ok(Self { parts, permutation, watched: 0 })
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
        if let [part] = self.parts.as_mut_slice() {
            return part.advance(steps);
        }
        std::thread::scope(|scope| {
            for part in &mut self.parts {
                scope.spawn(move || part.advance(steps));
            }
        });
    }

    /// Steps that a pass over the memory makes at most. With [`Detail::Light`](crate::solid::problem::Detail) each field
    /// goes in and out of the memory once in it.
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
            let own = part.first..part.first + part.domain.grid().count();
            part.watched = cells
                .iter()
                .map(|cell| self.permutation.permuted_cell(*cell))
                .enumerate()
                .filter(|(_, cell)| own.contains(cell))
                .map(|(place, cell)| (place, cell - part.first))
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
        let totals = self.parts.iter().flat_map(|part| part.domain.totals());
        Snapshot {
            steps: self.parts.first().map_or(0, |part| part.domain.steps()),
            fields: fields.into_iter().filter_map(|field| self.inner_values(field)).collect(),
            totals: totals.map(Total::numbers).collect(),
            sums: self.sums(),
            interlayers: self.interlayer_memory(),
        }
    }

    /// Goes back to rest, before the first step.
    pub(crate) fn reset(&mut self) {
        let mut sums = self.sums();
        sums.iter_mut().for_each(|own| own.fill(0.0));
        for part in &mut self.parts {
            part.domain.clear();
            let layers = part.domain.totals().len();
            part.domain.restore_totals(0, vec![Total::default(); layers].into_iter());
            part.domain.set_sums(&sums, part.first);
        }
    }

    /// Goes back, or on, to a snapshot of the same problem; `false` where it is one of another.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        let cells: usize = self.parts.iter().map(|part| part.domain.grid().count()).sum();
        let layers: usize = self.parts.iter().map(|part| part.domain.totals().len()).sum();
        let fields = self.fields().to_vec();
        if snapshot.fields.len() != fields.len()
            || snapshot.fields.iter().any(|values| values.len() != cells)
            || snapshot.totals.len() != layers
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
        let mut interlayers = snapshot.interlayers.iter().copied();
        let mut totals = snapshot.totals.iter().map(|numbers| Total::from_numbers(*numbers));
        for part in &mut self.parts {
            let own = part.domain.totals().len();
            part.domain.restore_totals(snapshot.steps, totals.by_ref().take(own));
            part.domain.set_sums(&snapshot.sums, part.first);
            part.domain.set_interlayer_memory(&mut interlayers);
        }
        true
    }

    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    pub fn dissipated(&self) -> Vec<f64> {
        self.permutation.unpermute(self.sums().swap_remove(0))
    }

    fn sums(&self) -> Vec<Vec<f64>> {
        let mut all: Vec<Vec<f64>> = Vec::new();
        for part in &self.parts {
            for (index, own) in part.domain.sums().into_iter().enumerate() {
                match all.get_mut(index) {
                    Some(sum) => sum.extend(own),
                    None => all.push(own),
                }
            }
        }
        all
    }

    /// What steps did to the energy so far.
    pub fn ledger(&self) -> Ledger {
        Total::sum(self.parts.iter().flat_map(|part| part.domain.totals()))
    }

    /// Energy of the deviation from the initial stress, each part in a thread of its own.
    pub fn energy(&self) -> Energy {
        let domains: Vec<&Domain<T, D>> = self.parts.iter().map(|part| &part.domain).collect();
        if let [domain] = domains.as_slice() {
            return domain.energy();
        }
        let all: Vec<Vec<Energy>> = std::thread::scope(|scope| {
            let threads: Vec<_> =
                domains.into_iter().map(|domain| scope.spawn(|| domain.energies())).collect();
            threads.into_iter().map(|thread| thread.join().unwrap_or_default()).collect()
        });
        Energy::sum(all.iter().flatten())
    }

    /// The first value that is not finite: its field and its cell.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let own = |part: &Part<T, D>| {
            let (field, cell) = part.domain.first_non_finite()?;
            Some((field, self.permutation.original_cell(part.first + cell)))
        };
        self.parts.iter().find_map(own)
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
        let own = |part: &Part<T, D>| Some(part.first + part.domain.first_beyond_yield()?);
        self.parts.iter().find_map(own).map(|cell| self.permutation.original_cell(cell))
    }

    /// The values of all fields, the first axis running fastest, as [`Domain::output_cell`] gives them.
    pub fn shown(&self) -> Vec<Vec<f64>> {
        let mut fields = vec![Vec::new(); self.width()];
        let mut state = Vec::new();
        for part in &self.parts {
            let sides = part.domain.closing_boundaries();
            for cell in 0..part.domain.grid().count() {
                state.clear();
                part.domain.output_cell_between(cell, sides.as_ref(), &mut state);
                for (values, value) in fields.iter_mut().zip(&state) {
                    values.push(*value);
                }
            }
        }
        fields.into_iter().map(|values| self.permutation.unpermute(values)).collect()
    }

    /// The values of a field as they are computed with, the first axis running fastest; `None` if there is
    /// no such field.
    pub fn values(&self, field: Field) -> Option<Vec<T>> {
        self.inner_values(field).map(|values| self.permutation.unpermute(values))
    }

    /// By cell of the parts.
    fn inner_values(&self, field: Field) -> Option<Vec<T>> {
        self.parts
            .iter()
            .map(|part| part.domain.values(field))
            .collect::<Option<Vec<_>>>()
            .map(|all| all.concat())
    }

    /// V and S of all faces with interlayers, in the order of [`Domain::interlayer_memory`] of the whole.
    pub fn interlayer_memory(&self) -> Vec<[T; 2]> {
        self.parts.iter().flat_map(|part| part.domain.interlayer_memory()).collect()
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
        let layers = self.parts.iter().map(|part| part.domain.totals().len()).sum();
        for part in &mut self.parts {
            let memory = part.domain.interlayers_at_start(part.first, layers, value);
            part.domain.set_interlayer_memory(&mut memory.into_iter());
        }
    }

    /// Sets the values of a field, the first axis running fastest: as many as there are cells.
    pub fn set(&mut self, field: Field, values: &[T]) {
        self.set_inner(field, &self.permutation.permute(values));
    }

    fn set_inner(&mut self, field: Field, values: &[T]) {
        for part in &mut self.parts {
            part.domain.set(field, values.get(part.first..).unwrap_or(&[]));
        }
    }
}
