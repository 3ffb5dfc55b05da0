//! Hooke's law, energy density and isotropy of elastic solids.

use crate::random_solids::{cubic, solid};
use crate::support::Random;
use crate::tensors::{conjugate, of, tensor};
use nalgebra::{DVector, Matrix3};
use wellposed_models::common::rates::RateEquations;
use wellposed_models::solid::parameters::Isotropic;
use wellposed_models::solid::stress::Component;
use wellposed_models::solid::stress::Stress;
use wellposed_models::solid::symbol::{Velocity, space};

/// Hooke's law λ tr(Λ) δ + 2μ Λˢ + 2α Λᵃ.
fn hooke([trace, symmetric, antisymmetric]: [f64; 3], t: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (trace * t.trace())
        + (t + t.transpose()) * symmetric
        + (t - t.transpose()) * antisymmetric
}

/// Energy density ½λ (tr Λ)² + μ|Λˢ|² + α|Λᵃ|².
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

/// Checks for U = (v, ω, De) that ½UᵀAU is the energy density and that De agrees with Hooke's law for tensors.
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

    // Carried (out-of-plane) stresses follow Hooke's law with zero out-of-plane strain.
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

/// Energy, Hooke's law, symmetry of the matrices and number of unknowns of random solids in 2 and 3 dimensions.
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

/// The stiffness of isotropic solids commutes with rotations: D(R e Rᵀ) = R (D e) Rᵀ.
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
