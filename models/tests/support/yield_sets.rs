//! Random yield sets with constants of order one.

use super::RandomNumbers;
use wellposed_models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};

/// Random Cosserat–Mises cone with constants of order one and non-associated flow.
pub fn random_mises(random: &mut RandomNumbers) -> Mises {
    let friction = random.uniform(0.1, 0.8);
    Mises {
        friction,
        dilatancy: friction * random.uniform(0.2, 0.9),
        antisymmetric_weight: random.uniform(0.3, 3.0),
        symmetric_internal_length: Some(random.uniform(0.5, 2.0)),
        antisymmetric_internal_length: Some(random.uniform(0.5, 2.0)),
        ..Mises::new_von_mises(random.uniform(0.5, 2.0))
    }
    .check()
    .unwrap()
}

/// Random interlayer yield set with constants of order one, couple limits and non-associated flow.
pub fn random_interlayer(random: &mut RandomNumbers) -> InterlayerYieldSet {
    let couple = InterlayerCoupleLimits {
        strength: random.uniform(0.5, 2.0),
        friction: random.uniform(0.2, 0.9),
        dilatancy: random.uniform(0.1, 0.2),
    };
    InterlayerYieldSet {
        shear_strength: random.uniform(0.5, 2.0),
        shear_friction: random.uniform(0.2, 0.9),
        shear_dilatancy: random.uniform(0.1, 0.2),
        couple: Some(couple),
    }
    .check()
    .unwrap()
}
