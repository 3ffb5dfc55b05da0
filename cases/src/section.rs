//! Reader and writer of a table with a schema.

use super::error::{CaseError, Place, escape};
use super::node::{Node, Table, segment};
use super::place::Places;
use super::value::{Value, nearest, suggestion};
use crate::schema::{Condition, Form, Item, Need, Scope, Type};
use std::fmt::{Debug, Display};
use toml::de::DeValue;

/// Empty schema, for the root table and for inline tables with keys of another section.
const OPEN: Form = Form::section("", "", &[]);

/// Table reader. The schema of the table determines allowed keys, types and messages; `finish` reports unknown keys.
pub(super) struct Section<'a> {
    path: String,
    table: &'a Table<'a>,
    places: &'a Places,
    form: &'static Form,
    /// Known properties of the case.
    pub(super) scope: Scope,
}

impl<'a> Section<'a> {
    /// Builds the reader of the root table, which contains all sections.
    pub(super) fn root(table: &'a Table<'a>, places: &'a Places, scope: Scope) -> Self {
        Self { path: String::new(), table, places, form: &OPEN, scope }
    }

    /// Returns the positions of the keys of the case.
    pub(super) fn places(&self) -> &'a Places {
        self.places
    }

    /// Returns all entries of the table.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'a str, &'a Node<'a>)> {
        self.table.entries()
    }

    /// Returns the node `name`, whether or not the schema allows it.
    pub(super) fn node(&self, name: &str) -> Option<&'a Node<'a>> {
        self.table.get(name)
    }

    /// Returns whether the table contains `name`.
    pub(super) fn has(&self, name: &str) -> bool {
        self.node(name).is_some()
    }

    /// Returns the dotted key of `name` in this table.
    pub(super) fn key(&self, name: &str) -> String {
        match self.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        }
    }

    /// Returns an error at the key `name` of this table.
    pub(super) fn error(
        &self,
        name: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(&self.key(name), found, allowed)
    }

    /// Returns the position of the key `name` of this table.
    pub(super) fn place(&self, name: &str) -> Place {
        self.places.of(&self.key(name))
    }

    fn holds(&self, condition: &Condition) -> bool {
        match condition {
            Condition::Is(key, words) => {
                let found = self.node(key).and_then(Node::text);
                found.is_some_and(|found| words.contains(&found.as_str()))
            }
            Condition::Present(key) => self.has(key),
            Condition::Absent(key) => !self.has(key),
            Condition::Plane => self.scope.dimensions() == 2,
            Condition::Space => self.scope.dimensions() == 3,
        }
    }

    /// Returns the item of a key whose conditions hold, else the first item of this name.
    fn item(&self, name: &str) -> Option<&'static Item> {
        let named = |item: &&Item| item.name == name;
        let elsewhere = || self.form.items().map(|(_, item)| item).find(named);
        self.form.applicable(|condition| self.holds(condition)).find(named).or_else(elsewhere)
    }

    fn expected(&self, name: &str) -> String {
        self.item(name).map_or(String::new(), |item| item.expected(&self.scope))
    }

    /// Returns the error of an invalid value.
    pub(super) fn wrong(&self, name: &str) -> CaseError {
        self.wrong_for(name, &self.expected(name))
    }

    fn wrong_for(&self, name: &str, expected: &str) -> CaseError {
        let found = self.node(name).map_or(String::new(), Node::words);
        self.error(name, format!("found {found}"), format!("expected {expected}"))
    }

    /// Returns the error of a missing required key.
    fn missing(&self, name: &str, expected: &str) -> CaseError {
        let allowed = match self.path.as_str() {
            "" => format!("add {expected}"),
            path if path.contains(['.', '[']) => {
                format!("add {name} to {path}: expected {expected}")
            }
            path => format!("add {name} to [{path}]: expected {expected}"),
        };
        self.error(name, "missing", allowed)
    }

    /// Reads an optional value; `None` if absent.
    pub(super) fn optional<T: TryFrom<Value>>(&self, name: &str) -> Result<Option<T>, CaseError> {
        let Some(node) = self.node(name) else { return Ok(None) };
        let item = self.item(name);
        let value = item
            .zip(node.value())
            .and_then(|(item, value)| item.value.parse(value, &self.scope))
            .and_then(|value| T::try_from(value).ok());
        value.map(Some).ok_or_else(|| self.wrong(name))
    }

    /// Reads a required value.
    pub(super) fn required<T: TryFrom<Value>>(&self, name: &str) -> Result<T, CaseError> {
        self.optional(name)?.ok_or_else(|| self.missing(name, &self.expected(name)))
    }

    /// Reads a value, or returns its default.
    pub(super) fn or_default<T: TryFrom<Value>>(&self, name: &str) -> Result<T, CaseError> {
        if let Some(value) = self.optional(name)? {
            return Ok(value);
        }
        let default = self.item(name).and_then(|item| match item.need {
            Need::Default(text) => {
                let value = DeValue::parse(text).ok()?;
                T::try_from(item.value.parse(value.get_ref(), &self.scope)?).ok()
            }
            Need::Required(_) | Need::Optional(_) => None,
        });
        default.ok_or_else(|| self.missing(name, &self.expected(name)))
    }

    /// Reads a required value with the conversion `read`; `expected` describes the allowed values.
    pub(super) fn required_as<T>(
        &self,
        name: &str,
        expected: &str,
        read: impl Fn(&DeValue) -> Option<T>,
    ) -> Result<T, CaseError> {
        let Some(node) = self.node(name) else { return Err(self.missing(name, expected)) };
        node.value().and_then(read).ok_or_else(|| self.wrong_for(name, expected))
    }

    /// Reads an optional text. It is not checked against `words`, which are listed in messages only.
    pub(super) fn optional_text(
        &self,
        name: &str,
        words: &[impl AsRef<str>],
    ) -> Result<Option<String>, CaseError> {
        let Some(node) = self.node(name) else { return Ok(None) };
        let text = node.text();
        text.map(Some).ok_or_else(|| self.wrong_for(name, &format!("one of {}", joined(words))))
    }

    /// Reads a required text. It is not checked against `words`, which are listed in messages only.
    pub(super) fn required_text(
        &self,
        name: &str,
        words: &[impl AsRef<str>],
    ) -> Result<String, CaseError> {
        self.optional_text(name, words)?
            .ok_or_else(|| self.missing(name, &format!("one of {}", joined(words))))
    }

    /// Reads an optional choice among `all`, whose names `word` returns.
    pub(super) fn optional_choice<T: Copy, N: AsRef<str>>(
        &self,
        name: &str,
        all: &[T],
        word: impl Fn(T) -> N,
    ) -> Result<Option<T>, CaseError> {
        let words: Vec<N> = all.iter().map(|&item| word(item)).collect();
        let Some(found) = self.optional_text(name, &words)? else { return Ok(None) };
        match words.iter().position(|word| word.as_ref() == found) {
            Some(index) => Ok(Some(all[index])),
            None => Err(self.no_such(name, &found, &words)),
        }
    }

    /// Reads a required choice among `all`, whose names `word` returns.
    pub(super) fn choice<T: Copy, N: AsRef<str>>(
        &self,
        name: &str,
        all: &[T],
        word: impl Fn(T) -> N,
    ) -> Result<T, CaseError> {
        self.optional_choice(name, all, &word)?.ok_or_else(|| {
            let words: Vec<N> = all.iter().map(|&item| word(item)).collect();
            self.missing(name, &format!("one of {}", joined(&words)))
        })
    }

    /// Reads a list of quantities without repetition, with names in `among`; `None` if absent.
    pub(super) fn different<T: PartialEq>(
        &self,
        key: &str,
        among: &[String],
        find: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<Vec<T>>, CaseError> {
        let Some(node) = self.node(key) else { return Ok(None) };
        let given = node.value().and_then(super::value::texts);
        let given = given
            .ok_or_else(|| self.wrong_for(key, &format!("a list with any of {}", joined(among))))?;
        let mut all = Vec::new();
        for name in given {
            let own = find(&name).ok_or_else(|| self.no_such(key, &name, among))?;
            if all.contains(&own) {
                let found = format!("found '{name}' twice");
                return Err(self.error(key, found, "name each once"));
            }
            all.push(own);
        }
        Ok(Some(all))
    }

    /// Returns the error of a text that is not among the allowed words.
    pub(super) fn no_such(&self, name: &str, found: &str, words: &[impl AsRef<str>]) -> CaseError {
        let meant = suggestion(nearest(found, words.iter().map(AsRef::as_ref)));
        let found = format!("found '{}'", escape(found));
        self.error(name, found, format!("{meant}allowed: {}", joined(words)))
    }

    /// Returns the reader of a required subsection.
    pub(super) fn required_section(&self, form: &'static Form) -> Result<Section<'a>, CaseError> {
        self.section(form)?.ok_or_else(|| self.missing(form.name, form.remedy))
    }

    /// Returns the reader of an optional subsection.
    pub(super) fn section(&self, form: &'static Form) -> Result<Option<Section<'a>>, CaseError> {
        let name = form.name;
        match self.node(name) {
            None => Ok(None),
            Some(Node::Table(table)) => Ok(Some(self.inside(self.key(name), table, form))),
            Some(_) => Err(self.no_table(name)),
        }
    }

    /// Returns the reader of an optional inline table.
    pub(super) fn table(&self, name: &str) -> Result<Option<Section<'a>>, CaseError> {
        let form = match self.item(name).map(|item| item.value) {
            Some(Type::Table(form)) => form,
            _ => &OPEN,
        };
        match self.node(name) {
            None => Ok(None),
            Some(Node::Table(table)) => Ok(Some(self.inside(self.key(name), table, form))),
            Some(_) => Err(self.no_table(name)),
        }
    }

    /// Returns the reader of a required inline table.
    pub(super) fn required_table(&self, name: &str) -> Result<Section<'a>, CaseError> {
        self.table(name)?.ok_or_else(|| self.missing(name, &self.expected(name)))
    }

    fn no_table(&self, name: &str) -> CaseError {
        let expected = match self.path.as_str() {
            "" => format!("expected a section [{name}]"),
            _ => "expected a table in braces { key = value, ... }".to_owned(),
        };
        let found = self.node(name).map_or(String::new(), Node::words);
        self.error(name, format!("found {found}"), expected)
    }

    /// Returns the readers of a list of subsections; empty if absent.
    pub(super) fn list(&self, form: &'static Form) -> Result<Vec<Section<'a>>, CaseError> {
        let name = form.name;
        match self.node(name) {
            None => Ok(Vec::new()),
            Some(Node::Tables(tables)) => {
                let path = |index| format!("{}[{index}]", self.key(name));
                let section = |(index, table)| self.inside(path(index), table, form);
                Ok(tables.iter().enumerate().map(section).collect())
            }
            // An empty TOML list is an empty list of tables.
            Some(Node::Value(value)) if value.as_array().is_some_and(|list| list.is_empty()) => {
                Ok(Vec::new())
            }
            Some(node) => {
                let found = format!("found {}", node.words());
                Err(self.error(name, found, format!("expected sections [[{name}]]")))
            }
        }
    }

    fn inside(&self, path: String, table: &'a Table<'a>, form: &'static Form) -> Section<'a> {
        Section { path, table, places: self.places, form, scope: self.scope.clone() }
    }

    /// Completes reading: refuses keys that the schema does not allow in this table.
    pub(super) fn finish(self) -> Result<(), CaseError> {
        let mut names: Vec<&str> = Vec::new();
        for item in self.form.applicable(|condition| self.holds(condition)) {
            if !names.contains(&item.name) {
                names.push(item.name);
            }
        }
        match self.entries().find(|(name, _)| !names.contains(name)) {
            Some((name, _)) => Err(self.unknown(name, &names)),
            None => Ok(()),
        }
    }

    /// Returns the error of an unknown key.
    pub(super) fn unknown(&self, name: &str, names: &[impl AsRef<str>]) -> CaseError {
        let meant = suggestion(nearest(name, names.iter().map(AsRef::as_ref)));
        let allowed = format!("{meant}allowed here: {}", joined(names));
        self.error(&segment(name), "unknown key", allowed)
    }
}

/// Joins names with commas.
pub(super) fn joined(words: &[impl AsRef<str>]) -> String {
    words.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")
}

/// Writer of a resolved table: pairs of key and value as TOML.
#[derive(Default)]
pub(super) struct Resolved(Vec<(String, String)>);

impl Resolved {
    /// Adds a number, or a list or matrix of numbers, in the shortest form that parses to the same doubles.
    pub(super) fn number(self, name: impl Into<String>, value: impl Debug) -> Self {
        self.literal(name, format_args!("{value:?}"))
    }

    /// Adds a text.
    pub(super) fn text(self, name: &str, value: impl AsRef<str>) -> Self {
        self.literal(name, toml::Value::from(value.as_ref()))
    }

    /// Adds a list of texts.
    pub(super) fn texts(self, name: &str, values: &[impl Display]) -> Self {
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        self.literal(name, toml::Value::from(values))
    }

    /// Adds an inline table.
    pub(super) fn table(self, name: &str, inner: &Self) -> Self {
        let entry = |(name, value): &(String, String)| format!("{name} = {value}");
        let entries: Vec<String> = inner.0.iter().map(entry).collect();
        self.literal(name, format_args!("{{ {} }}", entries.join(", ")))
    }

    /// Adds a value that is already formatted as TOML.
    pub(super) fn literal(mut self, name: impl Into<String>, value: impl Display) -> Self {
        self.0.push((name.into(), value.to_string()));
        self
    }

    /// Formats the section as TOML: header and lines.
    pub(super) fn under(&self, form: &Form) -> String {
        let lines = self.0.iter().map(|(name, value)| format!("{name} = {value}\n"));
        format!("\n{}\n{}", form.header(), lines.collect::<String>())
    }
}
