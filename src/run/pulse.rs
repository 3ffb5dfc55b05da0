//! The initial state of a plane wave of finite length.

use super::setup::{cell_at, centre};
use crate::Error;
use crate::case::dynamics::{Dynamics, PlanePulse, Polarization};
use crate::case::{Case, Wave};
use crate::setup::solid::{elastic_law_and_set, normal};
use models::cosserat::parameters::Isotropic;
use models::cosserat::waves::Field;
use models::elementary::Elementary;

/// Greatest part of the amplitude that may lie in other media.
const OUTSIDE: f64 = 1e-6;

/// A pulse in its medium.
pub(super) struct Incident<'a> {
    pulse: &'a PlanePulse,
    /// Direction.
    n: [f64; 3],
    /// Polarisation.
    a: [f64; 3],
    /// Speed, m/s.
    speed: f64,
    lambda: f64,
    mu: f64,
    /// The place of its medium.
    medium: u16,
}

impl<'a> Incident<'a> {
    /// # Errors
    /// The medium has spins, whose waves change their shape, or the pulse reaches another medium.
    pub(super) fn new(
        case: &Case,
        dynamics: &Dynamics,
        of_cell: &[u16],
        pulse: &'a PlanePulse,
        key: &str,
    ) -> Result<Self, Error> {
        let medium = of_cell[cell_at(dynamics, &pulse.at)];
        let own = dynamics.regions.get(usize::from(medium)).map_or(case, |region| &region.case);
        let (elastic, _) = elastic_law_and_set(own).map_err(|error| own.locate(error))?;
        let classical = elastic.downcast::<Isotropic>().filter(|own| own.microrotation.is_none());
        let Some(solid) = classical else {
            let found = format!("a pulse in a solid of kind {}", own.kind.name());
            let allowed = "the kind classical: in others waves change their shape; give pulse \
                           or plane-wave";
            return Err(dynamics.locate(&format!("{key}.kind"), found, allowed).into());
        };
        let wave = Wave {
            number: 1.0,
            direction_deg: pulse.direction_deg,
            elevation_deg: pulse.elevation_deg,
            greatest_number: 0.0,
        };
        let n = normal(&wave);
        let (azimuth, elevation) =
            (pulse.direction_deg.to_radians(), pulse.elevation_deg.to_radians());
        let (modulus, a) = match pulse.polarization {
            Polarization::P => (solid.lambda + 2.0 * solid.mu, n),
            Polarization::S => {
                let (sin, cos) = pulse.polarization_deg.to_radians().cr_sin_cos();
                // Of growing azimuth and of growing elevation.
                let across = [-azimuth.cr_sin(), azimuth.cr_cos(), 0.0];
                let (up, out) = elevation.cr_sin_cos();
                let above = [-up * azimuth.cr_cos(), -up * azimuth.cr_sin(), out];
                (solid.mu, std::array::from_fn(|i| cos * across[i] + sin * above[i]))
            }
        };
        let speed = (modulus / solid.density).sqrt();
        let (lambda, mu) = (solid.lambda, solid.mu);
        let own = Self { pulse, n, a, speed, lambda, mu, medium };
        for (cell, _) in of_cell.iter().enumerate().filter(|other| *other.1 != medium) {
            let x = centre(dynamics, cell);
            if own.shape(&x).abs() > OUTSIDE {
                let found = format!("a pulse that reaches another medium at {x:?}");
                let allowed = "one that begins in one medium: a smaller width, or at and time \
                               farther from the others";
                return Err(dynamics.locate(key, found, allowed).into());
            }
        }
        Ok(own)
    }

    /// The value at a point of the medium over that of the greatest velocity at the time 0.
    fn shape(&self, x: &[f64]) -> f64 {
        let from: Vec<f64> = x.iter().zip(&self.pulse.at).map(|(x, at)| x - at).collect();
        let along: f64 = from.iter().zip(self.n).map(|(x, n)| x * n).sum();
        let aside =
            from.iter().zip(self.n).fold(0.0, |r: f64, (x, n)| r.root_sum_square(x - along * n));
        self.pulse.time.value(-along / self.speed) * self.pulse.across(aside)
    }

    /// The value of a field in a cell of a medium.
    pub(super) fn value(&self, field: Field, x: &[f64], medium: u16) -> f64 {
        if medium != self.medium {
            return 0.0;
        }
        let (n, a) = (&self.n, &self.a);
        let factor = match field {
            Field::Velocity(i) => a[i],
            // σ̇ = λ tr ε̇ + 2μ ε̇ with ∂ⱼvᵢ = −aᵢnⱼg′/c.
            Field::Stress(i, j) => {
                let dilation: f64 = a.iter().zip(n).map(|(a, n)| a * n).sum();
                let normal = if i == j { self.lambda * dilation } else { 0.0 };
                -(normal + self.mu * (a[i] * n[j] + a[j] * n[i])) / self.speed
            }
            Field::Spin(_) | Field::Couple(..) => return 0.0,
        };
        self.pulse.amplitude * factor * self.shape(x)
    }
}
