//! Distribution over ranks: the results of the root must be bit-identical to those of one process. The ranks are on
//! threads of the test.

use crate::contacts::{granular, porous, viscous_granular};
use crate::decomposition::{random_problem_of_solids, solids_in_theory, two_solids};
use crate::saturated_cuts;
use crate::simulation::{build_output_times, pulse_simulation, run_with_interruptions};
use crate::support::interlayers::random_interlayers;
use crate::support::noise;
use crate::support::random::NoiseSequence;
use models::solid::parameters::Theory;
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Load, Source};
use wellposed_dynamics::decomposition::communicator::{Communicator, ThreadRank};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::ledger::{Energy, Ledger};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::simulation::SolverChoice;

/// Calls `task` for each of `size` ranks on a thread of its own; returns the value of the root.
fn run_ranks<V: Send>(size: usize, task: impl Fn(Arc<dyn Communicator>) -> V + Sync) -> V {
    std::thread::scope(|scope| {
        let task = &task;
        let threads: Vec<_> = ThreadRank::create_all(size)
            .into_iter()
            .map(|rank| scope.spawn(move || task(Arc::new(rank))))
            .collect();
        let mut values = threads.into_iter().map(|own| own.join().expect("no panic"));
        let root = values.next().expect("a root");
        values.for_each(drop);
        root
    })
}

/// Results of a run, complete at the root.
#[derive(Debug, PartialEq)]
struct Results<T> {
    snapshot: Snapshot<T>,
    output: Vec<Vec<f64>>,
    energy: Energy,
    ledger: Ledger,
    records: Vec<f64>,
}

/// Steps of the two halves of a run: more than a pass has.
const STEPS: [usize; 2] = [5, 6];

/// Runs `steps` from noise, or from a snapshot if there is one.
fn run_domain<T: SolverReal, const D: usize>(
    mut domain: DecomposedDomain<T, D>,
    cell_count: usize,
    start: Option<&Snapshot<T>>,
    steps: usize,
) -> Results<T> {
    match start {
        Some(snapshot) => assert!(domain.restore(snapshot)),
        None => {
            for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
                let value = |cell| T::from_f64(0.5 * noise((1_000_003 * index + cell) as u64));
                domain.set_field(field, &(0..cell_count).map(value).collect::<Vec<T>>());
            }
            domain.initialise_interlayers();
        }
    }
    domain.watch_cells(&[3, cell_count / 2 + 5, cell_count - 1]);
    domain.record_watched_cells();
    domain.advance(steps).expect("threads");
    assert_eq!((domain.first_non_finite(), domain.max_pass_steps() > 0), (None, true));
    Results {
        snapshot: domain.snapshot(),
        output: domain.output_values(),
        energy: domain.energy(),
        ledger: domain.ledger(),
        records: domain.take_records(),
    }
}

/// Compares runs on `sizes` ranks, with one or two threads each, with those of one process: the first half from noise,
/// the second one from the snapshot of the other number of ranks before.
fn compare_ranks<T: SolverReal, const D: usize>(problem: &Problem<D>, sizes: &[usize]) {
    let (first, count) = (problem.first_axis(), problem.grid.count());
    let whole = || DecomposedDomain::<T, D>::with_first_axis(first, problem, 1).expect("sound");
    let half = run_domain(whole(), count, None, STEPS[0]);
    let end = run_domain(whole(), count, Some(&half.snapshot), STEPS[1]);
    assert!(half.energy.total() > 0.0 && half.records.len() > 3);
    let mut start = half.snapshot.clone();
    for (index, &size) in sizes.iter().enumerate() {
        let threads = 1 + index % 2;
        let results = run_ranks(size, |rank| {
            let domain = || {
                let rank = Arc::clone(&rank);
                DecomposedDomain::<T, D>::with_ranks(first, problem, rank, threads).expect("room")
            };
            let half = run_domain(domain(), count, None, STEPS[0]);
            // Only the root has a snapshot.
            let start = if rank.is_root() { start.clone() } else { Snapshot::default() };
            let end = run_domain(domain(), count, Some(&start), STEPS[1]);
            let mut wrong = start;
            wrong.fields.pop();
            assert!(!domain().restore(&wrong));
            (half, end)
        });
        assert!(results.0 == half, "{size} ranks");
        assert!(results.1 == end, "{size} ranks");
        start = results.0.snapshot;
    }
}

/// Numbers of ranks of the long comparisons; those at even places have one thread each.
const ALL_SIZES: [usize; 6] = [1, 2, 3, 4, 7, 8];

const FREE: [Boundary; 2] = [Boundary::Free, Boundary::Free];
const PERIODIC: [Boundary; 2] = [Boundary::Periodic, Boundary::Periodic];
const OPEN: [Boundary; 2] = [Boundary::NonReflecting, Boundary::Fixed];

/// Adds a load on a part of a boundary and a source, and gravity.
fn add_loads<const D: usize>(problem: &mut Problem<D>) {
    let signal = Arc::new(|time: f64| (3.0 * time).sin());
    let faces = (0..problem.grid.faces(0)).step_by(2).map(|face| (face, 0.4)).collect();
    problem.loads.push(Load { axis: 0, end: 1, pair: 0, faces, signal: signal.clone() });
    let cells = vec![(problem.grid.count() / 3, 0.5), (problem.grid.count() / 2, -0.2)];
    let amplitudes = vec![(problem.fields()[0], 1e-2)];
    problem.sources.push(Source { cells, amplitudes, signal });
    problem.acceleration[D - 1] = 0.3;
}

#[test]
fn ranks_change_no_bit_of_solids_in_the_plane() {
    let mut problem =
        random_problem_of_solids(two_solids(), &[FREE, OPEN], [30, 33], PlasticStep::ReturnMapping);
    add_loads(&mut problem);
    compare_ranks::<f64, 2>(&problem, &ALL_SIZES);
    let classical = solids_in_theory(Theory::Classical);
    let mut problem = random_problem_of_solids(
        classical,
        &[PERIODIC, PERIODIC],
        [33, 17],
        PlasticStep::ReturnMapping,
    );
    problem.scheme.slopes = Slopes::FourthOrder;
    compare_ranks::<f64, 2>(&problem, &[4, 7]);
    // Alternating sweeps in single precision.
    let mut problem = random_problem_of_solids(
        two_solids(),
        &[FREE, PERIODIC],
        [40, 21],
        PlasticStep::ReturnMapping,
    );
    problem.scheme.splitting = Splitting::Alternating;
    compare_ranks::<f32, 2>(&problem, &[3, 8]);
}

#[test]
fn ranks_change_no_bit_of_solids_in_space() {
    let mut problem = random_problem_of_solids(
        two_solids(),
        &[OPEN, FREE, FREE],
        [9, 10, 30],
        PlasticStep::ReturnMapping,
    );
    add_loads(&mut problem);
    compare_ranks::<f64, 3>(&problem, &ALL_SIZES);
    let classical = solids_in_theory(Theory::Classical);
    let problem = random_problem_of_solids(
        classical,
        &[PERIODIC, FREE, PERIODIC],
        [14, 9, 12],
        PlasticStep::MidpointReflection,
    );
    compare_ranks::<f64, 3>(&problem, &[4, 6]);
}

/// Returns a plane problem with stripes of `media`.
fn striped_problem(media: Vec<Medium>) -> Problem<2> {
    let grid = Grid { cells: [24, 32], spacing: [0.1; 2] };
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let stripes = media.len();
    let cell_media = (0..grid.count()).map(|cell| (cell % 24 / 5 % stripes) as u16).collect();
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    Problem::new(grid, media, cell_media, [FREE, OPEN], 1.9 * 0.1 / speed, scheme)
}

#[test]
fn ranks_change_no_bit_of_granular_and_porous_media() {
    let media = vec![granular(0.5, None, 2), granular(0.3, Some(0.4), 2)];
    compare_ranks::<f64, 2>(&striped_problem(media), &[2, 7]);
    let media = vec![porous(2.0, 0.1, true, 2), porous(3.0, 0.2, false, 2)];
    compare_ranks::<f64, 2>(&striped_problem(media), &[3, 8]);
    compare_ranks::<f64, 2>(&striped_problem(vec![viscous_granular(Some(0.4), 2)]), &[4]);
}

#[test]
fn ranks_change_no_bit_of_blocky_media() {
    // Saturated interlayers, whose junctions are cut.
    for is_periodic in [false, true] {
        let mut random = NoiseSequence::new(91 << 40);
        let problem = saturated_cuts::build_problem(&mut random, is_periodic, true);
        compare_ranks::<f64, 2>(&problem, if is_periodic { &[3, 4] } else { &[2, 7, 8] });
    }
    // Interlayers across all axes in space.
    let mut random = NoiseSequence::new(92 << 40);
    let mut problem = random_problem_of_solids(
        two_solids(),
        &[FREE, FREE, PERIODIC],
        [12, 9, 15],
        PlasticStep::ReturnMapping,
    );
    for axis in 0..3 {
        let own = (axis, &problem.grid.cells[..]);
        let interlayers = random_interlayers(&mut random, own, [3, 3], &problem.media[0]);
        problem.interlayers.push(interlayers);
    }
    compare_ranks::<f64, 3>(&problem, &[2, 4]);
}

#[test]
fn too_many_ranks_are_refused() {
    let problem = striped_problem(vec![granular(0.5, None, 2)]);
    let error = run_ranks(64, |rank| {
        DecomposedDomain::<f64, 2>::with_ranks(0, &problem, rank, 1).map(drop)
    });
    assert_eq!(error, Err(DomainError::RankCount { ranks: 64, cells: 24 * 32 }));
}

/// Verifies records, accounts, output fields, states and the search for the last sound state before a fault, in runs
/// that are interrupted and resumed.
#[test]
fn simulations_on_ranks_deliver_the_same_bits() {
    let faulty = |t: f64| if t < 2.2 { t.sin() } else { f64::INFINITY };
    for signal in [f64::sin, faulty] {
        let run = |solver: SolverChoice, interruptions: Option<usize>| {
            let create = || pulse_simulation(signal, solver.clone());
            let output = build_output_times(0.2, 0.31, create().time_steps().step * 40.0);
            let (log, outcome, state) = run_with_interruptions(create, &output, interruptions);
            (log.delivered(), outcome.last_account, outcome.fault, state)
        };
        let expected = run(SolverChoice::Fused { threads: 1 }, None);
        for (size, interruptions) in [(2, None), (3, Some(2)), (4, Some(5))] {
            let found = run_ranks(size, |communicator| {
                run(SolverChoice::Ranks { communicator, threads: 1 }, interruptions)
            });
            assert!(found == expected, "{size} ranks, {:?} and {:?}", found.2, expected.2);
        }
    }
}
