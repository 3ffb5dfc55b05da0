//! Schemes without dampers: diagrams in closed form, to rounding.

use super::{assert_near, build, build_examples, compute_response};
use testkit::random::RandomNumbers;
use wellposed_models::rheology::element::Element;
use wellposed_models::rheology::load_path::{Activity, LoadPath};
use wellposed_models::rheology::scheme::{LoadControl, NamedElement, RheologicalScheme};

const ROUNDING: f64 = 1e-13;

/// Checks the stress along a path of strain against a function of strain.
fn check_monotone(
    scheme: &RheologicalScheme,
    last_strain: f64,
    stress_scale: f64,
    stress: impl Fn(f64) -> f64,
) {
    let points = [[0.0, 0.0], [1.0, last_strain]];
    for point in compute_response(scheme, LoadControl::Strain, &points, 173) {
        let state = point.state;
        assert_near(state.stress, stress(state.strain), stress_scale, ROUNDING);
    }
}

#[test]
fn granular_elastic_medium_bears_compression_only() {
    let scheme = build("granular-elastic", &[7.0]);
    for end in [-0.3, 0.4] {
        check_monotone(&scheme, end, 1.0, |strain| 7.0 * strain.min(0.0));
    }
}

#[test]
fn heteromodular_medium_has_two_moduli() {
    let [a, b] = [2.0, 5.0];
    let scheme = build("heteromodular", &[a, b]);
    check_monotone(&scheme, -0.3, 1.0, |strain| (a + b) * strain);
    check_monotone(&scheme, 0.3, 1.0, |strain| a * strain);
}

/// In one dimension spring ∥ (spring — contact) is spring — (spring ∥ contact) with the compliances 1/(A + B) and
/// 1/A − 1/(A + B).
#[test]
fn both_trees_of_the_heteromodular_medium_agree() {
    let [a, b] = [2.0, 5.0];
    let one = build("heteromodular", &[a, b]);
    let compliance = 1.0 / (a + b);
    let elements = vec![
        NamedElement::new("outer", Element::Spring { modulus: 1.0 / compliance }),
        NamedElement::new("inner", Element::Spring { modulus: 1.0 / (1.0 / a - compliance) }),
        NamedElement::new("contact", Element::Contact { gap: 0.0 }),
    ];
    let other = RheologicalScheme::parse(elements, "outer - (inner | contact)").expect("a tree");
    let mut random = RandomNumbers::new(5);
    let points: Vec<[f64; 2]> =
        (0..30).map(|index| [f64::from(index), random.uniform(-1.0, 1.0)]).collect();
    let pairs = compute_response(&one, LoadControl::Strain, &points, 7)
        .into_iter()
        .zip(compute_response(&other, LoadControl::Strain, &points, 7));
    for (one, other) in pairs {
        assert_near(one.state.stress, other.state.stress, 7.0, ROUNDING);
    }
}

#[test]
fn porous_elastic_medium_stiffens_when_its_pores_close() {
    let [a, b, porosity] = [2.0, 5.0, 0.03];
    let scheme = build("porous-elastic", &[a, b, porosity]);
    for end in [-0.1, 0.2] {
        check_monotone(&scheme, end, 1.0, |strain| a * strain + b * (strain + porosity).min(0.0));
    }
    let points = [[0.0, 0.0], [1.0, -0.1], [2.0, 0.05]];
    let response = compute_response(&scheme, LoadControl::Strain, &points, 150);
    let segments = scheme.find_segments(&response);
    let slopes: Vec<Option<f64>> = segments.iter().map(|own| own.slope).collect();
    assert_eq!(slopes, [Some(a), Some(a + b), Some(a + b), Some(a)]);
}

/// θ₀ > σ⁻/a: the skeleton yields before the pores close; the stress stays at −σ⁻ from −σ⁻/a to −θ₀, then the slope is
/// b. θ₀ < σ⁻/a: slopes a, a + b, b. In tension the limit is σ⁺.
#[test]
fn porous_plastic_medium_has_the_segments_of_the_closed_form() {
    let [a, b, compressive, tensile] = [2.0, 5.0, 0.04, 0.07];
    for (porosity, expected) in [(0.03, [a, 0.0, b]), (0.01, [a, a + b, b])] {
        let scheme = build("porous-plastic", &[a, b, porosity, compressive, tensile]);
        let stress = |strain: f64| {
            (a * strain).clamp(-compressive, tensile) + b * (strain + porosity).min(0.0)
        };
        for end in [-0.1, 0.1] {
            check_monotone(&scheme, end, 1.0, stress);
        }
        let response =
            compute_response(&scheme, LoadControl::Strain, &[[0.0, 0.0], [1.0, -0.1]], 200);
        let slopes: Vec<f64> =
            scheme.find_segments(&response).iter().filter_map(|own| own.slope).collect();
        assert_eq!(slopes, expected);
    }
}

/// Unloading has the slope a + b while the contact is closed and a while it is open, from any point; then the skeleton
/// yields in tension.
#[test]
fn porous_plastic_medium_unloads_elastically() {
    let [a, b, porosity, compressive, tensile] = [2.0, 5.0, 0.03, 0.04, 0.07];
    let scheme = build("porous-plastic", &[a, b, porosity, compressive, tensile]);
    for lowest in [-0.015, -0.025, -0.05, -0.3] {
        let points = [[0.0, 0.0], [1.0, lowest], [2.0, 0.2]];
        let response = compute_response(&scheme, LoadControl::Strain, &points, 211);
        let skeleton_at_turn = (a * lowest).max(-compressive);
        for point in response.iter().filter(|own| own.path_segment == Some(1)) {
            let strain = point.state.strain;
            let skeleton = (skeleton_at_turn + a * (strain - lowest)).min(tensile);
            let stress = skeleton + b * (strain + porosity).min(0.0);
            assert_near(point.state.stress, stress, 1.5, ROUNDING);
        }
    }
}

/// A cycle of strain between yielding in both directions dissipates (σ⁺ + σ⁻) times the plastic stroke, the range less
/// (σ⁺ + σ⁻)/a.
#[test]
fn a_cycle_dissipates_yield_stress_times_plastic_stroke() {
    let [a, b, porosity, compressive, tensile] = [2.0, 5.0, 0.03, 0.04, 0.07];
    let scheme = build("porous-plastic", &[a, b, porosity, compressive, tensile]);
    let [low, high] = [-0.2, 0.15];
    let turning = [high, low];
    for steps in [1, 2, 37] {
        let path = LoadPath::from_cycles(LoadControl::Strain, &turning, 4, 0.5, steps).expect("it");
        let response = scheme.compute_response(&path).expect("a response");
        super::assert_ledger_is_closed(&scheme, &response);
        let at_turn = |number: usize| response[number * steps].state.dissipated_energy();
        let stroke = high - low - (compressive + tensile) / a;
        let expected = (compressive + tensile) * stroke;
        for cycle in 1..4 {
            let dissipated = at_turn(2 * cycle + 1) - at_turn(2 * cycle - 1);
            assert_near(dissipated, expected, expected, 1e-13);
        }
    }
}

/// A granular plastic medium keeps its plastic strain: it opens there on unloading and closes there on reloading.
#[test]
fn granular_plastic_medium_opens_and_closes_at_its_plastic_strain() {
    let [modulus, strength] = [2.0, 0.04];
    let scheme = build("granular-plastic", &[modulus, strength]);
    let lowest = -0.1;
    let points = [[0.0, 0.0], [1.0, lowest], [2.0, 0.05], [3.0, -0.12]];
    let response = compute_response(&scheme, LoadControl::Strain, &points, 89);
    let plastic = lowest + strength / modulus;
    for point in &response {
        let strain = point.state.strain;
        let stress = match point.path_segment {
            None | Some(0) => (modulus * strain).max(-strength),
            _ => (modulus * (strain - plastic)).min(0.0).max(-strength),
        };
        assert_near(point.state.stress, stress, strength, ROUNDING);
    }
    let plastic_strokes = -plastic + (0.12 + lowest).abs();
    let dissipated = response.last().expect("points").state.dissipated_energy();
    assert_near(dissipated, strength * plastic_strokes, dissipated, ROUNDING);
}

/// Where a contact and a hinge without tensile strength may both move at the stress 0, the first in the tree does.
#[test]
fn the_first_of_two_free_elements_moves() {
    for (tree, moved, locked) in
        [("spring - contact - hinge", 1, 2), ("spring - hinge - contact", 2, 1)]
    {
        let elements = vec![
            NamedElement::new("spring", Element::Spring { modulus: 1.0 }),
            NamedElement::new("contact", Element::Contact { gap: 0.0 }),
            NamedElement::new(
                "hinge",
                Element::Hinge { compressive_yield_stress: 1.0, tensile_yield_stress: 0.0 },
            ),
        ];
        let scheme = RheologicalScheme::parse(elements, tree).expect("a tree");
        let points = [[0.0, 0.0], [1.0, 0.1]];
        let response = compute_response(&scheme, LoadControl::Strain, &points, 3);
        let last = &response.last().expect("points").state;
        assert_near(last.elements[moved].strain, 0.1, 0.1, ROUNDING);
        assert_eq!(last.elements[locked].strain, 0.0);
        assert_eq!(last.stress, 0.0);
    }
}

/// Under prescribed stress a strain that is not unique stays next to the last one.
#[test]
fn a_free_strain_stays_under_prescribed_stress() {
    let scheme = build("granular-elastic", &[2.0]);
    let points = [[0.0, 0.0], [1.0, -1.0], [2.0, 0.0], [3.0, -0.5]];
    for point in compute_response(&scheme, LoadControl::Stress, &points, 10) {
        assert_near(point.state.strain, 0.5 * point.state.stress, 1.0, ROUNDING);
    }
}

/// Far rays keep the digits of their slopes: the tangent modulus is the sum of moduli, and increments are exact, after
/// strains of any size.
#[test]
fn far_rays_keep_their_slopes() {
    let scheme = build("porous-elastic", &[1.0, 1e-6, 0.25]);
    let mut state = scheme.rest_state();
    for strain in [-1e12, -1e12 - 1024.0] {
        let before = state.stress;
        scheme.advance(&mut state, LoadControl::Strain, strain, 1.0).expect("a step");
        assert_eq!(state.tangent_modulus, 1.0 + 1e-6);
        if before != 0.0 {
            assert_near(state.stress - before, -1024.0 * (1.0 + 1e-6), 1e12, 1e-15);
        }
    }
}

/// The loss of the implicit steps vanishes in proportion to their number; the other energies converge.
#[test]
fn step_losses_vanish_in_the_limit_of_short_steps() {
    for scheme in build_examples() {
        let path = |steps| {
            LoadPath::from_cycles(LoadControl::Strain, &[-0.06, 0.01], 2, 0.1, steps).expect("it")
        };
        let loss = |steps| {
            let response = scheme.compute_response(&path(steps)).expect("a response");
            super::assert_ledger_is_closed(&scheme, &response);
            response.last().expect("points").state.step_loss()
        };
        let ratio = loss(400) / loss(800);
        assert!((1.9..2.1).contains(&ratio), "{ratio}: {}", scheme.notation());
    }
}

#[test]
fn activities_name_flow_and_contact() {
    let scheme = build("porous-plastic", &[2.0, 5.0, 0.03, 0.04, 0.07]);
    let points = [[0.0, 0.0], [1.0, -0.1], [2.0, 0.2]];
    let response = compute_response(&scheme, LoadControl::Strain, &points, 100);
    let segments = scheme.find_segments(&response);
    let pairs: Vec<[Activity; 2]> =
        segments.iter().map(|own| [own.activities[1], own.activities[3]]).collect();
    use Activity::{Closed, CompressiveFlow, Locked, Open, TensileFlow};
    assert_eq!(
        pairs,
        [
            [Locked, Open],
            [CompressiveFlow, Open],
            [CompressiveFlow, Closed],
            [Locked, Closed],
            [TensileFlow, Closed],
            [TensileFlow, Open],
        ]
    );
}
