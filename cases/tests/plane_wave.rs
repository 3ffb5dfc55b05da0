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
        RUN.to_owned(),
        POROUS.to_owned(),
        GRANULAR.to_owned(),
        POROUS.replace(
            "[piston]",
            "contact = 'cone'\ncontact_shear_modulus = 1e9\nfriction = 0.4\n[piston]",
        ),
        POROUS.replace("pressure = 1e9", "speed = 10\nduration = 1e-5\nprofile_time = 2e-5"),
        POROUS.replace("yield_stress = 4e7\n", ""),
        RUN.replace("friction = 0.5", "friction = 0.5\nbulk_viscosity = 2\ndashpot = 'parallel'"),
        RUN.replace("friction = 0.5", "friction = 0.5\nshear_viscosity = 2"),
    ] {
        let case = parse(&text).unwrap();
        assert!(case.material.contacts.is_some());
        let again = parse(&case.to_toml()).unwrap();
        assert_eq!(case, again, "{}", case.to_toml());
        assert_eq!(case.to_toml(), again.to_toml());
    }
    let case = parse(POROUS).unwrap();
    let Some(ContactMedium::Porous { porosity, contact_cone, intensity_coefficient, .. }) =
        case.material.contacts
    else {
        panic!("{case:?}")
    };
    let own = case.plane_wave.unwrap();
    assert_eq!((porosity, contact_cone, intensity_coefficient), (0.01, None, 0.375));
    assert_eq!(own.piston.unwrap().load, PistonLoadValue::Pressure(1e9));
    let own = parse(GRANULAR).unwrap().plane_wave.unwrap();
    assert_eq!(own.piston.unwrap().loosening, 0.01);
    assert_eq!(own.spall.unwrap().shape, SpallShape::Triangle);
}

/// A region without contacts beside a granular medium.
const RUN: &str = "
[model]
kind = 'classical'
lambda = 1
mu = 1
density = 1
[granular]
friction = 0.5
[grid]
cells = [9, 9]
spacing = 1
[time]
duration = 1
[[region]]
shape = 'layer'
axis = 2
from = 0
to = 4
contacts = 'none'
[[region]]
shape = 'rest'
";

#[test]
fn regions_inherit_contacts_unless_they_have_none() {
    let case = parse(RUN).unwrap();
    let run = case.solid_run.as_ref().unwrap();
    let contacts: Vec<bool> =
        run.regions.iter().map(|region| region.material.contacts.is_some()).collect();
    assert_eq!(contacts, [false, true]);
    let scheme = run.scheme;
    assert_eq!(scheme.reconstruction, wellposed_cases::dynamics::ReconstructionScheme::Eno2);
    assert_eq!(scheme.splitting, wellposed_cases::dynamics::DimensionalSplitting::TwoCyclic);
}

#[test]
fn wrong_sections_are_refused_with_line_and_key() {
    for (text, old, new, expected) in [
        (POROUS, "porosity = 0.01", "porosity = 1", "x.toml:8: porous.porosity: found 1; expected"),
        (POROUS, "porosity = 0.01", "porosity = -0.1", "x.toml:8: porous.porosity: found -0.1;"),
        (POROUS, "= 4e9", "= -4e9", "x.toml:10: porous.contact_bulk_modulus: found -4e9;"),
        (POROUS, "= 4e7", "= 0", "x.toml:9: porous.yield_stress: found 0;"),
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
        (POROUS, "pressure = 1e9", "pressure = 0", "x.toml:12: piston.pressure: found 0;"),
        (
            POROUS,
            "[piston]",
            "friction = 0.5\n[piston]",
            "x.toml:11: porous.friction: found, but not used here; leave it out: it is used with contact cone",
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
            "x.toml:11: spall: not used by a porous",
        ),
        (
            POROUS,
            "[piston]",
            "[yield]\nkind = 'von-mises'\nstrength = 1\n[piston]",
            "x.toml:11: yield: found beside [porous];",
        ),
        (
            RUN,
            "[time]",
            "[scheme]\norder = 'fourth-order'\n[time]",
            "scheme.order: found 'fourth-order'; expected 'eno2' or 'godunov': granular and porous media",
        ),
        (
            RUN,
            "[time]",
            "[initial_stress]\nsigma11 = 1\n[time]",
            "x.toml:12: initial_stress: found beside a granular or porous medium;",
        ),
        (
            RUN,
            "[time]",
            "[[initial]]\nkind = 'uniform'\nshape = 'everywhere'\nfield = 'sigma11'\namplitude = 1\n[time]",
            "x.toml:13: initial[0].kind: an initial stress beside a granular or porous medium;",
        ),
        (
            RUN,
            "duration = 1",
            "duration = 1\ncourant_of = 's'",
            "time.courant_of: found beside a granular or porous medium;",
        ),
        (
            POROUS,
            "kind = 'classical'",
            "kind = 'reduced-cosserat'\nalpha = 1e9\ninertia = 1",
            "porous: not used by the model reduced-cosserat;",
        ),
        (GRANULAR, "friction = 0.5", "friction = -0.5", "x.toml:8: granular.friction: found -0.5;"),
        (
            GRANULAR,
            "friction = 0.5",
            "friction = 0.5\ndashpot = 'parallel'",
            "x.toml:9: granular.dashpot: found 'parallel' for particles without viscosity; add shear_viscosity",
        ),
        (
            GRANULAR,
            "friction = 0.5",
            "friction = 0.5\nshear_viscosity = 1\ndashpot = 'paralel'",
            "x.toml:10: granular.dashpot: found 'paralel'; did you mean 'parallel'?",
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
    assert!(
        error.starts_with(
            "x.toml:7: porous: not used here: this command takes solids without contacts and pores; "
        ),
        "{error}"
    );
    let elastic = &POROUS[..POROUS.find("[porous]").unwrap()];
    let case = parse(elastic).unwrap();
    assert!(case.check_without_contacts().is_ok());
    let error = case.require_plane_wave().unwrap_err().to_string();
    assert!(error.starts_with("x.toml: porous: missing; add a section [porous]"), "{error}");
}
