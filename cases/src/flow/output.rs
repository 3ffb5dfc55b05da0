//! The sections `[output]` and `[[receiver]]` of a flow.

use super::reader::FlowReader;
use crate::dynamics::output::{CONTOURS_KEY, SNAPSHOT_INTERVAL_KEY, new_ledger_interval_key};
use crate::error::CaseError;
use crate::kind::ModelKind;
use crate::position_checks::PositionDomain;
use crate::receivers::{self, ReceiverDomain, ReceiverPoint, read_receivers};
use crate::schema::{KeyGroup, KeySchema, SchemaScope, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};
use models::flow::RotationKind;
use std::fmt;

/// Name of the picture that shows the magnitude of the velocity perturbation.
const SPEED_NAME: &str = "speed";

/// Schema of the sections `[[receiver]]`.
pub(super) const RECEIVER_SCHEMA: TableSchema = TableSchema::new_list(
    "receiver",
    "receivers: a point, line or grid of points of the box at which fields are recorded",
    &[KeyGroup::new(&[
        receivers::NAME_KEY,
        receivers::new_position_key(
            "point inside the box",
            "[0.05, 0.05]",
            "position at t = 0; the nearest grid point is recorded, which moves with the box",
        ),
        receivers::FIRST_POINT_KEY,
        receivers::LAST_POINT_KEY,
        receivers::POINT_COUNT_KEY,
        KeySchema::new_optional(
            "fields",
            ValueType::AnyOf(field_names),
            "",
            "[\"v1\", \"v2\"]",
            "recorded fields; default: all",
        ),
    ])],
);

/// Schema of the section `[output]`.
pub(super) const OUTPUT_SCHEMA: TableSchema = TableSchema::new_section(
    "output",
    "ledger, snapshots and pictures",
    &[KeyGroup::new(&[
        new_ledger_interval_key(
            "0: 1/200 of the duration",
            "time between two rows of the ledger; 0: 1/200 of the duration",
        ),
        SNAPSHOT_INTERVAL_KEY,
        KeySchema::new_with_default(
            "picture",
            ValueType::OneOf(|scope| {
                [SPEED_NAME.to_owned()].into_iter().chain(field_names(scope)).collect()
            }),
            "",
            "\"speed\"",
            "plotted quantity: speed of the perturbation, or a field",
        ),
        CONTOURS_KEY,
    ])],
);

/// Returns the names of the fields of a flow.
fn field_names(scope: &SchemaScope) -> Vec<String> {
    // Without a known kind: intrinsic spin, whose flows have all fields.
    let rotation = scope.kind.and_then(ModelKind::simulation_rotation);
    let all = FlowQuantity::all_fields(rotation.unwrap_or(RotationKind::IntrinsicSpin));
    all.iter().map(FlowQuantity::to_string).collect()
}

/// A field of a flow, as recorded and plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowQuantity {
    /// Velocity component along axis 0 or 1, m/s.
    Velocity(usize),
    /// Spin ω, rad/s.
    Spin,
    /// Stress angle ψ, rad.
    StressAngle,
    /// Pressure, Pa.
    Pressure,
    /// Shear rate Q_D, the magnitude of the deviatoric deformation rate, 1/s.
    ShearRate,
}

impl FlowQuantity {
    /// Returns all fields of a flow with the material rotation `rotation`, velocities first.
    pub fn all_fields(rotation: RotationKind) -> Vec<Self> {
        let spin = (rotation == RotationKind::IntrinsicSpin).then_some(Self::Spin);
        [Self::Velocity(0), Self::Velocity(1)]
            .into_iter()
            .chain(spin)
            .chain([Self::StressAngle, Self::Pressure, Self::ShearRate])
            .collect()
    }

    /// Returns the name in case files, tables and pictures, in which angles are in degrees.
    pub const fn name(self) -> &'static str {
        match self {
            Self::StressAngle => "psi_deg",
            _ => self.array_name(),
        }
    }

    /// Returns the name in archives and snapshots, in which angles are in radians.
    pub const fn array_name(self) -> &'static str {
        match self {
            Self::Velocity(0) => "v1",
            Self::Velocity(_) => "v2",
            Self::Spin => "w",
            Self::StressAngle => "psi",
            Self::Pressure => "p",
            Self::ShearRate => "shear_rate",
        }
    }

    /// Converts a value in SI units to the unit of [`name`](Self::name): angles from rad to degrees.
    pub fn to_display_unit(self, value: f64) -> f64 {
        if self == Self::StressAngle { value.to_degrees() } else { value }
    }
}

/// Formats the name in case files.
impl fmt::Display for FlowQuantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Output options of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowOutput {
    /// Time between two rows of the ledger and of the spectrum, s; 0 for 1/200 of the duration.
    pub ledger_interval: f64,
    /// Time between two snapshots of all fields, s; 0 for none.
    pub snapshot_interval: f64,
    /// Field plotted in pictures; `None` for the magnitude of the velocity perturbation.
    pub plotted_field: Option<FlowQuantity>,
    /// Contour levels in the unit of the field, empty for no contours; `None` for automatic levels.
    pub contour_levels: Option<Vec<f64>>,
}

impl FlowOutput {
    /// Formats the section `[output]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let resolved = TableWriter::default()
            .with_number("ledger_interval", self.ledger_interval)
            .with_number("snapshot_interval", self.snapshot_interval)
            .with_text("picture", self.plotted_field.map_or(SPEED_NAME, FlowQuantity::name));
        let resolved = match &self.contour_levels {
            Some(contours) => resolved.with_number("contours", contours),
            None => resolved,
        };
        resolved.to_section_toml(&OUTPUT_SCHEMA)
    }
}

impl ReceiverPoint<FlowQuantity> {
    /// Formats the section `[[receiver]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        self.to_table().to_section_toml(&RECEIVER_SCHEMA)
    }
}

fn find_field(among: &[FlowQuantity], name: &str) -> Option<FlowQuantity> {
    among.iter().copied().find(|own| own.name() == name)
}

impl FlowReader<'_> {
    /// Reads the sections `[[receiver]]`.
    pub(super) fn read_receivers(
        &self,
        root: &SectionReader,
    ) -> Result<Vec<ReceiverPoint<FlowQuantity>>, CaseError> {
        let all = FlowQuantity::all_fields(self.rotation);
        let extents = self.grid.lengths.map(|length| [0.0, length]).to_vec();
        let domain = ReceiverDomain {
            schema: &RECEIVER_SCHEMA,
            bounds: extents,
            domain: PositionDomain::Box,
            has_interpolation: false,
        };
        read_receivers(root, &all, |name| find_field(&all, name), &domain)
    }

    /// Reads the section `[output]`.
    pub(super) fn read_output(&self, root: &SectionReader) -> Result<FlowOutput, CaseError> {
        let mut output = FlowOutput {
            ledger_interval: 0.0,
            snapshot_interval: 0.0,
            plotted_field: None,
            contour_levels: None,
        };
        let Some(section) = root.open_section(&OUTPUT_SCHEMA)? else { return Ok(output) };
        output.ledger_interval = section.read_or_default("ledger_interval")?;
        output.snapshot_interval = section.read_or_default("snapshot_interval")?;
        let all = FlowQuantity::all_fields(self.rotation);
        let names: Vec<&str> =
            [SPEED_NAME].into_iter().chain(all.iter().map(|own| own.name())).collect();
        if let Some(name) = section.read_optional_text("picture", &names)? {
            output.plotted_field = find_field(&all, &name);
            if output.plotted_field.is_none() && name != SPEED_NAME {
                return Err(section.unknown_name_error("picture", &name, &names));
            }
        }
        output.contour_levels = section.read_optional("contours")?;
        section.finish()?;
        Ok(output)
    }
}
