//! Flow of the fluid along saturated interlayers and through their junctions.
//!
//! The faces of saturated interlayers are cells of a network. Each ends in two vertices of the grid, where up to four
//! faces meet: a straight layer goes on without a resistance, several layers meet in a junction, and a layer that ends
//! is closed, or open at a boundary. In the middle of a step the flow in all cells advances by the whole step, in
//! sub-steps of Courant number at most 1, by Godunov's method ([`models::interface::fluid`]).

use crate::simd::Real;
use models::interface::fluid::{
    ArmSide, FluidConstants, FluidState, JunctionArm, solve_closed_end, solve_junction,
    solve_open_end, solve_riemann,
};
use models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use models::interface::saturated::SaturatedLayer;
use std::collections::HashMap;

/// Largest number of sub-steps per step: a halo has as many valid cells beyond those that the other stages read.
pub(crate) const MAX_FLUID_SUBSTEPS: usize = 2;

/// Position of a saturated face: axis normal to it, and coordinates of the cell above it.
pub(crate) type FacePosition = (usize, [usize; 2]);

/// Saturated face as a cell of the network.
#[derive(Clone)]
struct NetworkCell<T> {
    law: SaturatedLayer<T>,
    /// Length along the layer, m.
    length: T,
}

/// Vertex: the cells that end there, those on the lower and the upper side along the first axis, then along the second.
#[derive(Clone, Default)]
struct Vertex {
    arms: [Option<usize>; 4],
    /// Whether a layer that ends there is open.
    is_open: bool,
}

/// Side of the vertex on which an arm lies.
const ARM_SIDES: [ArmSide; 4] = [ArmSide::Lower, ArmSide::Upper, ArmSide::Lower, ArmSide::Upper];

/// Network of saturated interlayers.
#[derive(Clone)]
pub(crate) struct FluidNetwork<T> {
    cells: Vec<NetworkCell<T>>,
    vertices: Vec<Vertex>,
    substeps: usize,
    /// Buffers: history variables by cell; states at both ends by cell.
    history: Vec<[T; MAX_HISTORY_VARIABLES]>,
    end_states: Vec<[FluidState<T>; 2]>,
}

/// Grid and boundaries of a network.
#[derive(Clone, Copy)]
pub(crate) struct NetworkGrid {
    /// Number of cells along each axis.
    pub(crate) cells: [usize; 2],
    /// Edge lengths of a cell, m.
    pub(crate) spacing: [f64; 2],
    /// Whether the vertices at both ends of an axis are the same.
    pub(crate) is_periodic: [bool; 2],
    /// Whether layers that end at the boundaries are open, by axis and end.
    pub(crate) is_open: [[bool; 2]; 2],
}

impl NetworkGrid {
    /// Returns the coordinates of both ends of a face; ends on a periodic boundary wrap around.
    fn face_ends(&self, (axis, cell): FacePosition) -> [[usize; 2]; 2] {
        let along = 1 - axis;
        let mut upper = cell;
        upper[along] += 1;
        if self.is_periodic[along] {
            upper[along] %= self.cells[along];
        }
        [cell, upper]
    }

    /// Returns whether layers that end at a vertex are open.
    fn is_open_at(&self, vertex: [usize; 2]) -> bool {
        (0..2).any(|axis| {
            (vertex[axis] == 0 && self.is_open[axis][0])
                || (vertex[axis] == self.cells[axis] && self.is_open[axis][1])
        })
    }
}

impl<T: Real> FluidNetwork<T> {
    /// Creates the network of faces, each with its position and law, for steps of `step`, s; faces that are not
    /// saturated must not be given.
    pub(crate) fn new(
        faces: impl Iterator<Item = (FacePosition, LayerLaw<T>)>,
        grid: &NetworkGrid,
        step: f64,
    ) -> Self {
        let mut indices: HashMap<[usize; 2], usize> = HashMap::new();
        let (mut cells, mut vertices): (Vec<NetworkCell<T>>, Vec<Vertex>) = Default::default();
        for (position, law) in faces {
            let LayerLaw::Saturated(law) = law else { continue };
            let along = 1 - position.0;
            let ends = grid.face_ends(position).map(|vertex| {
                *indices.entry(vertex).or_insert_with(|| {
                    let is_open = grid.is_open_at(vertex);
                    vertices.push(Vertex { is_open, ..Vertex::default() });
                    vertices.len() - 1
                })
            });
            // The vertex at the lower end of a cell has it on the upper side.
            vertices[ends[0]].arms[2 * along + 1] = Some(cells.len());
            vertices[ends[1]].arms[2 * along] = Some(cells.len());
            cells.push(NetworkCell { law, length: T::from_f64(grid.spacing[along]) });
        }
        let courant =
            |cell: &NetworkCell<T>| cell.law.fluid.speed.to_f64() * step / cell.length.to_f64();
        let largest = cells.iter().map(courant).fold(0.0, f64::max);
        // A Courant number of 1 may be exceeded by rounding.
        let substeps = ((largest - 1e-6).ceil().max(1.0)) as usize;
        let zero = FluidState { velocity: T::ZERO, stress: T::ZERO };
        Self {
            history: vec![[T::ZERO; MAX_HISTORY_VARIABLES]; cells.len()],
            end_states: vec![[zero; 2]; cells.len()],
            cells,
            vertices,
            substeps,
        }
    }

    /// Returns the history variables of the cells in the order in which they were given, to be read and written.
    pub(crate) fn history_mut(&mut self) -> &mut [[T; MAX_HISTORY_VARIABLES]] {
        &mut self.history
    }

    /// Returns velocities and stresses of an arm of a vertex.
    fn arm_state(&self, cell: usize) -> (FluidState<T>, &FluidConstants<T>) {
        let fluid = &self.cells[cell].law.fluid;
        (fluid.state(&self.history[cell]), fluid)
    }

    /// Advances the flow by `step`, s.
    pub(crate) fn advance(&mut self, step: f64) {
        let step = T::from_f64(step / self.substeps as f64);
        for _ in 0..self.substeps {
            for vertex in 0..self.vertices.len() {
                let states = self.solve_vertex(vertex);
                for (arm, state) in states.into_iter().enumerate() {
                    if let Some(cell) = self.vertices[vertex].arms[arm] {
                        // An arm on the lower side has the vertex at its upper end.
                        self.end_states[cell][1 - arm % 2] = state;
                    }
                }
            }
            for ((cell, ends), history) in
                self.cells.iter().zip(&self.end_states).zip(&mut self.history)
            {
                cell.law.fluid.advance_cell(*ends, step / cell.length, history);
            }
        }
    }

    /// Solves the Riemann problem at a vertex; returns the states at the ends of its arms.
    fn solve_vertex(&self, vertex: usize) -> [FluidState<T>; 4] {
        let vertex = &self.vertices[vertex];
        let zero = FluidState { velocity: T::ZERO, stress: T::ZERO };
        for along in 0..2 {
            let others = 2 * (1 - along);
            let is_straight = vertex.arms[others].is_none() && vertex.arms[others + 1].is_none();
            let (lower, upper) = (vertex.arms[2 * along], vertex.arms[2 * along + 1]);
            if let (Some(lower), Some(upper), true) = (lower, upper, is_straight) {
                let [(one, own), (other, next)] = [lower, upper].map(|cell| self.arm_state(cell));
                if own.thickness == next.thickness {
                    return [solve_riemann([one, other], [own.impedance, next.impedance]); 4];
                }
            }
            if let (true, Some((side, cell))) = (is_straight, single_arm(lower, upper)) {
                let (state, own) = self.arm_state(cell);
                let end = match vertex.is_open {
                    true => solve_open_end(state, side, own.impedance),
                    false => solve_closed_end(state, side, own.impedance),
                };
                return [end; 4];
            }
        }
        let absent = |side: ArmSide| JunctionArm {
            side,
            porosity: T::ZERO,
            thickness: T::ZERO,
            impedance: T::ONE,
            state: zero,
        };
        let arms = std::array::from_fn(|arm| match vertex.arms[arm] {
            None => absent(ARM_SIDES[arm]),
            Some(cell) => {
                let (state, own) = self.arm_state(cell);
                JunctionArm {
                    side: ARM_SIDES[arm],
                    porosity: self.cells[cell].law.porosity(&self.history[cell]),
                    thickness: own.thickness,
                    impedance: own.impedance,
                    state,
                }
            }
        });
        solve_junction::<T, 4>(&arms).0
    }
}

/// Returns the only arm of two collinear ones, if just one exists.
fn single_arm(lower: Option<usize>, upper: Option<usize>) -> Option<(ArmSide, usize)> {
    match (lower, upper) {
        (Some(cell), None) => Some((ArmSide::Lower, cell)),
        (None, Some(cell)) => Some((ArmSide::Upper, cell)),
        _ => None,
    }
}
