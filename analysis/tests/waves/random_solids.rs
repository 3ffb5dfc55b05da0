//! Random elastic solids and directions.

use crate::support::states::Random;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};

#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Classical,
    Reduced,
    Cosserat,
}

pub const KINDS: [Kind; 3] = [Kind::Classical, Kind::Reduced, Kind::Cosserat];

/// Random solid with moduli of comparable size; λ may be negative.
pub fn solid(random: &mut Random, kind: Kind) -> Isotropic {
    let mu = random.decades(1e-3, 1e10);
    let density = random.decades(0.1, 1e4);
    let lambda = mu * random.within(-0.6, 3.0);
    let couple = (kind == Kind::Cosserat).then(|| {
        let gamma = mu * random.decades(1e-8, 1e-2);
        let eta = gamma * random.decades(0.05, 5.0);
        CoupleModuli { beta: gamma * random.within(-0.6, 3.0), gamma, eta }
    });
    let microrotation = (kind != Kind::Classical).then(|| Microrotation {
        alpha: mu * random.decades(0.01, 3.0),
        inertia: density * random.decades(1e-6, 1.0),
        couple,
    });
    Isotropic::new(lambda, mu, density, microrotation).expect("sound moduli")
}

/// Random unit vector.
pub fn unit<const D: usize>(random: &mut Random) -> [f64; D] {
    loop {
        let v: [f64; D] = std::array::from_fn(|_| random.within(-1.0, 1.0));
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (0.1..1.0).contains(&length) {
            return v.map(|x| x / length);
        }
    }
}

/// Random solid with moduli and density of order one.
pub fn solid_of_order_one(random: &mut Random, kind: Kind) -> Isotropic {
    let couple = (kind == Kind::Cosserat).then(|| CoupleModuli {
        beta: random.within(-0.3, 1.0),
        gamma: random.within(0.5, 1.5),
        eta: random.within(0.5, 1.5),
    });
    let microrotation = (kind != Kind::Classical).then(|| Microrotation {
        alpha: random.within(0.2, 2.0),
        inertia: random.within(0.3, 2.0),
        couple,
    });
    Isotropic::new(random.within(-0.5, 2.0), 1.0, 1.0, microrotation).expect("sound moduli")
}
