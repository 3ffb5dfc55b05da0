//! State of a part of the cells, written to a file of its own and read from those of other parts: checkpoints do not
//! depend on the number of ranks.

use super::boxes::{BoxCopy, count_cells};
use super::fields::describe_error;
use crate::cli::folder::{OutputError, create_write_error};
use dynamics::simulation::{CellSections, StatePart, StateSource};
use files::section_file::{visit_section, visit_sections, write_sections_in_pieces};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Section with the positions of interlayers, which precedes that with their history variables.
const FACES_SECTION: &str = "interlayer_faces";

/// Section with the history variables of interlayers.
const HISTORY_SECTION: &str = "interlayers";

/// File with the sections of the state of a box of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) struct StateFile {
    pub(in crate::cli) path: PathBuf,
    /// Cells along the axes of the lists of a state.
    pub(in crate::cli) cells: Vec<Range<usize>>,
}

/// Writes sections, and those with values by cell of a state, of which a part of one is in memory at a time.
///
/// # Errors
/// The file cannot be written.
pub(in crate::cli) fn write_state_sections(
    path: &Path,
    sections: &[(&str, &[u8])],
    cells: Option<&dyn StateSource>,
) -> Result<(), OutputError> {
    let of_cells = cells.map_or(Vec::new(), StateSource::cell_sections);
    let lengths = sections.iter().map(|(name, content)| (*name, content.len()));
    let lengths: Vec<(&str, usize)> =
        lengths.chain(of_cells.iter().map(|(name, length)| (name.as_str(), *length))).collect();
    let written = write_sections_in_pieces(path, &lengths, |pieces| {
        for (index, (_, content)) in sections.iter().enumerate() {
            pieces.append(index, content)?;
        }
        let Some(source) = cells else { return Ok(()) };
        for (index, (name, _)) in of_cells.iter().enumerate() {
            source.read_cell_section(name, &mut |piece| {
                pieces.append(sections.len() + index, piece)
            })?;
        }
        Ok(())
    });
    written.map_err(|error| create_write_error(path, &error))
}

/// State of a part of the cells in the files of other parts, whose sections with values by cell are read one by one.
pub(in crate::cli) struct StateFiles {
    sources: Vec<StateFile>,
    part: StatePart,
    /// Names of the sections with values by cell, and lengths for this part, bytes.
    lengths: BTreeMap<String, usize>,
    /// Content of the section that was read last.
    content: Vec<u8>,
    /// First error of a section.
    pub(in crate::cli) error: Option<OutputError>,
}

impl StateFiles {
    /// Opens the files of the parts, all of whose checksums are verified. Returns also the sections without values by cell.
    ///
    /// # Errors
    /// A file cannot be read or is damaged.
    pub(in crate::cli) fn open(
        sources: Vec<StateFile>,
        part: StatePart,
    ) -> Result<(Self, BTreeMap<String, Vec<u8>>), OutputError> {
        let mut sections: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        let mut lengths = BTreeMap::new();
        let mut histories: BTreeMap<[usize; 3], Vec<u8>> = BTreeMap::new();
        for StateFile { path, cells } in &sources {
            let is_apart = BoxCopy::new(cells, &part.cells).is_empty();
            // All files have the sums of the whole; the first one gives them, even to a part that has none of its cells.
            if is_apart && !sections.is_empty() {
                continue;
            }
            let mut faces: Vec<[usize; 4]> = Vec::new();
            let read = visit_sections(path, |name, length, content| {
                if name.starts_with("work") {
                    if !sections.contains_key(name) {
                        sections.insert(name.to_owned(), read_all(content)?);
                    }
                } else if name == FACES_SECTION {
                    let bytes = read_all(content)?;
                    let numbers: Vec<usize> = bytes
                        .as_chunks()
                        .0
                        .iter()
                        .map(|own| u64::from_le_bytes(*own) as usize)
                        .collect();
                    faces = numbers.as_chunks().0.to_vec();
                } else if name == HISTORY_SECTION {
                    let count: usize = faces.iter().map(|face| face[3]).sum();
                    let size = usize::try_from(length).unwrap_or(0) / count.max(1);
                    for [layer, axis, cell, variables] in faces.drain(..) {
                        let mut history = vec![0; size * variables];
                        content.read_exact(&mut history)?;
                        let position = [layer, axis, cell];
                        if part.interlayers.binary_search_by_key(&position, |own| own.0).is_ok() {
                            histories.insert(position, history);
                        }
                    }
                } else if ["field", "sums"].iter().any(|kind| name.starts_with(kind)) {
                    let length = value_size(length, cells) * part.cell_count();
                    lengths.entry(name.to_owned()).or_insert(length);
                }
                Ok(())
            });
            read.map_err(|error| describe_error(path, error))?;
        }
        if !part.interlayers.is_empty() {
            let history = histories.into_values().flatten().collect();
            sections.insert(HISTORY_SECTION.to_owned(), history);
        }
        Ok((Self { sources, part, lengths, content: Vec::new(), error: None }, sections))
    }

    /// Reads the values by cell of the part in a section.
    fn read_section(&mut self, name: &str) -> Result<(), OutputError> {
        self.content.clear();
        self.content.resize(self.lengths.get(name).copied().unwrap_or_default(), 0);
        for StateFile { path, cells } in &self.sources {
            let copy = BoxCopy::new(cells, &self.part.cells);
            if copy.is_empty() {
                continue;
            }
            let (values, mut is_found) = (&mut self.content, false);
            let read = visit_section(path, name, |length, content| {
                is_found = true;
                copy.read(value_size(length, cells), content, values)
            });
            read.map_err(|error| describe_error(path, error))?;
            if !is_found {
                let cause = format!("has no section \"{name}\"");
                return Err(OutputError::from_invalid_content(path, cause));
            }
        }
        Ok(())
    }
}

impl CellSections for StateFiles {
    fn length(&self, name: &str) -> Option<usize> {
        self.lengths.get(name).copied()
    }

    fn read(&mut self, name: &str) -> Option<Cow<'_, [u8]>> {
        match self.read_section(name) {
            Ok(()) => Some(Cow::from(&self.content)),
            Err(error) => {
                self.error.get_or_insert(error);
                None
            }
        }
    }
}

/// Returns the size of the value of a cell in a section with values of some cells, bytes.
fn value_size(length: u64, cells: &[Range<usize>]) -> usize {
    usize::try_from(length).unwrap_or(0) / count_cells(cells).max(1)
}

fn read_all(content: &mut dyn Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    content.read_to_end(&mut bytes)?;
    Ok(bytes)
}
