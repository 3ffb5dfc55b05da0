//! Files that each rank writes for its own cells, into the results folder of the root.

use super::RankError;
use crate::Error;
use crate::case::Case;
use crate::cli::folder::{
    OutputError, PartFile, create_write_error, has_joint_files, snapshot_index_name,
};
use crate::cli::parts::{write_fields, write_joints, write_state_sections};
use crate::cli::run::create_part_sections;
use crate::report::run::{format_image_index, write_image};
use crate::study::simulate::{FieldSource, OutputFields, OutputPart, SavedState};
use dynamics::decomposition::communicator::Communicator;
use dynamics::simulation::SimulationState;
use files::vti::{PieceFile, Storage};
use files::{DigestWriter, FileDigest, write_atomically_with};
use serde_json::{Value, json};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files of the ranks: at the root those of all, at other ranks none.
pub(super) type RankFiles = Vec<(String, FileDigest)>;

/// Writer of the files of a rank. All ranks make the same calls.
pub(super) struct PartWriter<'a> {
    pub(super) communicator: &'a Arc<dyn Communicator>,
    pub(super) case: &'a Case,
    /// Results folder.
    pub(super) folder: PathBuf,
    /// Cells of the rank; known when the simulation starts.
    pub(super) part: Option<OutputPart>,
}

impl PartWriter<'_> {
    /// Returns the results of all ranks at the root, in their order, or the error of the first rank that has one; at the
    /// other ranks nothing, and no error.
    fn collect(&self, own: Result<Value, Error>) -> Result<Vec<Value>, RankError> {
        let own = match own {
            Ok(own) => json!({ "own": own }),
            Err(error) => json!({ "error": error.to_string() }),
        };
        let (mut all, mut failed) = (Vec::new(), None);
        self.communicator.gather(own.to_string().into_bytes(), &mut |rank, message| {
            let mut own: Value = serde_json::from_slice(&message).unwrap_or_default();
            if let Some(cause) = own["error"].as_str() {
                failed.get_or_insert(RankError::OtherRank { rank, cause: cause.to_owned() });
            }
            all.push(own["own"].take());
        });
        failed.map_or(Ok(all), Err)
    }

    /// Returns the files of all ranks at the root.
    fn collect_files(&self, own: Result<RankFiles, Error>) -> Result<RankFiles, RankError> {
        let list = |files: RankFiles| {
            let file = |(name, own): (String, FileDigest)| json!([name, own.length, own.checksum]);
            files.into_iter().map(file).collect()
        };
        let file = |own: &Value| {
            let digest = FileDigest {
                length: own[1].as_u64().unwrap_or_default(),
                checksum: own[2].as_u64().unwrap_or_default() as u32, // written as one
            };
            (own[0].as_str().unwrap_or_default().to_owned(), digest)
        };
        let all = self.collect(own.map(list))?;
        Ok(all.iter().filter_map(Value::as_array).flatten().map(file).collect())
    }

    fn name(&self, file: PartFile) -> String {
        file.name(self.case, self.communicator.rank())
    }

    fn own_cells(&self) -> &[Range<usize>] {
        self.part.as_ref().map_or(&[], |part| &part.cells)
    }

    /// Checks at the start that all ranks see the lock file of the run, which the root has created.
    pub(super) fn check_shared_folder(&self) -> Result<(), RankError> {
        let lock = self.folder.join(crate::cli::folder::AppendedFile::Lock.name());
        let found = match lock.symlink_metadata() {
            Ok(_) => Ok(Value::Null),
            Err(_) => Err(OutputError {
                path: self.folder.clone(),
                cause: "the results folder of rank 0 is not visible here".to_owned(),
                remedy: "name a folder on a file system that all machines share with --out",
            }),
        };
        let found = found.map_err(|error| crate::cli::CommandError::from(error).into());
        self.collect(found).map(drop)
    }

    /// Writes the state of the rank for a checkpoint. Returns the state with the list of the files of all ranks instead
    /// of its sections.
    pub(super) fn write_state(
        &self,
        SavedState { without_cells: state, cells }: SavedState,
    ) -> Result<SavedState<'static>, RankError> {
        let name = self.name(PartFile::Checkpoint(state.steps));
        let path = self.folder.join(&name);
        let sections: Vec<(&str, &[u8])> =
            state.sections.iter().map(|(name, own)| (name.as_str(), own.as_slice())).collect();
        let written =
            write_state_sections(&path, &sections, cells).map_err(crate::cli::CommandError::from);
        let cells = self.part.as_ref().map_or(&[][..], |part| &part.state.cells);
        let ends: Vec<[usize; 2]> = cells.iter().map(|own| [own.start, own.end]).collect();
        let parts = self.collect(written.map(|()| json!([name, ends])).map_err(Error::from))?;
        let index = |own: &Value| own.as_u64().unwrap_or_default() as usize;
        let part = |own: &Value| {
            let ends = own[1].as_array().into_iter().flatten();
            let cells = ends.map(|own| index(&own[0])..index(&own[1])).collect();
            (own[0].as_str().unwrap_or_default().to_owned(), cells)
        };
        let parts: Vec<(String, Vec<Range<usize>>)> = parts.iter().map(part).collect();
        let without_cells = SimulationState { sections: create_part_sections(&parts), ..state };
        Ok(SavedState { without_cells, cells: None })
    }

    /// Writes the fields of the rank for a snapshot. Returns the files of all ranks and the index for ParaView.
    pub(super) fn write_snapshot(
        &self,
        index: usize,
        fields: &dyn FieldSource,
    ) -> Result<(RankFiles, Vec<u8>), Error> {
        let cells = self.own_cells();
        let write = || -> Result<(RankFiles, Value), Error> {
            let name = self.name(PartFile::Snapshot(index));
            let path = self.folder.join(&name);
            let mut digest = FileDigest::default();
            let written = write_atomically_with(&path, |file| {
                let mut writer = DigestWriter::new(file);
                let options = (cells, Storage::Compressed);
                write_image(self.case, fields, options, &mut writer, &self.folder)
                    .map_err(io::Error::other)?;
                digest = writer.finish()?;
                Ok(())
            });
            written.map_err(|error| {
                crate::cli::CommandError::from(create_write_error(&path, &error))
            })?;
            let mut files = vec![(name.clone(), digest)];
            if has_joint_files(self.case) {
                let name = self.name(PartFile::SnapshotJoints(index));
                let OutputFields { joint_faces, time, .. } = fields.describe();
                files.push(
                    self.write_part(name, |path| write_joints(path, (&joint_faces, time), cells))?,
                );
            }
            let ends: Vec<[usize; 2]> = cells.iter().map(|own| [own.start, own.end]).collect();
            Ok((files, json!([name, ends])))
        };
        let (files, piece) = write()
            .map_or_else(|error| (Err(error), Value::Null), |(files, piece)| (Ok(files), piece));
        let files = self.collect_files(files);
        let pieces = self.collect(Ok(piece));
        let (files, pieces) = (
            files.map_err(crate::cli::CommandError::from)?,
            pieces.map_err(crate::cli::CommandError::from)?,
        );
        if !self.communicator.is_root() {
            return Ok((files, Vec::new()));
        }
        let number = |own: &Value| own.as_u64().unwrap_or_default() as usize;
        let piece = |own: &Value| PieceFile {
            cells: own[1]
                .as_array()
                .into_iter()
                .flatten()
                .map(|own| number(&own[0])..number(&own[1]))
                .collect(),
            file: own[0].as_str().unwrap_or_default().to_owned(),
        };
        let pieces: Vec<PieceFile> = pieces.iter().map(piece).collect();
        Ok((files, format_image_index(self.case, fields, cells, &pieces)?))
    }

    /// Returns the name of the index of a snapshot.
    pub(super) fn index_name(&self, index: usize) -> String {
        snapshot_index_name(self.case, index)
    }

    /// Writes the final fields of the rank; returns the files of all ranks.
    pub(super) fn write_fields(&self, fields: &dyn FieldSource) -> Result<RankFiles, RankError> {
        let written = self.write_part(self.name(PartFile::Fields), |path| {
            write_fields(path, fields, self.own_cells())
        });
        self.collect_files(written.map(|own| vec![own]))
    }

    fn write_part(
        &self,
        name: String,
        write: impl FnOnce(&Path) -> Result<(), OutputError>,
    ) -> Result<(String, FileDigest), Error> {
        let path = self.folder.join(&name);
        let written = write(&path).and_then(|()| {
            FileDigest::from_file(&path)
                .map_err(|error| OutputError::from_read_error(&path, &error))
        });
        Ok((name, written.map_err(crate::cli::CommandError::from)?))
    }
}
