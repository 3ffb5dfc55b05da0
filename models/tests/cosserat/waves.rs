//! Plane waves in elastic solids: wave speeds, dispersion of the reduced Cosserat solid, and limits.

use crate::cosserat::random_solids::{random_solid, random_unit_vector};
use crate::support::{RandomNumbers, draw_log_uniform};
use nalgebra::{Complex, SymmetricEigen};
use wellposed_models::common::rates::SymmetricForm;
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};

/// Frequencies ω of plane waves exp(i(k·x − ωt)) of a symmetric form, ascending: eigenvalues of the Hermitian matrix
/// L⁻¹(−k·B + iQ)L⁻ᵀ with A = L Lᵀ.
pub fn compute_frequencies<const D: usize>(form: &SymmetricForm<D>, wave: [f64; D]) -> Vec<f64> {
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

fn check_speeds<const D: usize>(solid: &Isotropic, random: &mut RandomNumbers, zeros: usize) {
    let form = solid.rates::<D>().symmetric_form().unwrap();
    let principal = SymmetricForm { q: form.q.clone() * 0.0, ..form };
    let own = compute_frequencies(&principal, random_unit_vector(random));
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

/// The closed-form speeds equal the eigenvalues of the principal part, including the number of zero speeds.
#[test]
fn wave_speeds_are_eigenvalues_of_the_principal_part() {
    let mut random = RandomNumbers::new(6);
    for _ in 0..100 {
        check_speeds::<2>(&random_solid(&mut random, 2), &mut random, 3);
        check_speeds::<3>(&random_solid(&mut random, 2), &mut random, 12);
        check_speeds::<2>(&random_solid(&mut random, 1), &mut random, 3);
        check_speeds::<3>(&random_solid(&mut random, 1), &mut random, 9);
        check_speeds::<2>(&random_solid(&mut random, 0), &mut random, 1);
        check_speeds::<3>(&random_solid(&mut random, 0), &mut random, 3);
    }
}

/// The wave speeds of the homogeneous Cosserat medium of a unit test of SPECFEM++ (Princeton) agree with its published
/// values.
#[test]
fn wave_speeds_agree_with_published_values() {
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

/// Transverse waves of the reduced Cosserat solid satisfy k² = ρω²(4α − jω²)/(4αμ − (μ + α)jω²), with a band gap
/// between ω₁ = ω₀/√(1 + α/μ) and ω₀ = √(4α/j).
#[test]
fn reduced_cosserat_waves_satisfy_the_dispersion_relation() {
    let mut random = RandomNumbers::new(7);
    for _ in 0..200 {
        let solid = random_solid(&mut random, 1);
        let Microrotation { alpha, inertia, .. } = solid.microrotation.unwrap();
        let (mu, natural) = (solid.mu, solid.microrotation.unwrap().natural_frequency());
        let number = draw_log_uniform(&mut random, -1.0, 1.0);
        let direction: [f64; 2] = random_unit_vector(&mut random);
        let form = solid.rates::<2>().symmetric_form().unwrap();
        let own = compute_frequencies(&form, direction.map(|x| x * number));
        // Seven frequencies: two transverse pairs ±ω, one longitudinal pair ±ω, and one zero.
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
            // The dispersion relation is multiplied by its denominator, which vanishes at ω₁.
            let left = number * number * (4.0 * alpha * mu - (mu + alpha) * w);
            let right = solid.density * frequency * frequency * (4.0 * alpha - w);
            let size = number * number * (4.0 * alpha * mu + (mu + alpha) * w)
                + solid.density * frequency * frequency * (4.0 * alpha + w);
            assert!((left - right).abs() <= 1e-12 * size, "{left} {right}");
        }
    }
}

/// For j → 0 the shear wave speed of the reduced Cosserat solid tends to √(μ/ρ) of the classical solid with an error of
/// order jk²; for β, γ, η → 0 the frequencies of the Cosserat solid tend to those of the reduced Cosserat solid with an
/// error of first order in these moduli.
#[test]
fn classical_and_reduced_limits_converge_at_first_order() {
    let mut random = RandomNumbers::new(8);
    for _ in 0..20 {
        let base = random_solid(&mut random, 2);
        let direction: [f64; 2] = random_unit_vector(&mut random);
        let shear_frequency = |inertia: f64| {
            let microrotation = base.microrotation.unwrap();
            let solid = Isotropic {
                microrotation: Some(Microrotation { inertia, couple: None, ..microrotation }),
                ..base
            };
            compute_frequencies(&solid.rates::<2>().symmetric_form().unwrap(), direction)[4]
        };
        let classical = Isotropic { microrotation: None, ..base };
        let form = classical.rates::<2>().symmetric_form().unwrap();
        let exact = compute_frequencies(&form, direction)[3];
        assert!((exact - classical.speeds().shear).abs() <= 1e-13);
        let [coarse, fine] = [1e-3, 1e-4].map(|inertia| (shear_frequency(inertia) - exact).abs());
        assert!(coarse < 0.02 * exact, "{coarse}");
        assert!((8.0..12.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");

        let cosserat_frequencies = |scale: f64| {
            let microrotation = base.microrotation.unwrap();
            let CoupleModuli { beta, gamma, eta } = microrotation.couple.unwrap();
            let couple =
                CoupleModuli { beta: scale * beta, gamma: scale * gamma, eta: scale * eta };
            let solid = Isotropic {
                microrotation: Some(Microrotation { couple: Some(couple), ..microrotation }),
                ..base
            };
            let all = compute_frequencies(&solid.rates::<2>().symmetric_form().unwrap(), direction);
            [all[6], all[7], all[8]]
        };
        let reduced = Isotropic {
            microrotation: base.microrotation.map(|m| Microrotation { couple: None, ..m }),
            ..base
        };
        let all = compute_frequencies(&reduced.rates::<2>().symmetric_form().unwrap(), direction);
        let distance = |scale: f64| {
            let own = cosserat_frequencies(scale);
            (0..3).map(|i| (own[i] - all[4 + i]).abs()).fold(0.0, f64::max)
        };
        let [coarse, fine] = [distance(1e-4), distance(1e-5)];
        assert!(coarse < 1e-2, "{coarse}");
        assert!((8.0..12.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
    }
}
