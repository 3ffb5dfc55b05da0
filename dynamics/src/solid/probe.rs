//! Probes: what is recorded at a point, by polynomial interpolation of cell values.
//!
//! Along each axis the Lagrange polynomial of degree 3 through the four cells nearest to the point, and their
//! tensor product: the error is O(h⁴), below that of the scheme. Next to a side the four cells stay inside and
//! the polynomial extrapolates, by half a cell at most; round a periodic axis they wrap round. All cells are of
//! the medium of the cell that holds the point, since fields have kinks or jumps at an interface: where
//! it is near, the polynomials extrapolate to it, and have fewer cells if the medium is thinner.

use crate::solid::medium::Medium;

/// Cells along an axis, at most.
const MOST: usize = 4;

/// Distance from the centre of a cell, in cells, that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// A point at which fields are recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Cells, the first axis running fastest, and their weights, which add up to 1.
    stencil: Vec<(usize, f64)>,
    /// The cell that holds the point.
    home: usize,
}

/// Cells that follow each other along an axis, by the index of the first one, which may lie before the grid
/// where that is periodic.
#[derive(Clone, Copy, Debug)]
struct Run {
    first: isize,
    count: usize,
    /// How much is lost without more cells: 0 where the point is at a centre.
    lacking: usize,
    /// Distance of the middle from the point, in cells.
    distance: f64,
}

/// The runs along an axis that may hold the point at `x`, in cells from the centre of the first one, which is in
/// the cell `home`.
fn runs(cells: usize, is_periodic: bool, home: usize, x: f64) -> Vec<Run> {
    let home = home as isize;
    if (x - home as f64).abs() < ROUNDING {
        return vec![Run { first: home, count: 1, lacking: 0, distance: 0.0 }];
    }
    let mut runs = Vec::new();
    for count in 1..=MOST.min(cells) {
        for first in home + 1 - count as isize..=home {
            if is_periodic || (first >= 0 && first as usize + count <= cells) {
                let distance = (first as f64 + 0.5 * (count as f64 - 1.0) - x).abs();
                runs.push(Run { first, count, lacking: MOST - count, distance });
            }
        }
    }
    runs
}

/// Lagrange weights at `x` of the cells of a run.
fn weights(run: &Run, x: f64) -> Vec<f64> {
    let places: Vec<f64> =
        (0..run.count).map(|index| (run.first + index as isize) as f64).collect();
    if run.lacking == 0 && run.count == 1 {
        return vec![1.0];
    }
    let weight = |own: &f64| {
        let others = places.iter().filter(|other| *other != own);
        others.map(|other| (x - other) / (own - other)).product()
    };
    places.iter().map(weight).collect()
}

/// Index of the cell at a place along an axis.
fn wrapped(place: isize, cells: usize) -> usize {
    place.rem_euclid(cells as isize) as usize
}

/// The cells of a box, the first axis fastest, by their indices along the axes.
fn cells_of(cells: &[usize], runs: &[Run]) -> Vec<usize> {
    let mut all = vec![0];
    for (axis, run) in runs.iter().enumerate().rev() {
        let count = cells[axis];
        all = all
            .iter()
            .flat_map(|cell| {
                (0..run.count)
                    .map(move |index| cell * count + wrapped(run.first + index as isize, count))
            })
            .collect();
    }
    all
}

/// The best box of one medium: the lowest degree as high as can be, then the others, then centred. `along` are by
/// axis the runs that it may have; `None` where there is none of one medium.
fn best_box(along: &[Vec<Run>], is_alike: impl Fn(&[Run]) -> bool) -> Option<Vec<Run>> {
    let mut boxes: Vec<Vec<Run>> = vec![Vec::new()];
    for runs in along {
        boxes = boxes
            .iter()
            .flat_map(|own| runs.iter().map(move |run| [own.as_slice(), &[*run]].concat()))
            .collect();
    }
    let rank = |runs: &[Run]| {
        let lacking = || runs.iter().map(|run| run.lacking);
        let distance: f64 = runs.iter().map(|run| run.distance).sum();
        (lacking().max().unwrap_or(0), lacking().sum::<usize>(), distance)
    };
    boxes.sort_by(|one, other| {
        let (one, other) = (rank(one), rank(other));
        (one.0, one.1).cmp(&(other.0, other.1)).then(one.2.total_cmp(&other.2))
    });
    boxes.into_iter().find(|own| is_alike(own))
}

impl Probe {
    /// The values of a cell.
    pub fn nearest(home: usize) -> Self {
        Self { stencil: vec![(home, 1.0)], home }
    }

    /// A point inside the cell `home` of a grid of so many `cells` along each axis, the first running fastest, which
    /// is periodic along some. `at` is the point in cells from the centre of the first one, `of_cell` the medium
    /// of each cell.
    pub fn interpolating(
        cells: &[usize],
        is_periodic: &[bool],
        of_cell: &[u16],
        home: usize,
        at: &[f64],
    ) -> Self {
        let mut rest = home;
        let along: Vec<Vec<Run>> = (0..cells.len())
            .map(|axis| {
                let index = rest % cells[axis];
                rest /= cells[axis];
                runs(cells[axis], is_periodic[axis], index, at[axis])
            })
            .collect();
        let is_alike = |runs: &[Run]| {
            cells_of(cells, runs).into_iter().all(|cell| of_cell[cell] == of_cell[home])
        };
        // The cell alone is always one.
        let Some(runs) = best_box(&along, is_alike) else { return Self::nearest(home) };
        let mut products = vec![1.0];
        for (run, x) in runs.iter().zip(at).rev() {
            let own = weights(run, *x);
            products =
                products.iter().flat_map(|all| own.iter().map(move |own| all * own)).collect();
        }
        Self { stencil: cells_of(cells, &runs).into_iter().zip(products).collect(), home }
    }

    /// The cells whose values it needs.
    pub(crate) fn cells(&self) -> impl Iterator<Item = usize> {
        self.stencil.iter().map(|own| own.0)
    }

    /// The same with places among `watched`, ascending, instead of cells.
    pub(crate) fn among(mut self, watched: &[usize]) -> Self {
        for (cell, _) in &mut self.stencil {
            *cell = watched.partition_point(|own| own < cell);
        }
        self
    }

    /// Appends the quantities at the point, of which there are `width` for each place in `values`. Interpolated
    /// stresses are put back into the yield set of the medium.
    pub(crate) fn append(
        &self,
        values: &[f64],
        width: usize,
        media: &[Medium],
        of_cell: &[u16],
        all: &mut Vec<f64>,
    ) {
        let first = all.len();
        all.extend((0..width).map(|name| {
            let terms =
                self.stencil.iter().map(|(place, weight)| weight * values[place * width + name]);
            // One cell alone keeps its bits.
            terms.reduce(|sum, term| sum + term).unwrap_or(0.0)
        }));
        if self.stencil.len() > 1 {
            media[usize::from(of_cell[self.home])].make_admissible(&mut all[first..]);
        }
    }
}
