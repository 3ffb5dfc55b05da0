//! All branches of all waves: predicted, expected and measured frequencies.

use super::background::{BackgroundStress, yield_normals};
use super::branch::{PredictedBranch, SAFETY_FACTOR, SolidExperiment};
use super::simulation::WaveSimulation;
use super::{BranchResult, GridResult, Measurement, SolverSettings, WaveResponse};
use crate::fit::{
    ErrorExponents, Rate, extrapolate, fit_rate, max_extrapolation_error, max_rate_error,
};
use crate::scheme::{Discretisation, EnergyForm};
use crate::{AgreementError, MeasurementError, PlaneWave, ProgressCallback, TaskProgress};
use analysis::solids::group_branches;
use dynamics::medium::Medium;
use dynamics::problem::{Grid, PlasticStep, Splitting};
use models::common::elementary::Modulus;
use models::elastoplastic::Solid;
use nalgebra::DVector;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Maximum number of cell updates per simulation.
const MAX_UPDATES: f64 = 2e9;
/// Bound on the rounding error of a step, in units of ε = 2⁻⁵² times the largest field in energy coordinates: up to
/// seven factors with about ten operations each, of which each rounds by at most ε/2.
const ROUNDINGS_PER_STEP: f64 = 64.0;
/// Ratio of the stress of a wave to [`BackgroundStress::wave_capacity`] on flat yield surfaces, in the energy norm.
const FLAT_SURFACE_STRESS_RATIO: f64 = 1e-3;

/// Predicts all branches of waves in `solid` and measures them in `medium`, the solver's description of the same
/// solid.
///
/// # Errors
/// The energy of the solid is not positive definite, its rate response is not defined, its active conditions are
/// linearly dependent, no stress meets them alone, or one has a plastic multiplier that is not positive; `medium` has
/// other dimensions; no grids are given; a simulation exceeds the number of cell updates; the progress callback cancels
/// the comparison.
pub fn compare_branches(
    solid: &Solid,
    medium: &Medium,
    waves: &[PlaneWave<3>],
    settings: &SolverSettings,
    on_progress: ProgressCallback,
) -> Result<Vec<BranchResult>, AgreementError> {
    if settings.cells_per_wavelength.is_empty() {
        return Err(AgreementError::NoGrids);
    }
    match (solid.dimensions, medium.pairs.len()) {
        (2, 2) => {
            SolidExperiment::<2> { solid, medium, settings }.compare_branches(waves, on_progress)
        }
        (3, 3) => {
            SolidExperiment::<3> { solid, medium, settings }.compare_branches(waves, on_progress)
        }
        (solid, medium) => Err(AgreementError::DimensionMismatch { solid, medium }),
    }
}

impl<const D: usize> SolidExperiment<'_, D> {
    fn compare_branches(
        &self,
        waves: &[PlaneWave<3>],
        on_progress: ProgressCallback,
    ) -> Result<Vec<BranchResult>, AgreementError> {
        let rates = self.solid.elastic_law.rates_with_out_of_plane::<D>();
        let unknowns: Vec<&str> = rates.unknowns.iter().map(|unknown| unknown.name).collect();
        let form = rates.symmetric_form().ok_or(AgreementError::IndefiniteEnergy)?;
        let normals = yield_normals::<D>(self.solid);
        let elastic = EnergyForm::new(&form, &[]).ok_or(AgreementError::IndefiniteEnergy)?;
        let yielding = EnergyForm::new(&form, &normals).ok_or(AgreementError::IndefiniteEnergy)?;
        let background = BackgroundStress::new(self.solid, &yielding)?;
        let branches = self.predict_branches(waves, &elastic, &yielding)?;
        let cells = &self.settings.cells_per_wavelength;
        let runs: Vec<(&PredictedBranch<D>, usize)> = branches
            .iter()
            .flat_map(|branch| cells.iter().map(move |&cells| (branch, cells)))
            .collect();
        for (branch, cells) in &runs {
            self.check_cell_updates(branch, *cells)?;
        }
        let progress = TaskProgress::new(on_progress, runs.len())?;
        let runs: Vec<Result<GridResult, MeasurementError>> = runs
            .into_par_iter()
            .map(|(branch, cells)| {
                let found = self.compare_on_grid(branch, cells, &unknowns, background.as_ref());
                progress.advance()?;
                Ok(found)
            })
            .collect::<Result<_, AgreementError>>()?;
        let results = branches.iter().zip(runs.chunks(cells.len()));
        Ok(results.map(|(branch, grids)| self.extrapolate_branch(branch, grids)).collect())
    }

    /// Branches of all waves, with amplitudes in energy coordinates.
    fn predict_branches<'a>(
        &self,
        waves: &[PlaneWave<3>],
        elastic: &'a EnergyForm<D>,
        yielding: &'a EnergyForm<D>,
    ) -> Result<Vec<PredictedBranch<'a, D>>, AgreementError> {
        let responses = match self.solid.plastic_state {
            None => vec![(WaveResponse::Elastic, true, elastic)],
            Some(_) => {
                vec![
                    (WaveResponse::Unloading, true, elastic),
                    (WaveResponse::Loading, false, yielding),
                ]
            }
        };
        let mut branches: Vec<PredictedBranch<D>> = Vec::new();
        for (index, wave) in waves.iter().enumerate() {
            // Components at the level of rounding are set to zero.
            let component = |axis: usize| match wave.normal[axis] {
                component if component.abs() < 1e-9 => 0.0,
                component => wave.wave_number * component,
            };
            let vector = std::array::from_fn(component);
            for &(response, stays_elastic, equations) in &responses {
                let predicted = self.predict_frequencies(wave, stays_elastic)?;
                let waves = equations.compute_waves(vector);
                let greatest = predicted.first().map_or(0.0, |own| own.1);
                let mut waves = waves.into_iter();
                for (label, predicted) in predicted {
                    // `None` if the energy form has fewer waves than the analysis: reported as
                    // `MeasurementError::MissingWave`.
                    let (frequency, amplitude) = waves.next().unzip();
                    let bounds = amplitude.as_ref().map(|own| yielding.bounds(vector, own));
                    branches.push(PredictedBranch {
                        wave_index: index,
                        wave_number: wave.wave_number,
                        wave_vector: vector,
                        response,
                        label,
                        predicted_frequency: predicted,
                        max_frequency: greatest,
                        energy_form_frequency: frequency.unwrap_or(f64::NAN),
                        amplitude,
                        energy_form: equations,
                        bounds: bounds.unwrap_or_default(),
                    });
                }
            }
        }
        Ok(branches)
    }

    /// Labels and predicted frequencies (rad/s) of the propagating waves, by descending frequency.
    fn predict_frequencies(
        &self,
        wave: &PlaneWave<3>,
        stays_elastic: bool,
    ) -> Result<Vec<(String, f64)>, AgreementError> {
        /// Frequencies below this fraction of the largest are treated as zero.
        const MIN_RELATIVE_FREQUENCY: f64 = 1e-6;
        let groups = group_branches(self.solid, wave.normal, wave.wave_number, stays_elastic)?;
        let mut all: Vec<(String, f64)> = groups
            .iter()
            .flat_map(|group| {
                group.points_at(wave.wave_number).into_iter().enumerate().flat_map(
                    |(branch, point)| {
                        let label = group.label(branch);
                        std::iter::repeat_n((label, point.frequency), group.family_count)
                    },
                )
            })
            .collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let greatest = all.first().map_or(0.0, |own| own.1);
        all.retain(|own| own.1 > MIN_RELATIVE_FREQUENCY * greatest);
        Ok(all)
    }

    fn extrapolate_branch(
        &self,
        branch: &PredictedBranch<D>,
        grids: &[Result<GridResult, MeasurementError>],
    ) -> BranchResult {
        let powers = match (self.settings.plastic_step, self.settings.splitting) {
            (PlasticStep::MidpointReflection, _) => ErrorExponents::SYMMETRIC,
            _ if branch.response == WaveResponse::Loading => ErrorExponents::PROJECTED,
            (_, Splitting::TwoCyclic) => ErrorExponents::SYMMETRIC,
            (_, Splitting::Alternating) => ErrorExponents::ALTERNATING,
        };
        let grids: Result<Vec<GridResult>, MeasurementError> = grids.iter().cloned().collect();
        BranchResult {
            wave_index: branch.wave_index,
            response: branch.response,
            branch_label: branch.label.clone(),
            predicted_frequency: branch.predicted_frequency,
            measurement: grids.map(|grids| extrapolate_to_zero_cell_size(grids, powers)),
        }
    }

    /// Grid of one wavelength along each axis, period (s), and number of steps in 1/`cells` of the period.
    fn choose_grid(&self, branch: &PredictedBranch<D>, cells: usize) -> (Grid<D>, f64, usize) {
        let edges = branch.wave_vector.map(|k| 2.0 * PI / (k.abs() * cells as f64));
        let longest = edges.iter().copied().filter(|edge| edge.is_finite()).fold(0.0, f64::max);
        let is_propagation_axis = |axis: usize| edges[axis].is_finite();
        let grid = Grid {
            cells: std::array::from_fn(|axis| if is_propagation_axis(axis) { cells } else { 1 }),
            // The solution is constant along axes normal to the wave vector.
            spacing: std::array::from_fn(|axis| {
                if is_propagation_axis(axis) { edges[axis] } else { longest }
            }),
        };
        let rate = |axis: usize| {
            let speeds = self.medium.pairs[axis].iter().map(|pair| pair.speed());
            speeds.fold(0.0, f64::max) / grid.spacing[axis]
        };
        let wave_steps = 2.0 * self.settings.courant_number / (0..D).map(rate).fold(0.0, f64::max);
        // The limit of the rotation applies to the coarsest grid, which has the longest step.
        let coarsest = self.settings.cells_per_wavelength[0] as f64 / cells as f64;
        let rotation_steps = self.medium.rotation.map_or(f64::INFINITY, |rotation| {
            self.settings.max_rotation / rotation.frequency * coarsest
        });
        let period = 2.0 * PI / branch.predicted_frequency;
        // The number of steps in 1/`cells` of the period is the same on all grids, and so is the Courant number.
        let per_cell = period / (wave_steps.min(rotation_steps) * cells as f64) * (1.0 - 1e-12);
        (grid, period, per_cell.ceil().max(1.0) as usize)
    }

    /// Checks the number of cell updates of a simulation against [`MAX_UPDATES`].
    fn check_cell_updates(
        &self,
        branch: &PredictedBranch<D>,
        cells: usize,
    ) -> Result<(), AgreementError> {
        let (grid, _, per_cell) = self.choose_grid(branch, cells);
        let updates = (cells * per_cell) as f64 * grid.count() as f64;
        match updates <= MAX_UPDATES {
            true => Ok(()),
            false => {
                let (wave_number, max_updates) = (branch.wave_number, MAX_UPDATES);
                Err(AgreementError::TooManyCellUpdates { updates, wave_number, max_updates })
            }
        }
    }

    fn compare_on_grid(
        &self,
        branch: &PredictedBranch<D>,
        cells: usize,
        unknowns: &[&str],
        background: Option<&BackgroundStress>,
    ) -> Result<GridResult, MeasurementError> {
        let Some(amplitude) = &branch.amplitude else {
            return Err(MeasurementError::MissingWave);
        };
        let (grid, period, per_cell) = self.choose_grid(branch, cells);
        let count = cells * per_cell;
        let discretisation =
            Discretisation { spacing: grid.spacing, time_step: period / count as f64 };
        let (size, disturbance) = match background {
            None => (1.0, 0.0),
            Some(background) => self.choose_wave_scale(branch, amplitude, background, count)?,
        };
        let rounding = ROUNDINGS_PER_STEP * f64::EPSILON * count as f64 + disturbance;
        let SolverSettings { plastic_step, splitting, .. } = *self.settings;
        let expected = branch
            .energy_form
            .propagator(branch.wave_vector, &discretisation, plastic_step, splitting)
            .amplitudes(amplitude, per_cell, cells);
        let (amplitude, scale) = (amplitude * Complex64::from(size), 1.0 / (size * size));
        let run =
            WaveSimulation { experiment: self, branch, grid, discretisation, unknowns, background };
        let measured = run.measure_amplitudes(&amplitude, cells, per_cell)?;
        let measured: Vec<Complex64> = measured.iter().map(|own| own * scale).collect();
        if !measured.iter().chain(&expected).all(|own| own.is_finite() && own.modulus() > 0.0) {
            return Err(MeasurementError::VanishingAmplitude);
        }
        let times: Vec<f64> =
            (0..=cells).map(|index| (index * per_cell) as f64 * discretisation.time_step).collect();
        // The expected frequency is the predicted one plus the discretisation error, which is the fitted frequency
        // minus that of the energy form. A predicted frequency is the square root of an eigenvalue ω², whose rounding
        // error is relative to the largest eigenvalue.
        let mut expected = fit_rate(&times, &expected);
        expected.frequency += branch.predicted_frequency - branch.energy_form_frequency;
        let ratio = branch.max_frequency / branch.predicted_frequency;
        let of_root = ROUNDINGS_PER_STEP * f64::EPSILON * branch.max_frequency * ratio;
        Ok(GridResult {
            cells,
            measured_rate: fit_rate(&times, &measured),
            expected_rate: expected,
            tolerance: max_rate_error(rounding, period) + of_root,
        })
    }

    /// Factor by which a wave of unit amplitude is multiplied so that it is small relative to the background, and bound
    /// on its phase error (0 for unloading) after the given number of steps: by the rotation of the normal of a curved
    /// yield surface due to the stress of the wave and of the flow, and by the rounding of the total stress.
    fn choose_wave_scale(
        &self,
        branch: &PredictedBranch<D>,
        amplitude: &DVector<Complex64>,
        background: &BackgroundStress,
        steps: usize,
    ) -> Result<(f64, f64), MeasurementError> {
        let part = if background.has_curved_yield_surface {
            f64::EPSILON.sqrt()
        } else {
            FLAT_SURFACE_STRESS_RATIO
        };
        // Energy norm, since stress and couple stress have different units.
        let velocities = self.solid.elastic_law.rates_with_out_of_plane::<D>().velocity_count();
        let stress = amplitude.rows_range(velocities..).norm();
        let size = part * background.wave_capacity / stress;
        // Over one period plastic flow rotates the normal by up to 2π × safety factor × relative stress of the wave;
        // the rotation enters the projection twice.
        let normal_rotation =
            if background.has_curved_yield_surface { 4.0 * PI * SAFETY_FACTOR * part } else { 0.0 };
        let rounding = f64::EPSILON * background.energy_norm / (part * background.wave_capacity);
        if rounding > 0.1 {
            return Err(MeasurementError::BelowRounding);
        }
        let is_loading = branch.response == WaveResponse::Loading;
        Ok((size, if is_loading { normal_rotation + steps as f64 * rounding } else { 0.0 }))
    }
}

fn extrapolate_to_zero_cell_size(grids: Vec<GridResult>, powers: ErrorExponents) -> Measurement {
    let cells: Vec<usize> = grids.iter().map(|grid| grid.cells).collect();
    let limit = |of: &dyn Fn(&GridResult) -> Rate| {
        extrapolate(&cells, &grids.iter().map(of).collect::<Vec<_>>(), powers)
    };
    let errors: Vec<f64> = grids.iter().map(|grid| grid.tolerance).collect();
    let limit = GridResult {
        cells: 0,
        measured_rate: limit(&|grid| grid.measured_rate),
        expected_rate: limit(&|grid| grid.expected_rate),
        tolerance: max_extrapolation_error(&cells, &errors, powers),
    };
    Measurement { grids, limit }
}
