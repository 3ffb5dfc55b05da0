//! Schema of the structured sections, e.g. grids, loads, sources and receivers.
//!
//! Each table of a case is a [`TableSchema`], each of its keys a [`KeySchema`] with type, unit, meaning and default.
//! The reader of a section, the templates of `wellposed new`, the reference page and the JSON Schema are derived from
//! these schemas. To add a key to a section, add a [`KeySchema`] to its table schema, a field, and lines in `read` and
//! `to_toml` of the same file. Relations between keys are checked by code next to the table schema. Constants and
//! states, which can be swept, are rows of [`keys`](crate::keys()).

use crate::kind::ModelKind;
pub use models::common::range::AllowedRange;

/// Schema of a table: the keys that the table may contain.
#[derive(Debug)]
pub struct TableSchema {
    /// Name of the section, or of the key whose value is the table.
    pub name: &'static str,
    /// Former name of the section, which is read for one more version.
    pub former_name: Option<&'static str>,
    /// Notation of the table.
    pub layout: TableLayout,
    /// Meaning of the table, in one line.
    pub meaning: &'static str,
    /// Whether a time-domain simulation requires the table.
    pub is_required: bool,
    /// Section that replaces a required table.
    pub(crate) alternative: Option<&'static str>,
    /// Remedy for messages if the table is missing.
    pub(crate) remedy: &'static str,
    /// Keys of the table, in the order of the reference page; empty for `[initial_stress]`, whose keys are stress
    /// components, and for tables with `named_values`.
    pub groups: &'static [KeyGroup],
    /// Values of a table whose keys the case chooses.
    pub named_values: Option<NamedValues>,
}

/// Notation of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableLayout {
    /// Section `[name]`.
    Section,
    /// List of sections `[[name]]`.
    List,
    /// Inline table `name = { … }`.
    InlineTable,
}

/// Keys of a table that are allowed under common conditions.
#[derive(Debug)]
pub struct KeyGroup {
    /// Conditions, all of which must hold.
    pub conditions: &'static [KeyCondition],
    /// Keys of the group.
    pub keys: &'static [KeySchema],
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct KeySchema {
    /// Name inside the table.
    pub name: &'static str,
    /// Former name of the key, which is read for one more version.
    pub former_name: Option<&'static str>,
    /// Type and range.
    pub value_type: ValueType,
    /// Unit; empty for texts and dimensionless numbers.
    pub unit: &'static str,
    /// Whether the key is required or optional, and its default.
    pub presence: KeyPresence,
    /// Meaning of the key, in one line.
    pub meaning: &'static str,
    /// Note in messages, printed in parentheses.
    pub(crate) message_note: &'static str,
    /// Remark at the end of messages.
    pub(crate) message_remark: &'static str,
    /// Conditions in addition to the conditions of the group.
    pub conditions: &'static [KeyCondition],
}

/// Presence of a key: required, optional with a default, or optional without default. Values are given as TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyPresence {
    /// Required, with an example.
    Required(&'static str),
    /// Optional with this default.
    Default(&'static str),
    /// Optional without default, with an example; the meaning of the key states the effect of its absence.
    Optional(&'static str),
}

/// Condition under which a key is allowed in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyCondition {
    /// Another key has one of these values.
    HasValue(&'static str, &'static [&'static str]),
    /// Another key is present.
    Present(&'static str),
    /// Another key is absent.
    Absent(&'static str),
    /// The grid has two dimensions.
    PlaneStrain,
    /// The grid has three dimensions.
    Space,
}

/// Known properties of the case to which a table belongs.
#[derive(Clone, Debug, Default)]
pub struct SchemaScope {
    /// Kind of model; `None` if unknown.
    pub kind: Option<ModelKind>,
    /// Number of dimensions of the grid; `None` if unknown.
    pub dimensions: Option<usize>,
    /// Tangential axes of the face to which a table refers, numbered from 0.
    pub(crate) face_axes: Vec<usize>,
}

/// Function that lists the allowed names of a key in a scope.
pub type AllowedNames = fn(&SchemaScope) -> Vec<String>;

/// Type and range of a value.
#[derive(Clone, Copy, Debug)]
pub enum ValueType {
    /// Text in one line.
    Text,
    /// A list of texts.
    TextList,
    /// Text of 1 to 255 letters, digits, `-`, `_` and `.`.
    Name,
    /// Eight hexadecimal digits.
    Hexadecimal,
    /// True or false.
    Boolean,
    /// A number in this range.
    Number(AllowedRange),
    /// A whole number with this minimum.
    WholeNumber(u64),
    /// An axis number from 1 to the number of dimensions of the grid.
    Axis,
    /// An axis number from 1 to 3.
    SpaceAxis,
    /// Two numbers.
    Pair,
    /// Two rows of two numbers.
    Matrix,
    /// A list of numbers; brackets are optional around a single number.
    Numbers(ListLength),
    /// A positive number for all axes, or one positive number for each axis.
    PerAxis(ListLength),
    /// A number for each axis, not all 0.
    Direction,
    /// A list of numbers in a range, with this minimum length.
    NumberList(usize, AllowedRange),
    /// A list of whole numbers.
    CountList {
        /// Minimum and maximum length of the list.
        length: [usize; 2],
        /// Minimum of the numbers.
        minimum: usize,
        /// Additional property of the numbers.
        order: CountConstraint,
    },
    /// Two whole numbers, not both 0.
    ModeNumbers,
    /// A square matrix with a row for each axis.
    Tensor,
    /// Samples: at least two pairs of numbers, the first of which strictly increases; the two texts describe a pair and
    /// the first numbers in messages.
    Samples([&'static str; 2]),
    /// A point, or a list of points, at most as many as there are axes.
    PointList,
    /// A whole number of at least 2, or a list of whole numbers of at least 2.
    PointCounts,
    /// One of the allowed names.
    OneOf(AllowedNames),
    /// A list of allowed names without repetition.
    AnyOf(AllowedNames),
    /// An inline table.
    Table(&'static TableSchema),
    /// A list of inline tables.
    TableList(&'static TableSchema),
    /// A list of whole numbers from 0.
    IndexList,
    /// An inline table with keys of this section of the case.
    SectionKeys(&'static str),
    /// A table with one entry per name, which the case chooses.
    Named(NamedValues),
}

/// Values of a table whose names the case chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedValues {
    /// Units of unknowns; a list of names if there are none.
    Units,
    /// Numbers, or tables with a value and a unit.
    Parameters,
    /// Expressions or equations.
    Expressions,
    /// Numbers, or tables of the value and of derivatives.
    Background,
}

/// Additional property of the numbers in a list of whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CountConstraint {
    /// No property.
    Unconstrained,
    /// All numbers are even.
    Even,
    /// The numbers are strictly ascending.
    Ascending,
}

/// Length of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListLength {
    /// Two items.
    Two,
    /// One item for each axis of the grid.
    GridAxes,
    /// One item for each tangential axis of a face.
    FaceAxes,
    /// One item for each spin: 1 in plane strain, 3 in space.
    SpinComponents,
}

impl TableLayout {
    /// Returns the header of a table of this name as written in a case file.
    pub(crate) fn format_header(self, name: &str) -> String {
        match self {
            Self::Section => format!("[{name}]"),
            Self::List => format!("[[{name}]]"),
            Self::InlineTable => format!("{name} = {{ … }}"),
        }
    }
}

impl TableSchema {
    /// Builds the schema of a section that may occur once.
    pub(crate) const fn new_section(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [KeyGroup],
    ) -> Self {
        let (layout, is_required, remedy) = (TableLayout::Section, false, "");
        let (former_name, alternative, named_values) = (None, None, None);
        Self {
            name,
            former_name,
            layout,
            meaning,
            is_required,
            alternative,
            remedy,
            groups,
            named_values,
        }
    }

    /// Builds the schema of a section whose keys the case chooses.
    pub(crate) const fn new_open_section(
        name: &'static str,
        meaning: &'static str,
        values: NamedValues,
    ) -> Self {
        Self { named_values: Some(values), ..Self::new_section(name, meaning, &[]) }
    }

    /// Builds the schema of a list of sections.
    pub(crate) const fn new_list(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [KeyGroup],
    ) -> Self {
        Self { layout: TableLayout::List, ..Self::new_section(name, meaning, groups) }
    }

    /// Builds the schema of an inline table.
    pub(crate) const fn new_inline_table(
        name: &'static str,
        meaning: &'static str,
        groups: &'static [KeyGroup],
    ) -> Self {
        Self { layout: TableLayout::InlineTable, ..Self::new_section(name, meaning, groups) }
    }

    /// Marks the table as required in time-domain simulations; `remedy` is printed if it is missing.
    pub(crate) const fn with_remedy(self, remedy: &'static str) -> Self {
        Self { is_required: true, remedy, ..self }
    }

    /// Sets the section that replaces this required table.
    pub(crate) const fn with_alternative(self, section: &'static str) -> Self {
        Self { alternative: Some(section), ..self }
    }

    /// Sets the former name of the section.
    pub(crate) const fn with_former_name(self, former_name: &'static str) -> Self {
        Self { former_name: Some(former_name), ..self }
    }

    /// Returns the header of the table as written in a case file.
    pub fn header(&self) -> String {
        self.layout.format_header(self.name)
    }

    /// Returns the former and the current name of each renamed key.
    pub(crate) fn renamed_keys(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.keys().filter_map(|(_, item)| Some((item.former_name?, item.name)))
    }

    /// Returns all keys with the conditions of their groups; a name may occur several times.
    pub fn keys(&self) -> impl Iterator<Item = (&'static [KeyCondition], &'static KeySchema)> {
        self.groups.iter().flat_map(|group| group.keys.iter().map(|item| (group.conditions, item)))
    }

    /// Returns the keys all of whose conditions hold.
    pub(crate) fn applicable_keys(
        &self,
        holds: impl Fn(&KeyCondition) -> bool,
    ) -> impl Iterator<Item = &'static KeySchema> {
        let holds = move |(when, item): &(&[KeyCondition], &'static KeySchema)| {
            when.iter().chain(item.conditions).all(&holds)
        };
        self.keys().filter(holds).map(|(_, item)| item)
    }

    /// Returns the discriminator, i.e. the key whose value determines the other keys allowed, with its names.
    pub fn discriminator(&self) -> Option<(&'static KeySchema, Vec<String>)> {
        let key = self
            .keys()
            .flat_map(|(when, item)| when.iter().chain(item.conditions))
            .find_map(|condition| match condition {
                KeyCondition::HasValue(key, _) => Some(*key),
                _ => None,
            })?;
        let (_, item) = self.keys().find(|(_, item)| item.name == key)?;
        match item.value_type {
            ValueType::OneOf(allowed_names) => Some((item, allowed_names(&SchemaScope::default()))),
            _ => None,
        }
    }
}

impl KeyGroup {
    /// Builds a group of keys without conditions.
    pub(crate) const fn new(items: &'static [KeySchema]) -> Self {
        Self { conditions: &[], keys: items }
    }

    /// Builds a group of keys that are allowed under conditions.
    pub(crate) const fn with_conditions(
        conditions: &'static [KeyCondition],
        items: &'static [KeySchema],
    ) -> Self {
        Self { conditions, keys: items }
    }
}

impl KeySchema {
    const fn new(
        name: &'static str,
        value: ValueType,
        unit: &'static str,
        need: KeyPresence,
        meaning: &'static str,
    ) -> Self {
        Self {
            name,
            former_name: None,
            value_type: value,
            unit,
            presence: need,
            meaning,
            message_note: "",
            message_remark: "",
            conditions: &[],
        }
    }

    /// Builds a required key, with an example.
    pub(crate) const fn new_required(
        name: &'static str,
        value: ValueType,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, KeyPresence::Required(example), meaning)
    }

    /// Builds a key with a default.
    pub(crate) const fn new_with_default(
        name: &'static str,
        value: ValueType,
        unit: &'static str,
        default: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, KeyPresence::Default(default), meaning)
    }

    /// Builds an optional key without default, with an example; `meaning` states the effect of its absence.
    pub(crate) const fn new_optional(
        name: &'static str,
        value: ValueType,
        unit: &'static str,
        example: &'static str,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, value, unit, KeyPresence::Optional(example), meaning)
    }

    /// Sets the former name of the key.
    pub(crate) const fn with_former_name(self, former_name: &'static str) -> Self {
        Self { former_name: Some(former_name), ..self }
    }

    /// Adds a note for messages, printed in parentheses.
    pub(crate) const fn with_note(self, with_note: &'static str) -> Self {
        Self { message_note: with_note, ..self }
    }

    /// Adds a remark for the end of messages.
    pub(crate) const fn with_remark(self, with_remark: &'static str) -> Self {
        Self { message_remark: with_remark, ..self }
    }

    /// Sets the conditions in addition to the conditions of the group.
    pub(crate) const fn with_conditions(self, conditions: &'static [KeyCondition]) -> Self {
        Self { conditions, ..self }
    }

    /// Returns the default or the example, as TOML.
    pub fn example_value(&self) -> &'static str {
        match self.presence {
            KeyPresence::Required(value)
            | KeyPresence::Default(value)
            | KeyPresence::Optional(value) => value,
        }
    }
}

impl SchemaScope {
    /// Returns the number of dimensions; 2 if unknown.
    pub fn dimensions(&self) -> usize {
        self.dimensions.unwrap_or(2)
    }
}

/// Schemas of the structured sections of a case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CaseSchemas {
    /// Time-domain sections of solids, in the order of writing.
    pub(crate) solids: &'static [&'static TableSchema],
    /// Time-domain sections of flows.
    pub(crate) flows: &'static [&'static TableSchema],
    /// Sections of plane waves in granular and porous media.
    pub(crate) plane_waves: &'static [&'static TableSchema],
    /// Sections of rheological schemes.
    pub(crate) rheology: &'static [&'static TableSchema],
    /// Sections of models given as equations.
    pub(crate) equations: &'static [&'static TableSchema],
    /// The section `[check]`.
    pub(crate) check: &'static TableSchema,
    /// Function from a kind of model to the schemas of its time-domain sections.
    pub(crate) simulation: fn(ModelKind) -> Vec<&'static TableSchema>,
}

impl CaseSchemas {
    /// Returns whether `section` is a structured section.
    pub(crate) fn has_section(&self, section: &str) -> bool {
        self.all().any(|table_schema| table_schema.name == section)
    }

    /// Returns all schemas.
    pub(crate) fn all(&self) -> impl Iterator<Item = &'static TableSchema> + use<> {
        let sections = self.solids.iter().chain(self.flows).chain(self.plane_waves);
        sections.chain(self.rheology).chain(self.equations).copied().chain([self.check])
    }

    /// Finds the schema of a section by its former name.
    pub(crate) fn find_by_former_name(&self, name: &str) -> Option<&'static TableSchema> {
        self.all().find(|table_schema| table_schema.former_name == Some(name))
    }
}
