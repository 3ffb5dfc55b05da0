//! Threads of the subdomains, started for each batch of time steps.

use std::sync::OnceLock;
use std::thread::{Builder, Scope, ScopedJoinHandle};

/// A thread of a subdomain could not be started. No time step has begun: the state is unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot start the threads of a time step: {cause}")]
pub struct ThreadStartError {
    /// Reason given by the operating system.
    pub cause: String,
}

impl From<std::io::Error> for ThreadStartError {
    fn from(error: std::io::Error) -> Self {
        Self { cause: error.to_string() }
    }
}

/// Starts threads of a scope. Tests use an implementation that fails.
#[doc(hidden)]
pub trait ThreadStarter {
    /// Starts a thread that does `work`.
    ///
    /// # Errors
    /// The thread cannot be started.
    fn start<'scope, R: Send + 'scope>(
        &mut self,
        scope: &'scope Scope<'scope, '_>,
        work: impl FnOnce() -> R + Send + 'scope,
    ) -> std::io::Result<ScopedJoinHandle<'scope, R>>;
}

/// Starter of threads of the operating system.
pub(super) struct SystemThreads;

impl ThreadStarter for SystemThreads {
    fn start<'scope, R: Send + 'scope>(
        &mut self,
        scope: &'scope Scope<'scope, '_>,
        work: impl FnOnce() -> R + Send + 'scope,
    ) -> std::io::Result<ScopedJoinHandle<'scope, R>> {
        Builder::new().spawn_scoped(scope, work)
    }
}

/// Does all `tasks` at the same time, each on its own thread. No task begins before all threads have started, since
/// tasks wait for messages of each other.
///
/// # Errors
/// A thread cannot be started; no task has begun.
pub(super) fn run_concurrently<W: FnOnce() + Send>(
    starter: &mut impl ThreadStarter,
    mut tasks: impl Iterator<Item = W>,
) -> Result<(), ThreadStartError> {
    let have_all_started = OnceLock::new();
    std::thread::scope(|scope| {
        let have_all_started = &have_all_started;
        let result = tasks.try_for_each(|task| {
            let work = move || {
                if *have_all_started.wait() {
                    task();
                }
            };
            starter.start(scope, work).map(drop)
        });
        let _ = have_all_started.set(result.is_ok());
        result.map_err(ThreadStartError::from)
    })
}

/// Returns the values of all `inputs`, each evaluated on its own thread, or on the calling thread if its thread cannot
/// be started.
pub(super) fn evaluate_each<I: Copy + Send, V: Send>(
    starter: &mut impl ThreadStarter,
    inputs: impl Iterator<Item = I>,
    evaluate: impl Fn(I) -> V + Sync,
) -> Vec<V> {
    let evaluate = &evaluate;
    std::thread::scope(|scope| {
        let started: Vec<_> = inputs
            .map(|input| starter.start(scope, move || evaluate(input)).map_err(|_| evaluate(input)))
            .collect();
        let value = |own: Result<ScopedJoinHandle<V>, V>| match own {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            Err(value) => value,
        };
        started.into_iter().map(value).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Starter that fails from the thread of this index on.
    struct LimitedThreads(usize);

    impl ThreadStarter for LimitedThreads {
        fn start<'scope, R: Send + 'scope>(
            &mut self,
            scope: &'scope Scope<'scope, '_>,
            work: impl FnOnce() -> R + Send + 'scope,
        ) -> std::io::Result<ScopedJoinHandle<'scope, R>> {
            match self.0.checked_sub(1) {
                None => Err(std::io::Error::other("no more threads")),
                Some(rest) => {
                    self.0 = rest;
                    SystemThreads.start(scope, work)
                }
            }
        }
    }

    #[test]
    fn no_task_begins_unless_all_threads_start() {
        for limit in 0..=4 {
            let done = AtomicUsize::new(0);
            let tasks = (0..4).map(|_| {
                || {
                    done.fetch_add(1, Ordering::Relaxed);
                }
            });
            let result = run_concurrently(&mut LimitedThreads(limit), tasks);
            let error = || ThreadStartError { cause: "no more threads".to_owned() };
            let expected = if limit < 4 { (Err(error()), 0) } else { (Ok(()), 4) };
            assert_eq!((result, done.into_inner()), expected, "{limit} threads");
        }
    }

    #[test]
    fn values_do_not_depend_on_the_number_of_threads() {
        for limit in 0..=4 {
            let values = evaluate_each(&mut LimitedThreads(limit), 0..4, |index| 10 * index);
            assert_eq!(values, [0, 10, 20, 30], "{limit} threads");
        }
    }
}
