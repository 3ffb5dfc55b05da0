//! Solids: plane waves of every branch, by the analysis and by the solver.

use super::fit::{Rate, error_of_extrapolated, error_of_rate, extrapolated, rate};
use super::scheme::{Equations, Steps};
use crate::Error;
use crate::case::{Case, Wave};
use crate::dispersion::kinds;
use crate::progress::Progress;
use crate::run::{medium, unknown_name};
use crate::solid::{Solid, normal};
use dynamics::boundary::{Boundary, Source};
use dynamics::domain::Domain;
use dynamics::line::Slopes;
use dynamics::medium::Medium;
use dynamics::problem::{Grid, Placement, Problem, Scheme};
use models::cosserat::stress::{Component, Stress};
use models::cosserat::waves::Field;
use models::granular_flow::InputError;
use models::plasticity::parameters::YieldSet;
use nalgebra::DVector;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// What a solid does under a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// It has no yield set.
    Elastic,
    /// Its background has just left the yield surface.
    Unloading,
    /// Its background flows, and goes on flowing.
    Loading,
}

impl Response {
    /// Name in results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Unloading => "unloading",
            Self::Loading => "loading",
        }
    }
}

/// What waves are sent, and on which grids.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The waves.
    pub waves: Vec<Wave>,
    /// Cells to a period along each axis, ascending.
    pub cells: Vec<usize>,
    /// c(Δt/2)/h of the fastest wave, at most.
    pub courant: f64,
    /// Turn of spins in a step at most, rad.
    pub rotation: f64,
}

/// What was measured on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnGrid {
    /// Cells to a period along each axis.
    pub cells: usize,
    /// Measured.
    pub measured: Rate,
    /// What the scheme makes of the prediction: its discretisation error included.
    pub expected: Rate,
    /// By how much both may differ, rad/s: rounding, and on curved yield surfaces what the wave turns them.
    pub tolerance: f64,
}

/// A branch at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The wave vector.
    pub wave: Wave,
    /// Which equations hold.
    pub response: Response,
    /// Name of the branch.
    pub branch: String,
    /// Predicted frequency, rad/s; no wave grows.
    pub predicted: f64,
    /// By grid, the coarsest first.
    pub grids: Vec<OnGrid>,
    /// In the limit of small cells.
    pub limit: OnGrid,
}

impl OnGrid {
    /// Whether what was measured is what was to be expected.
    pub fn agrees(&self) -> bool {
        self.measured.less(self.expected).size() <= self.tolerance
    }
}

impl Row {
    /// Whether it agrees on every grid and in the limit.
    pub fn agrees(&self) -> bool {
        self.grids.iter().chain([&self.limit]).all(OnGrid::agrees)
    }

    /// Measured less predicted in the limit of small cells, as part of the predicted frequency.
    pub fn difference(&self) -> Rate {
        self.part(self.limit.measured)
    }

    /// The same as the scheme's symbol has it.
    pub fn expected_difference(&self) -> Rate {
        self.part(self.limit.expected)
    }

    /// A rate less the predicted one, as part of the predicted frequency.
    pub fn part(&self, rate: Rate) -> Rate {
        let difference = rate.less(Rate { frequency: self.predicted, growth: 0.0 });
        Rate {
            frequency: difference.frequency / self.predicted,
            growth: difference.growth / self.predicted,
        }
    }

    /// By which power of the cell the measured error falls from the coarsest grid to the finest; `None` where
    /// it is rounding.
    pub fn order(&self) -> Option<f64> {
        let [first, .., last] = self.grids.as_slice() else { return None };
        let error = |grid: &OnGrid| self.part(grid.measured).size();
        let is_known = |grid: &OnGrid| {
            error(grid) * self.predicted > 10.0 * grid.tolerance && error(grid) > 0.0
        };
        (is_known(first) && is_known(last)).then(|| {
            (error(first) / error(last)).ln() / (last.cells as f64 / first.cells as f64).ln()
        })
    }
}

/// Frequencies at which no wave of some kind propagates, and whether that is what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// The kind of wave.
    pub polarisation: &'static str,
    /// Lower end, rad/s.
    pub from: f64,
    /// Upper end, rad/s.
    pub to: f64,
    /// The measured frequencies next to it, below and above, rad/s.
    pub nearest: [Option<f64>; 2],
    /// Whether none was measured inside.
    pub agrees: bool,
}

/// The forbidden bands of an elastic solid against what was measured.
///
/// # Errors
/// The case is wrong.
pub fn gaps(case: &Case, rows: &[Row]) -> Result<Vec<Gap>, Error> {
    let solid = Solid::of(case).map_err(|error| case.locate(error))?;
    let Some(first) = rows.first().filter(|row| row.response == Response::Elastic) else {
        return Ok(Vec::new());
    };
    let kinds =
        kinds(&solid, &first.wave, first.wave.number, true).map_err(|error| error.locate(case))?;
    let bands = kinds.iter().flat_map(|kind| {
        let name = kind.family.polarisation.name();
        let inner = kind.bands.iter().filter(|band| band.from > 0.0 && band.to.is_finite());
        inner.map(move |band| (name, *band))
    });
    Ok(bands
        .map(|(name, band)| {
            let own = || rows.iter().filter(|row| row.branch.starts_with(name));
            let measured = || own().map(|row| row.limit.measured.frequency);
            let is_inside = |row: &Row| {
                let off =
                    (row.limit.expected.frequency - row.predicted).abs() + row.limit.tolerance;
                let found = row.limit.measured.frequency;
                !(found <= band.from + off || found >= band.to - off)
            };
            Gap {
                polarisation: name,
                from: band.from,
                to: band.to,
                nearest: [
                    measured().filter(|f| *f < band.to).max_by(f64::total_cmp),
                    measured().filter(|f| *f > band.from).min_by(f64::total_cmp),
                ],
                agrees: !own().any(is_inside),
            }
        })
        .collect())
}

/// Most cell-updates of a run.
const MOST_UPDATES: f64 = 2e9;
/// Roundings of a step, each of half a unit in the last place of the greatest field in units of energy: a
/// sweep has about ten on a path from field to field, and there are up to seven factors.
const ROUNDINGS: f64 = 64.0;
/// How far the background is from where the wave could take it back over the yield surface, over the most
/// that a wave of its energy can do.
const MARGIN: f64 = 2.0;
/// Stress of waves over that of the background where the yield surface is flat.
const ON_FLAT: f64 = 1e-3;

/// The rows of a solid, predicted by `predicted` and measured on `measured`, which is the same case but where
/// the check itself is tested.
///
/// # Errors
/// The case is wrong, or the solver does not take it.
pub fn rows(predicted: &Case, measured: &Case, plan: &Plan) -> Result<Vec<Row>, Error> {
    let solid = Solid::of(predicted).map_err(|error| predicted.locate(error))?;
    let medium = medium(measured, solid.dimensions).map_err(|error| measured.locate(error))?;
    let rows = match solid.dimensions {
        2 => Check::<2> { solid, medium, plan }.rows(),
        _ => Check::<3> { solid, medium, plan }.rows(),
    };
    rows.map_err(|error| match error {
        Failed::Input(error) => predicted.locate(error).into(),
        Failed::State(error) => error.locate(predicted),
    })
}

/// Why a check is not carried out.
enum Failed {
    Input(InputError),
    State(crate::frozen::StateError),
}

impl From<InputError> for Failed {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl From<crate::frozen::StateError> for Failed {
    fn from(error: crate::frozen::StateError) -> Self {
        Self::State(error)
    }
}

struct Check<'a, const D: usize> {
    solid: Solid,
    medium: Medium,
    plan: &'a Plan,
}

/// The uniform state that waves run through.
struct Background {
    stress: Stress,
    /// By unknown: the stress in which every active condition has the value one in units of energy.
    outward: DVector<f64>,
    is_curved: bool,
    /// Norm of the stress in units of energy, √(J/m³).
    size: f64,
}

/// A wave to be measured.
struct Branch<'a, const D: usize> {
    wave: Wave,
    vector: [f64; D],
    response: Response,
    label: String,
    predicted: f64,
    /// The greatest predicted frequency at this wave vector, rad/s.
    greatest: f64,
    /// The frequency in `equations`, rad/s: the predicted one but for rounding.
    own: f64,
    /// In units of energy.
    amplitude: Option<DVector<Complex64>>,
    equations: &'a Equations<D>,
    /// As [`Equations::most`] gives them; 0 where nothing yields.
    loads: [f64; 2],
}

impl<const D: usize> Check<'_, D> {
    fn rows(&self) -> Result<Vec<Row>, Failed> {
        let rates = self.solid.elastic.carried_rates::<D>();
        let unknowns: Vec<&str> = rates.unknowns.iter().map(|unknown| unknown.name).collect();
        let unusable = || InputError {
            key: "model",
            found: "a solid without positive energy, or dependent active conditions".into(),
            allowed: "moduli, and conditions that hold independently of each other".into(),
        };
        let form = rates.symmetric().ok_or_else(unusable)?;
        let velocities = rates.velocities();
        let normals = self.normals(velocities, unknowns.len());
        let elastic = Equations::new(&form, &[]).ok_or_else(unusable)?;
        let yielding = Equations::new(&form, &normals).ok_or_else(unusable)?;
        let background = self.background(&yielding)?;
        let responses = match background {
            None => vec![(Response::Elastic, true, &elastic)],
            Some(_) => {
                vec![(Response::Unloading, true, &elastic), (Response::Loading, false, &yielding)]
            }
        };
        let mut branches: Vec<Branch<D>> = Vec::new();
        for wave in &self.plan.waves {
            let direction = normal(wave);
            // What is left of a component by rounding is none.
            let component = |axis: usize| match direction[axis] {
                part if part.abs() < 1e-9 => 0.0,
                part => wave.number * part,
            };
            let vector = std::array::from_fn(component);
            for &(response, stays_elastic, equations) in &responses {
                let predicted = self.predicted(wave, stays_elastic)?;
                let waves = equations.waves(vector);
                let greatest = predicted.first().map_or(0.0, |own| own.1);
                let mut waves = waves.into_iter();
                for (label, predicted) in predicted {
                    // Without one the analysis contradicts itself: nothing is measured, and that fails.
                    let (own, amplitude) = waves.next().unzip();
                    let loads = amplitude.as_ref().map(|own| yielding.most(vector, own));
                    branches.push(Branch {
                        wave: *wave,
                        vector,
                        response,
                        label,
                        predicted,
                        greatest,
                        own: own.unwrap_or(f64::NAN),
                        amplitude,
                        equations,
                        loads: loads.unwrap_or_default(),
                    });
                }
            }
        }
        let runs: Vec<(&Branch<D>, usize)> = branches
            .iter()
            .flat_map(|branch| self.plan.cells.iter().map(move |&cells| (branch, cells)))
            .collect();
        for (branch, cells) in &runs {
            self.check_size(branch, *cells)?;
        }
        let progress = Progress::new("waves in time", runs.len() as u64);
        let runs: Vec<OnGrid> = runs
            .into_par_iter()
            .map(|(branch, cells)| {
                let found = self.on_grid(branch, cells, &unknowns, background.as_ref());
                progress.tick(1);
                found
            })
            .collect();
        let rows = branches.iter().zip(runs.chunks(self.plan.cells.len()));
        Ok(rows.map(|(branch, grids)| row(branch, grids.to_vec())).collect())
    }

    /// Labels and frequencies of the waves that move, rad/s, descending.
    fn predicted(&self, wave: &Wave, stays_elastic: bool) -> Result<Vec<(String, f64)>, Failed> {
        /// Frequencies below this part of the greatest are zero.
        const STILL: f64 = 1e-6;
        let kinds = kinds(&self.solid, wave, wave.number, stays_elastic)?;
        let mut all: Vec<(String, f64)> = kinds
            .iter()
            .flat_map(|kind| {
                kind.at(wave.number).into_iter().enumerate().flat_map(|(branch, point)| {
                    let label = kind.label(branch);
                    std::iter::repeat_n((label, point.frequency), kind.count)
                })
            })
            .collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        let greatest = all.first().map_or(0.0, |own| own.1);
        all.retain(|own| own.1 > STILL * greatest);
        Ok(all)
    }

    /// Gradients of the active conditions by all unknowns.
    fn normals(&self, velocities: usize, unknowns: usize) -> Vec<DVector<f64>> {
        let stresses: Vec<Component> = self.solid.carried_stresses::<D>();
        let active = self.solid.plastic.iter().flat_map(|plastic| &plastic.active);
        active
            .map(|condition| {
                let mut normal = DVector::zeros(unknowns);
                for (place, stress) in stresses.iter().enumerate() {
                    normal[velocities + place] = stress.derivative(&condition.normal);
                }
                normal
            })
            .collect()
    }

    fn background(&self, yielding: &Equations<D>) -> Result<Option<Background>, Failed> {
        let Some(plastic) = &self.solid.plastic else { return Ok(None) };
        let refused = |found: &str, allowed: &str| InputError {
            key: "yield",
            found: found.into(),
            allowed: allowed.into(),
        };
        let stress = match (&plastic.stress, &plastic.set) {
            (Some(stress), _) => *stress,
            (None, YieldSet::Interlayer(layers)) => {
                // On each active condition, by its own shear or couple stress alone.
                let mut stress = Stress::default();
                for (condition, strength) in
                    layers.half_spaces().filter(|own| plastic.active.contains(&own.0))
                {
                    let own = condition.normal;
                    for face in 0..2 {
                        stress.force[1 - face][face] += own.force[1 - face][face] * strength;
                        stress.couple[2][face] += own.couple[2][face] * strength;
                    }
                }
                stress
            }
            (None, YieldSet::Mises(_)) => Stress::default(),
        };
        let size = {
            let velocities = self.velocities();
            let stresses: Vec<Component> = self.solid.carried_stresses::<D>();
            let mut unknowns = DVector::zeros(velocities + stresses.len());
            for (place, own) in stresses.iter().enumerate() {
                unknowns[velocities + place] = own.of(&stress);
            }
            (&yielding.into_energy * unknowns).norm()
        };
        if plastic.set.active(&stress, 1e-9) != plastic.active || size == 0.0 {
            let found = "active conditions that no stress meets alone";
            let allowed = "positive strengths, or a section [stress] that decides";
            return Err(refused(found, allowed).into());
        }
        let outward = yielding.outward().ok_or_else(|| {
            let allowed = "conditions that flow together";
            refused("active conditions of which flow leaves one", allowed)
        })?;
        let is_curved = matches!(plastic.set, YieldSet::Mises(_));
        Ok(Some(Background { stress, outward, is_curved, size }))
    }

    fn grid(&self, branch: &Branch<D>, cells: usize) -> (Grid<D>, f64, usize) {
        let edges = branch.vector.map(|k| 2.0 * PI / (k.abs() * cells as f64));
        let longest = edges.iter().copied().filter(|edge| edge.is_finite()).fold(0.0, f64::max);
        let along = |axis: usize| edges[axis].is_finite();
        let grid = Grid {
            cells: std::array::from_fn(|axis| if along(axis) { cells } else { 1 }),
            // Nothing depends on an axis across the wave.
            spacing: std::array::from_fn(|axis| if along(axis) { edges[axis] } else { longest }),
        };
        let rate = |axis: usize| {
            let speeds = self.medium.pairs[axis].iter().map(|pair| pair.speed());
            speeds.fold(0.0, f64::max) / grid.spacing[axis]
        };
        let by_waves = 2.0 * self.plan.courant / (0..D).map(rate).fold(0.0, f64::max);
        // The coarsest grid's turn is the greatest.
        let coarsest = self.plan.cells[0] as f64 / cells as f64;
        let by_rotation = self
            .medium
            .rotation
            .map_or(f64::INFINITY, |rotation| self.plan.rotation / rotation.frequency * coarsest);
        let period = 2.0 * PI / branch.predicted;
        // As many steps to a cell on all grids: one Courant number.
        let per_cell = period / (by_waves.min(by_rotation) * cells as f64) * (1.0 - 1e-12);
        (grid, period, per_cell.ceil().max(1.0) as usize)
    }

    /// That a run is not longer than anybody waits for.
    fn check_size(&self, branch: &Branch<D>, cells: usize) -> Result<(), InputError> {
        let (grid, _, per_cell) = self.grid(branch, cells);
        let updates = (cells * per_cell) as f64 * grid.count() as f64;
        if updates <= MOST_UPDATES {
            return Ok(());
        }
        Err(InputError {
            key: "check.numbers",
            found: format!("a wave of {updates:.1e} cell-updates at {} 1/m", branch.wave.number),
            allowed: format!("at most {MOST_UPDATES:.0e}: a greater wave number, or fewer cells"),
        })
    }

    fn on_grid(
        &self,
        branch: &Branch<D>,
        cells: usize,
        unknowns: &[&str],
        background: Option<&Background>,
    ) -> OnGrid {
        let nothing = Rate { frequency: f64::NAN, growth: f64::NAN };
        let failed = OnGrid { cells, measured: nothing, expected: nothing, tolerance: 0.0 };
        let Some(amplitude) = &branch.amplitude else { return failed };
        let (grid, period, per_cell) = self.grid(branch, cells);
        let count = cells * per_cell;
        let steps = Steps { spacing: grid.spacing, step: period / count as f64 };
        // What the wave's stress and the flow that carries it turn a curved surface, and the rounding of the
        // whole stress.
        let (size, disturbed) = match background {
            None => (1.0, 0.0),
            Some(own) => {
                let part = if own.is_curved { f64::EPSILON.sqrt() } else { ON_FLAT };
                // In units of energy: components of stress and of couple stress differ in unit.
                let stress = amplitude.rows_range(self.velocities()..).norm();
                let size = part * own.size / stress;
                // The rates of flow add up over a period; a turn of the normal counts twice.
                let turned = if own.is_curved { 4.0 * PI * MARGIN * part } else { 0.0 };
                let rounded = count as f64 * f64::EPSILON / part;
                let is_loading = branch.response == Response::Loading;
                (size, if is_loading { turned + rounded } else { 0.0 })
            }
        };
        let rounding = ROUNDINGS * f64::EPSILON * count as f64 + disturbed;
        let expected = {
            let step = branch.equations.step(branch.vector, &steps);
            let mut state = amplitude.clone();
            let mut amplitudes = vec![Complex64::from(1.0)];
            for _ in 0..cells {
                for _ in 0..per_cell {
                    state = &step * state;
                }
                amplitudes.push(amplitude.dotc(&state));
            }
            amplitudes
        };
        let (amplitude, scale) = (amplitude * Complex64::from(size), 1.0 / (size * size));
        let run = Run { check: self, branch, grid, steps, unknowns, background };
        let measured = run.amplitudes(&amplitude, cells, per_cell);
        let measured: Vec<Complex64> = measured.iter().map(|own| own * scale).collect();
        let times: Vec<f64> =
            (0..=cells).map(|index| (index * per_cell) as f64 * steps.step).collect();
        // What the scheme adds to the predicted frequency. That is the root of an eigenvalue ω², which is known
        // to the rounding of the greatest.
        let mut expected = rate(&times, &expected);
        expected.frequency += branch.predicted - branch.own;
        let ratio = branch.greatest / branch.predicted;
        let of_root = ROUNDINGS * f64::EPSILON * branch.greatest * ratio;
        OnGrid {
            cells,
            measured: rate(&times, &measured),
            expected,
            tolerance: error_of_rate(rounding, period) + of_root,
        }
    }

    fn velocities(&self) -> usize {
        self.solid.elastic.carried_rates::<D>().velocities()
    }
}

fn row<const D: usize>(branch: &Branch<D>, grids: Vec<OnGrid>) -> Row {
    let cells: Vec<usize> = grids.iter().map(|grid| grid.cells).collect();
    let limit = |of: &dyn Fn(&OnGrid) -> Rate| {
        extrapolated(&cells, &grids.iter().map(of).collect::<Vec<_>>())
    };
    let errors: Vec<f64> = grids.iter().map(|grid| grid.tolerance).collect();
    let limit = OnGrid {
        cells: 0,
        measured: limit(&|grid| grid.measured),
        expected: limit(&|grid| grid.expected),
        tolerance: error_of_extrapolated(&cells, &errors),
    };
    Row {
        wave: branch.wave,
        response: branch.response,
        branch: branch.label.clone(),
        predicted: branch.predicted,
        grids,
        limit,
    }
}

/// A run of the solver: one wave through a periodic box of one period along each axis.
struct Run<'a, const D: usize> {
    check: &'a Check<'a, D>,
    branch: &'a Branch<'a, D>,
    grid: Grid<D>,
    steps: Steps<D>,
    unknowns: &'a [&'a str],
    background: Option<&'a Background>,
}

impl<const D: usize> Run<'_, D> {
    /// The amplitude of the wave after every `per_cell` steps, in units of energy.
    fn amplitudes(
        &self,
        amplitude: &DVector<Complex64>,
        cells: usize,
        per_cell: usize,
    ) -> Vec<Complex64> {
        let equations = self.branch.equations;
        let problem = self.problem(amplitude);
        let Ok(mut domain) = Domain::<f64, D>::new(&problem) else { return Vec::new() };
        let fields: Vec<(Field, usize)> = domain
            .fields()
            .iter()
            .filter_map(|&field| {
                let name = unknown_name(field);
                Some((field, self.unknowns.iter().position(|own| *own == name)?))
            })
            .collect();
        let waves: Vec<Complex64> =
            (0..self.grid.count()).map(|cell| Complex64::cis(self.phase(cell))).collect();
        let wave = equations.from_energy.map(Complex64::from) * amplitude;
        let offset = self.offset(amplitude);
        for &(field, place) in &fields {
            let uniform = offset.as_ref().map_or(0.0, |own| own[place]);
            let values: Vec<f64> =
                waves.iter().map(|phase| uniform + (wave[place] * phase).re).collect();
            domain.set(field, &values);
        }
        let share = 2.0 / waves.len() as f64;
        let into_energy = equations.into_energy.map(Complex64::from);
        let measure = |domain: &Domain<f64, D>| {
            let mut state = DVector::zeros(self.unknowns.len());
            for &(field, place) in &fields {
                let values = domain.values(field).unwrap_or_default();
                let sum: Complex64 =
                    values.iter().zip(&waves).map(|(value, phase)| phase.conj() * *value).sum();
                state[place] = sum * share;
            }
            amplitude.dotc(&(&into_energy * state))
        };
        let mut all = vec![measure(&domain)];
        for _ in 0..cells {
            (0..per_cell).for_each(|_| domain.advance());
            all.push(measure(&domain));
        }
        all
    }

    /// κ·x in the middle of a cell.
    fn phase(&self, cell: usize) -> f64 {
        let mut rest = cell;
        let mut phase = 0.0;
        for axis in 0..D {
            let index = rest % self.grid.cells[axis];
            rest /= self.grid.cells[axis];
            phase += self.branch.vector[axis] * self.grid.spacing[axis] * (index as f64 + 0.5);
        }
        phase
    }

    fn problem(&self, amplitude: &DVector<Complex64>) -> Problem<D> {
        let count = self.grid.count();
        let mut problem = Problem::new(
            self.grid,
            vec![self.check.medium.clone()],
            vec![0; count],
            std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
            self.steps.step,
            Scheme::new(Slopes::Unlimited, Placement::Middle),
        );
        let Some(background) = self.background else { return problem };
        problem.initial_stress = Some((0, vec![background.stress; self.grid.cells[0]]));
        if self.branch.response == Response::Loading {
            // A stress source relieves its amplitude times its signal: here −t.
            let rate = MARGIN * amplitude.norm() * self.branch.loads[1];
            let volume = self.grid.volume() * count as f64;
            let amplitudes = self.check.medium.fields.iter().filter_map(|&field| {
                let name = unknown_name(field);
                let place = self.unknowns.iter().position(|own| *own == name)?;
                let value = background.outward[place] * rate * volume;
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

    /// How far inside its yield surface an unloading background stands, by unknown.
    fn offset(&self, amplitude: &DVector<Complex64>) -> Option<DVector<f64>> {
        let background = self.background?;
        (self.branch.response == Response::Unloading)
            .then(|| &background.outward * (-MARGIN * amplitude.norm() * self.branch.loads[0]))
    }
}
