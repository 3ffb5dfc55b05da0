//! Verifies that every block of code in the documents is run or checked by a test, and that parts of cases in them are valid.

use crate::documents::{DocumentCode, document_paths, extract_commands, read_document};
use wellposed::CASES;
use wellposed::case::Case;

/// Commands in blocks of `sh` that are not those of the program or of cargo, and the test of each.
const OTHER_COMMANDS: [&str; 4] = [
    // The wheel of `.ci/python`.
    "pip install './python[all]'",
    // `paths_in_documents_exist` looks for the script.
    "python3 tests/same_results/compare.py ../before/target/release/wellposed target/release/wellposed",
    "git worktree add ../before HEAD~1 && cargo build --release --manifest-path ../before/Cargo.toml",
    // `MPI_ABI_FOLDER` in the tests of runs in several processes.
    "export WELLPOSED_MPI=/opt/mpi/lib/libmpi_abi.so.1",
];

/// Returns the lines of a block of shell commands, joined with their continuation lines, without comments.
fn list_shell_lines(block: &str) -> Vec<String> {
    let joined = block.replace("\\\n", " ");
    let lines = joined.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    lines.filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

/// Verifies that a test runs or checks each block: `toml`, `bash`, `sh` and `text` in `documents.rs`, `python` in
/// `python/tests/test_documents.py`, `rust` as documentation of the library. Blocks without a language are layouts of folders.
#[test]
fn every_block_has_a_test() {
    let mut count = 0;
    for document in document_paths().into_iter().chain(["python/README.md".to_owned()]) {
        for (language, block) in DocumentCode::new(&read_document(&document)).blocks {
            let is_tested = match language.trim() {
                "toml" | "bash" | "python" => true,
                // `src/lib.rs` includes this page.
                "rust" => document == "docs/library.md",
                // Formulas, printed output, or what an editor is told.
                "text" => true,
                "" => document == "CONTRIBUTING.md",
                "sh" => list_shell_lines(&block).iter().all(|line| {
                    line.starts_with("cargo ")
                        || extract_commands(line).len() == 1
                        || OTHER_COMMANDS.contains(&line.as_str())
                }),
                _ => false,
            };
            assert!(is_tested, "{document}: no test runs this block of {language}:\n{block}");
            count += 1;
        }
    }
    assert!(count > 60, "{count}");
}

/// Returns the indented parts of cases in a document: lines that begin with a section.
fn list_case_parts(text: &str) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    let mut is_in_part = false;
    for line in text.split("```").step_by(2).flat_map(str::lines) {
        match line.strip_prefix("    ") {
            Some(own) if own.starts_with('[') && own.ends_with(']') => {
                parts.push(format!("{own}\n"));
                is_in_part = true;
            }
            Some(own) if is_in_part => {
                let part = parts.last_mut().expect("a part");
                *part += own;
                part.push('\n');
            }
            _ => is_in_part = false,
        }
    }
    parts
}

/// Verifies that a part of a case is valid in a bundled case, in place of the same section there.
#[test]
fn parts_of_cases_in_documents_are_valid() {
    let mut count = 0;
    for document in document_paths() {
        for part in list_case_parts(&read_document(&document)) {
            let sections: toml::Table =
                part.parse().unwrap_or_else(|error| panic!("{document}: {error}\n{part}"));
            let fits = |(_, text): &(&str, &str)| {
                let mut case: toml::Table = text.parse().expect("a bundled case");
                case.extend(sections.clone());
                Case::parse(&case.to_string(), "part.toml", &[])
            };
            let errors: Vec<String> = CASES
                .iter()
                .filter_map(|own| fits(own).err())
                .map(|error| error.to_string())
                .collect();
            assert!(errors.len() < CASES.len(), "{document}:\n{part}\n{}", errors.join("\n"));
            count += 1;
        }
    }
    assert!(count >= 4, "{count}");
}
