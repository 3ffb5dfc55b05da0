//! Sets the environment variable `WELLPOSED_COMMIT`, which is read at compile time and printed by `--version`, to the
//! abbreviated hash of the Git commit, or to `unknown`.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=WELLPOSED_COMMIT={}", read_commit().unwrap_or("unknown".into()));
}

/// Returns the abbreviated hash of the Git commit; `None` if Git cannot be run or this package is not the root of a
/// repository, for example if it was copied into another one.
fn read_commit() -> Option<String> {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR")?);
    let top = run_git(&root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    // A commit or a checkout changes one of these files, or a file in the directory `refs/heads`. Absent files are not
    // watched, since Cargo would then rebuild at each call.
    for name in ["HEAD", "refs/heads", "packed-refs"] {
        let path = root.join(run_git(&root, &["rev-parse", "--git-path", name])?);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    run_git(&root, &["rev-parse", "--short=9", "--verify", "HEAD"])
}

fn run_git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").current_dir(root).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}
