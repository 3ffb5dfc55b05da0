//! A row of the key table: a key, the media that use the key, and the storage of its value.

use crate::kind::{Kind, Medium, Solid, Yield};
use crate::numbers::Numbers;
use crate::schema::{Range, Type};
use crate::value::Value;
pub use models::common::parameter::Presence;
use models::common::parameter::{ANGLE, Parameter as Constant};
use models::flow::FlowKind as Flow;
use models::registry;

/// A row of the key table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Section and name, as written in `--set`.
    pub name: &'static str,
    /// Quantity and symbol, for axis labels and legends.
    pub label: &'static str,
    /// Unit; empty for texts and dimensionless numbers.
    pub unit: &'static str,
    /// Meaning and allowed values, in one line.
    pub meaning: &'static str,
    pub(super) users: Users,
    /// Yield sets that use the key; `None` if the key does not depend on the yield set.
    pub(super) sets: Option<Sets>,
    /// Whether the key is required or optional, and its default.
    pub presence: Presence,
    /// Allowed range of a number, independent of other keys. A case file may contain any finite number, since a map may
    /// sweep it; the range is checked when the model or state is built.
    pub range: Range,
    pub(crate) field: Field,
}

/// Kinds of model that use a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum Users {
    All,
    Flows(fn(Flow) -> bool),
    Solids(fn(Solid) -> bool),
    /// Models with a constant of this name; flows and solids share a key if the units are equal.
    With(&'static str),
}

/// Yield sets that use a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sets {
    Any(fn(Yield) -> bool),
    /// Yield sets with a constant of this name.
    With(&'static str),
}

impl Sets {
    /// Returns whether the yield set `set` uses the key in the solid `solid`.
    fn contain(self, set: Yield, solid: Solid) -> bool {
        set.admits(solid)
            && match self {
                Self::Any(uses) => uses(set),
                Self::With(name) => set.parameters_for(solid.theory).any(|own| own.name == name),
            }
    }
}

/// Type of a value and, for numbers, its storage in [`Numbers`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Field {
    Text,
    Texts,
    Count,
    Plain,
    Whole(fn(&mut Numbers) -> &mut usize),
    /// Constant of the model, by name.
    Constant(&'static str),
    /// Constant of the yield set, by name.
    YieldConstant(&'static str),
    Number(fn(&mut Numbers) -> &mut f64),
    OptionalNumber(fn(&mut Numbers) -> &mut Option<f64>),
    Pair(fn(&mut Numbers) -> &mut [f64; 2]),
    OptionalPair(fn(&mut Numbers) -> &mut Option<[f64; 2]>),
    OptionalMatrix(fn(&mut Numbers) -> &mut Option<[[f64; 2]; 2]>),
}

impl Field {
    /// Returns the type of the values.
    pub(crate) fn value_type(self) -> Type {
        match self {
            Self::Text => Type::Text,
            Self::Texts => Type::Texts,
            Self::Count | Self::Whole(_) => Type::Whole(1),
            Self::Plain
            | Self::Constant(_)
            | Self::YieldConstant(_)
            | Self::Number(_)
            | Self::OptionalNumber(_) => Type::Number(Range::Finite),
            Self::Pair(_) | Self::OptionalPair(_) => Type::Pair,
            Self::OptionalMatrix(_) => Type::Matrix,
        }
    }

    /// Returns whether the value is stored in [`Numbers`].
    pub(crate) fn is_kept(self) -> bool {
        !matches!(self, Self::Text | Self::Texts | Self::Count | Self::Plain)
    }

    /// Returns the number of components that a map can sweep: 1 for scalars, 2 for pairs, otherwise 0.
    pub(super) fn components(self) -> usize {
        match self {
            Self::Constant(_)
            | Self::YieldConstant(_)
            | Self::Number(_)
            | Self::OptionalNumber(_) => 1,
            Self::Pair(_) | Self::OptionalPair(_) => 2,
            _ => 0,
        }
    }

    /// Returns the stored value, if any.
    pub(crate) fn load(self, numbers: &Numbers) -> Option<Value> {
        let numbers = &mut numbers.clone();
        match self {
            Self::Whole(f) => Some(Value::Count(*f(numbers))),
            Self::Constant(name) => numbers.model.get(name).map(Value::Number),
            Self::YieldConstant(name) => numbers.yields.get(name).map(Value::Number),
            Self::Number(f) => Some(Value::Number(*f(numbers))),
            Self::OptionalNumber(f) => f(numbers).map(Value::Number),
            Self::Pair(f) => Some(Value::Pair(*f(numbers))),
            Self::OptionalPair(f) => f(numbers).map(Value::Pair),
            Self::OptionalMatrix(f) => f(numbers).map(Value::Matrix),
            _ => None,
        }
    }

    /// Stores a value of the type of this field.
    pub(crate) fn store(self, numbers: &mut Numbers, value: &Value) {
        match (self, value) {
            (Self::Whole(f), Value::Count(n)) => *f(numbers) = *n,
            (Self::Constant(name), Value::Number(x)) => numbers.model.set(name, *x),
            (Self::YieldConstant(name), Value::Number(x)) => numbers.yields.set(name, *x),
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
    /// Builds the row of a constant of a model.
    pub(super) fn of_model(constant: &'static Constant) -> Self {
        let name = constant.name;
        Self::of_constant("model", constant, Users::With(name), None, Field::Constant(name))
    }

    /// Builds the row of a constant of a yield set.
    pub(super) fn of_yield_set(constant: &'static Constant) -> Self {
        let name = constant.name;
        let sets = Some(Sets::With(name));
        Self::of_constant(
            "yield",
            constant,
            Users::Solids(|_| true),
            sets,
            Field::YieldConstant(name),
        )
    }

    fn of_constant(
        section: &str,
        constant: &'static Constant,
        users: Users,
        sets: Option<Sets>,
        field: Field,
    ) -> Self {
        let Constant { name, label, unit, meaning, presence, range } = *constant;
        let suffix = if unit == ANGLE { "_deg" } else { "" };
        let name = format!("{section}.{name}{suffix}").leak();
        Self { name, label, unit, meaning, users, sets, presence, range, field }
    }

    /// Returns the type of the values.
    pub fn value_type(&self) -> Type {
        self.field.value_type()
    }

    /// Splits the name into the section and the name inside it.
    pub fn split(&self) -> (&'static str, &'static str) {
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }

    /// Returns whether `medium` uses the key.
    pub fn is_used_by(&self, medium: impl Into<Medium>) -> bool {
        let Medium { kind, yields } = medium.into();
        let Some(sets) = self.sets else { return self.is_for(kind) };
        match (kind, yields) {
            (Kind::Solid(solid), Some(set)) => self.is_for(kind) && sets.contain(set, solid),
            _ => false,
        }
    }

    /// Returns whether models of `kind` use the key, possibly with some yield set.
    pub(crate) fn is_for(&self, kind: Kind) -> bool {
        if let (Some(sets), Kind::Solid(solid)) = (self.sets, kind)
            && !registry::yield_sets().iter().any(|set| sets.contain(*set, solid))
        {
            return false;
        }
        match (self.users, kind) {
            (Users::All, _) => true,
            (Users::Flows(uses), Kind::Flow(flow)) => uses(flow),
            (Users::Solids(uses), Kind::Solid(solid)) => uses(solid),
            (Users::With(name), Kind::Flow(flow)) => {
                flow.parameters().iter().any(|own| own.name == name)
            }
            (Users::With(name), Kind::Solid(solid)) => {
                solid.parameters.iter().any(|own| own.name == name)
            }
            _ => false,
        }
    }

    /// Returns the names of the models that use the key.
    pub(crate) fn owners(&self) -> Vec<&'static str> {
        Kind::all().into_iter().filter(|kind| self.is_for(*kind)).map(Kind::name).collect()
    }

    /// Returns the names of the yield sets that use the key; empty if the key does not depend on the yield set.
    pub(crate) fn set_names(&self) -> Vec<&'static str> {
        let Some(sets) = self.sets else { return Vec::new() };
        let uses = |set: &Yield| registry::solids().into_iter().any(|own| sets.contain(*set, own));
        registry::yield_sets().into_iter().filter(uses).map(|set| set.name).collect()
    }

    /// Returns the presence of the key for `medium`; for a constant the presence in the registry entry of the medium.
    pub fn presence_for(&self, medium: Medium) -> Presence {
        let constant = match (self.field, medium.kind, medium.yields) {
            (Field::Constant(name), Kind::Flow(flow), _) => {
                flow.parameters().iter().find(|own| own.name == name)
            }
            (Field::Constant(name), Kind::Solid(solid), _) => {
                solid.parameters.iter().find(|own| own.name == name)
            }
            (Field::YieldConstant(name), Kind::Solid(solid), Some(set)) => {
                set.parameters_for(solid.theory).find(|own| own.name == name)
            }
            _ => None,
        };
        constant.map_or(self.presence, |own| own.presence)
    }

    /// Resets the value to the default of the key.
    pub(crate) fn clear(&self, numbers: &mut Numbers) {
        self.clear_to(self.presence, numbers);
    }

    /// Resets the value to the default of `presence`.
    pub(crate) fn clear_to(&self, presence: Presence, numbers: &mut Numbers) {
        let absent = match presence {
            Presence::Default(value) => value,
            _ => 0.0,
        };
        match self.field {
            Field::Whole(f) => *f(numbers) = absent as usize,
            Field::Constant(name) => numbers.model.reset(name, presence),
            Field::YieldConstant(name) => numbers.yields.reset(name, presence),
            Field::Number(f) => *f(numbers) = absent,
            Field::OptionalNumber(f) => *f(numbers) = None,
            Field::Pair(f) => *f(numbers) = [absent; 2],
            Field::OptionalPair(f) => *f(numbers) = None,
            Field::OptionalMatrix(f) => *f(numbers) = None,
            _ => {}
        }
    }

    /// Returns the default or example value as TOML, as printed by `wellposed new`; `None` if the key is not a number.
    pub fn example(&self) -> Option<String> {
        self.example_of(self.presence)
    }

    /// Returns the default or example value for `medium` as TOML, by the registry entry of the medium.
    pub fn example_for(&self, medium: Medium) -> Option<String> {
        self.example_of(self.presence_for(medium))
    }

    fn example_of(&self, presence: Presence) -> Option<String> {
        let number = match presence {
            Presence::Required(value) | Presence::Default(value) => value,
            Presence::Optional => 0.0,
        };
        let value = match self.field {
            Field::Whole(_) => Value::Count(number as usize),
            Field::Constant(_)
            | Field::YieldConstant(_)
            | Field::Number(_)
            | Field::OptionalNumber(_) => Value::Number(number),
            Field::Pair(_) | Field::OptionalPair(_) => Value::Pair([number; 2]),
            Field::OptionalMatrix(_) => Value::Matrix([[number; 2]; 2]),
            _ => return None,
        };
        Some(value.to_string())
    }
}
