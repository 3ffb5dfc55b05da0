//! Schema of the structured sections, e.g. grids, loads, sources and receivers.
//!
//! Each table of a case is a [`Form`], each of its keys an [`Item`] with type, unit, meaning and default. The reader of
//! a section, the templates of `wellposed new`, the reference page and the JSON Schema are derived from it. To add a
//! key to a section, add an [`Item`] to its form, a field, and lines in `read` and `to_toml` of the same file. Relations between keys are checked by code next to the form.
//! Constants and states, which can be swept, are rows of [`keys`](crate::keys()).

use crate::kind::Kind;
pub use models::common::range::Range;

/// Schema of a table: the keys that the table may contain.
#[derive(Debug)]
pub struct Form {
    /// Name of the section, or of the key whose value is the table.
    pub name: &'static str,
    /// Notation of the table.
    pub layout: Layout,
    /// Meaning of the table, in one line.
    pub meaning: &'static str,
    /// Whether a time-domain simulation requires the table.
    pub is_required: bool,
    /// Remedy for messages if the table is missing.
    pub(crate) remedy: &'static str,
    /// Keys of the table, in the order of the reference page.
    pub groups: &'static [Group],
}

/// Notation of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Section `[name]`.
    Section,
    /// List of sections `[[name]]`.
    List,
    /// Inline table `name = { … }`.
    Braces,
}

/// Keys of a table that are allowed under common conditions.
#[derive(Debug)]
pub struct Group {
    /// Conditions, all of which must hold.
    pub when: &'static [Condition],
    /// Keys of the group.
    pub items: &'static [Item],
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Name inside the table.
    pub name: &'static str,
    /// Type and range.
    pub value: Type,
    /// Unit; empty for texts and dimensionless numbers.
    pub unit: &'static str,
    /// Whether the key is required or optional, and its default.
    pub need: Need,
    /// Meaning of the key, in one line.
    pub meaning: &'static str,
    /// Note in messages, printed in parentheses.
    pub(crate) note: &'static str,
    /// Remark at the end of messages.
    pub(crate) remark: &'static str,
    /// Conditions in addition to the conditions of the group.
    pub when: &'static [Condition],
}

/// Requirement of a key: required, with a default, or optional. Values are TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Required, with an example.
    Required(&'static str),
    /// Optional with this default.
    Default(&'static str),
    /// Optional without default; the meaning describes its absence. With an example.
    Optional(&'static str),
}

/// Condition under which a key is allowed in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// Another key has one of these values.
    Is(&'static str, &'static [&'static str]),
    /// Another key is present.
    Present(&'static str),
    /// Another key is absent.
    Absent(&'static str),
    /// The grid has two dimensions.
    Plane,
    /// The grid has three dimensions.
    Space,
}

/// Known properties of the case to which a table belongs.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Kind of model; `None` if unknown.
    pub kind: Option<Kind>,
    /// Number of dimensions of the grid; `None` if unknown.
    pub dimensions: Option<usize>,
    /// Tangential axes of the face to which a table refers, numbered from 0.
    pub(crate) axes: Vec<usize>,
}

/// Function that lists the allowed words of a key in a scope.
pub type Words = fn(&Scope) -> Vec<String>;

/// Type and range of a value.
#[derive(Clone, Copy, Debug)]
pub enum Type {
    /// Text in one line.
    Text,
    /// A list of texts.
    Texts,
    /// Text of letters, digits, `-`, `_` and `.`.
    Name,
    /// Eight hexadecimal digits.
    Hexadecimal,
    /// True or false.
    Truth,
    /// A number.
    Number(Range),
    /// A whole number with this minimum.
    Whole(u64),
    /// An axis number from 1 to the number of dimensions of the grid.
    Axis,
    /// An axis number from 1 to 3.
    AxisOfSpace,
    /// Two numbers.
    Pair,
    /// Two rows of two numbers.
    Matrix,
    /// A list of numbers; brackets are optional around a single number.
    Numbers(Length),
    /// A positive number for all axes, or one positive number for each axis.
    PerAxis(Length),
    /// A number for each axis, not all 0.
    Direction,
    /// A list with a minimum length of numbers in a range.
    List(usize, Range),
    /// A list of whole numbers.
    Counts {
        /// Minimum and maximum length of the list.
        length: [usize; 2],
        /// Minimum of the numbers.
        least: usize,
        /// Additional property of the numbers.
        order: Order,
    },
    /// Two whole numbers, not both 0.
    Mode,
    /// A square matrix with a row for each axis.
    Tensor,
    /// Samples: at least two pairs of the two named quantities; the first quantity strictly increases.
    Samples([&'static str; 2]),
    /// A point, or a list of points.
    Points,
    /// A whole number of at least 2, or a list of whole numbers of at least 2.
    Divisions,
    /// One of the allowed words.
    OneOf(Words),
    /// A list of allowed words without repetition.
    AnyOf(Words),
    /// An inline table.
    Table(&'static Form),
    /// An inline table with keys of this section of the case.
    Part(&'static str),
}

/// Additional property of the numbers in a list of whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// No property.
    Any,
    /// All numbers are even.
    Even,
    /// The numbers are strictly ascending.
    Ascending,
}

/// Length of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Two items.
    Two,
    /// One item for each axis of the grid.
    Axes,
    /// One item for each tangential axis of a face.
    SideAxes,
    /// One item for each spin: 1 in plane strain, 3 in space.
    Spins,
}

impl Form {
    /// Builds the schema of a section that may occur once.
    pub(crate) const fn section(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        let (layout, is_required, remedy) = (Layout::Section, false, "");
        Self { name, layout, meaning, is_required, remedy, groups }
    }

    /// Builds the schema of a list of sections.
    pub(crate) const fn list(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        Self { layout: Layout::List, ..Self::section(name, meaning, groups) }
    }

    /// Builds the schema of an inline table.
    pub(crate) const fn braces(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        Self { layout: Layout::Braces, ..Self::section(name, meaning, groups) }
    }

    /// Marks the table as required in time-domain simulations; `remedy` is printed if it is missing.
    pub(crate) const fn required(self, remedy: &'static str) -> Self {
        Self { is_required: true, remedy, ..self }
    }

    /// Returns the header of the table as written in a case file.
    pub fn header(&self) -> String {
        match self.layout {
            Layout::Section => format!("[{}]", self.name),
            Layout::List => format!("[[{}]]", self.name),
            Layout::Braces => format!("{} = {{ … }}", self.name),
        }
    }

    /// Returns all keys with the conditions of their groups; a name may occur several times.
    pub fn items(&self) -> impl Iterator<Item = (&'static [Condition], &'static Item)> {
        self.groups.iter().flat_map(|group| group.items.iter().map(|item| (group.when, item)))
    }

    /// Returns the keys all of whose conditions hold.
    pub(crate) fn applicable(
        &self,
        holds: impl Fn(&Condition) -> bool,
    ) -> impl Iterator<Item = &'static Item> {
        let holds = move |(when, item): &(&[Condition], &'static Item)| {
            when.iter().chain(item.when).all(&holds)
        };
        self.items().filter(holds).map(|(_, item)| item)
    }

    /// Returns the discriminator, i.e. the key whose value determines the other keys allowed, with its words.
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
    /// Builds a group of keys without conditions.
    pub(crate) const fn always(items: &'static [Item]) -> Self {
        Self { when: &[], items }
    }

    /// Builds a group of keys that are allowed under conditions.
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

    /// Builds a required key, with an example.
    pub(crate) const fn required(
        name: &'static str,
        value: Type,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Required(example), meaning)
    }

    /// Builds a key with a default.
    pub(crate) const fn with_default(
        name: &'static str,
        value: Type,
        unit: &'static str,
        default: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Default(default), meaning)
    }

    /// Builds an optional key without default, with an example; the meaning describes its absence.
    pub(crate) const fn optional(
        name: &'static str,
        value: Type,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Optional(example), meaning)
    }

    /// Adds a note for messages, printed in parentheses.
    pub(crate) const fn note(self, note: &'static str) -> Self {
        Self { note, ..self }
    }

    /// Adds a remark for the end of messages.
    pub(crate) const fn remark(self, remark: &'static str) -> Self {
        Self { remark, ..self }
    }

    /// Sets the conditions in addition to the conditions of the group.
    pub(crate) const fn when(self, when: &'static [Condition]) -> Self {
        Self { when, ..self }
    }

    /// Returns the default or the example, as TOML.
    pub fn example(&self) -> &'static str {
        match self.need {
            Need::Required(value) | Need::Default(value) | Need::Optional(value) => value,
        }
    }
}

impl Scope {
    /// Returns the number of dimensions; 2 if unknown.
    pub fn dimensions(&self) -> usize {
        self.dimensions.unwrap_or(2)
    }
}

/// Schemas of the structured sections of a case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forms {
    /// Time-domain sections of solids, in the order of writing.
    pub(crate) solids: &'static [&'static Form],
    /// Time-domain sections of flows.
    pub(crate) flows: &'static [&'static Form],
    /// The section `[check]`.
    pub(crate) check: &'static Form,
    /// Function from a kind of model to the schemas of its time-domain sections.
    pub(crate) in_time: fn(Kind) -> Vec<&'static Form>,
}

impl Forms {
    /// Returns whether `section` is a structured section.
    pub(crate) fn has(&self, section: &str) -> bool {
        let mut all = self.solids.iter().chain(self.flows).chain([&self.check]);
        all.any(|form| form.name == section)
    }
}
