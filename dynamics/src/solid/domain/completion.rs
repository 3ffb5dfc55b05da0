//! Completion of a step for output: with alternating sweeps the stored state lacks the last quarter of a step along the
//! first axis, which is applied to a copy of the state.

use super::material_table::WavePair;
use super::{Domain, MAX_FIELDS, SolverReal};
use crate::simd::{LaneGroup, Real};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{
    BoundaryFaces, CLOSURE_CELLS, GhostCoefficients, GhostRule, compute_ghosts, image, set_times,
};
use crate::solid::line::sweep;
use crate::solid::reconstruction::MAX_GHOSTS;
use crate::solid::riemann::State;

/// Largest number of cells in the stencil of the sweep for one cell.
const MAX_STENCIL_CELLS: usize = 2 * MAX_GHOSTS + 1;

/// Number of cells next to a reflecting boundary whose output is the mean of the states before and after a sweep by
/// half a step. The numerical boundary layer there depends on the Courant number of the sweeps: a sweep by a quarter of
/// a step disturbs it, by several per cent of a Rayleigh wave at 20 cells per wavelength. Farther inside, the mean
/// would reduce the amplitude of a wave of angular frequency ω by the fraction (ωΔt)²/32.
pub(crate) const BOUNDARY_LAYER_CELLS: usize = 4;

/// Boundaries across the first axis in the sweeps that complete a step.
#[derive(Clone)]
pub(crate) struct ClosingBoundaries<T: Real> {
    /// Boundaries for the sweep by a quarter of a step.
    pub(crate) quarter_step: [BoundaryFaces<T>; 2],
    /// Boundaries for the sweep by half a step, used near reflecting boundaries: output there is the mean of the states
    /// before and after it.
    pub(crate) half_step: [BoundaryFaces<T>; 2],
}

impl<T: Real> ClosingBoundaries<T> {
    pub(crate) fn new(boundaries: &[BoundaryFaces<T>; 2]) -> Self {
        Self { quarter_step: boundaries.clone(), half_step: boundaries.clone() }
    }

    /// Evaluates the boundary values for a time step of `step`, s, that ends at time `end`, s, in the middle of each of
    /// the two sweeps.
    pub(crate) fn set_time(&mut self, end: f64, step: f64) {
        set_times(&mut self.quarter_step, [end - 0.125 * step; 2]);
        set_times(&mut self.half_step, [end; 2]);
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the boundaries of the first axis in the sweeps that complete the last step; `None` without alternating
    /// sweeps.
    pub(crate) fn closing_boundaries(&self) -> Option<ClosingBoundaries<T>> {
        self.scheme.is_alternating().then(|| {
            let mut boundaries = ClosingBoundaries::new(&self.boundaries.faces[0][0]);
            boundaries.set_time(self.time(), self.step);
            boundaries
        })
    }

    /// Returns all fields of owned cells at the time of the domain, cell by cell: stresses as deviation from the
    /// initial stress, without the return mapping that [`Self::output_cell`] applies.
    pub fn field_deviations(&self, cells: &[usize]) -> Vec<f64> {
        let boundaries = self.closing_boundaries();
        let count = self.fields().len();
        let cell_deviations = |cell: &usize| {
            let values = self.complete_cell(self.layout.local_cell(*cell), boundaries.as_ref());
            values[..count].iter().map(|value| value.to_f64()).collect::<Vec<f64>>()
        };
        cells.iter().flat_map(cell_deviations).collect()
    }

    /// Returns the state of a cell (index among all cells, halo included) at the time of the domain: the stored state
    /// if `boundaries` is `None` or no step is done; else a copy swept along the first axis by a quarter of a step,
    /// near reflecting boundaries the mean of the stored state and of a copy swept by half a step.
    pub(super) fn complete_cell(
        &self,
        cell: usize,
        boundaries: Option<&ClosingBoundaries<T>>,
    ) -> [T; MAX_FIELDS] {
        let mut values = self.cell_state(cell);
        let Some(boundaries) = boundaries.filter(|_| self.schedule.steps > 0) else {
            return values;
        };
        let pattern = self.materials.lane_pattern_indices[self.layout.lane_index(cell).0.group];
        let lane = self.layout.lane_index(cell).1;
        for pair in 0..self.materials.quarter_step_waves.len() {
            let (wave, boundaries, fraction) = match self.is_near_reflecting_boundary(cell, pair) {
                true => (&self.materials.waves[0][pair], &boundaries.half_step, T::HALF),
                false => {
                    (&self.materials.quarter_step_waves[pair], &boundaries.quarter_step, T::ONE)
                }
            };
            let (mut velocity, mut stress, cells) =
                self.load_stencil(cell, (pair, wave), boundaries);
            let ghosts = self.layout.ghosts;
            let before = State { velocity: velocity[ghosts], stress: stress[ghosts] };
            let count = 2 * ghosts + 1;
            let slopes = self.scheme.slopes;
            sweep(&mut velocity[..count], &mut stress[..count], &cells[..count], slopes, None);
            let change = fraction * (stress[ghosts] - before.stress);
            values[wave.velocity / self.layout.pitch] =
                before.velocity + fraction * (velocity[ghosts] - before.velocity);
            values[wave.stress / self.layout.pitch] = before.stress + change;
            for (index, &place) in wave.passive_stresses.iter().enumerate() {
                let ratio = self.materials.table.coupling_ratio(pattern, wave, index).lanes()[lane];
                let value = &mut values[place / self.layout.pitch];
                *value = *value + ratio * change;
            }
        }
        values
    }

    /// Whether a cell is one of the [`BOUNDARY_LAYER_CELLS`] cells next to a boundary across the first axis that
    /// prescribes velocity or traction for this pair of waves; symmetry planes and the first-order scheme do not count.
    fn is_near_reflecting_boundary(&self, cell: usize, pair: usize) -> bool {
        let length = self.layout.cells[0];
        let (row, depth) = (cell / length, cell % length);
        let (group, lane) = (row / T::Lanes::COUNT, row % T::Lanes::COUNT);
        let reflects = |end_faces: &BoundaryFaces<T>| {
            end_faces.ghost_rule().is_some_and(|ghost_rule| {
                let [sign, .., one_sided] = ghost_rule.face_coefficients(pair, (group, lane));
                sign != T::ZERO && one_sided != T::ZERO
            })
        };
        let [lower, upper] = &self.boundaries.faces[0][0];
        (depth < BOUNDARY_LAYER_CELLS && reflects(lower))
            || (length - 1 - depth < BOUNDARY_LAYER_CELLS && reflects(upper))
    }

    /// Returns velocities, stresses and constants of a pair of waves in the stencil of a cell; behind it, its last cell is
    /// repeated.
    fn load_stencil(
        &self,
        cell: usize,
        (pair, wave): (usize, &WavePair),
        boundaries: &[BoundaryFaces<T>; 2],
    ) -> ([T; MAX_STENCIL_CELLS], [T; MAX_STENCIL_CELLS], [CellConstants<T>; MAX_STENCIL_CELLS])
    {
        let length = self.layout.cells[0];
        let (row, x) = (cell / length, cell % length);
        let state = |x: usize| {
            let cell = row * length + x;
            State {
                velocity: self.value_at(cell, wave.velocity),
                stress: self.value_at(cell, wave.stress),
            }
        };
        let constants = |x: usize| {
            let (stop, lane) = self.layout.lane_index(row * length + x);
            let pattern = self.materials.lane_pattern_indices[stop.group];
            self.materials.table.constants(pattern, wave).lane(lane)
        };
        // State of the ghost at a depth beyond an end, and the cell whose constants this ghost has.
        let ghost_state = |end: usize, depth: usize| -> (State<T>, usize) {
            let [inner, opposite] = [depth % length, length - 1 - depth % length];
            let (inner, opposite) = if end == 0 { (inner, opposite) } else { (opposite, inner) };
            let BoundaryFaces::Physical(ghost_rule) = &boundaries[end] else {
                return (state(opposite), opposite);
            };
            let face = (row / T::Lanes::COUNT, row % T::Lanes::COUNT);
            let face_rule = |ghost_rule: &GhostRule<T>| ghost_rule.face_coefficients(pair, face);
            let mirror_state = |[v, a, s, b, _]: [T; 5], source: State<T>| State {
                velocity: image([v, a], source.velocity),
                stress: image([s, b], source.stress),
            };
            if length < CLOSURE_CELLS || !ghost_rule.is_one_sided {
                // In a row of a single cell the second ghost is the image of the ghost at the other end.
                let mut source = state(inner);
                if let (BoundaryFaces::Physical(other), true) =
                    (&boundaries[1 - end], depth >= length)
                {
                    source = mirror_state(face_rule(other), source);
                }
                return (mirror_state(face_rule(ghost_rule), source), inner);
            }
            let outer_cells =
                std::array::from_fn(|depth| if end == 0 { depth } else { length - 1 - depth });
            let (outer_states, media) = (outer_cells.map(state), outer_cells.map(constants));
            let coefficients = GhostCoefficients::new(&media[0]);
            let media = media.each_ref();
            let ghost_states = compute_ghosts(
                ghost_rule.closure(),
                outer_states,
                face_rule(ghost_rule),
                end,
                media,
                &coefficients,
            );
            (ghost_states[depth], inner)
        };
        let state_and_constants = |offset: usize| {
            let ghosts = self.layout.ghosts;
            let position = (x + offset.min(2 * ghosts)) as isize - ghosts as isize;
            match usize::try_from(position) {
                Ok(x) if x < length => (state(x), constants(x)),
                Ok(x) => {
                    let (state, inner) = ghost_state(1, x - length);
                    (state, constants(inner))
                }
                Err(_) => {
                    let (state, inner) = ghost_state(0, position.unsigned_abs() - 1);
                    (state, constants(inner))
                }
            }
        };
        let stencil: [(State<T>, CellConstants<T>); MAX_STENCIL_CELLS] =
            std::array::from_fn(state_and_constants);
        (
            stencil.map(|cell_values| cell_values.0.velocity),
            stencil.map(|cell_values| cell_values.0.stress),
            stencil.map(|cell_values| cell_values.1),
        )
    }
}
