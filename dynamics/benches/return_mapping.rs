//! What the return mapping costs: million cell-updates per second in the plane, one thread, with yield sets that nothing
//! reaches and with stresses beyond them in nearly all cells and steps, and the ratio to the plain row of the same run.
//!
//! `cargo bench -p wellposed-dynamics --bench return_mapping -- [word…]` takes the theories and numbers that have all
//! these words. A row is the third fastest of 25 rounds of four steps from one state.

#[path = "../tests/solid/support.rs"]
mod support;

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{Interlayer, InterlayerCouple, Mises};
use std::time::Instant;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

/// Cells along each axis.
const CELLS: usize = 500;

/// What a row has beyond the plain configuration: initial stress, reflections, or several kinds of yield sets.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Plain,
    /// An initial stress by depth.
    Gravity,
    /// The reflection 2P − I.
    SecondOrder,
    /// A tenth of all layers has an interlayer set.
    TwoKinds,
}

fn media(theory: Theory, kind: Kind, strength: f64) -> Vec<Medium> {
    let couple = CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 };
    let couple = (theory == Theory::Cosserat).then_some(couple);
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let rotation = (theory != Theory::Classical).then_some(rotation);
    let own = Medium::new(Isotropic::new(1.4, 0.9, 1.2, rotation).expect("sound moduli"), 2);
    let is_cosserat = theory == Theory::Cosserat;
    let cone = Mises {
        antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
        symmetric_length: is_cosserat.then_some(0.9),
        antisymmetric_length: is_cosserat.then_some(0.7),
        // Without friction: with it noise in tension goes to the apex, one stress at a time.
        ..Mises::von_mises(strength)
    };
    let mut media = vec![own.clone().yielding(YieldSet::from(cone))];
    if kind == Kind::TwoKinds {
        media.push(own.yielding(YieldSet::from(Interlayer {
            shear_strength: strength,
            shear_friction: 0.3,
            shear_dilatancy: 0.3,
            couple: is_cosserat.then_some(InterlayerCouple {
                strength,
                friction: 0.3,
                dilatancy: 0.3,
            }),
        })));
    }
    media
}

/// Million cell-updates per second, and the plastic dissipation of a step, J.
fn measure<T: SolverReal>(theory: Theory, kind: Kind, yields: bool) -> (f64, f64) {
    let strength = if yields { 0.02 } else { 1e3 };
    let media = media(theory, kind, strength);
    let count = CELLS * CELLS;
    let is_other = |cell: usize| kind == Kind::TwoKinds && cell / CELLS < CELLS / 10;
    let of_cell = (0..count).map(|cell| u16::from(is_other(cell))).collect();
    let step = 0.9 * 0.2 / media[0].greatest_speed();
    let plastic_step = if kind == Kind::SecondOrder {
        PlasticStep::MidpointReflection
    } else {
        PlasticStep::ReturnMapping
    };
    let scheme =
        Scheme { splitting: Splitting::Alternating, ..Scheme::new(Slopes::Limited, plastic_step) };
    let grid = Grid { cells: [CELLS; 2], spacing: [0.1; 2] };
    let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let mut problem = Problem::new(grid, media, of_cell, sides, step, scheme);
    if kind == Kind::Gravity {
        let stress = |layer: usize| {
            let mut stress = Stress::default();
            for axis in 0..3 {
                stress.force[axis][axis] = -1.0 - 0.01 * layer as f64;
            }
            stress
        };
        problem.initial_stress = Some((1, (0..CELLS).map(stress).collect()));
    }
    let mut domain: Domain<T, 2> = Domain::new(&problem).expect("a sound problem");
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        let value = |cell: usize| T::of(0.5 * support::noise((cell + index * count) as u64));
        domain.set(field, &(0..count).map(value).collect::<Vec<_>>());
    }
    let mut seconds = Vec::new();
    for _ in 0..25 {
        let mut own = domain.clone();
        (0..2).for_each(|_| own.advance());
        let start = Instant::now();
        (0..4).for_each(|_| own.advance());
        seconds.push(start.elapsed().as_secs_f64() / 4.0);
    }
    seconds.sort_by(f64::total_cmp);
    (0..6).for_each(|_| domain.advance());
    let before = domain.ledger().plastic;
    domain.advance();
    (2.0 * count as f64 / seconds[2] / 1e6, domain.ledger().plastic - before)
}

fn rows<T: SolverReal>(theory: Theory) {
    let name = format!("{theory:?} f{}", 8 * size_of::<T>()).to_lowercase();
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if !words.iter().all(|word| name.split(' ').any(|own| own == word)) {
        return;
    }
    for yields in [false, true] {
        let mut plain = 0.0;
        for kind in [Kind::Plain, Kind::Gravity, Kind::SecondOrder, Kind::TwoKinds] {
            let (rate, dissipated) = measure::<T>(theory, kind, yields);
            if kind == Kind::Plain {
                plain = rate;
            }
            let what = if yields { "yielding" } else { "never" };
            println!(
                "| {name} {kind:?} {what} | {rate:.1} | {:.2} | {dissipated:.1e} |",
                rate / plain
            );
        }
    }
}

fn main() {
    println!("| row | Mcu/s | of plain | dissipated in a step, J |\n|---|---|---|---|");
    for theory in [Theory::Classical, Theory::Cosserat] {
        rows::<f64>(theory);
        rows::<f32>(theory);
    }
}
