//! The sections `[[load]]`: loads on the boundary faces of the grid.

use super::boundary::{FROM, Part, SIDE, Side, TO};
use super::component::{Component, components, names};
use super::function::{self, TimeFunction};
use super::profile::{self, Profile};
use super::reader::Reader;
use super::source::{KERNEL, Kernel, RADIUS};
use crate::error::CaseError;
use crate::schema::{Condition, Form, Group, Item, Length, Range, Type};
use crate::section::{Resolved, Section};

const WITHOUT_POINT: &[Condition] = &[Condition::Absent("at")];

/// Schema of the sections `[[load]]`.
pub(super) const FORM: Form = Form::list(
    "load",
    "a load on a side: what a stress or velocity of the side is; loads add up, over the conditions",
    &[
        Group::always(&[
            SIDE,
            Item::required(
                "field",
                Type::OneOf(|scope| names(&components(scope))),
                "",
                "\"sigma22\"",
                "a stress or couple stress on the side, tension positive, or a velocity or spin of it",
            ),
            Item::required(
                "amplitude",
                Type::Number(Range::Finite),
                "m/s, rad/s, Pa or N/m",
                "-1e3",
                "what the function of time is multiplied by; at a point N or N·m, in plane strain per m",
            )
            .note("what time is multiplied by"),
        ]),
        Group::when(WITHOUT_POINT, &[FROM, TO]),
        Group::always(&[Item::optional(
            "at",
            Type::Numbers(Length::SideAxes),
            "m",
            "0.0",
            "in place of from and to: a point at which a force acts; in space two numbers",
        )
        .note("a point of the side")
        .when(&[Condition::Absent("from"), Condition::Absent("to")])]),
        Group::when(&[Condition::Present("at")], &[KERNEL, RADIUS]),
        Group::when(
            WITHOUT_POINT,
            &[Item::optional(
                "profile",
                Type::Table(&profile::FORM),
                "",
                "{ kind = \"bell\", at = 0.0, radius = 5.0 }",
                "a factor along the side; default 1",
            )],
        ),
        Group::always(&[function::TIME]),
    ],
);

/// A boundary load.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Boundary face of the grid.
    pub side: Side,
    /// Loaded component: a velocity or spin of the face, or a stress or couple stress on it. Stresses are tensor
    /// components, tension-positive on the lower and the upper face.
    pub field: Component,
    /// Amplitude, multiplied by the time function: m/s, rad/s, Pa or N/m. For a point load the integral over the face:
    /// N or N·m, in plane strain per unit thickness.
    pub amplitude: f64,
    /// Loaded part of the face.
    pub action: Action,
    /// Spatial profile along the face; `None` for a uniform load and for point loads.
    pub profile: Option<Profile>,
    /// Time function.
    pub time: TimeFunction,
}

/// Part of a boundary face on which a load acts.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// The whole face.
    Whole,
    /// A rectangular part of the face.
    Part(Part),
    /// A point load.
    Point {
        /// Coordinates along the tangential axes of the face, m.
        at: Vec<f64>,
        /// Kernel over which the load is distributed.
        kernel: Kernel,
    },
}

impl Load {
    /// Formats the section `[[load]]` as TOML with all values.
    pub(super) fn to_toml(&self, dimensions: usize) -> String {
        let resolved = Resolved::default()
            .text("side", self.side.name())
            .text("field", self.field.to_string())
            .number("amplitude", self.amplitude);
        let resolved = match &self.action {
            Action::Whole => resolved,
            Action::Part(part) => part.resolved(resolved),
            Action::Point { at, kernel } => kernel.resolved(resolved.number("at", at)),
        };
        let resolved = match &self.profile {
            Some(profile) => resolved.table("profile", &profile.resolved(dimensions)),
            None => resolved,
        };
        resolved.table("time", &self.time.resolved()).under(&FORM)
    }
}

impl Reader<'_> {
    /// Reads all sections `[[load]]`.
    pub(super) fn loads(&self, root: &Section, periodic: &[Side]) -> Result<Vec<Load>, CaseError> {
        let mut loads = Vec::new();
        for mut section in root.list(&FORM)? {
            let side = self.side(&mut section)?;
            if periodic.contains(&side) {
                let found = format!("found {}, which is periodic", side.name());
                let allowed = "a periodic side has no load; give [[source]], or another side";
                return Err(section.error("side", found, allowed));
            }
            let among = Component::on_side(self.theory, self.dimensions(), side.axis);
            let field = self.component(&section, &among)?;
            let amplitude = section.required("amplitude")?;
            let action = self.action(&section, field)?;
            let profile = match action {
                Action::Point { .. } if section.has("profile") => {
                    let allowed = "leave it out: what acts at a point has a kernel; a profile goes \
                                   with from and to, or with all of the side";
                    return Err(section.error("profile", "found beside at", allowed));
                }
                Action::Point { .. } => None,
                _ => Profile::read(&section)?,
            };
            let time = self.function(&section)?;
            section.finish()?;
            loads.push(Load { side, field, amplitude, action, profile, time });
        }
        Ok(loads)
    }

    /// Reads the part of the face on which a load acts.
    fn action(&self, section: &Section, field: Component) -> Result<Action, CaseError> {
        let part = self.part(section)?;
        let at: Option<Vec<f64>> = section.optional("at")?;
        let kernel = Kernel::read(section)?;
        match (part, at) {
            (Some(_), Some(_)) => {
                let allowed = "give one of the two, a part or a point of the side";
                Err(section.error("at", "found beside from and to", allowed))
            }
            (_, Some(_)) if field.is_velocity() => {
                let allowed = "a stress or couple stress, or from and to in place of at";
                Err(section.error("at", format!("found for the velocity {field}"), allowed))
            }
            (None, Some(at)) => {
                self.check_inside(section, &at, &section.scope.axes)?;
                Ok(Action::Point { at, kernel: kernel.unwrap_or_default() })
            }
            (_, None) if kernel.is_some() => {
                let key = if section.has("radius") { "radius" } else { "kernel" };
                let allowed = "add at, the point that it is about, or leave it out";
                Err(section.error(key, "found without at", allowed))
            }
            (Some(part), None) => Ok(Action::Part(part)),
            (None, None) => Ok(Action::Whole),
        }
    }
}
