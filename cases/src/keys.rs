//! Table of the scalar keys of case files.
//!
//! Parsing, refusal of unknown and unused keys, `--set`, the templates of `wellposed new`
//! and the parameters of a map all use this table. Constants of models and yield sets come from the
//! [registry](models::registry). To add a case key: add a field to [`Numbers`] and a row here.

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
    /// The row of the key called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        keys().iter().find(|key| key.name == name)
    }

    /// Allowed words of a text key; `None` if any text is allowed.
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

/// A scalar that a map can sweep: a number of `[model]`, `[background]`, `[yield]`, `[stress]` or
/// `[wave]`, or a component of a pair. Cheap to copy and to set.
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
    /// The parameter called `name`, e.g. `background.pressure`, `background.velocity[0]`.
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.name() == name)
    }

    /// All parameters, in the order of the table.
    pub fn all() -> impl Iterator<Item = Self> {
        keys().iter().flat_map(|key| {
            (0..key.field.components()).map(move |component| Self { key, component })
        })
    }

    /// Name as in `[map]`.
    pub fn name(self) -> String {
        self.numbered(self.key.name)
    }

    /// Quantity and symbol, for axes.
    pub fn label(self) -> String {
        self.numbered(self.key.label)
    }

    /// Unit, as written on axes.
    pub fn unit(self) -> &'static str {
        self.key.unit
    }

    /// Row of the key table.
    pub fn key(self) -> &'static Key {
        self.key
    }

    /// The constant of the model `kind` set by this parameter, with its index in the registry entry; `None` if the
    /// parameter is no constant of the model.
    pub fn constant_of(self, kind: Kind) -> Option<(usize, &'static Constant)> {
        let Field::Constant(name) = self.key.field else { return None };
        let constants = match kind {
            Kind::Flow(flow) => flow.parameters(),
            Kind::Solid(solid) => solid.parameters,
        };
        constants.iter().enumerate().find(|(_, own)| own.name == name)
    }

    /// Value of the parameter, if present.
    pub fn get(self, numbers: &Numbers) -> Option<f64> {
        match self.key.field.load(numbers)? {
            Value::Number(x) => Some(x),
            Value::Pair(pair) => Some(pair[self.component]),
            _ => None,
        }
    }

    /// Sets the value; the other component of an absent pair becomes 0.
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
            // `all` makes no parameters of other types.
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
