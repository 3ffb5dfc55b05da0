//! Folder locks: a lock file that only one process at a time can lock.
//!
//! The lock is an advisory lock of the operating system, released when the process ends for any reason; the file is
//! empty and never written. A symbolic link at its path is refused. On systems without file locks the lock has no
//! effect.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::regular_file::{is_file_at, open_for_update, open_regular_file};

/// Pause between two attempts to acquire a lock.
const RETRY_INTERVAL: Duration = Duration::from_millis(5);

/// Error of acquiring a lock.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// The lock is held by another process, or by another thread of this process.
    #[error("held by another process")]
    Busy,
    /// The file cannot be created or opened, or is not a regular file.
    #[error("{0}")]
    Io(#[from] io::Error),
}

/// Lock on a folder while it is held. Drop releases it, and on Unix removes its file if the lock created the file or
/// [`with_removal_on_drop`](Self::with_removal_on_drop) was called.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
    /// Whether the file is removed on drop: the lock created it, or
    /// [`with_removal_on_drop`](Self::with_removal_on_drop) was called.
    is_removed_on_drop: bool,
}

impl Lock {
    /// Acquires the lock with its file at `path`, without waiting.
    ///
    /// # Errors
    /// The lock is held, or its file cannot be opened: not a regular file, or a missing folder.
    pub fn try_acquire(path: &Path) -> Result<Self, LockError> {
        loop {
            let (file, is_new) =
                match File::options().read(true).write(true).create_new(true).open(path) {
                    Ok(file) => (file, true),
                    Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                        match open_for_update(path) {
                            Ok(file) => (file, false),
                            // The file was removed by its holder in the meantime.
                            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                            Err(error) => return Err(error.into()),
                        }
                    }
                    Err(error) => return Err(error.into()),
                };
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(LockError::Busy),
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // A lock on a file that its previous holder has removed excludes nobody: try again.
            if is_file_at(&file, path) {
                return Ok(Self { path: path.to_owned(), file, is_removed_on_drop: is_new });
            }
        }
    }

    /// Acquires the lock, waiting up to `timeout` for its release.
    ///
    /// # Errors
    /// As [`try_acquire`](Self::try_acquire); a held lock is an error only after the waiting time has elapsed.
    pub fn acquire(path: &Path, timeout: Duration) -> Result<Self, LockError> {
        let start = Instant::now();
        loop {
            match Self::try_acquire(path) {
                Err(LockError::Busy) if start.elapsed() < timeout => {
                    std::thread::sleep(RETRY_INTERVAL)
                }
                end => return end,
            }
        }
    }

    /// Whether the lock with its file at `path` is held. The check acquires the lock for a moment, so callers must
    /// exclude concurrent acquirers by another lock.
    pub fn is_held(path: &Path) -> bool {
        let file = open_regular_file(path);
        file.is_ok_and(|file| matches!(file.try_lock(), Err(TryLockError::WouldBlock)))
    }

    /// Returns this lock, with its file to be removed on drop even if it existed before.
    pub fn with_removal_on_drop(mut self) -> Self {
        self.is_removed_on_drop = true;
        self
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Remove the file before the lock is released: afterwards it may belong to another holder. On systems that
        // cannot identify the file it is not removed.
        if self.is_removed_on_drop && cfg!(unix) && is_file_at(&self.file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn lock_has_one_holder_and_removes_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let (holders, max_holders) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..50 {
                        let lock = Lock::acquire(&path, Duration::from_secs(60)).unwrap();
                        let lock = lock.with_removal_on_drop();
                        max_holders.fetch_max(
                            1 + holders.fetch_add(1, Ordering::SeqCst),
                            Ordering::SeqCst,
                        );
                        std::thread::yield_now();
                        holders.fetch_sub(1, Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
        assert_eq!(max_holders.into_inner(), 1);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn held_lock_is_busy_and_existing_file_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        assert!(!Lock::is_held(&path));
        fs::write(&path, "of a dead process").unwrap();
        assert!(!Lock::is_held(&path));
        let lock = Lock::try_acquire(&path).unwrap();
        assert!(Lock::is_held(&path));
        assert!(matches!(Lock::try_acquire(&path), Err(LockError::Busy)));
        let start = Instant::now();
        let patience = Duration::from_millis(50);
        assert!(matches!(Lock::acquire(&path, patience), Err(LockError::Busy)));
        assert!(start.elapsed() >= patience);
        drop(lock);
        assert_eq!(fs::read(&path).unwrap(), b"of a dead process");
        drop(Lock::try_acquire(&path).unwrap().with_removal_on_drop());
        assert!(!path.exists());
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let [lock, target, absent] =
            ["lock", "target", "absent"].map(|name| folder.path().join(name));
        fs::write(&target, "precious").unwrap();
        for to in [&target, &absent] {
            std::os::unix::fs::symlink(to, &lock).unwrap();
            let refused = Lock::try_acquire(&lock).unwrap_err();
            assert_eq!(refused.to_string(), "a symbolic link");
            fs::remove_file(&lock).unwrap();
        }
        assert_eq!(fs::read(&target).unwrap(), b"precious");
        assert!(!absent.exists());
    }
}
