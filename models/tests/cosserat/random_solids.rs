//! Random solids with moduli of order one, and random directions.

use crate::support::RandomNumbers;
use crate::support::solids::random_plane_compliances;
use wellposed_models::solid::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances,
};

fn couple_moduli(random: &mut RandomNumbers) -> CoupleModuli {
    let gamma = random.uniform(0.2, 2.0);
    let beta = gamma * (random.uniform(0.1, 2.0) - 2.0 / 3.0);
    CoupleModuli { beta, gamma, eta: random.uniform(0.2, 2.0) }
}

/// Random classical (`theory` 0), reduced Cosserat (1) or Cosserat (2) solid with moduli of order one.
pub fn random_solid(random: &mut RandomNumbers, theory: usize) -> Isotropic {
    let mu = random.uniform(0.5, 2.0);
    let lambda = mu * (random.uniform(0.1, 3.0) - 2.0 / 3.0);
    let microrotation = Microrotation {
        alpha: random.uniform(0.1, 2.0),
        inertia: random.uniform(0.2, 2.0),
        couple: (theory == 2).then(|| couple_moduli(random)),
    };
    let density = random.uniform(0.5, 2.0);
    Isotropic::new(lambda, mu, density, (theory > 0).then_some(microrotation)).unwrap()
}

/// Random compliances of a cubic (anisotropic) solid.
pub fn random_cubic_solid(random: &mut RandomNumbers) -> PlaneCompliances {
    random_plane_compliances(random, 0.8)
}

pub fn random_unit_vector<const D: usize>(random: &mut RandomNumbers) -> [f64; D] {
    let raw: [f64; D] = std::array::from_fn(|_| random.signed_uniform(0.2, 1.0));
    let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
    raw.map(|x| x / norm)
}
