//! Parsing of values by type, and descriptions of types for messages.

use crate::schema::{Item, Length, Order, Range, Scope, Type};
use crate::value::{self, Value, list};
use std::fmt::Write;
use toml::de::DeValue;

/// Describes a number in a range, for messages.
fn number_in_words(range: Range) -> String {
    match range {
        Range::Finite => "a finite number".into(),
        Range::Positive => "a positive number".into(),
        Range::NotNegative => "a number of at least 0".into(),
        Range::UpTo(most) => format!("a number above 0 and at most {most}"),
        Range::Below(limit) => format!("a number between 0 and {limit}"),
        Range::NotNegativeBelow(limit) => format!("a number of at least 0 and below {limit}"),
    }
}

impl Length {
    /// Returns the number of items in a scope.
    pub(crate) fn count(self, scope: &Scope) -> usize {
        match self {
            Self::Two => 2,
            Self::Axes => scope.dimensions(),
            Self::SideAxes => scope.axes.len(),
            Self::Spins => {
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
pub(crate) const MAX_NAME: usize = 255;

/// Returns whether a text has more characters than a name may have.
pub(crate) fn is_too_long(name: &str) -> bool {
    name.chars().nth(MAX_NAME).is_some()
}

impl Type {
    /// Describes the type, for messages.
    pub(crate) fn words(&self, scope: &Scope) -> String {
        match *self {
            Self::Text => "text in quotes".into(),
            Self::Name => format!("text in quotes, at most {MAX_NAME} characters"),
            Self::Texts => "a list of texts in brackets".into(),
            Self::Hexadecimal => "eight hexadecimal digits in quotes".into(),
            Self::Truth => "true or false".into(),
            Self::Number(range) => number_in_words(range),
            Self::Whole(least) => format!("a whole number of at least {least}"),
            Self::Axis => format!("a whole number from 1 to {}", scope.dimensions()),
            Self::AxisOfSpace => "1, 2 or 3".into(),
            Self::Pair => "a pair of finite numbers [x1, x2]".into(),
            Self::Matrix => "a matrix of finite numbers [[a11, a12], [a21, a22]]".into(),
            Self::Numbers(length) => match length.count(scope) {
                1 => "a finite number".into(),
                count => format!("a list of {count} finite numbers"),
            },
            Self::PerAxis(length) => {
                format!("a positive number or a list of {} positive numbers", length.count(scope))
            }
            Self::Direction => format!("a list of {} numbers, not all 0", scope.dimensions()),
            Self::List(_, Range::Positive) => "a list of positive numbers".into(),
            Self::List(..) => "a list of finite numbers".into(),
            Self::Counts { length: [few, many], least, order } => match order {
                Order::Any => {
                    format!("a list of {few} or {many} whole numbers of at least {least}")
                }
                Order::Even => format!("a list of {many} even whole numbers of at least {least}"),
                Order::Ascending => {
                    format!("two to {many} ascending whole numbers of at least {least}")
                }
            },
            Self::Mode => "a list of 2 whole numbers, not both 0".into(),
            Self::Tensor => {
                let d = scope.dimensions();
                format!("a matrix of {d} by {d} finite numbers")
            }
            Self::Samples([pair, first]) => {
                format!("a list of at least two pairs {pair}, {first} increasing")
            }
            Self::Points => {
                format!("a list of {} finite numbers", scope.dimensions())
            }
            Self::Divisions => "a whole number of at least 2".into(),
            Self::OneOf(words) => format!("one of {}", words(scope).join(", ")),
            Self::AnyOf(words) => format!("a list with any of {}", words(scope).join(", ")),
            Self::Table(form) => {
                let mut text = String::from("a table { kind = ..., ... }");
                if let Some((item, words)) = form.discriminator() {
                    let _ = write!(text, " ({}: {})", item.name, words.join(", "));
                }
                text
            }
            Self::Part(section) => format!("a table with keys of [{section}]"),
        }
    }

    /// Names the axes of a list of coordinates on a face, for messages; otherwise empty.
    pub(crate) fn axes_in_words(&self, scope: &Scope) -> String {
        match self {
            Self::Numbers(Length::SideAxes) => {
                let names: Vec<String> =
                    scope.axes.iter().map(|axis| format!("x{}", axis + 1)).collect();
                format!(", along {}", names.join(", "))
            }
            _ => String::new(),
        }
    }

    /// Parses a value of this type. Allowed words are not checked; tables give `None`.
    pub(crate) fn parse(&self, value: &DeValue, scope: &Scope) -> Option<Value> {
        let numbers = |length| list(value, length, value::number);
        let whole_numbers = || list(value, value.as_array()?.len(), value::count);
        match *self {
            Self::Text | Self::OneOf(_) => value::text(value).map(Value::Text),
            Self::Texts | Self::AnyOf(_) => value::texts(value).map(Value::Texts),
            Self::Name => {
                let stands = |c: char| c.is_alphanumeric() || "-_.".contains(c);
                let text = value::text(value)?;
                let is_name = !text.is_empty() && text.chars().all(stands);
                (is_name && !is_too_long(&text)).then_some(Value::Text(text))
            }
            Self::Hexadecimal => {
                let digits = value::text(value).filter(|digits| digits.len() == 8)?;
                u32::from_str_radix(&digits, 16).ok().map(|number| Value::Whole(number.into()))
            }
            Self::Truth => value.as_bool().map(Value::Truth),
            Self::Number(range) => {
                value::number(value).filter(|x| range.contains(*x)).map(Value::Number)
            }
            Self::Whole(1) => value::count(value).map(Value::Count),
            Self::Whole(least) => {
                let number = u64::try_from(value::integer(value)?).ok()?;
                (number >= least).then_some(Value::Whole(number))
            }
            Self::Axis | Self::AxisOfSpace => {
                let most = if let Self::Axis = self { scope.dimensions() } else { 3 };
                value::count(value).filter(|axis| *axis <= most).map(Value::Count)
            }
            Self::Pair => value::pair(value, value::number).map(Value::Pair),
            Self::Matrix => {
                value::pair(value, |row| value::pair(row, value::number)).map(Value::Matrix)
            }
            Self::Numbers(length) => numbers(length.count(scope)).map(Value::Numbers),
            Self::PerAxis(length) => {
                let count = length.count(scope);
                let one = || value::number(value).map(|all| vec![all; count]);
                let all = numbers(count).or_else(one)?;
                all.iter().all(|edge| *edge > 0.0).then_some(Value::Numbers(all))
            }
            Self::Direction => {
                let all = numbers(scope.dimensions())?;
                all.iter().any(|x| *x != 0.0).then_some(Value::Numbers(all))
            }
            Self::List(least, range) => {
                let all = numbers(value.as_array()?.len())?;
                let is_in = all.len() >= least && all.iter().all(|x| range.contains(*x));
                is_in.then_some(Value::Numbers(all))
            }
            Self::Counts { length: [few, many], least, order } => {
                let all = whole_numbers()?;
                let is_ordered = match order {
                    Order::Any => true,
                    Order::Even => all.iter().all(|count| count.is_multiple_of(2)),
                    Order::Ascending => all.windows(2).all(|pair| pair[0] < pair[1]),
                };
                let is_in = (few..=many).contains(&all.len())
                    && is_ordered
                    && all.iter().all(|count| *count >= least);
                is_in.then_some(Value::Counts(all))
            }
            Self::Mode => {
                let pair = value::pair(value, value::integer).filter(|mode| *mode != [0, 0]);
                pair.map(Value::WholePair)
            }
            Self::Tensor => {
                let d = scope.dimensions();
                list(value, d, |row| list(row, d, value::number)).map(Value::Rows)
            }
            Self::Samples(_) => {
                let pairs = value.as_array()?.iter();
                let pairs: Option<Vec<[f64; 2]>> =
                    pairs.map(|row| value::pair(row.get_ref(), value::number)).collect();
                pairs.map(Value::Pairs)
            }
            Self::Points => points(value, scope.dimensions()).map(Value::Rows),
            Self::Divisions => {
                let all = match value.as_array() {
                    Some(_) => whole_numbers()?,
                    None => vec![value::count(value)?],
                };
                all.iter().all(|count| *count >= 2).then_some(Value::Counts(all))
            }
            Self::Table(_) | Self::Part(_) => None,
        }
    }
}

impl Item {
    /// Describes the allowed values, for messages.
    pub(crate) fn expected(&self, scope: &Scope) -> String {
        let mut text = self.value.words(scope);
        match self.unit {
            "" => {}
            "deg" => text += " in degrees",
            unit => text = format!("{text} in {unit}"),
        }
        let along = self.value.axes_in_words(scope);
        if !self.note.is_empty() {
            text = format!("{text} ({}{along})", self.note);
        }
        text + self.remark
    }
}

/// Parses a point of `dimensions` coordinates, or a list of at most `dimensions` points.
fn points(value: &DeValue, dimensions: usize) -> Option<Vec<Vec<f64>>> {
    if let Some(point) = list(value, dimensions, value::number) {
        return Some(vec![point]);
    }
    let points =
        list(value, value.as_array()?.len(), |point| list(point, dimensions, value::number))?;
    (!points.is_empty() && points.len() <= dimensions).then_some(points)
}
