//! Random tensors, stress components and their conjugate strains.

use crate::support::Random;
use nalgebra::Matrix3;
use wellposed_models::solid::stress::Component::{self, Couple, Force, Symmetric};
use wellposed_models::solid::stress::Stress;

pub fn tensor(random: &mut Random) -> Matrix3<f64> {
    Matrix3::from_fn(|_, _| random.within(-1.0, 1.0))
}

fn rows(t: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| t[(i, j)]))
}

pub fn of(component: Component, force: &Matrix3<f64>, couple: &Matrix3<f64>) -> f64 {
    component.value_in(&Stress { force: rows(force), couple: rows(couple) })
}

/// Strain rate that is work-conjugate to a stress component: twice the symmetric tensor component for shear stresses of
/// classical solids.
pub fn conjugate(component: Component, strain: &Matrix3<f64>, bend: &Matrix3<f64>) -> f64 {
    match component {
        Force(i, j) => strain[(i, j)],
        Symmetric(i, j) if i == j => strain[(i, i)],
        Symmetric(i, j) => strain[(i, j)] + strain[(j, i)],
        Couple(k, j) => bend[(k, j)],
    }
}
