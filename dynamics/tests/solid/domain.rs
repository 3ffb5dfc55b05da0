//! Fields on a grid against exact plane waves of every branch, in the plane and in space; energy and boundaries.

use crate::support::noise;
use models::common::rates::{RateEquations, SymmetricForm};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::solid::waves::Field;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;

const THEORIES: [Theory; 3] = [Theory::Classical, Theory::Reduced, Theory::Cosserat];

/// Returns a solid with unequal constants of order one.
fn solid(theory: Theory) -> Isotropic {
    let couple =
        (theory == Theory::Cosserat).then_some(CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 });
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let microrotation = (theory != Theory::Classical).then_some(rotation);
    Isotropic::new(1.4, 0.9, 1.2, microrotation).expect("sound moduli")
}

/// Returns the rate equations of a solid with all stresses of the domain as unknowns.
fn equations<const D: usize>(solid: &Isotropic) -> RateEquations<D> {
    let layout = solid.layout::<D>().carrying();
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    layout.rates(&solid.stiffness(layout.all_stresses()), solid.density, inertia)
}

fn name(field: Field) -> String {
    match field {
        Field::Velocity(i) => format!("v{}", i + 1),
        Field::Spin(k) => format!("ω{}", k + 1),
        Field::Stress(i, j) => format!("σ{}{}", i + 1, j + 1),
        Field::Couple(k, j) => format!("m{}{}", k + 1, j + 1),
        Field::ViscousStrain(i, j) => format!("e{}{}", i + 1, j + 1),
    }
}

/// Computes frequencies (rad/s, positive, ascending) and amplitudes of the plane waves with the wave vector κ:
/// U = Re û exp(i(κ·x − ωt)), from i L⁻¹(iκB + Q)L⁻ᵀ y = ω y with A = LLᵀ.
fn modes<const D: usize>(
    form: &SymmetricForm<D>,
    wave: [f64; D],
) -> Vec<(f64, DVector<Complex64>)> {
    let lower = form.a.clone().cholesky().expect("positive definite").l();
    let inverse = lower.clone().try_inverse().expect("regular");
    let half = |m: &DMatrix<f64>| &inverse * m * inverse.transpose();
    let mut symbol = half(&form.q).map(|x| Complex64::new(0.0, x));
    for (b, k) in form.b.iter().zip(wave) {
        symbol += half(b).map(|x| Complex64::new(-k * x, 0.0));
    }
    let symbol = (&symbol + symbol.adjoint()).scale(0.5);
    let eigen = symbol.symmetric_eigen();
    let back = inverse.transpose().map(Complex64::from);
    let mut modes: Vec<(f64, DVector<Complex64>)> = (0..eigen.eigenvalues.len())
        .filter(|&i| eigen.eigenvalues[i] > 1e-6)
        .map(|i| (eigen.eigenvalues[i], &back * eigen.eigenvectors.column(i)))
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Shear waves in space have double eigenvalues, whose eigenvectors are arbitrary: choose two linear polarisations
    // normal to the wave vector in which all fields are non-zero.
    for i in 1..modes.len() {
        if modes[i].0 - modes[i - 1].0 < 1e-9 * modes[i].0 {
            let pair = [modes[i - 1].1.clone(), modes[i].1.clone()];
            let across = [[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]];
            let part = |mode: usize, axis: usize| -> Complex64 {
                (0..3).map(|j| pair[mode][j] * across[axis][j]).sum::<Complex64>()
                    / across[axis].iter().map(|x| x * x).sum::<f64>().sqrt()
            };
            let [[a, b], [c, d]] = [0, 1].map(|axis| [0, 1].map(|mode| part(mode, axis)));
            for (place, turn) in [(i - 1, 0.3), (i, 0.3 + 0.5 * PI)] {
                let [p, q] = [turn.cos(), turn.sin()];
                let shares = [d * p - b * q, a * q - c * p];
                let size = shares[0].norm().hypot(shares[1].norm());
                modes[place].1 = (&pair[0] * shares[0] + &pair[1] * shares[1]).unscale(size);
            }
        }
    }
    modes
}

/// Computes the errors of a plane wave of unit energy density, means over the cells, maxima over several times: of each
/// component, and of velocity, spin, stress and couple stress as vectors or tensors.
fn errors<const D: usize>(theory: Theory, count: usize, branch: usize, slopes: Slopes) -> Errors {
    let solid = solid(theory);
    let equations = equations::<D>(&solid);
    let form = equations.symmetric().expect("elastic");
    let wave = wave_vector::<D>();
    let (frequency, amplitude) = modes(&form, wave).swap_remove(branch);
    let medium = Medium::new(solid, D);
    let h = 1.0 / count as f64;
    // End time in wave periods, not an integer; the Courant number is no integer for any family of waves.
    const LAST: f64 = 2.87;
    let time = LAST * 2.0 * PI / frequency;
    // Steps in proportion to the cells, so that the Courant number is the same on all grids.
    let steps = (16.0 * time * medium.greatest_speed() / (2.0 * 0.93)).ceil() / 16.0 / h;
    let steps = steps.round();
    let grid = Grid { cells: [count; D], spacing: [h; D] };
    let mut domain: Domain<f64, D> = Domain::new(&Problem::new(
        grid,
        vec![medium],
        vec![0; count.pow(D as u32)],
        std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
        time / steps,
        Scheme::new(slopes, PlasticStep::MidpointReflection),
    ))
    .expect("a sound domain");
    // Cell means: the value at the cell centre times a factor for each axis.
    let factor: f64 = wave.iter().map(|k| (0.5 * k * h).sin() / (0.5 * k * h)).product();
    let phase = |cell: usize| -> f64 {
        let mut rest = cell;
        wave.iter()
            .map(|k| {
                let at = rest % count;
                rest /= count;
                k * h * (at as f64 + 0.5)
            })
            .sum()
    };
    let fields = domain.fields().to_vec();
    // Index among the unknowns of the rate equations.
    let place = |field: &Field| {
        let name = name(*field);
        let place = equations.unknowns.iter().position(|unknown| unknown.name == name);
        place.expect("an unknown")
    };
    let places: Vec<usize> = fields.iter().map(place).collect();
    let exact = |place: usize, cell: usize, time: f64| {
        factor * (amplitude[place] * Complex64::cis(phase(cell) - frequency * time)).re
    };
    let cells = count.pow(D as u32);
    for (&field, &place) in fields.iter().zip(&places) {
        domain.set(field, &(0..cells).map(|cell| exact(place, cell, 0.0)).collect::<Vec<_>>());
    }
    let kind = |field: &Field| match field {
        Field::Velocity(_) => 0,
        Field::Spin(_) => 1,
        Field::Stress(..) | Field::ViscousStrain(..) => 2,
        Field::Couple(..) => 3,
    };
    // At several times, since at a single one errors of different kinds may cancel.
    let mut greatest = vec![0.0f64; fields.len()];
    let mut greatest_of_kind = [0.0f64; 4];
    let mut done = 0;
    for instant in [1.37, 1.87, 2.37, LAST] {
        let until = (steps * instant / LAST).round() as usize;
        for _ in done..until {
            domain.advance();
        }
        done = until;
        let time = time / steps * until as f64;
        let mut squares = vec![[0.0f64; 4]; cells];
        for ((field, &place), greatest) in fields.iter().zip(&places).zip(&mut greatest) {
            // In energy units; the wave has unit energy density, and some fields vanish in it.
            let weight = form.a[(place, place)].sqrt();
            let values = domain.values(*field).expect("a field");
            let mut sum = 0.0;
            for ((cell, value), squares) in values.iter().enumerate().zip(&mut squares) {
                let error = weight * (value - exact(place, cell, time)).abs();
                sum += error;
                squares[kind(field)] += error * error;
            }
            *greatest = greatest.max(sum / cells as f64);
        }
        for (kind, greatest) in greatest_of_kind.iter_mut().enumerate() {
            let sum: f64 = squares.iter().map(|squares| squares[kind].sqrt()).sum();
            *greatest = greatest.max(sum / cells as f64);
        }
    }
    Errors {
        components: fields.iter().map(|field| name(*field)).zip(greatest).collect(),
        fields: KINDS.into_iter().zip(greatest_of_kind).collect(),
    }
}

const KINDS: [&str; 4] = ["velocity", "spin", "stress", "couple stress"];

/// Errors of components and of fields, by name.
struct Errors {
    components: Vec<(String, f64)>,
    fields: Vec<(&'static str, f64)>,
}

impl Errors {
    /// Returns the largest error of all components.
    fn greatest(&self) -> f64 {
        self.components.iter().map(|own| own.1).fold(0.0, f64::max)
    }
}

/// Returns the wave vector: 2π (1, 2) in the plane, 2π (1, 1, 1) in space.
fn wave_vector<const D: usize>() -> [f64; D] {
    std::array::from_fn(|axis| if D == 2 && axis == 1 { 4.0 * PI } else { 2.0 * PI })
}

fn branches<const D: usize>(theory: Theory) -> usize {
    let form = equations::<D>(&solid(theory)).symmetric().expect("elastic");
    let wave = wave_vector::<D>();
    modes(&form, wave).len()
}

/// Verifies the order of convergence between the two finest grids for every branch: at least `least[0]` for the largest
/// component error, at least `least[1]` for each field whose error exceeds a tenth of the largest one. Orders of single
/// components are only printed: where errors of different origin cancel, they are not asymptotic.
fn orders<const D: usize>(counts: &[usize], slopes: Slopes, least: [f64; 2]) {
    let [.., last, most] = counts else { panic!("two grids") };
    let order_of =
        |[before, after]: [f64; 2]| (before / after).ln() / (*most as f64 / *last as f64).ln();
    let mut low = Vec::new();
    for theory in THEORIES {
        for branch in 0..branches::<D>(theory) {
            let errors: Vec<Errors> =
                counts.iter().map(|&n| errors::<D>(theory, n, branch, slopes)).collect();
            let [.., coarse, fine] = errors.as_slice() else { panic!("two grids") };
            let greatest = fine.greatest();
            let all: Vec<f64> = errors.iter().map(Errors::greatest).collect();
            let order = order_of([coarse.greatest(), greatest]);
            println!(
                "{D}D {theory:?} branch {branch} {slopes:?}: errors {all:?}, order {order:.3}"
            );
            if order <= least[0] {
                low.push(format!("{theory:?} branch {branch}: order {order}"));
            }
            for ((field, before), (_, after)) in coarse.fields.iter().zip(&fine.fields) {
                let own = order_of([*before, *after]);
                if *after > 1e-6 * greatest {
                    println!("  {field} {after:.2e} order {own:.3}");
                }
                // Fields with small errors are perturbed by the errors of the others.
                if *after > 0.1 * greatest && own <= least[1] {
                    low.push(format!("{theory:?} branch {branch} {field}: order {own}"));
                }
            }
            for ((name, before), (_, after)) in coarse.components.iter().zip(&fine.components) {
                if *after > 1e-6 * greatest {
                    println!("    {name} {after:.2e} order {:.3}", order_of([*before, *after]));
                }
            }
        }
    }
    assert!(low.is_empty(), "{D}D {slopes:?}: {low:#?}");
}

#[test]
fn plane_waves_in_the_plane_without_limiter() {
    orders::<2>(&[64, 128], Slopes::FourthOrder, [1.9, 1.8]);
}

#[test]
fn plane_waves_in_the_plane() {
    // On 64 cells the limiter still clips a considerable part of each crest.
    orders::<2>(&[128, 256], Slopes::Limited, [1.85, 1.85]);
}

#[test]
fn plane_waves_in_space() {
    orders::<3>(&[16, 32], Slopes::FourthOrder, [1.8, 1.8]);
}

/// Fills all fields with noise.
fn fill(fields: &[Field], cells: usize, mut set: impl FnMut(Field, &[f64])) {
    for (index, &field) in fields.iter().enumerate() {
        let value = |cell: usize| noise((1000 * index + cell) as u64);
        set(field, &(0..cells).map(value).collect::<Vec<_>>());
    }
}

/// Computes the kinetic and stored energy of a domain, J, from the symmetric form of the medium of each cell.
fn energy<const D: usize>(
    (fields, values): (&[Field], &dyn Fn(Field) -> Option<Vec<f64>>),
    forms: &[(RateEquations<D>, SymmetricForm<D>)],
    of_cell: &[u16],
    volume: f64,
) -> f64 {
    let unknowns = forms[0].0.unknowns;
    let places: Vec<usize> = fields
        .iter()
        .map(|f| unknowns.iter().position(|u| u.name == name(*f)).expect("an unknown"))
        .collect();
    let values: Vec<Vec<f64>> = fields.iter().map(|f| values(*f).expect("a field")).collect();
    (0..of_cell.len())
        .map(|cell| {
            let mut state = DVector::zeros(unknowns.len());
            for (place, values) in places.iter().zip(&values) {
                state[*place] = values[cell];
            }
            let form = &forms[usize::from(of_cell[cell])].1;
            0.5 * volume * (state.transpose() * &form.a * &state)[(0, 0)]
        })
        .sum()
}

/// Verifies with noise in a domain of two media, for each kind of boundary: the ledger closes, the energy never grows,
/// and fixed and free boundaries do no work.
#[test]
fn the_account_closes_and_energy_does_not_grow() {
    for theory in THEORIES {
        for boundary in
            [Boundary::Periodic, Boundary::Fixed, Boundary::Free, Boundary::NonReflecting]
        {
            let soft = solid(theory);
            let stiff = Isotropic {
                lambda: 3.0 * soft.lambda,
                mu: 2.0 * soft.mu,
                density: 1.7 * soft.density,
                ..soft
            };
            let cells = [14, 11];
            let spacing = [0.1, 0.13];
            let of_cell: Vec<u16> = (0..14 * 11).map(|i| u16::from(noise(i) > 0.3)).collect();
            let media = [soft, stiff].map(|s| Medium::new(s, 2));
            let speed = media.iter().map(Medium::greatest_speed).fold(0.0, f64::max);
            let forms = [soft, stiff].map(|s| {
                let equations = equations::<2>(&s);
                let form = equations.symmetric().expect("elastic");
                (equations, form)
            });
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let mut solver: Reference<f64, 2> = Reference::new(&Problem::new(
                Grid { cells, spacing },
                media.to_vec(),
                of_cell.clone(),
                std::array::from_fn(|_| [boundary.clone(), boundary.clone()]),
                2.0 * 0.1 / speed,
                scheme,
            ))
            .expect("a sound domain");
            fill(&media[0].fields, of_cell.len(), |field, own| solver.set(field, own));
            let volume = spacing[0] * spacing[1];
            let energy_of = |solver: &Reference<f64, 2>| {
                energy((solver.fields(), &|own| solver.values(own)), &forms, &of_cell, volume)
            };
            let start = energy_of(&solver);
            let mut last = start;
            for _ in 0..300 {
                solver.advance(1);
                let now = energy_of(&solver);
                assert!(now <= last * (1.0 + 1e-13), "{theory:?} {boundary:?}: {now} after {last}");
                last = now;
            }
            let account = solver.ledger();
            let residual = last - start - account.change();
            assert!((residual / start).abs() < 1e-12, "{theory:?} {boundary:?} {residual:e}");
            match boundary {
                Boundary::Fixed | Boundary::Free => {
                    assert!(account.inflow.abs() < 1e-13 * start, "{:e}", account.inflow);
                }
                Boundary::NonReflecting => assert!(account.inflow < -0.1 * start),
                _ => {}
            }
            assert!(account.numerical > 0.1 * start);
        }
    }
}

#[test]
fn domains_that_cannot_be_are_refused() {
    let medium = Medium::new(solid(Theory::Classical), 2);
    let grid = Grid { cells: [4, 4], spacing: [0.1, 0.1] };
    let make = |media: Vec<Medium>, of_cell: Vec<u16>, step: f64, sides: [[Boundary; 2]; 2]| {
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
        let problem = Problem::new(grid, media, of_cell, sides, step, scheme);
        Domain::<f64, 2>::new(&problem).map(|_| ())
    };
    let free = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    assert_eq!(make(vec![medium.clone()], vec![0; 16], 1e-3, free.clone()), Ok(()));
    assert_eq!(
        make(vec![medium.clone()], vec![0; 15], 1e-3, free.clone()),
        Err(DomainError::Cells { found: 15, needed: 16 })
    );
    assert_eq!(make(Vec::new(), vec![0; 16], 1e-3, free.clone()), Err(DomainError::Media));
    let other = Medium::new(solid(Theory::Cosserat), 2);
    assert_eq!(
        make(vec![medium.clone(), other], vec![0; 16], 1e-3, free.clone()),
        Err(DomainError::Media)
    );
    // A plane medium on a grid in space.
    let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
    let space = Grid { cells: [2; 3], spacing: [0.1; 3] };
    let problem = Problem::new(space, vec![medium.clone()], vec![0; 8], sides, 1e-3, scheme);
    assert_eq!(Domain::<f64, 3>::new(&problem).map(|_| ()), Err(DomainError::Media));
    assert!(matches!(
        make(vec![medium.clone()], vec![1; 16], 1e-3, free.clone()),
        Err(DomainError::NoSuchMedium { cell: 0, medium: 1, count: 1 })
    ));
    assert!(matches!(
        make(vec![medium.clone()], vec![0; 16], 1.0, free.clone()),
        Err(DomainError::Courant { axis: 0, .. })
    ));
    let half = [[Boundary::Periodic, Boundary::Free], [Boundary::Free, Boundary::Free]];
    let made = make(vec![medium.clone()], vec![0; 16], 1e-3, half);
    assert_eq!(made, Err(DomainError::Periodic(0)));
    let short = Boundary::Given(vec![Condition::Traction(0.0)]);
    let sides = [[Boundary::Free, Boundary::Free], [short, Boundary::Free]];
    assert_eq!(
        make(vec![medium], vec![0; 16], 1e-3, sides),
        Err(DomainError::Conditions { axis: 1, found: 1, needed: 2 })
    );
}

/// Verifies the orders of every branch on grids fine enough for the asymptotic orders of the scheme.
#[test]
#[ignore = "two minutes: cargo test --release -p wellposed-dynamics --test solid domain::fine -- --ignored --nocapture"]
fn fine_grids_in_the_plane() {
    orders::<2>(&[64, 128, 256, 512], Slopes::Limited, [1.9; 2]);
    orders::<2>(&[64, 128, 256, 512], Slopes::FourthOrder, [1.9; 2]);
}

/// Verifies the orders in space; a period is 74 cells of the finest grid.
#[test]
#[ignore = "half an hour"]
fn fine_grids_in_space() {
    orders::<3>(&[16, 32, 64, 128], Slopes::Limited, [1.9; 2]);
}

#[test]
#[ignore = "half an hour"]
fn fine_grids_in_space_without_limiter() {
    orders::<3>(&[16, 32, 64, 128], Slopes::FourthOrder, [1.9; 2]);
}

/// Verifies that half of a mirror-symmetric or antisymmetric domain has the bits of the whole domain.
#[test]
fn mirrored_halves_are_halves() {
    for theory in THEORIES {
        for is_even in [true, false] {
            let solid = solid(theory);
            let medium = Medium::new(solid, 2);
            let step = 1.9 * 0.1 / medium.greatest_speed();
            let side = match is_even {
                true => Boundary::symmetry(&medium, 0),
                false => Boundary::antisymmetry(&medium, 0),
            };
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let make = |length: usize, first: Boundary| -> Domain<f64, 2> {
                let grid = Grid { cells: [length, 6], spacing: [0.1, 0.1] };
                let sides = [[first, Boundary::Free], [Boundary::Fixed, Boundary::Free]];
                let media = vec![medium.clone()];
                let of_cell = vec![0; 6 * length];
                let problem = Problem::new(grid, media, of_cell, sides, step, scheme);
                Domain::new(&problem).expect("sound")
            };
            let (mut half, mut whole) = (make(8, side), make(16, Boundary::Free));
            for (index, field) in half.fields().to_vec().into_iter().enumerate() {
                // Parity under x₁ → −x₁ of vectors, axial vectors and their stresses.
                let ones = |indices: &[usize]| indices.iter().filter(|&&i| i == 0).count() % 2;
                let is_odd = match field {
                    Field::Velocity(i) => ones(&[i]) == 1,
                    Field::Spin(k) => ones(&[k]) == 0,
                    Field::Stress(i, j) | Field::ViscousStrain(i, j) => ones(&[i, j]) == 1,
                    Field::Couple(k, j) => ones(&[k, j]) == 0,
                };
                let sign = if is_odd == is_even { -1.0 } else { 1.0 };
                let mut values = [vec![0.0; 48], vec![0.0; 96]];
                for row in 0..6 {
                    for column in 0..8 {
                        let value = noise((100 * index + 10 * row + column) as u64);
                        values[0][8 * row + column] = value;
                        values[1][16 * row + 8 + column] = value;
                        values[1][16 * row + 7 - column] = sign * value;
                    }
                }
                half.set(field, &values[0]);
                whole.set(field, &values[1]);
            }
            for _ in 0..25 {
                half.advance();
                whole.advance();
            }
            for &field in half.fields() {
                let (half, whole) = (half.values(field), whole.values(field));
                let (half, whole) = (half.expect("a field"), whole.expect("a field"));
                for row in 0..6 {
                    for column in 0..8 {
                        let (a, b) = (half[8 * row + column], whole[16 * row + 8 + column]);
                        assert!(a == b, "{theory:?} {is_even} {field:?}: {a:e} {b:e}");
                    }
                }
            }
        }
    }
}

/// Verifies a bar pushed with the velocity V against σ = −zV behind the front, which moves by whole cells at Courant
/// number 1; the boundary work equals the energy of the bar.
#[test]
fn a_pushed_bar() {
    let solid = solid(Theory::Classical);
    let medium = Medium::new(solid, 2);
    let pair = &medium.pairs[0][0];
    let (z, c) = (pair.impedance(), pair.speed());
    for (condition, velocity, stress) in
        [(Condition::Velocity(0.3), 0.3, -0.3 * z), (Condition::Traction(-0.7), 0.7 / z, -0.7)]
    {
        let push = Boundary::Given(vec![condition, Condition::Traction(0.0)]);
        let sides = [[push, Boundary::Fixed], [Boundary::Periodic, Boundary::Periodic]];
        let grid = Grid { cells: [40, 1], spacing: [0.1, 0.1] };
        let (scheme, step) =
            (Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection), 2.0 * 0.1 / c);
        let problem = Problem::new(grid, vec![medium.clone()], vec![0; 40], sides, step, scheme);
        let mut domain: Reference<f64, 2> = Reference::new(&problem).expect("sound");
        domain.advance(15);
        let ledger = domain.ledger();
        let v = domain.values(Field::Velocity(0)).expect("a field");
        let s = domain.values(Field::Stress(0, 0)).expect("a field");
        for i in 0..40 {
            // A step consists of two sweeps.
            let [vi, si] = if i < 30 { [velocity, stress] } else { [0.0, 0.0] };
            assert!(
                (v[i] - vi).abs() < 1e-14 && (s[i] - si).abs() < 1e-14,
                "{i} {} {}",
                v[i],
                s[i]
            );
        }
        // ½ρv² + ½s²/M in thirty cells; sweeps along x₂ have no gradients.
        let expected = 30.0 * 0.01 * (velocity * velocity * z / c);
        assert!((ledger.inflow / expected - 1.0).abs() < 1e-13, "{} {expected}", ledger.inflow);
        assert!(ledger.numerical.abs() < 1e-13 * expected);
    }
}

/// Verifies the frequency of a uniform spin over a thousand periods, for the medium of the unit test
/// `HomogeneousIsotropicCosseratDomain` of SPECFEM++: 194.2009 Hz (as quoted; unconfirmed).
#[test]
fn uniform_rotation_has_the_natural_frequency() {
    let couple = Some(CoupleModuli { beta: 7.75e8, gamma: 1.5e8, eta: 3e8 });
    let rotation = Microrotation { alpha: 1.005e9, inertia: 2700.0, couple };
    let solid = Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(rotation)).expect("sound moduli");
    let medium = Medium::new(solid, 2);
    let spacing = 0.5;
    let step = 2.0 * spacing / medium.greatest_speed();
    let sides = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
    let grid = Grid { cells: [4, 4], spacing: [spacing; 2] };
    let mut domain: Domain<f64, 2> =
        Domain::new(&Problem::new(grid, vec![medium], vec![0; 16], sides, step, scheme))
            .expect("sound");
    domain.set(Field::Spin(2), &[1.0; 16]);
    let steps = (1000.0 / 194.2009 / step).round() as usize;
    // Each change of sign from + to − ends a period; its time within the step is interpolated with arccos.
    let (mut ends, mut last) = (Vec::new(), 1.0);
    for index in 1..=steps {
        domain.advance();
        let now = domain.values(Field::Spin(2)).expect("spins")[5];
        if last > 0.0 && now <= 0.0 {
            let angle = |value: f64| value.clamp(-1.0, 1.0).acos();
            let before = 0.5 * PI - angle(last);
            let share = before / (angle(now) - angle(last));
            ends.push((index as f64 - 1.0 + share) * step);
        }
        last = now;
    }
    let periods = (ends.len() - 1) as f64;
    let frequency = periods / (ends[ends.len() - 1] - ends[0]);
    assert!(periods > 900.0);
    assert!((frequency / 194.2009 - 1.0).abs() < 1e-6, "{frequency}");
}

/// Verifies that energy does not grow over many steps from noise, with Courant number 1 in each sweep.
#[test]
fn many_steps_are_stable() {
    for theory in THEORIES {
        for sides in [Boundary::Periodic, Boundary::Fixed, Boundary::Free] {
            let medium = Medium::new(solid(theory), 2);
            let step = 2.0 * 0.1 / medium.greatest_speed();
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let grid = Grid { cells: [7, 6], spacing: [0.1, 0.1] };
            let all = std::array::from_fn(|_| [sides.clone(), sides.clone()]);
            let problem = Problem::new(grid, vec![medium], vec![0; 42], all, step, scheme);
            let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
            fill(&problem.fields(), 42, |field, own| domain.set(field, own));
            let equations = equations::<2>(&solid(theory));
            let forms = [(equations.clone(), equations.symmetric().expect("elastic"))];
            let energy_of = |domain: &Domain<f64, 2>| {
                energy((domain.fields(), &|own| domain.values(own)), &forms, &[0; 42], 0.01)
            };
            let mut last = energy_of(&domain);
            for _ in 0..20 {
                for _ in 0..1000 {
                    domain.advance();
                }
                let now = energy_of(&domain);
                assert!(now <= last * (1.0 + 1e-12), "{theory:?} {sides:?}: {now} after {last}");
                last = now;
            }
        }
    }
}
