//! Tests of plane pulses against the exact wave, and of loads with a profile along their boundary.

use crate::support;

use support::{Columns, create_run_options, format_periodic_boundaries, read_columns, run_case};
use wellposed::case::Case;
use wellposed::cli::CommandError;

const MODEL_SECTION: &str = "
[model]
kind = 'classical'
lambda = 1e8
mu = 8e7
density = 2000
";

/// Runs a case and returns the receiver table and the ledger.
fn run_and_read_tables(case: &str) -> Result<[Columns; 2], CommandError> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    run_case(&create_run_options(folder.path(), case))?;
    let out = folder.path().join("out");
    Ok(["receivers.csv", "ledger.csv"].map(|name| read_columns(&out.join(name))))
}

/// Verifies that oblique P and S pulses have the shape, speed and polarisation of the exact wave with an error of
/// second order, before waves from the boundaries arrive.
#[test]
fn oblique_pulses_converge_to_exact_waves() {
    let speeds = [(2.6e8f64 / 2000.0).sqrt(), (8e7f64 / 2000.0).sqrt()];
    for (wave, direction, speed) in [("P", 200.0f64, speeds[0]), ("S", 35.0, speeds[1])] {
        let (sin, cos) = direction.to_radians().sin_cos();
        // The receiver is 3 m from the centre of the pulse.
        let at = [20.0 + 3.0 * cos, 20.0 + 3.0 * sin];
        let period = 8.0 / speed;
        let errors = [80, 160].map(|cells| {
            let case = format!(
                "{MODEL_SECTION}[grid]\ncells = {:?}\nspacing = {}\n[time]\nduration = 0.036\n\
                 [[initial]]\nkind = 'plane-pulse'\nwave = '{wave}'\ndirection_deg = {direction}\n\
                 at = [20, 20]\namplitude = 0.5\ntime = {{ kind = 'pulse', duration = {period} }}\n\
                 [[receiver]]\nat = {at:?}\nfields = ['v1', 'v2']\n",
                [cells; 2],
                40.0 / f64::from(cells),
            );
            let [receivers, ledger] = run_and_read_tables(&case).expect("a sound case");
            // In a plane wave kinetic energy equals stored energy.
            let [kinetic, stored] = [ledger[1].1[0], ledger[2].1[0]];
            assert!(kinetic > 0.0 && (kinetic - stored).abs() < 1e-12 * kinetic);
            let along = if wave == "P" { [cos, sin] } else { [-sin, cos] };
            let (mut error, mut norm) = (0.0, 0.0);
            for (row, time) in receivers[0].1.iter().enumerate() {
                let phase = (time - 3.0 / speed) / period;
                let shape = match (0.0..1.0).contains(&phase) {
                    true => (std::f64::consts::PI * phase).sin().powi(2),
                    false => 0.0,
                };
                for (axis, a) in along.iter().enumerate() {
                    error += (receivers[axis + 1].1[row] - 0.5 * a * shape).powi(2);
                    norm += (0.5 * a * shape).powi(2);
                }
            }
            (error / norm).sqrt()
        });
        println!("{wave}: {errors:?}, order {}", (errors[0] / errors[1]).log2());
        assert!(errors[1] < 0.01, "{wave}: {errors:?}");
        assert!((errors[0] / errors[1]).log2() > 1.5, "{wave}: {errors:?}");
    }
}

/// Verifies pulses in three dimensions: half of the energy is kinetic; the velocity is transverse in S waves and
/// longitudinal in P waves.
#[test]
fn pulses_in_three_dimensions_are_polarised_plane_waves() {
    let n = {
        let ((sin, cos), (up, out)) = (40f64.to_radians().sin_cos(), 25f64.to_radians().sin_cos());
        [out * cos, out * sin, up]
    };
    for keys in ["wave = 'P'", "wave = 'S'", "wave = 'S'\npolarization_deg = 70"] {
        let case = format!(
            "{MODEL_SECTION}[grid]\ncells = [12, 10, 11]\nspacing = 0.5\n[time]\nduration = 1e-4\n\
             [[initial]]\nkind = 'plane-pulse'\n{keys}\ndirection_deg = 40\nelevation_deg = 25\n\
             at = [3, 2.5, 2.5]\namplitude = 2\ntime = {{ kind = 'ricker', frequency = 60, delay = 0 }}\n\
             [[receiver]]\nat = [3.1, 2.4, 2.6]\nfields = ['v1', 'v2', 'v3']\ninterpolation = 'none'\n"
        );
        let again = Case::parse(&case, "case.run.toml", &[]).expect("a sound case");
        let again = Case::parse(&again.to_toml(), "case.run.toml", &[]).expect("a sound case");
        let [receivers, ledger] = run_and_read_tables(&again.to_toml()).expect("a sound case");
        let [kinetic, stored] = [ledger[1].1[0], ledger[2].1[0]];
        assert!(kinetic > 0.0 && (kinetic - stored).abs() < 1e-12 * kinetic, "{keys}");
        let v: [f64; 3] = std::array::from_fn(|axis| receivers[axis + 1].1[0]);
        let along: f64 = v.iter().zip(n).map(|(v, n)| v * n).sum();
        let speed = v.iter().fold(0.0, |sum: f64, v| sum.hypot(*v));
        assert!(speed > 1.0);
        let expected = if keys.contains('P') { speed } else { 0.0 };
        assert!((along - expected).abs() < 1e-14 * speed, "{keys}: {along} {speed}");
        // By default S waves are polarised in the plane of x₁ and x₂.
        assert!(keys != "wave = 'S'" || v[2] == 0.0);
    }
}

/// Verifies that a pulse which reaches another medium or is in a medium with spins is refused; a narrow pulse in one
/// layer is accepted.
#[test]
fn pulses_across_layers_and_with_spin_are_refused() {
    let case = |kind: &str, width: &str| {
        format!(
            "{}[grid]\ncells = [40, 40]\nspacing = 0.5\n[time]\nduration = 0.001\n[[region]]\n\
             shape = 'layer'\naxis = 2\nfrom = 0\nto = 6\nmodel = {{ mu = 2e8 }}\n[[region]]\n\
             shape = 'rest'\n[[initial]]\nkind = 'plane-pulse'\nwave = 'P'\ndirection_deg = -60\n\
             at = [10, 10]\namplitude = 1\ntime = {{ kind = 'pulse', duration = 0.01 }}\n{width}\n\
             [[receiver]]\nat = [10, 10]\n",
            MODEL_SECTION.replace("'classical'", kind)
        )
    };
    assert!(run_and_read_tables(&case("'classical'", "width = 3")).is_ok());
    let refusal = |case: &str| run_and_read_tables(case).expect_err("a wrong case").to_string();
    let error = refusal(&case("'classical'", ""));
    assert!(error.contains("initial[0]: a pulse that reaches another medium"), "{error}");
    let spins = "'reduced-cosserat'\nalpha = 3e7\ninertia = 300";
    let error = refusal(&case(spins, "width = 3"));
    assert!(
        error.contains("initial[0].kind: a pulse in a solid of kind reduced-cosserat"),
        "{error}"
    );
}

/// Runs loads on the upper boundary of a periodic strip with a linear scheme, and returns the receiver table.
fn run_with_loads(loads: &[&str]) -> Columns {
    let loads: String = loads
        .iter()
        .map(|keys| {
            format!(
                "[[load]]\nside = 'x2+'\nfield = 'sigma22'\n{keys}\n\
                 time = {{ kind = 'pulse', duration = 0.01 }}\n"
            )
        })
        .collect();
    let case = format!(
        "{MODEL_SECTION}[grid]\ncells = [24, 16]\nspacing = 0.5\n[time]\nduration = 0.02\n[scheme]\n\
         order = 'godunov'\n{}{loads}[[receiver]]\nfrom = [0.25, 6.25]\nto = [8.25, 6.25]\n\
         count = 5\nfields = ['v1', 'v2']\n",
        format_periodic_boundaries(&["x1-", "x1+"])
    );
    let [receivers, _] = run_and_read_tables(&case).expect("a sound case");
    receivers
}

/// Checks that a record is the given linear combination of others, within rounding.
fn assert_linear_combination(found: &[f64], terms: &[(f64, &[f64])]) {
    let largest = found.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let scale = terms.iter().flat_map(|term| term.1).fold(largest, |a: f64, b| a.max(b.abs()));
    assert!(scale > 0.0);
    for (row, found) in found.iter().enumerate() {
        let expected: f64 = terms.iter().map(|(factor, term)| factor * term[row]).sum();
        assert!((found - expected).abs() < 1e-12 * scale, "{row}: {found} {expected}");
    }
}

/// Verifies the response of a linear solid to load profiles: the velocity v₂ is proportional to cos(kx) for the profile
/// cos(kx); a bell acts like a force with the same integral; two ramps with the sum 1 act like a uniform load.
#[test]
fn load_profiles_superpose_linearly() {
    // Receivers at x = 0.25, 2.25, 4.25, 6.25 and 8.25 m are cell centres; the strip of 12 m contains an integer
    // number of wavelengths.
    let wave = run_with_loads(&[
        "amplitude = 1e4\nprofile = { kind = 'cos', wavelength = 6, phase_deg = -15 }",
    ]);
    for (index, x) in [0.25, 2.25, 4.25, 6.25, 8.25].into_iter().enumerate() {
        // The phase of the profile is 0 at x = 0.25 m.
        let factor = (std::f64::consts::TAU * (x - 0.25) / 6.0).cos();
        assert_linear_combination(&wave[2 + 2 * index].1, &[(factor, &wave[2].1)]);
    }
    // Σ h ½(1 + cos(πr/radius)) = radius if the radius is a multiple of the cell size and the bell is centred in a
    // cell.
    let bell =
        run_with_loads(&["amplitude = 2e3\nprofile = { kind = 'bell', at = 1.25, radius = 2 }"]);
    let force = run_with_loads(&["amplitude = 4e3\nat = 1.25\nradius = 2"]);
    for (bell, force) in bell.iter().zip(&force).skip(1) {
        assert_linear_combination(&bell.1, &[(1.0, &force.1)]);
    }
    let table = |samples: &str| {
        format!("amplitude = 1e4\nprofile = {{ kind = 'table', samples = {samples} }}")
    };
    let (up, down) = (table("[[2, 0], [5, 1]]"), table("[[2, 1], [5, 0]]"));
    let sum = run_with_loads(&[&up, &down]);
    let uniform = run_with_loads(&["amplitude = 1e4\nfrom = 2\nto = 5"]);
    let single = run_with_loads(&[&up]);
    for ((sum, uniform), single) in sum.iter().zip(&uniform).zip(&single).skip(1) {
        assert_linear_combination(&sum.1, &[(1.0, &uniform.1)]);
        assert!(single.1 != uniform.1);
    }
    let case = format!(
        "{MODEL_SECTION}[grid]\ncells = [4, 4, 4]\nspacing = 1\n[time]\nduration = 1\n[[load]]\nside = 'x2+'\n\
         field = 'sigma22'\namplitude = 1\nprofile = {{ kind = 'cos', axis = 3, wavelength = 2 }}\n\
         time = {{ kind = 'step' }}\n"
    );
    let read = Case::parse(&case, "case.run.toml", &[]).expect("a sound case");
    let again = Case::parse(&read.to_toml(), "case.run.toml", &[]).expect("a sound case");
    assert_eq!(again.solid_run.expect("a run").loads, read.solid_run.expect("a run").loads);
    let wrong = case.replace("axis = 3", "axis = 2");
    let error = Case::parse(&wrong, "case.run.toml", &[]).expect_err("a wrong case").to_string();
    assert!(error.contains("load[0].profile.axis: found 2"), "{error}");
    for (keys, expected) in [
        (
            "profile = { kind = 'bell', at = 30, radius = 2 }",
            "load[0].profile: 0 in the middle of every face that the load is on; one that is not 0",
        ),
        (
            "at = 1\nprofile = { kind = 'cos', wavelength = 2 }",
            "load[0].profile: found beside at; leave it out: what acts at a point has a kernel",
        ),
        ("profile = { kind = 'bell', at = 0, radius = 0 }", "load[0].profile.radius: found"),
    ] {
        let case = format!(
            "{MODEL_SECTION}[grid]\ncells = [24, 16]\nspacing = 0.5\n[time]\nduration = 0.02\n[[load]]\n\
             side = 'x2+'\nfield = 'sigma22'\namplitude = 1\ntime = {{ kind = 'step' }}\n{keys}\n"
        );
        let error = run_and_read_tables(&case).expect_err("a wrong case").to_string();
        assert!(error.contains(expected), "{error}");
    }
}
