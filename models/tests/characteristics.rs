//! Determinants of the linearised systems against closed forms: the steady characteristics of Harris & Grekova (2005),
//! eq. (70), and the exact dispersion relation for ν = 0.
//!
//! The determinants are expanded over all permutations in 31 digits from the entries in double precision. The error is
//! then due to the rounding of the entries, about ten units in the last place each. Tolerance: 300 u (50 u for each of
//! six factors, with the unit roundoff u) times the sum of the absolute values of all terms (the permanent).

use crate::support::states::{self, DilatancyKind};
use crate::support::{
    Complex, DifferentiableReal, DoubleDouble, RandomNumbers, complex, complex_determinant, dd,
    permanent,
};
use testkit::flows::MODEL_CASES;
use wellposed_models::LinearisedSystem;
use wellposed_models::flow::state::DeformingFlow;
use wellposed_models::registry;

const STATE_COUNT: usize = 300;
const DETERMINANT_TOLERANCE: f64 = 300.0 * f64::EPSILON / 2.0;

/// Matrix ξ₁(B¹ + V₁A) + ξ₂(B² + V₂A) of the steady equations for ξ = `direction`.
fn steady_matrix(
    system: &LinearisedSystem<2>,
    direction: [DoubleDouble; 2],
) -> Vec<Vec<DoubleDouble>> {
    let (rows, columns) = system.a.shape();
    let entry = |i: usize, j: usize| {
        (0..2).fold(dd(0.0), |sum, d| {
            let convected = dd(system.velocity[d]) * dd(system.a[(i, j)].value);
            sum + direction[d] * (dd(system.b[d][(i, j)].value) + convected)
        })
    };
    (0..rows).map(|i| (0..columns).map(|j| entry(i, j)).collect()).collect()
}

fn compute_steady_determinant(
    system: &LinearisedSystem<2>,
    direction: [DoubleDouble; 2],
) -> (f64, f64) {
    let matrix = steady_matrix(system, direction);
    let complex: Vec<Vec<Complex>> =
        matrix.iter().map(|row| row.iter().map(|&x| x.into()).collect()).collect();
    let sizes: Vec<Vec<f64>> =
        matrix.iter().map(|row| row.iter().map(|x| x.to_f64().abs()).collect()).collect();
    (complex_determinant(&complex).re.to_f64(), permanent(&sizes))
}

/// Quadratic form 𝒜 = (cos 2Ψ − sin φ) x² + 2 sin 2Ψ xy − (cos 2Ψ + sin φ) y² of eq. (69).
fn characteristic_form(angle: f64, phi: f64, [x, y]: [DoubleDouble; 2]) -> DoubleDouble {
    let angle = dd(angle);
    let (s, c) = (angle + angle).sin_cos();
    let sin_phi = dd(phi).sin();
    (c - sin_phi) * x * x + dd(2.0) * s * x * y - (c + sin_phi) * y * y
}

/// The determinant of the steady equations equals eq. (70) for Harris–Grekova and the analogous formulas below for the
/// other models. In the crate the mass row and the density column are last, in the paper fourth: two even permutations,
/// which leave the sign unchanged. With e = ξ·V the determinant is
///
/// - Harris–Grekova, ν > 0: −2 q ρI cos(φ − 2ν) e²𝒜², as printed. For ν = 0 the mass row and the density column are
///   absent, and with them one factor e: −2 q ρI cos φ e 𝒜².
/// - Plastic potential: the factor ρIe is absent, since there is no spin. The kinematic factor cos(φ − 2ν) 𝒜 of
///   eq. (68) becomes 𝒜 with sin ν in place of sin φ, so that stress and velocity characteristics differ unless ν = φ.
/// - Double shearing: the factor ρIe is absent, and the rotation row has the entry 2 sin(φ − ν) e in the column of ψ.
///   The permutations through this entry add −ρe · 2 sin(φ − ν) e · (e₅₁e₁₄ + e₅₂e₂₄), in the numbering of the paper
///   with column 4 for p. This term makes the steady equations depend on inertia.
#[test]
fn steady_determinant_equals_eq_70() {
    let mut worst = 0.0f64;
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        if kind == registry::FREE_ROTATING {
            continue;
        }
        let mut random = RandomNumbers::new(400 + seed as u64);
        for _ in 0..STATE_COUNT {
            let (parameters, model, state) = states::random_case(&mut random, kind, dilatancy);
            let flow = states::complete_flow(&model, &state);
            let system = states::assemble_symbol(&model, &flow);
            let direction =
                [random.signed_uniform(0.2, 2.0), random.signed_uniform(0.2, 2.0)].map(dd);
            let (determinant, size) = compute_steady_determinant(&system, direction);

            let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
            let form = |angle: f64| characteristic_form(state.stress_angle, angle, direction);
            let density = dd(state.density);
            let q = dd(state.pressure) * dd(phi).sin() + dd(parameters.cohesion) * dd(phi).cos();
            let e = direction[0] * dd(state.velocity[0]) + direction[1] * dd(state.velocity[1]);
            let kinematic = match kind {
                own if own == registry::PLASTIC_POTENTIAL => form(nu),
                _ => (dd(phi) - dd(nu) - dd(nu)).cos() * form(phi),
            };
            let mut expected = -(dd(2.0) * q * form(phi) * kinematic);
            if kind == registry::DOUBLE_SHEARING {
                // ξ − sin φ n and cos(φ − ν) ξ − sin ν n, where n is ξ reflected about the axis at the angle Ψ.
                let angle = dd(state.stress_angle);
                let (s, c) = (angle + angle).sin_cos();
                let along = |sine: DoubleDouble| {
                    [
                        direction[0] - sine * (c * direction[0] + s * direction[1]),
                        direction[1] - sine * (s * direction[0] - c * direction[1]),
                    ]
                };
                let difference = (dd(phi) - dd(nu)).cos();
                let (p, v) = (along(dd(phi).sin()), along(dd(nu).sin() / difference));
                let inner = difference * (p[0] * v[0] + p[1] * v[1]);
                let rotation = dd(2.0) * (dd(phi) - dd(nu)).sin();
                expected = expected - density * e * rotation * e * inner;
            }
            if kind == registry::HARRIS_GREKOVA {
                let inertia = dd(parameters.moment_of_inertia.unwrap());
                expected = expected * density * inertia * e;
            }
            if dilatancy != DilatancyKind::Zero {
                expected = expected * e;
            }
            let relative = (determinant - expected.to_f64()).abs() / size;
            worst = worst.max(relative);
            assert!(
                relative < DETERMINANT_TOLERANCE,
                "{kind:?} {dilatancy:?}: {determinant:e} against {:e} of {size:e}",
                expected.to_f64()
            );
        }
    }
    println!("largest deviation from (70), of the permanent: {worst:.1e}");
}

/// In the Harris–Grekova model with ν > 0 the characteristic directions ψ_σ ± ε, with the stress angle ψ_σ and
/// ε = π/4 + φ/2, and the streamlines are double: the determinant vanishes quadratically there, since stress and
/// velocity characteristics coincide.
#[test]
fn harris_grekova_characteristics_are_double_roots() {
    let mut random = RandomNumbers::new(450);
    for _ in 0..STATE_COUNT {
        let kind = registry::HARRIS_GREKOVA;
        let (parameters, model, state) =
            states::random_case(&mut random, kind, DilatancyKind::Positive);
        let system = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
        let epsilon = std::f64::consts::FRAC_PI_4 + 0.5 * parameters.friction_angle;
        let streamline = state.velocity[1].atan2(state.velocity[0]);
        let lines = [state.stress_angle + epsilon, state.stress_angle - epsilon, streamline];
        let distance = |a: f64, b: f64| (a - b).sin().abs();
        if distance(lines[2], lines[0]).min(distance(lines[2], lines[1])) < 0.1 {
            continue;
        }
        for line in lines {
            // Normals to the characteristic, rotated by h and h/2: det ~ h².
            let at = |h: f64| {
                let (s, c) = dd(line + h).sin_cos();
                compute_steady_determinant(&system, [-s, c]).0
            };
            let (h, k) = (1e-4, 5e-5);
            // The ratio is 4 up to the cubic term, whose relative size is a few times h/(angle to the other
            // characteristics).
            let ratio = at(h) / at(k);
            assert!((ratio - 4.0).abs() < 0.05, "ratio {ratio} at {line}");
            let other = at(-h) / at(h);
            assert!((other - 1.0).abs() < 0.05, "a double root does not change sign: {other}");
        }
    }
}

/// det(ςA + i k·B + C) equals the exact dispersion relation for ν = 0 with all background gradients,
///
/// ```text
/// {c₅₅ [(G̃·ξ) y + ρ G̃⊥·(∇V ξ⊥)] − (G̃×H̃) ik𝒜} (I y + c₃₃) + c₅₃ (c₃·ξ⊥)(G̃×H̃) = 0,
/// y = ρ (ς + ik·V),
/// ```
///
/// at random complex ς and real k. G̃ = ikG + (c₁₄, c₂₄) and H̃ = ikH + (c₁₅, c₂₅) are the coefficients of p and ψ in
/// the momentum rows, c₃ = (c₃₁, c₃₂), and cᵢⱼ are the entries of C numbered as in the paper. The left-hand side is the
/// determinant divided by −cos φ ik: the crate writes continuity as cos φ ik ξ·v, and elimination along ξ⊥ changes the
/// sign once. All terms are computed here from the state.
#[test]
fn determinant_equals_the_dispersion_relation_for_zero_dilatancy() {
    let mut random = RandomNumbers::new(460);
    let mut worst = 0.0f64;
    for _ in 0..STATE_COUNT {
        let kind = registry::HARRIS_GREKOVA;
        let (parameters, model, state) =
            states::random_case(&mut random, kind, DilatancyKind::Zero);
        let flow = states::complete_flow(&model, &state);
        let system = states::assemble_symbol(&model, &flow);
        let k = 10f64.powf(random.uniform(-2.0, 4.0));
        let theta = random.signed_uniform(0.0, 3.0);
        let size = k * 10f64.powf(random.uniform(-1.0, 1.0));
        let frequency =
            complex(size * random.signed_uniform(0.3, 1.0), size * random.signed_uniform(0.3, 1.0));

        let (sine, cosine) = dd(theta).sin_cos();
        let wave = [dd(k) * cosine, dd(k) * sine];
        let determinant = crate::support::evaluate_polynomial(
            &states::dispersion_polynomial(&system, wave),
            frequency,
        );
        let scale = states::dispersion_permanent(&system, wave, frequency.abs());
        let factor = -(Complex { re: dd(0.0), im: dd(k) * dd(parameters.friction_angle).cos() });
        let relation = exact_dispersion_relation(&parameters, &flow, k, theta, frequency);
        let relative = (determinant - factor * relation).abs() / scale;
        worst = worst.max(relative);
        assert!(relative < DETERMINANT_TOLERANCE, "off by {relative:e} of the sum of all terms");
        // The comparison is significant: the determinant is not negligible relative to the scale.
        assert!(determinant.abs() > 1e-9 * scale);
    }
    println!("largest deviation of the dispersion relation, of the permanent: {worst:.1e}");
}

fn exact_dispersion_relation(
    parameters: &testkit::flows::FlowParameters,
    flow: &DeformingFlow,
    k: f64,
    theta: f64,
    frequency: Complex,
) -> Complex {
    let two = dd(2.0);
    let (phi, psi, theta) = (dd(parameters.friction_angle), dd(flow.stress.angle), dd(theta));
    let inertia = dd(parameters.moment_of_inertia.unwrap());
    let density = dd(flow.density);
    let (sin_phi, cos_phi) = phi.sin_cos();
    let q = dd(flow.stress.pressure) * sin_phi + dd(parameters.cohesion) * cos_phi;
    let delta = dd(flow.noncoaxiality);
    let (sin_2delta, cos_2delta) = (delta + delta).sin_cos();
    let rate = dd(flow.shear_rate);

    let xi = [theta.cos(), theta.sin()];
    let xi_turned = [-xi[1], xi[0]];
    let (n2, n1) = (psi + psi - theta).sin_cos();
    let beta = (psi - theta) * two;
    let form = beta.cos() - sin_phi;
    let g = [xi[0] - sin_phi * n1, xi[1] - sin_phi * n2];
    let h = [two * q * n2, -(two * q * n1)];

    // c₁₄, c₂₄ and c₁₅, c₂₅: derivatives with respect to p and ψ of the divergence of the stress, sin φ ∇·(p S) with
    // the matrix S of the reflection about the axis at the angle Ψ.
    let (s, c) = (psi + psi).sin_cos();
    let [a1, a2] = flow.stress_angle_gradient.map(dd);
    let [p1, p2] = flow.pressure_gradient.map(dd);
    let c_g = [two * sin_phi * (a1 * s - a2 * c), -(two * sin_phi * (a1 * c + a2 * s))];
    let c_h = [
        two * (sin_phi * (p1 * s - p2 * c) + two * q * (a1 * c + a2 * s)),
        -(two * (sin_phi * (p1 * c + p2 * s) - two * q * (a1 * s - a2 * c))),
    ];
    let tilde = |vector: [DoubleDouble; 2], constant: [DoubleDouble; 2]| {
        [0, 1].map(|i| Complex { re: constant[i], im: dd(k) * vector[i] })
    };
    let (g, h) = (tilde(g, c_g), tilde(h, c_h));

    let spin = dd(flow.half_vorticity) - rate * sin_2delta / sin_phi;
    let c3 = [0, 1].map(|j| {
        let (by_spin, by_inertia) = (flow.spin_gradient[j], flow.inertia_gradient[j]);
        density * (inertia * dd(by_spin) + spin * dd(by_inertia))
    });
    let c33 = density * dd(flow.inertia_rate);
    let c55 = -(dd(4.0) * rate * cos_2delta);
    let c53 = two * sin_phi;

    // Velocity gradient ∇V for ν = 0.
    let (shear, normal) = (psi + delta + psi + delta).sin_cos();
    let half_vorticity = dd(flow.half_vorticity);
    let gradient = [
        [rate * normal, rate * shear - half_vorticity],
        [rate * shear + half_vorticity, -(rate * normal)],
    ];
    let strained = [0, 1].map(|i| gradient[i][0] * xi_turned[0] + gradient[i][1] * xi_turned[1]);

    let e = dd(k) * (xi[0] * dd(flow.velocity[0]) + xi[1] * dd(flow.velocity[1]));
    let y = Complex::from(density) * (frequency + Complex { re: dd(0.0), im: e });
    let times = |x: DoubleDouble, z: Complex| Complex::from(x) * z;
    let inner = times(xi[0], g[0]) + times(xi[1], g[1]);
    let across = times(strained[1], g[0]) - times(strained[0], g[1]);
    let cross = g[0] * h[1] - g[1] * h[0];
    let first = times(c55, inner * y + times(density, across))
        - cross * Complex { re: dd(0.0), im: dd(k) * form };
    first * (times(inertia, y) + c33.into())
        + times(c53 * (c3[0] * xi_turned[0] + c3[1] * xi_turned[1]), cross)
}

/// The double-sliding free-rotating model has one row fewer than columns, so every ς has an eigenvector (the pencil is
/// singular); its rows are independent, so exactly one equation is missing.
#[test]
fn free_rotating_model_has_one_equation_too_few() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let mut random = RandomNumbers::new(470);
        for _ in 0..STATE_COUNT {
            let kind = registry::FREE_ROTATING;
            let (_, model, state) = states::random_case(&mut random, kind, dilatancy);
            let system = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
            let (rows, columns) = system.a.shape();
            assert_eq!((rows + 1, columns), (columns, system.unknowns.len()));
            let wave = [random.signed_uniform(0.3, 3.0), random.signed_uniform(0.3, 3.0)].map(dd);
            let frequency =
                complex(random.signed_uniform(0.3, 3.0), random.signed_uniform(0.3, 3.0));
            let pencil = states::assemble_pencil(&system, wave);
            let full_rank = (0..columns).any(|dropped| {
                let square: Vec<Vec<Complex>> = pencil
                    .iter()
                    .map(|row| {
                        (0..columns)
                            .filter(|&j| j != dropped)
                            .map(|j| crate::support::evaluate_polynomial(&row[j], frequency))
                            .collect()
                    })
                    .collect();
                let sizes: Vec<Vec<f64>> =
                    square.iter().map(|row| row.iter().map(|x| x.abs()).collect()).collect();
                complex_determinant(&square).abs() > 1e-6 * permanent(&sizes)
            });
            assert!(full_rank, "an equation is void");
        }
    }
}
