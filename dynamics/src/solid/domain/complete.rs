//! Completion of a step for output: with alternating sweeps the stored state lacks the last quarter of a step along the
//! first axis, which is applied to a copy.

use super::table::WavePair;
use super::{Domain, MAX_FIELDS, SolverReal};
use crate::simd::{Group, Real};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{BESIDE, BoundaryFaces, GhostCoefficients, ghosts, image, set_time};
use crate::solid::line::sweep;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::riemann::State;

/// Number of cells in the stencil of the sweep of one cell.
const WINDOW: usize = 2 * GHOSTS + 1;

/// Number of cells next to a reflecting boundary whose output is the mean of the states before and after half a step.
/// The numerical boundary layer there depends on the Courant number of the sweeps: a sweep of a quarter of a step
/// disturbs it, by several per cent of a Rayleigh wave at 20 cells per wavelength. Farther inside the mean would damp a
/// wave by (ωΔt)²/32.
pub(crate) const BOUNDARY_LAYER: usize = 4;

/// Boundaries across the first axis in the sweeps that complete a step.
#[derive(Clone)]
pub(crate) struct ClosingBoundaries<T: Real> {
    /// For the sweep of a quarter of a step.
    quarter: [BoundaryFaces<T>; 2],
    /// For the sweep of half a step, whose mean with the state is the output.
    half: [BoundaryFaces<T>; 2],
}

impl<T: Real> ClosingBoundaries<T> {
    pub(super) fn new(sides: &[BoundaryFaces<T>; 2]) -> Self {
        Self { quarter: sides.clone(), half: sides.clone() }
    }

    /// Evaluates the boundary values for a time step `step` that ends at time `end`, s.
    pub(super) fn set_time(&mut self, end: f64, step: f64) {
        set_time(&mut self.quarter, end - 0.125 * step);
        set_time(&mut self.half, end);
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the boundaries of the first axis in the sweeps that complete the last step; `None` without alternating
    /// sweeps.
    pub(crate) fn closing_boundaries(&self) -> Option<ClosingBoundaries<T>> {
        self.scheme.alternates().then(|| {
            let mut sides = ClosingBoundaries::new(&self.boundary.faces[0][0]);
            sides.set_time(self.time(), self.step);
            sides
        })
    }

    /// Returns all fields of own cells at the time of the domain, cell by cell: the deviation from the initial stress,
    /// without the return mapping that [`Self::output_cell`] applies.
    pub fn deviations(&self, cells: &[usize]) -> Vec<f64> {
        let sides = self.closing_boundaries();
        let count = self.fields().len();
        let of_cell = |cell: &usize| {
            let own = self.completed(self.layout.own_cell(*cell), sides.as_ref());
            own[..count].iter().map(|value| value.to_f64()).collect::<Vec<f64>>()
        };
        cells.iter().flat_map(of_cell).collect()
    }

    /// Returns the state of a cell, counted with the halo, at the time of the domain: a copy is swept along the first
    /// axis by a quarter of a step; near reflecting boundaries the result is the mean of the state and of a copy swept
    /// by half a step.
    pub(super) fn completed(
        &self,
        cell: usize,
        sides: Option<&ClosingBoundaries<T>>,
    ) -> [T; MAX_FIELDS] {
        let mut values = self.cell_state(cell);
        let Some(sides) = sides.filter(|_| self.schedule.steps > 0) else { return values };
        let pattern = self.materials.patterns[self.layout.slot(cell).0.group];
        let lane = self.layout.slot(cell).1;
        for pair in 0..self.materials.quarter_waves.len() {
            let (wave, sides, part) = match self.is_near_reflecting_side(cell, pair) {
                true => (&self.materials.waves[0][pair], &sides.half, T::HALF),
                false => (&self.materials.quarter_waves[pair], &sides.quarter, T::ONE),
            };
            let (mut velocity, mut stress, cells) = self.window(cell, (pair, wave), sides);
            let before = State { velocity: velocity[GHOSTS], stress: stress[GHOSTS] };
            sweep(&mut velocity, &mut stress, &cells, self.scheme.slopes, None);
            let change = part * (stress[GHOSTS] - before.stress);
            values[wave.velocity / self.layout.pitch] =
                before.velocity + part * (velocity[GHOSTS] - before.velocity);
            values[wave.stress / self.layout.pitch] = before.stress + change;
            for (index, &place) in wave.passive_stresses.iter().enumerate() {
                let ratio = self.materials.table.ratio(pattern, wave, index).lanes()[lane];
                let value = &mut values[place / self.layout.pitch];
                *value = *value + ratio * change;
            }
        }
        values
    }

    /// Whether a cell is within [`BOUNDARY_LAYER`] cells of a boundary across the first axis that reflects this pair of
    /// waves.
    fn is_near_reflecting_side(&self, cell: usize, pair: usize) -> bool {
        let length = self.layout.cells[0];
        let (row, depth) = (cell / length, cell % length);
        let (group, lane) = (row / T::Lanes::COUNT, row % T::Lanes::COUNT);
        let reflects = |side: &BoundaryFaces<T>| {
            side.mirror().is_some_and(|mirror| {
                let [sign, .., one_sided] = mirror.face_at(pair, (group, lane));
                sign != T::ZERO && one_sided != T::ZERO
            })
        };
        let [lower, upper] = &self.boundary.faces[0][0];
        (depth < BOUNDARY_LAYER && reflects(lower))
            || (length - 1 - depth < BOUNDARY_LAYER && reflects(upper))
    }

    /// Returns velocities, stresses and constants of a pair of waves in the stencil of a cell.
    fn window(
        &self,
        cell: usize,
        (pair, wave): (usize, &WavePair),
        sides: &[BoundaryFaces<T>; 2],
    ) -> ([T; WINDOW], [T; WINDOW], [CellConstants<T>; WINDOW]) {
        let length = self.layout.cells[0];
        let (row, x) = (cell / length, cell % length);
        let state = |x: usize| {
            let cell = row * length + x;
            State { velocity: self.at(cell, wave.velocity), stress: self.at(cell, wave.stress) }
        };
        let constants = |x: usize| {
            let (stop, lane) = self.layout.slot(row * length + x);
            self.materials.table.cell(self.materials.patterns[stop.group], wave).lane(lane)
        };
        // State of the ghost at a depth beyond an end, and the cell whose constants it has.
        let beyond = |end: usize, depth: usize| -> (State<T>, usize) {
            let [own, across] = [depth % length, length - 1 - depth % length];
            let (own, across) = if end == 0 { (own, across) } else { (across, own) };
            let BoundaryFaces::Physical(mirror) = &sides[end] else {
                return (state(across), across);
            };
            let face = (row / T::Lanes::COUNT, row % T::Lanes::COUNT);
            let numbers = |mirror: &crate::solid::ghosts::GhostRule<T>| mirror.face_at(pair, face);
            let imaged = |[v, a, s, b, _]: [T; 5], seen: State<T>| State {
                velocity: image([v, a], seen.velocity),
                stress: image([s, b], seen.stress),
            };
            if length < BESIDE || !mirror.is_one_sided {
                // In a row of a single cell the second ghost is the image of the ghost at the other end.
                let mut seen = state(own);
                if let (BoundaryFaces::Physical(other), true) = (&sides[1 - end], depth >= length) {
                    seen = imaged(numbers(other), seen);
                }
                return (imaged(numbers(mirror), seen), own);
            }
            let inside =
                std::array::from_fn(|depth| if end == 0 { depth } else { length - 1 - depth });
            let (beside, media) = (inside.map(state), inside.map(constants));
            let coefficients = GhostCoefficients::new(&media[0]);
            let media = media.each_ref();
            let made = ghosts(mirror.closure(), beside, numbers(mirror), end, media, &coefficients);
            (made[depth], own)
        };
        let at = |offset: usize| {
            let place = (x + offset) as isize - GHOSTS as isize;
            match usize::try_from(place) {
                Ok(x) if x < length => (state(x), constants(x)),
                Ok(x) => {
                    let (state, own) = beyond(1, x - length);
                    (state, constants(own))
                }
                Err(_) => {
                    let (state, own) = beyond(0, place.unsigned_abs() - 1);
                    (state, constants(own))
                }
            }
        };
        let all: [(State<T>, CellConstants<T>); WINDOW] = std::array::from_fn(at);
        (all.map(|own| own.0.velocity), all.map(|own| own.0.stress), all.map(|own| own.1))
    }
}
