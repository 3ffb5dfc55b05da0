//! Folders of results: which may be written to, and what stands in every one of them.

use crate::case::Case;
use files::FileError;
use files::append::{AppendError, AppendProblem};
use serde_json::Value;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The resolved case of a folder.
const CASE: &str = "case.toml";
/// Name, version and commit of the program that wrote a folder, and the checksum of what it computed.
const PROGRAM: &str = "program.json";

/// File of a moment that tells whether a folder takes files.
const PROBE: &str = "probe";

/// What `map` writes besides.
pub const MAP: [&str; 6] = ["map.png", "map.svg", "map.csv", "map.npz", "map.json", "map.txt"];

/// What `point` writes besides: the first two always, the others where there is a flow.
pub const POINT: [&str; 10] = [
    "point.json",
    "point.txt",
    "growth.png",
    "growth.svg",
    "polar.png",
    "polar.svg",
    "growth_by_direction.csv",
    "growth_by_wave_number.csv",
    "directions.png",
    "directions.svg",
];

/// What `dispersion` writes besides.
pub const DISPERSION: [&str; 5] =
    ["dispersion.png", "dispersion.svg", "dispersion.csv", "dispersion.json", "dispersion.txt"];

/// What `speeds` writes besides: the last three in space alone.
pub const SPEEDS: [&str; 8] = [
    "speeds.png",
    "speeds.svg",
    "speeds.csv",
    "speeds.json",
    "speeds.txt",
    "sphere.png",
    "sphere.svg",
    "sphere.csv",
];

/// What `check` writes besides: the last two where a perturbation is refined.
pub const CHECK: [&str; 6] =
    ["check.png", "check.svg", "check.json", "check.txt", "refinement.png", "refinement.svg"];

/// What `run` writes besides: receivers and their pictures where there are any, snapshots and their animation
/// where they are asked for, spectra of flows, and every snapshot by its own name.
pub const RUN: [&str; 21] = [
    "run.png",
    "run.svg",
    "seismograms.png",
    "seismograms.svg",
    "ledger.png",
    "ledger.svg",
    "spectrum.png",
    "spectrum.svg",
    "dissipation.png",
    "dissipation.svg",
    "animation.gif",
    "receivers.csv",
    "receivers.npz",
    "ledger.csv",
    "spectrum.csv",
    "fields.npz",
    SNAPSHOTS,
    "checkpoint",
    "lock",
    "run.json",
    "run.txt",
];

/// The list of the snapshots of a run.
pub const SNAPSHOTS: &str = "snapshots.pvd";

/// What says that a run is finished.
const FINISHED: &str = "run.json";

/// A file that a run appends to, or writes again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AppendedFile {
    /// What receivers saw.
    Receivers,
    /// The ledger of energy.
    Ledger,
    /// Energies of the shells of modes of a flow.
    Spectrum,
    /// What resumes a run.
    Checkpoint,
    /// Wall times and speeds: no result.
    Log,
    /// Held while a run writes here.
    Lock,
}

impl AppendedFile {
    const fn name(self) -> &'static str {
        match self {
            Self::Receivers => "receivers.csv",
            Self::Ledger => "ledger.csv",
            Self::Spectrum => "spectrum.csv",
            Self::Checkpoint => "checkpoint",
            Self::Log => "log.txt",
            Self::Lock => "lock",
        }
    }
}

/// Whether the name is that of a snapshot: `snapshot-00000012.vti`, of a flow `.vts`.
pub fn is_snapshot(name: &str) -> bool {
    let inner = name
        .strip_prefix("snapshot-")
        .and_then(|name| name.strip_suffix(".vti").or_else(|| name.strip_suffix(".vts")));
    inner.is_some_and(|step| !step.is_empty() && step.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Every file that a verb may write. `--force` removes the ones of another case, so that no result
/// ever stands beside a case that it does not belong to.
pub fn results() -> impl Iterator<Item = &'static str> {
    MAP.into_iter().chain(POINT).chain(DISPERSION).chain(SPEEDS).chain(CHECK).chain(RUN)
}

/// Results cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {cause}; {remedy}", .path.display())]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// Why not.
    pub cause: String,
    /// What to do about it.
    pub remedy: &'static str,
}

impl OutputError {
    /// Something that cannot be written.
    pub fn new(path: &Path, cause: impl ToString) -> Self {
        Self {
            path: path.to_owned(),
            cause: cause.to_string(),
            remedy: "name a place that can be written to",
        }
    }

    /// A result that the operating system does not hand out.
    pub fn unreadable(path: &Path, error: &std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => Self::unusable(path, "is missing"),
            _ => Self { path: path.to_owned(), cause: error.to_string(), remedy: "let it be read" },
        }
    }

    /// A result that is not what was written.
    pub fn unusable(path: &Path, cause: impl ToString) -> Self {
        let remedy = "run the case again with --force";
        Self { path: path.to_owned(), cause: cause.to_string(), remedy }
    }

    /// A table that cannot be appended to.
    pub fn of_table(error: AppendError) -> Self {
        match error.problem {
            AppendProblem::Refused { ref source, .. } if source.kind() != ErrorKind::NotFound => {
                Self::new(&error.path, error.problem)
            }
            problem => Self::unusable(&error.path, problem),
        }
    }
}

/// A folder that may take the results of a case.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
    case: String,
    undrawn: String,
    /// Whether results of another case are to go.
    is_foreign: bool,
}

impl ResultFolder {
    /// The folder `out`, or else `out/<case name>`. Looks whether it takes files, and leaves
    /// nothing behind.
    ///
    /// An absent or empty folder will do, and one that holds results of the very same case from
    /// the very same program: they will be the same bits. Anything else needs `force`. The file
    /// that the case was loaded from is never overwritten by anything else than itself.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
    pub fn check(case: &Case, out: Option<&Path>, force: bool) -> Result<Self, OutputError> {
        let path = out.map_or_else(|| Path::new("out").join(&case.name), Path::to_owned);
        let (text, undrawn) = (case.to_toml(), case.undrawn().to_toml());
        let foreign = foreign(&path, &text, &undrawn)?;
        if let Some(name) = case.source().and_then(|source| overwritten(&path, source, &text)) {
            return Err(OutputError {
                path: path.join(name),
                cause: "this is the case file itself, which would be overwritten".into(),
                remedy: "name another folder with --out",
            });
        }
        if let (Some(cause), false) = (foreign, force) {
            return Err(OutputError {
                path,
                cause: cause.into(),
                remedy: "name another folder with --out, or overwrite with --force",
            });
        }
        probe(&path)?;
        Ok(Self { path, case: text, undrawn, is_foreign: foreign.is_some() })
    }

    /// The folder of a run that was not finished, and its case.
    ///
    /// # Errors
    /// It holds no run, a finished one, one of another version of the program, or one whose case was
    /// changed since it began.
    pub fn of_run(path: &Path) -> Result<(Self, Case), crate::Error> {
        let refused = |cause: &str, remedy| OutputError {
            path: path.to_owned(),
            cause: cause.to_owned(),
            remedy,
        };
        if !path.join(CASE).is_file() {
            let remedy = "name the folder of results of wellposed run";
            return Err(refused("no run: it holds no case.toml", remedy).into());
        }
        if path.join(FINISHED).exists() {
            return Err(refused("the run is finished", "wellposed plot draws it again").into());
        }
        let (folder, case) = Self::of_own_case(path)?;
        if !folder.origin()?.is_version {
            let remedy = "resume it with that version, or run the case again with --force";
            return Err(refused("a run of another version of this program", remedy).into());
        }
        folder.check_case()?;
        Ok((folder, case))
    }

    /// The folder of a finished run, to be drawn again, and its case.
    ///
    /// # Errors
    /// It holds no finished run, or one whose case was changed since in more than what is drawn.
    pub fn finished(path: &Path) -> Result<(Self, Case), crate::Error> {
        if !path.join(FINISHED).exists() || !path.join(CASE).is_file() {
            let remedy = "name the folder of results of wellposed run; resume an unfinished one";
            let (path, cause) = (path.to_owned(), "no finished run".to_owned());
            return Err(OutputError { path, cause, remedy }.into());
        }
        let (folder, case) = Self::of_own_case(path)?;
        folder.check_case()?;
        Ok((folder, case))
    }

    /// The folder of the case that it holds.
    fn of_own_case(path: &Path) -> Result<(Self, Case), crate::Error> {
        let case = Case::load_in_time(&path.join(CASE), &[])?;
        let (text, undrawn) = (case.to_toml(), case.undrawn().to_toml());
        Ok((Self { path: path.to_owned(), case: text, undrawn, is_foreign: false }, case))
    }

    fn origin(&self) -> Result<Origin, OutputError> {
        Origin::of(&self.path, &self.undrawn)
    }

    /// That the case of the folder is the one that its results began with.
    fn check_case(&self) -> Result<(), OutputError> {
        let origin = self.origin()?;
        if origin.is_case {
            return Ok(());
        }
        let cause = match origin.is_version {
            true => "not what the run began with, in more than output.picture and output.contours",
            false => "of a run of another version of this program",
        };
        Err(OutputError {
            path: self.path.join(CASE),
            cause: cause.to_owned(),
            remedy: "take the change back, or run the case again with --force",
        })
    }

    /// Whether a run may begin here: a finished or an unfinished one is not thrown away unasked.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
    pub fn check_runs(&self, force: bool) -> Result<(), OutputError> {
        let refused = |cause: &str, remedy| {
            Err(OutputError { path: self.path.clone(), cause: cause.to_owned(), remedy })
        };
        if force {
            Ok(())
        } else if self.path.join(FINISHED).exists() {
            refused("the folder holds this run, finished", "compute it again with --force")
        } else if self.path_of(AppendedFile::Checkpoint).exists() {
            let remedy = "go on with wellposed resume, or begin again with --force";
            refused("the folder holds this run, interrupted", remedy)
        } else {
            Ok(())
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The resolved case without what decides over its pictures alone.
    pub fn undrawn(&self) -> &str {
        &self.undrawn
    }

    /// Where a file stands.
    pub fn path_of(&self, file: AppendedFile) -> PathBuf {
        self.path.join(file.name())
    }

    /// Removes a file, if it is there.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn remove(&self, file: AppendedFile) -> Result<(), OutputError> {
        remove(&self.path_of(file))
    }

    /// Removes one of the [`results`], if it is there.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn remove_result(&self, name: &str) -> Result<(), OutputError> {
        remove(&self.path.join(name))
    }

    /// Keeps other runs out of the folder until what is handed back is dropped.
    ///
    /// # Errors
    /// Another run is in progress, or the folder takes no files.
    pub fn lock(&self) -> Result<File, OutputError> {
        fs::create_dir_all(&self.path).map_err(|error| OutputError::new(&self.path, error))?;
        let path = self.path_of(AppendedFile::Lock);
        let file = File::create(&path).map_err(|error| OutputError::new(&path, error))?;
        match file.try_lock() {
            Err(fs::TryLockError::WouldBlock) => Err(OutputError {
                path: self.path.clone(),
                cause: "a run is in progress here".into(),
                remedy: "wait for it, or name another folder with --out",
            }),
            // Where files cannot be locked nothing is guarded.
            Ok(()) | Err(fs::TryLockError::Error(_)) => Ok(file),
        }
    }

    /// Removes what a killed run left half-written.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn sweep(&self) -> Result<(), OutputError> {
        let mut half_written = names(&self.path)?.into_iter().filter(|name| is_half_written(name));
        half_written.try_for_each(|name| remove(&self.path.join(name)))
    }

    /// Makes the folder ready for a run from its beginning: as [`open`](Self::open), and without anything
    /// of an earlier run.
    ///
    /// # Errors
    /// What cannot be written or removed, and why.
    pub fn open_run(&self) -> Result<(), OutputError> {
        self.open()?;
        let own = |name: &String| {
            let is_kept = *name == AppendedFile::Lock.name();
            is_snapshot(name)
                || *name == AppendedFile::Log.name()
                || (!is_kept && RUN.iter().any(|own| own == name))
        };
        names(&self.path)?
            .iter()
            .filter(|name| own(name))
            .try_for_each(|name| remove(&self.path.join(name)))
    }

    /// Makes the folder ready: creates it, removes results of another case and what a killed run
    /// left half-written, writes the resolved case and the program's version.
    ///
    /// # Errors
    /// What cannot be written, and why.
    pub fn open(&self) -> Result<(), OutputError> {
        fs::create_dir_all(&self.path).map_err(|e| OutputError::new(&self.path, e))?;
        self.sweep()?;
        let stale =
            names(&self.path)?.into_iter().filter(|name| self.is_foreign && is_result(name));
        for name in stale {
            remove(&self.path.join(name))?;
        }
        // The case file itself may stand here, word for word.
        if !holds(&self.path.join(CASE), &self.case) {
            write_file(&self.path.join(CASE), self.case.as_bytes())?;
        }
        write_file(&self.path.join(PROGRAM), format!("{:#}\n", program(&self.undrawn)).as_bytes())
    }

    /// Writes one of the [`results`], whole or not at all.
    ///
    /// # Errors
    /// The file, and why it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        debug_assert!(is_result(name), "{name} is not listed");
        write_file(&self.path.join(name), bytes)
    }
}

/// Whether a verb may write a file of that name.
fn is_result(name: &str) -> bool {
    is_snapshot(name) || results().any(|known| known == name)
}

/// Removes a file, if it is there.
fn remove(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(OutputError {
            path: path.to_owned(),
            cause: error.to_string(),
            remedy: "let it be removed, or name another folder with --out",
        }),
        _ => Ok(()),
    }
}

/// What [`PROGRAM`] holds.
fn program(undrawn: &str) -> Value {
    serde_json::json!({
        "name": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "commit": env!("WELLPOSED_COMMIT"),
        "case": format!("{:08x}", files::checksum(undrawn.as_bytes())),
    })
}

/// Where the results of a folder come from.
struct Origin {
    /// Whether from this version of the program.
    is_version: bool,
    /// Whether from this case, whatever is drawn of it.
    is_case: bool,
}

impl Origin {
    /// By what [`PROGRAM`] holds in the folder, if it is there.
    fn of(folder: &Path, undrawn: &str) -> Result<Self, OutputError> {
        let path = folder.join(PROGRAM);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            bytes => bytes.map_err(|error| OutputError::unreadable(&path, &error))?,
        };
        let found: Value = serde_json::from_slice(&bytes).unwrap_or_default();
        let own = program(undrawn);
        let is_same = |key: &str| found[key] == own[key];
        let is_version = ["name", "version", "commit"].into_iter().all(is_same);
        Ok(Self { is_version, is_case: is_same("case") })
    }
}

fn holds(path: &Path, text: &str) -> bool {
    fs::read(path).is_ok_and(|bytes| bytes == text.as_bytes())
}

/// Why what stands in the folder is not to be overwritten unasked, if anything.
fn foreign(folder: &Path, case: &str, undrawn: &str) -> Result<Option<&'static str>, OutputError> {
    let mut names = names(folder)?;
    names.retain(|name| !is_half_written(name));
    if names.is_empty() {
        return Ok(None);
    }
    if !holds(&folder.join(CASE), case) {
        return Ok(Some("the folder holds something other than results of this case"));
    }
    // A run killed early may have left the case alone; there is no result to be taken for another.
    let has_origin = names.iter().any(|name| name == PROGRAM || is_result(name));
    let origin = Origin::of(folder, undrawn)?;
    Ok(match has_origin {
        true if !origin.is_version => {
            Some("the folder holds results of another version of this program")
        }
        true if !origin.is_case => {
            Some("the folder holds results of another case than its case.toml")
        }
        _ => None,
    })
}

/// Names in a folder; none where there is no folder.
fn names(folder: &Path) -> Result<Vec<String>, OutputError> {
    let at = |error| OutputError::new(folder, error);
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(at)?,
    };
    entries.map(|entry| Ok(entry.map_err(at)?.file_name().to_string_lossy().into_owned())).collect()
}

/// Whether a killed run of this program left the file: `.NAME.PROCESS.partial`. Hidden files of
/// anyone else are none of its business.
fn is_half_written(name: &str) -> bool {
    let inner = name.strip_prefix('.').and_then(|name| name.strip_suffix(".partial"));
    inner.and_then(|inner| inner.rsplit_once('.')).is_some_and(|(name, process)| {
        let is_number = process.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
        let is_own = is_result(name) || [CASE, PROGRAM, PROBE].contains(&name);
        is_number && is_own
    })
}

/// The file of the folder that is the case file `source` and would be overwritten with anything
/// else than it holds.
fn overwritten(folder: &Path, source: &Path, case: &str) -> Option<&'static str> {
    let source = source.canonicalize().ok()?;
    let is_source = |name: &&str| folder.join(name).canonicalize().is_ok_and(|p| p == source);
    let name = results().chain([CASE, PROGRAM]).find(is_source)?;
    (name != CASE || !holds(&source, case)).then_some(name)
}

/// Creates a file in the folder, or in the nearest one above that exists, and removes it again:
/// permission bits do not tell what a file system takes.
fn probe(folder: &Path) -> Result<(), OutputError> {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    // A link that leads nowhere stands in the way as well.
    let nearest = folder.ancestors().find(|above| above.symlink_metadata().is_ok());
    let nearest = nearest.unwrap_or(Path::new("."));
    let at = |error| OutputError::new(nearest, error);
    if !fs::metadata(nearest).map_err(at)?.is_dir() {
        return Err(OutputError::new(nearest, "not a folder"));
    }
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = nearest.join(format!(".{PROBE}.{}-{count}.partial", std::process::id()));
        match File::create_new(&path) {
            // Left by a process that had the same number.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(at(error)),
            Ok(_) => return fs::remove_file(&path).map_err(at),
        }
    }
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// The file, and why it cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    files::write_atomically(path, bytes).map_err(|error| not_written(path, &error))
}

/// That a file was not written; its name once, not that of the temporary file.
pub fn not_written(path: &Path, error: &FileError) -> OutputError {
    OutputError::new(path, format!("cannot {}: {}", error.action, error.source))
}
