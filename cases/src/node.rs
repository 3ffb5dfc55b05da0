//! Tree of values, tables and lists of tables: the content of structured sections.

use super::value::{self, describe, short_list};
use toml::de::{DeTable, DeValue};

/// A value, a table or a list of tables.
pub(super) enum Node<'a> {
    Value(DeValue<'a>),
    Table(Table<'a>),
    Tables(Vec<Table<'a>>),
}

/// A table with its entries in the order of the file.
#[derive(Default)]
pub(super) struct Table<'a>(Vec<(String, Node<'a>)>);

/// Error of an option `--set`: invalid part of the key, text found and text allowed.
pub(super) struct Refused {
    pub(super) key: String,
    pub(super) found: String,
    pub(super) allowed: String,
}

/// A segment of a key in `--set`: a name and, optionally, a list index.
type Step<'k> = (&'k str, Option<usize>);

/// Formats a name as a segment of a dotted key, quoted if necessary.
pub(super) fn segment(name: &str) -> String {
    match name.contains(['.', '[', ']']) {
        true => format!("{name:?}"),
        false => name.to_owned(),
    }
}

impl<'a> Node<'a> {
    /// Builds the tree of a value; reports the dotted key and byte offset of each part to `note`.
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

    /// Returns the text of the node; `None` if the node is not a text.
    pub(super) fn text(&self) -> Option<String> {
        value::text(self.value()?)
    }

    /// Returns the plain value; `None` for a table or a list of tables.
    pub(super) fn value(&self) -> Option<&DeValue<'a>> {
        match self {
            Self::Value(value) => Some(value),
            _ => None,
        }
    }

    /// Describes the node for messages.
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

    pub(super) fn get(&self, name: &str) -> Option<&Node<'a>> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, node)| node)
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = (&str, &Node<'a>)> {
        self.0.iter().map(|(name, node)| (name.as_str(), node))
    }

    pub(super) fn insert(&mut self, name: &str, node: Node<'a>) {
        match self.0.iter_mut().find(|(own, _)| own == name) {
            Some((_, old)) => *old = node,
            None => self.0.push((name.to_owned(), node)),
        }
    }

    /// Inserts a node at a dotted key; returns the normalised key.
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

/// Parses a segment of a dotted key; `None` if invalid.
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
