//! Table of the scalar keys of case files.
//!
//! Parser, detection of unknown and unused keys, `--set`, the templates of `wellposed new` and the parameters of a map
//! all use this table. Constants of models and yield sets come from the [registry](models::registry). To add a key
//! that a map can sweep, add a field to [`CaseNumbers`] and a row to `keys/table.rs`; any other key is a
//! [`KeySchema`](crate::schema::KeySchema) of its section.

mod key;
mod table;

pub(crate) use key::KeyStorage;
pub use key::{Key, Presence};
pub use table::keys;

use super::kind::ModelKind;
use super::map::SweepSpacing;
use super::numbers::CaseNumbers;
use super::value::CaseValue;
use models::common::parameter::Parameter;
use models::registry;
use std::sync::{Mutex, PoisonError};

impl Key {
    /// Finds the row of the key `name`.
    pub fn find_by_name(name: &str) -> Option<&'static Self> {
        keys().iter().find(|key| key.name == name)
    }

    /// Returns the allowed names of a key whose value is a text or a list of texts; `None` if any text is allowed or
    /// the key is a number.
    pub fn allowed_names(&self) -> Option<Vec<String>> {
        let kinds = |kinds: Vec<ModelKind>| kinds.into_iter().map(|kind| kind.name().to_owned());
        Some(match self.name {
            "model.kind" => kinds(ModelKind::all_kinds()).collect(),
            "compare.kinds" => kinds(ModelKind::flow_kinds()).collect(),
            "yield.kind" => {
                registry::yield_sets().into_iter().map(|set| set.name.to_owned()).collect()
            }
            "yield.active" => {
                let sets = registry::yield_sets();
                let names = sets.iter().flat_map(|set| set.conditions);
                names.map(|own| own.0.to_owned()).collect()
            }
            "map.x.parameter" | "map.y.parameter" => {
                SweepParameter::all_parameters().map(SweepParameter::name).collect()
            }
            "map.x.spacing" | "map.y.spacing" => {
                SweepSpacing::ALL.iter().map(|own| own.name().to_owned()).collect()
            }
            _ => return None,
        })
    }
}

/// A scalar that a map can sweep: a number of `[model]`, `[background]`, `[yield]`, `[stress]` or `[wave]`, or one
/// component of a pair.
#[derive(Clone, Copy, Debug)]
pub struct SweepParameter {
    key: &'static Key,
    component_index: usize,
}

impl PartialEq for SweepParameter {
    fn eq(&self, other: &Self) -> bool {
        (self.key.name, self.component_index) == (other.key.name, other.component_index)
    }
}

impl SweepParameter {
    /// Finds the parameter `name`, e.g. `background.pressure` or `background.velocity[0]`.
    pub fn find_by_name(name: &str) -> Option<Self> {
        Self::all_parameters().find(|parameter| parameter.name() == name)
    }

    /// Returns all parameters, in the order of the key table.
    pub fn all_parameters() -> impl Iterator<Item = Self> {
        keys().iter().flat_map(|key| {
            (0..key.storage.component_count())
                .map(move |component| Self { key, component_index: component })
        })
    }

    /// Returns the parameter for the number `index` of a model given as equations, from its key, its name for axes and
    /// its unit. Keys of such numbers live as long as the program; equal ones are kept once.
    pub(crate) fn from_equation_number(index: usize, texts: [&str; 3]) -> Self {
        static KEYS: Mutex<Vec<&'static Key>> = Mutex::new(Vec::new());
        let mut kept = KEYS.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |own: &&&'static Key| {
            [own.name, own.label, own.unit] == texts
                && matches!(own.storage, KeyStorage::EquationNumber(other) if other == index)
        };
        if let Some(key) = kept.iter().find(is_same) {
            return Self { key, component_index: 0 };
        }
        let [name, label, unit] = texts.map(|text| &*text.to_owned().leak());
        let key: &'static Key =
            Box::leak(Box::new(Key::from_equation_number(index, [name, label, unit])));
        kept.push(key);
        Self { key, component_index: 0 }
    }

    /// Returns the name used in `[map]`.
    pub fn name(self) -> String {
        self.format_with_component(self.key.name)
    }

    /// Returns quantity and symbol, for axis labels.
    pub fn label(self) -> String {
        self.format_with_component(self.key.label)
    }

    /// Returns the unit, for axis labels.
    pub fn unit(self) -> &'static str {
        self.key.unit
    }

    /// Returns the row of the key table.
    pub fn key(self) -> &'static Key {
        self.key
    }

    /// Returns the constant of the model `kind` set by this parameter, with its index in the registry entry; `None` if
    /// the parameter is not a constant of the model.
    pub fn model_constant(self, kind: ModelKind) -> Option<(usize, &'static Parameter)> {
        let KeyStorage::ModelConstant(name) = self.key.storage else { return None };
        kind.parameters().iter().enumerate().find(|(_, own)| own.name == name)
    }

    /// Returns the value of the parameter, if present.
    pub fn value(self, numbers: &CaseNumbers) -> Option<f64> {
        match self.key.storage.load_value(numbers)? {
            CaseValue::Number(x) => Some(x),
            CaseValue::Pair(pair) => Some(pair[self.component_index]),
            _ => None,
        }
    }

    /// Sets the value; if a pair is absent, its other component is set to 0.
    pub fn set_value(self, numbers: &mut CaseNumbers, value: f64) {
        match self.key.storage {
            KeyStorage::ModelConstant(name) => numbers.model_constants.set_value(name, value),
            KeyStorage::YieldConstant(name) => numbers.yield_constants.set_value(name, value),
            KeyStorage::Number(f) => *f(numbers) = value,
            KeyStorage::OptionalNumber(f) => *f(numbers) = Some(value),
            KeyStorage::Pair(f) => f(numbers)[self.component_index] = value,
            KeyStorage::OptionalPair(f) => {
                f(numbers).get_or_insert_default()[self.component_index] = value;
            }
            KeyStorage::EquationNumber(index) => numbers.equation_numbers[index] = value,
            // `all_parameters` yields no parameters of other types.
            _ => {}
        }
    }

    fn format_with_component(self, name: &str) -> String {
        match self.key.storage.component_count() {
            1 => name.to_owned(),
            _ => format!("{name}[{}]", self.component_index),
        }
    }
}
