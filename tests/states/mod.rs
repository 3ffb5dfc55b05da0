//! Random fully deforming states of every model, for tests and benchmarks of both routes.

use models::flow::state::{Background, Flow, State};
use models::flow::{FlowKind, Model};
use models::registry;
use std::f64::consts::{FRAC_PI_2, PI};
use testkit::flows::Parameters;
pub use testkit::random::Random;

/// Random number generator of the states.
pub fn seeded(seed: u64) -> Random {
    Random::with_salt(seed, 0x3c6e_f372)
}

fn pair(random: &mut Random, size: f64) -> [f64; 2] {
    [0; 2].map(|_| size * random.signed(1e-3, 1e3))
}

/// Range of the parameters of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Sands, powders and pellets: φ from 5° to 60°.
    Materials,
    /// All angles up to their limits, and quantities over many decades.
    Wide,
}

/// Random constants and state of a model, with or without gradients and accelerations.
pub fn random(
    random: &mut Random,
    kind: FlowKind,
    range: Range,
    dilatant: bool,
    gradients: bool,
) -> (Parameters, State) {
    let wide = range == Range::Wide;
    let near = |random: &mut Random| random.decades(1e-7, 1e-1);
    let friction_angle = match (wide, random.unit()) {
        (false, _) => random.within(0.09, 1.05),
        (true, x) if x < 0.1 => near(random),
        (true, x) if x < 0.2 => FRAC_PI_2 - near(random),
        (true, _) => random.within(0.01, 1.56),
    };
    let most = if kind == registry::PLASTIC_POTENTIAL { FRAC_PI_2 } else { friction_angle };
    let dilatancy_angle = match (dilatant, wide, random.unit()) {
        (false, _, _) => 0.0,
        (true, true, x) if x < 0.1 => most * near(random),
        (true, true, x) if x < 0.2 => most * (1.0 - near(random)),
        (true, true, x) if x < 0.3 => friction_angle * (1.0 - near(random)),
        (true, true, _) => most * random.within(0.001, 0.999),
        (true, false, _) => friction_angle * random.within(0.05, 0.95),
    };
    let mut size = |wide_range: [f64; 2], own: [f64; 2]| {
        let [least, most] = if wide { wide_range } else { own };
        random.decades(least, most)
    };
    let density = size([1e-3, 1e6], [500.0, 3000.0]);
    let pressure = size([1e-3, 1e9], [1.0, 1e5]);
    let shear_rate = size([1e-6, 1e6], [1e-2, 1e2]);
    let inertia = size([1e-12, 1e2], [1e-9, 1e-4]);
    let length = size([1e-6, 1e6], [1e-1, 1e1]);
    let cosserat = kind == registry::HARRIS_GREKOVA;
    let strength = if dilatant && !gradients || random.chance(0.5) {
        0.0
    } else {
        pressure * random.decades(1e-3, 1.0)
    };
    let parameters = Parameters {
        friction_angle,
        dilatancy_angle,
        cohesion: if random.chance(0.5) { 0.0 } else { pressure * random.decades(1e-3, 1e2) },
        moment_of_inertia: cosserat.then_some(inertia),
        rotational_strength: cosserat.then_some(strength),
    };
    let mut state = State {
        density,
        pressure,
        stress_angle: random.within(-PI, PI),
        shear_rate,
        velocity: pair(random, 1.0),
        half_vorticity: shear_rate * random.signed(1e-2, 1e2),
        noncoaxiality: (kind != registry::PLASTIC_POTENTIAL).then(|| random.within(-1.6, 1.6)),
        ..State::default()
    };
    if gradients {
        state.pressure_gradient = pair(random, pressure / length);
        state.stress_angle_gradient = pair(random, 1.0 / length);
        if dilatancy_angle > 0.0 {
            state.density_gradient = pair(random, density / length);
        }
        if cosserat {
            state.spin_gradient = pair(random, shear_rate / length);
            state.inertia_gradient = pair(random, inertia / length);
            state.inertia_rate = inertia * shear_rate * random.signed(1e-3, 1e3);
        }
    }
    (parameters, state)
}

/// Model with the given parameters and its background flow.
pub fn flow(kind: FlowKind, parameters: &Parameters, state: &State) -> (Model, Flow) {
    let model = parameters.model(kind).expect("constants within their ranges");
    match model.background(state).expect("an admissible state") {
        Background::FullyDeforming(flow) => (model, flow),
        elsewhere => panic!("on yield by construction, yet {elsewhere:?}"),
    }
}
