//! Random solids with moduli of the magnitude of real materials.

use crate::support::{RandomNumbers, draw_log_uniform};
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};

pub fn random_solid(random: &mut RandomNumbers, theory: Theory) -> Isotropic {
    let mu = draw_log_uniform(random, 6.0, 10.0);
    // Bulk modulus K = λ + ⅔μ from 0.03 to 30 times μ.
    let lambda = mu * (draw_log_uniform(random, -1.5, 1.5) - 2.0 / 3.0);
    let gamma = mu * draw_log_uniform(random, -6.0, 0.0);
    let couple = CoupleModuli {
        beta: gamma * (draw_log_uniform(random, -1.0, 1.0) - 2.0 / 3.0),
        gamma,
        eta: gamma * draw_log_uniform(random, -1.5, 1.0),
    };
    let microrotation = Microrotation {
        alpha: mu * draw_log_uniform(random, -2.0, 1.0),
        inertia: draw_log_uniform(random, -6.0, 3.0),
        couple: (theory == Theory::Cosserat).then_some(couple),
    };
    Isotropic::new(lambda, mu, 2000.0, (theory != Theory::Classical).then_some(microrotation))
        .unwrap()
}
