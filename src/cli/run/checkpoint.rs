//! What a run needs to go on: state, and what its tables held.

use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, not_written};
use dynamics::simulation::State;
use files::append::Written;
use files::sealed::{Problem, read_sealed, write_sealed};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// A checkpoint of a solid or a flow.
pub(in crate::cli) struct Checkpoint {
    /// What stands in the tables.
    pub(super) tables: Vec<Written>,
    /// The state.
    pub(in crate::cli) state: State,
}

impl Checkpoint {
    /// Writes it, whole or not at all.
    pub(super) fn write(&self, folder: &ResultFolder) -> Result<(), OutputError> {
        let State { steps, time, initial_energy, sections: numbers } = &self.state;
        let tables: Vec<[u64; 2]> =
            self.tables.iter().map(|table| [table.length, table.checksum.into()]).collect();
        let about = json!({
            "steps": steps,
            "time": time.to_bits(),
            "tables": tables,
            "start": initial_energy.to_bits(),
        })
        .to_string();
        let mut sections: Vec<(&str, &[u8])> =
            vec![("case", folder.undrawn().as_bytes()), ("about", about.as_bytes())];
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
        if take("case").as_deref() != Some(folder.undrawn().as_bytes()) {
            return Err(damaged("a checkpoint of another case"));
        }
        let about: Value =
            take("about").and_then(|own| serde_json::from_slice(&own).ok()).ok_or_else(odd)?;
        let number = |value: &Value| value.as_u64();
        let table = |table: &Value| {
            let checksum = number(&table[1]).and_then(|own| u32::try_from(own).ok());
            Some(Written { length: number(&table[0])?, checksum: checksum? })
        };
        let tables = about["tables"].as_array().and_then(|all| all.iter().map(table).collect());
        let [steps, time, start] = ["steps", "time", "start"].map(|name| number(&about[name]));
        let (Some(tables), Some(steps), Some(time), Some(start)) = (tables, steps, time, start)
        else {
            return Err(odd());
        };
        let state = State {
            steps: usize::try_from(steps).map_err(|_| odd())?,
            time: f64::from_bits(time),
            initial_energy: f64::from_bits(start),
            sections,
        };
        Ok(Some(Self { tables, state }))
    }

    /// That its state is none of this run's.
    pub(super) fn refused(folder: &ResultFolder) -> OutputError {
        let path = folder.path_of(AppendedFile::Checkpoint);
        OutputError::unusable(&path, "its fields are not those of the case")
    }
}
