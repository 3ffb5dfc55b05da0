//! `wellposed compare`: compares two finished runs of the same problem.

use super::folder::{
    COMPARISON_FILES, FIELDS_ARCHIVE_FILE, OutputError, ResultFolder, SNAPSHOT_LIST_FILE,
    is_snapshot_name,
};
use super::load::print_hints;
use super::progress::DelayedProgressBar;
use super::run::read_records;
use super::write::{
    CostEstimate, list_planned_paths, print_plan, print_report, refuse_or_warn, write_report_files,
};
use super::{CommandError, OutputFormat};
use crate::case::Case;
use crate::report;
use crate::report::PictureOptions;
use crate::report::format::format_count;
use crate::study::compare::{Comparison, ComparisonResult};
use crate::study::simulate::OutputFields;
use files::read_regular_file;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Options of `compare`.
#[derive(Clone, Debug, Default)]
pub struct CompareOptions {
    /// Results folders of the two runs; differences refer to the first.
    pub folders: [PathBuf; 2],
    /// Output format.
    pub format: OutputFormat,
    /// Results folder; default `out/<first>-<second>` with the names of the folders of the runs.
    pub output_folder: Option<PathBuf>,
    /// Whether results of another case may be overwritten.
    pub force: bool,
    /// Whether to check the folders and describe the work only, writing nothing.
    pub is_dry_run: bool,
    /// Which pictures are drawn, and how.
    pub pictures: PictureOptions,
}

/// Finished run to be compared.
struct StoredRun {
    folder: ResultFolder,
    case: Case,
    /// Paths of the snapshots, or of the archive of the final fields if the run has no snapshots.
    fields: Vec<PathBuf>,
}

/// Runs `compare`.
///
/// # Errors
/// A folder holds no finished run or damaged files, the runs do not match (see [`Comparison::new`]), or results cannot be
/// written.
pub fn run_compare(options: &CompareOptions, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let [first, second] = &options.folders;
    let runs = [StoredRun::open(first)?, StoredRun::open(second)?];
    let mut comparison = Comparison::new([&runs[0].case, &runs[1].case])?;
    let counts = [0, 1].map(|run| runs[run].fields.len());
    if counts[0] != counts[1] {
        return Err(comparison.snapshot_count_error(counts).into());
    }
    let default_name = [first, second].map(|folder| folder_name(folder)).join("-");
    let out = options.output_folder.clone().unwrap_or(Path::new("out").join(default_name));
    let folder = ResultFolder::from_case(&runs[0].case, Some(&out), options.force)?;
    refuse_or_warn(folder.check_other_results(), options.is_dry_run)?;
    let progress = DelayedProgressBar::new("compare", counts[0] as u64);
    let start = Instant::now();
    for index in 0..counts[0] {
        let fields = [runs[0].read_fields(index)?, runs[1].read_fields(index)?];
        comparison.add_snapshot([&fields[0], &fields[1]])?;
        if options.is_dry_run {
            // All pairs are equally large.
            let seconds = start.elapsed().as_secs_f64() * counts[0] as f64;
            let plan = format!("compare {} of snapshots", format_count(counts[0], "pair"));
            let paths = list_planned_paths(&folder, &COMPARISON_FILES, &options.pictures);
            let estimate = CostEstimate::from_seconds(seconds);
            return print_plan(&plan, &paths, estimate, options.format, stdout);
        }
        progress.advance_to(index as u64 + 1, counts[0] as u64);
    }
    drop(progress);
    let ledgers = [0, 1].map(|run| read_records(&runs[run].case, &runs[run].folder));
    let [first, second] = ledgers;
    let mut found = comparison.finish([&first?.ledger, &second?.ledger]);
    for (run, path) in found.runs.iter_mut().zip(&options.folders) {
        run.folder = Some(path.clone());
    }
    check_earlier_comparison(&folder, &found, options.force)?;
    let rendered = write_report_files(&found, &runs[0].case, &folder, &options.pictures)?;
    print_report(&rendered, &folder, &options.pictures, options.format, stdout)
}

/// Checks that a comparison that exists in the folder is one with the same second run.
fn check_earlier_comparison(
    folder: &ResultFolder,
    found: &ComparisonResult,
    can_overwrite: bool,
) -> Result<(), OutputError> {
    let path = folder.path().join("compare.json");
    let earlier: serde_json::Value = read_regular_file(&path)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let is_other =
        earlier["runs"][1]["case"].as_str().is_some_and(|case| case != found.runs[1].case_checksum);
    if can_overwrite || !is_other {
        return Ok(());
    }
    let cause = "the comparison with another second run".to_owned();
    Err(OutputError {
        path,
        cause,
        remedy: "name another folder with --out, or overwrite with --force",
    })
}

/// Returns the last component of the path of a folder, also of a relative path such as `.`.
fn folder_name(folder: &Path) -> String {
    let absolute = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    absolute.file_name().map_or("run".to_owned(), |name| name.to_string_lossy().into_owned())
}

impl StoredRun {
    fn open(path: &Path) -> Result<Self, CommandError> {
        let (folder, case) = ResultFolder::open_finished_run(path)?;
        print_hints(&case);
        folder.check_files(|name| {
            is_snapshot_name(name)
                || [FIELDS_ARCHIVE_FILE, SNAPSHOT_LIST_FILE, "ledger.csv"].contains(&name)
        })?;
        let has_snapshots =
            case.solid_run.as_ref().is_some_and(|run| run.output.snapshot_interval > 0.0);
        let names = match has_snapshots {
            true => {
                let list = folder.path().join(SNAPSHOT_LIST_FILE);
                let bytes = read(&list)?;
                let names = files::vti::parse_collection(&String::from_utf8_lossy(&bytes));
                if let Some(odd) = names.iter().find(|name| !is_snapshot_name(name)) {
                    let cause = format!("names '{odd}', no snapshot");
                    return Err(OutputError::from_invalid_content(&list, cause).into());
                }
                names
            }
            false => vec![FIELDS_ARCHIVE_FILE.to_owned()],
        };
        let fields = names.iter().map(|name| folder.path().join(name)).collect();
        Ok(Self { folder, case, fields })
    }

    /// Reads the fields of a snapshot, or the final fields.
    fn read_fields(&self, index: usize) -> Result<OutputFields, CommandError> {
        let path = &self.fields[index];
        let bytes = read(path)?;
        let grid = self.case.solid_run.as_ref().map(|run| &run.grid);
        let cells = grid.map_or(0, |grid| grid.cell_count());
        let damaged =
            |cause: String| CommandError::from(OutputError::from_invalid_content(path, cause));
        if path.ends_with(FIELDS_ARCHIVE_FILE) {
            return report::run::read_fields(&bytes, cells)
                .map_err(|error| damaged(error.to_string()));
        }
        report::run::read_snapshot(&self.case, &bytes).map_err(damaged)
    }
}

fn read(path: &Path) -> Result<Vec<u8>, OutputError> {
    read_regular_file(path).map_err(|error| OutputError::from_read_error(path, &error))
}
