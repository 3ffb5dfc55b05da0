//! Parsing of values by type, and descriptions of types for messages.

use crate::schema::{AllowedRange, CountConstraint, KeySchema, ListLength, SchemaScope, ValueType};
use crate::value::{self, CaseValue, parse_list};
use models::common::decimal::format_rounded;
use std::fmt::Write;
use toml::de::DeValue;

/// Describes a number in a range, for messages.
fn describe_number(range: AllowedRange) -> String {
    match range {
        AllowedRange::Finite => "a finite number".into(),
        AllowedRange::Positive => "a positive number".into(),
        AllowedRange::NotNegative => "a number of at least 0".into(),
        AllowedRange::PositiveUpTo(most) => {
            format!("a number above 0 and at most {}", format_rounded(most))
        }
        AllowedRange::PositiveBelow(limit) => {
            format!("a number between 0 and {}", format_rounded(limit))
        }
        AllowedRange::NotNegativeBelow(limit) => {
            format!("a number of at least 0 and below {}", format_rounded(limit))
        }
    }
}

impl ListLength {
    /// Returns the number of items in a scope.
    pub(crate) fn item_count(self, scope: &SchemaScope) -> usize {
        match self {
            Self::Two => 2,
            Self::GridAxes => scope.dimensions(),
            Self::FaceAxes => scope.face_axes.len(),
            Self::SpinComponents => {
                if scope.dimensions() == 2 {
                    1
                } else {
                    3
                }
            }
        }
    }
}

/// Maximum length of the names of cases and receivers, characters; names occur in file names and archive entries.
pub(crate) const MAX_NAME_LENGTH: usize = 255;

/// Returns whether a text has more characters than a name may have.
pub(crate) fn is_name_too_long(name: &str) -> bool {
    name.chars().nth(MAX_NAME_LENGTH).is_some()
}

impl ValueType {
    /// Describes the type, for messages.
    pub(crate) fn describe(&self, scope: &SchemaScope) -> String {
        match *self {
            Self::Text => "text in quotes".into(),
            Self::Name => format!("a name of 1 to {MAX_NAME_LENGTH} characters"),
            Self::TextList => "a list of texts in brackets".into(),
            Self::Hexadecimal => "eight hexadecimal digits in quotes".into(),
            Self::Boolean => "true or false".into(),
            Self::Number(range) => describe_number(range),
            Self::WholeNumber(least) => format!("a whole number of at least {least}"),
            Self::Axis => format!("a whole number from 1 to {}", scope.dimensions()),
            Self::SpaceAxis => "1, 2 or 3".into(),
            Self::Pair => "a pair of finite numbers [x1, x2]".into(),
            Self::Matrix => "a matrix of finite numbers [[a11, a12], [a21, a22]]".into(),
            Self::Numbers(length) => match length.item_count(scope) {
                1 => "a finite number".into(),
                count => format!("a list of {count} finite numbers"),
            },
            Self::PerAxis(length) => {
                format!(
                    "a positive number or a list of {} positive numbers",
                    length.item_count(scope)
                )
            }
            Self::Direction => format!("a list of {} numbers, not all 0", scope.dimensions()),
            Self::NumberList(_, AllowedRange::Positive) => "a list of positive numbers".into(),
            Self::NumberList(..) => "a list of finite numbers".into(),
            Self::CountList { length: [few, many], minimum: least, order } => match order {
                CountConstraint::Unconstrained if few == many => {
                    format!("a list of {few} whole numbers of at least {least}")
                }
                CountConstraint::Unconstrained => {
                    format!("a list of {few} or {many} whole numbers of at least {least}")
                }
                CountConstraint::Even => {
                    format!("a list of {many} even whole numbers of at least {least}")
                }
                CountConstraint::Ascending => {
                    format!("a list of {few} to {many} ascending whole numbers of at least {least}")
                }
            },
            Self::ModeNumbers => "a list of 2 whole numbers, not both 0".into(),
            Self::Tensor => {
                let d = scope.dimensions();
                format!("a matrix of {d} by {d} finite numbers")
            }
            Self::Samples([pair, first]) => {
                format!("a list of at least two pairs {pair}, {first} increasing")
            }
            Self::PointList => {
                format!("a list of {} finite numbers", scope.dimensions())
            }
            Self::PointCounts => "a whole number of at least 2".into(),
            Self::OneOf(allowed_names) => format!("one of {}", allowed_names(scope).join(", ")),
            Self::AnyOf(allowed_names) => {
                format!("a list with any of {}", allowed_names(scope).join(", "))
            }
            Self::Table(table_schema) => {
                let mut text = String::from("a table { kind = ..., ... }");
                if let Some((item, names)) = table_schema.discriminator() {
                    let _ = write!(text, " ({}: {})", item.name, names.join(", "));
                }
                text
            }
            Self::TableList(_) => "a list of tables [{ ... }, ...]".into(),
            Self::IndexList => "a list of whole numbers of at least 0".into(),
            Self::SectionKeys(section) => format!("a table with keys of [{section}]"),
            Self::Named(_) => "a table with an entry for each name".into(),
        }
    }

    /// Names the axes of a list of coordinates on a face, for messages; otherwise empty.
    pub(crate) fn describe_axes(&self, scope: &SchemaScope) -> String {
        match self {
            Self::Numbers(ListLength::FaceAxes) => {
                let names: Vec<String> =
                    scope.face_axes.iter().map(|axis| format!("x{}", axis + 1)).collect();
                format!(", along {}", names.join(", "))
            }
            _ => String::new(),
        }
    }

    /// Parses a value of this type. Allowed names are not checked; tables give `None`.
    pub(crate) fn parse_value(&self, value: &DeValue, scope: &SchemaScope) -> Option<CaseValue> {
        let numbers = |length| parse_list(value, length, value::parse_number);
        let whole_numbers = || parse_list(value, value.as_array()?.len(), value::parse_count);
        match *self {
            Self::Text | Self::OneOf(_) => value::parse_text(value).map(CaseValue::Text),
            Self::TextList | Self::AnyOf(_) => {
                value::parse_text_list(value).map(CaseValue::TextList)
            }
            Self::Name => parse_name(value).map(CaseValue::Text),
            Self::Hexadecimal => {
                let digits = value::parse_text(value).filter(|digits| digits.len() == 8)?;
                u32::from_str_radix(&digits, 16)
                    .ok()
                    .map(|number| CaseValue::WholeNumber(number.into()))
            }
            Self::Boolean => value.as_bool().map(CaseValue::Boolean),
            Self::Number(range) => {
                value::parse_number(value).filter(|x| range.contains(*x)).map(CaseValue::Number)
            }
            Self::WholeNumber(1) => value::parse_count(value).map(CaseValue::Count),
            Self::WholeNumber(least) => {
                let number = u64::try_from(value::parse_integer(value)?).ok()?;
                (number >= least).then_some(CaseValue::WholeNumber(number))
            }
            Self::Axis | Self::SpaceAxis => {
                let most = if let Self::Axis = self { scope.dimensions() } else { 3 };
                value::parse_count(value).filter(|axis| *axis <= most).map(CaseValue::Count)
            }
            Self::Pair => value::parse_pair(value, value::parse_number).map(CaseValue::Pair),
            Self::Matrix => {
                value::parse_pair(value, |row| value::parse_pair(row, value::parse_number))
                    .map(CaseValue::Matrix)
            }
            Self::Numbers(length) => numbers(length.item_count(scope)).map(CaseValue::Numbers),
            Self::PerAxis(length) => {
                let count = length.item_count(scope);
                let one = || value::parse_number(value).map(|all| vec![all; count]);
                let all = numbers(count).or_else(one)?;
                all.iter().all(|edge| *edge > 0.0).then_some(CaseValue::Numbers(all))
            }
            Self::Direction => {
                let all = numbers(scope.dimensions())?;
                all.iter().any(|x| *x != 0.0).then_some(CaseValue::Numbers(all))
            }
            Self::NumberList(least, range) => {
                let all = numbers(value.as_array()?.len())?;
                let is_in = all.len() >= least && all.iter().all(|x| range.contains(*x));
                is_in.then_some(CaseValue::Numbers(all))
            }
            Self::CountList { length: [shortest, longest], minimum, order } => {
                let counts = whole_numbers()?;
                let is_valid = (shortest..=longest).contains(&counts.len())
                    && counts.iter().all(|count| *count >= minimum)
                    && order.is_satisfied_by(&counts);
                is_valid.then_some(CaseValue::CountList(counts))
            }
            Self::ModeNumbers => {
                let pair =
                    value::parse_pair(value, value::parse_integer).filter(|mode| *mode != [0, 0]);
                pair.map(CaseValue::WholePair)
            }
            Self::Tensor => {
                let d = scope.dimensions();
                parse_list(value, d, |row| parse_list(row, d, value::parse_number))
                    .map(CaseValue::NumberRows)
            }
            Self::Samples(_) => parse_pair_list(value).map(CaseValue::Pairs),
            Self::PointList => parse_points(value, scope.dimensions()).map(CaseValue::NumberRows),
            Self::PointCounts => {
                let all = match value.as_array() {
                    Some(_) => whole_numbers()?,
                    None => vec![value::parse_count(value)?],
                };
                all.iter().all(|count| *count >= 2).then_some(CaseValue::CountList(all))
            }
            Self::IndexList => {
                let index = |item: &DeValue| usize::try_from(value::parse_integer(item)?).ok();
                parse_list(value, value.as_array()?.len(), index).map(CaseValue::CountList)
            }
            Self::Table(_) | Self::TableList(_) | Self::SectionKeys(_) | Self::Named(_) => None,
        }
    }
}

impl KeySchema {
    /// Describes the allowed values, for messages.
    pub(crate) fn describe_expected(&self, scope: &SchemaScope) -> String {
        let mut text = self.value_type.describe(scope);
        match self.unit {
            "" => {}
            "deg" => text += " in degrees",
            unit => text = format!("{text} in {unit}"),
        }
        let along = self.value_type.describe_axes(scope);
        if !self.message_note.is_empty() {
            text = format!("{text} ({}{along})", self.message_note);
        }
        text + self.message_remark
    }
}

impl CountConstraint {
    /// Returns whether a list of whole numbers satisfies the constraint.
    fn is_satisfied_by(self, counts: &[usize]) -> bool {
        match self {
            Self::Unconstrained => true,
            Self::Even => counts.iter().all(|count| count.is_multiple_of(2)),
            Self::Ascending => counts.windows(2).all(|pair| pair[0] < pair[1]),
        }
    }
}

/// Parses a name: letters, digits, `-`, `_` and `.`, at most [`MAX_NAME_LENGTH`] characters.
fn parse_name(value: &DeValue) -> Option<String> {
    let is_allowed = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let text = value::parse_text(value)?;
    let is_name = !text.is_empty() && text.chars().all(is_allowed) && !is_name_too_long(&text);
    is_name.then_some(text)
}

/// Parses a list of pairs of numbers.
fn parse_pair_list(value: &DeValue) -> Option<Vec<[f64; 2]>> {
    let rows = value.as_array()?.iter();
    rows.map(|row| value::parse_pair(row.get_ref(), value::parse_number)).collect()
}

/// Parses a point of `dimensions` coordinates, or a list of at most `dimensions` points.
fn parse_points(value: &DeValue, dimensions: usize) -> Option<Vec<Vec<f64>>> {
    if let Some(point) = parse_list(value, dimensions, value::parse_number) {
        return Some(vec![point]);
    }
    let points = parse_list(value, value.as_array()?.len(), |point| {
        parse_list(point, dimensions, value::parse_number)
    })?;
    (!points.is_empty() && points.len() <= dimensions).then_some(points)
}
