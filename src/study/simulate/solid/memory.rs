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

/// Memory of the program during a simulation, bytes, by measurement.
const PROGRAM_MEMORY_BYTES: f64 = 17.0 * 1048576.0;

/// Memory for drawing one picture, bytes, and bytes per cell, by measurement; the pictures are drawn one after the other,
/// when the solver has been dropped.
const PICTURE_MEMORY_BYTES: f64 = 55.0 * 1048576.0;
const PICTURE_BYTES_PER_CELL: f64 = 46.0;

/// The same for the animation of snapshots, bytes per cell.
const ANIMATION_BYTES_PER_CELL: f64 = 24.0;

/// Memory for the pictures and files of joints, bytes, by measurement, apart from that per face.
const JOINT_PICTURE_MEMORY_BYTES: f64 = 21.0 * 1048576.0;

/// Numbers that the solver stores, besides the fields, per pair of waves and line along the last axis in two dimensions,
/// or along the last two axes in three, by measurement: interface states, in three dimensions with boundary values.
const NUMBERS_PER_LINE: [f64; 2] = [5.7, 16.5];

/// Memory per pair of waves for both faces at the ends of a line of cells, bytes, by measurement: the condition of the
/// case, its position and that of the solver; by number of dimensions.
const BYTES_PER_BOUNDARY_LINE: [f64; 2] = [67.0, 5.0];

/// The same with the solver of ledgers with numerical dissipation, in any number of dimensions.
const BYTES_PER_REFERENCE_BOUNDARY_LINE: f64 = 145.0;

/// Number of SIMD lanes that pad a row of lines, by measurement.
const PADDING_LANES: usize = 10;

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
    /// Estimates the peak memory of a run, bytes: that of the program, of the values at boundaries, of the initial values,
    /// and of joints; plus all snapshots if `keeps_snapshots` is set; plus the solver with one list of values by cell for a
    /// checkpoint and some layers of cells of a snapshot, or a picture, whichever is larger, since pictures are drawn when
    /// the solver has been dropped. Of several ranks each has a share of all but the program and the boundaries: `own_share`
    /// of the cells, and `stored_share` of those in the solver, where copies of neighbouring cells count.
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
        let [solver, boundaries] = self.estimate_solver_memory(own_share < 1.0);
        // All ranks have the values at boundaries.
        let cells = own_share * grid.cell_count() as f64;
        let (solver, joints) = (stored_share * solver, own_share * joints);
        let output = slab.max(slab_copies * layer * cells);
        let lists = cells * wide * (LIST_COPIES + dissipation + integrals);
        let animation = if has_snapshots { ANIMATION_BYTES_PER_CELL } else { 0.0 };
        let pictures =
            PICTURE_MEMORY_BYTES + joint_pictures + cells * (PICTURE_BYTES_PER_CELL + animation);
        Bytes(
            PROGRAM_MEMORY_BYTES
                + boundaries
                + cells * per_cell
                + joints
                + (solver + lists + output).max(pictures),
        )
    }

    /// Estimates the memory of the solver, bytes: of the fields, and of values by line and at boundaries.
    fn estimate_solver_memory(&self, is_distributed: bool) -> [f64; 2] {
        let SolidRun { grid, scheme, .. } = self.solid_run;
        let fields = Medium::state_fields(&self.media).len();
        let number = self.number_size() as f64;
        let pairs = self.media[0].pairs.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let lines: usize = grid.cells.iter().map(|cells| grid.cell_count() / cells).sum();
        let boundary_lines = lines as f64 * pairs;
        if scheme.ledger_detail == LedgerDetail::TotalsAndDissipation {
            let solver = grid.cell_count() as f64 * fields as f64 * number;
            return [solver, BYTES_PER_REFERENCE_BOUNDARY_LINE * boundary_lines];
        }
        let cells = self.solver_cells(is_distributed);
        let (line_count, dimensions) = match cells[..] {
            [n1, n2, n3] => ((n1 + PADDING_LANES) * (n2 + n3), 1),
            [n1, _] => (n1, 0),
            _ => (0, 0),
        };
        let slopes = convert_scheme(*scheme).slopes;
        let solver = match scheme.precision {
            Precision::F64 => memory_bytes::<f64>(&cells, fields, slopes),
            Precision::F32 => memory_bytes::<f32>(&cells, fields, slopes),
        };
        let line_values = NUMBERS_PER_LINE[dimensions] * line_count as f64 * pairs * number;
        let boundary_values = BYTES_PER_BOUNDARY_LINE[dimensions] * boundary_lines;
        [solver, line_values + boundary_values]
    }

    /// Returns the size of a number of the solver, bytes.
    const fn number_size(&self) -> usize {
        match self.solid_run.scheme.precision {
            Precision::F64 => size_of::<f64>(),
            Precision::F32 => size_of::<f32>(),
        }
    }

    /// Returns the numbers of cells in the axis order of the solver, as
    /// [`Problem::first_axis`](dynamics::problem::Problem::first_axis) decides: in three dimensions with alternating
    /// splitting the last axis with a reflecting boundary is moved to the front. If this axis is idle (one cell,
    /// periodic, without contacts), the first one that is not is moved before it, unless the cells are distributed over
    /// ranks.
    fn solver_cells(&self, is_distributed: bool) -> Vec<usize> {
        let SolidRun { grid, scheme, .. } = self.solid_run;
        let mut axes: Vec<usize> = (0..grid.cells.len()).collect();
        if axes.len() == 3 && scheme.splitting == DimensionalSplitting::Alternating {
            let is_reflecting = |own: &FaceCondition| match own.condition {
                BoundaryConditionKind::Free
                | BoundaryConditionKind::Fixed
                | BoundaryConditionKind::Mixed { .. } => true,
                BoundaryConditionKind::Symmetry
                | BoundaryConditionKind::Antisymmetry
                | BoundaryConditionKind::Periodic
                | BoundaryConditionKind::NonReflecting => false,
            };
            let has_reflecting_face = |axis: &usize| {
                [false, true].into_iter().any(|is_upper| {
                    let face = BoundaryFace { axis: *axis, is_upper };
                    // Only conditions from the last one of the whole face on apply; a face without condition is free.
                    let conditions = &self.solid_run.boundary_conditions;
                    let of_face: Vec<_> =
                        conditions.iter().filter(|own| own.face == face).collect();
                    let whole = of_face.iter().rposition(|own| own.rectangle.is_none());
                    whole.is_none_or(|whole| of_face[whole..].iter().any(|own| is_reflecting(own)))
                })
            };
            let first = (0..3).rev().find(has_reflecting_face).unwrap_or(0);
            axes[..=first].rotate_right(1);
        }
        let has_contacts = self.media.iter().any(|medium| medium.contact.is_some());
        let is_periodic = |axis: usize| {
            self.solid_run.boundary_conditions.iter().any(|own| {
                own.face.axis == axis && matches!(own.condition, BoundaryConditionKind::Periodic)
            })
        };
        let is_idle = |axis: &usize| {
            !is_distributed
                && grid.cells[*axis] == 1
                && is_periodic(*axis)
                && !grid.is_polar()
                && !has_contacts
                && self.joint_face_count() == 0
        };
        let row = axes.iter().position(|axis| !is_idle(axis)).unwrap_or(0);
        axes[..=row].rotate_right(1);
        axes.into_iter().map(|axis| grid.cells[axis]).collect()
    }
}
