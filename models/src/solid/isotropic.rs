//! Isotropic solids: classical, reduced Cosserat and Cosserat.

use super::model::SolidModel;
use super::{ElasticLaw, Elasticity};
use crate::common::input::InputError;
use crate::common::parameter::to_constant_array;
use crate::common::system::RoundedMatrix;
use crate::solid::parameters::{
    ALPHA, BETA, CoupleModuli, DENSITY, ETA, GAMMA, INERTIA, Isotropic, LAMBDA, MU, Microrotation,
    Theory,
};
use crate::solid::stress::{Stress, StressComponent};
use crate::solid::waves::{SpinRotation, VelocityStressPair};

/// Registry entry of the classical solid with the Lamé moduli λ and μ.
pub static CLASSICAL: SolidModel = SolidModel {
    name: "classical",
    title: "classical solid",
    parameters: &[LAMBDA, MU, DENSITY],
    theory: Theory::Classical,
    is_plane: false,
    constructor: |given| {
        let [lambda, mu, density] = to_constant_array(given)?;
        build_law(lambda, mu, density, None)
    },
};

/// Registry entry of the reduced Cosserat solid with the moduli λ, μ, α: microrotation without couple stress.
pub static REDUCED_COSSERAT: SolidModel = SolidModel {
    name: "reduced-cosserat",
    title: "reduced Cosserat solid",
    parameters: &[LAMBDA, MU, ALPHA, DENSITY, INERTIA],
    theory: Theory::Reduced,
    is_plane: false,
    constructor: |given| {
        let [lambda, mu, alpha, density, inertia] = to_constant_array(given)?;
        build_law(lambda, mu, density, Some(Microrotation { alpha, inertia, couple: None }))
    },
};

/// Registry entry of the Cosserat solid with the moduli λ, μ, α and the couple moduli β, γ, η.
pub static COSSERAT: SolidModel = SolidModel {
    name: "cosserat",
    title: "Cosserat solid",
    parameters: &[LAMBDA, MU, ALPHA, BETA, GAMMA, ETA, DENSITY, INERTIA],
    theory: Theory::Cosserat,
    is_plane: false,
    constructor: |given| {
        let [lambda, mu, alpha, beta, gamma, eta, density, inertia] = to_constant_array(given)?;
        let couple = Some(CoupleModuli { beta, gamma, eta });
        build_law(lambda, mu, density, Some(Microrotation { alpha, inertia, couple }))
    },
};

fn build_law(
    lambda: f64,
    mu: f64,
    density: f64,
    microrotation: Option<Microrotation>,
) -> Result<ElasticLaw, InputError> {
    Isotropic::new(lambda, mu, density, microrotation).map(ElasticLaw::from)
}

impl Elasticity for Isotropic {
    fn theory(&self) -> Theory {
        Isotropic::theory(self)
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn inertia(&self) -> f64 {
        self.microrotation.map_or(0.0, |m| m.inertia)
    }

    fn antisymmetric_modulus(&self) -> f64 {
        self.microrotation.map_or(0.0, |m| m.alpha)
    }

    fn characteristic_wave_number(&self) -> Option<f64> {
        let frequency = self.microrotation?.natural_frequency();
        Some(frequency / self.speeds().shear)
    }

    fn stiffness(&self, stresses: &[StressComponent]) -> RoundedMatrix {
        Isotropic::stiffness(self, stresses.iter().copied())
    }

    fn pairs(&self, dimensions: usize, axis: usize) -> Vec<VelocityStressPair> {
        Isotropic::pairs(self, dimensions, axis)
    }

    fn rotation(&self) -> Option<SpinRotation> {
        Isotropic::rotation(self)
    }

    fn stored_energy(&self, stress: &Stress) -> f64 {
        Isotropic::stored_energy(self, stress)
    }
}
