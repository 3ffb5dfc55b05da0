//! Ranks as processes of the Message Passing Interface (MPI), which a launcher such as `mpirun` or `srun` starts on one
//! or several machines.
//!
//! The library is looked for at run time, and only under a launcher. A binding at compile time is not wanted: the
//! libraries of Open MPI, MPICH and the standard interface of MPI 5 differ in the sizes of handles and in the values of
//! constants, so that a program compiled for one does not run with another; and the library that knows the network of a
//! cluster is the one installed there, not that of the machine where the program was built. It would also make headers
//! and a C compiler necessary for everyone, including those with one machine. The eleven functions used here have the
//! same parameters in all libraries; the constants that differ are four handles and one level.

mod launcher;
mod library;

use super::communicator::{Communicator, WaitingTime};
use library::MpiLibrary;
use std::time::{Duration, Instant};

pub use launcher::Launcher;
pub use library::MpiError;

/// Largest length of a transfer, bytes: MPI counts in 32 bits.
const MAX_TRANSFER_LENGTH: usize = 1 << 30;

/// Number of tests of a transfer before the thread yields its core to others, and before it sleeps between tests.
const TESTS_BEFORE_PAUSES: [u32; 2] = [100, 2000];

/// Sleep between two tests of a transfer that takes long.
const LONG_PAUSE: Duration = Duration::from_micros(50);

/// Rank that communicates by MPI.
#[derive(Debug)]
pub struct MpiRank {
    library: MpiLibrary,
    rank: usize,
    size: usize,
    waiting_time: WaitingTime,
}

impl MpiRank {
    /// Loads the MPI library of a launcher, or the one that the environment variable `WELLPOSED_MPI` names, and starts
    /// it; once per process.
    ///
    /// # Errors
    /// No library can be loaded or started, or the library is not that of the launcher.
    pub fn start(launcher: &Launcher) -> Result<Self, MpiError> {
        let requested = std::env::var(library::LIBRARY_VARIABLE).ok();
        let library = MpiLibrary::load(&launcher.library_names(requested))?;
        let [rank, size] = library.start()?;
        match launcher.size {
            Some(launched) if launched != size => {
                let library = library.name().to_owned();
                Err(MpiError::OtherLauncher { library, launched, connected: size })
            }
            _ => Ok(Self { library, rank, size, waiting_time: WaitingTime::default() }),
        }
    }

    /// Returns the file of the library, and the first line of its description of itself.
    pub fn library_description(&self) -> String {
        format!("{} ({})", self.library.name(), self.library.version())
    }

    /// Ends all ranks after an error of the library.
    fn require(&self, result: Result<(), MpiError>) {
        if let Err(error) = result {
            self.abort(&error.to_string());
        }
    }
}

/// Returns a function that waits between two tests of a transfer: not at all, for other threads, or for a while.
fn create_pause() -> impl FnMut() {
    let mut tests = 0_u32;
    move || {
        tests = tests.saturating_add(1);
        match TESTS_BEFORE_PAUSES {
            [spinning, _] if tests < spinning => std::hint::spin_loop(),
            [_, yielding] if tests < yielding => std::thread::yield_now(),
            _ => std::thread::sleep(LONG_PAUSE),
        }
    }
}

impl Communicator for MpiRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn begin_send(&self, receiver: usize, tag: u16, mut message: Vec<u8>) {
        while message.len() > MAX_TRANSFER_LENGTH {
            let rest = message.split_off(MAX_TRANSFER_LENGTH);
            self.require(self.library.begin_send(receiver, tag, message));
            message = rest;
        }
        self.require(self.library.begin_send(receiver, tag, message));
    }

    fn receive(&self, sender: usize, tag: u16, message: &mut [u8]) {
        let start = Instant::now();
        // An empty message is one transfer as well.
        let (whole, rest) = message.split_at_mut(
            message.len().saturating_sub(1) / MAX_TRANSFER_LENGTH * MAX_TRANSFER_LENGTH,
        );
        for part in whole.chunks_mut(MAX_TRANSFER_LENGTH).chain([rest]) {
            self.require(self.library.receive(sender, tag, part, create_pause()));
        }
        self.waiting_time.add_since(start);
    }

    fn waiting_time(&self) -> f64 {
        self.waiting_time.as_seconds()
    }

    fn abort(&self, cause: &str) -> ! {
        eprintln!("error: rank {} of {}: {cause}", self.rank, self.size);
        self.library.abort()
    }

    fn finish(&self) {
        self.require(self.library.finish(create_pause()));
    }
}
