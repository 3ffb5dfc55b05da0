//! The commented cases of `wellposed new`, from the schema.

use super::keys::{Key, Presence, keys};
use super::kind::{Kind, Medium};
use super::{check, flow};
use crate::dynamics::{Component, stress};
use crate::schema::{Condition, Form, Item, Need, Scope, forms_in_time};
use crate::types::Type;
use std::fmt::Write;

/// What a case is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// One state: `point`, `map`, `dispersion`, `speeds`.
    State,
    /// A dynamic problem: `run`.
    Run,
}

/// Column at which comments begin in sections of states, and in those of runs.
const COLUMNS: [usize; 2] = [48, 29];

/// Longest line of a comment.
const WIDTH: usize = 110;

/// A section of the small problem that a template is: its keys and their values.
type Start = (&'static str, &'static [(&'static str, &'static str)]);

/// A dynamic problem in plane strain, to be changed.
const SOLID: &[Start] = &[
    ("grid", &[("cells", "[200, 100]"), ("spacing", "1.0"), ("origin", "[-100.0, -100.0]")]),
    ("time", &[("duration", "0.05")]),
    ("scheme", &[]),
    ("side", &[("side", "\"x1-\""), ("kind", "\"non-reflecting\"")]),
    ("side", &[("side", "\"x1+\""), ("kind", "\"non-reflecting\"")]),
    ("side", &[("side", "\"x2-\""), ("kind", "\"non-reflecting\"")]),
    (
        "load",
        &[
            ("side", "\"x2+\""),
            ("field", "\"sigma22\""),
            ("amplitude", "-1e3"),
            ("from", "-5.0"),
            ("to", "5.0"),
            ("time", "{ kind = \"pulse\", start = 0.0, duration = 0.02 }"),
        ],
    ),
    (
        "source",
        &[
            ("kind", "\"force\""),
            ("amplitude", "[1e4, 0.0]"),
            ("at", "[0.0, -40.0]"),
            ("radius", "4.0"),
            ("time", "{ kind = \"ricker\", frequency = 50.0, delay = 0.03 }"),
        ],
    ),
    ("receiver", &[("name", "\"surface\""), ("at", "[40.0, 0.0]")]),
    ("output", &[("picture", "\"speed\"")]),
];

/// A flow in time, to be changed.
const FLOW: &[Start] = &[
    ("grid", &[("cells", "[64, 64]"), ("length", "0.1")]),
    ("time", &[("duration", "1e-3")]),
    (
        "initial",
        &[
            ("kind", "\"noise\""),
            ("field", "\"v\""),
            ("from", "1"),
            ("to", "16"),
            ("amplitude", "1e-6"),
            ("seed", "1"),
        ],
    ),
    ("receiver", &[("name", "\"middle\""), ("at", "[0.05, 0.05]")]),
    ("output", &[("picture", "\"speed\"")]),
    ("limits", &[]),
];

/// Kinds to compare, whose keys all flows have.
const COMPARE: &str = "\
# compare.kinds = [\"double-shearing\", \"plastic-potential\"]  # for point: models side by side on this state
";

/// Keys of a state that follow from others, and are only checked.
const CHECKED: [&str; 5] = [
    "background.deviatoric_stress",
    "background.velocity_gradient",
    "background.acceleration",
    "background.body_moment",
    "background.stress_angle_rate_deg",
];

/// The text of a case of one state: every key that the medium uses, with unit and meaning.
pub fn text(medium: impl Into<Medium>) -> String {
    text_for(medium.into(), Purpose::State)
}

/// The text of a case for that purpose.
pub fn text_for(medium: Medium, purpose: Purpose) -> String {
    let mut text = head(medium, purpose);
    write_keys(&mut text, medium, purpose);
    let kind = medium.kind;
    let sets = kind.yield_sets();
    if medium.yields.is_none() && !sets.is_empty() {
        let names: Vec<&str> = sets.iter().map(|set| set.name).collect();
        let _ = write!(
            text,
            "\n# A solid that yields: wellposed new {}{} --yield SET, SET one of\n# {}.\n",
            kind.name(),
            if purpose == Purpose::Run { " --run" } else { "" },
            names.join(", ")
        );
    }
    if purpose == Purpose::Run {
        let mut blocks = Blocks::new(kind);
        let start = if let Kind::Solid(_) = kind { SOLID } else { FLOW };
        for form in forms_in_time(kind) {
            blocks.add(form, start);
        }
        return text + "\n" + &blocks.text;
    }
    if let Kind::Solid(_) = kind {
        let mut blocks = Blocks { column: COLUMNS[0], ..Blocks::new(kind) };
        blocks.add(&check::FORM, &[("check", &[])]);
        text = text + "\n" + &blocks.text;
    }
    text + &map(medium)
}

/// What stands before the first constant.
fn head(medium: Medium, purpose: Purpose) -> String {
    let kind = medium.kind;
    let is_flow = matches!(kind, Kind::Flow(_));
    format!(
        "\
# {what}. SI units; angles in degrees, anticlockwise from x₁.
# A key behind a '#' shows its default, or an example where there is none: take away the '#' to
# set it.
#
{verbs}

title = \"{title}: a first case\"
# name = \"{name}\"  # names the folder of results; absent: the name of this file
{compare}
[model]
kind = \"{name}\"
",
        what = match purpose {
            Purpose::State => "One state of one material",
            Purpose::Run if is_flow => "A flow in time",
            Purpose::Run => "A dynamic problem in plane strain",
        },
        verbs = match kind {
            _ if purpose == Purpose::Run =>
                "# wellposed run FILE    fields, records of receivers, ledger of energy",
            Kind::Flow(_) => {
                "# wellposed point FILE    everything about this state
# wellposed map FILE      verdict over the two parameters of [map]"
            }
            Kind::Solid(_) => {
                "# wellposed dispersion FILE    frequencies and speeds of waves against wave number
# wellposed speeds FILE        characteristic speeds against direction
# wellposed check FILE         frequencies of the analysis held against those of the solver
# wellposed point FILE         everything about this state
# wellposed map FILE           verdict over the two parameters of [map]"
            }
        },
        title = medium.title(),
        name = kind.name(),
        compare = if is_flow && purpose == Purpose::State { COMPARE } else { "" },
    )
}

/// The value of a key that a template shows; `None` where it has no use for the key.
fn value_for(key: &Key, medium: Medium, purpose: Purpose) -> Option<String> {
    let value = key.example()?;
    let (section, name) = key.split();
    let has_active = !medium.condition_names().is_empty();
    // Of the two ways to say what slips one is shown.
    if section == "stress" && has_active {
        return None;
    }
    let is_plane = purpose == Purpose::Run || has_active;
    if key.name == "model.dimensions" && is_plane {
        return Some("2".into());
    }
    if purpose == Purpose::State {
        return Some(value);
    }
    if let Kind::Flow(_) = medium.kind {
        let is_shown = ["model", "background"].contains(&section)
            && !flow::UNIFORM.contains(&key.name)
            && !CHECKED.contains(&key.name);
        return is_shown.then_some(value);
    }
    // A run needs no state, and its flow is ideal and associated.
    if !matches!(section, "model" | "yield") || matches!(name, "hardening" | "plastic_rate") {
        return None;
    }
    let friction = key.name.replace("dilatancy", "friction");
    let of_friction = || Key::find(&friction).and_then(Key::example);
    Some(if name.ends_with("dilatancy") { of_friction().unwrap_or(value) } else { value })
}

/// The sections whose keys are rows of the table.
fn write_keys(text: &mut String, medium: Medium, purpose: Purpose) {
    let mut section = "model";
    for key in keys().iter().filter(|key| key.is_used_by(medium)) {
        let Some(value) = value_for(key, medium, purpose) else { continue };
        let (own, name) = key.split();
        if own != section {
            let _ = write!(text, "\n[{own}]\n");
            section = own;
            if let ("yield", Some(set)) = (own, medium.yields) {
                let _ = writeln!(text, "kind = \"{}\"", set.name);
                let conditions = medium.condition_names();
                if let (Some(first), Purpose::State) = (conditions.first(), purpose) {
                    let _ = writeln!(
                        text,
                        "# Any of {}; or else a section [stress] with pressure, deviatoric_stress,\n\
                         # stress_angle_deg and so on, which is scaled until it yields.\n\
                         active = [\"{first}\"]",
                        conditions.join(", "),
                    );
                }
            }
        }
        let mark = if matches!(key.presence, Presence::Required(_)) { "" } else { "# " };
        let comment = comment(key.unit, key.meaning);
        let _ = writeln!(text, "{:<46}  # {comment}", format!("{mark}{name} = {value}"));
    }
}

/// The section `[map]`.
fn map(medium: Medium) -> String {
    let [x, y] = example_map(medium);
    format!("\n[map]\nx = {x}\ny = {y}\n")
}

/// The axes of a map to start from.
fn example_map(medium: Medium) -> [String; 2] {
    let axis = |parameter: &str, from: f64, to: f64, points: usize| {
        format!(
            "{{ parameter = \"{parameter}\", from = {from:?}, to = {to:?}, points = {points} }}"
        )
    };
    let keys = || keys().iter().filter(move |key| key.is_used_by(medium));
    let named =
        |end: &str| keys().find(|key| key.name.starts_with("yield.") && key.name.ends_with(end));
    match (medium.kind, medium.yields, named("dilatancy"), named("friction")) {
        (Kind::Flow(_), ..) => [
            axis("model.dilatancy_angle_deg", 0.0, 25.0, 26),
            axis("model.friction_angle_deg", 30.0, 60.0, 31),
        ],
        (_, Some(_), Some(dilatancy), Some(friction)) => {
            [axis(dilatancy.name, 0.0, 1.0, 41), axis(friction.name, 0.0, 1.0, 41)]
        }
        (_, Some(_), ..) => [
            axis("stress.out_of_plane_stress", -1.0, 1.0, 41),
            match Key::find("yield.hardening").filter(|key| key.is_used_by(medium)) {
                Some(hardening) => axis(hardening.name, -1e9, 1e9, 41),
                None => axis("stress.pressure", 0.0, 1e6, 41),
            },
        ],
        (Kind::Solid(solid), None, ..) => {
            // The first constant that may take any size.
            let first = solid.parameters.first().map_or("density", |own| own.name);
            let name = format!("model.{first}");
            let example = Key::find(&name).map_or(1.0, |key| match key.presence {
                Presence::Required(value) | Presence::Default(value) => value,
                Presence::Optional => 1.0,
            });
            [axis(&name, 0.5 * example, 1.5 * example, 11), axis("wave.number", 0.1, 10.0, 11)]
        }
    }
}

/// Unit and meaning.
fn comment(unit: &str, meaning: &str) -> String {
    match unit {
        "" => meaning.to_owned(),
        unit if unit.starts_with("the unit") => format!("in {unit}: {meaning}"),
        unit => format!("{unit}: {meaning}"),
    }
}

/// Text in lines of at most so many characters.
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

/// What is written of sections that are trees.
struct Blocks {
    text: String,
    scope: Scope,
    column: usize,
    /// Tables in braces whose variants have been shown.
    shown: Vec<&'static str>,
}

/// An item, or one that is the same elsewhere.
fn is_same(one: &Item, other: &Item) -> bool {
    (one.name, one.meaning, one.unit) == (other.name, other.meaning, other.unit)
}

impl Blocks {
    fn new(kind: Kind) -> Self {
        let scope = Scope { kind: Some(kind), dimensions: Some(2), axes: vec![0] };
        Self { text: String::new(), scope, column: COLUMNS[1], shown: Vec::new() }
    }

    /// Writes a section: as it is in the problem, and behind marks the keys of every other form that it may have.
    fn add(&mut self, form: &'static Form, start: &[Start]) {
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
            self.write(form, &variant, &items, blocks.is_empty(), true, &blocks);
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
                let is_optional = |item: &&&Item| !matches!(item.need, Need::Optional(_));
                let has = |block: &[&Item], item: &Item| block.iter().any(|own| is_same(own, item));
                let is_shown = blocks
                    .iter()
                    .any(|block| items.iter().filter(is_optional).all(|item| has(block, item)));
                let is_possible = present.is_none_or(|key| items.iter().any(|own| own.name == key))
                    && items.iter().all(|item| self.value(form, item, &variant).is_some());
                let is_other = present.is_some_and(|key| {
                    !blocks.iter().any(|block| block.iter().any(|own| own.name == key))
                });
                if is_possible && (!is_shown || is_other) {
                    self.write(form, &variant, &items, blocks.is_empty(), false, &blocks);
                    blocks.push(items);
                }
            }
        }
    }

    /// The section whose keys are stresses.
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

    /// The words of a key in this kind of model.
    fn words(&self, item: &Item) -> Vec<String> {
        match item.value {
            Type::OneOf(words) | Type::AnyOf(words) => words(&self.scope),
            _ => Vec::new(),
        }
    }

    /// The keys of a variant; of one that has another type in space that of plane strain.
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
                // What takes the place of other keys is shown where it does.
                let is_switch = switches(form).any(|key| key == item.name);
                !is_switch || variant.has(item.name)
            })
            .collect()
    }

    /// The value of a key in a variant: given, or else the word of the variant, or else default or example;
    /// `None` where the model has no word for it.
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

    /// Writes one variant, behind marks unless it is a part of the problem. Comments stand in the first one.
    fn write(
        &mut self,
        form: &'static Form,
        variant: &Variant,
        items: &[&'static Item],
        is_first: bool,
        is_active: bool,
        before: &[Vec<&'static Item>],
    ) {
        let header = if is_active { form.header() } else { format!("# {}", form.header()) };
        let _ = writeln!(self.text, "\n{header}");
        for item in items {
            let was_shown = before.iter().any(|block| block.iter().any(|own| is_same(own, item)));
            let is_given = variant.given.iter().any(|(key, _)| *key == item.name);
            let is_optional = !matches!(item.need, Need::Required(_));
            // Of several sections in the problem the first one shows all keys.
            if is_active && !is_first && !is_given {
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
        /// More words than this are no list for a comment.
        const MOST: usize = 12;
        let mut text = comment(item.unit, item.meaning);
        let words = self.words(item);
        let is_said = words.iter().all(|word| item.meaning.contains(word.as_str()));
        if (1..=MOST).contains(&words.len()) && !is_said {
            let _ = write!(text, "; {}", words.join(", "));
        }
        text
    }

    /// A table in braces, and where it has not been shown yet all other tables that can stand in its place.
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

    /// A line, and more where its comment is long.
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

/// Keys that take the place of others, or bring others with them.
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

/// What is assumed of a table.
struct Variant<'a> {
    given: &'a [(&'static str, &'static str)],
    /// That of the discriminator.
    word: Option<&'a str>,
    /// The key that takes the place of others.
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

/// A meaning as a sentence.
fn sentence(meaning: &str) -> String {
    let mut letters = meaning.chars();
    let first = letters.next().map_or(String::new(), |letter| letter.to_uppercase().collect());
    format!("{first}{}.", letters.as_str())
}
