//! Threads that cannot be started: the solver keeps its state, and a run ends with an error.

use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use std::cmp::Ordering;
use std::io;
use std::thread::{Builder, Scope, ScopedJoinHandle};
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::{DecomposedDomain, ThreadStartError, ThreadStarter};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::simulation::{
    AdvanceError, CellSections, DueSnapshot, Observer, OutputTimes, RegularTimes, RunError,
    Simulation, SimulationState, StateSource, run_simulation,
};

fn start_error() -> io::Error {
    io::Error::other("no more threads")
}

/// Starter of a limited number of threads.
struct LimitedThreads(usize);

impl ThreadStarter for LimitedThreads {
    fn start<'scope, R: Send + 'scope>(
        &mut self,
        scope: &'scope Scope<'scope, '_>,
        work: impl FnOnce() -> R + Send + 'scope,
    ) -> io::Result<ScopedJoinHandle<'scope, R>> {
        self.0 = self.0.checked_sub(1).ok_or_else(start_error)?;
        Builder::new().spawn_scoped(scope, work)
    }
}

/// Verifies that no step is made unless the threads of all subdomains start, and that a later call makes it.
#[test]
fn state_is_unchanged_if_a_thread_does_not_start() {
    let medium = Medium::new(Isotropic::new(2.0, 1.0, 1.0, None).expect("moduli"), 2);
    let step = 0.1 / medium.max_speed();
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    let boundaries = std::array::from_fn(|_| [Boundary::Fixed, Boundary::Free]);
    let grid = Grid { cells: [6, 30], spacing: [0.1; 2] };
    let problem = Problem::new(grid, vec![medium], vec![0; 180], boundaries, step, scheme);
    let create = || {
        let mut domain = DecomposedDomain::<f64, 2>::new(&problem, 3).expect("a sound problem");
        let values: Vec<f64> = (0..180).map(|cell| (cell % 7) as f64).collect();
        domain.set_field(SolidField::Velocity(0), &values);
        domain
    };
    let (mut whole, mut limited) = (create(), create());
    whole.advance(5).expect("threads");
    let before = limited.snapshot();
    for limit in 0..3 {
        let error = ThreadStartError { cause: start_error().to_string() };
        assert_eq!(limited.advance_with(&mut LimitedThreads(limit), 5), Err(error), "{limit}");
        assert_eq!(limited.snapshot(), before, "{limit}");
    }
    limited.advance_with(&mut LimitedThreads(3), 5).expect("threads");
    assert_eq!(limited.snapshot(), whole.snapshot());
    assert_ne!(limited.snapshot(), before);
}

/// Simulation of ten steps without a solver, whose threads cannot be started from step `limit` on.
struct TenStepSimulation {
    steps: usize,
    limit: usize,
}

impl Simulation for TenStepSimulation {
    type Account = usize;
    type Fields = ();
    type Fault = ();

    fn steps(&self) -> usize {
        self.steps
    }

    fn time(&self) -> f64 {
        self.steps as f64
    }

    fn is_finished(&self) -> bool {
        self.steps == 10
    }

    fn compare_time(&self, time: f64) -> Ordering {
        time.total_cmp(&self.time())
    }

    fn advance(&mut self, _due: f64) -> Result<(), AdvanceError<()>> {
        if self.steps == self.limit {
            return Err(AdvanceError::Threads(start_error().into()));
        }
        self.steps += 1;
        Ok(())
    }

    fn recover<E: From<ThreadStartError>>(
        &mut self,
        _fault: (),
        _restore_saved: impl FnOnce(&mut Self) -> Result<bool, E>,
        _before_batch: impl FnMut() -> Result<(), E>,
    ) -> Result<(), E> {
        panic!("the state is sound")
    }

    fn drain_records<E>(
        &mut self,
        mut deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        deliver(self.time(), &[])
    }

    fn account(&self) -> usize {
        self.steps
    }

    fn account_at(&self, _time: f64) -> Result<usize, ()> {
        Ok(self.steps)
    }

    fn fields(&self) {}

    fn fields_at(&self, _time: f64) -> Result<(), ()> {
        Ok(())
    }

    fn restore_with_cells(
        &mut self,
        state: &SimulationState,
        _cells: &mut dyn CellSections,
    ) -> bool {
        self.steps = state.steps;
        true
    }
}

impl StateSource for TenStepSimulation {
    fn state_without_cells(&self) -> SimulationState {
        SimulationState { steps: self.steps, time: self.time(), ..SimulationState::default() }
    }
}

/// Observer that keeps the accounts and the last state.
#[derive(Default)]
struct StepLog {
    accounts: Vec<usize>,
    state: Option<SimulationState>,
}

impl Observer<TenStepSimulation> for StepLog {
    type Error = ();

    fn on_record(&mut self, _time: f64, _values: &[f64]) -> Result<(), ()> {
        Ok(())
    }

    fn on_account(&mut self, account: &usize) -> Result<(), ()> {
        self.accounts.push(*account);
        Ok(())
    }

    fn on_snapshot(
        &mut self,
        _simulation: &TenStepSimulation,
        _snapshot: DueSnapshot<()>,
    ) -> Result<(), ()> {
        Ok(())
    }

    fn on_steps_done(&mut self, simulation: &TenStepSimulation, _last: &usize) -> Result<(), ()> {
        self.state = Some(simulation.state());
        Ok(())
    }
}

/// Verifies that a run whose threads do not start ends with that error, without recovery of a fault and without output
/// of the failed step, and that a run resumed from its last state completes the output.
#[test]
fn run_ends_with_an_error_and_can_be_resumed() {
    let output = OutputTimes { accounts: RegularTimes::new(1.0, 10.0), snapshots: None };
    let mut log = StepLog::default();
    let end =
        run_simulation(&mut TenStepSimulation { steps: 0, limit: 4 }, &output, false, &mut log)
            .err();
    assert_eq!(end, Some(RunError::Threads(start_error().into())));
    assert_eq!(log.accounts, [0, 1, 2, 3, 4]);
    let mut resumed = TenStepSimulation { steps: 0, limit: usize::MAX };
    assert!(resumed.restore(&log.state.take().expect("a state")));
    let end = run_simulation(&mut resumed, &output, true, &mut log).expect("threads");
    assert!(end.fault.is_none());
    assert_eq!(log.accounts, (0..=10).collect::<Vec<_>>());
}
