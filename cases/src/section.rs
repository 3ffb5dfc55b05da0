//! Reader and writer of a table with a schema.

use super::error::{CaseError, SourcePosition, escape};
use super::key_positions::KeyPositions;
use super::node::{Node, NodeTable, format_segment};
use super::value::{CaseValue, find_similar_name, format_allowed};
use crate::schema::{
    KeyCondition, KeyPresence, KeySchema, SchemaScope, TableLayout, TableSchema, ValueType,
};
use crate::section_schemas::simulation_schemas;
use std::fmt::{Debug, Display};
use toml::de::DeValue;

/// Schema without keys, for the root table and for inline tables whose keys are those of another section.
const OPEN_SCHEMA: TableSchema = TableSchema::new_section("", "", &[]);

/// Table reader. The schema of the table determines allowed keys, types and messages; `finish` reports unknown keys.
pub(super) struct SectionReader<'a> {
    path: String,
    table: &'a NodeTable<'a>,
    positions: &'a KeyPositions,
    schema: &'static TableSchema,
    /// Known properties of the case.
    pub(super) scope: SchemaScope,
}

impl<'a> SectionReader<'a> {
    /// Builds the reader of the root table, which contains all sections.
    pub(super) fn from_root(
        table: &'a NodeTable<'a>,
        positions: &'a KeyPositions,
        scope: SchemaScope,
    ) -> Self {
        Self { path: String::new(), table, positions, schema: &OPEN_SCHEMA, scope }
    }

    /// Returns the positions of the keys of the case.
    pub(super) fn positions(&self) -> &'a KeyPositions {
        self.positions
    }

    /// Returns all entries of the table.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'a str, &'a Node<'a>)> {
        self.table.entries()
    }

    /// Returns the node `name`, whether or not the schema allows it.
    pub(super) fn node(&self, name: &str) -> Option<&'a Node<'a>> {
        self.table.node(name)
    }

    /// Returns whether the table contains `name`.
    pub(super) fn has_key(&self, name: &str) -> bool {
        self.node(name).is_some()
    }

    /// Returns the dotted key of `name` in this table.
    pub(super) fn full_key(&self, name: &str) -> String {
        match self.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        }
    }

    /// Returns an error at the key `name` of this table.
    pub(super) fn key_error(
        &self,
        name: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.positions.key_error(&self.full_key(name), found, allowed)
    }

    /// Returns the position of the key `name` of this table.
    pub(super) fn locate(&self, name: &str) -> SourcePosition {
        self.positions.locate(&self.full_key(name))
    }

    fn is_satisfied(&self, condition: &KeyCondition) -> bool {
        match condition {
            KeyCondition::HasValue(key, names) => {
                let found = self.node(key).and_then(Node::as_text);
                found.is_some_and(|found| names.contains(&found.as_str()))
            }
            KeyCondition::Present(key) => self.has_key(key),
            KeyCondition::Absent(key) => !self.has_key(key),
            KeyCondition::PlaneStrain => self.scope.dimensions() == 2,
            KeyCondition::Space => self.scope.dimensions() == 3,
        }
    }

    /// Returns the schema of the key `name` whose conditions hold, else the first key schema of this name.
    fn find_key_schema(&self, name: &str) -> Option<&'static KeySchema> {
        let named = |item: &&KeySchema| item.name == name;
        let elsewhere = || self.schema.keys().map(|(_, item)| item).find(named);
        self.schema
            .applicable_keys(|condition| self.is_satisfied(condition))
            .find(named)
            .or_else(elsewhere)
    }

    fn describe_expected(&self, name: &str) -> String {
        self.find_key_schema(name).map_or(String::new(), |item| item.describe_expected(&self.scope))
    }

    /// Returns the error of an invalid value.
    pub(super) fn invalid_value_error(&self, name: &str) -> CaseError {
        self.invalid_value_error_with(name, &self.describe_expected(name))
    }

    fn invalid_value_error_with(&self, name: &str, expected: &str) -> CaseError {
        let found = self.node(name).map_or(String::new(), Node::describe);
        self.key_error(name, format!("found {found}"), format!("expected {expected}"))
    }

    /// Returns the error of a missing required key.
    fn missing_key_error(&self, name: &str, expected: &str) -> CaseError {
        let allowed = match self.path.as_str() {
            "" => format!("add {expected}"),
            path if path.contains(['.', '[']) => {
                format!("add {name} to {path}: expected {expected}")
            }
            path => format!("add {name} to [{path}]: expected {expected}"),
        };
        self.key_error(name, "missing", allowed)
    }

    /// Reads an optional value; `None` if absent.
    pub(super) fn read_optional<T: TryFrom<CaseValue>>(
        &self,
        name: &str,
    ) -> Result<Option<T>, CaseError> {
        let Some(node) = self.node(name) else { return Ok(None) };
        let item = self.find_key_schema(name);
        let value = item
            .zip(node.as_value())
            .and_then(|(item, value)| item.value_type.parse_value(value, &self.scope))
            .and_then(|value| T::try_from(value).ok());
        value.map(Some).ok_or_else(|| self.invalid_value_error(name))
    }

    /// Reads a required value.
    pub(super) fn read_required<T: TryFrom<CaseValue>>(&self, name: &str) -> Result<T, CaseError> {
        self.read_optional(name)?
            .ok_or_else(|| self.missing_key_error(name, &self.describe_expected(name)))
    }

    /// Reads a value, or returns its default.
    pub(super) fn read_or_default<T: TryFrom<CaseValue>>(
        &self,
        name: &str,
    ) -> Result<T, CaseError> {
        if let Some(value) = self.read_optional(name)? {
            return Ok(value);
        }
        let default = self.find_key_schema(name).and_then(|item| match item.presence {
            KeyPresence::Default(text) => {
                let value = DeValue::parse(text).ok()?;
                T::try_from(item.value_type.parse_value(value.get_ref(), &self.scope)?).ok()
            }
            KeyPresence::Required(_) | KeyPresence::Optional(_) => None,
        });
        default.ok_or_else(|| self.missing_key_error(name, &self.describe_expected(name)))
    }

    /// Reads a required value with the conversion `read`; `expected` describes the allowed values.
    pub(super) fn read_required_with<T>(
        &self,
        name: &str,
        expected: &str,
        read: impl Fn(&DeValue) -> Option<T>,
    ) -> Result<T, CaseError> {
        let Some(node) = self.node(name) else {
            return Err(self.missing_key_error(name, expected));
        };
        node.as_value().and_then(read).ok_or_else(|| self.invalid_value_error_with(name, expected))
    }

    /// Reads an optional text. It is not checked against `names`, which are listed in messages only.
    pub(super) fn read_optional_text(
        &self,
        name: &str,
        names: &[impl AsRef<str>],
    ) -> Result<Option<String>, CaseError> {
        let Some(node) = self.node(name) else { return Ok(None) };
        let text = node.as_text();
        text.map(Some).ok_or_else(|| {
            self.invalid_value_error_with(name, &format!("one of {}", join_with_commas(names)))
        })
    }

    /// Reads a required text. It is not checked against `names`, which are listed in messages only.
    pub(super) fn read_required_text(
        &self,
        name: &str,
        names: &[impl AsRef<str>],
    ) -> Result<String, CaseError> {
        self.read_optional_text(name, names)?.ok_or_else(|| {
            self.missing_key_error(name, &format!("one of {}", join_with_commas(names)))
        })
    }

    /// Reads an optional choice among `all`; `name_of` returns the name of each.
    pub(super) fn read_optional_choice<T: Copy, N: AsRef<str>>(
        &self,
        name: &str,
        all: &[T],
        name_of: impl Fn(T) -> N,
    ) -> Result<Option<T>, CaseError> {
        let names: Vec<N> = all.iter().map(|&item| name_of(item)).collect();
        let Some(found) = self.read_optional_text(name, &names)? else { return Ok(None) };
        match names.iter().position(|word| word.as_ref() == found) {
            Some(index) => Ok(Some(all[index])),
            None => Err(self.unknown_name_error(name, &found, &names)),
        }
    }

    /// Reads a required choice among `all`; `name_of` returns the name of each.
    pub(super) fn read_choice<T: Copy, N: AsRef<str>>(
        &self,
        name: &str,
        all: &[T],
        name_of: impl Fn(T) -> N,
    ) -> Result<T, CaseError> {
        self.read_optional_choice(name, all, &name_of)?.ok_or_else(|| {
            let names: Vec<N> = all.iter().map(|&item| name_of(item)).collect();
            self.missing_key_error(name, &format!("one of {}", join_with_commas(&names)))
        })
    }

    /// Reads a list of quantities without repetition; `None` if absent. `find` finds a quantity by its name; the names
    /// `among` are listed in messages.
    pub(super) fn read_distinct_list<T: PartialEq>(
        &self,
        key: &str,
        among: &[String],
        find: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<Vec<T>>, CaseError> {
        let Some(node) = self.node(key) else { return Ok(None) };
        let given = node.as_value().and_then(super::value::parse_text_list);
        let given = given.ok_or_else(|| {
            self.invalid_value_error_with(
                key,
                &format!("a list with any of {}", join_with_commas(among)),
            )
        })?;
        let mut all = Vec::new();
        for name in given {
            let own = find(&name).ok_or_else(|| self.unknown_name_error(key, &name, among))?;
            if all.contains(&own) {
                let found = format!("found '{}' twice", escape(&name));
                return Err(self.key_error(key, found, "expected each name once"));
            }
            all.push(own);
        }
        Ok(Some(all))
    }

    /// Returns the error of a text that is not among the allowed names.
    pub(super) fn unknown_name_error(
        &self,
        name: &str,
        found: &str,
        names: &[impl AsRef<str>],
    ) -> CaseError {
        let meant = find_similar_name(found, names.iter().map(AsRef::as_ref));
        let found = format!("found '{}'", escape(found));
        self.key_error(name, found, format_allowed("allowed", meant, names))
    }

    /// Returns the reader of a required subsection.
    pub(super) fn open_required_section(
        &self,
        table_schema: &'static TableSchema,
    ) -> Result<SectionReader<'a>, CaseError> {
        self.open_section(table_schema)?
            .ok_or_else(|| self.missing_key_error(table_schema.name, table_schema.remedy))
    }

    /// Returns the reader of an optional subsection.
    pub(super) fn open_section(
        &self,
        table_schema: &'static TableSchema,
    ) -> Result<Option<SectionReader<'a>>, CaseError> {
        let name = table_schema.name;
        match self.node(name) {
            None => Ok(None),
            Some(Node::Table(table)) => {
                Ok(Some(self.subsection_reader(self.full_key(name), table, table_schema)))
            }
            Some(_) => Err(self.not_a_table_error(name)),
        }
    }

    /// Returns the reader of an optional inline table.
    pub(super) fn open_table(&self, name: &str) -> Result<Option<SectionReader<'a>>, CaseError> {
        let table_schema = match self.find_key_schema(name).map(|item| item.value_type) {
            Some(ValueType::Table(table_schema)) => table_schema,
            _ => &OPEN_SCHEMA,
        };
        match self.node(name) {
            None => Ok(None),
            Some(Node::Table(table)) => {
                Ok(Some(self.subsection_reader(self.full_key(name), table, table_schema)))
            }
            Some(_) => Err(self.not_a_table_error(name)),
        }
    }

    /// Returns the reader of a required inline table.
    pub(super) fn open_required_table(&self, name: &str) -> Result<SectionReader<'a>, CaseError> {
        self.open_table(name)?
            .ok_or_else(|| self.missing_key_error(name, &self.describe_expected(name)))
    }

    fn not_a_table_error(&self, name: &str) -> CaseError {
        let expected = match self.path.as_str() {
            "" => format!("expected a section [{name}]"),
            _ => "expected a table in braces { key = value, ... }".to_owned(),
        };
        let found = self.node(name).map_or(String::new(), Node::describe);
        self.key_error(name, format!("found {found}"), expected)
    }

    /// Returns the readers of a list of subsections; empty if absent.
    pub(super) fn open_list(
        &self,
        table_schema: &'static TableSchema,
    ) -> Result<Vec<SectionReader<'a>>, CaseError> {
        let name = table_schema.name;
        match self.node(name) {
            None => Ok(Vec::new()),
            Some(Node::Tables(tables)) => {
                let path = |index| format!("{}[{index}]", self.full_key(name));
                let section =
                    |(index, table)| self.subsection_reader(path(index), table, table_schema);
                Ok(tables.iter().enumerate().map(section).collect())
            }
            // An empty TOML list is an empty list of tables.
            Some(Node::Value(value)) if value.as_array().is_some_and(|list| list.is_empty()) => {
                Ok(Vec::new())
            }
            Some(node) => {
                let found = format!("found {}", node.describe());
                let expected = match table_schema.layout {
                    TableLayout::InlineTable => "expected a list of tables [{ ... }, ...]".into(),
                    _ => format!("expected sections [[{name}]]"),
                };
                Err(self.key_error(name, found, expected))
            }
        }
    }

    fn subsection_reader(
        &self,
        path: String,
        table: &'a NodeTable<'a>,
        table_schema: &'static TableSchema,
    ) -> SectionReader<'a> {
        SectionReader {
            path,
            table,
            positions: self.positions,
            schema: table_schema,
            scope: self.scope.clone(),
        }
    }

    /// Completes reading: refuses keys that the schema does not allow in this table.
    pub(super) fn finish(self) -> Result<(), CaseError> {
        let mut names: Vec<&str> = Vec::new();
        for item in self.schema.applicable_keys(|condition| self.is_satisfied(condition)) {
            if !names.contains(&item.name) {
                names.push(item.name);
            }
        }
        match self.entries().find(|(name, _)| !names.contains(name)) {
            Some((name, _)) => Err(self.unused_key_error(name, &names)),
            None => Ok(()),
        }
    }

    /// Returns the error of a key that is not allowed here: one of the schema whose conditions do not hold, one of another
    /// section, or an unknown one. `names` are the allowed keys.
    fn unused_key_error(&self, name: &str, names: &[&'static str]) -> CaseError {
        let mut rows = self.schema.keys().filter(|(_, item)| item.name == name);
        if let Some((when, item)) = rows.next() {
            let unmet = when.iter().chain(item.conditions).find(|own| !self.is_satisfied(own));
            if let Some(condition) = unmet.filter(|_| rows.next().is_none()) {
                let (found, allowed) = self.describe_unmet_condition(condition);
                return self.key_error(name, found, allowed);
            }
        }
        // A section of the simulation has the key.
        let schemas = self.scope.kind.map(simulation_schemas).unwrap_or_default();
        let is_top_level = schemas.iter().any(|own| own.name == self.path);
        let owner = schemas.into_iter().find(|own| {
            own.layout == TableLayout::Section && own.keys().any(|(_, item)| item.name == name)
        });
        match owner.filter(|_| is_top_level) {
            Some(owner) => {
                let meant = format!("{}.{name}", owner.name);
                let allowed = format_allowed("allowed here", Some(&meant), names);
                self.key_error(&format_segment(name), "unknown key", allowed)
            }
            None => self.unknown_key_error(name, names),
        }
    }

    /// Describes the fault of a key whose condition does not hold, and the remedy.
    fn describe_unmet_condition(&self, condition: &KeyCondition) -> (String, String) {
        let not_here = "found, but not used here".to_owned();
        match condition {
            KeyCondition::HasValue(key, values) => {
                let found = self.node(key).and_then(Node::as_text);
                let found = found.map_or(String::new(), |own| format!(", here '{}'", escape(&own)));
                let values = values.join(" or ");
                (not_here, format!("leave it out: it is used with {key} {values}{found}"))
            }
            KeyCondition::Present(key) => {
                (not_here, format!("leave it out: it is used beside {key} only"))
            }
            KeyCondition::Absent(key) => {
                (format!("found beside {key}"), "give one of them".to_owned())
            }
            KeyCondition::PlaneStrain => {
                (not_here, "leave it out: it is used in plane strain only".to_owned())
            }
            KeyCondition::Space => (not_here, "leave it out: it is used in space only".to_owned()),
        }
    }

    /// Returns the error of an unknown key.
    pub(super) fn unknown_key_error(&self, name: &str, names: &[impl AsRef<str>]) -> CaseError {
        let meant = find_similar_name(name, names.iter().map(AsRef::as_ref));
        let allowed = format_allowed("allowed here", meant, names);
        self.key_error(&format_segment(name), "unknown key", allowed)
    }
}

/// Joins names with commas.
pub(super) fn join_with_commas(names: &[impl AsRef<str>]) -> String {
    names.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")
}

/// Writer of a resolved table: pairs of key and value as TOML.
#[derive(Default)]
pub(super) struct TableWriter(Vec<(String, String)>);

impl TableWriter {
    /// Adds a number, or a list or matrix of numbers, in the shortest form that parses to the same doubles.
    pub(super) fn with_number(self, name: impl Into<String>, value: impl Debug) -> Self {
        self.with_toml(name, format_args!("{value:?}"))
    }

    /// Adds a text.
    pub(super) fn with_text(self, name: &str, value: impl AsRef<str>) -> Self {
        self.with_toml(name, toml::Value::from(value.as_ref()))
    }

    /// Adds a list of texts.
    pub(super) fn with_text_list(self, name: &str, values: &[impl Display]) -> Self {
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        self.with_toml(name, toml::Value::from(values))
    }

    /// Adds an inline table.
    pub(super) fn with_table(self, name: &str, inner: &Self) -> Self {
        let entry = |(name, value): &(String, String)| format!("{name} = {value}");
        let entries: Vec<String> = inner.0.iter().map(entry).collect();
        self.with_toml(name, format_args!("{{ {} }}", entries.join(", ")))
    }

    /// Adds a list of inline tables.
    pub(super) fn with_table_list(self, name: &str, tables: &[Self]) -> Self {
        let braces = |table: &Self| {
            let entries = table.0.iter().map(|(name, value)| format!("{name} = {value}"));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        };
        let tables: Vec<String> = tables.iter().map(braces).collect();
        self.with_toml(name, format_args!("[{}]", tables.join(", ")))
    }

    /// Adds a value that is already formatted as TOML.
    pub(super) fn with_toml(mut self, name: impl Into<String>, value: impl Display) -> Self {
        self.0.push((name.into(), value.to_string()));
        self
    }

    /// Formats the section as TOML: header and lines.
    pub(super) fn to_section_toml(&self, table_schema: &TableSchema) -> String {
        let lines = self.0.iter().map(|(name, value)| format!("{name} = {value}\n"));
        format!("\n{}\n{}", table_schema.header(), lines.collect::<String>())
    }
}
