//! The schema of the sections that are trees: grids, loads, sources, receivers and so on.
//!
//! Each table of a case is a [`Form`], each of its keys an [`Item`] with type, unit, meaning and default. What
//! reads a section, the templates of `wellposed new`, the reference page and the JSON Schema all follow it.
//! Relations between keys are checked by code beside the form. Constants and states, which can be swept, are
//! rows of [`keys`](crate::keys()).

use crate::kind::Kind;
use crate::types::Type;

/// The keys that a table may hold.
#[derive(Debug)]
pub struct Form {
    /// Name of the section, or of the key whose value is the table.
    pub name: &'static str,
    /// How it is written.
    pub layout: Layout,
    /// What it describes, in one line.
    pub meaning: &'static str,
    /// Whether a run in time must have it.
    pub is_required: bool,
    /// What is to be added where it is missing.
    pub(crate) remedy: &'static str,
    /// Its keys, in the order of the reference page.
    pub groups: &'static [Group],
}

/// How a table is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// `[name]`.
    Section,
    /// `[[name]]`, any number of times.
    List,
    /// `name = { … }`.
    Braces,
}

/// Keys that a table may hold under the same conditions.
#[derive(Debug)]
pub struct Group {
    /// All of them hold.
    pub when: &'static [Condition],
    /// The keys.
    pub items: &'static [Item],
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Name inside the table.
    pub name: &'static str,
    /// Type and range.
    pub value: Type,
    /// Unit; empty for text and pure numbers.
    pub unit: &'static str,
    /// What holds where the key is absent.
    pub need: Need,
    /// What it is, in one line.
    pub meaning: &'static str,
    /// What a message says of it, in parentheses.
    pub(crate) note: &'static str,
    /// What a message adds to that.
    pub(crate) remark: &'static str,
    /// Conditions besides those of the group.
    pub when: &'static [Condition],
}

/// What holds where a key is absent. Values are TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// It must be there; this is an example.
    Required(&'static str),
    /// This value.
    Default(&'static str),
    /// What the meaning says; this is an example.
    Optional(&'static str),
}

/// When a key may stand in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// Another key has one of these values.
    Is(&'static str, &'static [&'static str]),
    /// Another key is there.
    Present(&'static str),
    /// Another key is not there.
    Absent(&'static str),
    /// The grid has two dimensions.
    Plane,
    /// The grid has three dimensions.
    Space,
}

/// What is known of the case that a table is in.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Kind of model; `None`: any.
    pub kind: Option<Kind>,
    /// Dimensions of the grid; `None`: any.
    pub dimensions: Option<usize>,
    /// Axes of the side that a table is about, from 0.
    pub(crate) axes: Vec<usize>,
}

impl Form {
    /// A section that may stand once.
    pub(crate) const fn section(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        let (layout, is_required, remedy) = (Layout::Section, false, "");
        Self { name, layout, meaning, is_required, remedy, groups }
    }

    /// A list of sections.
    pub(crate) const fn list(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        Self { layout: Layout::List, ..Self::section(name, meaning, groups) }
    }

    /// A table in braces.
    pub(crate) const fn braces(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        Self { layout: Layout::Braces, ..Self::section(name, meaning, groups) }
    }

    /// The same, which a run in time must have; `remedy` says what to add.
    pub(crate) const fn required(self, remedy: &'static str) -> Self {
        Self { is_required: true, remedy, ..self }
    }

    /// Its header, or the beginning of a line in braces.
    pub fn header(&self) -> String {
        match self.layout {
            Layout::Section => format!("[{}]", self.name),
            Layout::List => format!("[[{}]]", self.name),
            Layout::Braces => format!("{} = {{ … }}", self.name),
        }
    }

    /// All keys, with the conditions of their groups; a name may stand several times.
    pub fn items(&self) -> impl Iterator<Item = (&'static [Condition], &'static Item)> {
        self.groups.iter().flat_map(|group| group.items.iter().map(|item| (group.when, item)))
    }

    /// The keys for which all conditions hold.
    pub(crate) fn applicable(
        &self,
        holds: impl Fn(&Condition) -> bool,
    ) -> impl Iterator<Item = &'static Item> {
        let holds = move |(when, item): &(&[Condition], &'static Item)| {
            when.iter().chain(item.when).all(&holds)
        };
        self.items().filter(holds).map(|(_, item)| item)
    }

    /// The key whose value decides which others there are, and its words.
    pub fn discriminator(&self) -> Option<(&'static Item, Vec<String>)> {
        let key = self.items().flat_map(|(when, item)| when.iter().chain(item.when)).find_map(
            |condition| match condition {
                Condition::Is(key, _) => Some(*key),
                _ => None,
            },
        )?;
        let (_, item) = self.items().find(|(_, item)| item.name == key)?;
        match item.value {
            Type::OneOf(words) => Some((item, words(&Scope::default()))),
            _ => None,
        }
    }
}

impl Group {
    /// Keys without conditions.
    pub(crate) const fn always(items: &'static [Item]) -> Self {
        Self { when: &[], items }
    }

    /// Keys under conditions.
    pub(crate) const fn when(when: &'static [Condition], items: &'static [Item]) -> Self {
        Self { when, items }
    }
}

impl Item {
    const fn new(
        name: &'static str,
        value: Type,
        unit: &'static str,
        need: Need,
        meaning: &'static str,
    ) -> Self {
        Self { name, value, unit, need, meaning, note: "", remark: "", when: &[] }
    }

    /// A key that must be there, with an example.
    pub(crate) const fn required(
        name: &'static str,
        value: Type,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Required(example), meaning)
    }

    /// A key with a default.
    pub(crate) const fn with_default(
        name: &'static str,
        value: Type,
        unit: &'static str,
        default: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Default(default), meaning)
    }

    /// A key that may be absent, with an example; the meaning says what holds then.
    pub(crate) const fn optional(
        name: &'static str,
        value: Type,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Optional(example), meaning)
    }

    /// With what a message says of it in parentheses.
    pub(crate) const fn note(self, note: &'static str) -> Self {
        Self { note, ..self }
    }

    /// With what a message adds after that.
    pub(crate) const fn remark(self, remark: &'static str) -> Self {
        Self { remark, ..self }
    }

    /// With conditions.
    pub(crate) const fn when(self, when: &'static [Condition]) -> Self {
        Self { when, ..self }
    }

    /// Default or example, as TOML.
    pub fn example(&self) -> &'static str {
        match self.need {
            Need::Required(value) | Need::Default(value) | Need::Optional(value) => value,
        }
    }

    /// What is allowed, as a message says it.
    pub(crate) fn expected(&self, scope: &Scope) -> String {
        let mut text = self.value.words(scope);
        match self.unit {
            "" => {}
            "deg" => text += " in degrees",
            unit => text = format!("{text} in {unit}"),
        }
        let along = self.value.axes_in_words(scope);
        if !self.note.is_empty() {
            text = format!("{text} ({}{along})", self.note);
        }
        text + self.remark
    }
}

impl Scope {
    /// The number of dimensions; 2 where it is open.
    pub fn dimensions(&self) -> usize {
        self.dimensions.unwrap_or(2)
    }
}

/// The sections that say how models of a kind are run in time, in the order in which they are written; none
/// where nothing is.
pub fn forms_in_time(kind: Kind) -> Vec<&'static Form> {
    match kind {
        Kind::Solid(_) => crate::dynamics::FORMS.to_vec(),
        Kind::Flow(_) => crate::flow::forms(kind),
    }
}

/// All sections that are trees: those of solids in time, those of flows in time, and `[check]`.
pub fn all_forms() -> [(&'static str, Vec<&'static Form>); 3] {
    [
        ("solids in time", crate::dynamics::FORMS.to_vec()),
        ("flows in time", crate::flow::FORMS.to_vec()),
        ("check", vec![&crate::check::FORM]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
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
