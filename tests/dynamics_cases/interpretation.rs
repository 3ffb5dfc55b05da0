//! Tests of the interpretation of templates, shapes, time functions and names.

use super::{PLANE_CASE, SPATIAL_CASE, parse_solid_run};
use crate::support::{parse_case, replace_first};
use models::registry;
use models::solid::parameters::Theory;
use wellposed::case::dynamics::{RegionShape, StateComponent, TimeFunction};
use wellposed::case::{MediumKind, ModelKind};
use wellposed::cli::new::{self, TemplateKind};

/// Key, line without comment mark, and whether the line is active, for a line of a template.
fn parse_template_line(line: &str) -> Option<(&str, &str, bool)> {
    let inner = line.strip_prefix("# ");
    let (line, is_active) = (inner.unwrap_or(line), inner.is_none());
    let is_key = |key: &str| key.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    let (key, _) = line.split_once(" = ").filter(|(key, _)| is_key(key))?;
    Some((key, line, is_active))
}

/// Verifies that the template of a run contains every key of a run, and that every entry of it is valid.
#[test]
fn run_template_contains_every_key() {
    for medium in
        MediumKind::all_media().filter(|medium| matches!(medium.kind, ModelKind::Solid(_)))
    {
        let text = new::generate_template(medium, TemplateKind::Simulation);
        parse_case(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    }
    let cosserat = MediumKind::from(ModelKind::Solid(registry::COSSERAT));
    let text = new::generate_template(cosserat, TemplateKind::Simulation);
    let (model, template) = text.split_at(text.find("\n[grid]\n").unwrap());
    // Blocks of the template: header; text of the section with its active lines (in a commented-out block, all lines),
    // without "3D only" lines; all parsed lines.
    let blocks = template.split("\n\n").map(str::trim).filter_map(|block| {
        let (header, lines) = block.split_once('\n')?;
        let (header, is_active) = match header.strip_prefix("# ") {
            Some(header) => (header, false),
            None => (header, true),
        };
        let header = header.split('#').next().unwrap().trim();
        let lines: Vec<_> = lines.lines().filter_map(parse_template_line).collect();
        let is_selected =
            |line: &(&str, &str, bool)| (line.2 || !is_active) && !line.1.contains("3D only");
        let selected =
            lines.iter().filter(|line| is_selected(line)).map(|line| format!("{}\n", line.1));
        let text = format!("{header}\n{}", selected.collect::<String>());
        header.starts_with('[').then_some((header, text, lines))
    });
    let blocks: Vec<_> = blocks.collect();
    let document = |header: &str, text: &str| {
        // The first form of each section: the rectangular grid.
        let others = ["[grid]", "[time]"].into_iter().filter(|other| *other != header);
        let others: String = others
            .filter_map(|other| blocks.iter().find(|block| block.0 == other))
            .map(|block| block.1.clone())
            .collect();
        format!("{model}\n{others}{text}")
    };
    let is_shown = |header: &str, key: &str| {
        blocks.iter().any(|block| block.0 == header && block.2.iter().any(|line| line.0 == key))
    };
    // Values or keys allowed in place of an invalid one, from the error message.
    let allowed = |header: &str, text: &str, before: &str| -> Vec<String> {
        let error = parse_case(&document(header, text)).expect_err(text);
        let (_, list) = error.split_once(before).unwrap_or_else(|| panic!("{error}"));
        list.split(", ").map(str::to_owned).collect()
    };
    // Sections of a blocky medium are alternatives to the grid, with alternatives among them; other tests verify them.
    let is_blocky = |header: &str| ["[[block]]", "[[joint]]"].contains(&header);
    // Loosening belongs to granular media, which have no spins.
    let is_of_solid = |text: &str| !text.contains("loosening");
    let solid_blocks = blocks.iter().filter(|own| !is_blocky(own.0) && is_of_solid(&own.1));
    for (header, text, lines) in solid_blocks {
        parse_case(&document(header, text)).unwrap_or_else(|error| panic!("{error}\n{text}"));
        if *header != "[initial_stress]" {
            for key in allowed(header, &format!("{text}odd = 0\n"), "allowed here: ") {
                assert!(is_shown(header, &key), "{key} is missing in {header}");
            }
        }
        // Keys whose values are names.
        for (key, line, _) in lines {
            let choices = ["kind", "shape", "order", "correction", "precision", "ledger"];
            if choices.contains(key) {
                let text = format!("{text}\n");
                let text = text.replace(&format!("{line}\n"), "") + &format!("{key} = 'odd'\n");
                for word in allowed(header, &text, "allowed: ") {
                    assert!(template.contains(&word), "{word} is missing for {key} in {header}");
                }
            }
        }
        for (_, line, _) in lines.iter().filter(|line| line.0 == "time" && !line.1.contains("file"))
        {
            let (start, _) = line.split_once(" }").unwrap();
            let source = "[[source]]\nkind = 'explosion'\namplitude = 1\nat = [0, -1]\n";
            parse_case(&document("", &format!("{source}{line}\n"))).unwrap();
            let odd = format!("{source}{start}, odd = 0 }}\n");
            for key in allowed("", &odd, "allowed here: ").iter().filter(|_| *header == "[[load]]")
            {
                assert!(start.contains(&format!("{key} = ")), "{key} is missing in {line}");
            }
        }
    }
    for key in ["elevation_deg", "about"] {
        assert!(is_shown("[[initial]]", key), "{key}");
    }
    for name in TimeFunction::NAMES {
        assert!(template.contains(&format!("time = {{ kind = \"{name}\", ")), "{name}");
    }
    assert!(template.contains("kind = \"table\", file ="));
}

#[test]
fn every_cell_has_one_medium() {
    let media =
        |text: &str| parse_solid_run(text).compute_cell_media().map_err(|error| error.to_string());
    let plane = media(PLANE_CASE).unwrap();
    let count = |medium: u16| plane.iter().filter(|cell| **cell == medium).count();
    // Expected are half of the grid, the cells with centres within 1.5 m of (2.5, 5), and the remaining cells.
    assert_eq!((plane.len(), count(0), count(1), count(2)), (200, 100, 12, 88));
    assert_eq!(plane[..11], [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2]);
    // Layers and half-spaces adjoin without gaps, although cell centres may be on the common plane.
    assert_eq!(media(SPATIAL_CASE).unwrap().iter().filter(|cell| **cell == 0).count(), 4 * 6 * 4);
    let (model, _) = SPATIAL_CASE.split_once("[[region]]").unwrap();
    let halves = format!(
        "{model}[[region]]\nshape = 'half-space'\npoint = [1.25, 0, 0]\nnormal = [-1, 0, 0]\n\
         [[region]]\nshape = 'half-space'\npoint = [1.25, 0, 0]\nnormal = [1, 0, 0]\n"
    );
    assert_eq!(media(&halves).unwrap()[..4], [0, 0, 1, 1]);
    assert_eq!(media(model).unwrap(), [0; 4 * 6 * 8]);

    let error = media(&replace_first(PLANE_CASE, "to = [0, 10]", "to = [1.5, 10]")).unwrap_err();
    let end = "region[1]: overlaps region[0] (folder/x.toml:30) in the cell at [1.25, 4.5]; regions must not overlap: move or shrink one of the two";
    assert_eq!(error, format!("folder/x.toml:35: {end}"));
    let text =
        replace_first(PLANE_CASE, "shape = 'rest'", "shape = 'box'\nfrom = [0, 0]\nto = [5, 4]");
    let error = media(&text).unwrap_err();
    let end = "region: no region contains the cell at [0.25, 4.5]; add [[region]] with shape = \
               \"rest\", or make the regions larger";
    assert_eq!(error, format!("folder/x.toml:30: {end}"));
    let error =
        media(&replace_first(PLANE_CASE, "center = [2.5, 5]", "center = [25, 5]")).unwrap_err();
    let end = "region[1]: contains no cell centre; make it larger than a cell, move it into the grid, or remove it";
    assert_eq!(error, format!("folder/x.toml:35: {end}"));
}

#[test]
fn shapes_contain_expected_points() {
    let ball = RegionShape::Ball { center: vec![0.0, 0.0], radius: 5.0 };
    assert!(ball.contains(&[3.0, 3.9]) && !ball.contains(&[3.0, 4.0]));
    let boxed = RegionShape::Box { lower_corner: vec![0.0, 0.0], upper_corner: vec![1.0, 2.0] };
    assert!(boxed.contains(&[0.0, 1.9]) && !boxed.contains(&[1.0, 1.0]));
    let layer = RegionShape::Layer { axis: 1, lower_coordinate: 0.0, upper_coordinate: 1.0 };
    assert!(layer.contains(&[9.0, 0.0]) && !layer.contains(&[9.0, 1.0]));
    let half =
        |normal: [f64; 2]| RegionShape::HalfSpace { point: vec![1.0, 1.0], normal: normal.into() };
    for normal in [[1.0, 1.0], [0.0, 2.0], [-1.0, 3.0]] {
        let [one, other] = [half(normal), half(normal.map(|n| -n))];
        for x in [[1.0, 1.0], [0.0, 2.0], [2.0, 1.0], [-3.0, 1.0]] {
            assert_ne!(one.contains(&x), other.contains(&x), "{normal:?} {x:?}");
        }
    }
    assert!(half([0.0, 1.0]).contains(&[0.0, 5.0]) && !half([0.0, 1.0]).contains(&[0.0, 0.0]));
    assert!(RegionShape::WholeGrid.contains(&[0.0, 0.0]));
}

#[test]
fn time_functions_have_expected_values() {
    let step = TimeFunction::Step { start: 1.0, duration: Some(2.0) };
    assert_eq!([0.9, 1.0, 2.9, 3.0].map(|t| step.evaluate(t)), [0.0, 1.0, 1.0, 0.0]);
    let step = TimeFunction::Step { start: 1.0, duration: None };
    assert_eq!([0.9, 1.0, 1e9].map(|t| step.evaluate(t)), [0.0, 1.0, 1.0]);
    let triangle = TimeFunction::Triangle { start: 1.0, duration: 4.0 };
    assert_eq!(
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|t| triangle.evaluate(t)),
        [0.0, 0.0, 0.5, 1.0, 0.5, 0.0]
    );
    let pulse = TimeFunction::Pulse { start: 1.0, duration: 4.0 };
    assert_eq!((pulse.evaluate(1.0), pulse.evaluate(3.0), pulse.evaluate(5.0)), (0.0, 1.0, 0.0));
    assert!((pulse.evaluate(2.0) - 0.5).abs() < 1e-15);
    let ricker = TimeFunction::Ricker { frequency: 10.0, delay: 0.15 };
    assert_eq!((ricker.evaluate(0.15), ricker.evaluate(1e300)), (1.0, 0.0));
    // The Ricker function (1 − 2x²) exp(−x²), x = π frequency (t − delay), vanishes at x² = ½.
    let zero = 0.15 + 0.5f64.sqrt() / (10.0 * std::f64::consts::PI);
    assert!(ricker.evaluate(zero).abs() < 1e-14);
    let sine = TimeFunction::Sine { frequency: 2.0, start: 1.0 };
    assert_eq!((sine.evaluate(0.9), sine.evaluate(1.125)), (0.0, 1.0));
    let table = TimeFunction::from_samples(vec![[1.0, 2.0], [2.0, 4.0], [4.0, -1.0]]).unwrap();
    let times = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 4.5];
    assert_eq!(times.map(|t| table.evaluate(t)), [0.0, 2.0, 3.0, 4.0, 1.5, -1.0, 0.0]);
    assert_eq!(TimeFunction::from_samples(vec![[1.0, 2.0], [1.0, 4.0]]), None);
    assert_eq!(TimeFunction::from_samples(vec![[1.0, 2.0]]), None);
}

#[test]
fn components_have_names_and_boundaries() {
    for theory in [Theory::Classical, Theory::Reduced, Theory::Cosserat] {
        for dimensions in [2, 3] {
            let components = StateComponent::all_components(theory, dimensions);
            for component in &components {
                let name = component.to_string();
                assert_eq!(
                    StateComponent::find_by_name(&name, theory, &components),
                    Some(*component),
                    "{name}"
                );
            }
        }
    }
    let face_names = |theory, dimensions, axis| {
        let components = StateComponent::face_components(theory, dimensions, axis);
        components.iter().map(StateComponent::to_string).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(face_names(Theory::Classical, 2, 0), "v1 v2 sigma11 sigma12");
    assert_eq!(face_names(Theory::Classical, 3, 1), "v1 v2 v3 sigma12 sigma22 sigma23");
    assert_eq!(face_names(Theory::Reduced, 2, 1), "v1 v2 sigma12 sigma22");
    assert_eq!(face_names(Theory::Cosserat, 2, 0), "v1 v2 w3 sigma11 sigma21 m31");
    assert_eq!(
        face_names(Theory::Cosserat, 3, 2),
        "v1 v2 v3 w1 w2 w3 sigma13 sigma23 sigma33 m13 m23 m33"
    );
}
