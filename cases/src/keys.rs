//! The one table of keys that a case file may hold.
//!
//! Parsing, refusal of unknown and unused keys, `--set`, the commented files of `wellposed new`
//! and the parameters that a map can sweep all read this table. Constants of flow models come from the
//! [registry](models::registry). To add another key: add a field to [`Numbers`] and a row here.

mod table;

pub use table::keys;

use super::kind::{Kind, Medium, Solid, Yield};
use super::numbers::Numbers;
use super::types::{Range, Type};
use super::value::Value;
use models::granular_flow::Kind as Flow;
pub use models::parameter::Presence;
use models::parameter::{ANGLE, Parameter as Constant};

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Section and name, as in `--set`.
    pub name: &'static str,
    /// Quantity and symbol, for axes and legends.
    pub label: &'static str,
    /// Unit; empty for text and pure numbers.
    pub unit: &'static str,
    /// What the quantity is and what is allowed, in one line.
    pub meaning: &'static str,
    users: Users,
    /// The yield sets that use it; empty if it is no matter whether and how a solid yields.
    sets: &'static [Yield],
    /// What holds where the key is absent.
    pub presence: Presence,
    pub(super) field: Field,
}

/// The kinds of model that use a key.
#[derive(Clone, Copy, Debug)]
enum Users {
    All,
    Flows(fn(Flow) -> bool),
    Solids(&'static [Solid]),
    /// Flows that have a constant of that name.
    FlowsWith(&'static str),
}

/// Type of a value and, for the numbers of a case, where it is kept.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    Text,
    Texts,
    Count,
    Plain,
    Whole(fn(&mut Numbers) -> &mut usize),
    /// A constant of a flow model, by its name.
    Constant(&'static str),
    Number(fn(&mut Numbers) -> &mut f64),
    OptionalNumber(fn(&mut Numbers) -> &mut Option<f64>),
    Pair(fn(&mut Numbers) -> &mut [f64; 2]),
    OptionalPair(fn(&mut Numbers) -> &mut Option<[f64; 2]>),
    OptionalMatrix(fn(&mut Numbers) -> &mut Option<[[f64; 2]; 2]>),
}

/// Of keys for which it is no matter whether and how a solid yields.
const ANY: &[Yield] = &[];

impl Field {
    /// The type of values.
    pub(super) fn value_type(self) -> Type {
        match self {
            Self::Text => Type::Text,
            Self::Texts => Type::Texts,
            Self::Count | Self::Whole(_) => Type::Whole(1),
            Self::Plain | Self::Constant(_) | Self::Number(_) | Self::OptionalNumber(_) => {
                Type::Number(Range::Finite)
            }
            Self::Pair(_) | Self::OptionalPair(_) => Type::Pair,
            Self::OptionalMatrix(_) => Type::Matrix,
        }
    }

    /// Whether the value is kept in [`Numbers`].
    pub(super) fn is_kept(self) -> bool {
        !matches!(self, Self::Text | Self::Texts | Self::Count | Self::Plain)
    }

    /// Number of components that a map can sweep: 0 for what is no scalar or pair.
    fn components(self) -> usize {
        match self {
            Self::Constant(_) | Self::Number(_) | Self::OptionalNumber(_) => 1,
            Self::Pair(_) | Self::OptionalPair(_) => 2,
            _ => 0,
        }
    }

    /// The value kept, if there is one.
    pub(super) fn load(self, numbers: &Numbers) -> Option<Value> {
        let numbers = &mut numbers.clone();
        match self {
            Self::Whole(f) => Some(Value::Count(*f(numbers))),
            Self::Constant(name) => numbers.flow.get(name).map(Value::Number),
            Self::Number(f) => Some(Value::Number(*f(numbers))),
            Self::OptionalNumber(f) => f(numbers).map(Value::Number),
            Self::Pair(f) => Some(Value::Pair(*f(numbers))),
            Self::OptionalPair(f) => f(numbers).map(Value::Pair),
            Self::OptionalMatrix(f) => f(numbers).map(Value::Matrix),
            _ => None,
        }
    }

    /// Keeps a value of this type.
    pub(super) fn store(self, numbers: &mut Numbers, value: &Value) {
        match (self, value) {
            (Self::Whole(f), Value::Count(n)) => *f(numbers) = *n,
            (Self::Constant(name), Value::Number(x)) => numbers.flow.set(name, *x),
            (Self::Number(f), Value::Number(x)) => *f(numbers) = *x,
            (Self::OptionalNumber(f), Value::Number(x)) => *f(numbers) = Some(*x),
            (Self::Pair(f), Value::Pair(x)) => *f(numbers) = *x,
            (Self::OptionalPair(f), Value::Pair(x)) => *f(numbers) = Some(*x),
            (Self::OptionalMatrix(f), Value::Matrix(x)) => *f(numbers) = Some(*x),
            _ => debug_assert!(!self.is_kept(), "a value of another type than its key's"),
        }
    }
}

impl Key {
    /// The row of a constant of a flow model.
    fn of_constant(constant: &'static Constant) -> Self {
        let Constant { name, label, unit, meaning, presence } = *constant;
        let suffix = if unit == ANGLE { "_deg" } else { "" };
        Self {
            name: format!("model.{name}{suffix}").leak(),
            label,
            unit,
            meaning,
            users: Users::FlowsWith(name),
            sets: ANY,
            presence,
            field: Field::Constant(name),
        }
    }

    /// The row of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        keys().iter().find(|key| key.name == name)
    }

    /// Type of its values.
    pub fn value_type(&self) -> Type {
        self.field.value_type()
    }

    /// The words that it may have, where it has not any.
    pub fn words(&self) -> Option<Vec<String>> {
        let kinds = |kinds: Vec<Kind>| kinds.into_iter().map(|kind| kind.name().to_owned());
        Some(match self.name {
            "model.kind" => kinds(Kind::all()).collect(),
            "compare.kinds" => kinds(Kind::flows()).collect(),
            "yield.kind" => Yield::ALL.map(|set| set.name().to_owned()).to_vec(),
            "yield.active" => super::ACTIVE_NAMES.map(str::to_owned).to_vec(),
            "map.x.parameter" | "map.y.parameter" => {
                Parameter::all().map(Parameter::name).collect()
            }
            _ => return None,
        })
    }

    /// Section, and name inside it.
    pub fn split(&self) -> (&'static str, &'static str) {
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }

    /// Whether such media use the key.
    pub fn is_used_by(&self, medium: impl Into<Medium>) -> bool {
        let Medium { kind, yields } = medium.into();
        self.is_for(kind)
            && (self.sets.is_empty() || yields.is_some_and(|set| self.sets.contains(&set)))
    }

    /// Whether such a model uses the key, if it yields as it must for that.
    pub(super) fn is_for(&self, kind: Kind) -> bool {
        match (self.users, kind) {
            (Users::All, _) => true,
            (Users::Flows(uses), Kind::Flow(flow)) => uses(flow),
            (Users::FlowsWith(name), Kind::Flow(flow)) => {
                flow.parameters().iter().any(|own| own.name == name)
            }
            (Users::Solids(solids), Kind::Solid(solid)) => solids.contains(&solid),
            _ => false,
        }
    }

    /// The names of the models that use the key.
    pub(super) fn owners(&self) -> Vec<&'static str> {
        Kind::all().into_iter().filter(|kind| self.is_for(*kind)).map(Kind::name).collect()
    }

    /// The yield sets that use it; empty if it is no matter whether and how a solid yields.
    pub(super) fn sets(&self) -> &'static [Yield] {
        self.sets
    }

    /// Takes the key back to what holds where it is absent.
    pub(super) fn clear(&self, numbers: &mut Numbers) {
        let absent = match self.presence {
            Presence::Default(value) => value,
            _ => 0.0,
        };
        match self.field {
            Field::Whole(f) => *f(numbers) = absent as usize,
            Field::Constant(name) => match self.presence {
                Presence::Default(value) => numbers.flow.set(name, value),
                _ => numbers.flow.remove(name),
            },
            Field::Number(f) => *f(numbers) = absent,
            Field::OptionalNumber(f) => *f(numbers) = None,
            Field::Pair(f) => *f(numbers) = [absent; 2],
            Field::OptionalPair(f) => *f(numbers) = None,
            Field::OptionalMatrix(f) => *f(numbers) = None,
            _ => {}
        }
    }

    /// The value that `wellposed new` shows: default or example, as TOML; `None` for what is no
    /// number of the case.
    pub fn example(&self) -> Option<String> {
        let number = match self.presence {
            Presence::Required(value) | Presence::Default(value) => value,
            Presence::Optional => 0.0,
        };
        let value = match self.field {
            Field::Whole(_) => Value::Count(number as usize),
            Field::Constant(_) | Field::Number(_) | Field::OptionalNumber(_) => {
                Value::Number(number)
            }
            Field::Pair(_) | Field::OptionalPair(_) => Value::Pair([number; 2]),
            Field::OptionalMatrix(_) => Value::Matrix([[number; 2]; 2]),
            _ => return None,
        };
        Some(value.to_string())
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
    /// The parameter of that name: `background.pressure`, `background.velocity[0]`.
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

    /// Unit, as written on an axis.
    pub fn unit(self) -> &'static str {
        self.key.unit
    }

    /// The row of the table.
    pub fn key(self) -> &'static Key {
        self.key
    }

    /// The number, if the case has one.
    pub fn get(self, numbers: &Numbers) -> Option<f64> {
        match self.key.field.load(numbers)? {
            Value::Number(x) => Some(x),
            Value::Pair(pair) => Some(pair[self.component]),
            _ => None,
        }
    }

    /// Sets the number; the other component of an absent pair becomes 0.
    pub fn set(self, numbers: &mut Numbers, value: f64) {
        match self.key.field {
            Field::Constant(name) => numbers.flow.set(name, value),
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
