//! Waves behind a piston.

use super::column::{Column, ColumnGrid, ColumnState, EndCondition, TASKS};
use super::{ColumnResult, ShockResult, Tolerances};
use crate::{AgreementError, MeasurementError, ProgressCallback, TaskProgress};
use analysis::plane_shocks::{PistonLoad, PistonSolution, Profile, Release, Wave, plastic_work};
use dynamics::boundary::Condition;
use dynamics::contact_law::ContactLaw;
use dynamics::medium::Medium;
use models::common::elementary::Elementary;
use models::rheology::relaxation::SymmetricTensor;
use models::solid::waves::SolidField;
use models::uniaxial::UniaxialDiagram;
use std::f64::consts::PI;

/// Waves behind a piston, exact and in the solver.
#[derive(Clone, Debug)]
pub struct PistonColumn<'a> {
    /// Medium of the solver, in the plane.
    pub medium: &'a Medium,
    /// Load on the piston.
    pub load: PistonLoad,
    /// Exact solution.
    pub solution: &'a PistonSolution,
    /// Exact waves of the end of the load.
    pub release: Option<&'a Release>,
    /// Diagrams of loading and of unloading.
    pub diagrams: [&'a UniaxialDiagram; 2],
    /// Plastic work of yielding particles or of the yielding skeleton per unit of strain, Pa; 0 in elastic media.
    pub plastic_power: f64,
    /// Time of the profile, s; before the overtaking.
    pub time: f64,
}

/// Courant number of the fastest waves of closed contacts.
const COURANT_NUMBER: f64 = 0.8;

/// Length of the column relative to the path of the fastest wave.
const LENGTH_FACTOR: f64 = 1.1;

/// A front of the exact solution at a time.
struct Front<'a> {
    wave: &'a Wave,
    /// Time at which the wave leaves the piston, s.
    start: f64,
}

/// Interval behind a front in which the tails of both fronts are negligible.
struct Plateau {
    /// Positions, m; empty if the fronts are too close.
    range: [f64; 2],
    /// Description of the distance of the fronts and of their tails, in cells.
    tails: String,
}

impl Front<'_> {
    fn position(&self, time: f64) -> f64 {
        self.wave.speed * (time - self.start)
    }
}

/// Compares the waves behind a piston on a column of `cells` cells.
///
/// # Errors
/// The inner error is the reason why the solver cannot measure; the outer one is that of a cancelled run.
pub fn compare_piston(
    own: &PistonColumn,
    cells: usize,
    on_progress: ProgressCallback,
) -> Result<Result<ColumnResult, MeasurementError>, AgreementError> {
    let progress = TaskProgress::new(on_progress, TASKS)?;
    let (grid, half) = own.grid(cells);
    let mut column = match own.column(grid) {
        Ok(column) => column,
        Err(error) => return Ok(Err(error)),
    };
    column.advance_to(half, &progress)?;
    let middle = column.state();
    column.advance_to(grid.steps, &progress)?;
    let end = column.state();
    let times = [half, grid.steps].map(|steps| steps as f64 * grid.step);
    let tolerances = Tolerances::new(cells);
    let fronts = own.fronts();
    let mut rows = Vec::new();
    for index in 0..fronts.len() {
        rows.push(own.speed_row(&fronts, index, [&middle, &end], times, tolerances.speed));
    }
    own.add_plateau_rows(&mut rows, &fronts, (&end, times[1]), tolerances.plateau);
    let (time, dissipation) = ((times[1], grid.spacing), column.dissipation());
    own.add_dissipation_rows(&mut rows, &fronts, time, dissipation, tolerances.dissipation);
    if let (Some(profile), Some(front)) = (own.exact_profile(times[1]), fronts.last()) {
        let length = front.position(times[1]);
        let error = end.mean_error(&end.pressure, |x| pressure_integral(&profile, x));
        rows.push(ShockResult {
            quantity: "mean error of the pressure".into(),
            unit: "Pa",
            predicted: 0.0,
            measured: Ok(error / length),
            scale: own.solution.piston.pressure,
            tolerance: tolerances.profile,
        });
    }
    let profile = end.velocity.iter().zip(&end.pressure).map(|(v, p)| [*v, *p]).collect();
    Ok(Ok(ColumnResult {
        cells,
        steps: grid.steps,
        rows,
        time: times[1],
        spacing: grid.spacing,
        profile,
    }))
}

impl PistonColumn<'_> {
    /// Waves of the end of the load that exist at the time of the profile.
    fn active_release(&self) -> Option<&Release> {
        self.release.filter(|own| own.duration < self.time)
    }

    /// Returns the fronts in ascending order of position.
    fn fronts(&self) -> Vec<Front<'_>> {
        let release = self
            .active_release()
            .into_iter()
            .flat_map(|own| own.waves.iter().rev().map(|wave| Front { wave, start: own.duration }));
        release
            .chain(self.solution.waves.iter().rev().map(|wave| Front { wave, start: 0.0 }))
            .collect()
    }

    fn exact_profile(&self, time: f64) -> Option<Profile> {
        match self.active_release() {
            Some(own) => self.solution.profile_with_release(own, time),
            None => Some(self.solution.profile(time)),
        }
    }

    /// Returns the grid, and the step of the first measurement: half-way from the start of the last waves to the end.
    fn grid(&self, cells: usize) -> (ColumnGrid, usize) {
        let fastest = self.solution.fastest_speed();
        let spacing = LENGTH_FACTOR * fastest * self.time / cells as f64;
        let longest = 2.0 * COURANT_NUMBER * spacing / self.medium.max_speed();
        match self.active_release() {
            // The load ends between two steps.
            Some(own) => {
                let loaded = (own.duration / longest).ceil();
                let step = own.duration / loaded;
                let steps = (self.time / step) as usize;
                (ColumnGrid { cells, spacing, step, steps }, (loaded as usize + steps).div_ceil(2))
            }
            None => {
                let half = (0.5 * self.time / longest).ceil();
                let grid = ColumnGrid {
                    cells,
                    spacing,
                    step: 0.5 * self.time / half,
                    steps: 2 * half as usize,
                };
                (grid, half as usize)
            }
        }
    }

    fn column(&self, grid: ColumnGrid) -> Result<Column, MeasurementError> {
        let (condition, released) = match self.load {
            PistonLoad::Pressure(pressure) => (Condition::Traction(-pressure), pressure),
            PistonLoad::Speed(speed) => (Condition::Velocity(speed), -speed),
        };
        let change = self.active_release().map(|own| (own.duration, released));
        let mut column = Column::new(self.medium, grid, EndCondition { condition, change })?;
        if let Some(ContactLaw::Granular { law, closed, .. }) = &self.medium.contact {
            let strain = -self.solution.initial.strain;
            let conditional = SymmetricTensor::<f64, 1> {
                normal: [closed.lambda + 2.0 * closed.mu, closed.lambda, closed.lambda]
                    .map(|modulus| modulus * strain),
                shear: [0.0],
            };
            let state = law.complete_step(conditional, SymmetricTensor::ZERO);
            for i in 0..3 {
                column.set_field(SolidField::Stress(i, i), |_| state.stress.normal[i]);
                column.set_field(SolidField::ExcessStress(i, i), |_| state.excess.normal[i]);
            }
        }
        Ok(column)
    }

    /// Compares the speed of a front, from its positions at two times: the positions where the velocity is the mean of
    /// the velocities at both sides, between the middles of the intervals at both sides.
    fn speed_row(
        &self,
        fronts: &[Front],
        index: usize,
        states: [&ColumnState; 2],
        times: [f64; 2],
        tolerance: f64,
    ) -> ShockResult {
        let front = &fronts[index];
        let wave = front.wave;
        let level = 0.5 * (wave.ahead.velocity + wave.behind.velocity);
        let position = |(state, time): (&ColumnState, f64)| {
            let here = front.position(time);
            let below = index.checked_sub(1).map_or(0.0, |below| fronts[below].position(time));
            let above =
                fronts.get(index + 1).map_or(LENGTH_FACTOR * here, |own| own.position(time));
            state.crossing(&state.velocity, level, [0.5 * (below + here), 0.5 * (above + here)])
        };
        let [first, last] = [(states[0], times[0]), (states[1], times[1])].map(position);
        let speed = first.zip(last).map(|(first, last)| (last - first) / (times[1] - times[0]));
        // A front that the solver does not have is a disagreement, if the column resolves the plateaus beside it.
        let plateau = |index: usize| {
            let plateau = self.plateau(fronts, index, (times[1], states[1].spacing));
            states[1].mean(&states[1].velocity, plateau.range).is_none().then_some(plateau.tails)
        };
        let unresolved = plateau(index).or_else(|| {
            fronts.get(index + 1)?;
            plateau(index + 1)
        });
        let measured = match (speed, unresolved) {
            (Some(speed), _) => Ok(speed),
            (None, Some(tails)) => Err(tails),
            (None, None) => Ok(f64::NAN),
        };
        ShockResult {
            quantity: format!("speed of the {}", wave.kind.name()),
            unit: "m/s",
            predicted: wave.speed,
            measured,
            scale: wave.speed,
            tolerance,
        }
    }

    /// Compares the states between fronts, where the tails of both fronts are negligible.
    fn add_plateau_rows(
        &self,
        rows: &mut Vec<ShockResult>,
        fronts: &[Front],
        (state, time): (&ColumnState, f64),
        tolerance: f64,
    ) {
        let piston = self.solution.piston;
        for (index, front) in fronts.iter().enumerate() {
            let exact = front.wave.behind;
            let place = match index {
                0 => "at the piston".to_owned(),
                _ => format!("behind the {}", front.wave.kind.name()),
            };
            let Plateau { range, tails } = self.plateau(fronts, index, (time, state.spacing));
            let mut add = |name: &str, unit, predicted: f64, values: &[f64], piston: f64| {
                rows.push(ShockResult {
                    quantity: format!("{name} {place}"),
                    unit,
                    predicted,
                    measured: state.mean(values, range).ok_or_else(|| tails.clone()),
                    scale: if predicted == 0.0 { piston } else { predicted.abs() },
                    tolerance,
                });
            };
            add("velocity", "m/s", exact.velocity, &state.velocity, piston.velocity);
            add("pressure", "Pa", exact.pressure, &state.pressure, piston.pressure);
            if !state.compression.is_empty() {
                add("compression", "", exact.strain, &state.compression, piston.strain);
            }
        }
    }

    /// Returns the plateau behind a front: the middle half, and at least 4 spreads from both fronts.
    fn plateau(&self, fronts: &[Front], index: usize, (time, spacing): (f64, f64)) -> Plateau {
        /// Distance from a front relative to its spread.
        const MARGIN: f64 = 4.0;
        let margin = |own: &Front| MARGIN * self.spread(own, time, spacing);
        let (here, margin_here) = (fronts[index].position(time), margin(&fronts[index]));
        let (below, margin_below) = match index.checked_sub(1) {
            Some(below) => (fronts[below].position(time), margin(&fronts[below])),
            None => (0.0, 0.0),
        };
        let quarter = 0.25 * (here - below);
        let [distance, spread] =
            [here - below, margin_below + margin_here].map(|own| (own / spacing).round());
        Plateau {
            range: [below + margin_below.max(quarter), here - margin_here.max(quarter)],
            tails: format!("{distance} cells between fronts whose tails take {spread}"),
        }
    }

    /// Returns an upper bound of the spread of a front in the solver, m.
    ///
    /// - A front of a medium that does not yield and keeps its state, after n cells of the length h: hn^{1/3} in a scheme
    ///   of second order (Harten 1978).
    /// - A front of a yielding medium, where the scheme is of first order with the speed c_s of the stiffest medium: the
    ///   standard deviation √(2νt), with the numerical viscosity ν = ½h(c_s − Cc²/c_s) of the Courant number C.
    /// - A shock is steady where the speeds of sound on its sides differ by Δc: 4ν/Δc, if that is less.
    fn spread(&self, front: &Front, time: f64, spacing: f64) -> f64 {
        let wave = front.wave;
        let path = front.position(time);
        let stiffest = self.medium.max_speed();
        let viscosity =
            0.5 * spacing * (stiffest - COURANT_NUMBER * wave.speed * wave.speed / stiffest);
        let first_order = (2.0 * viscosity * (time - front.start)).sqrt();
        let [ahead, behind] = wave.sound_speeds;
        match (wave.is_shock, wave.segment_states[1].is_plastic()) {
            (true, _) => first_order.min(4.0 * viscosity / (behind - ahead).abs()),
            (false, true) => first_order,
            (false, false) => spacing * (path / spacing).cr_powf(1.0 / 3.0),
        }
    }

    /// Compares the energy dissipated. A front of the spread s lacks the energy [p][ε]s/√π in addition: ∫φ(1 − φ)dx of
    /// φ = ½erfc(x/(√2 s)).
    fn add_dissipation_rows(
        &self,
        rows: &mut Vec<ShockResult>,
        fronts: &[Front],
        (time, spacing): (f64, f64),
        [plastic, numerical]: [f64; 2],
        tolerance: f64,
    ) {
        let (mut exact, mut lacking) = ([0.0; 2], 0.0);
        for front in fronts {
            let (swept, wave) = (front.position(time), front.wave);
            let diagram = self.diagrams[usize::from(front.start > 0.0)];
            let strains = [wave.ahead.strain, wave.behind.strain];
            exact[0] += swept * plastic_work(diagram, strains, self.plastic_power);
            exact[1] += swept * wave.dissipation;
            let jump = (wave.behind.pressure - wave.ahead.pressure) * (strains[1] - strains[0]);
            lacking += jump * self.spread(front, time, spacing) / PI.sqrt();
        }
        let piston = self.solution.piston;
        let mut add = |name: &str, predicted: f64, measured: f64| {
            let scale = match predicted > 0.0 {
                true => predicted,
                false => piston.pressure * piston.velocity * time,
            };
            rows.push(ShockResult {
                quantity: name.into(),
                unit: "J/m²",
                predicted,
                measured: Ok(measured),
                scale,
                tolerance: tolerance + lacking / scale,
            });
        };
        // The return mapping of a yield set counts its own loss in the step as plastic dissipation; the law of granular
        // media does not.
        if self.medium.is_plastic() && self.medium.yield_set.is_none() {
            add("plastic dissipation", exact[0], plastic);
            add("dissipation at fronts", exact[1], numerical);
        } else {
            add("dissipation", exact[0] + exact[1], plastic + numerical);
        }
    }
}

/// Integral of the pressure of a profile from 0 to `x`.
fn pressure_integral(profile: &Profile, x: f64) -> f64 {
    let part = |piece: &analysis::plane_shocks::ProfilePiece| {
        let [from, to] = piece.range;
        piece.state.pressure * (x.min(to) - from).max(0.0)
    };
    profile.pieces.iter().map(part).sum()
}
