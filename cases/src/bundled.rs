//! Case files bundled with the program.

use crate::value::{find_similar_name, format_suggestion};
use std::path::Path;

// `CASES`: path and text of every bundled case file, sorted by path.
include!(concat!(env!("OUT_DIR"), "/cases.rs"));

/// Finds a bundled case by its path, such as `cases/flow/decay.toml`, by a shorter end of the path such as
/// `flow/decay.toml`, or by its name `decay`, with or without the suffix `.toml`; returns path and text.
pub fn find_bundled_case(name: &str) -> Option<(&'static str, &'static str)> {
    let name = name.replace('\\', "/");
    let name = name.trim_start_matches("./");
    let name = name.strip_suffix(".toml").unwrap_or(name);
    let is_end = |path: &str| {
        let path = path.strip_suffix(".toml").unwrap_or(path);
        path.strip_suffix(name).is_some_and(|rest| rest.is_empty() || rest.ends_with('/'))
    };
    CASES.iter().copied().find(|(path, _)| !name.is_empty() && is_end(path))
}

/// Returns the name of a bundled case: its path without folders and suffix.
pub fn bundled_case_name(path: &str) -> &str {
    let file = path.rsplit_once('/').map_or(path, |(_, file)| file);
    file.strip_suffix(".toml").unwrap_or(file)
}

/// Formats the suggestion of a case for a path that cannot be read, for messages: the file with the extension `.toml` or
/// a bundled case with a similar name; empty without one.
pub fn suggest_case(path: &Path) -> String {
    let file = path.with_extension("toml");
    if file != path && file.is_file() {
        return format_suggestion(Some(&file.to_string_lossy()));
    }
    let path = path.to_string_lossy();
    let name = bundled_case_name(&path);
    format_suggestion(find_similar_name(
        name,
        CASES.iter().map(|(path, _)| bundled_case_name(path)),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn bundled_cases_are_found_by_path_and_by_name() {
        let names: BTreeSet<&str> = CASES.iter().map(|(path, _)| bundled_case_name(path)).collect();
        assert_eq!(names.len(), CASES.len(), "names are unique");
        for (path, text) in CASES {
            let short = path.strip_prefix("cases/").unwrap();
            for name in [*path, short, &format!("./{path}"), bundled_case_name(path)] {
                assert_eq!(find_bundled_case(name), Some((*path, *text)), "{name}");
            }
        }
        for name in ["", "cay", "flow", ".toml", "flow/noncoaxiality-bound", "/decay"] {
            assert_eq!(find_bundled_case(name), None, "{name}");
        }
        assert_eq!(
            suggest_case(Path::new("noncoaxialty.toml")),
            "did you mean 'noncoaxiality-bound'? "
        );
    }
}
