//! Energy conservation of the rate equations of a solid, and growth of its waves.
//!
//! The symmetriser diag(M, D⁻¹), with inertia M and stiffness D, makes the elastic equations symmetric hyperbolic; its
//! quadratic form is twice the energy density (Sadovskii & Sadovskaya 2019, "Elastic Cosserat continuum"). The module
//! verifies the symmetry and the definiteness from the linearised system as the analysis receives it, independent of
//! its assembly.

use crate::dense::eigenvalues;
use models::LinearisedSystem;
use models::common::elementary::{Elementary, Modulus};
use models::common::product::{product, triple_product};
use models::common::rates::RateEquations;
use models::common::system::RoundedMatrix;
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Number of sampled directions.
const DIRECTION_COUNT: usize = 40;
/// Number of sampled decades of wave numbers, both below and above the given one.
const DECADES: i32 = 2;

/// Defects of energy conservation, relative to the largest of the compared numbers, and numbers of unknowns and of zero
/// roots. Growths are NaN if the symmetriser is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyConservation {
    /// Smallest eigenvalue of the symmetriser of the elastic equations after scaling to unit diagonal: positive if the
    /// energy is positive definite.
    pub definiteness: f64,
    /// Asymmetry: maximum of ‖A − Aᵀ‖ of the symmetriser A and ‖B − Bᵀ‖ of the symmetrised equations.
    pub asymmetry: f64,
    /// Deviation ‖Q + Qᵀ‖ of the symmetrised source matrix from antisymmetry.
    pub antisymmetry_defect: f64,
    /// Largest ratio max |Re ς|/max |ς|, over the roots at a wave vector, of elastic waves at all sampled wave vectors.
    pub elastic_growth: f64,
    /// Largest ratio max |Re ς|/max |ς|, over the roots at a wave vector, of waves while the solid yields.
    pub yielding_growth: f64,
    /// Number of unknowns of the rate equations.
    pub unknown_count: usize,
    /// Number of roots that are zero at every wave number.
    pub zero_root_count: usize,
}

/// Measures energy conservation of the elastic equations from the linearised system, and growth over 40 directions and
/// two decades of wave numbers below and above `wave_number` (1/m).
pub fn measure_energy_conservation<const D: usize>(
    elastic: &RateEquations<D>,
    rates: &RateEquations<D>,
    wave_number: f64,
) -> EnergyConservation {
    let mut system = LinearisedSystem::default();
    elastic.linearise(&mut system);
    let (nv, ns) = (elastic.velocity_count(), elastic.stress_count());
    let compliance = elastic.stiffness_values().try_inverse();
    let compliance = compliance.unwrap_or_else(|| DMatrix::from_element(ns, ns, f64::NAN));
    let symmetrised = |matrix: &RoundedMatrix| {
        let mut values = matrix.map(|entry| entry.value);
        let laws = product(&compliance, &values.rows(nv, ns));
        values.rows_mut(nv, ns).copy_from(&laws);
        values
    };
    let relative = |difference: DMatrix<f64>, of: &DMatrix<f64>| match of.amax() {
        0.0 => 0.0,
        size => difference.amax() / size,
    };
    let asymmetry = |axis: usize| {
        let b = symmetrised(&system.b[axis]);
        relative(&b - b.transpose(), &b)
    };
    let q = symmetrised(&system.c);
    let symmetriser = symmetrised(&system.a);
    // Scale the symmetriser to unit diagonal.
    let scale = symmetriser.diagonal().map(|x| x.sqrt().recip());
    let scaled =
        DMatrix::from_fn(nv + ns, nv + ns, |i, j| symmetriser[(i, j)] * scale[i] * scale[j]);
    // Cholesky factor R with RᵀR the symmetriser: for the symbol S of the equations, R S R⁻¹ is skew-Hermitian if
    // energy is conserved, so its eigenvalues are accurate to rounding.
    let factor = symmetriser.clone().cholesky().map(|found| found.l().transpose());
    let growth = |rates: &RateEquations<D>| match &factor {
        Some(factor) => max_growth(rates, factor, wave_number),
        None => f64::NAN,
    };
    EnergyConservation {
        definiteness: scaled.symmetric_eigenvalues().min(),
        asymmetry: (0..D)
            .map(asymmetry)
            .fold(relative(&symmetriser - symmetriser.transpose(), &symmetriser), f64::max),
        antisymmetry_defect: relative(&q + q.transpose(), &q),
        elastic_growth: growth(elastic),
        yielding_growth: growth(rates),
        unknown_count: nv + ns,
        zero_root_count: ns - nv,
    }
}

/// Largest ratio max |Re ς|/max |ς|, over the roots at a wave vector, at all sampled wave vectors, in energy
/// coordinates given by the Cholesky factor `factor`; NaN if the factor is singular or the eigenvalues do not converge.
fn max_growth<const D: usize>(
    rates: &RateEquations<D>,
    factor: &DMatrix<f64>,
    wave_number: f64,
) -> f64 {
    let mut system = LinearisedSystem::default();
    rates.linearise(&mut system);
    let Some(inverse) = factor.clone().try_inverse() else { return f64::NAN };
    let in_units = |matrix: &RoundedMatrix| {
        // A is diagonal.
        let rows = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
            -matrix[(i, j)].value / system.a[(i, i)].value
        });
        triple_product(factor, &rows, &inverse)
    };
    let (gradient, local) = (system.b.each_ref().map(in_units), in_units(&system.c));
    let mut worst = 0.0f64;
    for index in 0..DIRECTION_COUNT {
        let normal = sample_direction::<D>(index);
        let along: DMatrix<f64> = gradient.iter().zip(normal).map(|(b, n)| b * n).sum();
        for decade in -DECADES..=DECADES {
            let k = wave_number * 10f64.powi(decade);
            let symbol = local.zip_map(&along, |c, b| Complex64::new(c, k * b));
            let Some(roots) = eigenvalues(symbol) else { return f64::NAN };
            let largest = roots.iter().map(|root| root.modulus()).fold(0.0, f64::max);
            let grows = roots.iter().map(|root| root.re.abs()).fold(0.0, f64::max);
            worst = worst.max(grows / largest);
        }
    }
    worst
}

/// Unit vector number `index` of `DIRECTION_COUNT` spread evenly over half the circle or half the sphere.
fn sample_direction<const D: usize>(index: usize) -> [f64; D] {
    let share = (index as f64 + 0.5) / DIRECTION_COUNT as f64;
    let mut normal = [0.0; D];
    if D == 2 {
        (normal[0], normal[1]) = ((PI * share).cr_cos(), (PI * share).cr_sin());
    } else {
        // Fibonacci spiral: equal areas, azimuth in steps of the golden angle.
        let angle = PI * (3.0 - 5f64.sqrt()) * index as f64;
        let radius = (1.0 - share * share).sqrt();
        (normal[0], normal[1], normal[2]) =
            (radius * angle.cr_cos(), radius * angle.cr_sin(), share);
    }
    normal
}
