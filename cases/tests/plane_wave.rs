//! Sections of plane waves: reading, writing, and refusals with line and key.

use wellposed_cases::Case;
use wellposed_cases::plane_wave::{ContactMedium, PistonLoadValue, SpallShape};

const POROUS: &str = "\
[model]
kind = 'classical'
lambda = 55e9
mu = 25e9
density = 2673
dimensions = 3
[porous]
porosity = 0.01
yield_stress = 4e7
contact_bulk_modulus = 4e9
[piston]
pressure = 1e9
";

const GRANULAR: &str = "\
[model]
kind = 'classical'
lambda = 1e9
mu = 1e9
density = 1800
dimensions = 3
[granular]
friction = 0.5
[piston]
speed = 5
loosening = 0.01
[spall]
speed = 2
duration = 1e-3
shape = 'triangle'
";

fn parse(text: &str) -> Result<Case, String> {
    Case::parse(text, "x.toml", &[]).map_err(|error| error.to_string())
}

#[test]
fn sections_are_read_and_written() {
    for text in [
        POROUS.to_owned(),
        GRANULAR.to_owned(),
        POROUS.replace(
            "[piston]",
            "contact = 'cone'\ncontact_shear_modulus = 1e9\nfriction = 0.4\n[piston]",
        ),
        POROUS.replace("pressure = 1e9", "speed = 10\nduration = 1e-5\nprofile_time = 2e-5"),
        POROUS.replace("yield_stress = 4e7\n", ""),
    ] {
        let case = parse(&text).unwrap();
        assert!(case.plane_wave.is_some());
        let again = parse(&case.to_toml()).unwrap();
        assert_eq!(case.plane_wave, again.plane_wave, "{}", case.to_toml());
        assert_eq!(case.to_toml(), again.to_toml());
    }
    let own = parse(POROUS).unwrap().plane_wave.unwrap();
    let ContactMedium::Porous { porosity, contact_cone, intensity_coefficient, .. } = own.medium
    else {
        panic!("{own:?}")
    };
    assert_eq!((porosity, contact_cone, intensity_coefficient), (0.01, None, 0.375));
    assert_eq!(own.piston.unwrap().load, PistonLoadValue::Pressure(1e9));
    let own = parse(GRANULAR).unwrap().plane_wave.unwrap();
    assert_eq!(own.piston.unwrap().loosening, 0.01);
    assert_eq!(own.spall.unwrap().shape, SpallShape::Triangle);
}

#[test]
fn wrong_sections_are_refused_with_line_and_key() {
    for (text, old, new, expected) in [
        (
            POROUS,
            "porosity = 0.01",
            "porosity = 1",
            "x.toml:8: porous.porosity: found the integer 1; expected",
        ),
        (
            POROUS,
            "porosity = 0.01",
            "porosity = -0.1",
            "x.toml:8: porous.porosity: found the number -0.1;",
        ),
        (
            POROUS,
            "= 4e9",
            "= -4e9",
            "x.toml:10: porous.contact_bulk_modulus: found the number -4e9;",
        ),
        (POROUS, "= 4e7", "= 0", "x.toml:9: porous.yield_stress: found the integer 0;"),
        (POROUS, "porosity = 0.01\n", "", "porous.porosity: missing; add porosity to [porous]"),
        (POROUS, "porosity", "porositi", "porous.porosity: missing;"),
        (POROUS, "[piston]\npressure = 1e9\n", "", "porous: found without a load; add"),
        (POROUS, "pressure = 1e9", "", "piston.pressure: missing;"),
        (
            POROUS,
            "pressure = 1e9",
            "pressure = 1e9\nspeed = 1",
            "x.toml:13: piston.speed: found beside",
        ),
        (
            POROUS,
            "pressure = 1e9",
            "pressure = 1e9\nloosening = 0.1",
            "x.toml:13: piston.loosening:",
        ),
        (
            POROUS,
            "pressure = 1e9",
            "pressure = 0",
            "x.toml:12: piston.pressure: found the integer 0;",
        ),
        (
            POROUS,
            "[piston]",
            "friction = 0.5\n[piston]",
            "x.toml:11: porous.friction: unknown key;",
        ),
        (
            POROUS,
            "[piston]",
            "contact = 'cone'\n[piston]",
            "porous.contact_shear_modulus: missing;",
        ),
        (
            POROUS,
            "[piston]",
            "contact = 'con'\n[piston]",
            "x.toml:11: porous.contact: found 'con'; did you mean 'cone'?",
        ),
        (
            POROUS,
            "[piston]",
            "[granular]\nfriction = 1\n[piston]",
            "porous: found beside [granular];",
        ),
        (
            POROUS,
            "[piston]",
            "[spall]\nspeed = 1\nduration = 1\n[piston]",
            "x.toml:11: spall: found for a porous",
        ),
        (
            POROUS,
            "[piston]",
            "[yield]\nkind = 'von-mises'\nstrength = 1\n[piston]",
            "x.toml:11: yield: found beside [porous];",
        ),
        (
            POROUS,
            "[piston]",
            "[grid]\ncells = [9, 9]\nspacing = 1\n[time]\nduration = 1\n[piston]",
            "x.toml:7: porous: found beside a grid;",
        ),
        (
            POROUS,
            "kind = 'classical'",
            "kind = 'reduced-cosserat'\nalpha = 1e9\ninertia = 1",
            "porous: found for the model reduced-cosserat;",
        ),
        (
            GRANULAR,
            "friction = 0.5",
            "friction = -0.5",
            "x.toml:8: granular.friction: found the number -0.5;",
        ),
        (GRANULAR, "[granular]\nfriction = 0.5\n", "", "piston: found without a medium;"),
        (GRANULAR, "shape = 'triangle'", "shape = 'sine'", "x.toml:15: spall.shape: found 'sine';"),
    ] {
        assert!(text.contains(old), "{old}");
        let error = parse(&text.replacen(old, new, 1)).expect_err(new);
        assert!(error.contains(expected), "{error}\nexpected {expected}");
    }
}

#[test]
fn other_studies_refuse_media_with_contacts() {
    let error = parse(POROUS).unwrap().check_without_contacts().unwrap_err().to_string();
    assert!(error.starts_with("x.toml:7: porous: found; "), "{error}");
    let elastic = &POROUS[..POROUS.find("[porous]").unwrap()];
    let case = parse(elastic).unwrap();
    assert!(case.check_without_contacts().is_ok());
    let error = case.require_plane_wave().unwrap_err().to_string();
    assert!(error.starts_with("x.toml: porous: missing; add a section [porous]"), "{error}");
}
