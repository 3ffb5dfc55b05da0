//! Pictures of the simulation of a flow.

use super::records::{ledger, seismograms};
use super::snapshot::array;
use super::words::label;
use crate::case::Case;
use crate::case::flow::{FlowRun, Quantity};
use crate::report::Picture;
use crate::report::format::{case_title, short};
use crate::study::simulate::{Fields, Records, Table, unit_of};
use figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind, Line, SpectrumFigure};
use models::common::elementary::Elementary;

/// Creates all pictures of a run except the animation.
pub(super) fn pictures(
    case: &Case,
    run: &FlowRun,
    fields: &Fields,
    records: &Records,
) -> Vec<Picture> {
    let of = |name: &str| fields.get(name).unwrap_or_default();
    let values = match run.output.picture {
        None => of("v1").iter().zip(of("v2")).map(|(v1, v2)| v1.root_sum_square(*v2)).collect(),
        Some(own) => of(own.array()).iter().map(|value| own.to_display_unit(*value)).collect(),
    };
    let figure = figure(case, run, fields.time, values);
    let mut pictures = vec![Picture::new("run", move |format| figure.draw(format))];
    pictures.extend(records.receivers.as_ref().map(|table| seismograms(case, table)));
    let words = |name: &str| match name {
        "kinetic" => "kinetic energy of the perturbation",
        "background" => "given by the mean flow",
        "stress" => "work of the stress",
        _ => "left over: error of the steps",
    };
    pictures.extend(ledger(case, &records.ledger, words));
    pictures.extend(records.spectrum.as_ref().and_then(|table| spectrum(case, table)));
    pictures
}

/// Reads the values of the case's picture from a snapshot, in display units; an error message if they are absent.
pub(super) fn of_snapshot(bytes: &[u8], run: &FlowRun) -> Result<Vec<f64>, String> {
    let count = run.grid.count();
    let velocity = || array(bytes, "velocity [m/s]", 3 * count);
    let values: Vec<f64> = match run.output.picture {
        None => velocity()?.chunks_exact(3).map(|v| v[0].root_sum_square(v[1])).collect(),
        Some(Quantity::Velocity(i)) => velocity()?.chunks_exact(3).map(|v| v[i]).collect(),
        Some(own) => {
            let name = format!("{} [{}]", own.array(), unit_of(own.array()));
            array(bytes, &name, count)?.iter().map(|value| own.to_display_unit(*value)).collect()
        }
    };
    Ok(values)
}

/// Creates the figure of a field in the initial box. The spatial mean of quantities other than velocities is
/// subtracted, since perturbations are small against it.
pub(super) fn figure(case: &Case, run: &FlowRun, time: f64, mut values: Vec<f64>) -> FieldFigure {
    let picture = run.output.picture;
    let mut subtitle = format!("t = {} s, in the box that moves with the mean flow", short(time));
    let label = match picture {
        None => "speed |v| of the perturbation, m/s".to_owned(),
        Some(own @ Quantity::Velocity(_)) => label(own.name()),
        Some(own) => {
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.iter_mut().for_each(|value| *value -= mean);
            let unit = unit_of(own.name()).replace("deg", "°");
            subtitle += &format!("; mean {} {unit}", short(mean));
            label(own.name()).replace(", ", " less the mean, ")
        }
    };
    let axis = |axis: usize| FieldAxis {
        label: format!("x{} at the beginning, m", ["₁", "₂"][axis]),
        from: 0.0,
        to: run.grid.lengths[axis],
    };
    let mark = |at: [f64; 2], name: &str| FieldMark {
        at,
        name: name.to_owned(),
        kind: FieldMarkKind::Receiver,
    };
    FieldFigure {
        title: case_title(case),
        subtitle,
        x: axis(0),
        y: axis(1),
        columns: run.grid.cells[0],
        rows: run.grid.cells[1],
        values,
        label,
        is_signed: picture.is_some(),
        limit: None,
        scale: None,
        curves: run.output.contours.clone(),
        outlines: Vec::new(),
        plastic: Vec::new(),
        marks: run.receivers.iter().map(|own| mark([own.at[0], own.at[1]], &own.name)).collect(),
    }
}

/// Creates the figure of the energy spectrum by shells of modes, at up to six times.
fn spectrum(case: &Case, table: &Table) -> Option<Picture> {
    /// Maximum number of lines.
    const MOST: usize = 6;
    let (times, shells) = table.columns.split_first()?;
    let times = &times.values;
    let last = times.len().saturating_sub(1);
    let count = MOST.min(times.len());
    let rows = (0..count).map(|line| line * last / (count - 1).max(1));
    let lines = rows.map(|row| Line {
        label: format!("t = {} s", short(times[row])),
        points: (1..).zip(shells).map(|(n, shell)| [f64::from(n), shell.values[row]]).collect(),
    });
    let figure = SpectrumFigure {
        title: case_title(case),
        subtitle: "energy of the modes with n − ½ ≤ |m| < n + ½".to_owned(),
        x_label: "mode number n".to_owned(),
        y_label: "kinetic energy, J/m³".to_owned(),
        lines: lines.collect(),
        rings: Vec::new(),
    };
    Some(Picture::new("spectrum", move |format| figure.draw(format)))
}
