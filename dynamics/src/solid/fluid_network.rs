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

/// Largest number of sub-steps of the flow per time step, since each sub-step reads one more cell of the halo.
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

/// Vertex of the grid at which cells of the network end.
#[derive(Clone, Default)]
struct Vertex {
    /// Cells of the network that end here: on the lower and the upper side along the first axis, then along the second.
    arms: [Option<usize>; 4],
    /// Whether a layer that ends here is open: the fluid flows out at zero pressure.
    is_open: bool,
}

/// Side of a vertex on which each of its arms lies, in the order of [`Vertex::arms`].
const ARM_SIDES: [ArmSide; 4] = [ArmSide::Lower, ArmSide::Upper, ArmSide::Lower, ArmSide::Upper];

/// Network of saturated interlayers: faces as cells, connected at the vertices of the grid.
#[derive(Clone)]
pub(crate) struct FluidNetwork<T> {
    cells: Vec<NetworkCell<T>>,
    vertices: Vec<Vertex>,
    /// Number of sub-steps of a time step.
    substep_count: usize,
    /// Buffer: history variables of the face of each cell.
    history: Vec<[T; MAX_HISTORY_VARIABLES]>,
    /// Buffer: states of the fluid at the lower and the upper end of each cell.
    end_states: Vec<[FluidState<T>; 2]>,
}

/// Grid and boundaries from which the network of a domain is built.
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
    /// Returns the vertices at both ends of a face, by their coordinates; those on a periodic boundary wrap around.
    fn face_ends(&self, (axis, cell): FacePosition) -> [[usize; 2]; 2] {
        let along = 1 - axis;
        let mut upper = cell;
        upper[along] += 1;
        if self.is_periodic[along] {
            upper[along] %= self.cells[along];
        }
        [cell, upper]
    }

    /// Whether layers that end at a vertex are open.
    fn is_open_vertex(&self, vertex: [usize; 2]) -> bool {
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
                    let is_open = grid.is_open_vertex(vertex);
                    vertices.push(Vertex { is_open, ..Vertex::default() });
                    vertices.len() - 1
                })
            });
            // The vertex at the lower end of a cell has it on the upper side.
            vertices[ends[0]].arms[2 * along + 1] = Some(cells.len());
            vertices[ends[1]].arms[2 * along] = Some(cells.len());
            cells.push(NetworkCell { law, length: T::from_f64(grid.spacing[along]) });
        }
        let courant_number =
            |cell: &NetworkCell<T>| cell.law.fluid.speed.to_f64() * step / cell.length.to_f64();
        let max_courant_number = cells.iter().map(courant_number).fold(0.0, f64::max);
        // A Courant number of 1 may be exceeded by rounding.
        let substep_count = ((max_courant_number - 1e-6).ceil().max(1.0)) as usize;
        let zero = FluidState { velocity: T::ZERO, stress: T::ZERO };
        Self {
            history: vec![[T::ZERO; MAX_HISTORY_VARIABLES]; cells.len()],
            end_states: vec![[zero; 2]; cells.len()],
            cells,
            vertices,
            substep_count,
        }
    }

    /// Returns the history variables of the faces, in the order in which the faces were given, for reading and writing.
    pub(crate) fn history_mut(&mut self) -> &mut [[T; MAX_HISTORY_VARIABLES]] {
        &mut self.history
    }

    /// Returns state and constants of the fluid in a cell.
    fn fluid_state(&self, cell: usize) -> (FluidState<T>, &FluidConstants<T>) {
        let fluid = &self.cells[cell].law.fluid;
        (fluid.state(&self.history[cell]), fluid)
    }

    /// Advances the flow by a time step of `step`, s, in sub-steps.
    pub(crate) fn advance(&mut self, step: f64) {
        let step = T::from_f64(step / self.substep_count as f64);
        for _ in 0..self.substep_count {
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

    /// Solves the Riemann problem of the fluid at a vertex; returns the states at the ends of its arms.
    fn solve_vertex(&self, vertex: usize) -> [FluidState<T>; 4] {
        let vertex = &self.vertices[vertex];
        let zero = FluidState { velocity: T::ZERO, stress: T::ZERO };
        for along in 0..2 {
            let transverse = 2 * (1 - along);
            let is_straight =
                vertex.arms[transverse].is_none() && vertex.arms[transverse + 1].is_none();
            let (lower, upper) = (vertex.arms[2 * along], vertex.arms[2 * along + 1]);
            if let (Some(lower), Some(upper), true) = (lower, upper, is_straight) {
                let [(lower_state, lower_fluid), (upper_state, upper_fluid)] =
                    [lower, upper].map(|cell| self.fluid_state(cell));
                if lower_fluid.thickness == upper_fluid.thickness {
                    return [solve_riemann(
                        [lower_state, upper_state],
                        [lower_fluid.impedance, upper_fluid.impedance],
                    ); 4];
                }
            }
            if let (true, Some((side, cell))) = (is_straight, find_single_arm(lower, upper)) {
                let (state, fluid) = self.fluid_state(cell);
                let end = match vertex.is_open {
                    true => solve_open_end(state, side, fluid.impedance),
                    false => solve_closed_end(state, side, fluid.impedance),
                };
                return [end; 4];
            }
        }
        let absent_arm = |side: ArmSide| JunctionArm {
            side,
            porosity: T::ZERO,
            thickness: T::ZERO,
            impedance: T::ONE,
            state: zero,
        };
        let arms = std::array::from_fn(|arm| match vertex.arms[arm] {
            None => absent_arm(ARM_SIDES[arm]),
            Some(cell) => {
                let (state, fluid) = self.fluid_state(cell);
                JunctionArm {
                    side: ARM_SIDES[arm],
                    porosity: self.cells[cell].law.porosity(&self.history[cell]),
                    thickness: fluid.thickness,
                    impedance: fluid.impedance,
                    state,
                }
            }
        });
        solve_junction::<T, 4>(&arms).0
    }
}

/// Returns the only arm of two collinear ones, if just one exists.
fn find_single_arm(lower: Option<usize>, upper: Option<usize>) -> Option<(ArmSide, usize)> {
    match (lower, upper) {
        (Some(cell), None) => Some((ArmSide::Lower, cell)),
        (None, Some(cell)) => Some((ArmSide::Upper, cell)),
        _ => None,
    }
}
