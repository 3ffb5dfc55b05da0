//! Folders of results: which may be written to, and what stands in every one of them.

use crate::case::Case;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The resolved case of a folder.
const CASE: &str = "case.toml";
/// Name, version and commit of the program that wrote a folder.
const PROGRAM: &str = "program.json";

/// What `map` writes besides.
pub const MAP: [&str; 6] = ["map.png", "map.svg", "map.csv", "map.npz", "map.json", "map.txt"];

/// What `point` writes besides: the first two always, the others where there is a flow.
pub const POINT: [&str; 8] = [
    "point.json",
    "point.txt",
    "growth.png",
    "growth.svg",
    "growth_by_direction.csv",
    "growth_by_wave_number.csv",
    "directions.png",
    "directions.svg",
];

/// Every file that a verb may write. `--force` removes the ones of another case, so that no result
/// ever stands beside a case that it does not belong to.
pub fn results() -> impl Iterator<Item = &'static str> {
    MAP.into_iter().chain(POINT)
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
    fn new(path: &Path, cause: impl ToString) -> Self {
        Self {
            path: path.to_owned(),
            cause: cause.to_string(),
            remedy: "name a place that can be written to",
        }
    }
}

/// A folder that may take the results of a case.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
    case: String,
    /// Whether results of another case are to go.
    is_foreign: bool,
}

impl ResultFolder {
    /// The folder `out`, or else `out/<case name>`. Looks, and writes nothing.
    ///
    /// An absent or empty folder will do, and one that holds results of the very same case: they
    /// will be the same bits. Anything else needs `force`.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
    pub fn check(case: &Case, out: Option<&Path>, force: bool) -> Result<Self, OutputError> {
        let path = out.map_or_else(|| Path::new("out").join(&case.name), Path::to_owned);
        let case = case.to_toml();
        let is_foreign = match std::fs::read_dir(&path) {
            Ok(mut content) => {
                content.next().is_some()
                    && std::fs::read(path.join(CASE)).ok().as_deref() != Some(case.as_bytes())
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {
                check_parent(&path)?;
                false
            }
            Err(error) => return Err(OutputError::new(&path, error)),
        };
        if is_foreign && !force {
            return Err(OutputError {
                path,
                cause: "the folder holds something other than results of this case".into(),
                remedy: "name another folder with --out, or overwrite with --force",
            });
        }
        Ok(Self { path, case, is_foreign })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the folder ready before anything is computed: creates it, removes results of another
    /// case, writes the resolved case and the program's version.
    ///
    /// # Errors
    /// What cannot be written, and why.
    pub fn open(&self) -> Result<(), OutputError> {
        std::fs::create_dir_all(&self.path).map_err(|e| OutputError::new(&self.path, e))?;
        if self.is_foreign {
            for name in results() {
                let path = self.path.join(name);
                match std::fs::remove_file(&path) {
                    Err(error) if error.kind() != ErrorKind::NotFound => {
                        return Err(OutputError::new(&path, error));
                    }
                    _ => {}
                }
            }
        }
        let program = serde_json::json!({
            "name": env!("CARGO_PKG_NAME"),
            "version": env!("CARGO_PKG_VERSION"),
            "commit": env!("WELLPOSED_COMMIT"),
        });
        write_file(&self.path.join(CASE), self.case.as_bytes())?;
        write_file(&self.path.join(PROGRAM), format!("{program:#}\n").as_bytes())
    }

    /// Writes one of the [`results`], whole or not at all.
    ///
    /// # Errors
    /// The file, and why it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        debug_assert!(results().any(|known| known == name), "{name} is not listed");
        write_file(&self.path.join(name), bytes)
    }
}

/// That a folder can be created: the nearest thing above it that exists is a folder.
fn check_parent(path: &Path) -> Result<(), OutputError> {
    let above =
        path.ancestors().skip(1).find(|above| above.as_os_str().is_empty() || above.exists());
    match above {
        Some(above) if !above.as_os_str().is_empty() => match std::fs::metadata(above) {
            Ok(found) if !found.is_dir() => Err(OutputError::new(above, "not a folder")),
            Ok(found) if found.permissions().readonly() => {
                Err(OutputError::new(above, "no permission to write"))
            }
            Ok(_) => Ok(()),
            Err(error) => Err(OutputError::new(above, error)),
        },
        _ => Ok(()),
    }
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// The file, and why it cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    files::write_atomically(path, bytes).map_err(|error| {
        OutputError::new(path, format!("cannot {}: {}", error.action, error.source))
    })
}
