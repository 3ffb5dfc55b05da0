//! State of the simulation of a solid: its sections, of which those with values by cell are written and read one by one.

use super::super::{
    CellSections, SimulationState, StateSource, from_bytes, number_sections, to_bytes,
};
use super::{SolidAccount, SolidSimulation};
use crate::simd::Real;
use crate::solid::domain::SolverReal;
use crate::solid::snapshot::{Snapshot, StateLists, StatePart};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;

/// Names of the sections of a state: history variables of interlayers, their positions, and the beginnings of those with
/// work sums, fields and sums by cell.
const INTERLAYERS_SECTION: &str = "interlayers";
const INTERLAYER_FACES_SECTION: &str = "interlayer_faces";
const WORK_SECTION: &str = "work";
const FIELD_SECTION: &str = "field";
const SUMS_SECTION: &str = "sums";

impl<T: SolverReal, const D: usize> SolidSimulation<T, D> {
    /// Restores a state as [`Simulation::restore_with_cells`](super::Simulation::restore_with_cells) does.
    pub(super) fn restore_sections(
        &mut self,
        state: &SimulationState,
        cells: &mut dyn CellSections,
    ) -> bool {
        let without_lists = || {
            let work = state
                .numbered_sections(WORK_SECTION)
                .map(from_bytes)
                .collect::<Option<Vec<_>>>()?;
            let interlayers = match state.sections.get(INTERLAYERS_SECTION) {
                Some(bytes) => T::from_bytes(bytes)?,
                None => Vec::new(),
            };
            Some(Snapshot {
                steps: state.steps,
                fields: Vec::new(),
                work_sums: work.try_into().ok()?,
                cell_sums: Vec::new(),
                interlayer_history: interlayers,
            })
        };
        // All ranks must take part, even those whose state is that of another problem: it then has no lists.
        let is_restored = match without_lists() {
            Some(own) => self.solver.restore_lists(&own, &mut SectionLists(cells)),
            None => self.solver.restore(&Snapshot::default()),
        };
        if !is_restored {
            return false;
        }
        self.steps_done = state.steps;
        self.account.initial_energy = state.initial_energy;
        self.account = self.compute_account(self.steps_done);
        self.records.clear();
        true
    }
}

impl<T: SolverReal, const D: usize> StateSource for SolidSimulation<T, D> {
    fn state_without_cells(&self) -> SimulationState {
        let Snapshot { steps, work_sums, interlayer_history, .. } =
            self.solver.snapshot_without_lists();
        let mut sections: BTreeMap<String, Vec<u8>> =
            number_sections(WORK_SECTION, work_sums.iter().map(|parts| to_bytes(parts))).collect();
        if !interlayer_history.is_empty() {
            let StatePart { interlayers, .. } = self.solver.state_part();
            let numbers = interlayers
                .into_iter()
                .flat_map(|([layer, axis, cell], variables)| [layer, axis, cell, variables]);
            let faces = numbers.flat_map(|number| (number as u64).to_le_bytes()).collect();
            let mut history = vec![0; size_of_val(&*interlayer_history)];
            T::write_bytes(&interlayer_history, &mut history);
            sections.insert(INTERLAYER_FACES_SECTION.to_owned(), faces);
            sections.insert(INTERLAYERS_SECTION.to_owned(), history);
        }
        let SolidAccount { time, initial_energy, .. } = self.account;
        SimulationState { steps, time, initial_energy, sections }
    }

    fn cell_sections(&self) -> Vec<(String, usize)> {
        let [fields, sums] = self.solver.list_lengths();
        let fields = fields.iter().map(|count| count * size_of::<T>());
        let sums = sums.iter().map(|count| count * size_of::<f64>());
        number_sections(FIELD_SECTION, fields).chain(number_sections(SUMS_SECTION, sums)).collect()
    }

    fn read_cell_section(
        &self,
        name: &str,
        append: &mut dyn FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let index = |kind: &str| name.strip_prefix(kind).and_then(|index| index.parse().ok());
        if let Some(index) = index(FIELD_SECTION) {
            append_pieces(&self.solver.field_list(index), append)
        } else if let Some(index) = index(SUMS_SECTION) {
            append_pieces(&self.solver.sum_list(index), append)
        } else {
            Ok(())
        }
    }
}

/// Number of values that are encoded at a time.
const PIECE_LENGTH: usize = 8192;

/// Encodes values and passes their bytes to `append` in pieces.
fn append_pieces<V: Real>(
    values: &[V],
    append: &mut dyn FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    let mut bytes = vec![0; PIECE_LENGTH.min(values.len()) * size_of::<V>()];
    values.chunks(PIECE_LENGTH).try_for_each(|piece| {
        let bytes = &mut bytes[..size_of_val(piece)];
        V::write_bytes(piece, bytes);
        append(bytes)
    })
}

/// Lists by cell of a state in the sections of a file.
struct SectionLists<'a>(&'a mut dyn CellSections);

impl<T: SolverReal> StateLists<T> for SectionLists<'_> {
    fn lengths(&self) -> [Vec<usize>; 2] {
        [(FIELD_SECTION, size_of::<T>()), (SUMS_SECTION, size_of::<f64>())].map(|(kind, size)| {
            (0..)
                .map_while(|index| Some(self.0.length(&format!("{kind}{index}"))? / size))
                .collect()
        })
    }

    fn read_field(&mut self, index: usize) -> Option<Cow<'_, [T]>> {
        T::from_bytes(&self.0.read(&format!("{FIELD_SECTION}{index}"))?).map(Cow::from)
    }

    fn read_sums(&mut self, index: usize) -> Option<Cow<'_, [f64]>> {
        from_bytes(&self.0.read(&format!("{SUMS_SECTION}{index}"))?).map(Cow::from)
    }
}
