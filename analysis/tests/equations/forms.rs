//! The same model in other forms and dimensions; large models.

use crate::support::states::seeded_generator;
use models::common::system::RoundedMatrix;
use models::equations::{
    JetVariable, ModelText, NamedText, Quantity, TextModel, TextState, TextWorkspace,
};
use models::{LinearisedSystem, Rounded};
use nalgebra::DMatrix;
use num_complex::Complex64;
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

/// ċ = −Q²c − b M²c with a quadratic form Q that vanishes on a cone about a random axis a, and M = m·∇: to leading order
/// decay as −Q² k⁴, but on the cone growth as b (m·n)² k², largest where n lies in the plane of a and m.
#[test]
fn growth_on_a_cone_of_degenerate_directions_is_located() {
    let names = ["q11", "q22", "q33", "q12", "q13", "q23", "m1", "m2", "m3", "b"];
    let q = |inner: &str| {
        let term = |i: usize, j: usize| format!("d{i}(d{j}({inner}))");
        format!(
            "q11*{} + q22*{} + q33*{} + 2*(q12*{} + q13*{} + q23*{})",
            term(1, 1),
            term(2, 2),
            term(3, 3),
            term(1, 2),
            term(1, 3),
            term(2, 3)
        )
    };
    let along = |inner: &str| format!("m1*d1({inner}) + m2*d2({inner}) + m3*d3({inner})");
    let equation = format!("dt(c) = -({}) - b*({})", q(&q("c")), along(&along("c")));
    let model = build(3, &["c"], &[], &names, &[&equation]);
    let mut random = seeded_generator(10);
    for trial in 0..6 {
        let mut unit_vector = || {
            let raw = [0; 3].map(|_| random.signed_uniform(0.05, 1.0));
            let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
            raw.map(|x| x / norm)
        };
        let (axis, slope) = (unit_vector(), unit_vector());
        let (half_angle, growth) = (random.uniform(0.3, 1.3), random.uniform(0.1, 2.0));
        let cosine = half_angle.cos();
        // Q = |κ|² cos²α − (a·κ)².
        let entry = |i: usize, j: usize| f64::from(i == j) * cosine * cosine - axis[i] * axis[j];
        let mut parameters =
            vec![entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)];
        parameters.extend(slope);
        parameters.push(growth);
        let found = assess(&model, &parameters, &[]);
        let (order, value) = coefficient(&found);
        let between = axis.iter().zip(slope).map(|(a, b)| a * b).sum::<f64>().acos();
        let [near, far] = [between - half_angle, between + half_angle].map(|x| x.cos().powi(2));
        let expected = growth * near.max(far);
        assert_eq!(order, 2.0, "{trial}");
        assert!((value - expected).abs() < 1e-7 * expected, "{trial}: {value}, not {expected}");
        let direction = found.direction.expect("ill-posed");
        let along: f64 = direction.iter().zip(axis).map(|(a, b)| a * b).sum();
        assert!((along.abs() - cosine).abs() < 1e-6, "{trial}: {direction:?}");
        // With decay along M instead: well-posed.
        *parameters.last_mut().expect("not empty") = -growth;
        let verdict = assess(&model, &parameters, &[]).assessment.verdict;
        assert_eq!(verdict, Verdict::WellPosed, "{trial}");
    }
}

/// ċ = −κ·D·κ c − |κ|⁴ c has its largest growth rate g²/4 along the axis of the negative diffusivity −g.
#[test]
fn largest_growth_rate_in_space_is_located() {
    let names = ["k11", "k22", "k33", "k12", "k13", "k23"];
    let model = build(
        3,
        &["c"],
        &[],
        &names,
        &["dt(c) = d1(k11*d1(c) + k12*d2(c) + k13*d3(c)) + d2(k12*d1(c) + k22*d2(c) + k23*d3(c)) \
           + d3(k13*d1(c) + k23*d2(c) + k33*d3(c)) - d1(d1(d1(d1(c)))) - d2(d2(d2(d2(c)))) \
           - d3(d3(d3(d3(c)))) - 2*(d1(d1(d2(d2(c)))) + d1(d1(d3(d3(c)))) + d2(d2(d3(d3(c)))))"],
    );
    let mut random = seeded_generator(11);
    for trial in 0..3 {
        let raw = [0; 3].map(|_| random.signed_uniform(0.05, 1.0));
        let norm = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axis = raw.map(|x| x / norm);
        let growth = random.uniform(0.1, 2.0);
        let entry = |i: usize, j: usize| f64::from(i == j) - (1.0 + growth) * axis[i] * axis[j];
        let parameters =
            vec![entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)];
        let mut state = TextState { parameters, ..TextState::default() };
        let mut workspace = EquationsWorkspace::default();
        let found = workspace.assess(&model, &mut state).expect("smooth");
        assert_eq!(found.assessment.verdict, Verdict::WellPosed);
        let located = workspace.locate_supremum(&model, &found).expect("finite");
        let (supremum, direction) = located.expect("well-posed");
        let expected = 0.25 * growth * growth;
        let error = (supremum.growth_rate - expected).abs();
        assert!(error < 1e-5 * expected, "{trial}: {supremum:?}, not {expected}");
        let along: f64 = direction.iter().zip(axis).map(|(a, b)| a * b).sum();
        assert!(1.0 - along.abs() < 1e-4, "{trial}: {direction:?}, not {axis:?}");
    }
}

/// Poincaré waves on a rotating shallow layer conserve energy: their growth rate is zero, not the rounding error of the
/// neutral roots ς = 0, ± i √(f² + c²k²). A slow reaction beside them grows at its own rate.
#[test]
fn rounding_errors_are_not_growth() {
    let equations = [
        "dt(u) - f*v = -g*d1(h)",
        "dt(v) + f*u = -g*d2(h)",
        "dt(h) + depth*(d1(u) + d2(v)) = 0",
        "dt(c) = rate*c + b*(d1(d1(c)) + d2(d2(c)))",
    ];
    let parameters = ["f", "g", "depth", "rate", "b"];
    let model = build(2, &["u", "v", "h", "c"], &[], &parameters, &equations);
    let mut random = seeded_generator(12);
    for trial in 0..40 {
        let [f, g, depth, b] = [0; 4].map(|_| 10f64.powf(random.uniform(-3.0, 3.0)));
        let rate = if trial % 2 == 0 { 0.0 } else { f * 10f64.powf(random.uniform(-8.0, 0.0)) };
        let parameters = vec![f, g, depth, rate, b];
        let mut state = TextState { parameters, ..TextState::default() };
        let mut workspace = EquationsWorkspace::default();
        let found = workspace.assess(&model, &mut state).expect("smooth");
        let located = workspace.locate_supremum(&model, &found).expect("finite");
        let (supremum, _) = located.expect("well-posed");
        let error = (supremum.growth_rate - rate).abs();
        assert!(error <= 1e-5 * rate, "{trial}: {supremum:?}, not {rate}");
    }
}

/// Equations without evolution in time have no growth rate.
#[test]
fn equations_without_time_have_no_growth_rate() {
    let model = build(1, &["c"], &[], &[], &["d1(d1(c)) = 0"]);
    let (mut state, mut workspace) = (TextState::default(), EquationsWorkspace::default());
    let found = workspace.assess(&model, &mut state).expect("smooth");
    assert_eq!(workspace.locate_supremum(&model, &found).expect("finite"), None);
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

/// A viscous flow with the stress, the strain rate and a heat flux as unknowns, with coefficients that are numbers.
fn flow_with_stresses() -> TextModel {
    build(
        2,
        &["v1", "v2", "s11", "s12", "s22", "e12", "p", "T", "q1", "q2"],
        &["v1", "v2"],
        &["eta", "k"],
        &[
            "D(v1) = d1(s11) + d2(s12) + T*d1(T)",
            "D(v2) = d1(s12) + d2(s22)",
            "s11 = -p + 2*eta*d1(v1) + T^2*q1",
            "2*s22 + 2*p = 4*eta*d2(v2)",
            "s12 - 4*eta*e12 = 0",
            "2*e12 = d1(v2) + d2(v1)",
            "d1(v1) + d2(v2) = 0",
            "D(T) + d1(q1) + d2(q2) = s12*e12",
            "q1 = -k*T*d1(T)",
            "3*q2 = -3*k*d2(d2(d2(T))) - 3*q1",
        ],
    )
}

/// The symbols with and without the unknowns that an equation gives have the same determinant but for a number.
#[test]
fn elimination_keeps_the_determinant() {
    let model = flow_with_stresses();
    // s11, s12, s22, e12, q1, q2.
    assert_eq!(model.eliminated_count(), 6);
    let mut state = TextState { parameters: vec![0.7, -0.4], ..TextState::default() };
    for (unknown, orders, value) in [
        (0, [0, 0, 1, 0], 1.5),
        (1, [0; 4], -0.3),
        (3, [0; 4], 2.1),
        (5, [0; 4], 0.75),
        (6, [0; 4], 3.0),
        (7, [0; 4], 1.3),
        (7, [0, 1, 0, 0], 0.2),
        (8, [0; 4], 0.6),
    ] {
        state.set_background(JetVariable { unknown, orders }, Rounded::from_rounded(value));
    }
    let (mut full, mut reduced) = (LinearisedSystem::<2>::default(), LinearisedSystem::default());
    let workspace = &mut TextWorkspace::default();
    model.linearise(&state, workspace, &mut full).expect("smooth");
    model.linearise_reduced(&state, workspace, &mut reduced).expect("smooth");
    assert_eq!((full.unknowns.len(), reduced.unknowns.len()), (10, 4));
    let determinant = |system: &LinearisedSystem<2>, rate: Complex64, k: [Complex64; 2]| {
        let size = system.unknowns.len();
        let mut symbol = DMatrix::from_fn(size, size, |i, j| {
            let entry = |own: &RoundedMatrix| own[(i, j)].value;
            rate * entry(&system.a)
                + k[0] * entry(&system.b[0])
                + k[1] * entry(&system.b[1])
                + entry(&system.c)
        });
        for term in &system.higher_terms {
            let [b, c] = term.space_powers.map(u32::from);
            let powers = rate.powu(term.time_power.into()) * k[0].powu(b) * k[1].powu(c);
            symbol[(term.row, term.column)] += powers * term.coefficient.value;
        }
        symbol.determinant()
    };
    let mut random = seeded_generator(9);
    for _ in 0..50 {
        let mut complex = || Complex64::new(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
        let (rate, k) = (complex(), [complex(), complex()]);
        let [a, b] = [&full, &reduced].map(|system| determinant(system, rate, k));
        // The product of the pivots: 1, 2, 1, 2, 1, 3.
        let error = (a / b).norm() - 12.0;
        assert!(error.abs() < 1e-10 && (a / b).im.abs() < 1e-9, "{a}, {b}");
    }
}

/// Sixteen unknowns with fluxes are analysed: only those that no equation gives count.
#[test]
fn unknowns_that_an_equation_gives_do_not_count() {
    let mut text = chain(16);
    for index in 0..16 {
        text.unknowns.push(Quantity { name: format!("q{index}"), unit: None });
        let equation = &mut text.equations[index].text;
        *equation = format!("{equation} - d1(q{index})");
        let flux = format!("q{index} = -{}*d1(u{index})", 1 << index);
        text.equations.push(NamedText { name: format!("flux {index}"), text: flux });
    }
    let model = TextModel::new(&text).expect("a model");
    assert_eq!(model.eliminated_count(), 16);
    let found = assess(&model, &[], &[]);
    assert_eq!(found.assessment.verdict, Verdict::WellPosed);
    // Fluxes along the gradients: backward diffusion.
    text.equations.iter_mut().skip(16).for_each(|own| own.text = own.text.replace("= -", "= "));
    let found = assess(&TextModel::new(&text).expect("a model"), &[], &[]);
    let (order, value) = coefficient(&found);
    assert!(order == 2.0 && (value - 32768.0).abs() < 1e-6, "{order}, {value}");
}
