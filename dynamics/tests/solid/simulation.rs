//! Simulation driver: its output, bitwise reproducibility after interruptions, and runs that end with a fault.

use models::interface::elastic::ElasticMaterial;
use models::solid::parameters::Isotropic;
use models::solid::waves::Field;
use std::f64::consts::{FRAC_PI_6, TAU};
use std::fmt::Debug;
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Source};
use wellposed_dynamics::flow::perturbation::{Lattice, wave};
use wellposed_dynamics::flow::{self, Closure};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::probe::Probe;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::simulation::{
    End, FlowSimulation, Observer, OutputTimes, RegularTimes, Simulation, SolidSimulation,
    SolverChoice, State, TimeSteps, drive,
};
use wellposed_dynamics::solid::interlayers::Interlayers;

/// Observer that logs all output and interrupts the run after every `interruption` calls of `after_steps`.
#[derive(Default)]
struct Log {
    records: Vec<String>,
    accounts: Vec<String>,
    snapshots: Vec<String>,
    looks: usize,
    interruption: Option<usize>,
    /// Number of calls of `after_steps` after which a state is saved while the run continues.
    saving: Option<usize>,
    /// Number of batches of steps that were repeated.
    replays: usize,
    /// Number of repeated batches after which the run is interrupted.
    patience: Option<usize>,
}

impl<S: Simulation<Account: Debug, Fields: Debug>> Observer<S> for Log {
    /// State at the interruption.
    type Error = State;

    fn record(&mut self, time: f64, values: &[f64]) -> Result<(), State> {
        self.records.push(format!("{time:?} {values:?}"));
        Ok(())
    }

    fn account(&mut self, account: &S::Account) -> Result<(), State> {
        self.accounts.push(format!("{account:?}"));
        Ok(())
    }

    fn snapshot(&mut self, _: &S, index: usize, time: f64, own: S::Fields) -> Result<(), State> {
        self.snapshots.push(format!("{index} {time:?} {own:?}"));
        Ok(())
    }

    fn replay(&mut self) -> Result<(), State> {
        self.replays += 1;
        match self.patience {
            Some(patience) if self.replays > patience => Err(State {
                steps: 0,
                time: 0.0,
                initial_energy: 0.0,
                sections: Default::default(),
            }),
            _ => Ok(()),
        }
    }

    fn after_steps(&mut self, simulation: &S, _: &S::Account) -> Result<(), State> {
        self.looks += 1;
        if self.saving == Some(self.looks) {
            simulation.state();
        }
        if self.interruption.is_some_and(|looks| self.looks.is_multiple_of(looks)) {
            return Err(simulation.state());
        }
        Ok(())
    }
}

/// Runs a simulation, interrupting and resuming it after every `interruption` calls; returns its log, end and state.
fn run<S: Simulation<Account: Debug, Fields: Debug>>(
    new: impl Fn() -> S,
    output: &OutputTimes,
    interruption: Option<usize>,
) -> (Log, End<S>, State) {
    let mut log = Log { interruption, ..Log::default() };
    let mut from: Option<State> = None;
    loop {
        let mut simulation = new();
        if let Some(state) = &from {
            assert!(simulation.restore(state));
        }
        match drive(&mut simulation, output, from.is_some(), &mut log) {
            Ok(end) => return (log, end, simulation.state()),
            Err(state) => from = Some(state),
        }
    }
}

fn interruptions_change_nothing<S: Simulation<Account: Debug, Fields: Debug>>(
    new: impl Fn() -> S,
    output: &OutputTimes,
) {
    let (whole, end, state) = run(&new, output, None);
    assert!(end.fault.is_none());
    for looks in [1, 2, 5] {
        let (log, end, same) = run(&new, output, Some(looks));
        assert!(end.fault.is_none());
        assert_eq!(log.records, whole.records);
        assert_eq!(log.accounts, whole.accounts);
        assert_eq!(log.snapshots, whole.snapshots);
        assert_eq!(same, state);
    }
}

const DURATION: f64 = 4.0;

/// The fused solver with two subdomains, and the reference solver.
const SOLVERS: [SolverChoice; 2] = [SolverChoice::Fused { threads: 2 }, SolverChoice::Reference];

/// Creates a simulation of a pulse in plane blocks with interlayers, and a source with the time function `signal`.
fn solid(signal: fn(f64) -> f64, solver: SolverChoice) -> SolidSimulation<f64, 2> {
    solid_for(signal, solver, DURATION)
}

/// Creates the simulation of [`solid`] with a duration, s.
fn solid_for(
    signal: fn(f64) -> f64,
    solver: SolverChoice,
    duration: f64,
) -> SolidSimulation<f64, 2> {
    let medium = Medium::new(Isotropic::new(1.4, 0.9, 1.2, None).expect("moduli"), 2);
    let (cells, spacing) = ([20, 12], [0.1, 0.1]);
    let steps = TimeSteps::new(std::slice::from_ref(&medium), &spacing, 0.9, 1.0, duration);
    let steps = steps.expect("few steps");
    let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::NonReflecting]);
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let of_cell = vec![0; 240];
    let probe = Probe::interpolating(&cells, &[false; 2], &of_cell, 105, &[5.3, 4.9]);
    let mut problem =
        Problem::new(Grid { cells, spacing }, vec![medium], of_cell, sides, steps.step, scheme);
    problem.sources = vec![Source {
        cells: vec![(50, 1.0)],
        amplitudes: vec![(Field::Velocity(0), 1.0)],
        signal: Arc::new(signal),
    }];
    let material = ElasticMaterial {
        thickness: 0.05,
        density: 0.9,
        longitudinal_speed: 0.6,
        shear_speed: 0.3,
    };
    problem.interlayers = vec![Interlayers::of_material(0, [5, 5], &material, &problem.media[0])];
    let pulse = (0..240).map(|cell| if cell % 20 < 4 { 1.0 } else { 0.0 }).collect();
    let initial = vec![(Field::Velocity(1), pulse)];
    SolidSimulation::new(problem, steps, initial, vec![probe, Probe::nearest(17)], solver)
        .expect("a sound problem")
}

fn output(accounts: f64, snapshots: f64, duration: f64) -> OutputTimes {
    OutputTimes {
        accounts: RegularTimes::new(accounts, duration),
        snapshots: Some(RegularTimes::new(snapshots, duration)),
    }
}

/// Verifies solids: snapshots are taken between steps, records in every step.
#[test]
fn solids_go_on_with_the_same_bits() {
    let mut logs = Vec::new();
    for solver in SOLVERS {
        let new = || solid(f64::sin, solver);
        let steps = new().time_steps();
        let output = output(7.0 * steps.step, 0.31, DURATION);
        interruptions_change_nothing(new, &output);
        let (log, end, state) = run(new, &output, None);
        assert_eq!((log.records.len(), state.steps), (steps.count + 1, steps.count));
        assert_eq!(log.accounts.len(), steps.count.div_ceil(7) + 1);
        assert_eq!(log.snapshots.len(), 14);
        // The residual is rounding in the full ledger, and the numerical dissipation in the other one.
        let (balance, energy) = (end.last.balance().abs(), end.last.energy.total());
        match solver {
            SolverChoice::Reference => assert!(balance < 1e-13 * energy, "{balance:e}"),
            SolverChoice::Fused { .. } => assert!(balance > 1e-4 * energy, "{balance:e}"),
        }
        logs.push((log.records, log.snapshots));
    }
    assert!(logs[0] == logs[1]);
}

/// Verifies that a source that becomes infinite ends the run with the last finite state, and with all output up to it.
#[test]
fn faults_leave_the_last_sound_state() {
    SOLVERS.into_iter().for_each(leaves_the_last_sound_state);
}

fn leaves_the_last_sound_state(solver: SolverChoice) {
    let strength = |t: f64| if t < 2.2 { t.sin() } else { f64::INFINITY };
    let new = || solid(strength, solver);
    let steps = new().time_steps();
    let output = output(7.0 * steps.step, 0.31, DURATION);
    let (sound, _, _) = run(|| solid(f64::sin, solver), &output, None);
    let (whole, end, state) = run(new, &output, None);
    let fault = end.fault.expect("a fault");
    assert!(fault.place.is_some() && fault.time > state.time);
    assert!((state.time - 2.2).abs() < 2.0 * steps.step, "{}", state.time);
    assert_eq!(state.time, end.last.time);
    assert_eq!(whole.records.len(), state.steps + 1);
    assert_eq!(whole.records, sound.records[..=state.steps]);
    // Accounts that were due, and the account of the last state.
    let due = state.steps / 7 + 1;
    assert!(!state.steps.is_multiple_of(7));
    assert_eq!(whole.accounts[..due], sound.accounts[..due]);
    assert_eq!(whole.accounts[due..], [format!("{:?}", end.last)]);
    let (log, _, same) = run(new, &output, Some(2));
    assert_eq!((log.records, log.accounts, same), (whole.records, whole.accounts, state));
}

/// Verifies that after a fault only the steps since the last saved state are repeated, in batches between which the run
/// can be interrupted, and that the result does not depend on the saved state.
#[test]
fn faults_are_found_from_the_last_saved_state() {
    const LONG: f64 = 40.0;
    const END: f64 = 37.0;
    let strength = |t: f64| if t < END { t.sin() } else { f64::INFINITY };
    let new = || solid_for(strength, SOLVERS[0], LONG);
    let step = new().time_steps().step;
    // A long account interval, so that steps are made in large batches.
    let output = OutputTimes { accounts: RegularTimes::new(LONG, LONG), snapshots: None };
    let mut all = Vec::new();
    for saving in [None, Some(1), Some(usize::MAX)] {
        let mut simulation = new();
        let looks = (END / step) as usize / 64;
        let saving = saving.map(|own: usize| own.min(looks));
        let mut log = Log { saving, ..Log::default() };
        let end = drive(&mut simulation, &output, false, &mut log).expect("no interruption");
        assert!(end.fault.is_some());
        let batches = match saving {
            None => looks,
            Some(saved) => looks - saved,
        };
        assert_eq!(log.replays, batches, "{saving:?}");
        assert!(looks > 1, "{looks}");
        all.push((log.records, log.accounts, simulation.state()));
        // Interrupted between two batches.
        if batches > 1 {
            let mut log = Log { saving, patience: Some(1), ..Log::default() };
            assert!(drive(&mut new(), &output, false, &mut log).is_err());
            assert_eq!(log.replays, 2);
        }
    }
    assert!(all.windows(2).all(|pair| pair[0] == pair[1]));
    // Starting from a restored state.
    let mut first = new();
    let mut log = Log { interruption: Some(1), ..Log::default() };
    let state = drive(&mut first, &output, false, &mut log).err().expect("an interruption");
    let mut second = new();
    assert!(second.restore(&state));
    let mut log = Log::default();
    drive(&mut second, &output, true, &mut log).expect("no interruption");
    assert_eq!(log.replays, (END / step) as usize / 64 - 1);
    assert_eq!(second.state(), all[0].2);
}

/// Verifies flows: accounts and snapshots are taken between steps.
#[test]
fn flows_go_on_with_the_same_bits() {
    let rate = 25.0;
    let problem = flow::Problem {
        closure: Closure::HarrisGrekova,
        density: 1600.0,
        friction_angle: FRAC_PI_6,
        rotation_ratio: FRAC_PI_6.sin(),
        cohesion: 100.0,
        pressure: 1000.0,
        velocity_gradient: [[0.0, 2.0 * rate], [0.0, 0.0]],
        stress_angle: TAU / 8.0 - 0.3,
        spin: -rate - rate * 0.6f64.sin() / FRAC_PI_6.sin(),
        spin_acceleration: 0.0,
        points: [16; 2],
        lengths: [0.1; 2],
        tolerance: 1e-5,
        pressure_tolerance: 1e-9,
        least_shear_rate: 1e-3,
    };
    let duration = 1e-3;
    let waves = [wave([1, 0], 1e-3, 0.3), wave([1, -2], 2e-3, 1.0)];
    let [v1, v2] =
        Lattice { count: problem.points, lengths: problem.lengths }.transverse(&waves, None);
    let new = || {
        let mut own = FlowSimulation::new(&problem, duration, vec![3, 77]).expect("a problem");
        own.perturb([&v1, &v2], &[0.0; 256]).expect("a stress");
        own
    };
    let output = output(duration / 13.0, duration / 7.5, duration);
    interruptions_change_nothing(new, &output);
    let (log, _, state) = run(new, &output, None);
    assert_eq!(log.records.len(), state.steps + 1);
    assert_eq!((log.accounts.len(), log.snapshots.len()), (14, 9));
}
