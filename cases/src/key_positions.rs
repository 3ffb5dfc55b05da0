//! Positions of the keys of a case in its file or in `--set` options, for error messages.

use super::bundled::{bundled_case_name, find_bundled_case};
use super::error::{CaseError, SourcePosition, escape};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Positions of the keys and sections of a case.
#[derive(Clone, Debug)]
pub(super) struct KeyPositions {
    /// Positions in the file and in options; shared by the case and its regions.
    position_table: Arc<PositionTable>,
    /// Full names of the keys and sections that a region overrides or does not inherit.
    aliases: BTreeMap<&'static str, String>,
}

/// All positions compare equal, so that cases are compared by content only.
impl PartialEq for KeyPositions {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Line numbers in the case file and texts of options, by key.
#[derive(Clone, Debug)]
struct PositionTable {
    file: String,
    lines: BTreeMap<String, usize>,
    options: BTreeMap<String, String>,
}

impl KeyPositions {
    pub(super) fn new(file: &str) -> Self {
        let (file, lines, options) = (file.to_owned(), BTreeMap::new(), BTreeMap::new());
        Self {
            position_table: Arc::new(PositionTable { file, lines, options }),
            aliases: BTreeMap::new(),
        }
    }

    /// Records the line of a key or section; for a dotted section with several headers the first line.
    pub(super) fn add_line(&mut self, name: String, line: usize) {
        Arc::make_mut(&mut self.position_table).lines.entry(name).or_insert(line);
    }

    /// Records the option that set a key.
    pub(super) fn add_option(&mut self, key: String, option: &str) {
        Arc::make_mut(&mut self.position_table).options.insert(key, option.to_owned());
    }

    /// Removes the positions of a key and of all keys inside it.
    pub(super) fn remove_key(&mut self, key: &str) {
        let is_kept = |name: &str| {
            name.strip_prefix(key)
                .is_none_or(|rest| !(rest.is_empty() || rest.starts_with(['.', '['])))
        };
        let standing = Arc::make_mut(&mut self.position_table);
        standing.lines.retain(|name, _| is_kept(name));
        standing.options.retain(|name, _| is_kept(name));
    }

    /// Moves the position of a key to its new name.
    pub(super) fn rename_key(&mut self, key: &str, new_name: String) {
        let table = Arc::make_mut(&mut self.position_table);
        if let Some(line) = table.lines.remove(key) {
            table.lines.insert(new_name.clone(), line);
        }
        if let Some(option) = table.options.remove(key) {
            table.options.insert(new_name, option);
        }
    }

    /// Records the full name of a key or section that a region overrides or does not inherit.
    pub(super) fn add_alias(&mut self, key: &'static str, name: String) {
        self.aliases.insert(key, name);
    }

    /// Returns whether the region overrides or does not inherit a key.
    pub(super) fn has_alias(&self, key: &str) -> bool {
        self.aliases.contains_key(key)
    }

    /// Returns whether a key or section is in the file.
    pub(super) fn has_line(&self, name: &str) -> bool {
        self.position_table.lines.contains_key(name)
    }

    /// Returns whether an option set a key.
    pub(super) fn has_option(&self, key: &str) -> bool {
        self.position_table.options.contains_key(key)
    }

    /// Returns the full name of a key: in a region the name recorded by [`add_alias`](Self::add_alias), if any.
    fn resolve_alias<'k>(&'k self, key: &'k str) -> &'k str {
        self.aliases.get(key).map_or(key, String::as_str)
    }

    /// Returns the position of a key, else of its innermost enclosing section, else an option that set a key inside it,
    /// else the file.
    pub(super) fn locate(&self, key: &str) -> SourcePosition {
        let mut name = self.resolve_alias(key);
        loop {
            if let Some(text) = self.position_table.options.get(name) {
                return SourcePosition::Option(text.clone());
            }
            if let Some(&line) = self.position_table.lines.get(name) {
                return SourcePosition::Line { file: self.position_table.file.clone(), line };
            }
            match name.rfind(['.', '[']) {
                Some(end) => name = &name[..end],
                None => break,
            }
        }
        // The section may have been set by options only.
        match self.position_table.options.iter().find(|(name, _)| is_inside(name, key)) {
            Some((_, text)) => SourcePosition::Option(text.clone()),
            None => SourcePosition::File(self.position_table.file.clone()),
        }
    }

    /// Returns the name of a section for messages.
    pub(super) fn section_title(&self, section: &str) -> String {
        self.aliases.get(section).cloned().unwrap_or_else(|| match section.contains('.') {
            // A table in braces, or a section of its own.
            true => section.to_owned(),
            false => format!("[{section}]"),
        })
    }

    /// Returns the position of an axis of `[map]`: the option that set one of its values, else its line.
    pub(super) fn locate_axis(&self, axis: &str) -> SourcePosition {
        let set = ["from", "to", "parameter", "points", "spacing"]
            .iter()
            .find_map(|name| self.position_table.options.get(&format!("{axis}.{name}")));
        set.map_or_else(|| self.locate(axis), |text| SourcePosition::Option(text.clone()))
    }

    /// Returns an error at a key.
    pub(super) fn key_error(
        &self,
        key: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        let (position, mut allowed): (_, String) = (self.locate(key), allowed.into());
        // What is missing can only be added to a copy of a bundled case.
        if let SourcePosition::File(file) = &position
            && allowed.starts_with("add ")
            && !Path::new(file).exists()
            && let Some((path, _)) = find_bundled_case(file)
        {
            let name = bundled_case_name(path);
            allowed = format!(
                "{allowed}; copy the case first: wellposed cases show {name} > {name}.toml"
            );
        }
        let key = escape(self.resolve_alias(key));
        CaseError::Key { position, key, found: found.into(), allowed }
    }
}

/// Returns whether a dotted key is inside a section.
pub(super) fn is_inside(key: &str, section: &str) -> bool {
    key.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'))
}
