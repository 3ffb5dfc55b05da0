//! Checkpoint of a run: the state, and the lengths and checksums of its tables and snapshots.

use crate::case::{Case, TimeDomainRun};
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, is_part_name};
use crate::cli::parts::{StateFile, StateFiles, write_state_sections};
use crate::study::simulate::RestoreState;
use dynamics::simulation::{SimulationState, StatePart, StateSource};
use files::FileDigest;
use files::section_file::{SectionFileProblem, read_sections, visit_sections};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Checkpoint of a simulation of a solid or a flow.
pub(in crate::cli) struct Checkpoint {
    /// Lengths and checksums of the tables in the order receivers (if any), ledger, spectrum (flows only).
    pub(in crate::cli) table_digests: Vec<FileDigest>,
    /// Snapshots so far, by index.
    pub(in crate::cli) snapshots: Vec<SnapshotFiles>,
    /// State of the solver without values by cell; without all sections if the checkpoint was read.
    pub(in crate::cli) solver_state: SimulationState,
    /// Files with the sections of the state, one per rank; `None` if they are in the checkpoint itself.
    part_files: Option<Vec<StateFile>>,
    path: PathBuf,
}

/// Files of a snapshot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::cli) struct SnapshotFiles {
    /// Names in the lists of snapshots: that of the fields, and that of the joints if they have a file for ParaView.
    pub(in crate::cli) names: Vec<String>,
    /// Names, lengths and checksums of all files.
    pub(in crate::cli) files: Vec<(String, FileDigest)>,
}

/// Section that lists the files of the parts of a state.
const PARTS_SECTION: &str = "parts";

/// Sections of a checkpoint that are not part of the state.
const OWN_SECTIONS: [&str; 3] = ["case", "about", PARTS_SECTION];

/// Creates the content of [`PARTS_SECTION`]: names and cells of the files of all ranks.
pub(in crate::cli) fn create_part_sections(
    parts: &[(String, Vec<Range<usize>>)],
) -> BTreeMap<String, Vec<u8>> {
    let ends = |cells: &Vec<Range<usize>>| -> Vec<[usize; 2]> {
        cells.iter().map(|own| [own.start, own.end]).collect()
    };
    let list: Vec<Value> = parts.iter().map(|(name, cells)| json!([name, ends(cells)])).collect();
    [(PARTS_SECTION.to_owned(), Value::from(list).to_string().into_bytes())].into()
}

impl Checkpoint {
    /// Creates a checkpoint to be written to a folder.
    pub(super) fn new(
        folder: &ResultFolder,
        table_digests: Vec<FileDigest>,
        snapshots: Vec<SnapshotFiles>,
        solver_state: SimulationState,
    ) -> Self {
        let path = folder.file_path(AppendedFile::Checkpoint);
        Self { table_digests, snapshots, solver_state, part_files: None, path }
    }

    /// Writes the checkpoint to the results folder atomically, with the values by cell of `cells`, if it has them.
    pub(super) fn write(
        &self,
        folder: &ResultFolder,
        cells: Option<&dyn StateSource>,
    ) -> Result<(), OutputError> {
        let SimulationState { steps, time, initial_energy, sections: numbers } = &self.solver_state;
        let digest = |own: &FileDigest| [own.length, own.checksum.into()];
        let snapshot = |own: &SnapshotFiles| {
            let files = own.files.iter().map(|(name, own)| json!([name, own.length, own.checksum]));
            json!({ "names": own.names, "files": files.collect::<Vec<_>>() })
        };
        let about = json!({
            "steps": steps,
            "time": time.to_bits(),
            "tables": self.table_digests.iter().map(digest).collect::<Vec<_>>(),
            "snapshots": self.snapshots.iter().map(snapshot).collect::<Vec<_>>(),
            "start": initial_energy.to_bits(),
        })
        .to_string();
        let mut sections: Vec<(&str, &[u8])> = vec![
            ("case", folder.case_without_plot_options().as_bytes()),
            ("about", about.as_bytes()),
        ];
        sections.extend(numbers.iter().map(|(name, own)| (name.as_str(), own.as_slice())));
        write_state_sections(&self.path, &sections, cells)
    }

    /// Reads the checkpoint of a folder; `None` if the run had not written one yet. The state of the solver remains on
    /// disk, see [`Self::open_state`].
    ///
    /// # Errors
    /// The checkpoint cannot be read, is damaged or is of another case.
    pub(in crate::cli) fn read(folder: &ResultFolder) -> Result<Option<Self>, OutputError> {
        let path = folder.file_path(AppendedFile::Checkpoint);
        Self::read_file(path, folder.case_without_plot_options())
    }

    /// Reads the checkpoint of a case, without its plot options, as [`Self::read`] does.
    pub(in crate::cli) fn read_file(
        path: PathBuf,
        case: &str,
    ) -> Result<Option<Self>, OutputError> {
        let damaged = |cause: &str| OutputError::from_invalid_content(&path, cause);
        let mut sections: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        let read = visit_sections(&path, |name, _, content| {
            if OWN_SECTIONS.contains(&name) {
                content.read_to_end(sections.entry(name.to_owned()).or_default())?;
            }
            Ok(())
        });
        match read.map_err(|error| error.problem) {
            Err(SectionFileProblem::Io(error)) if error.kind() == ErrorKind::NotFound => {
                return Ok(None);
            }
            Err(SectionFileProblem::Io(error)) => {
                return Err(OutputError::from_read_error(&path, &error));
            }
            Err(problem) => return Err(damaged(&problem.to_string())),
            Ok(()) => {}
        }
        let odd = || damaged("not a checkpoint of this program");
        if sections.get("case").map(Vec::as_slice) != Some(case.as_bytes()) {
            return Err(damaged("a checkpoint of another case"));
        }
        let json = |name: &str| serde_json::from_slice(sections.get(name)?).ok();
        let about = json("about").and_then(|about: Value| parse_about(&about)).ok_or_else(odd)?;
        let part_files = match sections.contains_key(PARTS_SECTION) {
            false => None,
            true => {
                let parts = json(PARTS_SECTION).and_then(|parts| parse_parts(&parts, &path));
                Some(parts.ok_or_else(odd)?)
            }
        };
        let (table_digests, snapshots, solver_state) = about;
        Ok(Some(Self { table_digests, snapshots, solver_state, part_files, path }))
    }

    /// Opens the state of a part of the cells; of flows, which have no parts, the whole state.
    ///
    /// # Errors
    /// A file cannot be read or is damaged.
    pub(in crate::cli) fn open_state(
        &self,
        part: Option<&StatePart>,
    ) -> Result<OpenedState, OutputError> {
        let (cells, sections) = match part {
            Some(part) => {
                let grid = || part.grid_cells.iter().map(|count| 0..*count).collect();
                let whole = || vec![StateFile { path: self.path.clone(), cells: grid() }];
                let sources = self.part_files.clone().unwrap_or_else(whole);
                let (files, sections) = StateFiles::open(sources, part.clone())?;
                (Some(files), sections)
            }
            None => {
                let sections = read_sections(&self.path).map_err(|error| {
                    OutputError::from_invalid_content(&self.path, error.problem)
                })?;
                let of_state = |own: &(String, _)| !OWN_SECTIONS.contains(&&*own.0);
                (None, sections.into_iter().filter(of_state).collect())
            }
        };
        Ok(OpenedState { state: SimulationState { sections, ..self.solver_state.clone() }, cells })
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

/// State of a checkpoint that has been opened; by default one that matches no case.
#[derive(Default)]
pub(in crate::cli) struct OpenedState {
    /// State without values by cell.
    state: SimulationState,
    /// Files with the values by cell; `None` (flows) if there are none.
    cells: Option<StateFiles>,
}

impl OpenedState {
    /// Restores the state by `restore` and returns its result.
    ///
    /// # Errors
    /// A file cannot be read or is damaged.
    pub(in crate::cli) fn restore(
        &mut self,
        restore: &mut RestoreState,
    ) -> Result<Option<usize>, OutputError> {
        let Self { state, cells } = self;
        let Some(files) = cells else { return Ok(restore(state, &mut &*state)) };
        let restored = restore(state, files);
        files.error.take().map_or(Ok(restored), Err)
    }
}

/// Returns the digests of tables, the snapshots and the state without sections; `None` if the description is another one.
fn parse_about(about: &Value) -> Option<(Vec<FileDigest>, Vec<SnapshotFiles>, SimulationState)> {
    let digest = |length: &Value, checksum: &Value| {
        let checksum = u32::try_from(checksum.as_u64()?).ok()?;
        Some(FileDigest { length: length.as_u64()?, checksum })
    };
    let file = |own: &Value| Some((own[0].as_str()?.to_owned(), digest(&own[1], &own[2])?));
    let snapshot = |own: &Value| {
        let names = own["names"].as_array()?.iter().map(|name| Some(name.as_str()?.to_owned()));
        let files = own["files"].as_array()?.iter().map(file);
        Some(SnapshotFiles {
            names: names.collect::<Option<_>>()?,
            files: files.collect::<Option<_>>()?,
        })
    };
    let tables = about["tables"].as_array()?.iter().map(|own| digest(&own[0], &own[1]));
    let snapshots = about["snapshots"].as_array()?.iter().map(snapshot);
    let state = SimulationState {
        steps: usize::try_from(about["steps"].as_u64()?).ok()?,
        time: f64::from_bits(about["time"].as_u64()?),
        initial_energy: f64::from_bits(about["start"].as_u64()?),
        sections: BTreeMap::new(),
    };
    Some((tables.collect::<Option<_>>()?, snapshots.collect::<Option<_>>()?, state))
}

/// Returns the files of [`PARTS_SECTION`] in the folder of the checkpoint `path`; `None` if it is another text.
fn parse_parts(parts: &Value, path: &Path) -> Option<Vec<StateFile>> {
    let index = |value: &Value| usize::try_from(value.as_u64()?).ok();
    let range = |own: &Value| Some(index(&own[0])?..index(&own[1])?).filter(|own| !own.is_empty());
    let part = |own: &Value| {
        let name = own[0].as_str().filter(|name| is_part_name(name))?;
        let cells = own[1].as_array()?.iter().map(range).collect::<Option<_>>()?;
        Some(StateFile { path: path.with_file_name(name), cells })
    };
    parts.as_array()?.iter().map(part).collect()
}
