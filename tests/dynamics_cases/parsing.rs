//! Tests of parsing time-domain sections in all notations.

use super::{PLANE_CASE, SPATIAL_CASE, parse_solid_run};
use crate::support::{parse_case, parse_case_with, replace_first};
use models::registry;
use models::solid::parameters::Isotropic;
use wellposed::case::dynamics::{
    BoundaryConditionKind, BoundaryFace, InitialStateTerm, Kernel, LoadedArea, PlottedQuantity,
    PulseCentre, RecordedQuantity, SourceKind, StateComponent, TimeFunction,
};
use wellposed::case::{Case, Material, ModelKind, YieldSetKind};
use wellposed::cli::{self, Options};
use wellposed::setup;

#[test]
fn case_is_parsed_as_written() {
    let dynamics = parse_solid_run(PLANE_CASE);
    assert_eq!(dynamics.grid.axis_bounds(0), [-5.0, 5.0]);
    assert_eq!((dynamics.grid.cell_count(), dynamics.time.courant_number), (200, 0.9));
    assert_eq!(dynamics.scheme.reconstruction.name(), "godunov");
    assert_eq!(dynamics.scheme.return_mapping_order.name(), "first-order");
    let names =
        |list: &[StateComponent]| list.iter().map(StateComponent::to_string).collect::<Vec<_>>();
    let BoundaryConditionKind::Mixed { fixed_components } =
        &dynamics.boundary_conditions[1].condition
    else {
        panic!()
    };
    assert_eq!(names(fixed_components), ["v2", "w3"]);
    assert_eq!(
        dynamics.loads[1].loaded_area,
        LoadedArea::Point { position: vec![0.5], kernel: Kernel::Bell { radius: 0.25 } }
    );
    assert_eq!(
        dynamics.loads[1].time_function,
        TimeFunction::Ricker { frequency: 30.0, delay: 1.5 / 30.0 }
    );
    assert_eq!(dynamics.loads[2].face, BoundaryFace { axis: 0, is_upper: false });
    assert_eq!(dynamics.sources[1].kind, SourceKind::Couple(vec![7.0]));
    assert!(matches!(
        dynamics.initial_terms[1],
        InitialStateTerm::Pulse { centre: PulseCentre::Plane { axis: 1, coordinate: 3.0 }, .. }
    ));
    assert!(matches!(dynamics.initial_terms[3], InitialStateTerm::Rotation { axis: 2, .. }));
    let stresses: Vec<(String, f64)> =
        dynamics.initial_stress.iter().map(|(c, value)| (c.to_string(), *value)).collect();
    let expected = [
        ("sigma11", -1e5),
        ("sigma12", 0.0),
        ("sigma21", 0.0),
        ("sigma22", 0.0),
        ("sigma33", -2e5),
        ("m31", 4.0),
        ("m32", 0.0),
        ("m13", 0.0),
        ("m23", 0.0),
    ];
    assert_eq!(stresses, expected.map(|(name, value)| (name.to_owned(), value)));
    let gravity = dynamics.gravity.unwrap();
    assert!(gravity.is_balanced && gravity.lateral_ratio == 0.5);
    assert_eq!(dynamics.receivers[0].name, "r1");
    assert_eq!(dynamics.receivers[0].fields.len(), 12);
    let recorded = |list: &[RecordedQuantity]| {
        list.iter().map(RecordedQuantity::to_string).collect::<Vec<_>>()
    };
    assert_eq!(recorded(&dynamics.receivers[1].fields), ["v1", "sigma21"]);
    assert!(matches!(dynamics.output.plotted_quantity, PlottedQuantity::Component(_)));
    assert_eq!(dynamics.output.contour_levels, Some(vec![-1.0, 0.5]));

    // Time integrals are recorded at receivers that request them, or at receivers without a list of fields.
    let sets = ["output.integrals=['u2']", "receiver[1].fields=['u2', 'v1']"];
    let dynamics = parse_case_with(PLANE_CASE, &sets).unwrap().solid_run.unwrap();
    assert_eq!(recorded(&dynamics.receivers[0].fields).last().unwrap(), "u2");
    assert_eq!(recorded(&dynamics.receivers[1].fields), ["u2", "v1"]);
    let error = parse_case_with(PLANE_CASE, &sets[1..]).unwrap_err();
    assert!(error.contains("receiver[1].fields: found 'u2'; did you mean 'v2'?"), "{error}");

    // The number of dimensions follows from the grid.
    let case = parse_case(PLANE_CASE).unwrap();
    assert_eq!(case.material.numbers.dimensions, 2);
    // A case without time-domain sections has no simulation.
    assert_eq!(
        parse_case(&wellposed::cli::new::generate_state_template(case.medium())).unwrap().solid_run,
        None
    );
}

#[test]
fn regions_inherit_missing_parameters() {
    let case = parse_case(PLANE_CASE).unwrap();
    let regions = &case.solid_run.as_ref().unwrap().regions;
    let modulus = |material: &Material| {
        let law = setup::solid::create_solid(material).unwrap().elastic_law;
        let solid = law.downcast::<Isotropic>().unwrap();
        [solid.lambda, solid.mu]
    };
    assert_eq!(modulus(&regions[0].material), [2e9, 3e9]);
    assert_eq!(modulus(&regions[1].material), [2e9, 1e9]);
    let sets: Vec<Option<YieldSetKind>> =
        regions.iter().map(|region| region.material.yield_set).collect();
    assert_eq!(sets, [Some(registry::COSSERAT_MISES), None, Some(registry::VON_MISES)]);
    assert_eq!(regions[0].material.numbers.yield_constants, case.material.numbers.yield_constants);
    let other = &regions[2].material.numbers.yield_constants;
    assert_eq!((other.value("strength"), other.value("friction")), (Some(5.0), None));

    // A region of another kind inherits no model parameters, but the yield set of the case if that kind can have it.
    let text = replace_first(
        PLANE_CASE,
        "yield = { kind = 'none' }",
        "model = { kind = 'reduced-cosserat', lambda = 1, mu = 1, alpha = 1, density = 1, \
         inertia = 1 }",
    );
    let other = &parse_solid_run(&text).regions[1].material;
    assert_eq!(other.kind, ModelKind::Solid(registry::REDUCED_COSSERAT));
    assert_eq!(other.yield_set, Some(registry::COSSERAT_MISES));
    assert_eq!((other.numbers.dimensions, other.numbers.model_constants.value("beta")), (2, None));
}

#[test]
fn resolved_case_parses_to_equal_case() {
    let spinning = SPATIAL_CASE
        .replacen("'classical'", "'cosserat'", 1)
        .replace("sigma31", "sigma13")
        .replace("sigma32", "sigma23")
        .replacen("mu =", "alpha = 1\nbeta = 1\ngamma = 1\neta = 1\ninertia = 1\nmu =", 1)
        + "[[initial]]
kind = 'rotation'
shape = 'layer'
axis = 1
from = 0
to = 1
about = 2
angle_deg = 3
[[source]]
kind = 'couple'
amplitude = [1, 2, 3]
at = [1, 1, 1]
time = { kind = 'step' }
";
    let spinning = spinning.replace("lambda = 0, mu = 5e8", "lambda = 0, mu = 5e8, density = 1");
    for text in [PLANE_CASE, SPATIAL_CASE, &spinning] {
        let case = parse_case(text).unwrap();
        let resolved = case.to_toml();
        let reparsed = parse_case(&resolved).unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(reparsed, case, "{resolved}");
        assert_eq!(reparsed.to_toml(), resolved);
        for default in ["correction = \"first-order\"", "start = 0.0", "fields = [\"v1\", \"v2\""] {
            assert!(resolved.contains(default), "{default} is missing in\n{resolved}");
        }
        // Cases with different time-domain sections are different.
        let other = parse_case_with(text, &["time.duration=7"]).unwrap();
        assert_ne!(other, case);
    }
}

#[test]
fn settings_reach_all_sections() {
    let case = parse_case_with(
        PLANE_CASE,
        &[
            "grid.cells=[40, 20]",
            "grid.spacing=[0.25, 0.5]",
            "time.duration=0.1",
            "load[0].amplitude=2e6",
            "load[2].time={ kind = 'step', start = 3 }",
            "load[2].time.start=4",
            "region[0].model.mu=1e9",
            "region[1].yield.kind=von-mises",
            "region[1].yield.strength=8",
            "output.picture=speed",
            "scheme.ledger=full",
            "boundary[0].kind=free",
            "receiver[0].name=here",
        ],
    )
    .unwrap();
    let dynamics = case.solid_run.unwrap();
    assert_eq!((dynamics.grid.cells, dynamics.time.duration), (vec![40, 20], 0.1));
    assert_eq!(dynamics.loads[0].amplitude, 2e6);
    assert_eq!(dynamics.loads[2].time_function, TimeFunction::Step { start: 4.0, duration: None });
    assert_eq!(dynamics.regions[0].material.numbers.model_constants.value("mu"), Some(1e9));
    assert_eq!(dynamics.regions[1].material.numbers.yield_constants.value("strength"), Some(8.0));
    assert_eq!(dynamics.output.plotted_quantity, PlottedQuantity::Speed);
    assert_eq!(dynamics.scheme.ledger_detail.name(), "full");
    assert_eq!(dynamics.boundary_conditions[0].condition, BoundaryConditionKind::Free);
    assert_eq!(dynamics.receivers[0].name, "here");
    // Options add missing sections to a case.
    let (model, _) = PLANE_CASE.split_once("[grid]").unwrap();
    let sets = ["grid.cells=[2,2]", "grid.spacing=1", "time.duration=1"];
    assert_eq!(parse_case_with(model, &sets).unwrap().solid_run.unwrap().grid.origin, [0.0, 0.0]);
}

#[test]
fn invalid_settings_are_refused() {
    for (set, message) in [
        ("load[3].amplitude=1", "load: found the index 3; expected an index from 0 to 2"),
        (
            "load.amplitude=1",
            "load: found no index for a list of 3; expected load[i] with an index from 0 to 2",
        ),
        ("grid[0].cells=1", "grid: found the index 0; expected grid.KEY: grid is not a list"),
        (
            "grid.cells[0]=1",
            "grid.cells: found the index 0; expected grid.cells=VALUE: set the value as a whole",
        ),
        (
            "grid.cells.x=1",
            "grid.cells: found a key inside a value; expected grid.cells=VALUE: set the value as a whole",
        ),
        (
            "load[x].at=1",
            "load[x].at: found no key; expected section.key or section[0].key, the index counted from 0",
        ),
        (
            "load[0]=1",
            "load[0]: found 1; expected load[0].KEY, or a table in braces { key = value }",
        ),
        ("grid=1", "grid: found 1; expected a section [grid]"),
        ("load=1", "load: found 1; expected sections [[load]]"),
        (
            "time.courant=1.5",
            "time.courant: found 1.5; expected a number above 0 and at most 1 (Courant \
             number): a sweep is unstable above 1",
        ),
        (
            "load[2].time={ kind = 'step', stat = 3 }",
            "load[2].time.stat: unknown key; did you mean 'start'? allowed here: kind, start, \
             duration",
        ),
        (
            "region[1].model.mv=1",
            "region[1].model.mv: unknown key; did you mean 'mu'? allowed here: kind, dimensions, \
             lambda, mu, alpha, beta, gamma, eta, density, inertia",
        ),
        (
            "grid.cells=[3]",
            "grid.cells: found [3]; expected a list of 2 or 3 whole numbers of at least 1 (cells along each axis)",
        ),
    ] {
        let error = parse_case_with(PLANE_CASE, &[set]).expect_err(set);
        assert_eq!(error, format!("--set {set}: {message}"));
    }
    let flow = wellposed::cli::new::generate_state_template(ModelKind::flow_kinds()[0]);
    let error = parse_case_with(&flow, &["grid.spacing=1"]).unwrap_err();
    let start =
        "--set grid.spacing=1: grid.spacing: not used by a flow; give length, the edge lengths of";
    assert!(error.starts_with(start), "{error}");
    let error = parse_case_with(SPATIAL_CASE, &["receiver[1].at=[0,0,0]"]).unwrap_err();
    assert!(
        error.ends_with(
            "receiver: found the index 1; expected the index 0: the list has one section"
        ),
        "{error}"
    );
    let (model, _) = PLANE_CASE.split_once("[grid]").unwrap();
    let error = parse_case_with(model, &["load[0].at=1"]).unwrap_err();
    let end = "load: found the index 0, but there is no [[load]]; add a section [[load]] to the case file";
    assert_eq!(error, format!("--set load[0].at=1: {end}"));
}

#[test]
fn tables_are_read_relative_to_case() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let table = folder.path().join("data/load.csv");
    let old = "time = { kind = 'triangle', duration = 0.01 }";
    let text = replace_first(PLANE_CASE, old, "time = { kind = 'table', file = 'data/load.csv' }");
    let file = folder.path().join("x.toml");
    std::fs::write(&file, text).unwrap();
    let load = || Case::load(&file, &[]).map_err(|error| error.to_string());

    std::fs::write(&table, "# measured\n\ntime, value\n0, 1\n0.5,-2e3\n# more\n 1 , 0\n").unwrap();
    let case = load().unwrap();
    let TimeFunction::Table(samples) = &case.solid_run.as_ref().unwrap().loads[0].time_function
    else {
        panic!()
    };
    assert_eq!(samples.samples(), [[0.0, 1.0], [0.5, -2e3], [1.0, 0.0]]);
    let resolved = case.to_toml();
    // The resolved case contains the samples and does not depend on other files.
    let samples = "samples = [[0.0, 1.0], [0.5, -2000.0], [1.0, 0.0]]";
    assert!(resolved.contains(&format!("time = {{ kind = \"table\", {samples} }}")));
    let named = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, &resolved).unwrap();
    assert_eq!(load().unwrap(), case);
    std::fs::write(&file, named).unwrap();

    let table_name = table.display().to_string();
    for (content, line, end) in [
        ("0,1\n0,2\n", 2, "found the time 0 after 0; times must increase"),
        (
            "0,1\n1,x\n",
            2,
            "found '1,x'; expected two finite numbers separated by a comma, time in s and value",
        ),
        (
            "t,v\nt,v\n",
            2,
            "found 't,v'; expected two finite numbers separated by a comma, time in s and value",
        ),
        (
            "# a\n0,inf\n",
            2,
            "found '0,inf'; expected two finite numbers separated by a comma, time in s and value",
        ),
    ] {
        std::fs::write(&table, content).unwrap();
        assert_eq!(load().unwrap_err(), format!("{table_name}:{line}: load[0].time.file: {end}"));
    }
    for (content, end) in [
        (
            "0,1\n",
            "'data/load.csv' has 1 sample; expected at least two lines with time in s and value",
        ),
        ("", "'data/load.csv' has 0 samples; expected at least two lines with time in s and value"),
    ] {
        std::fs::write(&table, content).unwrap();
        let error = load().unwrap_err();
        assert!(error.ends_with(&format!(": load[0].time.file: {end}")), "{error}");
    }
    std::fs::write(&table, b"0,\xff\n").unwrap();
    assert!(load().unwrap_err().contains(": load[0].time.file: 'data/load.csv': not UTF-8 text; "));

    // Only regular files are opened: opening a pipe without a writer would block.
    let is_refused = |as_what: &str| {
        load().unwrap_err().contains(&format!("'data/load.csv': {as_what}; name a"))
    };
    std::fs::remove_file(&table).unwrap();
    std::fs::create_dir(&table).unwrap();
    assert!(is_refused("is a directory"));
    std::fs::remove_dir(&table).unwrap();
    if std::process::Command::new("mkfifo").arg(&table).status().is_ok_and(|made| made.success()) {
        assert!(is_refused("not a regular file"));
    }
}

#[test]
fn state_verbs_accept_time_domain_cases() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.toml");
    std::fs::write(&file, PLANE_CASE).unwrap();
    let options = Options { case_path: file, is_dry_run: true, ..Options::default() };
    cli::run_dispersion(&options, &mut std::io::sink()).unwrap();
    cli::run_point(&options, &mut std::io::sink()).unwrap();
}
