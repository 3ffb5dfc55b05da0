//! Elastic solids against the equations as published, typed out by hand, and against what energy and
//! rotations demand of them.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod support;

use nalgebra::{Complex, DMatrix, DVector, Matrix3, SymmetricEigen};
use support::Random;
use wellposed_models::LinearisedSystem;
use wellposed_models::common::rates::{RateEquations, SymmetricForm};
use wellposed_models::solid::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances,
};
use wellposed_models::solid::stress::Component::{self, Couple, Force, Symmetric};
use wellposed_models::solid::stress::Stress;
use wellposed_models::solid::symbol::{Velocity, plane, space};

fn decades(random: &mut Random, from: f64, to: f64) -> f64 {
    10f64.powf(random.within(from, to))
}

fn couple_moduli(random: &mut Random) -> CoupleModuli {
    let gamma = random.within(0.2, 2.0);
    let beta = gamma * (random.within(0.1, 2.0) - 2.0 / 3.0);
    CoupleModuli { beta, gamma, eta: random.within(0.2, 2.0) }
}

/// Classical, reduced or Cosserat, with moduli of order one, none equal.
fn solid(random: &mut Random, theory: usize) -> Isotropic {
    let mu = random.within(0.5, 2.0);
    let lambda = mu * (random.within(0.1, 3.0) - 2.0 / 3.0);
    let microrotation = Microrotation {
        alpha: random.within(0.1, 2.0),
        inertia: random.within(0.2, 2.0),
        couple: (theory == 2).then(|| couple_moduli(random)),
    };
    let density = random.within(0.5, 2.0);
    Isotropic::new(lambda, mu, density, (theory > 0).then_some(microrotation)).unwrap()
}

fn tensor(random: &mut Random) -> Matrix3<f64> {
    Matrix3::from_fn(|_, _| random.within(-1.0, 1.0))
}

fn rows(t: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| t[(i, j)]))
}

fn of(component: Component, force: &Matrix3<f64>, couple: &Matrix3<f64>) -> f64 {
    component.of(&Stress { force: rows(force), couple: rows(couple) })
}

/// What works on a component: for the symmetric ones off the diagonal twice the tensor's.
fn conjugate(component: Component, strain: &Matrix3<f64>, bend: &Matrix3<f64>) -> f64 {
    match component {
        Force(i, j) => strain[(i, j)],
        Symmetric(i, j) if i == j => strain[(i, i)],
        Symmetric(i, j) => strain[(i, j)] + strain[(j, i)],
        Couple(k, j) => bend[(k, j)],
    }
}

/// λ tr(Λ) δ + 2μ Λˢ + 2α Λᵃ.
fn hooke([trace, symmetric, antisymmetric]: [f64; 3], t: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (trace * t.trace())
        + (t + t.transpose()) * symmetric
        + (t - t.transpose()) * antisymmetric
}

/// ½λ (tr Λ)² + μ|Λˢ|² + α|Λᵃ|².
fn density([trace, symmetric, antisymmetric]: [f64; 3], t: &Matrix3<f64>) -> f64 {
    let (s, a) = ((t + t.transpose()) * 0.5, (t - t.transpose()) * 0.5);
    0.5 * trace * t.trace().powi(2)
        + symmetric * s.norm_squared()
        + antisymmetric * a.norm_squared()
}

fn force_moduli(solid: &Isotropic) -> [f64; 3] {
    [solid.lambda, solid.mu, solid.microrotation.map_or(0.0, |m| m.alpha)]
}

fn bending_moduli(solid: &Isotropic) -> [f64; 3] {
    solid.couple().map_or([0.0; 3], |c| [c.beta, c.gamma, c.eta])
}

/// Compliances of no isotropic solid.
fn cubic(random: &mut Random) -> PlaneCompliances {
    let (a1, a2) = (random.within(0.5, 2.0), random.within(0.5, 2.0));
    PlaneCompliances {
        a1,
        b1: a1 * random.within(-0.8, 0.8),
        a2,
        b2: a2 * random.within(-0.8, 0.8),
        alpha2: random.within(0.5, 2.0),
        density: random.within(0.5, 2.0),
        inertia: random.within(0.5, 2.0),
    }
    .check()
    .unwrap()
}

/// Sadovskii & Sadovskaya (2019, "Plane strain state") in the order (v₁, v₂, ω₃, σ₁₁, σ₂₂, σ₂₁, σ₁₂,
/// μ₃₁, μ₃₂): the left sides of
/// ρ₀v̇₁ = σ₁₁,₁ + σ₁₂,₂; ρ₀v̇₂ = σ₂₁,₁ + σ₂₂,₂; J₀ω̇₃ = μ₃₁,₁ + μ₃₂,₂ + σ₂₁ − σ₁₂; the laws.
fn typed(c: &PlaneCompliances) -> SymmetricForm<2> {
    let PlaneCompliances { a1, b1, a2, b2, alpha2, density: r, inertia: i } = *c;
    let k = 1.0 / alpha2;
    #[rustfmt::skip]
    let a = DMatrix::from_row_slice(9, 9, &[
        r,   0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, r,   0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, i,   0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, a1,  -b1, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, -b1, a1,  0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, a2,  -b2, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, -b2, a2,  0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, k,   0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, k,
    ]);
    #[rustfmt::skip]
    let b1 = DMatrix::from_row_slice(9, 9, &[
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0,
        1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]);
    #[rustfmt::skip]
    let b2 = DMatrix::from_row_slice(9, 9, &[
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]);
    let mut q = DMatrix::zeros(9, 9);
    (q[(2, 5)], q[(2, 6)], q[(5, 2)], q[(6, 2)]) = (1.0, -1.0, -1.0, 1.0);
    SymmetricForm { a, b: [b1, b2], q }
}

fn assert_close(own: &DMatrix<f64>, typed: &DMatrix<f64>, tolerance: f64, what: &str) {
    assert_eq!(own.shape(), typed.shape(), "{what}");
    let error = (own - typed).amax();
    assert!(error <= tolerance * typed.amax().max(1.0), "{what}: {error:e}\n{own}\n{typed}");
}

/// The tolerance leaves room for the inverse of an inverse: condition numbers up to 10.
const INVERSE: f64 = 1e-14;

#[test]
fn plane_equations_are_the_published_ones() {
    let mut random = Random::new(1);
    for number in 0..200 {
        let (compliances, rates) = if number % 2 == 0 {
            let c = cubic(&mut random);
            (c, c.rates())
        } else {
            let solid = solid(&mut random, 2);
            (PlaneCompliances::of(&solid).unwrap(), solid.rates::<2>())
        };
        let expected = typed(&compliances);
        let own = rates.symmetric().unwrap();
        assert_close(&own.a, &expected.a, 10.0 * INVERSE, "A");
        assert_eq!((&own.b, &own.q), (&expected.b, &expected.q));

        // Solved for the rates of the stresses: A of momenta, spin and ones; the rows of the laws are
        // −A⁻¹B and −A⁻¹Q.
        let mut linear = LinearisedSystem::default();
        rates.linearise(&mut linear);
        let value = |m: &wellposed_models::common::system::Matrix| m.map(|entry| entry.value);
        let mut a = DMatrix::identity(9, 9);
        (a[(0, 0)], a[(1, 1)]) = (compliances.density, compliances.density);
        a[(2, 2)] = compliances.inertia;
        assert_eq!(value(&linear.a), a);
        let solve = &a * expected.a.clone().try_inverse().unwrap();
        for axis in 0..2 {
            let expected = -&solve * &expected.b[axis];
            assert_close(&value(&linear.b[axis]), &expected, 10.0 * INVERSE, "B");
        }
        assert_close(&value(&linear.c), &(-&solve * &expected.q), 10.0 * INVERSE, "C");
        assert_eq!(linear.velocity, [0.0; 2]);
    }
}

/// The same with the moduli: σ̇₁₁ = (λ + 2μ)v₁,₁ + λv₂,₂, σ̇₂₁ = (μ + α)(v₂,₁ − ω₃) + (μ − α)(v₁,₂ + ω₃)…
#[test]
fn plane_equations_with_moduli() {
    let mut random = Random::new(2);
    let solid = solid(&mut random, 2);
    let (l, m) = (solid.lambda, solid.mu);
    let Microrotation { alpha, inertia, couple } = solid.microrotation.unwrap();
    let bending = couple.unwrap().gamma + couple.unwrap().eta;
    let mut linear = LinearisedSystem::default();
    solid.rates::<2>().linearise(&mut linear);
    let mut b = [DMatrix::zeros(9, 9), DMatrix::zeros(9, 9)];
    (b[0][(0, 3)], b[1][(0, 6)]) = (-1.0, -1.0);
    (b[0][(1, 5)], b[1][(1, 4)]) = (-1.0, -1.0);
    (b[0][(2, 7)], b[1][(2, 8)]) = (-1.0, -1.0);
    (b[0][(3, 0)], b[1][(3, 1)]) = (-(l + 2.0 * m), -l);
    (b[0][(4, 0)], b[1][(4, 1)]) = (-l, -(l + 2.0 * m));
    (b[0][(5, 1)], b[1][(5, 0)]) = (-(m + alpha), -(m - alpha));
    (b[0][(6, 1)], b[1][(6, 0)]) = (-(m - alpha), -(m + alpha));
    (b[0][(7, 2)], b[1][(8, 2)]) = (-bending, -bending);
    let mut c = DMatrix::zeros(9, 9);
    (c[(2, 5)], c[(2, 6)]) = (-1.0, 1.0);
    (c[(5, 2)], c[(6, 2)]) = (2.0 * alpha, -2.0 * alpha);
    for axis in 0..2 {
        assert_close(&linear.b[axis].map(|x| x.value), &b[axis], 1e-15, "B");
        // Structural zeros stay exact, and every other entry has a bound.
        for (own, typed) in linear.b[axis].iter().zip(b[axis].iter()) {
            assert_eq!(own.is_structural_zero(), *typed == 0.0);
        }
    }
    assert_close(&linear.c.map(|x| x.value), &c, 1e-15, "C");
    assert_eq!(linear.a[(2, 2)].value, inertia);

    // Reduced: the first seven; classical: without the spin, one shear stress.
    let reduced =
        Isotropic { microrotation: Some(Microrotation { alpha, inertia, couple: None }), ..solid };
    reduced.rates::<2>().linearise(&mut linear);
    for axis in 0..2 {
        let block = b[axis].view((0, 0), (7, 7)).into_owned();
        assert_close(&linear.b[axis].map(|x| x.value), &block, 1e-15, "B of the reduced solid");
    }
    let block = c.view((0, 0), (7, 7)).into_owned();
    assert_close(&linear.c.map(|x| x.value), &block, 1e-15, "C of the reduced solid");
    Isotropic { microrotation: None, ..solid }.rates::<2>().linearise(&mut linear);
    #[rustfmt::skip]
    let b = [
        DMatrix::from_row_slice(5, 5, &[
            0.0, 0.0, -1.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 0.0, -1.0,
            -(l + 2.0 * m), 0.0, 0.0, 0.0, 0.0,
            -l, 0.0, 0.0, 0.0, 0.0,
            0.0, -m, 0.0, 0.0, 0.0,
        ]),
        DMatrix::from_row_slice(5, 5, &[
            0.0, 0.0, 0.0, 0.0, -1.0,
            0.0, 0.0, 0.0, -1.0, 0.0,
            0.0, -l, 0.0, 0.0, 0.0,
            0.0, -(l + 2.0 * m), 0.0, 0.0, 0.0,
            -m, 0.0, 0.0, 0.0, 0.0,
        ]),
    ];
    for axis in 0..2 {
        assert_close(&linear.b[axis].map(|x| x.value), &b[axis], 1e-15, "B of the classical solid");
    }
    assert_eq!(linear.c.map(|x| x.value), DMatrix::zeros(5, 5));
}

fn check_structure<const D: usize>(rates: &RateEquations<D>) {
    let form = rates.symmetric().expect("positive definite");
    assert_eq!(rates.unknowns.len(), form.a.nrows());
    assert_eq!(rates.equations.len(), form.a.nrows());
    assert!((&form.a - form.a.transpose()).amax() <= 1e-15 * form.a.amax());
    assert!(form.a.clone().cholesky().is_some(), "A is not positive definite");
    for b in &form.b {
        assert_eq!(b, &b.transpose());
        assert!(b.amax() == 1.0);
    }
    assert_eq!(form.q, -form.q.transpose());
}

/// U = (v, ω, D e): ½UᵀAU is the energy density, and D e is Hooke's law in tensors.
fn check_energy<const D: usize>(random: &mut Random, solid: &Isotropic) {
    let layout = solid.layout::<D>();
    let rates = solid.rates::<D>();
    check_structure(&rates);
    let (mut strain, mut bend) = (tensor(random), tensor(random));
    if solid.microrotation.is_none() {
        strain = (strain + strain.transpose()) * 0.5;
    }
    if D == 2 {
        for i in 0..3 {
            (strain[(i, 2)], strain[(2, i)]) = (0.0, 0.0);
            (bend[(0, i)], bend[(1, i)], bend[(2, 2)]) = (0.0, 0.0, 0.0);
        }
    }
    if solid.couple().is_none() {
        bend.fill(0.0);
    }
    let force = hooke(force_moduli(solid), &strain);
    let couple = hooke(bending_moduli(solid), &bend);
    let stress = DVector::from_iterator(
        rates.stresses(),
        layout.stresses.iter().map(|c| of(*c, &force, &couple)),
    );
    let strains = DVector::from_iterator(
        rates.stresses(),
        layout.stresses.iter().map(|c| conjugate(*c, &strain, &bend)),
    );
    let law = rates.stiffness_values() * &strains;
    assert!((&law - &stress).amax() <= 1e-14 * stress.amax(), "{law}{stress}");
    let velocities = DVector::from_fn(rates.velocities(), |_, _| random.within(-1.0, 1.0));
    let mut u = DVector::zeros(rates.unknowns.len());
    u.rows_mut(0, velocities.len()).copy_from(&velocities);
    u.rows_mut(velocities.len(), stress.len()).copy_from(&stress);
    let a = rates.symmetric().unwrap().a;
    let kinetic: f64 = layout
        .velocities
        .iter()
        .zip(velocities.iter())
        .map(|(velocity, v)| match velocity {
            Velocity::Translation(_) => 0.5 * solid.density * v * v,
            Velocity::Spin(_) => 0.5 * solid.microrotation.unwrap().inertia * v * v,
        })
        .sum();
    let energy =
        kinetic + density(force_moduli(solid), &strain) + density(bending_moduli(solid), &bend);
    let own = 0.5 * u.dot(&(&a * &u));
    // Condition numbers of random moduli reach 100.
    assert!((own - energy).abs() <= 1e-13 * energy, "{own} {energy}");

    // Carried stresses: Hooke's law, too, with nothing strained across the plane.
    let all: Vec<Component> = layout.all_stresses().collect();
    let stiffness = solid.stiffness(layout.all_stresses());
    for (row, component) in all.iter().enumerate() {
        let sum: f64 = layout
            .stresses
            .iter()
            .enumerate()
            .map(|(column, c)| stiffness[(row, column)].value * conjugate(*c, &strain, &bend))
            .sum();
        let expected = of(*component, &force, &couple);
        assert!((sum - expected).abs() <= 1e-13, "{component:?}: {sum} {expected}");
    }
}

#[test]
fn energy_is_that_of_the_formula() {
    let mut random = Random::new(3);
    for number in 0..300 {
        let solid = solid(&mut random, number % 3);
        check_energy::<2>(&mut random, &solid);
        check_energy::<3>(&mut random, &solid);
    }
    for theory in 0..3 {
        let solid = solid(&mut random, theory);
        let count = [[5, 9], [7, 15], [9, 24]][theory];
        assert_eq!(solid.rates::<2>().unknowns.len(), count[0]);
        assert_eq!(solid.rates::<3>().unknowns.len(), count[1]);
    }
    check_structure(&cubic(&mut random).rates());
}

/// εᵢⱼₖ.
fn permutation(i: usize, j: usize, k: usize) -> f64 {
    let (i, j, k) = (i as f64, j as f64, k as f64);
    (j - i) * (k - j) * (k - i) / 2.0
}

/// Strain rates of a velocity gradient, a spin and its gradient: Λ̇ᵢⱼ = ∂ⱼvᵢ + εᵢⱼₖωₖ, Ṁᵢⱼ = ∂ⱼωᵢ; and
/// none in a rigid rotation, vᵢ = εᵢₖⱼωₖxⱼ.
#[test]
fn strain_rates() {
    let mut random = Random::new(4);
    for number in 0..60 {
        let solid = solid(&mut random, number % 3);
        let layout = solid.layout::<3>();
        let rates = solid.rates::<3>();
        let spin: [f64; 3] = std::array::from_fn(|_| random.within(-1.0, 1.0));
        let rate_of = |velocity: &Matrix3<f64>, bend: &Matrix3<f64>| {
            let mut rate = DVector::zeros(rates.stresses());
            for axis in 0..3 {
                let along = layout.velocities.iter().map(|v| match v {
                    Velocity::Translation(i) => velocity[(*i, axis)],
                    Velocity::Spin(k) => bend[(*k, axis)],
                });
                let along = DVector::from_iterator(rates.velocities(), along);
                rate += &rates.gradient[axis] * along;
            }
            let own = layout.velocities.iter().map(|v| match v {
                Velocity::Translation(_) => 0.3, // of no consequence: translations do not strain
                Velocity::Spin(k) => spin[*k],
            });
            rate + &rates.rotation * DVector::from_iterator(rates.velocities(), own)
        };
        let rigid = Matrix3::from_fn(|i, j| (0..3).map(|k| permutation(i, k, j) * spin[k]).sum());
        assert!(rate_of(&rigid, &Matrix3::zeros()).amax() <= 1e-15);

        let (velocity, bend) = (tensor(&mut random), tensor(&mut random));
        let strain = Matrix3::from_fn(|i, j| {
            velocity[(i, j)] + (0..3).map(|k| permutation(i, j, k) * spin[k]).sum::<f64>()
        });
        let strain = if number % 3 == 0 { velocity } else { strain };
        let own = rate_of(&velocity, &bend);
        for (component, own) in layout.stresses.iter().zip(own.iter()) {
            let expected = conjugate(*component, &strain, &bend);
            assert!((own - expected).abs() <= 1e-15, "{component:?}: {own} {expected}");
        }
    }
    // In the plane Λ̇₂₁ = ∂₁v₂ − ω₃ and the spin gets σ₂₁ − σ₁₂.
    let layout = plane(solid(&mut random, 2).theory());
    let place = layout.stresses.iter().position(|c| *c == Force(1, 0)).unwrap();
    assert_eq!(layout.rotation()[(place, 2)], -1.0);
    assert_eq!(layout.gradient(0)[(place, 1)], 1.0);
}

/// D (R e Rᵀ) = R (D e) Rᵀ.
#[test]
fn stiffness_is_isotropic() {
    let mut random = Random::new(5);
    for number in 0..200 {
        let solid = solid(&mut random, number % 3);
        let layout = space(solid.theory());
        let stiffness = solid.stiffness(layout.stresses.iter().copied()).map(|x| x.value);
        let turn = {
            let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::from_fn(|_, _| {
                random.within(-1.0, 1.0)
            }));
            nalgebra::Rotation3::from_axis_angle(&axis, random.within(0.1, 3.0)).into_inner()
        };
        let turned = |t: &Matrix3<f64>| turn * t * turn.transpose();
        let stress = |strain: &Matrix3<f64>, bend: &Matrix3<f64>| {
            let strains = layout.stresses.iter().map(|c| conjugate(*c, strain, bend));
            let stresses = &stiffness * DVector::from_iterator(layout.stresses.len(), strains);
            let mut stress = Stress::default();
            for (component, value) in layout.stresses.iter().zip(stresses.iter()) {
                component.set(&mut stress, *value);
            }
            let matrix = |t: [[f64; 3]; 3]| Matrix3::from_fn(|i, j| t[i][j]);
            (matrix(stress.force), matrix(stress.couple))
        };
        let (strain, bend) = (tensor(&mut random), tensor(&mut random));
        let (force, couple) = stress(&strain, &bend);
        let (own_force, own_couple) = stress(&turned(&strain), &turned(&bend));
        assert!((own_force - turned(&force)).amax() <= 1e-14 * force.amax().max(1.0));
        assert!((own_couple - turned(&couple)).amax() <= 1e-14 * couple.amax().max(1.0));
    }
}

/// Frequencies ω of plane waves exp(i(k·x − ωt)), ascending: eigenvalues of the Hermitian
/// L⁻¹(−k·B + iQ)L⁻ᵀ with A = L Lᵀ.
fn frequencies<const D: usize>(form: &SymmetricForm<D>, wave: [f64; D]) -> Vec<f64> {
    let factor = form.a.clone().cholesky().unwrap().l();
    let inverse = factor.try_inverse().unwrap().map(|x| Complex::new(x, 0.0));
    let mut symbol = form.q.map(|x| Complex::new(0.0, x));
    for axis in 0..D {
        symbol -= form.b[axis].map(|x| Complex::new(x * wave[axis], 0.0));
    }
    let hermitian = &inverse * symbol * inverse.adjoint();
    let mut values: Vec<f64> = SymmetricEigen::new(hermitian).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

fn unit<const D: usize>(random: &mut Random) -> [f64; D] {
    let raw: [f64; D] = std::array::from_fn(|_| random.generic(0.2, 1.0));
    let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
    raw.map(|x| x / norm)
}

fn check_speeds<const D: usize>(solid: &Isotropic, random: &mut Random, zeros: usize) {
    let form = solid.rates::<D>().symmetric().unwrap();
    let principal = SymmetricForm { q: form.q.clone() * 0.0, ..form };
    let own = frequencies(&principal, unit(random));
    let speeds = solid.speeds();
    let mut expected = vec![0.0; zeros];
    let mut add = |speed: Option<f64>, count: usize| {
        for speed in speed.into_iter().flat_map(|speed| vec![speed; count]) {
            expected.extend([speed, -speed]);
        }
    };
    add(Some(speeds.longitudinal), 1);
    add(Some(speeds.shear), D - 1);
    add(speeds.torsion.filter(|_| D == 3), 1);
    add(speeds.rotation, D - 1);
    expected.sort_by(f64::total_cmp);
    assert_eq!(own.len(), expected.len());
    for (own, expected) in own.iter().zip(&expected) {
        assert!((own - expected).abs() <= 1e-12 * speeds.longitudinal, "{own} {expected}");
    }
}

#[test]
fn speeds_are_those_of_the_symbol() {
    let mut random = Random::new(6);
    for _ in 0..100 {
        check_speeds::<2>(&solid(&mut random, 2), &mut random, 3);
        check_speeds::<3>(&solid(&mut random, 2), &mut random, 12);
        check_speeds::<2>(&solid(&mut random, 1), &mut random, 3);
        check_speeds::<3>(&solid(&mut random, 1), &mut random, 9);
        check_speeds::<2>(&solid(&mut random, 0), &mut random, 1);
        check_speeds::<3>(&solid(&mut random, 0), &mut random, 3);
    }
}

/// The homogeneous medium of the unit test of SPECFEM++ (Princeton).
#[test]
fn published_speeds() {
    let couple = CoupleModuli { beta: 7.75e8, gamma: 1.5e8, eta: 3e8 };
    let microrotation = Microrotation { alpha: 1.005e9, inertia: 2700.0, couple: Some(couple) };
    let solid = Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(microrotation)).unwrap();
    let speeds = solid.speeds();
    let close = |own: f64, published: f64, digit: f64| {
        assert!((own - published).abs() <= 0.5 * digit, "{own} {published}");
    };
    close(speeds.longitudinal, 3000.0, 1e-9);
    close(speeds.shear, 1836.361, 1e-3);
    close(speeds.torsion.unwrap(), 630.990, 1e-3);
    close(speeds.rotation.unwrap(), 408.248, 1e-3);
    close(microrotation.natural_frequency() / std::f64::consts::TAU, 194.2009, 1e-4);
    close(Isotropic { microrotation: None, ..solid }.speeds().shear, 1732.05, 1e-2);
}

/// Transverse waves of the reduced solid, exactly: k² = ρω²(4α − jω²)/(4αμ − (μ + α)jω²), with nothing
/// between ω₁ = ω₀/√(1 + α/μ) and ω₀ = √(4α/j).
#[test]
fn reduced_dispersion() {
    let mut random = Random::new(7);
    for _ in 0..200 {
        let solid = solid(&mut random, 1);
        let Microrotation { alpha, inertia, .. } = solid.microrotation.unwrap();
        let (mu, natural) = (solid.mu, solid.microrotation.unwrap().natural_frequency());
        let number = decades(&mut random, -1.0, 1.0);
        let direction: [f64; 2] = unit(&mut random);
        let form = solid.rates::<2>().symmetric().unwrap();
        let own = frequencies(&form, direction.map(|x| x * number));
        // Seven: ± two transverse, ± longitudinal, one at rest.
        let longitudinal = solid.speeds().longitudinal * number;
        let mut positive: Vec<f64> = own[4..].to_vec();
        let nearest = positive
            .iter()
            .enumerate()
            .min_by(|a, b| (a.1 - longitudinal).abs().total_cmp(&(b.1 - longitudinal).abs()))
            .unwrap()
            .0;
        assert!((positive.remove(nearest) - longitudinal).abs() <= 1e-12 * longitudinal);
        assert!(own[3].abs() <= 1e-12 * longitudinal.max(natural));
        let edge = natural / (1.0 + alpha / mu).sqrt();
        assert!(positive[0] < edge && positive[1] > natural, "{positive:?} {edge} {natural}");
        for frequency in positive {
            let w = inertia * frequency * frequency;
            // Cleared of the fraction, which has a pole at ω₁.
            let left = number * number * (4.0 * alpha * mu - (mu + alpha) * w);
            let right = solid.density * frequency * frequency * (4.0 * alpha - w);
            let size = number * number * (4.0 * alpha * mu + (mu + alpha) * w)
                + solid.density * frequency * frequency * (4.0 * alpha + w);
            assert!((left - right).abs() <= 1e-12 * size, "{left} {right}");
        }
    }
}

/// Limits, each with its rate: j → 0 or k → 0 (the rotation follows), c → √(μ/ρ) of the classical solid
/// with an error of order jk²; γ, η → 0, the reduced solid with an error of order γ + η.
#[test]
fn limits() {
    let mut random = Random::new(8);
    for _ in 0..20 {
        let base = solid(&mut random, 2);
        let direction: [f64; 2] = unit(&mut random);
        let slow = |inertia: f64| {
            let microrotation = base.microrotation.unwrap();
            let solid = Isotropic {
                microrotation: Some(Microrotation { inertia, couple: None, ..microrotation }),
                ..base
            };
            frequencies(&solid.rates::<2>().symmetric().unwrap(), direction)[4]
        };
        let classical = Isotropic { microrotation: None, ..base };
        let form = classical.rates::<2>().symmetric().unwrap();
        let exact = frequencies(&form, direction)[3];
        assert!((exact - classical.speeds().shear).abs() <= 1e-13);
        let [coarse, fine] = [1e-3, 1e-4].map(|inertia| (slow(inertia) - exact).abs());
        assert!(coarse < 0.02 * exact, "{coarse}");
        assert!((8.0..12.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");

        let bent = |scale: f64| {
            let microrotation = base.microrotation.unwrap();
            let CoupleModuli { beta, gamma, eta } = microrotation.couple.unwrap();
            let couple =
                CoupleModuli { beta: scale * beta, gamma: scale * gamma, eta: scale * eta };
            let solid = Isotropic {
                microrotation: Some(Microrotation { couple: Some(couple), ..microrotation }),
                ..base
            };
            let all = frequencies(&solid.rates::<2>().symmetric().unwrap(), direction);
            [all[6], all[7], all[8]]
        };
        let reduced = Isotropic {
            microrotation: base.microrotation.map(|m| Microrotation { couple: None, ..m }),
            ..base
        };
        let all = frequencies(&reduced.rates::<2>().symmetric().unwrap(), direction);
        let distance = |scale: f64| {
            let own = bent(scale);
            (0..3).map(|i| (own[i] - all[4 + i]).abs()).fold(0.0, f64::max)
        };
        let [coarse, fine] = [distance(1e-4), distance(1e-5)];
        assert!(coarse < 1e-2, "{coarse}");
        assert!((8.0..12.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
    }
}

/// Every inequality is refused with its name and the number, at zero and below, and for what is no
/// number.
#[test]
fn broken_inequalities_are_refused() {
    type Break = fn(&mut Isotropic, f64);
    fn rotation(solid: &mut Isotropic) -> &mut Microrotation {
        solid.microrotation.as_mut().unwrap()
    }
    fn couple(solid: &mut Isotropic) -> &mut CoupleModuli {
        rotation(solid).couple.as_mut().unwrap()
    }
    let couple_moduli = CoupleModuli { beta: 1.0, gamma: 1.5, eta: 2.0 };
    let microrotation = Microrotation { alpha: 1.0, inertia: 1.0, couple: Some(couple_moduli) };
    let sound = Isotropic::new(1.0, 1.5, 1.0, Some(microrotation)).unwrap();
    let cases: [(&str, &str, Break); 8] = [
        ("mu", "μ > 0", |s, x| s.mu = x),
        ("lambda", "3λ + 2μ > 0", |s, x| s.lambda = x - 1.0),
        ("density", "ρ > 0", |s, x| s.density = x),
        ("alpha", "α > 0", |s, x| rotation(s).alpha = x),
        ("inertia", "j > 0", |s, x| rotation(s).inertia = x),
        ("gamma", "γ > 0", |s, x| couple(s).gamma = x),
        ("beta", "3β + 2γ > 0", |s, x| couple(s).beta = x - 1.0),
        ("eta", "η > 0", |s, x| couple(s).eta = x),
    ];
    for (key, inequality, set) in cases {
        for (value, sum) in
            [(0.0, "= 0"), (-0.25, "= -0.75"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")]
        {
            let mut broken = sound;
            set(&mut broken, value);
            let error =
                Isotropic::new(broken.lambda, broken.mu, broken.density, broken.microrotation)
                    .unwrap_err();
            assert_eq!(error.input, key);
            let text = error.to_string();
            assert!(text.contains(inequality), "{text}");
            let number =
                if inequality.starts_with('3') { sum.to_string() } else { value.to_string() };
            assert!(error.found.contains(&number), "{text}: {number}");
        }
    }
    let plane = PlaneCompliances {
        a1: 1.0,
        b1: 0.5,
        a2: 2.0,
        b2: 0.5,
        alpha2: 1.0,
        density: 1.0,
        inertia: 1.0,
    };
    assert!(plane.check().is_ok());
    type BreakPlane = fn(&mut PlaneCompliances);
    let cases: [(&str, &str, &str, BreakPlane); 9] = [
        ("a1", "a₁ > |b₁|", "= 0", |c| c.b1 = 1.0),
        ("a1", "a₁ > |b₁|", "= -0.5", |c| c.b1 = -1.5),
        ("a1", "a₁ > |b₁|", "NaN", |c| c.a1 = f64::NAN),
        ("a2", "a₂ > |b₂|", "= 0", |c| c.b2 = -2.0),
        ("a2", "a₂ > |b₂|", "= -1", |c| c.b2 = 3.0),
        ("alpha2", "α₂ > 0", "0", |c| c.alpha2 = 0.0),
        ("alpha2", "α₂ > 0", "-1", |c| c.alpha2 = -1.0),
        ("density", "ρ₀ > 0", "0", |c| c.density = 0.0),
        ("inertia", "J₀ > 0", "0", |c| c.inertia = 0.0),
    ];
    for (key, inequality, number, set) in cases {
        let mut broken = plane;
        set(&mut broken);
        let error = broken.check().unwrap_err();
        assert_eq!(error.input, key);
        assert!(error.allowed.contains(inequality), "{error}");
        assert!(error.found.contains(number), "{error}");
    }
    // Not isotropic, though 3λ + 2μ > 0 alone would allow it: each inequality stands for itself.
    let dense_foam = CoupleModuli { beta: -1.0, gamma: 1.5, eta: 1.0 };
    let foam = Microrotation { couple: Some(dense_foam), ..microrotation };
    assert_eq!(Isotropic::new(1.0, 1.0, 1.0, Some(foam)).unwrap_err().input, "beta");
}

#[test]
fn compliances_and_moduli() {
    let mut random = Random::new(9);
    for _ in 0..1000 {
        let mut solid = solid(&mut random, 2);
        // From rubber to foam; α from 1e-3 to 1e3 times μ.
        let scale = decades(&mut random, 0.0, 11.0);
        (solid.lambda, solid.mu) = (solid.lambda * scale, solid.mu * scale);
        let alpha = solid.mu * decades(&mut random, -3.0, 3.0);
        solid.microrotation.as_mut().unwrap().alpha = alpha;
        let c = PlaneCompliances::of(&solid).unwrap().check().unwrap();
        let couple = solid.couple().unwrap();
        assert_eq!(c.alpha2, couple.gamma + couple.eta);
        assert!(c.anisotropy().abs() <= 1e-12, "{:e}", c.anisotropy());
        let [lambda, mu, own_alpha] = c.isotropic_moduli().unwrap();
        // a₂ − b₂ loses what a₂ and b₂ have in common: α/μ or μ/α digits' worth.
        let close = |own: f64, exact: f64, size: f64| {
            assert!((own - exact).abs() <= 1e-13 * size, "{own:e} {exact:e} of {solid:?}");
        };
        close(lambda, solid.lambda, solid.lambda.abs() + solid.mu);
        close(mu, solid.mu, solid.mu);
        close(own_alpha, alpha, alpha + alpha * alpha / solid.mu);
        // The published relations.
        let of = |a: f64, b: f64| [a, b].map(|x| x / ((a - b) * (a + b)));
        let size = solid.lambda.abs() + 2.0 * solid.mu + alpha;
        let [sum, cross] = of(c.a1, c.b1);
        close(sum, solid.lambda + 2.0 * solid.mu, size);
        close(cross, solid.lambda, size);

        // Cubic ones are refused, even when they are so by a millionth.
        let mut turned = c;
        turned.a1 *= 1.0 + 1e-6;
        let error = turned.isotropic_moduli().unwrap_err();
        assert!(error.allowed.contains("a₁ + b₁ = a₂ − b₂"), "{error}");
        assert!(error.found.contains(&format!("{}", turned.a1 + turned.b1)), "{error}");
    }
    assert_eq!(PlaneCompliances::of(&solid(&mut random, 1)), None);
    assert_eq!(PlaneCompliances::of(&solid(&mut random, 0)), None);

    // Speeds of cubic solids depend on direction, of isotropic ones they do not.
    let spread = |form: &SymmetricForm<2>| {
        let principal = SymmetricForm { q: form.q.clone() * 0.0, ..form.clone() };
        let [along, across] = [[1.0, 0.0], [0.6, 0.8]].map(|n| frequencies(&principal, n));
        along.iter().zip(&across).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    assert!(spread(&cubic(&mut random).rates().symmetric().unwrap()) > 1e-3);
    assert!(spread(&solid(&mut random, 2).rates::<2>().symmetric().unwrap()) < 1e-12);
}
