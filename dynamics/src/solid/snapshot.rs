//! State of a solid for checkpoints.

use crate::solid::ledger::WorkPartialSums;
use std::borrow::Cow;
use std::ops::Range;

/// State of a solid, or of the part of its cells that a rank holds, independent of the solver and of the number of
/// subdomains; sufficient to continue the simulation bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot<T> {
    /// Number of steps done since time 0.
    pub steps: usize,
    /// Values by field and cell; the axis that is swept first runs fastest.
    pub fields: Vec<Vec<T>>,
    /// Sums of boundary work, source work and numerical dissipation, and the smallest dissipation ratio.
    pub work_sums: WorkPartialSums,
    /// Lists by cell, in the order of `fields`: plastic dissipation, work of the initial stress and dissipation of
    /// dashpots, J/m³, each empty if the problem does not need it; then one list for each time integral, without its
    /// end correction.
    pub cell_sums: Vec<Vec<f64>>,
    /// History variables of interlayers, in the order of
    /// [`Domain::interlayer_history`](crate::solid::domain::Domain::interlayer_history).
    pub interlayer_history: Vec<T>,
}

/// A snapshot without fields, which belongs to no problem.
impl<T> Default for Snapshot<T> {
    fn default() -> Self {
        Self {
            steps: 0,
            fields: Vec::new(),
            work_sums: Default::default(),
            cell_sums: Vec::new(),
            interlayer_history: Vec::new(),
        }
    }
}

/// Lists by cell of a saved state, which are read one by one: those of [`Snapshot::fields`] and [`Snapshot::cell_sums`].
pub(crate) trait StateLists<T: Clone> {
    /// Numbers of values of the fields and of the sums by cell.
    fn lengths(&self) -> [Vec<usize>; 2];
    /// Values of a field; `None` if they cannot be read.
    fn read_field(&mut self, index: usize) -> Option<Cow<'_, [T]>>;
    /// Values of a sum by cell; `None` if they cannot be read.
    fn read_sums(&mut self, index: usize) -> Option<Cow<'_, [f64]>>;
}

impl<T: Clone> StateLists<T> for &Snapshot<T> {
    fn lengths(&self) -> [Vec<usize>; 2] {
        let sums = self.cell_sums.iter().map(Vec::len).collect();
        [self.fields.iter().map(Vec::len).collect(), sums]
    }

    fn read_field(&mut self, index: usize) -> Option<Cow<'_, [T]>> {
        self.fields.get(index).map(Cow::from)
    }

    fn read_sums(&mut self, index: usize) -> Option<Cow<'_, [f64]>> {
        self.cell_sums.get(index).map(Cow::from)
    }
}

/// Part of a state that a process holds: the cells of a rank, or all of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatePart {
    /// Number of cells of the whole grid along each axis, in the order of the axes of the lists of a state.
    pub grid_cells: Vec<usize>,
    /// Cells of the part along the same axes.
    pub cells: Vec<Range<usize>>,
    /// Interlayers of the part in the order of their history variables: position, by which they are sorted (layer across
    /// the last axis, axis normal to the face, cell above it), and number of history variables.
    pub interlayers: Vec<([usize; 3], usize)>,
}

impl StatePart {
    /// Returns the number of cells of the part.
    pub fn cell_count(&self) -> usize {
        self.cells.iter().map(ExactSizeIterator::len).product()
    }
}
