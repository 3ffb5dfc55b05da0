//! Result of a simulation: final fields, energy ledger and recorded time series.

use super::{JointFace, JointSummary, SimulationWarning, StopReport};
use crate::study::SolidVerdict;
use dynamics::decomposition::communicator::Communicator;
use serde::{Serialize, Serializer};

/// Result of a simulation of a solid or a flow; members that exist only for the other kind are `None`.
#[derive(Clone, Debug, Serialize)]
pub struct RunResult {
    /// Title of the case.
    pub title: String,
    /// Kind of the model; flows only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<&'static str>,
    /// Verdict of the analysis on a solid; `None` for flows, and for granular and porous media.
    #[serde(flatten)]
    pub solid_verdict: Option<SolidVerdict>,
    /// Cells of a solid, or points of a flow, along each axis.
    #[serde(rename = "cells")]
    pub cell_counts: Vec<usize>,
    /// Initial edge lengths of the box, m; flows only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "length")]
    pub box_lengths: Option<[f64; 2]>,
    /// Number of time steps done.
    #[serde(rename = "steps")]
    pub step_count: usize,
    /// Constant time step Δt, s; solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "step")]
    pub time_step: Option<f64>,
    /// Simulated time reached, s.
    #[serde(rename = "time")]
    pub final_time: f64,
    /// Floating-point precision of the solver, `f64` or `f32`; solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<&'static str>,
    /// Reconstruction of the scheme, which determines its order; solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "order")]
    pub reconstruction: Option<&'static str>,
    /// Velocity gradient of the mean flow, 1/s; flows only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_gradient: Option<[[f64; 2]; 2]>,
    /// Final deformation gradient F of the box, which maps initial positions y to Fy; flows only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "deformation")]
    pub deformation_gradient: Option<[[f64; 2]; 2]>,
    /// Final fields; only the names of their quantities are serialised.
    #[serde(serialize_with = "serialize_quantity_names")]
    pub fields: OutputFields,
    /// Last row of the energy ledger: final energies, work and dissipation since the start, and for flows the internal
    /// power.
    #[serde(rename = "ledger")]
    pub final_ledger: FinalLedger,
    /// Numbers of slipped, open and broken faces of joints; blocky media with joints only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "joints")]
    pub joint_summary: Option<JointSummary>,
    /// Estimate of the largest strain at the end, where it is larger than 1, so that equations of small strains do not hold;
    /// solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub large_strain: Option<f64>,
    /// Receivers of the simulation with their positions.
    pub receivers: Vec<RunReceiver>,
    /// Reason why the run was stopped before its duration; `None` if complete.
    #[serde(rename = "stopped", serialize_with = "serialize_stop_report")]
    pub stop_report: Option<StopReport>,
    /// Recorded time series: receivers, energy ledger, spectrum, snapshots.
    #[serde(skip)]
    pub records: RunRecords,
    /// Whether the fields are those of the cells of one of several ranks.
    #[serde(skip)]
    pub is_part: bool,
    /// Whether the fields have values; a recorder may have written them instead.
    #[serde(skip)]
    pub has_field_values: bool,
}

fn serialize_quantity_names<S: Serializer>(
    fields: &OutputFields,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(fields.quantities.iter().map(|own| &own.name))
}

fn serialize_stop_report<S: Serializer>(
    stop_report: &Option<StopReport>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    stop_report.as_ref().map(ToString::to_string).serialize(serializer)
}

/// Output fields at one time, serialised with all values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OutputFields {
    /// Simulated time of the fields, s.
    pub time: f64,
    /// Coordinates along each axis, m: cell centres of a solid, or points of the initial box of a flow.
    pub coordinates: Vec<Vec<f64>>,
    /// Deformation gradient F of the box of a flow, which maps initial positions y to Fy.
    #[serde(rename = "deformation")]
    pub deformation_gradient: Option<[[f64; 2]; 2]>,
    /// Fields, then time integrals of fields, in SI units.
    pub quantities: Vec<FieldQuantity>,
    /// Plastic dissipation by cell, J/m³; empty for elastic solids and flows.
    #[serde(rename = "dissipation")]
    pub plastic_dissipation: Vec<f64>,
    /// Index of the region of each cell of a solid, or of the material of its block, from 0; empty for a single
    /// material.
    #[serde(rename = "regions")]
    pub region_indices: Vec<u16>,
    /// Faces of the joints of a blocky medium, by row of cells; empty without joints.
    #[serde(rename = "joints")]
    pub joint_faces: Vec<JointFace>,
}

impl OutputFields {
    /// Returns the values of the quantity `name`, first axis fastest; `None` if there is no such quantity.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        Some(&self.quantities.iter().find(|own| own.name == name)?.values)
    }
}

/// Output quantity: a field or the time integral of a field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldQuantity {
    /// Name of the quantity in files: `v1`, `sigma12`, …
    pub name: String,
    /// SI unit of the values.
    pub unit: &'static str,
    /// Values by cell or point, first axis fastest.
    pub values: Vec<f64>,
}

impl FieldQuantity {
    /// Creates a quantity with the unit that its name determines.
    pub fn new(name: String, values: Vec<f64>) -> Self {
        Self { unit: quantity_unit(&name), name, values }
    }
}

/// Returns the unit of an output quantity by its name in files; J/m³, the unit of the plastic dissipation, for any
/// unknown name.
pub fn quantity_unit(name: &str) -> &'static str {
    match name.trim_end_matches(|c: char| c.is_ascii_digit()) {
        "v" => "m/s",
        "w" => "rad/s",
        "sigma" | "excess_stress" | "spring_stress" => "Pa",
        "volumetric_strain" | "pore_closure" | "porosity" | "viscous_strain" | "plastic_strain" => {
            "1"
        }
        "m" => "N/m",
        "u" => "m",
        "phi" | "psi" => "rad",
        "psi_deg" => "deg",
        "p" | "pressure" => "Pa",
        "slip" | "opening" => "m",
        "shear_rate" => "1/s",
        _ => "J/m3",
    }
}

/// Last row of the energy ledger: terms by name, all in `unit` except for the internal power of flows, W/m³.
#[derive(Clone, Debug, PartialEq)]
pub struct FinalLedger {
    /// Unit of the energies in the ledger.
    pub unit: &'static str,
    /// Names and values of the terms of the ledger.
    pub terms: Vec<(&'static str, f64)>,
}

impl FinalLedger {
    /// Returns the residual of the ledger of a solid relative to its largest term; `None` for flows and for ledgers
    /// without numerical dissipation, whose balance includes that dissipation.
    pub fn relative_residual(&self) -> Option<f64> {
        let residual = self.term("residual")?.abs();
        let greatest = self.terms.iter().map(|own| own.1.abs()).fold(0.0, f64::max);
        Some(if greatest > 0.0 { residual / greatest } else { 0.0 })
    }

    /// Returns the term of that name; `None` if the ledger has no such term.
    pub fn term(&self, name: &str) -> Option<f64> {
        self.terms.iter().find(|term| term.0 == name).map(|term| term.1)
    }
}

impl RunResult {
    /// Replaces the numbers that this rank has found in its cells by those of all ranks, which call it together.
    pub(super) fn combine_ranks(&mut self, communicator: &dyn Communicator) {
        let encode = |summary: Option<JointSummary>, strain: Option<f64>| {
            let numbers = summary.map_or([0.0; 8], JointSummary::to_numbers);
            let all = numbers.into_iter().chain([strain.unwrap_or(0.0)]);
            all.flat_map(f64::to_le_bytes).collect::<Vec<u8>>()
        };
        let decode = |message: &[u8]| {
            let numbers: Vec<f64> =
                message.as_chunks().0.iter().map(|own| f64::from_le_bytes(*own)).collect();
            let (numbers, strain) =
                numbers.as_slice().split_first_chunk().unwrap_or((&[0.0; 8], &[]));
            let strain = strain.first().copied().filter(|strain| *strain > 0.0);
            (JointSummary::from_numbers(numbers), strain)
        };
        let (mut summary, mut strain) = (None, None);
        let own = encode(self.joint_summary, self.large_strain);
        communicator.gather(own, &mut |_, message| {
            let other = decode(&message);
            summary = [summary, other.0].into_iter().flatten().reduce(JointSummary::merge);
            strain = [strain, other.1].into_iter().flatten().reduce(f64::max);
        });
        (self.joint_summary, self.large_strain) =
            decode(&communicator.broadcast(encode(summary, strain)));
    }

    /// Returns the warnings that follow from the result.
    pub fn warnings(&self) -> Vec<SimulationWarning> {
        let strain = self.large_strain.map(|strain| SimulationWarning::LargeStrain { strain });
        self.residual_warning().into_iter().chain(strain).collect()
    }

    /// Returns a warning if the residual of the ledger exceeds rounding: 10⁻⁶ of its largest term in double precision,
    /// 10⁻² in single precision.
    pub fn residual_warning(&self) -> Option<SimulationWarning> {
        let rounding = if self.precision == Some("f32") { 1e-2 } else { 1e-6 };
        let part = self.final_ledger.relative_residual().filter(|part| *part > rounding)?;
        Some(SimulationWarning::LedgerResidual { relative_residual: part })
    }
}

impl Serialize for FinalLedger {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let unit = ("unit", serde_json::Value::from(self.unit));
        let terms = self.terms.iter().map(|(name, value)| (*name, (*value).into()));
        serializer.collect_map(std::iter::once(unit).chain(terms))
    }
}

/// Receiver: a point at which the state was recorded.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunReceiver {
    /// Name of the receiver.
    pub name: String,
    /// Position requested in the case, m.
    #[serde(rename = "at")]
    pub position: Vec<f64>,
    /// Centre of the cell that contains the receiver, m; solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "cell")]
    pub cell_centre: Option<Vec<f64>>,
    /// Name of the interpolation between cells; solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<&'static str>,
    /// Recorded grid point of the initial box, m; flows only.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[serde(rename = "point")]
    pub grid_point: Option<[f64; 2]>,
}

/// Recorded time series of a simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunRecords {
    /// Receiver records: `time`, then `NAME.QUANTITY`, stress angles of flows in degrees; `None` without receivers.
    pub receivers: Option<RecordTable>,
    /// Table of the energy ledger.
    pub ledger: RecordTable,
    /// Energy spectrum by shells of mode numbers; flows only.
    pub spectrum: Option<RecordTable>,
    /// Snapshots of the case in order of time; empty unless kept in memory.
    pub snapshots: Vec<OutputFields>,
}

/// Table with columns of equal length.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RecordTable {
    /// Columns; the first is the time.
    pub columns: Vec<RecordColumn>,
}

/// Column of a table of records.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordColumn {
    /// Name of the column.
    pub name: String,
    /// Unit of the values of the column.
    pub unit: &'static str,
    /// Values of the column by row.
    pub values: Vec<f64>,
}

impl RecordTable {
    /// Returns the values of the column `name`; `None` if there is no such column.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        Some(&self.columns.iter().find(|column| column.name == name)?.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates the result of a run of a solid whose ledger has the given terms, J.
    fn result_with_ledger(precision: &'static str, terms: &[(&'static str, f64)]) -> RunResult {
        RunResult {
            title: String::new(),
            model: None,
            solid_verdict: None,
            cell_counts: vec![1, 1],
            box_lengths: None,
            step_count: 1,
            time_step: Some(1.0),
            final_time: 1.0,
            precision: Some(precision),
            reconstruction: None,
            velocity_gradient: None,
            deformation_gradient: None,
            fields: OutputFields::default(),
            final_ledger: FinalLedger { unit: "J", terms: terms.to_vec() },
            large_strain: None,
            joint_summary: None,
            receivers: Vec::new(),
            stop_report: None,
            is_part: false,
            has_field_values: true,
            records: RunRecords::default(),
        }
    }

    /// Verifies that a residual is reported if it exceeds 10⁻⁶ of the largest term (10⁻² in single precision), whatever
    /// its sign, and that ledgers with rounding errors, without energy or without a residual give no warning.
    #[test]
    fn residual_above_rounding_is_reported() {
        let warning = |precision, residual: f64| {
            let terms = [("kinetic", 1.0), ("boundary_work", -4.0), ("residual", residual)];
            result_with_ledger(precision, &terms).residual_warning()
        };
        for (precision, residual) in
            [("f64", 5e-6_f64), ("f64", -5e-6), ("f64", 1.0), ("f32", 5e-2), ("f32", -5e-2)]
        {
            let relative_residual = residual.abs() / 4.0;
            let expected = Some(SimulationWarning::LedgerResidual { relative_residual });
            assert_eq!(warning(precision, residual), expected, "{precision} {residual}");
        }
        for (precision, residual) in
            [("f64", 3e-6), ("f64", -1e-15), ("f64", 0.0), ("f32", 3e-2), ("f32", -1e-6)]
        {
            assert_eq!(warning(precision, residual), None, "{precision} {residual}");
        }
        let still = [("kinetic", 0.0), ("residual", 0.0)];
        assert_eq!(result_with_ledger("f64", &still).residual_warning(), None);
        // Without numerical dissipation as a term, the balance of a ledger includes that dissipation.
        let totals = [("kinetic", 1.0), ("balance", -0.5)];
        assert_eq!(result_with_ledger("f64", &totals).residual_warning(), None);
    }
}
