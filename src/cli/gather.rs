//! `wellposed gather`: joins the parts that several ranks have written to the files of a single process.

use super::folder::{
    FIELDS_ARCHIVE_FILE, OutputError, PartFile, Publication, ResultFolder, SNAPSHOT_LIST_FILE,
    ZARR_STORE_FILE, has_joint_files, is_part_name, joint_snapshot_file_name, list_part_names,
    snapshot_file_name, snapshot_file_names,
};
use super::load::print_hints;
use super::parts::{BoxCopy, FieldParts, write_field_archive};
use super::plot::redraw_run;
use super::zarr_store::{list_snapshots, stage_zarr_store};
use crate::case::Case;
use crate::case::dynamics::SolidRun;
use crate::cli::CommandError;
use crate::cli::folder::JOINT_SNAPSHOT_LIST_FILE;
use crate::report::run::{
    create_empty_image, create_joint_lines, create_joint_tables, snapshot_storage,
};
use crate::report::{PictureOptions, WriteContent};
use files::read_regular_file;
use files::vti::{ArrayDeclaration, format_collection, list_arrays, parse_index, read_array_bytes};
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Runs the verb `gather`: joins the parts in the folder of a finished run, draws its pictures and removes the parts. The
/// files are those that a single process would have written. Snapshots are joined array by array. With `zarr_chunk`, the
/// largest number of cells of a chunk along an axis, the snapshots of any run of a solid are also written as a Zarr store.
///
/// # Errors
/// The folder holds no finished run, a part is missing or damaged, or a file cannot be written.
pub fn gather(
    path: &Path,
    zarr_chunk: Option<usize>,
    pictures: &PictureOptions,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let (folder, case) = ResultFolder::open_finished_run(path)?;
    print_hints(&case);
    join_parts(path, (&folder, &case), pictures, stdout)?;
    let Some(chunk_edge) = zarr_chunk else { return Ok(()) };
    let Some(solid_run) = &case.solid_run else {
        return Err(OutputError {
            path: path.to_owned(),
            cause: "the run is one of a flow; only snapshots of solids become a Zarr store"
                .to_owned(),
            remedy: "read the .vts files, or leave out --zarr",
        }
        .into());
    };
    let mut publication = folder.start_redrawing("run");
    stage_zarr_store(&mut publication, (path, &case, solid_run), chunk_edge)?;
    publication.publish()?;
    writeln!(stdout, "wrote {}", path.join(ZARR_STORE_FILE).display())?;
    Ok(())
}

fn join_parts(
    path: &Path,
    (folder, case): (&ResultFolder, &Case),
    pictures: &PictureOptions,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let names = list_part_names(path)?;
    let Some(solid_run) = case.solid_run.as_ref().filter(|_| !names.is_empty()) else {
        writeln!(stdout, "{}: no parts, nothing to join", path.display())?;
        return Ok(());
    };
    folder.check_files(is_part_name)?;
    let parts = Parts { folder: path, case, solid_run, names: &names };
    let mut publication = folder.start_redrawing("run");
    parts.join_snapshots(&mut publication)?;
    parts.join_fields(&mut publication)?;
    names.iter().for_each(|name| publication.schedule_removal(name));
    publication.publish()?;
    writeln!(stdout, "joined {} files in {}", names.len(), path.display())?;
    if let Some(name) = redraw_run(path, pictures)? {
        writeln!(stdout, "picture: {}", path.join(name).display())?;
    }
    Ok(())
}

/// Receiver of joined files.
pub(super) trait JoinedFiles {
    /// Writes a file with the content that `write` produces.
    ///
    /// # Errors
    /// The file cannot be written.
    fn put(&mut self, name: &str, write: &mut WriteContent) -> Result<(), OutputError>;
}

impl JoinedFiles for Publication<'_> {
    fn put(&mut self, name: &str, write: &mut WriteContent) -> Result<(), OutputError> {
        self.stage_with(name, |file| write(file))
    }
}

/// Files of the parts of a run in a folder.
pub(super) struct Parts<'a> {
    pub(super) folder: &'a Path,
    pub(super) case: &'a Case,
    pub(super) solid_run: &'a SolidRun,
    /// Names of the files of parts in the folder.
    pub(super) names: &'a [String],
}

impl Parts<'_> {
    fn grid_cells(&self) -> &[usize] {
        &self.solid_run.grid.cells
    }

    fn grid_box(&self) -> Vec<Range<usize>> {
        self.grid_cells().iter().map(|count| 0..*count).collect()
    }

    /// Joins all snapshots that are in parts, and writes the lists of all.
    fn join_snapshots(&self, publication: &mut Publication) -> Result<(), CommandError> {
        let moments = list_snapshots(self.folder, self.solid_run)?;
        if moments.is_empty() {
            return Ok(());
        }
        for &(index, time) in &moments {
            let name = super::folder::snapshot_index_name(self.case, index);
            if self.names.contains(&name) {
                self.join_snapshot(publication, (index, time), &name)?;
            }
        }
        let lists = [SNAPSHOT_LIST_FILE, JOINT_SNAPSHOT_LIST_FILE];
        let kinds = if has_joint_files(self.case) { 2 } else { 1 };
        for (kind, list) in lists.into_iter().enumerate().take(kinds) {
            let entry = |(index, time): &(usize, f64)| {
                Some((*time, snapshot_file_names(self.case, *index).into_iter().nth(kind)?))
            };
            let entries: Vec<(f64, String)> = moments.iter().filter_map(entry).collect();
            let bytes = format_collection(&entries).map_err(crate::Error::from)?;
            publication.stage_file(list, &bytes)?;
        }
        Ok(())
    }

    /// Joins the parts of a snapshot with an index at a time, s; `name`: file that lists them.
    pub(super) fn join_snapshot(
        &self,
        joined: &mut dyn JoinedFiles,
        (index, time): (usize, f64),
        name: &str,
    ) -> Result<(), CommandError> {
        let path = self.folder.join(name);
        let odd = |path: &Path| OutputError::from_invalid_content(path, "not a part of a snapshot");
        let text = self.read(&path)?;
        let pieces = parse_index(&String::from_utf8_lossy(&text), self.grid_cells().len())
            .filter(|pieces| pieces.iter().all(|piece| is_part_name(&piece.file)))
            .ok_or_else(|| odd(&path))?;
        let first = self.folder.join(&pieces.first().ok_or_else(|| odd(&path))?.file);
        let arrays = list_arrays(&self.read(&first)?).ok_or_else(|| odd(&first))?;
        let grid = self.grid_box();
        let image =
            || create_empty_image(self.case, (time, None), &grid, snapshot_storage(self.case));
        image()?;
        let count = super::parts::count_cells(&grid);
        let fetch = |array: &ArrayDeclaration| -> io::Result<Vec<u8>> {
            let mut joined = vec![0; count * array.cell_size()];
            for piece in &pieces {
                let path = self.folder.join(&piece.file);
                let values = read_array_bytes(&read_regular_file(&path)?, array)
                    .ok_or_else(|| io::Error::other(odd(&path)))?;
                let copy = BoxCopy::new(&piece.cells, &grid);
                copy.read(array.cell_size(), &mut values.as_slice(), &mut joined)?;
            }
            Ok(joined)
        };
        joined.put(&snapshot_file_name(self.case, index), &mut |file| {
            let image = image().map_err(io::Error::other)?;
            image.write_in_pieces(&arrays, file, self.folder, |pieces| {
                arrays
                    .iter()
                    .enumerate()
                    .try_for_each(|(index, array)| pieces.append(index, &fetch(array)?))
            })
        })?;
        if has_joint_files(self.case) {
            let paths =
                self.part_paths(|rank| PartFile::SnapshotJoints(index).name(self.case, rank));
            let joints =
                FieldParts::open(paths, self.grid_cells())?.read_joints(&self.solid_run.grid)?;
            let lines = create_joint_lines(&joints, time)?;
            let name = joint_snapshot_file_name(index);
            joined.put(&name, &mut |file| file.write_all(&lines.to_bytes()))?;
        }
        Ok(())
    }

    /// Joins the final fields and joints.
    fn join_fields(&self, publication: &mut Publication) -> Result<(), CommandError> {
        let paths = self.part_paths(|rank| PartFile::Fields.name(self.case, rank));
        let parts = FieldParts::open(paths, self.grid_cells())?;
        let grid = &self.solid_run.grid;
        publication.stage_with(FIELDS_ARCHIVE_FILE, |file| {
            write_field_archive(&parts, grid, file).map_err(io::Error::other)
        })?;
        let joints = parts.read_joints(grid)?;
        for (name, table) in create_joint_tables(&joints, parts.time)? {
            publication.stage_file(name, &table.encode()?)?;
        }
        Ok(())
    }

    /// Returns the paths of the files with these names by rank.
    fn part_paths(&self, name: impl Fn(usize) -> String) -> Vec<PathBuf> {
        let names = (0..).map(name).take_while(|name| self.names.contains(name));
        names.map(|name| self.folder.join(name)).collect()
    }

    fn read(&self, path: &Path) -> Result<Vec<u8>, OutputError> {
        read_regular_file(path).map_err(|error| OutputError::from_read_error(path, &error))
    }
}
