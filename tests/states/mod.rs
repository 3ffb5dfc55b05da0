//! Random fully deforming states of every model, for tests and benchmarks of both routes.

use models::flow::state::{Background, DeformingFlow, MaterialState};
use models::flow::{FlowKind, Model};
use models::registry;
use std::f64::consts::{FRAC_PI_2, PI};
use testkit::flows::FlowParameters;
pub use testkit::random::RandomNumbers;

/// Creates the random number generator of the states from a seed.
pub fn create_random_numbers(seed: u64) -> RandomNumbers {
    RandomNumbers::with_salt(seed, 0x3c6e_f372)
}

fn generate_pair(random: &mut RandomNumbers, size: f64) -> [f64; 2] {
    [0; 2].map(|_| size * random.signed_log_uniform(1e-3, 1e3))
}

/// Range from which the parameters of a random state are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterRange {
    /// Sands, powders and pellets: friction angle φ from 5° to 60°.
    GranularMaterials,
    /// All angles up to their limits, and quantities over many decades.
    FullRange,
}

/// Generates random constants and a state of a model, with or without gradients and accelerations.
pub fn generate_state(
    random: &mut RandomNumbers,
    kind: FlowKind,
    range: ParameterRange,
    is_dilatant: bool,
    has_gradients: bool,
) -> (FlowParameters, MaterialState) {
    let is_full_range = range == ParameterRange::FullRange;
    let near = |random: &mut RandomNumbers| random.log_uniform(1e-7, 1e-1);
    let friction_angle = match (is_full_range, random.unit_interval()) {
        (false, _) => random.uniform(0.09, 1.05),
        (true, x) if x < 0.1 => near(random),
        (true, x) if x < 0.2 => FRAC_PI_2 - near(random),
        (true, _) => random.uniform(0.01, 1.56),
    };
    let max_dilatancy_angle =
        if kind == registry::PLASTIC_POTENTIAL { FRAC_PI_2 } else { friction_angle };
    let dilatancy_angle = match (is_dilatant, is_full_range, random.unit_interval()) {
        (false, _, _) => 0.0,
        (true, true, x) if x < 0.1 => max_dilatancy_angle * near(random),
        (true, true, x) if x < 0.2 => max_dilatancy_angle * (1.0 - near(random)),
        (true, true, x) if x < 0.3 => friction_angle * (1.0 - near(random)),
        (true, true, _) => max_dilatancy_angle * random.uniform(0.001, 0.999),
        (true, false, _) => friction_angle * random.uniform(0.05, 0.95),
    };
    let mut size = |full_range: [f64; 2], materials: [f64; 2]| {
        let [min, max] = if is_full_range { full_range } else { materials };
        random.log_uniform(min, max)
    };
    let density = size([1e-3, 1e6], [500.0, 3000.0]);
    let pressure = size([1e-3, 1e9], [1.0, 1e5]);
    let shear_rate = size([1e-6, 1e6], [1e-2, 1e2]);
    let inertia = size([1e-12, 1e2], [1e-9, 1e-4]);
    let length = size([1e-6, 1e6], [1e-1, 1e1]);
    let cosserat = kind == registry::HARRIS_GREKOVA;
    let strength = if is_dilatant && !has_gradients || random.bernoulli(0.5) {
        0.0
    } else {
        pressure * random.log_uniform(1e-3, 1.0)
    };
    let parameters = FlowParameters {
        friction_angle,
        dilatancy_angle,
        cohesion: if random.bernoulli(0.5) {
            0.0
        } else {
            pressure * random.log_uniform(1e-3, 1e2)
        },
        moment_of_inertia: cosserat.then_some(inertia),
        rotational_strength: cosserat.then_some(strength),
    };
    let mut state = MaterialState {
        density,
        pressure,
        stress_angle: random.uniform(-PI, PI),
        shear_rate,
        velocity: generate_pair(random, 1.0),
        half_vorticity: shear_rate * random.signed_log_uniform(1e-2, 1e2),
        noncoaxiality: (kind != registry::PLASTIC_POTENTIAL).then(|| random.uniform(-1.6, 1.6)),
        ..MaterialState::default()
    };
    if has_gradients {
        state.pressure_gradient = generate_pair(random, pressure / length);
        state.stress_angle_gradient = generate_pair(random, 1.0 / length);
        if dilatancy_angle > 0.0 {
            state.density_gradient = generate_pair(random, density / length);
        }
        if cosserat {
            state.spin_gradient = generate_pair(random, shear_rate / length);
            state.inertia_gradient = generate_pair(random, inertia / length);
            state.inertia_rate = inertia * shear_rate * random.signed_log_uniform(1e-3, 1e3);
        }
    }
    (parameters, state)
}

/// Builds the model with the given parameters, and its background flow.
pub fn build_flow(
    kind: FlowKind,
    parameters: &FlowParameters,
    state: &MaterialState,
) -> (Model, DeformingFlow) {
    let model = parameters.build_model(kind).expect("constants within their ranges");
    match model.background(state).expect("an admissible state") {
        Background::FullyDeforming(flow) => (model, flow),
        elsewhere => panic!("on yield by construction, yet {elsewhere:?}"),
    }
}
