//! Symmetric tensors as vectors of an orthonormal basis, and isotropic elastic energy.

use wellposed_models::common::number::Number;
use wellposed_models::rheology::relaxation::SymmetricTensor;

/// Components 11, 22, 33 and √2 times those of shear: the double contraction is the scalar product.
pub type Vector = [f64; 6];

pub fn to_vector<N: Number + Into<f64>, const SHEAR_COUNT: usize>(
    tensor: &SymmetricTensor<N, SHEAR_COUNT>,
) -> Vector {
    let mut vector = [0.0; 6];
    for (own, value) in vector.iter_mut().zip(tensor.normal) {
        *own = value.into();
    }
    for (own, value) in vector[3..].iter_mut().zip(tensor.shear) {
        *own = std::f64::consts::SQRT_2 * value.into();
    }
    vector
}

pub fn combine(a: Vector, factor: f64, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + factor * b[i])
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub fn trace(a: Vector) -> f64 {
    a[0] + a[1] + a[2]
}

pub fn deviator(a: Vector) -> Vector {
    combine(a, -trace(a) / 3.0, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
}

/// Isotropic elasticity by Young's modulus and Poisson's ratio.
#[derive(Clone, Copy, Debug)]
pub struct Elasticity {
    pub young_modulus: f64,
    pub poisson_ratio: f64,
}

impl Elasticity {
    pub fn new(bulk_modulus: f64, shear_modulus: f64) -> Self {
        let denominator = 3.0 * bulk_modulus + shear_modulus;
        Self {
            young_modulus: 9.0 * bulk_modulus * shear_modulus / denominator,
            poisson_ratio: (1.5 * bulk_modulus - shear_modulus) / denominator,
        }
    }

    /// Strain ((1 + ν)σ − ν tr σ δ)/E.
    pub fn strain(&self, stress: Vector) -> Vector {
        let Self { young_modulus, poisson_ratio } = *self;
        let lateral = poisson_ratio * trace(stress);
        let unit = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        std::array::from_fn(|i| {
            ((1.0 + poisson_ratio) * stress[i] - lateral * unit[i]) / young_modulus
        })
    }

    /// Stored energy ½σ:a:σ.
    pub fn energy(&self, stress: Vector) -> f64 {
        0.5 * dot(stress, self.strain(stress))
    }

    /// Norm √(σ:a:σ).
    pub fn energy_norm(&self, stress: Vector) -> f64 {
        (2.0 * self.energy(stress)).sqrt()
    }
}
