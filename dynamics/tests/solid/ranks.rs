//! Distribution over ranks: the results of all ranks together must be bit-identical to those of one process. The ranks
//! are on threads of the test.

use crate::contacts::{granular, porous, viscous_granular};
use crate::decomposition::{random_problem_of_solids, solids_in_theory, two_solids};
use crate::saturated_cuts;
use crate::simulation::{build_output_times, pulse_simulation, run_with_interruptions};
use crate::support::interlayers::random_interlayers;
use crate::support::noise;
use crate::support::random::NoiseSequence;
use models::solid::parameters::Theory;
use std::ops::Range;
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Load, Source};
use wellposed_dynamics::decomposition::communicator::{Communicator, ThreadRank};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::ledger::{Energy, Ledger};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::simulation::{SolidFields, SolverChoice, StatePart};

/// Calls `task` for each of `size` ranks on a thread of its own; returns the values in the order of the ranks.
fn run_ranks<V: Send>(size: usize, task: impl Fn(Arc<dyn Communicator>) -> V + Sync) -> Vec<V> {
    std::thread::scope(|scope| {
        let task = &task;
        let threads: Vec<_> = ThreadRank::create_all(size)
            .into_iter()
            .map(|rank| scope.spawn(move || task(Arc::new(rank))))
            .collect();
        threads.into_iter().map(|own| own.join().expect("no panic")).collect()
    })
}

/// Results of a run: of the whole grid, or of the cells of a rank.
#[derive(Clone, Debug, PartialEq)]
struct Results<T> {
    part: StatePart,
    /// Cells along the axes of the problem.
    cells: Vec<Range<usize>>,
    snapshot: Snapshot<T>,
    output: Vec<Vec<f64>>,
    energy: Energy,
    ledger: Ledger,
    records: Vec<f64>,
}

/// Returns the indices in the whole grid of the cells of a box.
fn box_cells(grid: &[usize], cells: &[Range<usize>]) -> Vec<usize> {
    let mut indices = vec![0];
    for (count, range) in grid.iter().zip(cells).rev() {
        let extend = |index: usize| range.clone().map(move |place| index * count + place);
        indices = indices.into_iter().flat_map(extend).collect();
    }
    indices
}

/// Returns the values of a box from those of the whole grid.
fn cut<V: Copy>(values: &[V], grid: &[usize], cells: &[Range<usize>]) -> Vec<V> {
    let cells = box_cells(grid, cells).into_iter();
    cells.filter_map(|cell| values.get(cell).copied()).collect()
}

/// Returns the results in a box of cells: `cells` along the axes of the problem, `part` along those of the state.
fn cut_results<T: SolverReal>(
    whole: &Results<T>,
    grid: &[usize],
    cells: &[Range<usize>],
    part: &StatePart,
) -> Results<T> {
    let of_state = |values: &Vec<f64>| cut(values, &part.grid_cells, &part.cells);
    let mut rest = whole.snapshot.interlayer_history.as_slice();
    let mut history = Vec::new();
    for face in &whole.part.interlayers {
        let (own, others) = rest.split_at(face.1);
        rest = others;
        if part.interlayers.contains(face) {
            history.extend_from_slice(own);
        }
    }
    let fields = whole.snapshot.fields.iter();
    Results {
        part: part.clone(),
        cells: cells.to_vec(),
        snapshot: Snapshot {
            fields: fields.map(|own| cut(own, &part.grid_cells, &part.cells)).collect(),
            cell_sums: whole.snapshot.cell_sums.iter().map(of_state).collect(),
            interlayer_history: history,
            ..whole.snapshot.clone()
        },
        output: whole.output.iter().map(|own| cut(own, grid, cells)).collect(),
        ..whole.clone()
    }
}

/// Steps of the two halves of a run: more than a pass has.
const STEPS: [usize; 2] = [5, 6];

/// Runs `steps` from noise, or from the state of the end of another run of the whole grid if there is one.
fn run_domain<T: SolverReal, const D: usize>(
    mut domain: DecomposedDomain<T, D>,
    grid: [usize; D],
    start: Option<&Results<T>>,
    steps: usize,
) -> Results<T> {
    let (cells, part) = (domain.own_cells().to_vec(), domain.state_part());
    match start {
        Some(whole) => {
            assert!(domain.restore(&cut_results(whole, &grid, &cells, &part).snapshot));
        }
        None => {
            for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
                let value = |cell| T::from_f64(0.5 * noise((1_000_003 * index + cell) as u64));
                let values = box_cells(&grid, &cells).into_iter().map(value);
                domain.set_field(field, &values.collect::<Vec<T>>());
            }
            domain.initialise_interlayers();
        }
    }
    let cell_count: usize = grid.iter().product();
    domain.watch_cells(&[3, cell_count / 2 + 5, cell_count - 1]);
    domain.record_watched_cells();
    domain.advance(steps).expect("threads");
    assert_eq!((domain.first_non_finite(), domain.max_pass_steps() > 0), (None, true));
    Results {
        part,
        cells,
        snapshot: domain.snapshot(),
        output: domain.output_values(),
        energy: domain.energy(),
        ledger: domain.ledger(),
        records: domain.take_records(),
    }
}

/// Compares runs on `sizes` ranks, with one or two threads each, with those of one process: the first half from noise,
/// the second one from the state of one process. The parts of the ranks are boxes that tile the grid, and the media of
/// their cells are given by a function.
fn compare_ranks<T: SolverReal, const D: usize>(problem: &Problem<D>, sizes: &[usize]) {
    let (first, grid) = (problem.first_axis(), problem.grid.cells);
    let whole = || DecomposedDomain::<T, D>::with_first_axis(first, problem, 1).expect("sound");
    let half = run_domain(whole(), grid, None, STEPS[0]);
    let end = run_domain(whole(), grid, Some(&half), STEPS[1]);
    assert!(half.energy.total() > 0.0 && half.records.len() > 3);
    let cell_media = problem.cell_media.clone();
    let problem = &Problem {
        cell_media: Vec::new(),
        medium_function: Some(Arc::new(move |cell| cell_media[cell])),
        ..problem.clone()
    };
    for (index, &size) in sizes.iter().enumerate() {
        let threads = 1 + index % 2;
        let results = run_ranks(size, |communicator| {
            let choice =
                SolverChoice::Ranks { communicator: communicator.clone(), threads, parts: None };
            let planned = choice.own_cells(problem).expect("room").to_vec();
            let domain = || {
                let rank = Arc::clone(&communicator);
                DecomposedDomain::<T, D>::with_ranks(first, problem, rank, threads).expect("room")
            };
            let parts = [
                run_domain(domain(), grid, None, STEPS[0]),
                run_domain(domain(), grid, Some(&half), STEPS[1]),
            ];
            assert_eq!(parts[0].cells, planned);
            // The snapshot of one rank lacks a field.
            let mut wrong = parts[0].snapshot.clone();
            if communicator.rank() + 1 == size {
                wrong.fields.pop();
            }
            assert!(!domain().restore(&wrong));
            parts
        });
        let mut owners = vec![0; grid.iter().product()];
        for (rank, parts) in results.into_iter().enumerate() {
            box_cells(&grid, &parts[0].cells).into_iter().for_each(|cell| owners[cell] += 1);
            for (mut part, whole) in parts.into_iter().zip([&half, &end]) {
                let expected = cut_results(whole, &grid, &part.cells, &part.part);
                if rank > 0 {
                    assert!(part.records.is_empty());
                    part.records.clone_from(&whole.records);
                }
                assert!(part == expected, "rank {rank} of {size}");
            }
        }
        assert!(owners.iter().all(|count| *count == 1));
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
    assert_eq!(error, vec![Err(DomainError::RankCount { ranks: 64, cells: 24 * 32 }); 64]);
}

/// Verifies records, accounts, output fields, states and the search for the last sound state before a fault, in runs
/// that are interrupted and resumed.
#[test]
fn simulations_on_ranks_deliver_the_same_bits() {
    let faulty = |t: f64| if t < 2.2 { t.sin() } else { f64::INFINITY };
    for signal in [f64::sin, faulty] {
        let run = |solver: SolverChoice, interruptions: Option<usize>| {
            let create = || pulse_simulation(signal, solver.clone());
            let (simulation, grid) = (create(), create().problem().grid.cells);
            let output = build_output_times(0.2, 0.31, simulation.time_steps().step * 40.0);
            let (mut log, outcome, state) = run_with_interruptions(create, &output, interruptions);
            let fields: Vec<SolidFields> = std::mem::take(&mut log.fields)
                .into_iter()
                .map(|own| *own.downcast().expect("fields of a solid"))
                .collect();
            let cells = simulation.own_cells().to_vec();
            let numbers = (state.steps, state.time, state.initial_energy);
            (log.tables(), outcome.last_account, outcome.fault, numbers, fields, grid, cells)
        };
        let (tables, account, fault, numbers, fields, grid, _) =
            run(SolverChoice::Fused { threads: 1 }, None);
        for (size, interruptions) in [(2, None), (3, Some(2)), (4, Some(5))] {
            let found = run_ranks(size, |communicator| {
                run(SolverChoice::Ranks { communicator, threads: 1, parts: None }, interruptions)
            });
            assert_eq!(found[0].0, tables, "{size} ranks");
            for (rank, found) in found.into_iter().enumerate() {
                assert_eq!((found.1, &found.2, found.3), (account, &fault, numbers), "rank {rank}");
                assert_eq!(found.4.len(), fields.len());
                for (own, whole) in found.4.iter().zip(&fields) {
                    let whole = whole.values.iter().map(|own| cut(own, &grid, &found.6));
                    assert!(own.values.iter().cloned().eq(whole), "rank {rank} of {size}");
                }
            }
        }
    }
}
