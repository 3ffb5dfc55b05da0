//! `wellposed check`: what is measured in time is what the analysis predicts.
//!
//! [`agreement`] holds prediction and measurement against each other; here stand the problems that a case states, and
//! the reports on their results.

pub mod flow;
mod flow_report;
mod report;
mod setup;
pub mod solid;

pub use setup::plan;

use crate::case::{Case, Kind, Wave};
use crate::output::{self, OutputError, ResultFolder};
use crate::report::format::case_title;
use crate::{Error, Format, Options};
use agreement::solids::{BandGap, BranchResult};
use figures::NoteFigure;
use models::elementary::Elementary;
use models::granular_flow::InputError;
use serde_json::{Value, json};
use setup::{Media, in_range, media, plan_of, reason};
use solid::Plan;
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

/// The results of one medium.
struct Checked {
    /// Where it is in the case; empty if it is everywhere.
    place: String,
    case: Case,
    plan: Plan,
    rows: Vec<BranchResult>,
    gaps: Vec<BandGap>,
}

impl Checked {
    /// The wave of a row.
    fn wave(&self, row: &BranchResult) -> Wave {
        self.plan.waves[row.wave]
    }

    /// Whether everything that was measured agrees; `None` where nothing was.
    fn agrees(&self) -> Option<bool> {
        let all: Vec<bool> = self.rows.iter().filter_map(BranchResult::agrees).collect();
        let gaps = self.gaps.iter().all(|gap| gap.agrees);
        (!all.is_empty()).then(|| gaps && all.into_iter().all(|own| own))
    }
}

/// What the verb finds of a case, as it stands in `check.json`.
///
/// # Errors
/// The case is wrong, or no solver takes its state.
pub fn report(case: &Case, extent: Extent) -> Result<Value, Error> {
    Ok(Subject::of(case, extent)?.check(case, extent)?.report(case))
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
        for name in &output::CHECK[..4] {
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
            writeln!(stdout, "picture: {}", folder.path().join("check.png").display())?;
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
        in_range(case)?;
        let Kind::Flow(_) = case.kind else {
            return Ok(match media(case).map_err(|error| case.locate(error))? {
                Ok(media) => Self::Solid(media),
                Err(error) => Self::Nothing(reason(case.locate(error))),
            });
        };
        case.model()?.background(&case.state()).map_err(|error| case.locate(error))?;
        if let Err(error) = case.rotation_in_time().and(case.mean_flow()) {
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
            case.for_kind(*kind).rotation_in_time()?;
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
            Self::Solid(media) => Found::Solid(check(case, media, extent)?),
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
                let failed = rows().filter(|row| row.agrees() == Some(false)).count()
                    + gaps().filter(|gap| !gap.agrees).count();
                [rows().count() + gaps().count(), failed]
            }
        }
    }

    /// Waves that were not measurable.
    fn unmeasured(&self) -> usize {
        match self {
            Self::Flow(own) => own.unmeasured(),
            Self::Solid(all) => all.iter().map(|own| unmeasured(&own.rows)).sum(),
            Self::Nothing(_) => 0,
        }
    }

    /// The greatest difference of the measured waves, as part of the rate; `None` where nothing was measured.
    fn worst(&self) -> Option<f64> {
        match self {
            Self::Nothing(_) => None,
            Self::Flow(own) => own.worst(),
            Self::Solid(all) => worst(all.iter().flat_map(|own| &own.rows)),
        }
    }

    fn report(&self, case: &Case) -> Value {
        match self {
            Self::Nothing(reason) => json!({
                "model": case.medium().title(), "agrees": null, "not_measurable": reason,
            }),
            Self::Flow(own) => own.report(case),
            Self::Solid(all) => report::report(case, all),
        }
    }

    fn words(&self, case: &Case) -> String {
        match self {
            Self::Nothing(reason) => {
                let (title, medium) = (case_title(case), case.medium().title());
                format!("{title}\n{medium}\n\nnot measurable: {reason}\n")
            }
            Self::Flow(own) => own.words(case),
            Self::Solid(all) => report::words(case, all),
        }
    }

    /// Pictures by the names of their files.
    fn pictures(&self, case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        use figures::Format::{Png, Svg};
        let mut all = Vec::new();
        match self {
            Self::Nothing(reason) => {
                let (title, subtitle) = (case_title(case), case.medium().title().to_owned());
                let text = format!("not measurable: {reason}");
                let figure = NoteFigure { title, subtitle, text };
                all.push(("check.png", figure.draw(Png)?));
                all.push(("check.svg", figure.draw(Svg)?));
            }
            Self::Solid(checked) => {
                let figure = report::figure(case, &checked[0])?;
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
            let left = unmeasured_words(found.unmeasured());
            let verdict = match (worst, is_well) {
                (None, _) => "nothing measured".to_owned(),
                (Some(worst), true) => format!("{} off: agrees", exponent(worst)),
                (Some(worst), false) => format!("{} off: DISAGREES", exponent(worst)),
            };
            writeln!(stdout, "{name:<56} {rows:>3} waves, {verdict}{left}")?;
            stdout.flush()?;
        }
        list.push(json!({
            "case": name,
            "agrees": worst.map(|_| is_well),
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
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && path.file_name().is_none_or(|name| name != "Cargo.toml")
        {
            // The manifest of a crate beside cases is none of them.
            files.push(path);
        }
    }
    Ok(())
}

fn check(whole: &Case, media: Media, extent: Extent) -> Result<Vec<Checked>, Error> {
    let checked = media.into_iter().map(|(place, case)| {
        let plan = plan_of(whole, &case, extent);
        let rows = solid::rows(&case, &case, &plan)?;
        let gaps = solid::gaps(&case, &plan, &rows)?;
        Ok(Checked { place, case, plan, rows, gaps })
    });
    checked.collect()
}

/// The greatest difference of all rows in the limit of small cells, as part of the frequency.
fn worst<'a>(rows: impl Iterator<Item = &'a BranchResult>) -> Option<f64> {
    greatest(rows.filter_map(|row| Some(row.difference()?.max_norm())))
}

/// Rows without a measurement.
fn unmeasured(rows: &[BranchResult]) -> usize {
    rows.iter().filter(|row| row.measured.is_err()).count()
}

/// The greatest of some sizes; what is not a number is the greatest.
fn greatest(sizes: impl Iterator<Item = f64>) -> Option<f64> {
    sizes.reduce(|sum, own| if own <= sum || sum.is_nan() { sum } else { own })
}

/// How far the measured waves are off, if there are any.
fn worst_words(worst: Option<f64>) -> String {
    worst.map_or("nothing measured".to_owned(), |own| format!("{} off at most", exponent(own)))
}

/// Says how many waves have no measurement, if there are any.
fn unmeasured_words(count: usize) -> String {
    if count == 0 { String::new() } else { format!("; {count} not measurable") }
}

/// A number by its size: `3.2e-7`.
fn exponent(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// A frequency with seven digits.
fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e6).contains(&size) => {
            let after = (6 - size.cr_log10().floor() as i32).clamp(0, 9) as usize;
            format!("{x:.after$}")
        }
        _ => format!("{x:.5e}"),
    }
}
