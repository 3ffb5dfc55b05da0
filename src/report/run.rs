//! Report on the simulation of a solid or a flow.

mod animation;
mod archive;
mod flow;
mod records;
mod snapshot;
mod solid;
mod words;

pub use animation::{Frame, Frames};
pub use archive::read_fields;
pub use snapshot::image;
pub use words::Time;

use super::format::{case_title, short};
use super::{Picture, Report};
use crate::Error;
use crate::case::flow::Quantity;
use crate::case::{Case, InTime};
use crate::study::simulate::{Fields, Records, RunResult, unit_of};
use std::fmt::Write as _;

impl Report for RunResult {
    const NAME: &'static str = "run";

    fn text(&self, case: &Case) -> String {
        let mut text = format!("{}\n", case_title(case));
        let time = short(self.time);
        let _ = match self.step {
            Some(step) => writeln!(text, "{} steps of {} s: t = {time} s", self.steps, short(step)),
            None => writeln!(text, "{} steps: t = {time} s", self.steps),
        };
        if let Some(stopped) = &self.stopped {
            let _ = writeln!(text, "stopped: {stopped}");
        }
        let terms = if self.step.is_some() { SOLID_TERMS } else { FLOW_TERMS };
        let unit = self.ledger.unit.replace("m3", "m³");
        for (name, words) in terms {
            let Some(value) = self.ledger.get(name) else { continue };
            if *name == "initial_stress" && value == 0.0 {
                continue;
            }
            let unit: &str = if *name == "power" { "W/m³" } else { &unit };
            write_line(&mut text, words, value, unit);
        }
        if let Some(flow) = &case.flow {
            self.write_ranges(&Quantity::all(flow.rotation), &mut text);
        }
        text
    }

    fn pictures(&self, case: &Case) -> Result<Vec<Picture>, Error> {
        pictures(case, &self.fields, &self.records)
    }

    /// Renders the archives; the CSV tables are written row by row during the run.
    fn tables(&self, _case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        let mut all = vec![("fields.npz", archive::fields(&self.fields)?)];
        if let Some(receivers) = &self.records.receivers {
            all.push(("receivers.npz", archive::table(receivers)?));
        }
        Ok(all)
    }
}

/// Terms of the energy ledger of a solid with their descriptions, in the order of the report.
const SOLID_TERMS: &[(&str, &str)] = &[
    ("at_start", "energy at the start"),
    ("kinetic", "kinetic energy"),
    ("stored", "stored energy"),
    ("sides", "work at the sides"),
    ("sources", "work of sources and weight"),
    ("initial_stress", "released by the initial stress"),
    ("plastic", "plastic dissipation"),
    ("numerical", "dissipation of the scheme"),
    ("residual", "left over (rounding)"),
    ("balance", "balance (the scheme's, not counted)"),
];

/// Terms of the energy ledger of a flow with their descriptions, in the order of the report.
const FLOW_TERMS: &[(&str, &str)] = &[
    ("at_start", "kinetic energy at the start"),
    ("kinetic", "kinetic energy"),
    ("background", "given by the mean flow"),
    ("stress", "work of the stress"),
    ("balance", "left over (error of the steps)"),
    ("power", "internal power"),
];

fn write_line(text: &mut String, name: &str, value: f64, unit: &str) {
    let _ = writeln!(text, "  {name:<34} {:>11} {unit}", short(value));
}

impl RunResult {
    fn write_ranges(&self, shown: &[Quantity], text: &mut String) {
        for (own, quantity) in shown.iter().zip(&self.fields.quantities) {
            let [least, greatest] = range(&quantity.values);
            let unit = unit_of(own.name());
            write_line(text, &format!("least {own}"), own.to_display_unit(least), unit);
            write_line(text, &format!("greatest {own}"), own.to_display_unit(greatest), unit);
        }
    }
}

/// Returns the minimum and maximum of values.
fn range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(*value), high.max(*value)]
    })
}

/// Creates all pictures of a run except the animation of its snapshots.
///
/// # Errors
/// The case has no simulation.
pub fn pictures(case: &Case, fields: &Fields, records: &Records) -> Result<Vec<Picture>, Error> {
    Ok(match case.in_time()? {
        InTime::Solid(dynamics) => solid::pictures(case, dynamics, fields, records),
        InTime::Flow(run) => flow::pictures(case, run, fields, records),
    })
}
