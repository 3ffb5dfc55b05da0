//! Closed forms of the models against the roots of det(ςA + i k·B + C) at large k.
//!
//! The determinant is expanded over all permutations in 31 digits, in a background without gradients except the
//! velocity gradient, where the corrections to the leading terms are of relative size (rates of the
//! background)/(leading growth rate).

use crate::support::states::{self, DilatancyKind};
use crate::support::{
    Complex, DifferentiableReal, DoubleDouble, Polynomial, RandomNumbers, complex, dd,
    evaluate_polynomial, quadratic_roots,
};
use testkit::flows::FlowParameters;
use wellposed_models::flow::double_shearing::parameters::DoubleShearing;
use wellposed_models::flow::harris_grekova::parameters::HarrisGrekova;
use wellposed_models::flow::plastic_potential::parameters::PlasticPotential;
use wellposed_models::flow::state::{DeformingFlow, MaterialState};
use wellposed_models::flow::{FlowKind, Model};
use wellposed_models::registry;

const STATE_COUNT: usize = 300;

fn random_uniform_state(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> (FlowParameters, MaterialState) {
    let parameters = states::random_parameters(random, kind, dilatancy);
    let state = states::without_gradients(states::random_state(random, kind, dilatancy));
    (parameters, MaterialState { velocity: [0.0; 2], ..state })
}

/// Determinant as a polynomial in ς at the wave number `k` in the direction with β = 2(Ψ_Σ − ψ_K) = `beta`.
fn dispersion_polynomial(
    model: &Model,
    flow: &DeformingFlow,
    k: f64,
    beta: DoubleDouble,
) -> Polynomial {
    let (s, c) = (dd(flow.stress.angle) - beta * dd(0.5)).sin_cos();
    states::dispersion_polynomial(&states::assemble_symbol(model, flow), [dd(k) * c, dd(k) * s])
}

/// Finds a root by Newton's method from `guess`; asserts that the last relative step is below 1e-20.
fn find_root_near(polynomial: &[Complex], guess: Complex) -> Complex {
    let slope: Polynomial =
        polynomial.iter().enumerate().skip(1).map(|(n, &c)| c * complex(n as f64, 0.0)).collect();
    let mut x = guess;
    for _ in 0..60 {
        x = x - evaluate_polynomial(polynomial, x) / evaluate_polynomial(&slope, x);
    }
    let step = evaluate_polynomial(polynomial, x) / evaluate_polynomial(&slope, x);
    assert!(step.abs() <= 1e-20 * x.abs(), "no root near the guess");
    x
}

/// Sum of all roots: minus the second-highest coefficient divided by the highest.
fn sum_of_roots(polynomial: &[Complex]) -> Complex {
    let [.., next, last] = polynomial else { panic!("a constant") };
    -(*next / *last)
}

/// Harris–Grekova, ν = 0, zero gradients, |Δ| below and above 45°: `growth_coefficient` equals lim ς/k².
///
/// Tolerance 1e-12. The other root is of the order of the background rates, about 10 1/s, and the coefficient at least
/// 1e-3 m²/s, so the sum of the roots over k² has a relative error below 1e-13 at k = 1e9 1/m. The entries have
/// relative errors of 1e-15, amplified by up to 1/0.05 each near cos β = sin φ and near |Δ| = 45°.
#[test]
fn harris_grekova_growth_coefficient_is_the_limit_of_the_roots() {
    let mut random = RandomNumbers::new(500);
    let (mut worst, mut compared) = (0.0f64, 0);
    while compared < STATE_COUNT {
        let (parameters, state) =
            random_uniform_state(&mut random, registry::HARRIS_GREKOVA, DilatancyKind::Zero);
        let model = states::build_model(registry::HARRIS_GREKOVA, &parameters);
        let flow = states::complete_flow(&model, &state);
        let constants = parameters.to_constants(registry::HARRIS_GREKOVA);
        let own = HarrisGrekova::from_constants(&constants).expect("in range");
        let beta = random.signed_uniform(0.0, 3.1);
        let gap = beta.cos() - parameters.friction_angle.sin();
        if gap.abs() < 0.05 || (2.0 * flow.noncoaxiality).cos().abs() < 0.05 {
            continue;
        }
        compared += 1;
        let k = 1e9;
        let root = sum_of_roots(&dispersion_polynomial(&model, &flow, k, dd(beta)));
        let truth = (root / complex(k * k, 0.0)).re.to_f64();
        let (q, rho, rate) = (flow.stress.deviator.value, flow.density, flow.shear_rate);
        let closed = own.growth_coefficient(q, rho, rate, flow.noncoaxiality, beta);
        worst = worst.max((closed / truth - 1.0).abs());
        assert!((closed / truth - 1.0).abs() < 1e-12, "{closed:e} against {truth:e}");
    }
    println!("Harris–Grekova: {worst:.1e}");
}

/// Double shearing, ν = 0, at rest: the roots are ±k × `growth_coefficient`.
///
/// Tolerance 1e-9. At k = 1e12 1/m the relative corrections are (background rates)/(kc) with the coefficient c of order
/// 0.1 m/s.
#[test]
fn double_shearing_growth_coefficient_is_the_limit_of_the_roots() {
    let mut random = RandomNumbers::new(510);
    let mut worst = 0.0f64;
    for _ in 0..STATE_COUNT {
        let (parameters, state) =
            random_uniform_state(&mut random, registry::DOUBLE_SHEARING, DilatancyKind::Zero);
        let model = states::build_model(registry::DOUBLE_SHEARING, &parameters);
        let flow = states::complete_flow(&model, &state);
        let constants = parameters.to_constants(registry::DOUBLE_SHEARING);
        let own = DoubleShearing::from_constants(&constants).expect("in range");
        let beta = random.signed_uniform(0.0, 3.1);
        if (beta.cos() - parameters.friction_angle.sin()).abs() < 0.05 {
            continue;
        }
        let k = 1e12;
        let polynomial = dispersion_polynomial(&model, &flow, k, dd(beta));
        let roots = quadratic_roots(&polynomial).map(|x| (x / complex(k, 0.0)).re.to_f64());
        let closed = own.growth_coefficient(flow.stress.deviator.value, flow.density, beta);
        for truth in roots {
            worst = worst.max((closed / truth.abs() - 1.0).abs());
            assert!((closed / truth.abs() - 1.0).abs() < 1e-9, "{closed:e} against {truth:e}");
        }
        assert!(roots[0] * roots[1] < 0.0, "one grows, one decays");
    }
    println!("double shearing: {worst:.1e}");
}

/// With all gradients and a velocity the roots of double shearing are −ik·V ± kc to order k, with the same drift −ik·V:
/// the advection term V·∇ enters exactly once.
#[test]
fn double_shearing_roots_are_advected_with_the_material() {
    let mut random = RandomNumbers::new(511);
    for _ in 0..STATE_COUNT {
        let kind = registry::DOUBLE_SHEARING;
        let parameters = states::random_parameters(&mut random, kind, DilatancyKind::Zero);
        let state = states::random_state(&mut random, kind, DilatancyKind::Zero);
        let model = states::build_model(kind, &parameters);
        let flow = states::complete_flow(&model, &state);
        let (k, beta) = (1e12, random.signed_uniform(0.0, 3.1));
        if (beta.cos() - parameters.friction_angle.sin()).abs() < 0.05 {
            continue;
        }
        let roots = quadratic_roots(&dispersion_polynomial(&model, &flow, k, dd(beta)));
        let (s, c) = (state.stress_angle - 0.5 * beta).sin_cos();
        let drift = c * state.velocity[0] + s * state.velocity[1];
        for root in roots {
            // Corrections of Im ς/k are of the order (background rates, and gradients times velocities)/k, below
            // 1e-6 m/s.
            assert!((root.im.to_f64() / k + drift).abs() < 1e-6);
        }
    }
}

/// Plastic potential, all ν: `growth_coefficient` equals lim ς/k² in every direction, and is positive exactly in the
/// sector where cos β lies between sin ν and sin φ.
#[test]
fn plastic_potential_growth_coefficient_is_the_limit_of_the_roots() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive, DilatancyKind::Associated] {
        let mut random = RandomNumbers::new(520);
        let (mut worst, mut inside, mut compared) = (0.0f64, 0, 0);
        while compared < STATE_COUNT {
            let (parameters, state) =
                random_uniform_state(&mut random, registry::PLASTIC_POTENTIAL, dilatancy);
            let model = states::build_model(registry::PLASTIC_POTENTIAL, &parameters);
            let flow = states::complete_flow(&model, &state);
            let constants = parameters.to_constants(registry::PLASTIC_POTENTIAL);
            let own = PlasticPotential::from_constants(&constants).expect("in range");
            let beta = random.signed_uniform(0.0, 3.1);
            let (phi, nu) = (parameters.friction_angle.sin(), parameters.dilatancy_angle.sin());
            let gaps = (beta.cos() - phi) * (beta.cos() - nu);
            if gaps.abs() < 1e-3 {
                continue;
            }
            compared += 1;
            let k = 1e12;
            let (q, rho, rate) = (flow.stress.deviator.value, flow.density, flow.shear_rate);
            let closed = own.growth_coefficient(q, rho, rate, beta);
            assert_eq!(closed > 0.0, gaps < 0.0);
            inside += usize::from(closed > 0.0);
            let polynomial = dispersion_polynomial(&model, &flow, k, dd(beta));
            let root = find_root_near(&polynomial, complex(closed * k * k, 0.0));
            let truth = (root / complex(k * k, 0.0)).re.to_f64();
            // The root found is the only one of order k²: the sum of all roots agrees, since the others are of order k
            // at most.
            let sum = (sum_of_roots(&polynomial) / complex(k * k, 0.0)).re.to_f64();
            assert!((sum / truth - 1.0).abs() < 1e-6);
            // The tolerance allows for errors of the entries of 1e-15, amplified by up to 1e3 near a zero of the
            // coefficient.
            worst = worst.max((closed / truth - 1.0).abs());
            assert!((closed / truth - 1.0).abs() < 1e-11, "{closed:e} against {truth:e}");
        }
        // The unstable sector is empty exactly for associated flow.
        assert_eq!(inside == 0, dilatancy == DilatancyKind::Associated);
        println!("plastic potential {dilatancy:?}: {worst:.1e}");
    }
}

/// `PlasticPotential::fastest_growth` returns the maximum over the directions of the leading growth rate, and its
/// direction; verified by the roots of the determinant in 100 directions.
#[test]
fn plastic_potential_fastest_growth_is_the_maximum_over_directions() {
    let mut random = RandomNumbers::new(530);
    let mut compared = 0;
    while compared < 200 {
        let (parameters, state) =
            random_uniform_state(&mut random, registry::PLASTIC_POTENTIAL, DilatancyKind::Positive);
        let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
        if (phi - nu).abs() < 0.1 {
            continue;
        }
        compared += 1;
        let model = states::build_model(registry::PLASTIC_POTENTIAL, &parameters);
        let flow = states::complete_flow(&model, &state);
        let constants = parameters.to_constants(registry::PLASTIC_POTENTIAL);
        let own = PlasticPotential::from_constants(&constants).expect("in range");
        let (rate, cosine) =
            own.fastest_growth(flow.stress.deviator.value, flow.density, flow.shear_rate);
        assert!(phi.sin().min(nu.sin()) < cosine && cosine < phi.sin().max(nu.sin()));
        let k = 1e12;
        let at = |beta: f64| {
            let sum = sum_of_roots(&dispersion_polynomial(&model, &flow, k, dd(beta)));
            (sum / complex(k * k, 0.0)).re.to_f64()
        };
        let beta = cosine.acos();
        // Tolerance: rounding errors of the entries over tan²((φ − ν)/2), |φ − ν| ≥ 0.1. An error of the direction
        // enters quadratically.
        assert!((at(beta) / rate - 1.0).abs() < 1e-11, "{} {rate}", at(beta));
        for n in 0..100 {
            let other = at(std::f64::consts::PI * f64::from(n) / 100.0);
            assert!(other <= rate * (1.0 + 1e-12));
        }
        for h in [-1e-3, 1e-3] {
            assert!(at(beta + h) < rate, "a maximum");
        }
    }
}

/// The bound on |Δ| of Harris–Grekova, ν = 0 and ν > 0, agrees with the determinant: beyond the bound the coefficient
/// of the highest power of ς changes sign in some direction, below it in none. In a uniform background this coefficient
/// is k² (a + b cos β + c sin β), fitted in three directions and checked in a fourth, so it has one sign exactly if
/// |a| > √(b² + c²). The limit Δ is found by bisection.
///
/// Tolerance 1e-10: errors of 1e-15 of the entries are divided by the slope of |a| − √(b² + c²) in Δ, which is small
/// for ν near φ or 0.
#[test]
fn noncoaxiality_bound_is_where_the_growth_coefficient_vanishes() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let mut random = RandomNumbers::new(540);
        let mut worst = 0.0f64;
        for _ in 0..200 {
            let (parameters, state) =
                random_uniform_state(&mut random, registry::HARRIS_GREKOVA, dilatancy);
            let model = states::build_model(registry::HARRIS_GREKOVA, &parameters);
            let closed = model.noncoaxiality_bound().unwrap();
            let k = 7.0;
            // Mean a and amplitude √(b² + c²) of the highest coefficient over the directions, divided by
            // |a| + |b| + |c|.
            let mean_and_amplitude = |delta: f64| {
                let flow = states::complete_flow(
                    &model,
                    &MaterialState { noncoaxiality: Some(delta), ..state },
                );
                let highest = |beta: f64| {
                    // The highest coefficient is real.
                    let polynomial = dispersion_polynomial(&model, &flow, k, dd(beta));
                    assert_eq!(
                        polynomial.len(),
                        if dilatancy == DilatancyKind::Zero { 3 } else { 4 }
                    );
                    let last = *polynomial.last().unwrap();
                    assert!(last.im.to_f64().abs() <= 1e-25 * last.abs());
                    last.re.to_f64()
                };
                let (east, north, west) = (highest(0.0), highest(1.25), highest(2.5));
                // Fit a + b cos β + c sin β to three directions.
                let rows = [
                    [1.0, 1.0, 0.0],
                    [1.0, 1.25f64.cos(), 1.25f64.sin()],
                    [1.0, 2.5f64.cos(), 2.5f64.sin()],
                ];
                let solved = nalgebra::Matrix3::from_fn(|i, j| rows[i][j])
                    .lu()
                    .solve(&nalgebra::Vector3::new(east, north, west))
                    .unwrap();
                let (a, b, c) = (solved[0], solved[1], solved[2]);
                let fourth = a + b * 4.0f64.cos() + c * 4.0f64.sin();
                let size = a.abs() + b.abs() + c.abs();
                assert!((highest(4.0) - fourth).abs() < 1e-11 * size, "no trigonometric line");
                [a / size, b.hypot(c) / size]
            };
            // Difference of mean and amplitude: positive if in all directions the coefficient has the sign that it has
            // in a coaxial flow. (For ν = 0 it changes sign in all directions at the same Δ.)
            let coaxial = mean_and_amplitude(0.0)[0].signum();
            let mean_and_amplitude = |delta: f64| {
                let [mean, amplitude] = mean_and_amplitude(delta);
                coaxial * mean - amplitude
            };
            let (mut inside, mut outside) = (0.0, std::f64::consts::FRAC_PI_4 + 0.01);
            assert!(mean_and_amplitude(inside) > 0.0 && mean_and_amplitude(outside) < 0.0);
            for _ in 0..50 {
                let middle = 0.5 * (inside + outside);
                if mean_and_amplitude(middle) > 0.0 {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            worst = worst.max((inside - closed).abs());
            assert!((inside - closed).abs() < 1e-10, "{inside} from the pencil, {closed} closed");
            // Negative Δ has the same bound.
            assert!(
                mean_and_amplitude(-closed + 1e-6) > 0.0
                    && mean_and_amplitude(-closed - 1e-6) < 0.0
            );
        }
        println!("bound on Δ, {dilatancy:?}: {worst:.1e}");
    }
}

/// Harris–Grekova, ν > 0: for |Δ| below the bound the leading growth rate is not positive in any direction, beyond it
/// is positive in some direction; verified by the roots at k = 1e9, not only by the highest coefficient.
#[test]
fn noncoaxiality_bound_separates_growth_from_decay() {
    let mut random = RandomNumbers::new(550);
    for _ in 0..200 {
        let (parameters, state) =
            random_uniform_state(&mut random, registry::HARRIS_GREKOVA, DilatancyKind::Positive);
        let model = states::build_model(registry::HARRIS_GREKOVA, &parameters);
        let bound = model.noncoaxiality_bound().unwrap();
        let sign = random.signed_uniform(1.0, 1.1).signum();
        let max_growth_rate = |delta: f64| {
            let flow = states::complete_flow(
                &model,
                &MaterialState { noncoaxiality: Some(sign * delta), ..state },
            );
            let k = 1e9;
            (0..240)
                .map(|n| {
                    let beta = dd(std::f64::consts::TAU * f64::from(n) / 240.0);
                    let sum = sum_of_roots(&dispersion_polynomial(&model, &flow, k, beta));
                    (sum / complex(k * k, 0.0)).re.to_f64()
                })
                .fold(f64::MIN, f64::max)
        };
        // The sum of the roots equals the leading root, since the others are of lower order in k. Near directions with
        // cos β = sin φ it is zero up to errors of the entries.
        let scale = state.pressure / state.density / state.shear_rate;
        assert!(max_growth_rate(0.95 * bound) <= 1e-9 * scale);
        assert!(max_growth_rate(bound + 0.05) > 1e-6 * scale);
    }
}
