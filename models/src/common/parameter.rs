//! Metadata of model constants: name, unit, meaning, default and range, from which case files are read and templates
//! and parameter sweeps are built.

use crate::common::input::{InputError, ensure, to_rounded_degrees};
use crate::common::range::AllowedRange;
use std::fmt::Display;

/// A constant of a model or of a yield set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name of the constant in lower case, words joined by underscores, e.g. `friction_angle`.
    pub name: &'static str,
    /// Quantity and symbol, for axes and legends: `friction angle φ`.
    pub label: &'static str,
    /// SI unit; empty for pure numbers, [`ANGLE_UNIT`] for angles.
    pub unit: &'static str,
    /// Meaning of the quantity and its allowed values, in one line.
    pub meaning: &'static str,
    /// Whether a value is required, has a default, or is optional.
    pub presence: Presence,
    /// Allowed range in the unit of the parameter, independent of the other constants.
    pub range: AllowedRange,
}

/// Defines constants of type [`Parameter`] from rows of name, label, unit, presence, range and meaning.
macro_rules! define_parameters {
    ($(
        $(#[$attribute:meta])*
        $visibility:vis $constant:ident = $name:literal: $label:literal [$unit:expr],
            $presence:ident($value:expr), $range:ident $(($bound:expr))?, $meaning:literal;
    )*) => {
        $(
            $(#[$attribute])*
            $visibility const $constant: $crate::common::parameter::Parameter =
                $crate::common::parameter::Parameter {
                    name: $name,
                    label: $label,
                    unit: $unit,
                    meaning: $meaning,
                    presence: $crate::common::parameter::Presence::$presence($value),
                    range: $crate::common::range::AllowedRange::$range $(($bound))?,
                };
        )*
    };
}

pub(crate) use define_parameters;

/// Unit of angles. Case files and output hold them in degrees; models take them in rad.
pub const ANGLE_UNIT: &str = "deg";

/// Whether a constant is required, has a default, or is optional.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// Required; the number is an example value, in the unit of the parameter.
    Required(f64),
    /// Optional with this default, in the unit of the parameter.
    Default(f64),
    /// Optional without default: an absent quantity is derived or not used.
    Optional,
}

impl Parameter {
    /// A required constant whose range is all finite numbers; `example` in the unit of the parameter.
    pub const fn new_required(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
        example: f64,
    ) -> Self {
        Self::new([name, label, unit], meaning, Presence::Required(example))
    }

    /// A constant whose range is all finite numbers, with the default `default` in the unit of the parameter.
    pub const fn with_default(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
        default: f64,
    ) -> Self {
        Self::new([name, label, unit], meaning, Presence::Default(default))
    }

    /// An optional constant without default, whose range is all finite numbers.
    pub const fn new_optional(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
    ) -> Self {
        Self::new([name, label, unit], meaning, Presence::Optional)
    }

    const fn new(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
        presence: Presence,
    ) -> Self {
        Self { name, label, unit, meaning, presence, range: AllowedRange::Finite }
    }

    /// Returns this parameter with the allowed range `range`, in the unit of the parameter.
    pub const fn with_range(self, range: AllowedRange) -> Self {
        Self { range, ..self }
    }

    /// Checks that `value` (SI units, rad) is in the range; `allowed` describes the range in the error message.
    ///
    /// # Errors
    /// The value is out of range or not finite.
    pub fn check(&self, value: f64, allowed: impl Display) -> Result<(), InputError> {
        match self.unit {
            ANGLE_UNIT => {
                let is_in = self.range.to_radians().contains(value);
                ensure(is_in, self.name, to_rounded_degrees(value), allowed)
            }
            _ => ensure(self.range.contains(value), self.name, value, allowed),
        }
    }

    /// The example or default value in SI units and rad; NaN for [`Presence::Optional`].
    pub fn example_value(&self) -> f64 {
        match self.presence {
            Presence::Required(value) | Presence::Default(value) => self.to_si(value),
            Presence::Optional => f64::NAN,
        }
    }

    /// Converts a value from the unit of the parameter to SI units: angles from degrees to rad; other values are in SI
    /// units already.
    pub fn to_si(&self, stated: f64) -> f64 {
        if self.unit == ANGLE_UNIT { stated.to_radians() } else { stated }
    }
}

/// Converts the list of constants of a model with `N` constants to an array.
///
/// # Errors
/// The list has another length than `N`.
pub fn to_constant_array<const N: usize>(given: &[f64]) -> Result<[f64; N], InputError> {
    given.try_into().map_err(|_| InputError {
        input: "kind",
        rejected_value: format!("{} constants", given.len()),
        allowed_values: format!("this model has {N}"),
    })
}
