//! Tests of solids through the program, from case files to verdicts, speeds and waves, against closed forms.

use serde_json::Value;
use std::f64::consts::PI;
use std::path::Path;
use wellposed::cli::{self, Options, OutputFormat};
use wellposed::study::MapOptions;

type VerbFunction =
    fn(&Options, &mut dyn std::io::Write) -> Result<(), wellposed::cli::CommandError>;

const LAYERED_CASE: &str = "
[model]
kind = 'reduced-cosserat'
dimensions = 2
lambda = 1
mu = 1
alpha = 0.3
density = 1
inertia = 1
[yield]
kind = 'interlayer'
active = ['+sigma21']
shear_strength = 1
shear_friction = 0.6
shear_dilatancy = 0.05
";

const DRUCKER_PRAGER_CASE: &str = "
[model]
kind = 'classical'
dimensions = 3
lambda = 1.5
mu = 1
density = 2
[yield]
kind = 'drucker-prager'
strength = 1
friction = 0.6
dilatancy = 0.1
hardening = 0
[stress]
pressure = 0.4
deviatoric_stress = 1
stress_angle_deg = 25
out_of_plane_stress = 0.3
";

fn run_verb(
    folder: &Path,
    verb: VerbFunction,
    case: &str,
    sets: &[String],
) -> Result<Value, String> {
    let file = folder.join("solid.toml");
    std::fs::write(&file, case).expect("a scratch file");
    let options = Options {
        case_path: file,
        settings: sets.to_vec(),
        format: OutputFormat::Json,
        output_folder: Some(folder.join("out")),
        force: true,
        ..Options::default()
    };
    let mut stdout = Vec::new();
    verb(&options, &mut stdout).map_err(|error| error.to_string())?;
    Ok(serde_json::from_slice(&stdout).expect("JSON"))
}

fn as_number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn format_setting(key: &str, value: f64) -> String {
    format!("{key}={value:?}")
}

/// Returns trace and determinant of the acoustic tensor while the layer normal to x₁ slips (λ = μ = ρ = 1, α = 0.3),
/// derived by hand.
fn acoustic_tensor_invariants(friction: f64, dilatancy: f64, angle: f64) -> [f64; 2] {
    let (lambda, alpha) = (1.0, 0.3);
    // Elastic tensor D applied to the normal (κ, 0, 1, 0) over (σ11, σ22, σ21, σ12), with the friction or dilatancy κ.
    let image = |k: f64| [(lambda + 2.0) * k, lambda * k, 1.0 + alpha, 1.0 - alpha];
    let (flow, normal) = (image(dilatancy), image(friction));
    let response = friction * flow[0] + flow[2];
    let (s, c) = angle.sin_cos();
    let traction = |d: [f64; 4]| [d[0] * c + d[3] * s, d[2] * c + d[1] * s];
    let (a, b) = (traction(flow), traction(normal));
    let entry = |i: usize, j: usize| {
        let n = [c, s];
        (lambda + 1.0 - alpha) * n[i] * n[j] + f64::from(u8::from(i == j)) * (1.0 + alpha)
            - a[i] * b[j] / response
    };
    [entry(0, 0) + entry(1, 1), entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0)]
}

/// Returns the maximum of |Im c| over all directions, with the complex wave speed c.
fn max_flutter_growth(friction: f64, dilatancy: f64) -> f64 {
    let rate = |angle: f64| {
        let [trace, determinant] = acoustic_tensor_invariants(friction, dilatancy, angle);
        let square = determinant - 0.25 * trace * trace;
        // With trace t and determinant of the acoustic tensor: c² = t/2 ± i√square, hence 2 (Im c)² = |c²| − Re c².
        if square > 0.0 { (0.5 * (determinant.sqrt() - 0.5 * trace)).sqrt() } else { 0.0 }
    };
    (0..200_000).map(|i| rate(PI * f64::from(i) / 200_000.0)).fold(0.0, f64::max)
}

#[test]
fn flutter_growth_of_layers_agrees_with_discriminant() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let (mut ill, mut well) = (0, 0);
    for friction in [0.1, 0.6, 1.1] {
        for dilatancy in [-0.2, 0.05, 0.25, 0.6, 1.0] {
            let sets = [
                format_setting("yield.shear_friction", friction),
                format_setting("yield.shear_dilatancy", dilatancy),
            ];
            let report =
                run_verb(folder.path(), cli::run_point, LAYERED_CASE, &sets).expect("a sound case");
            let expected = max_flutter_growth(friction, dilatancy);
            if expected > 0.0 {
                ill += 1;
                assert_eq!(report["verdict"], "ill-posed", "{friction} {dilatancy}");
                assert_eq!(report["hyperbolicity"], "flutter");
                assert_eq!(as_number(&report["order"]), 1.0);
                let found = as_number(&report["coefficient"]);
                assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
                assert!((as_number(&report["flutter"]["growth"]) / found - 1.0).abs() < 1e-9);
            } else {
                well += 1;
                assert_eq!(report["verdict"], "well-posed", "{friction} {dilatancy}");
                assert_eq!(report["hyperbolicity"], "hyperbolic");
            }
            // The speed of slip along the layer is zero in all cases.
            assert!(as_number(&report["slowest"]["squared_speed"]).abs() < 1e-12);
            assert_eq!(as_number(&report["slowest"]["normal"]["direction_deg"]), 0.0);
        }
    }
    assert!(ill >= 4 && well >= 4, "{ill} {well}");
}

#[test]
fn layer_sectors_and_speeds_satisfy_characteristic_equation() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let report = run_verb(folder.path(), cli::run_speeds, LAYERED_CASE, &[]).expect("a sound case");
    let sectors = report["flutter_sectors_deg"].as_array().expect("a list");
    assert_eq!(sectors.len(), 1);
    for (edge, inwards) in [(0, 1e-6), (1, -1e-6)] {
        let edge = as_number(&sectors[0][edge]).to_radians();
        let discriminant = |angle: f64| {
            let [trace, determinant] = acoustic_tensor_invariants(0.6, 0.05, angle);
            trace * trace - 4.0 * determinant
        };
        assert!(discriminant(edge + inwards) < 0.0 && discriminant(edge - inwards) > 0.0);
    }
    assert_eq!(report["vanishing"][0]["what"], "slip along the layer");
    assert_eq!(report["vanishing"].as_array().expect("a list").len(), 1);
    // Every speed in the table satisfies the characteristic equation.
    let table = std::fs::read_to_string(folder.path().join("out/speeds.csv")).expect("a table");
    let mut rows = 0;
    for line in table.lines().skip(1).filter(|line| line.contains("yielding")) {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |i: usize| cells[i].parse::<f64>().expect("a number");
        let [trace, determinant] = acoustic_tensor_invariants(0.6, 0.05, cell(0).to_radians());
        let (re, im) = (cell(3), cell(4));
        let residual = [re * re - im * im - trace * re + determinant, 2.0 * re * im - trace * im];
        assert!(residual.iter().all(|r| r.abs() < 1e-12), "{line}: {residual:?}");
        rows += 1;
    }
    assert_eq!(rows, 2 * 721);
}

/// Returns the critical plastic modulus h over the shear modulus, of Rudnicki & Rice (1975, eq. 20), with their N, μ,
/// β, for normals in the plane of the major and minor principal stress.
fn critical_plastic_modulus(ratio: f64, friction: f64, dilatancy: f64, lambda: f64) -> f64 {
    // `ratio` is their N = s₂/τ̄, the intermediate principal deviator over τ̄; their μ and β are derivatives with
    // respect to −σ_m, here the friction κ and the dilatancy κ̂.
    let nu = lambda / (2.0 * (lambda + 1.0));
    let (mu, beta) = (friction, dilatancy);
    (1.0 + nu) / (9.0 * (1.0 - nu)) * (beta - mu).powi(2)
        - 0.5 * (1.0 + nu) * (ratio + (beta + mu) / 3.0).powi(2)
}

#[test]
fn shear_bands_start_at_critical_modulus_of_rudnicki_and_rice() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    for (out_of_plane, friction, dilatancy) in [(0.3, 0.6, 0.1), (-0.4, 0.5, 0.2)] {
        // Principal deviators of diag(1, −1, x): ±1 − x/3 and 2x/3.
        let middle = 2.0 * out_of_plane / 3.0;
        let square = |x: f64| x * x;
        let shear = (0.5
            * (square(1.0 - out_of_plane / 3.0)
                + square(1.0 + out_of_plane / 3.0)
                + square(middle)))
        .sqrt();
        // f = τ̄ + κσ_m: Rudnicki & Rice also define the mean stress with the factor ⅓.
        let critical = critical_plastic_modulus(middle / shear, friction, dilatancy, 1.5);
        for (offset, is_banded) in [(-1e-6, true), (1e-6, false)] {
            let sets = [
                format_setting("stress.out_of_plane_stress", out_of_plane),
                format_setting("yield.friction", friction),
                format_setting("yield.dilatancy", dilatancy),
                format_setting("yield.hardening", critical + offset),
            ];
            let report = run_verb(folder.path(), cli::run_speeds, DRUCKER_PRAGER_CASE, &sets)
                .expect("a sound case");
            let squared = as_number(&report["slowest"]["squared_speed"]);
            assert_eq!(squared < 0.0, is_banded, "{out_of_plane}: {critical} {squared:e}");
            let verdict = if is_banded { "ill-posed" } else { "well-posed" };
            assert_eq!(report["verdict"], verdict, "{out_of_plane} {friction} {dilatancy}");
            // The normal is in the plane of the major and minor principal stresses.
            assert!(as_number(&report["slowest"]["normal"]["elevation_deg"]).abs() < 1e-2);
        }
    }
}

#[test]
fn stress_is_scaled_to_yield_surface() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let report =
        run_verb(folder.path(), cli::run_point, DRUCKER_PRAGER_CASE, &[]).expect("a sound case");
    let s = |i: usize, j: usize| as_number(&report["stress"]["force"][i][j]);
    let mean = (s(0, 0) + s(1, 1) + s(2, 2)) / 3.0;
    let mut square = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            let deviator = s(i, j) - if i == j { mean } else { 0.0 };
            square += 0.5 * deviator * deviator;
        }
    }
    assert!((square.sqrt() + 0.6 * mean - 1.0).abs() < 1e-14);
    assert!((-0.5 * (s(0, 0) + s(1, 1)) - 0.4).abs() < 1e-14, "the pressure stays");
    let angle = 0.5 * (s(0, 1) + s(1, 0)).atan2(s(0, 0) - s(1, 1)).to_degrees();
    assert!((angle - 25.0).abs() < 1e-12);

    // Layers: with the rotational stress r and the deviatoric stress q, σ21 = r + q sin 2ψ is the first to reach
    // τ₀ − κσ11.
    let layers = LAYERED_CASE.replace("active = ['+sigma21']\n", "")
        + "[stress]\npressure = 2\ndeviatoric_stress = 0.4\nstress_angle_deg = 10\nrotational_stress = 1\n";
    let report = run_verb(folder.path(), cli::run_point, &layers, &[]).expect("a sound case");
    assert_eq!(report["active"][0], "shear of the layer normal to x1, σ21 > 0");
    assert_eq!(report["active"].as_array().expect("a list").len(), 1);
    let s = |i: usize, j: usize| as_number(&report["stress"]["force"][i][j]);
    assert!((s(1, 0) - (1.0 - 0.6 * s(0, 0))).abs() < 1e-14);
    assert!(s(0, 1).abs() < 1.0 - 0.6 * s(1, 1));
    // The tangent depends on the active conditions only.
    let named = run_verb(folder.path(), cli::run_point, LAYERED_CASE, &[]).expect("a sound case");
    assert_eq!(named["coefficient"], report["coefficient"]);
}

#[test]
fn energy_conserving_solid_is_well_posed() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let associated = [format_setting("yield.shear_dilatancy", 0.6)];
    let cone = [format_setting("yield.dilatancy", 0.6)];
    for (case, sets) in [(LAYERED_CASE, &associated), (DRUCKER_PRAGER_CASE, &cone)] {
        let report = run_verb(folder.path(), cli::run_point, case, sets).expect("a sound case");
        assert_eq!(report["verdict"], "well-posed");
        assert_eq!(report["associated"], true);
        let energy = |key: &str| as_number(&report["energy"][key]);
        assert!(energy("definiteness") > 0.01);
        for (key, rounding) in
            [("asymmetry", 1e-14), ("antisymmetry", 1e-14), ("elastic_growth", 1e-12)]
        {
            assert!(energy(key) < rounding, "{key} {}", energy(key));
        }
        // During yielding some zero roots are almost defective.
        assert!(energy("growth") < 1e-7, "{}", energy("growth"));
    }
    // Softening along the normal is associated but does not conserve energy.
    let sets = [format_setting("yield.dilatancy", 0.6), format_setting("yield.hardening", -0.8)];
    let report =
        run_verb(folder.path(), cli::run_point, DRUCKER_PRAGER_CASE, &sets).expect("a sound case");
    assert_eq!(report["verdict"], "ill-posed");
    assert_eq!(report["hyperbolicity"], "shear-band");
}

#[test]
fn growth_rate_of_fluttering_solid_agrees_with_closed_form() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let sets = [format_setting("wave.direction_deg", 44.0), format_setting("wave.number", 1e6)];
    let report =
        run_verb(folder.path(), cli::run_dispersion, LAYERED_CASE, &sets).expect("a sound case");
    let [trace, determinant] = acoustic_tensor_invariants(0.6, 0.05, 44f64.to_radians());
    let expected = (0.5 * (determinant.sqrt() - 0.5 * trace)).sqrt();
    let families = report["families"].as_array().expect("a list");
    let rates = families.iter().flat_map(|f| f["at_wave"].as_array().expect("a list"));
    let max_growth_rate = rates.map(|at| as_number(&at["growth_rate"])).fold(0.0, f64::max);
    assert!((max_growth_rate / (1e6 * expected) - 1.0).abs() < 1e-6, "{max_growth_rate}");
}

const MAP_SECTION: &str = "
[map]
x = { parameter = 'yield.shear_dilatancy', from = -0.4, to = 1.2, points = 9 }
y = { parameter = 'yield.shear_friction', from = 0.05, to = 1.25, points = 7 }
";

#[test]
fn map_verdicts_agree_with_closed_form() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let verb: VerbFunction = |options, stdout| cli::run_map(options, MapOptions::default(), stdout);
    let report = run_verb(folder.path(), verb, &(LAYERED_CASE.to_owned() + MAP_SECTION), &[])
        .expect("a sound case");
    let table = std::fs::read_to_string(folder.path().join("out/map.csv")).expect("a table");
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).expect("a column");
    let (verdict, coefficient) = (column("verdict"), column("coefficient"));
    let mut counts = [0; 3];
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let at = |i: usize| cells[i].parse::<f64>().expect("a number");
        let (dilatancy, friction) = (at(0), at(1));
        let expected = max_flutter_growth(friction, dilatancy);
        match cells[verdict] {
            "well-posed" => {
                counts[0] += 1;
                assert_eq!(expected, 0.0, "{line}");
            }
            "ill-posed" if cells[column("hyperbolicity")] == "flutter" => {
                counts[1] += 1;
                assert!((at(coefficient) / expected - 1.0).abs() < 1e-5, "{line} {expected}");
            }
            _ => counts[2] += 1,
        }
    }
    assert_eq!(counts.iter().sum::<i32>(), 63);
    assert!(counts[0] > 20 && counts[1] > 10 && counts[2] < 5, "{counts:?}");
    assert_eq!(as_number(&report["points"]["well-posed"]), f64::from(counts[0]));
}

#[test]
fn spatial_map_is_bit_identical_for_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    // The modulus λ varies along x, so that the directions of each elastic solid are recomputed for every column.
    let case = DRUCKER_PRAGER_CASE.to_owned()
        + "[map]\nx = { parameter = 'model.lambda', from = 1, to = 2, points = 3 }\n\
           y = { parameter = 'yield.hardening', from = -0.3, to = 0.3, points = 30 }\n";
    let file = folder.path().join("solid.toml");
    std::fs::write(&file, case).expect("a scratch file");
    let maps = [1, 2, 3].map(|threads| {
        let out = folder.path().join(format!("out{threads}"));
        let options = Options {
            case_path: file.clone(),
            output_folder: Some(out.clone()),
            thread_count: Some(threads),
            ..Options::default()
        };
        cli::run_map(&options, MapOptions::default(), &mut Vec::new()).expect("a sound case");
        std::fs::read(out.join("map.csv")).expect("a table")
    });
    assert!(maps[0] == maps[1] && maps[1] == maps[2]);
    let text = String::from_utf8(maps[0].clone()).expect("text");
    assert!(text.contains("shear-band") && text.contains(",hyperbolic,"));
}

#[test]
fn invalid_solids_are_refused_with_location_and_remedy() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let refused = |case: &str, words: &[&str]| {
        let error = run_verb(folder.path(), cli::run_point, case, &[]).expect_err("a wrong case");
        for word in words {
            assert!(error.contains(word), "{error}\nsays nothing of '{word}'");
        }
    };
    let change = |from: &str, to: &str| {
        assert!(LAYERED_CASE.contains(from), "{from}");
        LAYERED_CASE.replace(from, to)
    };
    refused(&change("dimensions = 2", "dimensions = 3"), &["solid.toml:4: model.dimensions", "2"]);
    refused(&change("dimensions = 2", "dimensions = 4"), &["found 4", "2 (plane strain) or 3"]);
    refused(
        &change("'interlayer'", "'interlayers'"),
        &[":11: yield.kind", "did you mean 'interlayer'"],
    );
    refused(&change("'+sigma21'", "'+sigma31'"), &["yield.active", "'+sigma31'", "+sigma21"]);
    refused(&change("'+sigma21'", "'+m31'"), &["yield.active", "+sigma21, -sigma21"]);
    refused(&change("'+sigma21'", "'+sigma21', '-sigma21'"), &["name each stress once"]);
    refused(&change("['+sigma21']", "[]"), &["an empty list"]);
    refused(&change("shear_dilatancy = 0.05", ""), &["yield.shear_dilatancy", "missing"]);
    refused(
        &change("shear_dilatancy = 0.05", "dilatancy = 0.05"),
        &["yield.dilatancy", "not used by the yield set interlayer", "drucker-prager"],
    );
    refused(
        &change("shear_friction = 0.6", "shear_friction = -1"),
        &["yield.shear_friction", "κ_τ ≥ 0"],
    );
    refused(
        &change("shear_dilatancy = 0.05", "shear_dilatancy = -5"),
        &["no response while yielding"],
    );
    refused(&(LAYERED_CASE.to_owned() + "[stress]\npressure = 1\n"), &["not both"]);
    let cone = |from: &str, to: &str| DRUCKER_PRAGER_CASE.replace(from, to);
    refused(&cone("pressure = 0.4", "pressure = -2"), &["stress.pressure", "within the yield set"]);
    refused(
        &cone("deviatoric_stress = 1", "deviatoric_stress = 0").replace("= 0.3", "= 0"),
        &["never yield"],
    );
    refused(&cone("'drucker-prager'", "'cosserat-mises'"), &["allowed for classical"]);
    let elastic = &DRUCKER_PRAGER_CASE[..DRUCKER_PRAGER_CASE.find("[yield]").expect("a section")];
    refused(
        &format!(
            "{elastic}[stress]
pressure = 1
"
        ),
        &["stress: found without a yield set"],
    );
    let flow = wellposed::cli::new::generate_state_template(
        wellposed::case::ModelKind::from_name("double-shearing").expect("a kind"),
    );
    refused(&(flow + "\n[yield]\nkind = 'von-mises'\n"), &["yield", "built-in yield condition"]);
}

#[test]
fn plastic_rate_damps_waves_without_changing_speeds() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let roots = |sets: &[String]| {
        let report = run_verb(folder.path(), cli::run_point, DRUCKER_PRAGER_CASE, sets)
            .expect("a sound case");
        let list = report["roots"].as_array().expect("a list").clone();
        let roots: Vec<[f64; 2]> =
            list.iter().map(|root| [as_number(&root[0]), as_number(&root[1])]).collect();
        (roots, report)
    };
    let associated = format_setting("yield.dilatancy", 0.6);
    let wave = [format_setting("wave.number", 1000.0), format_setting("wave.direction_deg", 20.0)];
    let with = |rate: f64| {
        let mut sets = vec![associated.clone(), format_setting("yield.plastic_rate", rate)];
        sets.extend(wave.clone());
        roots(&sets)
    };
    let ((free, still), (damped, flowing)) = (with(0.0), with(5.0));
    assert_eq!(still["squared_speeds"], flowing["squared_speeds"]);
    assert!(damped.iter().all(|root| root[0] < 1e-9), "{damped:?}");
    assert!(damped.iter().any(|root| root[0] < -0.1), "{damped:?}");
    // The frequencies of short waves do not change: damping is of lower order.
    for root in &free {
        let near = damped.iter().map(|d| (d[1] - root[1]).abs()).fold(f64::INFINITY, f64::min);
        assert!(near < 1e-4 * root[1].abs().max(1.0), "{root:?} {damped:?}");
    }
    let error = run_verb(
        folder.path(),
        cli::run_dispersion,
        DRUCKER_PRAGER_CASE,
        &[format_setting("yield.plastic_rate", 1.0)],
    );
    assert!(error.expect_err("damped").contains("yield.plastic_rate"));
}

#[test]
fn growth_rate_of_softening_solid_agrees_with_imaginary_speed() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let sets = [format_setting("yield.dilatancy", 0.6), format_setting("yield.hardening", -0.8)];
    let report =
        run_verb(folder.path(), cli::run_speeds, DRUCKER_PRAGER_CASE, &sets).expect("a sound case");
    let slowest = &report["slowest"];
    let squared = as_number(&slowest["squared_speed"]);
    assert!(squared < 0.0);
    let at = |key: &str| as_number(&slowest["normal"][key]);
    let wave = [
        format_setting("wave.direction_deg", at("direction_deg")),
        format_setting("wave.elevation_deg", at("elevation_deg")),
        format_setting("wave.number", 3.0),
    ];
    let sets: Vec<String> = sets.into_iter().chain(wave).collect();
    let report = run_verb(folder.path(), cli::run_dispersion, DRUCKER_PRAGER_CASE, &sets)
        .expect("a sound case");
    let families = report["families"].as_array().expect("a list");
    let rates = families.iter().flat_map(|f| f["at_wave"].as_array().expect("a list"));
    let max_growth_rate = rates.map(|at| as_number(&at["growth_rate"])).fold(0.0, f64::max);
    assert!(
        (max_growth_rate / (3.0 * (-squared).sqrt()) - 1.0).abs() < 1e-6,
        "{max_growth_rate} {squared}"
    );
}

/// Verifies with three active conditions that imaginary speeds in other directions decide the verdict where the
/// polynomial is indeterminate along a layer.
#[test]
fn indeterminate_directions_do_not_hide_growth() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let case = "
[model]
kind = 'cosserat'
dimensions = 2
lambda = 0.4091020509110211
mu = 1.845658514760656
alpha = 0.07518753459830219
beta = 0.5
gamma = 1.4450918961553236
eta = 2.60532400308898
density = 1
inertia = 1.9801710654633173
[yield]
kind = 'interlayer'
active = ['+m31', '+sigma21', '-m32']
shear_strength = 1
shear_friction = 1
shear_dilatancy = -0.2
couple_strength = 1
couple_friction = 0.9624238222822759
couple_dilatancy = 0.1680159567011167
[wave]
number = 1e6
";
    let report = run_verb(folder.path(), cli::run_point, case, &[]).expect("a sound case");
    assert_eq!(report["verdict"], "ill-posed");
    assert_eq!(as_number(&report["order"]), 1.0);
    // In the reported direction the largest root at the wave number k = 10⁶ is the coefficient times k.
    let coefficient = as_number(&report["coefficient"]);
    let along = [format_setting("wave.direction_deg", as_number(&report["direction_deg"]))];
    let report = run_verb(folder.path(), cli::run_point, case, &along).expect("a sound case");
    let max_growth_rate = as_number(&report["roots"][0][0]);
    assert!(
        (max_growth_rate / (1e6 * coefficient) - 1.0).abs() < 1e-4,
        "{max_growth_rate} {coefficient}"
    );
}

#[test]
fn speed_vanishing_in_all_directions_is_reported_once() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    // In a classical solid σ12 = σ21: with both conditions active there is no shear wave.
    let case = LAYERED_CASE
        .replace("reduced-cosserat", "classical")
        .replace("alpha = 0.3\n", "")
        .replace("inertia = 1\n", "")
        .replace("'+sigma21'", "'+sigma21', '+sigma12'");
    let sets = [format_setting("yield.shear_dilatancy", 0.6)];
    let report = run_verb(folder.path(), cli::run_speeds, &case, &sets).expect("a sound case");
    assert_eq!(report["always_still"], true);
    assert_eq!(report["vanishing"].as_array().expect("a list").len(), 0);
}

#[test]
fn sectors_of_imaginary_speeds_end_where_a_speed_vanishes() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let sets = [
        format_setting("stress.stress_angle_deg", 0.0),
        format_setting("stress.out_of_plane_stress", 0.0),
    ];
    let report =
        run_verb(folder.path(), cli::run_speeds, DRUCKER_PRAGER_CASE, &sets).expect("a sound case");
    let sectors = report["imaginary_sectors_deg"].as_array().expect("a list");
    assert_eq!(sectors.len(), 2);
    for edge in sectors.iter().flat_map(|s| [as_number(&s[0]), as_number(&s[1])]) {
        let at = |direction: f64| {
            let wave = [format_setting("wave.direction_deg", direction)];
            let sets: Vec<String> = sets.iter().cloned().chain(wave).collect();
            let report = run_verb(folder.path(), cli::run_point, DRUCKER_PRAGER_CASE, &sets)
                .expect("a sound case");
            let speeds = report["squared_speeds"].as_array().expect("a list").clone();
            speeds.iter().map(|c| as_number(&c[0])).fold(f64::INFINITY, f64::min)
        };
        let (before, after) = (at(edge - 1e-6), at(edge + 1e-6));
        assert!(before * after < 0.0 && before.abs() < 1e-6, "{edge}: {before:e} {after:e}");
    }
}
