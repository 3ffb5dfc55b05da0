//! Atomic file writes.

use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::regular_file::{is_file_at, open_regular_file};

/// Error of writing or reading a file or folder.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}", path.display())]
pub struct FileError {
    /// File or folder of the failed operation.
    pub path: PathBuf,
    /// Attempted action, a phrase that follows "cannot".
    pub action: &'static str,
    /// Error of the operating system.
    pub source: io::Error,
}

/// Writes `bytes` to `path` atomically: afterwards the file contains all bytes, or is unchanged.
///
/// Missing parent folders are created. The bytes are written to a temporary file in the same folder and flushed to
/// disk; then the temporary file is renamed. If an operation fails the temporary file is removed. A symbolic link is
/// replaced and its target is not changed; other special files, such as devices, are refused.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_atomically_with(path, |file| file.write_all(bytes))
}

/// Writes a file atomically, as [`write_atomically`] does, with the content that `write` produces. The file is
/// unbuffered: callers that write many small blocks need a buffer.
pub fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), FileError> {
    stage_file_with(path, write)?.publish()
}

/// Complete file on disk under a temporary name. Drop removes it unless it has been published under its final name.
#[derive(Debug)]
pub struct StagedFile {
    path: PathBuf,
    temporary_path: PathBuf,
    /// Open file, which is locked so that other processes do not remove it as abandoned.
    _file: File,
}

impl StagedFile {
    /// Renames the file to its final name.
    ///
    /// # Errors
    /// A device, pipe or socket has the final name, or renaming fails; the temporary file is removed.
    pub fn publish(self) -> Result<(), FileError> {
        let at = |source| FileError { path: self.path.clone(), action: "write", source };
        refuse_device(&self.path).map_err(at)?;
        fs::rename(&self.temporary_path, &self.path).map_err(at)?;
        sync_parent_folder(&self.path);
        Ok(())
    }
}

impl Drop for StagedFile {
    fn drop(&mut self) {
        let mut temporary_files = lock_temporary_files();
        // After renaming, the temporary name no longer exists.
        let _ = fs::remove_file(&self.temporary_path);
        temporary_files.remove(&self.temporary_path);
    }
}

/// Writes a file under a temporary name; [`StagedFile::publish`] renames it to `path`.
///
/// # Errors
/// The path names no file, or names a device, pipe or socket; or a folder or the file cannot be created or written. The
/// temporary file is removed.
pub fn stage_file_with(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<StagedFile, FileError> {
    let at = |path: &Path, action| {
        let path = path.to_path_buf();
        move |source| FileError { path, action, source }
    };
    let Some(name) = path.file_name() else {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "the path names no file");
        return Err(at(path, "write")(source));
    };
    refuse_device(path).map_err(at(path, "write"))?;
    let folder = parent_folder(path);
    fs::create_dir_all(folder).map_err(at(folder, "create the folder"))?;
    let (temporary_path, mut file) = create_temporary_file(folder, name)?;
    let written = write(&mut file).and_then(|()| file.sync_all());
    // On failure `staged` is dropped, which removes the temporary file.
    let staged = StagedFile { path: path.to_path_buf(), temporary_path, _file: file };
    written.map_err(at(&staged.temporary_path, "write"))?;
    Ok(staged)
}

/// Checks that `path` is absent or may be replaced: not a device, pipe or socket.
fn refuse_device(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path).map(|found| found.file_type()) {
        Ok(found) if !found.is_file() && !found.is_symlink() && !found.is_dir() => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"))
        }
        _ => Ok(()),
    }
}

/// Paths of the temporary files of this process.
static TEMPORARY_FILES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn lock_temporary_files() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    TEMPORARY_FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of this process and prevents the creation of others, for a process about to be
/// terminated, e.g. by a signal. From then on writers in other threads block.
pub fn remove_temporary_files() {
    let temporary_files = lock_temporary_files();
    temporary_files.iter().for_each(|path| drop(fs::remove_file(path)));
    std::mem::forget(temporary_files);
}

/// Creates and locks a temporary file for the file `name` in `folder`.
fn create_temporary_file(folder: &Path, name: &OsStr) -> Result<(PathBuf, File), FileError> {
    static FILE_COUNTER: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = FILE_COUNTER.fetch_add(1, Ordering::Relaxed);
        let mut temporary = OsString::from(".");
        temporary.push(name);
        // The process id distinguishes processes, the counter distinguishes files of one process.
        temporary.push(format!(".{}-{count}.partial", std::process::id()));
        let path = folder.join(temporary);
        let mut temporary_files = lock_temporary_files();
        let file = match File::options().read(true).write(true).create_new(true).open(&path) {
            // The file was abandoned by an earlier process with the same id; try the next name.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            Err(source) => return Err(FileError { path, action: "create", source }),
            Ok(file) => file,
        };
        // Before it was locked, another process may have considered the file abandoned and removed it.
        let is_locked = !matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        if is_locked && is_file_at(&file, &path) {
            temporary_files.insert(path.clone());
            return Ok((path, file));
        }
    }
}

/// Removes a temporary file abandoned by a terminated process; a file being written is not removed.
///
/// # Errors
/// The path is not a regular file, or the file cannot be opened or removed.
pub fn remove_abandoned_file(path: &Path) -> io::Result<()> {
    let file = match open_regular_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        file => file?,
    };
    let is_abandoned = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => false,
        // Without file locks the process id decides, if it can be looked up.
        Err(TryLockError::Error(_)) => {
            parse_process_id(path).is_some_and(|process| is_terminated(process) == Some(true))
        }
    };
    if !is_abandoned {
        return Ok(());
    }
    match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

/// Process id in the name of a temporary file.
fn parse_process_id(path: &Path) -> Option<u32> {
    let name = path.file_name()?.to_str()?.strip_suffix(".partial")?;
    let (_, number) = name.rsplit_once('.')?;
    number.split('-').next()?.parse().ok()
}

/// Whether no process with this id exists; `None` if unknown.
fn is_terminated(process: u32) -> Option<bool> {
    let processes = Path::new("/proc");
    processes.join("self").exists().then(|| !processes.join(process.to_string()).exists())
}

/// Folder of a file.
fn parent_folder(path: &Path) -> &Path {
    // The parent of a bare file name is the empty path, which denotes the current folder.
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Flushes the folder of a new file to disk, so that its name is durable. Errors are ignored: some systems cannot
/// flush folders, and the file itself is complete.
pub(crate) fn sync_parent_folder(path: &Path) {
    let _ = File::open(parent_folder(path)).and_then(|folder| folder.sync_all());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of the files in a folder; files removed while it is read are skipped.
    fn file_names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().filter_map(Result::ok);
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn writing_creates_folders_and_replaces_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/result.csv");
        write_atomically(&path, b"first and longer").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(file_names(path.parent().unwrap()), ["result.csv"]);
    }

    #[test]
    fn failed_write_names_the_path_and_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        // A non-empty folder exists at the path of the file, so that renaming fails.
        let occupied = folder.path().join("occupied");
        fs::create_dir_all(occupied.join("content")).unwrap();
        let error = write_atomically(&occupied, b"bytes").unwrap_err();
        assert_eq!(error.path, occupied);
        let message = error.to_string();
        assert!(message.starts_with("cannot write ") && message.contains("occupied"), "{message}");
        assert_eq!(file_names(folder.path()), ["occupied"]);
    }

    #[test]
    fn a_file_in_place_of_a_folder_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"kept").unwrap();
        let error = write_atomically(&file.join("below"), b"bytes").unwrap_err();
        assert_eq!(error.path, file);
        assert!(error.to_string().starts_with("cannot create the folder "));
        assert_eq!(fs::read(&file).unwrap(), b"kept");
    }

    #[test]
    fn failing_content_writer_leaves_previous_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        write_atomically(&path, b"earlier").unwrap();
        let error = write_atomically_with(&path, |file| {
            file.write_all(b"half of")?;
            Err(io::Error::other("the source ran dry"))
        });
        assert_eq!(error.unwrap_err().source.to_string(), "the source ran dry");
        assert_eq!(fs::read(&path).unwrap(), b"earlier");
        assert_eq!(file_names(folder.path()), ["result"]);
    }

    #[test]
    fn a_path_without_a_file_name_is_refused() {
        for path in ["", "/", ".."] {
            let error = write_atomically(Path::new(path), b"bytes").unwrap_err();
            assert_eq!(error.source.kind(), io::ErrorKind::InvalidInput);
        }
    }

    #[test]
    fn staged_file_replaces_target_only_when_published() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        write_atomically(&path, b"earlier").unwrap();
        drop(stage_file_with(&path, |file| file.write_all(b"dropped")).unwrap());
        assert_eq!(file_names(folder.path()), ["result"]);
        let [one, two] = ["one", "two"]
            .map(|text| stage_file_with(&path, |file| file.write_all(text.as_bytes())).unwrap());
        assert_eq!(
            (fs::read(&path).unwrap(), file_names(folder.path()).len()),
            (b"earlier".to_vec(), 3)
        );
        one.publish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
        two.publish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(file_names(folder.path()), ["result"]);
    }

    #[test]
    fn only_abandoned_temporary_files_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        let staged = stage_file_with(&path, |file| file.write_all(b"alive")).unwrap();
        // Ids of a terminated process and of a running process.
        let abandoned = [7_u32, std::process::id()]
            .map(|process| folder.path().join(format!(".result.{process}-999.partial")));
        for leftover in &abandoned {
            fs::write(leftover, "half").unwrap();
        }
        for name in file_names(folder.path()) {
            remove_abandoned_file(&folder.path().join(name)).unwrap();
        }
        assert!(abandoned.iter().all(|leftover| !leftover.exists()));
        staged.publish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"alive");
        remove_abandoned_file(&folder.path().join("absent")).unwrap();
        assert_eq!(parse_process_id(Path::new("a/.map.png.123-4.partial")), Some(123));
        assert!(!is_terminated(std::process::id()).unwrap_or(false));
    }

    /// Verifies that a thread which removes abandoned files does not disturb eight threads which write files.
    #[test]
    fn removal_of_abandoned_files_does_not_disturb_writers() {
        use std::sync::atomic::AtomicBool;
        let folder = tempfile::tempdir().unwrap();
        let (folder, is_done) = (folder.path(), AtomicBool::new(false));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_done.load(Ordering::Relaxed) {
                    for name in file_names(folder) {
                        if name.ends_with(".partial") {
                            remove_abandoned_file(&folder.join(name)).unwrap();
                        }
                    }
                }
            });
            let writers: Vec<_> = (0..8)
                .map(|thread| {
                    scope.spawn(move || {
                        (0..40).try_for_each(|_| {
                            write_atomically(
                                &folder.join(format!("result{thread}")),
                                &[thread; 999],
                            )
                        })
                    })
                })
                .collect();
            let ends: Vec<_> = writers.into_iter().map(|writer| writer.join().unwrap()).collect();
            is_done.store(true, Ordering::Relaxed);
            ends.into_iter().for_each(|end| end.unwrap());
        });
        assert_eq!(file_names(folder).len(), 8);
    }

    #[cfg(unix)]
    #[test]
    fn pipe_is_refused_and_symbolic_link_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let error = write_atomically(&pipe, b"bytes").unwrap_err();
        assert!(error.to_string().ends_with("pipe: not a regular file"), "{error}");
        assert_eq!(file_names(folder.path()), ["pipe"]);
        assert!(!fs::symlink_metadata(&pipe).unwrap().is_file());
        // A symbolic link is replaced; its target is unchanged.
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, "kept").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write_atomically(&link, b"bytes").unwrap();
        assert_eq!(
            (fs::read(&target).unwrap(), fs::read(&link).unwrap()),
            (b"kept".to_vec(), b"bytes".to_vec())
        );
    }
}
