//! Check of a folder of cases on several ranks, which check the cases in turn. The root prints.

use super::{RankError, agree, await_beginning, end_together, require_all_ranks};
use crate::cli::check::{check_files, list_case_files, plan_folder_check, run_check};
use crate::cli::folder::OutputError;
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use dynamics::decomposition::communicator::Communicator;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

/// Runs the verb `check` on all cases in a folder on several ranks. The output is that of one process. All ranks call it,
/// whatever they find at the path of the folder: rank 0 decides whether the path is that of a single case.
///
/// # Errors
/// Those of [`run_check`]; a single case is to be checked on several ranks; or ranks have another program or other cases.
pub fn run_check_on_ranks(
    options: &Options,
    communicator: &Arc<dyn Communicator>,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    end_together(communicator, || {
        let (threads, count) = (options.thread_count, communicator.size());
        if count == 1 {
            return run_check(options, stdout);
        }
        let prepared = match communicator.is_root() && !options.case_path.is_dir() {
            true => Err(RankError::SingleProcessVerb { count: Some(count) }.into()),
            false => list_case_files(&options.case_path)
                .and_then(|files| read_all(&files).map(|content| (files, content))),
        };
        let (files, threads) = match communicator.is_root() {
            false => {
                let content = prepared.as_ref().map(|own| own.1.clone());
                let content = content.map_err(ToString::to_string);
                let beginning = await_beginning(communicator, content, threads);
                let Some((threads, ..)) = beginning else { return Ok(()) };
                (prepared?.0, threads)
            }
            true => {
                let own = prepared.as_ref().ok().filter(|_| !options.is_dry_run);
                let content = own.map(|own| own.1.clone());
                let agreed = agree(communicator, content, threads, (None, false));
                let (files, _) = prepared?;
                if options.is_dry_run {
                    return plan_folder_check(options, &files, stdout);
                }
                (files, agreed?)
            }
        };
        let pool = require_all_ranks(&**communicator, create_thread_pool(Some(threads)))?;
        check_files(options, &files, &pool, &**communicator, stdout)
    })
}

/// Returns names and content of files.
fn read_all(files: &[PathBuf]) -> Result<Vec<u8>, CommandError> {
    let mut all = Vec::new();
    for path in files {
        let content = std::fs::read(path).map_err(|e| OutputError::from_read_error(path, &e))?;
        all.extend(path.display().to_string().into_bytes());
        all.extend(content);
    }
    Ok(all)
}
