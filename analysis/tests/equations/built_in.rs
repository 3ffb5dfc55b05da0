//! The built-in flow models and plane solids typed in as text, compared on random states.

use super::linearised::model_text;
use crate::support::states::{DilatancyKind, sample_order_one, seeded_generator};
use crate::support::typed_flows::type_in;
use models::LinearisedSystem;
use models::common::rates::RateEquations;
use models::equations::{TextModel, TextState, TextWorkspace};
use models::registry;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances};
use num_complex::Complex64;
use testkit::random::RandomNumbers;
use wellposed_analysis::growth::{self, Assessment, Verdict};
use wellposed_analysis::pencil::{Pencil, PencilRoots};

/// Asserts that all entries agree to 1e-12 of the largest entry of their row in the same matrix.
fn assert_same_entries(what: &str, ours: &LinearisedSystem<2>, typed: &LinearisedSystem<2>) -> f64 {
    assert!(typed.higher_terms.is_empty(), "{what}");
    assert_eq!(ours.velocity, typed.velocity, "{what}");
    let pairs = [
        (&ours.a, &typed.a),
        (&ours.b[0], &typed.b[0]),
        (&ours.b[1], &typed.b[1]),
        (&ours.c, &typed.c),
    ];
    let mut worst = 0.0f64;
    for (index, (own, other)) in pairs.into_iter().enumerate() {
        for row in 0..own.nrows() {
            let largest = own.row(row).iter().map(|x| x.value.abs()).fold(0.0, f64::max);
            for column in 0..own.ncols() {
                let (a, b) = (own[(row, column)], other[(row, column)]);
                let error = (a.value - b.value).abs();
                // Where all entries of a row cancel, rounding of the terms that cancel remains.
                let allowed = (1e-12 * largest).max(a.bound + b.bound);
                assert!(
                    error <= allowed,
                    "{what}: matrix {index}, row {row}, column {column}: {a:?}, {b:?}"
                );
                worst = worst.max(if largest > 0.0 { error / largest } else { 0.0 });
            }
        }
    }
    worst
}

/// Asserts that two assessments agree, directions but for a reflection at the angle `mirror`; returns false if a verdict
/// is marginal, since rounding bounds differ.
fn assert_same_assessment(what: &str, ours: &Assessment, typed: &Assessment, mirror: f64) -> bool {
    if ours.verdict.name() == "marginal" || typed.verdict.name() == "marginal" {
        return false;
    }
    match (&ours.verdict, &typed.verdict) {
        (
            Verdict::IllPosed { growth: a, direction: x },
            Verdict::IllPosed { growth: b, direction: y },
        ) => {
            match (a, b) {
                (Some(a), Some(b)) => {
                    assert_eq!(a.order, b.order, "{what}");
                    let error = (a.coefficient - b.coefficient).abs();
                    assert!(error <= 1e-8 * a.coefficient, "{what}: {a:?}, {b:?}");
                }
                (None, None) => {}
                _ => panic!("{what}: {a:?}, {b:?}"),
            }
            // Growth of the coaxial model is symmetric about the principal axes of the stress, so that two directions
            // may share the largest.
            let turns = [x - y, x + y - 2.0 * mirror].map(|turn| turn.sin().abs());
            assert!(turns[0].min(turns[1]) < 1e-6, "{what}: directions {x}, {y}");
        }
        (a, b) => assert_eq!(a, b, "{what}"),
    }
    true
}

/// Asserts that roots agree: simple ones to 1e-10, all by sum and product.
fn assert_same_roots(what: &str, ours: &[Complex64], typed: &[Complex64]) {
    assert_eq!(ours.len(), typed.len(), "{what}");
    let size = ours.iter().map(|root| root.norm()).fold(0.0, f64::max);
    let sums = [ours, typed].map(|list| list.iter().sum::<Complex64>());
    assert!((sums[0] - sums[1]).norm() <= 1e-10 * size, "{what}: sums {sums:?}");
    let products = [ours, typed].map(|list| list.iter().product::<Complex64>());
    let product_size: f64 = ours.iter().map(|root| root.norm().max(1e-12 * size)).product();
    assert!(
        (products[0] - products[1]).norm() <= 1e-9 * product_size,
        "{what}: products {products:?}"
    );
    for root in ours {
        let gap = |other: &Complex64| (other - root).norm();
        let neighbours = ours.iter().filter(|other| gap(other) < 1e-2 * root.norm()).count();
        if neighbours == 1 {
            let nearest = typed.iter().map(gap).fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= 1e-10 * root.norm().max(1e-4 * size),
                "{what}: {root} is off by {nearest:e}"
            );
        }
    }
}

#[test]
fn typed_flow_models_equal_the_built_in_ones() {
    for (name, kind) in [
        ("harris-grekova", registry::HARRIS_GREKOVA),
        ("double-shearing", registry::DOUBLE_SHEARING),
        ("plastic-potential", registry::PLASTIC_POTENTIAL),
        ("free-rotating", registry::FREE_ROTATING),
    ] {
        let (mut worst, mut undecided) = (0.0f64, 0);
        for seed in 0..200 {
            let random = &mut seeded_generator(seed);
            let dilatancy =
                if seed % 2 == 0 { DilatancyKind::Zero } else { DilatancyKind::Positive };
            let sample = sample_order_one(random, kind, dilatancy, seed / 2 % 2 == 0);
            let (model, state) = type_in(&sample, &model_text(&format!("typed-{name}")));
            let what = format!("{name}, state {seed}");
            let mut workspace = TextWorkspace::default();
            // The balances hold at the background, whose quantities the built-in model has derived from them.
            model
                .check_background(&state, &mut workspace)
                .unwrap_or_else(|error| panic!("{what}: {error}"));
            let mut typed = LinearisedSystem::default();
            model.linearise(&state, &mut workspace, &mut typed).expect("smooth");
            worst = worst.max(assert_same_entries(&what, &sample.system, &typed));
            let (mut own, mut other) = (Pencil::default(), Pencil::default());
            own.update(&sample.system).expect("finite");
            other.update(&typed).expect("finite");
            let assessments = [&own, &other].map(growth::assess);
            let [ours, ref other_assessment] = assessments;
            let mirror = sample.flow.stress.angle;
            let agree = assert_same_assessment(&what, &ours, other_assessment, mirror);
            undecided += usize::from(!agree);
            let (k, direction) = (random.log_uniform(0.1, 100.0), random.uniform(0.0, 3.0));
            match (own.roots(k, direction), other.roots(k, direction)) {
                (
                    PencilRoots::Regular { finite: a, infinite: i },
                    PencilRoots::Regular { finite: b, infinite: j },
                ) => {
                    assert_eq!(i, j, "{what}");
                    assert_same_roots(&what, &a, &b);
                }
                (a, b) => assert_eq!(a, b, "{what}"),
            }
        }
        println!("{name}: entries agree to {worst:e} of their row; {undecided} of 200 marginal");
        assert!(undecided <= 4, "{name}: {undecided} verdicts are marginal");
    }
}

/// Compares 200 random solids of a built-in theory with the bundled case `name`; `draw` returns the equations of a solid,
/// the parameters of the case, and √(ρ/j) or another wave number at which its terms are of one size, 1/m.
fn compare_solids(
    name: &str,
    draw: impl Fn(&mut RandomNumbers) -> (LinearisedSystem<2>, Vec<f64>, f64),
) {
    let model = TextModel::new(&model_text(name)).expect("a model");
    let (mut worst, mut undecided) = (0.0f64, 0);
    for seed in 0..200 {
        let random = &mut seeded_generator(seed);
        let (ours, parameters, wave_number) = draw(random);
        let mut typed = LinearisedSystem::default();
        let state = TextState { parameters, ..TextState::default() };
        model.linearise(&state, &mut TextWorkspace::default(), &mut typed).expect("smooth");
        let what = format!("{name} {seed}");
        worst = worst.max(assert_same_entries(&what, &ours, &typed));
        let (mut own, mut other) = (Pencil::default(), Pencil::default());
        own.update(&ours).expect("finite");
        other.update(&typed).expect("finite");
        let assessments = [&own, &other].map(growth::assess);
        let agree = assert_same_assessment(&what, &assessments[0], &assessments[1], 0.0);
        undecided += usize::from(!agree);
        let k = random.log_uniform(0.1, 10.0) * wave_number;
        if let (PencilRoots::Regular { finite: a, .. }, PencilRoots::Regular { finite: b, .. }) =
            (own.roots(k, 0.4), other.roots(k, 0.4))
        {
            assert_same_roots(&what, &a, &b);
        }
    }
    println!("{name}: entries agree to {worst:e} of their row; {undecided} of 200 marginal");
    assert!(undecided <= 4, "{name}: {undecided} verdicts are marginal");
}

/// Moduli λ, μ and α, density and inertia of a random solid.
fn draw_moduli(random: &mut RandomNumbers) -> [f64; 5] {
    let mu = random.log_uniform(1e-3, 1e10);
    let (lambda, alpha) = (mu * random.uniform(-0.6, 3.0), mu * random.uniform(0.01, 3.0));
    let density = random.log_uniform(0.1, 1e4);
    let inertia = density * random.log_uniform(1e-6, 1.0);
    [lambda, mu, alpha, density, inertia]
}

fn linearise(rates: RateEquations<2>) -> LinearisedSystem<2> {
    let mut system = LinearisedSystem::default();
    rates.linearise(&mut system);
    system
}

#[test]
fn typed_classical_solid_equals_the_built_in_one() {
    compare_solids("typed-classical", |random| {
        let [lambda, mu, _, density, _] = draw_moduli(random);
        let solid = Isotropic::new(lambda, mu, density, None).expect("moduli");
        (linearise(solid.rates()), vec![lambda, mu, density], 1.0)
    });
}

#[test]
fn typed_reduced_cosserat_solid_equals_the_built_in_one() {
    compare_solids("typed-reduced-cosserat", |random| {
        let [lambda, mu, alpha, density, inertia] = draw_moduli(random);
        let microrotation = Microrotation { alpha, inertia, couple: None };
        let solid = Isotropic::new(lambda, mu, density, Some(microrotation)).expect("moduli");
        let parameters = vec![lambda, mu, alpha, density, inertia];
        (linearise(solid.rates()), parameters, (density / inertia).sqrt())
    });
}

#[test]
fn typed_cosserat_solid_equals_the_built_in_one() {
    compare_solids("typed-cosserat", |random| {
        let [lambda, mu, alpha, density, inertia] = draw_moduli(random);
        let gamma = mu * random.log_uniform(1e-8, 1e-2);
        let eta = gamma * random.uniform(0.1, 3.0);
        let couple = Some(CoupleModuli { beta: 0.3 * gamma, gamma, eta });
        let microrotation = Microrotation { alpha, inertia, couple };
        let solid = Isotropic::new(lambda, mu, density, Some(microrotation)).expect("moduli");
        let parameters = vec![lambda, mu, alpha, gamma, eta, density, inertia];
        (linearise(solid.rates()), parameters, (density / inertia).sqrt())
    });
}

#[test]
fn typed_compliances_equal_the_built_in_ones() {
    compare_solids("typed-cosserat-compliances", |random| {
        let [_, mu, _, density, inertia] = draw_moduli(random);
        let [a1, a2] = [0; 2].map(|_| random.log_uniform(0.1, 10.0) / mu);
        let [b1, b2] = [a1, a2].map(|a| a * random.uniform(-0.9, 0.9));
        let alpha2 = mu * random.log_uniform(1e-8, 1e-2);
        let solid = PlaneCompliances { a1, b1, a2, b2, alpha2, density, inertia };
        let solid = solid.check().expect("compliances");
        let parameters = vec![a1, b1, a2, b2, alpha2, density, inertia];
        (linearise(solid.rates()), parameters, (density / inertia).sqrt())
    });
}
