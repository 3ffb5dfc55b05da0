//! Files that a run writes on its way, from what the driver delivers.

use super::checkpoint::Checkpoint;
use super::control::{CheckpointTimer, computed};
use super::files::{Files, Table, check_snapshots};
use super::{Run, Stopped};
use crate::Error;
use crate::cli::progress::Progress;
use crate::output::AppendedFile;
use dynamics::simulation::{Observer, OutputTimes, RegularTimes, Simulation, drive};
use files::vti::ImageData;
use std::fs::File;
use std::time::Instant;

/// Parts of the duration that a bar of progress tells apart.
const PARTS: f64 = 1000.0;

/// What files and messages say of a kind of simulation.
pub(super) trait View<S: Simulation> {
    /// Extension of the files of snapshots.
    const EXTENSION: &'static str;

    /// The header of the receivers' table, and the places of its columns in what the probes record; `None` without
    /// receivers.
    fn receivers(&self) -> Option<(Vec<String>, Vec<usize>)>;

    /// A recorded value at such a place, in the unit of the table.
    fn to_display_unit(&self, _place: usize, value: f64) -> f64 {
        value
    }

    /// The tables of accounts.
    fn tables(&self) -> Vec<Table>;

    /// The rows of these for an account.
    fn rows(&self, account: &S::Account) -> Vec<Vec<f64>>;

    /// A snapshot for ParaView, of a time in s.
    ///
    /// # Errors
    /// It cannot be made.
    fn image(&self, simulation: &S, fields: &S::Fields, time: f64) -> Result<ImageData, Error>;

    /// How far it has come, in words; `last` is the last account written.
    fn note(&self, simulation: &S, last: &S::Account, effort: Effort) -> String;

    /// What a run took, in words.
    fn log(&self, simulation: &S, effort: Effort) -> String;

    /// Why a simulation stopped, and at which time, s, it is saved.
    fn stopped(&self, fault: &S::Fault, saved: f64) -> Stopped;
}

/// Steps of this part of a run, and the time that they took.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    pub(super) steps: usize,
    pub(super) seconds: f64,
}

/// What came out of a simulation.
pub(super) struct Found<S: Simulation> {
    /// All fields at the end.
    pub(super) fields: S::Fields,
    /// The account of the same state.
    pub(super) last: S::Account,
    pub(super) steps: usize,
    /// The time that the run came to, s.
    pub(super) time: f64,
    pub(super) stopped: Option<Stopped>,
    /// Held until all is written.
    pub(super) lock: File,
}

/// Accounts and snapshots at such intervals of a duration, s; of 0 no snapshots.
pub(super) fn output_times(accounts: f64, snapshots: f64, duration: f64) -> OutputTimes {
    let has_snapshots = snapshots > 0.0;
    OutputTimes {
        accounts: RegularTimes::new(accounts, duration),
        snapshots: has_snapshots.then(|| RegularTimes::new(snapshots, duration)),
    }
}

/// Runs a simulation of that duration, s, from its beginning or from a checkpoint, and writes the files that are
/// appended to.
pub(super) fn simulate<S: Simulation, V: View<S>>(
    view: &V,
    run: &Run,
    mut simulation: S,
    output: &OutputTimes,
    duration: f64,
    from: Option<Checkpoint>,
) -> Result<Found<S>, Error> {
    let (header, columns) = view.receivers().unzip();
    let header = header.map(|header| (AppendedFile::Receivers, header));
    let tables: Vec<Table> = header.into_iter().chain(view.tables()).collect();
    let has_snapshots = output.snapshots.is_some();
    let (files, lock) = Files::open(run.folder, &tables, has_snapshots, from.as_ref(), |state| {
        simulation.restore(state)
    })?;
    let is_resumed = from.is_some();
    drop(from);
    if let (true, Some(times)) = (is_resumed, output.snapshots) {
        let due = 0..times.reached(&simulation);
        check_snapshots(run.folder, due.map(|index| snapshot_name(index, V::EXTENSION)))?;
    }
    let mut recorder = Recorder {
        view,
        files,
        timer: CheckpointTimer::new(run),
        columns: columns.unwrap_or_default(),
        accounts: view.tables().into_iter().map(|(file, _)| file).collect(),
        snapshots: output.snapshots,
        progress: Progress::new("run", PARTS as u64),
        duration,
        parts: 0,
        start: (Instant::now(), simulation.steps()),
    };
    recorder.tick(simulation.time());
    let end = drive(&mut simulation, output, is_resumed, &mut recorder)?;
    computed();
    recorder.files.sync()?;
    recorder.files.log(&view.log(&simulation, recorder.effort(&simulation)));
    Ok(Found {
        fields: simulation.fields(),
        last: end.last,
        steps: simulation.steps(),
        time: simulation.time(),
        stopped: end.fault.map(|fault| view.stopped(&fault, simulation.time())),
        lock,
    })
}

/// The name of the file of a snapshot.
fn snapshot_name(index: usize, extension: &str) -> String {
    format!("snapshot-{index:08}.{extension}")
}

/// Writes what the driver delivers.
struct Recorder<'a, V> {
    view: &'a V,
    files: Files<'a>,
    timer: CheckpointTimer<'a>,
    /// Places of what the receivers record, in what the probes do.
    columns: Vec<usize>,
    /// The tables of accounts.
    accounts: Vec<AppendedFile>,
    snapshots: Option<RegularTimes>,
    progress: Progress,
    /// s.
    duration: f64,
    /// Parts of the duration that the bar shows.
    parts: u64,
    /// When this part of the run began, and after how many steps.
    start: (Instant, usize),
}

impl<V> Recorder<'_, V> {
    fn tick(&mut self, time: f64) {
        let parts = (PARTS * time / self.duration) as u64;
        self.progress.tick(parts - self.parts);
        self.parts = parts;
    }

    fn effort(&self, simulation: &impl Simulation) -> Effort {
        let (clock, first) = self.start;
        let steps = simulation.steps() - first;
        Effort { steps, seconds: clock.elapsed().as_secs_f64() }
    }
}

impl<S: Simulation, V: View<S>> Observer<S> for Recorder<'_, V> {
    type Error = Error;

    fn record(&mut self, time: f64, values: &[f64]) -> Result<(), Error> {
        let value = |&place: &usize| self.view.to_display_unit(place, values[place]);
        let row: Vec<f64> = std::iter::once(time).chain(self.columns.iter().map(value)).collect();
        self.files.write(AppendedFile::Receivers, &row)
    }

    fn account(&mut self, account: &S::Account) -> Result<(), Error> {
        let rows = self.view.rows(account);
        self.accounts.iter().zip(rows).try_for_each(|(table, row)| self.files.write(*table, &row))
    }

    fn snapshot(
        &mut self,
        simulation: &S,
        index: usize,
        time: f64,
        fields: &S::Fields,
    ) -> Result<(), Error> {
        let Some(times) = self.snapshots else { return Ok(()) };
        let image = self.view.image(simulation, fields, time)?;
        let name = |index| Some((times.time(index)?, snapshot_name(index, V::EXTENSION)));
        let list: Vec<(f64, String)> = (0..=index).map_while(name).collect();
        self.files.snapshot(&image, &list)
    }

    fn after_steps(&mut self, simulation: &S, last: &S::Account) -> Result<(), Error> {
        self.tick(simulation.time());
        self.progress.note(self.view.note(simulation, last, self.effort(simulation)));
        self.timer.write_if_due(&mut self.files, simulation)
    }
}
