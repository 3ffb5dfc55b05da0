//! A row of the key table: a key, the media that use the key, and the storage of its value.

use crate::kind::{MediumKind, ModelKind, SolidKind, YieldSetKind};
use crate::numbers::CaseNumbers;
use crate::schema::{AllowedRange, ValueType};
use crate::value::CaseValue;
pub use models::common::parameter::Presence;
use models::common::parameter::{ANGLE_UNIT, Parameter};
use models::flow::FlowKind;
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
    pub(super) model_filter: ModelFilter,
    /// Yield sets that use the key; `None` if the key does not depend on the yield set.
    pub(super) yield_set_filter: Option<YieldSetFilter>,
    /// Whether the key is required or optional, and its default.
    pub presence: Presence,
    /// Allowed range of a number, independent of other keys. A case file may contain any finite number, since a map may
    /// sweep it; the range is checked when the model or state is built, for `[wave]` on reading.
    pub range: AllowedRange,
    pub(crate) storage: KeyStorage,
}

/// Kinds of model that use a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum ModelFilter {
    AllModels,
    Flows(fn(FlowKind) -> bool),
    Solids(fn(SolidKind) -> bool),
    /// Models, both flows and solids, with a constant of this name.
    HavingConstant(&'static str),
}

/// Yield sets that use a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum YieldSetFilter {
    Predicate(fn(YieldSetKind) -> bool),
    /// Yield sets with a constant of this name.
    HavingConstant(&'static str),
}

impl YieldSetFilter {
    /// Returns whether the yield set `set` uses the key in the solid `solid`.
    fn is_satisfied_by(self, set: YieldSetKind, solid: SolidKind) -> bool {
        set.is_compatible(solid)
            && match self {
                Self::Predicate(uses) => uses(set),
                Self::HavingConstant(name) => {
                    set.parameters_for(solid.theory).any(|own| own.name == name)
                }
            }
    }
}

/// Type of a value and, for numbers, its storage in [`CaseNumbers`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum KeyStorage {
    Text,
    TextList,
    Count,
    UnstoredNumber,
    StoredCount(fn(&mut CaseNumbers) -> &mut usize),
    /// Constant of the model, by name.
    ModelConstant(&'static str),
    /// Constant of the yield set, by name.
    YieldConstant(&'static str),
    Number(fn(&mut CaseNumbers) -> &mut f64),
    OptionalNumber(fn(&mut CaseNumbers) -> &mut Option<f64>),
    Pair(fn(&mut CaseNumbers) -> &mut [f64; 2]),
    OptionalPair(fn(&mut CaseNumbers) -> &mut Option<[f64; 2]>),
    OptionalMatrix(fn(&mut CaseNumbers) -> &mut Option<[[f64; 2]; 2]>),
    /// Number of a model given as equations, by index.
    EquationNumber(usize),
}

impl KeyStorage {
    /// Returns the type of the values.
    pub(crate) fn value_type(self) -> ValueType {
        match self {
            Self::Text => ValueType::Text,
            Self::TextList => ValueType::TextList,
            Self::Count | Self::StoredCount(_) => ValueType::WholeNumber(1),
            Self::UnstoredNumber
            | Self::ModelConstant(_)
            | Self::YieldConstant(_)
            | Self::Number(_)
            | Self::EquationNumber(_)
            | Self::OptionalNumber(_) => ValueType::Number(AllowedRange::Finite),
            Self::Pair(_) | Self::OptionalPair(_) => ValueType::Pair,
            Self::OptionalMatrix(_) => ValueType::Matrix,
        }
    }

    /// Returns whether the value is stored in [`CaseNumbers`].
    pub(crate) fn is_stored(self) -> bool {
        !matches!(self, Self::Text | Self::TextList | Self::Count | Self::UnstoredNumber)
    }

    /// Returns the number of components that a map can sweep: 1 for scalars, 2 for pairs, otherwise 0.
    pub(super) fn component_count(self) -> usize {
        match self {
            Self::ModelConstant(_)
            | Self::YieldConstant(_)
            | Self::Number(_)
            | Self::EquationNumber(_)
            | Self::OptionalNumber(_) => 1,
            Self::Pair(_) | Self::OptionalPair(_) => 2,
            _ => 0,
        }
    }

    /// Returns the stored value, if any.
    pub(crate) fn load_value(self, numbers: &CaseNumbers) -> Option<CaseValue> {
        let numbers = &mut numbers.clone();
        match self {
            Self::StoredCount(f) => Some(CaseValue::Count(*f(numbers))),
            Self::ModelConstant(name) => numbers.model_constants.value(name).map(CaseValue::Number),
            Self::YieldConstant(name) => numbers.yield_constants.value(name).map(CaseValue::Number),
            Self::Number(f) => Some(CaseValue::Number(*f(numbers))),
            Self::OptionalNumber(f) => f(numbers).map(CaseValue::Number),
            Self::Pair(f) => Some(CaseValue::Pair(*f(numbers))),
            Self::OptionalPair(f) => f(numbers).map(CaseValue::Pair),
            Self::OptionalMatrix(f) => f(numbers).map(CaseValue::Matrix),
            Self::EquationNumber(index) => {
                numbers.equation_numbers.get(index).copied().map(CaseValue::Number)
            }
            _ => None,
        }
    }

    /// Stores a value of the type [`value_type`](Self::value_type) in `numbers`; values of keys that are not stored are
    /// ignored.
    pub(crate) fn store_value(self, numbers: &mut CaseNumbers, value: &CaseValue) {
        match (self, value) {
            (Self::StoredCount(f), CaseValue::Count(n)) => *f(numbers) = *n,
            (Self::ModelConstant(name), CaseValue::Number(x)) => {
                numbers.model_constants.set_value(name, *x)
            }
            (Self::YieldConstant(name), CaseValue::Number(x)) => {
                numbers.yield_constants.set_value(name, *x)
            }
            (Self::Number(f), CaseValue::Number(x)) => *f(numbers) = *x,
            (Self::OptionalNumber(f), CaseValue::Number(x)) => *f(numbers) = Some(*x),
            (Self::Pair(f), CaseValue::Pair(x)) => *f(numbers) = *x,
            (Self::OptionalPair(f), CaseValue::Pair(x)) => *f(numbers) = Some(*x),
            (Self::OptionalMatrix(f), CaseValue::Matrix(x)) => *f(numbers) = Some(*x),
            (Self::EquationNumber(index), CaseValue::Number(x)) => {
                numbers.equation_numbers[index] = *x;
            }
            _ => debug_assert!(!self.is_stored(), "a value of another type than its key's"),
        }
    }
}

impl Key {
    /// Builds the row of a constant of a model.
    pub(super) fn from_model_constant(constant: &'static Parameter) -> Self {
        let name = constant.name;
        Self::from_constant(
            "model",
            constant,
            ModelFilter::HavingConstant(name),
            None,
            KeyStorage::ModelConstant(name),
        )
    }

    /// Builds the row of a constant of a yield set.
    pub(super) fn from_yield_constant(constant: &'static Parameter) -> Self {
        let name = constant.name;
        let sets = Some(YieldSetFilter::HavingConstant(name));
        Self::from_constant(
            "yield",
            constant,
            ModelFilter::Solids(|_| true),
            sets,
            KeyStorage::YieldConstant(name),
        )
    }

    /// Builds the row of the number `index` of a model given as equations, from key, name for axes and unit.
    pub(super) fn from_equation_number(
        index: usize,
        [name, label, unit]: [&'static str; 3],
    ) -> Self {
        Self {
            name,
            label,
            unit,
            meaning: "number of a model given as equations",
            model_filter: ModelFilter::Flows(|_| false),
            yield_set_filter: None,
            presence: Presence::Required(0.0),
            range: AllowedRange::Finite,
            storage: KeyStorage::EquationNumber(index),
        }
    }

    fn from_constant(
        section: &str,
        constant: &'static Parameter,
        users: ModelFilter,
        sets: Option<YieldSetFilter>,
        field: KeyStorage,
    ) -> Self {
        let Parameter { name, label, unit, meaning, presence, range } = *constant;
        let suffix = if unit == ANGLE_UNIT { "_deg" } else { "" };
        let name = format!("{section}.{name}{suffix}").leak();
        Self {
            name,
            label,
            unit,
            meaning,
            model_filter: users,
            yield_set_filter: sets,
            presence,
            range,
            storage: field,
        }
    }

    /// Returns the type of the values.
    pub fn value_type(&self) -> ValueType {
        self.storage.value_type()
    }

    /// Splits the name into the section and the name inside it.
    pub fn split_section(&self) -> (&'static str, &'static str) {
        self.name.rsplit_once('.').unwrap_or(("", self.name))
    }

    /// Returns whether `medium` uses the key.
    pub fn is_used_by(&self, medium: impl Into<MediumKind>) -> bool {
        let MediumKind { kind, yield_set: yields } = medium.into();
        let Some(sets) = self.yield_set_filter else { return self.is_used_by_kind(kind) };
        match (kind, yields) {
            (ModelKind::Solid(solid), Some(set)) => {
                self.is_used_by_kind(kind) && sets.is_satisfied_by(set, solid)
            }
            _ => false,
        }
    }

    /// Returns whether models of `kind` use the key, possibly with some yield set.
    pub(crate) fn is_used_by_kind(&self, kind: ModelKind) -> bool {
        if let (Some(sets), ModelKind::Solid(solid)) = (self.yield_set_filter, kind)
            && !registry::yield_sets().iter().any(|set| sets.is_satisfied_by(*set, solid))
        {
            return false;
        }
        match (self.model_filter, kind) {
            // Of the scalar keys a rheological scheme or a model given as equations has only those before the first
            // section.
            (ModelFilter::AllModels, ModelKind::Rheology | ModelKind::Equations) => {
                self.split_section().0.is_empty()
            }
            (ModelFilter::AllModels, _) => true,
            (ModelFilter::Flows(uses), ModelKind::Flow(flow)) => uses(flow),
            (ModelFilter::Solids(uses), ModelKind::Solid(solid)) => uses(solid),
            (ModelFilter::HavingConstant(name), _) => {
                kind.parameters().iter().any(|own| own.name == name)
            }
            _ => false,
        }
    }

    /// Returns the names of the models that use the key.
    pub(crate) fn model_names(&self) -> Vec<&'static str> {
        ModelKind::all_kinds()
            .into_iter()
            .filter(|kind| self.is_used_by_kind(*kind))
            .map(ModelKind::name)
            .collect()
    }

    /// Returns the names of the yield sets that use the key; empty if the key does not depend on the yield set.
    pub(crate) fn yield_set_names(&self) -> Vec<&'static str> {
        let Some(sets) = self.yield_set_filter else { return Vec::new() };
        let uses = |set: &YieldSetKind| {
            registry::solids().into_iter().any(|own| sets.is_satisfied_by(*set, own))
        };
        registry::yield_sets().into_iter().filter(uses).map(|set| set.name).collect()
    }

    /// Returns the presence of the key for `medium`; for a constant the presence in the registry entry of the medium.
    pub fn presence_for(&self, medium: MediumKind) -> Presence {
        let constant = match (self.storage, medium.kind, medium.yield_set) {
            (KeyStorage::ModelConstant(name), kind, _) => {
                kind.parameters().iter().find(|own| own.name == name)
            }
            (KeyStorage::YieldConstant(name), ModelKind::Solid(solid), Some(set)) => {
                set.parameters_for(solid.theory).find(|own| own.name == name)
            }
            _ => None,
        };
        constant.map_or(self.presence, |own| own.presence)
    }

    /// Resets the value to the default of the key, as [`reset_value_to`](Self::reset_value_to).
    pub(crate) fn reset_value(&self, numbers: &mut CaseNumbers) {
        self.reset_value_to(self.presence, numbers);
    }

    /// Resets the value to the default of `presence`, or to 0 if there is none; optional values and constants without
    /// default become absent.
    pub(crate) fn reset_value_to(&self, presence: Presence, numbers: &mut CaseNumbers) {
        let absent = match presence {
            Presence::Default(value) => value,
            _ => 0.0,
        };
        match self.storage {
            KeyStorage::StoredCount(f) => *f(numbers) = absent as usize,
            KeyStorage::ModelConstant(name) => numbers.model_constants.reset(name, presence),
            KeyStorage::YieldConstant(name) => numbers.yield_constants.reset(name, presence),
            KeyStorage::Number(f) => *f(numbers) = absent,
            KeyStorage::OptionalNumber(f) => *f(numbers) = None,
            KeyStorage::Pair(f) => *f(numbers) = [absent; 2],
            KeyStorage::OptionalPair(f) => *f(numbers) = None,
            KeyStorage::OptionalMatrix(f) => *f(numbers) = None,
            _ => {}
        }
    }

    /// Returns the default or example value as TOML, as printed by `wellposed new`; 0 for an optional key, `None` for
    /// texts and numbers of `[map]`.
    pub fn example_value(&self) -> Option<String> {
        self.example_value_from(self.presence)
    }

    /// Returns the value as [`example_value`](Self::example_value) does, for a constant from the registry entry of
    /// `medium`.
    pub fn example_value_for(&self, medium: MediumKind) -> Option<String> {
        self.example_value_from(self.presence_for(medium))
    }

    fn example_value_from(&self, presence: Presence) -> Option<String> {
        let number = match presence {
            Presence::Required(value) | Presence::Default(value) => value,
            Presence::Optional => 0.0,
        };
        let value = match self.storage {
            KeyStorage::StoredCount(_) => CaseValue::Count(number as usize),
            KeyStorage::ModelConstant(_)
            | KeyStorage::YieldConstant(_)
            | KeyStorage::Number(_)
            | KeyStorage::OptionalNumber(_) => CaseValue::Number(number),
            KeyStorage::Pair(_) | KeyStorage::OptionalPair(_) => CaseValue::Pair([number; 2]),
            KeyStorage::OptionalMatrix(_) => CaseValue::Matrix([[number; 2]; 2]),
            _ => return None,
        };
        Some(value.to_string())
    }
}
