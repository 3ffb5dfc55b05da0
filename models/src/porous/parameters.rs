//! Constants of a porous medium and their checks.

use crate::common::input::{InputError, ensure};
use crate::common::range::AllowedRange::{NotNegative, NotNegativeBelow, Positive};
use crate::uniaxial::StrainIntensity;
use crate::uniaxial::cone::DEFAULT_INTENSITY_COEFFICIENT;
use crate::uniaxial::skeleton::SkeletonConstants;

/// Constants of a porous medium, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousParameters {
    /// Density ρ of the porous medium, kg/m³; > 0.
    pub density: f64,
    /// Bulk modulus k_a of the skeleton, Pa; > 0.
    pub bulk_modulus: f64,
    /// Shear modulus μ_a of the skeleton, Pa; > 0.
    pub shear_modulus: f64,
    /// Yield stress τ_s of the skeleton in τ ≤ τ_s, Pa; > 0. `None`: elastic skeleton.
    pub yield_stress: Option<f64>,
    /// Coefficient c² of the intensity of shear stress τ² = c² s:s; > 0.
    pub intensity_coefficient: f64,
    /// Bulk modulus k_b that collapsed pores add, Pa; ≥ 0, > 0 with friction.
    pub contact_bulk_modulus: f64,
    /// Porosity θ₀ of the natural state; in [0, 1).
    pub porosity: f64,
    /// Contact of the walls of pores.
    pub contact: PoreContact,
}

/// Contact of the walls of pores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoreContact {
    /// Walls transmit a mean stress, from tr ε = −θ₀ on.
    Spherical,
    /// Walls transmit stresses in the cone τ ≤ æp.
    Frictional {
        /// Shear modulus μ_b that collapsed pores add, Pa; > 0.
        shear_modulus: f64,
        /// Friction æ; ≥ 0.
        friction: f64,
    },
}

/// Porous medium with checked constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousMedium(PorousParameters);

impl PorousParameters {
    /// Coefficient c² of the intensity of shear stress if none is given: τ is half of the von Mises stress.
    pub const DEFAULT_INTENSITY_COEFFICIENT: f64 = DEFAULT_INTENSITY_COEFFICIENT;
}

impl From<&PorousParameters> for SkeletonConstants {
    fn from(own: &PorousParameters) -> Self {
        Self {
            density: own.density,
            bulk_modulus: own.bulk_modulus,
            shear_modulus: own.shear_modulus,
            yield_stress: own.yield_stress,
            intensity_coefficient: own.intensity_coefficient,
        }
    }
}

impl PorousMedium {
    /// Checks the constants.
    ///
    /// # Errors
    /// A constant is not finite or out of range.
    pub fn new(parameters: PorousParameters) -> Result<Self, InputError> {
        let own = parameters;
        SkeletonConstants::from(&own).check()?;
        ensure(
            NotNegative.contains(own.contact_bulk_modulus),
            "contact_bulk_modulus",
            own.contact_bulk_modulus,
            "the bulk modulus of collapsed pores must be k_b ≥ 0, in Pa",
        )?;
        ensure(
            NotNegativeBelow(1.0).contains(own.porosity),
            "porosity",
            own.porosity,
            "the porosity must be 0 ≤ θ₀ < 1",
        )?;
        if let PoreContact::Frictional { shear_modulus, friction } = own.contact {
            ensure(
                Positive.contains(own.contact_bulk_modulus),
                "contact_bulk_modulus",
                own.contact_bulk_modulus,
                "the bulk modulus of collapsed pores with friction must be k_b > 0, in Pa",
            )?;
            ensure(
                Positive.contains(shear_modulus),
                "contact_shear_modulus",
                shear_modulus,
                "the shear modulus of collapsed pores must be μ_b > 0, in Pa",
            )?;
            ensure(
                NotNegative.contains(friction),
                "friction",
                friction,
                "the friction must be æ ≥ 0",
            )?;
        }
        Ok(Self(own))
    }

    /// Returns the constants.
    pub fn parameters(&self) -> &PorousParameters {
        &self.0
    }

    /// Returns the compression strain θ_f = τ_s/m at which the skeleton yields; infinite for an elastic skeleton.
    pub fn yield_strain(&self) -> f64 {
        self.0
            .yield_stress
            .map_or(f64::INFINITY, |limit| limit / self.intensity().intensity_modulus)
    }

    /// Returns the constants of the intensity of shear stress of the skeleton.
    pub(super) fn intensity(&self) -> StrainIntensity {
        StrainIntensity::new(self.0.shear_modulus, self.0.intensity_coefficient)
    }
}
