//! What solids begin with: weight in equilibrium, plane waves and plane pulses.

use crate::solid::medium::Medium;
use models::common::elementary::Elementary;
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::solid::waves::Field;
use num_complex::Complex64;

/// Two densities in one layer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("densities {:?} and {:?} in one layer", densities[0], densities[1])]
pub struct UnevenLayer {
    /// The first cell whose density is not that of its layer.
    pub cell: usize,
    /// The density of the layer and that of the cell, kg/m³.
    pub densities: [f64; 2],
}

/// Densities of the layers of a grid across an axis, kg/m³; `of_cell` are the media, the first axis running fastest.
///
/// # Errors
/// A layer has several.
pub fn layer_densities(
    cells: &[usize],
    axis: usize,
    media: &[Medium],
    of_cell: &[u16],
) -> Result<Vec<f64>, UnevenLayer> {
    let stride: usize = cells[..axis].iter().product();
    let mut densities = vec![f64::NAN; cells[axis]];
    for (cell, &medium) in of_cell.iter().enumerate() {
        let density = media[usize::from(medium)].inertia(Field::Velocity(axis));
        let own = &mut densities[cell / stride % cells[axis]];
        if own.is_nan() {
            *own = density;
        } else if *own != density {
            return Err(UnevenLayer { cell, densities: [*own, density] });
        }
    }
    Ok(densities)
}

/// Adds the stress that balances weight to that of the layers across an axis: ∂σ + ρg = 0 from the side against which
/// the weight acts, where σ = 0. `densities` (kg/m³) are those of the layers, `spacing` (m) their thickness,
/// `acceleration` (m/s²) is along the axis; across it normal stresses are `lateral_ratio` times those along it.
pub fn add_lithostatic(
    layers: &mut [Stress],
    axis: usize,
    densities: &[f64],
    spacing: f64,
    acceleration: f64,
    lateral_ratio: f64,
) {
    let mut above = 0.0;
    let from_upper = acceleration < 0.0;
    for step in 0..densities.len() {
        let index = if from_upper { densities.len() - 1 - step } else { step };
        let weight = densities[index] * acceleration.abs() * spacing;
        let normal = -(above + 0.5 * weight);
        above += weight;
        for i in 0..3 {
            let share = if i == axis { 1.0 } else { lateral_ratio };
            layers[index].force[i][i] += share * normal;
        }
    }
}

/// Amplitudes of a plane wave in units of the greatest velocity: |v| with the phase of its greatest component is 1.
/// They are given in units of energy, of which the wave has one; `None` where it moves nothing but spins.
pub fn with_unit_velocity(
    amplitudes: Vec<(Field, Complex64)>,
    density: f64,
) -> Option<Vec<(Field, Complex64)>> {
    let velocities = || amplitudes.iter().filter(|(f, _)| matches!(f, Field::Velocity(_)));
    let speed = velocities().map(|own| own.1.norm_sqr()).sum::<f64>().sqrt();
    let greatest = velocities()
        .map(|(_, amplitude)| *amplitude)
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .filter(|_| density.sqrt() * speed > 1e-6)
        .map(|amplitude| amplitude.unscale(amplitude.norm()).scale(speed))?;
    Some(amplitudes.into_iter().map(|(field, amplitude)| (field, amplitude / greatest)).collect())
}

/// A plane wave that keeps its shape: d'Alembert's solution in a classical isotropic solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanePulse {
    /// Direction.
    n: [f64; 3],
    /// Polarisation.
    a: [f64; 3],
    /// Speed, m/s.
    speed: f64,
    lambda: f64,
    mu: f64,
}

impl PlanePulse {
    /// A longitudinal wave in the direction `n`.
    pub fn longitudinal(solid: &Isotropic, n: [f64; 3]) -> Self {
        Self::new(solid, solid.lambda + 2.0 * solid.mu, n, n)
    }

    /// A transverse wave in the direction `n`, of that azimuth and elevation, rad. It is polarised in the direction of
    /// growing azimuth, turned by `angle`, rad, into that of growing elevation.
    pub fn transverse(
        solid: &Isotropic,
        n: [f64; 3],
        azimuth: f64,
        elevation: f64,
        angle: f64,
    ) -> Self {
        let (sin, cos) = angle.cr_sin_cos();
        let across = [-azimuth.cr_sin(), azimuth.cr_cos(), 0.0];
        let (up, out) = elevation.cr_sin_cos();
        let above = [-up * azimuth.cr_cos(), -up * azimuth.cr_sin(), out];
        let a = std::array::from_fn(|i| cos * across[i] + sin * above[i]);
        Self::new(solid, solid.mu, n, a)
    }

    fn new(solid: &Isotropic, modulus: f64, n: [f64; 3], a: [f64; 3]) -> Self {
        let speed = (modulus / solid.density).sqrt();
        Self { n, a, speed, lambda: solid.lambda, mu: solid.mu }
    }

    /// Speed, m/s.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Distances of a place, m, from the point where the pulse is at the time 0: along its direction and across it.
    pub fn distances(&self, from: &[f64]) -> [f64; 2] {
        let along: f64 = from.iter().zip(self.n).map(|(x, n)| x * n).sum();
        let aside =
            from.iter().zip(self.n).fold(0.0, |r: f64, (x, n)| r.root_sum_square(x - along * n));
        [along, aside]
    }

    /// The value of a field where the velocity is 1 m/s; `None` for those that classical solids do not have.
    pub fn factor(&self, field: Field) -> Option<f64> {
        let (n, a) = (&self.n, &self.a);
        match field {
            Field::Velocity(i) => Some(a[i]),
            // σ̇ = λ tr ε̇ + 2μ ε̇ with ∂ⱼvᵢ = −aᵢnⱼg′/c.
            Field::Stress(i, j) => {
                let dilation: f64 = a.iter().zip(n).map(|(a, n)| a * n).sum();
                let normal = if i == j { self.lambda * dilation } else { 0.0 };
                Some(-(normal + self.mu * (a[i] * n[j] + a[j] * n[i])) / self.speed)
            }
            Field::Spin(_) | Field::Couple(..) | Field::ViscousStrain(..) => None,
        }
    }
}
