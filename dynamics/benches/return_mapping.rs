//! Cost of the return mapping: million cell-updates per second in the plane on one thread, for yield sets that no
//! stress reaches and for trial stresses beyond the yield set in nearly all cells and steps, and the ratio of this rate
//! to that of the plain configuration.
//!
//! `cargo bench -p wellposed-dynamics --bench return_mapping -- [word…]` runs the theories and precisions whose names
//! contain all these words. A row is the fastest of nine rounds of four steps from the same state, by CPU time; rounds
//! of all rows are interleaved.

#[path = "../tests/solid/support/noise.rs"]
mod noise;

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

/// Number of cells along each axis.
const CELLS_PER_AXIS: usize = 500;

/// Addition to the plain configuration: initial stress, midpoint reflection, or a second kind of yield set.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Configuration {
    Plain,
    /// An initial stress that depends on depth.
    Gravity,
    /// The midpoint reflection 2P − I, with the projection P onto the yield set.
    SecondOrder,
    /// An interlayer yield set in a tenth of the layers.
    TwoKinds,
}

fn build_media(theory: Theory, configuration: Configuration, strength: f64) -> Vec<Medium> {
    let couple = CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 };
    let couple = (theory == Theory::Cosserat).then_some(couple);
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let rotation = (theory != Theory::Classical).then_some(rotation);
    let medium = Medium::new(Isotropic::new(1.4, 0.9, 1.2, rotation).expect("sound moduli"), 2);
    let is_cosserat = theory == Theory::Cosserat;
    let cone = Mises {
        antisymmetric_weight: if theory == Theory::Classical { 0.0 } else { 0.8 },
        symmetric_internal_length: is_cosserat.then_some(0.9),
        antisymmetric_internal_length: is_cosserat.then_some(0.7),
        // No friction: with friction, tensile noise returns to the apex, which is handled by the scalar projection.
        ..Mises::new_von_mises(strength)
    };
    let mut media = vec![medium.clone().with_yield_set(YieldSet::from(cone))];
    if configuration == Configuration::TwoKinds {
        media.push(medium.with_yield_set(YieldSet::from(InterlayerYieldSet {
            shear_strength: strength,
            shear_friction: 0.3,
            shear_dilatancy: 0.3,
            couple: is_cosserat.then_some(InterlayerCoupleLimits {
                strength,
                friction: 0.3,
                dilatancy: 0.3,
            }),
        })));
    }
    media
}

/// Creates a domain with stresses far beyond the yield set if `is_yielding` is true, else far inside it.
fn build_domain<T: SolverReal>(
    theory: Theory,
    configuration: Configuration,
    is_yielding: bool,
) -> Domain<T, 2> {
    let strength = if is_yielding { 0.02 } else { 1e3 };
    let media = build_media(theory, configuration, strength);
    let count = CELLS_PER_AXIS * CELLS_PER_AXIS;
    let has_second_kind = |cell: usize| {
        configuration == Configuration::TwoKinds && cell / CELLS_PER_AXIS < CELLS_PER_AXIS / 10
    };
    let cell_media = (0..count).map(|cell| u16::from(has_second_kind(cell))).collect();
    let step = 0.9 * 0.2 / media[0].max_speed();
    let plastic_step = if configuration == Configuration::SecondOrder {
        PlasticStep::MidpointReflection
    } else {
        PlasticStep::ReturnMapping
    };
    let scheme =
        Scheme { splitting: Splitting::Alternating, ..Scheme::new(Slopes::Limited, plastic_step) };
    let grid = Grid { cells: [CELLS_PER_AXIS; 2], spacing: [0.1; 2] };
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let mut problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
    if configuration == Configuration::Gravity {
        let stress = |layer: usize| {
            let mut stress = Stress::default();
            for axis in 0..3 {
                stress.force[axis][axis] = -1.0 - 0.01 * layer as f64;
            }
            stress
        };
        problem.initial_stress = Some((1, (0..CELLS_PER_AXIS).map(stress).collect()));
    }
    let mut domain: Domain<T, 2> = Domain::new(&problem).expect("a sound problem");
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        let value = |cell: usize| T::from_f64(0.5 * noise::noise((cell + index * count) as u64));
        domain.set_field(field, &(0..count).map(value).collect::<Vec<_>>());
    }
    domain
}

/// Returns the CPU time of this thread, s.
#[cfg(target_os = "linux")]
fn thread_cpu_time() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes to `time` only.
    let failed = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    assert_eq!(failed, 0, "no clock of the processor's time");
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Returns the time elapsed since the first call, s.
#[cfg(not(target_os = "linux"))]
fn thread_cpu_time() -> f64 {
    static CLOCK_START: std::sync::LazyLock<std::time::Instant> =
        std::sync::LazyLock::new(std::time::Instant::now);
    CLOCK_START.elapsed().as_secs_f64()
}

fn measure_rows<T: SolverReal>(theory: Theory) {
    let name = format!("{theory:?} f{}", 8 * size_of::<T>()).to_lowercase();
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if !words.iter().all(|word| name.split(' ').any(|own| own == word)) {
        return;
    }
    const CONFIGURATIONS: [Configuration; 4] = [
        Configuration::Plain,
        Configuration::Gravity,
        Configuration::SecondOrder,
        Configuration::TwoKinds,
    ];
    for is_yielding in [false, true] {
        let mut domains = CONFIGURATIONS
            .map(|configuration| build_domain::<T>(theory, configuration, is_yielding));
        let mut seconds = [f64::INFINITY; CONFIGURATIONS.len()];
        for _ in 0..9 {
            for (domain, shortest) in domains.iter().zip(&mut seconds) {
                let mut working_copy = domain.clone();
                (0..2).for_each(|_| working_copy.advance());
                let start = thread_cpu_time();
                (0..4).for_each(|_| working_copy.advance());
                *shortest = shortest.min((thread_cpu_time() - start) / 4.0);
            }
        }
        for ((domain, configuration), shortest) in
            domains.iter_mut().zip(CONFIGURATIONS).zip(seconds)
        {
            (0..6).for_each(|_| domain.advance());
            let before = domain.ledger().plastic_dissipation;
            domain.advance();
            let dissipated = domain.ledger().plastic_dissipation - before;
            let label = if is_yielding { "yielding" } else { "never" };
            println!(
                "| {name} {configuration:?} {label} | {:.1} | {:.2} | {dissipated:.1e} |",
                2.0 * (CELLS_PER_AXIS * CELLS_PER_AXIS) as f64 / shortest / 1e6,
                seconds[0] / shortest
            );
        }
    }
}

fn main() {
    println!("| row | Mcu/s | of plain | dissipated in a step, J |\n|---|---|---|---|");
    for theory in [Theory::Classical, Theory::Cosserat] {
        measure_rows::<f64>(theory);
        measure_rows::<f32>(theory);
    }
}
