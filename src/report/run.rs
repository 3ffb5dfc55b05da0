//! Report on the simulation of a solid or a flow.

mod animation;
mod archive;
mod display;
mod flow;
mod fluid;
mod joints;
mod polar;
mod profile;
mod records;
mod snapshot;
mod solid;

pub use animation::{AnimationFrame, FrameConverter, FrameScale};
pub use archive::{create_field_arrays, create_record_arrays, read_fields};
pub use display::DisplayTime;
pub(super) use display::axis_label;
pub use joints::{JointLineScale, create_joint_lines, read_joints};
pub(super) use polar::PolarRaster;
pub use snapshot::{
    create_empty_image, create_image, format_image_index, read_snapshot, snapshot_storage,
    whole_image, write_image,
};
pub use solid::list_drawn_quantities;

use super::format::{case_title, format_count, format_short};
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::flow::FlowQuantity;
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::{
    JointFace, JointSummary, OutputFields, RunRecords, RunResult, SimulationWarning, quantity_unit,
};
use std::borrow::Cow;
use std::fmt::Write as _;

impl Report for RunResult {
    const NAME: &'static str = "run";

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\n", case_title(case));
        let time = format_short(self.final_time);
        let _ = match self.time_step {
            Some(step) => {
                writeln!(
                    text,
                    "{} of {} s: t = {time} s",
                    format_count(self.step_count, "step"),
                    format_short(step)
                )
            }
            None => writeln!(text, "{}: t = {time} s", format_count(self.step_count, "step")),
        };
        if let Some(verdict) = &self.solid_verdict {
            let _ = writeln!(text, "verdict of the analysis: {verdict}");
        }
        if let Some(stopped) = &self.stop_report {
            let _ = writeln!(text, "stopped: {stopped}");
        }
        if let Some(strain) = self.large_strain {
            let _ = writeln!(text, "warning: {}", SimulationWarning::LargeStrain { strain });
        }
        let terms = if self.time_step.is_some() { SOLID_LEDGER_TERMS } else { FLOW_LEDGER_TERMS };
        let unit = self.final_ledger.unit.replace("m3", "m³");
        for (name, description) in terms {
            let Some(value) = self.final_ledger.term(name) else { continue };
            // These terms are zero in most runs.
            let is_special = ["joint_", "fluid_", "initial_stress_"]
                .iter()
                .any(|prefix| name.starts_with(prefix));
            if is_special && value == 0.0 {
                continue;
            }
            let unit: &str = if *name == "power" { "W/m³" } else { &unit };
            write_value_line(&mut text, description, value, unit);
        }
        if let Some(joints) = &self.joint_summary {
            write_joints(&mut text, joints);
        }
        if let Some(flow) = &case.flow_run {
            self.write_value_ranges(&FlowQuantity::all_fields(flow.rotation), &mut text);
        }
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        match (self.is_part, case.time_domain_run()?) {
            (true, TimeDomainRun::Solid(_)) => {
                Ok(solid::create_record_pictures(case, &self.records))
            }
            _ => create_pictures(case, &self.fields, &self.records),
        }
    }

    /// Creates the archives, and the table of joints; the other CSV tables are written row by row during the run.
    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let mut all = Vec::new();
        if self.has_field_values && !self.is_part {
            let fields = create_field_arrays(Cow::Borrowed(&self.fields));
            all.push(("fields.npz", DataFile::Arrays(fields)));
        }
        if let Some(receivers) = &self.records.receivers {
            let arrays = create_record_arrays(Cow::Borrowed(receivers));
            all.push(("receivers.npz", DataFile::Arrays(arrays)));
        }
        if !self.is_part {
            all.extend(create_joint_tables(&self.fields.joint_faces, self.fields.time)?);
        }
        Ok(all)
    }
}

/// Creates the files of the state of all joints at a time, s; none without joints.
///
/// # Errors
/// A coordinate or the time is not finite.
pub fn create_joint_tables(
    joints: &[JointFace],
    time: f64,
) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
    if joints.is_empty() {
        return Ok(Vec::new());
    }
    let lines = create_joint_lines(joints, time)?;
    Ok(vec![
        ("joints.csv", joints::create_table(joints)),
        ("joints.npz", joints::create_arrays(joints)),
        ("joints.vtp", DataFile::Encoded(lines.to_bytes())),
    ])
}

/// Terms of the energy ledger of a solid with their descriptions, in the order of the report.
const SOLID_LEDGER_TERMS: &[(&str, &str)] = &[
    ("at_start", "initial energy"),
    ("kinetic", "kinetic energy"),
    ("stored", "stored energy"),
    ("boundary_work", "work of the boundaries"),
    ("source_work", "work of sources and gravity"),
    ("initial_stress_work", "work of the initial stress"),
    ("plastic_dissipation", "plastic dissipation"),
    ("joint_kinetic", "kinetic energy of joints"),
    ("joint_stored", "stored energy of joints"),
    ("fluid_kinetic", "kinetic energy of the fluid"),
    ("fluid_stored", "energy of the fluid pressure"),
    ("joint_plastic_dissipation", "plastic dissipation of joints"),
    ("joint_viscous_dissipation", "viscous dissipation of joints"),
    ("joint_released_energy", "energy released by open cracks"),
    ("joint_fracture_energy", "energy lost at fracture"),
    ("fluid_dissipation", "numerical dissipation of the fluid"),
    ("numerical_dissipation", "numerical dissipation"),
    ("residual", "residual: rounding"),
    ("balance", "balance: numerical dissipation"),
];

/// Terms of the energy ledger of a flow with their descriptions, in the order of the report.
const FLOW_LEDGER_TERMS: &[(&str, &str)] = &[
    ("at_start", "initial kinetic energy"),
    ("kinetic", "kinetic energy of the perturbation"),
    ("background", "energy from the mean flow"),
    ("stress", "work of the stress"),
    ("balance", "residual: time-step error"),
    ("power", "internal power"),
];

/// Returns the description of a term of a ledger; `None` for an unknown name. Runs of earlier versions of the program
/// have other names of some terms.
fn describe_ledger_term<'a>(terms: &[(&str, &'a str)], name: &str) -> Option<&'a str> {
    let name = match name {
        "sides" => "boundary_work",
        "sources" => "source_work",
        "initial_stress" => "initial_stress_work",
        "plastic" => "plastic_dissipation",
        "numerical" => "numerical_dissipation",
        name => name,
    };
    terms.iter().find(|term| term.0 == name).map(|term| term.1)
}

fn write_value_line(text: &mut String, name: &str, value: f64, unit: &str) {
    let _ = writeln!(text, "  {name:<34} {:>11} {unit}", format_short(value));
}

/// Writes the numbers of slipped, open and broken faces of joints, with their extreme values and the times of first
/// events.
fn write_joints(text: &mut String, joints: &JointSummary) {
    let JointSummary {
        face_count: faces,
        slipped_count: slipped,
        open_count: open,
        broken_count: broken,
        ..
    } = *joints;
    let _ = writeln!(
        text,
        "  faces of joints: {faces}; {slipped} slipped, {open} open, {broken} broken"
    );
    let values = [
        ("largest slip", Some(joints.max_slip).filter(|slip| *slip > 0.0), "m"),
        ("largest opening", Some(joints.max_opening).filter(|opening| *opening > 0.0), "m"),
        ("first slip", joints.first_slip_time, "s"),
        ("first fracture", joints.first_fracture_time, "s"),
    ];
    for (name, value, unit) in values {
        if let Some(value) = value {
            write_value_line(text, name, value, unit);
        }
    }
}

impl RunResult {
    fn write_value_ranges(&self, shown: &[FlowQuantity], text: &mut String) {
        for (own, quantity) in shown.iter().zip(&self.fields.quantities) {
            let [least, greatest] = compute_value_range(&quantity.values);
            let unit = quantity_unit(own.name());
            write_value_line(text, &format!("minimum {own}"), own.to_display_unit(least), unit);
            write_value_line(text, &format!("maximum {own}"), own.to_display_unit(greatest), unit);
        }
    }
}

/// Returns the minimum and the maximum of `values`.
fn compute_value_range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(*value), high.max(*value)]
    })
}

/// Creates all pictures of a run except the animation of its snapshots.
///
/// # Errors
/// The case has no simulation.
pub fn create_pictures(
    case: &Case,
    fields: &OutputFields,
    records: &RunRecords,
) -> Result<Vec<ReportPicture>, Error> {
    Ok(match case.time_domain_run()? {
        TimeDomainRun::Solid(solid_run) => solid::create_pictures(case, solid_run, fields, records),
        TimeDomainRun::Flow(run) => flow::create_pictures(case, run, fields, records),
    })
}
