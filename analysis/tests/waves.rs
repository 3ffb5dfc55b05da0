//! Plane waves of elastic and yielding solids against closed forms, and against the first-order
//! equations.

mod support;

use models::LinearisedSystem;
use models::common::rates::{RateEquations, SymmetricForm};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{ActiveCondition, Interlayer, InterlayerCouple, Mises};
use models::yield_set::tangent::tangent;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};
use support::slipping::Slipping;
use support::states::{Random, seeded};
use wellposed_analysis::energy::energy;
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::{Pencil, Roots};
use wellposed_analysis::waves::{Polarisation, Waves, plane_waves, roots, squared_speeds};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Classical,
    Reduced,
    Cosserat,
}

const KINDS: [Kind; 3] = [Kind::Classical, Kind::Reduced, Kind::Cosserat];

/// Moduli of order one to each other, λ negative at times.
fn solid(random: &mut Random, kind: Kind) -> Isotropic {
    let mu = random.decades(1e-3, 1e10);
    let density = random.decades(0.1, 1e4);
    let lambda = mu * random.within(-0.6, 3.0);
    let couple = (kind == Kind::Cosserat).then(|| {
        let gamma = mu * random.decades(1e-8, 1e-2);
        let eta = gamma * random.decades(0.05, 5.0);
        CoupleModuli { beta: gamma * random.within(-0.6, 3.0), gamma, eta }
    });
    let microrotation = (kind != Kind::Classical).then(|| Microrotation {
        alpha: mu * random.decades(0.01, 3.0),
        inertia: density * random.decades(1e-6, 1.0),
        couple,
    });
    Isotropic::new(lambda, mu, density, microrotation).expect("sound moduli")
}

fn unit<const D: usize>(random: &mut Random) -> [f64; D] {
    loop {
        let v: [f64; D] = std::array::from_fn(|_| random.within(-1.0, 1.0));
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (0.1..1.0).contains(&length) {
            return v.map(|x| x / length);
        }
    }
}

/// The characteristic speeds squared that an isotropic solid has, descending.
fn expected(solid: &Isotropic, dimensions: usize) -> Vec<f64> {
    let speeds = solid.speeds();
    let across = dimensions - 1;
    let mut all = vec![speeds.longitudinal];
    all.extend(vec![speeds.shear; across]);
    let spins = if solid.microrotation.is_none() { 0 } else { dimensions * (dimensions - 1) / 2 };
    let torsions = usize::from(spins == 3);
    all.extend(vec![speeds.torsion.unwrap_or(0.0); torsions]);
    all.extend(vec![speeds.rotation.unwrap_or(0.0); spins - torsions]);
    all.sort_by(|a, b| b.total_cmp(a));
    all.into_iter().map(|c| c * c).collect()
}

fn speeds_agree<const D: usize>(random: &mut Random, solid: &Isotropic) -> f64 {
    let found = squared_speeds(&solid.rates::<D>(), unit::<D>(random));
    let expected = expected(solid, D);
    assert_eq!(found.len(), expected.len());
    let error = |(found, expected): (&Complex64, &f64)| match *expected {
        // Nothing is gained from a relative error of zero.
        0.0 => found.norm() / solid.speeds().shear.powi(2),
        // Of the speed, half that of its square.
        square => 0.5 * (found - square).norm() / square,
    };
    found.iter().zip(&expected).map(error).fold(0.0, f64::max)
}

#[test]
fn characteristic_speeds_are_the_closed_forms() {
    let random = &mut seeded(1);
    for kind in KINDS {
        let mut worst = [0.0f64; 2];
        for _ in 0..1500 {
            let solid = solid(random, kind);
            worst[0] = worst[0].max(speeds_agree::<2>(random, &solid));
            worst[1] = worst[1].max(speeds_agree::<3>(random, &solid));
        }
        println!("plane, space: {worst:?}");
        assert!(worst.iter().all(|&w| w < 1e-13), "{worst:?}");
    }
}

/// The medium of the unit test `HomogeneousIsotropicCosseratDomain` of SPECFEM++ (Princeton).
fn specfem() -> Isotropic {
    let couple = Some(CoupleModuli { beta: 7.75e8, gamma: 1.5e8, eta: 3e8 });
    let microrotation = Microrotation { alpha: 1.005e9, inertia: 2700.0, couple };
    Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(microrotation)).expect("sound moduli")
}

#[test]
fn the_specfem_medium() {
    let equations = specfem().rates::<3>();
    let speeds: Vec<f64> =
        squared_speeds(&equations, unit(&mut seeded(2))).iter().map(|c| c.re.sqrt()).collect();
    // As published, to half a unit of the last digit given.
    let published = [3000.0, 1836.361, 1836.361, 630.990, 408.248, 408.248];
    for (found, published) in speeds.iter().zip(published) {
        assert!((found - published).abs() <= 0.5e-3, "{found} {published}");
    }
    let waves = Waves::along(&equations, [0.0, 0.6, 0.8]);
    for family in &waves.families {
        let cut_off = family.squared_cut_offs().last().expect("a branch").re.sqrt() / (2.0 * PI);
        match family.polarisation {
            Polarisation::Longitudinal => assert_eq!(cut_off, 0.0),
            _ => assert!((cut_off - 194.2009).abs() <= 0.5e-4, "{cut_off}"),
        }
    }
    // Long shear waves are those of the classical solid: 1732.05 m/s.
    let slowest = waves.families.iter().map(|f| f.squared_frequencies(1e-4)[0].re.sqrt() / 1e-4);
    let shear = slowest.fold(f64::INFINITY, f64::min);
    assert!((shear - 1732.05).abs() < 0.5e-2, "{shear}");
}

#[test]
fn natural_rotation_and_the_forbidden_band_of_the_reduced_solid() {
    let random = &mut seeded(3);
    let mut worst = 0.0f64;
    for index in 0..2000 {
        let kind = if index % 2 == 0 { Kind::Reduced } else { Kind::Cosserat };
        let solid = solid(random, kind);
        let rotation = solid.microrotation.expect("not classical");
        let natural = rotation.natural_frequency();
        let families = if random.chance(0.5) {
            Waves::along(&solid.rates::<2>(), unit(random)).families
        } else {
            Waves::along(&solid.rates::<3>(), unit(random)).families
        };
        let transverse: Vec<_> =
            families.iter().filter(|f| f.polarisation == Polarisation::Transverse).collect();
        assert!(!transverse.is_empty());
        for family in transverse {
            let cut_off = family.squared_cut_offs()[1].re.sqrt();
            worst = worst.max((cut_off / natural - 1.0).abs());
            let bands = family.forbidden_bands();
            if kind == Kind::Cosserat {
                assert!(bands.is_empty(), "{bands:?}");
                continue;
            }
            // ω₁² = ω₀²/(1 + α/μ) < ω² < ω₀² = 4α/j.
            let lower = natural / (1.0 + rotation.alpha / solid.mu).sqrt();
            assert_eq!(bands.len(), 1, "{bands:?}");
            worst = worst.max((bands[0].from / lower - 1.0).abs());
            worst = worst.max((bands[0].to / natural - 1.0).abs());
        }
    }
    println!("worst relative error {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// k² = ρω²(4α − jω²)/(4αμ − (μ + α)jω²) for transverse waves of the reduced solid, exactly.
#[test]
fn dispersion_of_the_reduced_solid() {
    let random = &mut seeded(4);
    for _ in 0..500 {
        let solid = solid(random, Kind::Reduced);
        let Microrotation { alpha, inertia, .. } = solid.microrotation.expect("reduced");
        let (mu, density) = (solid.mu, solid.density);
        let k = random.decades(0.05, 20.0) * (4.0 * alpha / inertia).sqrt() / solid.speeds().shear;
        for family in Waves::along(&solid.rates::<3>(), unit(random)).families {
            if family.polarisation != Polarisation::Transverse {
                continue;
            }
            for mode in family.modes(k) {
                let square = mode.squared_frequency.re;
                // Without denominators; relative to the greatest term.
                let left = k * k * (4.0 * alpha * mu - (mu + alpha) * inertia * square);
                let right = density * square * (4.0 * alpha - inertia * square);
                let size = density * inertia * square * square
                    + 4.0 * alpha * density * square
                    + k * k * (4.0 * alpha * mu + (mu + alpha) * inertia * square);
                assert!((left - right).abs() < 1e-13 * size, "{left} {right} {size}");
            }
        }
    }
}

#[test]
fn long_waves_are_those_of_the_classical_solid() {
    let random = &mut seeded(5);
    for kind in KINDS {
        for _ in 0..200 {
            let solid = solid(random, kind);
            let length = match solid.microrotation {
                None => 1.0,
                Some(m) => solid.speeds().shear / m.natural_frequency(),
            };
            // α > μ/100 and couple stress of any size: corrections are of order k² times lengths².
            let couple = solid.couple().map_or(0.0, |c| ((c.gamma + c.eta) / solid.mu).sqrt());
            let k = 1e-5 / length.max(couple);
            let shear = solid.mu / solid.density;
            let families = Waves::along(&solid.rates::<3>(), unit(random)).families;
            let transverse = families.iter().filter(|f| f.polarisation == Polarisation::Transverse);
            for family in transverse {
                let mode = family.modes(k)[0];
                let phase = mode.squared_frequency.re / (k * k);
                // The eigenvalue k²μ/ρ stands beside ω*² ≥ 4e-2 ω... : its rounding, over k², and
                // the correction of order (k × length)² ≤ 1e-10.
                let cut_off = solid.microrotation.map_or(0.0, |m| m.natural_frequency());
                let rounding = 1e-15 * (cut_off / k).powi(2) / shear;
                let tolerance = 1e-8 + 10.0 * rounding;
                assert!((phase / shear - 1.0).abs() < tolerance, "{} {tolerance:e}", phase / shear);
            }
        }
    }
}

#[test]
fn isotropic_solids_are_isotropic() {
    let random = &mut seeded(6);
    for kind in KINDS {
        for _ in 0..300 {
            let solid = solid(random, kind);
            let equations = solid.rates::<3>();
            let k = random.decades(0.1, 10.0)
                * solid.microrotation.map_or(1.0, |m| m.natural_frequency() / solid.speeds().shear);
            let frequencies = |normal: [f64; 3]| {
                let families = Waves::along(&equations, normal).families;
                let mut all: Vec<f64> =
                    families.iter().flat_map(|f| f.squared_frequencies(k)).map(|w| w.re).collect();
                all.sort_by(f64::total_cmp);
                all
            };
            let (one, other) = (frequencies(unit(random)), frequencies(unit(random)));
            let largest = one[one.len() - 1];
            for (a, b) in one.iter().zip(&other) {
                assert!((a - b).abs() < 1e-13 * largest, "{one:?} {other:?}");
            }
        }
    }
}

#[test]
fn group_speeds_are_slopes() {
    let random = &mut seeded(7);
    for _ in 0..300 {
        let solid = solid(random, Kind::Cosserat);
        let k0 = solid.microrotation.expect("Cosserat").natural_frequency() / solid.speeds().shear;
        let k = k0 * random.decades(0.1, 10.0);
        for family in Waves::along(&solid.rates::<3>(), unit(random)).families {
            let step = 1e-4 * k;
            let [before, after] = [k - step, k + step].map(|k| family.squared_frequencies(k));
            for (i, mode) in family.modes(k).iter().enumerate() {
                let slope = (after[i] - before[i]).re / (2.0 * step);
                // Differences of fourth powers of k: 1e-8 of the largest slope.
                let size = after.iter().map(|w| w.re).fold(0.0, f64::max) / k;
                assert!((mode.slope.re - slope).abs() < 1e-6 * size, "{} {slope}", mode.slope.re);
            }
        }
    }
}

/// The plane waves, and the roots of the first-order equations by generalised eigenvalues.
#[test]
fn waves_agree_with_the_pencil() {
    let random = &mut seeded(8);
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    for index in 0..300 {
        let solid = solid(random, KINDS[index % 3]);
        let layout = solid.layout::<2>();
        let list: Vec<_> = layout.all_stresses().collect();
        let elastic = solid.stiffness(layout.all_stresses());
        let friction = random.within(0.1, 0.8);
        let set = YieldSet::from(Mises::drucker_prager(1.0, friction, friction));
        let active = set.active(&on_yield(random, &set, false), 1e-9);
        let plastic = tangent(&elastic, &list, &active).expect("associated");
        for stiffness in [elastic, plastic] {
            let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
            let equations: RateEquations<2> = layout.rates(&stiffness, solid.density, inertia);
            equations.linearise(&mut system);
            pencil.update(&system).expect("finite");
            let k0 =
                solid.microrotation.map_or(1.0, |m| m.natural_frequency() / solid.speeds().shear);
            let (k, direction) = (k0 * random.decades(0.3, 3.0), random.within(0.0, PI));
            let Roots::Regular { finite, .. } = pencil.roots(k, direction) else {
                panic!("a regular system")
            };
            let families = Waves::along(&equations, [direction.cos(), direction.sin()]).families;
            let mut expected: Vec<f64> =
                families.iter().flat_map(|f| f.squared_frequencies(k)).map(|w| w.re).collect();
            // The first-order system has as many zero roots as it has more stresses.
            expected.extend(vec![0.0; equations.stresses() - equations.velocities()]);
            let mut found: Vec<f64> =
                finite.iter().filter(|r| r.im >= 0.0).map(|r| r.im * r.im).collect();
            let largest = expected.iter().copied().fold(0.0, f64::max);
            // Every ω² that is not zero within rounding is met by a pair ±iω.
            found.sort_by(f64::total_cmp);
            for e in expected.iter().filter(|&&e| e > 1e-6 * largest) {
                let nearest = found.iter().map(|f| (f - e).abs()).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-9 * largest, "{e} not among {found:?}");
            }
        }
    }
}

/// A random stress on the surface of a set, by scaling from zero; with `corners` half of the stresses
/// lie on an edge of the interlayer set.
fn on_yield(random: &mut Random, set: &YieldSet, corners: bool) -> Stress {
    loop {
        let mut stress = Stress::default();
        for i in 0..3 {
            for j in 0..3 {
                stress.force[i][j] = random.within(-1.0, 1.0);
                stress.couple[i][j] = random.within(-1.0, 1.0);
            }
        }
        let scaled = |factor: f64| Stress {
            force: stress.force.map(|row| row.map(|x| factor * x)),
            couple: stress.couple.map(|row| row.map(|x| factor * x)),
        };
        let (mut low, mut high) = (0.0, 1.0);
        while set.value(&scaled(high)) < 0.0 && high < 1e6 {
            high *= 2.0;
        }
        if high >= 1e6 {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if set.value(&scaled(middle)) < 0.0 { low = middle } else { high = middle }
        }
        let mut stress = scaled(high);
        if let (Some(set), true) = (set.downcast::<Interlayer>(), corners && random.chance(0.5)) {
            // Slip of both layers, and of what else is at hand.
            stress.force[1][0] = set.shear_strength - set.shear_friction * stress.force[0][0];
            stress.force[0][1] = set.shear_friction * stress.force[1][1] - set.shear_strength;
            if let (Some(couple), true) = (set.couple, random.chance(0.5)) {
                stress.couple[2][0] = couple.strength - couple.friction * stress.force[0][0];
            }
            if YieldSet::from(*set).value(&stress) > 1e-9 {
                continue;
            }
        }
        return stress;
    }
}

/// An orthonormal basis of {U : n·U = 0 for all normals}.
fn tangent_basis(size: usize, normals: &[DVector<f64>]) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let orthogonal = |columns: &[DVector<f64>], v: &DVector<f64>| {
        let mut v = v.clone();
        // Twice is enough (Kahan).
        for _ in 0..2 {
            for c in columns {
                v -= c * c.dot(&v);
            }
        }
        v
    };
    for normal in normals {
        let rest = orthogonal(&columns, normal);
        if rest.norm() > 1e-9 * normal.norm() {
            columns.push(rest.normalize());
        }
    }
    let rank = columns.len();
    for i in 0..size {
        let rest = orthogonal(&columns, &DVector::from_fn(size, |r, _| f64::from(r == i)));
        if rest.norm() > 1e-6 {
            columns.push(rest.normalize());
        }
    }
    assert_eq!(columns.len(), size);
    DMatrix::from_columns(&columns[rank..])
}

/// Growth of a symmetric-hyperbolic system at ik = iκ, computed, not assumed: with A = LLᵀ the roots
/// are those of L⁻¹(iΣκᵢBⁱ + Q)L⁻ᵀ, whose Hermitian part bounds every Re ς; and the roots themselves.
fn growth<const D: usize>(form: &SymmetricForm<D>, wave: [f64; D]) -> (f64, f64) {
    let factor = form.a.clone().cholesky().expect("positive definite");
    let half = |m: &DMatrix<f64>| {
        let left = factor.l().solve_lower_triangular(m).expect("regular");
        factor.l().solve_lower_triangular(&left.transpose()).expect("regular").transpose()
    };
    let mut k = half(&form.q).map(|x| Complex64::new(x, 0.0));
    for (b, component) in form.b.iter().zip(wave) {
        k += half(b).map(|x| Complex64::new(0.0, component * x));
    }
    let size = k.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let hermitian = (&k + k.adjoint()).scale(0.5);
    let bound = hermitian.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let roots = k.schur().unpack().1.diagonal();
    (roots.iter().map(|r| r.re).fold(f64::NEG_INFINITY, f64::max) / size, bound / size)
}

/// Elastic and yielding squared speeds, descending, along `normal`.
fn interlaced<const D: usize>(
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
    let random = &mut seeded(9);
    let mut worst = [0.0f64; 2];
    let mut corners = [0usize; 5];
    for index in 0..10_000 {
        let kind = KINDS[index % 3];
        let mut solid = solid(random, kind);
        // Stresses of order one.
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
        let friction = random.within(0.0, 0.9);
        let with_couple = kind == Kind::Cosserat;
        let set = match index / 3 % 4 {
            0 | 1 => {
                let couple = with_couple.then(|| {
                    let friction = random.within(0.0, 0.5);
                    InterlayerCouple {
                        strength: random.within(0.1, 1.0),
                        friction,
                        dilatancy: friction,
                    }
                });
                YieldSet::from(Interlayer {
                    shear_strength: random.within(0.1, 1.0),
                    shear_friction: friction,
                    shear_dilatancy: friction,
                    couple,
                })
            }
            2 => YieldSet::from(Mises::drucker_prager(1.0, friction, friction)),
            _ => YieldSet::from(Mises {
                antisymmetric_weight: random.within(0.0, 2.0),
                symmetric_length: with_couple.then_some(1.0),
                antisymmetric_length: with_couple.then_some(2.0),
                ..Mises::von_mises(1.0)
            }),
        };
        let is_interlayer = set.half_spaces().is_some();
        let stress = on_yield(random, &set, true);
        let active = set.active(&stress, 1e-9);
        assert!(!active.is_empty());
        corners[active.len()] += 1;
        if is_interlayer || random.chance(0.5) {
            yielding::<2>(random, &solid, &active, &mut worst);
        } else {
            yielding::<3>(random, &solid, &active, &mut worst);
        }
    }
    println!("max Re ς, Hermitian part, over the largest entry: {worst:?}; conditions {corners:?}");
    // Entries of 24 × 24 matrices of order one, one hundred times their rounding.
    assert!(worst[0] < 3e-14 && worst[1] < 3e-14, "{worst:?}");
    assert!(corners[2] > 500 && corners[3] > 100, "{corners:?}");
}

fn yielding<const D: usize>(
    random: &mut Random,
    solid: &Isotropic,
    active: &[ActiveCondition],
    worst: &mut [f64; 2],
) {
    let layout = solid.layout::<D>();
    let list: Vec<_> = layout.all_stresses().collect();
    let elastic = solid.stiffness(layout.all_stresses());
    let plastic = tangent(&elastic, &list, active).expect("associated");
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    let rates = |stiffness| layout.rates::<D>(stiffness, solid.density, inertia);
    // Normals that nearly agree magnify the rounding of the tangent stiffness by the inverse of the
    // least eigenvalue of their scaled products nᵀDn.
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
    interlaced(&rates(&elastic), &rates(&plastic), unit(random), active.len(), tolerance);

    // The restriction, with the carried stresses as unknowns of their own.
    let full = carried_too::<D>(solid);
    let form = full.symmetric().expect("elastic");
    let nv = full.velocities();
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
    let restricted = form.restricted(&tangent_basis(nv + list.len(), &normals));
    let k = random.decades(0.1, 10.0);
    let wave = unit::<D>(random).map(|n| k * n);
    let (found, bound) = growth(&restricted, wave);
    worst[0] = worst[0].max(found);
    worst[1] = worst[1].max(bound);

    // The roots of the restriction are those of the tangent stiffness.
    if random.chance(0.05) {
        let length = wave.iter().map(|x| x * x).sum::<f64>().sqrt();
        let families = Waves::along(&rates(&plastic), wave.map(|x| x / length)).families;
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

/// The rate equations with the carried stresses among the unknowns.
fn carried_too<const D: usize>(solid: &Isotropic) -> RateEquations<D> {
    let layout = solid.layout::<D>().carrying();
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    layout.rates(&solid.stiffness(layout.all_stresses()), solid.density, inertia)
}

/// A Cosserat solid of order one in plane strain while it yields, and the set's friction and dilatancy.
fn plane_yielding(random: &mut Random, dilatancy: impl Fn(f64) -> f64) -> RateEquations<2> {
    loop {
        let solid = solid_of_order_one(random, Kind::Cosserat);
        let layout = solid.layout::<2>();
        let list: Vec<_> = layout.all_stresses().collect();
        let friction = random.within(0.0, 1.0);
        let set = Mises {
            antisymmetric_weight: random.within(0.2, 2.0),
            symmetric_length: Some(0.8),
            antisymmetric_length: Some(0.6),
            ..Mises::drucker_prager(1.0, friction, dilatancy(friction))
        };
        let stress = on_yield(random, &YieldSet::from(set), false);
        let condition = set.condition(&stress).expect("off the axis");
        let stiffness = tangent(&solid.stiffness(layout.all_stresses()), &list, &[condition]);
        if let (Ok(stiffness), Some(rotation)) = (stiffness, solid.microrotation) {
            return layout.rates(&stiffness, 1.0, rotation.inertia);
        }
    }
}

/// No wave has a frequency in a forbidden band, and waves come close to its ends: shear waves of laws
/// that are positive but otherwise arbitrary.
#[test]
fn forbidden_bands_hold_no_wave() {
    let random = &mut seeded(37);
    let mut bands = 0;
    for _ in 0..400 {
        let mut equations = solid_of_order_one(random, Kind::Reduced).rates::<2>();
        let root = DMatrix::from_fn(2, 2, |_, _| random.within(-1.0, 1.0));
        let law = &root * root.transpose();
        // σ21 and σ12.
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            equations.stiffness[(2 + i, 2 + j)] = models::Rounded::given(law[(i, j)]);
        }
        for family in Waves::along(&equations, [1.0, 0.0]).families {
            let numbers = (0..1650).map(|i| 1e-4 * 1.008f64.powi(i));
            let waves: Vec<f64> = numbers
                .flat_map(|k| family.squared_frequencies(k))
                .map(|square| square.re.max(0.0).sqrt())
                .collect();
            for band in family.forbidden_bands() {
                bands += 1;
                let tolerance = 1e-9 * (1.0 + band.from);
                let is_inside = |&&w: &&f64| w > band.from + tolerance && w < band.to - tolerance;
                assert_eq!(waves.iter().find(is_inside), None, "{band:?}");
                for end in [band.from, band.to].into_iter().filter(|&e| e > 0.0 && e.is_finite()) {
                    let near = waves.iter().map(|w| (w - end).abs()).fold(f64::INFINITY, f64::min);
                    assert!(near < 0.05 * end, "{end} of {band:?} is {near} away from waves");
                }
            }
        }
    }
    assert!(bands > 300, "{bands}");
}

/// Slopes of complex branches against differences of the roots of the first-order equations.
#[test]
fn slopes_of_complex_branches() {
    let random = &mut seeded(41);
    let (mut complex, mut worst) = (0, 0.0f64);
    for _ in 0..400 {
        let equations = plane_yielding(random, |friction| friction - 0.9);
        let angle = random.within(0.0, PI);
        let normal = [angle.cos(), angle.sin()];
        let k = random.decades(0.3, 30.0);
        let step = 1e-4 * k;
        let squares = |k: f64| -> Vec<Complex64> {
            roots(&equations, normal, k).iter().map(|root| -(root * root)).collect()
        };
        let (before, after) = (squares(k - step), squares(k + step));
        for family in Waves::along(&equations, normal).families {
            let modes = family.modes(k);
            for mode in &modes {
                let size = mode.squared_frequency.norm();
                let others =
                    modes.iter().map(|m| (m.squared_frequency - mode.squared_frequency).norm());
                // Alone, and not at rest.
                if size < 1e-3 * k * k || others.filter(|&d| d < 0.2 * size).count() > 1 {
                    continue;
                }
                let nearest = |list: &[Complex64], guess: Complex64| {
                    let distance = |z: &&Complex64| (**z - guess).norm();
                    list.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied()
                };
                let ahead = mode.squared_frequency + mode.slope * step;
                let behind = mode.squared_frequency - mode.slope * step;
                let (Some(b), Some(a)) = (nearest(&before, behind), nearest(&after, ahead)) else {
                    continue;
                };
                let slope = (a - b) / (2.0 * step);
                worst = worst.max((slope - mode.slope).norm() * k / size);
                complex += u32::from(mode.squared_frequency.im.abs() > 1e-3 * size);
            }
        }
    }
    println!("{complex} complex, {worst:e}");
    assert!(complex > 20, "{complex}");
    assert!(worst < 1e-5);
}

/// Plastic flow of the background damps waves where the flow is associated: no root has Re ς > 0, and
/// some decay.
#[test]
fn flow_of_the_background_damps() {
    let random = &mut seeded(23);
    let [mut greatest, mut least] = [f64::NEG_INFINITY, 0.0f64];
    for index in 0..600 {
        let solid = solid_of_order_one(random, KINDS[index % 3]);
        let layout = solid.layout::<3>().carrying();
        let list: Vec<_> = layout.all_stresses().collect();
        let friction = random.within(0.0, 1.0);
        let set = Mises {
            antisymmetric_weight: random.within(0.2, 2.0),
            symmetric_length: Some(0.8),
            antisymmetric_length: Some(0.6),
            ..Mises::drucker_prager(1.0, friction, friction)
        };
        let stress = on_yield(random, &YieldSet::from(set), false);
        let condition = set.condition(&stress).expect("off the axis");
        let form = {
            let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
            let mut rates: RateEquations<3> =
                layout.rates(&solid.stiffness(layout.all_stresses()), 1.0, inertia);
            let rate = random.decades(0.01, 10.0);
            let curvature = set.curvature(&stress, &list).expect("off the axis") * rate;
            rates.relaxation = curvature.map(models::Rounded::given);
            rates.symmetric().expect("elastic")
        };
        let nv = solid.layout::<3>().velocities.len();
        let normal = DVector::from_fn(nv + list.len(), |row, _| {
            row.checked_sub(nv).map_or(0.0, |s| list[s].derivative(&condition.normal))
        });
        let restricted = form.restricted(&tangent_basis(nv + list.len(), &[normal]));
        let k = random.decades(0.1, 10.0);
        let wave = unit::<3>(random).map(|n| k * n);
        let (found, _) = growth(&restricted, wave);
        greatest = greatest.max(found);
        let (decay, _) = growth(&negative(&restricted), wave.map(|x| -x));
        least = least.max(decay);
    }
    println!("greatest Re ς {greatest:e}, fastest decay {least:e}");
    assert!(greatest < 1e-13);
    assert!(least > 1e-3);
}

/// The equations backwards in time.
fn negative<const D: usize>(form: &SymmetricForm<D>) -> SymmetricForm<D> {
    SymmetricForm { a: form.a.clone(), b: form.b.each_ref().map(|b| -b), q: -&form.q }
}

/// Moduli and densities of order one.
fn solid_of_order_one(random: &mut Random, kind: Kind) -> Isotropic {
    let couple = (kind == Kind::Cosserat).then(|| CoupleModuli {
        beta: random.within(-0.3, 1.0),
        gamma: random.within(0.5, 1.5),
        eta: random.within(0.5, 1.5),
    });
    let microrotation = (kind != Kind::Classical).then(|| Microrotation {
        alpha: random.within(0.2, 2.0),
        inertia: random.within(0.3, 2.0),
        couple,
    });
    Isotropic::new(random.within(-0.5, 2.0), 1.0, 1.0, microrotation).expect("sound moduli")
}

/// Roots of the first-order equations with relaxation: those of the linearised system that the analysis
/// takes are those of the restricted form, decay included.
#[test]
fn relaxation_reaches_the_linearised_system() {
    let random = &mut seeded(29);
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    for index in 0..40 {
        // Five, six and eight equations: within the exact polynomial's reach.
        let solid = solid_of_order_one(random, KINDS[index % 2]);
        let layout = solid.layout::<2>().carrying();
        let list: Vec<_> = layout.all_stresses().collect();
        let set = Mises { antisymmetric_weight: 0.7, ..Mises::drucker_prager(1.0, 0.4, 0.4) };
        let stress = on_yield(random, &YieldSet::from(set), false);
        let condition = set.condition(&stress).expect("off the axis");
        let stiffness = solid.stiffness(layout.all_stresses());
        let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
        let curvature = set.curvature(&stress, &list).expect("off the axis") * 0.8;
        let relaxation = curvature.map(models::Rounded::given);
        let plastic = tangent(&stiffness, &list, &[condition]).expect("response");
        let rates = |stiffness| RateEquations::<2> {
            relaxation: relaxation.clone(),
            ..layout.rates(stiffness, 1.0, inertia)
        };
        rates(&plastic).linearise(&mut system);
        pencil.update(&system).expect("finite");
        let (k, angle) = (random.decades(0.3, 3.0), random.within(0.0, PI));
        let Roots::Regular { finite, .. } = pencil.roots(k, angle) else { panic!("regular") };

        let nv = solid.layout::<2>().velocities.len();
        let normal = DVector::from_fn(nv + list.len(), |row, _| {
            row.checked_sub(nv).map_or(0.0, |s| list[s].derivative(&condition.normal))
        });
        let restricted = rates(&stiffness)
            .symmetric()
            .expect("elastic")
            .restricted(&tangent_basis(nv + list.len(), &[normal]));
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

fn is_ill_posed(equations: &RateEquations<2>) -> bool {
    let (mut system, mut pencil) = (LinearisedSystem::default(), Pencil::default());
    equations.linearise(&mut system);
    pencil.update(&system).expect("finite");
    matches!(assess(&pencil).verdict, Verdict::IllPosed { .. })
}

/// The dilatancy between `low` and `high` at which `holds` changes.
fn onset(holds: impl Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    let at_low = holds(low);
    assert_ne!(at_low, holds(high));
    for _ in 0..45 {
        let middle = 0.5 * (low + high);
        if holds(middle) == at_low { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Least value over directions, by golden section from the best of many.
fn least(f: impl Fn(f64) -> f64) -> f64 {
    let steps = 720;
    let step = PI / f64::from(steps);
    let start = (0..steps)
        .map(|i| (f64::from(i) + 0.5) * step)
        .min_by(|&x, &y| f(x).total_cmp(&f(y)))
        .expect("some");
    let (mut low, mut high) = (start - step, start + step);
    for _ in 0..100 {
        let (x, y) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if f(x) < f(y) { high = y } else { low = x }
    }
    f(0.5 * (low + high))
}

#[test]
fn flutter_sets_in_where_the_discriminant_vanishes() {
    for (lambda, alpha, friction) in [(1.0, 0.3, 0.6), (1.0, 0.3, 0.9), (3.0, 0.3, 0.9)] {
        let with = |dilatancy| Slipping { lambda, alpha, friction, dilatancy };
        // Associated flow is well-posed, flow without dilatancy is not.
        let by_verdict = onset(|x| is_ill_posed(&with(x).equations()), 0.0, friction);
        let discriminant = |x: f64| {
            least(|angle| {
                let [trace, determinant] = with(x).invariants(angle);
                trace * trace - 4.0 * determinant
            })
        };
        let by_discriminant = onset(|x| discriminant(x) < 0.0, 0.0, friction);
        println!("flutter below the dilatancy {by_verdict}, by the discriminant {by_discriminant}");
        assert!((by_verdict - by_discriminant).abs() < 1e-8);
    }
    // Just outside no speed is complex; without dilatancy some are, around 45°.
    let complex = |dilatancy: f64| {
        let with = Slipping { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy };
        (0..1800).map(|i| f64::from(i) * PI / 1800.0).filter(move |&angle| {
            squared_speeds(&with.equations(), [angle.cos(), angle.sin()])[0].im.abs() > 1e-6
        })
    };
    assert_eq!(complex(0.297).count(), 0);
    assert!(complex(0.0).any(|angle| (angle - 0.25 * PI).abs() < 0.02));
    assert!(complex(0.0).all(|angle| angle < FRAC_PI_2));
}

/// Along the layer's normal one speed is zero whatever the dilatancy: slip, not a loss of
/// well-posedness. Elsewhere det Γ, over the square of the sine that this zero leaves, tells where
/// a speed vanishes: a stationary discontinuity.
#[test]
fn a_speed_vanishes_where_the_determinant_does() {
    for (lambda, alpha, friction) in [(0.0, 0.1, 1.5), (0.0, 0.1, 2.0), (0.2, 0.05, 1.6)] {
        let with = |dilatancy| Slipping { lambda, alpha, friction, dilatancy };
        for dilatancy in [0.0, 0.5 * friction, friction] {
            let along = squared_speeds(&with(dilatancy).equations(), [1.0, 0.0]);
            assert!(along[along.len() - 1].norm() < 1e-15);
        }
        let by_verdict = onset(|x| is_ill_posed(&with(x).equations()), 0.0, friction);
        let determinant =
            |x: f64| least(|angle| with(x).invariants(angle)[1] / angle.sin().powi(2));
        let by_determinant = onset(|x| determinant(x) < 0.0, 0.0, friction);
        println!(
            "zero speed below the dilatancy {by_verdict}, by the determinant {by_determinant}"
        );
        assert!((by_verdict - by_determinant).abs() < 1e-8);
    }
}

/// What the symmetriser shows of sound solids, and that it shows what is wrong.
#[test]
fn energy_tells_sound_equations_from_others() {
    let random = &mut seeded(43);
    for index in 0..60 {
        let solid = solid_of_order_one(random, KINDS[index % 3]);
        let sound = solid.rates::<3>();
        let found = energy(&sound, &sound, 1.0);
        assert!(found.definiteness > 1e-3, "{found:?}");
        assert!(found.asymmetry.max(found.antisymmetry) < 1e-14, "{found:?}");
        // Some thousand rotations of 24 rows.
        assert!(found.elastic_growth.max(found.growth) < 1e-12, "{found:?}");
        assert_eq!(found.zeros, sound.stresses() - sound.velocities());
        // A law that is not symmetric.
        let mut other = sound.clone();
        let moved = other.stiffness[(0, 1)] + models::Rounded::given(0.1);
        other.stiffness[(0, 1)] = moved;
        let found = energy(&other, &other, 1.0);
        assert!(found.asymmetry > 1e-3, "{found:?}");
    }
    // Slip with friction but without dilatancy.
    let slipping = Slipping { lambda: 1.0, alpha: 0.3, friction: 0.6, dilatancy: 0.0 };
    let elastic = Slipping { dilatancy: 0.6, ..slipping };
    let couple = Some(CoupleModuli { beta: 0.2, gamma: 0.4, eta: 0.3 });
    let rotation = Microrotation { alpha: 0.3, inertia: 1.0, couple };
    let solid = Isotropic::new(1.0, 1.0, 1.0, Some(rotation)).expect("sound moduli");
    let found = energy(&solid.rates::<2>(), &slipping.equations(), 1.0);
    assert!(found.growth > 1e-2, "{found:?}");
    let found = energy(&solid.rates::<2>(), &elastic.equations(), 1.0);
    assert!(found.growth < 1e-7, "{found:?}");
}

/// Plane waves solve the linearised equations, with the frequencies of their families.
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
        // (−iωA + iκB + C)û = 0.
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
