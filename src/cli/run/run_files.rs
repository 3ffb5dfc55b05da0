//! Files that a run appends to: tables and snapshots.

use super::checkpoint::{Checkpoint, OpenedState, SnapshotFiles};
use crate::case::{Case, TimeDomainRun};
use crate::cli::CommandError;
use crate::cli::folder::{
    AppendedFile, JOINT_SNAPSHOT_LIST_FILE, OutputError, ResultFolder, RunFolder,
    SNAPSHOT_LIST_FILE, has_joint_files, is_part_name, snapshot_file_names,
};
use crate::cli::gather::{JoinedFiles, Parts};
use crate::report::WriteContent;
use crate::study::simulate::{
    RecordColumn, RecordTable, RestoreState, RunRecords, TableHeader, TableKind, column_unit,
};
use dynamics::simulation::{RegularTimes, SimulationState};
use files::lock::Lock;
use files::table_appender::{Appender, InterruptedTable};
use files::vti::{PolyData, format_collection};
use files::{FileDigest, read_regular_file};
use std::io::Write;

/// Tables and snapshots that a run writes, and the folder that contains them.
pub(in crate::cli) struct RunFiles<'a> {
    folder: &'a ResultFolder,
    /// Run lock of a resumed run, until [`Self::begin_run`] or [`Self::resume_run`] takes it over.
    run_lock: Option<Lock>,
    /// Folder of the run; `None` before the run begins.
    run_folder: Option<RunFolder<'a>>,
    table_appenders: Vec<(AppendedFile, Appender)>,
    /// Snapshots so far, by index.
    snapshots: Vec<SnapshotFiles>,
    /// Times at which snapshots are due.
    snapshot_times: Option<RegularTimes>,
}

impl From<TableKind> for AppendedFile {
    fn from(table: TableKind) -> Self {
        match table {
            TableKind::Receivers => Self::Receivers,
            TableKind::Ledger => Self::Ledger,
            TableKind::Spectrum => Self::Spectrum,
        }
    }
}

impl<'a> RunFiles<'a> {
    /// Creates the files of a run that has not begun. `lock` is the run lock of a resumed run.
    pub(super) fn new(folder: &'a ResultFolder, lock: Option<Lock>) -> Self {
        Self {
            folder,
            run_lock: lock,
            run_folder: None,
            table_appenders: Vec::new(),
            snapshots: Vec::new(),
            snapshot_times: None,
        }
    }

    /// Prepares the folder for a run from its beginning and creates its tables; `has_joints` states whether snapshots,
    /// which are due at the times `snapshots`, have files of joints.
    pub(super) fn begin_run(
        &mut self,
        tables: &[TableHeader],
        snapshots: Option<RegularTimes>,
        has_joints: bool,
    ) -> Result<(), CommandError> {
        let folder = self.folder;
        let mut run = match self.run_lock.take() {
            None => folder.begin_run()?,
            Some(lock) => folder.restart_run(lock)?,
        };
        for TableHeader { kind, columns, .. } in tables {
            let file = AppendedFile::from(*kind);
            let header: Vec<&str> = columns.iter().map(String::as_str).collect();
            let own = Appender::create(&folder.file_path(file), &header);
            self.table_appenders.push((file, own.map_err(OutputError::from_append_error)?));
        }
        if snapshots.is_some() {
            write_snapshot_lists(&mut run, &[], has_joints)?;
        }
        self.snapshot_times = snapshots;
        self.run_folder = Some(run);
        Ok(())
    }

    /// Prepares the folder for a run resumed from a checkpoint, whose state is `state`, which `restore` restores. Nothing is
    /// changed before all files are found to match the checkpoint.
    pub(super) fn resume_run(
        &mut self,
        tables: &[TableHeader],
        (from, state): (&Checkpoint, &mut OpenedState),
        restore: &mut RestoreState,
        snapshots: Option<RegularTimes>,
    ) -> Result<(), CommandError> {
        let folder = self.folder;
        let snapshots_due = state.restore(restore)?;
        if snapshots_due != Some(from.snapshots.len()) || from.table_digests.len() != tables.len() {
            return Err(Checkpoint::create_mismatch_error(folder).into());
        }
        let files = from.snapshots.iter().flat_map(|own| &own.files);
        for (name, written) in files.clone() {
            folder.check_file(name, *written)?;
        }
        let mut found = Vec::new();
        for (head, written) in tables.iter().zip(&from.table_digests) {
            let file = AppendedFile::from(head.kind);
            let own = InterruptedTable::open(&folder.file_path(file), *written);
            found.push((file, own.map_err(OutputError::from_append_error)?));
        }
        let lock = self.run_lock.take().ok_or_else(|| Checkpoint::create_mismatch_error(folder))?;
        let mut run = RunFolder::from_checkpoint(folder, lock)?;
        for (file, own) in found {
            self.table_appenders
                .push((file, own.resume().map_err(OutputError::from_append_error)?));
        }
        files.for_each(|(name, own)| run.insert_checksum(name, *own));
        self.snapshots.clone_from(&from.snapshots);
        self.snapshot_times = snapshots;
        self.run_folder = Some(run);
        if let Some(first) = self.snapshots.first() {
            // The list on disk may contain snapshots of steps that will be repeated.
            let has_joints = first.names.len() > 1;
            self.write_lists(has_joints)?;
        }
        Ok(())
    }

    /// Appends a row to a table; does nothing if the run has no such table.
    pub(super) fn append_row(
        &mut self,
        table: AppendedFile,
        row: &[f64],
    ) -> Result<(), CommandError> {
        match self.table_appenders.iter_mut().find(|own| own.0 == table) {
            Some((_, file)) => Ok(file.write_row(row).map_err(OutputError::from_append_error)?),
            None => Ok(()),
        }
    }

    /// Writes the files of the next snapshot for ParaView under the names `names`: the fields, which `write_fields` writes, and
    /// joints if any.
    pub(super) fn write_snapshot(
        &mut self,
        write_fields: &mut WriteContent,
        joints: Option<&PolyData>,
        names: Vec<String>,
    ) -> Result<(), CommandError> {
        let Some(run) = &mut self.run_folder else { return Ok(()) };
        let mut files = Vec::new();
        for (index, name) in names.iter().enumerate() {
            let written = match joints.filter(|_| index > 0) {
                None => run.write_result_with(name, write_fields)?,
                Some(lines) => run.write_result(name, &lines.to_bytes())?,
            };
            files.push((name.clone(), written));
        }
        self.snapshots.push(SnapshotFiles { names, files });
        self.write_lists(joints.is_some())
    }

    /// Writes the index `index` of the next snapshot under a name, of which the ranks have written the files `files`.
    pub(in crate::cli) fn write_snapshot_index(
        &mut self,
        (name, index): (String, &[u8]),
        mut files: Vec<(String, FileDigest)>,
    ) -> Result<(), CommandError> {
        let Some(run) = &mut self.run_folder else { return Ok(()) };
        files.push((name.clone(), run.write_result(&name, index)?));
        files.iter().for_each(|(name, own)| run.insert_checksum(name, *own));
        self.snapshots.push(SnapshotFiles { names: vec![name], files });
        self.write_lists(false)
    }

    /// Joins the snapshots that several ranks have written in parts, in a run that this process resumes alone. The parts
    /// remain until the run finishes, since the last checkpoint refers to them.
    pub(super) fn join_snapshots(&mut self, case: &Case) -> Result<(), CommandError> {
        let (Some(run), Some(times), Some(solid_run)) =
            (&mut self.run_folder, self.snapshot_times, &case.solid_run)
        else {
            return Ok(());
        };
        let folder = self.folder.path();
        let mut is_any_joined = false;
        for (index, snapshot) in self.snapshots.iter_mut().enumerate() {
            let name = snapshot.names.first().filter(|name| is_part_name(name)).cloned();
            let (Some(name), Some(time)) = (name, times.time(index)) else { continue };
            let names: Vec<String> = snapshot.files.iter().map(|own| own.0.clone()).collect();
            let mut joined = JoinedRunFiles { run, files: Vec::new() };
            Parts { folder, case, solid_run, names: &names }.join_snapshot(
                &mut joined,
                (index, time),
                &name,
            )?;
            let files = joined.files;
            names.iter().for_each(|name| run.remove_checksum(name));
            *snapshot = SnapshotFiles { names: snapshot_file_names(case, index), files };
            is_any_joined = true;
        }
        if is_any_joined { self.write_lists(has_joint_files(case)) } else { Ok(()) }
    }

    /// Adds the checksums of files that the ranks have written.
    pub(in crate::cli) fn insert_checksums(&mut self, files: &[(String, FileDigest)]) {
        let Some(run) = &mut self.run_folder else { return };
        files.iter().for_each(|(name, own)| run.insert_checksum(name, *own));
    }

    /// Writes the lists of snapshots, with that of joints if snapshots have files of joints.
    fn write_lists(&mut self, has_joints: bool) -> Result<(), CommandError> {
        let (Some(run), Some(times)) = (&mut self.run_folder, self.snapshot_times) else {
            return Ok(());
        };
        let entry =
            |(index, own): (usize, &SnapshotFiles)| Some((times.time(index)?, own.names.clone()));
        let list: Vec<_> = self.snapshots.iter().enumerate().filter_map(entry).collect();
        write_snapshot_lists(run, &list, has_joints)
    }

    /// Syncs the tables to disk and creates a checkpoint of `state`.
    pub(super) fn create_checkpoint(
        &mut self,
        state: SimulationState,
    ) -> Result<Checkpoint, CommandError> {
        let tables = self.sync_tables()?;
        Ok(Checkpoint::new(self.folder, tables, self.snapshots.clone(), state))
    }

    /// Syncs the tables to disk and returns their lengths and checksums.
    pub(super) fn sync_tables(&mut self) -> Result<Vec<FileDigest>, CommandError> {
        let tables = self.table_appenders.iter_mut();
        Ok(tables
            .map(|own| own.1.sync())
            .collect::<Result<_, _>>()
            .map_err(OutputError::from_append_error)?)
    }

    /// Syncs the tables to disk and returns the run folder, to whose checksums those of the tables are added; `None`
    /// before the run begins.
    pub(super) fn into_folder(mut self) -> Result<Option<RunFolder<'a>>, CommandError> {
        let written = self.sync_tables()?;
        let Some(run) = &mut self.run_folder else { return Ok(None) };
        self.table_appenders
            .iter()
            .zip(written)
            .for_each(|((file, _), own)| run.insert_checksum(file.name(), own));
        Ok(self.run_folder)
    }

    /// Appends a line on wall times and speeds to the log. A log that cannot be written is ignored.
    pub(super) fn append_log(&self, text: &str) {
        let path = self.folder.file_path(AppendedFile::Log);
        if let Ok(mut file) = files::open_to_append(&path) {
            let _ = writeln!(file, "{text}");
        }
    }
}

/// Files of a run that have been joined from parts, with their lengths and checksums.
struct JoinedRunFiles<'a, 'b> {
    run: &'a mut RunFolder<'b>,
    files: Vec<(String, FileDigest)>,
}

impl JoinedFiles for JoinedRunFiles<'_, '_> {
    fn put(&mut self, name: &str, write: &mut WriteContent) -> Result<(), OutputError> {
        let written = self.run.write_result_with(name, write)?;
        self.files.push((name.to_owned(), written));
        Ok(())
    }
}

/// Writes the list of snapshots, whose times, s, and file names are in `list`, and the list of joint snapshots if there
/// are any.
fn write_snapshot_lists(
    run: &mut RunFolder,
    list: &[(f64, Vec<String>)],
    has_joints: bool,
) -> Result<(), CommandError> {
    let lists = [(SNAPSHOT_LIST_FILE, true), (JOINT_SNAPSHOT_LIST_FILE, has_joints)];
    for (index, (file, _)) in lists.into_iter().enumerate().filter(|(_, (_, is_due))| *is_due) {
        let entries: Vec<(f64, &String)> =
            list.iter().filter_map(|(time, names)| Some((*time, names.get(index)?))).collect();
        run.write_result(file, &format_collection(&entries).map_err(crate::Error::from)?)?;
    }
    Ok(())
}

/// Reads the tables that a run has written to its results folder.
///
/// # Errors
/// The case has no simulation, or a table is missing, cannot be read or is not numeric.
pub(in crate::cli) fn read_records(
    case: &Case,
    folder: &ResultFolder,
) -> Result<RunRecords, CommandError> {
    let read = |kind| read_table(case, folder, kind);
    let has_receivers = match case.time_domain_run()? {
        TimeDomainRun::Solid(solid_run) => !solid_run.receivers.is_empty(),
        TimeDomainRun::Flow(run) => !run.receivers.is_empty(),
    };
    Ok(RunRecords {
        receivers: has_receivers.then(|| read(TableKind::Receivers)).transpose()?,
        ledger: read(TableKind::Ledger)?,
        spectrum: case.flow_run.as_ref().map(|_| read(TableKind::Spectrum)).transpose()?,
        snapshots: Vec::new(),
    })
}

/// Reads the columns of a table in the results folder, with their units.
fn read_table(
    case: &Case,
    folder: &ResultFolder,
    kind: TableKind,
) -> Result<RecordTable, CommandError> {
    let path = folder.file_path(kind.into());
    let bytes =
        read_regular_file(&path).map_err(|error| OutputError::from_read_error(&path, &error))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = text.lines();
    let column = |name: &str| {
        let unit = column_unit(case, kind, name);
        RecordColumn { name: name.to_owned(), unit, values: Vec::new() }
    };
    let mut columns: Vec<RecordColumn> =
        lines.next().unwrap_or_default().split(',').map(column).collect();
    for (index, line) in lines.enumerate() {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            let number = cell.parse();
            let odd = |_| {
                OutputError::from_invalid_content(&path, format!("line {}: '{cell}'", index + 2))
            };
            column.values.push(number.map_err(odd)?);
        }
    }
    Ok(RecordTable { columns })
}
