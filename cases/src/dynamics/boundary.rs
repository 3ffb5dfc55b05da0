//! The sections `[[side]]`: boundary conditions on the faces of the grid.

use super::component::{Component, components, names};
use super::reader::Reader;
use crate::error::CaseError;
use crate::position::check_order;
use crate::schema::{Condition as When, Form, Group, Item, Length, Type};
use crate::section::{Resolved, Section, joined};

/// Key `side`: name of a boundary face of the grid.
pub(super) const SIDE: Item = Item::required(
    "side",
    Type::OneOf(|scope| {
        let dimensions = scope.dimensions.unwrap_or(3);
        Side::all(dimensions).into_iter().map(Side::name).collect()
    }),
    "",
    "\"x2+\"",
    "the side: the axis of its normal, and at which end",
);

const END: Type = Type::Numbers(Length::SideAxes);

/// Key `from`: lower corner of a rectangular part of a face.
pub(super) const FROM: Item = Item::optional(
    "from",
    END,
    "m",
    "-5.0",
    "with to: a part of the side, of which this is the first end, which is in it; in space two numbers; default all of it",
)
.note("an end of the part");

/// Key `to`: upper corner of a rectangular part of a face.
pub(super) const TO: Item =
    Item::optional("to", END, "m", "5.0", "last end of the part, which is not in it")
        .note("an end of the part");

/// Schema of the sections `[[side]]`.
pub(super) const FORM: Form = Form::list(
    "side",
    "a condition on a side of the grid; a side that is not named is free, and later entries hold over earlier ones",
    &[
        Group::always(&[
            SIDE,
            Item::required(
                "kind",
                Type::OneOf(|_| Condition::NAMES.map(str::to_owned).to_vec()),
                "",
                "\"non-reflecting\"",
                "what holds there: no traction, no velocity, mirror image, the side across, waves along the normal leave, or held",
            ),
        ]),
        Group::when(
            &[When::Is("kind", &["mixed"])],
            &[Item::required(
                "held",
                Type::AnyOf(|scope| {
                    let mut all = components(scope);
                    all.retain(|component| component.is_velocity());
                    names(&all)
                }),
                "",
                "[\"v2\"]",
                "velocities and spins that vanish; the tractions and couples of the others do",
            )],
        ),
        Group::when(
            &[When::Is(
                "kind",
                &["free", "fixed", "symmetry", "antisymmetry", "non-reflecting", "mixed"],
            )],
            &[FROM, TO],
        ),
    ],
);

/// A boundary face of the grid, normal to an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Side {
    /// Axis of the normal, numbered from 0.
    pub axis: usize,
    /// Whether the face is at the upper end of the axis.
    pub is_upper: bool,
}

impl Side {
    /// Returns all boundary faces of a grid in 2 or 3 dimensions.
    pub fn all(dimensions: usize) -> Vec<Self> {
        let both = |axis| [false, true].map(|is_upper| Self { axis, is_upper });
        (0..dimensions).flat_map(both).collect()
    }

    /// Returns the name in case files, e.g. `x1-`.
    pub fn name(self) -> String {
        format!("x{}{}", self.axis + 1, if self.is_upper { '+' } else { '-' })
    }

    /// Returns the opposite face.
    pub fn opposite(self) -> Self {
        Self { is_upper: !self.is_upper, ..self }
    }

    /// Returns the tangential axes of the face, ascending; positions on the face are given along these axes.
    pub fn axes(self, dimensions: usize) -> Vec<usize> {
        (0..dimensions).filter(|&axis| axis != self.axis).collect()
    }
}

/// A rectangular part of a boundary face: from ≤ x < to along each tangential axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Lower coordinates along the tangential axes, m.
    pub from: Vec<f64>,
    /// Upper coordinates along the tangential axes, m.
    pub to: Vec<f64>,
}

impl Part {
    /// Returns whether the part contains a position on the face.
    pub fn contains(&self, position: &[f64]) -> bool {
        let ends = self.from.iter().zip(&self.to);
        position.iter().zip(ends).all(|(x, (from, to))| (from..to).contains(&x))
    }

    /// Adds the keys `from` and `to` of the part to a table.
    pub(super) fn resolved(&self, resolved: Resolved) -> Resolved {
        resolved.number("from", &self.from).number("to", &self.to)
    }
}

/// Boundary condition on a face or on a part of a face. Faces without a condition are traction-free; where entries
/// overlap, the last one applies.
#[derive(Clone, Debug, PartialEq)]
pub struct SideCondition {
    /// Boundary face of the grid.
    pub side: Side,
    /// Boundary condition.
    pub condition: Condition,
    /// Part of the face; `None` for the whole face.
    pub part: Option<Part>,
}

/// Boundary condition.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// Traction-free: zero traction and couple traction.
    Free,
    /// Fixed: zero velocity and spin.
    Fixed,
    /// Mirror symmetry.
    Symmetry,
    /// Mirror antisymmetry.
    Antisymmetry,
    /// Periodic: connected to the opposite face.
    Periodic,
    /// Non-reflecting: waves along the normal leave the grid without reflection.
    NonReflecting,
    /// Mixed: the velocities and spins in `held` are zero; the tractions and couples of the other components are zero.
    Mixed {
        /// Velocities and spins that are zero.
        held: Vec<Component>,
    },
}

impl Condition {
    /// Names of all boundary conditions in case files.
    pub const NAMES: [&str; 7] =
        ["free", "fixed", "symmetry", "antisymmetry", "periodic", "non-reflecting", "mixed"];

    /// Returns the name of the boundary condition in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Fixed => "fixed",
            Self::Symmetry => "symmetry",
            Self::Antisymmetry => "antisymmetry",
            Self::Periodic => "periodic",
            Self::NonReflecting => "non-reflecting",
            Self::Mixed { .. } => "mixed",
        }
    }
}

/// Returns the periodic faces after all entries, each with the index of its entry.
pub(super) fn periodic_sides(sides: &[SideCondition]) -> impl Iterator<Item = (usize, Side)> {
    let is_last_whole = |index: usize, side: Side| {
        !sides[index + 1..].iter().any(|later| later.side == side && later.part.is_none())
    };
    sides
        .iter()
        .enumerate()
        .filter(move |(index, entry)| {
            entry.condition == Condition::Periodic && is_last_whole(*index, entry.side)
        })
        .map(|(index, entry)| (index, entry.side))
}

impl SideCondition {
    /// Formats the section `[[side]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let mut resolved =
            Resolved::default().text("side", self.side.name()).text("kind", self.condition.name());
        if let Condition::Mixed { held } = &self.condition {
            resolved = resolved.texts("held", held);
        }
        let resolved = match &self.part {
            Some(part) => part.resolved(resolved),
            None => resolved,
        };
        resolved.under(&FORM)
    }
}

impl Reader<'_> {
    /// Reads the boundary face of an entry and sets the scope: positions in the entry are along the tangential axes of
    /// the face.
    pub(super) fn side(&self, section: &mut Section) -> Result<Side, CaseError> {
        let side = section.choice("side", &Side::all(self.dimensions()), Side::name)?;
        section.scope.axes = side.axes(self.dimensions());
        Ok(side)
    }

    /// Reads the part of a face between `from` and `to`, if given.
    pub(super) fn part(&self, section: &Section) -> Result<Option<Part>, CaseError> {
        let (from, to): (Option<Vec<f64>>, _) =
            (section.optional("from")?, section.optional::<Vec<f64>>("to")?);
        match (from, to) {
            (Some(from), Some(to)) => {
                check_order(section, &from, &to)?;
                Ok(Some(Part { from, to }))
            }
            (None, None) => Ok(None),
            (from, _) => {
                let absent = if from.is_none() { "from" } else { "to" };
                Err(section.error(absent, "missing", "give both ends of a part, from and to"))
            }
        }
    }

    /// Reads all sections `[[side]]`.
    pub(super) fn sides(&self, root: &Section) -> Result<Vec<SideCondition>, CaseError> {
        let mut sides = Vec::new();
        for mut section in root.list(&FORM)? {
            let side = self.side(&mut section)?;
            let condition = match section.choice("kind", &Condition::NAMES, |name| name)? {
                "free" => Condition::Free,
                "fixed" => Condition::Fixed,
                "symmetry" => Condition::Symmetry,
                "antisymmetry" => Condition::Antisymmetry,
                "periodic" => Condition::Periodic,
                "non-reflecting" => Condition::NonReflecting,
                _ => Condition::Mixed { held: self.held(&section, side)? },
            };
            let part = match condition {
                Condition::Periodic => None,
                _ => self.part(&section)?,
            };
            section.finish()?;
            sides.push(SideCondition { side, condition, part });
        }
        let periodic: Vec<(usize, Side)> = periodic_sides(&sides).collect();
        let is_periodic = |side: Side| periodic.iter().any(|(_, own)| *own == side);
        for (index, side) in &periodic {
            let (own, across) = (side.name(), side.opposite().name());
            if !is_periodic(side.opposite()) {
                let found = format!("found periodic on {own} alone");
                let allowed = format!("add [[side]] with side = \"{across}\", kind = \"periodic\"");
                return Err(root.error(&format!("side[{index}].kind"), found, allowed));
            }
        }
        let is_part = |entry: &SideCondition| entry.part.is_some() && is_periodic(entry.side);
        if let Some(index) = sides.iter().position(is_part) {
            let found = format!("found a part of {}, which is periodic", sides[index].side.name());
            let allowed = "leave the part out: a side is periodic as a whole";
            return Err(root.error(&format!("side[{index}].side"), found, allowed));
        }
        Ok(sides)
    }

    /// Reads the velocities and spins that are zero on a mixed face.
    fn held(&self, section: &Section, side: Side) -> Result<Vec<Component>, CaseError> {
        let mut among = Component::on_side(self.theory, self.dimensions(), side.axis);
        among.retain(|component| component.is_velocity());
        let names = names(&among);
        let find = |name: &str| Component::find(name, self.theory, &among);
        section.different("held", &names, find)?.ok_or_else(|| {
            let allowed = format!("add held, a list with any of {}", joined(&names));
            section.error("held", "missing", allowed)
        })
    }
}
