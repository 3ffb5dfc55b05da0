//! Probes: records at a point by polynomial interpolation of cell values.
//!
//! The interpolation is a tensor product of cubic Lagrange polynomials through the four nearest cells along each axis;
//! its error O(h⁴) is below that of the scheme. Near a boundary the four cells stay inside the grid and the polynomial
//! extrapolates by at most half a cell; on a periodic axis they wrap around. All cells belong to the medium of the cell
//! that contains the point, since fields have kinks or jumps at interfaces: near an interface the polynomials
//! extrapolate, and in a thin medium they have fewer cells.

use crate::solid::medium::Medium;

/// Maximum number of cells of the stencil along an axis.
const MAX_STENCIL_CELLS: usize = 4;

/// Distance from a cell centre, in cells, below which a point counts as at the centre.
const CENTRE_TOLERANCE: f64 = 1e-9;

/// Probe at a point: the cells and weights of its interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Cells (first axis fastest) and their weights, which add up to 1.
    stencil: Vec<(usize, f64)>,
    /// Cell that contains the point.
    containing_cell: usize,
}

/// Run of consecutive cells along an axis; `first` may be negative on a periodic axis.
#[derive(Clone, Copy, Debug)]
struct CellRun {
    first: isize,
    count: usize,
    /// [`MAX_STENCIL_CELLS`] minus the number of cells; 0 for a point at a cell centre.
    missing_cells: usize,
    /// Distance of the centre of the run from the point, in cells.
    centre_distance: f64,
}

/// Lists the admissible runs along an axis of `cells` cells for a point in cell `containing_cell`, at the coordinate
/// `x` in cells from the centre of the first cell.
fn admissible_runs(
    cells: usize,
    is_periodic: bool,
    containing_cell: usize,
    x: f64,
) -> Vec<CellRun> {
    let containing_cell = containing_cell as isize;
    if (x - containing_cell as f64).abs() < CENTRE_TOLERANCE {
        return vec![CellRun {
            first: containing_cell,
            count: 1,
            missing_cells: 0,
            centre_distance: 0.0,
        }];
    }
    let mut runs = Vec::new();
    for count in 1..=MAX_STENCIL_CELLS.min(cells) {
        for first in containing_cell + 1 - count as isize..=containing_cell {
            if is_periodic || (first >= 0 && first as usize + count <= cells) {
                let distance = (first as f64 + 0.5 * (count as f64 - 1.0) - x).abs();
                runs.push(CellRun {
                    first,
                    count,
                    missing_cells: MAX_STENCIL_CELLS - count,
                    centre_distance: distance,
                });
            }
        }
    }
    runs
}

/// Computes the Lagrange weights of the cells of a run for the coordinate `x`, in cells from the centre of the first
/// cell of the axis.
fn lagrange_weights(run: &CellRun, x: f64) -> Vec<f64> {
    let positions: Vec<f64> =
        (0..run.count).map(|index| (run.first + index as isize) as f64).collect();
    if run.missing_cells == 0 && run.count == 1 {
        return vec![1.0];
    }
    let weight = |own: &f64| {
        let others = positions.iter().filter(|other| *other != own);
        others.map(|other| (x - other) / (own - other)).product()
    };
    positions.iter().map(weight).collect()
}

/// Wraps an index along a periodic axis.
fn wrap_index(place: isize, cells: usize) -> usize {
    place.rem_euclid(cells as isize) as usize
}

/// Lists the cells of the tensor product of runs (first axis fastest) in a grid of `cells` cells.
fn box_cells(cells: &[usize], runs: &[CellRun]) -> Vec<usize> {
    let mut indices = vec![0];
    for (axis, run) in runs.iter().enumerate().rev() {
        let count = cells[axis];
        indices = indices
            .iter()
            .flat_map(|cell| {
                (0..run.count)
                    .map(move |index| cell * count + wrap_index(run.first + index as isize, count))
            })
            .collect();
    }
    indices
}

/// Selects the best tensor product of runs with cells of one medium: highest minimum polynomial degree, then highest
/// sum of degrees (the degree along an axis on whose cell centre the point lies counts as the maximum), then smallest
/// sum of the distances of the run centres from the point. `along`: admissible runs by axis; `has_one_medium`: whether
/// all cells are of one medium. `None` if there is no such product.
fn select_box(
    along: &[Vec<CellRun>],
    has_one_medium: impl Fn(&[CellRun]) -> bool,
) -> Option<Vec<CellRun>> {
    let mut boxes: Vec<Vec<CellRun>> = vec![Vec::new()];
    for runs in along {
        boxes = boxes
            .iter()
            .flat_map(|own| runs.iter().map(move |run| [own.as_slice(), &[*run]].concat()))
            .collect();
    }
    let rank = |runs: &[CellRun]| {
        let missing_cells = || runs.iter().map(|run| run.missing_cells);
        let distance: f64 = runs.iter().map(|run| run.centre_distance).sum();
        (missing_cells().max().unwrap_or(0), missing_cells().sum::<usize>(), distance)
    };
    boxes.sort_by(|one, other| {
        let (one, other) = (rank(one), rank(other));
        (one.0, one.1).cmp(&(other.0, other.1)).then(one.2.total_cmp(&other.2))
    });
    boxes.into_iter().find(|own| has_one_medium(own))
}

impl Probe {
    /// Creates a probe that takes the values of one cell.
    pub fn from_cell(containing_cell: usize) -> Self {
        Self { stencil: vec![(containing_cell, 1.0)], containing_cell }
    }

    /// Creates a probe at a point in cell `containing_cell` of a grid of `cells` cells (first axis fastest). `at`:
    /// coordinates of the point in cells from the centre of the first cell; `medium_index`: medium of a cell.
    pub fn with_interpolation(
        cells: &[usize],
        is_periodic: &[bool],
        medium_index: impl Fn(usize) -> usize,
        containing_cell: usize,
        at: &[f64],
    ) -> Self {
        let mut remaining_index = containing_cell;
        let along: Vec<Vec<CellRun>> = (0..cells.len())
            .map(|axis| {
                let index = remaining_index % cells[axis];
                remaining_index /= cells[axis];
                admissible_runs(cells[axis], is_periodic[axis], index, at[axis])
            })
            .collect();
        let has_one_medium = |runs: &[CellRun]| {
            box_cells(cells, runs)
                .into_iter()
                .all(|cell| medium_index(cell) == medium_index(containing_cell))
        };
        // The product of runs of one cell always qualifies.
        let Some(runs) = select_box(&along, has_one_medium) else {
            return Self::from_cell(containing_cell);
        };
        let mut products = vec![1.0];
        for (run, x) in runs.iter().zip(at).rev() {
            let weights = lagrange_weights(run, *x);
            products = products
                .iter()
                .flat_map(|product| weights.iter().map(move |weight| product * weight))
                .collect();
        }
        Self {
            stencil: box_cells(cells, &runs).into_iter().zip(products).collect(),
            containing_cell,
        }
    }

    /// Returns the cells of the stencil.
    pub(crate) fn cells(&self) -> impl Iterator<Item = usize> {
        self.stencil.iter().map(|own| own.0)
    }

    /// Replaces cells by their indices in the ascending list `watched`.
    pub(crate) fn reindex_cells(mut self, watched: &[usize]) -> Self {
        for (cell, _) in &mut self.stencil {
            *cell = watched.partition_point(|own| own < cell);
        }
        self
    }

    /// Appends the `width` output quantities at the point to `all`; `values` has `width` quantities per watched cell.
    /// Interpolated stresses are projected onto the yield set of the medium.
    pub(crate) fn append_values<'a>(
        &self,
        values: &[f64],
        width: usize,
        medium: impl Fn(usize) -> &'a Medium,
        all: &mut Vec<f64>,
    ) {
        let first = all.len();
        all.extend((0..width).map(|name| {
            let terms =
                self.stencil.iter().map(|(place, weight)| weight * values[place * width + name]);
            // For a single cell the value is unchanged bit for bit.
            terms.reduce(|sum, term| sum + term).unwrap_or(0.0)
        }));
        if self.stencil.len() > 1 {
            medium(self.containing_cell).make_admissible(&mut all[first..]);
        }
    }
}
