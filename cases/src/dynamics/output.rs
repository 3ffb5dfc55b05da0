//! The sections `[output]` and `[[receiver]]` of a solid.

use super::component::{Component, components, names};
use super::reader::Reader;
use super::time;
use crate::error::CaseError;
use crate::receivers::{self, Domain, Interpolation, Receiver, receivers};
use crate::schema::{Form, Group, Item, Range, Scope, Type};
use crate::section::{Resolved, Section};
use std::fmt;

/// Builds the key `ledger_interval`, the time between two rows of the energy ledger; `zero` describes the meaning of 0
/// in messages.
pub(crate) const fn ledger_interval(zero: &'static str, meaning: &'static str) -> Item {
    Item::with_default("ledger_interval", Type::Number(Range::NotNegative), "s", "0.0", meaning)
        .note(zero)
}

/// Key `snapshot_interval`: time between two snapshots.
pub(crate) const SNAPSHOT_INTERVAL: Item = Item::with_default(
    "snapshot_interval",
    Type::Number(Range::NotNegative),
    "s",
    "0.0",
    "time between two snapshots of all fields, for ParaView and an animation; 0: none",
)
.note("0: none");

/// Key `contours`: contour levels of a picture.
pub(crate) const CONTOURS: Item = Item::optional(
    "contours",
    Type::List(0, Range::Finite),
    "the unit of the picture",
    "[0.01, 0.02]",
    "lines of equal value; default: at ¼ and ½ of the greatest magnitude of what has a sign; []: none",
)
.note("lines of equal value");

/// Schema of the sections `[[receiver]]`.
pub(super) const RECEIVER: Form = Form::list(
    "receiver",
    "a point, a line or a grid of points at which the state is recorded",
    &[Group::always(&[
        receivers::NAME,
        receivers::at(
            "a point of the grid",
            "[40.0, 0.0]",
            "any point of the grid, on sides as well",
        ),
        receivers::FROM,
        receivers::TO,
        receivers::COUNT,
        Item::optional(
            "fields",
            Type::AnyOf(|scope| {
                let mut words = names(&components(scope));
                words.extend(all_integrals(scope));
                words
            }),
            "",
            "[\"v1\", \"v2\"]",
            "what is recorded; default all components, and what integrals of [output] names",
        ),
        Item::with_default(
            "interpolation",
            Type::OneOf(|_| time::names(Interpolation::ALL, Interpolation::name)),
            "",
            "\"cubic\"",
            "between cells; none: the cell that holds the point",
        ),
    ])],
);

/// Schema of the section `[output]`.
pub(super) const OUTPUT: Form = Form::section(
    "output",
    "what else is recorded, and what pictures show",
    &[Group::always(&[
        ledger_interval(
            "0: at most 1000 lines",
            "time between two lines of the energy ledger; 0: at most 1000 lines",
        ),
        SNAPSHOT_INTERVAL,
        Item::optional(
            "integrals",
            Type::AnyOf(all_integrals),
            "",
            "[]",
            "displacements and rotations to be kept: \"u1\", \"phi3\"; default none",
        ),
        Item::with_default(
            "picture",
            Type::OneOf(|scope| {
                let mut words = vec!["speed".to_owned()];
                words.extend(names(&components(scope)));
                words.extend(all_integrals(scope));
                words.push("dissipation".to_owned());
                words
            }),
            "",
            "\"speed\"",
            "what pictures show: speed, a component, one of integrals, or dissipation",
        ),
        CONTOURS,
    ])],
);

/// Returns the names of all displacements and rotations of a solid.
fn all_integrals(scope: &Scope) -> Vec<String> {
    components(scope).into_iter().filter_map(Component::integral).collect()
}

/// A quantity recorded by a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Recorded {
    /// A component of the state.
    Component(Component),
    /// Time integral of a velocity (displacement) or spin (rotation).
    Integral(Component),
}

/// Formats the name in case files.
impl fmt::Display for Recorded {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Component(component) => component.fmt(formatter),
            Self::Integral(component) => {
                formatter.write_str(&component.integral().unwrap_or_default())
            }
        }
    }
}

/// Output options of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Time between two rows of the energy ledger, s; 0 for at most 1000 rows.
    pub ledger_interval: f64,
    /// Time between two snapshots of all fields, s; 0 for none.
    pub snapshot_interval: f64,
    /// Velocities and spins whose time integrals (displacements, rotations) are stored.
    pub integrals: Vec<Component>,
    /// Quantity plotted in pictures.
    pub picture: Picture,
    /// Contour levels in the unit of the quantity; `None` for automatic levels.
    pub contours: Option<Vec<f64>>,
}

/// Quantity plotted in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Picture {
    /// Magnitude of the velocity.
    #[default]
    Speed,
    /// A component of the state.
    Component(Component),
    /// Time integral of a velocity (displacement) or spin (rotation).
    Integral(Component),
    /// Plastic dissipation per unit volume.
    Dissipation,
}

impl Picture {
    /// Returns the name of the quantity in case files.
    pub fn name(self) -> String {
        match self {
            Self::Speed => "speed".to_owned(),
            Self::Component(component) => component.to_string(),
            Self::Integral(component) => component.integral().unwrap_or_default(),
            Self::Dissipation => "dissipation".to_owned(),
        }
    }
}

impl Output {
    /// Formats the section `[output]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let integrals: Vec<String> =
            self.integrals.iter().filter_map(|own| own.integral()).collect();
        let resolved = Resolved::default()
            .number("ledger_interval", self.ledger_interval)
            .number("snapshot_interval", self.snapshot_interval)
            .texts("integrals", &integrals)
            .text("picture", self.picture.name());
        let resolved = match &self.contours {
            Some(contours) => resolved.number("contours", contours),
            None => resolved,
        };
        resolved.under(&OUTPUT)
    }
}

impl Receiver<Recorded> {
    /// Formats the section `[[receiver]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        self.resolved().text("interpolation", self.interpolation.name()).under(&RECEIVER)
    }
}

impl Reader<'_> {
    /// Reads the sections `[[receiver]]`; `integrals` are the recorded displacements and rotations.
    pub(super) fn receivers(
        &self,
        root: &Section,
        integrals: &[Component],
    ) -> Result<Vec<Receiver<Recorded>>, CaseError> {
        let all: Vec<Recorded> = (self.components.iter().copied().map(Recorded::Component))
            .chain(integrals.iter().copied().map(Recorded::Integral))
            .collect();
        let find = |name: &str| {
            let component = Component::find(name, self.theory, &self.components);
            let integral = || all.iter().copied().find(|own| own.to_string() == name);
            component.map(Recorded::Component).or_else(integral)
        };
        let extents: Vec<[f64; 2]> = (0..self.dimensions()).map(|a| self.grid.extent(a)).collect();
        let domain = Domain { form: &RECEIVER, extents, whole: "grid", interpolates: true };
        receivers(root, &all, find, &domain)
    }

    /// Reads the section `[output]`; `yields` states whether at least one medium yields.
    pub(super) fn output(&self, root: &Section, yields: bool) -> Result<Output, CaseError> {
        let mut output = Output {
            ledger_interval: 0.0,
            snapshot_interval: 0.0,
            integrals: Vec::new(),
            picture: Picture::Speed,
            contours: None,
        };
        let Some(section) = root.section(&OUTPUT)? else { return Ok(output) };
        output.ledger_interval = section.or_default("ledger_interval")?;
        output.snapshot_interval = section.or_default("snapshot_interval")?;
        let possible: Vec<(String, Component)> = self
            .components
            .iter()
            .filter_map(|component| Some((component.integral()?, *component)))
            .collect();
        let words: Vec<String> = possible.iter().map(|own| own.0.clone()).collect();
        let find = |name: &str| possible.iter().find(|own| own.0 == name).map(|own| own.1);
        output.integrals = section.different("integrals", &words, find)?.unwrap_or_default();
        let mut pictures = vec![Picture::Speed];
        pictures.extend(self.components.iter().copied().map(Picture::Component));
        pictures.extend(output.integrals.iter().copied().map(Picture::Integral));
        pictures.push(Picture::Dissipation);
        let words: Vec<String> = pictures.iter().map(|picture| picture.name()).collect();
        if let Some(name) = section.optional_text("picture", &words)? {
            let own = pictures.iter().copied().find(|picture| picture.name() == name);
            let component = Component::find(&name, self.theory, &self.components);
            let own = own.or(component.map(Picture::Component));
            output.picture = own.ok_or_else(|| section.no_such("picture", &name, &words))?;
        }
        if output.picture == Picture::Dissipation && !yields {
            let allowed = "another picture, or a section [yield]";
            return Err(section.error("picture", "found 'dissipation' in elastic media", allowed));
        }
        output.contours = section.optional("contours")?;
        section.finish()?;
        Ok(output)
    }
}
