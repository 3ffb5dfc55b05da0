//! Recorder of a run on several ranks: the root records, the others take part.

use super::RankError;
use super::part_writer::PartWriter;
use crate::Error;
use crate::case::Case;
use crate::cli::CommandError;
use crate::cli::folder::{AppendedFile, OutputError};
use crate::cli::parts::create_field_store;
use crate::cli::run::{Checkpoint, FileRecorder, OpenedState};
use crate::study::simulate::{
    FieldSource, FieldStore, OutputFields, OutputPart, Recorder, RestoreState, RunProgress,
    RunRecords, SavedState, TableHeader, TableKind,
};
use dynamics::decomposition::communicator::Communicator;
use dynamics::simulation::RegularTimes;
use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::Arc;

/// Message of the root: the call has succeeded or failed, or the recorder asks all ranks to save or to restore their
/// states.
const SUCCEEDED: u8 = 0;
const FAILED: u8 = 1;
const CALLS_ALL: u8 = 2;

/// Recorder on one of several ranks.
///
/// The root passes tables to its own recorder, and tells the others at the end of each batch of steps whether to go on.
/// Each rank writes the fields and the state of its own cells to files of its own.
pub(in crate::cli) struct RankRecorder<'a, 'b> {
    communicator: &'a Arc<dyn Communicator>,
    /// Recorder of the root.
    recorder: Option<&'a mut FileRecorder<'b>>,
    is_resumed: bool,
    writer: PartWriter<'a>,
    /// First error of the recorder since the other ranks were last told.
    error: Option<Error>,
}

impl<'a, 'b> RankRecorder<'a, 'b> {
    /// Creates the recorder of a rank of a run with the results folder `folder`; `recorder`: that of the root.
    /// `is_resumed`: whether the run resumes from a saved state, the same at all ranks.
    pub(in crate::cli) fn new(
        communicator: &'a Arc<dyn Communicator>,
        (case, folder): (&'a Case, PathBuf),
        recorder: Option<&'a mut FileRecorder<'b>>,
        is_resumed: bool,
    ) -> Self {
        let writer = PartWriter { communicator, case, folder, part: None };
        Self { communicator, recorder, is_resumed, writer, error: None }
    }

    /// Opens the own part of the state of the checkpoint.
    fn open_state(&self) -> Result<OpenedState, CommandError> {
        let path = self.writer.folder.join(AppendedFile::Checkpoint.name());
        let case = self.writer.case.without_plot_options().to_toml();
        let missing = || OutputError::from_invalid_content(&path, "no checkpoint");
        let checkpoint = Checkpoint::read_file(path.clone(), &case)?.ok_or_else(missing)?;
        Ok(checkpoint.open_state(self.writer.part.as_ref().map(|part| &part.state))?)
    }

    /// Makes a call of the root's recorder and tells the other ranks whether it has succeeded. The call receives a
    /// function that makes them take part; other ranks take part by `respond`.
    fn call<V: Default>(
        &mut self,
        call: impl FnOnce(&mut dyn Recorder, &dyn Fn()) -> Result<V, Error>,
        mut respond: impl FnMut(),
    ) -> Result<V, Error> {
        let communicator = self.communicator;
        let Some(recorder) = &mut self.recorder else {
            loop {
                let message = communicator.broadcast(Vec::new());
                match message.as_slice() {
                    [CALLS_ALL] => respond(),
                    [SUCCEEDED] => return Ok(V::default()),
                    _ => return Err(CommandError::from(RankError::Ended { exit_code: 2 }).into()),
                }
            }
        };
        let call_all = || drop(communicator.broadcast(vec![CALLS_ALL]));
        let result = match self.error.take() {
            Some(error) => Err(error),
            None => call(&mut **recorder, &call_all),
        };
        communicator.broadcast(vec![if result.is_ok() { SUCCEEDED } else { FAILED }]);
        result
    }

    /// Makes a call with the progress of the run, in which all ranks save their states if the recorder asks for it.
    fn call_with_progress<V: Default>(
        &mut self,
        progress: &RunProgress,
        call: impl FnOnce(&mut dyn Recorder, &RunProgress) -> Result<V, Error>,
    ) -> Result<V, Error> {
        let writer = PartWriter {
            communicator: self.communicator,
            case: self.writer.case,
            folder: self.writer.folder.clone(),
            part: self.writer.part.clone(),
        };
        let save_part = || -> Result<SavedState<'static>, Error> {
            let state = (progress.save_state)()?;
            Ok(writer.write_state(state).map_err(CommandError::from)?)
        };
        let call_root = |recorder: &mut dyn Recorder, call_all: &dyn Fn()| {
            let save_state = || {
                call_all();
                save_part()
            };
            call(recorder, &RunProgress { save_state: &save_state, ..*progress })
        };
        self.call(call_root, || drop(save_part()))
    }

    /// Keeps the first error of the root's recorder until the next call in which all ranks take part.
    fn keep_error(&mut self, record: impl FnOnce(&mut dyn Recorder) -> Result<(), Error>) {
        if let (Some(recorder), None) = (&mut self.recorder, &self.error) {
            self.error = record(&mut **recorder).err();
        }
    }
}

impl Recorder for RankRecorder<'_, '_> {
    fn communicator(&self) -> Option<Arc<dyn Communicator>> {
        Some(Arc::clone(self.communicator))
    }

    fn is_resumed(&self) -> bool {
        self.is_resumed
    }

    fn set_part(&mut self, part: OutputPart) {
        if let Some(recorder) = &mut self.recorder {
            recorder.set_part(part.clone());
        }
        self.writer.part = Some(part);
    }

    fn start(
        &mut self,
        tables: &[TableHeader],
        snapshots: Option<RegularTimes>,
        restore: &mut RestoreState,
    ) -> Result<(), Error> {
        // Each rank restores its own part; without it none is restored.
        let (mut own, mut failure) = (OpenedState::default(), None);
        if self.is_resumed {
            match self.open_state() {
                Ok(opened) => own = opened,
                Err(error) => failure = Some(error),
            }
        }
        let restore_own = RefCell::new(|| {
            let restored = own.restore(&mut *restore);
            restored.unwrap_or_else(|error| {
                failure.get_or_insert(error.into());
                None
            })
        });
        let start = |recorder: &mut dyn Recorder, call_all: &dyn Fn()| {
            recorder.start(tables, snapshots, &mut |_, _| {
                call_all();
                restore_own.borrow_mut()()
            })
        };
        let started = self.call(start, || {
            restore_own.borrow_mut()();
        });
        // The error of the root's file precedes that of its recorder, which follows from it.
        match failure {
            Some(failure) if self.recorder.is_some() => return Err(failure.into()),
            _ => started?,
        }
        let shared = self.writer.check_shared_folder();
        self.error = shared.map_err(|error| CommandError::from(error).into()).err();
        self.call(|_, _| Ok(()), || {})
    }

    fn record_row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        self.keep_error(|recorder| recorder.record_row(table, row));
        Ok(())
    }

    fn create_field_store(&self) -> Box<dyn FieldStore> {
        create_field_store(&self.writer.folder)
    }

    fn record_snapshot(&mut self, index: usize, fields: &dyn FieldSource) -> Result<(), Error> {
        let written = self.writer.write_snapshot(index, fields);
        let name = self.writer.index_name(index);
        if let (Some(recorder), None) = (&mut self.recorder, &self.error) {
            self.error = written
                .and_then(|(files, bytes)| {
                    let index = (name, bytes.as_slice());
                    Ok(recorder.run_files_mut().write_snapshot_index(index, files)?)
                })
                .err();
        }
        Ok(())
    }

    fn begin_replay(&mut self) -> Result<(), Error> {
        self.call(|recorder, _| recorder.begin_replay(), || {})
    }

    fn restore_saved(&mut self, restore: &mut RestoreState) -> Result<bool, Error> {
        // All ranks take part, even one that cannot read its state: none of them restores it then.
        let restored = self.open_state().unwrap_or_default().restore(restore);
        Ok(restored.is_ok_and(|snapshots| snapshots.is_some()))
    }

    fn handle_progress(&mut self, progress: &RunProgress) -> Result<(), Error> {
        self.call_with_progress(progress, |recorder, progress| recorder.handle_progress(progress))
    }

    /// Writes the final fields of the cells of each rank.
    fn record_final_fields(
        &mut self,
        fields: &dyn FieldSource,
    ) -> Result<Option<OutputFields>, Error> {
        let files = self.writer.write_fields(fields);
        self.error = files
            .map(|files| {
                if let Some(recorder) = &mut self.recorder {
                    recorder.run_files_mut().insert_checksums(&files);
                }
            })
            .map_err(|error| CommandError::from(error).into())
            .err();
        self.call(|_, _| Ok(None), || {})
    }

    fn finish(&mut self, progress: &RunProgress) -> Result<RunRecords, Error> {
        self.call_with_progress(progress, |recorder, progress| recorder.finish(progress))
    }
}
