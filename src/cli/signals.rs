//! Signal handling: SIGINT (Ctrl-C), SIGTERM, SIGHUP and SIGXFSZ.

use super::error::{CommandError, INTERRUPTED_CODE};
use super::options::OutputFormat;
use std::io::{IsTerminal, Write as _};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::Duration;

/// Stage of the program, which determines the effect of an interrupt.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum ProgramStage {
    /// No run is in progress: an interrupt ends the program at once.
    OutsideRun,
    /// Time stepping: an interrupt ends the run after a checkpoint.
    TimeStepping,
    /// An interrupted run writes its checkpoint; only a second interrupt ends the program at once.
    WritingCheckpoint,
    /// Replay of steps up to a fault: an interrupt ends it without a checkpoint.
    Replay,
    /// All steps are done, and results are being written: a first interrupt ends nothing, a second one ends the program
    /// at once.
    WritingResults,
}

/// Longest wait for the current step of an interrupted run, or for the end of its replay.
const MAX_STEP_WAIT: Duration = Duration::from_secs(8);

static PROGRAM_STAGE: AtomicU8 = AtomicU8::new(ProgramStage::OutsideRun as u8);
/// Whether a run has been interrupted.
static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether the error of an interrupted study is printed as JSON.
static PRINTS_JSON_ERRORS: AtomicBool = AtomicBool::new(false);

/// Sets the format of the error that an interrupt outside a run prints.
pub fn set_error_format(format: OutputFormat) {
    PRINTS_JSON_ERRORS.store(format == OutputFormat::Json, Ordering::Relaxed);
}

/// Whether nothing is printed, since another rank prints.
static IS_SILENT: AtomicBool = AtomicBool::new(false);

/// Sets whether an interrupt prints nothing.
pub fn set_silence(is_silent: bool) {
    IS_SILENT.store(is_silent, Ordering::Relaxed);
}

/// Sets the stage of the program, which determines the effect of the next interrupt.
pub(super) fn set_stage(stage: ProgramStage) {
    PROGRAM_STAGE.store(stage as u8, Ordering::Relaxed);
}

/// Sets the stage until the returned guard is dropped; then the stage is [`ProgramStage::OutsideRun`].
pub(super) fn set_stage_until_drop(stage: ProgramStage) -> impl Drop {
    struct StageGuard;
    impl Drop for StageGuard {
        fn drop(&mut self) {
            set_stage(ProgramStage::OutsideRun);
        }
    }
    set_stage(stage);
    StageGuard
}

/// Returns whether a run has been interrupted.
pub(super) fn is_interrupted() -> bool {
    IS_INTERRUPTED.load(Ordering::Relaxed)
}

/// Installs the handlers. SIGINT, SIGTERM and SIGHUP end a run after a checkpoint, or after its results if all steps
/// are done, and any other work at once, without partial files; a second signal ends a run at once. A write that
/// exceeds the file size limit (SIGXFSZ) returns an error and does not end the program.
pub fn install_signal_handlers() {
    static INSTALL_ONCE: Once = Once::new();
    INSTALL_ONCE.call_once(|| {
        // An ignored SIGHUP, as set by nohup, stays ignored.
        let outlives_terminal = is_hangup_ignored();
        // A handler installed earlier is kept.
        let _ = ctrlc::set_handler(handle_interrupt);
        ignore_signals(outlives_terminal);
    });
}

fn handle_interrupt() {
    let stage = PROGRAM_STAGE.load(Ordering::Relaxed);
    let said = match stage {
        _ if stage == ProgramStage::TimeStepping as u8 => {
            "finishing the step and writing a checkpoint"
        }
        _ if stage == ProgramStage::WritingCheckpoint as u8 => "writing the checkpoint",
        _ if stage == ProgramStage::Replay as u8 => {
            "a fault was found, steps are made again up to it: ending, the last checkpoint stays"
        }
        _ if stage == ProgramStage::WritingResults as u8 => "all steps are done, writing results",
        _ => {
            let error = CommandError::InterruptedStudy;
            let prints_json = PRINTS_JSON_ERRORS.load(Ordering::Relaxed);
            match prints_json && !IS_SILENT.load(Ordering::Relaxed) {
                true => drop(writeln!(std::io::stderr(), "{}", error.to_json())),
                false => print_message(&format!("error: {error}")),
            }
            exit_at_once()
        }
    };
    if IS_INTERRUPTED.swap(true, Ordering::Relaxed) {
        exit_at_once();
    }
    print_message(&format!("{said}; press again to stop at once"));
    // If no thread can be started, there is no time limit on the current step.
    let _ = std::thread::Builder::new().spawn(|| {
        std::thread::sleep(MAX_STEP_WAIT);
        let stage = PROGRAM_STAGE.load(Ordering::Relaxed);
        if stage == ProgramStage::TimeStepping as u8 || stage == ProgramStage::Replay as u8 {
            print_message("the step takes too long: ended without it; the last checkpoint stays, if there is one");
            exit_at_once();
        }
        print_message(match stage {
            _ if stage == ProgramStage::WritingCheckpoint as u8 => "still writing the checkpoint",
            _ => "still writing results",
        });
    });
}

/// Prints a message on a new line, since on a terminal the progress bar occupies the current one. A closed standard
/// error is ignored.
fn print_message(text: &str) {
    if IS_SILENT.load(Ordering::Relaxed) {
        return;
    }
    let mut stderr = std::io::stderr();
    let start = if stderr.is_terminal() { "\n" } else { "" };
    let _ = writeln!(stderr, "{start}{text}");
}

fn exit_at_once() -> ! {
    files::remove_temporary_files();
    std::process::exit(INTERRUPTED_CODE.into());
}

/// Returns whether SIGHUP was ignored when the program was started, as by nohup.
#[cfg(unix)]
fn is_hangup_ignored() -> bool {
    let mut found = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: with a null new action the call only writes the present one to `found`; zeros are a valid `sigaction`.
    unsafe {
        let code = libc::sigaction(libc::SIGHUP, std::ptr::null(), found.as_mut_ptr());
        code == 0 && found.assume_init().sa_sigaction == libc::SIG_IGN
    }
}

/// Ignores SIGXFSZ, so that a write that exceeds the file size limit returns an error; ignores SIGHUP if
/// `ignores_hangup` is set.
#[cfg(unix)]
fn ignore_signals(ignores_hangup: bool) {
    // SAFETY: `SIG_IGN` is a valid disposition that runs no code; for SIGHUP it replaces the handler installed before.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
        if ignores_hangup {
            libc::signal(libc::SIGHUP, libc::SIG_IGN);
        }
    }
}

#[cfg(not(unix))]
fn is_hangup_ignored() -> bool {
    false
}

#[cfg(not(unix))]
fn ignore_signals(_hangup: bool) {}
