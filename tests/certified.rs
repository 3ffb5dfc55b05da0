//! Certified maps: proved verdicts against verdicts at points by other methods.

use wellposed::case::{Case, ParameterSweep};
use wellposed::study::map::{CELL_PARTS, MapResult, PointStatus};
use wellposed::study::{MapOptions, ignore_progress};

/// Cells along both axes, and points by which they are compared.
const CELLS: [usize; 2] = [24, 18];
const POINTS: [usize; 2] = [83, 61];

fn load(name: &str, counts: [usize; 2], settings: &[&str]) -> Case {
    let counts =
        ["map.x", "map.y"].iter().zip(counts).map(|(axis, n)| format!("{axis}.points={n}"));
    let settings: Vec<String> =
        counts.chain(settings.iter().map(|own| (*own).to_owned())).collect();
    Case::load(format!("cases/{name}.toml").as_ref(), &settings).expect("a bundled case")
}

fn compute(case: &Case, options: MapOptions) -> MapResult {
    wellposed::compute_map(case, options, &ignore_progress).expect("a map")
}

/// Verifies that no point of a map by the linearised equations (flows) or by other methods (solids) contradicts what is
/// proved of the parts of cells in which it lies, and that parts of at least `least_share` of the area are decided.
fn check(name: &str, settings: &[&str], least_share: f64) {
    let certified = MapOptions { is_certified: true, ..MapOptions::default() };
    let case = load(name, CELLS.map(|n| n + 1), settings);
    let proved = compute(&case, certified);
    let proved = proved.certified.expect("a certified map");
    let blind = MapOptions { is_model_blind: true, ..MapOptions::default() };
    let points = compute(&load(name, POINTS, settings), blind).points;
    let width = CELLS[0] * CELL_PARTS;
    // The parts that contain a point, which may lie on their common edge.
    let parts_at = |axis: usize, index: usize| {
        let count = CELLS[axis] * CELL_PARTS;
        let (place, steps) = (index * count, POINTS[axis] - 1);
        let first = (place / steps).min(count - 1);
        let is_on_edge = place % steps == 0 && first > 0 && place / steps < count;
        first - usize::from(is_on_edge)..first + 1
    };
    let mut compared = 0;
    for (index, point) in points.iter().enumerate() {
        for row in parts_at(1, index / POINTS[0]) {
            for column in parts_at(0, index % POINTS[0]) {
                let code = proved.parts[row * width + column];
                let is_same = match code {
                    0 => matches!(point.status, PointStatus::WellPosed | PointStatus::Marginal),
                    1 => matches!(point.status, PointStatus::IllPosed | PointStatus::Marginal),
                    _ => true,
                };
                assert!(is_same, "{name}, point {index}: verdict {code}, {point:?}");
                compared += usize::from(code < 2);
            }
        }
    }
    let shares = proved.area_shares;
    println!("{name}: {shares:?}, {:?}, {compared} comparisons", proved.cell_counts);
    assert!(shares[0].1 + shares[1].1 > least_share, "{name}: {shares:?}");
    assert!(compared > 4000, "{compared}");
    // The undecided boxes have the area of the undecided parts.
    let map = case.require_map().expect("a map");
    let size = |sweep: &ParameterSweep| sweep.last_value - sweep.first_value;
    let all = size(&map.x) * size(&map.y);
    let boxes =
        proved.undecided.iter().map(|[left, right, low, high]| (right - left) * (high - low));
    assert!((boxes.sum::<f64>() / all - shares[2].1).abs() < 1e-12);
}

/// Flows, with the boundaries Δ = ±45° and φ = ν and the edge ν = 0 inside cells and on their edges; also with gradients
/// and accelerations, which the proof without dilatancy admits.
#[test]
fn proved_flows_agree_with_the_linearised_equations() {
    check("granular-flow/noncoaxiality-bound", &[], 0.95);
    check("granular-flow/noncoaxiality-bound", &["map.x.from=-80", "map.x.to=71"], 0.95);
    let gradients = ["background.pressure_gradient=[500,300]", "background.spin_gradient=[20,10]"];
    check("granular-flow/noncoaxiality-bound", &gradients, 0.95);
    // The edge Q_D = 0, on which nothing deforms.
    let rate = ["map.y.parameter=background.shear_rate", "map.y.from=0", "map.y.to=2"];
    check("granular-flow/noncoaxiality-bound", &rate, 0.9);
    check("granular-flow/dilatant-domain", &[], 0.97);
    check(
        "granular-flow/dilatant-domain",
        &[
            "map.y.parameter=model.friction_angle_deg",
            "map.y.from=12",
            "map.y.to=50",
            "model.dilatancy_angle_deg=10",
        ],
        0.97,
    );
    check("granular-flow/plastic-potential", &["map.y.from=7"], 0.97);
    let double_shearing = [
        "model.dilatancy_angle_deg=5",
        "map={ x = { parameter = 'background.noncoaxiality_deg', from = -40, to = 40 }, y = { parameter = 'model.friction_angle_deg', from = 6, to = 50 } }",
    ];
    check("flow/double-shearing", &double_shearing, 0.999);
}

#[test]
fn proved_solids_agree_with_the_acoustic_tensor() {
    check("cosserat/flutter", &[], 0.9);
    check(
        "cosserat/flutter",
        &["map.y.parameter=model.alpha", "map.y.from=0.05", "map.y.to=0.9"],
        0.9,
    );
    check("cosserat/shear-band", &[], 0.97);
}

/// States under tension, with cohesion, and states between corners without any: neither is proved to be absent.
#[test]
fn parts_with_states_are_not_called_without_state() {
    let cohesive =
        ["model.cohesion=1000", "background.pressure=-300", "map.y.from=5", "map.y.to=20"];
    check("granular-flow/noncoaxiality-bound", &cohesive, 0.9);
    let case = load(
        "granular-flow/dilatant-domain",
        [5, 11],
        &[
            "map.x={ parameter = 'model.dilatancy_angle_deg', from = -5, to = 35 }",
            "map.y={ parameter = 'model.friction_angle_deg', from = 1, to = 41 }",
        ],
    );
    let options = MapOptions { is_certified: true, ..MapOptions::default() };
    let parts = compute(&case, options).certified.expect("a certified map").parts;
    // φ = 4°, ν = 2° in the first cell, whose corners have no state.
    let (row, column) = (6, 5);
    assert!(parts[row * 4 * CELL_PARTS + column] < 3, "{:?}", &parts[..64]);
}

/// What is proved is a matter of the case alone.
#[test]
fn certified_maps_do_not_depend_on_threads() {
    let case = load("cosserat/flutter", [13, 11], &[]);
    let options = MapOptions { is_certified: true, ..MapOptions::default() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| compute(&case, options).certified.expect("a certified map"))
    };
    let (one, three) = (on(1), on(3));
    assert!(one.parts == three.parts && one.undecided == three.undecided);
}

#[test]
fn numbers_without_proof_are_refused() {
    let options = MapOptions { is_certified: true, ..MapOptions::default() };
    let refuse = |name: &str, settings: &[&str]| {
        let case = load(name, [5, 4], settings);
        let error = wellposed::compute_map(&case, options, &ignore_progress);
        error.expect_err("nothing is proved").to_string()
    };
    let text = refuse("granular-flow/noncoaxiality-bound", &["map.x.parameter=background.spin"]);
    assert!(text.contains("map.x") && text.contains("background.noncoaxiality_deg"), "{text}");
    let text = refuse("cosserat/rotation-waves", &[]);
    assert!(text.contains("model.kind") && text.contains("drucker-prager"), "{text}");
    // The deviatoric stress on yield is the same for φ = 40° and 50°, but not between them.
    let settings = ["model.cohesion=1000", "background.deviatoric_stress=1408.8320528055174"];
    let text = refuse("granular-flow/noncoaxiality-bound", &settings);
    assert!(text.contains("background.deviatoric_stress"), "{text}");
    let settings = ["model.dilatancy_angle_deg=4", "background.spin_gradient=[1,0]"];
    let text = refuse("granular-flow/noncoaxiality-bound", &settings);
    assert!(text.contains("uniform background"), "{text}");
    let text = refuse("equations/mu-of-i", &[]);
    assert!(text.contains("model.kind") && text.contains("a flow or a solid"), "{text}");
    let text = refuse("granular-flow/noncoaxiality-bound", &["map.y.points=1"]);
    assert!(text.contains("map.y") && text.contains("two or more points"), "{text}");
}
