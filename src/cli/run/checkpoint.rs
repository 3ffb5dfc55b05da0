//! Checkpoint of a run: the state, and the lengths and checksums of its tables and snapshots.

use crate::case::{Case, TimeDomainRun};
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, create_write_error};
use dynamics::simulation::SimulationState;
use files::FileDigest;
use files::section_file::{SectionFileProblem, read_sections, write_sections};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::ErrorKind;

/// Checkpoint of a simulation of a solid or a flow.
pub(in crate::cli) struct Checkpoint {
    /// Lengths and checksums of the tables in the order receivers (if any), ledger, spectrum (flows only).
    pub(in crate::cli) table_digests: Vec<FileDigest>,
    /// Lengths and checksums of the files of all snapshots so far, by index.
    pub(in crate::cli) snapshot_digests: Vec<FileDigest>,
    /// Complete state of the solver.
    pub(in crate::cli) solver_state: SimulationState,
}

impl Checkpoint {
    /// Writes the checkpoint to the results folder atomically.
    pub(super) fn write(&self, folder: &ResultFolder) -> Result<(), OutputError> {
        let SimulationState { steps, time, initial_energy, sections: numbers } = &self.solver_state;
        let pairs = |files: &[FileDigest]| -> Vec<[u64; 2]> {
            files.iter().map(|own| [own.length, own.checksum.into()]).collect()
        };
        let about = json!({
            "steps": steps,
            "time": time.to_bits(),
            "tables": pairs(&self.table_digests),
            "snapshots": pairs(&self.snapshot_digests),
            "start": initial_energy.to_bits(),
        })
        .to_string();
        let mut sections: Vec<(&str, &[u8])> = vec![
            ("case", folder.case_without_plot_options().as_bytes()),
            ("about", about.as_bytes()),
        ];
        sections.extend(numbers.iter().map(|(name, own)| (name.as_str(), own.as_slice())));
        let path = folder.file_path(AppendedFile::Checkpoint);
        write_sections(&path, &sections).map_err(|error| create_write_error(&path, &error))
    }

    /// Reads the checkpoint of a folder; `None` if the run had not written one yet.
    ///
    /// # Errors
    /// The checkpoint cannot be read, is damaged or is of another case.
    pub(in crate::cli) fn read(folder: &ResultFolder) -> Result<Option<Self>, OutputError> {
        let path = folder.file_path(AppendedFile::Checkpoint);
        let damaged = |cause: &str| OutputError::from_invalid_content(&path, cause);
        let sections = match read_sections(&path).map_err(|error| error.problem) {
            Err(SectionFileProblem::Io(error)) if error.kind() == ErrorKind::NotFound => {
                return Ok(None);
            }
            Err(SectionFileProblem::Io(error)) => {
                return Err(OutputError::from_read_error(&path, &error));
            }
            Err(problem) => return Err(damaged(&problem.to_string())),
            Ok(sections) => sections,
        };
        let mut sections: BTreeMap<String, Vec<u8>> = sections.into_iter().collect();
        let mut take = |name: &str| sections.remove(name);
        let odd = || damaged("not a checkpoint of this program");
        if take("case").as_deref() != Some(folder.case_without_plot_options().as_bytes()) {
            return Err(damaged("a checkpoint of another case"));
        }
        let about: Value =
            take("about").and_then(|own| serde_json::from_slice(&own).ok()).ok_or_else(odd)?;
        let number = |value: &Value| value.as_u64();
        let pair = |own: &Value| {
            let checksum = number(&own[1]).and_then(|own| u32::try_from(own).ok());
            Some(FileDigest { length: number(&own[0])?, checksum: checksum? })
        };
        let pairs = |name: &str| -> Option<Vec<FileDigest>> {
            about[name].as_array()?.iter().map(pair).collect()
        };
        let [tables, snapshots] = ["tables", "snapshots"].map(pairs);
        let [steps, time, start] = ["steps", "time", "start"].map(|name| number(&about[name]));
        let (Some(tables), Some(snapshots)) = (tables, snapshots) else { return Err(odd()) };
        let (Some(steps), Some(time), Some(start)) = (steps, time, start) else {
            return Err(odd());
        };
        let state = SimulationState {
            steps: usize::try_from(steps).map_err(|_| odd())?,
            time: f64::from_bits(time),
            initial_energy: f64::from_bits(start),
            sections,
        };
        Ok(Some(Self { table_digests: tables, snapshot_digests: snapshots, solver_state: state }))
    }

    /// Returns the tables covered by the checkpoint with their lengths and checksums, in the order in which a run of
    /// the case creates them: receivers, ledger, spectrum.
    ///
    /// # Errors
    /// The case has no simulation.
    pub(in crate::cli) fn list_table_files(
        &self,
        case: &Case,
    ) -> Result<Vec<(AppendedFile, FileDigest)>, crate::Error> {
        let has_receivers = match case.time_domain_run()? {
            TimeDomainRun::Solid(own) => !own.receivers.is_empty(),
            TimeDomainRun::Flow(own) => !own.receivers.is_empty(),
        };
        let all = [
            has_receivers.then_some(AppendedFile::Receivers),
            Some(AppendedFile::Ledger),
            case.flow_run.is_some().then_some(AppendedFile::Spectrum),
        ];
        Ok(all.into_iter().flatten().zip(self.table_digests.iter().copied()).collect())
    }

    /// Creates the error that the saved solver state does not match the fields of the case.
    pub(in crate::cli) fn create_mismatch_error(folder: &ResultFolder) -> OutputError {
        let path = folder.file_path(AppendedFile::Checkpoint);
        OutputError::from_invalid_content(&path, "its fields are not those of the case")
    }
}
