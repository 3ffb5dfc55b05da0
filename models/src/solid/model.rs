//! An elastic solid as the registry lists it.

use super::ElasticLaw;
use crate::common::input::InputError;
use crate::common::kind::{impl_deref_to_entry, impl_kind_by_name};
use crate::common::parameter::Parameter;
use crate::solid::parameters::Theory;

/// An elastic solid as the [registry](crate::registry) lists it.
pub struct SolidModel {
    /// Name of the solid in case files, e.g. `reduced-cosserat`.
    pub name: &'static str,
    /// Name of the solid in titles and legends.
    pub title: &'static str,
    /// Constants of the solid. Constants of the same name in different solids and flow models must have the same unit.
    pub parameters: &'static [Parameter],
    /// Theory: whether the solid has microrotation and couple stress.
    pub theory: Theory,
    /// Whether the law is defined in plane strain only.
    pub is_plane: bool,
    /// Constructor from the constants in the order of `parameters`, in SI units.
    pub constructor: fn(&[f64]) -> Result<ElasticLaw, InputError>,
}

/// Reference to a registry entry of a solid; equality compares names.
#[derive(Clone, Copy)]
pub struct SolidKind(&'static SolidModel);

impl SolidKind {
    /// A reference to the registry entry `model`.
    pub const fn new(model: &'static SolidModel) -> Self {
        Self(model)
    }

    /// Builds the elastic law with the example or default constants; whether a yield set admits the solid is decided by
    /// this law.
    ///
    /// # Errors
    /// A constant is out of range.
    pub fn build_example_law(self) -> Result<ElasticLaw, InputError> {
        let constants: Vec<f64> = self.0.parameters.iter().map(Parameter::example_value).collect();
        self.build_law(&constants)
    }

    /// Builds the elastic law with the given constants, in the order of the kind's parameters, in SI units.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn build_law(self, constants: &[f64]) -> Result<ElasticLaw, InputError> {
        (self.0.constructor)(constants)
    }
}

impl_deref_to_entry!(SolidKind, SolidModel);
impl_kind_by_name!(SolidKind);
