//! Meaning of model texts: names, cycles, units, kinks, residuals, solved derivatives, moving frames.

use crate::equations::text_models::{coefficient, granular_rheology, jet, model_text, state};
use wellposed_models::LinearisedSystem;
use wellposed_models::equations::{EvaluationError, NamedText, TextModel, TextWorkspace};

const RHEOLOGY_PARAMETERS: [f64; 6] = [1500.0, 2500.0, 5e-4, 0.342, 0.557, 0.069];

/// Entries of the incompressible μ(I) rheology in simple shear, derived by hand: with v = (γ̇x₂, 0) the stress
/// perturbation is s′₁₂ = τ′(γ̇)(∂₂v₁ + ∂₁v₂) + (∂τ/∂p) p′, s′₁₁ = −p′ + 2η∂₁v₁.
#[test]
fn rheology_in_simple_shear_has_the_entries_of_the_hand_calculation() {
    let model = TextModel::new(&granular_rheology()).expect("a model");
    let (rate, pressure) = (10.0, 1000.0);
    let at =
        state(&model, &RHEOLOGY_PARAMETERS, &[("p", [0; 4], pressure), ("v1", [0, 0, 1, 0], rate)]);
    let (mut workspace, mut system) = (TextWorkspace::default(), LinearisedSystem::<2>::default());
    model.check_background(&at, &mut workspace).expect("steady shear");
    model.linearise(&at, &mut workspace, &mut system).expect("a smooth state");
    let [rho, rho_s, d, mu_s, mu_2, i0] = RHEOLOGY_PARAMETERS;
    let inertial = rate * d * (rho_s / pressure).sqrt();
    let mu = mu_s + (mu_2 - mu_s) / (1.0 + i0 / inertial);
    // I dμ/dI = (μ₂ − μ_s) I₀ I/(I + I₀)².
    let slope = (mu_2 - mu_s) * i0 * inertial / (inertial + i0).powi(2);
    let (viscosity, tangent) = (mu * pressure / rate, slope * pressure / rate);
    let by_pressure = mu - 0.5 * slope;
    /// Name, row and column, powers of ς and κ, value.
    type Entry = (&'static str, (usize, usize), u8, [u8; 2], f64);
    let expected: [Entry; 12] = [
        ("inertia", (0, 0), 1, [0, 0], rho),
        ("advection of the background", (0, 1), 0, [0, 0], rho * rate),
        ("pressure 1", (0, 2), 0, [1, 0], 1.0),
        ("friction of pressure", (0, 2), 0, [0, 1], -by_pressure),
        ("normal viscosity", (0, 0), 0, [2, 0], -2.0 * viscosity),
        ("tangent viscosity", (0, 0), 0, [0, 2], -tangent),
        ("tangent viscosity, mixed", (0, 1), 0, [1, 1], -tangent),
        ("pressure 2", (1, 2), 0, [0, 1], 1.0),
        ("friction of pressure 2", (1, 2), 0, [1, 0], -by_pressure),
        ("normal viscosity 2", (1, 1), 0, [0, 2], -2.0 * viscosity),
        ("volume 1", (2, 0), 0, [1, 0], 1.0),
        ("volume 2", (2, 1), 0, [0, 1], 1.0),
    ];
    for (name, entry, time, space, value) in expected {
        let found = coefficient(&system, entry, time, space);
        let error = (found.value - value).abs();
        assert!(error <= 1e-13 * value.abs() + found.bound, "{name}: {found:?}, not {value}");
        assert!(found.bound <= 1e-12 * value.abs(), "{name}: {found:?}");
    }
    assert!(model.unused_parameters().is_empty());
}

/// In the frame of the background velocity the linearised equations do not depend on it.
#[test]
fn material_derivatives_do_not_depend_on_a_uniform_velocity() {
    let model = TextModel::new(&granular_rheology()).expect("a model");
    let system_at = |velocity: [f64; 2]| {
        // ∂ₜv₁ = −v₂ γ̇ keeps the particle free of acceleration.
        let at = state(
            &model,
            &RHEOLOGY_PARAMETERS,
            &[
                ("p", [0; 4], 1000.0),
                ("v1", [0; 4], velocity[0]),
                ("v2", [0; 4], velocity[1]),
                ("v1", [0, 0, 1, 0], 10.0),
                ("v1", [1, 0, 0, 0], -10.0 * velocity[1]),
            ],
        );
        let (mut workspace, mut system) =
            (TextWorkspace::default(), LinearisedSystem::<2>::default());
        model.check_background(&at, &mut workspace).expect("steady in the frame of the particle");
        model.linearise(&at, &mut workspace, &mut system).expect("a smooth state");
        system
    };
    let (rest, moving) = (system_at([0.0; 2]), system_at([3.0, -0.7]));
    assert_eq!(moving.velocity, [3.0, -0.7]);
    assert_eq!((&rest.a, &rest.c, &rest.b), (&moving.a, &moving.c, &moving.b));
    assert_eq!(rest.higher_terms, moving.higher_terms);
}

fn refusal(change: impl Fn(&mut wellposed_models::equations::ModelText)) -> String {
    let mut text = granular_rheology();
    change(&mut text);
    TextModel::new(&text).expect_err("a refusal").to_string()
}

#[test]
fn refusals_name_place_and_remedy() {
    let message =
        refusal(|text| text.definitions[3].text = "mu_s + (mu_2 - mus)/(1 + I0/I)".into());
    assert!(
        message.contains("line 1, column 16") && message.contains("did you mean mu_s?"),
        "{message}"
    );
    let message = refusal(|text| text.definitions[0].text = "(d2(v1) + d1(v2)/2".into());
    assert!(message.contains("')' for the '(' at line 1, column 1"), "{message}");
    let message = refusal(|text| text.definitions[1].text = "sqrt(I)".into());
    assert!(message.contains("rate → I → rate") || message.contains("I → rate → I"), "{message}");
    let message = refusal(|text| text.equations[0].text = "rho*D(v1) = d1(s11) + s12".into());
    assert!(
        message.contains("'d1(s11)' has the unit kg/(m^2 s^2), 's12' has kg/(m s^2)"),
        "{message}"
    );
    let message = refusal(|text| text.definitions[3].text = "mu_s + exp(d)".into());
    assert!(
        message.contains("'d' has the unit m") && message.contains("exp takes a pure number"),
        "{message}"
    );
    let message = refusal(|text| {
        text.equations.push(wellposed_models::equations::NamedText {
            name: "more".into(),
            text: "p = 0".into(),
        })
    });
    assert!(message.contains("4 equations for 3 unknowns"), "{message}");
    let message = refusal(|text| {
        text.unknowns.push(wellposed_models::equations::Quantity {
            name: "T".into(),
            unit: Some("K".into()),
        });
    });
    assert!(message.contains("unknown T: in no equation"), "{message}");
    let message = refusal(|text| text.parameters[2].unit = Some("furlong".into()));
    assert!(message.contains("the unit 'furlong'"), "{message}");
    let message = refusal(|text| text.velocity = vec!["v1".into(), "u2".into()]);
    assert!(message.contains("did you mean v2?"), "{message}");
    let message = refusal(|text| text.driven = vec!["momentum1".into()]);
    assert!(message.contains("did you mean momentum 1?"), "{message}");
    let message = refusal(|text| text.equations[2].text = "d1(v1) + d3(v2) = 0".into());
    assert!(message.contains("d3 in a model of 2 dimensions"), "{message}");
    let message = refusal(|text| text.equations[2].text = "d1(v1) +\n d2(v2 = 0".into());
    assert!(message.contains("line 2, column 8"), "{message}");
}

#[test]
fn kinks_and_poles_are_named_with_their_value() {
    let model = TextModel::new(&granular_rheology()).expect("a model");
    let mut workspace = TextWorkspace::default();
    let mut system = LinearisedSystem::<2>::default();
    let rest = state(&model, &RHEOLOGY_PARAMETERS, &[("p", [0; 4], 1000.0)]);
    let error = model.linearise(&rest, &mut workspace, &mut system).expect_err("no rate");
    let EvaluationError::Undefined { expression, problem, value, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(expression, "sqrt(2*(d1(v1)^2 + 2*D12^2 + d2(v2)^2))");
    assert_eq!((*problem, *value), ("is not differentiable at 0", 0.0));
    for (text, value, is_smooth) in [
        ("abs(u)", 0.0, false),
        ("abs(u)", 1e-300, true),
        ("max(u, 2)", 2.0, false),
        ("min(u, 2)", 1.0, true),
        ("sign(u - 1)", 1.0, false),
        ("u^1.5", 0.0, false),
        ("u^2", 0.0, true),
        ("1/u", 0.0, false),
        ("ln(u)", -1.0, false),
        ("tan(u)", 1.0, true),
        ("asin(u)", 1.5, false),
        ("exp(u)", 800.0, false),
    ] {
        let own = model_text(1, &[("u", "-")], &[], &[], &[], &[("e", &format!("dt(u) = {text}"))]);
        let model = TextModel::new(&own).expect("a model");
        let at = state(&model, &[], &[("u", [0; 4], value)]);
        let mut system = LinearisedSystem::<1>::default();
        let residuals = model.residuals(&at, &mut workspace).map(drop);
        let found = residuals.and(model.linearise(&at, &mut workspace, &mut system));
        assert_eq!(found.is_ok(), is_smooth, "{text} at {value}: {found:?}");
        if let Err(error) = found {
            assert!(error.to_string().contains(text.split('(').next().unwrap_or(text)), "{error}");
        }
    }
}

#[test]
fn residuals_refuse_a_background_unless_driven_or_solved() {
    let text = granular_rheology();
    let model = TextModel::new(&text).expect("a model");
    let mut workspace = TextWorkspace::default();
    // Two shear gradients: ∂₂∂₂v₁ ≠ 0 leaves a net force.
    let mut at = state(
        &model,
        &RHEOLOGY_PARAMETERS,
        &[("p", [0; 4], 1000.0), ("v1", [0, 0, 1, 0], 10.0), ("v1", [0, 0, 2, 0], 50.0)],
    );
    let error = model.check_background(&at, &mut workspace).expect_err("a net force");
    assert!(
        matches!(error, EvaluationError::Residual { relative, .. } if relative > 0.99),
        "{error}"
    );
    assert!(error.to_string().contains("momentum 1"), "{error}");

    // The acceleration balances it: ρ∂ₜv₁ = τ′(γ̇) ∂₂∂₂v₁.
    at.solved = vec![jet(&model, "v1", [1, 0, 0, 0])];
    model.solve_background(&mut at, &mut workspace).expect("one unknown in one equation");
    model.check_background(&at, &mut workspace).expect("solved");
    let inertial: f64 = 10.0 * 5e-4 * 2.5f64.sqrt();
    let tangent = (0.557 - 0.342) * 0.069 * inertial / (inertial + 0.069).powi(2) * 1000.0 / 10.0;
    let (_, found) = at.background[at.background.len() - 1];
    assert!(
        (found.value - tangent * 50.0 / 1500.0).abs() <= 1e-13 * found.value.abs(),
        "{found:?}"
    );
    assert!(found.bound < 1e-12 * found.value.abs(), "{found:?}");

    let driven = TextModel::new(&wellposed_models::equations::ModelText {
        driven: vec!["momentum 1".into()],
        ..text
    });
    at.set_background(jet(&model, "v1", [1, 0, 0, 0]), wellposed_models::Rounded::ZERO);
    driven.expect("a model").check_background(&at, &mut workspace).expect("driven");

    // A derivative that no equation determines.
    at.solved = vec![jet(&model, "p", [1, 0, 0, 0])];
    let error = model.solve_background(&mut at, &mut workspace).expect_err("∂ₜp is nowhere");
    assert!(matches!(error, EvaluationError::NotDetermined { .. }), "{error}");
}

/// The rheology with its sums written by indices has the coefficients of the one with all terms, and the stress σ[2,1]
/// needs a name of its own.
#[test]
fn sums_over_the_dimensions_equal_their_terms() {
    let mut text = granular_rheology();
    let replace = |list: &mut Vec<NamedText>, name: &str, text: &str| match list
        .iter_mut()
        .find(|own| own.name == name)
    {
        Some(own) => own.text = text.into(),
        None => list.push(NamedText { name: name.into(), text: text.into() }),
    };
    replace(&mut text.equations, "momentum 1", "rho*D(v1) = sum(j, d[j](s[1,j]))");
    replace(&mut text.equations, "momentum 2", "rho*D(v[2]) = sum(j, d[j](s[2, j]))");
    replace(&mut text.equations, "volume", "sum(i, d[i](v[i])) = 0");
    let rate = "sqrt(sum(i, sum(k, (d[i](v[k]) + d[k](v[i]))^2))/2)";
    replace(&mut text.definitions, "rate", rate);
    let error = TextModel::new(&text).expect_err("no s21");
    assert_eq!(error.position, Some([1, 27]), "{error}");
    assert!(error.found.contains("'s21'"), "{error}");
    replace(&mut text.definitions, "s21", "s12");
    let systems = [granular_rheology(), text].map(|text| {
        let model = TextModel::new(&text).expect("a model");
        let values = [("p", [0; 4], 1000.0), ("v1", [0, 0, 1, 0], 10.0)];
        let at = state(&model, &RHEOLOGY_PARAMETERS, &values);
        let mut system = LinearisedSystem::<2>::default();
        model.linearise(&at, &mut TextWorkspace::default(), &mut system).expect("a smooth state");
        system
    });
    for row in 0..3 {
        for column in 0..3 {
            for powers in [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]] {
                for time in [0, 1] {
                    let [a, b] =
                        systems.each_ref().map(|own| coefficient(own, (row, column), time, powers));
                    let error = (a.value - b.value).abs();
                    assert!(error <= 1e-14 * a.value.abs() + a.bound, "{a:?}, {b:?}");
                }
            }
        }
    }
}

#[test]
fn wrong_sums_are_refused_with_place_and_remedy() {
    let cases = [
        ("sum(j, d[k](v[j]))", [1, 10], "1, 2, 3 or j"),
        ("d[j](v1)", [1, 3], "the index of a sum"),
        ("d[4](v1)", [1, 3], "1, 2 or 3"),
        ("sum(j, sum(j, v[j]))", [1, 12], "differently"),
        ("sum(j d[j](v[j]))", [1, 7], "','"),
        ("sum(2, v1)", [1, 5], "an index"),
        ("sum j", [1, 5], "'('"),
        ("sum(j, v[j) + p", [1, 11], "']'"),
        ("sum(j, v[j] + p", [1, 16], "')'"),
        ("sum(a, sum(b, sum(c, sum(e, v[e]))))", [1, 22], "definitions"),
    ];
    for (case, position, remedy) in cases {
        let mut text = granular_rheology();
        text.definitions[0].text = case.into();
        let error = TextModel::new(&text).expect_err(case);
        assert_eq!(error.position, Some(position), "{case}: {error}");
        assert!(error.remedy.contains(remedy), "{case}: {error}");
    }
}
