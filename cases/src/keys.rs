//! Table of the scalar keys of case files.
//!
//! Parser, detection of unknown and unused keys, `--set`, the templates of `wellposed new` and the parameters of a map
//! all use this table. Constants of models and yield sets come from the [registry](models::registry). To add a key
//! that a map can sweep, add a field to [`Numbers`] and a row to `keys/table.rs`; any other key is an
//! [`Item`](crate::schema::Item) of its section.

mod key;
mod table;

pub(crate) use key::Field;
pub use key::{Key, Presence};
pub use table::keys;

use super::kind::Kind;
use super::numbers::Numbers;
use super::value::Value;
use models::common::parameter::Parameter as Constant;
use models::registry;

impl Key {
    /// Finds the row of the key `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        keys().iter().find(|key| key.name == name)
    }

    /// Returns the allowed words of a text key; `None` if any text is allowed.
    pub fn words(&self) -> Option<Vec<String>> {
        let kinds = |kinds: Vec<Kind>| kinds.into_iter().map(|kind| kind.name().to_owned());
        Some(match self.name {
            "model.kind" => kinds(Kind::all()).collect(),
            "compare.kinds" => kinds(Kind::flows()).collect(),
            "yield.kind" => {
                registry::yield_sets().into_iter().map(|set| set.name.to_owned()).collect()
            }
            "yield.active" => {
                let sets = registry::yield_sets();
                let names = sets.iter().flat_map(|set| set.conditions);
                names.map(|own| own.0.to_owned()).collect()
            }
            "map.x.parameter" | "map.y.parameter" => {
                Parameter::all().map(Parameter::name).collect()
            }
            _ => return None,
        })
    }
}

/// A scalar that a map can sweep: a number of `[model]`, `[background]`, `[yield]`, `[stress]` or `[wave]`, or one
/// component of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    key: &'static Key,
    component: usize,
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Self) -> bool {
        (self.key.name, self.component) == (other.key.name, other.component)
    }
}

impl Parameter {
    /// Finds the parameter `name`, e.g. `background.pressure` or `background.velocity[0]`.
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.name() == name)
    }

    /// Returns all parameters, in the order of the key table.
    pub fn all() -> impl Iterator<Item = Self> {
        keys().iter().flat_map(|key| {
            (0..key.field.components()).map(move |component| Self { key, component })
        })
    }

    /// Returns the name used in `[map]`.
    pub fn name(self) -> String {
        self.numbered(self.key.name)
    }

    /// Returns quantity and symbol, for axis labels.
    pub fn label(self) -> String {
        self.numbered(self.key.label)
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
    pub fn constant_of(self, kind: Kind) -> Option<(usize, &'static Constant)> {
        let Field::Constant(name) = self.key.field else { return None };
        let constants = match kind {
            Kind::Flow(flow) => flow.parameters(),
            Kind::Solid(solid) => solid.parameters,
        };
        constants.iter().enumerate().find(|(_, own)| own.name == name)
    }

    /// Returns the value of the parameter, if present.
    pub fn get(self, numbers: &Numbers) -> Option<f64> {
        match self.key.field.load(numbers)? {
            Value::Number(x) => Some(x),
            Value::Pair(pair) => Some(pair[self.component]),
            _ => None,
        }
    }

    /// Sets the value; if a pair is absent, its other component is set to 0.
    pub fn set(self, numbers: &mut Numbers, value: f64) {
        match self.key.field {
            Field::Constant(name) => numbers.model.set(name, value),
            Field::YieldConstant(name) => numbers.yields.set(name, value),
            Field::Number(f) => *f(numbers) = value,
            Field::OptionalNumber(f) => *f(numbers) = Some(value),
            Field::Pair(f) => f(numbers)[self.component] = value,
            Field::OptionalPair(f) => {
                f(numbers).get_or_insert_default()[self.component] = value;
            }
            // `all` yields no parameters of other types.
            _ => {}
        }
    }

    fn numbered(self, name: &str) -> String {
        match self.key.field.components() {
            1 => name.to_owned(),
            _ => format!("{name}[{}]", self.component),
        }
    }
}
