//! Build script: lists the bundled case files, which lie beside this file so that the packaged crate contains them.

use std::fmt::Write;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=.");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    std::fs::write(out.join("cases.rs"), list_of_cases()).expect("cargo's folder takes files");
}

/// Generates the Rust source of `CASES`, a table of the path and text of each case file.
fn list_of_cases() -> String {
    let mut paths = Vec::new();
    collect_case_paths(Path::new("."), &mut paths);
    paths.sort();
    let root = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let mut list = String::from(
        "/// Path and text of each case that comes with the program, sorted by path.\n\
         pub static CASES: &[(&str, &str)] = &[\n",
    );
    for path in paths {
        let file = Path::new(&root).join(&path);
        let name = format!("cases/{path}");
        let _ = writeln!(list, "    ({name:?}, include_str!({:?})),", file.display().to_string());
    }
    list.push_str("];\n");
    list
}

/// Collects the paths of the case files inside `folder` that lie in a direct subfolder of the current folder, with
/// slashes as separators on every system.
fn collect_case_paths(folder: &Path, paths: &mut Vec<String>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for path in entries.map(|entry| entry.path()) {
        let name = path.strip_prefix(".").unwrap_or(&path);
        if path.is_dir() {
            collect_case_paths(&path, paths);
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && name.components().count() == 2
        {
            paths.extend(name.to_str().map(|name| name.replace('\\', "/")));
        }
    }
}
