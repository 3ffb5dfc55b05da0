//! Cosserat solid in plane strain given by its compliances a₁, b₁, a₂, b₂ and its couple modulus α₂; of cubic symmetry
//! in general.

use super::model::SolidModel;
use super::{ElasticLaw, Elasticity};
use crate::common::parameter::{define_parameters, to_constant_array};
use crate::common::system::RoundedMatrix;
use crate::solid::parameters::{ALPHA2, DENSITY, INERTIA, PlaneCompliances, Theory};
use crate::solid::stress::{Stress, StressComponent};
use crate::solid::waves::{SpinRotation, VelocityStressPair};

define_parameters! {
    A1 = "a1": "compliance a₁" ["1/Pa"], Required(4.6296296296296296e-11), Finite,
        "compliance a₁; > |b₁|";
    B1 = "b1": "compliance b₁" ["1/Pa"], Required(1.5432098765432098e-11), Finite,
        "compliance b₁; a₁ + b₁ = a₂ − b₂ in isotropic solids";
    A2 = "a2": "compliance a₂" ["1/Pa"], Required(2.7962041638724895e-10), Finite,
        "compliance a₂; > |b₂|";
    B2 = "b2": "compliance b₂" ["1/Pa"], Required(2.178920212921872e-10), Finite,
        "compliance b₂";
}

/// Registry entry of the Cosserat solid in plane strain by compliances.
pub static COSSERAT_COMPLIANCES: SolidModel = SolidModel {
    name: "cosserat-compliances",
    title: "Cosserat solid by compliances",
    parameters: &[A1, B1, A2, B2, ALPHA2, DENSITY, INERTIA],
    theory: Theory::Cosserat,
    is_plane: true,
    constructor: |given| {
        let [a1, b1, a2, b2, alpha2, density, inertia] = to_constant_array(given)?;
        let compliances = PlaneCompliances { a1, b1, a2, b2, alpha2, density, inertia };
        compliances.check().map(ElasticLaw::from)
    },
};

impl Elasticity for PlaneCompliances {
    fn theory(&self) -> Theory {
        Theory::Cosserat
    }

    fn is_plane(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn inertia(&self) -> f64 {
        self.inertia
    }

    fn antisymmetric_modulus(&self) -> f64 {
        0.5 / (self.a2 + self.b2)
    }

    fn characteristic_wave_number(&self) -> Option<f64> {
        let Self { a2, b2, density, inertia, .. } = *self;
        // Frequency √(4α/j) and shear wave speed √((μ + α)/ρ), with 4α = 2/(a₂ + b₂) and μ + α = a₂/(a₂² − b₂²).
        let frequency = (2.0 / ((a2 + b2) * inertia)).sqrt();
        let speed = (a2 / ((a2 - b2) * (a2 + b2) * density)).sqrt();
        Some(frequency / speed)
    }

    fn stiffness(&self, _stresses: &[StressComponent]) -> RoundedMatrix {
        PlaneCompliances::stiffness(self)
    }

    fn pairs(&self, _dimensions: usize, axis: usize) -> Vec<VelocityStressPair> {
        PlaneCompliances::pairs(self, axis)
    }

    fn rotation(&self) -> Option<SpinRotation> {
        Some(PlaneCompliances::rotation(self))
    }

    fn stored_energy(&self, stress: &Stress) -> f64 {
        PlaneCompliances::stored_energy(self, stress)
    }
}
