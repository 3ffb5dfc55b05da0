//! The value of a simulation.

use super::{Stopped, Warning};
use serde::{Serialize, Serializer};

/// A run in time. What is not of its kind, solid or flow, is absent.
#[derive(Clone, Debug, Serialize)]
pub struct RunResult {
    /// Title of the case.
    pub title: String,
    /// Kind of model; of flows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<&'static str>,
    /// Cells of a solid, or points of a flow, along each axis.
    pub cells: Vec<usize>,
    /// Edges of the box at the beginning, m; of flows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<[f64; 2]>,
    /// Steps done.
    pub steps: usize,
    /// Δt, s; of solids, whose steps are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// The time that the run came to, s.
    pub time: f64,
    /// Precision of the solver; of solids.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<&'static str>,
    /// Order of the scheme; of solids.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<&'static str>,
    /// Velocity gradient of the mean flow, 1/s; of flows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity_gradient: Option<[[f64; 2]; 2]>,
    /// Final deformation gradient F of the box: its point y is at Fy; of flows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deformation: Option<[[f64; 2]; 2]>,
    /// All fields at the end; in the report their names.
    #[serde(serialize_with = "names")]
    pub fields: Fields,
    /// The energy at the end, and what became of it.
    pub ledger: FinalLedger,
    /// Receivers of the simulation with their positions.
    pub receivers: Vec<Receiver>,
    /// Why the run ended before its duration was over, if it did.
    #[serde(serialize_with = "words")]
    pub stopped: Option<Stopped>,
    /// Records of the simulation.
    #[serde(skip)]
    pub records: Records,
}

fn names<S: Serializer>(fields: &Fields, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(fields.quantities.iter().map(|own| &own.name))
}

fn words<S: Serializer>(stopped: &Option<Stopped>, serializer: S) -> Result<S::Ok, S::Error> {
    stopped.as_ref().map(ToString::to_string).serialize(serializer)
}

/// All that is seen of a state. Serialised with all values, unlike in the report of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Fields {
    /// s.
    pub time: f64,
    /// Along each axis, the middles of cells or, of flows, points of the box at the beginning, m.
    pub coordinates: Vec<Vec<f64>>,
    /// Deformation gradient F of the box of a flow: its point y is at Fy.
    pub deformation: Option<[[f64; 2]; 2]>,
    /// Fields, then integrals in time, in SI units.
    pub quantities: Vec<Quantity>,
    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    pub dissipation: Vec<f64>,
    /// The region of each cell of a solid; empty without regions.
    pub regions: Vec<u16>,
}

impl Fields {
    /// Values of a quantity, the first axis running fastest.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        Some(&self.quantities.iter().find(|own| own.name == name)?.values)
    }
}

/// A field, or its integral in time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// `v1`, `sigma12`, …
    pub name: String,
    /// SI.
    pub unit: &'static str,
    /// By cell or point, the first axis running fastest.
    pub values: Vec<f64>,
}

impl Quantity {
    /// A column with the unit that follows from its name.
    pub fn new(name: String, values: Vec<f64>) -> Self {
        Self { unit: unit_of(&name), name, values }
    }
}

/// The unit of what is shown, by its name in files.
pub fn unit_of(name: &str) -> &'static str {
    match name.trim_end_matches(|c: char| c.is_ascii_digit()) {
        "v" => "m/s",
        "w" => "rad/s",
        "sigma" => "Pa",
        "m" => "N/m",
        "u" => "m",
        "phi" | "psi" => "rad",
        "psi_deg" => "deg",
        "p" => "Pa",
        "shear_rate" => "1/s",
        _ => "J/m3",
    }
}

/// The last row of the ledger: terms by name, in one unit but for the internal power of flows, W/m³.
#[derive(Clone, Debug, PartialEq)]
pub struct FinalLedger {
    /// Unit of the energies.
    pub unit: &'static str,
    /// Names and values.
    pub terms: Vec<(&'static str, f64)>,
}

impl FinalLedger {
    /// What the full ledger of a solid leaves over, relative to the greatest of its terms; `None` for a light one, which
    /// leaves over what the scheme dissipates, and of flows.
    pub fn remainder(&self) -> Option<f64> {
        let residual = self.get("residual")?.abs();
        let greatest = self.terms.iter().map(|own| own.1.abs()).fold(0.0, f64::max);
        Some(if greatest > 0.0 { residual / greatest } else { 0.0 })
    }

    /// The term of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.terms.iter().find(|term| term.0 == name).map(|term| term.1)
    }
}

impl RunResult {
    /// What is not to be believed of the result.
    pub fn warning(&self) -> Option<Warning> {
        let rounding = if self.precision == Some("f32") { 1e-2 } else { 1e-6 };
        let part = self.ledger.remainder().filter(|part| *part > rounding)?;
        Some(Warning::Remainder { part })
    }
}

impl Serialize for FinalLedger {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let unit = ("unit", serde_json::Value::from(self.unit));
        let terms = self.terms.iter().map(|(name, value)| (*name, (*value).into()));
        serializer.collect_map(std::iter::once(unit).chain(terms))
    }
}

/// A point at which the state was recorded.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Receiver {
    /// Its name.
    pub name: String,
    /// Requested position, m.
    pub at: Vec<f64>,
    /// The centre of the cell that holds it, m; of solids.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell: Option<Vec<f64>>,
    /// Interpolation between cells; of solids.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<&'static str>,
    /// The point of the box that is recorded, m; of flows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<[f64; 2]>,
}

/// Records of a simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Records {
    /// Seismograms: `time`, then `NAME.QUANTITY`, angles in degrees; none without receivers.
    pub receivers: Option<Table>,
    /// The ledger of energy.
    pub ledger: Table,
    /// Energies of the shells of modes; of flows.
    pub spectrum: Option<Table>,
    /// The snapshots that the case asks for, where they are kept in memory.
    pub snapshots: Vec<Fields>,
}

/// Columns of equal length.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// The first one is the time.
    pub columns: Vec<Column>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// By row.
    pub values: Vec<f64>,
}

impl Table {
    /// The values of a column.
    pub fn get(&self, name: &str) -> Option<&[f64]> {
        Some(&self.columns.iter().find(|column| column.name == name)?.values)
    }
}
