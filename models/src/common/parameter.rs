//! What a model says of each of its constants, for whoever reads, writes or sweeps them.

use crate::common::input::{InputError, degrees, ensure};
use crate::common::range::Range;
use std::fmt::Display;

/// A constant of a model or of a yield set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in lower case, words joined by underscores: `friction_angle`.
    pub name: &'static str,
    /// Quantity and symbol, for axes and legends: `friction angle φ`.
    pub label: &'static str,
    /// SI unit; empty for pure numbers. Angles are marked [`ANGLE`].
    pub unit: &'static str,
    /// What the quantity is and what is allowed, in one line.
    pub meaning: &'static str,
    /// What holds where no value is given.
    pub presence: Presence,
    /// Its range, whatever the other constants are.
    pub range: Range,
}

/// Unit of angles. They are stated and shown in degrees; a model is given them in rad.
pub const ANGLE: &str = "deg";

/// What holds where no value is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// A value must be given; this is an example, in the unit of the parameter.
    Required(f64),
    /// This value, in the unit of the parameter.
    Default(f64),
    /// Nothing: the quantity is derived, or not used.
    Optional,
}

impl Parameter {
    /// A constant that must be given; any finite number.
    pub const fn required(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
        example: f64,
    ) -> Self {
        Self::new([name, label, unit], meaning, Presence::Required(example))
    }

    /// A constant with a default; any finite number.
    pub const fn with_default(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
        default: f64,
    ) -> Self {
        Self::new([name, label, unit], meaning, Presence::Default(default))
    }

    const fn new(
        [name, label, unit]: [&'static str; 3],
        meaning: &'static str,
        presence: Presence,
    ) -> Self {
        Self { name, label, unit, meaning, presence, range: Range::Finite }
    }

    /// The same of a constant that is in a range, in its unit, whatever the other constants are.
    pub const fn within(self, range: Range) -> Self {
        Self { range, ..self }
    }

    /// That a value, in SI units and rad, is in the range; `allowed` says what is.
    ///
    /// # Errors
    /// It is not.
    pub fn check(&self, value: f64, allowed: impl Display) -> Result<(), InputError> {
        match self.unit {
            ANGLE => {
                let is_in = self.range.to_radians().contains(value);
                ensure(is_in, self.name, degrees(value), allowed)
            }
            _ => ensure(self.range.contains(value), self.name, value, allowed),
        }
    }

    /// The example or the default as the model takes it; NaN of what is absent without default.
    pub fn example(&self) -> f64 {
        match self.presence {
            Presence::Required(value) | Presence::Default(value) => self.to_si(value),
            Presence::Optional => f64::NAN,
        }
    }

    /// A stated value as the model takes it: angles in rad.
    pub fn to_si(&self, stated: f64) -> f64 {
        if self.unit == ANGLE { stated.to_radians() } else { stated }
    }
}

/// The constants of a model that has `N` of them.
///
/// # Errors
/// Another number of them.
pub fn constants<const N: usize>(given: &[f64]) -> Result<[f64; N], InputError> {
    given.try_into().map_err(|_| InputError {
        input: "kind",
        found: format!("{} constants", given.len()),
        allowed: format!("this model has {N}"),
    })
}
