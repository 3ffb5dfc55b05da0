//! Random fully deforming states of the granular-flow models, and their linearised equations in
//! 256 bits from formulas written for the tests alone.

use super::exact::System256;
use super::real256::Real256;
use models::LinearisedSystem;
use models::flow::state::{Background, DeformingFlow, MaterialState};
use models::flow::{FlowKind, Model};
use models::registry;
pub use testkit::flows::DilatancyKind;
use testkit::flows::{FlowParameters, random_dilatancy_angle};
pub use testkit::random::RandomNumbers;

/// Random-number generator of the tests of this crate.
pub fn seeded_generator(seed: u64) -> RandomNumbers {
    let mut random = RandomNumbers::with_salt(seed, 0x5bf0_3635);
    random.unit_interval();
    random
}

/// A model and a state, with the flow and the linearised equations that follow from them.
#[derive(Debug)]
pub struct FlowSample {
    pub parameters: FlowParameters,
    pub state: MaterialState,
    pub model: Model,
    pub flow: DeformingFlow,
    pub system: LinearisedSystem<2>,
}

impl FlowSample {
    pub fn new(kind: FlowKind, parameters: FlowParameters, state: MaterialState) -> Self {
        let model = parameters.build_model(kind).expect("constants within their ranges");
        let flow = match model.background(&state).expect("an admissible state") {
            Background::FullyDeforming(flow) => flow,
            elsewhere => panic!("on yield by construction, yet {elsewhere:?}"),
        };
        let mut system = LinearisedSystem::default();
        model.write_symbol(&flow, &mut system);
        Self { parameters, state, model, flow, system }
    }

    pub fn kind(&self) -> FlowKind {
        self.model.kind()
    }
}

/// The sample with another non-coaxiality, rad.
pub fn with_noncoaxiality(sample: &FlowSample, noncoaxiality: f64) -> FlowSample {
    let state = MaterialState { noncoaxiality: Some(noncoaxiality), ..sample.state };
    FlowSample::new(sample.kind(), sample.parameters, state)
}

/// Random sample in the widest ranges: densities 1e2…1e4 kg/m³, pressures 1…1e6 Pa, shear rates 1e-3…1e3 1/s, moments
/// of inertia 1e-9…1e-2 m², friction angles 0.03…1.5 rad, non-coaxialities −1.57…1.57 rad, all stress angles.
pub fn sample_wide_range(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> FlowSample {
    let friction_angle = random.uniform(0.03, 1.5);
    let cosserat = kind == registry::HARRIS_GREKOVA;
    let pressure = random.log_uniform(1.0, 1e6);
    let inertia = random.log_uniform(1e-9, 1e-2);
    let shear_rate = random.log_uniform(1e-3, 1e3);
    let density = random.log_uniform(1e2, 1e4);
    let parameters = FlowParameters {
        friction_angle,
        dilatancy_angle: random_dilatancy_angle(
            random,
            kind,
            dilatancy,
            friction_angle,
            [0.01..1.5, 0.02..0.98],
        ),
        cohesion: if random.bernoulli(0.5) {
            0.0
        } else {
            pressure * random.log_uniform(1e-3, 10.0)
        },
        moment_of_inertia: cosserat.then_some(inertia),
        rotational_strength: cosserat.then(|| {
            if random.bernoulli(0.4) { 0.0 } else { pressure * random.log_uniform(1e-3, 1.0) }
        }),
    };
    let mut state = MaterialState {
        density,
        pressure,
        stress_angle: random.uniform(-std::f64::consts::PI, std::f64::consts::PI),
        shear_rate,
        noncoaxiality: (kind != registry::PLASTIC_POTENTIAL).then(|| random.uniform(-1.57, 1.57)),
        ..MaterialState::default()
    };
    if random.bernoulli(0.6) {
        state.velocity =
            [random.signed_log_uniform(1e-2, 10.0), random.signed_log_uniform(1e-2, 10.0)];
    }
    if random.bernoulli(0.6) {
        state.half_vorticity = shear_rate * random.signed_log_uniform(1e-2, 10.0);
    }
    if random.bernoulli(0.6) {
        let mut pair = |size: f64| [0; 2].map(|_| size * random.signed_log_uniform(1e-2, 1e2));
        state.pressure_gradient = pair(pressure);
        state.stress_angle_gradient = pair(1.0);
        if dilatancy != DilatancyKind::Zero {
            state.density_gradient = pair(0.1 * density);
        }
        if cosserat {
            state.spin_gradient = pair(shear_rate);
        }
    }
    if cosserat && random.bernoulli(0.6) {
        state.inertia_rate = inertia * shear_rate * random.signed_log_uniform(1e-2, 10.0);
        state.inertia_gradient = [0; 2].map(|_| inertia * random.signed_log_uniform(1e-2, 10.0));
    }
    FlowSample::new(kind, parameters, state)
}

/// Random sample with constants of comparable size, so that asymptotic behaviour appears at moderate wave numbers.
pub fn sample_order_one(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
    gradients: bool,
) -> FlowSample {
    let friction_angle = random.uniform(0.2, 1.2);
    let cosserat = kind == registry::HARRIS_GREKOVA;
    let parameters = FlowParameters {
        friction_angle,
        dilatancy_angle: random_dilatancy_angle(
            random,
            kind,
            dilatancy,
            friction_angle,
            [0.1..1.3, 0.1..0.9],
        ),
        cohesion: random.uniform(0.0, 1.0),
        moment_of_inertia: cosserat.then(|| random.uniform(0.1, 1.0)),
        rotational_strength: cosserat
            .then(|| if random.bernoulli(0.5) { 0.0 } else { random.uniform(0.1, 1.0) }),
    };
    let mut state = MaterialState {
        density: random.uniform(0.5, 2.0),
        pressure: random.uniform(0.5, 3.0),
        stress_angle: random.uniform(-3.0, 3.0),
        shear_rate: random.uniform(0.3, 2.0),
        half_vorticity: random.uniform(-2.0, 2.0),
        noncoaxiality: (kind != registry::PLASTIC_POTENTIAL).then(|| random.uniform(-1.55, 1.55)),
        velocity: [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)],
        ..MaterialState::default()
    };
    if gradients {
        let mut pair = || [0; 2].map(|_| random.signed_log_uniform(0.2, 2.0));
        state.pressure_gradient = pair();
        state.stress_angle_gradient = pair();
        if dilatancy != DilatancyKind::Zero {
            state.density_gradient = pair();
        }
        if cosserat {
            state.spin_gradient = pair();
            state.inertia_gradient = pair();
            state.inertia_rate = random.signed_log_uniform(0.2, 2.0);
        }
    }
    FlowSample::new(kind, parameters, state)
}

/// The linearised equations of a sample in 256 bits, in the crate's order of rows and columns.
///
/// With N(ψ) = [[cos 2ψ, sin 2ψ], [sin 2ψ, −cos 2ψ]] the stress is −p + q N, q = p sin φ + c cos φ; momentum reads ρ
/// Dv/Dt = −∇p + ∇·(q N), the flow rule e_v tr d = s_v d:N and 2 e_r (ω − s₂₁) = −½ c_r d:N′, the balance of the spin ρ
/// I Dω/Dt + ρ ω DI/Dt = 2r + ρG with the rotational stress r and the body moment G; all linearised about the
/// deformation rate D = ½ tr D + Q_D N(Ψ_D), for which D:N = 2 Q_D cos 2Δ, D:N′ = 4 Q_D sin 2Δ, and N″ = −4N.
pub fn reference_system(sample: &FlowSample) -> System256 {
    let FlowSample { parameters, state, flow, .. } = sample;
    let kind = sample.kind();
    let w = Real256::from;
    let (one, zero) = (w(1.0), Real256::ZERO);
    let phi = w(parameters.friction_angle);
    let nu = w(parameters.dilatancy_angle);
    let dilatant = parameters.dilatancy_angle > 0.0;
    let (sin_phi, cos_phi) = phi.sin_cos();
    let (sin_nu, cos_nu) = nu.sin_cos();
    let (sin_gap, cos_gap) = (phi - nu).sin_cos();
    let (e_v, s_v, e_r, c_r) = match kind {
        own if own == registry::PLASTIC_POTENTIAL => (one, sin_nu, zero, one),
        _ => (cos_gap, sin_nu, sin_gap, cos_nu),
    };
    let q = w(state.pressure) * sin_phi + w(parameters.cohesion) * cos_phi;
    let rho = w(state.density);
    let tensor = |angle: Real256| {
        let (s, c) = angle.multiply_by_power_of_two(1).sin_cos();
        [[c, s], [s, -c]]
    };
    let rate_of = |n: [[Real256; 2]; 2]| {
        let (c, s) = (n[0][0].multiply_by_power_of_two(1), n[0][1].multiply_by_power_of_two(1));
        [[-s, c], [c, s]]
    };
    let psi = w(state.stress_angle);
    let n = tensor(psi);
    let n1 = rate_of(n);
    let delta = w(flow.noncoaxiality);
    let (sin_2d, cos_2d) = delta.multiply_by_power_of_two(1).sin_cos();
    let shear_rate = w(state.shear_rate);
    let times =
        |m: [[Real256; 2]; 2], x: [Real256; 2]| [0, 1].map(|i| m[i][0] * x[0] + m[i][1] * x[1]);
    let grad_p = state.pressure_gradient.map(w);
    let grad_psi = state.stress_angle_gradient.map(w);

    // ∇V is D = ½ tr D + Q_D N(Ψ_D) plus the rotation at half the vorticity.
    let half_trace = if dilatant { s_v * e_v.reciprocal() * shear_rate * cos_2d } else { zero };
    let direction = tensor(psi + delta);
    let turn = w(state.half_vorticity);
    let gradient = [
        [half_trace + shear_rate * direction[0][0], shear_rate * direction[0][1] - turn],
        [shear_rate * direction[1][0] + turn, half_trace + shear_rate * direction[1][1]],
    ];
    let n_p = times(n, grad_p);
    let n1_psi = times(n1, grad_psi);
    let n1_p = times(n1, grad_p);
    let n_psi = times(n, grad_psi);

    // Unknowns v₁, v₂, ω, p, ψ, ρ; equations momentum 1, 2, spin, volume, rotation, mass.
    let mut m = vec![vec![[Real256::ZERO; 4]; 6]; 6];
    for i in 0..2 {
        m[i][i][0] = rho;
        for j in 0..2 {
            m[i][j][3] = rho * gradient[i][j];
            let unit = if i == j { one } else { zero };
            m[i][3][1 + j] = unit - sin_phi * n[i][j];
            m[i][4][1 + j] = -(q * n1[i][j]);
        }
        m[i][3][3] = -(sin_phi * n1_psi[i]);
        m[i][4][3] = (q * n_psi[i]).multiply_by_power_of_two(2) - sin_phi * n1_p[i];
        m[i][5][3] = (sin_phi * n_p[i] - grad_p[i] + q * n1_psi[i]) * rho.reciprocal();
    }
    for i in 0..2 {
        for j in 0..2 {
            let unit = if i == j { one } else { zero };
            m[3][i][1 + j] = e_v * unit - s_v * n[i][j];
            m[4][i][1 + j] = (c_r * n1[i][j]).multiply_by_power_of_two(-1);
        }
    }
    m[4][0][2] += e_r;
    m[4][1][1] += -e_r;
    m[3][4][3] = -(s_v * shear_rate * sin_2d).multiply_by_power_of_two(2);
    m[4][4][3] = -(c_r * shear_rate * cos_2d).multiply_by_power_of_two(2);
    match kind {
        own if own == registry::HARRIS_GREKOVA => {
            let inertia = w(parameters.moment_of_inertia.expect("given"));
            let spin = turn - c_r * e_r.reciprocal() * shear_rate * sin_2d;
            m[4][2][3] = e_r.multiply_by_power_of_two(1);
            m[2][2][0] = rho * inertia;
            m[2][2][3] = rho * w(state.inertia_rate);
            for (j, entry) in m[2].iter_mut().take(2).enumerate() {
                entry[3] = rho
                    * (inertia * w(state.spin_gradient[j]) + spin * w(state.inertia_gradient[j]));
            }
            // The rotational stress r opposes the relative rotation ω − s₂₁ = −(c_r/e_r) Q_D sin 2Δ.
            let strength = w(parameters.rotational_strength.expect("given"));
            let rotational = state.rotational_stress.map_or(
                if sin_2d.is_zero() {
                    zero
                } else if sin_2d.is_negative() {
                    -strength
                } else {
                    strength
                },
                w,
            );
            m[2][5][3] = rotational.multiply_by_power_of_two(1) * rho.reciprocal();
        }
        own if own == registry::DOUBLE_SHEARING => {
            m[4][4][0] = e_r.multiply_by_power_of_two(1);
            for j in 0..2 {
                m[4][j][3] = (e_r * grad_psi[j]).multiply_by_power_of_two(1);
            }
        }
        _ => {}
    }
    m[5][5][0] = one;
    m[5][5][3] = gradient[0][0] + gradient[1][1];
    for j in 0..2 {
        m[5][j][1 + j] = rho;
        m[5][j][3] = w(state.density_gradient[j]);
    }

    const UNKNOWN_NAMES: [&str; 6] =
        ["velocity 1", "velocity 2", "spin", "pressure", "stress angle", "density"];
    const EQUATION_NAMES: [&str; 6] =
        ["momentum 1", "momentum 2", "spin", "flow rule: volume", "flow rule: rotation", "mass"];
    let place = |names: &[&str], name: &str| {
        let name = name.replace("coaxiality", "rotation");
        names.iter().position(|&own| own == name).expect("a known name")
    };
    let entries: Vec<Vec<[Real256; 4]>> = sample
        .system
        .equations
        .iter()
        .map(|equation| {
            let row = place(&EQUATION_NAMES, equation);
            let columns = sample.system.unknowns.iter();
            columns.map(|u| m[row][place(&UNKNOWN_NAMES, u.name)]).collect()
        })
        .collect();
    System256 { size: entries.len(), entries }
}
