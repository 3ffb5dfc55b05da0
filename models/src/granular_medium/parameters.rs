//! Constants of a granular medium and their checks.

use crate::common::input::{InputError, ensure};
use crate::common::range::AllowedRange::NotNegative;
use crate::uniaxial::cone::DEFAULT_INTENSITY_COEFFICIENT;
use crate::uniaxial::skeleton::SkeletonConstants;
use crate::uniaxial::{FrictionCone, StrainIntensity};

/// Constants of a granular medium, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GranularParameters {
    /// Density ρ, kg/m³; > 0.
    pub density: f64,
    /// Bulk modulus k of the compressed medium, Pa; > 0.
    pub bulk_modulus: f64,
    /// Shear modulus μ of the compressed medium, Pa; > 0.
    pub shear_modulus: f64,
    /// Friction æ of the cone τ ≤ æp; ≥ 0.
    pub friction: f64,
    /// Yield stress τ_s of the particles in τ ≤ τ_s, Pa; > 0. `None`: elastic particles.
    pub yield_stress: Option<f64>,
    /// Coefficient c² of the intensity of shear stress τ² = c² s:s; > 0.
    pub intensity_coefficient: f64,
}

/// Granular medium with checked constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GranularMedium(GranularParameters);

impl GranularParameters {
    /// Coefficient c² of the intensity of shear stress if none is given: τ is half of the von Mises stress.
    pub const DEFAULT_INTENSITY_COEFFICIENT: f64 = DEFAULT_INTENSITY_COEFFICIENT;
}

impl From<&GranularParameters> for SkeletonConstants {
    fn from(own: &GranularParameters) -> Self {
        Self {
            density: own.density,
            bulk_modulus: own.bulk_modulus,
            shear_modulus: own.shear_modulus,
            yield_stress: own.yield_stress,
            intensity_coefficient: own.intensity_coefficient,
        }
    }
}

impl GranularMedium {
    /// Checks the constants.
    ///
    /// # Errors
    /// A constant is not finite or out of range.
    pub fn new(parameters: GranularParameters) -> Result<Self, InputError> {
        let own = parameters;
        SkeletonConstants::from(&own).check()?;
        ensure(
            NotNegative.contains(own.friction),
            "friction",
            own.friction,
            "the friction must be æ ≥ 0",
        )?;
        Ok(Self(own))
    }

    /// Returns the constants.
    pub fn parameters(&self) -> &GranularParameters {
        &self.0
    }

    /// Returns whether the cone admits tension under lateral pressure: æ > √(3c²/2).
    pub fn transmits_tension(&self) -> bool {
        self.0.friction > self.cone().intensity.front_ratio
    }

    /// Returns the contact in uniaxial strain.
    pub(super) fn cone(&self) -> FrictionCone {
        FrictionCone {
            bulk_modulus: self.0.bulk_modulus,
            friction: self.0.friction,
            intensity: StrainIntensity::new(self.0.shear_modulus, self.0.intensity_coefficient),
        }
    }
}
