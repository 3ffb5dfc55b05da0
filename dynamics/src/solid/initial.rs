//! Initial states: lithostatic stress, plane waves and plane pulses.

use crate::solid::medium::Medium;
use models::common::elementary::{Elementary, Modulus};
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use num_complex::Complex64;

/// Error: a layer has several densities.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("densities {:?} and {:?} in one layer", densities[0], densities[1])]
pub struct NonUniformLayer {
    /// First cell whose density differs from that of its layer.
    pub cell: usize,
    /// Densities of the layer and of the cell, kg/m³.
    pub densities: [f64; 2],
}

/// Returns the density of each layer normal to an axis, kg/m³; `cell_media`: index of the medium of each cell (first axis
/// fastest).
///
/// # Errors
/// A layer has several densities.
pub fn layer_densities(
    cells: &[usize],
    axis: usize,
    media: &[Medium],
    cell_media: impl Iterator<Item = usize>,
) -> Result<Vec<f64>, NonUniformLayer> {
    let stride: usize = cells[..axis].iter().product();
    let mut densities = vec![f64::NAN; cells[axis]];
    for (cell, medium) in cell_media.enumerate() {
        let density = media[medium].inertia(SolidField::Velocity(axis));
        let layer_density = &mut densities[cell / stride % cells[axis]];
        if layer_density.is_nan() {
            *layer_density = density;
        } else if *layer_density != density {
            return Err(NonUniformLayer { cell, densities: [*layer_density, density] });
        }
    }
    Ok(densities)
}

/// Adds the lithostatic stress to the layers normal to an axis: ∂σ + ρg = 0, with σ = 0 at the boundary that the
/// acceleration g = `acceleration`, m/s² along the axis, points away from. `densities`, kg/m³, and `spacing`
/// (thickness, m) are those of the layers. Normal stresses along the other axes are `lateral_ratio` times that along
/// this axis.
pub fn add_lithostatic_stress(
    layers: &mut [Stress],
    axis: usize,
    densities: &[f64],
    spacing: f64,
    acceleration: f64,
    lateral_ratio: f64,
) {
    let mut weight_above = 0.0;
    let from_upper = acceleration < 0.0;
    for step in 0..densities.len() {
        let index = if from_upper { densities.len() - 1 - step } else { step };
        let weight = densities[index] * acceleration.abs() * spacing;
        let normal = -(weight_above + 0.5 * weight);
        weight_above += weight;
        for i in 0..3 {
            let share = if i == axis { 1.0 } else { lateral_ratio };
            layers[index].force[i][i] += share * normal;
        }
    }
}

/// Normalises the amplitudes of a plane wave of unit energy such that the norm |v| of the complex velocity is 1 m/s and
/// the largest velocity component is real and positive. `None` if only spins move. `density`, kg/m³.
pub fn normalise_velocity(
    amplitudes: Vec<(SolidField, Complex64)>,
    density: f64,
) -> Option<Vec<(SolidField, Complex64)>> {
    let velocities = || amplitudes.iter().filter(|(f, _)| matches!(f, SolidField::Velocity(_)));
    let speed = velocities().map(|own| own.1.norm_sqr()).sum::<f64>().sqrt();
    let max_amplitude = velocities()
        .map(|(_, amplitude)| *amplitude)
        .max_by(|a, b| a.modulus().total_cmp(&b.modulus()))
        .filter(|_| density.sqrt() * speed > 1e-6)
        .map(|amplitude| amplitude.unscale(amplitude.modulus()).scale(speed))?;
    Some(
        amplitudes
            .into_iter()
            .map(|(field, amplitude)| (field, amplitude / max_amplitude))
            .collect(),
    )
}

/// Plane pulse of constant shape: d'Alembert's solution in a classical isotropic solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanePulse {
    /// Direction of propagation, a unit vector.
    n: [f64; 3],
    /// Polarisation, a unit vector.
    a: [f64; 3],
    /// Speed, m/s.
    speed: f64,
    lambda: f64,
    mu: f64,
}

impl PlanePulse {
    /// Creates a longitudinal wave in the direction `n`.
    pub fn new_longitudinal(solid: &Isotropic, n: [f64; 3]) -> Self {
        Self::new(solid, solid.lambda + 2.0 * solid.mu, n, n)
    }

    /// Creates a transverse wave in the direction `n` of the given azimuth and elevation, rad. The polarisation is the
    /// direction of increasing azimuth, rotated by `angle`, rad, towards increasing elevation.
    pub fn new_transverse(
        solid: &Isotropic,
        n: [f64; 3],
        azimuth: f64,
        elevation: f64,
        angle: f64,
    ) -> Self {
        let (sin, cos) = angle.cr_sin_cos();
        let across = [-azimuth.cr_sin(), azimuth.cr_cos(), 0.0];
        let (up, out) = elevation.cr_sin_cos();
        let weight_above = [-up * azimuth.cr_cos(), -up * azimuth.cr_sin(), out];
        let a = std::array::from_fn(|i| cos * across[i] + sin * weight_above[i]);
        Self::new(solid, solid.mu, n, a)
    }

    fn new(solid: &Isotropic, modulus: f64, n: [f64; 3], a: [f64; 3]) -> Self {
        let speed = (modulus / solid.density).sqrt();
        Self { n, a, speed, lambda: solid.lambda, mu: solid.mu }
    }

    /// Returns the wave speed, m/s.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Computes two distances, m, from the vector `from`, m, that leads from the pulse centre at time 0 to a position:
    /// the signed distance along the direction of propagation, and the distance normal to it.
    pub fn distances(&self, from: &[f64]) -> [f64; 2] {
        let along: f64 = from.iter().zip(self.n).map(|(x, n)| x * n).sum();
        let transverse_distance =
            from.iter().zip(self.n).fold(0.0, |r: f64, (x, n)| r.root_sum_square(x - along * n));
        [along, transverse_distance]
    }

    /// Returns the value of a field, in its SI unit, per 1 m/s of particle velocity along the polarisation; `None` for
    /// fields that classical solids do not have.
    pub fn field_per_velocity(&self, field: SolidField) -> Option<f64> {
        let (n, a) = (&self.n, &self.a);
        match field {
            SolidField::Velocity(i) => Some(a[i]),
            // σ̇ = λ tr ε̇ I + 2μ ε̇ with ∂ⱼvᵢ = −aᵢnⱼg′/c for the velocity v = a g(t − n·x/c).
            SolidField::Stress(i, j) => {
                let dilation: f64 = a.iter().zip(n).map(|(a, n)| a * n).sum();
                let normal = if i == j { self.lambda * dilation } else { 0.0 };
                Some(-(normal + self.mu * (a[i] * n[j] + a[j] * n[i])) / self.speed)
            }
            _ => None,
        }
    }
}
