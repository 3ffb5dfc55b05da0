//! Random schemes and random steps.

use testkit::random::RandomNumbers;
use wellposed_models::rheology::element::Element;
use wellposed_models::rheology::scheme::{
    LoadControl, NamedElement, RheologicalScheme, SchemeTree,
};
use wellposed_models::rheology::step::{SchemeState, StepError};

/// Distribution of constants and steps.
#[derive(Clone, Copy)]
pub struct Distribution {
    /// Constants and durations are from 1/`spread` to `spread`.
    pub spread: f64,
    /// Probability that a yield stress is 0.
    pub zero_yield_probability: f64,
}

fn draw_element(random: &mut RandomNumbers, distribution: Distribution) -> Element {
    let Distribution { spread, zero_yield_probability } = distribution;
    let mut size = |zero_probability: f64| match random.bernoulli(zero_probability) {
        true => 0.0,
        false => random.log_uniform(1.0 / spread, spread),
    };
    let [tensile, compressive] = [(); 2].map(|()| size(zero_yield_probability));
    let modulus = size(0.0);
    match random.uniform_index(6) {
        0 | 1 => Element::Spring { modulus },
        2 => Element::Damper { viscosity: modulus },
        3 | 4 => {
            Element::Hinge { compressive_yield_stress: compressive, tensile_yield_stress: tensile }
        }
        _ => Element::Contact {
            gap: match random.bernoulli(0.3) {
                true => 0.0,
                false => random.log_uniform(1.0 / spread, 1.0),
            },
        },
    }
}

fn draw_tree(
    random: &mut RandomNumbers,
    elements: &mut Vec<NamedElement>,
    distribution: Distribution,
    (is_series, depth): (bool, usize),
) -> SchemeTree {
    if depth > 0 && (depth == 4 || random.bernoulli(0.45)) {
        let name = format!("e{}", elements.len());
        elements.push(NamedElement::new(name, draw_element(random, distribution)));
        return SchemeTree::Element(elements.len() - 1);
    }
    let count = 2 + random.uniform_index(2);
    let branches = (0..count)
        .map(|_| draw_tree(random, elements, distribution, (!is_series, depth + 1)))
        .collect();
    if is_series { SchemeTree::Series(branches) } else { SchemeTree::Parallel(branches) }
}

/// Draws a scheme of 2 to 12 elements that is valid under the control.
pub fn draw_scheme(
    random: &mut RandomNumbers,
    control: LoadControl,
    distribution: Distribution,
) -> RheologicalScheme {
    loop {
        let mut elements = Vec::new();
        let is_series = random.bernoulli(0.5);
        let tree = draw_tree(random, &mut elements, distribution, (is_series, 0));
        if elements.len() > 12 {
            continue;
        }
        match RheologicalScheme::new(elements, tree) {
            Ok(scheme) if scheme.check_control(control).is_ok() => return scheme,
            _ => {}
        }
    }
}

/// Draws the control of a history.
pub fn draw_control(random: &mut RandomNumbers) -> LoadControl {
    if random.bernoulli(0.6) { LoadControl::Strain } else { LoadControl::Stress }
}

/// Advances a state by a random step and returns its duration. A stress that the scheme does not bear is replaced by
/// the nearest one that it bears, at which it flows or opens.
pub fn advance_at_random(
    random: &mut RandomNumbers,
    scheme: &RheologicalScheme,
    control: LoadControl,
    state: &mut SchemeState,
    Distribution { spread, .. }: Distribution,
) -> f64 {
    let duration = random.log_uniform(1.0 / spread, spread);
    let target = match (control, random.bernoulli(0.1)) {
        (LoadControl::Strain, true) => state.strain,
        (LoadControl::Stress, true) => state.stress,
        (LoadControl::Strain, _) => state.strain + random.signed_log_uniform(1.0 / spread, 1.0),
        (LoadControl::Stress, _) => random.signed_log_uniform(1.0 / spread, spread),
    };
    match scheme.advance(state, control, target, duration) {
        Err(StepError::Stress { bounds: [low, high], .. }) => {
            let target = target.clamp(low, high);
            scheme.advance(state, control, target, duration).expect("a stress that is borne");
        }
        result => result.expect("a step"),
    }
    duration
}
