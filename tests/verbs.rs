//! Tests of `map` and `point`, from the case file to the results.

use serde_json::Value;
use std::fs;
use std::path::Path;
use wellposed::cli::{self, Options, OutputFormat};
use wellposed::study::MapOptions;

const STATE_CASE: &str = include_str!("data/state.toml");

fn create_options(folder: &Path, text: &str, sets: &[&str]) -> Options {
    let case_path = folder.join("state.toml");
    fs::write(&case_path, text).unwrap();
    Options {
        case_path,
        settings: sets.iter().map(|s| (*s).to_owned()).collect(),
        format: OutputFormat::Json,
        output_folder: Some(folder.join("out")),
        force: true,
        ..Options::default()
    }
}

fn run_point(text: &str, sets: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let mut printed = Vec::new();
    cli::run_point(&create_options(folder.path(), text, sets), &mut printed).unwrap();
    let written = fs::read(folder.path().join("out/point.json")).unwrap();
    assert_eq!(printed, written, "what is printed is what is written");
    serde_json::from_slice(&printed).unwrap()
}

#[test]
fn point_inside_noncoaxiality_bound_is_well_posed() {
    let found = run_point(STATE_CASE, &[]);
    assert_eq!(found["model"], "harris-grekova");
    assert_eq!(found["verdict"], "well-posed");
    for key in ["order", "coefficient", "direction_deg"] {
        assert!(found[key].is_null(), "{key} is null unless ill-posed");
    }
    assert_eq!(found["noncoaxiality_bound_deg"], 45.0);
    assert_eq!(found["region"], "fully-deforming");
    // Power 2 Q_D cos 2Δ q of the stress, W/m³, with the shear rate Q_D, the non-coaxiality Δ and q = p sin φ.
    let power = 2.0 * 2.0 * 40f64.to_radians().cos() * 500.0;
    assert!((found["power"].as_f64().unwrap() - power).abs() < 1e-9 * power);
    // Two finite roots; one is the convected spin with ς = −ik·V exactly, with the wave vector k and the velocity V.
    let roots = found["roots"].as_array().unwrap();
    assert_eq!(roots.len(), 2);
    assert_eq!(found["infinite_roots"], 3);
    let (sin, cos) = 33f64.to_radians().sin_cos();
    let convection = -500.0 * (0.4 * cos - 0.1 * sin);
    assert!(roots.iter().any(|r| r[0].as_f64() == Some(0.0)));
    for root in roots {
        assert!((root[1].as_f64().unwrap() - convection).abs() < 1e-9);
    }
    // Characteristics: double ones at ψ_σ ± (45° + φ/2), with the stress angle ψ_σ and the friction angle φ, and a
    // single one, the streamline (for the dilatancy angle ν = 0 the density contributes none).
    let mut wanted = vec![
        (17.0 + 60.0, 2, "stress and velocity"),
        (17.0 - 60.0 + 180.0, 2, "stress and velocity"),
        ((-0.1f64).atan2(0.4).to_degrees() + 180.0, 1, "streamline"),
    ];
    wanted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let characteristics = found["characteristics"].as_array().unwrap();
    assert_eq!(characteristics.len(), 3);
    for (c, (angle, multiplicity, family)) in characteristics.iter().zip(wanted) {
        assert!((c["angle_deg"].as_f64().unwrap() - angle).abs() < 1e-12);
        assert_eq!(c["multiplicity"], multiplicity);
        assert_eq!(c["family"], family);
    }
    assert!(found["bound"].as_f64().is_some_and(|b| b.is_finite() && b > 0.0));
}

#[test]
fn growth_outside_noncoaxiality_bound_agrees_with_closed_form() {
    let found = run_point(STATE_CASE, &["background.noncoaxiality_deg=60"]);
    assert_eq!(found["verdict"], "ill-posed");
    assert_eq!(found["order"], 2.0);
    // Coefficient in the least stable direction, β = π: q (1 + sin φ)² / [2 ρ Q_D |cos 2Δ| (1 + sin φ)].
    let worst = 500.0 * 1.5 / (2.0 * 1600.0 * 2.0 * 0.5);
    assert!((found["coefficient"].as_f64().unwrap() - worst).abs() < 1e-12 * worst);
    assert!((found["direction_deg"].as_f64().unwrap() - 107.0).abs() < 1e-5);
    assert!(found["bound"].is_null() && found["bound_at"].is_null());
    assert!(found["power"].as_f64().unwrap() < 0.0, "dissipation is negative beyond 45°");
}

#[test]
fn verdict_is_marginal_only_at_noncoaxiality_bound() {
    for (delta, verdict) in [
        ("45", "marginal"),
        ("45.000000001", "ill-posed"),
        ("44.999999999", "well-posed"),
        ("-45", "marginal"),
    ] {
        let found = run_point(STATE_CASE, &[&format!("background.noncoaxiality_deg={delta}")]);
        assert_eq!(found["verdict"], verdict, "Δ = {delta}°");
    }
}

#[test]
fn states_outside_fully_deforming_region_are_not_analysed() {
    for (set, region) in [
        ("background.deviatoric_stress=499", "rigid-or-indeterminate"),
        ("background.deviatoric_stress=501", "outside-yield"),
        ("background.rotational_stress=1", "outside-yield"),
    ] {
        let found = run_point(STATE_CASE, &[set]);
        assert_eq!(found["region"], region, "{set}");
        for key in ["verdict", "order", "bound", "power", "roots", "characteristics"] {
            assert!(found[key].is_null(), "{set}: {key}");
        }
    }
}

#[test]
fn spin_determines_noncoaxiality() {
    // sin 2Δ = −(Ω − s₂₁) sin φ/Q_D with the spin Ω, sin φ = ½ and Q_D = 2 1/s: Ω = s₂₁ − 2 sin 2Δ/sin φ.
    let text = STATE_CASE.replace("noncoaxiality_deg = 20", "half_vorticity = 0.3");
    let spin = 0.3 - 4.0 * 40f64.to_radians().sin();
    let found = run_point(&text, &[&format!("background.spin={spin}")]);
    let delta = found["background"]["noncoaxiality_deg"].as_f64().unwrap();
    assert!((delta - 20.0).abs() < 1e-12);
}

#[test]
fn compared_models_have_separate_verdicts() {
    let text = format!("{STATE_CASE}\n[compare]\nkinds = ['harris-grekova', 'double-shearing']\n");
    let found = run_point(&text, &[]);
    let verdicts: Vec<_> =
        found["compare"].as_array().unwrap().iter().map(|c| &c["verdict"]).collect();
    assert_eq!(verdicts, ["well-posed", "ill-posed"]);
    assert_eq!(found["compare"][1]["order"], 1.0);
}

#[test]
fn free_rotating_model_is_indeterminate() {
    let text = STATE_CASE
        .replace("harris-grekova", "free-rotating")
        .replace("moment_of_inertia = 1.25e-7\nrotational_strength = 0\n", "");
    let found = run_point(&text, &[]);
    assert_eq!(found["verdict"], "indeterminate");
    assert!(found["roots"].is_null() && found["characteristics"].is_null());
}

#[test]
fn map_is_independent_of_threads_and_agrees_with_points() {
    let folder = tempfile::tempdir().unwrap();
    let mut results = Vec::new();
    for threads in [1, 3] {
        let mut options = create_options(folder.path(), STATE_CASE, &[]);
        options.output_folder = Some(folder.path().join(format!("{threads}")));
        options.thread_count = Some(threads);
        cli::run_map(
            &options,
            MapOptions { computes_bound: true, ..MapOptions::default() },
            &mut std::io::sink(),
        )
        .unwrap();
        let mut files: Vec<_> = fs::read_dir(folder.path().join(format!("{threads}")))
            .unwrap()
            .map(|entry| entry.unwrap())
            .map(|entry| (entry.file_name(), fs::read(entry.path()).unwrap()))
            .collect();
        files.sort();
        results.push(files);
    }
    assert!(results[0].len() >= 7, "{:?}", results[0].iter().map(|f| &f.0).collect::<Vec<_>>());
    assert!(results[1..].iter().all(|r| *r == results[0]), "files differ between thread counts");

    // Arrays of the map are compared with the verdicts of single points.
    let arrays = results[0].iter().find(|(name, _)| name == "map.npz").unwrap();
    let arrays = files::npz::read_arrays(&arrays.1).unwrap();
    let numbers = |name: &str| {
        let array = arrays.iter().find(|a| a.name == name).unwrap_or_else(|| panic!("{name}"));
        match &array.values {
            files::npz::ArrayValues::F64(values) => values.clone(),
            files::npz::ArrayValues::I8(values) => values.iter().map(|&v| f64::from(v)).collect(),
            other => panic!("{name}: {other:?}"),
        }
    };
    let x = numbers("background.noncoaxiality_deg");
    let y = numbers("model.dilatancy_angle_deg");
    let (verdict, order) = (numbers("verdict"), numbers("order"));
    assert_eq!((x.len(), y.len(), verdict.len()), (25, 9, 225));
    for (iy, ix) in [(0, 12), (0, 24), (2, 8), (3, 20), (5, 3), (8, 0)] {
        let sets = [
            format!("background.noncoaxiality_deg={}", x[ix]),
            format!("model.dilatancy_angle_deg={}", y[iy]),
        ];
        let code = verdict[iy * 25 + ix];
        if y[iy] >= 30.0 {
            assert_eq!(code, 5.0, "ν ≥ φ is outside the model");
            continue;
        }
        let found = run_point(STATE_CASE, &[&sets[0], &sets[1]]);
        let wanted = if found["verdict"] == "well-posed" { 0.0 } else { 1.0 };
        assert_eq!(code, wanted, "{sets:?}");
        let order = order[iy * 25 + ix];
        assert_eq!(found["order"].as_f64(), order.is_finite().then_some(order), "{sets:?}");
    }
}

#[test]
fn map_outside_model_is_refused_with_line_and_key() {
    let folder = tempfile::tempdir().unwrap();
    let text = STATE_CASE.replace("density = 1600", "density = -1600");
    let options = create_options(folder.path(), &text, &[]);
    let error = cli::run_map(&options, MapOptions::default(), &mut std::io::sink()).unwrap_err();
    let message = error.to_string();
    assert_eq!(error.exit_code(), 2);
    assert!(
        message.contains("state.toml:9") && message.contains("background.density"),
        "{message}"
    );
    assert!(!folder.path().join("out/map.json").exists());
}

#[test]
fn compared_models_have_equal_state_for_given_spin() {
    let text = STATE_CASE.replace("noncoaxiality_deg = 20", "spin = -1.5")
        + "\n[compare]\nkinds = ['harris-grekova', 'double-shearing', 'plastic-potential']\n";
    let found = run_point(&text, &[]);
    let delta = |report: &Value| report["background"]["noncoaxiality_deg"].as_f64().unwrap();
    // sin 2Δ = −Ω sin φ/Q_D with the spin Ω = −1.5 1/s and the half-vorticity 0.
    let wanted = 0.5 * (1.5f64 * 0.5 / 2.0).asin().to_degrees();
    assert!((delta(&found) - wanted).abs() < 1e-12);
    assert_eq!(delta(&found["compare"][0]), delta(&found));
    assert!((delta(&found["compare"][1]) - delta(&found)).abs() < 1e-12);
    assert_eq!(delta(&found["compare"][2]), 0.0, "the plastic potential is coaxial");
}

#[test]
fn waves_outside_floating_point_range_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for set in ["wave.number=1e100", "wave.number=1e-100", "background.velocity=[1e308, 0]"] {
        let options = create_options(folder.path(), STATE_CASE, &[set]);
        let error = cli::run_point(&options, &mut std::io::sink()).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{set}");
        let text = error.to_string();
        let is_explained = text.contains("for a computer") || text.contains("range of doubles");
        assert!(is_explained, "{set}: {text}");
    }
}

#[test]
fn growth_curve_by_direction_reaches_predicted_peak() {
    let text = STATE_CASE
        .replace("rotational_strength = 0", "rotational_strength = 5\ndilatancy_angle_deg = 10")
        .replace("number = 500", "number = 1e7");
    let folder = tempfile::tempdir().unwrap();
    cli::run_point(&create_options(folder.path(), &text, &[]), &mut std::io::sink()).unwrap();
    let curve = fs::read_to_string(folder.path().join("out/growth_by_direction.csv")).unwrap();
    let max_growth_rate = curve
        .lines()
        .skip(1)
        .filter_map(|line| line.rsplit(',').next()?.parse::<f64>().ok())
        .fold(0.0, f64::max);
    let found: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/point.json")).unwrap()).unwrap();
    assert_eq!(found["order"], 0.4);
    let predicted = found["coefficient"].as_f64().unwrap() * 1e7f64.powf(0.4);
    assert!((max_growth_rate / predicted - 1.0).abs() < 0.05, "{max_growth_rate} for {predicted}");
}

#[test]
fn fitted_growth_orders_agree_with_exact_orders() {
    let layer = STATE_CASE
        .replace("rotational_strength = 0", "rotational_strength = 5\ndilatancy_angle_deg = 10");
    let coaxial = STATE_CASE
        .replace("harris-grekova", "plastic-potential")
        .replace(
            "moment_of_inertia = 1.25e-7\nrotational_strength = 0\n",
            "dilatancy_angle_deg = 29\n",
        )
        .replace("noncoaxiality_deg = 20\n", "");
    let shearing = STATE_CASE
        .replace("harris-grekova", "double-shearing")
        .replace("moment_of_inertia = 1.25e-7\nrotational_strength = 0\n", "");
    for (text, set, order) in [
        (STATE_CASE, "background.noncoaxiality_deg=60", 2.0),
        (&layer, "background.noncoaxiality_deg=5", 0.4),
        (&coaxial, "wave.number=100", 2.0),
        (&shearing, "wave.direction_deg=90", 1.0),
    ] {
        let found = run_point(text, &[set]);
        assert_eq!(found["order"], order, "{set}");
        let fitted = found["fitted_order"].as_f64().unwrap();
        assert!((fitted - order).abs() < 0.02, "{fitted} for {order}");
        let numbers = found["fitted_wave_numbers"].as_array().unwrap();
        let ratio = numbers[1].as_f64().unwrap() / numbers[0].as_f64().unwrap();
        assert!((ratio - 100.0).abs() < 1e-6);
    }
    let bounded = run_point(STATE_CASE, &[]);
    assert!(bounded["fitted_order"].as_f64().is_none_or(|order| order < 1e-3));
    for set in [
        "background.deviatoric_stress=499",
        // Unbounded growth at a finite wave number.
        "model.dilatancy_angle_deg=20",
    ] {
        let found = run_point(STATE_CASE, &[set, "background.noncoaxiality_deg=44.9"]);
        assert!(found["order"].is_null() && found["fitted_order"].is_null(), "{set}");
    }
}

#[test]
fn max_growth_rate_bounds_directional_rate_and_follows_asymptote() {
    let text = STATE_CASE
        .replace("rotational_strength = 0", "rotational_strength = 5\ndilatancy_angle_deg = 10");
    let folder = tempfile::tempdir().unwrap();
    cli::run_point(&create_options(folder.path(), &text, &[]), &mut std::io::sink()).unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let found: Value = serde_json::from_str(&read("point.json")).unwrap();
    let (order, coefficient) =
        (found["order"].as_f64().unwrap(), found["coefficient"].as_f64().unwrap());
    let table = read("growth_by_wave_number.csv");
    let mut lines = table.lines();
    let header = "model,number,growth_rate,greatest_growth_rate,greatest_direction_deg";
    assert_eq!(lines.next(), Some(header));
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').skip(1).map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert!(rows.iter().all(|row| row[2] >= row[1] && (0.0..180.0).contains(&row[3])));
    let last = rows.last().unwrap();
    assert!((last[2] / (coefficient * last[0].powf(order)) - 1.0).abs() < 0.01, "{last:?}");
    for name in ["growth", "polar", "directions"] {
        assert!(folder.path().join(format!("out/{name}.png")).exists());
        assert!(folder.path().join(format!("out/{name}.svg")).exists());
    }
}
