//! Random elastic solids and directions.

use crate::support::states::RandomNumbers;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};

pub const THEORIES: [Theory; 3] = [Theory::Classical, Theory::Reduced, Theory::Cosserat];

/// Random solid with a shear modulus μ over 13 decades and force-stress moduli λ and α of comparable size; λ may be
/// negative.
pub fn random_solid(random: &mut RandomNumbers, theory: Theory) -> Isotropic {
    let mu = random.log_uniform(1e-3, 1e10);
    let density = random.log_uniform(0.1, 1e4);
    let lambda = mu * random.uniform(-0.6, 3.0);
    let couple = (theory == Theory::Cosserat).then(|| {
        let gamma = mu * random.log_uniform(1e-8, 1e-2);
        let eta = gamma * random.log_uniform(0.05, 5.0);
        CoupleModuli { beta: gamma * random.uniform(-0.6, 3.0), gamma, eta }
    });
    let microrotation = (theory != Theory::Classical).then(|| Microrotation {
        alpha: mu * random.log_uniform(0.01, 3.0),
        inertia: density * random.log_uniform(1e-6, 1.0),
        couple,
    });
    Isotropic::new(lambda, mu, density, microrotation).expect("sound moduli")
}

/// Random unit vector.
pub fn random_unit_vector<const D: usize>(random: &mut RandomNumbers) -> [f64; D] {
    loop {
        let v: [f64; D] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (0.1..1.0).contains(&length) {
            return v.map(|x| x / length);
        }
    }
}

/// Random solid with moduli and density of order one.
pub fn random_solid_of_order_one(random: &mut RandomNumbers, theory: Theory) -> Isotropic {
    let couple = (theory == Theory::Cosserat).then(|| CoupleModuli {
        beta: random.uniform(-0.3, 1.0),
        gamma: random.uniform(0.5, 1.5),
        eta: random.uniform(0.5, 1.5),
    });
    let microrotation = (theory != Theory::Classical).then(|| Microrotation {
        alpha: random.uniform(0.2, 2.0),
        inertia: random.uniform(0.3, 2.0),
        couple,
    });
    Isotropic::new(random.uniform(-0.5, 2.0), 1.0, 1.0, microrotation).expect("sound moduli")
}
