//! Estimate of the memory of a simulation of a solid.

use super::{NUMBERS_PER_JOINT_FACE, SolidJob};
use crate::case::dynamics::{
    BoundaryConditionKind, BoundaryFace, DimensionalSplitting, FaceCondition, LedgerDetail,
    Precision, SolidRun,
};
use crate::setup::solid_run::convert_scheme;
use crate::study::simulate::Bytes;
use crate::study::simulate::plan::snapshot_count;
use dynamics::domain::memory_bytes;
use dynamics::medium::Medium;
use dynamics::problem::choose_first_axis;

/// Memory of the program during a simulation, bytes, by measurement.
const PROGRAM_MEMORY_BYTES: f64 = 17.0 * 1048576.0;

/// Memory of an MPI library in each rank, bytes, by measurement.
const MPI_MEMORY_BYTES: f64 = 12.0 * 1048576.0;

/// Memory for drawing one picture, bytes, and bytes per cell, by measurement; the pictures are drawn one after the other,
/// when the solver has been dropped.
const PICTURE_MEMORY_BYTES: f64 = 55.0 * 1048576.0;
const PICTURE_BYTES_PER_CELL: f64 = 46.0;

/// The same for the animation of snapshots, bytes per cell.
const ANIMATION_BYTES_PER_CELL: f64 = 24.0;

/// Memory for the pictures and files of joints, bytes, by measurement, apart from that per face.
const JOINT_PICTURE_MEMORY_BYTES: f64 = 4.0 * 1048576.0;

/// Memory per pair of waves for both faces at the ends of a line of cells in the solver of ledgers with numerical
/// dissipation, bytes, by measurement.
const BYTES_PER_REFERENCE_BOUNDARY_LINE: f64 = 50.0;

/// Memory per pair of waves and face of a side with loads, or whose conditions differ between faces, bytes, by measurement.
const BYTES_PER_LOADED_FACE: f64 = 200.0;

/// Memory while snapshots are written, bytes, by measurement: some layers of cells with all arrays, their encoded values,
/// and compressed values.
const SNAPSHOT_MEMORY_BYTES: f64 = 12.0 * 1048576.0;

/// Copies of a layer of cells with all arrays, by measurement, while final fields and while snapshots are written.
const SLAB_COPIES: [f64; 2] = [1.5, 2.5];

/// Lists with a value by cell that are in memory besides the state, by measurement: one as a checkpoint is written.
const LIST_COPIES: f64 = 1.17;

/// Lists with the plastic dissipation by cell in the solver, by measurement.
const DISSIPATION_LISTS: f64 = 1.17;

/// Memory of a face of a joint in multiples of its output, by measurement: history variables, lists of faces, and copies
/// of the output while files and pictures are created.
const JOINT_COPIES: f64 = 5.4;

impl SolidJob<'_> {
    /// Estimates the peak memory of a run, bytes: that of the program, of the initial values, and of joints; plus all
    /// snapshots if `keeps_snapshots` is set; plus the solver with one list of values by cell for a checkpoint and some
    /// layers of cells of a snapshot, or a picture, whichever is larger, since pictures are drawn when the solver has been
    /// dropped. Of several ranks each has a share of all but the program: `own_share` of the cells, and `stored_share` of
    /// those in the solver, where copies of neighbouring cells count.
    pub(in crate::study::simulate) fn estimate_memory(
        &self,
        keeps_snapshots: bool,
        [own_share, stored_share]: [f64; 2],
    ) -> Bytes {
        let SolidRun { grid, output, initial_terms: initial, time, .. } = self.solid_run;
        let wide = size_of::<f64>() as f64;
        let shown = wide * self.quantity_names.len() as f64;
        let dissipation = if self.yields() { DISSIPATION_LISTS } else { 0.0 };
        let integrals = output.integrated_components.len() as f64;
        let has_snapshots = output.snapshot_interval > 0.0;
        let layers = *grid.cells.last().unwrap_or(&1) as f64;
        let layer = wide * self.numbers_per_snapshot_cell() as f64 / layers;
        let (slab_copies, slab) = match has_snapshots {
            true => (SLAB_COPIES[1], SNAPSHOT_MEMORY_BYTES),
            false => (SLAB_COPIES[0], 0.0),
        };
        let kept = match keeps_snapshots {
            // The fields before a step are in memory, too.
            true if has_snapshots => {
                snapshot_count(output.snapshot_interval, time.duration) + slab_copies
            }
            _ => 0.0,
        };
        let per_cell = wide * initial.len() as f64 + kept * shown + size_of::<u16>() as f64;
        let joint_faces = self.joint_face_count() as f64;
        let joint_copies = JOINT_COPIES + kept;
        let joints = wide * NUMBERS_PER_JOINT_FACE * joint_copies * joint_faces;
        let joint_pictures = if joint_faces > 0.0 { JOINT_PICTURE_MEMORY_BYTES } else { 0.0 };
        let [solver, lines] = self.estimate_solver_memory();
        let cells = own_share * grid.cell_count() as f64;
        // Of the lines across one or two axes a part has more than its share of the cells.
        let solver = stored_share * solver + own_share.sqrt() * lines;
        let joints = own_share * joints;
        let output = slab.max(slab_copies * layer * cells);
        let lists = cells * wide * (LIST_COPIES + dissipation + integrals);
        let animation = if has_snapshots { ANIMATION_BYTES_PER_CELL } else { 0.0 };
        let pictures =
            PICTURE_MEMORY_BYTES + joint_pictures + cells * (PICTURE_BYTES_PER_CELL + animation);
        let ranks = if own_share < 1.0 { MPI_MEMORY_BYTES } else { 0.0 };
        Bytes(
            PROGRAM_MEMORY_BYTES
                + ranks
                + self.estimate_boundary_memory()
                + cells * per_cell
                + joints
                + (solver + lists + output).max(pictures),
        )
    }

    /// Estimates the memory of the solver, bytes: of values by cell, and of values by line across one or two axes.
    fn estimate_solver_memory(&self) -> [f64; 2] {
        let SolidRun { grid, scheme, .. } = self.solid_run;
        let fields = Medium::state_fields(&self.media).len();
        if self.has_reference_solver() {
            return [grid.cell_count() as f64 * fields as f64 * self.number_size() as f64, 0.0];
        }
        let (cells, pairs) = (self.solver_cells(), self.pair_count());
        let slopes = convert_scheme(*scheme).slopes;
        match scheme.precision {
            Precision::F64 => memory_bytes::<f64>(&cells, fields, pairs, slopes),
            Precision::F32 => memory_bytes::<f32>(&cells, fields, pairs, slopes),
        }
    }

    /// Estimates the memory of conditions and loads that are stored by face, bytes: those of sides with loads or with
    /// different conditions, and of all sides of a ledger with numerical dissipation.
    fn estimate_boundary_memory(&self) -> f64 {
        let SolidRun { grid, boundary_conditions, loads, .. } = self.solid_run;
        let faces = |axis: usize| (grid.cell_count() / grid.cells[axis]) as f64;
        let differs = |side: &BoundaryFace| {
            loads.iter().any(|own| own.face == *side)
                || boundary_conditions
                    .iter()
                    .any(|own| own.face == *side && own.rectangle.is_some())
        };
        let sides = (0..grid.dimensions())
            .flat_map(|axis| [false, true].map(|is_upper| BoundaryFace { axis, is_upper }));
        let by_face: f64 = sides.filter(differs).map(|side| faces(side.axis)).sum();
        let lines: f64 = (0..grid.dimensions()).map(faces).sum();
        let reference = if self.has_reference_solver() { lines } else { 0.0 };
        self.pair_count() as f64
            * (BYTES_PER_LOADED_FACE * by_face + BYTES_PER_REFERENCE_BOUNDARY_LINE * reference)
    }

    /// Returns whether the ledger has the numerical dissipation, which needs the solver of one sweep at a time.
    fn has_reference_solver(&self) -> bool {
        self.solid_run.scheme.ledger_detail == LedgerDetail::TotalsAndDissipation
    }

    /// Returns the greatest number of pairs of waves along an axis.
    fn pair_count(&self) -> usize {
        self.media[0].pairs.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Returns the size of a number of the solver, bytes.
    const fn number_size(&self) -> usize {
        match self.solid_run.scheme.precision {
            Precision::F64 => size_of::<f64>(),
            Precision::F32 => size_of::<f32>(),
        }
    }

    /// Returns the numbers of cells in the axis order of the solver, see [`choose_first_axis`].
    fn solver_cells(&self) -> Vec<usize> {
        let SolidRun { grid, scheme, .. } = self.solid_run;
        let is_reflecting = |own: &FaceCondition| match own.condition {
            BoundaryConditionKind::Free
            | BoundaryConditionKind::Fixed
            | BoundaryConditionKind::Mixed { .. } => true,
            BoundaryConditionKind::Symmetry
            | BoundaryConditionKind::Antisymmetry
            | BoundaryConditionKind::Periodic
            | BoundaryConditionKind::NonReflecting => false,
        };
        let has_reflecting_end = |axis: usize| {
            [false, true].into_iter().any(|is_upper| {
                let face = BoundaryFace { axis, is_upper };
                // Only conditions from the last one of the whole face on apply; a face without condition is free.
                let conditions = &self.solid_run.boundary_conditions;
                let of_face: Vec<_> = conditions.iter().filter(|own| own.face == face).collect();
                let whole = of_face.iter().rposition(|own| own.rectangle.is_none());
                whole.is_none_or(|whole| of_face[whole..].iter().any(|own| is_reflecting(own)))
            })
        };
        let is_alternating = scheme.splitting == DimensionalSplitting::Alternating;
        let first = match grid.is_polar() || self.joint_face_count() > 0 {
            true => 0,
            false => choose_first_axis(&grid.cells, has_reflecting_end, is_alternating),
        };
        let mut cells = grid.cells.clone();
        cells[..=first].rotate_right(1);
        cells
    }
}
