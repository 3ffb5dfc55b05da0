//! Pictures of what was recorded in the course of a run.

use super::words::label;
use crate::case::Case;
use crate::report::Picture;
use crate::report::format::case_title;
use crate::study::simulate::Table;
use figures::{LedgerFigure, LedgerTerm, SeismogramFigure, SeismogramPanel, Trace};

/// Receivers that a picture names: of many some, evenly spread from the first to the last.
pub(super) fn some_of(count: usize) -> impl Iterator<Item = usize> {
    /// As many as a legend tells apart.
    const MOST: usize = 8;
    let named = count.min(MOST);
    (0..named).map(move |index| index * (count - 1) / (named - 1).max(1))
}

/// What the receivers saw: a panel for each quantity that one of them recorded.
pub(super) fn seismograms(case: &Case, table: &Table) -> Picture {
    /// Panels of a page; of more quantities the first.
    const MOST: usize = 8;
    let columns = &table.columns;
    let mut receivers: Vec<&str> =
        columns.iter().filter_map(|own| Some(own.name.rsplit_once('.')?.0)).collect();
    receivers.dedup();
    let drawn: Vec<&str> = some_of(receivers.len()).map(|index| receivers[index]).collect();
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
    let all = panels.len();
    panels.truncate(MOST);
    let figure = SeismogramFigure {
        title: case_title(case),
        subtitle: match (all > MOST, receivers.len() > drawn.len()) {
            (true, false) => format!("the first {MOST} of {all} quantities in receivers.csv"),
            (false, true) => format!("{} of {} receivers", drawn.len(), receivers.len()),
            (true, true) => format!(
                "the first {MOST} of {all} quantities in receivers.csv, {} of {} receivers",
                drawn.len(),
                receivers.len()
            ),
            (false, false) => String::new(),
        },
        time_label: "time t, s".to_owned(),
        panels: panels
            .into_iter()
            .map(|(name, traces)| SeismogramPanel { label: label(&name), traces })
            .collect(),
        times: columns.first().map(|column| column.values.clone()).unwrap_or_default(),
    };
    Picture::new("seismograms", move |format| figure.draw(format))
}

/// Where the energy was, and what became of it: columns of the ledger that are energies, the last one what is left
/// over, by their `words`.
pub(super) fn ledger(
    case: &Case,
    table: &Table,
    words: impl Fn(&str) -> &'static str,
) -> Option<Picture> {
    let (times, columns) = table.columns.split_first()?;
    let unit = columns.first()?.unit;
    let mut terms: Vec<LedgerTerm> = columns
        .iter()
        .filter(|column| column.unit == unit)
        .map(|own| LedgerTerm { name: words(&own.name).to_owned(), values: own.values.clone() })
        .collect();
    let balance = terms.pop()?;
    terms.retain(|term| term.values.iter().any(|value| *value != 0.0));
    let figure = LedgerFigure {
        title: case_title(case),
        subtitle: String::new(),
        time_label: "time t, s".to_owned(),
        label: format!("energy, {}", unit.replace("m3", "m³")),
        times: times.values.clone(),
        terms,
        balance,
    };
    Some(Picture::new("ledger", move |format| figure.draw(format)))
}
