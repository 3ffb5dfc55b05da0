//! Random tensors, stress components and their conjugate strains.

use crate::support::RandomNumbers;
use nalgebra::Matrix3;
use wellposed_models::solid::stress::Stress;
use wellposed_models::solid::stress::StressComponent::{self, Couple, Force, Symmetric};

pub fn random_tensor(random: &mut RandomNumbers) -> Matrix3<f64> {
    Matrix3::from_fn(|_, _| random.uniform(-1.0, 1.0))
}

fn to_rows(t: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| t[(i, j)]))
}

pub fn component_value(
    component: StressComponent,
    force: &Matrix3<f64>,
    couple: &Matrix3<f64>,
) -> f64 {
    component.value_in(&Stress { force: to_rows(force), couple: to_rows(couple) })
}

/// Component of strain or curvature (or of their rates) that is work-conjugate to a stress component: twice the tensor
/// component of the symmetric strain for a shear stress of a classical solid.
pub fn conjugate_strain(
    component: StressComponent,
    strain: &Matrix3<f64>,
    curvature: &Matrix3<f64>,
) -> f64 {
    match component {
        Force(i, j) => strain[(i, j)],
        Symmetric(i, j) if i == j => strain[(i, i)],
        Symmetric(i, j) => strain[(i, j)] + strain[(j, i)],
        Couple(k, j) => curvature[(k, j)],
    }
}
