//! Tests of refused time-domain sections and their messages.

use super::{PLANE_CASE, SPATIAL_CASE};
use crate::support::{parse_case, parse_case_with, replace_first};
use std::panic::{AssertUnwindSafe, catch_unwind};
use wellposed::case::ModelKind;
use wellposed::setup;

#[test]
fn model_errors_name_the_line_of_the_region() {
    let located = |text: &str, sets: &[&str]| {
        let case = parse_case_with(text, sets).unwrap();
        let region = &case.solid_run.as_ref().unwrap().regions[0].material;
        region.locate_error(setup::solid::create_solid(region).unwrap_err()).to_string()
    };
    let text = replace_first(PLANE_CASE, "mu = 3e9", "mu = -3e9");
    let start = "folder/x.toml:34: region[0].model.mu: found -3e9;";
    let error = located(&text, &[]);
    assert!(error.starts_with(start), "{error}");
    // The error of an inherited key names the line of that key.
    let error = located(&replace_first(PLANE_CASE, "alpha = 5e8", "alpha = -5"), &[]);
    assert!(error.starts_with("folder/x.toml:6: model.alpha: found -5"), "{error}");
    let error = located(PLANE_CASE, &["region[0].model.mu=-1"]);
    let start = "--set region[0].model.mu=-1: region[0].model.mu: found -1";
    assert!(error.starts_with(start), "{error}");
    let case = parse_case(PLANE_CASE).unwrap();
    let error = case.solid_run.unwrap().key_error("load[1].at", "too near", "move it").to_string();
    assert_eq!(error, "folder/x.toml:62: load[1].at: too near; move it");
}

/// Replaces a passage of [`PLANE_CASE`] and checks the complete message, or its beginning if the entry ends with ": ".
// Long because of the table, with one line for each invalid input.
#[test]
fn invalid_input_is_refused_with_line_key_and_remedy() {
    const FIELD_NAMES: &str =
        "v1, v2, w3, sigma11, sigma12, sigma21, sigma22, sigma33, m31, m32, m13, m23";
    #[rustfmt::skip]
    let table: &[(&str, &str, &str)] = &[
        // sections and keys
        ("[grid]", "[grdi]", "19: grdi: unknown key or section; did you mean 'grid'?"),
        ("[[receiver]]", "[[reciever]]", "134: reciever: unknown key or section; did you mean 'receiver'?"),
        ("spacing = [0.5, 1]", "spacin = 1", "19: grid.spacing: missing; add spacing to [grid]: expected a positive number or a list of 2 positive numbers in m (cell size)"),
        ("origin = [-5, 0]", "orign = [-5, 0]", "22: grid.orign: unknown key; did you mean 'origin'? allowed here: cells, spacing, origin, inner_radius"),
        ("courant = 0.9", "courant = 1.5", "25: time.courant: found 1.5; expected a number above 0 and at most 1 (Courant number): a sweep is unstable above 1"),
        ("courant = 0.9", "courat = 0.9", "25: time.courat: unknown key; did you mean 'courant'? allowed here: duration, courant, courant_of, rotation_deg"),
        ("courant = 0.9", "courant_of = 'p'", "25: time.courant_of: found 'p'; allowed: fastest, s"),
        ("duration = 0.25", "duration = 0", "24: time.duration: found 0; expected a positive number in s"),
        ("duration = 0.25\n", "", "23: time.duration: missing; add duration to [time]: expected a positive number in s"),
        ("[time]\nduration = 0.25\ncourant = 0.9\n", "", ": time: missing; add a section [time] with duration in s"),
        ("'godunov'", "'godunow'", "27: scheme.order: found 'godunow'; did you mean 'godunov'? allowed: fourth-order, eno2, godunov"),
        ("'godunov'", "2", "27: scheme.order: found 2; expected one of fourth-order, eno2, godunov"),
        ("'godunov'", "'sixth-order'", "27: scheme.order: found 'sixth-order'; expected 'fourth-order' or 'eno2' or 'godunov': regions of other solids allow no other"),
        // grid
        ("cells = [20, 10]", "cells = [20, 10, 5, 3]", "20: grid.cells: found [20, 10, 5, 3]; expected a list of 2 or 3 whole numbers of at least 1 (cells along each axis)"),
        ("cells = [20, 10]", "cells = [20, 0]", "20: grid.cells: found [20, 0]; expected a list of 2 or 3 whole numbers of at least 1 (cells along each axis)"),
        ("cells = [20, 10]", "cells = [2000000, 1000000]", "20: grid.cells: found a grid of 2000000 × 1000000; expected at most 4000000000 cells in total"),
        ("spacing = [0.5, 1]", "spacing = 1e-300", "21: grid.spacing: cells of 1e-300 m from -5 to -5; expected a spacing at which cell coordinates along x1 differ in double precision"),
        ("lambda = 2e9", "dimensions = 3\nlambda = 2e9", "4: model.dimensions: found 3 in a grid of 2 dimensions; expected 2, the number of entries of grid.cells; or leave the key out"),
        // regions
        ("model = { mu = 3e9 }", "model = { mu = 3e9, a1 = 4 }", "34: region[0].model.a1: not used by the model cosserat; leave it out (it belongs to cosserat-compliances)"),
        ("model = { mu = 3e9 }", "model = { mu = '3e9' }", "34: region[0].model.mu: found the text '3e9'; expected a finite number in Pa (shear modulus μ; > 0)"),
        ("model = { mu = 3e9 }", "model = { kind = 'classical' }", "34: region[0].model.kind: found classical, which does not admit the yield set cosserat-mises; add yield = { kind = ... } with one of none, interlayer, von-mises, drucker-prager"),
        ("model = { mu = 3e9 }", "model = { kind = 'reduced-cosserat', mu = 1, lambda = 1, density = 1, inertia = 1 }", "34: region[0].model.alpha: missing; add alpha to region[0].model: expected a finite number in Pa (modulus α of the antisymmetric strain; > 0)"),
        ("model = { mu = 3e9 }", "model = { dimensions = 3 }", "34: region[0].model.dimensions: found 3 in a grid of 2 dimensions; expected 2, the number of entries of grid.cells; or leave the key out"),
        ("model = { mu = 3e9 }", "model = { kind = 'double-shearing' }", "34: region[0].model.kind: found double-shearing, a flow; expected one of classical, reduced-cosserat, cosserat, cosserat-compliances"),
        ("model = { mu = 3e9 }", "model = 3", "34: region[0].model: found 3; expected a table in braces { key = value, ... }"),
        ("model = { mu = 3e9 }", "modl = { mu = 3e9 }", "34: region[0].modl: unknown key; did you mean 'model'? allowed here: shape, from, to, model, yield, contacts"),
        ("yield = { kind = 'none' }", "yield = { kind = 'non' }", "39: region[1].yield.kind: found 'non'; did you mean 'none'? allowed for cosserat: interlayer, von-mises, drucker-prager, cosserat-mises, none"),
        ("yield = { kind = 'none' }", "yield = { kind = 'none', strength = 1 }", "39: region[1].yield.strength: not used by an elastic solid; leave it out (it belongs to von-mises, drucker-prager, cosserat-mises)"),
        ("yield = { kind = 'von-mises', strength = 5 }", "yield = { kind = 'von-mises' }", "42: region[2].yield.strength: missing; add strength to region[2].yield: expected a finite number in Pa (strength k_Y in shear; > 0)"),
        ("shape = 'circle'", "shape = 'rest'", "37: region[1].center: found, but not used here; leave it out: it is used with shape circle or sphere, here 'rest'"),
        ("shape = 'circle'\ncenter = [2.5, 5]\nradius = 1.5", "shape = 'rest'", "39: region[2].shape: a second region with shape rest, after region[1] (folder/x.toml:35); use shape = \"rest\" once"),
        ("shape = 'circle'", "shape = 'sphere'", "36: region[1].shape: found 'sphere' in a grid of 2 dimensions; write circle"),
        ("to = [0, 10]", "to = [0, 0]", "33: region[0].to: found [0, 0] with from = [-5, 0]; to must be greater than from along each axis"),
        ("radius = 1.5", "radius = 0", "38: region[1].radius: found 0; expected a positive number in m"),
        // boundaries and loads
        ("side = 'x2-'\nkind = 'fixed'", "side = 'x3-'\nkind = 'fixed'", "45: boundary[0].side: found 'x3-'; did you mean 'x1-'? allowed: x1-, x1+, x2-, x2+"),
        ("kind = 'fixed'", "kind = 'periodic'", "46: boundary[0].kind: found periodic on x2- alone; add [[boundary]] with side = \"x2+\", kind = \"periodic\""),
        ("kind = 'fixed'", "kind = 'fixd'", "46: boundary[0].kind: found 'fixd'; did you mean 'fixed'? allowed: free, fixed, symmetry, antisymmetry, periodic, non-reflecting, mixed"),
        ("from = [-1]\n", "", "47: boundary[1].from: missing; give both ends of a part, from and to"),
        ("fixed_components = ['v2', 'w3']", "fixed_components = ['v2', 'w1']", "52: boundary[1].fixed_components: found 'w1'; did you mean 'v1'? allowed: v1, v2, w3"),
        ("fixed_components = ['v2', 'w3']\n", "", "47: boundary[1].fixed_components: missing; add fixed_components, a list with any of v1, v2, w3"),
        ("side = 'x2+'\nfield = 'sigma22'", "side = 'x3+'\nfield = 'sigma22'", "54: load[0].side: found 'x3+'; did you mean 'x1+'? allowed: x1-, x1+, x2-, x2+"),
        ("field = 'sigma22'", "field = 'sigma21'", "55: load[0].field: found 'sigma21'; did you mean 'sigma12'? allowed: v1, v2, w3, sigma12, sigma22, m32"),
        ("at = [0.5]", "at = [50]", "62: load[1].at: found [50], outside the grid; the grid has x1 from -5 to 5 m"),
        ("at = [0.5]\n", "", "62: load[1].radius: found without at; add at, the centre of the kernel, or leave it out"),
        ("from = [2]\nto = [4]", "at = [4]", "69: load[2].at: found for the velocity v1; give a stress or couple stress, or from and to instead of at"),
        ("time = { kind = 'triangle', duration = 0.01 }", "time = { kind = 'triangel' }", "57: load[0].time.kind: found 'triangel'; did you mean 'triangle'? allowed: step, triangle, pulse, ricker, sine, table"),
        ("time = { kind = 'triangle', duration = 0.01 }", "time = { kind = 'triangle' }", "57: load[0].time.duration: missing; add duration to load[0].time: expected a positive number in s (duration)"),
        ("time = { kind = 'triangle', duration = 0.01 }", "time = { kind = 'table', file = 'none.csv' }", "57: load[0].time.file: 'none.csv': No such file or directory (os error 2); name a CSV file with two columns, time in s and value, by its path relative to the folder of the case file"),
        ("time = { kind = 'triangle', duration = 0.01 }\n", "", "53: load[0].time: missing; add time to load[0]: expected a table { kind = ..., ... } (kind: step, triangle, pulse, ricker, sine, table)"),
        // sources and the initial state
        ("at = [0, 5]\nradius = 1", "at = [0, 50]\nradius = 1", "76: source[0].at: found [0, 50], outside the grid; the grid has x1 from -5 to 5 m, x2 from 0 to 10 m"),
        ("amplitude = [1, 2]", "amplitude = 1", "75: source[0].amplitude: found 1; expected a list of 2 finite numbers in N/m (force vector)"),
        ("branch = 2", "branch = 4", "110: initial[2].branch: found 4; expected a whole number from 1 to 3 (1 is the branch of highest frequency)"),
        ("field = 'sigma33'", "field = 'sigma34'", &format!("123: initial[4].field: found 'sigma34'; did you mean 'sigma33'? allowed: {FIELD_NAMES}")),
        ("normal = [0, 1]", "normal = [0, 0]", "118: initial[3].normal: found [0, 0]; expected a list of 2 numbers, not all 0 (normal vector that points into the shape)"),
        ("m31 = 4", "m33 = 4", "129: initial_stress.m33: unknown key; did you mean 'm31'? allowed here: sigma11, sigma12, sigma21, sigma22, sigma33, m31, m32, m13, m23"),
        ("acceleration = [0, -9.81]", "acceleration = [1, -9.81]", "130: gravity.balanced: found true, the default, with the acceleration [1, -9.81]; give an acceleration along one axis, or set balanced = false"),
        // receivers and output
        ("at = [5, 10]", "at = [5.5, 10]", "138: receiver[1].at: found [5.5, 10], outside the grid; the grid has x1 from -5 to 5 m, x2 from 0 to 10 m"),
        ("'surface.1'", "'r1'", "137: receiver[1].name: found 'r1', the name of receiver[0] (folder/x.toml:134); give each receiver a unique name"),
        ("'surface.1'", "'a b'", "137: receiver[1].name: found the text 'a b'; expected a name of 1 to 255 characters (letters, digits, '-', '_' and '.')"),
        ("['v1', 'sigma21']", "['v1', 'v1']", "139: receiver[1].fields: found 'v1' twice; expected each name once"),
        ("picture = 'w3'", "picture = 'sped'", "142: output.picture: found 'sped'; did you mean 'speed'?"),
        ("contours = [-1, 0.5]", "contours = [1, 'a']", "143: output.contours: found a list that contains the text 'a'; expected a list of finite numbers in the unit of the picture (contour levels)"),
    ];
    for (old, new, message) in table {
        let error = parse_case(&replace_first(PLANE_CASE, old, new)).expect_err(new);
        let file = if message.starts_with(':') { "folder/x.toml" } else { "folder/x.toml:" };
        let message = format!("{file}{message}");
        match message.ends_with(": ") {
            true => assert!(error.starts_with(&message), "{new}:\n{message}\n{error}"),
            false => assert_eq!(error, message, "{new}"),
        }
    }
}

#[test]
fn time_domain_runs_need_a_solid_and_a_grid() {
    let (model, rest) = PLANE_CASE.split_once("[grid]\n").unwrap();
    let (_, rest) = rest.split_once("[time]").unwrap();
    let error = parse_case(&format!("{model}[time]{rest}")).unwrap_err();
    let end = "time: found [time], but no [grid]; add a section [grid] with cells and spacing, which runs \
               need; or leave [time] out";
    assert_eq!(error, format!("folder/x.toml:19: {end}"));

    let plane = wellposed::cli::new::generate_state_template(ModelKind::solid_kinds()[3])
        + "[grid]\ncells = [2, 2, 2]\nspacing = 1\n";
    let error = parse_case(&plane).unwrap_err();
    let end = "model.kind: found cosserat-compliances in a grid of 3 dimensions; expected 2 \
               entries of grid.cells: this is a solid in plane strain";
    assert!(error.ends_with(end), "{error}");

    let classical = wellposed::cli::new::generate_state_template(ModelKind::solid_kinds()[0])
        + "[grid]\ncells = [2, 2, 2]\nspacing = 1\n[time]\nduration = 1\n";
    for (entry, end) in [
        (
            "[[initial]]\nkind = 'rotation'\n",
            "initial[0].kind: found a microrotation in a solid without spin; use a Cosserat solid in \
             model.kind, or another kind here",
        ),
        (
            "[[source]]\nkind = 'couple'\n",
            "source[0].kind: found a couple in a solid without spin; use a Cosserat solid in \
             model.kind, or another kind here",
        ),
        (
            "[initial_stress]\nsigma12 = 1\nsigma21 = 1\n",
            "initial_stress.sigma21: a second value of sigma12; give one: the stress tensor of a classical solid is symmetric",
        ),
        (
            "[[boundary]]\nside = 'x1-'\nkind = 'periodic'\n[[boundary]]\nside = 'x1+'\nkind = 'periodic'\n\
             [[load]]\nside = 'x1+'\n",
            "load[0].side: found x1+, which is periodic; periodic faces carry no load; use [[source]], or load another face",
        ),
        (
            "[[boundary]]\nside = 'x1-'\nkind = 'periodic'\n[[boundary]]\nside = 'x1+'\nkind = 'periodic'\n\
             [[boundary]]\nside = 'x1+'\nkind = 'free'\nfrom = [0, 0]\nto = [1, 1]\n",
            "boundary[2].side: found a part of x1+, which is periodic; leave the part out: a side is \
             periodic as a whole",
        ),
        (
            "[scheme]\norder = 'sixth-order'\n",
            "scheme.order: found 'sixth-order'; expected 'fourth-order' or 'eno2' or 'godunov': grids of fewer \
             than 4 cells along an axis allow no other",
        ),
        (
            "[scheme]\norder = 'eighth-order'\n[[boundary]]\nside = 'x1-'\nkind = 'non-reflecting'\n",
            "scheme.order: found 'eighth-order'; expected 'fourth-order' or 'eno2' or 'godunov': non-reflecting \
             sides, which would return short waves, allow no other",
        ),
        (
            "side = 3\n",
            "time.side: unknown key; allowed here: duration, courant, courant_of, rotation_deg",
        ),
    ] {
        let error = parse_case(&format!("{classical}{entry}")).unwrap_err();
        assert!(error.ends_with(end), "{error}");
    }
}

/// Verifies that cases with deleted, repeated, swapped or changed lines cause no panic, and that accepted ones are
/// unchanged by writing and reading.
#[test]
fn mutated_cases_are_accepted_or_refused() {
    const REPLACEMENT_VALUES: [&str; 14] = [
        "0",
        "-1",
        "1e308",
        "5e-324",
        "nan",
        "true",
        "'x'",
        "[]",
        "[1]",
        "[1, 2]",
        "[[1, 2], [3, 4]]",
        "{}",
        "[{}]",
        "{ kind = 'step', start = 1e308 }",
    ];
    let (mut accepted, mut count) = (0, 0);
    for original in [PLANE_CASE, SPATIAL_CASE] {
        let lines: Vec<&str> = original.lines().collect();
        let mut mutants = Vec::new();
        for at in 0..lines.len() {
            let replaced = |with: &[&str]| {
                let parts = [&lines[..at], with, &lines[at + 1..]];
                parts.concat().join("\n")
            };
            mutants.push(replaced(&[]));
            mutants.push(replaced(&[lines[at], lines[at]]));
            mutants.push(replaced(&[lines[(at * 7 + 3) % lines.len()]]));
            if let Some((key, _)) = lines[at].split_once(" = ") {
                let value = |value: &&str| replaced(&[&format!("{key} = {value}")]);
                mutants.extend(REPLACEMENT_VALUES.iter().map(value));
            }
        }
        for text in mutants {
            count += 1;
            let run = || {
                let case = parse_case(&text).ok()?;
                let resolved = case.to_toml();
                assert!(parse_case(&resolved) == Ok(case.clone()), "{resolved}");
                if let Some(dynamics) = case.solid_run.filter(|run| run.grid.cell_count() < 10_000)
                {
                    let _ = dynamics.compute_cell_media();
                }
                Some(())
            };
            match catch_unwind(AssertUnwindSafe(run)) {
                Ok(case) => accepted += usize::from(case.is_some()),
                Err(_) => panic!("{text}"),
            }
        }
    }
    assert!(accepted > count / 20 && accepted < count * 3 / 4, "{accepted} of {count} were taken");
}
