//! Solver sources, and the distribution of point sources and point loads to cells and faces.

use super::GridConverter;
use super::geometry::is_periodic;
use crate::Error;
use crate::case::dynamics::{
    BoundaryConditionKind, BoundaryFace, FaceRectangle, Kernel, PointSource, SolidRun, SourceKind,
    StateComponent,
};
use dynamics::boundary::{Signal, Source};
use dynamics::point_kernel::{AxisEnd, PointPosition, bell_shares, nearest_share, spline_shares};
use models::common::decimal::ToPlainText;
use models::solid::waves::SolidField;
use std::sync::Arc;

/// Returns how a field is continued across a boundary near a point: as a mirror image, periodically, or not at all
/// (open).
fn find_boundary_continuation(
    solid_run: &SolidRun,
    boundary: BoundaryFace,
    point: &[f64],
    field: SolidField,
) -> AxisEnd {
    if is_periodic(solid_run, boundary.axis) {
        return AxisEnd::Periodic;
    }
    let position: Vec<f64> = boundary
        .tangential_axes(solid_run.grid.dimensions())
        .into_iter()
        .map(|axis| point[axis])
        .collect();
    let holds = |part: &FaceRectangle| part.contains(&position);
    let entry = solid_run
        .boundary_conditions
        .iter()
        .rev()
        .find(|entry| entry.face == boundary && entry.rectangle.as_ref().is_none_or(holds));
    match entry.map(|entry| &entry.condition) {
        Some(BoundaryConditionKind::Symmetry) => AxisEnd::new_symmetry(field, boundary.axis),
        Some(BoundaryConditionKind::Antisymmetry) => {
            AxisEnd::new_antisymmetry(field, boundary.axis)
        }
        _ => AxisEnd::Open,
    }
}

/// Returns the indices of the cells to which a point source of `field` is distributed, and the fraction of the source
/// in each; boundary faces instead of cells if `axes` are the tangential axes of a boundary.
fn compute_shares(
    solid_run: &SolidRun,
    axes: &[usize],
    point: &[f64],
    kernel: Kernel,
    field: SolidField,
) -> Vec<(usize, f64)> {
    let grid = &solid_run.grid;
    let along: Vec<PointPosition> = axes
        .iter()
        .map(|&axis| PointPosition {
            cells: grid.cells[axis],
            ends: [false, true].map(|is_upper| {
                find_boundary_continuation(solid_run, BoundaryFace { axis, is_upper }, point, field)
            }),
            x: (point[axis] - grid.origin[axis]) / grid.spacing[axis] - 0.5,
        })
        .collect();
    match kernel {
        Kernel::Spline => spline_shares(&along),
        Kernel::Bell { radius } => {
            let spacing: Vec<f64> = axes.iter().map(|&axis| grid.spacing[axis]).collect();
            bell_shares(&along, &spacing, radius)
        }
        Kernel::Cell => nearest_share(&along),
    }
}

/// Maximum number of cells or faces in the bounding rectangle or cuboid of a bell kernel.
const MAX_KERNEL_CELLS: f64 = 1e7;

/// Checks that the radius of a bell kernel is at most twice the largest extent of the grid, and that the kernel covers
/// at most [`MAX_KERNEL_CELLS`] cells or faces.
fn check_radius(solid_run: &SolidRun, axes: &[usize], radius: f64, key: &str) -> Result<(), Error> {
    let grid = &solid_run.grid;
    let widest = (0..grid.dimensions()).map(|axis| grid.cells[axis] as f64 * grid.spacing[axis]);
    let widest = 2.0 * widest.fold(0.0, f64::max);
    let places: f64 = axes.iter().map(|&axis| 2.0 * radius / grid.spacing[axis] + 1.0).product();
    if radius <= widest && places <= MAX_KERNEL_CELLS {
        return Ok(());
    }
    let found = format!("found {radius}, over {places:.1e} cells", radius = radius.to_plain_text());
    let allowed = format!(
        "expected at most {widest}, twice the grid, and {MAX_KERNEL_CELLS:e} cells",
        widest = widest.to_plain_text()
    );
    Err(solid_run.key_error(&format!("{key}.radius"), found, allowed).into())
}

impl GridConverter<'_> {
    /// Returns the indices of the cells or faces to which a point source or point load is distributed, and the fraction
    /// in each; refuses a source or load whose fractions are all below 10⁻¹² in magnitude.
    pub(super) fn compute_checked_shares(
        &self,
        axes: &[usize],
        point: &[f64],
        kernel: Kernel,
        field: SolidField,
        key: &str,
    ) -> Result<Vec<(usize, f64)>, Error> {
        if let Kernel::Bell { radius } = kernel {
            check_radius(self.solid_run, axes, radius, key)?;
        }
        let shares = compute_shares(self.solid_run, axes, point, kernel, field);
        if shares.iter().all(|own| own.1.abs() < 1e-12) {
            let found = format!("what drives {} is on a plane of symmetry", StateComponent(field));
            let allowed = "its mirror image takes it away: leave that component out, or move it";
            return Err(self.solid_run.key_error(&format!("{key}.at"), found, allowed).into());
        }
        Ok(shares)
    }

    /// Creates the solver sources of a source of the case, one for each group of components that are distributed alike:
    /// at a boundary the mirror images of all components of a group have the same sign.
    pub(super) fn create_sources(
        &self,
        index: usize,
        source: &PointSource,
    ) -> Result<Vec<Source>, Error> {
        let amplitudes: Vec<(SolidField, f64)> = match &source.kind {
            SourceKind::Force(force) => {
                force.iter().enumerate().map(|(i, f)| (SolidField::Velocity(i), *f)).collect()
            }
            SourceKind::Couple(couple) => {
                let first = 3 - couple.len();
                couple.iter().enumerate().map(|(k, m)| (SolidField::Spin(first + k), *m)).collect()
            }
            SourceKind::Moment(moment) => {
                let entries = moment.iter().enumerate().flat_map(|(i, row)| {
                    row.iter().enumerate().map(move |(j, m)| (SolidField::Stress(i, j), *m))
                });
                let is_classical = self.first_medium.rotation.is_none();
                let transposed = |i: usize, j: usize| moment[j][i];
                if is_classical
                    && entries.clone().any(|(field, m)| match field {
                        SolidField::Stress(i, j) => transposed(i, j) != m,
                        _ => false,
                    })
                {
                    let found = "a moment tensor that is not symmetric in a classical solid";
                    let allowed = "expected a symmetric one; couples need a solid with spin";
                    let key = format!("source[{index}].amplitude");
                    return Err(self.solid_run.key_error(&key, found, allowed).into());
                }
                entries.filter(|(field, _)| self.first_medium.fields.contains(field)).collect()
            }
            // In plane strain the out-of-plane component σ₃₃ is included.
            SourceKind::Explosion(moment) => {
                (0..3).map(|i| (SolidField::Stress(i, i), *moment)).collect()
            }
        };
        let time = source.time_function.clone();
        let signal: Signal = Arc::new(move |t| time.evaluate(t));
        let axes: Vec<usize> = (0..self.solid_run.grid.dimensions()).collect();
        let key = format!("source[{index}]");
        let mut parts: Vec<Source> = Vec::new();
        for own in amplitudes.into_iter().filter(|(_, amplitude)| *amplitude != 0.0) {
            let cells =
                self.compute_checked_shares(&axes, &source.position, source.kernel, own.0, &key)?;
            match parts.iter_mut().find(|part| part.cells == cells) {
                Some(part) => part.amplitudes.push(own),
                None => {
                    parts.push(Source { cells, amplitudes: vec![own], signal: signal.clone() });
                }
            }
        }
        Ok(parts)
    }
}
