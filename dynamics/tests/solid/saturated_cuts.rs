//! Domain decomposition through interlayers of all kinds and through junctions of saturated ones.

use crate::support::interlayers::{count_saturated_junctions, layers_of_all_kinds};
use crate::support::media::classical;
use crate::support::noise;
use crate::support::random::NoiseSequence;
use models::interface::history::FLUID_VELOCITY;
use models::interface::layer::LayerLaw;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::solid::interlayers::{
    InterlayerLaw, InterlayerPlane, Interlayers, PlaneLaws,
};

/// Number of cells along each axis: a multiple of the cells of a block.
const CELL_COUNT: usize = 36;
/// Number of cells of a block along each axis: cuts into two, three, four and six parts lie on planes of interlayers.
const BLOCK_CELLS: usize = 3;

/// Builds a medium of blocks with interlayers of all kinds, face by face. Two of three faces are saturated; if
/// `saturates_cuts`, so are all faces on the planes that halve the grid.
pub(crate) fn build_problem(
    random: &mut NoiseSequence,
    is_periodic: bool,
    saturates_cuts: bool,
) -> Problem<2> {
    let laws = layers_of_all_kinds(random);
    let saturated: Vec<usize> =
        (0..laws.len()).filter(|index| matches!(laws[*index], LayerLaw::Saturated(_))).collect();
    let interlayers = [0, 1].map(|axis| {
        let first = if is_periodic { 0 } else { BLOCK_CELLS };
        let mut plane = |cell: usize| {
            let is_cut = saturates_cuts && cell == CELL_COUNT / 2;
            let law = |_| match is_cut || !random.is_one_in(3) {
                true => Some(random.choose(&saturated) as u16),
                false => Some(random.uniform_index(laws.len()) as u16),
            };
            let faces = (0..CELL_COUNT).map(law);
            InterlayerPlane { cell, laws: PlaneLaws::from_faces(faces) }
        };
        Interlayers {
            axis,
            planes: (first..CELL_COUNT).step_by(BLOCK_CELLS).map(&mut plane).collect(),
            laws: laws.iter().map(|law| InterlayerLaw::Plane(*law, axis)).collect(),
            has_open_ends: saturates_cuts,
        }
    });
    let media = vec![Medium::new(classical(1.0), 2), Medium::new(classical(3.0), 2)];
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let boundary = if is_periodic { Boundary::Periodic } else { Boundary::Free };
    let grid = Grid { cells: [CELL_COUNT; 2], spacing: [0.1; 2] };
    let cell_media = (0..grid.count())
        .map(|cell| (cell % CELL_COUNT / BLOCK_CELLS + cell / CELL_COUNT / BLOCK_CELLS) as u16 % 2)
        .collect();
    let boundaries = [0, 1].map(|_| [boundary.clone(), boundary.clone()]);
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    Problem {
        interlayers: interlayers.to_vec(),
        ..Problem::new(grid, media, cell_media, boundaries, 2.0 * 0.1 / speed, scheme)
    }
}

fn initial_values(index: usize) -> Vec<f64> {
    (0..CELL_COUNT * CELL_COUNT).map(|cell| noise((index * 1_000_003 + cell) as u64)).collect()
}

fn build_domain(problem: &Problem<2>, subdomain_counts: [usize; 2]) -> DecomposedDomain<f64, 2> {
    let mut decomposed: DecomposedDomain<f64, 2> =
        DecomposedDomain::with_subdomains(0, problem, subdomain_counts).expect("sound");
    for (index, field) in decomposed.fields().to_vec().into_iter().enumerate() {
        decomposed.set_field(field, &initial_values(index));
    }
    decomposed.initialise_interlayers();
    decomposed
}

fn snapshot_bits(snapshot: &Snapshot<f64>) -> Vec<u64> {
    let values = snapshot.fields.iter().flatten().chain(&snapshot.interlayer_history);
    values.map(|value| value.to_bits()).collect()
}

/// Verifies that cuts along both axes, through faces of all kinds and through junctions of saturated layers, change no
/// bit, also from a snapshot taken in the middle of a run, and that the reference solver has the same bits.
#[test]
fn cuts_through_saturated_junctions_change_no_bit() {
    let mut random = NoiseSequence::new(90 << 40);
    for (is_periodic, saturates_cuts) in
        [(false, false), (false, true), (true, false), (true, true)]
    {
        let problem = build_problem(&mut random, is_periodic, saturates_cuts);
        let junctions = count_saturated_junctions(&problem);
        println!("{junctions} junctions");
        assert!(junctions > 50);
        let mut whole = build_domain(&problem, [1, 1]);
        let mut reference = Reference::<f64, 2>::new(&problem).expect("sound");
        for (index, field) in reference.fields().to_vec().into_iter().enumerate() {
            reference.set_field(field, &initial_values(index));
        }
        reference.initialise_interlayers();
        whole.advance(7).expect("threads");
        let snapshot = whole.snapshot();
        whole.advance(5).expect("threads");
        reference.advance(12);
        let final_snapshot = whole.snapshot();
        assert_eq!(snapshot_bits(&final_snapshot), snapshot_bits(&reference.snapshot()));
        let history = whole.interlayer_history();
        let has_flow = |start: usize| history[start + FLUID_VELOCITY].abs() > 1e-3;
        let flowing_count =
            problem.interlayer_faces().iter().filter(|face| has_flow(face.history.start)).count();
        assert!(flowing_count > 500, "{flowing_count}");
        for subdomain_counts in [[2, 1], [1, 2], [2, 2], [1, 3], [3, 2], [4, 3], [6, 5], [5, 7]] {
            let mut decomposed = build_domain(&problem, subdomain_counts);
            decomposed.advance(12).expect("threads");
            assert!(
                snapshot_bits(&decomposed.snapshot()) == snapshot_bits(&final_snapshot),
                "{subdomain_counts:?}"
            );
            assert_eq!(decomposed.ledger(), whole.ledger(), "{subdomain_counts:?}");
            assert_eq!(decomposed.energy(), whole.energy(), "{subdomain_counts:?}");
            // A run in other subdomains continues from the snapshot.
            let mut resumed = build_domain(&problem, subdomain_counts);
            resumed.advance(3).expect("threads");
            assert!(resumed.restore(&snapshot));
            resumed.advance(5).expect("threads");
            assert_eq!(resumed.snapshot(), final_snapshot, "{subdomain_counts:?}");
        }
    }
}
