//! Means over blocks: stresses, and the rate of rotation ½(v₂,₁ − v₁,₂).

use crate::case::CaseError;
use crate::case::dynamics::{PlacedBlock, SolidGrid, SolidRun};
use crate::study::simulate::OutputFields;
use models::common::decimal::format_rounded;
use std::ops::Range;

/// Largest distance of the edge of an averaging area from a face between cells, relative to a cell.
const ALIGNMENT_TOLERANCE: f64 = 1e-6;

/// Rectangles that tile the domain, over which both runs are averaged: the blocks of the first blocky run, or else the
/// cells of the coarser grid.
#[derive(Clone, Debug)]
pub(super) struct AveragingAreas {
    /// Lower and upper bound along each axis, m.
    bounds: Vec<[[f64; 2]; 2]>,
    /// Whether the areas are blocks.
    pub(super) are_blocks: bool,
    /// Cells of each run in each area, along each axis.
    ranges: [Vec<[Range<usize>; 2]>; 2],
    /// Index of the run with the cells from which the areas were taken.
    source: usize,
}

impl AveragingAreas {
    /// Determines the areas for two runs of the same extent.
    ///
    /// # Errors
    /// The areas are not whole numbers of cells of the other run.
    pub(super) fn new(runs: [&SolidRun; 2]) -> Result<Self, CaseError> {
        let blocky = runs.iter().position(|run| run.blocks.is_some());
        let coarser = usize::from(runs[1].grid.cell_count() < runs[0].grid.cell_count());
        let source = blocky.unwrap_or(coarser);
        let grid = &runs[source].grid;
        let own: Vec<[Range<usize>; 2]> = match &runs[source].blocks {
            Some(blocks) => {
                blocks.blocks.iter().map(|block: &PlacedBlock| block.cells.clone()).collect()
            }
            None => {
                let [columns, rows] = [grid.cells[0], grid.cells[1]];
                let cell = |index: usize| {
                    let [i, j] = [index % columns, index / columns];
                    [i..i + 1, j..j + 1]
                };
                (0..columns * rows).map(cell).collect()
            }
        };
        let coordinate =
            |axis: usize, face: usize| grid.origin[axis] + face as f64 * grid.spacing[axis];
        let bounds: Vec<[[f64; 2]; 2]> = own
            .iter()
            .map(|cells| {
                [0, 1].map(|axis| [cells[axis].start, cells[axis].end].map(|i| coordinate(axis, i)))
            })
            .collect();
        let other = runs[1 - source];
        let found: Option<Vec<_>> =
            bounds.iter().map(|area| align_with_cells(&other.grid, area)).collect();
        let Some(found) = found else {
            let key = if other.blocks.is_some() { "block[0].cells" } else { "grid.cells" };
            let spacing = format!(
                "found cells of {} × {} m",
                format_rounded(other.grid.spacing[0]),
                format_rounded(other.grid.spacing[1])
            );
            let [[left, right], [bottom, top]] = bounds[0];
            let allowed = format!(
                "expected a whole number of cells along both axes of each {} of {} × {} m of the other run",
                if blocky.is_some() { "block" } else { "cell" },
                format_rounded(right - left),
                format_rounded(top - bottom),
            );
            return Err(other.key_error(key, spacing, allowed));
        };
        let ranges = if source == 0 { [own, found] } else { [found, own] };
        Ok(Self { bounds, are_blocks: blocky.is_some(), ranges, source })
    }

    /// Returns the number of areas.
    pub(super) fn count(&self) -> usize {
        self.bounds.len()
    }

    /// Returns the edge lengths of the first area, m.
    pub(super) fn size(&self) -> [f64; 2] {
        self.bounds[0].map(|[from, to]| to - from)
    }

    /// Returns the area of each averaging area, m².
    fn weights(&self) -> impl Iterator<Item = f64> {
        self.bounds.iter().map(|[[left, right], [bottom, top]]| (right - left) * (top - bottom))
    }

    /// Computes the difference of two lists of means relative to the first: ‖a − b‖/‖a‖ with the L2 norm over the domain;
    /// `None` if the first vanishes.
    pub(super) fn relative_difference(&self, means: [&[f64]; 2]) -> Option<f64> {
        let [mut difference, mut reference] = [0.0, 0.0];
        for ((first, second), weight) in means[0].iter().zip(means[1]).zip(self.weights()) {
            difference += weight * (first - second) * (first - second);
            reference += weight * first * first;
        }
        let ratio = (difference / reference).sqrt();
        (reference > 0.0).then_some(ratio).filter(|ratio| ratio.is_finite())
    }

    /// Spreads means over the cells of the grid from which the areas were taken, first axis fastest; the grid is that of
    /// the run [`raster_run`](Self::raster_run).
    pub(super) fn spread_over_cells(
        &self,
        means: &[f64],
        columns: usize,
        count: usize,
    ) -> Vec<f64> {
        let mut values = vec![0.0; count];
        for ([i, j], mean) in self.ranges[self.source].iter().zip(means) {
            for row in j.clone() {
                values[columns * row + i.start..columns * row + i.end].fill(*mean);
            }
        }
        values
    }

    /// Returns the index of the run with the cells of the areas.
    pub(super) fn raster_run(&self) -> usize {
        self.source
    }
}

/// Returns the cells of a grid in an area; `None` if an edge is inside a cell, or the area holds no cell.
fn align_with_cells(grid: &SolidGrid, area: &[[f64; 2]; 2]) -> Option<[Range<usize>; 2]> {
    let along = |axis: usize| {
        let face = |coordinate: f64| {
            let place = (coordinate - grid.origin[axis]) / grid.spacing[axis];
            let nearest = place.round();
            let is_face = (place - nearest).abs() <= ALIGNMENT_TOLERANCE
                && (0.0..=grid.cells[axis] as f64).contains(&nearest);
            is_face.then_some(nearest as usize)
        };
        let cells = face(area[axis][0])?..face(area[axis][1])?;
        (!cells.is_empty()).then_some(cells)
    };
    Some([along(0)?, along(1)?])
}

/// Means of a run over the averaging areas at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockMeans {
    /// Normal stress σ₂₂, Pa.
    pub normal_stress: Vec<f64>,
    /// Shear stress, Pa: σ₁₂, in Cosserat solids ½(σ₁₂ + σ₂₁), since the mean of σ₁₂ over a block contains the tractions
    /// on both pairs of its faces.
    pub shear_stress: Vec<f64>,
    /// Rate of rotation, rad/s: spin ω₃ of a Cosserat solid, otherwise ½(v₂,₁ − v₁,₂) of the linear velocity field that fits
    /// best by least squares. Empty if an area has only one cell
    /// of a solid without spin along an axis.
    pub rotation_rate: Vec<f64>,
}

impl BlockMeans {
    /// Averages the fields of a run, with index `run`, over all areas.
    pub(super) fn new(areas: &AveragingAreas, run: usize, fields: &OutputFields) -> Self {
        let columns = fields.coordinates.first().map_or(0, Vec::len);
        let get = |name: &str| fields.get(name).unwrap_or_default();
        let average = |name: &str| -> Vec<f64> {
            let values = get(name);
            areas.ranges[run].iter().map(|cells| mean(values, columns, cells)).collect()
        };
        let mut shear_stress = average("sigma12");
        if fields.get("sigma21").is_some() {
            for (shear, transposed) in shear_stress.iter_mut().zip(average("sigma21")) {
                *shear = 0.5 * (*shear + transposed);
            }
        }
        let rotation_rate = match fields.get("w3") {
            Some(_) => average("w3"),
            None => {
                let rate = |cells: &[Range<usize>; 2]| {
                    let [first, second] = [(get("v2"), 0), (get("v1"), 1)]
                        .map(|(values, axis)| fit_slope(values, columns, cells, axis, fields));
                    Some(0.5 * (first? - second?))
                };
                areas.ranges[run].iter().map(rate).collect::<Option<_>>().unwrap_or_default()
            }
        };
        Self { normal_stress: average("sigma22"), shear_stress, rotation_rate }
    }
}

fn mean(values: &[f64], columns: usize, [i, j]: &[Range<usize>; 2]) -> f64 {
    let rows = j
        .clone()
        .map(|row| values.get(columns * row + i.start..columns * row + i.end).unwrap_or_default());
    rows.flatten().sum::<f64>() / (i.len() * j.len()) as f64
}

/// Computes the slope along `axis` of the linear function that fits the values in an area best by least squares. `None` for a
/// single layer of cells.
///
/// For velocities half the difference of both slopes in a square is its angular momentum over its moment of inertia. The
/// slope depends little on the cells beside joints, where the reconstruction is of lower order.
fn fit_slope(
    values: &[f64],
    columns: usize,
    cells: &[Range<usize>; 2],
    axis: usize,
    fields: &OutputFields,
) -> Option<f64> {
    let layers = cells[axis].clone();
    let along = fields.coordinates.get(axis)?;
    let middle = 0.5 * (along.get(layers.start)? + along.get(layers.end - 1)?);
    let [mut sum, mut squares] = [0.0, 0.0];
    for index in layers {
        let mut layer = cells.clone();
        layer[axis] = index..index + 1;
        let distance = along.get(index)? - middle;
        sum += distance * mean(values, columns, &layer);
        squares += distance * distance;
    }
    (squares > 0.0).then(|| sum / squares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::simulate::FieldQuantity;

    /// Verifies that the mean rate of a linear velocity field is exact, with different spacings along the axes.
    #[test]
    fn rotation_rate_of_a_rigid_rotation_and_strain_is_exact() {
        let spacing = [0.5, 0.25];
        let coordinates: Vec<Vec<f64>> = [6, 8]
            .iter()
            .zip(spacing)
            .map(|(count, spacing)| (0..*count).map(|i| (i as f64 + 0.5) * spacing).collect())
            .collect();
        let field = |name: &str, value: fn(f64, f64) -> f64| {
            let values = coordinates[1]
                .iter()
                .flat_map(|y| coordinates[0].iter().map(move |x| value(*x, *y)))
                .collect();
            FieldQuantity::new(name.to_owned(), values)
        };
        let quantities = vec![
            field("v1", |x, y| 3.0 * x - 5.0 * y + 1.0),
            field("v2", |x, y| 2.0 * x + 7.0 * y),
            field("sigma12", |x, y| x * y),
            field("sigma22", |x, _| x),
        ];
        let fields = OutputFields { coordinates, quantities, ..OutputFields::default() };
        let own = vec![[0..3, 0..4], [3..6, 0..4], [0..3, 4..8], [3..6, 4..8]];
        let areas = AveragingAreas {
            bounds: vec![[[0.0, 1.5], [0.0, 1.0]]; 4],
            are_blocks: true,
            ranges: [own.clone(), own],
            source: 0,
        };
        let means = BlockMeans::new(&areas, 0, &fields);
        assert!(means.rotation_rate.iter().all(|rate| (rate - 3.5).abs() < 1e-12), "{means:?}");
        assert_eq!(means.normal_stress, [0.75, 2.25, 0.75, 2.25]);
        assert_eq!(means.shear_stress, [0.375, 1.125, 1.125, 3.375]);
        // ‖a − 2a‖/‖a‖ = 1; without a reference there is no relative difference.
        let doubled: Vec<f64> = means.shear_stress.iter().map(|stress| 2.0 * stress).collect();
        assert_eq!(areas.relative_difference([&means.shear_stress, &doubled]), Some(1.0));
        assert_eq!(areas.relative_difference([&[0.0; 4], &doubled]), None);
        let cells = areas.spread_over_cells(&means.shear_stress, 6, 48);
        assert_eq!([cells[0], cells[3], cells[24], cells[47]], [0.375, 1.125, 1.125, 3.375]);
    }

    #[test]
    fn areas_are_aligned_with_cells_or_refused() {
        let grid = SolidGrid {
            cells: vec![10, 4],
            spacing: vec![0.1; 2],
            origin: vec![-0.5, 0.0],
            polar_bounds: None,
        };
        let align = |area| align_with_cells(&grid, &area);
        assert_eq!(align([[-0.3, 0.1], [0.0, 0.2]]), Some([2..6, 0..2]));
        assert_eq!(align([[-0.25, 0.1], [0.0, 0.2]]), None);
        assert_eq!(align([[-0.3, -0.3], [0.0, 0.2]]), None);
        assert_eq!(align([[-0.3, 0.1], [0.0, 0.5]]), None);
    }
}
