//! Hooke's law, energy density and isotropy of elastic solids.

use crate::cosserat::random_solids::{random_cubic_solid, random_solid};
use crate::cosserat::tensors::{component_value, conjugate_strain, random_tensor};
use crate::support::RandomNumbers;
use nalgebra::{DVector, Matrix3};
use wellposed_models::common::rates::RateEquations;
use wellposed_models::solid::parameters::Isotropic;
use wellposed_models::solid::stress::Stress;
use wellposed_models::solid::stress::StressComponent;
use wellposed_models::solid::symbol::{Velocity, space_layout};

/// Hooke's law λ tr(Λ) δ + 2μ Λˢ + 2α Λᵃ.
fn isotropic_stress([trace, symmetric, antisymmetric]: [f64; 3], t: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (trace * t.trace())
        + (t + t.transpose()) * symmetric
        + (t - t.transpose()) * antisymmetric
}

/// Energy density ½λ (tr Λ)² + μ|Λˢ|² + α|Λᵃ|².
fn energy_density([trace, symmetric, antisymmetric]: [f64; 3], t: &Matrix3<f64>) -> f64 {
    let (s, a) = ((t + t.transpose()) * 0.5, (t - t.transpose()) * 0.5);
    0.5 * trace * t.trace().powi(2)
        + symmetric * s.norm_squared()
        + antisymmetric * a.norm_squared()
}

fn force_moduli(solid: &Isotropic) -> [f64; 3] {
    [solid.lambda, solid.mu, solid.microrotation.map_or(0.0, |m| m.alpha)]
}

fn couple_moduli(solid: &Isotropic) -> [f64; 3] {
    solid.couple().map_or([0.0; 3], |c| [c.beta, c.gamma, c.eta])
}

fn check_matrix_symmetry<const D: usize>(rates: &RateEquations<D>) {
    let form = rates.symmetric_form().expect("positive definite");
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

/// Checks for U = (v, ω, De), with velocities v, spins ω, strains e and stiffness matrix D, that ½UᵀAU is the sum of
/// kinetic and elastic energy density, and that De agrees with Hooke's law for tensors.
fn check_energy<const D: usize>(random: &mut RandomNumbers, solid: &Isotropic) {
    let layout = solid.layout::<D>();
    let rates = solid.rates::<D>();
    check_matrix_symmetry(&rates);
    let (mut strain, mut curvature) = (random_tensor(random), random_tensor(random));
    if solid.microrotation.is_none() {
        strain = (strain + strain.transpose()) * 0.5;
    }
    if D == 2 {
        for i in 0..3 {
            (strain[(i, 2)], strain[(2, i)]) = (0.0, 0.0);
            (curvature[(0, i)], curvature[(1, i)], curvature[(2, 2)]) = (0.0, 0.0, 0.0);
        }
    }
    if solid.couple().is_none() {
        curvature.fill(0.0);
    }
    let force = isotropic_stress(force_moduli(solid), &strain);
    let couple = isotropic_stress(couple_moduli(solid), &curvature);
    let stress = DVector::from_iterator(
        rates.stress_count(),
        layout.stresses.iter().map(|c| component_value(*c, &force, &couple)),
    );
    let strains = DVector::from_iterator(
        rates.stress_count(),
        layout.stresses.iter().map(|c| conjugate_strain(*c, &strain, &curvature)),
    );
    let law = rates.stiffness_values() * &strains;
    assert!((&law - &stress).amax() <= 1e-14 * stress.amax(), "{law}{stress}");
    let velocities = DVector::from_fn(rates.velocity_count(), |_, _| random.uniform(-1.0, 1.0));
    let mut u = DVector::zeros(rates.unknowns.len());
    u.rows_mut(0, velocities.len()).copy_from(&velocities);
    u.rows_mut(velocities.len(), stress.len()).copy_from(&stress);
    let a = rates.symmetric_form().unwrap().a;
    let kinetic: f64 = layout
        .velocities
        .iter()
        .zip(velocities.iter())
        .map(|(velocity, v)| match velocity {
            Velocity::Translation(_) => 0.5 * solid.density * v * v,
            Velocity::Spin(_) => 0.5 * solid.microrotation.unwrap().inertia * v * v,
        })
        .sum();
    let energy = kinetic
        + energy_density(force_moduli(solid), &strain)
        + energy_density(couple_moduli(solid), &curvature);
    let own = 0.5 * u.dot(&(&a * &u));
    // The tolerance allows for condition numbers of the stiffness matrix up to 100.
    assert!((own - energy).abs() <= 1e-13 * energy, "{own} {energy}");

    // All stresses, including the out-of-plane stresses, follow Hooke's law with zero out-of-plane strain.
    let all: Vec<StressComponent> = layout.all_stresses().collect();
    let stiffness = solid.stiffness(layout.all_stresses());
    for (row, component) in all.iter().enumerate() {
        let sum: f64 = layout
            .stresses
            .iter()
            .enumerate()
            .map(|(column, c)| {
                stiffness[(row, column)].value * conjugate_strain(*c, &strain, &curvature)
            })
            .sum();
        let expected = component_value(*component, &force, &couple);
        assert!((sum - expected).abs() <= 1e-13, "{component:?}: {sum} {expected}");
    }
}

/// For random solids in 2 and 3 dimensions ½UᵀAU of the symmetric form is the sum of kinetic and elastic energy
/// density, the stiffness matrix agrees with Hooke's law for tensors, A and Bⁱ are symmetric and Q antisymmetric, and
/// the number of unknowns is correct.
#[test]
fn energy_of_the_symmetric_form_is_the_elastic_and_kinetic_energy() {
    let mut random = RandomNumbers::new(3);
    for number in 0..300 {
        let solid = random_solid(&mut random, number % 3);
        check_energy::<2>(&mut random, &solid);
        check_energy::<3>(&mut random, &solid);
    }
    for theory in 0..3 {
        let solid = random_solid(&mut random, theory);
        let count = [[5, 9], [7, 15], [9, 24]][theory];
        assert_eq!(solid.rates::<2>().unknowns.len(), count[0]);
        assert_eq!(solid.rates::<3>().unknowns.len(), count[1]);
    }
    check_matrix_symmetry(&random_cubic_solid(&mut random).rates());
}

/// The stiffness D of isotropic solids commutes with rotations R: D(R e Rᵀ) = R (D e) Rᵀ for every strain e.
#[test]
fn isotropic_stiffness_commutes_with_rotations() {
    let mut random = RandomNumbers::new(5);
    for number in 0..200 {
        let solid = random_solid(&mut random, number % 3);
        let layout = space_layout(solid.theory());
        let stiffness = solid.stiffness(layout.stresses.iter().copied()).map(|x| x.value);
        let rotation = {
            let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::from_fn(|_, _| {
                random.uniform(-1.0, 1.0)
            }));
            nalgebra::Rotation3::from_axis_angle(&axis, random.uniform(0.1, 3.0)).into_inner()
        };
        let rotate_tensor = |t: &Matrix3<f64>| rotation * t * rotation.transpose();
        let stress = |strain: &Matrix3<f64>, curvature: &Matrix3<f64>| {
            let strains = layout.stresses.iter().map(|c| conjugate_strain(*c, strain, curvature));
            let stresses = &stiffness * DVector::from_iterator(layout.stresses.len(), strains);
            let mut stress = Stress::default();
            for (component, value) in layout.stresses.iter().zip(stresses.iter()) {
                component.set(&mut stress, *value);
            }
            let matrix = |t: [[f64; 3]; 3]| Matrix3::from_fn(|i, j| t[i][j]);
            (matrix(stress.force), matrix(stress.couple))
        };
        let (strain, curvature) = (random_tensor(&mut random), random_tensor(&mut random));
        let (force, couple) = stress(&strain, &curvature);
        let (own_force, own_couple) = stress(&rotate_tensor(&strain), &rotate_tensor(&curvature));
        assert!((own_force - rotate_tensor(&force)).amax() <= 1e-14 * force.amax().max(1.0));
        assert!((own_couple - rotate_tensor(&couple)).amax() <= 1e-14 * couple.amax().max(1.0));
    }
}
