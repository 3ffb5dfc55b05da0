//! Random solids, yield sets and stresses, and the search over all directions.

use crate::support::states::Random;
use models::common::rates::RateEquations;
use models::common::rounding::Rounded;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::{Component, Stress};
use models::yield_set::parameters::{ActiveCondition, Mises};
use nalgebra::{DMatrix, Rotation3, Vector3};
use wellposed_analysis::sphere::{AcousticTensor3, Extremes, RankOne, SphereError};

pub type Tensor = [[f64; 3]; 3];

pub fn isotropic(random: &mut Random, is_cosserat: bool) -> Isotropic {
    let mu = random.decades(0.1, 10.0);
    let microrotation = is_cosserat.then(|| {
        let gamma = random.decades(0.1, 10.0);
        Microrotation {
            alpha: random.decades(0.05, 5.0),
            inertia: random.decades(0.1, 10.0),
            couple: Some(CoupleModuli {
                beta: random.within(-0.6 * gamma, 3.0 * gamma),
                gamma,
                eta: random.decades(0.1, 10.0),
            }),
        }
    });
    Isotropic {
        lambda: mu * random.within(-0.6, 4.0),
        mu,
        density: random.decades(0.3, 3.0),
        microrotation,
    }
}

pub fn random_tensor(random: &mut Random, is_symmetric: bool) -> Tensor {
    let mut t: Tensor = std::array::from_fn(|_| std::array::from_fn(|_| random.within(-1.0, 1.0)));
    if is_symmetric {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            t[j][i] = t[i][j];
        }
    }
    t
}

pub fn random_stress(random: &mut Random, is_cosserat: bool) -> Stress {
    let force = random_tensor(random, !is_cosserat);
    let couple = if is_cosserat { random_tensor(random, false) } else { [[0.0; 3]; 3] };
    Stress { force, couple }
}

pub fn rotation(random: &mut Random) -> Tensor {
    let axis = Vector3::from_fn(|_, _| random.within(-1.0, 1.0));
    let turned = Rotation3::new(axis.normalize() * random.within(0.0, 6.0));
    std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)]))
}

pub fn turned(q: &Tensor, t: &Tensor) -> Tensor {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let mut sum = 0.0;
            for k in 0..3 {
                for l in 0..3 {
                    sum += q[i][k] * q[j][l] * t[k][l];
                }
            }
            sum
        })
    })
}

pub fn components(solid: &Isotropic) -> Vec<Component> {
    solid.layout::<3>().all_stresses().collect()
}

pub fn vector(list: &[Component], gradient: &Stress) -> Vec<f64> {
    list.iter().map(|c| c.derivative(gradient)).collect()
}

pub fn update(solid: &Isotropic, condition: &ActiveCondition) -> Result<RankOne, SphereError> {
    let list = components(solid);
    RankOne::new(
        &solid.rates::<3>(),
        &vector(&list, &condition.normal),
        &vector(&list, &condition.flow),
        condition.hardening,
    )
}

pub fn cosserat_mises(random: &mut Random) -> Mises {
    Mises {
        antisymmetric_weight: random.within(0.0, 2.0),
        symmetric_length: Some(random.decades(0.3, 3.0)),
        antisymmetric_length: Some(random.decades(0.3, 3.0)),
        ..Mises::drucker_prager(1.0, random.within(0.0, 1.5), random.within(-0.5, 1.5))
    }
}

pub fn search(sphere: &AcousticTensor3, update: &RankOne) -> Extremes {
    sphere.search(update, &mut sphere.workspace()).unwrap()
}

/// A solid whose stiffness is a random positive definite matrix.
pub fn anisotropic(random: &mut Random, is_cosserat: bool) -> RateEquations<3> {
    let mut elastic = isotropic(random, is_cosserat).rates::<3>();
    let size = elastic.stresses();
    let factor = DMatrix::from_fn(size, size, |_, _| random.within(-1.0, 1.0));
    let stiffness = &factor * factor.transpose() + DMatrix::identity(size, size);
    elastic.stiffness = stiffness.map(Rounded::exact);
    elastic
}
