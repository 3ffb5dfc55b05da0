//! Random models and states with generic constants, and their values in the variables of the nonlinear equations.

use super::equations::{self, Fields, Prescribed, Rotation};
use super::{Complex, Polynomial, Random, Real, Wide, determinant, permanent, wide};
use testkit::flows::Parameters;
use wellposed_models::flow::state::{Background, Flow, State};
use wellposed_models::flow::{FlowKind, Model, RotationKind};
use wellposed_models::registry;
use wellposed_models::{LinearisedSystem, Rounded};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dilatancy {
    Zero,
    Positive,
    /// ν = φ, for the plastic potential.
    Associated,
}

/// Every model with every kind of dilatancy that it admits.
pub const VARIANTS: [(FlowKind, Dilatancy); 9] = [
    (registry::HARRIS_GREKOVA, Dilatancy::Zero),
    (registry::HARRIS_GREKOVA, Dilatancy::Positive),
    (registry::DOUBLE_SHEARING, Dilatancy::Zero),
    (registry::DOUBLE_SHEARING, Dilatancy::Positive),
    (registry::PLASTIC_POTENTIAL, Dilatancy::Zero),
    (registry::PLASTIC_POTENTIAL, Dilatancy::Positive),
    (registry::PLASTIC_POTENTIAL, Dilatancy::Associated),
    (registry::FREE_ROTATING, Dilatancy::Zero),
    (registry::FREE_ROTATING, Dilatancy::Positive),
];

pub fn random_parameters(random: &mut Random, kind: FlowKind, dilatancy: Dilatancy) -> Parameters {
    let friction_angle = random.within(0.15, 1.2);
    let cosserat = kind == registry::HARRIS_GREKOVA;
    Parameters {
        friction_angle,
        dilatancy_angle: match dilatancy {
            Dilatancy::Zero => 0.0,
            Dilatancy::Associated => friction_angle,
            // For a plastic potential ν may exceed φ.
            Dilatancy::Positive if kind == registry::PLASTIC_POTENTIAL => random.within(0.1, 1.3),
            Dilatancy::Positive => friction_angle * random.within(0.1, 0.9),
        },
        cohesion: random.within(50.0, 900.0),
        moment_of_inertia: cosserat.then(|| random.within(0.02, 0.3)),
        rotational_strength: cosserat.then(|| random.within(20.0, 300.0)),
    }
}

/// Random state in which every quantity that the model admits is nonzero; |Δ| up to 85°.
pub fn random_state(random: &mut Random, kind: FlowKind, dilatancy: Dilatancy) -> State {
    let mut pair =
        |least: f64, most: f64| [random.generic(least, most), random.generic(least, most)];
    let velocity = pair(0.3, 3.0);
    let pressure_gradient = pair(200.0, 4000.0);
    let stress_angle_gradient = pair(0.2, 2.0);
    let spin_gradient = pair(0.3, 3.0);
    let inertia_gradient = pair(0.02, 0.2);
    let density_gradient = if dilatancy == Dilatancy::Zero { [0.0; 2] } else { pair(50.0, 500.0) };
    State {
        density: random.within(700.0, 2500.0),
        pressure: random.within(500.0, 5000.0),
        stress_angle: random.generic(0.1, 3.0),
        shear_rate: random.within(0.2, 2.0),
        velocity,
        half_vorticity: random.generic(0.2, 2.0),
        noncoaxiality: (kind != registry::PLASTIC_POTENTIAL).then(|| random.generic(0.05, 1.48)),
        pressure_gradient,
        stress_angle_gradient,
        spin_gradient,
        density_gradient,
        spin_acceleration: random.generic(0.1, 1.0),
        inertia_rate: random.generic(0.02, 0.2),
        inertia_gradient,
        ..State::default()
    }
}

pub fn model(kind: FlowKind, parameters: &Parameters) -> Model {
    parameters.model(kind).expect("the constants are within their ranges")
}

pub fn flow(model: &Model, state: &State) -> Flow {
    match model.background(state).expect("the state is admissible") {
        Background::FullyDeforming(flow) => flow,
        elsewhere => panic!("on yield by construction, yet {elsewhere:?}"),
    }
}

pub fn symbol(model: &Model, flow: &Flow) -> LinearisedSystem<2> {
    let mut system = LinearisedSystem::default();
    model.symbol(flow, &mut system);
    system
}

/// Background of the crate in the variables of the nonlinear equations. Quantities derived by the crate are taken from
/// `flow`, so that an error makes the residuals nonzero. Quantities that the model does not determine (∂ₜp, body force,
/// ∂ₜψ except in double shearing) are random.
pub fn point(
    random: &mut Random,
    parameters: &Parameters,
    kind: FlowKind,
    state: &State,
    flow: &Flow,
) -> (Prescribed<Wide>, Fields<Wide>) {
    let exact = |x: Rounded| wide(x.value);
    let body_force = [random.generic(1.0, 10.0), random.generic(1.0, 10.0)].map(wide);
    let velocity = flow.velocity.map(wide);
    let along =
        |gradient: [f64; 2]| velocity[0] * wide(gradient[0]) + velocity[1] * wide(gradient[1]);
    let gradient = flow.velocity_gradient;
    let convected =
        [0, 1].map(|i| velocity[0] * exact(gradient[i][0]) + velocity[1] * exact(gradient[i][1]));
    let density = wide(flow.density);
    let spin = flow.spin.map_or(wide(0.3), exact);
    let angle_rate = wide(flow.stress_angle_rate.unwrap_or_else(|| random.generic(0.3, 1.0)));
    let fields = Fields {
        z: [
            velocity[0],
            velocity[1],
            spin,
            wide(flow.stress.pressure),
            wide(flow.stress.angle),
            density,
        ],
        by_time: [
            exact(flow.acceleration[0]) + body_force[0] - convected[0],
            exact(flow.acceleration[1]) + body_force[1] - convected[1],
            wide(state.spin_acceleration) - along(flow.spin_gradient),
            wide(random.generic(10.0, 100.0)),
            angle_rate - along(flow.stress_angle_gradient),
            -(density * (exact(gradient[0][0]) + exact(gradient[1][1])))
                - along(flow.density_gradient),
        ],
        by_space: [0, 1].map(|j| {
            [
                exact(gradient[0][j]),
                exact(gradient[1][j]),
                wide(flow.spin_gradient[j]),
                wide(flow.pressure_gradient[j]),
                wide(flow.stress_angle_gradient[j]),
                wide(flow.density_gradient[j]),
            ]
        }),
    };
    let given = Prescribed {
        rotation: match kind.rotation() {
            RotationKind::IntrinsicSpin | RotationKind::Free => Rotation::Intrinsic,
            RotationKind::StressAxes => Rotation::StressAxes,
            RotationKind::None => Rotation::Potential,
        },
        friction_angle: wide(parameters.friction_angle),
        dilatancy_angle: wide(parameters.dilatancy_angle),
        cohesion: wide(parameters.cohesion),
        inertia: wide(parameters.moment_of_inertia.unwrap_or(0.07)),
        inertia_by_time: wide(flow.inertia_rate) - along(flow.inertia_gradient),
        inertia_gradient: flow.inertia_gradient.map(wide),
        rotational_stress: wide(flow.stress.rotational),
        body_force,
        body_moment: wide(flow.body_moment.unwrap_or_default()),
    };
    (given, fields)
}

/// Background from the nonlinear equations in 31 digits, independent of the crate: tr d and rotation from the flow
/// rule, accelerations and density rate from the balances, body moment from the balance of spin. Only Δ and r are taken
/// from the crate.
pub fn exact_point(
    random: &mut Random,
    parameters: &Parameters,
    kind: FlowKind,
    state: &State,
    flow: &Flow,
) -> (Prescribed<Wide>, Fields<Wide>) {
    let (mut given, mut fields) = point(random, parameters, kind, state, flow);
    let zero = wide(0.0);
    let angle = wide(state.stress_angle) + wide(flow.noncoaxiality);
    let (sine, cosine) = (angle + angle).sin_cos();
    let rate = wide(state.shear_rate);
    let turn = wide(state.half_vorticity);
    let set_gradient = |fields: &mut Fields<Wide>, half_trace: Wide| {
        fields.by_space[0][0] = half_trace + rate * cosine;
        fields.by_space[1][0] = rate * sine - turn;
        fields.by_space[0][1] = rate * sine + turn;
        fields.by_space[1][1] = half_trace - rate * cosine;
    };
    // Solves for the root of a residual that is linear in the quantity that `set` assigns.
    let solve = |fields: &mut Fields<Wide>, row: usize, set: &dyn Fn(&mut Fields<Wide>, Wide)| {
        set(fields, zero);
        let at_zero = equations::residuals(&given, fields)[row];
        set(fields, wide(1.0));
        let at_one = equations::residuals(&given, fields)[row];
        set(fields, at_zero / (at_zero - at_one));
    };
    solve(&mut fields, 3, &set_gradient);
    match given.rotation {
        Rotation::Intrinsic => solve(&mut fields, 4, &|f, x| f.z[equations::SPIN] = x),
        Rotation::StressAxes => solve(&mut fields, 4, &|f, x| f.by_time[equations::ANGLE] = x),
        Rotation::Potential => {}
    }
    for (row, unknown) in [(0, 0), (1, 1), (5, equations::DENSITY)] {
        solve(&mut fields, row, &|f, x| f.by_time[unknown] = x);
    }
    given.body_moment = zero;
    given.body_moment = equations::residuals(&given, &fields)[2] / wide(state.density);
    (given, fields)
}

/// Indices in [`equations::UNKNOWNS`] of the columns of `system`, by name.
pub fn columns(system: &LinearisedSystem<2>) -> Vec<usize> {
    let place = |name| equations::UNKNOWNS.iter().position(|&own| own == name);
    system.unknowns.iter().map(|u| place(u.name).expect(u.name)).collect()
}

/// Indices in [`equations::EQUATIONS`] of the rows of `system`, by name.
pub fn rows(system: &LinearisedSystem<2>) -> Vec<usize> {
    let place = |name: &str| {
        let name =
            name.strip_prefix("flow rule: ").unwrap_or(name).replace("coaxiality", "rotation");
        equations::EQUATIONS.iter().position(|&own| own == name)
    };
    system.equations.iter().map(|name| place(name).expect(name)).collect()
}

/// Matrix ςA + i k·(B + V A) + C of `system` as polynomials in ς.
pub fn pencil(system: &LinearisedSystem<2>, wave: [Wide; 2]) -> Vec<Vec<Polynomial>> {
    let (n, m) = system.a.shape();
    (0..n)
        .map(|i| {
            (0..m)
                .map(|j| {
                    let a = wide(system.a[(i, j)].value);
                    let im = [0, 1]
                        .map(|d| {
                            wave[d]
                                * (wide(system.b[d][(i, j)].value) + wide(system.velocity[d]) * a)
                        })
                        .into_iter()
                        .fold(wide(0.0), |sum, x| sum + x);
                    let constant = Complex { re: wide(system.c[(i, j)].value), im };
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
pub fn dispersion(system: &LinearisedSystem<2>, wave: [Wide; 2]) -> Polynomial {
    determinant(&pencil(system, wave))
}

/// Sum of the absolute values of all terms of the determinant at |ς| = `frequency`.
pub fn dispersion_size(system: &LinearisedSystem<2>, wave: [Wide; 2], frequency: f64) -> f64 {
    let sizes: Vec<Vec<f64>> = pencil(system, wave)
        .iter()
        .map(|row| {
            row.iter()
                .map(|p| p.iter().rev().fold(0.0, |sum, c| sum * frequency + c.abs()))
                .collect()
        })
        .collect();
    permanent(&sizes)
}
