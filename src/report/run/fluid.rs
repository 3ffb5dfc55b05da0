//! Picture of the circulation of the fluid in saturated joints.
//!
//! Arrows at the junctions of joints are the flux θ(w₁, w₂), with the means over the faces of each direction that meet
//! there. The colour of a cell is the pressure of the nearest saturated face of its block; level curves are those of the
//! magnitude of the flux, interpolated bilinearly between junctions on a rectangular lattice.

use crate::case::dynamics::{Blocks, SolidGrid};
use crate::study::simulate::JointFace;
use figures::{FieldArrow, FieldArrows};
use models::common::elementary::Elementary;
use models::interface::parameters::LayerMaterial;
use std::collections::{BTreeMap, VecDeque};

/// Fluid in saturated joints at one time.
pub(super) struct FluidState {
    /// Pressure by cell, Pa; 0 in blocks without saturated joints.
    pub(super) pressures: Vec<f64>,
    /// Flux at junctions.
    pub(super) arrows: FieldArrows,
}

/// Sum of the fluxes along each axis of the faces that meet at a node of the grid, and their number.
#[derive(Clone, Copy, Default)]
struct NodeFlux {
    sums: [f64; 2],
    counts: [u32; 2],
}

impl NodeFlux {
    /// Returns the mean flux; `None` unless faces of both directions meet.
    fn mean(self) -> Option<[f64; 2]> {
        let Self { sums, counts } = self;
        counts
            .iter()
            .all(|count| *count > 0)
            .then(|| [0, 1].map(|axis| sums[axis] / f64::from(counts[axis])))
    }
}

impl FluidState {
    /// Evaluates the fluid; `None` without saturated joints.
    pub(super) fn new(blocks: &Blocks, grid: &SolidGrid, faces: &[JointFace]) -> Option<Self> {
        let is_saturated: Vec<bool> = blocks
            .joint_laws()
            .map(|law| matches!(law.material, LayerMaterial::Saturated(_)))
            .collect();
        let own: Vec<&JointFace> = faces
            .iter()
            .filter(|face| is_saturated.get(face.joint).copied().unwrap_or(false))
            .collect();
        if own.is_empty() {
            return None;
        }
        let junctions = find_junctions(grid, &own);
        let to_arrow = |(node, vector): (&[usize; 2], &[f64; 2])| FieldArrow {
            position: [0, 1].map(|axis| grid.origin[axis] + node[axis] as f64 * grid.spacing[axis]),
            vector: *vector,
        };
        Some(Self {
            pressures: spread_pressures(blocks, grid, &own),
            arrows: FieldArrows {
                label: "flux of fluid θw".to_owned(),
                magnitude_label: "|θw|".to_owned(),
                unit: "m/s".to_owned(),
                arrows: junctions.iter().map(to_arrow).collect(),
                magnitudes: interpolate_magnitudes(grid, &junctions),
            },
        })
    }
}

/// Returns the node of the grid nearest to the lower end of a face.
fn lower_node(grid: &SolidGrid, face: &JointFace) -> [usize; 2] {
    let end = face.ends()[0];
    [0, 1].map(|axis| {
        ((end[axis] - grid.origin[axis]) / grid.spacing[axis]).round().max(0.0) as usize
    })
}

/// Computes the flux at all nodes of the grid where faces of both directions meet.
fn find_junctions(grid: &SolidGrid, faces: &[&JointFace]) -> BTreeMap<[usize; 2], [f64; 2]> {
    let mut nodes: BTreeMap<[usize; 2], NodeFlux> = BTreeMap::new();
    for face in faces {
        let along = 1 - face.axis;
        let flux = face.record.porosity * face.record.fluid_velocity;
        for end in 0..2 {
            let mut node = lower_node(grid, face);
            node[along] += end;
            let own = nodes.entry(node).or_default();
            own.sums[along] += flux;
            own.counts[along] += 1;
        }
    }
    nodes.into_iter().filter_map(|(node, own)| Some((node, own.mean()?))).collect()
}

/// Computes the pressure in each cell: that of the nearest saturated face of its block, by steps between cells.
fn spread_pressures(blocks: &Blocks, grid: &SolidGrid, faces: &[&JointFace]) -> Vec<f64> {
    let [columns, rows] = [grid.cells[0], grid.cells[1]];
    let mut pressures: Vec<Option<f64>> = vec![None; columns * rows];
    // A cell beside several faces, in a corner of its block, has their mean.
    let mut beside: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for face in faces {
        let upper = lower_node(grid, face);
        let mut lower = upper;
        // Below the first cell of a periodic axis is the last one.
        lower[face.axis] = upper[face.axis].checked_sub(1).unwrap_or(grid.cells[face.axis] - 1);
        for [i, j] in [lower, upper] {
            let cell = j * columns + i;
            let own = beside.entry(cell).or_default();
            *own = (own.0 + face.record.pressure, own.1 + 1.0);
        }
    }
    let mut queue = VecDeque::new();
    for (cell, (sum, count)) in beside {
        if let Some(own) = pressures.get_mut(cell) {
            *own = Some(sum / count);
            queue.push_back(cell);
        }
    }
    // Without memory for the blocks of cells, pressures are spread across blocks.
    let owners = blocks.compute_cell_blocks().unwrap_or_default();
    while let Some(cell) = queue.pop_front() {
        let [i, j] = [cell % columns, cell / columns];
        let neighbours = [
            (i > 0).then(|| cell - 1),
            (i + 1 < columns).then(|| cell + 1),
            (j > 0).then(|| cell - columns),
            (j + 1 < rows).then(|| cell + columns),
        ];
        for next in neighbours.into_iter().flatten() {
            if pressures[next].is_none() && owners.get(next) == owners.get(cell) {
                pressures[next] = pressures[cell];
                queue.push_back(next);
            }
        }
    }
    pressures.into_iter().map(|pressure| pressure.unwrap_or(0.0)).collect()
}

/// Interpolates the magnitude of the flux bilinearly to the centres of cells; outside the lattice of junctions it is
/// constant across its boundary. Empty if the junctions form no rectangular lattice.
fn interpolate_magnitudes(
    grid: &SolidGrid,
    junctions: &BTreeMap<[usize; 2], [f64; 2]>,
) -> Vec<f64> {
    let lines = [0, 1].map(|axis| {
        let mut own: Vec<usize> = junctions.keys().map(|node| node[axis]).collect();
        own.sort_unstable();
        own.dedup();
        own
    });
    if lines.iter().any(|own| own.len() < 2) || lines[0].len() * lines[1].len() != junctions.len() {
        return Vec::new();
    }
    let magnitude = |node: [usize; 2]| {
        junctions.get(&node).map_or(0.0, |[u, v]| Elementary::root_sum_square(*u, *v))
    };
    // Index of the junction below a cell centre, and fraction of the distance to the next one.
    let locate = |axis: usize, cell: usize| {
        let own = &lines[axis];
        let above = own.partition_point(|line| *line <= cell).clamp(1, own.len() - 1);
        let (from, to) = (own[above - 1] as f64, own[above] as f64);
        (above - 1, ((cell as f64 + 0.5 - from) / (to - from)).clamp(0.0, 1.0))
    };
    let columns: Vec<(usize, f64)> = (0..grid.cells[0]).map(|cell| locate(0, cell)).collect();
    let mut values = Vec::with_capacity(grid.cell_count());
    for cell in 0..grid.cells[1] {
        let (row, up) = locate(1, cell);
        for &(column, right) in &columns {
            let at = |i: usize, j: usize| magnitude([lines[0][column + i], lines[1][row + j]]);
            let lower = (1.0 - right) * at(0, 0) + right * at(1, 0);
            let upper = (1.0 - right) * at(0, 1) + right * at(1, 1);
            values.push((1.0 - up) * lower + up * upper);
        }
    }
    values
}
