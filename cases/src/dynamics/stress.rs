//! The sections `[initial_stress]` and `[gravity]`.

use super::component::{Component, names};
use super::reader::Reader;
use crate::error::CaseError;
use crate::schema::{Form, Group, Item, Length, Range, Type};
use crate::section::{Resolved, Section};
use crate::value::number;
use models::solid::parameters::Theory;
use models::solid::waves::Field;

/// Schema of the section `[initial_stress]`, whose keys are the names of the stress components of the solid.
pub(super) const INITIAL_STRESS: Form = Form::section(
    "initial_stress",
    "a uniform initial stress: components of stress, Pa, and of couple stress, N/m, by name; what is not named is 0",
    &[],
);

/// Schema of the section `[gravity]`.
pub(super) const GRAVITY: Form = Form::section(
    "gravity",
    "weight",
    &[Group::always(&[
        Item::required(
            "acceleration",
            Type::Numbers(Length::Axes),
            "m/s²",
            "[0.0, -9.81]",
            "acceleration by components",
        ),
        Item::with_default(
            "balanced",
            Type::Truth,
            "",
            "true",
            "whether an initial stress rests in it, along one axis then; false: it acts from the start",
        ),
        Item::with_default(
            "lateral_ratio",
            Type::Number(Range::NotNegative),
            "",
            "1.0",
            "ratio of the normal stresses across the weight to that along it in the initial stress",
        )
        .note("stress across the weight over that along it"),
    ])],
);

/// Gravity.
#[derive(Clone, Debug, PartialEq)]
pub struct Gravity {
    /// Gravitational acceleration, components in m/s².
    pub acceleration: Vec<f64>,
    /// Whether a geostatic initial stress balances the weight; gravity then acts along one axis.
    pub is_balanced: bool,
    /// Ratio K₀ of lateral to vertical normal stress in the initial stress; ≥ 0.
    pub lateral_ratio: f64,
}

impl Gravity {
    /// Reads the section `[gravity]`; `None` if absent.
    pub(super) fn read(root: &Section) -> Result<Option<Self>, CaseError> {
        let Some(section) = root.section(&GRAVITY)? else { return Ok(None) };
        let acceleration: Vec<f64> = section.required("acceleration")?;
        let is_balanced = section.or_default("balanced")?;
        let axes = acceleration.iter().filter(|a| **a != 0.0).count();
        if is_balanced && axes != 1 {
            let stated = if section.has("balanced") { "" } else { ", the default," };
            let found = format!("found true{stated} with the acceleration {acceleration:?}");
            let allowed = "give an acceleration along one axis, or set balanced = false";
            return Err(section.error("balanced", found, allowed));
        }
        let lateral_ratio = section.or_default("lateral_ratio")?;
        section.finish()?;
        Ok(Some(Self { acceleration, is_balanced, lateral_ratio }))
    }

    /// Formats the section `[gravity]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        Resolved::default()
            .number("acceleration", &self.acceleration)
            .literal("balanced", self.is_balanced)
            .number("lateral_ratio", self.lateral_ratio)
            .under(&GRAVITY)
    }
}

/// Returns all stress and couple stress components of a Cosserat solid in space.
pub(crate) fn all() -> impl Iterator<Item = Component> {
    Component::all(Theory::Cosserat, 3).into_iter().filter(|component| !component.is_velocity())
}

/// Returns the unit of a stress or couple stress component.
pub(crate) fn unit(component: Component) -> &'static str {
    if let Field::Couple(..) = component.0 { "N/m" } else { "Pa" }
}

/// Formats the section `[initial_stress]` as TOML.
pub(super) fn to_toml(stresses: &[(Component, f64)]) -> String {
    let stress = |all: Resolved, (component, value): &(Component, f64)| {
        all.number(component.to_string(), value)
    };
    stresses.iter().fold(Resolved::default(), stress).under(&INITIAL_STRESS)
}

impl Reader<'_> {
    /// Reads the section `[initial_stress]`: all stress components of the solid, 0 where not given.
    pub(super) fn initial_stress(
        &self,
        root: &Section,
    ) -> Result<Vec<(Component, f64)>, CaseError> {
        let is_stress = |component: &&Component| !component.is_velocity();
        let stresses: Vec<Component> = self.components.iter().filter(is_stress).copied().collect();
        let mut values: Vec<(Component, Option<f64>)> =
            stresses.iter().map(|&component| (component, None)).collect();
        if let Some(section) = root.section(&INITIAL_STRESS)? {
            for (name, node) in section.entries() {
                let Some(component) = Component::find(name, self.theory, &stresses) else {
                    return Err(section.unknown(name, &names(&stresses)));
                };
                let Some(value) = node.value().and_then(number) else {
                    let allowed = format!("expected a finite number in {}", unit(component));
                    return Err(section.error(name, format!("found {}", node.words()), allowed));
                };
                for (_, slot) in values.iter_mut().filter(|(own, _)| *own == component) {
                    if slot.replace(value).is_some() {
                        let found = format!("a second value of {component}");
                        let allowed = "give one: shear stresses of a classical solid are equal";
                        return Err(section.error(name, found, allowed));
                    }
                }
            }
        }
        Ok(values.into_iter().map(|(stress, value)| (stress, value.unwrap_or(0.0))).collect())
    }
}
