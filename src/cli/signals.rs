//! Signals: Ctrl-C, a request to end, a limit to the size of files.

use super::error::INTERRUPTED_CODE;
use std::io::{IsTerminal, Write as _};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::time::Duration;

/// What Ctrl-C means.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Stage {
    /// Nothing is lost by an end at once.
    Anything,
    /// A run makes steps, and writes a checkpoint if it is asked to end.
    Steps,
    /// A run that is asked to end writes its checkpoint.
    Checkpoint,
    /// A run makes steps again up to a fault, and ends where it is if it is asked to.
    Replay,
    /// All steps of a run are done, so that only results are left to be written.
    Results,
}

/// How long a run that is asked to end may take for its step.
const PATIENCE: Duration = Duration::from_secs(8);

static STAGE: AtomicU8 = AtomicU8::new(Stage::Anything as u8);
/// Whether somebody has asked a run to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Says what the program does from now on.
pub(super) fn enter(stage: Stage) {
    STAGE.store(stage as u8, Ordering::Relaxed);
}

/// The same until what is handed back is dropped.
pub(super) fn enter_until_dropped(stage: Stage) -> impl Drop {
    struct Guard;
    impl Drop for Guard {
        fn drop(&mut self) {
            enter(Stage::Anything);
        }
    }
    enter(stage);
    Guard
}

/// Whether somebody has asked a run to end.
pub(super) fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Lets Ctrl-C, SIGTERM and SIGHUP end a run after a checkpoint, and all else at once, without a file half-written; a
/// second one ends a run at once, too. A file that grows beyond a limit is an error of writing, no end of the program.
pub fn install() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // As nohup does.
        let outlives_terminal = is_hangup_ignored();
        // Where another listener stands already it will do.
        let _ = ctrlc::set_handler(end);
        ignore_some(outlives_terminal);
    });
}

fn end() {
    let stage = STAGE.load(Ordering::Relaxed);
    let said = match stage {
        _ if stage == Stage::Steps as u8 => "finishing the step and writing a checkpoint",
        _ if stage == Stage::Checkpoint as u8 => "writing the checkpoint",
        _ if stage == Stage::Replay as u8 => {
            "a fault was found, steps are made again up to it: ending, the last checkpoint stays"
        }
        _ if stage == Stage::Results as u8 => "all steps are done, writing results",
        _ => end_at_once(),
    };
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        end_at_once();
    }
    say(&format!("{said}; press again to stop at once"));
    // Where no thread can be started the run waits for its step.
    let _ = std::thread::Builder::new().spawn(|| {
        std::thread::sleep(PATIENCE);
        let stage = STAGE.load(Ordering::Relaxed);
        if stage == Stage::Steps as u8 || stage == Stage::Replay as u8 {
            say("the step takes too long: ended without it; the last checkpoint stays, if there is one");
            end_at_once();
        }
        say(match stage {
            _ if stage == Stage::Checkpoint as u8 => "still writing the checkpoint",
            _ => "still writing results",
        });
    });
}

/// A message of its own line. On a terminal the bar stands in the line. Nothing is left to be said if nobody listens.
fn say(text: &str) {
    let mut stderr = std::io::stderr();
    let start = if stderr.is_terminal() { "\n" } else { "" };
    let _ = writeln!(stderr, "{start}{text}");
}

fn end_at_once() -> ! {
    files::remove_own_temporaries();
    std::process::exit(INTERRUPTED_CODE.into());
}

/// Whether the program was started so that the end of its terminal is not its own.
#[cfg(unix)]
fn is_hangup_ignored() -> bool {
    let mut found = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: without a new action the call writes the present one, and nothing else; zeros are one as well.
    unsafe {
        let code = libc::sigaction(libc::SIGHUP, std::ptr::null(), found.as_mut_ptr());
        code == 0 && found.assume_init().sa_sigaction == libc::SIG_IGN
    }
}

/// Ignores the signal that a file has grown beyond a limit: the system then hands the error to whoever writes; and the
/// end of the terminal if that is asked for.
#[cfg(unix)]
fn ignore_some(hangup: bool) {
    // SAFETY: no handler of this program is installed, and no other part of it asks for these signals.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
        if hangup {
            libc::signal(libc::SIGHUP, libc::SIG_IGN);
        }
    }
}

#[cfg(not(unix))]
fn is_hangup_ignored() -> bool {
    false
}

#[cfg(not(unix))]
fn ignore_some(_hangup: bool) {}
