//! State of a part of the cells, read from the files of other parts: checkpoints do not depend on the number of ranks.

use super::boxes::{BoxCopy, count_cells};
use crate::cli::folder::OutputError;
use dynamics::simulation::StatePart;
use files::section_file::{SectionFileProblem, visit_sections};
use std::collections::BTreeMap;
use std::io::{self, Read};
use std::ops::Range;
use std::path::PathBuf;

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

/// Reads the sections of the state of a part from the files of other parts, of which none is read into memory as a whole.
///
/// # Errors
/// A file cannot be read or is damaged.
pub(in crate::cli) fn read_state_sections(
    sources: &[StateFile],
    part: &StatePart,
) -> Result<BTreeMap<String, Vec<u8>>, OutputError> {
    let mut sections: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut histories: BTreeMap<[usize; 3], Vec<u8>> = BTreeMap::new();
    for StateFile { path, cells } in sources {
        let copy = BoxCopy::new(cells, &part.cells);
        // All files have the sums of the whole; the first one gives them, even to a part that has none of its cells.
        if copy.is_empty() && !sections.is_empty() {
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
                let size = usize::try_from(length).unwrap_or(0) / count_cells(cells).max(1);
                let values = sections.entry(name.to_owned()).or_default();
                values.resize(size * part.cell_count(), 0);
                copy.read(size, content, values)?;
            }
            Ok(())
        });
        read.map_err(|error| match error.problem {
            SectionFileProblem::Io(error) => OutputError::from_read_error(path, &error),
            problem => OutputError::from_invalid_content(path, problem),
        })?;
    }
    if !part.interlayers.is_empty() {
        let history = histories.into_values().flatten().collect();
        sections.insert(HISTORY_SECTION.to_owned(), history);
    }
    Ok(sections)
}

fn read_all(content: &mut dyn Read) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    content.read_to_end(&mut bytes)?;
    Ok(bytes)
}
