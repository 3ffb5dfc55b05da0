//! Plans of the distribution over ranks: balance of the work, given numbers of parts, and the messages of a run against
//! those that the plan predicts.

use crate::blocks::random_block_problem;
use crate::contacts::granular;
use crate::decomposition::{random_problem_of_solids, solids_in_theory, two_solids};
use crate::wide_stencil::with_wide_stencil;
use models::solid::parameters::Theory;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::communicator::{Communicator, SingleProcess, ThreadRank};
use wellposed_dynamics::decomposition::{DecomposedDomain, RankCounts, RankPlan};
use wellposed_dynamics::line::{Slopes, WideOrder};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};

/// First tag of messages that are no halos.
const COLLECTIVE_TAG: u16 = 32_767;

/// Rank that counts the messages with halos that it sends, and their bytes.
#[derive(Debug)]
struct CountingRank {
    rank: ThreadRank,
    sent: [AtomicUsize; 2],
}

impl Communicator for CountingRank {
    fn rank(&self) -> usize {
        self.rank.rank()
    }

    fn size(&self) -> usize {
        self.rank.size()
    }

    fn begin_send(&self, receiver: usize, tag: u16, message: Vec<u8>) {
        if tag < COLLECTIVE_TAG {
            self.sent[0].fetch_add(1, Ordering::Relaxed);
            self.sent[1].fetch_add(message.len(), Ordering::Relaxed);
        }
        self.rank.begin_send(receiver, tag, message);
    }

    fn receive(&self, sender: usize, tag: u16, message: &mut [u8]) {
        self.rank.receive(sender, tag, message);
    }

    fn abort(&self, cause: &str) -> ! {
        self.rank.abort(cause)
    }
}

/// Compares the messages of all ranks in a few passes with the planned ones.
fn compare_messages<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    ranks: usize,
    threads: usize,
) {
    const PASSES: usize = 3;
    let counts = RankCounts { ranks, threads, parts: None };
    // Some random problems are too small for so many ranks.
    let Ok(plan) = RankPlan::new(problem.first_axis(), problem, &counts, &SingleProcess) else {
        return;
    };
    let parts = plan.parts::<T>(problem).expect("room");
    let count = |rank: ThreadRank| {
        let own = Arc::new(CountingRank { rank, sent: Default::default() });
        let communicator: Arc<dyn Communicator> = own.clone();
        let plan = RankPlan::new(problem.first_axis(), problem, &counts, &*own).expect("room");
        let mut domain =
            DecomposedDomain::<T, D>::with_rank_plan(problem, plan, communicator).expect("sound");
        let steps = PASSES * domain.max_pass_steps();
        domain.advance(steps).expect("threads");
        let sent = own.sent.each_ref().map(|own| own.load(Ordering::Relaxed) as f64);
        (domain.own_cells(), sent.map(|own| own / steps as f64))
    };
    let found: Vec<_> = std::thread::scope(|scope| {
        let count = &count;
        let started: Vec<_> = ThreadRank::create_all(ranks)
            .into_iter()
            .map(|rank| scope.spawn(move || count(rank)))
            .collect();
        started.into_iter().map(|own| own.join().expect("no panic")).collect()
    });
    for (part, (cells, [messages, bytes])) in parts.iter().zip(found) {
        assert_eq!(part.cells, cells);
        assert!(part.bytes_per_step > 0.0 && part.surface > 0);
        assert_eq!([part.messages_per_step, part.bytes_per_step], [messages, bytes]);
    }
}

const FREE: [Boundary; 2] = [Boundary::Free, Boundary::Free];
const PERIODIC: [Boundary; 2] = [Boundary::Periodic, Boundary::Periodic];

#[test]
fn planned_messages_are_those_of_a_run() {
    let media = |theory| [two_solids(), solids_in_theory(theory)];
    for solids in media(Theory::Classical) {
        let create = |boundaries: &[[Boundary; 2]; 2], cells| {
            random_problem_of_solids(solids, boundaries, cells, PlasticStep::ReturnMapping)
        };
        let problem = create(&[FREE, PERIODIC], [41, 33]);
        compare_messages::<f64, 2>(&problem, 4, 1);
        compare_messages::<f32, 2>(&problem, 2, 2);
        let mut problem = create(&[PERIODIC, FREE], [40, 50]);
        problem.scheme.splitting = Splitting::Alternating;
        compare_messages::<f64, 2>(&problem, 6, 1);
        // Three and four ghost cells.
        for order in [WideOrder::Sixth, WideOrder::Eighth] {
            compare_messages::<f64, 2>(&with_wide_stencil(problem.clone(), order), 4, 1);
        }
    }
    for solids in media(Theory::Classical) {
        let mut problem = random_problem_of_solids(
            solids,
            &[FREE, PERIODIC, FREE],
            [14, 20, 13],
            PlasticStep::ReturnMapping,
        );
        compare_messages::<f64, 3>(&problem, 6, 1);
        compare_messages::<f64, 3>(&problem, 8, 1);
        problem.scheme.splitting = Splitting::Alternating;
        compare_messages::<f32, 3>(&problem, 4, 1);
    }
}

#[test]
fn planned_messages_include_history_variables_of_joints() {
    for number in 0..12 {
        let ranks = 2 + number % 5;
        compare_messages::<f64, 2>(&random_block_problem(number).0, ranks, 1);
        compare_messages::<f32, 3>(&random_block_problem(number).0, ranks, 1);
    }
}

/// Returns a problem whose upper third along the first axis is granular, beside another solid.
fn layered_problem() -> Problem<2> {
    let grid = Grid { cells: [90, 40], spacing: [0.1; 2] };
    let first = granular(0.5, None, 2);
    let media = vec![first.clone(), Medium { contact: None, ..first }];
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let cell_media = (0..grid.count()).map(|cell| u16::from(cell % 90 < 60)).collect();
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    Problem::new(grid, media, cell_media, [FREE, FREE], 1.9 * 0.1 / speed, scheme)
}

#[test]
fn cuts_balance_the_work_of_media() {
    let problem = layered_problem();
    let work = |cell: usize| problem.media[problem.medium_index(cell)].relative_work();
    let total: u64 = (0..problem.grid.count()).map(work).sum();
    // 60 layers of elastic cells and 30 of granular cells, each of which has four times their work.
    assert_eq!(total, 40 * (60 * 10 + 30 * 40));
    for ranks in [2, 3, 6] {
        let counts = RankCounts { ranks, threads: 1, parts: Some(vec![ranks, 1]) };
        let plan = RankPlan::new(0, &problem, &counts, &SingleProcess).expect("room");
        let own = |rank| plan.own_cells(rank).expect("room")[0].clone();
        let greatest =
            (0..ranks).map(|rank| own(rank).map(work).sum::<u64>() * 40).max().expect("ranks");
        let imbalance = greatest as f64 * ranks as f64 / total as f64;
        assert!(imbalance < 1.07, "{ranks} ranks: {imbalance}");
        // Several ranks count together what one process counts.
        let together: Vec<_> = std::thread::scope(|scope| {
            let (problem, counts) = (&problem, &counts);
            let started: Vec<_> = ThreadRank::create_all(ranks)
                .into_iter()
                .map(|rank| {
                    scope.spawn(move || {
                        let plan = RankPlan::new(0, problem, counts, &rank).expect("room");
                        plan.own_cells(rank.rank()).expect("room")[0].clone()
                    })
                })
                .collect();
            started.into_iter().map(|own| own.join().expect("no panic")).collect()
        });
        assert!((0..ranks).map(own).eq(together));
    }
}

#[test]
fn given_parts_are_taken_or_refused() {
    let problem = layered_problem();
    let plan = |parts: &[usize], ranks| {
        let counts = RankCounts { ranks, threads: 2, parts: Some(parts.to_vec()) };
        RankPlan::new(0, &problem, &counts, &SingleProcess)
    };
    let accepted = plan(&[2, 3], 6).expect("room");
    assert_eq!((accepted.part_counts(), accepted.threads()), ([2, 3], 2));
    let refused = plan(&[2, 3], 4).map(drop).unwrap_err();
    assert_eq!(refused, DomainError::PartCounts { parts: vec![2, 3], ranks: 4 });
    assert_eq!(refused.to_string(), "2 × 3 parts for 4 ranks");
    // Cells of parts must fill the halos of their neighbours.
    let refused = plan(&[1, 11], 11).map(drop);
    assert_eq!(refused, Err(DomainError::RankCount { ranks: 11, cells: 3600 }));
}
