//! Associated flow: no growth, and no speed above the elastic speeds.

use crate::support::states::{RandomNumbers, seeded_generator};
use models::common::rates::RateEquations;
use models::solid::parameters::{CoupleModuli, Isotropic, Theory};
use models::yield_set::YieldSet;
use models::yield_set::parameters::{
    ActiveCondition, InterlayerCoupleLimits, InterlayerYieldSet, Mises,
};
use models::yield_set::tangent::tangent_stiffness;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use wellposed_analysis::waves::{DirectionalWaves, squared_speeds};

use super::random_solids::{THEORIES, random_solid, random_solid_of_order_one, random_unit_vector};
use super::yielding::{
    equations_with_out_of_plane_stresses, growth_and_bound, random_mises_condition,
    random_stress_on_yield_surface, reverse_time, tangent_basis,
};

/// Verifies that elastic and yielding squared speeds along `normal` interlace, with `conditions` active conditions.
fn assert_interlaced<const D: usize>(
    elastic: &RateEquations<D>,
    yielding: &RateEquations<D>,
    normal: [f64; D],
    conditions: usize,
    tolerance: f64,
) {
    let [fast, slow] = [elastic, yielding].map(|e| squared_speeds(e, normal));
    let tolerance = tolerance * fast[0].re;
    for i in 0..fast.len() {
        assert!(slow[i].im.abs() <= tolerance && slow[i].re >= -tolerance, "{slow:?}");
        assert!(slow[i].re <= fast[i].re + tolerance, "{slow:?} {fast:?}");
        if let Some(next) = fast.get(i + conditions) {
            assert!(slow[i].re >= next.re - tolerance, "{slow:?} {fast:?}");
        }
    }
}

#[test]
fn associated_yielding_keeps_growth_at_rounding_level() {
    check_associated_yielding(3000);
}

/// Checks `count` random yielding solids.
fn check_associated_yielding(count: usize) {
    let random = &mut seeded_generator(9);
    let mut worst = [0.0f64; 2];
    let mut corners = [0usize; 5];
    for index in 0..count {
        let theory = THEORIES[index % 3];
        let mut solid = random_solid(random, theory);
        // Scale moduli and density to order one.
        let scale = solid.mu;
        solid.lambda /= scale;
        solid.mu = 1.0;
        solid.density = 1.0;
        if let Some(m) = &mut solid.microrotation {
            m.alpha /= scale;
            m.inertia = 1.0;
            let gamma = m.couple.map_or(1.0, |c| c.gamma);
            m.couple = m.couple.map(|c| CoupleModuli {
                beta: c.beta / gamma,
                gamma: 1.0,
                eta: c.eta / gamma,
            });
        }
        let friction = random.uniform(0.0, 0.9);
        let with_couple = theory == Theory::Cosserat;
        let set = match index / 3 % 4 {
            0 | 1 => {
                let couple = with_couple.then(|| {
                    let friction = random.uniform(0.0, 0.5);
                    InterlayerCoupleLimits {
                        strength: random.uniform(0.1, 1.0),
                        friction,
                        dilatancy: friction,
                    }
                });
                YieldSet::from(InterlayerYieldSet {
                    shear_strength: random.uniform(0.1, 1.0),
                    shear_friction: friction,
                    shear_dilatancy: friction,
                    couple,
                })
            }
            2 => YieldSet::from(Mises::new_drucker_prager(1.0, friction, friction)),
            _ => YieldSet::from(Mises {
                antisymmetric_weight: random.uniform(0.0, 2.0),
                symmetric_internal_length: with_couple.then_some(1.0),
                antisymmetric_internal_length: with_couple.then_some(2.0),
                ..Mises::new_von_mises(1.0)
            }),
        };
        let is_interlayer = set.half_spaces().is_some();
        let stress = random_stress_on_yield_surface(random, &set, true);
        let active = set.active_conditions(&stress, 1e-9);
        assert!(!active.is_empty());
        corners[active.len()] += 1;
        if is_interlayer || random.bernoulli(0.5) {
            verify_associated_yielding::<2>(random, &solid, &active, &mut worst);
        } else {
            verify_associated_yielding::<3>(random, &solid, &active, &mut worst);
        }
    }
    println!("max Re ς, Hermitian part, over the largest entry: {worst:?}; conditions {corners:?}");
    // Tolerance of about 100 ε for the eigenvalues and entries of matrices of up to 24 × 24 entries of order one.
    assert!(worst[0] < 3e-14 && worst[1] < 3e-14, "{worst:?}");
    assert!(20 * corners[2] > count && 100 * corners[3] > count, "{corners:?}");
}

fn verify_associated_yielding<const D: usize>(
    random: &mut RandomNumbers,
    solid: &Isotropic,
    active: &[ActiveCondition],
    worst: &mut [f64; 2],
) {
    let layout = solid.layout::<D>();
    let list: Vec<_> = layout.all_stresses().collect();
    let elastic = solid.stiffness(layout.all_stresses());
    let plastic = tangent_stiffness(&elastic, &list, active).expect("associated");
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    let rates = |stiffness| layout.rates::<D>(stiffness, solid.density, inertia);
    // Normals that nearly agree magnify the rounding of the tangent stiffness by the inverse of the smallest eigenvalue
    // of their scaled products nᵀDn.
    let values = elastic.map(|entry| entry.value);
    let normals = DMatrix::from_fn(list.len(), active.len(), |row, a| {
        list[row].derivative(&active[a].normal)
    });
    let products = normals.transpose() * &values * &normals;
    let scaled = DMatrix::from_fn(active.len(), active.len(), |a, b| {
        products[(a, b)] / (products[(a, a)] * products[(b, b)]).sqrt()
    });
    let least =
        scaled.symmetric_eigenvalues().iter().copied().filter(|&e| e > 1e-11).fold(1.0, f64::min);
    let tolerance = 1e-13 / least;
    assert_interlaced(
        &rates(&elastic),
        &rates(&plastic),
        random_unit_vector(random),
        active.len(),
        tolerance,
    );

    // Restriction to the tangent space of the active conditions, with the out-of-plane stresses as unknowns.
    let full = equations_with_out_of_plane_stresses::<D>(solid);
    let form = full.symmetric_form().expect("elastic");
    let nv = full.velocity_count();
    let normals: Vec<DVector<f64>> = active
        .iter()
        .map(|condition| {
            let of = |row: usize| match row.checked_sub(nv) {
                None => 0.0,
                Some(s) => list[s].derivative(&condition.normal),
            };
            DVector::from_fn(nv + list.len(), |row, _| of(row))
        })
        .collect();
    let restricted = form.restrict(&tangent_basis(nv + list.len(), &normals));
    let k = random.log_uniform(0.1, 10.0);
    let wave = random_unit_vector::<D>(random).map(|n| k * n);
    let (found, bound) = growth_and_bound(&restricted, wave);
    worst[0] = worst[0].max(found);
    worst[1] = worst[1].max(bound);

    // The restricted equations and those with the tangent stiffness have the same largest frequency.
    if random.bernoulli(0.05) {
        let length = wave.iter().map(|x| x * x).sum::<f64>().sqrt();
        let families =
            DirectionalWaves::from_equations(&rates(&plastic), wave.map(|x| x / length)).families;
        let greatest = families
            .iter()
            .flat_map(|f| f.squared_frequencies(length))
            .map(|w| w.re)
            .fold(0.0, f64::max);
        let factor = restricted.a.clone().try_inverse().expect("definite");
        let mut symbol = (&factor * &restricted.q).map(|x| Complex64::new(x, 0.0));
        for (b, component) in restricted.b.iter().zip(wave) {
            symbol += (&factor * b).map(|x| Complex64::new(0.0, component * x));
        }
        let roots = symbol.schur().unpack().1.diagonal();
        let fastest = roots.iter().map(|r| r.im * r.im).fold(0.0, f64::max);
        assert!((fastest / greatest - 1.0).abs() < 1e-10, "{fastest} {greatest}");
    }
}

/// Verifies that plastic flow of the background damps waves if it is associated: no root has Re ς > 0, and some decay.
#[test]
fn associated_flow_of_the_background_damps_waves() {
    let random = &mut seeded_generator(23);
    let [mut greatest, mut least] = [f64::NEG_INFINITY, 0.0f64];
    for index in 0..600 {
        let solid = random_solid_of_order_one(random, THEORIES[index % 3]);
        let layout = solid.layout::<3>().with_out_of_plane();
        let list: Vec<_> = layout.all_stresses().collect();
        let friction = random.uniform(0.0, 1.0);
        let (set, stress, condition) = random_mises_condition(random, friction, friction);
        let form = {
            let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
            let mut rates: RateEquations<3> =
                layout.rates(&solid.stiffness(layout.all_stresses()), 1.0, inertia);
            let rate = random.log_uniform(0.01, 10.0);
            let curvature = set.curvature(&stress, &list).expect("off the axis") * rate;
            rates.relaxation = curvature.map(models::Rounded::from_rounded);
            rates.symmetric_form().expect("elastic")
        };
        let nv = solid.layout::<3>().velocities.len();
        let normal = DVector::from_fn(nv + list.len(), |row, _| {
            row.checked_sub(nv).map_or(0.0, |s| list[s].derivative(&condition.normal))
        });
        let restricted = form.restrict(&tangent_basis(nv + list.len(), &[normal]));
        let k = random.log_uniform(0.1, 10.0);
        let wave = random_unit_vector::<3>(random).map(|n| k * n);
        let (found, _) = growth_and_bound(&restricted, wave);
        greatest = greatest.max(found);
        let (decay, _) = growth_and_bound(&reverse_time(&restricted), wave.map(|x| -x));
        least = least.max(decay);
    }
    println!("greatest Re ς {greatest:e}, fastest decay {least:e}");
    assert!(greatest < 1e-13);
    assert!(least > 1e-3);
}

#[test]
#[ignore = "takes ten seconds"]
fn many_associated_yielding_solids_keep_growth_at_rounding_level() {
    check_associated_yielding(10_000);
}
