//! Templates of `new` and bundled cases: complete, valid and commented.

use crate::mutation::without_marks;
use crate::support::{check, parse};
use models::registry;
use wellposed::CASES;
use wellposed::case::{Case, Kind, Medium, keys};
use wellposed::setup;

#[test]
fn new_cases_are_complete_and_valid() {
    for medium in Medium::all() {
        let text = wellposed::cli::new::text(medium);
        let case = parse(&text).unwrap();
        assert_eq!(case.medium(), medium);
        if let Kind::Solid(_) = medium.kind {
            setup::solid::solid(&case.material).unwrap();
        } else {
            check(&case).unwrap();
            let map = case.required_map().unwrap();
            for (x, y) in [(0, 0), (25, 0), (0, 30), (25, 30)] {
                let mut corner = case.clone();
                corner.set(map.x.parameter, map.x.value(x));
                corner.set(map.y.parameter, map.y.value(y));
                check(&corner).unwrap();
            }
        }
        // Every optional key can be uncommented as it is, and all keys are known.
        let full = without_marks(&text);
        parse(&full).unwrap();
        let is_layered = medium.yields == Some(registry::INTERLAYER);
        for key in keys()
            .iter()
            .filter(|key| key.is_used_by(medium) && key.example().is_some())
            .filter(|key| !(is_layered && key.name.starts_with("stress.")))
        {
            let line = format!("\n{} = ", key.split().1);
            assert_eq!(full.matches(&line).count(), 1, "{}", key.name);
        }
    }
}

#[test]
fn bundled_cases_are_valid_and_have_headers() {
    assert!(CASES.len() >= 5);
    for (path, text) in CASES {
        let case = Case::parse(text, path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!case.title.is_empty(), "{path}");
        let verb = if case.in_time().is_ok() {
            if path.starts_with("cases/check/") { "check" } else { "run" }
        } else if let Kind::Solid(_) = case.material.kind {
            setup::solid::solid(&case.material).unwrap_or_else(|error| panic!("{error}"));
            match case.map.is_some() {
                true => "map",
                false if path.starts_with("cases/check/") => "check",
                false => "dispersion",
            }
        } else {
            check(&case).unwrap_or_else(|error| panic!("{error}"));
            if case.map.is_some() { "map" } else { "point" }
        };
        let command = format!("# Run     wellposed {verb} {path}");
        let lines = || text.lines();
        assert!(
            lines().any(|line| line.trim_end_matches(" --accept-ill-posed") == command),
            "{path} does not say '{command}'"
        );
        for part in ["# Shows ", "# Expect ", "# Takes "] {
            assert!(text.contains(part), "{path} does not say '{part}'");
        }
    }
}
