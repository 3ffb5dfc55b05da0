//! Sections that hold lists of tables: their values as a tree, and a reader of one table that knows
//! what it was asked for.

use super::error::{CaseError, Place, shown};
use super::place::Places;
use super::value::{self, describe, list, nearest, short_list, suggestion};
use std::fmt::{Debug, Display};
use toml::de::{DeTable, DeValue};

/// A value, a table or a list of tables.
pub(super) enum Node<'a> {
    Value(DeValue<'a>),
    Table(Table<'a>),
    Tables(Vec<Table<'a>>),
}

/// A table in the order of the file.
#[derive(Default)]
pub(super) struct Table<'a>(Vec<(String, Node<'a>)>);

/// Why a `--set` cannot be carried out: the part of its key that is wrong, what was found and what
/// is allowed.
pub(super) struct Refused {
    pub(super) key: String,
    pub(super) found: String,
    pub(super) allowed: String,
}

/// A step of a key in `--set`: a name, and the index behind it.
type Step<'k> = (&'k str, Option<usize>);

/// A name as a part of a dotted key: what would be taken for several is put in quotes.
pub(super) fn segment(name: &str) -> String {
    match name.contains(['.', '[', ']']) {
        true => format!("{name:?}"),
        false => name.to_owned(),
    }
}

impl<'a> Node<'a> {
    /// The tree of a value, and by dotted key where its parts begin.
    pub(super) fn read(
        value: &DeValue<'a>,
        path: &str,
        note: &mut impl FnMut(String, usize),
    ) -> Self {
        match value {
            DeValue::Table(table) => Self::Table(Table::read(table, path, note)),
            DeValue::Array(array) if array.iter().any(|item| item.get_ref().is_table()) => {
                let mut tables = Vec::new();
                for (index, item) in array.iter().enumerate() {
                    let Some(table) = item.get_ref().as_table() else {
                        return Self::Value(value.clone());
                    };
                    let path = format!("{path}[{index}]");
                    note(path.clone(), item.span().start);
                    tables.push(Table::read(table, &path, note));
                }
                Self::Tables(tables)
            }
            _ => Self::Value(value.clone()),
        }
    }

    /// What is neither a table nor a list of tables.
    pub(super) fn value(&self) -> Option<&DeValue<'a>> {
        match self {
            Self::Value(value) => Some(value),
            _ => None,
        }
    }

    /// The node as it is named in a message.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Value(value) => short_list(value).unwrap_or_else(|| describe(value)),
            Self::Table(_) => "a section".to_owned(),
            Self::Tables(tables) => format!("a list of {}", tables.len()),
        }
    }
}

impl<'a> Table<'a> {
    fn read(table: &DeTable<'a>, path: &str, note: &mut impl FnMut(String, usize)) -> Self {
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let read = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'a>>)| {
            let name: &std::borrow::Cow<'_, str> = key.get_ref();
            let path = format!("{path}.{}", segment(name));
            note(path.clone(), key.span().start);
            (name.to_string(), Node::read(value.get_ref(), &path, note))
        };
        Self(entries.into_iter().map(read).collect())
    }

    fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    fn get(&self, name: &str) -> Option<&Node<'a>> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, node)| node)
    }

    fn entries(&self) -> impl Iterator<Item = (&str, &Node<'a>)> {
        self.0.iter().map(|(name, node)| (name.as_str(), node))
    }

    pub(super) fn insert(&mut self, name: &str, node: Node<'a>) {
        match self.0.iter_mut().find(|(own, _)| own == name) {
            Some((_, old)) => *old = node,
            None => self.0.push((name.to_owned(), node)),
        }
    }

    /// Puts a node where the key says, and hands back the key as places are kept by it.
    pub(super) fn set(&mut self, key: &str, node: Node<'a>) -> Result<String, Refused> {
        let steps: Option<Vec<Step>> = key.split('.').map(step).collect();
        let Some(steps) = steps else {
            return Err(Refused {
                key: key.to_owned(),
                found: "no key".into(),
                allowed: "write section.key or section[0].key, the index counted from 0".into(),
            });
        };
        let mut path = String::new();
        self.set_at(&steps, &mut path, node)?;
        Ok(path)
    }

    fn set_at(&mut self, steps: &[Step], path: &mut String, node: Node<'a>) -> Result<(), Refused> {
        let Some((&(name, index), rest)) = steps.split_first() else { return Ok(()) };
        if !path.is_empty() {
            path.push('.');
        }
        path.push_str(name);
        let refused =
            |found: String, allowed: String| Err(Refused { key: path.clone(), found, allowed });
        let Some(index) = index else {
            if rest.is_empty() {
                self.insert(name, node);
                return Ok(());
            }
            if !self.has(name) {
                self.insert(name, Node::Table(Table::default()));
            }
            return match self.slot(name) {
                Some(Node::Table(table)) => table.set_at(rest, path, node),
                Some(Node::Tables(tables)) => refused(
                    format!("a list of {}", tables.len()),
                    format!("write {path}[0] with an index from 0 to {}", tables.len() - 1),
                ),
                _ => refused("no section".into(), "a key inside it cannot be set".into()),
            };
        };
        let count = match self.slot(name) {
            Some(Node::Tables(tables)) => tables.len(),
            Some(Node::Table(_)) => {
                return refused(format!("the index {index}"), format!("{path} is no list"));
            }
            Some(Node::Value(value)) if value.as_array().is_none_or(|list| !list.is_empty()) => {
                return refused(format!("the index {index}"), "set the value as a whole".into());
            }
            _ => 0,
        };
        match (self.slot(name), node) {
            (Some(Node::Tables(tables)), node) if index < count => {
                path.push_str(&format!("[{index}]"));
                match (rest.is_empty(), node) {
                    (false, node) => tables[index].set_at(rest, path, node),
                    (true, Node::Table(table)) => {
                        tables[index] = table;
                        Ok(())
                    }
                    (true, node) => Err(Refused {
                        key: path.clone(),
                        found: format!("found {}", node.words()),
                        allowed: "name a key inside it, or give a table in braces".into(),
                    }),
                }
            }
            _ if count == 0 => refused(
                format!("the index {index} of no entry"),
                format!("add [[{path}]] to the file first"),
            ),
            _ => refused(
                format!("the index {index} of {count}"),
                format!("expected an index from 0 to {}", count - 1),
            ),
        }
    }

    fn slot(&mut self, name: &str) -> Option<&mut Node<'a>> {
        self.0.iter_mut().find(|(own, _)| own == name).map(|(_, node)| node)
    }
}

/// A part of a key between dots; `None` if it is none.
fn step(text: &str) -> Option<Step<'_>> {
    let is_name =
        |name: &str| !name.is_empty() && !name.contains(|c: char| "[]\"'".contains(c) || c == ' ');
    let (name, index) = match text.split_once('[') {
        Some((name, rest)) => (name, Some(rest.strip_suffix(']')?)),
        None => (text, None),
    };
    let index = match index {
        Some(digits) if digits.bytes().all(|digit| digit.is_ascii_digit()) => {
            Some(digits.parse().ok()?)
        }
        Some(_) => return None,
        None => None,
    };
    is_name(name).then_some((name, index))
}

/// A finite number.
pub(super) fn number(node: &Node) -> Option<f64> {
    value::number(node.value()?)
}

/// A number above zero.
pub(super) fn positive(node: &Node) -> Option<f64> {
    number(node).filter(|number| *number > 0.0)
}

/// A number that is not negative.
pub(super) fn not_negative(node: &Node) -> Option<f64> {
    number(node).filter(|number| *number >= 0.0)
}

/// A whole number of at least 1.
pub(super) fn count(node: &Node) -> Option<usize> {
    value::count(node.value()?)
}

/// A whole number of at least 0.
pub(super) fn whole(node: &Node) -> Option<u64> {
    u64::try_from(value::integer(node.value()?)?).ok()
}

/// Two whole numbers.
pub(super) fn whole_pair(node: &Node) -> Option<[i64; 2]> {
    value::pair(node.value()?, value::integer)
}

/// Text in one line.
pub(super) fn text(node: &Node) -> Option<String> {
    value::text(node.value()?)
}

/// A list of texts.
pub(super) fn texts(node: &Node) -> Option<Vec<String>> {
    value::texts(node.value()?)
}

/// True or false.
pub(super) fn truth(node: &Node) -> Option<bool> {
    node.value()?.as_bool()
}

/// `length` numbers; one alone needs no brackets.
pub(super) fn numbers(length: usize) -> impl Fn(&Node) -> Option<Vec<f64>> {
    move |node| list(node.value()?, length, value::number)
}

/// A list of any number of numbers.
pub(super) fn any_numbers(node: &Node) -> Option<Vec<f64>> {
    let value = node.value()?;
    list(value, value.as_array()?.len(), value::number)
}

/// Two or three whole numbers of at least 1.
pub(super) fn cells(node: &Node) -> Option<Vec<usize>> {
    let value = node.value()?;
    let length = value.as_array()?.len();
    list(value, length, value::count).filter(|_| (2..=3).contains(&length))
}

/// A positive number for all axes, or one for each.
pub(super) fn spacing(length: usize) -> impl Fn(&Node) -> Option<Vec<f64>> {
    move |node| {
        let all = numbers(length)(node).or_else(|| number(node).map(|all| vec![all; length]));
        all.filter(|all| all.iter().all(|edge| *edge > 0.0))
    }
}

/// A point of so many coordinates, or a list of such points.
pub(super) fn list_of_points(dimensions: usize) -> impl Fn(&Node) -> Option<Vec<Vec<f64>>> {
    move |node| {
        let value = node.value()?;
        if let Some(point) = list(value, dimensions, value::number) {
            return Some(vec![point]);
        }
        let points =
            list(value, value.as_array()?.len(), |point| list(point, dimensions, value::number))?;
        (!points.is_empty() && points.len() <= dimensions).then_some(points)
    }
}

/// So many whole numbers of at least 2; one alone needs no brackets.
pub(super) fn any_counts(length: usize) -> impl Fn(&Node) -> Option<Vec<usize>> {
    move |node| {
        let all = list(node.value()?, length, value::count)?;
        all.iter().all(|count| *count >= 2).then_some(all)
    }
}

/// A square matrix by rows.
pub(super) fn matrix(size: usize) -> impl Fn(&Node) -> Option<Vec<Vec<f64>>> {
    move |node| list(node.value()?, size, |row| list(row, size, value::number))
}

/// Any number of pairs of numbers.
pub(super) fn rows(node: &Node) -> Option<Vec<[f64; 2]>> {
    let pairs = node.value()?.as_array()?.iter();
    pairs.map(|row| value::pair(row.get_ref(), value::number)).collect()
}

/// Reads one table: what is asked for is what it may hold.
pub(super) struct Section<'a> {
    path: String,
    table: &'a Table<'a>,
    places: &'a Places,
    asked: Vec<&'static str>,
}

impl<'a> Section<'a> {
    /// The table around all sections.
    pub(super) fn root(table: &'a Table<'a>, places: &'a Places) -> Self {
        Self { path: String::new(), table, places, asked: Vec::new() }
    }

    /// All that the table holds.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'a str, &'a Node<'a>)> {
        self.table.entries()
    }

    /// The node of that name, whether allowed or not.
    pub(super) fn node(&self, name: &str) -> Option<&'a Node<'a>> {
        self.table.get(name)
    }

    /// The dotted key of what is inside.
    pub(super) fn key(&self, name: &str) -> String {
        match self.path.as_str() {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        }
    }

    /// An error at a key inside.
    pub(super) fn error(
        &self,
        name: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(&self.key(name), found, allowed)
    }

    /// The node of that name, which from now on is allowed.
    pub(super) fn get(&mut self, name: &'static str) -> Option<&'a Node<'a>> {
        if !self.asked.contains(&name) {
            self.asked.push(name);
        }
        self.table.get(name)
    }

    /// A value that may be absent; `expected` says what it is, with its unit.
    pub(super) fn optional<T>(
        &mut self,
        name: &'static str,
        expected: &str,
        read: impl Fn(&Node) -> Option<T>,
    ) -> Result<Option<T>, CaseError> {
        let Some(node) = self.get(name) else { return Ok(None) };
        read(node).map(Some).ok_or_else(|| {
            self.error(name, format!("found {}", node.words()), format!("expected {expected}"))
        })
    }

    /// A value that must be there.
    pub(super) fn required<T>(
        &mut self,
        name: &'static str,
        expected: &str,
        read: impl Fn(&Node) -> Option<T>,
    ) -> Result<T, CaseError> {
        self.optional(name, expected, read)?.ok_or_else(|| self.missing(name, expected))
    }

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

    /// One of some names that may be absent.
    pub(super) fn optional_choice<T: Copy, N: AsRef<str>>(
        &mut self,
        name: &'static str,
        all: &[T],
        word: impl Fn(T) -> N,
    ) -> Result<Option<T>, CaseError> {
        let words: Vec<N> = all.iter().map(|&item| word(item)).collect();
        let expected = format!("one of {}", joined(&words));
        let Some(found) = self.optional(name, &expected, text)? else { return Ok(None) };
        match words.iter().position(|word| word.as_ref() == found) {
            Some(index) => Ok(Some(all[index])),
            None => Err(self.no_such(name, &found, &words)),
        }
    }

    /// One of some names.
    pub(super) fn choice<T: Copy, N: AsRef<str>>(
        &mut self,
        name: &'static str,
        all: &[T],
        word: impl Fn(T) -> N,
    ) -> Result<T, CaseError> {
        self.optional_choice(name, all, &word)?.ok_or_else(|| {
            let words: Vec<N> = all.iter().map(|&item| word(item)).collect();
            self.missing(name, &format!("one of {}", joined(&words)))
        })
    }

    /// What to say of a text that is none of the allowed ones.
    pub(super) fn no_such(&self, name: &str, found: &str, words: &[impl AsRef<str>]) -> CaseError {
        let meant = suggestion(nearest(found, words.iter().map(AsRef::as_ref)));
        let found = format!("found '{}'", shown(found));
        self.error(name, found, format!("{meant}allowed: {}", joined(words)))
    }

    /// A table inside.
    pub(super) fn table(&mut self, name: &'static str) -> Result<Option<Section<'a>>, CaseError> {
        match self.get(name) {
            None => Ok(None),
            Some(Node::Table(table)) => Ok(Some(self.inside(self.key(name), table))),
            Some(node) => {
                let expected = match self.path.as_str() {
                    "" => format!("expected a section [{name}]"),
                    _ => "expected a table in braces { key = value, ... }".to_owned(),
                };
                Err(self.error(name, format!("found {}", node.words()), expected))
            }
        }
    }

    /// A table inside that must be there.
    pub(super) fn required_table(
        &mut self,
        name: &'static str,
        expected: &str,
    ) -> Result<Section<'a>, CaseError> {
        self.table(name)?.ok_or_else(|| self.missing(name, expected))
    }

    /// The tables of a list, none where it is absent.
    pub(super) fn tables(&mut self, name: &'static str) -> Result<Vec<Section<'a>>, CaseError> {
        match self.get(name) {
            None => Ok(Vec::new()),
            Some(Node::Tables(tables)) => {
                let path = |index| format!("{}[{index}]", self.key(name));
                let section = |(index, table)| self.inside(path(index), table);
                Ok(tables.iter().enumerate().map(section).collect())
            }
            Some(Node::Value(DeValue::Array(array))) if array.is_empty() => Ok(Vec::new()),
            Some(node) => {
                let found = format!("found {}", node.words());
                Err(self.error(name, found, format!("expected sections [[{name}]]")))
            }
        }
    }

    fn inside(&self, path: String, table: &'a Table<'a>) -> Section<'a> {
        Section { path, table, places: self.places, asked: Vec::new() }
    }

    /// Refuses what was not asked for.
    pub(super) fn finish(self) -> Result<(), CaseError> {
        let unknown = |(name, _): &(&str, &Node)| !self.asked.contains(name);
        match self.table.entries().find(unknown) {
            Some((name, _)) => Err(self.unknown(name, &self.asked)),
            None => Ok(()),
        }
    }

    /// What to say of a key that is none of the allowed ones.
    pub(super) fn unknown(&self, name: &str, names: &[impl AsRef<str>]) -> CaseError {
        let meant = suggestion(nearest(name, names.iter().map(AsRef::as_ref)));
        let allowed = format!("{meant}allowed here: {}", joined(names));
        self.error(&segment(name), "unknown key", allowed)
    }

    /// Where a key inside stands.
    pub(super) fn place(&self, name: &str) -> Place {
        self.places.of(&self.key(name))
    }
}

/// Names with commas between them.
pub(super) fn joined(words: &[impl AsRef<str>]) -> String {
    words.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ")
}

/// Keys and values of a resolved table, as TOML.
#[derive(Default)]
pub(super) struct Resolved(Vec<(String, String)>);

impl Resolved {
    /// A number, or a list or matrix of numbers, in the shortest form that reads back to the same
    /// doubles.
    pub(super) fn number(self, name: impl Into<String>, value: impl Debug) -> Self {
        self.literal(name, format_args!("{value:?}"))
    }

    /// A text.
    pub(super) fn text(self, name: &str, value: impl AsRef<str>) -> Self {
        self.literal(name, toml::Value::from(value.as_ref()))
    }

    /// A list of texts.
    pub(super) fn texts(self, name: &str, values: &[impl Display]) -> Self {
        let values: Vec<String> = values.iter().map(ToString::to_string).collect();
        self.literal(name, toml::Value::from(values))
    }

    /// A table in braces.
    pub(super) fn table(self, name: &str, inner: &Self) -> Self {
        let entry = |(name, value): &(String, String)| format!("{name} = {value}");
        let entries: Vec<String> = inner.0.iter().map(entry).collect();
        self.literal(name, format_args!("{{ {} }}", entries.join(", ")))
    }

    /// What is TOML already.
    pub(super) fn literal(mut self, name: impl Into<String>, value: impl Display) -> Self {
        self.0.push((name.into(), value.to_string()));
        self
    }

    /// The lines of a section under its header.
    pub(super) fn under(&self, header: &str) -> String {
        let lines = self.0.iter().map(|(name, value)| format!("{name} = {value}\n"));
        format!("\n{header}\n{}", lines.collect::<String>())
    }
}
