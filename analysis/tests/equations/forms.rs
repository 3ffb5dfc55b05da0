//! The same model in other forms and dimensions; large models.

use crate::support::states::seeded_generator;
use models::Rounded;
use models::equations::{JetVariable, ModelText, NamedText, Quantity, TextModel, TextState};
use wellposed_analysis::equations::{EquationsAssessment, EquationsWorkspace};
use wellposed_analysis::growth::Verdict;

fn build(
    dimensions: usize,
    unknowns: &[&str],
    velocity: &[&str],
    parameters: &[&str],
    equations: &[&str],
) -> TextModel {
    let quantities = |names: &[&str]| {
        names.iter().map(|name| Quantity { name: (*name).into(), unit: None }).collect()
    };
    let text = ModelText {
        dimensions,
        unknowns: quantities(unknowns),
        velocity: velocity.iter().map(|own| (*own).to_owned()).collect(),
        parameters: quantities(parameters),
        definitions: Vec::new(),
        equations: equations
            .iter()
            .enumerate()
            .map(|(index, text)| NamedText { name: format!("e{index}"), text: (*text).into() })
            .collect(),
        driven: Vec::new(),
    };
    TextModel::new(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn assess(
    model: &TextModel,
    parameters: &[f64],
    background: &[(&str, [u8; 4], f64)],
) -> EquationsAssessment {
    let mut state = TextState { parameters: parameters.to_vec(), ..TextState::default() };
    for &(name, orders, value) in background {
        let unknown = model.find_unknown(name).expect("known");
        state.set_background(JetVariable { unknown, orders }, Rounded::from_rounded(value));
    }
    EquationsWorkspace::default()
        .assess(model, &mut state)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn coefficient(found: &EquationsAssessment) -> (f64, f64) {
    match &found.assessment.verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => {
            (growth.order.to_f64(), growth.coefficient)
        }
        other => panic!("{other:?}"),
    }
}

/// Isentropic Euler equations with p = a ρ + b ρ³ in four forms: with D, multiplied by ρ, conservative, and in momentum.
#[test]
fn equivalent_forms_have_the_same_verdict() {
    let parameters = ["a", "b"];
    let pressure = "(a*rho + b*rho^3)";
    let velocity_unknowns = ["rho", "v1", "v2"];
    let material = build(
        2,
        &velocity_unknowns,
        &["v1", "v2"],
        &parameters,
        &[
            "D(rho) + rho*(d1(v1) + d2(v2)) = 0",
            &format!("D(v1) = -d1{pressure}/rho"),
            &format!("D(v2) = -d2{pressure}/rho"),
        ],
    );
    let multiplied = build(
        2,
        &velocity_unknowns,
        &["v1", "v2"],
        &parameters,
        &[
            "rho*D(ln(rho)) + rho*(d1(v1) + d2(v2)) = 0",
            &format!("rho*D(v1) + d1{pressure} = 0"),
            &format!("rho*D(v2) + d2{pressure} = 0"),
        ],
    );
    let conservative = build(
        2,
        &velocity_unknowns,
        &[],
        &parameters,
        &[
            "dt(rho) + d1(rho*v1) + d2(rho*v2) = 0",
            &format!("dt(rho*v1) + d1(rho*v1^2 + {pressure}) + d2(rho*v1*v2) = 0"),
            &format!("dt(rho*v2) + d1(rho*v1*v2) + d2(rho*v2^2 + {pressure}) = 0"),
        ],
    );
    let momentum = build(
        2,
        &["rho", "m1", "m2"],
        &[],
        &parameters,
        &[
            "dt(rho) + d1(m1) + d2(m2) = 0",
            &format!("dt(m1) + d1(m1^2/rho + {pressure}) + d2(m1*m2/rho) = 0"),
            &format!("dt(m2) + d1(m1*m2/rho) + d2(m2^2/rho + {pressure}) = 0"),
        ],
    );
    let mut random = seeded_generator(7);
    for _ in 0..20 {
        let (a, b, rho) =
            (random.uniform(-3.0, 1.0), random.uniform(0.1, 0.5), random.uniform(0.3, 2.0));
        let v = [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)];
        let by_velocity = [("rho", [0; 4], rho), ("v1", [0; 4], v[0]), ("v2", [0; 4], v[1])];
        let by_momentum =
            [("rho", [0; 4], rho), ("m1", [0; 4], rho * v[0]), ("m2", [0; 4], rho * v[1])];
        let found = [
            assess(&material, &[a, b], &by_velocity),
            assess(&multiplied, &[a, b], &by_velocity),
            assess(&conservative, &[a, b], &by_velocity),
            assess(&momentum, &[a, b], &by_momentum),
        ];
        let slope = a + 3.0 * b * rho * rho;
        for own in &found {
            if slope < 0.0 {
                let (order, value) = coefficient(own);
                assert_eq!(order, 1.0);
                assert!((value - (-slope).sqrt()).abs() < 1e-8 * value, "{value}, p' = {slope}");
            } else {
                assert_eq!(own.assessment.verdict, Verdict::WellPosed, "p' = {slope}, v = {v:?}");
            }
        }
    }
}

/// Diffusion in space with one negative principal diffusivity along a random axis: the axis and the coefficient are found.
#[test]
fn growth_in_space_is_located() {
    let names = ["k11", "k22", "k33", "k12", "k13", "k23"];
    let model = build(
        3,
        &["c"],
        &[],
        &names,
        &["dt(c) = d1(k11*d1(c) + k12*d2(c) + k13*d3(c)) + d2(k12*d1(c) + k22*d2(c) + k23*d3(c)) \
           + d3(k13*d1(c) + k23*d2(c) + k33*d3(c))"],
    );
    let mut random = seeded_generator(8);
    for _ in 0..20 {
        let raw = [0; 3].map(|_| random.signed_uniform(0.05, 1.0));
        let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axis = raw.map(|x| x / norm);
        let growth = random.uniform(0.1, 2.0);
        // Diffusivity 1 − (1 + g) n ⊗ n.
        let entry = |i: usize, j: usize| f64::from(i == j) - (1.0 + growth) * axis[i] * axis[j];
        let parameters =
            [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)];
        let found = assess(&model, &parameters, &[]);
        let (order, value) = coefficient(&found);
        assert_eq!(order, 2.0);
        assert!((value - growth).abs() < 1e-9 * growth, "{value}, not {growth}");
        let direction = found.direction.expect("ill-posed");
        let along: f64 = direction.iter().zip(axis).map(|(a, b)| a * b).sum();
        assert!(1.0 - along.abs() < 1e-9, "{direction:?}, not {axis:?}");
    }
}

/// The third-order Korteweg–de Vries equation is well-posed; a regularised long-wave equation of the wrong sign has a root
/// at infinity at a finite wave number.
#[test]
fn odd_orders_and_poles_on_a_line() {
    let parameters = ["b"];
    let kdv = build(1, &["u"], &[], &parameters, &["dt(u) + u*d1(u) + b*d1(d1(d1(u))) = 0"]);
    assert_eq!(assess(&kdv, &[0.3], &[("u", [0; 4], 1.2)]).assessment.verdict, Verdict::WellPosed);
    let long_waves =
        build(1, &["u"], &[], &parameters, &["dt(u) - b*dt(d1(d1(u))) = d1(d1(u)) - u"]);
    let verdict = |b: f64| assess(&long_waves, &[b], &[]).assessment.verdict;
    assert_eq!(verdict(0.3), Verdict::WellPosed);
    assert!(matches!(verdict(-0.3), Verdict::IllPosed { growth: None, .. }), "{:?}", verdict(-0.3));
}

/// A symmetric chain of `count` transported fields: hyperbolic.
fn chain(count: usize) -> ModelText {
    let name = |index: usize| format!("u{index}");
    let equation = |i: usize| {
        let mut terms = vec![format!("dt({})", name(i))];
        for j in [i.wrapping_sub(1), i + 1].into_iter().filter(|j| *j < count) {
            terms.push(format!("{}*d1({})", 1 + i.min(j), name(j)));
        }
        format!("{} = -{}", terms.join(" + "), name(i))
    };
    ModelText {
        dimensions: 1,
        unknowns: (0..count).map(|index| Quantity { name: name(index), unit: None }).collect(),
        equations: (0..count)
            .map(|index| NamedText { name: format!("e{index}"), text: equation(index) })
            .collect(),
        ..ModelText::default()
    }
}

#[test]
fn sixteen_unknowns_are_analysed_and_seventeen_refused() {
    for count in [11, 14, 16] {
        let model = TextModel::new(&chain(count)).expect("a model");
        let found = assess(&model, &[], &[]);
        assert_eq!(found.assessment.verdict, Verdict::WellPosed, "{count} unknowns");
    }
    let error = TextModel::new(&chain(17)).expect_err("too many").to_string();
    assert!(error.contains("17 unknowns") && error.contains("at most 16"), "{error}");
}
