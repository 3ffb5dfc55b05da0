//! Where the keys of a case stand, in its file or in `--set` options, and errors at them.

use super::error::{CaseError, Place, shown};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Where the keys and sections of a case stand, to answer for them later.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// Shared by the case and its regions.
    all: Arc<Standing>,
    /// Keys that stand under another name: those that a region has of its own.
    aliases: BTreeMap<&'static str, String>,
}

/// Where something stands makes no case different from another.
impl PartialEq for Places {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Lines and options by key.
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

    /// Keeps the line of a key or section. A dotted section has several headers; the first one
    /// answers for it.
    pub(super) fn add_line(&mut self, name: String, line: usize) {
        Arc::make_mut(&mut self.all).lines.entry(name).or_insert(line);
    }

    /// Keeps the option that set a key.
    pub(super) fn add_option(&mut self, key: String, option: &str) {
        Arc::make_mut(&mut self.all).options.insert(key, option.to_owned());
    }

    /// Forgets where a key and all inside it stand.
    pub(super) fn forget(&mut self, key: &str) {
        let is_kept = |name: &str| {
            name.strip_prefix(key)
                .is_none_or(|rest| !(rest.is_empty() || rest.starts_with(['.', '['])))
        };
        let standing = Arc::make_mut(&mut self.all);
        standing.lines.retain(|name, _| is_kept(name));
        standing.options.retain(|name, _| is_kept(name));
    }

    /// Keeps the other name under which a key stands.
    pub(super) fn add_alias(&mut self, key: &'static str, name: String) {
        self.aliases.insert(key, name);
    }

    /// Whether a key stands under another name.
    pub(super) fn has_alias(&self, key: &str) -> bool {
        self.aliases.contains_key(key)
    }

    /// Whether a key or section stands on a line of the file.
    pub(super) fn has_line(&self, name: &str) -> bool {
        self.all.lines.contains_key(name)
    }

    /// The name under which a key stands.
    fn alias<'k>(&'k self, key: &'k str) -> &'k str {
        self.aliases.get(key).map_or(key, String::as_str)
    }

    /// The place of a key, or else of the innermost section around it, or else the file.
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
        // A section may stand in options alone.
        match self.all.options.iter().find(|(name, _)| is_inside(name, key)) {
            Some((_, text)) => Place::Option(text.clone()),
            None => Place::File(self.all.file.clone()),
        }
    }

    /// A section as it is named in a message.
    pub(super) fn title(&self, section: &str) -> String {
        self.aliases.get(section).cloned().unwrap_or_else(|| format!("[{section}]"))
    }

    /// The place of an axis of `[map]`: the option that set one of its values, or else its line.
    pub(super) fn of_axis(&self, axis: &str) -> Place {
        let set = ["from", "to", "parameter", "points"]
            .iter()
            .find_map(|name| self.all.options.get(&format!("{axis}.{name}")));
        set.map_or_else(|| self.of(axis), |text| Place::Option(text.clone()))
    }

    /// An error at a key.
    pub(super) fn error(
        &self,
        key: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        CaseError::Key {
            place: self.of(key),
            key: shown(self.alias(key)),
            found: found.into(),
            allowed: allowed.into(),
        }
    }
}

/// Whether a dotted key is one inside a section.
pub(super) fn is_inside(key: &str, section: &str) -> bool {
    key.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'))
}
