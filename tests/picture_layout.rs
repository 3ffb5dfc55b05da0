//! Layout of the pictures of the bundled cases: no text covers another text, a curve of data or a marked point, and none
//! extends beyond the picture. Numbers on discs mark their curves and may cover them. Points without area on a map, grid
//! lines, leader lines and hatching are no curves.

use figures::{FigureFormat, FigureOptions, FigureSize};
use wellposed::CASES;
use wellposed::case::{Case, TimeDomainRun};
use wellposed::report::{PictureOptions, Report, draw_pictures};
use wellposed::study::check::CheckExtent;
use wellposed::study::simulate::SimulationSettings;
use wellposed::study::{self, MapOptions, ignore_progress};

/// Pictures of studies with covering texts.
#[derive(Default)]
struct Layouts {
    checked: Vec<String>,
    covering: Vec<String>,
}

impl Layouts {
    /// Checks the pictures of a study, of the natural size and in a column of 85 mm, unless the case does not have the
    /// study.
    fn check<R: Report, E>(&mut self, case: &Case, found: Result<R, E>) {
        let Ok(found) = found else { return };
        let pictures = found.create_pictures(case).expect("pictures");
        for size in [None, Some(FigureSize::MillimetresWide(85.0))] {
            let figure =
                FigureOptions { size, lists_covering_texts: true, ..FigureOptions::default() };
            let options = PictureOptions {
                formats: vec![FigureFormat::Svg],
                has_page: false,
                figure,
                animations: Vec::new(),
                ..PictureOptions::default()
            };
            draw_pictures(&pictures, &options, |name, list| {
                let place = format!("{} {}/{name} {size:?}", case.name, R::NAME);
                let list = String::from_utf8_lossy(list);
                self.covering.extend(list.lines().map(|line| format!("{place}: {line}")));
                self.checked.push(place);
                Ok::<(), wellposed::Error>(())
            })
            .expect("layouts");
        }
    }
}

fn parse((path, text): (&str, &str), settings: &[&str]) -> Case {
    let settings: Vec<String> = settings.iter().map(|own| (*own).to_owned()).collect();
    Case::parse(text, path, &settings).expect("a bundled case")
}

/// Checks the pictures of all studies but maps of the bundled cases that `is_selected` selects.
fn check_studies(is_selected: impl Fn(&Case) -> bool) -> Layouts {
    let mut layouts = Layouts::default();
    for own in CASES.iter().copied() {
        let case = parse(own, &[]);
        if !is_selected(&case) {
            continue;
        }
        layouts.check(&case, study::compute_diagram(&case));
        layouts.check(&case, study::compute_shocks(&case));
        layouts.check(&case, study::analyse_point(&case, &ignore_progress));
        layouts.check(&case, study::compute_speeds(&case, &ignore_progress));
        match case.has_joints() {
            true => layouts.check(&case, study::compute_bloch_waves(&case, &ignore_progress)),
            false => layouts.check(&case, study::compute_dispersion(&case, &ignore_progress)),
        }
    }
    layouts
}

/// Whether the studies of a case take long: in space, or the bands of blocks.
fn is_expensive(case: &Case) -> bool {
    case.has_joints() || case.equations.is_some() || case.material.numbers.dimensions == 3
}

#[test]
fn texts_of_studies_cover_nothing() {
    let Layouts { checked, covering } = check_studies(|case| !is_expensive(case));
    assert!(covering.is_empty(), "{covering:#?}");
    assert!(checked.len() > 50, "{checked:?}");
}

#[test]
#[ignore = "a minute: studies in space, and bands of blocks"]
fn texts_of_expensive_studies_cover_nothing() {
    let Layouts { checked, covering } = check_studies(is_expensive);
    assert!(covering.is_empty(), "{covering:#?}");
    assert!(checked.len() > 50, "{checked:?}");
}

/// Checks the maps of the bundled cases on a few states; their texts do not depend on the number of states.
#[test]
fn texts_of_maps_cover_nothing() {
    let mut layouts = Layouts::default();
    for own in CASES.iter().copied().filter(|(_, text)| text.contains("\n[map]")) {
        let case = parse(own, &["map.x.points=6", "map.y.points=2"]);
        let found = study::compute_map(&case, MapOptions::default(), &ignore_progress);
        layouts.check(&case, found);
    }
    let Layouts { checked, covering } = layouts;
    assert!(covering.is_empty(), "{covering:#?}");
    assert!(checked.len() >= 28, "{checked:?}");
}

/// Checks the pictures of runs of a two-hundredth of the duration: fields with names, numbers and arrows, records and
/// ledgers.
fn check_runs(is_selected: impl Fn(&Case) -> bool) -> Layouts {
    let mut layouts = Layouts::default();
    for own in CASES.iter().copied() {
        let case = parse(own, &[]);
        let duration = match case.time_domain_run() {
            Ok(TimeDomainRun::Solid(run)) => run.time.duration,
            _ => continue,
        };
        if is_selected(&case) {
            let case = parse(own, &[&format!("time.duration={:e}", 0.005 * duration)]);
            let settings = SimulationSettings::default();
            layouts.check(&case, study::simulate(&case, settings, &ignore_progress));
        }
    }
    layouts
}

/// Whether a run has few cells.
fn is_small(case: &Case) -> bool {
    let grid = case.solid_run.as_ref().map(|run| &run.grid);
    grid.is_some_and(|grid| grid.cell_count() < 20_000)
}

#[test]
fn texts_of_small_runs_cover_nothing() {
    let Layouts { checked, covering } = check_runs(is_small);
    assert!(covering.is_empty(), "{covering:#?}");
    assert!(checked.len() >= 18, "{checked:?}");
}

#[test]
#[ignore = "a minute: runs of many cells, and checks"]
fn texts_of_runs_and_checks_cover_nothing() {
    let mut layouts = check_runs(|case| !is_small(case));
    for own in CASES.iter().copied() {
        let case = parse(own, &[]);
        if case.compared_kinds.is_none() && !is_expensive(&case) {
            let found = study::check_agreement(&case, CheckExtent::Short, &ignore_progress);
            layouts.check(&case, found);
        }
    }
    let Layouts { checked, covering } = layouts;
    assert!(covering.is_empty(), "{covering:#?}");
    assert!(checked.len() > 60, "{checked:?}");
}
