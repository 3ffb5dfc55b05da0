//! Tree of values, tables and lists of tables: the content of structured sections.

use super::value::{self, describe_value, format_short_list};
use toml::de::{DeTable, DeValue};

/// A value, a table or a list of tables.
pub(super) enum Node<'a> {
    Value(DeValue<'a>),
    Table(NodeTable<'a>),
    Tables(Vec<NodeTable<'a>>),
}

/// A table with its entries in the order of the file.
#[derive(Default)]
pub(super) struct NodeTable<'a>(Vec<(String, Node<'a>)>);

/// Error of an option `--set`: invalid part of the key, text found and text allowed.
pub(super) struct OptionError {
    pub(super) key: String,
    pub(super) found: String,
    pub(super) allowed: String,
}

/// A segment of a key in `--set`: a name and, optionally, a list index.
type KeySegment<'k> = (&'k str, Option<usize>);

/// Formats a name as a segment of a dotted key, quoted if necessary.
pub(super) fn format_segment(name: &str) -> String {
    match name.contains(['.', '[', ']']) {
        true => format!("{name:?}"),
        false => name.to_owned(),
    }
}

impl<'a> Node<'a> {
    /// Builds the tree of a value; calls `note` with the dotted key and byte offset of each value inside it.
    pub(super) fn from_toml(
        value: &DeValue<'a>,
        path: &str,
        note: &mut impl FnMut(String, usize),
    ) -> Self {
        match value {
            DeValue::Table(table) => Self::Table(NodeTable::from_toml(table, path, note)),
            DeValue::Array(array) if array.iter().any(|item| item.get_ref().is_table()) => {
                let mut tables = Vec::new();
                for (index, item) in array.iter().enumerate() {
                    let Some(table) = item.get_ref().as_table() else {
                        return Self::Value(value.clone());
                    };
                    let path = format!("{path}[{index}]");
                    note(path.clone(), item.span().start);
                    tables.push(NodeTable::from_toml(table, &path, note));
                }
                Self::Tables(tables)
            }
            _ => Self::Value(value.clone()),
        }
    }

    /// Returns the text of the node; `None` if the node is not a text.
    pub(super) fn as_text(&self) -> Option<String> {
        value::parse_text(self.as_value()?)
    }

    /// Returns the plain value; `None` for a table or a list of tables.
    pub(super) fn as_value(&self) -> Option<&DeValue<'a>> {
        match self {
            Self::Value(value) => Some(value),
            _ => None,
        }
    }

    /// Describes the node for messages.
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Value(value) => format_short_list(value).unwrap_or_else(|| describe_value(value)),
            Self::Table(_) => "a section".to_owned(),
            Self::Tables(tables) => format!("a list of {}", tables.len()),
        }
    }
}

impl<'a> NodeTable<'a> {
    fn from_toml(table: &DeTable<'a>, path: &str, note: &mut impl FnMut(String, usize)) -> Self {
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let read = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'a>>)| {
            let name: &std::borrow::Cow<'_, str> = key.get_ref();
            let path = format!("{path}.{}", format_segment(name));
            note(path.clone(), key.span().start);
            (name.to_string(), Node::from_toml(value.get_ref(), &path, note))
        };
        Self(entries.into_iter().map(read).collect())
    }

    fn has_entry(&self, name: &str) -> bool {
        self.node(name).is_some()
    }

    /// Returns the node with the name `name`, if any.
    pub(super) fn node(&self, name: &str) -> Option<&Node<'a>> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, node)| node)
    }

    /// Returns all names and nodes in the order of the file.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&str, &Node<'a>)> {
        self.0.iter().map(|(name, node)| (name.as_str(), node))
    }

    /// Inserts a node, or replaces the node of the same name.
    pub(super) fn insert(&mut self, name: &str, node: Node<'a>) {
        match self.0.iter_mut().find(|(own, _)| own == name) {
            Some((_, old)) => *old = node,
            None => self.0.push((name.to_owned(), node)),
        }
    }

    /// Returns whether the dotted key is a table with an entry `value`.
    pub(super) fn has_table_with_value(&self, key: &str) -> bool {
        let mut table = self;
        for name in key.split('.') {
            match table.node(name) {
                Some(Node::Table(inner)) => table = inner,
                _ => return false,
            }
        }
        table.has_entry("value")
    }

    /// Inserts a node at a dotted key; returns the normalised key.
    pub(super) fn insert_at_key(
        &mut self,
        key: &str,
        node: Node<'a>,
    ) -> Result<String, OptionError> {
        let steps: Option<Vec<KeySegment>> = key.split('.').map(parse_segment).collect();
        let Some(steps) = steps else {
            return Err(OptionError {
                key: key.to_owned(),
                found: "found no key".into(),
                allowed: "expected section.key or section[0].key, the index counted from 0".into(),
            });
        };
        let mut path = String::new();
        self.insert_at_path(&steps, &mut path, node)?;
        Ok(path)
    }

    fn insert_at_path(
        &mut self,
        steps: &[KeySegment],
        path: &mut String,
        node: Node<'a>,
    ) -> Result<(), OptionError> {
        let Some((&(name, index), rest)) = steps.split_first() else { return Ok(()) };
        if !path.is_empty() {
            path.push('.');
        }
        path.push_str(name);
        let refused =
            |found: String, allowed: String| Err(OptionError { key: path.clone(), found, allowed });
        let Some(index) = index else {
            if rest.is_empty() {
                self.insert(name, node);
                return Ok(());
            }
            if !self.has_entry(name) {
                self.insert(name, Node::Table(NodeTable::default()));
            }
            return match self.node_mut(name) {
                Some(Node::Table(table)) => table.insert_at_path(rest, path, node),
                Some(Node::Tables(tables)) => refused(
                    format!("found no index for a list of {}", tables.len()),
                    format!("expected {path}[i] with {}", describe_indices(tables.len())),
                ),
                _ => refused(
                    "found a key inside a value".into(),
                    format!("expected {path}=VALUE: set the value as a whole"),
                ),
            };
        };
        let count = match self.node_mut(name) {
            Some(Node::Tables(tables)) => tables.len(),
            Some(Node::Table(_)) => {
                return refused(
                    format!("found the index {index}"),
                    format!("expected {path}.KEY: {path} is not a list"),
                );
            }
            Some(Node::Value(value)) if value.as_array().is_none_or(|list| !list.is_empty()) => {
                return refused(
                    format!("found the index {index}"),
                    format!("expected {path}=VALUE: set the value as a whole"),
                );
            }
            _ => 0,
        };
        match (self.node_mut(name), node) {
            (Some(Node::Tables(tables)), node) if index < count => {
                path.push_str(&format!("[{index}]"));
                match (rest.is_empty(), node) {
                    (false, node) => tables[index].insert_at_path(rest, path, node),
                    (true, Node::Table(table)) => {
                        tables[index] = table;
                        Ok(())
                    }
                    (true, node) => Err(OptionError {
                        key: path.clone(),
                        found: format!("found {}", node.describe()),
                        allowed: format!(
                            "expected {path}.KEY, or a table in braces {{ key = value }}"
                        ),
                    }),
                }
            }
            _ if count == 0 => refused(
                format!("found the index {index}, but there is no [[{path}]]"),
                format!("add a section [[{path}]] to the case file"),
            ),
            _ => refused(
                format!("found the index {index}"),
                format!("expected {}", describe_indices(count)),
            ),
        }
    }

    /// Returns the tables of a section or of a list of sections, with their dotted keys.
    pub(super) fn tables_of_section(
        &mut self,
        name: &str,
    ) -> impl Iterator<Item = (String, &mut NodeTable<'a>)> {
        let tables: Vec<_> = match self.node_mut(name) {
            Some(Node::Table(table)) => vec![(name.to_owned(), table)],
            Some(Node::Tables(tables)) => {
                let path = |(index, table)| (format!("{name}[{index}]"), table);
                tables.iter_mut().enumerate().map(path).collect()
            }
            _ => Vec::new(),
        };
        tables.into_iter()
    }

    /// Renames an entry.
    pub(super) fn rename(&mut self, name: &str, new_name: &str) {
        if let Some((own, _)) = self.0.iter_mut().find(|(own, _)| own == name) {
            new_name.clone_into(own);
        }
    }

    fn node_mut(&mut self, name: &str) -> Option<&mut Node<'a>> {
        self.0.iter_mut().find(|(own, _)| own == name).map(|(_, node)| node)
    }
}

/// Describes the indices of a list of `count` ≥ 1 tables.
fn describe_indices(count: usize) -> String {
    match count {
        1 => "the index 0: the list has one section".to_owned(),
        _ => format!("an index from 0 to {}", count - 1),
    }
}

/// Parses a segment of a dotted key; `None` if invalid.
fn parse_segment(text: &str) -> Option<KeySegment<'_>> {
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
