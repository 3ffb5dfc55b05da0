//! Errata of the roots and degenerate directions in Harris & Grekova (2005): eqs (142)–(163).

use crate::errata::comparison::Comparison;
use crate::errata::system::{IncompressibleFlow, STATE_COUNT, for_random_flows};
use crate::support::{
    DifferentiableReal, DoubleDouble, RIGHT_ANGLE, RandomNumbers, complex, dd, quadratic_roots,
};

/// Eq. (149) is too large by a factor of two, since it uses the printed c₅₅ of eq. (83). Reference: the larger root of
/// the exact determinant at k = 1e9 1/m in a uniform background, where the corrections of Re ς/k² are of relative size
/// K²/k² with K² of a few thousand 1/m².
#[test]
fn eq_149_leading_root_is_too_large_by_two() {
    let mut random = RandomNumbers::new(11);
    for _ in 0..STATE_COUNT {
        let system = IncompressibleFlow::new_uniform(&mut random);
        let beta = dd(random.signed_uniform(0.0, 3.0));
        let gap = beta.cos() - system.friction_angle().sin();
        if gap.to_f64().abs() < 0.05 {
            continue;
        }
        let k = 1e9;
        let wave = system.wave_direction(beta).map(|x| x * dd(k));
        let root = quadratic_roots(&system.dispersion_polynomial(wave))[0] / complex(k * k, 0.0);
        let below = system.density()
            * dd(system.state.shear_rate)
            * system.cos_twice_noncoaxiality()
            * (dd(1.0) - system.friction_angle().sin() * beta.cos());
        let printed = (-(system.yield_deviator * gap * gap / below)).to_f64();
        let off = |x: f64| (root - complex(x, 0.0)).abs() / root.abs();
        // ς/k² has the imaginary part −k·V/k², below 1e-6 of the real part for |cos β − sin φ| ≥ 0.05.
        assert!(off(printed) > 0.9, "the printed (149) holds");
        assert!(off(printed / 2.0) < 1e-5, "off by {:e}", off(printed / 2.0));
        assert!((root.re.to_f64() / (printed / 2.0) - 1.0).abs() < 1e-12);
    }
}

/// Eq. (150), another form of (149), is printed with sin⁴ in place of one sin², and with a factor 4 in place of 2.
/// Reference: the factor (cos β − sin φ)² of (149), divided by two.
#[test]
fn eq_150_misprints_the_product_of_sines() {
    let mut random = RandomNumbers::new(12);
    let mut comparisons: [Comparison; 2] = Default::default();
    for _ in 0..STATE_COUNT {
        let phi = dd(random.uniform(0.15, 1.2));
        let x = dd(random.signed_uniform(0.05, 1.5));
        let quarter = RIGHT_ANGLE * dd(0.5);
        let half = phi * dd(0.5);
        let gap = (x + x).cos() - phi.sin();
        let truth = gap * gap * dd(0.5);
        let (first, second) = ((x + quarter - half).sin(), (x - quarter + half).sin());
        let (first, second) = (first * first, second * second);
        let corrected = first * second * dd(2.0);
        // The printed form, and the form with the correct product of sines but the printed factor 4.
        let printed = [dd(4.0) * first * second * second, dd(4.0) * first * second];
        for (comparison, printed) in comparisons.iter_mut().zip(printed) {
            comparison.add_case(truth.into(), printed.into(), corrected.into(), 1e-3);
        }
    }
    comparisons.into_iter().for_each(Comparison::assert_mostly_misprinted);
}

/// Eq. (160): the degenerate wave vectors (154) have the direction (−sin, cos) of the angle Ψ ± ε; (sin, cos) is
/// printed. Reference: the stress and velocity characteristics (67), (68) from the matrices.
#[test]
fn eq_160_misprints_the_degenerate_directions() {
    for_random_flows(13, |_, system| {
        let epsilon = RIGHT_ANGLE * dd(0.5) + system.friction_angle() * dd(0.5);
        for epsilon in [epsilon, -epsilon] {
            let (s, c) = (dd(system.state.stress_angle) + epsilon).sin_cos();
            let factors = |wave: [DoubleDouble; 2]| {
                let e =
                    |i: usize, j: usize| wave[0] * system.b[0][i][j] + wave[1] * system.b[1][i][j];
                let stress = e(0, 3) * e(1, 4) - e(0, 4) * e(1, 3);
                let velocity = e(3, 1) * e(4, 0) - e(3, 0) * e(4, 1);
                [stress.to_f64().abs() / system.yield_deviator.to_f64(), velocity.to_f64().abs()]
            };
            assert!(factors([-s, c]).iter().all(|x| *x < 1e-28));
            // For the printed direction the factors vanish only if the angle Ψ ± ε is near a multiple of 90°.
            let special = (s * c).to_f64().abs() < 1e-2;
            assert!(special || factors([s, c]).iter().all(|x| *x > 1e-3));
        }
    });
}

/// Eqs (142)–(145) claim that the root of order k² is double; one of the two roots is of order k² and the other at most
/// of order k.
#[test]
fn eq_142_to_145_root_of_order_two_is_simple() {
    for_random_flows(16, |random, system| {
        let beta = dd(random.signed_uniform(0.0, 3.0));
        if (beta.cos() - system.friction_angle().sin()).to_f64().abs() < 0.05 {
            return;
        }
        let roots_at = |k: f64| {
            quadratic_roots(
                &system.dispersion_polynomial(system.wave_direction(beta).map(|x| x * dd(k))),
            )
        };
        let (near, far) = (roots_at(1e9), roots_at(1e10));
        let order = |n: usize| (far[n].abs() / near[n].abs()).log10();
        // Corrections are of relative size (background gradients)/(k (cos β − sin φ)²), below 1e-4.
        assert!((order(0) - 2.0).abs() < 1e-3, "order {} in k", order(0));
        assert!(order(1) < 1.001, "order {} in k", order(1));
    });
}

/// Eq. (163) claims that ς = 0 is a triple root in a degenerate direction; it is not a root.
#[test]
fn eq_163_zero_is_not_a_root() {
    for_random_flows(17, |_, system| {
        // The degenerate directions have cos β = sin φ.
        let beta = RIGHT_ANGLE - system.friction_angle();
        for beta in [beta, -beta] {
            let wave = system.wave_direction(beta).map(|x| x * dd(30.0));
            let exact = system.dispersion_polynomial(wave);
            assert_eq!(exact.len(), 3);
            let [large, small] = quadratic_roots(&exact);
            assert!(small.abs() > 1e-6 * large.abs(), "{small:?} is a root near zero");
            let constant = exact[0].abs();
            let size = exact[2].abs() * large.abs() * large.abs();
            assert!(constant > 1e-8 * size);
        }
    });
}
