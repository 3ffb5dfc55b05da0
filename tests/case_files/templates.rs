//! Templates of `new` and bundled cases: complete, valid and commented.

use super::full_case::derive_background;
use crate::mutation::uncomment_optional_keys;
use crate::support::parse_case;
use models::registry;
use wellposed::CASES;
use wellposed::case::{Case, MediumKind, ModelKind, keys};
use wellposed::setup;
use wellposed::study::ignore_progress;

#[test]
fn templates_are_complete_and_valid() {
    for medium in MediumKind::all_media() {
        let text = wellposed::cli::new::generate_state_template(medium);
        let case = parse_case(&text).unwrap();
        assert_eq!(case.medium(), medium);
        if let ModelKind::Solid(_) = medium.kind {
            setup::solid::create_solid(&case.material).unwrap();
        } else {
            derive_background(&case).unwrap();
            let map = case.require_map().unwrap();
            for (x, y) in [(0, 0), (25, 0), (0, 30), (25, 30)] {
                let mut corner = case.clone();
                corner.set_number(map.x.parameter, map.x.sweep_value(x));
                corner.set_number(map.y.parameter, map.y.sweep_value(y));
                derive_background(&corner).unwrap();
            }
        }
        // Every optional key can be uncommented as it is, and all keys are known.
        let full = uncomment_optional_keys(&text);
        parse_case(&full).unwrap();
        let is_layered = medium.yield_set == Some(registry::INTERLAYER);
        for key in keys()
            .iter()
            .filter(|key| key.is_used_by(medium) && key.example_value().is_some())
            .filter(|key| !(is_layered && key.name.starts_with("stress.")))
        {
            let line = format!("\n{} = ", key.split_section().1);
            assert_eq!(full.matches(&line).count(), 1, "{}", key.name);
        }
    }
}

#[test]
fn bundled_cases_are_valid_and_have_header_comments() {
    assert!(CASES.len() >= 5);
    for (path, text) in CASES {
        let case = Case::parse(text, path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!case.title.is_empty(), "{path}");
        let verb = if case.time_domain_run().is_ok() {
            if path.starts_with("cases/check/") { "check" } else { "run" }
        } else if case.rheology.is_some() {
            wellposed::compute_diagram(&case).unwrap_or_else(|error| panic!("{error}"));
            "diagram"
        } else if let ModelKind::Solid(_) = case.material.kind {
            setup::solid::create_solid(&case.material).unwrap_or_else(|error| panic!("{error}"));
            match case.map.is_some() {
                _ if case.plane_wave.is_some() => "shocks",
                true => "map",
                false if path.starts_with("cases/check/") => "check",
                false => "dispersion",
            }
        } else if case.equations.is_some() {
            wellposed::analyse_point(&case, &ignore_progress)
                .unwrap_or_else(|error| panic!("{error}"));
            if case.map.is_some() { "map" } else { "point" }
        } else {
            derive_background(&case).unwrap_or_else(|error| panic!("{error}"));
            if case.map.is_some() { "map" } else { "point" }
        };
        let command = format!("# Run     wellposed {verb} {path}");
        let lines = || text.lines();
        assert!(
            lines().any(|line| line.trim_end_matches(" --accept-ill-posed") == command),
            "{path} does not say '{command}'"
        );
        for heading in ["# Shows ", "# Expect ", "# Takes "] {
            assert!(text.contains(heading), "{path} does not say '{heading}'");
        }
    }
}
