//! Branches of the dispersion relation: band gaps and slopes.

use crate::support::states::seeded_generator;
use models::solid::parameters::Theory;
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_analysis::waves::{DirectionalWaves, roots};

use super::random_solids::random_solid_of_order_one;
use super::yielding::random_yielding_equations;

/// Verifies that no wave has a frequency in a band gap and that waves come close to its ends, for shear waves of
/// random positive stiffnesses.
#[test]
fn band_gaps_contain_no_wave() {
    let random = &mut seeded_generator(37);
    let mut bands = 0;
    for _ in 0..400 {
        let mut equations = random_solid_of_order_one(random, Theory::Reduced).rates::<2>();
        let root = DMatrix::from_fn(2, 2, |_, _| random.uniform(-1.0, 1.0));
        let law = &root * root.transpose();
        // Stiffness of σ21 and σ12.
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            equations.stiffness[(2 + i, 2 + j)] = models::Rounded::from_rounded(law[(i, j)]);
        }
        for family in DirectionalWaves::from_equations(&equations, [1.0, 0.0]).families {
            let numbers = (0..1650).map(|i| 1e-4 * 1.008f64.powi(i));
            let waves: Vec<f64> = numbers
                .flat_map(|k| family.squared_frequencies(k))
                .map(|square| square.re.max(0.0).sqrt())
                .collect();
            for band in family.band_gaps() {
                bands += 1;
                let tolerance = 1e-9 * (1.0 + band.lower);
                let is_inside =
                    |&&w: &&f64| w > band.lower + tolerance && w < band.upper - tolerance;
                assert_eq!(waves.iter().find(is_inside), None, "{band:?}");
                for end in
                    [band.lower, band.upper].into_iter().filter(|&e| e > 0.0 && e.is_finite())
                {
                    let near = waves.iter().map(|w| (w - end).abs()).fold(f64::INFINITY, f64::min);
                    assert!(near < 0.05 * end, "{end} of {band:?} is {near} away from waves");
                }
            }
        }
    }
    assert!(bands > 300, "{bands}");
}

/// Verifies slopes of complex branches against differences of the roots of the first-order equations.
#[test]
fn slopes_of_complex_branches_agree_with_differences() {
    let random = &mut seeded_generator(41);
    let (mut complex, mut worst) = (0, 0.0f64);
    for _ in 0..400 {
        let equations = random_yielding_equations(random, |friction| friction - 0.9);
        let angle = random.uniform(0.0, PI);
        let normal = [angle.cos(), angle.sin()];
        let k = random.log_uniform(0.3, 30.0);
        let step = 1e-4 * k;
        let squares = |k: f64| -> Vec<Complex64> {
            roots(&equations, normal, k).iter().map(|root| -(root * root)).collect()
        };
        let (before, after) = (squares(k - step), squares(k + step));
        for family in DirectionalWaves::from_equations(&equations, normal).families {
            let modes = family.modes(k);
            for mode in &modes {
                let size = mode.squared_frequency.norm();
                let others =
                    modes.iter().map(|m| (m.squared_frequency - mode.squared_frequency).norm());
                // Skip branches of nearly zero frequency or close to others.
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
