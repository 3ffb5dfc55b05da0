//! The schema of the sections that are trees: grids, loads, sources, receivers and so on.
//!
//! Each table of a case is a [`Form`], each of its keys an [`Item`] with type, unit, meaning and default. What
//! reads a section, the templates of `wellposed new`, the reference page and the JSON Schema all follow it.
//! Relations between keys are checked by code beside the form. Constants and states, which can be swept, are
//! rows of [`keys`](crate::keys()).

use crate::kind::Kind;
pub use models::common::range::Range;

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

/// Words that a key may have, of a case of which something is known.
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
    /// A whole number of at least this.
    Whole(u64),
    /// An axis by its number: at most the dimensions of the grid.
    Axis,
    /// An axis of space by its number.
    AxisOfSpace,
    /// Two numbers.
    Pair,
    /// Two rows of two numbers.
    Matrix,
    /// A list of numbers; one alone needs no brackets.
    Numbers(Length),
    /// A positive number for all axes, or one for each.
    PerAxis(Length),
    /// A number for each axis, not all 0.
    Direction,
    /// A list of at least so many numbers.
    List(usize, Range),
    /// A list of whole numbers.
    Counts {
        /// Least and greatest length of the list.
        length: [usize; 2],
        /// Least number.
        least: usize,
        /// What else holds of them.
        order: Order,
    },
    /// Two whole numbers, not both 0.
    Mode,
    /// A square matrix with a row for each axis.
    Tensor,
    /// At least two pairs of these two quantities, the first one increasing.
    Samples([&'static str; 2]),
    /// A point, or a list of points.
    Points,
    /// A whole number of at least 2, or a list of such numbers.
    Divisions,
    /// One of some words.
    OneOf(Words),
    /// A list of different ones of some words.
    AnyOf(Words),
    /// A table in braces.
    Table(&'static Form),
    /// A table in braces with keys of this section of the case.
    Part(&'static str),
}

/// What holds of a list of whole numbers besides its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Nothing.
    Any,
    /// They are even.
    Even,
    /// Each is greater than the one before.
    Ascending,
}

/// Length of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Two.
    Two,
    /// One for each axis of the grid.
    Axes,
    /// One for each axis of a side.
    SideAxes,
    /// One for each spin: 1 in plane strain, 3 in space.
    Spins,
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
}

impl Scope {
    /// The number of dimensions; 2 where it is open.
    pub fn dimensions(&self) -> usize {
        self.dimensions.unwrap_or(2)
    }
}

/// The sections of a case that are trees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forms {
    /// Those of solids in time, in the order in which they are written.
    pub(crate) solids: &'static [&'static Form],
    /// Those of flows in time.
    pub(crate) flows: &'static [&'static Form],
    /// The section `[check]`.
    pub(crate) check: &'static Form,
    /// Those by which models of a kind are run in time.
    pub(crate) in_time: fn(Kind) -> Vec<&'static Form>,
}

impl Forms {
    /// Whether a section of that name is among them.
    pub(crate) fn has(&self, section: &str) -> bool {
        let mut all = self.solids.iter().chain(self.flows).chain([&self.check]);
        all.any(|form| form.name == section)
    }
}
