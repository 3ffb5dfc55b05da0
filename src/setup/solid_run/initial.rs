//! Initial state of a solid simulation.

use super::geometry::{along, centre, distance};
use super::pulse::Incident;
use super::{Place, unknown_name};
use crate::Error;
use crate::case::dynamics::{Centre, Dynamics, Initial, Shape};
use crate::case::{Case, Material, Wave};
use crate::setup::solid::{elastic_law_and_set, normal};
use analysis::waves::plane_waves;
use dynamics::initial::with_unit_velocity;
use models::common::elementary::{Elementary, cr_cis};
use models::solid::waves::Field;
use num_complex::Complex64;

/// Accumulated parts of the initial state.
struct Sums<'a> {
    dynamics: &'a Dynamics,
    /// Values by cell of the fields set by any part.
    all: Vec<(Field, Vec<f64>)>,
}

impl Sums<'_> {
    /// Adds `value` at the cell centres, in order of the cells.
    fn add(&mut self, field: Field, mut value: impl FnMut(&[f64]) -> f64) {
        let place = self.all.iter().position(|own| own.0 == field).unwrap_or_else(|| {
            self.all.push((field, vec![0.0; self.dynamics.grid.count()]));
            self.all.len() - 1
        });
        for (cell, own) in self.all[place].1.iter_mut().enumerate() {
            *own += value(&centre(self.dynamics, cell));
        }
    }
}

impl Place<'_> {
    /// Returns the initial values of all fields that are set, by cell.
    pub(super) fn initial<const D: usize>(
        &self,
        case: &Case,
        media: usize,
    ) -> Result<Vec<(Field, Vec<f64>)>, Error> {
        let mut sums = Sums { dynamics: self.dynamics, all: Vec::new() };
        for (index, part) in self.dynamics.initial.iter().enumerate() {
            match part {
                Initial::Pulse { field, amplitude, centre, radius } => {
                    let axes: Vec<usize> = (0..D).collect();
                    sums.add(field.0, |x| {
                        let r = match centre {
                            Centre::Point(at) => distance(self.dynamics, &axes, x, at),
                            Centre::Plane { axis, at } => {
                                along(self.dynamics, *axis, x[*axis], *at)
                            }
                        };
                        amplitude * (-(r / radius).powi(2)).cr_exp()
                    });
                }
                Initial::Uniform { shape, field, amplitude } => {
                    sums.add(field.0, |x| if shape.contains(x) { *amplitude } else { 0.0 });
                }
                Initial::Rotation { shape, angle_deg, axis } => {
                    self.add_rotation(&mut sums, case, shape, *angle_deg, *axis)?;
                }
                Initial::PlanePulse(pulse) => {
                    let of_cell = self.dynamics.media_of_cells()?;
                    let key = format!("initial[{index}]");
                    let wave = Incident::new(case, self.dynamics, &of_cell, pulse, &key)?;
                    for &field in &self.medium.fields {
                        let mut media = of_cell.iter();
                        sums.add(field, |x| {
                            media.next().map_or(0.0, |medium| wave.value(field, x, *medium))
                        });
                    }
                }
                Initial::PlaneWave {
                    branch,
                    direction_deg,
                    elevation_deg,
                    wavelength,
                    amplitude,
                } => {
                    let key = format!("initial[{index}]");
                    if media > 1 {
                        let found = "a plane wave in several media";
                        let allowed = "one medium: leave the regions out";
                        return Err(self.dynamics.locate(&key, found, allowed).into());
                    }
                    let wave = Wave {
                        number: 2.0 * std::f64::consts::PI / wavelength,
                        direction_deg: *direction_deg,
                        elevation_deg: *elevation_deg,
                        greatest_number: 0.0,
                    };
                    for (field, factor) in self.plane_wave::<D>(case, &wave, *branch, &key)? {
                        let direction = normal(&wave);
                        sums.add(field, |x| {
                            let along: f64 = x.iter().zip(direction).map(|(x, n)| x * n).sum();
                            (amplitude * factor * cr_cis(wave.number * along)).re
                        });
                    }
                }
            }
        }
        Ok(sums.all)
    }

    /// Adds the stress of a rotation φ without displacement: Λ = −φ×, σ_ij = −σ_ji = 2αφ with α of each medium.
    fn add_rotation(
        &self,
        sums: &mut Sums,
        case: &Case,
        shape: &Shape,
        angle_deg: f64,
        axis: usize,
    ) -> Result<(), Error> {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let antisymmetric_moduli = self.antisymmetric_moduli(case)?;
        let of_cell = self.dynamics.media_of_cells()?;
        for (field, sign) in [(Field::Stress(i, j), 1.0), (Field::Stress(j, i), -1.0)] {
            let mut cell = 0;
            sums.add(field, |x| {
                let alpha = antisymmetric_moduli[usize::from(of_cell[cell])];
                cell += 1;
                match shape.contains(x) {
                    true => sign * 2.0 * alpha * angle_deg.to_radians(),
                    false => 0.0,
                }
            });
        }
        Ok(())
    }

    /// Returns the antisymmetric modulus α of each medium, Pa.
    fn antisymmetric_moduli(&self, case: &Case) -> Result<Vec<f64>, Error> {
        let alpha = |own: &Material| -> Result<f64, Error> {
            let (elastic, _) = elastic_law_and_set(own).map_err(|error| own.locate(error))?;
            Ok(elastic.antisymmetric_modulus())
        };
        match self.dynamics.regions.as_slice() {
            [] => Ok(vec![alpha(&case.material)?]),
            regions => regions.iter().map(|region| alpha(&region.material)).collect(),
        }
    }

    /// Returns the complex amplitudes of a plane wave, normalised to a greatest velocity of 1.
    fn plane_wave<const D: usize>(
        &self,
        case: &Case,
        wave: &Wave,
        branch: usize,
        key: &str,
    ) -> Result<Vec<(Field, Complex64)>, Error> {
        let own = match self.dynamics.regions.as_slice() {
            [region] => &region.material,
            _ => &case.material,
        };
        let (elastic, _) = elastic_law_and_set(own).map_err(|error| own.locate(error))?;
        let rates = elastic.carried_rates::<D>();
        let direction = normal(wave);
        let vector = std::array::from_fn(|axis| wave.number * direction[axis]);
        let waves = plane_waves(&rates, vector);
        // Waves by descending frequency, without those of zero frequency.
        let Some((_, amplitudes)) = branch.checked_sub(1).and_then(|i| waves.get(i)) else {
            let found = format!("found branch {branch}");
            let allowed = format!("1 to {} at this wavelength", waves.len());
            return Err(self.dynamics.locate(&format!("{key}.branch"), found, allowed).into());
        };
        let of = |field: Field| {
            let name = unknown_name(field);
            rates.unknowns.iter().position(|unknown| unknown.name == name)
        };
        let found: Vec<(Field, Complex64)> = self
            .medium
            .fields
            .iter()
            .filter_map(|&field| Some((field, amplitudes[of(field)?])))
            .collect();
        let density = self.medium.inertia(Field::Velocity(0));
        with_unit_velocity(found, density).ok_or_else(|| {
            let found = "a branch that moves nothing but spins";
            let allowed = "a wave whose velocity can have an amplitude: another branch";
            self.dynamics.locate(&format!("{key}.branch"), found, allowed).into()
        })
    }
}
