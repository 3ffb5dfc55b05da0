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

/// Cells along both axes: a multiple of the numbers of subdomains and of blocks.
const CELLS: usize = 36;
/// Cells of a block along each axis: cuts into two, three, four and six parts lie on planes of interlayers.
const BLOCK: usize = 3;

/// Returns blocks with layers of all kinds by face; two of three faces are saturated, those at the cuts into halves all
/// of them if `saturates_cuts`.
fn problem(random: &mut NoiseSequence, is_periodic: bool, saturates_cuts: bool) -> Problem<2> {
    let laws = layers_of_all_kinds(random);
    let saturated: Vec<usize> =
        (0..laws.len()).filter(|index| matches!(laws[*index], LayerLaw::Saturated(_))).collect();
    let interlayers = [0, 1].map(|axis| {
        let first = if is_periodic { 0 } else { BLOCK };
        let mut plane = |cell: usize| {
            let is_cut = saturates_cuts && cell == CELLS / 2;
            let law = |_| match is_cut || !random.is_one_in(3) {
                true => Some(random.choose(&saturated) as u16),
                false => Some(random.uniform_index(laws.len()) as u16),
            };
            let faces = (0..CELLS).map(law).collect();
            InterlayerPlane { cell, laws: PlaneLaws::ByFace(faces) }
        };
        Interlayers {
            axis,
            planes: (first..CELLS).step_by(BLOCK).map(&mut plane).collect(),
            laws: laws.iter().map(|law| InterlayerLaw::Plane(*law, axis)).collect(),
            has_open_ends: saturates_cuts,
        }
    });
    let media = vec![Medium::new(classical(1.0), 2), Medium::new(classical(3.0), 2)];
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let boundary = if is_periodic { Boundary::Periodic } else { Boundary::Free };
    let grid = Grid { cells: [CELLS; 2], spacing: [0.1; 2] };
    let cell_media = (0..grid.count())
        .map(|cell| (cell % CELLS / BLOCK + cell / CELLS / BLOCK) as u16 % 2)
        .collect();
    let boundaries = [0, 1].map(|_| [boundary.clone(), boundary.clone()]);
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    Problem {
        interlayers: interlayers.to_vec(),
        ..Problem::new(grid, media, cell_media, boundaries, 2.0 * 0.1 / speed, scheme)
    }
}

fn initial_values(index: usize) -> Vec<f64> {
    (0..CELLS * CELLS).map(|cell| noise((index * 1_000_003 + cell) as u64)).collect()
}

fn domain(problem: &Problem<2>, parts: [usize; 2]) -> DecomposedDomain<f64, 2> {
    let mut own: DecomposedDomain<f64, 2> =
        DecomposedDomain::with_subdomains(0, problem, parts).expect("sound");
    for (index, field) in own.fields().to_vec().into_iter().enumerate() {
        own.set(field, &initial_values(index));
    }
    own.initialise_interlayers();
    own
}

fn bits(snapshot: &Snapshot<f64>) -> Vec<u64> {
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
        let problem = problem(&mut random, is_periodic, saturates_cuts);
        let junctions = count_saturated_junctions(&problem);
        println!("{junctions} junctions");
        assert!(junctions > 50);
        let mut whole = domain(&problem, [1, 1]);
        let mut reference = Reference::<f64, 2>::new(&problem).expect("sound");
        for (index, field) in reference.fields().to_vec().into_iter().enumerate() {
            reference.set(field, &initial_values(index));
        }
        reference.initialise_interlayers();
        whole.advance(7).expect("threads");
        let snapshot = whole.snapshot();
        whole.advance(5).expect("threads");
        reference.advance(12);
        let end = whole.snapshot();
        assert_eq!(bits(&end), bits(&reference.snapshot()));
        let history = whole.interlayer_history();
        let flows = |start: usize| history[start + FLUID_VELOCITY].abs() > 1e-3;
        let moving =
            problem.interlayer_faces().iter().filter(|own| flows(own.history.start)).count();
        assert!(moving > 500, "{moving}");
        for parts in [[2, 1], [1, 2], [2, 2], [1, 3], [3, 2], [4, 3], [6, 5], [5, 7]] {
            let mut own = domain(&problem, parts);
            own.advance(12).expect("threads");
            assert!(bits(&own.snapshot()) == bits(&end), "{parts:?}");
            assert_eq!(own.ledger(), whole.ledger(), "{parts:?}");
            assert_eq!(own.energy(), whole.energy(), "{parts:?}");
            // A run in other parts goes on from the snapshot.
            let mut resumed = domain(&problem, parts);
            resumed.advance(3).expect("threads");
            assert!(resumed.restore(&snapshot));
            resumed.advance(5).expect("threads");
            assert_eq!(resumed.snapshot(), end, "{parts:?}");
        }
    }
}
