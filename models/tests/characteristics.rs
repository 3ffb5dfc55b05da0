//! Determinants of the linearised systems against closed forms: the steady characteristics of Harris & Grekova (2005),
//! eq. (70), and the exact dispersion relation for ν = 0.
//!
//! The determinants are expanded over all permutations in 31 digits from the entries in double precision. The error is
//! then due to the rounding of the entries, about ten units in the last place each. Tolerance: 50 × 6 u times the sum
//! of the absolute values of all terms (the permanent).

mod support;

use support::states::{self, Dilatancy, VARIANTS};
use support::{Complex, Random, Real, Wide, complex, number_determinant, permanent, wide};
use wellposed_models::LinearisedSystem;
use wellposed_models::flow::state::Flow;
use wellposed_models::registry;

const STATES: usize = 300;
const TOLERANCE: f64 = 300.0 * f64::EPSILON / 2.0;

/// Matrix ξ₁(B¹ + V₁A) + ξ₂(B² + V₂A) of the steady equations.
fn steady(system: &LinearisedSystem<2>, direction: [Wide; 2]) -> Vec<Vec<Wide>> {
    let (rows, columns) = system.a.shape();
    let entry = |i: usize, j: usize| {
        (0..2).fold(wide(0.0), |sum, d| {
            let convected = wide(system.velocity[d]) * wide(system.a[(i, j)].value);
            sum + direction[d] * (wide(system.b[d][(i, j)].value) + convected)
        })
    };
    (0..rows).map(|i| (0..columns).map(|j| entry(i, j)).collect()).collect()
}

fn steady_determinant(system: &LinearisedSystem<2>, direction: [Wide; 2]) -> (f64, f64) {
    let matrix = steady(system, direction);
    let complex: Vec<Vec<Complex>> =
        matrix.iter().map(|row| row.iter().map(|&x| x.into()).collect()).collect();
    let sizes: Vec<Vec<f64>> =
        matrix.iter().map(|row| row.iter().map(|x| x.value().abs()).collect()).collect();
    (number_determinant(&complex).re.value(), permanent(&sizes))
}

/// Quadratic form 𝒜 of eq. (69).
fn quadratic_form(angle: f64, phi: f64, [x, y]: [Wide; 2]) -> Wide {
    let angle = wide(angle);
    let (s, c) = (angle + angle).sin_cos();
    let sin_phi = wide(phi).sin();
    (c - sin_phi) * x * x + wide(2.0) * s * x * y - (c + sin_phi) * y * y
}

/// The determinant of the steady equations equals eq. (70) for Harris–Grekova and the analogous formulas below for the
/// other models. In the crate the mass row and the density column are last, in the paper fourth: two even permutations,
/// which leave the sign unchanged. e = ξ·V.
///
/// - Harris–Grekova, ν > 0: −2 q ρI cos(φ − 2ν) e²𝒜², as printed. For ν = 0 the mass row and the density column are
///   absent, and with them one factor e: −2 q ρI cos φ e 𝒜².
/// - Plastic potential: without spin the factor ρIe is absent. The kinematic factor cos(φ − 2ν) 𝒜 of (68) becomes 𝒜
///   with sin ν in place of sin φ, so that stress and velocity characteristics differ unless ν = φ.
/// - Double shearing: the factor ρIe is absent, and the rotation row has the entry 2 sin(φ − ν) e in the column of ψ.
///   The permutations through this entry add −ρe · 2 sin(φ − ν) e · (e₅₁e₁₄ + e₅₂e₂₄), in the numbering of the paper
///   with column 4 for p. This term makes the steady equations depend on inertia.
#[test]
fn steady_determinant_is_eq_70() {
    let mut worst = 0.0f64;
    for (seed, (kind, dilatancy)) in VARIANTS.into_iter().enumerate() {
        if kind == registry::FREE_ROTATING {
            continue;
        }
        let mut random = Random::new(400 + seed as u64);
        for _ in 0..STATES {
            let parameters = states::random_parameters(&mut random, kind, dilatancy);
            let model = states::model(kind, &parameters);
            let state = states::random_state(&mut random, kind, dilatancy);
            let flow = states::flow(&model, &state);
            let system = states::symbol(&model, &flow);
            let direction = [random.generic(0.2, 2.0), random.generic(0.2, 2.0)].map(wide);
            let (determinant, size) = steady_determinant(&system, direction);

            let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
            let form = |angle: f64| quadratic_form(state.stress_angle, angle, direction);
            let density = wide(state.density);
            let q = wide(state.pressure) * wide(phi).sin()
                + wide(parameters.cohesion) * wide(phi).cos();
            let e = direction[0] * wide(state.velocity[0]) + direction[1] * wide(state.velocity[1]);
            let kinematic = match kind {
                own if own == registry::PLASTIC_POTENTIAL => form(nu),
                _ => (wide(phi) - wide(nu) - wide(nu)).cos() * form(phi),
            };
            let mut expected = -(wide(2.0) * q * form(phi) * kinematic);
            if kind == registry::DOUBLE_SHEARING {
                // ξ − sin φ n and cos(φ − ν) ξ − sin ν n, where n is ξ reflected about the axis Ψ.
                let angle = wide(state.stress_angle);
                let (s, c) = (angle + angle).sin_cos();
                let along = |sine: Wide| {
                    [
                        direction[0] - sine * (c * direction[0] + s * direction[1]),
                        direction[1] - sine * (s * direction[0] - c * direction[1]),
                    ]
                };
                let difference = (wide(phi) - wide(nu)).cos();
                let (p, v) = (along(wide(phi).sin()), along(wide(nu).sin() / difference));
                let inner = difference * (p[0] * v[0] + p[1] * v[1]);
                let rotation = wide(2.0) * (wide(phi) - wide(nu)).sin();
                expected = expected - density * e * rotation * e * inner;
            }
            if kind == registry::HARRIS_GREKOVA {
                let inertia = wide(parameters.moment_of_inertia.unwrap());
                expected = expected * density * inertia * e;
            }
            if dilatancy != Dilatancy::Zero {
                expected = expected * e;
            }
            let relative = (determinant - expected.value()).abs() / size;
            worst = worst.max(relative);
            assert!(
                relative < TOLERANCE,
                "{kind:?} {dilatancy:?}: {determinant:e} against {:e} of {size:e}",
                expected.value()
            );
        }
    }
    println!("largest deviation from (70), of the permanent: {worst:.1e}");
}

/// In the Harris–Grekova model the characteristic directions ψ_σ ± ε and the streamlines are double for general ν: the
/// determinant vanishes quadratically there, since stress and velocity characteristics coincide.
#[test]
fn harris_grekova_characteristics_are_double() {
    let mut random = Random::new(450);
    for _ in 0..STATES {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(&mut random, kind, Dilatancy::Positive);
        let model = states::model(kind, &parameters);
        let state = states::random_state(&mut random, kind, Dilatancy::Positive);
        let system = states::symbol(&model, &states::flow(&model, &state));
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
                let (s, c) = wide(line + h).sin_cos();
                steady_determinant(&system, [-s, c]).0
            };
            let (h, k) = (1e-4, 5e-5);
            // The ratio is 4 up to the cubic term, of relative size a few h/(distance to the other characteristics).
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
/// at random complex ς and real k. The left-hand side is the determinant divided by −cos φ ik: the crate writes
/// continuity as cos φ ik ξ·v, and elimination along ξ⊥ changes the sign once. All terms are computed here from the
/// state.
#[test]
fn dispersion_relation_for_zero_dilatancy() {
    let mut random = Random::new(460);
    let mut worst = 0.0f64;
    for _ in 0..STATES {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(&mut random, kind, Dilatancy::Zero);
        let model = states::model(kind, &parameters);
        let state = states::random_state(&mut random, kind, Dilatancy::Zero);
        let flow = states::flow(&model, &state);
        let system = states::symbol(&model, &flow);
        let k = 10f64.powf(random.within(-2.0, 4.0));
        let theta = random.generic(0.0, 3.0);
        let size = k * 10f64.powf(random.within(-1.0, 1.0));
        let frequency = complex(size * random.generic(0.3, 1.0), size * random.generic(0.3, 1.0));

        let (sine, cosine) = wide(theta).sin_cos();
        let wave = [wide(k) * cosine, wide(k) * sine];
        let determinant = support::evaluate(&states::dispersion(&system, wave), frequency);
        let scale = states::dispersion_size(&system, wave, frequency.abs());
        let factor =
            -(Complex { re: wide(0.0), im: wide(k) * wide(parameters.friction_angle).cos() });
        let relation = closed_dispersion(&parameters, &flow, k, theta, frequency);
        let relative = (determinant - factor * relation).abs() / scale;
        worst = worst.max(relative);
        assert!(relative < TOLERANCE, "off by {relative:e} of the sum of all terms");
        // The comparison is significant: the determinant is not negligible relative to the scale.
        assert!(determinant.abs() > 1e-9 * scale);
    }
    println!("largest deviation of the dispersion relation, of the permanent: {worst:.1e}");
}

fn closed_dispersion(
    parameters: &testkit::flows::Parameters,
    flow: &Flow,
    k: f64,
    theta: f64,
    frequency: Complex,
) -> Complex {
    let two = wide(2.0);
    let (phi, psi, theta) = (wide(parameters.friction_angle), wide(flow.stress.angle), wide(theta));
    let inertia = wide(parameters.moment_of_inertia.unwrap());
    let density = wide(flow.density);
    let (sin_phi, cos_phi) = phi.sin_cos();
    let q = wide(flow.stress.pressure) * sin_phi + wide(parameters.cohesion) * cos_phi;
    let delta = wide(flow.noncoaxiality);
    let (sin_2delta, cos_2delta) = (delta + delta).sin_cos();
    let rate = wide(flow.shear_rate);

    let xi = [theta.cos(), theta.sin()];
    let xi_turned = [-xi[1], xi[0]];
    let (n2, n1) = (psi + psi - theta).sin_cos();
    let beta = (psi - theta) * two;
    let form = beta.cos() - sin_phi;
    let g = [xi[0] - sin_phi * n1, xi[1] - sin_phi * n2];
    let h = [two * q * n2, -(two * q * n1)];

    // c₁₄, c₂₄ and c₁₅, c₂₅: derivatives with respect to p and ψ of the divergence of the stress, sin φ ∇·(p S) with
    // the reflection S about the axis Ψ.
    let (s, c) = (psi + psi).sin_cos();
    let [a1, a2] = flow.stress_angle_gradient.map(wide);
    let [p1, p2] = flow.pressure_gradient.map(wide);
    let c_g = [two * sin_phi * (a1 * s - a2 * c), -(two * sin_phi * (a1 * c + a2 * s))];
    let c_h = [
        two * (sin_phi * (p1 * s - p2 * c) + two * q * (a1 * c + a2 * s)),
        -(two * (sin_phi * (p1 * c + p2 * s) - two * q * (a1 * s - a2 * c))),
    ];
    let tilde = |vector: [Wide; 2], constant: [Wide; 2]| {
        [0, 1].map(|i| Complex { re: constant[i], im: wide(k) * vector[i] })
    };
    let (g, h) = (tilde(g, c_g), tilde(h, c_h));

    let spin = wide(flow.half_vorticity) - rate * sin_2delta / sin_phi;
    let c3 = [0, 1].map(|j| {
        let (by_spin, by_inertia) = (flow.spin_gradient[j], flow.inertia_gradient[j]);
        density * (inertia * wide(by_spin) + spin * wide(by_inertia))
    });
    let c33 = density * wide(flow.inertia_rate);
    let c55 = -(wide(4.0) * rate * cos_2delta);
    let c53 = two * sin_phi;

    // Velocity gradient ∇V for ν = 0.
    let (shear, normal) = (psi + delta + psi + delta).sin_cos();
    let turn = wide(flow.half_vorticity);
    let gradient = [[rate * normal, rate * shear - turn], [rate * shear + turn, -(rate * normal)]];
    let strained = [0, 1].map(|i| gradient[i][0] * xi_turned[0] + gradient[i][1] * xi_turned[1]);

    let e = wide(k) * (xi[0] * wide(flow.velocity[0]) + xi[1] * wide(flow.velocity[1]));
    let y = Complex::from(density) * (frequency + Complex { re: wide(0.0), im: e });
    let times = |x: Wide, z: Complex| Complex::from(x) * z;
    let inner = times(xi[0], g[0]) + times(xi[1], g[1]);
    let across = times(strained[1], g[0]) - times(strained[0], g[1]);
    let cross = g[0] * h[1] - g[1] * h[0];
    let first = times(c55, inner * y + times(density, across))
        - cross * Complex { re: wide(0.0), im: wide(k) * form };
    first * (times(inertia, y) + c33.into())
        + times(c53 * (c3[0] * xi_turned[0] + c3[1] * xi_turned[1]), cross)
}

/// The double-sliding free-rotating model has one row fewer than columns, so every ς has an eigenvector (the pencil is
/// singular); its rows are independent, so exactly one equation is missing.
#[test]
fn free_rotating_lacks_one_equation() {
    for dilatancy in [Dilatancy::Zero, Dilatancy::Positive] {
        let mut random = Random::new(470);
        for _ in 0..STATES {
            let kind = registry::FREE_ROTATING;
            let parameters = states::random_parameters(&mut random, kind, dilatancy);
            let model = states::model(kind, &parameters);
            let state = states::random_state(&mut random, kind, dilatancy);
            let system = states::symbol(&model, &states::flow(&model, &state));
            let (rows, columns) = system.a.shape();
            assert_eq!((rows + 1, columns), (columns, system.unknowns.len()));
            let wave = [random.generic(0.3, 3.0), random.generic(0.3, 3.0)].map(wide);
            let frequency = complex(random.generic(0.3, 3.0), random.generic(0.3, 3.0));
            let pencil = states::pencil(&system, wave);
            let full_rank = (0..columns).any(|dropped| {
                let square: Vec<Vec<Complex>> = pencil
                    .iter()
                    .map(|row| {
                        (0..columns)
                            .filter(|&j| j != dropped)
                            .map(|j| support::evaluate(&row[j], frequency))
                            .collect()
                    })
                    .collect();
                let sizes: Vec<Vec<f64>> =
                    square.iter().map(|row| row.iter().map(|x| x.abs()).collect()).collect();
                number_determinant(&square).abs() > 1e-6 * permanent(&sizes)
            });
            assert!(full_rank, "an equation is void");
        }
    }
}
