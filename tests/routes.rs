//! Verifies that both routes to a verdict, by closed form and from the linearised equations, give the same verdict,
//! order, coefficient and direction.

use crate::states;

use analysis::flows::FlowWorkspace;
use analysis::growth::Verdict;
use models::ClosedFormVerdict;
use models::flow::FlowKind;
use models::flow::state::MaterialState;
use models::registry;
use rayon::prelude::*;
use states::{ParameterRange, create_random_numbers};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use testkit::flows::FlowParameters;
use wellposed::cli::{self, Options};
use wellposed::study::MapOptions;

/// Tolerance of the relative difference of two coefficients.
const COEFFICIENT_TOLERANCE: f64 = 1e-9;

/// Tolerance of the angle between two directions, rad: about √ε, since a smooth function varies only at second order
/// near its maximum.
const DIRECTION_TOLERANCE: f64 = 1e-7;

/// Comparison of both routes for one state of a model.
struct RouteComparison {
    closed_form: Option<ClosedFormVerdict>,
    /// Quantity in which closed form and linearised equations differ; `None` if they agree or without a closed form.
    difference: Option<String>,
}

impl RouteComparison {
    fn new(
        workspace: &mut FlowWorkspace,
        kind: FlowKind,
        parameters: &FlowParameters,
        state: &MaterialState,
    ) -> Self {
        let (model, flow) = states::build_flow(kind, parameters, state);
        let closed_form = model.closed_form_verdict(&flow);
        let assessed = workspace.assess(&model, &flow).expect("finite coefficients").verdict;
        let difference = closed_form.and_then(|verdict| {
            let quantity = find_difference(&Verdict::from(verdict), &assessed, |from| {
                find_mirror_direction(kind, parameters, state, from)
            })?;
            Some(format!(
                "{quantity}: {verdict:?} against {assessed:?} for {kind:?}, {parameters:?}, {state:?}"
            ))
        });
        Self { closed_form, difference }
    }

    /// Returns the name of the closed-form verdict.
    fn closed_form_name(&self) -> &'static str {
        match self.closed_form {
            None => "declined",
            Some(ClosedFormVerdict::WellPosed) => "well-posed",
            Some(ClosedFormVerdict::PowerLawGrowth { order: 1, .. }) => "order 1",
            Some(ClosedFormVerdict::PowerLawGrowth { .. }) => "order 2",
            Some(ClosedFormVerdict::UnboundedAtFiniteWaveNumber { .. }) => "unbounded at finite k",
            Some(ClosedFormVerdict::Indeterminate { .. }) => "indeterminate",
        }
    }
}

/// Returns the quantity in which two verdicts differ; `None` if they agree. `mirror_direction` returns the second
/// direction with equal growth; a closed form may give either of the two.
fn find_difference(
    closed_form: &Verdict,
    assessed: &Verdict,
    mirror_direction: impl Fn(f64) -> f64,
) -> Option<&'static str> {
    let (
        Verdict::IllPosed { growth, direction },
        Verdict::IllPosed { growth: other_growth, direction: other },
    ) = (closed_form, assessed)
    else {
        return (closed_form != assessed).then_some("verdict");
    };
    match (growth, other_growth) {
        (None, None) => {}
        (Some(own), Some(other)) if own.order == other.order => {
            if (own.coefficient / other.coefficient - 1.0).abs() > COEFFICIENT_TOLERANCE {
                return Some("coefficient");
            }
        }
        _ => return Some("order"),
    }
    let is_far = |from: f64| {
        let difference = (from - other).rem_euclid(PI);
        difference.min(PI - difference) > DIRECTION_TOLERANCE
    };
    (is_far(*direction) && is_far(mirror_direction(*direction))).then_some("direction")
}

/// Returns the other direction in which waves grow as in `direction`, or `direction` itself if there is none.
///
/// Growth in the plastic potential is symmetric about the principal axes of stress. In the dilatant model of
/// Harris & Grekova the leading coefficient a − b cos β + d sin β vanishes at two angles β = 2(ψ − direction), with the
/// stress angle ψ; their mean is −atan2(d, b).
fn find_mirror_direction(
    kind: FlowKind,
    parameters: &FlowParameters,
    state: &MaterialState,
    direction: f64,
) -> f64 {
    let psi = state.stress_angle;
    match kind {
        kind if kind == registry::PLASTIC_POTENTIAL => 2.0 * psi - direction,
        kind if kind == registry::HARRIS_GREKOVA && parameters.dilatancy_angle > 0.0 => {
            let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
            let twice_delta = 2.0 * state.noncoaxiality.unwrap_or(0.0);
            let e = phi - nu;
            let b = nu.cos() * twice_delta.cos() * (e.cos() * phi.sin() + nu.sin());
            let d = nu.sin() * phi.cos() * e.cos() * twice_delta.sin();
            2.0 * psi - direction + d.atan2(b)
        }
        _ => direction,
    }
}

/// Assesses states in parallel; panics with the first few that differ, and counts the closed-form verdicts by model.
fn check_route_agreement(
    states: impl IndexedParallelIterator<Item = (FlowKind, FlowParameters, MaterialState)>,
) -> BTreeMap<(&'static str, &'static str), usize> {
    let comparisons: Vec<_> = states
        .map_init(FlowWorkspace::default, |workspace, (kind, parameters, state)| {
            let comparison = RouteComparison::new(workspace, kind, &parameters, &state);
            ((kind.name(), comparison.closed_form_name()), comparison.difference)
        })
        .collect();
    let differences: Vec<&str> =
        comparisons.iter().filter_map(|(_, difference)| difference.as_deref()).collect();
    assert!(
        differences.is_empty(),
        "{} differ:\n{}",
        differences.len(),
        differences[..differences.len().min(5)].join("\n")
    );
    let mut counts = BTreeMap::new();
    for (name, _) in comparisons {
        *counts.entry(name).or_insert(0) += 1;
    }
    counts
}

/// Verifies both routes for random states of every model, with the dilatancy angle ν = 0 and ν > 0, with and without
/// gradients and accelerations, for ordinary materials and for the full ranges of angles and quantities over many
/// decades.
#[test]
fn both_routes_agree_on_random_states() {
    check_random_states(30_000);
}

#[test]
#[ignore = "takes a quarter of a minute"]
fn both_routes_agree_on_many_random_states() {
    check_random_states(100_000);
}

/// Checks both routes for `count` states, a multiple of four.
fn check_random_states(count: usize) {
    let states = (0..count).into_par_iter().map(|index| {
        let random = &mut create_random_numbers(index as u64);
        let kind = registry::STANDARD_FLOWS[index % 4];
        let (is_dilatant, has_gradients) = (index / 4 % 2 == 0, index / 8 % 2 == 0);
        let range = if index / 16 % 2 == 0 {
            ParameterRange::FullRange
        } else {
            ParameterRange::GranularMaterials
        };
        let (parameters, state) =
            states::generate_state(random, kind, range, is_dilatant, has_gradients);
        (kind, parameters, state)
    });
    let counts = check_route_agreement(states);
    println!("{counts:?}");
    // Smallest number of states with each answer in 100,000.
    for (kind, answer, min_count) in [
        ("harris-grekova", "well-posed", 6_000),
        ("harris-grekova", "order 2", 5_000),
        ("harris-grekova", "unbounded at finite k", 1_000),
        ("double-shearing", "order 1", 22_000),
        ("plastic-potential", "order 2", 22_000),
        ("free-rotating", "indeterminate", 24_999),
    ] {
        assert!(
            100_000 * counts[&(kind, answer)] > min_count * count,
            "{kind}, {answer}: {counts:?}"
        );
    }
}

/// Distances from a boundary, rad, and whether closed forms answer: `false` for none of the states, `true` for some;
/// `None`: not checked.
const BOUNDARY_DISTANCES: [(f64, Option<bool>); 9] = [
    (0.0, Some(false)),
    (1e-15, Some(false)),
    (1e-12, Some(false)),
    (1e-9, Some(false)),
    (1e-7, None),
    (1e-5, None),
    (1e-4, None),
    (1e-3, None),
    (2e-2, Some(true)),
];

/// Number of states at each distance from a boundary.
const NEAR_STATES: usize = 200;

/// Verifies both routes for states at several distances inside and outside a boundary; `shift_state` moves a random
/// state to a signed distance (rad) from it.
fn check_route_agreement_near_boundary(
    kind: FlowKind,
    is_dilatant: bool,
    has_gradients: bool,
    shift_state: impl Fn(&mut FlowParameters, &mut MaterialState, f64) + Sync,
) {
    for (distance, answers) in BOUNDARY_DISTANCES {
        let states = (0..NEAR_STATES).into_par_iter().map(|index| {
            let random = &mut create_random_numbers(0xb0 + index as u64);
            let (mut parameters, mut state) = states::generate_state(
                random,
                kind,
                ParameterRange::GranularMaterials,
                is_dilatant,
                has_gradients,
            );
            let signed_distance = if index % 2 == 0 { distance } else { -distance };
            shift_state(&mut parameters, &mut state, signed_distance);
            (kind, parameters, state)
        });
        let counts = check_route_agreement(states);
        let declined = counts.get(&(kind.name(), "declined")).copied().unwrap_or(0);
        match answers {
            Some(true) => assert!(declined < NEAR_STATES, "{distance}: {counts:?}"),
            Some(false) => assert_eq!(declined, NEAR_STATES, "{distance}: {counts:?}"),
            None => {}
        }
    }
}

/// Verifies both routes near the boundary |Δ| = 45° of Harris & Grekova with ν = 0, where cos 2Δ changes sign (Δ:
/// non-coaxiality angle, ν: dilatancy angle).
#[test]
fn both_routes_agree_near_noncoaxiality_bound() {
    for has_gradients in [false, true] {
        for bound in [-0.25 * PI, 0.25 * PI] {
            check_route_agreement_near_boundary(
                registry::HARRIS_GREKOVA,
                false,
                has_gradients,
                |_, state, distance| {
                    state.noncoaxiality = Some(bound + distance);
                },
            );
        }
    }
}

/// Verifies both routes near the bounds on |Δ| of the dilatant model of Harris & Grekova in a uniform state, and near
/// 90° minus these bounds.
#[test]
fn both_routes_agree_near_noncoaxiality_bounds_with_dilatancy() {
    for (sign, complement) in [(1.0, false), (-1.0, false), (1.0, true), (-1.0, true)] {
        check_route_agreement_near_boundary(
            registry::HARRIS_GREKOVA,
            true,
            false,
            |parameters, state, distance| {
                parameters.rotational_strength = Some(0.0);
                let model =
                    parameters.build_model(registry::HARRIS_GREKOVA).expect("within ranges");
                let bound = model.noncoaxiality_bound().expect("the model has one");
                let bound = if complement { 0.5 * PI - bound } else { bound };
                state.noncoaxiality = Some(sign * bound + distance);
            },
        );
    }
}

/// Verifies both routes near |Δ| = 45° ± ν/2, where one of the two zeros of the leading coefficient D coincides with a
/// zero of 𝒜 in the growth rate ς ≈ −k² q cos(φ − 2ν) 𝒜²/(2ρQ_D D), and ς does not pass through infinity there; the
/// other zero of D remains.
#[test]
fn both_routes_agree_at_coincident_zeros_of_leading_coefficient_and_growth_rate() {
    for distance in [0.0, 1e-12, -1e-9, 1e-9, -1e-6, 1e-3] {
        let states = (0..400usize).into_par_iter().map(|index| {
            let random = &mut create_random_numbers(0xc0 + index as u64);
            let kind = registry::HARRIS_GREKOVA;
            let (parameters, mut state) = states::generate_state(
                random,
                kind,
                ParameterRange::GranularMaterials,
                true,
                false,
            );
            let half = 0.5 * parameters.dilatancy_angle;
            let size = 0.25 * PI + if index % 2 == 0 { half } else { -half } + distance;
            state.noncoaxiality = Some(if index % 4 < 2 { size } else { -size });
            (kind, parameters, state)
        });
        let counts = check_route_agreement(states);
        let unbounded = counts.get(&("harris-grekova", "unbounded at finite k"));
        assert!(unbounded.is_some_and(|&count| count > 300), "{distance}: {counts:?}");
    }
}

/// Verifies both routes near the boundary ν = φ of the plastic potential: associated flow rule.
#[test]
fn both_routes_agree_near_associated_flow_rule() {
    for has_gradients in [false, true] {
        check_route_agreement_near_boundary(
            registry::PLASTIC_POTENTIAL,
            true,
            has_gradients,
            |parameters, _, distance| {
                parameters.dilatancy_angle = parameters.friction_angle + distance;
            },
        );
    }
}

/// Verifies both routes near the limits of the friction angle, φ → 0 and 90°, and of the dilatancy angle, ν → 0 and φ.
#[test]
fn both_routes_agree_near_parameter_limits() {
    for (index, kind) in registry::STANDARD_FLOWS.into_iter().enumerate() {
        for limit in 0..4 {
            for distance in [1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2] {
                let states = (0..64usize).into_par_iter().map(move |seed| {
                    let random =
                        &mut create_random_numbers((limit * 4 + index) as u64 * 1000 + seed as u64);
                    let has_gradients = seed % 2 == 0;
                    let (mut parameters, mut state) = states::generate_state(
                        random,
                        kind,
                        ParameterRange::GranularMaterials,
                        seed % 4 < 2,
                        has_gradients,
                    );
                    let FlowParameters { friction_angle: phi, dilatancy_angle: nu, .. } =
                        &mut parameters;
                    match limit {
                        0 => {
                            *nu *= distance / *phi;
                            *phi = distance;
                        }
                        1 => *phi = 0.5 * PI - distance,
                        2 => *nu = distance * *phi,
                        _ => *nu = *phi * (1.0 - distance),
                    }
                    if *nu == 0.0 {
                        state.density_gradient = [0.0; 2];
                    }
                    (kind, parameters, state)
                });
                check_route_agreement(states);
            }
        }
    }
}

/// Verifies that maps of a case with and without closed forms are equal at every point.
#[test]
fn maps_by_both_routes_are_equal() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/granular-flow");
    let folder = tempfile::tempdir().expect("a scratch folder");
    for (case, sets, by_formula) in [
        ("noncoaxiality-bound", ["map.x.points=61", "map.y.points=23"], 59 * 23),
        ("plastic-potential", ["map.x.points=61", "map.y.points=23"], 1000),
        ("dilatant-domain", ["map.x.points=61", "map.y.points=24"], 700),
    ] {
        let run = |is_model_blind: bool, threads: usize| -> Vec<files::npz::NpzArray> {
            let out = folder.path().join(format!("{case}-{is_model_blind}-{threads}"));
            let options = Options {
                case_path: cases.join(case).with_extension("toml"),
                settings: sets.map(str::to_owned).to_vec(),
                output_folder: Some(out.clone()),
                thread_count: Some(threads),
                ..Options::default()
            };
            let map_options = MapOptions { is_model_blind, ..MapOptions::default() };
            cli::run_map(&options, map_options, &mut std::io::sink()).expect("a map");
            files::npz::read_arrays(&fs::read(out.join("map.npz")).expect("an archive"))
                .expect("arrays")
        };
        let [mixed, blind] = [run(false, 1), run(true, 2)];
        run(false, 3);
        let [one, three] = [1, 3].map(|threads| {
            fs::read(folder.path().join(format!("{case}-false-{threads}/map.npz"))).expect("bytes")
        });
        assert!(one == three, "one thread and three");
        let codes = |arrays: &[files::npz::NpzArray], name: &str| match &arrays
            .iter()
            .find(|a| a.name == name)
            .expect(name)
            .values
        {
            files::npz::ArrayValues::I8(values) => values.clone(),
            other => panic!("{name}: {other:?}"),
        };
        let numbers = |arrays: &[files::npz::NpzArray], name: &str| match &arrays
            .iter()
            .find(|a| a.name == name)
            .expect(name)
            .values
        {
            files::npz::ArrayValues::F64(values) => values.clone(),
            other => panic!("{name}: {other:?}"),
        };
        let count =
            |arrays, route: i8| codes(arrays, "route").iter().filter(|&&r| r == route).count();
        assert!(count(&mixed, 1) >= by_formula, "{case}: {}", count(&mixed, 1));
        assert_eq!(count(&blind, 1), 0);
        assert_eq!(count(&mixed, 0), count(&blind, 0), "points without a verdict");
        assert_eq!(codes(&mixed, "verdict"), codes(&blind, "verdict"), "{case}");
        let is_close = |(a, b): (&f64, &f64)| {
            (a.is_nan() && b.is_nan()) || (a - b).abs() <= COEFFICIENT_TOLERANCE * a.abs()
        };
        for name in ["order", "coefficient"] {
            let (first, second) = (numbers(&mixed, name), numbers(&blind, name));
            assert!(first.iter().zip(&second).all(is_close), "{case}: {name}");
        }
        let json = fs::read_to_string(folder.path().join(format!("{case}-false-1/map.json")));
        let json: serde_json::Value =
            serde_json::from_str(&json.expect("a summary")).expect("JSON");
        assert_eq!(json["route"]["closed-form"], count(&mixed, 1));
        assert_eq!(json["route"]["model-blind"], count(&mixed, 2));
    }
}

/// Verifies that growth rates, which need the dispersion polynomial and exclude closed forms, are computed if
/// requested or implied by a sweep of the wave vector.
#[test]
fn growth_rates_are_computed_only_on_request() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let case =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/granular-flow/noncoaxiality-bound.toml");
    let small = ["map.x.points=5", "map.y.points=3"].map(str::to_owned);
    let wave = ["map.x.parameter=wave.number", "map.x.from=1", "map.x.to=2"].map(str::to_owned);
    for (name, sets, computes_growth_rate, has_column) in [
        ("plain", small.to_vec(), false, false),
        ("asked", small.to_vec(), true, true),
        ("swept", [small.to_vec(), wave.to_vec()].concat(), false, true),
    ] {
        let out = folder.path().join(name);
        let options = Options {
            case_path: case.clone(),
            settings: sets,
            output_folder: Some(out.clone()),
            ..Options::default()
        };
        let map_options = MapOptions { computes_growth_rate, ..MapOptions::default() };
        cli::run_map(&options, map_options, &mut std::io::sink()).expect("a map");
        let table = fs::read_to_string(out.join("map.csv")).expect("a table");
        assert_eq!(table.lines().next().expect("a header").contains("growth_rate"), has_column);
        assert_eq!(table.contains("closed-form"), !has_column, "{name}");
    }
}
