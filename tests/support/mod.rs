//! Helpers that parse and run cases within the test process and read the result files.
#![allow(dead_code, reason = "each test uses a part")]

use files::npz::{self, ArrayValues};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use wellposed::case::Case;
use wellposed::cli::{self, CheckpointSettings, CommandError, Options};

/// Settings of a run without periodic checkpoints.
pub const NO_CHECKPOINTS: CheckpointSettings = CheckpointSettings { interval: 1e9 };

/// Cosserat solid in plane strain, with the constants of a unit test of SPECFEM++.
pub const COSSERAT_MODEL: &str = "
[model]
kind = 'cosserat'
dimensions = 2
lambda = 8.1e9
mu = 8.1e9
alpha = 1.005e9
beta = 7.75e8
gamma = 1.5e8
eta = 3e8
density = 2700
inertia = 2700
";

/// Columns of a table in the order of the file: name and values.
pub type Columns = Vec<(String, Vec<f64>)>;

/// Returns the path of a bundled case; `name` is relative to the folder of cases.
pub fn bundled_case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases").join(name)
}

/// Parses a case whose file is called `folder/x.toml`.
pub fn parse_case(text: &str) -> Result<Case, String> {
    parse_case_with(text, &[])
}

/// Parses a case whose file is called `folder/x.toml`, with settings in the notation of the option `--set`.
pub fn parse_case_with(text: &str, settings: &[&str]) -> Result<Case, String> {
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    Case::parse(text, "folder/x.toml", &settings).map_err(|error| error.to_string())
}

/// Replaces the first occurrence of `old`, which must occur in the text.
pub fn replace_first(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

/// Formats the sections of a case that make boundaries periodic.
pub fn format_periodic_boundaries(boundaries: &[&str]) -> String {
    let section =
        |boundary: &&str| format!("[[boundary]]\nside = '{boundary}'\nkind = 'periodic'\n");
    boundaries.iter().map(section).collect()
}

/// Writes `case.run.toml` to a folder; returns options that run it on one thread, which takes less processor time than
/// several on small grids, with results in `out`, overwriting earlier ones.
pub fn create_run_options(folder: &Path, case: &str) -> Options {
    let file = folder.join("case.run.toml");
    fs::write(&file, case).expect("a scratch file");
    Options {
        case_path: file,
        output_folder: Some(folder.join("out")),
        thread_count: Some(1),
        force: true,
        ..Options::default()
    }
}

/// Runs a case without periodic checkpoints and returns the printed text.
pub fn run_case(options: &Options) -> Result<String, CommandError> {
    let mut stdout = Vec::new();
    cli::run_simulation(options, NO_CHECKPOINTS, &mut stdout)?;
    Ok(String::from_utf8(stdout).expect("text"))
}

/// Reads the columns of a CSV file, by name.
pub fn read_columns(path: &Path) -> Columns {
    let text = fs::read_to_string(path).expect("a table");
    let mut lines = text.lines();
    let header = lines.next().expect("a header").split(',');
    let mut columns: Columns = header.map(|name| (name.to_owned(), Vec::new())).collect();
    for line in lines {
        for ((_, values), cell) in columns.iter_mut().zip(line.split(',')) {
            values.push(cell.parse().expect("a number"));
        }
    }
    columns
}

/// Returns the values of the column `name`.
pub fn column_values<'a>(columns: &'a [(String, Vec<f64>)], name: &str) -> &'a [f64] {
    &columns.iter().find(|column| column.0 == name).expect("a column").1
}

/// Reads the arrays of floating-point numbers of an NPZ file by name.
pub fn read_arrays_by_name(path: &Path) -> HashMap<String, Vec<f64>> {
    let arrays = npz::read_arrays(&fs::read(path).expect("a file")).expect("arrays");
    let numbers = arrays.into_iter().filter_map(|array| match array.values {
        ArrayValues::F64(values) => Some((array.name, values)),
        _ => None,
    });
    numbers.collect()
}
