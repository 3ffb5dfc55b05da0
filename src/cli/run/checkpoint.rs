//! What a run needs to go on: state, and what its tables held.

use crate::case::{Case, InTime};
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, not_written};
use dynamics::simulation::State;
use files::Written;
use files::sealed::{Problem, read_sealed, write_sealed};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// A checkpoint of a solid or a flow.
pub(in crate::cli) struct Checkpoint {
    /// What stands in the tables.
    pub(in crate::cli) tables: Vec<Written>,
    /// All snapshots so far.
    pub(in crate::cli) snapshots: Vec<Written>,
    /// The state.
    pub(in crate::cli) state: State,
}

impl Checkpoint {
    /// Writes it, whole or not at all.
    pub(super) fn write(&self, folder: &ResultFolder) -> Result<(), OutputError> {
        let State { steps, time, initial_energy, sections: numbers } = &self.state;
        let pairs = |files: &[Written]| -> Vec<[u64; 2]> {
            files.iter().map(|own| [own.length, own.checksum.into()]).collect()
        };
        let about = json!({
            "steps": steps,
            "time": time.to_bits(),
            "tables": pairs(&self.tables),
            "snapshots": pairs(&self.snapshots),
            "start": initial_energy.to_bits(),
        })
        .to_string();
        let mut sections: Vec<(&str, &[u8])> =
            vec![("case", folder.without_plot_options().as_bytes()), ("about", about.as_bytes())];
        sections.extend(numbers.iter().map(|(name, own)| (name.as_str(), own.as_slice())));
        let path = folder.path_of(AppendedFile::Checkpoint);
        write_sealed(&path, &sections).map_err(|error| not_written(&path, &error))
    }

    /// The checkpoint of a folder; `None` where there is none: the run had not come so far.
    ///
    /// # Errors
    /// It is damaged, or of another case.
    pub(in crate::cli) fn read(folder: &ResultFolder) -> Result<Option<Self>, OutputError> {
        let path = folder.path_of(AppendedFile::Checkpoint);
        let damaged = |cause: &str| OutputError::unusable(&path, cause);
        let sections = match read_sealed(&path).map_err(|error| error.problem) {
            Err(Problem::Read(error)) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(Problem::Read(error)) => return Err(OutputError::unreadable(&path, &error)),
            Err(problem) => return Err(damaged(&problem.to_string())),
            Ok(sections) => sections,
        };
        let mut sections: BTreeMap<String, Vec<u8>> = sections.into_iter().collect();
        let mut take = |name: &str| sections.remove(name);
        let odd = || damaged("not a checkpoint of this program");
        if take("case").as_deref() != Some(folder.without_plot_options().as_bytes()) {
            return Err(damaged("a checkpoint of another case"));
        }
        let about: Value =
            take("about").and_then(|own| serde_json::from_slice(&own).ok()).ok_or_else(odd)?;
        let number = |value: &Value| value.as_u64();
        let pair = |own: &Value| {
            let checksum = number(&own[1]).and_then(|own| u32::try_from(own).ok());
            Some(Written { length: number(&own[0])?, checksum: checksum? })
        };
        let pairs = |name: &str| -> Option<Vec<Written>> {
            about[name].as_array()?.iter().map(pair).collect()
        };
        let [tables, snapshots] = ["tables", "snapshots"].map(pairs);
        let [steps, time, start] = ["steps", "time", "start"].map(|name| number(&about[name]));
        let (Some(tables), Some(snapshots)) = (tables, snapshots) else { return Err(odd()) };
        let (Some(steps), Some(time), Some(start)) = (steps, time, start) else {
            return Err(odd());
        };
        let state = State {
            steps: usize::try_from(steps).map_err(|_| odd())?,
            time: f64::from_bits(time),
            initial_energy: f64::from_bits(start),
            sections,
        };
        Ok(Some(Self { tables, snapshots, state }))
    }

    /// Its tables by files, in the order in which a run of the case has them.
    ///
    /// # Errors
    /// The case does not say how it is run in time.
    pub(in crate::cli) fn tables_of(
        &self,
        case: &Case,
    ) -> Result<Vec<(AppendedFile, Written)>, crate::Error> {
        let has_receivers = match case.in_time()? {
            InTime::Solid(own) => !own.receivers.is_empty(),
            InTime::Flow(own) => !own.receivers.is_empty(),
        };
        let all = [
            has_receivers.then_some(AppendedFile::Receivers),
            Some(AppendedFile::Ledger),
            case.flow.is_some().then_some(AppendedFile::Spectrum),
        ];
        Ok(all.into_iter().flatten().zip(self.tables.iter().copied()).collect())
    }

    /// That its state is none of this run's.
    pub(in crate::cli) fn refused(folder: &ResultFolder) -> OutputError {
        let path = folder.path_of(AppendedFile::Checkpoint);
        OutputError::unusable(&path, "its fields are not those of the case")
    }
}
