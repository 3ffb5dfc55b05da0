//! Random solids with moduli of order one, and random directions.

use crate::support::Random;
use wellposed_models::solid::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances,
};

fn couple_moduli(random: &mut Random) -> CoupleModuli {
    let gamma = random.within(0.2, 2.0);
    let beta = gamma * (random.within(0.1, 2.0) - 2.0 / 3.0);
    CoupleModuli { beta, gamma, eta: random.within(0.2, 2.0) }
}

/// Random classical (`theory` 0), reduced Cosserat (1) or Cosserat (2) solid with moduli of order one.
pub fn solid(random: &mut Random, theory: usize) -> Isotropic {
    let mu = random.within(0.5, 2.0);
    let lambda = mu * (random.within(0.1, 3.0) - 2.0 / 3.0);
    let microrotation = Microrotation {
        alpha: random.within(0.1, 2.0),
        inertia: random.within(0.2, 2.0),
        couple: (theory == 2).then(|| couple_moduli(random)),
    };
    let density = random.within(0.5, 2.0);
    Isotropic::new(lambda, mu, density, (theory > 0).then_some(microrotation)).unwrap()
}

/// Random compliances of a cubic (anisotropic) solid.
pub fn cubic(random: &mut Random) -> PlaneCompliances {
    let (a1, a2) = (random.within(0.5, 2.0), random.within(0.5, 2.0));
    PlaneCompliances {
        a1,
        b1: a1 * random.within(-0.8, 0.8),
        a2,
        b2: a2 * random.within(-0.8, 0.8),
        alpha2: random.within(0.5, 2.0),
        density: random.within(0.5, 2.0),
        inertia: random.within(0.5, 2.0),
    }
    .check()
    .unwrap()
}

pub fn unit<const D: usize>(random: &mut Random) -> [f64; D] {
    let raw: [f64; D] = std::array::from_fn(|_| random.generic(0.2, 1.0));
    let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
    raw.map(|x| x / norm)
}
