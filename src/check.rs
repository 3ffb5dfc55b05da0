//! `wellposed check`: what is measured in time is what the analysis predicts.
//!
//! The prediction comes from the linearised equations ([`analysis`]), the measurement from the solver
//! ([`dynamics`]); they share nothing but the numbers of the case. How far the solver may be off is not
//! chosen: `scheme` has the exact symbol of its step, whose complex frequencies are fitted as the measured
//! ones are; for flows the limit of small steps tells how far it may be off.

mod fit;
pub mod flow;
mod mean;
mod scheme;
pub mod solid;

pub use fit::Rate;

use crate::case::{Case, CaseError, Check, Kind, Parameter, Wave};
use crate::dispersion::{Kind as Waves, kinds};
use crate::output::{self, OutputError, ResultFolder};
use crate::solid::Solid;
use crate::words::{case_title, short};
use crate::{Error, Format, Options};
use figures::{Band, Branch, DispersionFigure};
use models::granular_flow::InputError;
use serde_json::{Value, json};
use solid::{Gap, OnGrid, Plan, Response, Row};
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A check that disagreed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{failed} of {all} {what} disagree")]
pub struct Disagreement {
    failed: usize,
    all: usize,
    what: &'static str,
}

/// How thorough a check is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All waves of the case, or the chosen ones.
    Full,
    /// One wave number in two directions: for many cases one after the other.
    Short,
}

/// What was found of one medium.
struct Checked {
    /// Where it is in the case; empty if it is everywhere.
    place: String,
    case: Case,
    rows: Vec<Row>,
    gaps: Vec<Gap>,
}

impl Checked {
    fn agrees(&self) -> bool {
        self.rows.iter().all(Row::agrees) && self.gaps.iter().all(|gap| gap.agrees)
    }
}

/// Runs the verb on a case, or on all cases in a folder.
///
/// # Errors
/// The case is wrong or has no solver, results cannot be written, or the check disagrees.
pub fn run(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()
        .map_err(|error| Error::Threads(error.to_string()))?;
    match options.case.is_dir() {
        true => of_folder(options, &pool, stdout),
        false => of_case(options, &pool, stdout),
    }
}

fn of_case(
    options: &Options,
    pool: &rayon::ThreadPool,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let subject = Subject::of(&case, Extent::Full)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    if options.dry_run {
        writeln!(stdout, "would {}", subject.plan())?;
        let is_drawn = !matches!(subject, Subject::Nothing(_));
        for name in output::CHECK[..4].iter().filter(|name| is_drawn || !is_picture(name)) {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }
    let found = pool.install(|| subject.check(&case, Extent::Full))?;
    let json = format!("{:#}\n", found.report(&case));
    let words = found.words(&case);
    folder.open()?;
    for (name, drawn) in found.pictures(&case)? {
        folder.write(name, &drawn)?;
    }
    folder.write("check.json", json.as_bytes())?;
    folder.write("check.txt", words.as_bytes())?;
    match options.format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            if !matches!(found, Found::Nothing(_)) {
                writeln!(stdout, "picture: {}", folder.path().join("check.png").display())?;
            }
        }
    }
    let [all, failed] = found.counts();
    disagreement(failed, all, "rows")
}

/// Most points along an axis of a grid on which a perturbation of a flow is refined.
const MOST_POINTS: usize = 4096;

/// What of a case is checked.
enum Subject {
    /// Media, and where they are.
    Solid(Vec<(String, Case)>),
    /// Waves, and grids on which a perturbation is refined.
    Flow { waves: Vec<flow::Wave>, grids: Vec<usize> },
    /// Nothing, since no solver takes the case: why.
    Nothing(String),
}

/// What was found.
enum Found {
    Solid(Vec<Checked>),
    Flow(flow::Checked),
    /// Not measurable: why.
    Nothing(String),
}

impl Subject {
    /// # Errors
    /// The case is wrong.
    fn of(case: &Case, extent: Extent) -> Result<Self, Error> {
        let Kind::Flow(_) = case.kind else {
            return Ok(match media(case).map_err(|error| case.locate(error))? {
                Ok(media) => Self::Solid(media),
                Err(error) => Self::Nothing(reason(case.locate(error))),
            });
        };
        in_range(case)?;
        case.model()?.background(&case.state()).map_err(|error| case.locate(error))?;
        if let Err(error) = case.closure().and(case.mean_flow()) {
            return Ok(Self::Nothing(reason(error)));
        }
        let (wave, asked) = (case.numbers.wave, case.check.clone().unwrap_or_default());
        let mut numbers =
            asked.numbers.unwrap_or_else(|| [1.0, 4.0, 16.0].map(|n| n * wave.number).to_vec());
        let mut directions = match asked.directions_deg {
            Some(directions) => directions,
            None => {
                let worst = flow::worst_direction_deg(case)?;
                let mut all = vec![wave.direction_deg];
                // The order of the short form.
                for other in worst.into_iter().chain([30.0, 105.0]) {
                    if all.iter().all(|own| (own - other).abs() > 1e-6) {
                        all.push(other);
                    }
                }
                all
            }
        };
        if extent == Extent::Short {
            numbers.truncate(1);
            directions.truncate(2);
        }
        let waves = directions.iter().flat_map(|&direction_deg| {
            numbers.iter().map(move |&number| flow::Wave { number, direction_deg })
        });
        let grids = asked.cells.unwrap_or_default();
        let refuse = |found: String, allowed: &str| {
            let allowed = allowed.to_owned();
            Err(case.locate(InputError { key: "check.cells", found, allowed }).into())
        };
        if !grids.is_empty() && case.flow.is_none() {
            let found = format!("{grids:?} without a perturbation");
            return refuse(found, "add [grid], [time] and [[initial]], or leave it out");
        }
        if let Some(odd) = grids.iter().find(|own| *own % 2 == 1 || **own > MOST_POINTS) {
            return refuse(odd.to_string(), "even numbers of points along each axis, up to 4096");
        }
        for kind in case.compare.iter().flatten().filter(|_| !grids.is_empty()) {
            case.for_kind(*kind).closure()?;
        }
        let grids = if extent == Extent::Full { grids } else { Vec::new() };
        Ok(Self::Flow { waves: waves.collect(), grids })
    }

    /// What would be done.
    fn plan(&self) -> String {
        match self {
            Self::Solid(media) => {
                let count: usize =
                    media.iter().map(|(_, own)| plan(own, Extent::Full).waves.len()).sum();
                format!("send all branches at {count} wave vectors")
            }
            Self::Nothing(reason) => format!("say that the case is not measurable: {reason}"),
            Self::Flow { waves, grids } if grids.is_empty() => {
                format!("follow waves of {} wave vectors", waves.len())
            }
            Self::Flow { waves, grids } => {
                format!(
                    "follow waves of {} wave vectors, and one perturbation on {} grids",
                    waves.len(),
                    grids.len()
                )
            }
        }
    }

    fn check(self, case: &Case, extent: Extent) -> Result<Found, Error> {
        Ok(match self {
            Self::Solid(media) => Found::Solid(check(media, extent)?),
            Self::Flow { waves, grids } => Found::Flow(flow::check(case, &waves, &grids)?),
            Self::Nothing(reason) => Found::Nothing(reason),
        })
    }
}

impl Found {
    /// Rows, and those that disagree.
    fn counts(&self) -> [usize; 2] {
        match self {
            Self::Nothing(_) => [0, 0],
            Self::Flow(own) => own.counts(),
            Self::Solid(all) => {
                let rows = || all.iter().flat_map(|own| &own.rows);
                let gaps = || all.iter().flat_map(|own| &own.gaps);
                let failed = rows().filter(|row| !row.agrees()).count()
                    + gaps().filter(|gap| !gap.agrees).count();
                [rows().count() + gaps().count(), failed]
            }
        }
    }

    /// Waves that were not measurable.
    fn unmeasured(&self) -> usize {
        match self {
            Self::Flow(own) => own.unmeasured().map_or(0, |found| found.0),
            Self::Solid(_) | Self::Nothing(_) => 0,
        }
    }

    /// The greatest difference of all waves, as part of the rate.
    fn worst(&self) -> f64 {
        match self {
            Self::Nothing(_) => 0.0,
            Self::Flow(own) => own.worst(),
            Self::Solid(all) => worst(&all.iter().flat_map(|own| &own.rows).collect::<Vec<_>>()),
        }
    }

    fn report(&self, case: &Case) -> Value {
        match self {
            Self::Nothing(reason) => json!({
                "model": case.medium().title(), "agrees": null, "not_measurable": reason,
            }),
            Self::Flow(own) => own.report(case),
            Self::Solid(all) => report(case, all),
        }
    }

    fn words(&self, case: &Case) -> String {
        match self {
            Self::Nothing(reason) => {
                let (title, medium) = (case_title(case), case.medium().title());
                format!("{title}\n{medium}\n\nnot measurable: {reason}\n")
            }
            Self::Flow(own) => own.words(case),
            Self::Solid(all) => words(case, all),
        }
    }

    /// Pictures by the names of their files.
    fn pictures(&self, case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        use figures::Format::{Png, Svg};
        let mut all = Vec::new();
        match self {
            Self::Nothing(_) => {}
            Self::Solid(checked) => {
                let figure = figure(case, &checked[0])?;
                all.push(("check.png", figure.draw(Png)?));
                all.push(("check.svg", figure.draw(Svg)?));
            }
            Self::Flow(checked) => {
                let figure = checked.figure(case)?;
                all.push(("check.png", figure.draw(Png)?));
                all.push(("check.svg", figure.draw(Svg)?));
                if let Some(figure) = checked.refinement_figure(case) {
                    all.push(("refinement.png", figure.draw(Png)?));
                    all.push(("refinement.svg", figure.draw(Svg)?));
                }
            }
        }
        Ok(all)
    }
}

fn disagreement(failed: usize, all: usize, what: &'static str) -> Result<(), Error> {
    match failed {
        0 => Ok(()),
        _ => Err(Disagreement { failed, all, what }.into()),
    }
}

/// Checks all cases in a folder in short; writes nothing.
fn of_folder(
    options: &Options,
    pool: &rayon::ThreadPool,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut files = Vec::new();
    collect(&options.case, &mut files)?;
    files.sort();
    if options.dry_run {
        writeln!(stdout, "would check {} cases; would write nothing", files.len())?;
        return Ok(());
    }
    let (mut list, mut failed, mut all) = (Vec::new(), 0, 0);
    for path in files {
        let case = Case::load(&path, &options.sets)?;
        let name = path.display().to_string();
        let found = Subject::of(&case, Extent::Short)
            .and_then(|subject| pool.install(|| subject.check(&case, Extent::Short)));
        let found = match found {
            Ok(Found::Nothing(reason)) => {
                if options.format == Format::Text {
                    writeln!(stdout, "{name:<56} not measurable: {reason}")?;
                }
                list.push(json!({ "case": name, "not_measurable": reason }));
                continue;
            }
            Ok(found) => found,
            Err(Error::Case(error)) => {
                (all, failed) = (all + 1, failed + 1);
                if options.format == Format::Text {
                    writeln!(stdout, "{name:<56} FAILS: {error}")?;
                }
                list.push(json!({ "case": name, "agrees": false, "failure": error.to_string() }));
                continue;
            }
            Err(error) => return Err(error),
        };
        let ([rows, wrong], worst) = (found.counts(), found.worst());
        let is_well = wrong == 0;
        all += 1;
        failed += usize::from(!is_well);
        if options.format == Format::Text {
            let verdict = if is_well { "agrees" } else { "DISAGREES" };
            let (worst, left) = (exponent(worst), unmeasured_words(found.unmeasured()));
            writeln!(stdout, "{name:<56} {rows:>3} waves, {worst} off: {verdict}{left}")?;
            stdout.flush()?;
        }
        list.push(json!({
            "case": name,
            "agrees": is_well,
            "waves": rows,
            "waves_not_measurable": found.unmeasured(),
            "greatest_difference": worst,
        }));
    }
    if options.format == Format::Json {
        writeln!(stdout, "{:#}", json!({ "agrees": failed == 0, "cases": list }))?;
    }
    disagreement(failed, all, "cases")
}

/// The case files in a folder and in those inside it.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), OutputError> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| OutputError::unreadable(folder, &error))?;
    for entry in entries {
        let path = entry.map_err(|error| OutputError::unreadable(folder, &error))?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "toml") {
            files.push(path);
        }
    }
    Ok(())
}

type Media = Vec<(String, Case)>;

/// The media of a solid that a solver takes, and where they are; or why no solver takes one of them.
///
/// # Errors
/// The case is wrong.
fn media(case: &Case) -> Result<Result<Media, InputError>, InputError> {
    let regions = case.dynamics.iter().flat_map(|dynamics| &dynamics.regions);
    let mut media: Vec<(String, Case)> = Vec::new();
    for (index, region) in regions.enumerate() {
        let own = &region.case;
        let is_same = |(_, other): &(String, Case)| {
            (own.medium(), own.numbers) == (other.medium(), other.numbers)
        };
        if !media.iter().any(is_same) {
            media.push((format!("region[{index}]"), own.clone()));
        }
    }
    if media.is_empty() {
        media.push((String::new(), case.clone()));
    }
    for (_, own) in &media {
        let solid = Solid::of(own)?;
        if let Err(error) = crate::run::medium(own, solid.dimensions) {
            return Ok(Err(error));
        }
        if let Some(plastic) = solid.plastic.filter(|plastic| plastic.rate > 0.0) {
            return Ok(Err(InputError {
                key: "yield.plastic_rate",
                found: format!("{:?}", plastic.rate),
                allowed: "waves are sent through backgrounds at rest: 0".to_owned(),
            }));
        }
    }
    Ok(Ok(media))
}

/// Why no solver takes a case.
fn reason(error: CaseError) -> String {
    match error {
        CaseError::Key { key, found, allowed, .. } => {
            format!("{key}: {found}; analysis alone ({allowed})")
        }
        other => other.to_string(),
    }
}

/// That products of a few numbers of a flow neither overflow nor vanish.
fn in_range(case: &Case) -> Result<(), CaseError> {
    const SIZES: std::ops::RangeInclusive<f64> = 1e-60..=1e60;
    let asked = case.check.iter().flat_map(|own| own.numbers.iter().flatten());
    let keys = Parameter::all().filter_map(|key| Some((key.key().name, key.get(&case.numbers)?)));
    let mut all = keys.chain(asked.map(|number| ("check.numbers", *number)));
    match all.find(|(_, value)| *value != 0.0 && !SIZES.contains(&value.abs())) {
        None => Ok(()),
        Some((key, value)) => {
            let (found, allowed) = (format!("{value:?}"), "0, or a size from 1e-60 to 1e60".into());
            Err(case.locate(InputError { key, found, allowed }))
        }
    }
}

/// Whether a result is a picture.
fn is_picture(name: &str) -> bool {
    name.ends_with(".png") || name.ends_with(".svg")
}

/// The waves of a medium and the grids.
pub fn plan(case: &Case, extent: Extent) -> Plan {
    let wave = case.numbers.wave;
    let solid = Solid::of(case);
    let own = solid.as_ref().ok().and_then(|solid| solid.elastic.own_wave_number());
    let dimensions = solid.as_ref().map_or(2, |solid| solid.dimensions);
    let yields = solid.is_ok_and(|solid| solid.plastic.is_some());
    let asked = case.check.clone().unwrap_or_default();
    let Check { numbers, directions_deg, cells } = asked;
    let mut numbers = numbers.unwrap_or_else(|| match own {
        // Long waves see another solid than short ones.
        Some(own) if !yields => [1.0, 0.25, 0.5, 2.0, 4.0].map(|part| part * own).to_vec(),
        Some(own) => vec![own],
        None => vec![wave.number],
    });
    let asked = directions_deg
        .map(|all| all.into_iter().map(|own| [own, wave.elevation_deg]).collect::<Vec<_>>());
    let mut directions = asked.unwrap_or_else(|| {
        let oblique: &[[f64; 2]] = match (dimensions, yields) {
            (2, false) => &[[30.0, 0.0], [0.0, 0.0], [105.0, 0.0]],
            (2, true) => &[[30.0, 0.0], [0.0, 0.0]],
            (_, false) => &[[30.0, 35.0], [0.0, 0.0], [105.0, -20.0]],
            (_, true) => &[[30.0, 0.0], [0.0, 0.0]],
        };
        let own = [wave.direction_deg, wave.elevation_deg];
        let others = oblique.iter().copied().filter(|other| *other != own);
        [own].into_iter().chain(others).collect()
    });
    if extent == Extent::Short {
        numbers.truncate(1);
        directions.truncate(2);
    }
    let waves = numbers.iter().flat_map(|&number| {
        directions.iter().map(move |&[direction_deg, elevation_deg]| Wave {
            number,
            direction_deg,
            elevation_deg,
            ..wave
        })
    });
    let default = if dimensions == 2 { vec![20, 30, 40] } else { vec![20, 25, 30] };
    let time = case.dynamics.as_ref().map(|dynamics| &dynamics.time);
    Plan {
        waves: waves.collect(),
        cells: cells.unwrap_or(default),
        courant: time.map_or(crate::case::dynamics::COURANT, |time| time.courant),
        rotation: time.map_or(30.0, |time| time.rotation_deg).to_radians(),
    }
}

fn check(media: Vec<(String, Case)>, extent: Extent) -> Result<Vec<Checked>, Error> {
    let checked = media.into_iter().map(|(place, case)| {
        let rows = solid::rows(&case, &case, &plan(&case, extent))?;
        let gaps = solid::gaps(&case, &rows)?;
        Ok(Checked { place, case, rows, gaps })
    });
    checked.collect()
}

/// The greatest difference of all rows in the limit of small cells, as part of the frequency.
fn worst(rows: &[&Row]) -> f64 {
    greatest(rows.iter().map(|row| row.difference().size()))
}

/// The greatest of some sizes; what is not a number is the greatest.
fn greatest(sizes: impl Iterator<Item = f64>) -> f64 {
    sizes.fold(0.0, |sum, own| if own <= sum { sum } else { own })
}

/// Says how many waves have no measurement, if there are any.
fn unmeasured_words(count: usize) -> String {
    if count == 0 { String::new() } else { format!("; {count} not measurable") }
}

/// A number by its size: `3.2e-7`.
fn exponent(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

fn grid_json(row: &Row, grid: &OnGrid) -> Value {
    json!({
        "cells": grid.cells,
        "frequency": grid.measured.frequency,
        "growth_rate": grid.measured.growth,
        "expected_frequency": grid.expected.frequency,
        "expected_growth_rate": grid.expected.growth,
        "difference": row.part(grid.measured).frequency,
        "tolerance": grid.tolerance,
        "agrees": grid.agrees(),
    })
}

fn report(case: &Case, checked: &[Checked]) -> Value {
    let row = |row: &Row| {
        let mut limit = grid_json(row, &row.limit);
        limit["cells"] = Value::Null;
        json!({
            "response": row.response.name(),
            "branch": row.branch,
            "wave": {
                "number": row.wave.number,
                "direction_deg": row.wave.direction_deg,
                "elevation_deg": row.wave.elevation_deg,
            },
            "predicted": { "frequency": row.predicted, "growth_rate": 0.0 },
            "limit": limit,
            "grids": row.grids.iter().map(|grid| grid_json(row, grid)).collect::<Vec<_>>(),
            "order": row.order(),
            "agrees": row.agrees(),
        })
    };
    let gap = |gap: &Gap| {
        json!({
            "polarisation": gap.polarisation,
            "from": gap.from,
            "to": gap.to,
            "nearest": gap.nearest,
            "agrees": gap.agrees,
        })
    };
    json!({
        "model": case.medium().title(),
        "agrees": checked.iter().all(Checked::agrees),
        "media": checked.iter().map(|own| json!({
            "place": own.place,
            "model": own.case.medium().title(),
            "agrees": own.agrees(),
            "rows": own.rows.iter().map(row).collect::<Vec<_>>(),
            "forbidden_bands": own.gaps.iter().map(gap).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "units": { "frequency": "rad/s", "growth_rate": "1/s", "tolerance": "rad/s", "number": "1/m" },
    })
}

fn words(case: &Case, checked: &[Checked]) -> String {
    let mut text = format!("{}\n", case_title(case));
    for own in checked {
        let place = if own.place.is_empty() { String::new() } else { format!("{}: ", own.place) };
        let _ = writeln!(text, "{place}{}", own.case.medium().title());
        let Some(first) = own.rows.first() else { continue };
        let cells: Vec<String> = first.grids.iter().map(|grid| grid.cells.to_string()).collect();
        let coarse = &cells[0];
        let _ = writeln!(
            text,
            "frequencies ω in rad/s; differences and growth rates γ as parts of ω; {} cells to a period \
             along each axis\n",
            cells.join(", ")
        );
        let _ = writeln!(
            text,
            "{:<42}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>6}",
            "",
            "predicted",
            "measured",
            "differs",
            "expected",
            "growth",
            "within",
            format!("at {coarse}"),
            "order",
        );
        let mut last: Option<Wave> = None;
        for row in &own.rows {
            let wave = row.wave;
            if last != Some(wave) {
                let up = match wave.elevation_deg {
                    0.0 => String::new(),
                    up => format!(", {}° above the plane", short(up)),
                };
                let (k, along) = (short(wave.number), short(wave.direction_deg));
                let _ = writeln!(text, "k = {k} 1/m at {along}°{up}");
                last = Some(wave);
            }
            let name = match row.response {
                Response::Elastic => row.branch.clone(),
                other => format!("{}: {}", other.name(), row.branch),
            };
            let (found, expected) = (row.difference(), row.expected_difference());
            let signed = |x: f64| if x == 0.0 { "0".into() } else { format!("{x:+.1e}") };
            let _ = writeln!(
                text,
                "  {:<40}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>6}  {}",
                name,
                digits(row.predicted),
                digits(row.limit.measured.frequency),
                signed(found.frequency),
                signed(expected.frequency),
                signed(found.growth),
                exponent(row.limit.tolerance / row.predicted),
                signed(row.part(row.grids[0].measured).frequency),
                row.order().map_or("–".into(), |order| format!("{order:.2}")),
                if row.agrees() { "agrees" } else { "DISAGREES" },
            );
        }
        for gap in &own.gaps {
            let at = |own: Option<f64>| own.map_or("none".to_owned(), digits);
            let _ = writeln!(
                text,
                "\nno {} waves between {} and {} rad/s: measured next to it {} and {}  {}",
                gap.polarisation,
                digits(gap.from),
                digits(gap.to),
                at(gap.nearest[0]),
                at(gap.nearest[1]),
                if gap.agrees { "agrees" } else { "DISAGREES" },
            );
        }
        let rows: Vec<&Row> = own.rows.iter().collect();
        let failed = rows.iter().filter(|row| !row.agrees()).count();
        let verdict = match failed {
            0 => "all agree".to_owned(),
            some => format!("{some} DISAGREE"),
        };
        let _ = writeln!(
            text,
            "\n{} waves, {} off at most: {verdict}",
            rows.len(),
            exponent(worst(&rows))
        );
    }
    text
}

/// A frequency with seven digits.
fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e6).contains(&size) => {
            let after = (6 - size.log10().floor() as i32).clamp(0, 9) as usize;
            format!("{x:.after$}")
        }
        _ => format!("{x:.5e}"),
    }
}

/// Phase speeds below this part of the greatest are zero: what stands still is not drawn.
const STILL: f64 = 1e-6;

/// Measured points on predicted curves: elastic ones of all directions, which are alike, where the solid is
/// isotropic; else of the first direction.
fn figure(case: &Case, checked: &Checked) -> Result<DispersionFigure, Error> {
    let own = &checked.case;
    let solid = Solid::of(own).map_err(|error| own.locate(error))?;
    let wave = checked.rows.first().map_or(own.numbers.wave, |row| row.wave);
    let greatest = checked.rows.iter().map(|row| row.wave.number).fold(0.0, f64::max);
    let speeds = checked.rows.iter().map(|row| row.predicted / row.wave.number);
    let greatest_speed = speeds.fold(0.0, f64::max);
    let is_isotropic = matches!(solid.elastic, crate::solid::Elastic::Isotropic(_));
    let responses: &[(Response, bool)] = match solid.plastic {
        None => &[(Response::Elastic, true)],
        Some(_) => &[(Response::Unloading, true), (Response::Loading, false)],
    };
    let (mut branches, mut bands) = (Vec::new(), Vec::new());
    for &(response, stays_elastic) in responses {
        let all: Vec<Waves> =
            kinds(&solid, &wave, greatest, stays_elastic).map_err(|error| error.locate(own))?;
        for kind in &all {
            for (index, curve) in kind.curves(1.05 * greatest).into_iter().enumerate() {
                let label = kind.label(index);
                let is_own = |row: &&Row| {
                    let is_along = (row.wave.direction_deg, row.wave.elevation_deg)
                        == (wave.direction_deg, wave.elevation_deg);
                    row.response == response
                        && row.branch == label
                        && (is_along || (is_isotropic && response != Response::Loading))
                };
                let measured = checked.rows.iter().filter(is_own);
                if curve.iter().all(|p| p.frequency <= STILL * p.number * greatest_speed) {
                    continue;
                }
                branches.push(Branch {
                    measured: measured
                        .map(|row| [row.wave.number, row.limit.measured.frequency])
                        .collect(),
                    label: match response {
                        Response::Elastic => label,
                        other => format!("{}: {label}", other.name()),
                    },
                    frequency: curve.iter().map(|p| [p.number, p.frequency]).collect(),
                    group_speed: Vec::new(),
                    growth: Vec::new(),
                });
            }
            let inner = kind.bands.iter().filter(|band| band.from > 0.0 && band.to.is_finite());
            bands.extend(inner.map(|band| Band {
                label: format!("no {} waves", kind.family.polarisation.name()),
                from: band.from,
                to: band.to,
            }));
        }
    }
    Ok(DispersionFigure {
        title: case_title(case),
        subtitle: format!(
            "{}: curves from the analysis, rings from the solver{}",
            own.medium().title(),
            if is_isotropic && solid.plastic.is_none() { ", all directions" } else { "" },
        ),
        k_label: "wave number k (1/m)".into(),
        frequency_label: "angular frequency ω (rad/s)".into(),
        speed_label: "phase speed ω/k (m/s)".into(),
        growth_label: String::new(),
        k_log: false,
        frequency_log: false,
        branches,
        bands,
        cutoffs: Vec::new(),
        speed_limits: Vec::new(),
    })
}
