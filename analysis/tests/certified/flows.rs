//! Boxes of states of the flow models: any size, and, as often, with φ = ν, ν = 0, Δ = ±45° or the bound on Δ inside, on an
//! edge or beside it.

use super::{BoxNumber, BoxSample, Family, random_half};
use crate::support::states::{DilatancyKind, RandomNumbers, sample_wide_range};
use models::Rounded;
use models::common::taylor_model::TaylorModel;
use models::flow::state::{Background, DeformingFlow, MaterialState};
use models::flow::{FlowKind, Model};
use models::registry;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use testkit::flows::FlowParameters;
use wellposed_analysis::certified::{BoxProof, BoxVerdict};
use wellposed_analysis::flows::FlowWorkspace;

pub const FAMILIES: [Family; 5] = [
    Family {
        name: "Harris–Grekova without dilatancy",
        draw: |random| draw_flow(random, registry::HARRIS_GREKOVA, DilatancyKind::Zero),
        share: 0.2,
        least: [35, 40],
    },
    Family {
        name: "Harris–Grekova with dilatancy",
        draw: |random| draw_flow(random, registry::HARRIS_GREKOVA, DilatancyKind::Positive),
        share: 0.2,
        least: [20, 45],
    },
    Family {
        name: "double shearing",
        draw: |random| draw_flow(random, registry::DOUBLE_SHEARING, DilatancyKind::Positive),
        share: 0.15,
        least: [0, 60],
    },
    Family {
        name: "plastic potential",
        draw: |random| draw_flow(random, registry::PLASTIC_POTENTIAL, DilatancyKind::Positive),
        share: 0.15,
        least: [0, 60],
    },
    Family {
        name: "plastic potential, nearly associated",
        draw: |random| draw_flow(random, registry::PLASTIC_POTENTIAL, DilatancyKind::Associated),
        share: 0.1,
        least: [0, 20],
    },
];

/// A box in two of the friction angle φ, the dilatancy angle ν and the non-coaxiality Δ, rad; the rest of the state is random.
fn draw_flow(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> BoxSample<'static> {
    let base = sample_wide_range(random, kind, dilatancy);
    let (mut parameters, mut state) = (base.parameters, base.state);
    if kind == registry::HARRIS_GREKOVA && dilatancy != DilatancyKind::Zero {
        // What the proof takes.
        parameters.rotational_strength = Some(0.0);
        state = MaterialState {
            pressure_gradient: [0.0; 2],
            stress_angle_gradient: [0.0; 2],
            spin_gradient: [0.0; 2],
            density_gradient: [0.0; 2],
            inertia_gradient: [0.0; 2],
            inertia_rate: 0.0,
            ..state
        };
    }
    let half = random_half(random);
    let phi = parameters.friction_angle;
    let mut nu = parameters.dilatancy_angle;
    let mut delta = state.noncoaxiality.unwrap_or_default();
    // Places of the centre: a multiple of the half size beside a special place.
    let offset = if random.bernoulli(0.3) { 0.0 } else { half * random.uniform(-4.0, 4.0) };
    match (random.uniform_index(4), dilatancy) {
        (1, DilatancyKind::Positive) => nu = half,
        (2, DilatancyKind::Positive) | (1..=3, DilatancyKind::Associated) => {
            nu = (phi + offset).max(half);
        }
        (3, _) if kind != registry::PLASTIC_POTENTIAL => {
            let bound = base.model.noncoaxiality_bound().unwrap_or(FRAC_PI_4);
            let places = [bound, FRAC_PI_2 - bound, FRAC_PI_4, FRAC_PI_2];
            delta = places[random.uniform_index(4)] + offset;
            delta = if random.bernoulli(0.5) { delta } else { -delta };
        }
        _ => {}
    }
    let mut axes: Vec<usize> = [
        Some(0),
        (dilatancy != DilatancyKind::Zero).then_some(1),
        (kind != registry::PLASTIC_POTENTIAL).then_some(2),
    ]
    .into_iter()
    .flatten()
    .collect();
    if axes.len() == 3 {
        axes.remove(random.uniform_index(3));
    }
    let mut index = 0;
    let numbers = [phi, nu, delta].map(|value| {
        let axis = axes.iter().position(|&own| own == index);
        let half = if axis.is_some() { half } else { 0.0 };
        index += 1;
        BoxNumber { low: value - half, high: value + half, axis }
    });
    let own = FlowBox { kind, parameters, state, numbers };
    let proved = own.prove();
    let mut workspace = FlowWorkspace::default();
    let verdict_at = move |point: [f64; 2]| {
        let (model, flow) = own.state_at(point)?;
        Some(workspace.assess(&model, &flow).expect("numbers that do not overflow").verdict)
    };
    BoxSample { proved, verdict_at: Box::new(verdict_at) }
}

/// States with these numbers but for φ, ν and Δ.
struct FlowBox {
    kind: FlowKind,
    parameters: FlowParameters,
    state: MaterialState,
    numbers: [BoxNumber; 3],
}

impl FlowBox {
    /// Model and flow at a point (u, v) of the square, if they exist.
    fn state_at(&self, point: [f64; 2]) -> Option<(Model, DeformingFlow)> {
        let [friction_angle, dilatancy_angle, noncoaxiality] =
            self.numbers.map(|own| own.at(point));
        let parameters = FlowParameters { friction_angle, dilatancy_angle, ..self.parameters };
        let noncoaxiality = self.state.noncoaxiality.map(|_| noncoaxiality);
        let model = parameters.build_model(self.kind).ok()?;
        match model.background(&MaterialState { noncoaxiality, ..self.state }) {
            Ok(Background::FullyDeforming(flow)) => Some((model, flow)),
            _ => None,
        }
    }

    /// Certified verdict on the box. Not decided if a corner has no state; with states at all corners all points have one.
    fn prove(&self) -> BoxVerdict {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        let states: Option<Vec<_>> = corners.into_iter().map(|own| self.state_at(own)).collect();
        let Some((model, flow)) = states.and_then(|mut own| own.pop()) else {
            return BoxVerdict::NotDecided;
        };
        let enclose = |own: BoxNumber| match own.axis {
            Some(_) => own.enclose(),
            None => Rounded::from_angle(own.low).into(),
        };
        let [phi, nu, delta] = self.numbers.map(enclose);
        let mut constants: Vec<TaylorModel> = self
            .parameters
            .to_constants(self.kind)
            .iter()
            .map(|&own| Rounded::from_angle(own).into())
            .collect();
        (constants[0], constants[1]) = (phi, nu);
        let conditions = model.box_conditions(&flow, &constants, delta);
        conditions.map_or(BoxVerdict::NotDecided, |own| BoxProof::from_conditions(&own).verdict)
    }
}
