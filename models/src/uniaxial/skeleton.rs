//! Constants that granular and porous media share, and their checks.

use crate::common::input::{InputError, ensure};
use crate::common::range::AllowedRange::Positive;

/// Number that stands for the absence of a limit of a stress, Pa, or of a strain: finite in single precision, and beyond
/// every stress.
pub const NO_LIMIT: f64 = 1e30;

/// Constants of the particles of a granular medium, or of the skeleton of a porous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SkeletonConstants {
    pub(crate) density: f64,
    pub(crate) bulk_modulus: f64,
    pub(crate) shear_modulus: f64,
    pub(crate) yield_stress: Option<f64>,
    pub(crate) intensity_coefficient: f64,
}

impl SkeletonConstants {
    /// Checks that all constants are finite and positive.
    pub(crate) fn check(&self) -> Result<(), InputError> {
        let constants = [
            ("density", self.density, "the density must be ρ > 0, in kg/m³"),
            ("bulk_modulus", self.bulk_modulus, "the bulk modulus must be k > 0, in Pa"),
            ("shear_modulus", self.shear_modulus, "the shear modulus must be μ > 0, in Pa"),
            (
                "intensity_coefficient",
                self.intensity_coefficient,
                "the coefficient of the intensity of shear stress must be c² > 0",
            ),
        ];
        let limit = self
            .yield_stress
            .map(|limit| ("yield_stress", limit, "the yield stress must be τ_s > 0, in Pa"));
        for (name, value, allowed) in constants.into_iter().chain(limit) {
            ensure(Positive.contains(value), name, value, allowed)?;
        }
        Ok(())
    }
}
