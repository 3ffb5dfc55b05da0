//! Generator of the structured sections of a template.

use crate::dynamics::{StateComponent, stress};
use crate::kind::ModelKind;
use crate::schema::{KeyCondition, KeyPresence, KeySchema, SchemaScope, TableSchema, ValueType};
use std::fmt::Write;

/// Maximum line length of comments, characters.
const MAX_LINE_WIDTH: usize = 110;

/// A section of the example: name, and pairs of key and value.
pub(super) type ExampleSection = (&'static str, &'static [(&'static str, &'static str)]);

/// Formats the comment of a key: unit and meaning.
pub(super) fn format_comment(unit: &str, meaning: &str) -> String {
    match unit {
        "" => meaning.to_owned(),
        unit if unit.starts_with("the unit") => format!("in {unit}: {meaning}"),
        unit => format!("{unit}: {meaning}"),
    }
}

/// Wraps a text into lines of at most `width` characters.
fn wrap_text(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for name in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + name.chars().count() <= width => {
                line.push(' ');
                line.push_str(name);
            }
            _ => lines.push(name.to_owned()),
        }
    }
    lines
}

/// Generator of the structured sections of a template.
pub(super) struct SectionTemplates {
    text: String,
    scope: SchemaScope,
    comment_column: usize,
    /// Names of the inline tables whose variants have been written.
    written_tables: Vec<&'static str>,
}

/// Returns whether two schemas describe the same key.
fn is_same_key(one: &KeySchema, other: &KeySchema) -> bool {
    (one.name, one.meaning, one.unit) == (other.name, other.meaning, other.unit)
}

impl SectionTemplates {
    /// Creates an empty generator with comments at `column`.
    pub(super) fn new(kind: ModelKind, column: usize) -> Self {
        let scope = SchemaScope { kind: Some(kind), dimensions: Some(2), face_axes: vec![0] };
        Self { text: String::new(), scope, comment_column: column, written_tables: Vec::new() }
    }

    /// Writes the sections of the example `start` that have the schema `table_schema`, followed by all other variants
    /// of the schema, commented out.
    pub(super) fn add_section(
        &mut self,
        table_schema: &'static TableSchema,
        start: &[ExampleSection],
    ) {
        let separator = if self.text.is_empty() { "" } else { "\n" };
        let _ = write!(self.text, "{separator}");
        for line in wrap_text(&format_sentence(table_schema.meaning), MAX_LINE_WIDTH) {
            let _ = writeln!(self.text, "# {line}");
        }
        if table_schema.groups.is_empty() {
            return self.add_stress_section(table_schema);
        }
        let mut blocks: Vec<Vec<&'static KeySchema>> = Vec::new();
        for (_, given) in start.iter().filter(|(name, _)| *name == table_schema.name) {
            let variant =
                TableVariant { given_values: given, discriminator_value: None, present_key: None };
            let items = self.variant_keys(table_schema, &variant);
            self.write_variant(table_schema, &variant, &items, true, &blocks);
            blocks.push(items);
        }
        let names =
            table_schema.discriminator().map_or(Vec::new(), |(item, _)| self.allowed_names(item));
        let names: Vec<Option<&str>> = match names.is_empty() {
            true => vec![None],
            false => names.iter().map(|name| Some(name.as_str())).collect(),
        };
        for name in names {
            let switches = [None].into_iter().chain(exclusive_keys(table_schema).map(Some));
            for present in switches {
                let variant = TableVariant {
                    given_values: &[],
                    discriminator_value: name,
                    present_key: present,
                };
                let items = self.variant_keys(table_schema, &variant);
                let is_needed =
                    |item: &&&KeySchema| !matches!(item.presence, KeyPresence::Optional(_));
                let has = |block: &[&KeySchema], item: &KeySchema| {
                    block.iter().any(|own| is_same_key(own, item))
                };
                let is_shown = blocks
                    .iter()
                    .any(|block| items.iter().filter(is_needed).all(|item| has(block, item)));
                let is_possible = present.is_none_or(|key| items.iter().any(|own| own.name == key))
                    && items
                        .iter()
                        .all(|item| self.key_value(table_schema, item, &variant).is_some());
                let is_other = present.is_some_and(|key| {
                    !blocks.iter().any(|block| block.iter().any(|own| own.name == key))
                });
                if is_possible && (!is_shown || is_other) {
                    self.write_variant(table_schema, &variant, &items, false, &blocks);
                    blocks.push(items);
                }
            }
        }
    }

    /// Returns the generated text.
    pub(super) fn into_text(self) -> String {
        self.text
    }

    /// Writes the section `[initial_stress]`, whose keys are stress components.
    fn add_stress_section(&mut self, table_schema: &TableSchema) {
        let Some(ModelKind::Solid(solid)) = self.scope.kind else { return };
        let _ = writeln!(self.text, "\n# {}", table_schema.header());
        let all = StateComponent::all_components(solid.theory, 2);
        for component in all.into_iter().filter(|component| !component.is_velocity()) {
            let line = format!("# {component} = 0.0");
            let unit = stress::stress_unit(component);
            let _ = writeln!(self.text, "{line:<0$}# {unit}", self.comment_column);
        }
    }

    /// Returns the allowed names of a key for the kind of model.
    fn allowed_names(&self, item: &KeySchema) -> Vec<String> {
        match item.value_type {
            ValueType::OneOf(allowed_names) | ValueType::AnyOf(allowed_names) => {
                allowed_names(&self.scope)
            }
            _ => Vec::new(),
        }
    }

    /// Returns the keys of a variant; for a key whose type depends on the dimensions its schema for plane strain.
    fn variant_keys(
        &self,
        table_schema: &'static TableSchema,
        variant: &TableVariant,
    ) -> Vec<&'static KeySchema> {
        let in_plane = |condition: &KeyCondition| {
            *condition != KeyCondition::Space && variant.is_satisfied(table_schema, condition)
        };
        let plane: Vec<&KeySchema> = table_schema.applicable_keys(in_plane).collect();
        let anywhere = |condition: &KeyCondition| variant.is_satisfied(table_schema, condition);
        table_schema
            .applicable_keys(anywhere)
            .filter(|item| {
                plane.iter().any(|own| std::ptr::eq(*own, *item))
                    || plane.iter().all(|own| own.name != item.name)
            })
            .filter(|item| {
                // A key that replaces other keys is written only in the variant in which it is present.
                let is_switch = exclusive_keys(table_schema).any(|key| key == item.name);
                !is_switch || variant.has_key(item.name)
            })
            .collect()
    }

    /// Returns the value of a key in a variant: the given value, else for the discriminator its value in the variant,
    /// else the default or example; `None` if the kind of model allows no name for the key.
    fn key_value(
        &self,
        table_schema: &'static TableSchema,
        item: &KeySchema,
        variant: &TableVariant,
    ) -> Option<String> {
        if let Some((_, value)) = variant.given_values.iter().find(|(key, _)| *key == item.name) {
            return Some((*value).to_owned());
        }
        if let (Some((own, _)), Some(name)) =
            (table_schema.discriminator(), variant.discriminator_value)
            && own.name == item.name
        {
            return Some(format!("{name:?}"));
        }
        let example = item.example_value();
        let ValueType::OneOf(_) = item.value_type else { return Some(example.to_owned()) };
        let names = self.allowed_names(item);
        match names.iter().any(|name| format!("{name:?}") == example) {
            true => Some(example.to_owned()),
            false => names.first().map(|name| format!("{name:?}")),
        }
    }

    /// Writes one variant, commented out unless it is part of the example. Descriptions are written at the first
    /// occurrence of a key.
    fn write_variant(
        &mut self,
        table_schema: &'static TableSchema,
        variant: &TableVariant,
        items: &[&'static KeySchema],
        is_active: bool,
        before: &[Vec<&'static KeySchema>],
    ) {
        let header =
            if is_active { table_schema.header() } else { format!("# {}", table_schema.header()) };
        let _ = writeln!(self.text, "\n{header}");
        for item in items {
            let was_shown =
                before.iter().any(|block| block.iter().any(|own| is_same_key(own, item)));
            let is_given = variant.given_values.iter().any(|(key, _)| *key == item.name);
            let is_optional = !matches!(item.presence, KeyPresence::Required(_));
            // The first active section with this schema shows all keys; further sections show given keys only.
            if is_active && !before.is_empty() && !is_given {
                continue;
            }
            if was_shown
                && matches!(item.presence, KeyPresence::Optional(_))
                && !is_given
                && !variant.has_key(item.name)
            {
                continue;
            }
            let is_set = is_active && (is_given || !is_optional);
            let mut comment = if was_shown { String::new() } else { self.format_key_comment(item) };
            if item.conditions.contains(&KeyCondition::Space) {
                let separator = if comment.is_empty() { "" } else { "; " };
                comment = format!("3D only{separator}{comment}");
            }
            if let ValueType::Table(inner) = item.value_type {
                self.write_inline_tables(table_schema, item, inner, variant, is_set, comment);
                continue;
            }
            let value = self.key_value(table_schema, item, variant).unwrap_or_default();
            self.write_line(is_set, item.name, &value, &comment);
        }
    }

    fn format_key_comment(&self, item: &KeySchema) -> String {
        /// Maximum number of names listed in a comment.
        const MAX_LISTED_NAMES: usize = 12;
        let mut text = format_comment(item.unit, item.meaning);
        let names = self.allowed_names(item);
        let is_said = names.iter().all(|name| item.meaning.contains(name.as_str()));
        if (1..=MAX_LISTED_NAMES).contains(&names.len()) && !is_said {
            let _ = write!(text, "; {}", names.join(", "));
        }
        text
    }

    /// Writes an inline table and, at its first occurrence, all alternative tables.
    fn write_inline_tables(
        &mut self,
        table_schema: &'static TableSchema,
        item: &KeySchema,
        inner: &'static TableSchema,
        variant: &TableVariant,
        is_set: bool,
        comment: String,
    ) {
        let value = self.key_value(table_schema, item, variant).unwrap_or_default();
        if self.written_tables.contains(&inner.name) {
            return self.write_line(is_set, item.name, &value, &comment);
        }
        self.written_tables.push(inner.name);
        let discriminator = inner.discriminator().map(|(item, _)| item);
        let meaning = discriminator.map_or("", |item| item.meaning);
        let kind_key = discriminator.map_or("kind", |item| item.name);
        for line in wrap_text(
            &format!("{} {}", format_sentence(&comment), format_sentence(meaning)),
            MAX_LINE_WIDTH,
        ) {
            let _ = writeln!(self.text, "# {line}");
        }
        if is_set {
            self.write_line(true, item.name, &value, "");
        }
        for name in inner.discriminator().map_or(Vec::new(), |(kind, _)| self.allowed_names(kind)) {
            for present in [None].into_iter().chain(exclusive_keys(inner).map(Some)) {
                let variant = TableVariant {
                    given_values: &[],
                    discriminator_value: Some(&name),
                    present_key: present,
                };
                let items = self.variant_keys(inner, &variant);
                let is_possible = present.is_none_or(|key| items.iter().any(|own| own.name == key));
                let own = format!("{kind_key} = \"{name}\"");
                if !is_possible || (is_set && value.contains(&own)) {
                    continue;
                }
                let is_in_space = |own: &KeySchema| own.conditions.contains(&KeyCondition::Space);
                let pairs: Vec<String> = items
                    .iter()
                    .filter(|own| !is_in_space(own))
                    .filter_map(|own| {
                        Some(format!("{} = {}", own.name, self.key_value(inner, own, &variant)?))
                    })
                    .collect();
                let units: Vec<String> = items
                    .iter()
                    .filter(|own| own.name != kind_key)
                    .map(|own| match is_in_space(own) {
                        true => format!("in 3D also {} = {}", own.name, own.example_value()),
                        false if own.unit.is_empty() => own.meaning.to_owned(),
                        false => format!("{} in {}", own.name, own.unit),
                    })
                    .collect();
                let value = format!("{{ {} }}", pairs.join(", "));
                self.write_line(false, item.name, &value, &units.join(", "));
            }
        }
    }

    /// Writes a key and its comment, which is continued on further lines if it is long.
    fn write_line(&mut self, is_set: bool, name: &str, value: &str, comment: &str) {
        let mark = if is_set { "" } else { "# " };
        let line = format!("{mark}{name} = {value}");
        if comment.is_empty() {
            let _ = writeln!(self.text, "{line}");
            return;
        }
        let column = self.comment_column;
        let width = (line.chars().count() + 2).max(column);
        let lines = wrap_text(comment, MAX_LINE_WIDTH.saturating_sub(width).max(40));
        for (index, comment) in lines.iter().enumerate() {
            let line = if index == 0 { line.as_str() } else { "" };
            let _ = writeln!(self.text, "{line:<width$}# {comment}");
        }
    }
}

/// Returns the keys whose presence or absence is a condition of other keys.
fn exclusive_keys(table_schema: &'static TableSchema) -> impl Iterator<Item = &'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for (when, item) in table_schema.keys() {
        for condition in when.iter().chain(item.conditions) {
            if let KeyCondition::Present(key) | KeyCondition::Absent(key) = condition
                && !names.contains(key)
            {
                names.push(key);
            }
        }
    }
    names.into_iter()
}

/// A variant of a table: given values, value of the discriminator and key assumed present.
struct TableVariant<'a> {
    given_values: &'a [(&'static str, &'static str)],
    /// Value of the discriminator.
    discriminator_value: Option<&'a str>,
    /// Key that replaces other keys, if present.
    present_key: Option<&'static str>,
}

impl TableVariant<'_> {
    fn has_key(&self, key: &str) -> bool {
        self.present_key == Some(key) || self.given_values.iter().any(|(own, _)| *own == key)
    }

    fn is_satisfied(&self, table_schema: &'static TableSchema, condition: &KeyCondition) -> bool {
        match condition {
            KeyCondition::HasValue(key, names) => {
                let own = table_schema.discriminator().filter(|(item, _)| item.name == *key);
                let given =
                    self.given_values.iter().find(|(own, _)| own == key).map(|(_, value)| *value);
                let example = table_schema.keys().find(|(_, item)| item.name == *key);
                let example = example.map_or("", |(_, item)| item.example_value());
                let value = match (given, own, self.discriminator_value) {
                    (Some(given), _, _) => given.trim_matches('"'),
                    (None, Some(_), Some(name)) => name,
                    _ => example.trim_matches('"'),
                };
                names.contains(&value)
            }
            KeyCondition::Present(key) => self.has_key(key),
            KeyCondition::Absent(key) => !self.has_key(key),
            KeyCondition::PlaneStrain | KeyCondition::Space => true,
        }
    }
}

/// Formats a meaning as a sentence.
fn format_sentence(meaning: &str) -> String {
    let mut letters = meaning.chars();
    let first = letters.next().map_or(String::new(), |letter| letter.to_uppercase().collect());
    format!("{first}{}.", letters.as_str())
}
