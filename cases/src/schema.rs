//! Schema of the structured sections: grids, loads, sources, receivers and so on.
//!
//! Each table of a case is a [`Form`], each of its keys an [`Item`] with type, unit, meaning and default. The reader of
//! a section, the templates of `wellposed new`, the reference page and the JSON Schema follow it. To add a case key to a
//! section, add an [`Item`] to its form. Relations between keys are checked by code next to the form. Constants and
//! states, which can be swept, are rows of [`keys`](crate::keys()).

use crate::kind::Kind;
pub use models::common::range::Range;

/// Schema of a table: the keys that it may contain.
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
    /// Remedy if the table is missing.
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
    /// Unit; empty for text and pure numbers.
    pub unit: &'static str,
    /// Whether the key is required, and its default.
    pub need: Need,
    /// Meaning of the key, in one line.
    pub meaning: &'static str,
    /// Note in messages, in parentheses.
    pub(crate) note: &'static str,
    /// Remark at the end of messages.
    pub(crate) remark: &'static str,
    /// Conditions besides those of the group.
    pub when: &'static [Condition],
}

/// Whether a key is required, has a default or is optional. Values are TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Required, with an example.
    Required(&'static str),
    /// Optional with this default.
    Default(&'static str),
    /// Optional as described in the meaning, with an example.
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

/// Known properties of the case that contains a table.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Kind of model; `None` if unknown.
    pub kind: Option<Kind>,
    /// Dimensions of the grid; `None` if unknown.
    pub dimensions: Option<usize>,
    /// Tangential axes of the side to which a table refers, from 0.
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
    /// A whole number not below this bound.
    Whole(u64),
    /// An axis by its number: at most the dimensions of the grid.
    Axis,
    /// An axis of space by its number.
    AxisOfSpace,
    /// Two numbers.
    Pair,
    /// Two rows of two numbers.
    Matrix,
    /// A list of numbers; a single number needs no brackets.
    Numbers(Length),
    /// A positive number for all axes, or one for each.
    PerAxis(Length),
    /// A number for each axis, not all 0.
    Direction,
    /// A list with a minimum number of numbers in a range.
    List(usize, Range),
    /// A list of whole numbers.
    Counts {
        /// Minimum and maximum length of the list.
        length: [usize; 2],
        /// Minimum of the numbers.
        least: usize,
        /// Further property of the numbers.
        order: Order,
    },
    /// Two whole numbers, not both 0.
    Mode,
    /// A square matrix with a row for each axis.
    Tensor,
    /// Samples: at least two pairs of the two named quantities, the first increasing.
    Samples([&'static str; 2]),
    /// A point, or a list of points.
    Points,
    /// A whole number of at least 2, or a list of such numbers.
    Divisions,
    /// One of the allowed words.
    OneOf(Words),
    /// A list of distinct allowed words.
    AnyOf(Words),
    /// An inline table.
    Table(&'static Form),
    /// An inline table with the keys of this section of the case.
    Part(&'static str),
}

/// Property of a list of whole numbers.
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
    /// One item for each tangential axis of a side.
    SideAxes,
    /// One item for each spin: 1 in plane strain, 3 in space.
    Spins,
}

impl Form {
    /// Schema of a section that may occur once.
    pub(crate) const fn section(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        let (layout, is_required, remedy) = (Layout::Section, false, "");
        Self { name, layout, meaning, is_required, remedy, groups }
    }

    /// Schema of a list of sections.
    pub(crate) const fn list(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        Self { layout: Layout::List, ..Self::section(name, meaning, groups) }
    }

    /// Schema of an inline table.
    pub(crate) const fn braces(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [Group],
    ) -> Self {
        Self { layout: Layout::Braces, ..Self::section(name, meaning, groups) }
    }

    /// This schema, required in time-domain simulations; `remedy` says what to add.
    pub(crate) const fn required(self, remedy: &'static str) -> Self {
        Self { is_required: true, remedy, ..self }
    }

    /// Header of the table as written in a file.
    pub fn header(&self) -> String {
        match self.layout {
            Layout::Section => format!("[{}]", self.name),
            Layout::List => format!("[[{}]]", self.name),
            Layout::Braces => format!("{} = {{ … }}", self.name),
        }
    }

    /// All keys with the conditions of their groups; a name may occur several times.
    pub fn items(&self) -> impl Iterator<Item = (&'static [Condition], &'static Item)> {
        self.groups.iter().flat_map(|group| group.items.iter().map(|item| (group.when, item)))
    }

    /// Keys whose conditions all hold.
    pub(crate) fn applicable(
        &self,
        holds: impl Fn(&Condition) -> bool,
    ) -> impl Iterator<Item = &'static Item> {
        let holds = move |(when, item): &(&[Condition], &'static Item)| {
            when.iter().chain(item.when).all(&holds)
        };
        self.items().filter(holds).map(|(_, item)| item)
    }

    /// Discriminator: the key whose value decides which other keys are allowed, with its words.
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

    /// A required key, with an example.
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

    /// An optional key without default, with an example; the meaning describes its absence.
    pub(crate) const fn optional(
        name: &'static str,
        value: Type,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, Need::Optional(example), meaning)
    }

    /// This key with a note in messages, in parentheses.
    pub(crate) const fn note(self, note: &'static str) -> Self {
        Self { note, ..self }
    }

    /// This key with a remark at the end of messages.
    pub(crate) const fn remark(self, remark: &'static str) -> Self {
        Self { remark, ..self }
    }

    /// This key with additional conditions.
    pub(crate) const fn when(self, when: &'static [Condition]) -> Self {
        Self { when, ..self }
    }

    /// Default or example, as TOML.
    pub fn example(&self) -> &'static str {
        match self.need {
            Need::Required(value) | Need::Default(value) | Need::Optional(value) => value,
        }
    }
}

impl Scope {
    /// Number of dimensions; 2 if unknown.
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
    /// Function from a kind of model to its time-domain sections.
    pub(crate) in_time: fn(Kind) -> Vec<&'static Form>,
}

impl Forms {
    /// Whether `section` is a structured section.
    pub(crate) fn has(&self, section: &str) -> bool {
        let mut all = self.solids.iter().chain(self.flows).chain([&self.check]);
        all.any(|form| form.name == section)
    }
}
