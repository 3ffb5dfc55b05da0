//! Cell laws of a step, applied between its sweeps.

use super::Reference;
use crate::solid::cell_laws::{
    LawInterval, MAX_FIELDS, RelaxedFields, SpinStressRotation, accelerate, add_scaled,
    apply_source, find_relaxed_fields, flush_limit, integrate_signal, map_scaled_stress, relax,
    relaxation_coefficients, rotate_spin_stress, rotated_fields, spin_stress_rotation,
    stress_from_fields,
};
use crate::solid::domain::{CellMapping, SolverReal};
use crate::solid::medium::{Medium, stress_component};
use crate::solid::metric::{CurvatureRotation, rotate_pair_by_curvature};
use crate::solid::problem::Problem;
use models::rheology::relaxation::Relaxation;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;

/// Constants of the laws that act in cells between sweeps.
#[derive(Clone)]
pub(super) struct CellLaws<T: SolverReal> {
    /// Spin–stress rotation coefficients by medium, over a whole and over half a step.
    spin_rotations: Vec<[SpinStressRotation<T>; 2]>,
    /// Field indices that rotate together: each spin and its two stresses.
    rotated_fields: Vec<[usize; 3]>,
    /// Rotation planes of the curvature of rows, by medium; empty lists if rows are straight.
    curvature_planes: Vec<Vec<LayeredPlane<T>>>,
    /// Relaxation; `None` if nothing relaxes.
    relaxations: Option<MediumRelaxations<T>>,
    /// Return mapping by the vectorised kernel of the fused solver, which rounds differently from the scalar
    /// projection; `None` if the results of the fused solver equal those of the scalar projection.
    lane_return_mapping: Option<CellMapping<T>>,
}

/// A rotation plane of the curvature, and its coefficients by layer over a whole and over half a step.
type LayeredPlane<T> = (CurvatureRotation, Vec<[[T; 4]; 2]>);

/// Constants of the stress relaxation of all media.
#[derive(Clone)]
struct MediumRelaxations<T> {
    fields: RelaxedFields,
    /// Coefficients by medium, over a whole and over half a step.
    medium_coefficients: Vec<[Relaxation<T>; 2]>,
}

impl<T: SolverReal> CellLaws<T> {
    /// Creates the constants for a problem with these fields.
    pub(super) fn new<const D: usize>(problem: &Problem<D>, fields: &[SolidField]) -> Self {
        let Problem { media, step, .. } = problem;
        let rotations = media.iter().map(|medium| {
            LawInterval::evaluate_both(|step_fraction| {
                spin_stress_rotation(medium, step_fraction, *step).map(T::from_f64)
            })
        });
        let relaxations = find_relaxed_fields(fields).map(|fields| MediumRelaxations {
            fields,
            medium_coefficients: media
                .iter()
                .map(|medium| {
                    LawInterval::evaluate_both(|step_fraction| {
                        relaxation_coefficients(
                            |coefficient| T::from_f64(coefficient(medium)),
                            step_fraction,
                            *step,
                        )
                    })
                })
                .collect(),
        });
        let curvature = problem.metric.as_ref().map_or(&[][..], |metric| &metric.curvature);
        let plane = |plane: CurvatureRotation| {
            let layer_coefficients = |curvature: &f64| {
                LawInterval::evaluate_both(|step_fraction| {
                    plane.coefficients(*curvature, step_fraction * step).map(T::from_f64)
                })
            };
            let by_layer = curvature.iter().map(layer_coefficients).collect();
            (plane, by_layer)
        };
        let planes = match curvature {
            [] => Vec::new(),
            _ => CurvatureRotation::from_media(media),
        };
        let layered = |own: Vec<CurvatureRotation>| own.into_iter().map(plane).collect();
        Self {
            curvature_planes: planes.into_iter().map(layered).collect(),
            spin_rotations: rotations.collect(),
            rotated_fields: rotated_fields(fields),
            relaxations,
            lane_return_mapping: CellMapping::new(problem),
        }
    }
}

impl<T: SolverReal> CellLaws<T> {
    /// Whether spins rotate or stresses relax in any medium.
    pub(super) fn has_rotation_or_relaxation(&self) -> bool {
        !self.rotated_fields.is_empty() || self.relaxations.is_some()
    }
}

impl<T: SolverReal, const D: usize> Reference<T, D> {
    pub(super) fn medium(&self, cell: usize) -> &Medium {
        &self.problem.media[usize::from(self.problem.cell_media[cell])]
    }

    /// Returns the ratio of the fields of a cell to the physical fields.
    pub(super) fn field_factor(&self, cell: usize) -> f64 {
        self.problem.field_factor_of_cell(cell)
    }

    /// Returns the values of all fields of a cell.
    pub(super) fn cell_state(&self, cell: usize) -> [T; MAX_FIELDS] {
        let mut state = [T::ZERO; MAX_FIELDS];
        for (value, field) in state.iter_mut().zip(&self.fields) {
            *value = field[cell];
        }
        state
    }

    /// Returns the initial stress in a cell, if any.
    pub(super) fn initial_stress(&self, cell: usize) -> Option<Stress> {
        let (axis, layers) = self.problem.initial_stress.as_ref()?;
        let stride: usize = self.problem.grid.cells[..*axis].iter().product();
        Some(layers[cell / stride % layers.len()])
    }

    /// Returns the total stress in a cell, given by its permuted index.
    pub(super) fn permuted_total_stress(&self, cell: usize) -> Stress {
        let deviation = stress_from_fields(self.fields(), &self.cell_state(cell));
        add_scaled(&deviation, &self.initial_stress(cell).unwrap_or_default(), 1.0)
    }

    /// Integrates the signals of all sources over an interval, s.
    pub(super) fn integrate_signals(&self, interval: [f64; 2]) -> Vec<[f64; 2]> {
        self.problem.sources.iter().map(|own| integrate_signal(&own.signal, interval)).collect()
    }

    /// Operator K: applies sources, with their integrated signals, and gravity over half a step.
    pub(super) fn apply_sources(&mut self, signals: &[[f64; 2]]) {
        for (source, signal) in signals.iter().enumerate() {
            for index in 0..self.problem.sources[source].cells.len() {
                let (cell, share) = self.problem.sources[source].cells[index];
                self.apply_source(source, (cell, share), *signal);
            }
        }
        self.apply_gravity();
    }

    fn apply_source(&mut self, source: usize, (cell, share): (usize, f64), signal: [f64; 2]) {
        let volume = self.problem.grid.volume();
        for index in 0..self.problem.sources[source].amplitudes.len() {
            let (field, amplitude) = self.problem.sources[source].amplitudes[index];
            let Some(field) = self.field_index(field) else { continue };
            let (mut state, strength) = (self.cell_state(cell), amplitude * share);
            let work = apply_source(self.medium(cell), &mut state, field, strength, signal, volume);
            self.fields[field][cell] = state[field];
            self.work.source_work.add(work);
        }
    }

    fn apply_gravity(&mut self) {
        for (axis, acceleration) in self.problem.acceleration.into_iter().enumerate() {
            let field = SolidField::Velocity(axis);
            let Some(index) = self.field_index(field).filter(|_| acceleration != 0.0) else {
                continue;
            };
            let change = acceleration * 0.5 * self.problem.step;
            for cell in 0..self.problem.grid.count() {
                let inertia = self.medium(cell).inertia(field);
                let work = inertia * accelerate(&mut self.fields[index][cell], change);
                self.work.source_work.add(work);
            }
        }
    }

    /// Operator Q: rotates spins and antisymmetric stresses over `interval`.
    pub(super) fn rotate_spins(&mut self, interval: LawInterval) {
        for &indices in &self.cell_laws.rotated_fields {
            for (cell, medium) in self.problem.cell_media.iter().enumerate() {
                let constants =
                    self.cell_laws.spin_rotations[usize::from(*medium)][interval as usize];
                let before = indices.map(|index| self.fields[index][cell]);
                for (index, value) in indices.into_iter().zip(rotate_spin_stress(constants, before))
                {
                    self.fields[index][cell] = value;
                }
            }
        }
    }

    /// Rotates the state by the curvature of rows over `interval`, and completes the strain increment in media with
    /// contacts.
    pub(super) fn rotate_by_curvature(&mut self, interval: LawInterval) {
        let length = self.problem.grid.cells[0];
        for (cell, medium) in self.problem.cell_media.iter().enumerate() {
            let planes = self.cell_laws.curvature_planes.get(usize::from(*medium));
            for (plane, by_layer) in planes.into_iter().flatten() {
                let weights = plane.weights.iter();
                let y = weights.fold(T::ZERO, |y, &(index, weight)| {
                    y + T::from_f64(weight) * self.fields[index][cell]
                });
                let v = self.fields[plane.velocity][cell];
                let [v, strain] =
                    rotate_pair_by_curvature(by_layer[cell / length][interval as usize], v, y);
                self.fields[plane.velocity][cell] = v;
                for &(index, modulus) in &plane.moduli {
                    let stress = &mut self.fields[index][cell];
                    *stress = *stress - T::from_f64(modulus) * strain;
                }
            }
        }
        if self.problem.metric.as_ref().is_some_and(|metric| !metric.curvature.is_empty()) {
            self.apply_contact_laws();
        }
    }

    /// Relaxes stresses over `interval`.
    pub(super) fn relax(&mut self, interval: LawInterval) {
        let Some(relaxations) = self.cell_laws.relaxations.take() else { return };
        let (normal, shear) = &relaxations.fields;
        for cell in 0..self.problem.grid.count() {
            if self.medium(cell).relaxation.is_none() {
                continue;
            }
            let medium = usize::from(self.problem.cell_media[cell]);
            let constants = &relaxations.medium_coefficients[medium][interval as usize];
            let energy_loss = match shear.as_slice() {
                [first] => self.relax_cell(cell, constants, normal, &[*first]),
                [first, second, third] => {
                    self.relax_cell(cell, constants, normal, &[*first, *second, *third])
                }
                _ => T::ZERO,
            };
            self.dissipation.viscous_dissipation[cell] += energy_loss.to_f64();
        }
        self.cell_laws.relaxations = Some(relaxations);
    }

    /// Relaxes the stresses of a cell; returns the energy dissipated, J/m³.
    fn relax_cell<const SHEAR_COUNT: usize>(
        &mut self,
        cell: usize,
        constants: &Relaxation<T>,
        normal: &[[usize; 2]; 3],
        shear: &[[usize; 3]; SHEAR_COUNT],
    ) -> T {
        let value = |index: usize| self.fields[index][cell];
        let mut normal_values = normal.map(|indices| indices.map(value));
        let mut shear_values = shear.map(|indices| indices.map(value));
        let energy_loss = relax(constants, &mut normal_values, &mut shear_values);
        let indices = normal.as_flattened().iter().chain(shear.as_flattened());
        let values = normal_values.as_flattened().iter().chain(shear_values.as_flattened());
        indices.zip(values).for_each(|(&index, value)| self.fields[index][cell] = *value);
        energy_loss
    }

    /// Operator P: applies the return mapping to all cells.
    pub(super) fn map_stresses(&mut self) {
        if self.problem.media.iter().all(|medium| medium.yield_set.is_none()) {
            return;
        }
        let Some(mut lane_return_mapping) = self.cell_laws.lane_return_mapping.take() else {
            return self.map_cells_scalar(false);
        };
        for cell in 0..self.problem.grid.count() {
            let medium = self.problem.cell_media[cell];
            let mut state = self.cell_state(cell);
            let factor = T::from_f64(self.field_factor(cell));
            match lane_return_mapping.map_cell(medium, factor, &mut state) {
                Some(dissipated) => {
                    self.dissipation.plastic_dissipation[cell] += dissipated;
                    for (field, value) in self.fields.iter_mut().zip(state) {
                        field[cell] = value;
                    }
                }
                None => self.map_cell_stress(cell, false),
            }
        }
        self.cell_laws.lane_return_mapping = Some(lane_return_mapping);
    }

    /// Applies P, or the reflection 2P − I if `reflects`, cell by cell with the scalar projection.
    pub(super) fn map_cells_scalar(&mut self, reflects: bool) {
        (0..self.problem.grid.count()).for_each(|cell| self.map_cell_stress(cell, reflects));
    }

    fn map_cell_stress(&mut self, cell: usize, reflects: bool) {
        let medium = self.medium(cell);
        if medium.yield_set.is_none() {
            return;
        }
        let deviation = stress_from_fields(self.fields(), &self.cell_state(cell));
        let initial = self.initial_stress(cell);
        let weight = medium.mapping_weight(reflects, self.problem.step);
        let factor = self.field_factor(cell);
        let Some(mapped) = map_scaled_stress(medium, factor, &deviation, initial.as_ref(), weight)
        else {
            return;
        };
        self.dissipation.plastic_dissipation[cell] += mapped.dissipation;
        if let Some(initial_stress_work) = self.dissipation.initial_stress_work.get_mut(cell) {
            *initial_stress_work += mapped.initial_stress_work;
        }
        self.work.min_dissipation_ratio =
            self.work.min_dissipation_ratio.min(mapped.dissipation_ratio);
        for (field, values) in self.problem.media[0].fields.iter().zip(&mut self.fields) {
            if let Some(value) = stress_component(*field, &mapped.stress) {
                values[cell] = T::from_f64(value);
            }
        }
    }

    /// Sets values of magnitude below [`flush_limit`] to zero after every 16th step, in fields and in history variables
    /// of interlayers.
    pub(super) fn flush_subnormals(&mut self) {
        let Some(limit) = flush_limit::<T>(self.steps) else { return };
        for value in self.fields.iter_mut().flatten() {
            *value = value.flush_below(limit);
        }
        self.interlayers.flush_below(limit);
    }

    /// Adds the present values to the time integrals, weighted by `steps`·Δt.
    pub(super) fn accumulate_integrals(&mut self, steps: f64) {
        for (place, sums) in &mut self.time_integrals {
            for (sum, value) in sums.iter_mut().zip(&self.fields[*place]) {
                *sum += steps * self.problem.step * value.to_f64();
            }
        }
    }
}
