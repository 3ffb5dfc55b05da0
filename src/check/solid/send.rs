//! Sends waves through the solver.

use super::{Measured, OnGrid, Plan, Response, Row};
use crate::Error;
use crate::case::dynamics::{Correction, Splitting};
use crate::case::{Case, Wave};
use crate::check::fit::{Powers, Rate, error_of_extrapolated, error_of_rate, extrapolated, rate};
use crate::check::scheme::{Equations, Steps};
use crate::dispersion::kinds;
use crate::progress::Progress;
use crate::run::{medium, unknown_name};
use crate::setup::{self, solid::normal};
use analysis::StateError;
use dynamics::boundary::{Boundary, Source};
use dynamics::domain::Domain;
use dynamics::line::Slopes;
use dynamics::medium::Medium;
use dynamics::problem::{self, Grid, Placement, Problem, Scheme};
use models::cosserat::stress::{Component, Stress};
use models::cosserat::waves::Field;
use models::elastoplastic::Solid;
use models::elementary::cr_cis;
use models::granular_flow::InputError;
use models::plasticity::parameters::ActiveCondition;
use nalgebra::DVector;
use num_complex::Complex64;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

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
    let solid = setup::solid::solid(predicted).map_err(|error| predicted.locate(error))?;
    let medium = medium(measured, solid.dimensions).map_err(|error| measured.locate(error))?;
    let rows = match solid.dimensions {
        2 => Check::<2> { solid, medium, plan }.rows(),
        _ => Check::<3> { solid, medium, plan }.rows(),
    };
    rows.map_err(|error| match error {
        Failed::Input(error) => predicted.locate(error).into(),
        Failed::State(error) => setup::locate(predicted, error),
    })
}

/// Why a check is not carried out.
enum Failed {
    Input(InputError),
    State(StateError),
}

impl From<InputError> for Failed {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

impl From<StateError> for Failed {
    fn from(error: StateError) -> Self {
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
    /// The greatest wave, likewise, that meets no condition but the active ones.
    room: f64,
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
        let normals = self.normals();
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
                    // Without one both parts of the analysis contradict each other: there is nothing to send.
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
        let runs: Vec<Result<OnGrid, String>> = runs
            .into_par_iter()
            .map(|(branch, cells)| {
                let found = self.on_grid(branch, cells, &unknowns, background.as_ref());
                progress.tick(1);
                found
            })
            .collect();
        let rows = branches.iter().zip(runs.chunks(self.plan.cells.len()));
        Ok(rows.map(|(branch, grids)| self.row(branch, grids)).collect())
    }

    fn row(&self, branch: &Branch<D>, grids: &[Result<OnGrid, String>]) -> Row {
        let powers = match (self.plan.correction, self.plan.splitting) {
            (Correction::SecondOrder, _) => Powers::SYMMETRIC,
            _ if branch.response == Response::Loading => Powers::PROJECTED,
            (_, Splitting::TwoCyclic) => Powers::SYMMETRIC,
            (_, Splitting::Alternating) => Powers::ALTERNATING,
        };
        let grids: Result<Vec<OnGrid>, String> = grids.iter().cloned().collect();
        Row {
            wave: branch.wave,
            response: branch.response,
            branch: branch.label.clone(),
            predicted: branch.predicted,
            measured: grids.map(|grids| in_the_limit(grids, powers)),
        }
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
    fn normals(&self) -> Vec<DVector<f64>> {
        let active = self.solid.plastic.iter().flat_map(|plastic| &plastic.active);
        active.map(|condition| self.normal(condition)).collect()
    }

    fn normal(&self, condition: &ActiveCondition) -> DVector<f64> {
        let velocities = self.velocities();
        let stresses: Vec<Component> = self.solid.carried_stresses::<D>();
        let mut normal = DVector::zeros(velocities + stresses.len());
        for (place, stress) in stresses.iter().enumerate() {
            normal[velocities + place] = stress.derivative(&condition.normal);
        }
        normal
    }

    fn background(&self, yielding: &Equations<D>) -> Result<Option<Background>, Failed> {
        let Some(plastic) = &self.solid.plastic else { return Ok(None) };
        let refused = |found: &str, allowed: &str| InputError {
            key: "yield",
            found: found.into(),
            allowed: allowed.into(),
        };
        let half_spaces = plastic.set.half_spaces();
        let is_curved = half_spaces.is_none();
        let half_spaces = half_spaces.unwrap_or_default();
        let stress = match &plastic.stress {
            Some(stress) => *stress,
            None => {
                // On each active condition, by its own shear or couple stress alone.
                let mut stress = Stress::default();
                for (condition, strength) in
                    half_spaces.iter().filter(|own| plastic.active.contains(&own.0))
                {
                    let own = condition.normal;
                    for face in 0..2 {
                        stress.force[1 - face][face] += own.force[1 - face][face] * strength;
                        stress.couple[2][face] += own.couple[2][face] * strength;
                    }
                }
                stress
            }
        };
        let velocities = self.velocities();
        let stresses: Vec<Component> = self.solid.carried_stresses::<D>();
        let mut unknowns = DVector::zeros(velocities + stresses.len());
        for (place, own) in stresses.iter().enumerate() {
            unknowns[velocities + place] = own.of(&stress);
        }
        let size = (&yielding.into_energy * &unknowns).norm();
        let mut room = size;
        for (condition, strength) in
            half_spaces.iter().filter(|own| !plastic.active.contains(&own.0))
        {
            let normal = self.normal(condition);
            // By L⁻¹ as normals are.
            let scaled = yielding.from_energy.transpose() * &normal;
            room = room.min((strength - normal.dot(&unknowns)) / scaled.norm());
        }
        if plastic.set.active(&stress, 1e-9) != plastic.active || room <= 0.0 {
            let found = "active conditions that no stress meets alone";
            let allowed = "positive strengths, or a section [stress] that decides";
            return Err(refused(found, allowed).into());
        }
        let outward = yielding.outward().ok_or_else(|| {
            let allowed = "conditions that flow together";
            refused("active conditions of which flow leaves one", allowed)
        })?;
        Ok(Some(Background { stress, outward, is_curved, size, room }))
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
    ) -> Result<OnGrid, String> {
        let Some(amplitude) = &branch.amplitude else {
            return Err("the equations in units of energy have no such wave".to_owned());
        };
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
                let size = part * own.room / stress;
                // The rates of flow add up over a period; a turn of the normal counts twice.
                let turned = if own.is_curved { 4.0 * PI * MARGIN * part } else { 0.0 };
                let rounding = f64::EPSILON * own.size / (part * own.room);
                if rounding > 0.1 {
                    let found =
                        "the background's stress, rounded, hides any wave that meets no other";
                    return Err(format!("{found} yield condition"));
                }
                let is_loading = branch.response == Response::Loading;
                (size, if is_loading { turned + count as f64 * rounding } else { 0.0 })
            }
        };
        let rounding = ROUNDINGS * f64::EPSILON * count as f64 + disturbed;
        let Plan { correction, splitting, .. } = *self.plan;
        let expected = branch
            .equations
            .propagator(branch.vector, &steps, correction, splitting)
            .amplitudes(amplitude, per_cell, cells);
        let (amplitude, scale) = (amplitude * Complex64::from(size), 1.0 / (size * size));
        let run = Run { check: self, branch, grid, steps, unknowns, background };
        let measured = run.amplitudes(&amplitude, cells, per_cell)?;
        let measured: Vec<Complex64> = measured.iter().map(|own| own * scale).collect();
        if !measured.iter().chain(&expected).all(|own| own.is_finite() && own.norm() > 0.0) {
            return Err("amplitudes that vanish or are not finite".to_owned());
        }
        let times: Vec<f64> =
            (0..=cells).map(|index| (index * per_cell) as f64 * steps.step).collect();
        // What the scheme adds to the predicted frequency. That is the root of an eigenvalue ω², which is known
        // to the rounding of the greatest.
        let mut expected = rate(&times, &expected);
        expected.frequency += branch.predicted - branch.own;
        let ratio = branch.greatest / branch.predicted;
        let of_root = ROUNDINGS * f64::EPSILON * branch.greatest * ratio;
        Ok(OnGrid {
            cells,
            measured: rate(&times, &measured),
            expected,
            tolerance: error_of_rate(rounding, period) + of_root,
        })
    }

    fn velocities(&self) -> usize {
        self.solid.elastic.carried_rates::<D>().velocities()
    }
}

fn in_the_limit(grids: Vec<OnGrid>, powers: Powers) -> Measured {
    let cells: Vec<usize> = grids.iter().map(|grid| grid.cells).collect();
    let limit = |of: &dyn Fn(&OnGrid) -> Rate| {
        extrapolated(&cells, &grids.iter().map(of).collect::<Vec<_>>(), powers)
    };
    let errors: Vec<f64> = grids.iter().map(|grid| grid.tolerance).collect();
    let limit = OnGrid {
        cells: 0,
        measured: limit(&|grid| grid.measured),
        expected: limit(&|grid| grid.expected),
        tolerance: error_of_extrapolated(&cells, &errors, powers),
    };
    Measured { grids, limit }
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
    /// The amplitude of the wave after every `per_cell` steps, in units of energy; or why there is none.
    fn amplitudes(
        &self,
        amplitude: &DVector<Complex64>,
        cells: usize,
        per_cell: usize,
    ) -> Result<Vec<Complex64>, String> {
        let equations = self.branch.equations;
        let problem = self.problem(amplitude);
        let mut domain = Domain::<f64, D>::new(&problem).map_err(|error| error.to_string())?;
        let fields: Vec<Field> = domain.fields().to_vec();
        let place = |field: &Field| {
            let name = unknown_name(*field);
            self.unknowns.iter().position(|own| *own == name)
        };
        let places: Vec<Option<usize>> = fields.iter().map(place).collect();
        let waves: Vec<Complex64> =
            (0..self.grid.count()).map(|cell| cr_cis(self.phase(cell))).collect();
        let wave = equations.from_energy.map(Complex64::from) * amplitude;
        let offset = self.offset(amplitude);
        for (&field, place) in fields.iter().zip(&places) {
            let Some(place) = *place else { continue };
            let uniform = offset.as_ref().map_or(0.0, |own| own[place]);
            let values: Vec<f64> =
                waves.iter().map(|phase| uniform + (wave[place] * phase).re).collect();
            domain.set(field, &values);
        }
        let into_energy = equations.into_energy.map(Complex64::from);
        let count = domain.fields().len();
        let measure = |domain: &Domain<f64, D>, index: usize| {
            let line = self.line(index);
            let share = 2.0 / line.len() as f64;
            let values = domain.deviations(&line);
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

    /// Cells over a period of the wave on a line along an axis: measuring completes steps cell by cell, which takes
    /// long. One line after the other, so that all rows are seen.
    fn line(&self, index: usize) -> Vec<usize> {
        let counts = self.grid.cells;
        let axis = counts.iter().position(|count| *count > 1).unwrap_or(0);
        let stride = |axis: usize| counts[..axis].iter().product::<usize>();
        let first: usize =
            (0..D).filter(|own| *own != axis).map(|own| index % counts[own] * stride(own)).sum();
        (0..counts[axis]).map(|own| first + own * stride(axis)).collect()
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
            Scheme {
                placement: match self.check.plan.correction {
                    Correction::FirstOrder => Placement::Last,
                    Correction::SecondOrder => Placement::Middle,
                },
                splitting: match self.check.plan.splitting {
                    Splitting::Alternating => problem::Splitting::Alternating,
                    Splitting::TwoCyclic => problem::Splitting::TwoCyclic,
                },
                ..Scheme::new(Slopes::FourthOrder, Placement::Last)
            },
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
