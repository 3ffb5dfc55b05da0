//! Initial state of a solid simulation.

use super::geometry::{cell_centre, coordinate_difference, distance};
use super::grid_part::GridPart;
use super::pulse::IncidentPulse;
use super::ranges::WaveRange;
use super::{GridConverter, analysis_unknown_name};
use crate::Error;
use crate::case::dynamics::{InitialStateTerm, PulseCentre, RegionShape, SolidRun};
use crate::case::{Case, Material, WaveNumbers};
use crate::setup::solid::{create_elastic_law_and_set, wave_normal};
use analysis::waves::plane_waves;
use dynamics::contact_law::ContactLaw;
use dynamics::initial::normalise_velocity;
use dynamics::problem::Problem;
use models::common::elementary::{Elementary, cr_cis};
use models::rheology::relaxation::SymmetricTensor;
use models::solid::waves::SolidField;
use num_complex::Complex64;
use std::cell::Cell;

/// Initial fields of the cells of this process as sums over the terms of the initial state of the case.
struct FieldSums<'a> {
    solid_run: &'a SolidRun,
    part: &'a GridPart,
    /// Fields that at least one term sets, with their values by cell of the process in SI units.
    fields: Vec<(SolidField, Vec<f64>)>,
    /// Largest magnitude of the values of each of the fields; NaN if a value is NaN.
    max_magnitudes: Vec<f64>,
}

impl FieldSums<'_> {
    /// Adds a function `value` of position, m, to a field: evaluated at the cell centres.
    fn add_field(&mut self, field: SolidField, value: impl Fn(&[f64]) -> f64) {
        self.add_field_by_cell(field, |_, x| value(x));
    }

    /// Adds a function `value` of cell and position, m, to a field.
    fn add_field_by_cell(&mut self, field: SolidField, value: impl Fn(usize, &[f64]) -> f64) {
        let index = self.fields.iter().position(|own| own.0 == field).unwrap_or_else(|| {
            self.fields.push((field, vec![0.0; self.part.cell_count()]));
            self.max_magnitudes.push(0.0);
            self.fields.len() - 1
        });
        let mut max = 0.0f64;
        for (cell, own) in self.part.cells().zip(&mut self.fields[index].1) {
            *own += value(cell, &cell_centre(self.solid_run, cell));
            max = if own.abs() <= max || max.is_nan() { max } else { own.abs() };
        }
        self.max_magnitudes[index] = max;
    }
}

impl GridConverter<'_> {
    /// Returns the initial fields that are set, with their values by cell of this process, for the media of a problem;
    /// `range` is that of the values.
    pub(super) fn create_initial_fields<const D: usize>(
        &self,
        case: &Case,
        problem: &Problem<D>,
        range: &WaveRange,
        part: &GridPart,
    ) -> Result<Vec<(SolidField, Vec<f64>)>, Error> {
        let media = problem.media.as_slice();
        let mut sums = FieldSums {
            solid_run: self.solid_run,
            part,
            fields: Vec::new(),
            max_magnitudes: Vec::new(),
        };
        for (index, term) in self.solid_run.initial_terms.iter().enumerate() {
            match term {
                InitialStateTerm::Pulse { component: field, amplitude, centre, radius } => {
                    let axes: Vec<usize> = (0..D).collect();
                    sums.add_field(field.0, |x| {
                        let r = match centre {
                            PulseCentre::Point(at) => distance(self.solid_run, &axes, x, at),
                            PulseCentre::Plane { axis, coordinate: at } => {
                                coordinate_difference(self.solid_run, *axis, x[*axis], *at)
                            }
                        };
                        amplitude * (-(r / radius).powi(2)).cr_exp()
                    });
                }
                InitialStateTerm::Uniform { shape, component: field, amplitude } => {
                    sums.add_field(field.0, |x| if shape.contains(x) { *amplitude } else { 0.0 });
                }
                InitialStateTerm::Rotation { shape, angle_deg, axis } => {
                    self.add_rotation(&mut sums, case, problem, shape, (*angle_deg, *axis))?;
                }
                InitialStateTerm::RigidRotation { shape, center, rate, axis } => {
                    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                    let coordinate =
                        |x: &[f64], axis: usize| x.get(axis).map_or(0.0, |x| x - center[axis]);
                    let inside = |x: &[f64], value: f64| {
                        if shape.contains(x) { value } else { 0.0 }
                    };
                    for (own, other, sign) in [(i, j, -1.0), (j, i, 1.0)] {
                        sums.add_field(SolidField::Velocity(own), |x| {
                            inside(x, sign * rate * coordinate(x, other))
                        });
                    }
                    let spin = SolidField::Spin(*axis);
                    if self.first_medium.fields.contains(&spin) {
                        sums.add_field(spin, |x| inside(x, *rate));
                    }
                }
                InitialStateTerm::Loosening { shape, extension, axis } => {
                    let key = format!("initial[{index}]");
                    self.add_loosening(&mut sums, problem, shape, (*extension, *axis), &key)?;
                }
                InitialStateTerm::PlanePulse(pulse) => {
                    let key = format!("initial[{index}]");
                    let wave =
                        IncidentPulse::new(case, self.solid_run, (problem, part), pulse, &key)?;
                    for &field in &self.first_medium.fields {
                        sums.add_field_by_cell(field, |cell, x| {
                            wave.field_value(field, x, problem.medium_index(cell))
                        });
                    }
                }
                InitialStateTerm::PlaneWave {
                    branch,
                    direction_deg,
                    elevation_deg,
                    wavelength,
                    amplitude,
                } => {
                    let key = format!("initial[{index}]");
                    if media.len() > 1 {
                        let found = "a plane wave in several media";
                        let allowed = "one medium: leave the regions out";
                        return Err(self.solid_run.key_error(&key, found, allowed).into());
                    }
                    let wave = WaveNumbers {
                        wave_number: 2.0 * std::f64::consts::PI / wavelength,
                        direction_deg: *direction_deg,
                        elevation_deg: *elevation_deg,
                        max_wave_number: 0.0,
                    };
                    for (field, factor) in
                        self.compute_plane_wave_amplitudes::<D>(case, &wave, *branch, &key)?
                    {
                        let direction = wave_normal(&wave);
                        sums.add_field(field, |x| {
                            let along: f64 = x.iter().zip(direction).map(|(x, n)| x * n).sum();
                            (amplitude * factor * cr_cis(wave.wave_number * along)).re
                        });
                    }
                }
            }
            part.take_greatest(&mut sums.max_magnitudes);
            for ((field, _), max) in sums.fields.iter().zip(&sums.max_magnitudes) {
                range.check_initial_values(index, *field, *max)?;
            }
        }
        Ok(sums.fields)
    }

    /// Adds the stress of a microrotation φ (`angle_deg`) about `axis` inside `shape`, without displacement: σ_ij =
    /// −σ_ji = 2αφ with (i, j, `axis`) in cyclic order and the antisymmetric modulus α, Pa, of the medium of each cell.
    fn add_rotation<const D: usize>(
        &self,
        sums: &mut FieldSums,
        case: &Case,
        problem: &Problem<D>,
        shape: &RegionShape,
        (angle_deg, axis): (f64, usize),
    ) -> Result<(), Error> {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let compute_antisymmetric_moduli = self.compute_antisymmetric_moduli(case)?;
        for (field, sign) in [(SolidField::Stress(i, j), 1.0), (SolidField::Stress(j, i), -1.0)] {
            sums.add_field_by_cell(field, |cell, x| {
                let alpha = compute_antisymmetric_moduli[problem.medium_index(cell)];
                match shape.contains(x) {
                    true => sign * 2.0 * alpha * angle_deg.to_radians(),
                    false => 0.0,
                }
            });
        }
        Ok(())
    }

    /// Adds the excess stress C:ε of contacts that are open by the strain ε inside `shape`: an extension along an axis, or
    /// along all axes.
    fn add_loosening<const D: usize>(
        &self,
        sums: &mut FieldSums,
        problem: &Problem<D>,
        shape: &RegionShape,
        (extension, axis): (f64, Option<usize>),
        key: &str,
    ) -> Result<(), Error> {
        let strain: [f64; 3] =
            std::array::from_fn(
                |i| {
                    if axis.map_or(i < D, |own| own == i) { extension } else { 0.0 }
                },
            );
        let mut excess = Vec::new();
        for medium in &problem.media {
            let Some(ContactLaw::Granular { law, closed, .. }) = medium.contact else {
                excess.push([0.0; 3]);
                continue;
            };
            let trace: f64 = strain.iter().sum();
            let normal = strain.map(|own| closed.lambda * trace + 2.0 * closed.mu * own);
            let tensor = SymmetricTensor::<f64, 1> { normal, shear: [0.0] };
            if law.complete_step(SymmetricTensor::ZERO, tensor).stress != SymmetricTensor::ZERO {
                let found = "an extension that causes stresses, as the friction is so large";
                let allowed = "an extension along all axes, or friction ≤ √(3c²/2)";
                return Err(self.solid_run.key_error(key, found, allowed).into());
            }
            excess.push(normal);
        }
        let has_granular_cell = Cell::new(false);
        for i in 0..3 {
            let of_media: Vec<f64> = excess.iter().map(|own| own[i]).collect();
            sums.add_field_by_cell(SolidField::ExcessStress(i, i), |cell, x| {
                let value =
                    if shape.contains(x) { of_media[problem.medium_index(cell)] } else { 0.0 };
                has_granular_cell.set(has_granular_cell.get() || value != 0.0);
                value
            });
        }
        let mut is_found = [f64::from(u8::from(has_granular_cell.get()))];
        sums.part.take_greatest(&mut is_found);
        if is_found == [0.0] {
            let found = "a shape without cells of a granular medium";
            let allowed = "a shape that contains centres of such cells";
            return Err(self.solid_run.key_error(key, found, allowed).into());
        }
        Ok(())
    }

    /// Returns the antisymmetric modulus α of each medium, Pa.
    fn compute_antisymmetric_moduli(&self, case: &Case) -> Result<Vec<f64>, Error> {
        let alpha = |own: &Material| -> Result<f64, Error> {
            let (elastic, _) =
                create_elastic_law_and_set(own).map_err(|error| own.locate_error(error))?;
            Ok(elastic.antisymmetric_modulus())
        };
        match self.solid_run.materials().as_slice() {
            [] => Ok(vec![alpha(&case.material)?]),
            materials => materials.iter().map(|own| alpha(own)).collect(),
        }
    }

    /// Returns the complex amplitudes of a plane wave, normalised such that the norm |v| of the complex velocity is 1
    /// m/s and its largest component is real and positive.
    fn compute_plane_wave_amplitudes<const D: usize>(
        &self,
        case: &Case,
        wave: &WaveNumbers,
        branch: usize,
        key: &str,
    ) -> Result<Vec<(SolidField, Complex64)>, Error> {
        let own = match self.solid_run.materials().as_slice() {
            [own] => *own,
            _ => &case.material,
        };
        let (elastic, _) =
            create_elastic_law_and_set(own).map_err(|error| own.locate_error(error))?;
        let rates = elastic.rates_with_out_of_plane::<D>();
        let direction = wave_normal(wave);
        let vector = std::array::from_fn(|axis| wave.wave_number * direction[axis]);
        let waves = plane_waves(&rates, vector);
        // `waves` are sorted by descending frequency and contain no wave of zero frequency; `branch` counts from 1.
        let Some((_, amplitudes)) = branch.checked_sub(1).and_then(|i| waves.get(i)) else {
            let found = format!("found branch {branch}");
            let allowed = format!("1 to {} at this wavelength", waves.len());
            return Err(self.solid_run.key_error(&format!("{key}.branch"), found, allowed).into());
        };
        let of = |field: SolidField| {
            let name = analysis_unknown_name(field);
            rates.unknowns.iter().position(|unknown| unknown.name == name)
        };
        let found: Vec<(SolidField, Complex64)> = self
            .first_medium
            .fields
            .iter()
            .filter_map(|&field| Some((field, amplitudes[of(field)?])))
            .collect();
        let density = self.first_medium.inertia(SolidField::Velocity(0));
        normalise_velocity(found, density).ok_or_else(|| {
            let found = "a branch that moves nothing but spins";
            let allowed = "expected a wave whose velocity can have an amplitude: another branch";
            self.solid_run.key_error(&format!("{key}.branch"), found, allowed).into()
        })
    }
}
