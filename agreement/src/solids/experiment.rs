//! All branches of all waves: predicted, expected and measured frequencies.

use super::background::{Background, normals};
use super::branch::{Branch, Experiment, MARGIN};
use super::run::Run;
use super::{BranchResult, GridResult, Measurement, Response, SolverSettings};
use crate::fit::{Powers, Rate, extrapolate, extrapolation_error, fit_rate, rate_error};
use crate::scheme::{Discretisation, Equations};
use crate::{AgreementError, NotMeasurable, OnProgress, PlaneWave, Progress};
use analysis::solids::branches;
use dynamics::medium::Medium;
use dynamics::problem::{Grid, PlasticStep, Splitting};
use models::elastoplastic::Solid;
use nalgebra::DVector;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Maximum number of cell updates per simulation.
const MAX_UPDATES: f64 = 2e9;
/// Bound on the rounding errors of a step, in half units in the last place of the largest field in energy
/// coordinates: about ten operations per sweep, and up to seven factors per step.
const ROUNDINGS: f64 = 64.0;
/// Ratio of wave stress to background capacity on flat yield surfaces.
const ON_FLAT: f64 = 1e-3;

/// Predicts all branches of waves in `solid` and measures them in `medium`, the solver's description of the same
/// solid.
///
/// # Errors
/// The energy of the solid is not positive definite, its rate response is not defined, or it has no background on its
/// yield surface; `medium` has other dimensions; no grids are given; a simulation exceeds the number of cell updates;
/// the progress callback cancels the comparison.
pub fn branch_results(
    solid: &Solid,
    medium: &Medium,
    waves: &[PlaneWave<3>],
    settings: &SolverSettings,
    on_progress: OnProgress,
) -> Result<Vec<BranchResult>, AgreementError> {
    if settings.cells.is_empty() {
        return Err(AgreementError::NoGrids);
    }
    match (solid.dimensions, medium.pairs.len()) {
        (2, 2) => Experiment::<2> { solid, medium, settings }.results(waves, on_progress),
        (3, 3) => Experiment::<3> { solid, medium, settings }.results(waves, on_progress),
        (solid, medium) => Err(AgreementError::Dimensions { solid, medium }),
    }
}

impl<const D: usize> Experiment<'_, D> {
    fn results(
        &self,
        waves: &[PlaneWave<3>],
        on_progress: OnProgress,
    ) -> Result<Vec<BranchResult>, AgreementError> {
        let rates = self.solid.elastic.carried_rates::<D>();
        let unknowns: Vec<&str> = rates.unknowns.iter().map(|unknown| unknown.name).collect();
        let form = rates.symmetric().ok_or(AgreementError::Energy)?;
        let normals = normals::<D>(self.solid);
        let elastic = Equations::new(&form, &[]).ok_or(AgreementError::Energy)?;
        let yielding = Equations::new(&form, &normals).ok_or(AgreementError::Energy)?;
        let background = Background::new(self.solid, &yielding)?;
        let branches = self.branches(waves, &elastic, &yielding)?;
        let cells = &self.settings.cells;
        let runs: Vec<(&Branch<D>, usize)> = branches
            .iter()
            .flat_map(|branch| cells.iter().map(move |&cells| (branch, cells)))
            .collect();
        for (branch, cells) in &runs {
            self.check_size(branch, *cells)?;
        }
        let progress = Progress::begin(on_progress, runs.len())?;
        let runs: Vec<Result<GridResult, NotMeasurable>> = runs
            .into_par_iter()
            .map(|(branch, cells)| {
                let found = self.on_grid(branch, cells, &unknowns, background.as_ref());
                progress.advance()?;
                Ok(found)
            })
            .collect::<Result<_, AgreementError>>()?;
        let results = branches.iter().zip(runs.chunks(cells.len()));
        Ok(results.map(|(branch, grids)| self.result(branch, grids)).collect())
    }

    /// Branches of all waves, with amplitudes in energy coordinates.
    fn branches<'a>(
        &self,
        waves: &[PlaneWave<3>],
        elastic: &'a Equations<D>,
        yielding: &'a Equations<D>,
    ) -> Result<Vec<Branch<'a, D>>, AgreementError> {
        let responses = match self.solid.plastic {
            None => vec![(Response::Elastic, true, elastic)],
            Some(_) => {
                vec![(Response::Unloading, true, elastic), (Response::Loading, false, yielding)]
            }
        };
        let mut branches: Vec<Branch<D>> = Vec::new();
        for (index, wave) in waves.iter().enumerate() {
            // Components at the level of rounding are set to zero.
            let component = |axis: usize| match wave.normal[axis] {
                component if component.abs() < 1e-9 => 0.0,
                component => wave.number * component,
            };
            let vector = std::array::from_fn(component);
            for &(response, stays_elastic, equations) in &responses {
                let predicted = self.predicted(wave, stays_elastic)?;
                let waves = equations.waves(vector);
                let greatest = predicted.first().map_or(0.0, |own| own.1);
                let mut waves = waves.into_iter();
                for (label, predicted) in predicted {
                    // `None` if the energy form has fewer waves than the analysis: reported as
                    // `NotMeasurable::NoSuchWave`.
                    let (frequency, amplitude) = waves.next().unzip();
                    let bounds = amplitude.as_ref().map(|own| yielding.bounds(vector, own));
                    branches.push(Branch {
                        wave: index,
                        number: wave.number,
                        vector,
                        response,
                        label,
                        predicted,
                        greatest,
                        frequency: frequency.unwrap_or(f64::NAN),
                        amplitude,
                        equations,
                        bounds: bounds.unwrap_or_default(),
                    });
                }
            }
        }
        Ok(branches)
    }

    /// Labels and predicted frequencies (rad/s) of the propagating waves, by descending frequency.
    fn predicted(
        &self,
        wave: &PlaneWave<3>,
        stays_elastic: bool,
    ) -> Result<Vec<(String, f64)>, AgreementError> {
        /// Frequencies below this fraction of the largest are treated as zero.
        const NEGLIGIBLE: f64 = 1e-6;
        let groups = branches(self.solid, wave.normal, wave.number, stays_elastic)?;
        let mut all: Vec<(String, f64)> = groups
            .iter()
            .flat_map(|group| {
                group.at(wave.number).into_iter().enumerate().flat_map(|(branch, point)| {
                    let label = group.label(branch);
                    std::iter::repeat_n((label, point.frequency), group.count)
                })
            })
            .collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let greatest = all.first().map_or(0.0, |own| own.1);
        all.retain(|own| own.1 > NEGLIGIBLE * greatest);
        Ok(all)
    }

    fn result(
        &self,
        branch: &Branch<D>,
        grids: &[Result<GridResult, NotMeasurable>],
    ) -> BranchResult {
        let powers = match (self.settings.plastic_step, self.settings.splitting) {
            (PlasticStep::MidpointReflection, _) => Powers::SYMMETRIC,
            _ if branch.response == Response::Loading => Powers::PROJECTED,
            (_, Splitting::TwoCyclic) => Powers::SYMMETRIC,
            (_, Splitting::Alternating) => Powers::ALTERNATING,
        };
        let grids: Result<Vec<GridResult>, NotMeasurable> = grids.iter().cloned().collect();
        BranchResult {
            wave: branch.wave,
            response: branch.response,
            branch: branch.label.clone(),
            predicted: branch.predicted,
            measured: grids.map(|grids| in_the_limit(grids, powers)),
        }
    }

    /// Grid of one wavelength along each axis, period (s), and number of steps per `cells`-th part of the period.
    fn grid(&self, branch: &Branch<D>, cells: usize) -> (Grid<D>, f64, usize) {
        let edges = branch.vector.map(|k| 2.0 * PI / (k.abs() * cells as f64));
        let longest = edges.iter().copied().filter(|edge| edge.is_finite()).fold(0.0, f64::max);
        let along = |axis: usize| edges[axis].is_finite();
        let grid = Grid {
            cells: std::array::from_fn(|axis| if along(axis) { cells } else { 1 }),
            // The solution is constant along axes normal to the wave vector.
            spacing: std::array::from_fn(|axis| if along(axis) { edges[axis] } else { longest }),
        };
        let rate = |axis: usize| {
            let speeds = self.medium.pairs[axis].iter().map(|pair| pair.speed());
            speeds.fold(0.0, f64::max) / grid.spacing[axis]
        };
        let by_waves = 2.0 * self.settings.courant / (0..D).map(rate).fold(0.0, f64::max);
        // The limit of the rotation applies to the coarsest grid, which has the longest step.
        let coarsest = self.settings.cells[0] as f64 / cells as f64;
        let by_rotation = self.medium.rotation.map_or(f64::INFINITY, |rotation| {
            self.settings.rotation / rotation.frequency * coarsest
        });
        let period = 2.0 * PI / branch.predicted;
        // The number of steps per cell is the same on all grids, and so is the Courant number.
        let per_cell = period / (by_waves.min(by_rotation) * cells as f64) * (1.0 - 1e-12);
        (grid, period, per_cell.ceil().max(1.0) as usize)
    }

    /// Checks the number of cell updates of a simulation against [`MAX_UPDATES`].
    fn check_size(&self, branch: &Branch<D>, cells: usize) -> Result<(), AgreementError> {
        let (grid, _, per_cell) = self.grid(branch, cells);
        let updates = (cells * per_cell) as f64 * grid.count() as f64;
        match updates <= MAX_UPDATES {
            true => Ok(()),
            false => {
                let (number, most) = (branch.number, MAX_UPDATES);
                Err(AgreementError::TooLong { updates, number, most })
            }
        }
    }

    fn on_grid(
        &self,
        branch: &Branch<D>,
        cells: usize,
        unknowns: &[&str],
        background: Option<&Background>,
    ) -> Result<GridResult, NotMeasurable> {
        let Some(amplitude) = &branch.amplitude else {
            return Err(NotMeasurable::NoSuchWave);
        };
        let (grid, period, per_cell) = self.grid(branch, cells);
        let count = cells * per_cell;
        let discretisation = Discretisation { spacing: grid.spacing, step: period / count as f64 };
        let (size, disturbance) = match background {
            None => (1.0, 0.0),
            Some(background) => self.size(branch, amplitude, background, count)?,
        };
        let rounding = ROUNDINGS * f64::EPSILON * count as f64 + disturbance;
        let SolverSettings { plastic_step, splitting, .. } = *self.settings;
        let expected = branch
            .equations
            .propagator(branch.vector, &discretisation, plastic_step, splitting)
            .amplitudes(amplitude, per_cell, cells);
        let (amplitude, scale) = (amplitude * Complex64::from(size), 1.0 / (size * size));
        let run = Run { experiment: self, branch, grid, discretisation, unknowns, background };
        let measured = run.amplitudes(&amplitude, cells, per_cell)?;
        let measured: Vec<Complex64> = measured.iter().map(|own| own * scale).collect();
        if !measured.iter().chain(&expected).all(|own| own.is_finite() && own.norm() > 0.0) {
            return Err(NotMeasurable::Vanishing);
        }
        let times: Vec<f64> =
            (0..=cells).map(|index| (index * per_cell) as f64 * discretisation.step).collect();
        // Shift of the frequency by the discretisation error, relative to the predicted frequency. The latter is the
        // square root of an eigenvalue ω², whose rounding error is relative to the largest eigenvalue.
        let mut expected = fit_rate(&times, &expected);
        expected.frequency += branch.predicted - branch.frequency;
        let ratio = branch.greatest / branch.predicted;
        let of_root = ROUNDINGS * f64::EPSILON * branch.greatest * ratio;
        Ok(GridResult {
            cells,
            measured: fit_rate(&times, &measured),
            expected,
            tolerance: rate_error(rounding, period) + of_root,
        })
    }

    /// Scale factor of a wave of unit amplitude relative to the background, and bound on the phase error after the
    /// given number of steps: by the rotation of the normal of a curved yield surface due to the stress of the wave
    /// and of the flow, and by the rounding of the total stress.
    fn size(
        &self,
        branch: &Branch<D>,
        amplitude: &DVector<Complex64>,
        background: &Background,
        steps: usize,
    ) -> Result<(f64, f64), NotMeasurable> {
        let part = if background.is_curved { f64::EPSILON.sqrt() } else { ON_FLAT };
        // Energy norm, since stress and couple stress have different units.
        let velocities = self.solid.elastic.carried_rates::<D>().velocities();
        let stress = amplitude.rows_range(velocities..).norm();
        let size = part * background.capacity / stress;
        // The rate of plastic flow acts over one period; a rotation of the normal enters the projection twice.
        let turned = if background.is_curved { 4.0 * PI * MARGIN * part } else { 0.0 };
        let rounding = f64::EPSILON * background.norm / (part * background.capacity);
        if rounding > 0.1 {
            return Err(NotMeasurable::Hidden);
        }
        let is_loading = branch.response == Response::Loading;
        Ok((size, if is_loading { turned + steps as f64 * rounding } else { 0.0 }))
    }
}

fn in_the_limit(grids: Vec<GridResult>, powers: Powers) -> Measurement {
    let cells: Vec<usize> = grids.iter().map(|grid| grid.cells).collect();
    let limit = |of: &dyn Fn(&GridResult) -> Rate| {
        extrapolate(&cells, &grids.iter().map(of).collect::<Vec<_>>(), powers)
    };
    let errors: Vec<f64> = grids.iter().map(|grid| grid.tolerance).collect();
    let limit = GridResult {
        cells: 0,
        measured: limit(&|grid| grid.measured),
        expected: limit(&|grid| grid.expected),
        tolerance: extrapolation_error(&cells, &errors, powers),
    };
    Measurement { grids, limit }
}
