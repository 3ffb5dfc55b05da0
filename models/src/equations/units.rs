//! Units of expressions: dimensional analysis of definitions and equations.

use super::error::{TextError, TextPlace, line_and_column};
use super::syntax::{BinaryOperator, Callee, Derivative, Expression, ExpressionKind, Function2};
use crate::common::scalar::Function;
use std::fmt;

/// Exponents of kg, m, s, K, A and mol in twelfths, so that roots stay exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension([i32; 6]);

/// Base units in the order of [`Dimension`].
const BASE_UNITS: [&str; 6] = ["kg", "m", "s", "K", "A", "mol"];

/// Exponents per unit power.
const DENOMINATOR: i32 = 12;

/// Unit names and their exponents of the base units.
const UNITS: [(&str, [i32; 6]); 18] = [
    ("kg", [1, 0, 0, 0, 0, 0]),
    ("m", [0, 1, 0, 0, 0, 0]),
    ("s", [0, 0, 1, 0, 0, 0]),
    ("K", [0, 0, 0, 1, 0, 0]),
    ("A", [0, 0, 0, 0, 1, 0]),
    ("mol", [0, 0, 0, 0, 0, 1]),
    ("rad", [0; 6]),
    ("Hz", [0, 0, -1, 0, 0, 0]),
    ("N", [1, 1, -2, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0]),
    ("J", [1, 2, -2, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0]),
    ("C", [0, 0, 1, 0, 1, 0]),
    ("V", [1, 2, -3, 0, -1, 0]),
    ("ohm", [1, 2, -3, 0, -2, 0]),
    ("F", [-1, -2, 4, 0, 2, 0]),
    ("T", [1, 0, -2, 0, -1, 0]),
    ("H", [1, 2, -2, 0, -2, 0]),
];

impl Dimension {
    /// The dimension of pure numbers.
    pub const NONE: Self = Self([0; 6]);
    const LENGTH: Self = Self([0, DENOMINATOR, 0, 0, 0, 0]);
    const TIME: Self = Self([0, 0, DENOMINATOR, 0, 0, 0]);

    /// Parses a unit such as `kg/m^3`, `m^2/(Pa s)` or `1/s`; an empty text is a pure number. The error is the part that is
    /// no unit.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut found = Self::NONE;
        // Signs of the exponents: of the innermost open parenthesis last, then of the next factor.
        let mut outer: Vec<i32> = vec![1];
        let (mut sign, mut rest) = (1, text.trim());
        let mut expects_factor = !rest.is_empty();
        while let Some(first) = rest.chars().next() {
            let base = outer[outer.len() - 1];
            match first {
                '(' if outer.len() < 8 => {
                    outer.push(base * sign);
                    (sign, expects_factor) = (1, true);
                    rest = &rest[1..];
                }
                ')' if outer.len() > 1 && !expects_factor => {
                    outer.pop();
                    rest = &rest[1..];
                }
                '*' | '/' if !expects_factor => {
                    (sign, expects_factor) = (if first == '/' { -1 } else { 1 }, true);
                    rest = &rest[1..];
                }
                _ => {
                    let end = rest.find(['*', '/', ' ', '(', ')']).unwrap_or(rest.len());
                    let (factor, after) = rest.split_at(end);
                    let (unit, power) = parse_factor(factor).ok_or(rest)?;
                    // A factor after a space is multiplied.
                    let sign = if expects_factor { sign } else { 1 };
                    for (own, exponent) in found.0.iter_mut().zip(unit) {
                        *own += DENOMINATOR * base * sign * power * exponent;
                    }
                    expects_factor = false;
                    rest = after;
                }
            }
            rest = rest.trim_start();
        }
        if expects_factor || outer.len() > 1 {
            return Err(text.trim().to_owned());
        }
        Ok(found)
    }

    fn combine(self, other: Self, sign: i32) -> Self {
        Self(std::array::from_fn(|i| self.0[i].saturating_add(sign * other.0[i])))
    }

    /// The dimension to the power `exponent`; `None` if an exponent is no multiple of 1/12.
    fn power(self, exponent: f64) -> Option<Self> {
        let mut result = [0; 6];
        for (own, base) in result.iter_mut().zip(self.0) {
            let value = f64::from(base) * exponent;
            if (value - value.round()).abs() > 1e-9 || value.abs() > 1e6 {
                return None;
            }
            *own = value.round() as i32;
        }
        Some(Self(result))
    }
}

/// The unit in base units, e.g. `kg/(m s^2)`.
impl fmt::Display for Dimension {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = |sign: i32| -> Vec<String> {
            let positive = self.0.iter().zip(BASE_UNITS).filter(|(power, _)| **power * sign > 0);
            positive
                .map(|(power, name)| match power * sign {
                    DENOMINATOR => name.to_owned(),
                    power if power % DENOMINATOR == 0 => format!("{name}^{}", power / DENOMINATOR),
                    power => format!("{name}^{}", f64::from(power) / f64::from(DENOMINATOR)),
                })
                .collect()
        };
        let (above, below) = (part(1), part(-1));
        let numerator = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
        match below.len() {
            0 => formatter.write_str(&numerator),
            1 => write!(formatter, "{numerator}/{}", below[0]),
            _ => write!(formatter, "{numerator}/({})", below.join(" ")),
        }
    }
}

/// Exponents of the base units of a factor of a unit, and its power: `m^2`.
fn parse_factor(text: &str) -> Option<([i32; 6], i32)> {
    let (name, power) = match text.split_once('^') {
        Some((name, power)) => (name, power.parse::<i32>().ok().filter(|p| p.abs() <= 12)?),
        None => (text, 1),
    };
    let known = UNITS.iter().find(|(own, _)| *own == name).map(|(_, unit)| *unit);
    Some((known.or((name == "1").then_some([0; 6]))?, power))
}

/// Names of all units, for messages.
pub(super) fn unit_names() -> String {
    UNITS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// Dimensional analysis of one text; `dimension_of` returns the dimension of a name, `None` if it is not checked.
pub(super) struct UnitChecker<'a, F> {
    pub(super) place: &'a TextPlace,
    pub(super) text: &'a str,
    pub(super) dimension_of: F,
}

impl<F: Fn(&str) -> Option<Dimension>> UnitChecker<'_, F> {
    fn text_of(&self, expression: &Expression) -> &str {
        &self.text[expression.span.clone()]
    }

    fn error(&self, at: &Expression, found: String, remedy: &str) -> TextError {
        TextError {
            position: Some(line_and_column(self.text, at.span.start)),
            ..TextError::new(self.place.clone(), found, remedy)
        }
    }

    /// Checks that both expressions have the same dimension and returns it. Zero fits every dimension.
    pub(super) fn check_equal(
        &self,
        [a, b]: [&Expression; 2],
    ) -> Result<Option<Dimension>, TextError> {
        let (of_a, of_b) = (self.dimension(a)?, self.dimension(b)?);
        match (of_a, of_b) {
            (Some(x), Some(y)) if x != y && !is_zero(a) && !is_zero(b) => {
                // The terms that were added last name the mismatch best.
                let (last, first) = (last_term(a), first_term(b));
                let found = format!(
                    "'{}' has the unit {x}, '{}' has {y}",
                    self.text_of(last),
                    self.text_of(first)
                );
                Err(self.error(b, found, "terms that are added or compared need the same unit"))
            }
            (Some(_), Some(y)) if is_zero(a) => Ok(Some(y)),
            (Some(x), Some(_)) => Ok(Some(x)),
            _ => Ok(None),
        }
    }

    fn check_pure(&self, argument: &Expression, of: &str) -> Result<(), TextError> {
        match self.dimension(argument)? {
            Some(found) if found != Dimension::NONE => {
                let text = self.text_of(argument);
                let found = format!("'{text}' has the unit {found}");
                Err(self.error(argument, found, &format!("{of} takes a pure number")))
            }
            _ => Ok(()),
        }
    }

    /// Dimension of an expression; `None` if it is not known, such as that of a power with a variable exponent.
    pub(super) fn dimension(
        &self,
        expression: &Expression,
    ) -> Result<Option<Dimension>, TextError> {
        match &expression.kind {
            ExpressionKind::Number { .. } => Ok(Some(Dimension::NONE)),
            ExpressionKind::Name(name) => Ok((self.dimension_of)(name)),
            ExpressionKind::Negate(inner) => self.dimension(inner),
            ExpressionKind::Binary(operator, operands) => {
                let [a, b] = &**operands;
                match operator {
                    BinaryOperator::Add | BinaryOperator::Subtract => self.check_equal([a, b]),
                    BinaryOperator::Multiply | BinaryOperator::Divide => {
                        let sign = if *operator == BinaryOperator::Multiply { 1 } else { -1 };
                        let (x, y) = (self.dimension(a)?, self.dimension(b)?);
                        Ok(x.zip(y).map(|(x, y)| x.combine(y, sign)))
                    }
                    BinaryOperator::Power => self.power(a, b),
                }
            }
            ExpressionKind::Call(callee, arguments) => self.call(*callee, arguments),
        }
    }

    fn power(
        &self,
        base: &Expression,
        exponent: &Expression,
    ) -> Result<Option<Dimension>, TextError> {
        self.check_pure(exponent, "an exponent")?;
        let Some(of_base) = self.dimension(base)? else { return Ok(None) };
        if of_base == Dimension::NONE {
            return Ok(Some(of_base));
        }
        // A power with a variable exponent has a unit that varies, e.g. K ρ^γ: not checked.
        let Some(exponent_value) = constant_value(exponent) else { return Ok(None) };
        match of_base.power(exponent_value) {
            Some(found) => Ok(Some(found)),
            None => {
                let found =
                    format!("'{}' with the unit {of_base} to this power", self.text_of(base));
                Err(self.error(exponent, found, "make the base a pure number"))
            }
        }
    }

    fn call(
        &self,
        callee: Callee,
        arguments: &[Expression],
    ) -> Result<Option<Dimension>, TextError> {
        let argument = &arguments[0];
        match callee {
            Callee::Derivative(derivative) => {
                let by = match derivative {
                    Derivative::Space(_) => Dimension::LENGTH,
                    Derivative::Time | Derivative::Material => Dimension::TIME,
                };
                Ok(self.dimension(argument)?.map(|own| own.combine(by, -1)))
            }
            Callee::Function(Function::Sqrt) => {
                Ok(self.dimension(argument)?.and_then(|own| own.power(0.5)))
            }
            Callee::Function(Function::Abs) => self.dimension(argument),
            Callee::Function(Function::Sign) => {
                self.dimension(argument)?;
                Ok(Some(Dimension::NONE))
            }
            Callee::Function(_) => {
                self.check_pure(argument, callee.name())?;
                Ok(Some(Dimension::NONE))
            }
            Callee::Function2(function) => {
                let found = self.check_equal([&arguments[0], &arguments[1]])?;
                Ok(if function == Function2::Atan2 { Some(Dimension::NONE) } else { found })
            }
        }
    }
}

/// Whether an expression is the number 0.
fn is_zero(expression: &Expression) -> bool {
    matches!(expression.kind, ExpressionKind::Number { value: 0.0, .. })
}

/// The value of an expression of numbers alone.
fn constant_value(expression: &Expression) -> Option<f64> {
    match &expression.kind {
        ExpressionKind::Number { value, .. } => Some(*value),
        ExpressionKind::Negate(inner) => Some(-constant_value(inner)?),
        ExpressionKind::Binary(operator, operands) => {
            let [a, b] = [constant_value(&operands[0])?, constant_value(&operands[1])?];
            Some(match operator {
                BinaryOperator::Add => a + b,
                BinaryOperator::Subtract => a - b,
                BinaryOperator::Multiply => a * b,
                BinaryOperator::Divide => a / b,
                BinaryOperator::Power => return None,
            })
        }
        ExpressionKind::Name(_) | ExpressionKind::Call(..) => None,
    }
}

/// The last of the terms that an expression adds.
fn last_term(expression: &Expression) -> &Expression {
    match &expression.kind {
        ExpressionKind::Binary(BinaryOperator::Add | BinaryOperator::Subtract, operands) => {
            last_term(&operands[1])
        }
        _ => expression,
    }
}

/// The first of the terms that an expression adds.
fn first_term(expression: &Expression) -> &Expression {
    match &expression.kind {
        ExpressionKind::Binary(BinaryOperator::Add | BinaryOperator::Subtract, operands) => {
            first_term(&operands[0])
        }
        _ => expression,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_parsed_and_printed_in_base_units() {
        for (text, base) in [
            ("", "1"),
            ("1", "1"),
            ("kg/m^3", "kg/m^3"),
            ("Pa", "kg/(m s^2)"),
            ("Pa s", "kg/(m s)"),
            ("Pa*s", "kg/(m s)"),
            ("m^2/(Pa s)", "m^3 s/kg"),
            ("1/s", "1/s"),
            ("J/(kg K)", "m^2/(s^2 K)"),
            ("N/(m/s)", "kg/s"),
            ("Pa m^6/kg^2", "m^5/(kg s^2)"),
            ("m s^-2", "m/s^2"),
        ] {
            assert_eq!(
                Dimension::parse(text).map(|own| own.to_string()),
                Ok(base.into()),
                "{text}"
            );
        }
        for text in ["kPa", "m/", "(m", "m)", "m^x", "*m", "m//s", "()", "m^99"] {
            assert!(Dimension::parse(text).is_err(), "{text}");
        }
    }
}
