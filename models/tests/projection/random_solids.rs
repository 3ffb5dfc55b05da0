//! Random solids with moduli of the magnitude of real materials.

use crate::support::{Random, decades};
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation {
    Classical,
    Reduced,
    Cosserat,
}

pub fn solid(random: &mut Random, rotation: Rotation) -> Isotropic {
    let mu = decades(random, 6.0, 10.0);
    // Bulk modulus K from 0.03 to 30 times μ.
    let lambda = mu * (decades(random, -1.5, 1.5) - 2.0 / 3.0);
    let gamma = mu * decades(random, -6.0, 0.0);
    let couple = CoupleModuli {
        beta: gamma * (decades(random, -1.0, 1.0) - 2.0 / 3.0),
        gamma,
        eta: gamma * decades(random, -1.5, 1.0),
    };
    let microrotation = Microrotation {
        alpha: mu * decades(random, -2.0, 1.0),
        inertia: decades(random, -6.0, 3.0),
        couple: (rotation == Rotation::Cosserat).then_some(couple),
    };
    Isotropic::new(lambda, mu, 2000.0, (rotation != Rotation::Classical).then_some(microrotation))
        .unwrap()
}
