//! Tests of the options of pictures, and of the verb `plot` for every verb that draws.

use crate::support::{NO_CHECKPOINTS, create_run_options};
use figures::{FigureFormat, FigureOptions};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use wellposed::cli::{self, CommandError, Options};
use wellposed::report::PictureOptions;
use wellposed::study::MapOptions;

const STATE_CASE: &str = include_str!("data/state.toml");

/// Short run of a solid on a few cells, with snapshots.
const RUN: &str = "
[model]
kind = 'classical'
lambda = 1e8
mu = 1e8
density = 2000
[grid]
cells = [12, 10]
spacing = 1
[time]
duration = 0.02
[[load]]
side = 'x2+'
field = 'sigma22'
amplitude = -1e5
time = { kind = 'pulse', duration = 0.01 }
[output]
snapshot_interval = 0.005
";

/// Small pictures without heading: fast to draw, and other than the default ones.
fn small_pictures() -> PictureOptions {
    let figure = FigureOptions { dpi: Some(40.0), has_heading: false, ..FigureOptions::default() };
    PictureOptions { formats: vec![FigureFormat::Png, FigureFormat::Pdf], figure }
}

/// Reads the pictures of a folder by name.
fn read_pictures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_picture = |path: &std::path::PathBuf| {
        path.extension()
            .is_some_and(|own| ["png", "svg", "pdf", "gif"].iter().any(|name| own == *name))
    };
    entries
        .filter(is_picture)
        .map(|path| {
            (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap())
        })
        .collect()
}

/// Runs a verb on a case, given by name or text, removes its pictures, and checks that `plot` draws the same again.
fn check_redrawing(
    case: &str,
    verb: impl Fn(&Options) -> Result<(), CommandError>,
    names: &[&str],
) {
    let folder = tempfile::tempdir().unwrap();
    let mut options = create_run_options(folder.path(), case);
    if !case.contains('\n') {
        options.case_path = case.into();
    }
    options.pictures = small_pictures();
    verb(&options).unwrap();
    let out = folder.path().join("out");
    let drawn = read_pictures(&out);
    assert_eq!(drawn.keys().map(String::as_str).collect::<Vec<_>>(), names, "{case}");
    names.iter().for_each(|name| fs::remove_file(out.join(name)).unwrap());
    let mut printed = Vec::new();
    cli::plot(&out, &small_pictures(), &mut printed).unwrap();
    assert!(read_pictures(&out) == drawn, "{case}");
    assert!(String::from_utf8(printed).unwrap().contains(".png"));
    assert!(cli::folder::verify_folder(&out).unwrap().damaged_files.is_empty(), "{case}");
}

#[test]
fn plot_redraws_the_pictures_of_every_verb() {
    let ignore = &mut Vec::new;
    check_redrawing(
        STATE_CASE,
        |options| cli::run_point(options, &mut ignore()),
        &["directions.pdf", "directions.png", "growth.pdf", "growth.png", "polar.pdf", "polar.png"],
    );
    for map_options in [
        MapOptions::default(),
        MapOptions { computes_bound: true, ..MapOptions::default() },
        MapOptions { is_model_blind: true, ..MapOptions::default() },
    ] {
        check_redrawing(
            STATE_CASE,
            |options| cli::run_map(options, map_options, &mut ignore()),
            &["map.pdf", "map.png"],
        );
    }
    check_redrawing(
        "forbidden-band",
        |options| cli::run_dispersion(options, &mut ignore()),
        &["dispersion.pdf", "dispersion.png"],
    );
    check_redrawing(
        "creep",
        |options| cli::run_diagram(options, &mut ignore()),
        &["diagram.pdf", "diagram.png"],
    );
    check_redrawing(
        "flutter",
        |options| cli::run_speeds(options, &mut ignore()),
        &["speeds.pdf", "speeds.png"],
    );
    check_redrawing(
        "sand-compaction",
        |options| cli::run_shocks(options, &mut ignore()),
        &["shocks.pdf", "shocks.png"],
    );
    check_redrawing(
        "heat",
        |options| cli::run_check(options, &mut ignore()),
        &["check.pdf", "check.png"],
    );
    check_redrawing(
        RUN,
        |options| cli::run_simulation(options, NO_CHECKPOINTS, &mut ignore()),
        &["animation.gif", "ledger.pdf", "ledger.png", "run.pdf", "run.png"],
    );
}

/// Verifies that no picture is drawn if none is wanted, and that pictures can be drawn later.
#[test]
fn pictures_may_be_left_out_and_drawn_later() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        pictures: PictureOptions::no_pictures(),
        ..create_run_options(folder.path(), RUN)
    };
    let mut printed = Vec::new();
    cli::run_simulation(&options, NO_CHECKPOINTS, &mut printed).unwrap();
    let out = folder.path().join("out");
    assert!(read_pictures(&out).is_empty());
    let text = String::from_utf8(printed).unwrap();
    assert!(text.trim_end().ends_with(&format!("results: {}", out.display())), "{text}");
    cli::plot(&out, &small_pictures(), &mut Vec::new()).unwrap();
    assert_eq!(read_pictures(&out).len(), 5);
}

/// Verifies that results which do not follow from the case are not redrawn.
#[test]
fn changed_results_are_not_redrawn() {
    let folder = tempfile::tempdir().unwrap();
    let options =
        Options { pictures: small_pictures(), ..create_run_options(folder.path(), STATE_CASE) };
    cli::run_point(&options, &mut Vec::new()).unwrap();
    let report = folder.path().join("out/point.json");
    let text = fs::read_to_string(&report).unwrap();
    fs::write(&report, text.replace("well-posed", "ill-posed")).unwrap();
    let refused = cli::plot(&folder.path().join("out"), &small_pictures(), &mut Vec::new());
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("not what this version of the program computes"), "{message}");
}
