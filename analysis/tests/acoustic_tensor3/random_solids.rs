//! Random solids, yield sets and stresses, and the search over all directions.

use crate::support::states::RandomNumbers;
use models::common::rates::RateEquations;
use models::common::rounding::Rounded;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::{Stress, StressComponent};
use models::yield_set::parameters::{ActiveCondition, Mises};
use nalgebra::{DMatrix, Rotation3, Vector3};
use wellposed_analysis::acoustic_tensor3::{
    AcousticTensor3, NormalSearchError, RankOneUpdate, WaveExtremes,
};

pub type Tensor = [[f64; 3]; 3];

pub fn random_isotropic(random: &mut RandomNumbers, is_cosserat: bool) -> Isotropic {
    let mu = random.log_uniform(0.1, 10.0);
    let microrotation = is_cosserat.then(|| {
        let gamma = random.log_uniform(0.1, 10.0);
        Microrotation {
            alpha: random.log_uniform(0.05, 5.0),
            inertia: random.log_uniform(0.1, 10.0),
            couple: Some(CoupleModuli {
                beta: random.uniform(-0.6 * gamma, 3.0 * gamma),
                gamma,
                eta: random.log_uniform(0.1, 10.0),
            }),
        }
    });
    Isotropic {
        lambda: mu * random.uniform(-0.6, 4.0),
        mu,
        density: random.log_uniform(0.3, 3.0),
        microrotation,
    }
}

pub fn random_tensor(random: &mut RandomNumbers, is_symmetric: bool) -> Tensor {
    let mut t: Tensor = std::array::from_fn(|_| std::array::from_fn(|_| random.uniform(-1.0, 1.0)));
    if is_symmetric {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            t[j][i] = t[i][j];
        }
    }
    t
}

pub fn random_stress(random: &mut RandomNumbers, is_cosserat: bool) -> Stress {
    let force = random_tensor(random, !is_cosserat);
    let couple = if is_cosserat { random_tensor(random, false) } else { [[0.0; 3]; 3] };
    Stress { force, couple }
}

pub fn random_rotation(random: &mut RandomNumbers) -> Tensor {
    let axis = Vector3::from_fn(|_, _| random.uniform(-1.0, 1.0));
    let turned = Rotation3::new(axis.normalize() * random.uniform(0.0, 6.0));
    std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)]))
}

pub fn rotate_tensor(q: &Tensor, t: &Tensor) -> Tensor {
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

pub fn stress_components(solid: &Isotropic) -> Vec<StressComponent> {
    solid.layout::<3>().all_stresses().collect()
}

pub fn gradient_components(list: &[StressComponent], gradient: &Stress) -> Vec<f64> {
    list.iter().map(|c| c.derivative(gradient)).collect()
}

pub fn rank_one_update(
    solid: &Isotropic,
    condition: &ActiveCondition,
) -> Result<RankOneUpdate, NormalSearchError> {
    let list = stress_components(solid);
    RankOneUpdate::new(
        &solid.rates::<3>(),
        &gradient_components(&list, &condition.normal),
        &gradient_components(&list, &condition.flow_direction),
        condition.hardening,
    )
}

pub fn random_cosserat_mises(random: &mut RandomNumbers) -> Mises {
    Mises {
        antisymmetric_weight: random.uniform(0.0, 2.0),
        symmetric_internal_length: Some(random.log_uniform(0.3, 3.0)),
        antisymmetric_internal_length: Some(random.log_uniform(0.3, 3.0)),
        ..Mises::new_drucker_prager(1.0, random.uniform(0.0, 1.5), random.uniform(-0.5, 1.5))
    }
}

pub fn search_extremes(tensor: &AcousticTensor3, update: &RankOneUpdate) -> WaveExtremes {
    tensor.search_extremes(update, &mut tensor.new_workspace()).unwrap()
}

/// A solid whose stiffness is a random positive definite matrix.
pub fn random_anisotropic(random: &mut RandomNumbers, is_cosserat: bool) -> RateEquations<3> {
    let mut elastic = random_isotropic(random, is_cosserat).rates::<3>();
    let size = elastic.stress_count();
    let factor = DMatrix::from_fn(size, size, |_, _| random.uniform(-1.0, 1.0));
    let stiffness = &factor * factor.transpose() + DMatrix::identity(size, size);
    elastic.stiffness = stiffness.map(Rounded::from_exact);
    elastic
}
