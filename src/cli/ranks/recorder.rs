//! Recorder of a run on several ranks: the root records, the others take part.

use super::RankError;
use crate::Error;
use crate::cli::CommandError;
use crate::study::simulate::{
    OutputFields, Recorder, RunProgress, RunRecords, TableHeader, TableKind,
};
use dynamics::decomposition::communicator::Communicator;
use dynamics::simulation::{RegularTimes, SimulationState};
use std::sync::Arc;

/// First byte of a message of the root: the call has succeeded or failed, or the recorder asks for the state of all
/// ranks or restores it.
const SUCCEEDED: u8 = 0;
const FAILED: u8 = 1;
const CALLS_ALL: u8 = 2;

/// Recorder on one of several ranks.
///
/// The root passes all output to its own recorder, and tells the others at the end of each batch of steps whether to go
/// on. When its recorder saves or restores a state, all ranks take part.
pub(in crate::cli) struct RankRecorder<'a> {
    communicator: &'a Arc<dyn Communicator>,
    /// Recorder of the root.
    recorder: Option<&'a mut dyn Recorder>,
    is_resumed: bool,
    /// First error of the recorder since the other ranks were last told.
    error: Option<Error>,
}

impl<'a> RankRecorder<'a> {
    /// Creates the recorder of a rank; `recorder`: that of the root. `is_resumed`: whether the run resumes from a saved
    /// state, the same at all ranks.
    pub(in crate::cli) fn new(
        communicator: &'a Arc<dyn Communicator>,
        recorder: Option<&'a mut dyn Recorder>,
        is_resumed: bool,
    ) -> Self {
        Self { communicator, recorder, is_resumed, error: None }
    }

    /// Makes a call of the root's recorder and tells the other ranks whether it has succeeded. The call receives a
    /// function that makes them take part, with a message. Other ranks take part by `respond`.
    fn call<V: Default>(
        &mut self,
        call: impl FnOnce(&mut dyn Recorder, &dyn Fn(&[u8])) -> Result<V, Error>,
        mut respond: impl FnMut(&[u8]),
    ) -> Result<V, Error> {
        let communicator = self.communicator;
        let Some(recorder) = &mut self.recorder else {
            loop {
                let message = communicator.broadcast(Vec::new());
                match message.split_first() {
                    Some((&CALLS_ALL, message)) => respond(message),
                    Some((&SUCCEEDED, _)) => return Ok(V::default()),
                    _ => return Err(CommandError::from(RankError::Ended { exit_code: 2 }).into()),
                }
            }
        };
        let call_all = |message: &[u8]| {
            communicator.broadcast([&[CALLS_ALL], message].concat());
        };
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
        let call_root = |recorder: &mut dyn Recorder, call_all: &dyn Fn(&[u8])| {
            let save_state = || {
                call_all(&[]);
                (progress.save_state)()
            };
            call(recorder, &RunProgress { save_state: &save_state, ..*progress })
        };
        self.call(call_root, |_| drop((progress.save_state)()))
    }

    /// Keeps the first error of the root's recorder until the next call in which all ranks take part.
    fn keep_error(&mut self, record: impl FnOnce(&mut dyn Recorder) -> Result<(), Error>) {
        if let (Some(recorder), None) = (&mut self.recorder, &self.error) {
            self.error = record(&mut **recorder).err();
        }
    }
}

impl Recorder for RankRecorder<'_> {
    fn communicator(&self) -> Option<Arc<dyn Communicator>> {
        Some(Arc::clone(self.communicator))
    }

    fn is_resumed(&self) -> bool {
        self.is_resumed
    }

    fn start(
        &mut self,
        tables: &[TableHeader],
        snapshots: Option<RegularTimes>,
        restore: &mut dyn FnMut(&SimulationState) -> Option<usize>,
    ) -> Result<(), Error> {
        let restore = std::cell::RefCell::new(restore);
        let start = |recorder: &mut dyn Recorder, call_all: &dyn Fn(&[u8])| {
            recorder.start(tables, snapshots, &mut |state| {
                let numbers =
                    [state.steps as u64, state.time.to_bits(), state.initial_energy.to_bits()];
                call_all(numbers.map(u64::to_le_bytes).as_flattened());
                restore.borrow_mut()(state)
            })
        };
        self.call(start, |message| {
            let (numbers, _) = message.as_chunks();
            let mut numbers = numbers.iter().map(|own| u64::from_le_bytes(*own));
            let mut next = || numbers.next().unwrap_or_default();
            let state = SimulationState {
                steps: next() as usize,
                time: f64::from_bits(next()),
                initial_energy: f64::from_bits(next()),
                sections: Default::default(),
            };
            restore.borrow_mut()(&state);
        })
    }

    fn record_row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        self.keep_error(|recorder| recorder.record_row(table, row));
        Ok(())
    }

    fn record_snapshot(&mut self, index: usize, fields: OutputFields) -> Result<(), Error> {
        self.keep_error(|recorder| recorder.record_snapshot(index, fields));
        Ok(())
    }

    fn begin_replay(&mut self) -> Result<(), Error> {
        self.call(|recorder, _| recorder.begin_replay(), |_| {})
    }

    fn handle_progress(&mut self, progress: &RunProgress) -> Result<(), Error> {
        self.call_with_progress(progress, |recorder, progress| recorder.handle_progress(progress))
    }

    fn finish(&mut self, progress: &RunProgress) -> Result<RunRecords, Error> {
        self.call_with_progress(progress, |recorder, progress| recorder.finish(progress))
    }
}
