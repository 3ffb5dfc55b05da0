//! Simulation of one wave in a periodic box of one wavelength along each axis.

use super::background::BackgroundStress;
use super::branch::{PredictedBranch, SAFETY_FACTOR, SolidExperiment};
use super::{SolverSettings, WaveResponse};
use crate::MeasurementError;
use crate::scheme::Discretisation;
use dynamics::boundary::{Boundary, Source};
use dynamics::domain::Domain;
use dynamics::line::Slopes;
use dynamics::problem::{Grid, Problem, Scheme};
use models::common::elementary::cr_cis;
use models::solid::waves::SolidField;
use nalgebra::DVector;
use num_complex::Complex64;
use std::sync::Arc;

/// Simulation of one wave on one grid.
pub(super) struct WaveSimulation<'a, const D: usize> {
    pub(super) experiment: &'a SolidExperiment<'a, D>,
    pub(super) branch: &'a PredictedBranch<'a, D>,
    pub(super) grid: Grid<D>,
    pub(super) discretisation: Discretisation<D>,
    /// Names of the unknowns of the rate equations.
    pub(super) unknowns: &'a [&'a str],
    pub(super) background: Option<&'a BackgroundStress>,
}

impl<const D: usize> WaveSimulation<'_, D> {
    /// Inner products of `amplitude` with the measured amplitude, in energy coordinates, initially and after every
    /// `per_cell` steps (`cells` times); or the reason why the solver rejects the problem.
    pub(super) fn measure_amplitudes(
        &self,
        amplitude: &DVector<Complex64>,
        cells: usize,
        per_cell: usize,
    ) -> Result<Vec<Complex64>, MeasurementError> {
        let equations = self.branch.energy_form;
        let problem = self.build_problem(amplitude);
        let mut domain = Domain::<f64, D>::new(&problem)?;
        let fields: Vec<SolidField> = domain.fields().to_vec();
        let places: Vec<Option<usize>> =
            fields.iter().map(|field| self.unknown_index(*field)).collect();
        let waves: Vec<Complex64> =
            (0..self.grid.count()).map(|cell| cr_cis(self.cell_phase(cell))).collect();
        let wave = equations.inverse_transform.map(Complex64::from) * amplitude;
        let offset = self.background_offset(amplitude);
        for (&field, place) in fields.iter().zip(&places) {
            let Some(place) = *place else { continue };
            let uniform = offset.as_ref().map_or(0.0, |own| own[place]);
            let values: Vec<f64> =
                waves.iter().map(|phase| uniform + (wave[place] * phase).re).collect();
            domain.set_field(field, &values);
        }
        let into_energy = equations.energy_transform.map(Complex64::from);
        let count = domain.fields().len();
        let measure = |domain: &Domain<f64, D>, index: usize| {
            let line = self.sample_line(index);
            let share = 2.0 / line.len() as f64;
            let values = domain.field_deviations(&line);
            let mut state = DVector::zeros(self.unknowns.len());
            for (field, place) in places.iter().enumerate() {
                let Some(place) = *place else { continue };
                let values = values.iter().skip(field).step_by(count);
                let sum: Complex64 =
                    values.zip(&line).map(|(value, &cell)| waves[cell].conj() * *value).sum();
                state[place] = sum * share;
            }
            amplitude.dotc(&(&into_energy * state))
        };
        let mut all = vec![measure(&domain, 0)];
        for index in 1..=cells {
            (0..per_cell).for_each(|_| domain.advance());
            all.push(measure(&domain, index));
        }
        Ok(all)
    }

    /// Index of a field among the unknowns, by its name.
    fn unknown_index(&self, field: SolidField) -> Option<usize> {
        let name = field.to_string();
        self.unknowns.iter().position(|own| *own == name)
    }

    /// Cells of one wavelength on a line along an axis. Successive samples use successive lines, so that all rows are
    /// sampled; sampling all cells would be slow, since the output of a step is completed cell by cell.
    fn sample_line(&self, index: usize) -> Vec<usize> {
        let counts = self.grid.cells;
        let axis = counts.iter().position(|count| *count > 1).unwrap_or(0);
        let stride = |axis: usize| counts[..axis].iter().product::<usize>();
        let first: usize =
            (0..D).filter(|own| *own != axis).map(|own| index % counts[own] * stride(own)).sum();
        (0..counts[axis]).map(|own| first + own * stride(axis)).collect()
    }

    /// Phase κ·x at the centre of a cell, rad.
    fn cell_phase(&self, cell: usize) -> f64 {
        let mut rest = cell;
        let mut phase = 0.0;
        for axis in 0..D {
            let index = rest % self.grid.cells[axis];
            rest /= self.grid.cells[axis];
            phase += self.branch.wave_vector[axis] * self.grid.spacing[axis] * (index as f64 + 0.5);
        }
        phase
    }

    fn build_problem(&self, amplitude: &DVector<Complex64>) -> Problem<D> {
        let count = self.grid.count();
        let SolverSettings { plastic_step, splitting, .. } = *self.experiment.settings;
        let mut problem = Problem::new(
            self.grid,
            vec![self.experiment.medium.clone()],
            vec![0; count],
            std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
            self.discretisation.time_step,
            Scheme { splitting, ..Scheme::new(Slopes::FourthOrder, plastic_step) },
        );
        let Some(background) = self.background else { return problem };
        problem.initial_stress = Some((0, vec![background.stress; self.grid.cells[0]]));
        if self.branch.response == WaveResponse::Loading {
            // A source subtracts amplitude × signal from the stress: the signal −t adds stress at the constant rate.
            let rate = SAFETY_FACTOR * amplitude.norm() * self.branch.bounds[1];
            let volume = self.grid.volume() * count as f64;
            let amplitudes = self.experiment.medium.fields.iter().filter_map(|&field| {
                let place = self.unknown_index(field)?;
                let value = background.yield_normal_stress[place] * rate * volume;
                (value != 0.0).then_some((field, value))
            });
            problem.sources = vec![Source {
                cells: (0..count).map(|cell| (cell, 1.0 / count as f64)).collect(),
                amplitudes: amplitudes.collect(),
                signal: Arc::new(|time: f64| -time),
            }];
        }
        problem
    }

    /// Offset, as a vector of unknowns, of an unloading background from the yield surface into the elastic domain.
    fn background_offset(&self, amplitude: &DVector<Complex64>) -> Option<DVector<f64>> {
        let background = self.background?;
        (self.branch.response == WaveResponse::Unloading).then(|| {
            &background.yield_normal_stress
                * (-SAFETY_FACTOR * amplitude.norm() * self.branch.bounds[0])
        })
    }
}
