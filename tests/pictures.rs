//! Tests of the options of pictures, and of the verb `plot` for every verb that draws.

use crate::support::{NO_CHECKPOINTS, create_run_options};
use figures::{AnimationFormat, FigureFormat, FigureOptions};
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
    let animations = vec![AnimationFormat::Gif, AnimationFormat::Apng];
    let formats = vec![FigureFormat::Png, FigureFormat::Pdf];
    PictureOptions { formats, has_page: true, figure, animations, ..PictureOptions::default() }
}

/// Reads the pictures of a folder by name.
fn read_pictures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_picture = |path: &std::path::PathBuf| {
        path.extension().is_some_and(|own| {
            ["png", "svg", "pdf", "gif", "apng", "html"].iter().any(|name| own == *name)
        })
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
    let mut names = [names, &["report.html"]].concat();
    names.sort_unstable();
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
        &["animation.apng", "animation.gif", "ledger.pdf", "ledger.png", "run.pdf", "run.png"],
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
    assert_eq!(read_pictures(&out).len(), 7);
    let animations = PictureOptions { animations: Vec::new(), ..small_pictures() };
    cli::run_simulation(
        &Options { pictures: animations, ..options },
        NO_CHECKPOINTS,
        &mut Vec::new(),
    )
    .unwrap();
    assert!(read_pictures(&out).keys().all(|name| !name.starts_with("animation")));
}

/// Frames of an animation: width, time for which all are shown, s, and pixels of each, three bytes each.
struct Frames {
    width: usize,
    total_time: f64,
    frames: Vec<Vec<u8>>,
}

impl Frames {
    fn from_gif(bytes: &[u8]) -> Self {
        let mut decoder = gif::DecodeOptions::new().read_info(bytes).unwrap();
        let palette = decoder.global_palette().unwrap().to_vec();
        let width = usize::from(decoder.width());
        let mut all = Self { width, total_time: 0.0, frames: Vec::new() };
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let colour = |index: &u8| palette[3 * usize::from(*index)..][..3].to_vec();
            all.total_time += 0.01 * f64::from(frame.delay);
            all.frames.push(frame.buffer.iter().flat_map(colour).collect());
        }
        all
    }

    fn from_apng(bytes: &[u8]) -> Self {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let width = reader.info().width as usize;
        let mut canvas = vec![0; 3 * width * reader.info().height as usize];
        let mut all = Self { width, total_time: 0.0, frames: Vec::new() };
        for _ in 0..reader.info().animation_control().unwrap().num_frames {
            let mut part = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut part).unwrap();
            let frame = *reader.info().frame_control().unwrap();
            let lines = part[..info.buffer_size()].chunks_exact(info.line_size);
            for (row, line) in (frame.y_offset as usize..).zip(lines) {
                let start = 3 * (row * width + frame.x_offset as usize);
                canvas[start..start + line.len()].copy_from_slice(line);
            }
            all.total_time += f64::from(frame.delay_num) / f64::from(frame.delay_den);
            all.frames.push(canvas.clone());
        }
        all
    }

    /// Returns the first rows of all bands of dark rows in the middle third of a frame.
    fn dark_rows(&self, frame: usize) -> Vec<usize> {
        let is_dark = |row: &[u8]| row[self.width..2 * self.width].iter().all(|byte| *byte < 160);
        let dark: Vec<usize> = self.frames[frame]
            .chunks_exact(3 * self.width)
            .enumerate()
            .filter_map(|(index, row)| is_dark(row).then_some(index))
            .collect();
        dark.iter().copied().filter(|row| *row == 0 || !dark.contains(&(row - 1))).collect()
    }
}

/// Animations of few snapshots last 5 s or longer; every frame shows the border between two materials.
#[test]
fn animations_have_their_length_and_borders() {
    let case = format!(
        "{RUN}
[[region]]
shape = 'layer'
axis = 2
from = 0
to = 5
model = {{ lambda = 2e8, mu = 2e8, density = 2000 }}
[[region]]
shape = 'rest'
"
    );
    let folder = tempfile::tempdir().unwrap();
    let options =
        Options { pictures: small_pictures(), ..create_run_options(folder.path(), &case) };
    cli::run_simulation(&options, NO_CHECKPOINTS, &mut Vec::new()).unwrap();
    let read = |name: &str| fs::read(folder.path().join("out").join(name)).unwrap();
    for frames in
        [Frames::from_gif(&read("animation.gif")), Frames::from_apng(&read("animation.apng"))]
    {
        assert!(frames.frames.len() == 5 && (frames.total_time - 5.0).abs() < 1e-9);
        assert_ne!(frames.frames[1], frames.frames[3]);
        // Nothing moves at first: the dark rows are the load on the upper edge, the border and the lower edge of the field.
        // The first row of the load is some rows above the edge.
        let [top, border, bottom] = frames.dark_rows(0)[..] else {
            panic!("{:?}", frames.dark_rows(0))
        };
        assert!((2 * border).abs_diff(top + bottom) <= 8, "{top} {border} {bottom}");
        assert!((1..5).all(|index| frames.dark_rows(index).contains(&border)));
    }
}

/// A run on one row of cells is a curve in its picture, in its animation, and when it is drawn again.
#[test]
fn rows_of_cells_are_curves() {
    let case = RUN.replace("[12, 10]", "[1, 40]");
    let folder = tempfile::tempdir().unwrap();
    let options =
        Options { pictures: small_pictures(), ..create_run_options(folder.path(), &case) };
    cli::run_simulation(&options, NO_CHECKPOINTS, &mut Vec::new()).unwrap();
    let out = folder.path().join("out");
    let drawn = read_pictures(&out);
    let shape = |name: &str| {
        let reader = png::Decoder::new(std::io::Cursor::new(&drawn[name][..])).read_info().unwrap();
        f64::from(reader.info().width) / f64::from(reader.info().height)
    };
    let with_heading = PictureOptions { figure: FigureOptions::default(), ..small_pictures() };
    cli::plot(&out, &with_heading, &mut Vec::new()).unwrap();
    let again = read_pictures(&out);
    assert!(drawn["animation.apng"] == again["animation.apng"]);
    // A ribbon would be twenty times as high as wide, with its colour bar beside it.
    let reader =
        png::Decoder::new(std::io::Cursor::new(&again["run.png"][..])).read_info().unwrap();
    let [width, height] = [reader.info().width, reader.info().height].map(f64::from);
    assert!((width / height - shape("animation.apng")).abs() < 0.01);
    assert!(width / height > 2.0, "{width} {height}");
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
