//! The quarter of a step along the first axis by which the state is behind its time where sweeps alternate.

use super::{Domain, MOST_FIELDS};
use crate::line::{Cell, GHOSTS, State, sweep};
use crate::real::{Group, Real};
use crate::side::{BESIDE, Side, ghosts, image, set_time};

/// Cells that a sweep of one cell reads.
const WINDOW: usize = 2 * GHOSTS + 1;

impl<T: Real, const D: usize> Domain<T, D> {
    /// The sides of the first axis in the quarter step that completes the last step.
    pub(crate) fn sides_now(&self) -> [Side<T>; 2] {
        let mut sides = self.sides[0][0].clone();
        if self.scheme.alternates() {
            set_time(&mut sides, self.time() - 0.125 * self.step);
        }
        sides
    }

    /// All fields of own cells at the time of the domain, cell by cell: the deviation from the initial stress, and not
    /// taken into the yield set as what [`Self::show`] gives is.
    pub fn deviations(&self, cells: &[usize]) -> Vec<f64> {
        let sides = self.sides_now();
        let (first, count) = (self.own_cells().start, self.fields().len());
        let of_cell = |cell: &usize| {
            let own = self.completed(first + cell, &sides);
            own[..count].iter().map(|value| value.wide()).collect::<Vec<f64>>()
        };
        cells.iter().flat_map(of_cell).collect()
    }

    /// The state of a cell among all at the time of the domain: a copy goes along the first axis by a quarter of a
    /// step.
    pub(super) fn completed(&self, cell: usize, sides: &[Side<T>; 2]) -> [T; MOST_FIELDS] {
        let mut values = [T::ZERO; MOST_FIELDS];
        for (value, (_, place)) in values.iter_mut().zip(self.places()) {
            *value = self.at(cell, place);
        }
        if !self.scheme.alternates() || self.steps == 0 {
            return values;
        }
        let pattern = self.patterns[self.slot(cell).0.group];
        let lane = self.slot(cell).1;
        for (pair, wave) in self.quarter_waves.iter().enumerate() {
            let (mut velocity, mut stress, cells) = self.window(cell, pair, sides);
            let before = stress[GHOSTS];
            sweep(&mut velocity, &mut stress, &cells, self.scheme.slopes, None);
            values[wave.velocity / self.pitch] = velocity[GHOSTS];
            values[wave.stress / self.pitch] = stress[GHOSTS];
            for (index, &place) in wave.followers.iter().enumerate() {
                let ratio = self.table.ratio(pattern, wave, index).lanes()[lane];
                let value = &mut values[place / self.pitch];
                *value = *value + ratio * (stress[GHOSTS] - before);
            }
        }
        values
    }

    /// Velocities, stresses and constants of a pair of waves in a cell and in those that its sweep reads.
    fn window(
        &self,
        cell: usize,
        pair: usize,
        sides: &[Side<T>; 2],
    ) -> ([T; WINDOW], [T; WINDOW], [Cell<T>; WINDOW]) {
        let wave = &self.quarter_waves[pair];
        let length = self.grid.cells[0];
        let (row, x) = (cell / length, cell % length);
        let state = |x: usize| {
            let cell = row * length + x;
            State { velocity: self.at(cell, wave.velocity), stress: self.at(cell, wave.stress) }
        };
        let constants = |x: usize| {
            let (stop, lane) = self.slot(row * length + x);
            self.table.cell(self.patterns[stop.group], wave).lane(lane)
        };
        // What is beyond an end, and whose constants it has.
        let beyond = |end: usize, depth: usize| -> (State<T>, usize) {
            let [own, across] = [depth % length, length - 1 - depth % length];
            let (own, across) = if end == 0 { (own, across) } else { (across, own) };
            let Side::Mirror(mirror) = &sides[end] else { return (state(across), across) };
            let face = (row / T::Lanes::COUNT, row % T::Lanes::COUNT);
            let numbers = |mirror: &crate::side::Mirror<T>| {
                mirror.face(pair, face.0).map(|lanes| lanes.lanes()[face.1])
            };
            let imaged = |[v, a, s, b, _]: [T; 5], seen: State<T>| State {
                velocity: image([v, a], seen.velocity),
                stress: image([s, b], seen.stress),
            };
            if length < BESIDE || !mirror.is_one_sided {
                // A single cell is seen through the other mirror.
                let mut seen = state(own);
                if let (Side::Mirror(other), true) = (&sides[1 - end], depth >= length) {
                    seen = imaged(numbers(other), seen);
                }
                return (imaged(numbers(mirror), seen), own);
            }
            let inside =
                std::array::from_fn(|depth| if end == 0 { depth } else { length - 1 - depth });
            let (beside, media) = (inside.map(state), inside.map(constants));
            let made = ghosts(mirror.closure(), beside, numbers(mirror), end, media.each_ref());
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
        let all: [(State<T>, Cell<T>); WINDOW] = std::array::from_fn(at);
        (all.map(|own| own.0.velocity), all.map(|own| own.0.stress), all.map(|own| own.1))
    }
}
