//! Random models and states without special values, and their values in the variables of the nonlinear equations.

use super::equations::{self, PointFields, PrescribedFields, RotationLaw};
use super::{
    Complex, DifferentiableReal, DoubleDouble, Polynomial, RandomNumbers, dd, permanent,
    polynomial_determinant,
};
use testkit::flows::{FlowParameters, MODEL_CASES, random_dilatancy_angle};
use wellposed_models::flow::state::{Background, DeformingFlow, MaterialState};
use wellposed_models::flow::{FlowKind, Model, RotationKind};
use wellposed_models::registry;
use wellposed_models::{LinearisedSystem, Rounded};

pub use testkit::flows::DilatancyKind;

pub fn random_parameters(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> FlowParameters {
    let friction_angle = random.uniform(0.15, 1.2);
    let cosserat = kind == registry::HARRIS_GREKOVA;
    FlowParameters {
        friction_angle,
        dilatancy_angle: random_dilatancy_angle(
            random,
            kind,
            dilatancy,
            friction_angle,
            [0.1..1.3, 0.1..0.9],
        ),
        cohesion: random.uniform(50.0, 900.0),
        moment_of_inertia: cosserat.then(|| random.uniform(0.02, 0.3)),
        rotational_strength: cosserat.then(|| random.uniform(20.0, 300.0)),
    }
}

/// Random state without special values: the required quantities, gradients and rates are nonzero (density gradient only
/// for ν > 0), |Δ| is between 3° and 85° (absent for a plastic potential), and the other optional quantities are
/// absent.
pub fn random_state(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> MaterialState {
    let mut pair =
        |low: f64, high: f64| [random.signed_uniform(low, high), random.signed_uniform(low, high)];
    let velocity = pair(0.3, 3.0);
    let pressure_gradient = pair(200.0, 4000.0);
    let stress_angle_gradient = pair(0.2, 2.0);
    let spin_gradient = pair(0.3, 3.0);
    let inertia_gradient = pair(0.02, 0.2);
    let density_gradient =
        if dilatancy == DilatancyKind::Zero { [0.0; 2] } else { pair(50.0, 500.0) };
    MaterialState {
        density: random.uniform(700.0, 2500.0),
        pressure: random.uniform(500.0, 5000.0),
        stress_angle: random.signed_uniform(0.1, 3.0),
        shear_rate: random.uniform(0.2, 2.0),
        velocity,
        half_vorticity: random.signed_uniform(0.2, 2.0),
        noncoaxiality: (kind != registry::PLASTIC_POTENTIAL)
            .then(|| random.signed_uniform(0.05, 1.48)),
        pressure_gradient,
        stress_angle_gradient,
        spin_gradient,
        density_gradient,
        spin_acceleration: random.signed_uniform(0.1, 1.0),
        inertia_rate: random.signed_uniform(0.02, 0.2),
        inertia_gradient,
        ..MaterialState::default()
    }
}

pub fn build_model(kind: FlowKind, parameters: &FlowParameters) -> Model {
    parameters.build_model(kind).expect("the constants are within their ranges")
}

/// Random parameters, the model with these parameters, and a random state.
pub fn random_case(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> (FlowParameters, Model, MaterialState) {
    let parameters = random_parameters(random, kind, dilatancy);
    let state = random_state(random, kind, dilatancy);
    (parameters, build_model(kind, &parameters), state)
}

/// A random state of a model with one of its kinds of dilatancy.
pub struct RandomCase {
    pub kind: FlowKind,
    pub dilatancy: DilatancyKind,
    pub parameters: FlowParameters,
    pub model: Model,
    pub state: MaterialState,
}

/// Calls `check` for `count` random states of each of the [`MODEL_CASES`]; the sequence of random numbers of the n-th
/// one has the seed `first_seed` + n.
pub fn for_random_cases(
    first_seed: u64,
    count: usize,
    mut check: impl FnMut(&mut RandomNumbers, RandomCase),
) {
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(first_seed + seed as u64);
        for _ in 0..count {
            let (parameters, model, state) = random_case(&mut random, kind, dilatancy);
            check(&mut random, RandomCase { kind, dilatancy, parameters, model, state });
        }
    }
}

/// The state without gradients (other than the velocity gradient) and without the rate of the moment of inertia.
pub fn without_gradients(state: MaterialState) -> MaterialState {
    MaterialState {
        pressure_gradient: [0.0; 2],
        stress_angle_gradient: [0.0; 2],
        spin_gradient: [0.0; 2],
        density_gradient: [0.0; 2],
        inertia_gradient: [0.0; 2],
        inertia_rate: 0.0,
        ..state
    }
}

pub fn complete_flow(model: &Model, state: &MaterialState) -> DeformingFlow {
    match model.background(state).expect("the state is admissible") {
        Background::FullyDeforming(flow) => flow,
        background => panic!("on yield by construction, yet {background:?}"),
    }
}

pub fn assemble_symbol(model: &Model, flow: &DeformingFlow) -> LinearisedSystem<2> {
    let mut system = LinearisedSystem::default();
    model.write_symbol(flow, &mut system);
    system
}

/// Background of the crate in the variables of the nonlinear equations. Quantities derived by the crate are taken from
/// `flow`, so that an error of the crate makes the residuals nonzero. Quantities that the model does not determine
/// (∂ₜp, body force, ∂ₜψ except in double shearing) are random.
pub fn assemble_background_fields(
    random: &mut RandomNumbers,
    parameters: &FlowParameters,
    kind: FlowKind,
    state: &MaterialState,
    flow: &DeformingFlow,
) -> (PrescribedFields<DoubleDouble>, PointFields<DoubleDouble>) {
    let exact = |x: Rounded| dd(x.value);
    let body_force = [random.signed_uniform(1.0, 10.0), random.signed_uniform(1.0, 10.0)].map(dd);
    let velocity = flow.velocity.map(dd);
    let along = |gradient: [f64; 2]| velocity[0] * dd(gradient[0]) + velocity[1] * dd(gradient[1]);
    let gradient = flow.velocity_gradient;
    let convected =
        [0, 1].map(|i| velocity[0] * exact(gradient[i][0]) + velocity[1] * exact(gradient[i][1]));
    let density = dd(flow.density);
    let spin = flow.spin.map_or(dd(0.3), exact);
    let angle_rate = dd(flow.stress_angle_rate.unwrap_or_else(|| random.signed_uniform(0.3, 1.0)));
    let fields = PointFields {
        z: [
            velocity[0],
            velocity[1],
            spin,
            dd(flow.stress.pressure),
            dd(flow.stress.angle),
            density,
        ],
        time_derivatives: [
            exact(flow.acceleration[0]) + body_force[0] - convected[0],
            exact(flow.acceleration[1]) + body_force[1] - convected[1],
            dd(state.spin_acceleration) - along(flow.spin_gradient),
            dd(random.signed_uniform(10.0, 100.0)),
            angle_rate - along(flow.stress_angle_gradient),
            -(density * (exact(gradient[0][0]) + exact(gradient[1][1])))
                - along(flow.density_gradient),
        ],
        space_derivatives: [0, 1].map(|j| {
            [
                exact(gradient[0][j]),
                exact(gradient[1][j]),
                dd(flow.spin_gradient[j]),
                dd(flow.pressure_gradient[j]),
                dd(flow.stress_angle_gradient[j]),
                dd(flow.density_gradient[j]),
            ]
        }),
    };
    let given = PrescribedFields {
        rotation: match kind.rotation() {
            RotationKind::IntrinsicSpin | RotationKind::Free => RotationLaw::IntrinsicSpin,
            RotationKind::StressAxes => RotationLaw::StressAxes,
            RotationKind::None => RotationLaw::PlasticPotential,
        },
        friction_angle: dd(parameters.friction_angle),
        dilatancy_angle: dd(parameters.dilatancy_angle),
        cohesion: dd(parameters.cohesion),
        inertia: dd(parameters.moment_of_inertia.unwrap_or(0.07)),
        inertia_time_derivative: dd(flow.inertia_rate) - along(flow.inertia_gradient),
        inertia_gradient: flow.inertia_gradient.map(dd),
        rotational_stress: dd(flow.stress.rotational_stress),
        body_force,
        body_moment: dd(flow.body_moment.unwrap_or_default()),
    };
    (given, fields)
}

/// Background from the nonlinear equations in 31 digits, independent of the crate: tr d and rotation from the flow
/// rule, accelerations and density rate from the balances, body moment from the balance of spin. Only Δ and r are taken
/// from the crate.
pub fn solve_background_fields(
    random: &mut RandomNumbers,
    parameters: &FlowParameters,
    kind: FlowKind,
    state: &MaterialState,
    flow: &DeformingFlow,
) -> (PrescribedFields<DoubleDouble>, PointFields<DoubleDouble>) {
    let (mut given, mut fields) = assemble_background_fields(random, parameters, kind, state, flow);
    let zero = dd(0.0);
    let angle = dd(state.stress_angle) + dd(flow.noncoaxiality);
    let (sine, cosine) = (angle + angle).sin_cos();
    let rate = dd(state.shear_rate);
    let spin = dd(state.half_vorticity);
    let set_gradient = |fields: &mut PointFields<DoubleDouble>, half_trace: DoubleDouble| {
        fields.space_derivatives[0][0] = half_trace + rate * cosine;
        fields.space_derivatives[1][0] = rate * sine - spin;
        fields.space_derivatives[0][1] = rate * sine + spin;
        fields.space_derivatives[1][1] = half_trace - rate * cosine;
    };
    // Assigns by `set` the value of a quantity at which the residual `row`, a linear function of the quantity,
    // vanishes.
    let solve = |fields: &mut PointFields<DoubleDouble>,
                 row: usize,
                 set: &dyn Fn(&mut PointFields<DoubleDouble>, DoubleDouble)| {
        set(fields, zero);
        let at_zero = equations::residuals(&given, fields)[row];
        set(fields, dd(1.0));
        let at_one = equations::residuals(&given, fields)[row];
        set(fields, at_zero / (at_zero - at_one));
    };
    solve(&mut fields, 3, &set_gradient);
    match given.rotation {
        RotationLaw::IntrinsicSpin => solve(&mut fields, 4, &|f, x| f.z[equations::SPIN_INDEX] = x),
        RotationLaw::StressAxes => {
            solve(&mut fields, 4, &|f, x| f.time_derivatives[equations::STRESS_ANGLE_INDEX] = x)
        }
        RotationLaw::PlasticPotential => {}
    }
    for (row, unknown) in [(0, 0), (1, 1), (5, equations::DENSITY_INDEX)] {
        solve(&mut fields, row, &|f, x| f.time_derivatives[unknown] = x);
    }
    given.body_moment = zero;
    given.body_moment = equations::residuals(&given, &fields)[2] / dd(state.density);
    (given, fields)
}

/// Indices in [`equations::UNKNOWNS`] of the columns of `system`, by name.
pub fn unknown_indices(system: &LinearisedSystem<2>) -> Vec<usize> {
    let position_of = |name| equations::UNKNOWNS.iter().position(|&own| own == name);
    system.unknowns.iter().map(|u| position_of(u.name).expect(u.name)).collect()
}

/// Indices in [`equations::EQUATIONS`] of the rows of `system`, by name.
pub fn equation_indices(system: &LinearisedSystem<2>) -> Vec<usize> {
    let position_of = |name: &str| {
        let name =
            name.strip_prefix("flow rule: ").unwrap_or(name).replace("coaxiality", "rotation");
        equations::EQUATIONS.iter().position(|&own| own == name)
    };
    system.equations.iter().map(|name| position_of(name).expect(name)).collect()
}

/// Matrix ςA + i k·(B + V A) + C of `system` as polynomials in ς.
pub fn assemble_pencil(
    system: &LinearisedSystem<2>,
    wave: [DoubleDouble; 2],
) -> Vec<Vec<Polynomial>> {
    let (n, m) = system.a.shape();
    (0..n)
        .map(|i| {
            (0..m)
                .map(|j| {
                    let a = dd(system.a[(i, j)].value);
                    let im = [0, 1]
                        .map(|d| {
                            wave[d] * (dd(system.b[d][(i, j)].value) + dd(system.velocity[d]) * a)
                        })
                        .into_iter()
                        .fold(dd(0.0), |sum, x| sum + x);
                    let constant = Complex { re: dd(system.c[(i, j)].value), im };
                    if a.high == 0.0 { vec![constant] } else { vec![constant, a.into()] }
                })
                .map(|p: Polynomial| {
                    let zero = p.len() == 1 && p[0].re.high == 0.0 && p[0].im.high == 0.0;
                    if zero { vec![] } else { p }
                })
                .collect()
        })
        .collect()
}

/// Determinant det(ςA + i k·(B + V A) + C) as a polynomial in ς.
pub fn dispersion_polynomial(system: &LinearisedSystem<2>, wave: [DoubleDouble; 2]) -> Polynomial {
    polynomial_determinant(&assemble_pencil(system, wave))
}

/// Sum of the absolute values of all terms of det(ςA + i k·(B + V A) + C) at |ς| = `frequency`.
pub fn dispersion_permanent(
    system: &LinearisedSystem<2>,
    wave: [DoubleDouble; 2],
    frequency: f64,
) -> f64 {
    let sizes: Vec<Vec<f64>> = assemble_pencil(system, wave)
        .iter()
        .map(|row| {
            row.iter()
                .map(|p| p.iter().rev().fold(0.0, |sum, c| sum * frequency + c.abs()))
                .collect()
        })
        .collect();
    permanent(&sizes)
}
