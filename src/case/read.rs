//! From TOML text and `--set` options to values by key, each with its place.

use super::error::{CaseError, Place, shown};
use super::keys::{Field, KEYS, Key, Value};
use super::kind::{Kind, Medium, Yield};
use super::section::{Node, Refused, Section, Table, segment};
use std::collections::BTreeMap;
use std::sync::Arc;
use toml::de::{DeArray, DeInteger, DeTable, DeValue};

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

impl Standing {
    /// Forgets where a key and all inside it stand.
    fn forget(&mut self, key: &str) {
        let is_kept = |name: &str| {
            name.strip_prefix(key)
                .is_none_or(|rest| !(rest.is_empty() || rest.starts_with(['.', '['])))
        };
        self.lines.retain(|name, _| is_kept(name));
        self.options.retain(|name, _| is_kept(name));
    }
}

impl Places {
    fn new(file: &str) -> Self {
        let (file, lines, options) = (file.to_owned(), BTreeMap::new(), BTreeMap::new());
        Self { all: Arc::new(Standing { file, lines, options }), aliases: BTreeMap::new() }
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
    fn title(&self, section: &str) -> String {
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

/// The sections of a case that say how it is run in time, in the order in which they are written;
/// whether each is a list.
pub(super) const SECTIONS_IN_TIME: [(&str, bool); 12] = [
    ("grid", false),
    ("time", false),
    ("scheme", false),
    ("region", true),
    ("side", true),
    ("load", true),
    ("source", true),
    ("initial", true),
    ("initial_stress", false),
    ("gravity", false),
    ("receiver", true),
    ("output", false),
];

fn is_in_time(section: &str) -> bool {
    SECTIONS_IN_TIME.iter().any(|(name, _)| *name == section)
}

/// The values of a case by key, before their meaning is looked at.
pub(super) struct Entries<'a> {
    values: BTreeMap<&'static str, Value>,
    /// The sections of [`SECTIONS_IN_TIME`].
    in_time: Table<'a>,
    pub(super) places: Places,
}

impl<'a> Entries<'a> {
    /// Reads the text of a file, then the `--set` options over it; the last one of a key holds.
    pub(super) fn read(text: &'a str, file: &str, sets: &'a [String]) -> Result<Self, CaseError> {
        let document = DeTable::parse(text).map_err(|error| {
            let line = lines(text)(error.span().map_or(0, |span| span.start));
            let content = text.lines().nth(line - 1).unwrap_or_default().trim();
            CaseError::Syntax {
                place: Place::Line { file: file.to_owned(), line },
                cause: format!("{} in '{}'", shown(error.message()), shown(content)),
            }
        })?;

        let mut found = Vec::new();
        collect("", document.get_ref(), &mut found);
        found.sort_by_key(|entry| entry.offset);

        let mut places = Places::new(file);
        let standing = Arc::make_mut(&mut places.all);
        let mut in_time = Table::default();
        let mut parts: Vec<(String, usize)> = Vec::new();
        for entry in &found {
            parts.push((entry.name.clone(), entry.offset));
            if is_in_time(&entry.name) {
                let node = Node::read(entry.value, &entry.name, &mut |name, offset| {
                    parts.push((name, offset));
                });
                in_time.insert(&entry.name, node);
            }
        }
        let line = lines(text);
        for (name, offset) in parts {
            // A dotted section has several headers; the first one answers for it.
            standing.lines.entry(name).or_insert_with(|| line(offset));
        }
        let mut entries = Self { values: BTreeMap::new(), in_time, places };
        let mut unknown = None;
        for Found { name, value, .. } in &found {
            match Key::find(name) {
                Some(key) => entries.insert(key, value)?,
                None if is_in_time(name) => {}
                None if !is_section(name) => {
                    unknown.get_or_insert_with(|| (name.clone(), entries.places.of(name)));
                }
                None if value.as_table().is_none() => {
                    let allowed = format!("expected a section [{name}]");
                    return Err(entries.places.error(name, describe(value), allowed));
                }
                None => {}
            }
        }
        for set in sets {
            let name = entries.set(set)?;
            unknown = unknown.or(name.map(|name| (name, Place::Option(set.clone()))));
        }
        // Last, when the kind of model is known and with it what is allowed.
        match unknown {
            Some((name, place)) => Err(entries.unknown(&name, &name, place)),
            None => Ok(entries),
        }
    }

    fn insert(&mut self, key: &'static Key, value: &DeValue) -> Result<(), CaseError> {
        let read = read_value(key, value).ok_or_else(|| {
            self.places.error(key.name, format!("found {}", describe(value)), allowed(key))
        })?;
        self.values.insert(key.name, read);
        Ok(())
    }

    /// Reads one `--set key=value`; hands back the key if it is unknown.
    fn set(&mut self, set: &'a str) -> Result<Option<String>, CaseError> {
        let refused = |key: &str, found: &str, allowed: String| {
            let (place, key) = (Place::Option(set.to_owned()), shown(key));
            Err(CaseError::Key { place, key, found: found.to_owned(), allowed })
        };
        let Some((name, text)) = set.split_once('=') else {
            return refused(set, "no '='", "write --set section.key=value".into());
        };
        let (name, text) = (name.trim(), text.trim());
        if name.is_empty() {
            return refused(set, "no key before '='", "write --set section.key=value".into());
        }
        let Some(key) = Key::find(name) else {
            if is_in_time(name.split(['.', '[']).next().unwrap_or_default()) {
                return self.set_in_time(set, name, text).map(|()| None);
            }
            if is_section(name) {
                let inside = names_inside(name, |_| true).join(", ");
                return refused(name, "a section", format!("name a key inside it: {inside}"));
            }
            return Ok(Some(name.to_owned()));
        };
        let options = &mut Arc::make_mut(&mut self.places.all).options;
        options.insert(key.name.to_owned(), set.to_owned());
        // Quotes around text may be left out, as the shell takes them away.
        let bare = || DeValue::String(text.into());
        let value = match DeValue::parse(text) {
            Ok(value) if value.get_ref().is_str() => value.into_inner(),
            _ if matches!(key.field, Field::Text) => bare(),
            Ok(value) => value.into_inner(),
            Err(_) => bare(),
        };
        self.insert(key, &value)?;
        Ok(None)
    }

    /// Reads one `--set` of a key in [`SECTIONS_IN_TIME`].
    fn set_in_time(&mut self, set: &str, name: &str, text: &'a str) -> Result<(), CaseError> {
        // Quotes around text may be left out, as the shell takes them away.
        let value = DeValue::parse(text).map(|value| value.into_inner());
        let value = value.unwrap_or_else(|_| DeValue::String(text.into()));
        // One place answers for all that the option holds.
        let node = Node::read(&value, name, &mut |_, _| {});
        let key = self.in_time.set(name, node).map_err(|Refused { key, found, allowed }| {
            let (place, key) = (Place::Option(set.to_owned()), shown(&key));
            CaseError::Key { place, key, found, allowed }
        })?;
        let standing = Arc::make_mut(&mut self.places.all);
        standing.forget(&key);
        standing.options.insert(key, set.to_owned());
        Ok(())
    }

    /// The sections that say how a case is run in time.
    pub(super) fn in_time(&self) -> Section<'_> {
        Section::root(&self.in_time, &self.places)
    }

    /// A value that follows from others, where none was given.
    pub(super) fn provide(&mut self, key: &'static str, value: Value) {
        self.values.entry(key).or_insert(value);
    }

    /// The values of a region: those of the case, and over them what its tables `model` and `yield`
    /// say. A table that names another kind than the case counts alone.
    pub(super) fn of_region(&self, region: &mut Section) -> Result<Entries<'static>, CaseError> {
        let (in_time, places) = (Table::default(), self.places.clone());
        let mut own = Entries { values: BTreeMap::new(), in_time, places };
        let mut given = Vec::new();
        for (section, kind_key) in [("model", "model.kind"), ("yield", "yield.kind")] {
            let table = region.table(section)?;
            let kind = table.as_ref().and_then(|table| table.node("kind"));
            let is_alone = kind.is_some_and(|node| {
                super::section::text(node).as_deref() != self.get(kind_key).and_then(Value::text)
            });
            for key in KEYS.iter().filter(|key| is_inside(key.name, section)) {
                if is_alone {
                    own.places.aliases.insert(key.name, region.key(key.name));
                } else if let Some(value) = self.get(key.name) {
                    own.values.insert(key.name, value.clone());
                }
            }
            if let Some(table) = table {
                own.places.aliases.insert(section, region.key(section));
                given.push((section, table));
            }
        }
        let mut unknown = None;
        for (section, table) in &given {
            for (name, node) in table.entries() {
                let name = format!("{section}.{}", segment(name));
                let Some(key) = Key::find(&name) else {
                    unknown.get_or_insert(name);
                    continue;
                };
                own.places.aliases.insert(key.name, region.key(key.name));
                let Some(value) = node.value().and_then(|value| read_value(key, value)) else {
                    let found = format!("found {}", node.words());
                    return Err(own.places.error(key.name, found, allowed(key)));
                };
                own.values.insert(key.name, value);
            }
        }
        match unknown {
            Some(name) => {
                let key = region.key(&name);
                Err(own.unknown(&name, &key, self.places.of(&key)))
            }
            None => Ok(own),
        }
    }

    /// Whether a region has the value from the case.
    pub(super) fn is_inherited(&self, key: &str) -> bool {
        !self.places.aliases.contains_key(key)
    }

    /// Drops what a region has from the case and its own medium does not use.
    pub(super) fn keep_inherited(&mut self, is_used: impl Fn(&str) -> bool) {
        let aliases = &self.places.aliases;
        self.values.retain(|key, _| aliases.contains_key(key) || is_used(key));
    }

    /// What to say of a key that the table does not have: what it may mean, and what is allowed.
    /// `shown_as` is how the key is named in the message.
    fn unknown(&self, name: &str, shown_as: &str, place: Place) -> CaseError {
        let text = |key: &str| self.get(key).and_then(Value::text);
        let kind = text("model.kind").and_then(Kind::from_name);
        let yields = text("yield.kind").and_then(Yield::from_name);
        let is_usable = |key: &Key| kind.is_none_or(|kind| key.is_used_by(Medium { kind, yields }));
        let (mut section, last) = name.rsplit_once('.').unwrap_or(("", name));
        while !section.is_empty() && !is_section(section) {
            section = section.rsplit_once('.').map_or("", |(outer, _)| outer);
        }
        let mut siblings = names_inside(section, is_usable);
        if section.is_empty() && !matches!(kind, Some(Kind::Flow(_))) {
            siblings.extend(SECTIONS_IN_TIME.map(|(name, is_list)| match is_list {
                true => format!("[[{name}]]"),
                false => format!("[{name}]"),
            }));
        }
        let bare = siblings.iter().map(|sibling| sibling.trim_matches(['[', ']']));
        // The right name in the wrong section, else the nearest name in this one.
        let misplaced = KEYS.iter().find(|key| is_usable(key) && key.split().1 == last);
        let meant = misplaced.map(|key| key.name).or_else(|| nearest(last, bare));
        let allowed = format!("{}allowed here: {}", suggestion(meant), siblings.join(", "));
        CaseError::Key { place, key: shown(shown_as), found: "unknown key".into(), allowed }
    }

    /// The value of a key, if it was given.
    pub(super) fn get(&self, key: &str) -> Option<&Value> {
        self.values.get(key)
    }

    /// Whether a section stands in the file or was set.
    pub(super) fn has_section(&self, section: &str) -> bool {
        self.places.all.lines.contains_key(section)
            || self.values.keys().any(|key| is_inside(key, section))
    }

    /// The value of a key that must be there.
    pub(super) fn require(&self, key: &'static str) -> Result<&Value, CaseError> {
        self.get(key).ok_or_else(|| {
            let row = Key::find(key);
            let section = key.rsplit_once('.').map_or("", |(section, _)| section);
            let allowed = row.map_or(String::new(), |row| {
                let name = row.split().1;
                match self.has_section(section) {
                    true => {
                        format!("add {name} to {}: {}", self.places.title(section), allowed(row))
                    }
                    false => format!("add a section [{section}] with {name}: {}", allowed(row)),
                }
            });
            self.places.error(key, "missing", allowed)
        })
    }

    /// The text of a key that must be there.
    pub(super) fn text(&self, key: &'static str) -> Result<&str, CaseError> {
        match self.require(key)? {
            Value::Text(text) => Ok(text),
            _ => Ok(""), // the table says that it is text
        }
    }

    /// The number of a key that must be there.
    pub(super) fn number(&self, key: &'static str) -> Result<f64, CaseError> {
        match self.require(key)? {
            Value::Number(number) => Ok(*number),
            Value::Count(count) => Ok(*count as f64),
            _ => Ok(0.0), // the table says that it is a number
        }
    }
}

/// What the table says is allowed for a key.
pub(super) fn allowed(key: &Key) -> String {
    let unit = if key.unit.is_empty() { String::new() } else { format!(" in {}", key.unit) };
    format!("expected {}{unit} ({})", key.field.expected(), key.meaning)
}

/// The name nearest to a misspelt one, where one is near.
pub(super) fn nearest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    const NEAR: f64 = 0.3; // a third of the letters right
    let name: String = name.chars().take(80).collect();
    candidates
        .into_iter()
        .map(|candidate| (strsim::normalized_damerau_levenshtein(&name, candidate), candidate))
        .filter(|(likeness, _)| *likeness >= NEAR)
        // The first of those that are equally near.
        .reduce(|best, other| if other.0 > best.0 { other } else { best })
        .map(|(_, candidate)| candidate)
}

/// A question in front of what is allowed, or nothing.
pub(super) fn suggestion(name: Option<&str>) -> String {
    name.map_or(String::new(), |name| format!("did you mean '{name}'? "))
}

/// The line of an offset, both counted in the text; lines from 1.
fn lines(text: &str) -> impl Fn(usize) -> usize {
    let ends: Vec<usize> = text.match_indices('\n').map(|(offset, _)| offset).collect();
    move |offset| 1 + ends.partition_point(|&end| end < offset)
}

struct Found<'d, 'a> {
    name: String,
    value: &'d DeValue<'a>,
    offset: usize,
}

/// Lists a table and the sections inside it by dotted names.
fn collect<'d, 'a>(prefix: &str, table: &'d DeTable<'a>, found: &mut Vec<Found<'d, 'a>>) {
    for (key, value) in table {
        // "model.kind" in quotes is one odd name, not a key of a section.
        let segment = segment(key.get_ref());
        let name = if prefix.is_empty() { segment } else { format!("{prefix}.{segment}") };
        let value = value.get_ref();
        if let (Some(inner), true) = (value.as_table(), is_section(&name)) {
            collect(&name, inner, found);
        }
        found.push(Found { name, value, offset: key.span().start });
    }
}

fn is_inside(key: &str, section: &str) -> bool {
    key.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'))
}

fn is_section(name: &str) -> bool {
    KEYS.iter().any(|key| is_inside(key.name, name))
}

/// The usable names directly inside a section, and the sections among them in brackets.
fn names_inside(section: &str, is_usable: impl Fn(&Key) -> bool) -> Vec<String> {
    let mut names = Vec::new();
    for key in KEYS.iter().filter(|key| is_usable(key)) {
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

/// A value of the type that the table gives to the key.
fn read_value(key: &Key, value: &DeValue) -> Option<Value> {
    match key.field {
        Field::Text => text(value).map(Value::Text),
        Field::Texts => texts(value).map(Value::Texts),
        Field::Count | Field::Whole(_) => count(value).map(Value::Count),
        Field::Plain | Field::Number(_) | Field::OptionalNumber(_) => {
            number(value).map(Value::Number)
        }
        Field::Pair(_) | Field::OptionalPair(_) => pair(value, number).map(Value::Pair),
        Field::OptionalMatrix(_) => pair(value, |row| pair(row, number)).map(Value::Matrix),
    }
}

/// Text in one line.
pub(super) fn text(value: &DeValue) -> Option<String> {
    value.as_str().filter(|text| !text.chars().any(char::is_control)).map(str::to_owned)
}

/// Integers count as numbers as far as doubles hold them exactly.
pub(super) fn number(value: &DeValue) -> Option<f64> {
    const EXACT: i64 = 1 << f64::MANTISSA_DIGITS;
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(_) => {
            integer(value).filter(|i| (-EXACT..=EXACT).contains(i)).map(|i| i as f64)
        }
        _ => None,
    }
    .filter(|number: &f64| number.is_finite())
}

fn integer(value: &DeValue) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// Whether what begins like an integer is one, however large: `0x` alone has no digits.
fn has_digits(integer: &DeInteger) -> bool {
    let digits = integer.as_str().trim_start_matches(['+', '-']);
    !digits.is_empty() && digits.chars().all(|digit| digit.is_digit(integer.radix()))
}

pub(super) fn count(value: &DeValue) -> Option<usize> {
    integer(value).filter(|&count| count >= 1).and_then(|count| count.try_into().ok())
}

pub(super) fn texts(value: &DeValue) -> Option<Vec<String>> {
    value.as_array()?.iter().map(|text| text.get_ref().as_str().map(str::to_owned)).collect()
}

fn pair<T>(value: &DeValue, read: impl Fn(&DeValue) -> Option<T>) -> Option<[T; 2]> {
    let array: &DeArray = value.as_array()?;
    let items: Option<Vec<T>> = array.iter().map(|item| read(item.get_ref())).collect();
    items?.try_into().ok()
}

/// A value as it is named in a message.
pub(super) fn describe(value: &DeValue) -> String {
    match value {
        DeValue::String(text) => format!("the text '{}'", shown(text)),
        DeValue::Integer(integer) => {
            let digits = shown(&integer.to_string());
            match number(value) {
                Some(_) => format!("the integer {digits}"),
                None if !has_digits(integer) => format!("'{digits}', which is not a number"),
                None => format!("the integer {digits}, too large to be exact; write it as 1e20"),
            }
        }
        DeValue::Float(float) => {
            let digits = shown(float.as_str());
            match number(value) {
                Some(_) => format!("the number {digits}"),
                None => format!("{digits}, which is not finite"),
            }
        }
        DeValue::Boolean(boolean) => format!("the truth value {boolean}"),
        DeValue::Datetime(datetime) => format!("the date {datetime}"),
        DeValue::Array(array) => {
            // The item that does not go with the others.
            let items = || array.iter().map(|item| item.get_ref());
            let is_of_texts = items().next().is_some_and(DeValue::is_str);
            let odd = items().find(|item| match is_of_texts {
                true => !item.is_str(),
                false => !item.is_array() && number(item).is_none(),
            });
            match odd {
                Some(item) => format!("a list that holds {}", describe(item)),
                None => format!("a list of {}", array.len()),
            }
        }
        DeValue::Table(_) => "a section".to_owned(),
    }
}

/// The kind of model of that name, for the key that names it.
pub(super) fn kind(name: &str, key: &str, places: &Places) -> Result<Kind, CaseError> {
    Kind::from_name(name).ok_or_else(|| {
        let names = Kind::ALL.map(Kind::name);
        let meant = suggestion(nearest(name, names));
        let found = format!("found '{}'", shown(name));
        places.error(key, found, format!("{meant}allowed: {}", names.join(", ")))
    })
}
