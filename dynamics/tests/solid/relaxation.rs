//! Relaxing solids: frequency and damping of plane waves against the complex modulus, energy, ledger, exact relaxation
//! at rest, bitwise reproducibility, several constitutive laws in one run.

use crate::support::media::isotropic;
use crate::support::noise;
use models::InputError;
use models::rheology::relaxation::StandardLinearSolid;
use models::solid::parameters::Theory;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use num_complex::Complex64 as Complex;
use std::f64::consts::TAU;
use std::sync::Arc;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Load, Source};
use wellposed_dynamics::decomposition::{DecomposedDomain, Snapshot};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::InstructionSet;
use wellposed_dynamics::simulation::{
    Simulation, SolidSimulation, SolverChoice, StateSource as _, TimeSteps,
};

const LAMBDA: f64 = 1.4;
/// Relaxed shear modulus μ_R, Pa.
const MU: f64 = 0.9;
/// Shear modulus μ₁ of the relaxing branch (spring and dashpot in series), Pa.
const BRANCH_MODULUS: f64 = 0.5;
const DENSITY: f64 = 1.2;

const SPLITTINGS: [Splitting; 2] = [Splitting::TwoCyclic, Splitting::Alternating];

fn relaxing_medium(theory: Theory, time: f64, dimensions: usize) -> Medium {
    let solid: Result<_, InputError> =
        StandardLinearSolid::from_relaxed(isotropic(theory, 1.0), BRANCH_MODULUS, time);
    Medium::with_relaxation(solid.expect("sound constants"), dimensions)
}

fn return_mapping_scheme(slopes: Slopes, splitting: Splitting) -> Scheme {
    Scheme { splitting, ..Scheme::new(slopes, PlasticStep::ReturnMapping) }
}

fn periodic_boundaries<const D: usize>() -> [[Boundary; 2]; D] {
    std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic])
}

fn fill_with_noise<T: SolverReal, const D: usize>(domain: &mut DecomposedDomain<T, D>, size: f64) {
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        let count = domain.values(field).expect("a field").len();
        let value = |cell: usize| T::from_f64(size * noise((1000 * index + cell) as u64));
        domain.set_field(field, &(0..count).map(value).collect::<Vec<_>>());
    }
}

/// Complex shear modulus μ(ς), Pa: for a strain e ∝ exp(ςt) spring and dashpot have the viscous strain e/(1 + ςτ).
fn shear_modulus(rate: Complex, time: f64) -> Complex {
    let viscous = (rate * time + 1.0).inv();
    MU + BRANCH_MODULUS * (1.0 - viscous)
}

/// Finds the root of f next to `start` by the secant method.
fn find_root(f: impl Fn(Complex) -> Complex, start: Complex) -> Complex {
    let (mut a, mut b) = (start, start * Complex::new(1.001, 0.0007));
    for _ in 0..60 {
        let (fa, fb) = (f(a), f(b));
        if (fb - fa).norm() < 1e-300 {
            break;
        }
        (a, b) = (b, b - fb * (b - a) / (fb - fa));
    }
    assert!(f(b).norm() < 1e-12 && b.re < 0.0 && b.im > 0.0, "{b}");
    b
}

/// A plane wave exp(ςt + ik·x), damped at −Re ς, with `mode_numbers` periods along each axis of the unit box.
struct DampedPlaneWave<const D: usize> {
    mode_numbers: [usize; D],
    /// Direction of the velocity.
    polarisation: [f64; 3],
    complex_rate: Complex,
    relaxation_time: f64,
    theory: Theory,
}

impl<const D: usize> DampedPlaneWave<D> {
    /// Creates a P wave, or an S wave polarised in the plane of the first two axes. The relaxation time τ is of the
    /// order of the period over 2π.
    fn new(wave: [usize; D], is_longitudinal: bool, theory: Theory) -> Self {
        let mut n = [0.0; 3];
        wave.iter().enumerate().for_each(|(axis, number)| n[axis] = *number as f64);
        let norm = n.iter().map(|x| x * x).sum::<f64>().sqrt();
        let n = n.map(|x| x / norm);
        let polarisation = match is_longitudinal {
            true => n,
            false => {
                let size = n[0].hypot(n[1]);
                [-n[1] / size, n[0] / size, 0.0]
            }
        };
        let k = TAU * norm;
        let time = 0.7 / (k * (MU / DENSITY).sqrt());
        let bulk = LAMBDA + 2.0 / 3.0 * MU;
        let microrotation =
            isotropic(theory, 1.0).microrotation.map_or([0.0; 2], |m| [m.alpha, m.inertia]);
        let modulus = |rate: Complex| {
            let shear = shear_modulus(rate, time);
            match (is_longitudinal, microrotation) {
                (true, _) => bulk + 4.0 / 3.0 * shear,
                (false, [0.0, _]) => shear,
                // Spin amplitude ω for the velocity amplitude v, from jς²ω + 4αω = 2αik v.
                (false, [alpha, inertia]) => {
                    let kinetic = rate * rate * inertia;
                    shear + alpha * kinetic / (kinetic + 4.0 * alpha)
                }
            }
        };
        let start =
            Complex::new(-0.1, 1.0) * k * (modulus(Complex::new(0.0, 1e9)).re / DENSITY).sqrt();
        let rate =
            find_root(|rate| (rate * rate * DENSITY + modulus(rate) * (k * k)) / (k * k), start);
        Self { mode_numbers: wave, polarisation, complex_rate: rate, relaxation_time: time, theory }
    }

    /// Computes the amplitude of a field for unit velocity amplitude.
    fn amplitude(&self, field: SolidField) -> Complex {
        let Self { polarisation: p, complex_rate: rate, relaxation_time: time, theory, .. } = self;
        let mut k = [0.0; 3];
        self.mode_numbers.iter().enumerate().for_each(|(axis, own)| k[axis] = TAU * *own as f64);
        let over = Complex::i() / rate;
        let gradient = |i: usize, j: usize| over * (p[i] * k[j]);
        let volume = gradient(0, 0) + gradient(1, 1) + gradient(2, 2);
        let kronecker = |i: usize, j: usize| f64::from(u8::from(i == j));
        let deviator = |i: usize, j: usize| {
            (gradient(i, j) + gradient(j, i)) * 0.5 - volume * (kronecker(i, j) / 3.0)
        };
        let m = isotropic(*theory, 1.0).microrotation;
        // About x₃, for waves in the plane: (curl v)₃ is twice the rotation rate of the material.
        let curl = Complex::i() * (p[1] * k[0] - p[0] * k[1]);
        let spin = m.map_or(Complex::ZERO, |m| {
            curl * (2.0 * m.alpha) / (rate * rate * m.inertia + 4.0 * m.alpha)
        });
        match field {
            SolidField::Velocity(i) => Complex::from(p[i]),
            SolidField::Spin(2) => spin,
            SolidField::ViscousStrain(i, j) => deviator(i, j) / (rate * *time + 1.0),
            SolidField::Stress(i, j) => {
                let bulk = LAMBDA + 2.0 / 3.0 * MU;
                let symmetric = volume * (bulk * kronecker(i, j))
                    + shear_modulus(*rate, *time) * 2.0 * deviator(i, j);
                let turned = match (i, j) {
                    (1, 0) => curl - spin * 2.0,
                    (0, 1) => -(curl - spin * 2.0),
                    _ => Complex::ZERO,
                };
                symmetric + m.map_or(Complex::ZERO, |m| turned / rate * m.alpha)
            }
            _ => Complex::ZERO,
        }
    }

    /// Computes the relative error of the rate ς over the last three quarters of the time in which the amplitude
    /// halves, with `cells` cells along each axis.
    fn rate_error(&self, cells: usize, splitting: Splitting) -> f64 {
        let medium = relaxing_medium(self.theory, self.relaxation_time, D);
        let grid = Grid { cells: [cells; D], spacing: [1.0 / cells as f64; D] };
        let duration = 0.7 / -self.complex_rate.re;
        let longest = 0.9 * 2.0 / (8.0 * medium.max_speed());
        // The Courant number is the same on all grids; the number of steps is a multiple of four.
        let steps = 4 * (0.25 * duration / longest).ceil() as usize * cells / 8;
        let (step, count) = (duration / steps as f64, grid.count());
        let scheme = return_mapping_scheme(Slopes::FourthOrder, splitting);
        let problem =
            Problem::new(grid, vec![medium], vec![0; count], periodic_boundaries(), step, scheme);
        let mut domain: DecomposedDomain<f64, D> =
            DecomposedDomain::new(&problem, 1).expect("sound");
        let phase = |cell: usize| {
            let (mut remaining_index, mut phase) = (cell, 0.0);
            for own in self.mode_numbers {
                phase += TAU * own as f64 * ((remaining_index % cells) as f64 + 0.5) / cells as f64;
                remaining_index /= cells;
            }
            Complex::from_polar(1.0, phase)
        };
        for field in domain.fields().to_vec() {
            let amplitude = self.amplitude(field);
            let values = (0..count).map(|cell| (amplitude * phase(cell)).re);
            domain.set_field(field, &values.collect::<Vec<_>>());
        }
        let fields = domain.fields().to_vec();
        let amplitude = |domain: &DecomposedDomain<f64, D>| {
            let mut sum = Complex::ZERO;
            for (field, values) in fields.iter().zip(domain.output_values()) {
                let SolidField::Velocity(i) = field else { continue };
                for (cell, value) in values.into_iter().enumerate() {
                    sum += phase(cell).conj() * (value * self.polarisation[*i]);
                }
            }
            sum
        };
        // Measured between two times, since initial values and output change the amplitude once.
        domain.advance(steps / 4).expect("threads");
        let first = amplitude(&domain);
        domain.advance(steps - steps / 4).expect("threads");
        let duration = (steps - steps / 4) as f64 * step;
        // The ratio is close to 1, so that its logarithm needs no phase unwrapping.
        let ratio = amplitude(&domain) / first / (self.complex_rate * duration).exp();
        (ratio.ln() / duration).norm() / self.complex_rate.norm()
    }

    /// Verifies second order of the error of ς between two grids that are fine enough for the asymptotic order.
    fn check_second_order(&self, cells: [usize; 2], max_error: f64) {
        for splitting in SPLITTINGS {
            let errors = cells.map(|cells| self.rate_error(cells, splitting));
            let order = (errors[0] / errors[1]).ln() / (cells[1] as f64 / cells[0] as f64).ln();
            println!(
                "{:?} {:?} {splitting:?}: {errors:?}, {order}",
                self.mode_numbers, self.theory
            );
            assert!(order > 1.9, "{:?} {splitting:?}: {errors:?}, {order}", self.mode_numbers);
            assert!(errors[1] < max_error, "{:?} {splitting:?}: {errors:?}", self.mode_numbers);
        }
    }
}

#[test]
fn plane_waves_are_second_order() {
    for (is_longitudinal, waves) in [(true, [[0, 1], [2, 1]]), (false, [[1, 0], [1, 1]])] {
        for wave in waves {
            DampedPlaneWave::new(wave, is_longitudinal, Theory::Classical)
                .check_second_order([96, 192], 1e-4);
        }
        DampedPlaneWave::new([1, 1, 1], is_longitudinal, Theory::Classical)
            .check_second_order([32, 48], 1e-3);
    }
}

/// Verifies second order with spin–stress rotation in addition to relaxation.
#[test]
fn shear_waves_with_spin_are_second_order() {
    for wave in [[1, 0], [0, 1], [1, 1]] {
        DampedPlaneWave::new(wave, false, Theory::Reduced).check_second_order([96, 192], 1e-4);
    }
}

/// Verifies exact relaxation at rest: in the time t deviatoric stresses are multiplied by (μ_R + μ₁e^(−t/τ))/μ_U, with
/// the relaxed modulus μ_R, the branch modulus μ₁, the unrelaxed modulus μ_U = μ_R + μ₁ and the relaxation time τ.
#[test]
fn uniform_strain_relaxes_exactly() {
    for splitting in SPLITTINGS {
        for plastic_step in [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection] {
            check_relaxation_at_rest::<2>(splitting, plastic_step, Theory::Cosserat);
            check_relaxation_at_rest::<3>(splitting, plastic_step, Theory::Classical);
        }
    }
}

fn check_relaxation_at_rest<const D: usize>(
    splitting: Splitting,
    plastic_step: PlasticStep,
    theory: Theory,
) {
    let time = 0.13;
    let medium =
        relaxing_medium(theory, time, D).with_yield_set(YieldSet::from(Mises::new_von_mises(1e3)));
    let grid = Grid { cells: [7; D], spacing: [0.1; D] };
    let step = 0.9 * 2.0 * 0.1 / medium.max_speed();
    let scheme = Scheme { plastic_step, ..return_mapping_scheme(Slopes::Limited, splitting) };
    let count = grid.count();
    let problem =
        Problem::new(grid, vec![medium], vec![0; count], periodic_boundaries(), step, scheme);
    let mut domain: Domain<f64, D> = Domain::new(&problem).expect("sound");
    let start = |field: SolidField| match field {
        SolidField::Stress(i, j) => [[0.7, 0.3, -0.2], [0.3, -0.4, 0.5], [-0.2, 0.5, 0.25]][i][j],
        _ => 0.0,
    };
    for field in domain.fields().to_vec() {
        domain.set_field(field, &vec![start(field); count]);
    }
    let mean = (0.7 - 0.4 + 0.25) / 3.0;
    for index in 1..=12 {
        domain.advance();
        let decay = (-step * f64::from(index) / time).exp();
        for field in domain.fields().to_vec() {
            let deviator = |i: usize, j: usize| {
                start(SolidField::Stress(i, j)) - if i == j { mean } else { 0.0 }
            };
            let expected = match field {
                SolidField::Stress(i, j) => {
                    let remaining_fraction = (MU + BRANCH_MODULUS * decay) / (MU + BRANCH_MODULUS);
                    deviator(i, j) * remaining_fraction + if i == j { mean } else { 0.0 }
                }
                SolidField::ViscousStrain(i, j) => {
                    0.5 * deviator(i, j) / (MU + BRANCH_MODULUS) * (1.0 - decay)
                }
                _ => 0.0,
            };
            for found in domain.values(field).expect("a field") {
                assert!((found - expected).abs() < 1e-13, "{field:?} {found} {expected}");
            }
        }
    }
}

/// Returns an elastic, a relaxing, a relaxing and yielding, and a yielding medium.
fn four_media(theory: Theory, step: f64, dimensions: usize) -> Vec<Medium> {
    let set = |strength: f64| YieldSet::from(Mises::new_drucker_prager(strength, 0.2, 0.2));
    vec![
        Medium::new(isotropic(theory, 1.0), dimensions),
        relaxing_medium(theory, 5.0 * step, dimensions),
        relaxing_medium(theory, 40.0 * step, dimensions).with_yield_set(set(0.8)),
        Medium::new(isotropic(theory, 1.0), dimensions).with_yield_set(set(0.5)),
    ]
}

/// Returns a problem with all four media at random in a box with free, fixed and periodic boundaries.
fn mixed_problem<const D: usize>(cells: [usize; D], theory: Theory, scheme: Scheme) -> Problem<D> {
    let speed = relaxing_medium(theory, 1.0, D).max_speed();
    let grid = Grid { cells, spacing: [0.1; D] };
    let step = 0.9 * 2.0 * 0.1 / speed;
    let cell_media =
        (0..grid.count() as u64).map(|cell| (2.0 + 2.0 * noise(cell)) as u16).collect();
    let mut boundaries = periodic_boundaries();
    boundaries[0] = [Boundary::Free, Boundary::Fixed];
    Problem::new(grid, four_media(theory, step, D), cell_media, boundaries, step, scheme)
}

/// Verifies that energy never grows from random states with viscous strains, for steps far shorter and longer than τ.
/// In one subdomain: every call would start the threads of several, which change no bit.
#[test]
fn energy_never_grows() {
    for splitting in SPLITTINGS {
        for theory in [Theory::Classical, Theory::Cosserat] {
            for factor in [1e-3, 1.0, 1e3] {
                let scheme = return_mapping_scheme(Slopes::Limited, splitting);
                let mut problem = mixed_problem([9, 8], theory, scheme);
                let step = problem.step;
                problem.media[1] = relaxing_medium(theory, factor * step, 2);
                let mut domain: DecomposedDomain<f64, 2> =
                    DecomposedDomain::new(&problem, 1).expect("sound");
                fill_with_noise(&mut domain, 1.0);
                let mut last = domain.energy().total();
                let start = last;
                for index in 0..1000 {
                    domain.advance(1).expect("threads");
                    let now = domain.energy().total();
                    assert!(now <= last * (1.0 + 1e-13), "{index}: {now} after {last}");
                    last = now;
                }
                assert!(last < 0.5 * start);
                assert_eq!(domain.first_non_finite(), None);
            }
        }
    }
}

/// Verifies the full ledger with all loads: every term is computed independently, and the stored energy includes the
/// springs of the branches.
#[test]
fn ledger_closes() {
    for (splitting, plastic_step) in [
        (Splitting::TwoCyclic, PlasticStep::ReturnMapping),
        (Splitting::TwoCyclic, PlasticStep::MidpointReflection),
        (Splitting::Alternating, PlasticStep::ReturnMapping),
    ] {
        for theory in [Theory::Classical, Theory::Reduced, Theory::Cosserat] {
            let scheme = Scheme {
                plastic_step,
                ..self::return_mapping_scheme(Slopes::FourthOrder, splitting)
            };
            let mut problem = mixed_problem([12, 10], theory, scheme);
            let signal = Arc::new(|time: f64| (3.0 * time).sin());
            let faces = (0..9).map(|face| (face, 0.3)).collect();
            problem.loads.push(Load { axis: 0, end: 0, pair: 0, faces, signal: signal.clone() });
            let amplitudes = vec![(SolidField::Velocity(1), 0.1), (SolidField::Stress(0, 1), 0.02)];
            problem.sources.push(Source { cells: vec![(51, 1.0)], amplitudes, signal });
            problem.acceleration = [0.0, -0.05];
            if plastic_step == PlasticStep::MidpointReflection {
                let force = [[-0.1, 0.02, 0.0], [0.02, -0.15, 0.0], [0.0; 3]];
                let stress = Stress { force, ..Stress::default() };
                problem.initial_stress = Some((1, vec![stress; 10]));
            }
            let mut domain: Reference<f64, 2> = Reference::new(&problem).expect("sound");
            for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
                let values = (0..120).map(|cell| 0.5 * noise(1000 * index as u64 + cell));
                domain.set_field(field, &values.collect::<Vec<_>>());
            }
            let start = domain.energy().total();
            let (mut error, mut scale) = (0.0f64, start);
            for index in 0..1000 {
                domain.advance(1);
                if index % 10 == 0 {
                    let energy = domain.energy().total();
                    scale = scale.max(energy);
                    error = error.max((energy - start - domain.ledger().energy_change()).abs());
                }
            }
            let ledger = domain.ledger();
            println!("{theory:?} {splitting:?} {plastic_step:?}: {:e} {ledger:?}", error / scale);
            assert!(error < 1e-12 * scale, "{theory:?}: {:e}", error / scale);
            assert!(
                ledger.viscous_dissipation > 1e-2 * scale && ledger.plastic_dissipation > 0.0,
                "{ledger:?}"
            );
            assert!(ledger.source_work != 0.0 && ledger.boundary_work != 0.0, "{ledger:?}");
        }
    }
}

/// Verifies the stored energy of a domain against that of the springs of the solid, computed from the state by cell.
#[test]
fn stored_energy_is_that_of_the_springs() {
    let theory = Theory::Cosserat;
    let grid = Grid { cells: [5, 4], spacing: [0.1, 0.2] };
    let solid = StandardLinearSolid::from_relaxed(isotropic(theory, 1.0), BRANCH_MODULUS, 0.3)
        .expect("sound");
    let media = vec![Medium::with_relaxation(solid, 2)];
    let scheme = return_mapping_scheme(Slopes::Limited, Splitting::TwoCyclic);
    let problem = Problem::new(grid, media, vec![0; 20], periodic_boundaries(), 1e-3, scheme);
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        let values = (0..20).map(|cell| noise(1000 * index as u64 + cell));
        domain.set_field(field, &values.collect::<Vec<_>>());
    }
    let stored: f64 = (0..20)
        .map(|cell| {
            let strain = |i: usize, j: usize| {
                let field = SolidField::ViscousStrain(i.min(j), i.max(j));
                domain.value(field, cell).unwrap_or(0.0)
            };
            let strain = std::array::from_fn(|i| std::array::from_fn(|j| strain(i, j)));
            0.02 * solid.stored_energy(&domain.total_stress(cell), &strain)
        })
        .sum();
    let found = domain.energy().stored;
    assert!((found - stored).abs() < 1e-13 * stored, "{found} {stored}");
}

/// Returns the bits of the fields and of the cell sums of a snapshot.
fn snapshot_bits<T: SolverReal>(own: &Snapshot<T>) -> (Vec<Vec<u64>>, Vec<Vec<u64>>) {
    let to_bits = |values: &Vec<T>| values.iter().map(|value| value.to_f64().to_bits()).collect();
    let sums = own.cell_sums.iter().map(|own| own.iter().map(|value| value.to_bits()).collect());
    (own.fields.iter().map(to_bits).collect(), sums.collect())
}

/// Compares runs bit by bit: decompositions, instruction sets, resumed from a snapshot, and the reference solver.
fn compare_bits<T: SolverReal, const D: usize>(cells: [usize; D], theory: Theory) {
    for splitting in SPLITTINGS {
        for plastic_step in [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection] {
            let scheme =
                Scheme { plastic_step, ..return_mapping_scheme(Slopes::Limited, splitting) };
            let problem = mixed_problem(cells, theory, scheme);
            let mut expected = None;
            let cut = |axis: usize, count: usize| {
                std::array::from_fn(|own| if own == axis { count } else { 1 })
            };
            for parts in [cut(D - 1, 1), cut(D - 1, 2), cut(D - 1, 3), cut(0, 2)] {
                // Every instruction set in one subdomain, the widest in several.
                for instructions in InstructionSet::available_sets()
                    .filter(|own| parts == [1; D] || *own == InstructionSet::widest())
                {
                    let create_domain = || -> DecomposedDomain<T, D> {
                        let mut domain =
                            DecomposedDomain::with_subdomains(0, &problem, parts).expect("sound");
                        domain.set_instructions(instructions);
                        domain
                    };
                    let mut domain = create_domain();
                    fill_with_noise(&mut domain, 1.0);
                    domain.advance(7).expect("threads");
                    let mut resumed = create_domain();
                    assert!(resumed.restore(&domain.snapshot()));
                    resumed.advance(12).expect("threads");
                    assert!(
                        resumed.ledger().viscous_dissipation > 0.0
                            && resumed.ledger().plastic_dissipation > 0.0
                    );
                    let found = snapshot_bits(&resumed.snapshot());
                    domain.advance(12).expect("threads");
                    assert!(
                        found == snapshot_bits(&domain.snapshot()),
                        "{splitting:?} {parts:?}: after a snapshot"
                    );
                    let is_same = *expected.get_or_insert(found.clone()) == found;
                    assert!(is_same, "{splitting:?} {plastic_step:?} {parts:?} {instructions:?}");
                }
            }
            let mut start: DecomposedDomain<T, D> =
                DecomposedDomain::new(&problem, 1).expect("sound");
            fill_with_noise(&mut start, 1.0);
            let mut reference: Reference<T, D> = Reference::new(&problem).expect("sound");
            assert!(reference.restore(&start.snapshot()));
            reference.advance(19);
            start.advance(19).expect("threads");
            assert!(expected == Some(snapshot_bits(&reference.snapshot())), "line by line");
            assert_eq!(reference.energy(), start.energy());
        }
    }
}

#[test]
fn results_do_not_depend_on_decomposition_or_instruction_set() {
    compare_bits::<f64, 2>([21, 14], Theory::Cosserat);
    compare_bits::<f32, 2>([37, 14], Theory::Classical);
    compare_bits::<f64, 3>([13, 6, 13], Theory::Reduced);
}

/// Verifies that cells without relaxation have no viscous strain, and that unused relaxing media change nothing.
#[test]
fn unused_relaxing_media_change_nothing() {
    for theory in [Theory::Classical, Theory::Cosserat] {
        let problem = mixed_problem(
            [12, 10],
            theory,
            return_mapping_scheme(Slopes::Limited, Splitting::Alternating),
        );
        let mut domain: DecomposedDomain<f64, 2> =
            DecomposedDomain::new(&problem, 1).expect("sound");
        for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
            if !matches!(field, SolidField::ViscousStrain(..)) {
                let values = (0..120).map(|cell| noise(1000 * index as u64 + cell));
                domain.set_field(field, &values.collect::<Vec<_>>());
            }
        }
        domain.advance(20).expect("threads");
        let history = problem.media[1].history_fields();
        assert_eq!(history.len(), 4);
        for field in history {
            for (cell, value) in domain.values(field).expect("a field").into_iter().enumerate() {
                let relaxes = [1, 2].contains(&problem.cell_media[cell]);
                assert_eq!(value != 0.0, relaxes, "{field:?} in cell {cell}");
            }
        }
        // Media of the list that occur in no cell must not change the results.
        let mut without = problem.clone();
        without.cell_media.iter_mut().for_each(|own| *own = [0, 3, 3, 3][usize::from(*own)]);
        let mut plain = without.clone();
        plain.media[1] = plain.media[0].clone();
        plain.media[2] = plain.media[3].clone();
        let [with, plain] = [without, plain].map(|problem| {
            let mut domain: DecomposedDomain<f64, 2> =
                DecomposedDomain::new(&problem, 1).expect("sound");
            fill_with_noise(&mut domain, 1.0);
            domain.advance(20).expect("threads");
            (snapshot_bits(&domain.snapshot()), domain.fields().len())
        });
        assert!(with.1 == plain.1 + 4 && with.0.0[..plain.1] == plain.0.0[..]);
        assert_eq!(with.0.1[0], plain.0.1[0]);
    }
}

/// Verifies that viscous strains are saved in states, checked for non-finite values, and refused in sources.
#[test]
fn viscous_strains_belong_to_the_state() {
    let problem = mixed_problem(
        [8, 9],
        Theory::Classical,
        return_mapping_scheme(Slopes::Limited, Splitting::TwoCyclic),
    );
    let strain = SolidField::ViscousStrain(0, 1);
    assert_eq!(
        problem.fields()[problem.media[0].fields.len()..],
        problem.media[1].history_fields()
    );
    let mut domain: DecomposedDomain<f64, 2> = DecomposedDomain::new(&problem, 2).expect("sound");
    let mut values = vec![0.0; 72];
    values[40] = f64::NAN;
    domain.set_field(strain, &values);
    assert_eq!(domain.first_non_finite(), Some((strain, 40)));

    let steps = TimeSteps::new(&problem.media, &[0.1; 2], (0.9, 1), 1.0, 1.0).expect("few steps");
    let problem = Problem { step: steps.step, ..problem };
    for choice in [SolverChoice::Fused { threads: 2 }, SolverChoice::Reference] {
        let create_simulation = || {
            let start = (0..72).map(noise).collect::<Vec<_>>();
            let initial = vec![(SolidField::Velocity(0), start.clone()), (strain, start)];
            SolidSimulation::<f64, 2>::new(
                problem.clone(),
                steps,
                initial,
                Vec::new(),
                choice.clone(),
            )
            .expect("sound")
        };
        let mut first = create_simulation();
        assert!(first.advance(0.5 * steps.time(steps.count)).is_ok());
        let state = first.state();
        let mut second = create_simulation();
        assert!(second.restore(&state) && first.steps() == second.steps() && first.steps() > 0);
        assert_eq!(first.account(), second.account());
        while !first.is_finished() {
            assert!(first.advance(1.0).is_ok() && second.advance(1.0).is_ok());
        }
        assert!(first.all_fields() == second.all_fields() && first.account() == second.account());
        assert!(first.account().ledger.viscous_dissipation > 0.0);
        assert_eq!(first.all_fields().values.len(), problem.fields().len());
    }

    let amplitudes = vec![(strain, 1.0)];
    let source = Source { cells: vec![(0, 1.0)], amplitudes, signal: Arc::new(|_: f64| 1.0) };
    let refused = Problem { sources: vec![source], ..problem };
    assert_eq!(refused.validate(), Err(DomainError::Source(0)));
}
