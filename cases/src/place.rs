//! Positions of the keys of a case in its file or in `--set` options, for error messages.

use super::error::{CaseError, Place, escape};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Positions of the keys and sections of a case.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// Positions in the file and in options; shared by the case and its regions.
    all: Arc<Standing>,
    /// Full names of the keys overridden by a region.
    aliases: BTreeMap<&'static str, String>,
}

/// All positions compare equal, so that cases are compared by content only.
impl PartialEq for Places {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Line numbers and options by key.
#[derive(Clone, Debug)]
struct Standing {
    file: String,
    lines: BTreeMap<String, usize>,
    options: BTreeMap<String, String>,
}

impl Places {
    pub(super) fn new(file: &str) -> Self {
        let (file, lines, options) = (file.to_owned(), BTreeMap::new(), BTreeMap::new());
        Self { all: Arc::new(Standing { file, lines, options }), aliases: BTreeMap::new() }
    }

    /// Records the line of a key or section; for a dotted section with several headers the first line.
    pub(super) fn add_line(&mut self, name: String, line: usize) {
        Arc::make_mut(&mut self.all).lines.entry(name).or_insert(line);
    }

    /// Records the option that set a key.
    pub(super) fn add_option(&mut self, key: String, option: &str) {
        Arc::make_mut(&mut self.all).options.insert(key, option.to_owned());
    }

    /// Removes the positions of a key and of all keys inside it.
    pub(super) fn forget(&mut self, key: &str) {
        let is_kept = |name: &str| {
            name.strip_prefix(key)
                .is_none_or(|rest| !(rest.is_empty() || rest.starts_with(['.', '['])))
        };
        let standing = Arc::make_mut(&mut self.all);
        standing.lines.retain(|name, _| is_kept(name));
        standing.options.retain(|name, _| is_kept(name));
    }

    /// Records the full name of a key overridden by a region.
    pub(super) fn add_alias(&mut self, key: &'static str, name: String) {
        self.aliases.insert(key, name);
    }

    /// Returns whether the region overrides a key.
    pub(super) fn has_alias(&self, key: &str) -> bool {
        self.aliases.contains_key(key)
    }

    /// Returns whether a key or section is in the file.
    pub(super) fn has_line(&self, name: &str) -> bool {
        self.all.lines.contains_key(name)
    }

    /// Returns the full name of a key.
    fn alias<'k>(&'k self, key: &'k str) -> &'k str {
        self.aliases.get(key).map_or(key, String::as_str)
    }

    /// Returns the position of a key, else of its innermost enclosing section, else of the file.
    pub(super) fn of(&self, key: &str) -> Place {
        let mut name = self.alias(key);
        loop {
            if let Some(text) = self.all.options.get(name) {
                return Place::Option(text.clone());
            }
            if let Some(&line) = self.all.lines.get(name) {
                return Place::Line { file: self.all.file.clone(), line };
            }
            match name.rfind(['.', '[']) {
                Some(end) => name = &name[..end],
                None => break,
            }
        }
        // The section may have been set by options only.
        match self.all.options.iter().find(|(name, _)| is_inside(name, key)) {
            Some((_, text)) => Place::Option(text.clone()),
            None => Place::File(self.all.file.clone()),
        }
    }

    /// Returns the name of a section for messages.
    pub(super) fn title(&self, section: &str) -> String {
        self.aliases.get(section).cloned().unwrap_or_else(|| format!("[{section}]"))
    }

    /// Returns the position of an axis of `[map]`: the option that set one of its values, else its line.
    pub(super) fn of_axis(&self, axis: &str) -> Place {
        let set = ["from", "to", "parameter", "points"]
            .iter()
            .find_map(|name| self.all.options.get(&format!("{axis}.{name}")));
        set.map_or_else(|| self.of(axis), |text| Place::Option(text.clone()))
    }

    /// Returns an error at a key.
    pub(super) fn error(
        &self,
        key: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        CaseError::Key {
            place: self.of(key),
            key: escape(self.alias(key)),
            found: found.into(),
            allowed: allowed.into(),
        }
    }
}

/// Returns whether a dotted key is inside a section.
pub(super) fn is_inside(key: &str, section: &str) -> bool {
    key.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'))
}
