//! Errata of the verdicts derived from limits along rays in Harris & Grekova (2005): eqs (130), (136) and the abstract.

use crate::errata::system::{IncompressibleFlow, STATE_COUNT, for_random_flows};
use crate::support::states::{self, DilatancyKind};
use crate::support::{
    DifferentiableReal, DoubleDouble, Polynomial, RIGHT_ANGLE, RandomNumbers, complex, dd,
    polynomial_determinant, quadratic_roots,
};
use wellposed_models::flow::harris_grekova::parameters::HarrisGrekova;
use wellposed_models::flow::state::MohrCoulomb;
use wellposed_models::registry;

/// Eqs (130), (136) take the limit k → ∞ in each direction separately, which does not bound the growth rate. In
///
/// ```text
/// ∂ₜw = ∂₁²∂₂²w + ∂₂⁶w,   ς = k₁²k₂² − k₂⁶,
/// ```
///
/// written as a first-order system like (77) for w and its derivatives, ς tends to −∞ or is 0 along every ray, so that
/// it is well-posed by (130), whereas the supremum over all directions grows like k³ (at k₂ ≈ (k²/3)^¼).
#[test]
fn eq_130_and_136_limits_along_rays_do_not_bound_the_growth() {
    // Unknowns w, ∂₁w, ∂₁²w, ∂₁²∂₂w, ∂₂w, ∂₂²w … ∂₂⁵w; row 0 is ∂ₜw = ∂₂(∂₁²∂₂w) + ∂₂(∂₂⁵w).
    let dispersion = |wave: [f64; 2]| {
        let mut matrix: Vec<Vec<Polynomial>> = vec![vec![vec![]; 9]; 9];
        let i_k = wave.map(|k| complex(0.0, k));
        matrix[0][0] = vec![0.0.into(), 1.0.into()];
        matrix[0][3] = vec![-i_k[1]];
        matrix[0][8] = vec![-i_k[1]];
        // Row n defines unknown n as the derivative of another unknown.
        for (n, axis, of) in
            [(1, 0, 0), (2, 0, 1), (3, 1, 2), (4, 1, 0), (5, 1, 4), (6, 1, 5), (7, 1, 6), (8, 1, 7)]
        {
            matrix[n][n] = vec![1.0.into()];
            matrix[n][of] = vec![-i_k[axis]];
        }
        let polynomial = polynomial_determinant(&matrix);
        assert_eq!(polynomial.len(), 2);
        (-(polynomial[0] / polynomial[1])).re.to_f64()
    };
    let expected = 2.5f64 * 2.5 * 0.7 * 0.7 - 0.7f64.powi(6);
    assert!((dispersion([2.5, 0.7]) - expected).abs() < 1e-12);

    // Along each of 181 rays the growth rate tends to −∞, or is 0 along the first axis.
    for degree in 0..=180 {
        let (sine, cosine) = match degree {
            0 | 180 => (0.0, 1.0),
            _ => f64::from(degree).to_radians().sin_cos(),
        };
        let far = dispersion([1e6 * cosine, 1e6 * sine]);
        assert!(far <= 0.0, "along {degree} degrees: {far:e}");
    }
    // The supremum over all directions at fixed k is of order 3 in k.
    let supremum = |k: f64| {
        (1..20_000)
            .map(|n| {
                let angle = 2.0 * f64::from(n) / 20_000.0 / k.sqrt();
                dispersion([k * angle.cos(), k * angle.sin()])
            })
            .fold(f64::MIN, f64::max)
    };
    let (near, far) = (supremum(1e3), supremum(1e4));
    assert!(near > 0.0 && ((far / near).log10() - 3.0).abs() < 0.01, "{near:e} {far:e}");
}

/// In some states the growth rate in a layer around a degenerate direction β₀ of the model exceeds the limits along
/// rays: as k → ∞ with fixed s = (β − β₀)k, Re ς tends to a function of s that exceeds, somewhere in the layer, the
/// limits along all rays including the degenerate direction. So the limits of eq. (130) do not give the bound on the
/// growth rate.
#[test]
fn eq_130_and_136_growth_is_largest_in_layers_around_degenerate_directions() {
    let mut found = 0;
    for_random_flows(18, |_, system| {
        if system.cos_twice_noncoaxiality().to_f64() < 0.1 {
            return;
        }
        let k = 1e8;
        let growth = |beta: DoubleDouble| {
            let roots = quadratic_roots(
                &system.dispersion_polynomial(system.wave_direction(beta).map(|x| x * dd(k))),
            );
            roots.map(|x| x.re.to_f64()).into_iter().fold(f64::MIN, f64::max)
        };
        let ends = [RIGHT_ANGLE - system.friction_angle(), system.friction_angle() - RIGHT_ANGLE];
        // Limits along rays: the slow root −c₃₃/(ρI) in general directions, and the roots in the degenerate directions.
        let slow = -(system.c[2][2] / (system.density() * system.inertia())).to_f64();
        let along_rays = ends.map(growth).into_iter().fold(slow, f64::max);
        let in_layers = (-100..=100)
            .flat_map(|n| ends.map(|end| growth(end + dd(f64::from(n) / k))))
            .fold(f64::MIN, f64::max);
        assert!(in_layers.is_finite() && in_layers < 1e6, "bounded in the layers");
        found += usize::from(in_layers > along_rays + 1e-3 * (1.0 + along_rays.abs()));
    });
    assert!(found >= 10, "the layers never exceed the rays: found {found}");
}

/// The claim of abstract and section 8 that incompressible flows are well-posed holds only for the non-coaxiality
/// |Ψ_D − Ψ_Σ| < π/4. For larger non-coaxiality a root of the exact determinant grows like k² with half the coefficient
/// of eq. (149); for smaller non-coaxiality the growth rate tends to a constant.
#[test]
fn abstract_claim_holds_only_below_45_degrees_noncoaxiality() {
    let mut random = RandomNumbers::new(19);
    let (mut beyond, mut within) = (0, 0);
    for _ in 0..STATE_COUNT {
        let system = IncompressibleFlow::new_random(&mut random);
        let beta = dd(random.signed_uniform(0.0, 3.0));
        let gap = (beta.cos() - system.friction_angle().sin()).to_f64();
        let degrees = system.flow.noncoaxiality.abs().to_degrees();
        if gap.abs() < 0.05 || (degrees - 45.0).abs() < 1.0 {
            continue;
        }
        let growth = |k: f64| {
            quadratic_roots(
                &system.dispersion_polynomial(system.wave_direction(beta).map(|x| x * dd(k))),
            )
            .map(|x| x.re.to_f64())
            .into_iter()
            .fold(f64::MIN, f64::max)
        };
        if degrees > 45.0 {
            beyond += 1;
            let model = HarrisGrekova::new(
                MohrCoulomb::new(system.parameters.friction_angle, system.parameters.cohesion)
                    .unwrap(),
                0.0,
                system.parameters.moment_of_inertia.unwrap(),
                system.parameters.rotational_strength.unwrap(),
            )
            .unwrap();
            let coefficient = model.growth_coefficient(
                system.yield_deviator.to_f64(),
                system.state.density,
                system.state.shear_rate,
                system.flow.noncoaxiality,
                beta.to_f64(),
            );
            assert!(coefficient > 0.0);
            // Corrections are of relative size (background gradients)/k, below 1e-6/(cos β − sin φ)² at k = 1e10.
            assert!((growth(1e10) / 1e20 / coefficient - 1.0).abs() < 1e-4);
        } else {
            within += 1;
            // The slow root is −c₃₃/(ρI) + O(1/(k (cos β − sin φ)²)); the other has a large negative real part.
            let slow = -(system.c[2][2] / (system.density() * system.inertia())).to_f64();
            assert!((growth(1e10) - slow).abs() < 1e-3 * (1.0 + slow.abs()));
        }
    }
    assert!(beyond > 60 && within > 60);
    let kind = registry::HARRIS_GREKOVA;
    let parameters = states::random_parameters(&mut random, kind, DilatancyKind::Zero);
    let bound = parameters.build_model(kind).unwrap().noncoaxiality_bound().unwrap();
    assert!((bound - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
}
