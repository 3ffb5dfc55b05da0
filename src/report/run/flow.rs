//! Pictures of the simulation of a flow.

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
        None => of("v1").iter().zip(of("v2")).map(|(v1, v2)| v1.root_sum_square(*v2)).collect(),
        Some(own) => of(own.array_name()).iter().map(|value| own.to_display_unit(*value)).collect(),
    };
    let figure = create_figure(case, run, fields.time, values);
    let mut pictures = vec![ReportPicture::new("run", move |format| figure.draw(format))];
    pictures.extend(records.receivers.as_ref().map(|table| create_seismograms(case, table)));
    let describe_term = |name: &str| match name {
        "kinetic" => "kinetic energy of the perturbation",
        "background" => "energy from the mean flow",
        "stress" => "work of the stress",
        _ => "residual: time-step error",
    };
    pictures.extend(create_ledger_picture(case, &records.ledger, describe_term));
    pictures
        .extend(records.spectrum.as_ref().and_then(|table| create_spectrum_picture(case, table)));
    pictures
}

/// Reads the values of the case's picture from a snapshot, in display units; an error message if they are absent.
pub(super) fn read_snapshot_values(bytes: &[u8], run: &FlowRun) -> Result<Vec<f64>, String> {
    let count = run.grid.point_count();
    let velocity = || read_array(bytes, "velocity [m/s]", 3 * count);
    let values: Vec<f64> = match run.output.plotted_field {
        None => velocity()?.chunks_exact(3).map(|v| v[0].root_sum_square(v[1])).collect(),
        Some(FlowQuantity::Velocity(i)) => velocity()?.chunks_exact(3).map(|v| v[i]).collect(),
        Some(own) => {
            let name = format!("{} [{}]", own.array_name(), quantity_unit(own.array_name()));
            read_array(bytes, &name, count)?
                .iter()
                .map(|value| own.to_display_unit(*value))
                .collect()
        }
    };
    Ok(values)
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
        None => "speed |v| of the perturbation, m/s".to_owned(),
        Some(own @ FlowQuantity::Velocity(_)) => axis_label(own.name()),
        Some(own) => {
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.iter_mut().for_each(|value| *value -= mean);
            let unit = quantity_unit(own.name()).replace("deg", "°");
            subtitle += &format!("; mean {} {unit}", format_short(mean));
            axis_label(own.name()).replace(", ", " minus the mean, ")
        }
    };
    let axis = |axis: usize| FieldAxis {
        label: format!("x{} at t = 0, m", ["₁", "₂"][axis]),
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
        columns: run.grid.points[0],
        rows: run.grid.points[1],
        values,
        label,
        is_signed: picture.is_some(),
        limit: None,
        fixed_limit: None,
        contour_levels: run.output.contour_levels.clone(),
        body: None,
        material_indices: Vec::new(),
        has_yielded: Vec::new(),
        line_sets: Vec::new(),
        arrows: None,
        marks: run
            .receivers
            .iter()
            .map(|own| mark([own.position[0], own.position[1]], &own.name))
            .collect(),
    }
}

/// Creates the figure of the energy spectrum by shells of mode numbers, at up to six evenly spaced rows of its table,
/// from the first to the last.
fn create_spectrum_picture(case: &Case, table: &RecordTable) -> Option<ReportPicture> {
    /// Maximum number of spectra drawn, one per time.
    const MAX_SPECTRA: usize = 6;
    let (times, shells) = table.columns.split_first()?;
    let times = &times.values;
    let last = times.len().saturating_sub(1);
    let count = MAX_SPECTRA.min(times.len());
    let rows = (0..count).map(|line| line * last / (count - 1).max(1));
    let lines = rows.map(|row| LabelledCurve {
        label: format!("t = {} s", format_short(times[row])),
        points: (1..).zip(shells).map(|(n, shell)| [f64::from(n), shell.values[row]]).collect(),
    });
    let figure = SpectrumFigure {
        title: case_title(case),
        subtitle: "energy of the modes with n − ½ ≤ |m| < n + ½".to_owned(),
        x_label: "mode number n".to_owned(),
        y_label: "kinetic energy, J/m³".to_owned(),
        spectra: lines.collect(),
        measured_points: Vec::new(),
    };
    Some(ReportPicture::new("spectrum", move |format| figure.draw(format)))
}
