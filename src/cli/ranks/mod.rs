//! Runs on several ranks: processes that an MPI launcher such as `mpirun` has started.
//!
//! All ranks read the same case and make the same calls. Each writes the values of its own cells to files in the results
//! folder. Rank 0, the root, prints and writes all other files; the others are silent. They all end with the exit code of
//! the root.

mod check;
mod map;
mod part_writer;
mod recorder;
mod time;
mod waiting;

pub use check::run_check_on_ranks;
pub use map::run_map_on_ranks;
pub(super) use recorder::RankRecorder;
pub use time::run_time_on_ranks;
pub(super) use waiting::WaitingClock;

use super::folder::{ResultFolder, UnfinishedRun};
use super::options::{OutputFormat, create_thread_pool};
use super::resume::prepare_resumed_run;
use super::run::{CheckpointSettings, RunContext, execute_prepared_run, execute_run, prepare_run};
use super::signals::{self, ProgramStage};
use super::{CommandError, Options};
use crate::VERSION;
use crate::case::dynamics::LedgerDetail;
use crate::case::{Case, CaseError, TimeDomainRun};
use crate::report::PictureOptions;
use crate::study::simulate::create_job;
use dynamics::decomposition::communicator::Communicator;
#[cfg(unix)]
use dynamics::decomposition::mpi::{Launcher, MpiError, MpiRank};
use files::FileDigest;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Error of a program that an MPI launcher has started in several processes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RankError {
    /// MPI cannot be started.
    #[cfg(unix)]
    #[error(transparent)]
    Mpi(#[from] MpiError),
    /// The verb works in one process only.
    #[error(
        "this verb works in one process, and the launcher has started {}; start it without a launcher, only wellposed \
         run, resume, map, time and check of a folder work in several", count.map_or_else(|| "an unknown number".to_owned(), |own| own.to_string())
    )]
    SingleProcessVerb {
        /// Number of processes; `None` if the launcher does not tell it.
        count: Option<usize>,
    },
    /// Numbers of ranks are asked for under a launcher.
    #[error("--ranks: the launcher has started {count} ranks, which are timed; leave --ranks out")]
    RankOption {
        /// Number of ranks.
        count: usize,
    },
    /// The simulation works in one process only.
    #[error("{simulation} runs in one process, and the launcher has started {count}")]
    SingleProcessRun {
        /// Description of the simulation.
        simulation: &'static str,
        /// Number of processes.
        count: usize,
    },
    /// Another rank cannot begin the run.
    #[error("rank {rank}: {cause}")]
    OtherRank {
        /// Rank that failed first.
        rank: usize,
        /// Its error.
        cause: String,
    },
    /// Ranks do not run the same program or case.
    #[error(
        "rank {rank} has another {subject} than rank 0: the file must be the same on all machines"
    )]
    Different {
        /// First rank that differs.
        rank: usize,
        /// What differs: program or case.
        subject: &'static str,
    },
    /// The root has ended the run; it prints the reason.
    #[error("rank 0 has ended the run")]
    Ended {
        /// Exit code of the root.
        exit_code: u8,
    },
}

/// Returns whether this process is not rank 0 of a launcher: it must not print.
pub fn is_silent() -> bool {
    #[cfg(unix)]
    if let Some(launcher) = Launcher::detect() {
        return launcher.rank.is_some_and(|rank| rank > 0);
    }
    false
}

/// Waits until rank 0 has printed its error. A launcher ends all ranks as soon as one has ended with an error.
pub fn wait_for_root_message() {
    std::thread::sleep(Duration::from_secs(1));
}

/// Refuses a verb that works in one process, if a launcher has started several.
///
/// # Errors
/// A launcher has started several processes, or an unknown number.
pub fn require_single_process() -> Result<(), CommandError> {
    #[cfg(unix)]
    if let Some(Launcher { size, .. }) = Launcher::detect().filter(|own| own.size != Some(1)) {
        return Err(RankError::SingleProcessVerb { count: size }.into());
    }
    Ok(())
}

/// Starts the communication between ranks; `None` without a launcher.
///
/// # Errors
/// MPI cannot be started.
pub fn start_ranks() -> Result<Option<Arc<dyn Communicator>>, CommandError> {
    #[cfg(unix)]
    if let Some(launcher) = Launcher::detect() {
        let rank = MpiRank::start(&launcher).map_err(RankError::Mpi)?;
        return Ok(Some(Arc::new(rank)));
    }
    Ok(None)
}

/// Runs the verb `run` on several ranks: simulates a solid, whose cells are distributed over the ranks. The results are
/// those of one process, bit for bit. All ranks end with the same exit code.
///
/// # Errors
/// Those of [`run_simulation`](super::run_simulation); the simulation works in one process only; or ranks have another
/// program or case.
pub fn run_simulation_on_ranks(
    options: &Options,
    checkpoint_settings: CheckpointSettings,
    communicator: &Arc<dyn Communicator>,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    end_together(communicator, || {
        if !communicator.is_root() {
            let case = Case::load_simulation(&options.case_path, &options.settings);
            return take_part_in_run(communicator, case, options.thread_count);
        }
        let prepared = prepare_run(options, communicator.size(), stdout).and_then(|own| {
            let case = own.as_ref().map(|(case, _)| case);
            case.map_or(Ok(()), |case| check_distributable(case, communicator)).map(|()| own)
        });
        let own = prepared.as_ref().ok().and_then(Option::as_ref);
        let content = own.map(|(case, _)| case.to_toml().into_bytes());
        let folder = own.map(|own| own.1.path());
        let threads = agree(communicator, content, options.thread_count, (folder, false));
        let Some((case, folder)) = prepared? else { return Ok(()) };
        let options = Options { thread_count: Some(threads?), ..options.clone() };
        execute_prepared_run(
            &options,
            (&case, &folder),
            checkpoint_settings,
            Some(communicator),
            stdout,
        )
    })
}

/// Runs the verb `resume` on several ranks, whose number may differ from that of the interrupted run. Only the root
/// needs the results folder.
///
/// # Errors
/// Those of [`resume`](super::resume) and [`run_simulation_on_ranks`].
pub fn resume_on_ranks(
    path: &Path,
    thread_count: Option<usize>,
    checkpoint_settings: CheckpointSettings,
    communicator: &Arc<dyn Communicator>,
    (format, pictures): (OutputFormat, &PictureOptions),
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let file = path.join(ResultFolder::COMMON_FILE_NAMES[0]).display().to_string();
    end_together(communicator, || {
        if !communicator.is_root() {
            let text = communicator.broadcast(Vec::new());
            let case = Case::parse(&String::from_utf8_lossy(&text), &file, &[]);
            return take_part_in_run(communicator, case, thread_count);
        }
        let prepared = prepare_resumed_run(path, communicator.size())
            .and_then(|own| check_distributable(&own.0.case, communicator).map(|()| own));
        let text = prepared.as_ref().map_or_else(|_| String::new(), |own| own.0.case.to_toml());
        communicator.broadcast(text.into_bytes());
        let content = prepared.as_ref().ok().map(|own| own.0.case.to_toml().into_bytes());
        let is_resumed = prepared.as_ref().is_ok_and(|own| own.1.is_some());
        let threads = agree(communicator, content, thread_count, (Some(path), is_resumed));
        let (UnfinishedRun { folder, case, run_lock }, checkpoint) = prepared?;
        let run = RunContext {
            case: &case,
            folder: &folder,
            checkpoint_settings,
            thread_count: Some(threads?),
            pictures,
            communicator: Some(communicator),
        };
        execute_run(&run, &*create_job(&case)?, checkpoint, Some(run_lock), format, stdout)
    })
}

/// Makes a verb on all ranks, which end with the exit code of the root.
fn end_together(
    communicator: &Arc<dyn Communicator>,
    verb: impl FnOnce() -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    let result = verb();
    let own_code = result.as_ref().map_or_else(CommandError::exit_code, |()| 0);
    let exit_code = communicator.broadcast(vec![own_code]).first().copied().unwrap_or(own_code);
    match (communicator.is_root(), exit_code) {
        (true, _) => result,
        (false, 0) => Ok(()),
        (false, exit_code) => Err(RankError::Ended { exit_code }.into()),
    }
}

/// Agrees with the other ranks at the root that the work on a case, of which `content` is the text, begins; without it,
/// that it does not. Returns the number of threads of each rank.
fn agree(
    communicator: &Arc<dyn Communicator>,
    content: Option<Vec<u8>>,
    thread_count: Option<usize>,
    (folder, is_resumed): (Option<&Path>, bool),
) -> Result<usize, CommandError> {
    let own = content.map(|content| describe_rank(&content, thread_count));
    let mut ranks: Vec<Value> = Vec::new();
    communicator.gather(Vec::new(), &mut |_, message| {
        ranks.push(serde_json::from_slice(&message).unwrap_or_default());
    });
    let threads = match own {
        Some(own) => own.and_then(|own| {
            ranks[0] = own;
            compare_ranks(&ranks)
        }),
        // Only checked, or refused with an error of its own.
        None => Err(RankError::Ended { exit_code: 0 }.into()),
    };
    // Other ranks may have other working folders.
    let folder = folder.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
    let begins = threads.as_ref().ok().map(|threads| (threads, is_resumed, folder));
    communicator.broadcast(json!(begins).to_string().into_bytes());
    threads
}

/// Checks that all ranks have the same program and case as the first one; returns the smallest number of threads.
fn compare_ranks(ranks: &[Value]) -> Result<usize, CommandError> {
    for (rank, other) in ranks.iter().enumerate() {
        if let Some(cause) = other["error"].as_str() {
            return Err(RankError::OtherRank { rank, cause: cause.to_owned() }.into());
        }
        for subject in ["program", "case"] {
            if other[subject] != ranks[0][subject] {
                return Err(RankError::Different { rank, subject }.into());
            }
        }
    }
    let threads = ranks.iter().filter_map(|own| own["threads"].as_u64()).min();
    Ok(threads.and_then(|own| usize::try_from(own).ok()).unwrap_or(1))
}

/// Agreement with the root to begin: number of threads, whether a run is resumed, and the results folder.
type Beginning = (usize, bool, Option<PathBuf>);

/// Agrees with the root to begin the work on a case, of which `content` is the text or the error; `None` if the root has ended it, or has only checked the case.
fn await_beginning(
    communicator: &Arc<dyn Communicator>,
    content: Result<Vec<u8>, String>,
    thread_count: Option<usize>,
) -> Option<Beginning> {
    let describe =
        |content: Vec<u8>| describe_rank(&content, thread_count).map_err(|error| error.to_string());
    let own = content.and_then(describe).unwrap_or_else(|error| json!({ "error": error }));
    communicator.gather(own.to_string().into_bytes(), &mut |_, _| {});
    serde_json::from_slice(&communicator.broadcast(Vec::new())).unwrap_or_default()
}

/// Returns the text of a case with all values, or its error.
fn describe_case(case: &Result<Case, CaseError>) -> Result<Vec<u8>, String> {
    case.as_ref().map(|own| own.to_toml().into_bytes()).map_err(ToString::to_string)
}

/// Agrees with the root and takes part in the simulation of a case.
fn take_part_in_run(
    communicator: &Arc<dyn Communicator>,
    case: Result<Case, CaseError>,
    thread_count: Option<usize>,
) -> Result<(), CommandError> {
    let beginning = await_beginning(communicator, describe_case(&case), thread_count);
    let Some((threads, is_resumed, folder)) = beginning else { return Ok(()) };
    let folder = folder.unwrap_or_default();
    signals::install_signal_handlers();
    let _stage = signals::set_stage_until_drop(ProgramStage::TimeStepping);
    let pool = create_thread_pool(Some(threads));
    let (pool, case) = (require_all_ranks(&**communicator, pool)?, case?);
    let job = create_job(&case)?;
    let mut recorder = RankRecorder::new(communicator, (&case, folder), None, is_resumed);
    let clock = WaitingClock::start(&**communicator);
    pool.install(|| job.execute(&mut recorder))?;
    clock.collect(threads);
    Ok(())
}

/// Waits until all ranks are ready to compute, or one of them is not. Returns `own`, what this rank has prepared.
///
/// # Errors
/// Another rank is not ready; the error of a rank that is not ready itself is its own.
pub(super) fn require_all_ranks<V>(
    communicator: &dyn Communicator,
    own: Result<V, CommandError>,
) -> Result<V, CommandError> {
    let message = own.as_ref().map_or_else(|error| json!(error.to_string()), |_| Value::Null);
    let all = communicator.gather_to_all(message.to_string().into_bytes());
    let cause = |message: &Vec<u8>| serde_json::from_slice::<Option<String>>(message).ok()?;
    let failed = all.iter().map(cause).enumerate().find_map(|(rank, own)| Some((rank, own?)));
    match failed {
        Some((rank, cause)) if own.is_ok() => Err(RankError::OtherRank { rank, cause }.into()),
        _ => own,
    }
}

/// Checks that the simulation of a case can be distributed.
fn check_distributable(
    case: &Case,
    communicator: &Arc<dyn Communicator>,
) -> Result<(), CommandError> {
    let simulation = match case.time_domain_run().map_err(crate::Error::from)? {
        TimeDomainRun::Flow(_) => "the simulation of a flow",
        TimeDomainRun::Solid(solid_run) => match solid_run.scheme.ledger_detail {
            LedgerDetail::TotalsAndDissipation => {
                "a simulation with the numerical dissipation in its ledger"
            }
            LedgerDetail::Totals => return Ok(()),
        },
    };
    match communicator.size() {
        1 => Ok(()),
        count => Err(RankError::SingleProcessRun { simulation, count }.into()),
    }
}

/// Describes what must be the same on all ranks, and the number of threads of this one.
fn describe_rank(content: &[u8], thread_count: Option<usize>) -> Result<Value, CommandError> {
    let program = std::env::current_exe().and_then(|path| FileDigest::from_file(&path));
    let threads = create_thread_pool(thread_count)?.current_num_threads();
    let program = program.map(|own| own.checksum).unwrap_or_default();
    Ok(json!({
        "program": format!("{VERSION} {program}"),
        "case": files::checksum(content),
        "threads": threads,
    }))
}
