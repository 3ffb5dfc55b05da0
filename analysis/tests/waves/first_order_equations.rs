//! Plane waves against the roots of the first-order equations.

use crate::support::states::seeded_generator;
use models::LinearisedSystem;
use models::common::rates::RateEquations;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use models::yield_set::tangent::tangent_stiffness;
use nalgebra::DVector;
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_analysis::pencil::{Pencil, PencilRoots};
use wellposed_analysis::waves::{DirectionalWaves, plane_waves, roots};

use super::random_solids::{THEORIES, random_solid, random_solid_of_order_one};
use super::yielding::{random_stress_on_yield_surface, tangent_basis};

/// Verifies plane waves against the roots of the first-order equations by generalised eigenvalues.
#[test]
fn waves_agree_with_the_pencil() {
    let random = &mut seeded_generator(8);
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    for index in 0..300 {
        let solid = random_solid(random, THEORIES[index % 3]);
        let layout = solid.layout::<2>();
        let list: Vec<_> = layout.all_stresses().collect();
        let elastic = solid.stiffness(layout.all_stresses());
        let friction = random.uniform(0.1, 0.8);
        let set = YieldSet::from(Mises::new_drucker_prager(1.0, friction, friction));
        let active =
            set.active_conditions(&random_stress_on_yield_surface(random, &set, false), 1e-9);
        let plastic = tangent_stiffness(&elastic, &list, &active).expect("associated");
        for stiffness in [elastic, plastic] {
            let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
            let equations: RateEquations<2> = layout.rates(&stiffness, solid.density, inertia);
            equations.linearise(&mut system);
            pencil.update(&system).expect("finite");
            let k0 =
                solid.microrotation.map_or(1.0, |m| m.natural_frequency() / solid.speeds().shear);
            let (k, direction) = (k0 * random.log_uniform(0.3, 3.0), random.uniform(0.0, PI));
            let PencilRoots::Regular { finite, .. } = pencil.roots(k, direction) else {
                panic!("a regular system")
            };
            let families =
                DirectionalWaves::from_equations(&equations, [direction.cos(), direction.sin()])
                    .families;
            let mut expected: Vec<f64> =
                families.iter().flat_map(|f| f.squared_frequencies(k)).map(|w| w.re).collect();
            // The first-order system has one zero root for each stress in excess of the number of velocities.
            expected.extend(vec![0.0; equations.stress_count() - equations.velocity_count()]);
            let mut found: Vec<f64> =
                finite.iter().filter(|r| r.im >= 0.0).map(|r| r.im * r.im).collect();
            let largest = expected.iter().copied().fold(0.0, f64::max);
            // Every ω² that is not zero within rounding has a pair of roots ±iω.
            found.sort_by(f64::total_cmp);
            for e in expected.iter().filter(|&&e| e > 1e-6 * largest) {
                let nearest = found.iter().map(|f| (f - e).abs()).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-9 * largest, "{e} not among {found:?}");
            }
        }
    }
}

/// Verifies that with relaxation the roots of the linearised system are the roots of the restricted form, decay
/// included.
#[test]
fn relaxation_reaches_the_linearised_system() {
    let random = &mut seeded_generator(29);
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    for index in 0..40 {
        // Only theories whose number of equations is within the limit of the exact polynomial.
        let solid = random_solid_of_order_one(random, THEORIES[index % 2]);
        let layout = solid.layout::<2>().with_out_of_plane();
        let list: Vec<_> = layout.all_stresses().collect();
        let set = Mises { antisymmetric_weight: 0.7, ..Mises::new_drucker_prager(1.0, 0.4, 0.4) };
        let stress = random_stress_on_yield_surface(random, &YieldSet::from(set), false);
        let condition = set.condition(&stress).expect("off the axis");
        let stiffness = solid.stiffness(layout.all_stresses());
        let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
        let curvature = set.curvature(&stress, &list).expect("off the axis") * 0.8;
        let relaxation = curvature.map(models::Rounded::from_rounded);
        let plastic = tangent_stiffness(&stiffness, &list, &[condition]).expect("response");
        let rates = |stiffness| RateEquations::<2> {
            relaxation: relaxation.clone(),
            ..layout.rates(stiffness, 1.0, inertia)
        };
        rates(&plastic).linearise(&mut system);
        pencil.update(&system).expect("finite");
        let (k, angle) = (random.log_uniform(0.3, 3.0), random.uniform(0.0, PI));
        let PencilRoots::Regular { finite, .. } = pencil.roots(k, angle) else { panic!("regular") };

        let nv = solid.layout::<2>().velocities.len();
        let normal = DVector::from_fn(nv + list.len(), |row, _| {
            row.checked_sub(nv).map_or(0.0, |s| list[s].derivative(&condition.normal))
        });
        let restricted = rates(&stiffness)
            .symmetric_form()
            .expect("elastic")
            .restrict(&tangent_basis(nv + list.len(), &[normal]));
        let factor = restricted.a.clone().try_inverse().expect("definite");
        let mut symbol = (&factor * &restricted.q).map(|x| Complex64::new(x, 0.0));
        for (b, component) in restricted.b.iter().zip([k * angle.cos(), k * angle.sin()]) {
            symbol += (&factor * b).map(|x| Complex64::new(0.0, component * x));
        }
        let expected = symbol.schur().unpack().1.diagonal();
        assert_eq!(finite.len(), expected.len() + 1, "one more is zero");
        for root in expected.iter() {
            let near = finite.iter().map(|f| (f - root).norm()).fold(f64::INFINITY, f64::min);
            assert!(near < 1e-6 * (1.0 + root.norm()), "{root} {finite:?}");
        }
        assert!(expected.iter().any(|root| root.re < -1e-3));
    }
}

/// Verifies that plane waves solve the linearised equations, with the frequencies of their families.
#[test]
fn plane_waves_solve_the_equations() {
    let couple = Some(CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 });
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let solid = Isotropic::new(1.4, 0.9, 1.2, Some(rotation)).expect("sound moduli");
    let layout = solid.layout::<3>();
    let rates = layout.rates(&solid.stiffness(layout.all_stresses()), 1.2, 0.37);
    let wave = [1.1, -0.7, 0.4];
    let number = wave.iter().map(|k| k * k).sum::<f64>().sqrt();
    let found = plane_waves(&rates, wave);
    assert_eq!(found.len(), 6);
    let mut system = LinearisedSystem::default();
    rates.linearise(&mut system);
    for (frequency, amplitude) in &found {
        // The linearised equations for a plane wave: (−iωA + iκB + C)û = 0.
        let i = Complex64::i();
        let mut sum = system.a.map(|x| x.value).map(Complex64::from) * amplitude * (-i * frequency);
        for (b, k) in system.b.iter().zip(wave) {
            sum += b.map(|x| x.value).map(Complex64::from) * amplitude * (i * k);
        }
        sum += system.c.map(|x| x.value).map(Complex64::from) * amplitude;
        let size = amplitude.map(|x| x.norm()).max() * frequency;
        assert!(sum.map(|x| x.norm()).max() < 1e-12 * size, "{frequency}");
    }
    let mut expected = roots(&rates, wave.map(|k| k / number), number);
    expected.retain(|root| root.im > 1e-9);
    expected.sort_by(|a, b| b.im.total_cmp(&a.im));
    assert_eq!(expected.len(), 6);
    for (root, (frequency, _)) in expected.iter().zip(&found) {
        assert!((root.im - frequency).abs() < 1e-12 * frequency, "{root} {frequency}");
    }
}
