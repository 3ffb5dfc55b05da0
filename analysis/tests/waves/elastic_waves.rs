//! Speeds, dispersion and band gaps of elastic solids against closed forms.

use crate::support::states::{RandomNumbers, seeded_generator};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_analysis::waves::{DirectionalWaves, Polarisation, squared_speeds};

use super::random_solids::{THEORIES, random_solid, random_unit_vector};

/// Squared characteristic speeds of an isotropic solid in closed form, descending.
fn expected_squared_speeds(solid: &Isotropic, dimensions: usize) -> Vec<f64> {
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

fn max_speed_error<const D: usize>(random: &mut RandomNumbers, solid: &Isotropic) -> f64 {
    let found = squared_speeds(&solid.rates::<D>(), random_unit_vector::<D>(random));
    let expected = expected_squared_speeds(solid, D);
    assert_eq!(found.len(), expected.len());
    let error = |(found, expected): (&Complex64, &f64)| match *expected {
        // Error of a zero speed relative to the shear speed.
        0.0 => found.norm() / solid.speeds().shear.powi(2),
        // Relative error of the speed: half the relative error of its square.
        square => 0.5 * (found - square).norm() / square,
    };
    found.iter().zip(&expected).map(error).fold(0.0, f64::max)
}

#[test]
fn characteristic_speeds_agree_with_closed_forms() {
    let random = &mut seeded_generator(1);
    for theory in THEORIES {
        let mut worst = [0.0f64; 2];
        for _ in 0..1500 {
            let solid = random_solid(random, theory);
            worst[0] = worst[0].max(max_speed_error::<2>(random, &solid));
            worst[1] = worst[1].max(max_speed_error::<3>(random, &solid));
        }
        println!("plane, space: {worst:?}");
        assert!(worst.iter().all(|&w| w < 1e-13), "{worst:?}");
    }
}

/// The medium of the unit test `HomogeneousIsotropicCosseratDomain` of SPECFEM++ (Princeton).
fn specfem_medium() -> Isotropic {
    let couple = Some(CoupleModuli { beta: 7.75e8, gamma: 1.5e8, eta: 3e8 });
    let microrotation = Microrotation { alpha: 1.005e9, inertia: 2700.0, couple };
    Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(microrotation)).expect("sound moduli")
}

#[test]
fn specfem_medium_has_published_speeds() {
    let equations = specfem_medium().rates::<3>();
    let speeds: Vec<f64> = squared_speeds(&equations, random_unit_vector(&mut seeded_generator(2)))
        .iter()
        .map(|c| c.re.sqrt())
        .collect();
    // Published speeds, m/s, rounded to three decimals.
    let published = [3000.0, 1836.361, 1836.361, 630.990, 408.248, 408.248];
    for (found, published) in speeds.iter().zip(published) {
        assert!((found - published).abs() <= 0.5e-3, "{found} {published}");
    }
    let waves = DirectionalWaves::from_equations(&equations, [0.0, 0.6, 0.8]);
    for family in &waves.families {
        let cut_off = family.squared_cut_offs().last().expect("a branch").re.sqrt() / (2.0 * PI);
        match family.polarisation {
            Polarisation::Longitudinal => assert_eq!(cut_off, 0.0),
            _ => assert!((cut_off - 194.2009).abs() <= 0.5e-4, "{cut_off}"),
        }
    }
    // Long shear waves have the speed of the classical solid: 1732.05 m/s.
    let slowest = waves.families.iter().map(|f| f.squared_frequencies(1e-4)[0].re.sqrt() / 1e-4);
    let shear = slowest.fold(f64::INFINITY, f64::min);
    assert!((shear - 1732.05).abs() < 0.5e-2, "{shear}");
}

#[test]
fn cut_off_is_the_natural_rotation_and_ends_the_band_gap() {
    let random = &mut seeded_generator(3);
    let mut worst = 0.0f64;
    for index in 0..2000 {
        let theory = if index % 2 == 0 { Theory::Reduced } else { Theory::Cosserat };
        let solid = random_solid(random, theory);
        let rotation = solid.microrotation.expect("not classical");
        let natural = rotation.natural_frequency();
        let families = if random.bernoulli(0.5) {
            DirectionalWaves::from_equations(&solid.rates::<2>(), random_unit_vector(random))
                .families
        } else {
            DirectionalWaves::from_equations(&solid.rates::<3>(), random_unit_vector(random))
                .families
        };
        let transverse: Vec<_> =
            families.iter().filter(|f| f.polarisation == Polarisation::Transverse).collect();
        assert!(!transverse.is_empty());
        for family in transverse {
            let cut_off = family.squared_cut_offs()[1].re.sqrt();
            worst = worst.max((cut_off / natural - 1.0).abs());
            let bands = family.band_gaps();
            if theory == Theory::Cosserat {
                assert!(bands.is_empty(), "{bands:?}");
                continue;
            }
            // The band gap is ω₁² < ω² < ω₀² with the natural frequency ω₀ of rotation and ω₁² = ω₀²/(1 + α/μ).
            let lower = natural / (1.0 + rotation.alpha / solid.mu).sqrt();
            assert_eq!(bands.len(), 1, "{bands:?}");
            worst = worst.max((bands[0].lower / lower - 1.0).abs());
            worst = worst.max((bands[0].upper / natural - 1.0).abs());
        }
    }
    println!("worst relative error {worst:e}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// Verifies the dispersion relation k² = ρω²(4α − jω²)/(4αμ − (μ + α)jω²) of transverse waves of the reduced solid with
/// density ρ, moduli α and μ and microinertia j.
#[test]
fn reduced_solid_obeys_its_dispersion_relation() {
    let random = &mut seeded_generator(4);
    for _ in 0..500 {
        let solid = random_solid(random, Theory::Reduced);
        let Microrotation { alpha, inertia, .. } = solid.microrotation.expect("reduced");
        let (mu, density) = (solid.mu, solid.density);
        let k =
            random.log_uniform(0.05, 20.0) * (4.0 * alpha / inertia).sqrt() / solid.speeds().shear;
        for family in
            DirectionalWaves::from_equations(&solid.rates::<3>(), random_unit_vector(random))
                .families
        {
            if family.polarisation != Polarisation::Transverse {
                continue;
            }
            for mode in family.modes(k) {
                let square = mode.squared_frequency.re;
                // The relation multiplied by its denominator; the error is relative to the largest term.
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
fn long_waves_agree_with_the_classical_solid() {
    let random = &mut seeded_generator(5);
    for theory in THEORIES {
        for _ in 0..200 {
            let solid = random_solid(random, theory);
            let length = match solid.microrotation {
                None => 1.0,
                Some(m) => solid.speeds().shear / m.natural_frequency(),
            };
            // Relative corrections are of order k² times the squares of the lengths of microrotation and couple stress.
            let couple = solid.couple().map_or(0.0, |c| ((c.gamma + c.eta) / solid.mu).sqrt());
            let k = 1e-5 / length.max(couple);
            let shear = solid.mu / solid.density;
            let families =
                DirectionalWaves::from_equations(&solid.rates::<3>(), random_unit_vector(random))
                    .families;
            let transverse = families.iter().filter(|f| f.polarisation == Polarisation::Transverse);
            for family in transverse {
                let mode = family.modes(k)[0];
                let phase = mode.squared_frequency.re / (k * k);
                // Rounding of the larger eigenvalue, the squared cut-off frequency, relative to the eigenvalue k²μ/ρ,
                // and the correction of order (k × length)² ≤ 1e-10.
                let cut_off = solid.microrotation.map_or(0.0, |m| m.natural_frequency());
                let rounding = 1e-15 * (cut_off / k).powi(2) / shear;
                let tolerance = 1e-8 + 10.0 * rounding;
                assert!((phase / shear - 1.0).abs() < tolerance, "{} {tolerance:e}", phase / shear);
            }
        }
    }
}

#[test]
fn frequencies_of_isotropic_solids_do_not_depend_on_direction() {
    let random = &mut seeded_generator(6);
    for theory in THEORIES {
        for _ in 0..300 {
            let solid = random_solid(random, theory);
            let equations = solid.rates::<3>();
            let k = random.log_uniform(0.1, 10.0)
                * solid.microrotation.map_or(1.0, |m| m.natural_frequency() / solid.speeds().shear);
            let frequencies = |normal: [f64; 3]| {
                let families = DirectionalWaves::from_equations(&equations, normal).families;
                let mut all: Vec<f64> =
                    families.iter().flat_map(|f| f.squared_frequencies(k)).map(|w| w.re).collect();
                all.sort_by(f64::total_cmp);
                all
            };
            let (one, other) =
                (frequencies(random_unit_vector(random)), frequencies(random_unit_vector(random)));
            let largest = one[one.len() - 1];
            for (a, b) in one.iter().zip(&other) {
                assert!((a - b).abs() < 1e-13 * largest, "{one:?} {other:?}");
            }
        }
    }
}

#[test]
fn group_speeds_agree_with_differences() {
    let random = &mut seeded_generator(7);
    for _ in 0..300 {
        let solid = random_solid(random, Theory::Cosserat);
        let k0 = solid.microrotation.expect("Cosserat").natural_frequency() / solid.speeds().shear;
        let k = k0 * random.log_uniform(0.1, 10.0);
        for family in
            DirectionalWaves::from_equations(&solid.rates::<3>(), random_unit_vector(random))
                .families
        {
            let step = 1e-4 * k;
            let [before, after] = [k - step, k + step].map(|k| family.squared_frequencies(k));
            for (i, mode) in family.modes(k).iter().enumerate() {
                let slope = (after[i] - before[i]).re / (2.0 * step);
                // Central differences are accurate to about 1e-8 of the largest slope.
                let size = after.iter().map(|w| w.re).fold(0.0, f64::max) / k;
                assert!((mode.slope.re - slope).abs() < 1e-6 * size, "{} {slope}", mode.slope.re);
            }
        }
    }
}
