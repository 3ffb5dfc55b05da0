//! Schemas of all structured sections, and the sections allowed for each kind of model.

use crate::error::CaseError;
use crate::kind::{ModelKind, join_names};
use crate::schema::{CaseSchemas, TableSchema};
use crate::section::SectionReader;
use crate::{check, dynamics, equations, flow, plane_wave, rheology};
use models::flow::RotationKind;

/// Schemas of all structured sections.
pub(crate) const CASE_SCHEMAS: CaseSchemas = CaseSchemas {
    solids: dynamics::SOLID_SCHEMAS,
    flows: &flow::FLOW_SCHEMAS,
    plane_waves: plane_wave::PLANE_WAVE_SCHEMAS,
    rheology: rheology::RHEOLOGY_SCHEMAS,
    equations: &[],
    check: &check::SCHEMA,
    simulation: simulation_schemas,
};

/// Schemas of the sections of a case whose model is given as equations; its sections `[model]`, `[background]`,
/// `[wave]` and `[map]` are structured.
pub(crate) const EQUATION_CASE_SCHEMAS: CaseSchemas = CaseSchemas {
    solids: &[],
    flows: &[],
    plane_waves: &[],
    rheology: &[],
    equations: equations::EQUATION_SCHEMAS,
    ..CASE_SCHEMAS
};

/// Returns the schemas of the time-domain sections of a kind of model, in the order of writing; empty if the kind has
/// no time-domain solver.
pub(crate) fn simulation_schemas(kind: ModelKind) -> Vec<&'static TableSchema> {
    match kind {
        ModelKind::Solid(_) => dynamics::SOLID_SCHEMAS.to_vec(),
        ModelKind::Flow(_) => flow::schemas_for_kind(kind),
        ModelKind::Rheology | ModelKind::Equations => Vec::new(),
    }
}

/// Returns the schemas of all structured sections in six groups: time-domain solids, time-domain flows, plane waves,
/// rheological schemes, models given as equations, and `[check]`.
pub fn all_schemas() -> [(&'static str, Vec<&'static TableSchema>); 6] {
    let CaseSchemas { solids, flows, plane_waves, rheology, check, .. } = CASE_SCHEMAS;
    [
        ("time-domain simulation of solids", solids.to_vec()),
        ("time-domain simulation of flows", flows.to_vec()),
        ("plane waves in granular and porous media", plane_waves.to_vec()),
        ("rheological schemes", rheology.to_vec()),
        ("models given as equations", equations::EQUATION_SCHEMAS.to_vec()),
        ("check", vec![check]),
    ]
}

/// Returns whether the case describes a time-domain simulation, i.e. has a section `[grid]` or `[[block]]`.
///
/// # Errors
/// A section is not used by the kind of model, or a time-domain section is present without `[grid]`.
pub(crate) fn has_simulation(root: &SectionReader, kind: ModelKind) -> Result<bool, CaseError> {
    let own = simulation_schemas(kind);
    let is_own = |name: &str| {
        let always = plane_wave::PLANE_WAVE_SCHEMAS.iter().chain([&&check::SCHEMA]);
        always.chain(&own).any(|table_schema| table_schema.name == name)
    };
    if let Some((foreign, _)) = root.entries().find(|(name, _)| !is_own(name)) {
        let (found, allowed) = find_foreign_section(kind, foreign).unwrap_or_default();
        return Err(root.key_error(foreign, found, allowed));
    }
    let first = own.iter().map(|table_schema| table_schema.name).find(|name| root.has_key(name));
    match first {
        None => Ok(false),
        Some("grid" | "block") => Ok(true),
        Some(name) => {
            let size = if let ModelKind::Flow(_) = kind { "length" } else { "spacing" };
            let allowed = format!(
                "add a section [grid] with cells and {size}, which runs need; or leave [{name}] out"
            );
            Err(root.key_error(name, format!("found [{name}], but no [grid]"), allowed))
        }
    }
}

/// Returns fault and remedy of a section that the kind of model does not use; `None` if the kind uses it or it is no
/// structured section.
pub(crate) fn find_foreign_section(kind: ModelKind, foreign: &str) -> Option<(String, String)> {
    let own = simulation_schemas(kind);
    let always = plane_wave::PLANE_WAVE_SCHEMAS.iter().chain([&&check::SCHEMA]);
    if always.chain(&own).any(|table_schema| table_schema.name == foreign) {
        return None;
    }
    let found = match kind {
        ModelKind::Solid(_) => format!("not used by the model {}, a solid", kind.name()),
        ModelKind::Flow(_) => format!("not used by the model {}, a flow", kind.name()),
        ModelKind::Rheology => "not used by a rheological scheme".to_owned(),
        ModelKind::Equations => "not used by a model given as equations".to_owned(),
    };
    let allowed = match kind {
        ModelKind::Flow(flow) if flow.rotation() == RotationKind::Free => {
            "leave it out: this model does not determine the spin, so that it cannot be \
             simulated"
                .to_owned()
        }
        _ if foreign == "limits" => {
            let owners = ModelKind::flow_kinds();
            let is_coaxial =
                |kind: &&ModelKind| matches!(kind, ModelKind::Flow(flow) if flow.is_coaxial());
            let owners: Vec<ModelKind> = owners.iter().filter(is_coaxial).copied().collect();
            format!("leave it out: it belongs to {}", join_names(&owners))
        }
        _ => {
            let own: Vec<&str> = own.iter().map(|table_schema| table_schema.name).collect();
            format!("leave it out: it belongs to solids; a flow has {}", own.join(", "))
        }
    };
    Some((found, allowed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{KeyCondition, SchemaScope, ValueType};
    use crate::value::CaseValue;
    use toml::de::DeValue;

    fn assert_keys_are_consistent(table_schema: &'static TableSchema) {
        let names: Vec<&str> = table_schema.keys().map(|(_, item)| item.name).collect();
        for (when, item) in table_schema.keys() {
            let conditions = || when.iter().chain(item.conditions);
            for condition in conditions() {
                match condition {
                    KeyCondition::HasValue(key, _)
                    | KeyCondition::Present(key)
                    | KeyCondition::Absent(key) => {
                        assert!(names.contains(key), "{}: {key}", table_schema.name);
                    }
                    KeyCondition::PlaneStrain | KeyCondition::Space => {}
                }
            }
            if let ValueType::Table(inner) | ValueType::TableList(inner) = item.value_type {
                assert_keys_are_consistent(inner);
                continue;
            }
            let is_in_space = conditions().any(|condition| *condition == KeyCondition::Space);
            let dimensions = Some(if is_in_space { 3 } else { 2 });
            let scope = SchemaScope { kind: None, dimensions, face_axes: vec![0] };
            let value = DeValue::parse(item.example_value()).expect("TOML");
            let read = item.value_type.parse_value(value.get_ref(), &scope);
            let is_allowed = match (item.value_type, read) {
                (ValueType::SectionKeys(_) | ValueType::Named(_), _) => true,
                (ValueType::OneOf(allowed_names), Some(CaseValue::Text(word))) => {
                    allowed_names(&scope).contains(&word)
                }
                (ValueType::AnyOf(allowed_names), Some(CaseValue::TextList(own))) => {
                    own.iter().all(|word| allowed_names(&scope).contains(word))
                }
                (_, read) => read.is_some(),
            };
            assert!(is_allowed, "{}.{}: {}", table_schema.name, item.name, item.example_value());
        }
    }

    #[test]
    fn schema_examples_have_declared_types_and_conditions_name_existing_keys() {
        for table_schema in all_schemas().iter().flat_map(|(_, table_schemas)| table_schemas) {
            assert_keys_are_consistent(table_schema);
        }
    }

    #[test]
    fn default_courant_number_equals_schema_default() {
        let time = crate::dynamics::SOLID_SCHEMAS
            .iter()
            .find(|table_schema| table_schema.name == "time")
            .expect("it");
        let (_, item) = time.keys().find(|(_, item)| item.name == "courant").expect("it");
        assert_eq!(item.example_value().parse(), Ok(crate::dynamics::DEFAULT_COURANT_NUMBER));
    }
}
