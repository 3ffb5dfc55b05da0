//! Picture of the circulation of the fluid in the saturated joints of a blocky medium.
//!
//! Arrows at the junctions of joints show the flux θ(w₁, w₂) of the fluid, with porosity θ and fluid velocity w; each
//! component is the mean over the faces of that direction that meet at the junction. The colour of a cell shows the
//! pressure of the nearest saturated face of its block. Level curves are those of the flux magnitude, interpolated
//! between junctions.

use crate::case::dynamics::{Blocks, SolidGrid};
use crate::study::simulate::JointFace;
use figures::{FieldArrow, FieldArrows};
use models::common::elementary::Elementary;
use models::interface::parameters::LayerMaterial;
use std::collections::{BTreeMap, VecDeque};

/// Pressure and flux of the fluid in saturated joints at one time.
pub(super) struct FluidState {
    /// Pressure by cell, Pa; 0 in blocks without saturated joints.
    pub(super) pressures: Vec<f64>,
    /// Arrows of the flux at the junctions of joints, m/s.
    pub(super) arrows: FieldArrows,
}

/// Sums of the fluxes along each axis, m/s, over the faces that meet at a node of the grid, and the numbers of these
/// faces.
#[derive(Clone, Copy, Default)]
struct NodeFluxSum {
    sums: [f64; 2],
    counts: [u32; 2],
}

impl NodeFluxSum {
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
    /// Computes pressures and fluxes from the states of the faces; `None` without saturated joints.
    pub(super) fn new(blocks: &Blocks, grid: &SolidGrid, faces: &[JointFace]) -> Option<Self> {
        let is_saturated: Vec<bool> = blocks
            .joint_laws()
            .map(|law| matches!(law.material, LayerMaterial::Saturated(_)))
            .collect();
        let own: Vec<&JointFace> = faces
            .iter()
            .filter(|face| is_saturated.get(face.joint_index).copied().unwrap_or(false))
            .collect();
        if own.is_empty() {
            return None;
        }
        let junctions = compute_junction_fluxes(grid, &own);
        let to_arrow = |(node, vector): (&[usize; 2], &[f64; 2])| FieldArrow {
            position: [0, 1].map(|axis| grid.origin[axis] + node[axis] as f64 * grid.spacing[axis]),
            vector: *vector,
        };
        Some(Self {
            pressures: assign_cell_pressures(blocks, grid, &own),
            arrows: FieldArrows {
                label: "flux of fluid θw".to_owned(),
                magnitude_label: "|θw|".to_owned(),
                unit: "m/s".to_owned(),
                arrows: junctions.iter().map(to_arrow).collect(),
                magnitudes: interpolate_flux_magnitudes(grid, &junctions),
            },
        })
    }
}

/// Returns the node of the grid nearest to the lower end of a face.
fn find_lower_node(grid: &SolidGrid, face: &JointFace) -> [usize; 2] {
    let end = face.ends()[0];
    [0, 1].map(|axis| {
        ((end[axis] - grid.origin[axis]) / grid.spacing[axis]).round().max(0.0) as usize
    })
}

/// Computes the flux, m/s, at all nodes of the grid where faces of both directions meet.
fn compute_junction_fluxes(
    grid: &SolidGrid,
    faces: &[&JointFace],
) -> BTreeMap<[usize; 2], [f64; 2]> {
    let mut nodes: BTreeMap<[usize; 2], NodeFluxSum> = BTreeMap::new();
    for face in faces {
        let along = 1 - face.axis;
        let flux = face.record.porosity * face.record.fluid_velocity;
        for end in 0..2 {
            let mut node = find_lower_node(grid, face);
            node[along] += end;
            let own = nodes.entry(node).or_default();
            own.sums[along] += flux;
            own.counts[along] += 1;
        }
    }
    nodes.into_iter().filter_map(|(node, own)| Some((node, own.mean()?))).collect()
}

/// Assigns to each cell the pressure, Pa, of the nearest saturated face of its block, where distance is the number of
/// steps between adjacent cells.
fn assign_cell_pressures(blocks: &Blocks, grid: &SolidGrid, faces: &[&JointFace]) -> Vec<f64> {
    let [columns, rows] = [grid.cells[0], grid.cells[1]];
    let mut pressures: Vec<Option<f64>> = vec![None; columns * rows];
    // A cell adjacent to several faces, in a corner of its block, has their mean pressure.
    let mut beside: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for face in faces {
        let upper = find_lower_node(grid, face);
        let mut lower = upper;
        // Along a periodic axis the neighbour below the first cell is the last one.
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
    // If the list of the block of each cell cannot be allocated, pressures are assigned across block boundaries.
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

/// Interpolates the flux magnitude, m/s, to the cell centres: linearly along the rows of junctions, then between rows; on
/// a rectangular lattice of junctions bilinearly. It is constant across the ends of a row, and beyond the first and last
/// rows. Empty unless there are two rows, each with two junctions.
fn interpolate_flux_magnitudes(
    grid: &SolidGrid,
    junctions: &BTreeMap<[usize; 2], [f64; 2]>,
) -> Vec<f64> {
    let mut rows: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
    for ([column, row], [first, second]) in junctions {
        let magnitude = Elementary::root_sum_square(*first, *second);
        rows.entry(*row).or_default().push((*column, magnitude));
    }
    if rows.len() < 2 || rows.values().any(|own| own.len() < 2) {
        return Vec::new();
    }
    let (row_nodes, rows): (Vec<usize>, Vec<Vec<(usize, f64)>>) = rows.into_iter().unzip();
    let values_along = |row: usize| -> Vec<f64> {
        let (columns, magnitudes): (Vec<usize>, Vec<f64>) = rows[row].iter().copied().unzip();
        let value = |cell: usize| {
            let (lower, fraction) = locate_between(&columns, cell);
            (1.0 - fraction) * magnitudes[lower] + fraction * magnitudes[lower + 1]
        };
        (0..grid.cells[0]).map(value).collect()
    };
    let mut values = Vec::with_capacity(grid.cell_count());
    let (mut current, mut neighbours) = (0, [values_along(0), values_along(1)]);
    for cell in 0..grid.cells[1] {
        let (row, up) = locate_between(&row_nodes, cell);
        if row != current {
            (current, neighbours) = (row, [values_along(row), values_along(row + 1)]);
        }
        let [lower, upper] = &neighbours;
        values
            .extend(lower.iter().zip(upper).map(|(lower, upper)| (1.0 - up) * lower + up * upper));
    }
    values
}

/// Returns the index of the last node before the centre of a cell that has a next node, and the fraction of the distance
/// to that node, in \[0, 1\]; `nodes` are at least two, in ascending order.
fn locate_between(nodes: &[usize], cell: usize) -> (usize, f64) {
    let next = nodes.partition_point(|node| *node <= cell).clamp(1, nodes.len() - 1);
    let (from, to) = (nodes[next - 1] as f64, nodes[next] as f64);
    (next - 1, ((cell as f64 + 0.5 - from) / (to - from)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Linear function of the position, in cells, as flux magnitude.
    fn linear_magnitude(x: f64, y: f64) -> f64 {
        3.0 + 0.5 * x + 0.25 * y
    }

    fn create_grid() -> SolidGrid {
        SolidGrid {
            cells: vec![16, 12],
            spacing: vec![0.5, 0.25],
            origin: vec![-1.0, 2.0],
            polar_bounds: None,
        }
    }

    /// Verifies that linear magnitudes are interpolated exactly between rows whose junctions lie at different places, as in
    /// masonry that ends at the joints of another region, and are constant across the ends of rows.
    #[test]
    fn linear_magnitudes_are_interpolated_between_unequal_rows() {
        let rows: [(usize, &[usize]); 3] = [(2, &[1, 4, 14]), (6, &[2, 6, 10, 15]), (10, &[0, 13])];
        let junctions: BTreeMap<[usize; 2], [f64; 2]> = rows
            .iter()
            .flat_map(|(row, columns)| columns.iter().map(|column| [*column, *row]))
            .map(|[i, j]| {
                let size = linear_magnitude(i as f64, j as f64);
                ([i, j], [0.6 * size, -0.8 * size])
            })
            .collect();
        let grid = create_grid();
        let values = interpolate_flux_magnitudes(&grid, &junctions);
        assert_eq!(values.len(), 16 * 12);
        for j in 2..10 {
            // From the largest first to the smallest last junction of two neighbouring rows.
            for i in 2..13 {
                let expected = linear_magnitude(i as f64 + 0.5, j as f64 + 0.5);
                assert!((values[16 * j + i] - expected).abs() < 1e-12, "{i} {j}");
            }
        }
        // Below the first row, and to the right of its last junction.
        assert!((values[15] - linear_magnitude(14.0, 2.0)).abs() < 1e-12);
    }

    #[test]
    fn single_rows_have_no_level_curves() {
        let row = |row: usize| [3, 6, 9].map(|column| ([column, row], [1.0, 0.0]));
        let grid = create_grid();
        assert!(interpolate_flux_magnitudes(&grid, &row(4).into_iter().collect()).is_empty());
        let single = row(4).into_iter().chain([([3, 8], [1.0, 0.0])]);
        assert!(interpolate_flux_magnitudes(&grid, &single.collect()).is_empty());
        let two = row(4).into_iter().chain(row(8));
        assert!(interpolate_flux_magnitudes(&grid, &two.collect()).iter().all(|own| *own == 1.0));
    }
}
