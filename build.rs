//! Finds the commit for `--version` and lists the bundled cases.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=WELLPOSED_COMMIT={}", commit().unwrap_or("unknown".into()));

    println!("cargo::rerun-if-changed=cases");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    std::fs::write(out.join("cases.rs"), list_of_cases()).expect("cargo's folder takes files");
}

/// The commit of this very repository; a copy inside another one has none.
fn commit() -> Option<String> {
    let root = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR")?);
    let top = git(&root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    // A commit or a checkout changes one of these; watching an absent file would build each time.
    for name in ["HEAD", "refs/heads", "packed-refs"] {
        let path = root.join(git(&root, &["rev-parse", "--git-path", name])?);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(&root, &["rev-parse", "--short=9", "--verify", "HEAD"])
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").current_dir(root).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}

/// `CASES`, a table of path and text of each case.
fn list_of_cases() -> String {
    let mut paths = Vec::new();
    collect(Path::new("cases"), &mut paths);
    paths.sort();
    let root = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let mut list = String::from(
        "/// Path and text of each case that comes with the program, sorted by path.\n\
         pub static CASES: &[(&str, &str)] = &[\n",
    );
    for path in paths {
        let file = Path::new(&root).join(&path);
        let _ = writeln!(list, "    ({path:?}, include_str!({:?})),", file.display().to_string());
    }
    list.push_str("];\n");
    list
}

/// Paths of all case files under a folder, with slashes on every system.
fn collect(folder: &Path, paths: &mut Vec<String>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()) {
        if path.is_dir() {
            collect(&path, paths);
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && path.file_name().is_none_or(|name| name != "Cargo.toml")
        {
            paths.extend(path.to_str().map(|path| path.replace('\\', "/")));
        }
    }
}
