//! Pictures of the simulation of a flow.

use super::FLOW_LEDGER_TERMS;
use super::display::axis_label;
use super::records::{create_ledger_picture, create_seismograms};
use super::snapshot::read_array;
use crate::case::Case;
use crate::case::flow::{FlowQuantity, FlowRun};
use crate::report::ReportPicture;
use crate::report::format::{case_title, format_short};
use crate::study::simulate::{OutputFields, RecordTable, RunRecords, quantity_unit};
use figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind, LabelledCurve, SpectrumFigure};
use models::common::elementary::Elementary;

/// Creates all pictures of a run except the animation.
pub(super) fn create_pictures(
    case: &Case,
    run: &FlowRun,
    fields: &OutputFields,
    records: &RunRecords,
) -> Vec<ReportPicture> {
    let of = |name: &str| fields.get(name).unwrap_or_default();
    let values = match run.output.plotted_field {
        None => interpolate_speed(of("v1"), of("v2"), run.grid.points),
        Some(own) => {
            let values: Vec<f64> =
                of(own.array_name()).iter().map(|value| own.to_display_unit(*value)).collect();
            interpolate_periodic(&values, run.grid.points)
        }
    };
    let figure = create_figure(case, run, fields.time, values);
    let mut pictures = vec![ReportPicture::new("run", move |format| figure.draw(format))];
    pictures.extend(records.receivers.as_ref().map(|table| create_seismograms(case, table)));
    pictures.extend(create_ledger_picture(case, &records.ledger, FLOW_LEDGER_TERMS));
    pictures
        .extend(records.spectrum.as_ref().and_then(|table| create_spectrum_picture(case, table)));
    pictures
}

/// Reads the values of the case's picture from a snapshot, in display units; an error message if they are absent.
pub(super) fn read_snapshot_values(bytes: &[u8], run: &FlowRun) -> Result<Vec<f64>, String> {
    let count = run.grid.point_count();
    let velocity = || read_array(bytes, "velocity [m/s]", 3 * count);
    let values: Vec<f64> = match run.output.plotted_field {
        None => {
            let velocity = velocity()?;
            let [v1, v2] = [0, 1]
                .map(|axis| velocity.iter().skip(axis).step_by(3).copied().collect::<Vec<_>>());
            return Ok(interpolate_speed(&v1, &v2, run.grid.points));
        }
        Some(FlowQuantity::Velocity(i)) => velocity()?.chunks_exact(3).map(|v| v[i]).collect(),
        Some(own) => {
            let name = format!("{} [{}]", own.array_name(), quantity_unit(own.array_name()));
            read_array(bytes, &name, count)?
                .iter()
                .map(|value| own.to_display_unit(*value))
                .collect()
        }
    };
    Ok(interpolate_periodic(&values, run.grid.points))
}

/// Creates the figure of the plotted field of the case in the initial box, from its values in display units. The
/// spatial mean of quantities other than velocities is subtracted, since perturbations are small against it.
pub(super) fn create_figure(
    case: &Case,
    run: &FlowRun,
    time: f64,
    mut values: Vec<f64>,
) -> FieldFigure {
    let picture = run.output.plotted_field;
    let mut subtitle =
        format!("t = {} s, in the box that moves with the mean flow", format_short(time));
    let label = match picture {
        None => "speed |v| of the perturbation (m/s)".to_owned(),
        Some(own @ FlowQuantity::Velocity(_)) => axis_label(own.name()),
        Some(own) => {
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.iter_mut().for_each(|value| *value -= mean);
            let unit = quantity_unit(own.name()).replace("deg", "°");
            subtitle += &format!("; mean {} {unit}", format_short(mean));
            axis_label(own.name()).replace(" (", " minus the mean (")
        }
    };
    let factors = interpolation_factors(run.grid.points);
    let [columns, rows] = [0, 1].map(|axis| run.grid.points[axis] * factors[axis]);
    let axis = |axis: usize| FieldAxis {
        label: format!("x{} at t = 0 (m)", ["₁", "₂"][axis]),
        start: 0.0,
        end: run.grid.lengths[axis],
    };
    let mark = |at: [f64; 2], name: &str| FieldMark {
        position: at,
        name: name.to_owned(),
        kind: FieldMarkKind::Receiver,
    };
    FieldFigure {
        title: case_title(case),
        subtitle,
        x: axis(0),
        y: axis(1),
        columns,
        rows,
        values,
        label,
        is_signed: picture.is_some(),
        contour_levels: run.output.contour_levels.clone(),
        marks: run
            .receivers
            .iter()
            .map(|own| mark([own.position[0], own.position[1]], &own.name))
            .collect(),
        ..FieldFigure::default()
    }
}

/// Returns the numbers of cells of a picture per point along both axes: at most six, and at most 512 cells in total.
fn interpolation_factors(points: [usize; 2]) -> [usize; 2] {
    const MAX_CELLS: usize = 512;
    const MAX_FACTOR: usize = 6;
    points.map(|count| (MAX_CELLS / count.max(1)).clamp(1, MAX_FACTOR))
}

/// Interpolates the components of a velocity as [`interpolate_periodic`] and returns their magnitude, which the points
/// alone do not resolve.
fn interpolate_speed(v1: &[f64], v2: &[f64], points: [usize; 2]) -> Vec<f64> {
    let [v1, v2] = [v1, v2].map(|values| interpolate_periodic(values, points));
    v1.iter().zip(&v2).map(|(v1, v2)| v1.root_sum_square(*v2)).collect()
}

/// Interpolates periodic values at points by the trigonometric polynomial through them, which is the field that the
/// solver represents. Returns the values at the centres of the cells of a picture; the points are at the lower edges of
/// their intervals. Values that are not finite are repeated.
fn interpolate_periodic(values: &[f64], points: [usize; 2]) -> Vec<f64> {
    let factor = interpolation_factors(points);
    if values.len() != points[0] * points[1] {
        return values.to_vec();
    }
    if values.iter().any(|value| !value.is_finite()) {
        let repeat = |row: &[f64]| -> Vec<f64> {
            row.iter().flat_map(|value| std::iter::repeat_n(*value, factor[0])).collect()
        };
        let rows = values.chunks_exact(points[0]).map(repeat);
        return rows.flat_map(|row| row.repeat(factor[1])).collect();
    }
    let weights = [0, 1].map(|axis| dirichlet_weights(points[axis], factor[axis]));
    let cells = [0, 1].map(|axis| points[axis] * factor[axis]);
    let along_x: Vec<f64> = values
        .chunks_exact(points[0])
        .flat_map(|row| {
            weights[0]
                .iter()
                .map(|own| row.iter().zip(own).map(|(value, weight)| value * weight).sum::<f64>())
        })
        .collect();
    let mut finer = vec![0.0; cells[0] * cells[1]];
    for (own, row) in weights[1].iter().zip(finer.chunks_exact_mut(cells[0])) {
        for (weight, source) in own.iter().zip(along_x.chunks_exact(cells[0])) {
            for (sum, value) in row.iter_mut().zip(source) {
                *sum += weight * value;
            }
        }
    }
    finer
}

/// Returns the weights of the values at `points` in the interpolated value of each of `factor` cells per point.
fn dirichlet_weights(points: usize, factor: usize) -> Vec<Vec<f64>> {
    let count = points as f64;
    let weight = |distance: f64| {
        let angle = std::f64::consts::PI * distance / count;
        let (sin, cos) = angle.cr_sin_cos();
        if sin.abs() < 1e-12 {
            return 1.0;
        }
        let ratio = (count * angle).cr_sin() / (count * sin);
        // The mode of the highest wave number of an even number of points is a cosine.
        if points.is_multiple_of(2) { ratio * cos } else { ratio }
    };
    (0..points * factor)
        .map(|cell| {
            // With one cell per point the values are those at the points.
            let place = match factor {
                1 => cell as f64,
                _ => (cell as f64 + 0.5) / factor as f64,
            };
            (0..points).map(|point| weight(place - point as f64)).collect()
        })
        .collect()
}

/// Creates the figure of the energy spectrum by shells of mode numbers, at up to six evenly spaced rows of its table,
/// from the first to the last.
fn create_spectrum_picture(case: &Case, table: &RecordTable) -> Option<ReportPicture> {
    /// Maximum number of spectra drawn, one per time.
    const MAX_SPECTRA: usize = 6;
    /// Energy of a shell, as a fraction of that of the strongest shell, below which it is a rounding error.
    const ENERGY_FLOOR: f64 = 1e-20;
    let (times, shells) = table.columns.split_first()?;
    let greatest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let largest = shells.iter().map(|shell| greatest(&shell.values)).fold(0.0, f64::max);
    let times = &times.values;
    let last = times.len().saturating_sub(1);
    let count = MAX_SPECTRA.min(times.len());
    let rows = (0..count).map(|line| line * last / (count - 1).max(1));
    let lines = rows.map(|row| LabelledCurve {
        label: format!("t = {} s", format_short(times[row])),
        points: (1..)
            .zip(shells)
            .filter(|(_, shell)| greatest(&shell.values) > ENERGY_FLOOR * largest)
            .map(|(n, shell)| [f64::from(n), shell.values[row]])
            .collect(),
    });
    let figure = SpectrumFigure {
        title: case_title(case),
        subtitle: "energy of the modes with n − ½ ≤ |m| < n + ½".to_owned(),
        x_label: "mode number n".to_owned(),
        y_label: "kinetic energy (J/m³)".to_owned(),
        spectra: lines.collect(),
        measured_points: Vec::new(),
        disagreeing_points: Vec::new(),
        remarks: Vec::new(),
    };
    Some(ReportPicture::new("spectrum", move |format| figure.draw(format)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Waves that the points resolve are reproduced between the points.
    #[test]
    fn resolved_waves_are_interpolated_exactly() {
        for points in [[8, 5], [7, 12]] {
            let wave = |x: f64, y: f64| {
                let [x, y] = [TAU * x / points[0] as f64, TAU * y / points[1] as f64];
                0.3 + (3.0 * x).sin() - 2.0 * (x + 2.0 * y).cos() + (y - x).sin()
            };
            let places = (0..points[0] * points[1]).map(|at| (at % points[0], at / points[0]));
            let values: Vec<f64> = places.map(|(x, y)| wave(x as f64, y as f64)).collect();
            let finer = interpolate_periodic(&values, points);
            let cells = points.map(|count| 6 * count);
            assert_eq!(finer.len(), cells[0] * cells[1]);
            for (cell, value) in finer.iter().enumerate() {
                let [x, y] = [cell % cells[0], cell / cells[0]].map(|at| (at as f64 + 0.5) / 6.0);
                assert!((value - wave(x, y)).abs() < 1e-12, "{value} at {x} {y}");
            }
        }
        let repeated = interpolate_periodic(&[1.0, f64::NAN], [2, 1]);
        assert!(repeated.len() == 72 && repeated[5] == 1.0 && repeated[6].is_nan());
        let speed = interpolate_speed(&[3.0; 6], &[4.0; 6], [3, 2]);
        assert!(speed.len() == 216 && speed.iter().all(|value| (value - 5.0).abs() < 1e-12));
        assert_eq!(dirichlet_weights(3, 1)[1][1], 1.0);
    }
}
