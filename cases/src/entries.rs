//! Parsing of TOML text and `--set` options to values by key with positions.

use super::equations::is_equations_kind;
use super::error::{CaseError, SourcePosition, escape};
use super::former_names::HintList;
use super::key_positions::{KeyPositions, is_inside};
use super::keys::{Key, KeyStorage, keys};
use super::kind::{MediumKind, ModelKind};
use super::node::{Node, NodeTable, OptionError, format_segment};
use super::schema::{CaseSchemas, SchemaScope};
use super::section::SectionReader;
use super::section_schemas::{EQUATION_CASE_SCHEMAS, find_foreign_section};
use super::toml_faults::{check_bare_text, choose_syntax_remedy, has_no_value};
use super::value::{CaseValue, describe_value, find_similar_name, format_allowed};
use models::registry;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// Maximum number of sections, entries of lists of tables, and inline tables.
const MAX_TABLES: usize = 100_000;
/// Maximum number of keys, estimated by the number of `=` in the text.
const MAX_KEYS: usize = 500_000;

/// Values of a case by key, parsed but not yet interpreted.
pub(super) struct CaseEntries<'a> {
    scalar_values: BTreeMap<&'static str, CaseValue>,
    /// Content of the structured sections: time-domain sections and `[check]`.
    pub(super) structured_sections: NodeTable<'a>,
    /// Schemas of the structured sections.
    pub(super) schemas: &'static CaseSchemas,
    pub(super) positions: KeyPositions,
    pub(super) hints: HintList,
}

impl<'a> CaseEntries<'a> {
    /// Parses the text of a case file, then applies the `--set` options `options`; of several options for one key the
    /// last one applies.
    pub(super) fn parse(
        text: &'a str,
        file: &str,
        options: &'a [String],
        schemas: &'static CaseSchemas,
    ) -> Result<Self, CaseError> {
        check_entry_counts(text, file)?;
        let document = DeTable::parse(text).map_err(|error| {
            let line = build_line_index(text)(error.span().map_or(0, |span| span.start));
            let content = text.lines().nth(line - 1).unwrap_or_default().trim();
            let fault = match has_no_value(content) {
                true => "no value".to_owned(),
                false => escape(error.message()),
            };
            CaseError::Syntax {
                position: SourcePosition::Line { file: file.to_owned(), line },
                cause: format!("{fault} in '{}'", escape(content)),
                remedy: choose_syntax_remedy(error.message(), content),
            }
        })?;

        let kind = document.get_ref().get("model").and_then(|own| own.get_ref().as_table());
        let kind = kind.and_then(|own| own.get("kind")).and_then(|own| own.get_ref().as_str());
        let schemas = if is_equations_kind(kind) { &EQUATION_CASE_SCHEMAS } else { schemas };
        let mut found = Vec::new();
        collect_entries("", document.get_ref(), &mut found);
        found.sort_by_key(|entry| entry.offset);
        let line = build_line_index(text);
        let hints = rename_former_sections(&mut found, schemas, |offset| SourcePosition::Line {
            file: file.to_owned(),
            line: line(offset),
        })?;

        let mut positions = KeyPositions::new(file);
        let mut structured_sections = NodeTable::default();
        let mut key_offsets: Vec<(String, usize)> = Vec::new();
        for entry in &found {
            key_offsets.push((entry.name.clone(), entry.offset));
            if schemas.has_section(&entry.name) {
                let node = Node::from_toml(entry.value, &entry.name, &mut |name, offset| {
                    key_offsets.push((name, offset));
                });
                structured_sections.insert(&entry.name, node);
            }
        }
        for (name, offset) in key_offsets {
            positions.add_line(name, line(offset));
        }
        let mut entries =
            Self { scalar_values: BTreeMap::new(), structured_sections, schemas, positions, hints };
        entries.rename_former_keys()?;
        let mut unknown = None;
        for DocumentEntry { name, value, .. } in &found {
            if schemas.has_section(root_section(name)) {
                continue;
            }
            match Key::find_by_name(name) {
                Some(key) => entries.insert(key, value)?,
                None if !is_section(name) => {
                    unknown.get_or_insert_with(|| (name.clone(), entries.positions.locate(name)));
                }
                None if value.as_table().is_none() => {
                    let found = format!("found {}", describe_value(value));
                    return Err(entries.positions.key_error(name, found, expect_section(name)));
                }
                None => {}
            }
        }
        for option in options {
            let name = entries.apply_option(option)?;
            unknown = unknown.or(name.map(|name| (name, SourcePosition::Option(option.clone()))));
        }
        // An unknown key is reported after all other errors, since the allowed keys depend on the kind of model.
        match unknown {
            Some((name, position)) => {
                // A misspelt kind of model explains keys of another kind.
                if let Some(CaseValue::Text(kind)) = entries.value("model.kind") {
                    find_model_kind(kind, "model.kind", &entries.positions)?;
                }
                Err(entries.unknown_key_error(&name, &name, position))
            }
            None => Ok(entries),
        }
    }

    fn insert(&mut self, key: &'static Key, value: &DeValue) -> Result<(), CaseError> {
        let read = parse_key_value(key, value).ok_or_else(|| {
            self.positions.key_error(
                key.name,
                format!("found {}", describe_value(value)),
                describe_allowed_values(key),
            )
        })?;
        self.scalar_values.insert(key.name, read);
        Ok(())
    }

    /// Applies an option `--set key=value`; returns the key if it is unknown.
    fn apply_option(&mut self, set: &'a str) -> Result<Option<String>, CaseError> {
        let refused = |key: &str, found: &str, allowed: String| {
            let (position, key) = (SourcePosition::Option(set.to_owned()), escape(key));
            Err(CaseError::Key { position, key, found: found.to_owned(), allowed })
        };
        let Some((name, text)) = set.split_once('=') else {
            return refused(set, "found no '='", "expected --set section.key=value".into());
        };
        let (name, text) = (name.trim(), text.trim());
        if name.is_empty() {
            let allowed = "expected --set section.key=value".into();
            return refused(set, "found no key before '='", allowed);
        }
        let name = &*self.hints.resolve_option_key(name, self.schemas, set);
        if self.schemas.has_section(root_section(name)) {
            return self.apply_structured_option(set, name, text).map(|()| None);
        }
        let Some(key) = Key::find_by_name(name) else {
            if is_section(name) {
                if let Ok(value) = DeValue::parse(text)
                    && let Some(table) = value.get_ref().as_table()
                {
                    return self.apply_section_option(set, name, table);
                }
                let inside = list_section_keys(name, |_| true).join(", ");
                return refused(
                    name,
                    "found a section",
                    format!("expected a key inside it: {inside}"),
                );
            }
            return Ok(Some(name.to_owned()));
        };
        self.positions.add_option(key.name.to_owned(), set);
        // Quotes around a text are optional, since shells remove them.
        let bare = || DeValue::String(text.into());
        let value = match DeValue::parse(text) {
            Ok(value) if value.get_ref().is_str() => value.into_inner(),
            _ if matches!(key.storage, KeyStorage::Text) => bare(),
            Ok(value) => value.into_inner(),
            Err(error) => {
                check_bare_text(text, &error, |found, allowed| refused(name, found, allowed))?;
                bare()
            }
        };
        self.insert(key, &value)?;
        Ok(None)
    }

    /// Applies an option `--set section={ key = value, … }`; keys that the table lacks keep their values. Returns the first
    /// key that is unknown.
    fn apply_section_option(
        &mut self,
        set: &str,
        section: &str,
        table: &DeTable,
    ) -> Result<Option<String>, CaseError> {
        for (name, value) in table {
            let name = format!("{section}.{}", name.get_ref());
            let value = value.get_ref();
            let unknown = match (Key::find_by_name(&name), value.as_table()) {
                (Some(key), _) => {
                    self.positions.add_option(key.name.to_owned(), set);
                    self.insert(key, value)?;
                    None
                }
                (None, Some(table)) if is_section(&name) => {
                    self.apply_section_option(set, &name, table)?
                }
                (None, _) => Some(name),
            };
            if unknown.is_some() {
                return Ok(unknown);
            }
        }
        Ok(None)
    }

    /// Applies an option `--set` for a key of a structured section.
    fn apply_structured_option(
        &mut self,
        set: &str,
        name: &str,
        text: &'a str,
    ) -> Result<(), CaseError> {
        // Quotes around a text are optional, since shells remove them.
        let value = match DeValue::parse(text) {
            Ok(value) => value.into_inner(),
            Err(error) => {
                let refused = |found: &str, allowed| {
                    let (position, key) = (SourcePosition::Option(set.to_owned()), escape(name));
                    Err(CaseError::Key { position, key, found: found.to_owned(), allowed })
                };
                check_bare_text(text, &error, refused)?;
                DeValue::String(text.into())
            }
        };
        // Errors in any part of the value are reported at the option.
        let node = Node::from_toml(&value, name, &mut |_, _| {});
        // A number for a parameter or an unknown that is a table with a value replaces the value alone.
        let inner = format!("{name}.value");
        let is_value = !self.schemas.equations.is_empty()
            && matches!(node, Node::Value(_))
            && self.structured_sections.has_table_with_value(name);
        let name = if is_value { &inner } else { name };
        let kind = self.value("model.kind").and_then(CaseValue::as_text);
        let kind = kind.and_then(ModelKind::from_name);
        let key = self.structured_sections.insert_at_key(name, node).map_err(
            |OptionError { key, found, allowed }| {
                // A section of other models cannot be added to the file either.
                let (found, allowed) = kind
                    .and_then(|kind| find_foreign_section(kind, root_section(name)))
                    .unwrap_or((found, allowed));
                let (position, key) = (SourcePosition::Option(set.to_owned()), escape(&key));
                CaseError::Key { position, key, found, allowed }
            },
        )?;
        self.positions.remove_key(&key);
        self.positions.add_option(key, set);
        self.rename_former_keys()
    }

    /// Returns the reader of the root table of the structured sections.
    pub(super) fn structured_reader(&self, scope: SchemaScope) -> SectionReader<'_> {
        SectionReader::from_root(&self.structured_sections, &self.positions, scope)
    }

    /// Supplies a derived value for a key that is not given.
    pub(super) fn set_default(&mut self, key: &'static str, value: CaseValue) {
        self.scalar_values.entry(key).or_insert(value);
    }

    /// Builds the values of a region: the values of the case, overridden by the tables `model` and `yield` of the
    /// region. A table that names another kind than the case inherits no values of its section.
    pub(super) fn to_region_entries(
        &self,
        region: &SectionReader,
    ) -> Result<CaseEntries<'static>, CaseError> {
        let (structured_sections, positions) = (NodeTable::default(), self.positions.clone());
        let mut own = CaseEntries {
            scalar_values: BTreeMap::new(),
            structured_sections,
            schemas: self.schemas,
            positions,
            hints: HintList::default(),
        };
        let mut given = Vec::new();
        for (section, kind_key) in [("model", "model.kind"), ("yield", "yield.kind")] {
            let table = region.open_table(section)?;
            let kind = table.as_ref().and_then(|table| table.node("kind"));
            let is_alone = kind.is_some_and(|node| {
                node.as_text().as_deref() != self.value(kind_key).and_then(CaseValue::as_text)
            });
            for key in keys().iter().filter(|key| is_inside(key.name, section)) {
                if is_alone {
                    own.positions.add_alias(key.name, region.full_key(key.name));
                } else if let Some(value) = self.value(key.name) {
                    own.scalar_values.insert(key.name, value.clone());
                }
            }
            if let Some(table) = table {
                own.positions.add_alias(section, region.full_key(section));
                given.push((section, table));
            }
        }
        let mut unknown = None;
        for (section, table) in &given {
            for (name, node) in table.entries() {
                let name = format!("{section}.{}", format_segment(name));
                let Some(key) = Key::find_by_name(&name) else {
                    unknown.get_or_insert(name);
                    continue;
                };
                own.positions.add_alias(key.name, region.full_key(key.name));
                let Some(value) = node.as_value().and_then(|value| parse_key_value(key, value))
                else {
                    let found = format!("found {}", node.describe());
                    return Err(own.positions.key_error(
                        key.name,
                        found,
                        describe_allowed_values(key),
                    ));
                };
                own.scalar_values.insert(key.name, value);
            }
        }
        match unknown {
            Some(name) => {
                let key = region.full_key(&name);
                Err(own.unknown_key_error(&name, &key, self.positions.locate(&key)))
            }
            None => Ok(own),
        }
    }

    /// Returns whether a region inherits the value of `key` from the case.
    pub(super) fn is_inherited(&self, key: &str) -> bool {
        !self.positions.has_alias(key)
    }

    /// Removes the inherited values that the medium of a region does not use.
    pub(super) fn remove_unused_inherited(&mut self, is_used: impl Fn(&str) -> bool) {
        let positions = &self.positions;
        self.scalar_values.retain(|key, _| positions.has_alias(key) || is_used(key));
    }

    /// Builds the error of an unknown key `name`, with a suggestion and the allowed keys; `shown_as` is the key as
    /// printed in the message.
    fn unknown_key_error(&self, name: &str, shown_as: &str, position: SourcePosition) -> CaseError {
        let text = |key: &str| self.value(key).and_then(CaseValue::as_text);
        let kind = text("model.kind").and_then(ModelKind::from_name);
        let yields = text("yield.kind").and_then(registry::find_yield_set);
        let is_usable = |key: &Key| {
            kind.is_none_or(|kind| key.is_used_by(MediumKind { kind, yield_set: yields }))
        };
        let (mut section, last) = name.rsplit_once('.').unwrap_or(("", name));
        while !section.is_empty() && !is_section(section) {
            section = section.rsplit_once('.').map_or("", |(outer, _)| outer);
        }
        let mut siblings = list_section_keys(section, is_usable);
        if section.is_empty() {
            siblings.push(self.schemas.check.header());
            let in_time =
                kind.map_or_else(|| self.schemas.solids.to_vec(), self.schemas.simulation);
            siblings.extend(in_time.iter().map(|table_schema| table_schema.header()));
        }
        let bare = siblings.iter().map(|sibling| sibling.trim_matches(['[', ']']));
        // Suggest the key of the same name in another section, else the most similar name in this section.
        let misplaced = keys().iter().find(|key| is_usable(key) && key.split_section().1 == last);
        let sought = if section.is_empty() { name } else { last };
        let meant = misplaced.map(|key| key.name).or_else(|| find_similar_name(sought, bare));
        let allowed = format_allowed("allowed here", meant, &siblings);
        let found = if section.is_empty() { "unknown key or section" } else { "unknown key" };
        CaseError::Key { position, key: escape(shown_as), found: found.into(), allowed }
    }

    /// Returns the value of a key, if given.
    pub(super) fn value(&self, key: &str) -> Option<&CaseValue> {
        self.scalar_values.get(key)
    }

    /// Returns whether a section is in the file or was set by an option.
    pub(super) fn has_section(&self, section: &str) -> bool {
        self.positions.has_line(section)
            || self.scalar_values.keys().any(|key| is_inside(key, section))
    }

    /// Returns the value of a required key.
    pub(super) fn require_value(&self, key: &'static str) -> Result<&CaseValue, CaseError> {
        self.value(key).ok_or_else(|| {
            let row = Key::find_by_name(key);
            let section = key.rsplit_once('.').map_or("", |(section, _)| section);
            let allowed = row.map_or(String::new(), |row| {
                let name = row.split_section().1;
                match self.has_section(section) {
                    true => {
                        format!(
                            "add {name} to {}: {}",
                            self.positions.section_title(section),
                            describe_allowed_values(row)
                        )
                    }
                    false => format!(
                        "add a section [{section}] with {name}: {}",
                        describe_allowed_values(row)
                    ),
                }
            });
            self.positions.key_error(key, "missing", allowed)
        })
    }

    /// Returns the text of a required key.
    pub(super) fn require_text(&self, key: &'static str) -> Result<&str, CaseError> {
        match self.require_value(key)? {
            CaseValue::Text(text) => Ok(text),
            _ => Ok(""), // unreachable: the key table declares the key as text
        }
    }

    /// Returns the number of a required key.
    pub(super) fn require_number(&self, key: &'static str) -> Result<f64, CaseError> {
        match self.require_value(key)? {
            CaseValue::Number(number) => Ok(*number),
            CaseValue::Count(count) => Ok(*count as f64),
            _ => Ok(0.0), // unreachable: the key table declares the key as a number
        }
    }
}

/// Describes the allowed values of a key, for messages.
pub(super) fn describe_allowed_values(key: &Key) -> String {
    let unit = if key.unit.is_empty() { String::new() } else { format!(" in {}", key.unit) };
    let expected = key.storage.value_type().describe(&SchemaScope::default());
    format!("expected {expected}{unit} ({})", key.meaning)
}

/// Checks the number of keys and tables before parsing: each takes over a kilobyte in the parser.
fn check_entry_counts(text: &str, file: &str) -> Result<(), CaseError> {
    let count = |byte: u8| text.bytes().filter(|own| *own == byte).count();
    // Lines with a comma are rows of nested lists, not headers.
    let is_header = |line: &&str| line.trim_start().starts_with('[') && !line.contains(',');
    let tables = count(b'{') + text.lines().filter(is_header).count();
    for (found, most, what) in
        [(tables, MAX_TABLES, "sections and tables"), (count(b'='), MAX_KEYS, "keys")]
    {
        if found > most {
            let cause = format!("about {found} {what}, more than the maximum of {most}");
            return Err(CaseError::Unreadable { path: file.into(), cause });
        }
    }
    Ok(())
}

/// Returns a function from a byte offset in the text to its line number, from 1.
fn build_line_index(text: &str) -> impl Fn(usize) -> usize {
    let ends: Vec<usize> = text.match_indices('\n').map(|(offset, _)| offset).collect();
    move |offset| 1 + ends.partition_point(|&end| end < offset)
}

/// A value of the parsed document with its dotted name and its byte offset in the text.
struct DocumentEntry<'d, 'a> {
    name: String,
    value: &'d DeValue<'a>,
    offset: usize,
}

/// Collects the entries of a table and of the sections inside it, with dotted names; `prefix` is the dotted name of the
/// table.
fn collect_entries<'d, 'a>(
    prefix: &str,
    table: &'d DeTable<'a>,
    found: &mut Vec<DocumentEntry<'d, 'a>>,
) {
    for (key, value) in table {
        // A quoted key "model.kind" is a single name with a dot, not a key of a section.
        let segment = format_segment(key.get_ref());
        let name = if prefix.is_empty() { segment } else { format!("{prefix}.{segment}") };
        let value = value.get_ref();
        if let (Some(inner), true) = (value.as_table(), is_section(&name)) {
            collect_entries(&name, inner, found);
        }
        found.push(DocumentEntry { name, value, offset: key.span().start });
    }
}

/// Describes the section `name`: its title, or for a table inside a section its keys.
fn expect_section(name: &str) -> String {
    let Some((_, own)) = name.rsplit_once('.') else {
        return format!("expected a section [{name}]");
    };
    let keys: Vec<String> = keys()
        .iter()
        .filter_map(|key| key.name.strip_prefix(name)?.strip_prefix('.'))
        .map(|key| format!("{key} = …"))
        .collect();
    format!("expected a table {own} = {{ {} }}", keys.join(", "))
}

/// Replaces former names of sections by the current names; returns hints.
fn rename_former_sections(
    found: &mut [DocumentEntry],
    schemas: &CaseSchemas,
    locate: impl Fn(usize) -> SourcePosition,
) -> Result<HintList, CaseError> {
    let mut hints = HintList::default();
    for index in 0..found.len() {
        let DocumentEntry { name, offset, .. } = &found[index];
        let Some(table_schema) = schemas.find_by_former_name(name) else { continue };
        let has_current_name = found.iter().any(|entry| entry.name == table_schema.name);
        hints.add_section_of_file(locate(*offset), table_schema, name, has_current_name)?;
        table_schema.name.clone_into(&mut found[index].name);
    }
    Ok(hints)
}

/// Returns the first segment of a dotted key.
fn root_section(name: &str) -> &str {
    name.split(['.', '[']).next().unwrap_or_default()
}

fn is_section(name: &str) -> bool {
    keys().iter().any(|key| is_inside(key.name, name))
}

/// Returns the usable keys directly inside a section; subsections in brackets.
fn list_section_keys(section: &str, is_usable: impl Fn(&Key) -> bool) -> Vec<String> {
    let mut names = Vec::new();
    for key in keys().iter().filter(|key| is_usable(key)) {
        let rest = match section {
            "" => Some(key.name),
            _ => key.name.strip_prefix(section).and_then(|rest| rest.strip_prefix('.')),
        };
        let name = rest.map(|rest| match rest.split_once('.') {
            Some((inner, _)) => format!("[{inner}]"),
            None => rest.to_owned(),
        });
        names.extend(name);
    }
    names.dedup();
    names
}

/// Converts a TOML value to the type of the key; `None` if the value has another type.
fn parse_key_value(key: &Key, value: &DeValue) -> Option<CaseValue> {
    key.storage.value_type().parse_value(value, &SchemaScope::default())
}

/// Finds the kind of model `name`; an error refers to `key`.
pub(super) fn find_model_kind(
    name: &str,
    key: &str,
    positions: &KeyPositions,
) -> Result<ModelKind, CaseError> {
    ModelKind::from_name(name).ok_or_else(|| {
        let kinds = ModelKind::all_kinds().into_iter().chain([ModelKind::Equations]);
        let names: Vec<&str> = kinds.map(ModelKind::name).collect();
        let meant = find_similar_name(name, names.iter().copied());
        let found = format!("found '{}'", escape(name));
        positions.key_error(key, found, format_allowed("allowed", meant, &names))
    })
}
