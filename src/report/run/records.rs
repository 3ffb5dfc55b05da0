//! Pictures of receiver records and of the energy ledger.

use super::describe_ledger_term;
use super::display::axis_label;
use super::polar::polar_label;
use crate::case::Case;
use crate::case::dynamics::Precision;
use crate::report::ReportPicture;
use crate::report::format::case_title;
use crate::study::simulate::{RecordTable, quantity_unit};
use figures::{LedgerFigure, LedgerTerm, SeismogramFigure, SeismogramPanel, Trace};

/// Returns the indices of the receivers that a picture names, out of `count` receivers: at most eight, evenly spaced
/// from the first to the last.
pub(super) fn select_evenly_spaced_indices(count: usize) -> impl Iterator<Item = usize> {
    /// Maximum number of legend entries.
    const MAX_LEGEND_ENTRIES: usize = 8;
    let named = count.min(MAX_LEGEND_ENTRIES);
    (0..named).map(move |index| index * (count - 1) / (named - 1).max(1))
}

/// Creates the figure of the receiver records with one panel per quantity.
pub(super) fn create_seismograms(case: &Case, table: &RecordTable) -> ReportPicture {
    /// Maximum number of panels; further quantities are omitted.
    const MAX_PANELS: usize = 16;
    let is_polar = case.solid_run.as_ref().is_some_and(|run| run.grid.is_polar());
    let axis_label = |name: &str| match is_polar {
        true => polar_label(&axis_label(name)),
        false => axis_label(name),
    };
    let columns = &table.columns;
    let mut receivers: Vec<&str> =
        columns.iter().filter_map(|own| Some(own.name.rsplit_once('.')?.0)).collect();
    receivers.dedup();
    let drawn: Vec<&str> =
        select_evenly_spaced_indices(receivers.len()).map(|index| receivers[index]).collect();
    let mut panels: Vec<(String, Vec<Trace>)> = Vec::new();
    for column in columns.iter().skip(1) {
        let Some((receiver, name)) = column.name.rsplit_once('.') else { continue };
        if !drawn.contains(&receiver) {
            continue;
        }
        let trace = Trace { name: receiver.to_owned(), values: column.values.clone() };
        match panels.iter_mut().find(|panel| panel.0 == name) {
            Some(panel) => panel.1.push(trace),
            None => panels.push((name.to_owned(), vec![trace])),
        }
    }
    let vanishing = remove_vanishing_panels(&mut panels, machine_epsilon(case));
    let all = panels.len();
    panels.truncate(MAX_PANELS);
    let mut notes = Vec::new();
    if all > MAX_PANELS {
        notes.push(format!("the first {MAX_PANELS} of {all} quantities in receivers.csv"));
    }
    if receivers.len() > drawn.len() {
        notes.push(format!("{} of {} receivers", drawn.len(), receivers.len()));
    }
    if !vanishing.is_empty() {
        // The name of the quantity is the text of the axis label before its unit.
        let quantity = |name: &String| axis_label(name).split(" (").next().map(str::to_owned);
        let names: Vec<String> = vanishing.iter().filter_map(quantity).collect();
        notes.push(format!("omitted: {} (zero within rounding)", names.join(", ")));
    }
    let figure = SeismogramFigure {
        title: case_title(case),
        subtitle: notes.join(", "),
        time_label: "time t (s)".to_owned(),
        panels: panels
            .into_iter()
            .map(|(name, traces)| SeismogramPanel { label: axis_label(&name), traces })
            .collect(),
        times: columns.first().map(|column| column.values.clone()).unwrap_or_default(),
    };
    ReportPicture::new("seismograms", move |format| figure.draw(format))
}

/// Returns the machine epsilon of the solver's precision.
fn machine_epsilon(case: &Case) -> f64 {
    match case.solid_run.as_ref().map(|solid_run| solid_run.scheme.precision) {
        Some(Precision::F32) => f32::EPSILON.into(),
        _ => f64::EPSILON,
    }
}

/// Returns the greatest magnitude in traces; infinity if a value is not finite, which its panel shows.
fn greatest_magnitude(traces: &[Trace]) -> f64 {
    let all = traces.iter().flat_map(|trace| &trace.values);
    all.fold(0.0, |sum, value| if value.is_finite() { sum.max(value.abs()) } else { f64::INFINITY })
}

/// Removes the panels of quantities that vanish within rounding and returns the names of these quantities. The
/// reference is the largest value among all quantities of the same unit; plotted on a separate scale, rounding errors
/// would look like motion. Panels that are exactly zero are removed too if others remain. `rounding` is the machine
/// epsilon.
fn remove_vanishing_panels(panels: &mut Vec<(String, Vec<Trace>)>, rounding: f64) -> Vec<String> {
    /// Factor for the accumulation of rounding errors during a run.
    const ROUNDING_FACTOR: f64 = 256.0;
    let sizes: Vec<(&'static str, f64)> = panels
        .iter()
        .map(|(name, traces)| (quantity_unit(name), greatest_magnitude(traces)))
        .collect();
    let has_motion = sizes.iter().any(|own| own.1 > 0.0);
    let vanishes = |&(unit, size): &(&str, f64)| {
        let beside = sizes.iter().filter(|own| own.0 == unit && own.1.is_finite()).map(|own| own.1);
        has_motion && size <= ROUNDING_FACTOR * rounding * beside.fold(0.0, f64::max)
    };
    let vanishing: Vec<bool> = sizes.iter().map(vanishes).collect();
    let mut names = Vec::new();
    let mut index = 0;
    panels.retain(|(name, _)| {
        index += 1;
        if vanishing[index - 1] {
            names.push(name.clone());
        }
        !vanishing[index - 1]
    });
    names
}

/// Creates the figure of the energy ledger. Columns in the unit of energy are its terms, described by `descriptions`;
/// the last one of them is the balance. Terms that are zero at all times are omitted.
pub(super) fn create_ledger_picture(
    case: &Case,
    table: &RecordTable,
    descriptions: &[(&str, &str)],
) -> Option<ReportPicture> {
    let (times, columns) = table.columns.split_first()?;
    let unit = columns.first()?.unit;
    let mut terms: Vec<LedgerTerm> = columns
        .iter()
        .filter(|column| column.unit == unit)
        .map(|own| LedgerTerm {
            name: describe_ledger_term(descriptions, &own.name).unwrap_or(&own.name).to_owned(),
            values: own.values.clone(),
        })
        .collect();
    let balance = terms.pop()?;
    terms.retain(|term| term.values.iter().any(|value| *value != 0.0));
    let figure = LedgerFigure {
        title: case_title(case),
        subtitle: String::new(),
        time_label: "time t (s)".to_owned(),
        energy_label: format!("energy ({})", unit.replace("m3", "m³")),
        times: times.values.clone(),
        terms,
        residual: LedgerTerm {
            name: format!("{} ({})", balance.name, unit.replace("m3", "m³")),
            ..balance
        },
    };
    Some(ReportPicture::new("ledger", move |format| figure.draw(format)))
}
