//! Typed values from TOML, their descriptions in messages, and suggestions for misspelt names.

use super::error::escape;
use super::section::join_with_commas;
use std::fmt::{Display, Formatter};
use toml::de::{DeArray, DeInteger, DeValue};

/// A value of one of the types of the schema.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum CaseValue {
    Text(String),
    TextList(Vec<String>),
    Boolean(bool),
    Count(usize),
    WholeNumber(u64),
    CountList(Vec<usize>),
    WholePair([i64; 2]),
    Number(f64),
    Numbers(Vec<f64>),
    Pair([f64; 2]),
    Pairs(Vec<[f64; 2]>),
    Matrix([[f64; 2]; 2]),
    NumberRows(Vec<Vec<f64>>),
}

impl CaseValue {
    /// Returns the text; `None` for other types.
    pub(super) fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }
}

/// Implements the conversion of a `CaseValue` to Rust types.
macro_rules! from_value {
    ($($variant:ident: $type:ty;)*) => {
        $(impl TryFrom<CaseValue> for $type {
            type Error = CaseValue;

            fn try_from(value: CaseValue) -> Result<Self, CaseValue> {
                match value {
                    CaseValue::$variant(own) => Ok(own),
                    other => Err(other),
                }
            }
        })*
    };
}

from_value! {
    TextList: Vec<String>;
    Text: String;
    Boolean: bool;
    Count: usize;
    WholeNumber: u64;
    CountList: Vec<usize>;
    WholePair: [i64; 2];
    Number: f64;
    Numbers: Vec<f64>;
    Pairs: Vec<[f64; 2]>;
    NumberRows: Vec<Vec<f64>>;
}

/// Formats the value as TOML; numbers in the shortest form that parses to the same double.
impl Display for CaseValue {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text(text) => write!(formatter, "{}", toml::Value::from(text.as_str())),
            Self::TextList(texts) => write!(formatter, "{}", toml::Value::from(texts.clone())),
            Self::Count(count) => write!(formatter, "{count}"),
            Self::Number(number) => write!(formatter, "{number:?}"),
            Self::Boolean(truth) => write!(formatter, "{truth}"),
            Self::WholeNumber(whole) => write!(formatter, "{whole}"),
            Self::CountList(counts) => write!(formatter, "{counts:?}"),
            Self::WholePair(pair) => write!(formatter, "{pair:?}"),
            Self::Numbers(numbers) => write!(formatter, "{numbers:?}"),
            Self::Pairs(pairs) => write!(formatter, "{pairs:?}"),
            Self::NumberRows(rows) => write!(formatter, "{rows:?}"),
            Self::Pair(pair) => write!(formatter, "{pair:?}"),
            Self::Matrix(matrix) => write!(formatter, "{matrix:?}"),
        }
    }
}

/// Parses a text without control characters.
pub(super) fn parse_text(value: &DeValue) -> Option<String> {
    value.as_str().filter(|text| !text.chars().any(char::is_control)).map(str::to_owned)
}

/// Parses a finite number; integers are accepted up to a magnitude of 2⁵³, to which doubles represent them exactly.
pub(super) fn parse_number(value: &DeValue) -> Option<f64> {
    const MAX_EXACT_INTEGER: i64 = 1 << f64::MANTISSA_DIGITS;
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(_) => parse_integer(value)
            .filter(|i| (-MAX_EXACT_INTEGER..=MAX_EXACT_INTEGER).contains(i))
            .map(|i| i as f64),
        _ => None,
    }
    .filter(|number: &f64| number.is_finite())
}

/// Parses an integer.
pub(super) fn parse_integer(value: &DeValue) -> Option<i64> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

/// Returns whether an integer literal has digits (`0x` alone has none).
fn has_digits(integer: &DeInteger) -> bool {
    let digits = integer.as_str().trim_start_matches(['+', '-']);
    !digits.is_empty() && digits.chars().all(|digit| digit.is_digit(integer.radix()))
}

/// Parses a whole number of at least 1.
pub(super) fn parse_count(value: &DeValue) -> Option<usize> {
    parse_integer(value).filter(|&count| count >= 1).and_then(|count| count.try_into().ok())
}

/// Parses a list of texts.
pub(super) fn parse_text_list(value: &DeValue) -> Option<Vec<String>> {
    value.as_array()?.iter().map(|text| text.get_ref().as_str().map(str::to_owned)).collect()
}

/// Parses a list of two items.
pub(super) fn parse_pair<T>(
    value: &DeValue,
    read: impl Fn(&DeValue) -> Option<T>,
) -> Option<[T; 2]> {
    let array: &DeArray = value.as_array()?;
    let items: Option<Vec<T>> = array.iter().map(|item| read(item.get_ref())).collect();
    items?.try_into().ok()
}

/// Parses a list of `length` items; brackets are optional around a single item.
pub(super) fn parse_list<T>(
    value: &DeValue,
    length: usize,
    read: impl Fn(&DeValue) -> Option<T>,
) -> Option<Vec<T>> {
    let Some(array) = value.as_array() else {
        return (length == 1).then(|| read(value).map(|item| vec![item])).flatten();
    };
    let items: Option<Vec<T>> = array.iter().map(|item| read(item.get_ref())).collect();
    items.filter(|items| items.len() == length)
}

/// Describes a value for messages.
pub(super) fn describe_value(value: &DeValue) -> String {
    match value {
        DeValue::String(text) => format!("the text '{}'", escape(text)),
        DeValue::Integer(integer) => {
            let digits = escape(&integer.to_string());
            match parse_number(value) {
                Some(_) => digits,
                None if !has_digits(integer) => format!("'{digits}', which is not a number"),
                None => format!("{digits}, too large to be exact; write it as 1e20"),
            }
        }
        DeValue::Float(float) => {
            let digits = escape(float.as_str());
            match parse_number(value) {
                Some(_) => digits,
                None => format!("{digits}, which is not finite"),
            }
        }
        DeValue::Boolean(boolean) => format!("the truth value {boolean}"),
        DeValue::Datetime(datetime) => format!("the date {datetime}"),
        DeValue::Array(array) => {
            // First item whose type differs from the expected item type.
            let items = || array.iter().map(|item| item.get_ref());
            let is_of_texts = items().next().is_some_and(DeValue::is_str);
            let odd = items().find(|item| match is_of_texts {
                true => !item.is_str(),
                false => !item.is_array() && parse_number(item).is_none(),
            });
            match odd {
                Some(item) => format!("a list that contains {}", describe_value(item)),
                None if array.is_empty() => "an empty list".to_owned(),
                None => format!("a list of {}", array.len()),
            }
        }
        DeValue::Table(_) => "a section".to_owned(),
    }
}

/// Formats a list of 1 to 9 numbers; `None` for empty and longer lists and for other items.
pub(super) fn format_short_list(value: &DeValue) -> Option<String> {
    const MAX_ITEMS: usize = 9;
    let array = value.as_array().filter(|array| (1..=MAX_ITEMS).contains(&array.len()))?;
    let item = |item: &DeValue| match item {
        DeValue::Integer(integer) => parse_number(item).map(|_| escape(&integer.to_string())),
        DeValue::Float(float) => parse_number(item).map(|_| escape(float.as_str())),
        _ => None,
    };
    let items: Option<Vec<String>> = array.iter().map(|own| item(own.get_ref())).collect();
    items.map(|items| format!("[{}]", items.join(", ")))
}

/// Finds the candidate most similar to a misspelt name, if similar enough.
pub fn find_similar_name<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    const MIN_SIMILARITY: f64 = 0.5; // half of the letters agree
    let name: String = name.chars().take(80).collect();
    let name = match name.rsplit_once('.') {
        Some((section, last)) => format!("{section}.{}", to_usual_name(last)),
        None => to_usual_name(&name).to_owned(),
    };
    candidates
        .into_iter()
        .map(|candidate| (name_similarity(&name, candidate), candidate))
        .filter(|(likeness, _)| *likeness >= MIN_SIMILARITY)
        // Of equally similar candidates the first one.
        .reduce(|best, other| if other.0 > best.0 { other } else { best })
        .map(|(_, candidate)| candidate)
}

/// Returns the name under which a quantity with another usual name is found here.
fn to_usual_name(name: &str) -> &str {
    match name {
        "cfl" | "CFL" => "courant",
        "position" => "at",
        other => other,
    }
}

/// Computes the similarity, 0 to 1, of a misspelt name and a candidate: the normalised Damerau–Levenshtein similarity to
/// the candidate, or, slightly less, to the start of a longer one, so that `fricton` is similar to `friction_angle_deg`, and
/// to its last words, so that `friction` is similar to `shear_friction`.
/// Names in the same section are compared without it, a name without a section also with the last part of the candidate,
/// and the section of a name also with a candidate without section.
fn name_similarity(name: &str, candidate: &str) -> f64 {
    const OTHER_SECTION_WEIGHT: f64 = 0.9;
    match (name.rsplit_once('.'), candidate.rsplit_once('.')) {
        (Some((section, name)), Some((same, candidate))) if section == same => {
            last_part_similarity(name, candidate)
        }
        // A key without its section.
        (None, Some((_, last))) => last_part_similarity(name, candidate)
            .max(OTHER_SECTION_WEIGHT * last_part_similarity(name, last)),
        // A key in a misspelt section.
        (Some((section, _)), None) => {
            last_part_similarity(name, candidate).max(last_part_similarity(section, candidate))
        }
        _ => last_part_similarity(name, candidate),
    }
}

fn last_part_similarity(name: &str, candidate: &str) -> f64 {
    const MIN_START_LENGTH: usize = 4;
    const START_WEIGHT: f64 = 0.9;
    let similarity = strsim::normalized_damerau_levenshtein;
    let length = name.chars().count();
    let start = |length: usize| candidate.chars().take(length).collect::<String>();
    let whole = similarity(name, candidate);
    // The last words of a longer name.
    if length >= MIN_START_LENGTH && candidate.ends_with(&format!("_{name}")) {
        return START_WEIGHT.max(whole);
    }
    if candidate.chars().nth(length).is_none() {
        return whole;
    }
    if length < MIN_START_LENGTH {
        // Short names differ from most starts by few letters.
        return if length > 1 && candidate.starts_with(name) { START_WEIGHT } else { whole };
    }
    let starts = (length - 1..=length + 1).map(|length| similarity(name, &start(length)));
    starts.fold(whole, |most, own| most.max(START_WEIGHT * own))
}

/// Formats the suggestion "did you mean …?" for messages; empty without a suggestion.
pub(super) fn format_suggestion(name: Option<&str>) -> String {
    name.map_or(String::new(), |name| format!("did you mean '{name}'? "))
}

/// Formats the suggestion `meant` and the allowed names for messages; of a long list only the suggestion.
/// `label` is "allowed", "allowed here" or the like.
pub(super) fn format_allowed(
    label: &str,
    meant: Option<&str>,
    names: &[impl AsRef<str>],
) -> String {
    const MAX_LISTED_BESIDE_SUGGESTION: usize = 12;
    match meant {
        Some(meant) if names.len() > MAX_LISTED_BESIDE_SUGGESTION => {
            format!("did you mean '{meant}'?")
        }
        _ => format!("{}{label}: {}", format_suggestion(meant), join_with_commas(names)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_names_find_the_name_here() {
        let names = ["duration", "courant", "courant_of", "rotation_deg"];
        assert_eq!(find_similar_name("cfl", names), Some("courant"));
        assert_eq!(
            find_similar_name("time.cfl", ["time.duration", "time.courant"]),
            Some("time.courant")
        );
    }

    #[test]
    fn last_words_of_a_name_find_it() {
        let names = ["yield.shear_strength", "yield.shear_friction", "yield.shear_dilatancy"];
        assert_eq!(find_similar_name("yield.friction", names), Some("yield.shear_friction"));
    }

    #[test]
    fn long_lists_are_left_out_beside_a_suggestion() {
        let names: Vec<String> = (1..=20).map(|n| format!("name{n}")).collect();
        let (few, near) = (&names[..2], Some("name1"));
        assert_eq!(
            format_allowed("allowed", near, few),
            "did you mean 'name1'? allowed: name1, name2"
        );
        let found = format_allowed("allowed here", near, &names);
        assert_eq!(found, "did you mean 'name1'?");
        assert!(format_allowed("allowed", None, &names).ends_with("name19, name20"));
    }

    #[test]
    fn misspelt_names_find_the_name_meant_and_no_other() {
        const NAMES: [&str; 6] = [
            "model.cohesion",
            "model.friction_angle_deg",
            "model.dilatancy_angle_deg",
            "model.moment_of_inertia",
            "background.pressure",
            "background.density",
        ];
        for (name, expected) in [
            ("model.fricton", Some("model.friction_angle_deg")),
            ("model.friction", Some("model.friction_angle_deg")),
            ("model.dilatency", Some("model.dilatancy_angle_deg")),
            ("model.cfl", None),
            ("model.cohesoin", Some("model.cohesion")),
            ("background.presure", Some("background.pressure")),
            ("background.densty", Some("background.density")),
            ("model.xyz", None),
            ("pressure", Some("background.pressure")),
        ] {
            assert_eq!(find_similar_name(name, NAMES), expected, "{name}");
        }
        assert_eq!(find_similar_name("psi", ["v", "psi_deg"]), Some("psi_deg"));
        assert_eq!(find_similar_name("foo", ["force", "couple"]), None);
        assert_eq!(find_similar_name("mohr-coulomb", ["cosserat-compliances", "classical"]), None);
        assert_eq!(find_similar_name("tme.duration", ["region", "time"]), Some("time"));
    }
}
