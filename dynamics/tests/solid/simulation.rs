//! Simulation driver: its output, bitwise reproducibility after interruptions, and runs that end with a fault.

use crate::support::shear_flow::simple_shear;
use models::interface::elastic::ElasticMaterial;
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Source};
use wellposed_dynamics::flow::perturbation::{Lattice, plane_wave};
use wellposed_dynamics::flow::{self, Closure};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::probe::Probe;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::simulation::{
    DueSnapshot, FlowSimulation, Observer, OutputTimes, RegularTimes, RunError, Simulation,
    SimulationOutcome, SimulationState, SolidFields, SolidSimulation, SolverChoice,
    StateSource as _, TimeSteps, run_simulation,
};
use wellposed_dynamics::solid::interlayers::{InterlayerLaw, Interlayers};

/// Observer that logs all output and interrupts the run after every `interruption_interval` calls of `on_steps_done`.
#[derive(Default)]
pub(crate) struct OutputLog {
    records: Vec<String>,
    accounts: Vec<String>,
    snapshots: Vec<String>,
    /// Output fields of solids before and after the steps of the snapshots.
    pub(crate) fields: Vec<Box<dyn Any + Send>>,
    batch_count: usize,
    interruption_interval: Option<usize>,
    /// Number of calls of `on_steps_done` after which a state is saved while the run continues.
    save_after: Option<usize>,
    /// State that was saved, or from which the run was resumed.
    saved: Option<SimulationState>,
    /// Number of batches of steps that were repeated.
    replay_count: usize,
    /// Number of repeated batches after which the run is interrupted.
    max_replays: Option<usize>,
}

impl OutputLog {
    /// Returns records and accounts.
    pub(crate) fn tables(self) -> [Vec<String>; 2] {
        [self.records, self.accounts]
    }
}

/// Simulation whose output fields are logged.
pub(crate) trait LoggedSimulation: Simulation<Account: Debug, Fields: Debug> {
    /// Fields of all cells.
    type Logged: Debug + Send + 'static;

    /// Returns the fields of the present state that the fields at an output time do not contain.
    fn logged_fields(&self) -> Self::Logged;
}

impl<T: SolverReal, const D: usize> LoggedSimulation for SolidSimulation<T, D> {
    type Logged = SolidFields;

    fn logged_fields(&self) -> SolidFields {
        self.all_fields()
    }
}

impl LoggedSimulation for FlowSimulation {
    type Logged = ();

    fn logged_fields(&self) {}
}

impl<S: LoggedSimulation> Observer<S> for OutputLog {
    /// State at the interruption.
    type Error = SimulationState;

    fn on_record(&mut self, time: f64, values: &[f64]) -> Result<(), SimulationState> {
        self.records.push(format!("{time:?} {values:?}"));
        Ok(())
    }

    fn on_account(&mut self, account: &S::Account) -> Result<(), SimulationState> {
        self.accounts.push(format!("{account:?}"));
        Ok(())
    }

    fn on_state_before_snapshot(&mut self, simulation: &S) -> Result<(), SimulationState> {
        self.fields.push(Box::new(simulation.logged_fields()));
        Ok(())
    }

    fn on_snapshot(
        &mut self,
        simulation: &S,
        due: DueSnapshot<S::Fields>,
    ) -> Result<(), SimulationState> {
        let fields = simulation.logged_fields();
        self.snapshots.push(format!("{due:?} {fields:?}"));
        self.fields.push(Box::new(fields));
        Ok(())
    }

    fn on_replay(&mut self) -> Result<(), SimulationState> {
        self.replay_count += 1;
        match self.max_replays {
            Some(max_replays) if self.replay_count > max_replays => Err(SimulationState {
                steps: 0,
                time: 0.0,
                initial_energy: 0.0,
                sections: Default::default(),
            }),
            _ => Ok(()),
        }
    }

    fn restore_saved(&mut self, simulation: &mut S) -> Result<bool, SimulationState> {
        Ok(self.saved.as_ref().is_some_and(|state| simulation.restore(state)))
    }

    fn on_steps_done(&mut self, simulation: &S, _: &S::Account) -> Result<(), SimulationState> {
        self.batch_count += 1;
        if self.save_after == Some(self.batch_count) {
            self.saved = Some(simulation.state());
        }
        if self
            .interruption_interval
            .is_some_and(|interval| self.batch_count.is_multiple_of(interval))
        {
            return Err(simulation.state());
        }
        Ok(())
    }
}

/// Runs a simulation, interrupting it after every `interruption_interval` calls of `on_steps_done` and resuming it;
/// returns its log, its outcome and its final state.
pub(crate) fn run_with_interruptions<S: LoggedSimulation>(
    create: impl Fn() -> S,
    output: &OutputTimes,
    interruption_interval: Option<usize>,
) -> (OutputLog, SimulationOutcome<S>, SimulationState) {
    let mut log = OutputLog { interruption_interval, ..OutputLog::default() };
    let mut from: Option<SimulationState> = None;
    loop {
        let mut simulation = create();
        if let Some(state) = &from {
            assert!(simulation.restore(state));
        }
        match run_simulation(&mut simulation, output, from.is_some(), &mut log) {
            Ok(end) => return (log, end, simulation.state()),
            Err(RunError::Observer(state)) => from = Some(state),
            Err(RunError::Threads(error)) => panic!("{error}"),
        }
    }
}

fn check_interruptions<S: LoggedSimulation>(create: impl Fn() -> S, output: &OutputTimes) {
    let (whole, end, state) = run_with_interruptions(&create, output, None);
    assert!(end.fault.is_none());
    for interval in [1, 2, 5] {
        let (log, end, same) = run_with_interruptions(&create, output, Some(interval));
        assert!(end.fault.is_none());
        assert_eq!(log.records, whole.records);
        assert_eq!(log.accounts, whole.accounts);
        assert_eq!(log.snapshots, whole.snapshots);
        assert_eq!(same, state);
    }
}

const RUN_DURATION: f64 = 4.0;

/// The fused solver with two subdomains, and the reference solver.
const SOLVER_CHOICES: [SolverChoice; 2] =
    [SolverChoice::Fused { threads: 2 }, SolverChoice::Reference];

/// Creates a simulation of a plane solid in blocks with interlayers and a source with the time function `signal`.
pub(crate) fn pulse_simulation(
    signal: fn(f64) -> f64,
    solver: SolverChoice,
) -> SolidSimulation<f64, 2> {
    pulse_simulation_with_duration(signal, solver, RUN_DURATION)
}

/// Creates the simulation of [`pulse_simulation`] with a duration, s.
fn pulse_simulation_with_duration(
    signal: fn(f64) -> f64,
    solver: SolverChoice,
    duration: f64,
) -> SolidSimulation<f64, 2> {
    let medium = Medium::new(Isotropic::new(1.4, 0.9, 1.2, None).expect("moduli"), 2);
    let (cells, spacing) = ([20, 12], [0.1, 0.1]);
    let steps = TimeSteps::new(std::slice::from_ref(&medium), &spacing, (0.9, 1), 1.0, duration);
    let steps = steps.expect("few steps");
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::NonReflecting]);
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let cell_media = vec![0; 240];
    let probe = Probe::with_interpolation(&cells, &[false; 2], |_| 0, 105, &[5.3, 4.9]);
    let mut problem = Problem::new(
        Grid { cells, spacing },
        vec![medium],
        cell_media,
        boundaries,
        steps.step,
        scheme,
    );
    problem.sources = vec![Source {
        cells: vec![(50, 1.0)],
        amplitudes: vec![(SolidField::Velocity(0), 1.0)],
        signal: Arc::new(signal),
    }];
    let material = ElasticMaterial {
        thickness: 0.05,
        density: 0.9,
        longitudinal_speed: 0.6,
        shear_speed: 0.3,
    };
    let law = InterlayerLaw::from_material(0, &material, &problem.media[0]);
    let cells = problem.grid.cells[0];
    problem.interlayers = vec![Interlayers::new_regular(0, cells, [5, 5], law)];
    let [columns, rows] = solver.own_cells(&problem).expect("room");
    let pulse = rows.flat_map(|_| columns.clone());
    let pulse = pulse.map(|column| if column < 4 { 1.0 } else { 0.0 }).collect();
    let initial = vec![(SolidField::Velocity(1), pulse)];
    SolidSimulation::new(problem, steps, initial, vec![probe, Probe::from_cell(17)], solver)
        .expect("a sound problem")
}

pub(crate) fn build_output_times(accounts: f64, snapshots: f64, duration: f64) -> OutputTimes {
    OutputTimes {
        accounts: RegularTimes::new(accounts, duration),
        snapshots: Some(RegularTimes::new(snapshots, duration)),
    }
}

/// Verifies that resumed runs of solids deliver the same bits: snapshots are taken between steps, records in every
/// step.
#[test]
fn resumed_solid_runs_deliver_the_same_bits() {
    let mut logs = Vec::new();
    for solver in SOLVER_CHOICES {
        let create_simulation = || pulse_simulation(f64::sin, solver.clone());
        let steps = create_simulation().time_steps();
        let output = build_output_times(7.0 * steps.step, 0.31, RUN_DURATION);
        check_interruptions(create_simulation, &output);
        let (log, end, state) = run_with_interruptions(create_simulation, &output, None);
        assert_eq!((log.records.len(), state.steps), (steps.count + 1, steps.count));
        assert_eq!(log.accounts.len(), steps.count.div_ceil(7) + 1);
        assert_eq!(log.snapshots.len(), 14);
        // The residual of the energy balance is rounding in the full ledger of the reference solver, and the numerical
        // dissipation in the ledger of the fused solver.
        let (balance, energy) = (end.last_account.balance().abs(), end.last_account.energy.total());
        match solver {
            SolverChoice::Reference => assert!(balance < 1e-13 * energy, "{balance:e}"),
            SolverChoice::Fused { .. } | SolverChoice::Ranks { .. } => {
                assert!(balance > 1e-4 * energy, "{balance:e}")
            }
        }
        logs.push((log.records, log.snapshots));
    }
    assert!(logs[0] == logs[1]);
}

/// Verifies that a source that becomes infinite ends the run with the last finite state, and with all output up to it.
#[test]
fn faults_end_the_run_at_the_last_sound_state() {
    SOLVER_CHOICES.into_iter().for_each(check_fault);
}

fn check_fault(solver: SolverChoice) {
    let strength = |t: f64| if t < 2.2 { t.sin() } else { f64::INFINITY };
    let create_simulation = || pulse_simulation(strength, solver.clone());
    let steps = create_simulation().time_steps();
    let output = build_output_times(7.0 * steps.step, 0.31, RUN_DURATION);
    let (sound, _, _) =
        run_with_interruptions(|| pulse_simulation(f64::sin, solver.clone()), &output, None);
    let (whole, end, state) = run_with_interruptions(create_simulation, &output, None);
    let fault = end.fault.expect("a fault");
    assert!(fault.location.is_some() && fault.time > state.time);
    assert!((state.time - 2.2).abs() < 2.0 * steps.step, "{}", state.time);
    assert_eq!(state.time, end.last_account.time);
    assert_eq!(whole.records.len(), state.steps + 1);
    assert_eq!(whole.records, sound.records[..=state.steps]);
    // The accounts that were due up to the fault, and the account of the last valid state.
    let due = state.steps / 7 + 1;
    assert!(!state.steps.is_multiple_of(7));
    assert_eq!(whole.accounts[..due], sound.accounts[..due]);
    assert_eq!(whole.accounts[due..], [format!("{:?}", end.last_account)]);
    let (log, _, same) = run_with_interruptions(create_simulation, &output, Some(2));
    assert_eq!((log.records, log.accounts, same), (whole.records, whole.accounts, state));
}

/// Verifies that after a fault only the steps since the last saved state are repeated, in batches between which the run
/// can be interrupted, and that the result does not depend on the saved state.
#[test]
fn faults_are_located_from_the_last_saved_state() {
    const LONG_DURATION: f64 = 40.0;
    const FAULT_TIME: f64 = 37.0;
    let strength = |t: f64| if t < FAULT_TIME { t.sin() } else { f64::INFINITY };
    let create_simulation = || {
        pulse_simulation_with_duration(strength, SolverChoice::Fused { threads: 2 }, LONG_DURATION)
    };
    let step = create_simulation().time_steps().step;
    // A long account interval, so that steps are made in large batches.
    let output =
        OutputTimes { accounts: RegularTimes::new(LONG_DURATION, LONG_DURATION), snapshots: None };
    let mut outcomes = Vec::new();
    for save_after in [None, Some(1), Some(usize::MAX)] {
        let mut simulation = create_simulation();
        let batch_count = (FAULT_TIME / step) as usize / 64;
        let save_after = save_after.map(|own: usize| own.min(batch_count));
        let mut log = OutputLog { save_after, ..OutputLog::default() };
        let end =
            run_simulation(&mut simulation, &output, false, &mut log).expect("no interruption");
        assert!(end.fault.is_some());
        let replayed = match save_after {
            None => batch_count,
            Some(saved) => batch_count - saved,
        };
        assert_eq!(log.replay_count, replayed, "{save_after:?}");
        assert!(batch_count > 1, "{batch_count}");
        outcomes.push((log.records, log.accounts, simulation.state()));
        // The repetition can be interrupted between two batches.
        if replayed > 1 {
            let mut log = OutputLog { save_after, max_replays: Some(1), ..OutputLog::default() };
            assert!(run_simulation(&mut create_simulation(), &output, false, &mut log).is_err());
            assert_eq!(log.replay_count, 2);
        }
    }
    assert!(outcomes.windows(2).all(|pair| pair[0] == pair[1]));
    // After resuming from a saved state, only the steps since that state are repeated.
    let mut first = create_simulation();
    let mut log = OutputLog { interruption_interval: Some(1), ..OutputLog::default() };
    let end = run_simulation(&mut first, &output, false, &mut log);
    let Err(RunError::Observer(state)) = end else { panic!("an interruption") };
    let mut second = create_simulation();
    assert!(second.restore(&state));
    let mut log = OutputLog { saved: Some(state), ..OutputLog::default() };
    run_simulation(&mut second, &output, true, &mut log).expect("no interruption");
    assert_eq!(log.replay_count, (FAULT_TIME / step) as usize / 64 - 1);
    assert_eq!(second.state(), outcomes[0].2);
}

/// Verifies that resumed runs of flows deliver the same bits: accounts and snapshots are taken between steps.
#[test]
fn resumed_flow_runs_deliver_the_same_bits() {
    let problem = flow::FlowProblem {
        tolerance: 1e-5,
        pressure_tolerance: 1e-9,
        ..simple_shear(Closure::HarrisGrekova, 16, 0.3)
    };
    let duration = 1e-3;
    let waves = [plane_wave([1, 0], 1e-3, 0.3), plane_wave([1, -2], 2e-3, 1.0)];
    let [v1, v2] = Lattice { points: problem.points, lengths: problem.lengths }
        .evaluate_transverse(&waves, None);
    let create_simulation = || {
        let mut simulation =
            FlowSimulation::new(&problem, duration, vec![3, 77]).expect("a problem");
        simulation.perturb([&v1, &v2], &[0.0; 256]).expect("a stress");
        simulation
    };
    let output = build_output_times(duration / 13.0, duration / 7.5, duration);
    check_interruptions(create_simulation, &output);
    let (log, _, state) = run_with_interruptions(create_simulation, &output, None);
    assert_eq!(log.records.len(), state.steps + 1);
    assert_eq!((log.accounts.len(), log.snapshots.len()), (14, 9));
}
