//! Schemas of all structured sections, and the sections allowed for each kind of model.

use crate::error::CaseError;
use crate::kind::{Kind, names};
use crate::schema::{Form, Forms};
use crate::section::Section;
use crate::{check, dynamics, flow};
use models::flow::RotationKind;

/// Schemas of all structured sections.
pub(crate) const FORMS: Forms = Forms {
    solids: dynamics::FORMS,
    flows: &flow::FORMS,
    check: &check::FORM,
    in_time: forms_in_time,
};

/// Returns the schemas of the time-domain sections of a kind of model, in the order of writing; empty if the kind has
/// no time-domain solver.
pub(crate) fn forms_in_time(kind: Kind) -> Vec<&'static Form> {
    match kind {
        Kind::Solid(_) => dynamics::FORMS.to_vec(),
        Kind::Flow(_) => flow::forms(kind),
    }
}

/// Returns the schemas of all structured sections in three groups: time-domain solids, time-domain flows and `[check]`.
pub fn all_forms() -> [(&'static str, Vec<&'static Form>); 3] {
    let Forms { solids, flows, check, .. } = FORMS;
    [("solids in time", solids.to_vec()), ("flows in time", flows.to_vec()), ("check", vec![check])]
}

/// Returns whether the case describes a time-domain simulation, i.e. has a section `[grid]`.
///
/// # Errors
/// A section is not used by the kind of model, or a time-domain section is present without `[grid]`.
pub(crate) fn is_run_in_time(root: &Section, kind: Kind) -> Result<bool, CaseError> {
    let own = forms_in_time(kind);
    let is_own = |name: &str| name == check::FORM.name || own.iter().any(|form| form.name == name);
    if let Some((foreign, _)) = root.entries().find(|(name, _)| !is_own(name)) {
        let found = match kind {
            Kind::Solid(_) => format!("found for the model {}, a solid", kind.name()),
            Kind::Flow(_) => format!("found for the model {}, a flow", kind.name()),
        };
        let allowed = match kind {
            Kind::Flow(flow) if flow.rotation() == RotationKind::Free => {
                "leave it out: nothing determines the spin of this model, so that it cannot be \
                 run in time"
                    .to_owned()
            }
            _ if foreign == "limits" => {
                let owners = Kind::flows();
                let is_coaxial =
                    |kind: &&Kind| matches!(kind, Kind::Flow(flow) if flow.is_coaxial());
                let owners: Vec<Kind> = owners.iter().filter(is_coaxial).copied().collect();
                format!("leave it out: it belongs to {}", names(&owners))
            }
            _ => {
                let own: Vec<&str> = own.iter().map(|form| form.name).collect();
                format!("leave it out: it belongs to solids; a flow has {}", own.join(", "))
            }
        };
        return Err(root.error(foreign, found, allowed));
    }
    let first = own.iter().map(|form| form.name).find(|name| root.has(name));
    match first {
        None => Ok(false),
        Some("grid") => Ok(true),
        Some(name) => {
            let size = if let Kind::Flow(_) = kind { "length" } else { "spacing" };
            let allowed =
                format!("add a section [grid] with cells and {size}, or leave this one out");
            Err(root.error(name, "found without a grid", allowed))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{Condition, Scope, Type};
    use crate::value::Value;
    use toml::de::DeValue;

    fn check(form: &'static Form) {
        let names: Vec<&str> = form.items().map(|(_, item)| item.name).collect();
        for (when, item) in form.items() {
            let conditions = || when.iter().chain(item.when);
            for condition in conditions() {
                match condition {
                    Condition::Is(key, _) | Condition::Present(key) | Condition::Absent(key) => {
                        assert!(names.contains(key), "{}: {key}", form.name);
                    }
                    Condition::Plane | Condition::Space => {}
                }
            }
            if let Type::Table(inner) = item.value {
                check(inner);
                continue;
            }
            let is_in_space = conditions().any(|condition| *condition == Condition::Space);
            let dimensions = Some(if is_in_space { 3 } else { 2 });
            let scope = Scope { kind: None, dimensions, axes: vec![0] };
            let value = DeValue::parse(item.example()).expect("TOML");
            let read = item.value.parse(value.get_ref(), &scope);
            let is_allowed = match (item.value, read) {
                (Type::Part(_), _) => true,
                (Type::OneOf(words), Some(Value::Text(word))) => words(&scope).contains(&word),
                (Type::AnyOf(words), Some(Value::Texts(own))) => {
                    own.iter().all(|word| words(&scope).contains(word))
                }
                (_, read) => read.is_some(),
            };
            assert!(is_allowed, "{}.{}: {}", form.name, item.name, item.example());
        }
    }

    #[test]
    fn defaults_and_examples_are_of_their_types_and_conditions_name_keys() {
        for form in all_forms().iter().flat_map(|(_, forms)| forms) {
            check(form);
        }
    }

    #[test]
    fn the_default_courant_number_is_that_of_the_schema() {
        let time = crate::dynamics::FORMS.iter().find(|form| form.name == "time").expect("it");
        let (_, item) = time.items().find(|(_, item)| item.name == "courant").expect("it");
        assert_eq!(item.example().parse(), Ok(crate::dynamics::COURANT));
    }
}
