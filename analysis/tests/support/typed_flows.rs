//! States of the built-in flow models as states of the same models given as equations.

use super::states::FlowSample;
use models::Rounded;
use models::equations::{JetVariable, ModelText, TextModel, TextState};

/// Without dilatancy the density is a parameter, and there is no balance of mass.
fn without_density(mut text: ModelText) -> ModelText {
    let density = text.unknowns.iter().position(|own| own.name == "rho").expect("a density");
    let density = text.unknowns.remove(density);
    text.parameters.push(density);
    text.equations.retain(|own| own.name != "mass");
    text
}

/// The model and the state of a sample, given as equations: `text` is the case of its kind, with dilatancy.
pub fn type_in(sample: &FlowSample, text: &ModelText) -> (TextModel, TextState) {
    let FlowSample { parameters, state, flow, .. } = sample;
    let is_dilatant = parameters.dilatancy_angle > 0.0;
    let text = if is_dilatant { text.clone() } else { without_density(text.clone()) };
    let model = TextModel::new(&text).unwrap_or_else(|error| panic!("{error}"));
    let mut typed = TextState::default();
    let v = flow.velocity;
    for parameter in &text.parameters {
        typed.parameters.push(match parameter.name.as_str() {
            "phi" => parameters.friction_angle,
            "nu" => parameters.dilatancy_angle,
            "c" => parameters.cohesion,
            // The acceleration is that relative to the body force.
            "F1" | "F2" => 0.0,
            "rho" => flow.density,
            "inertia" => parameters.moment_of_inertia.expect("with spin"),
            // Rate at a fixed place of a moment of inertia whose material rate is given.
            "inertia_t" => {
                flow.inertia_rate
                    - v[0] * flow.inertia_gradient[0]
                    - v[1] * flow.inertia_gradient[1]
            }
            "inertia_1" => flow.inertia_gradient[0],
            "inertia_2" => flow.inertia_gradient[1],
            "r" => flow.stress.rotational_stress,
            "moment" => flow.body_moment.expect("with spin"),
            other => panic!("{other}"),
        });
    }
    let mut set = |unknown: &str, orders: [u8; 4], value: Rounded| {
        let variable = JetVariable { unknown: model.find_unknown(unknown).expect("known"), orders };
        typed.set_background(variable, value);
    };
    let (t, x, y) = ([1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]);
    // A field with its gradient and material rate, which is turned into the rate at a fixed place.
    let mut field = |name: &str, value: Rounded, gradient: [Rounded; 2], rate: Rounded| {
        let velocity = v.map(Rounded::from_rounded);
        set(name, [0; 4], value);
        set(name, x, gradient[0]);
        set(name, y, gradient[1]);
        set(name, t, rate - velocity[0] * gradient[0] - velocity[1] * gradient[1]);
    };
    let given = Rounded::from_rounded;
    for i in 0..2 {
        let name = ["v1", "v2"][i];
        field(name, given(v[i]), flow.velocity_gradient[i], flow.acceleration[i]);
    }
    field("p", given(state.pressure), flow.pressure_gradient.map(given), Rounded::ZERO);
    let turning = flow.stress_angle_rate.map_or(Rounded::ZERO, given);
    let angle_gradient = flow.stress_angle_gradient.map(Rounded::from_angle);
    field("psi", Rounded::from_angle(flow.stress.angle), angle_gradient, turning);
    if model.find_unknown("w").is_some() {
        let gradient = flow.spin_gradient.map(given);
        let spin = flow.spin.unwrap_or_else(|| given(flow.half_vorticity) + flow.relative_rotation);
        field("w", spin, gradient, given(state.spin_acceleration));
    }
    if is_dilatant {
        let divergence = flow.velocity_gradient[0][0] + flow.velocity_gradient[1][1];
        let rate = -(given(flow.density) * divergence);
        field("rho", given(flow.density), flow.density_gradient.map(given), rate);
    }
    (model, typed)
}
