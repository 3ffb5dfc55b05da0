//! An elastic solid as the registry lists it.

use super::ElasticLaw;
use crate::common::input::InputError;
use crate::common::parameter::Parameter;
use crate::solid::parameters::Theory;
use std::fmt;

/// An elastic solid as the [registry](crate::registry) lists it.
pub struct SolidModel {
    /// Name in case files, as in `reduced-cosserat`.
    pub name: &'static str,
    /// Name in titles and legends.
    pub title: &'static str,
    /// Its constants. Those named like a constant of another solid must have the same unit.
    pub parameters: &'static [Parameter],
    /// Whether it has a rotation of its own, and couple stress.
    pub theory: Theory,
    /// Whether it is a law of plane strain alone.
    pub is_plane: bool,
    /// Checks the constants, which are in the order of `parameters`, in SI units.
    pub build: fn(&[f64]) -> Result<ElasticLaw, InputError>,
}

/// An entry of the registry by reference; two are equal if they have the same name.
#[derive(Clone, Copy)]
pub struct SolidKind(&'static SolidModel);

impl SolidKind {
    /// An entry of the registry.
    pub const fn new(model: &'static SolidModel) -> Self {
        Self(model)
    }

    /// The law with the constants that its parameters have for examples or defaults, by which a yield set says whether
    /// it admits the solid.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn example(self) -> Result<ElasticLaw, InputError> {
        let constants: Vec<f64> = self.0.parameters.iter().map(Parameter::example).collect();
        self.law(&constants)
    }

    /// The law with these constants, which are in the order of the kind's parameters, in SI units.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn law(self, constants: &[f64]) -> Result<ElasticLaw, InputError> {
        (self.0.build)(constants)
    }
}

impl std::ops::Deref for SolidKind {
    type Target = SolidModel;

    fn deref(&self) -> &SolidModel {
        self.0
    }
}

impl PartialEq for SolidKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for SolidKind {}

impl std::hash::Hash for SolidKind {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl fmt::Debug for SolidKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}
