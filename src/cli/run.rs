//! `wellposed run`, and the code shared with `wellposed resume`.
//!
//! [`study::simulate`](mod@crate::study::simulate) computes; this module writes its output to files: rows are appended
//! to tables, snapshots are written one by one. A checkpoint holds the state and the lengths and checksums of tables
//! and snapshots; a resumed run writes the same bits as an uninterrupted run. The remaining results are written at the
//! end.

mod animation;
mod checkpoint;
mod checkpoint_timer;
mod free_memory;
mod page;
mod planned_files;
mod recorder;
mod run_files;

pub(super) use animation::{AnimationOutput, draw_animation};
pub(super) use checkpoint::{Checkpoint, OpenedState, create_part_sections};
pub(super) use page::create_page_section;
pub(super) use recorder::FileRecorder;
pub(super) use run_files::read_records;

use super::load::print_hints;
use super::signals::{self, ProgramStage};
use super::write::{
    CostEstimate, list_planned_paths, print_plan, print_report, refuse_or_warn, select_folder,
};
use crate::case::Case;
use crate::case::dynamics::SolidRun;
use crate::cli::folder::{FIELDS_ARCHIVE_FILE, PartFile, ResultFolder};
use crate::cli::options::{check_thread_start, create_thread_pool};
use crate::cli::parts::{FieldParts, write_field_archive};
use crate::cli::ranks::{RankRecorder, WaitingClock, require_all_ranks};
use crate::cli::{CommandError, Options, OutputFormat};
use crate::report::run::list_drawn_quantities;
use crate::report::{PictureOptions, RenderedReport};
use crate::study::decide_solid_verdict;
use crate::study::simulate::OutputFields;
use crate::study::simulate::{SimulationJob, create_job};
use dynamics::decomposition::communicator::Communicator;
use files::lock::Lock;
use free_memory::release_free_memory;
use std::io::{self, Write};
use std::num::NonZero;
use std::sync::Arc;

/// Default of the smallest wall time between two checkpoints, s.
pub const DEFAULT_CHECKPOINT_INTERVAL: f64 = 300.0;

/// Settings for the checkpoints of a run.
#[derive(Clone, Copy, Debug)]
pub struct CheckpointSettings {
    /// Smallest wall time between two checkpoints, s; 0 for a checkpoint after every batch of steps.
    pub interval: f64,
}

/// Runs the verb `run`: simulates a case in the time domain and writes the results.
///
/// # Errors
/// The case is invalid, memory is insufficient, the cost exceeds the limits, the equations are ill-posed, the folder
/// holds a finished or interrupted run or one in progress, the threads cannot be started, results cannot be written, or
/// the run was interrupted or stopped because of its state. `--force` lifts the limits of the cost and discards a
/// finished or interrupted run; `--accept-ill-posed` permits ill-posed equations.
pub fn run_simulation(
    options: &Options,
    checkpoint_settings: CheckpointSettings,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    match prepare_run(options, 1, stdout)? {
        Some((case, folder)) => {
            execute_prepared_run(options, (&case, &folder), checkpoint_settings, None, stdout)
        }
        None => Ok(()),
    }
}

/// Checks the case of a run in several processes and its results folder, and prints plan and warnings; `None` if that is all, by `--dry-run`.
pub(super) fn prepare_run(
    options: &Options,
    rank_count: usize,
    stdout: &mut dyn Write,
) -> Result<Option<(Case, ResultFolder)>, CommandError> {
    let case = Case::load_simulation(&options.case_path, &options.settings)?;
    print_hints(&case);
    let job = create_job(&case)?;
    let plan = job.plan(false, rank_count)?;
    if !options.force {
        job.refuse_excess(&plan)?;
    }
    let folder = select_folder(&case, options)?;
    refuse_or_warn(folder.check_run_may_start(), options.is_dry_run)?;
    if options.is_dry_run {
        job.check_case()?;
        if let Some(found) = job.find_ill_posedness()?.filter(|_| !options.accept_ill_posed) {
            return Err(CommandError::IllPosed(found));
        }
        let estimate = CostEstimate {
            seconds: Some(plan.cost.single_thread_time),
            memory_bytes: Some(plan.required_memory.0),
            is_in_plan: true,
        };
        let plan = format!("compute {plan}");
        let paths = list_planned_paths(
            &folder,
            &planned_files::list_planned_file_names(&case, &options.pictures)?,
            &options.pictures,
        );
        print_plan(&plan, &paths, estimate, options.format, stdout)?;
        return Ok(None);
    }
    // A closed standard error is ignored.
    let _ = writeln!(std::io::stderr(), "{plan}");
    if let Some(verdict) = decide_solid_verdict(&case) {
        let _ = writeln!(std::io::stderr(), "verdict of the analysis: {verdict}");
    }
    for warning in job.find_warnings()? {
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
    match job.find_ill_posedness()? {
        Some(found) if !options.accept_ill_posed => return Err(CommandError::IllPosed(found)),
        Some(found) => drop(writeln!(std::io::stderr(), "warning: {found}")),
        None => {}
    }
    drop(job);
    Ok(Some((case, folder)))
}

/// Computes a run from its beginning and writes all results. With several ranks, which `communicator` connects, the
/// others take part.
pub(super) fn execute_prepared_run(
    options: &Options,
    (case, folder): (&Case, &ResultFolder),
    checkpoint_settings: CheckpointSettings,
    communicator: Option<&Arc<dyn Communicator>>,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let job = create_job(case)?;
    let run = RunContext {
        case,
        folder,
        checkpoint_settings,
        thread_count: options.thread_count,
        pictures: &options.pictures,
        communicator,
    };
    execute_run(&run, &*job, None, None, options.format, stdout)
}

/// Case, results folder, checkpoint settings, number of threads and pictures of a run.
pub(super) struct RunContext<'a> {
    pub(super) case: &'a Case,
    pub(super) folder: &'a ResultFolder,
    pub(super) checkpoint_settings: CheckpointSettings,
    pub(super) thread_count: Option<usize>,
    pub(super) pictures: &'a PictureOptions,
    /// Communication between several ranks.
    pub(super) communicator: Option<&'a Arc<dyn Communicator>>,
}

/// Computes a run from its beginning or from `checkpoint` and writes all results. `lock` is the run lock of a resumed
/// run.
pub(super) fn execute_run(
    run: &RunContext,
    job: &dyn SimulationJob,
    checkpoint: Option<Checkpoint>,
    lock: Option<Lock>,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    signals::install_signal_handlers();
    let _stage = signals::set_stage_until_drop(ProgramStage::TimeStepping);
    let is_resumed = checkpoint.is_some();
    let mut recorder = FileRecorder::new(run, checkpoint, lock);
    let pool = create_thread_pool(run.thread_count)
        .and_then(|pool| check_thread_start(pool.current_num_threads()).map(|()| pool));
    let pool = match run.communicator {
        Some(communicator) => require_all_ranks(&**communicator, pool)?,
        None => pool?,
    };
    let failed =
        |error| CommandError::from_run_error(error, &run.folder.path().display().to_string());
    let (mut result, waiting) = match run.communicator.filter(|own| own.size() > 1) {
        None => (pool.install(|| job.execute(&mut recorder)).map_err(failed)?, None),
        Some(communicator) => {
            let folder = run.folder.path();
            let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
            let clock = WaitingClock::start(&**communicator);
            let mut all = RankRecorder::new(
                communicator,
                (run.case, folder),
                Some(&mut recorder),
                is_resumed,
            );
            let result = pool.install(|| job.execute(&mut all)).map_err(failed)?;
            let waiting = clock.collect(pool.current_num_threads());
            recorder.run_files_mut().append_log(waiting.to_string().trim_end());
            (result, Some(waiting))
        }
    };
    // The solver has been dropped: the announced memory is that of the solver or of pictures, not of both.
    release_free_memory();
    for warning in result.warnings() {
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
    let RunContext { case, folder, pictures, .. } = run;
    let stored_fields = match &case.solid_run {
        Some(solid_run) if !result.has_field_values && !result.is_part => {
            Some((read_drawn_fields(run, solid_run, &mut result.fields)?, &solid_run.grid))
        }
        _ => None,
    };
    let mut rendered = RenderedReport::new(&result, case)?;
    if let Some(mut files) = recorder.into_folder()? {
        let animation = match result.is_part {
            true => AnimationOutput::NoAnimation,
            false => draw_animation(case, folder, pictures)?,
        };
        match animation {
            AnimationOutput::NoAnimation => {}
            AnimationOutput::AllZero(names) => {
                names.iter().try_for_each(|name| files.remove_result(name))?;
            }
            AnimationOutput::Files(animations) => {
                for (name, bytes) in animations {
                    files.write_result(&name, &bytes)?;
                }
            }
        }
        if let Some((parts, grid)) = stored_fields {
            files.write_result_with(FIELDS_ARCHIVE_FILE, &mut |file| {
                write_field_archive(&parts, grid, file).map_err(io::Error::other)
            })?;
        }
        // One after the other, as the announced memory assumes.
        let one_by_one =
            PictureOptions { thread_count: NonZero::<usize>::MIN, ..(*pictures).clone() };
        let of_page = rendered.write_files(&one_by_one, |name, write| {
            files.write_result_with(name, write).map(drop).map_err(CommandError::from)
        })?;
        let reports = [rendered.text(), rendered.json()];
        let section =
            pictures.has_page.then(|| create_page_section(case, folder, &reports, &of_page));
        files.finish(section.transpose()?.as_ref())?;
    }
    print_report(&rendered, folder, pictures, format, stdout)?;
    if let (OutputFormat::Text, Some(waiting)) = (format, waiting) {
        write!(stdout, "\n{waiting}")?;
    }
    drop(rendered);
    result.stop_report.map_or(Ok(()), |stopped| Err(stopped.into()))
}

/// Opens the final fields that a single process has written by layers, and reads those that pictures show. Their file is
/// removed when the results are complete.
fn read_drawn_fields(
    run: &RunContext,
    solid_run: &SolidRun,
    fields: &mut OutputFields,
) -> Result<FieldParts, CommandError> {
    let path = run.folder.path().join(PartFile::Fields.name(run.case, 0));
    let cells = &solid_run.grid.cells;
    let parts = FieldParts::open(vec![path], cells)?;
    if run.pictures.has_page || !run.pictures.formats.is_empty() {
        let drawn = list_drawn_quantities(solid_run);
        for own in fields.quantities.iter_mut().filter(|own| drawn.contains(&own.name)) {
            own.values = parts.read_values(&own.name, cells)?;
        }
        if parts.has_dissipation {
            fields.plastic_dissipation = parts.read_values("dissipation", cells)?;
        }
        if parts.has_regions {
            let regions = parts.read_regions(cells)?;
            fields.region_indices = regions.iter().map(|&region| region as u16).collect();
        }
    }
    Ok(parts)
}
