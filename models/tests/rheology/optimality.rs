//! Optimality of the steps of random schemes: every element ends on its own graph, strains add in series, stresses add in
//! parallel, and the ledger is closed.

use super::random_trees::{Distribution, advance_at_random, draw_control, draw_scheme};
use testkit::random::RandomNumbers;
use wellposed_models::rheology::element::Element;
use wellposed_models::rheology::scheme::{RheologicalScheme, SchemeTree};
use wellposed_models::rheology::step::SchemeState;

/// Tolerance of the residuals, relative to the largest strain and the largest stress of any element in the history.
const TOLERANCE: f64 = 1e-12;

const WIDE: Distribution = Distribution { spread: 1e3, zero_yield_probability: 0.2 };

/// Largest strain and stress of any element so far.
#[derive(Clone, Copy, Default)]
struct Scales {
    strain: f64,
    stress: f64,
}

impl Scales {
    fn extend(&mut self, state: &SchemeState) {
        for own in &state.elements {
            self.strain = self.strain.max(own.strain.abs());
            self.stress = self.stress.max(own.stress.abs());
        }
        self.strain = self.strain.max(state.strain.abs());
        self.stress = self.stress.max(state.stress.abs());
    }
}

/// Distance of a pair of strain and stress errors from 0 in units of both scales; a stress error that follows from a
/// strain error by a modulus counts as the strain error.
fn relative_error(stress_error: f64, modulus: f64, scales: Scales) -> f64 {
    stress_error.abs() / (scales.stress + modulus * scales.strain)
}

/// Distance of an element from its graph, relative to the scales.
fn element_residual(
    element: &Element,
    [before, after]: [(f64, f64); 2],
    duration: f64,
    scales: Scales,
) -> f64 {
    let (strain, stress) = after;
    let increment = strain - before.0;
    let of_stress = |error: f64| error / scales.stress.max(f64::MIN_POSITIVE);
    let of_strain = |error: f64| error / scales.strain.max(f64::MIN_POSITIVE);
    match *element {
        Element::Spring { modulus } => relative_error(stress - modulus * strain, modulus, scales),
        Element::Damper { viscosity } => {
            let modulus = viscosity / duration;
            relative_error(stress - modulus * increment, modulus, scales)
        }
        Element::Hinge { compressive_yield_stress, tensile_yield_stress } => {
            let outside = (stress - tensile_yield_stress).max(-compressive_yield_stress - stress);
            let flow = match increment > 0.0 {
                true => tensile_yield_stress - stress,
                false => stress + compressive_yield_stress,
            };
            let complementarity = of_stress(flow.abs()).min(of_strain(increment.abs()));
            of_stress(outside.max(0.0)).max(complementarity)
        }
        Element::Contact { gap } => {
            let opening = strain + gap;
            let inside = of_stress(stress.max(0.0)).max(of_strain((-opening).max(0.0)));
            inside.max(of_stress(stress.abs()).min(of_strain(opening.abs())))
        }
    }
}

/// Strain and stress of a branch from its elements; `residual` grows to the largest mismatch of strains in parallel or
/// stresses in series.
fn add_up(tree: &SchemeTree, state: &SchemeState, scales: Scales, residual: &mut f64) -> [f64; 2] {
    let (branches, common) = match tree {
        SchemeTree::Element(index) => {
            return [state.elements[*index].strain, state.elements[*index].stress];
        }
        SchemeTree::Series(branches) => (branches, 1),
        SchemeTree::Parallel(branches) => (branches, 0),
    };
    let ends: Vec<[f64; 2]> =
        branches.iter().map(|branch| add_up(branch, state, scales, residual)).collect();
    let scale = [scales.strain, scales.stress][common].max(f64::MIN_POSITIVE);
    for pair in ends.windows(2) {
        *residual = residual.max((pair[0][common] - pair[1][common]).abs() / scale);
    }
    let mut total = ends[0];
    total[1 - common] = ends.iter().map(|end| end[1 - common]).sum();
    total
}

/// Largest residual of a step.
fn step_residual(
    scheme: &RheologicalScheme,
    [before, after]: [&SchemeState; 2],
    duration: f64,
    scales: Scales,
) -> f64 {
    let mut residual: f64 = 0.0;
    let [strain, stress] = add_up(scheme.tree(), after, scales, &mut residual);
    residual = residual.max((strain - after.strain).abs() / scales.strain.max(f64::MIN_POSITIVE));
    residual = residual.max((stress - after.stress).abs() / scales.stress.max(f64::MIN_POSITIVE));
    let pairs = before.elements.iter().zip(&after.elements);
    for (own, (one, other)) in scheme.elements().iter().zip(pairs) {
        let states = [one, other].map(|state| (state.strain, state.stress));
        residual = residual.max(element_residual(&own.element, states, duration, scales));
    }
    residual
}

/// 5000 random schemes, each with a history of 200 random steps.
#[test]
fn steps_of_random_schemes_are_optimal() {
    let start = std::time::Instant::now();
    let mut random = RandomNumbers::new(2019);
    let (mut largest_residual, mut largest_ledger): (f64, f64) = (0.0, 0.0);
    for _ in 0..5000 {
        let control = draw_control(&mut random);
        let scheme = draw_scheme(&mut random, control, WIDE);
        let mut state = scheme.rest_state();
        let mut scales = Scales::default();
        let mut energy: f64 = 0.0;
        for step in 0..200 {
            let before = state.clone();
            let duration = advance_at_random(&mut random, &scheme, control, &mut state, WIDE);
            scales.extend(&state);
            let residual = step_residual(&scheme, [&before, &state], duration, scales);
            let notation = scheme.notation();
            assert!(residual <= TOLERANCE, "{residual:e} in step {step}: {notation} {scheme:?}");
            largest_residual = largest_residual.max(residual);
            let energies = [state.stored_energy(&scheme), state.dissipated_energy()];
            energy = energies.into_iter().fold(energy.max(state.work.abs()), f64::max);
            let ledger = state.ledger_residual(&scheme).abs() / energy.max(f64::MIN_POSITIVE);
            assert!(ledger <= 1e-12, "{ledger:e} in step {step}: {notation} {scheme:?}");
            largest_ledger = largest_ledger.max(ledger);
            assert!(state.step_loss() >= -1e-15 * energy);
        }
    }
    println!(
        "residual at most {largest_residual:e}, ledger {largest_ledger:e}, {:.1} s",
        start.elapsed().as_secs_f64()
    );
}

/// Hinges of schemes without dampers dissipate their yield stress times their plastic strokes, at any step.
#[test]
fn hinges_dissipate_yield_stress_times_stroke() {
    let mut random = RandomNumbers::new(7);
    let mut count = 0;
    while count < 200 {
        let control = draw_control(&mut random);
        let scheme = draw_scheme(&mut random, control, WIDE);
        if scheme.has_damper() {
            continue;
        }
        let mut state = scheme.rest_state();
        let mut expected = vec![0.0; state.elements.len()];
        for _ in 0..100 {
            let before = state.clone();
            advance_at_random(&mut random, &scheme, control, &mut state, WIDE);
            for (index, own) in scheme.elements().iter().enumerate() {
                let stroke = state.elements[index].strain - before.elements[index].strain;
                if let Element::Hinge { compressive_yield_stress, tensile_yield_stress } =
                    own.element
                {
                    expected[index] += match stroke > 0.0 {
                        true => tensile_yield_stress * stroke,
                        false => compressive_yield_stress * -stroke,
                    };
                }
            }
        }
        let scale = expected.iter().copied().fold(state.work.abs(), f64::max);
        for (own, expected) in state.elements.iter().zip(expected) {
            let error = (own.dissipated_energy - expected).abs();
            assert!(error <= 1e-12 * scale, "{error:e} of {scale:e}");
        }
        count += 1;
    }
}
