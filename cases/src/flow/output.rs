//! The sections `[output]` and `[[receiver]]` of a flow.

use super::reader::Reader;
use crate::dynamics::output::{CONTOURS, SNAPSHOT_INTERVAL, ledger_interval};
use crate::error::CaseError;
use crate::kind::Kind;
use crate::receivers::{self, Domain, Receiver, receivers};
use crate::schema::{Form, Group, Item, Scope, Type};
use crate::section::{Resolved, Section};
use models::flow::RotationKind;
use std::fmt;

/// Name of the picture that shows the magnitude of the velocity perturbation.
const SPEED: &str = "speed";

/// Schema of the sections `[[receiver]]`.
pub(super) const RECEIVER: Form = Form::list(
    "receiver",
    "a point, a line or a grid of points of the box at which fields are recorded",
    &[Group::always(&[
        receivers::NAME,
        receivers::at(
            "a point of the box",
            "[0.05, 0.05]",
            "where it is at the beginning: the nearest point of the box, which moves with it",
        ),
        receivers::FROM,
        receivers::TO,
        receivers::COUNT,
        Item::optional(
            "fields",
            Type::AnyOf(words),
            "",
            "[\"v1\", \"v2\"]",
            "what is recorded; default all",
        ),
    ])],
);

/// Schema of the section `[output]`.
pub(super) const OUTPUT: Form = Form::section(
    "output",
    "what else is recorded, and what pictures show",
    &[Group::always(&[
        ledger_interval(
            "0: a two-hundredth of the duration",
            "time between two lines of the ledger; 0: a two-hundredth of the duration",
        ),
        SNAPSHOT_INTERVAL,
        Item::with_default(
            "picture",
            Type::OneOf(|scope| [SPEED.to_owned()].into_iter().chain(words(scope)).collect()),
            "",
            "\"speed\"",
            "what pictures show: the speed of the perturbation, or a field",
        ),
        CONTOURS,
    ])],
);

/// Returns the names of the fields of a flow.
fn words(scope: &Scope) -> Vec<String> {
    // Without a known kind: intrinsic spin, whose flows have all fields.
    let rotation = scope.kind.and_then(Kind::rotation_in_time);
    let all = Quantity::all(rotation.unwrap_or(RotationKind::IntrinsicSpin));
    all.iter().map(Quantity::to_string).collect()
}

/// A field of a flow, as recorded and plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Velocity component, by axis 0 or 1.
    Velocity(usize),
    /// Spin ω.
    Spin,
    /// Stress angle ψ.
    StressAngle,
    /// Pressure.
    Pressure,
    /// Shear rate Q_D.
    ShearRate,
}

impl Quantity {
    /// Returns all fields of a flow with the material rotation `rotation`, velocities first.
    pub fn all(rotation: RotationKind) -> Vec<Self> {
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
            _ => self.array(),
        }
    }

    /// Returns the name in archives and snapshots, in which angles are in radians.
    pub const fn array(self) -> &'static str {
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
impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Output options of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Time between two rows of the ledger and of the spectrum, s; 0 for 1/200 of the duration.
    pub ledger_interval: f64,
    /// Time between two snapshots of all fields, s; 0 for none.
    pub snapshot_interval: f64,
    /// Field plotted in pictures; `None` for the magnitude of the velocity perturbation.
    pub picture: Option<Quantity>,
    /// Contour levels in the unit of the field; `None` for automatic levels.
    pub contours: Option<Vec<f64>>,
}

impl Output {
    /// Formats the section `[output]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let resolved = Resolved::default()
            .number("ledger_interval", self.ledger_interval)
            .number("snapshot_interval", self.snapshot_interval)
            .text("picture", self.picture.map_or(SPEED, Quantity::name));
        let resolved = match &self.contours {
            Some(contours) => resolved.number("contours", contours),
            None => resolved,
        };
        resolved.under(&OUTPUT)
    }
}

impl Receiver<Quantity> {
    /// Formats the section `[[receiver]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        self.resolved().under(&RECEIVER)
    }
}

fn named(among: &[Quantity], name: &str) -> Option<Quantity> {
    among.iter().copied().find(|own| own.name() == name)
}

impl Reader<'_> {
    /// Reads the sections `[[receiver]]`.
    pub(super) fn receivers(&self, root: &Section) -> Result<Vec<Receiver<Quantity>>, CaseError> {
        let all = Quantity::all(self.rotation);
        let extents = self.grid.lengths.map(|length| [0.0, length]).to_vec();
        let domain = Domain { form: &RECEIVER, extents, whole: "box", interpolates: false };
        receivers(root, &all, |name| named(&all, name), &domain)
    }

    /// Reads the section `[output]`.
    pub(super) fn output(&self, root: &Section) -> Result<Output, CaseError> {
        let mut output =
            Output { ledger_interval: 0.0, snapshot_interval: 0.0, picture: None, contours: None };
        let Some(section) = root.section(&OUTPUT)? else { return Ok(output) };
        output.ledger_interval = section.or_default("ledger_interval")?;
        output.snapshot_interval = section.or_default("snapshot_interval")?;
        let all = Quantity::all(self.rotation);
        let words: Vec<&str> =
            [SPEED].into_iter().chain(all.iter().map(|own| own.name())).collect();
        if let Some(name) = section.optional_text("picture", &words)? {
            output.picture = named(&all, &name);
            if output.picture.is_none() && name != SPEED {
                return Err(section.no_such("picture", &name, &words));
            }
        }
        output.contours = section.optional("contours")?;
        section.finish()?;
        Ok(output)
    }
}
