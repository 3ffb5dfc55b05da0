//! Writing a file as one indivisible step.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file or folder that could not be written or read.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}", path.display())]
pub struct FileError {
    /// The file or folder that the failed step touched.
    pub path: PathBuf,
    /// What was attempted, as a phrase that follows "cannot".
    pub action: &'static str,
    /// The operating system's answer.
    pub source: io::Error,
}

/// Writes `bytes` to `path`: afterwards the file holds all of them or is as it was before.
///
/// Missing parent folders are created. The bytes go to a temporary file in the same folder, are
/// flushed to the device, and the temporary file takes the final name in one step. When any step
/// fails the temporary file is removed.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_atomically_with(path, |file| file.write_all(bytes))
}

/// As [`write_atomically`], for content that is not in memory as a whole: `write` puts it into
/// the file, which collects nothing, so that many small pieces deserve a buffer of their own.
pub fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), FileError> {
    let at = |path: &Path, action| {
        let path = path.to_path_buf();
        move |source| FileError { path, action, source }
    };
    let Some(name) = path.file_name() else {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "the path names no file");
        return Err(at(path, "write")(source));
    };
    let folder = folder_of(path);
    fs::create_dir_all(folder).map_err(at(folder, "create the folder"))?;

    // The process number keeps two programs apart that write the same file at the same time;
    // `create_new` below refuses to touch whatever else may carry the name.
    let mut temporary = OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.partial", std::process::id()));
    let temporary = folder.join(temporary);

    let mut file = File::options()
        .write(true)
        .create_new(true)
        .open(&temporary)
        .map_err(at(&temporary, "create"))?;
    let written = write(&mut file)
        .and_then(|()| file.sync_all())
        .map_err(at(&temporary, "write"))
        .and_then(|()| fs::rename(&temporary, path).map_err(at(path, "write")));
    drop(file);
    if written.is_err() {
        // The first failure is the one worth reporting.
        let _ = fs::remove_file(&temporary);
        return written;
    }
    sync_name(path);
    Ok(())
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    // A bare file name has the empty path as its parent, which means the current folder.
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Brings the name of a new file to the device, which it reaches only with its folder. Not every
/// system can open or flush a folder, and the file itself is complete by now, so a refusal is no
/// failure.
pub(crate) fn sync_name(path: &Path) {
    let _ = File::open(folder_of(path)).and_then(|folder| folder.sync_all());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn creates_parents_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/result.csv");
        write_atomically(&path, b"first and longer").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(path.parent().unwrap()), ["result.csv"]);
    }

    #[test]
    fn a_failure_names_the_place_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        // A folder with content stands where the file should go: the last step, the renaming,
        // fails.
        let occupied = folder.path().join("occupied");
        fs::create_dir_all(occupied.join("content")).unwrap();
        let error = write_atomically(&occupied, b"bytes").unwrap_err();
        assert_eq!(error.path, occupied);
        let message = error.to_string();
        assert!(message.starts_with("cannot write ") && message.contains("occupied"), "{message}");
        assert_eq!(names(folder.path()), ["occupied"]);
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
    fn content_that_fails_leaves_the_earlier_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        write_atomically(&path, b"earlier").unwrap();
        let error = write_atomically_with(&path, |file| {
            file.write_all(b"half of")?;
            Err(io::Error::other("the source ran dry"))
        });
        assert_eq!(error.unwrap_err().source.to_string(), "the source ran dry");
        assert_eq!(fs::read(&path).unwrap(), b"earlier");
        assert_eq!(names(folder.path()), ["result"]);
    }

    #[test]
    fn a_path_without_a_file_name_is_refused() {
        for path in ["", "/", ".."] {
            let error = write_atomically(Path::new(path), b"bytes").unwrap_err();
            assert_eq!(error.source.kind(), io::ErrorKind::InvalidInput);
        }
    }
}
