//! The sections `[initial_stress]` and `[gravity]`.

use super::component::{StateComponent, component_names};
use super::reader::SolidReader;
use crate::error::CaseError;
use crate::schema::{AllowedRange, KeyGroup, KeySchema, ListLength, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};
use crate::value::parse_number;
use models::common::decimal::ToPlainText;
use models::solid::parameters::Theory;
use models::solid::waves::SolidField;

/// Schema of the section `[initial_stress]`, whose keys are the names of the stress components of the solid.
pub(super) const INITIAL_STRESS_SCHEMA: TableSchema = TableSchema::new_section(
    "initial_stress",
    "uniform initial stress: components of stress in Pa and of couple stress in N/m; omitted components are 0",
    &[],
);

/// Schema of the section `[gravity]`.
pub(super) const GRAVITY_SCHEMA: TableSchema = TableSchema::new_section(
    "gravity",
    "gravity",
    &[KeyGroup::new(&[
        KeySchema::new_required(
            "acceleration",
            ValueType::Numbers(ListLength::GridAxes),
            "m/s²",
            "[0.0, -9.81]",
            "gravitational acceleration vector",
        ),
        KeySchema::new_with_default(
            "balanced",
            ValueType::Boolean,
            "",
            "true",
            "true: a geostatic initial stress balances the weight, which must act along one axis; false: the weight acts from t = 0 without initial balance",
        ),
        KeySchema::new_with_default(
            "lateral_ratio",
            ValueType::Number(AllowedRange::NotNegative),
            "",
            "1.0",
            "ratio K₀ of lateral to vertical normal stress in the initial stress",
        )
        .with_note("ratio of lateral to vertical normal stress"),
    ])],
);

/// Gravity with or without a balancing initial stress.
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
    pub(super) fn read(root: &SectionReader) -> Result<Option<Self>, CaseError> {
        let Some(section) = root.open_section(&GRAVITY_SCHEMA)? else { return Ok(None) };
        let acceleration: Vec<f64> = section.read_required("acceleration")?;
        let is_balanced = section.read_or_default("balanced")?;
        let axes = acceleration.iter().filter(|a| **a != 0.0).count();
        if is_balanced && axes != 1 {
            let stated = if section.has_key("balanced") { "" } else { ", the default," };
            let found = format!(
                "found true{stated} with the acceleration {acceleration}",
                acceleration = acceleration.to_plain_text()
            );
            let allowed = "give an acceleration along one axis, or set balanced = false";
            return Err(section.key_error("balanced", found, allowed));
        }
        let lateral_ratio = section.read_or_default("lateral_ratio")?;
        section.finish()?;
        Ok(Some(Self { acceleration, is_balanced, lateral_ratio }))
    }

    /// Formats the section `[gravity]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        TableWriter::default()
            .with_number("acceleration", &self.acceleration)
            .with_toml("balanced", self.is_balanced)
            .with_number("lateral_ratio", self.lateral_ratio)
            .to_section_toml(&GRAVITY_SCHEMA)
    }
}

/// Returns all stress and couple stress components of a Cosserat solid in space.
pub(crate) fn stress_components() -> impl Iterator<Item = StateComponent> {
    StateComponent::all_components(Theory::Cosserat, 3)
        .into_iter()
        .filter(|component| !component.is_velocity())
}

/// Returns the unit of a stress or couple stress component.
pub(crate) fn stress_unit(component: StateComponent) -> &'static str {
    if let SolidField::Couple(..) = component.0 { "N/m" } else { "Pa" }
}

/// Formats the section `[initial_stress]` as TOML.
pub(super) fn to_toml(stresses: &[(StateComponent, f64)]) -> String {
    let stress = |all: TableWriter, (component, value): &(StateComponent, f64)| {
        all.with_number(component.to_string(), value)
    };
    stresses.iter().fold(TableWriter::default(), stress).to_section_toml(&INITIAL_STRESS_SCHEMA)
}

impl SolidReader<'_> {
    /// Reads the section `[initial_stress]`: all stress components of the solid, 0 where not given.
    pub(super) fn read_initial_stress(
        &self,
        root: &SectionReader,
    ) -> Result<Vec<(StateComponent, f64)>, CaseError> {
        let is_stress = |component: &&StateComponent| !component.is_velocity();
        let stresses: Vec<StateComponent> =
            self.state_components.iter().filter(is_stress).copied().collect();
        let mut values: Vec<(StateComponent, Option<f64>)> =
            stresses.iter().map(|&component| (component, None)).collect();
        if let Some(section) = root.open_section(&INITIAL_STRESS_SCHEMA)? {
            for (name, node) in section.entries() {
                let Some(component) = StateComponent::find_by_name(name, self.theory, &stresses)
                else {
                    return Err(section.unknown_key_error(name, &component_names(&stresses)));
                };
                let Some(value) = node.as_value().and_then(parse_number) else {
                    let allowed = format!("expected a finite number in {}", stress_unit(component));
                    return Err(section.key_error(
                        name,
                        format!("found {}", node.describe()),
                        allowed,
                    ));
                };
                for (_, slot) in values.iter_mut().filter(|(own, _)| *own == component) {
                    if slot.replace(value).is_some() {
                        let found = format!("a second value of {component}");
                        let allowed =
                            "give one: the stress tensor of a classical solid is symmetric";
                        return Err(section.key_error(name, found, allowed));
                    }
                }
            }
        }
        Ok(values.into_iter().map(|(stress, value)| (stress, value.unwrap_or(0.0))).collect())
    }
}
