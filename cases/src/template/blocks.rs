//! Generator of the structured sections of a template.

use crate::dynamics::{Component, stress};
use crate::kind::Kind;
use crate::schema::{Condition, Form, Item, Need, Scope, Type};
use std::fmt::Write;

/// Maximum line length of comments, characters.
const WIDTH: usize = 110;

/// A section of the example: name, and pairs of key and value.
pub(super) type Start = (&'static str, &'static [(&'static str, &'static str)]);

/// Formats the comment of a key: unit and meaning.
pub(super) fn comment(unit: &str, meaning: &str) -> String {
    match unit {
        "" => meaning.to_owned(),
        unit if unit.starts_with("the unit") => format!("in {unit}: {meaning}"),
        unit => format!("{unit}: {meaning}"),
    }
}

/// Wraps a text into lines of at most `width` characters.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Generator of the structured sections of a template.
pub(super) struct Blocks {
    text: String,
    scope: Scope,
    column: usize,
    /// Names of the inline tables whose variants have been written.
    shown: Vec<&'static str>,
}

/// Returns whether two items describe the same key.
fn is_same(one: &Item, other: &Item) -> bool {
    (one.name, one.meaning, one.unit) == (other.name, other.meaning, other.unit)
}

impl Blocks {
    /// Creates an empty generator with comments at `column`.
    pub(super) fn new(kind: Kind, column: usize) -> Self {
        let scope = Scope { kind: Some(kind), dimensions: Some(2), axes: vec![0] };
        Self { text: String::new(), scope, column, shown: Vec::new() }
    }

    /// Writes the sections of the example, followed by all other variants of the schema, commented out.
    pub(super) fn add(&mut self, form: &'static Form, start: &[Start]) {
        let separator = if self.text.is_empty() { "" } else { "\n" };
        let _ = write!(self.text, "{separator}");
        for line in wrapped(&sentence(form.meaning), WIDTH) {
            let _ = writeln!(self.text, "# {line}");
        }
        if form.groups.is_empty() {
            return self.add_stresses(form);
        }
        let mut blocks: Vec<Vec<&'static Item>> = Vec::new();
        for (_, given) in start.iter().filter(|(name, _)| *name == form.name) {
            let variant = Variant { given, word: None, present: None };
            let items = self.items(form, &variant);
            self.write(form, &variant, &items, true, &blocks);
            blocks.push(items);
        }
        let words = form.discriminator().map_or(Vec::new(), |(item, _)| self.words(item));
        let words: Vec<Option<&str>> = match words.is_empty() {
            true => vec![None],
            false => words.iter().map(|word| Some(word.as_str())).collect(),
        };
        for word in words {
            let switches = [None].into_iter().chain(switches(form).map(Some));
            for present in switches {
                let variant = Variant { given: &[], word, present };
                let items = self.items(form, &variant);
                let is_needed = |item: &&&Item| !matches!(item.need, Need::Optional(_));
                let has = |block: &[&Item], item: &Item| block.iter().any(|own| is_same(own, item));
                let is_shown = blocks
                    .iter()
                    .any(|block| items.iter().filter(is_needed).all(|item| has(block, item)));
                let is_possible = present.is_none_or(|key| items.iter().any(|own| own.name == key))
                    && items.iter().all(|item| self.value(form, item, &variant).is_some());
                let is_other = present.is_some_and(|key| {
                    !blocks.iter().any(|block| block.iter().any(|own| own.name == key))
                });
                if is_possible && (!is_shown || is_other) {
                    self.write(form, &variant, &items, false, &blocks);
                    blocks.push(items);
                }
            }
        }
    }

    /// Returns the generated text.
    pub(super) fn into_text(self) -> String {
        self.text
    }

    /// Writes the section whose keys are stress components.
    fn add_stresses(&mut self, form: &Form) {
        let Some(Kind::Solid(solid)) = self.scope.kind else { return };
        let _ = writeln!(self.text, "\n# {}", form.header());
        let all = Component::all(solid.theory, 2);
        for component in all.into_iter().filter(|component| !component.is_velocity()) {
            let line = format!("# {component} = 0.0");
            let unit = stress::unit(component);
            let _ = writeln!(self.text, "{line:<0$}# {unit}", self.column);
        }
    }

    /// Returns the allowed words of a key for the kind of model.
    fn words(&self, item: &Item) -> Vec<String> {
        match item.value {
            Type::OneOf(words) | Type::AnyOf(words) => words(&self.scope),
            _ => Vec::new(),
        }
    }

    /// Returns the keys of a variant; for a key whose type depends on the dimensions the item for plane strain.
    fn items(&self, form: &'static Form, variant: &Variant) -> Vec<&'static Item> {
        let in_plane = |condition: &Condition| {
            *condition != Condition::Space && variant.holds(form, condition)
        };
        let plane: Vec<&Item> = form.applicable(in_plane).collect();
        let anywhere = |condition: &Condition| variant.holds(form, condition);
        form.applicable(anywhere)
            .filter(|item| {
                plane.iter().any(|own| std::ptr::eq(*own, *item))
                    || plane.iter().all(|own| own.name != item.name)
            })
            .filter(|item| {
                // A key that replaces other keys is written only in the variant in which it is present.
                let is_switch = switches(form).any(|key| key == item.name);
                !is_switch || variant.has(item.name)
            })
            .collect()
    }

    /// Returns the value of a key in a variant: the given value, else the word of the variant, else the default or
    /// example; `None` if the kind of model has no word for the key.
    fn value(&self, form: &'static Form, item: &Item, variant: &Variant) -> Option<String> {
        if let Some((_, value)) = variant.given.iter().find(|(key, _)| *key == item.name) {
            return Some((*value).to_owned());
        }
        if let (Some((own, _)), Some(word)) = (form.discriminator(), variant.word)
            && own.name == item.name
        {
            return Some(format!("{word:?}"));
        }
        let example = item.example();
        let Type::OneOf(_) = item.value else { return Some(example.to_owned()) };
        let words = self.words(item);
        match words.iter().any(|word| format!("{word:?}") == example) {
            true => Some(example.to_owned()),
            false => words.first().map(|word| format!("{word:?}")),
        }
    }

    /// Writes one variant, commented out unless it is part of the example. Descriptions are written at the first
    /// occurrence of a key.
    fn write(
        &mut self,
        form: &'static Form,
        variant: &Variant,
        items: &[&'static Item],
        is_active: bool,
        before: &[Vec<&'static Item>],
    ) {
        let header = if is_active { form.header() } else { format!("# {}", form.header()) };
        let _ = writeln!(self.text, "\n{header}");
        for item in items {
            let was_shown = before.iter().any(|block| block.iter().any(|own| is_same(own, item)));
            let is_given = variant.given.iter().any(|(key, _)| *key == item.name);
            let is_optional = !matches!(item.need, Need::Required(_));
            // The first active section of a form shows all keys; further sections show given keys only.
            if is_active && !before.is_empty() && !is_given {
                continue;
            }
            if was_shown
                && matches!(item.need, Need::Optional(_))
                && !is_given
                && !variant.has(item.name)
            {
                continue;
            }
            let is_set = is_active && (is_given || !is_optional);
            let mut comment = if was_shown { String::new() } else { self.comment_of(item) };
            if item.when.contains(&Condition::Space) {
                let separator = if comment.is_empty() { "" } else { "; " };
                comment = format!("in space alone{separator}{comment}");
            }
            if let Type::Table(inner) = item.value {
                self.write_tables(form, item, inner, variant, is_set, comment);
                continue;
            }
            let value = self.value(form, item, variant).unwrap_or_default();
            self.line(is_set, item.name, &value, &comment);
        }
    }

    fn comment_of(&self, item: &Item) -> String {
        /// Maximum number of words listed in a comment.
        const MOST: usize = 12;
        let mut text = comment(item.unit, item.meaning);
        let words = self.words(item);
        let is_said = words.iter().all(|word| item.meaning.contains(word.as_str()));
        if (1..=MOST).contains(&words.len()) && !is_said {
            let _ = write!(text, "; {}", words.join(", "));
        }
        text
    }

    /// Writes an inline table and, at its first occurrence, all alternative tables.
    fn write_tables(
        &mut self,
        form: &'static Form,
        item: &Item,
        inner: &'static Form,
        variant: &Variant,
        is_set: bool,
        comment: String,
    ) {
        let value = self.value(form, item, variant).unwrap_or_default();
        if self.shown.contains(&inner.name) {
            return self.line(is_set, item.name, &value, &comment);
        }
        self.shown.push(inner.name);
        let meaning = inner.discriminator().map_or("", |(kind, _)| kind.meaning);
        for line in wrapped(&format!("{} {}", sentence(&comment), sentence(meaning)), WIDTH) {
            let _ = writeln!(self.text, "# {line}");
        }
        if is_set {
            self.line(true, item.name, &value, "");
        }
        for word in inner.discriminator().map_or(Vec::new(), |(kind, _)| self.words(kind)) {
            for present in [None].into_iter().chain(switches(inner).map(Some)) {
                let variant = Variant { given: &[], word: Some(&word), present };
                let items = self.items(inner, &variant);
                let is_possible = present.is_none_or(|key| items.iter().any(|own| own.name == key));
                let own = format!("kind = \"{word}\"");
                if !is_possible || (is_set && value.contains(&own)) {
                    continue;
                }
                let is_in_space = |own: &Item| own.when.contains(&Condition::Space);
                let pairs: Vec<String> = items
                    .iter()
                    .filter(|own| !is_in_space(own))
                    .filter_map(|own| {
                        Some(format!("{} = {}", own.name, self.value(inner, own, &variant)?))
                    })
                    .collect();
                let units: Vec<String> = items
                    .iter()
                    .filter(|own| own.name != "kind")
                    .map(|own| match is_in_space(own) {
                        true => format!("in space also {} = {}", own.name, own.example()),
                        false if own.unit.is_empty() => own.meaning.to_owned(),
                        false => format!("{} in {}", own.name, own.unit),
                    })
                    .collect();
                let value = format!("{{ {} }}", pairs.join(", "));
                self.line(false, item.name, &value, &units.join(", "));
            }
        }
    }

    /// Writes a key and its comment, which is continued on further lines if it is long.
    fn line(&mut self, is_set: bool, name: &str, value: &str, comment: &str) {
        let mark = if is_set { "" } else { "# " };
        let line = format!("{mark}{name} = {value}");
        if comment.is_empty() {
            let _ = writeln!(self.text, "{line}");
            return;
        }
        let column = self.column;
        let width = (line.chars().count() + 2).max(column);
        let lines = wrapped(comment, WIDTH.saturating_sub(width).max(40));
        for (index, comment) in lines.iter().enumerate() {
            let line = if index == 0 { line.as_str() } else { "" };
            let _ = writeln!(self.text, "{line:<width$}# {comment}");
        }
    }
}

/// Returns the keys whose presence excludes or requires other keys.
fn switches(form: &'static Form) -> impl Iterator<Item = &'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for (when, item) in form.items() {
        for condition in when.iter().chain(item.when) {
            if let Condition::Present(key) | Condition::Absent(key) = condition
                && !names.contains(key)
            {
                names.push(key);
            }
        }
    }
    names.into_iter()
}

/// A variant of a table: given values, word of the discriminator and key assumed present.
struct Variant<'a> {
    given: &'a [(&'static str, &'static str)],
    /// Word of the discriminator.
    word: Option<&'a str>,
    /// Key that replaces other keys, if present.
    present: Option<&'static str>,
}

impl Variant<'_> {
    fn has(&self, key: &str) -> bool {
        self.present == Some(key) || self.given.iter().any(|(own, _)| *own == key)
    }

    fn holds(&self, form: &'static Form, condition: &Condition) -> bool {
        match condition {
            Condition::Is(key, words) => {
                let own = form.discriminator().filter(|(item, _)| item.name == *key);
                let given = self.given.iter().find(|(own, _)| own == key).map(|(_, value)| *value);
                let example = form.items().find(|(_, item)| item.name == *key);
                let example = example.map_or("", |(_, item)| item.example());
                let value = match (given, own, self.word) {
                    (Some(given), _, _) => given.trim_matches('"'),
                    (None, Some(_), Some(word)) => word,
                    _ => example.trim_matches('"'),
                };
                words.contains(&value)
            }
            Condition::Present(key) => self.has(key),
            Condition::Absent(key) => !self.has(key),
            Condition::Plane | Condition::Space => true,
        }
    }
}

/// Formats a meaning as a sentence.
fn sentence(meaning: &str) -> String {
    let mut letters = meaning.chars();
    let first = letters.next().map_or(String::new(), |letter| letter.to_uppercase().collect());
    format!("{first}{}.", letters.as_str())
}
