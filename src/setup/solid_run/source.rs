//! Sources, and distribution of point sources and point loads to cells and faces.

use super::Place;
use super::geometry::is_periodic;
use crate::Error;
use crate::case::dynamics::{
    Component, Condition, Dynamics, Kernel, Part, Side, Source as Inside, SourceKind,
};
use dynamics::boundary::{Signal, Source};
use dynamics::point_kernel::{Axis, End, bell_shares, nearest_share, spline_shares};
use models::solid::waves::Field;
use std::sync::Arc;

/// Returns the continuation of a field beyond a side (mirror image, open or periodic) at a point.
fn end(dynamics: &Dynamics, side: Side, point: &[f64], field: Field) -> End {
    if is_periodic(dynamics, side.axis) {
        return End::Periodic;
    }
    let position: Vec<f64> =
        side.axes(dynamics.grid.dimensions()).into_iter().map(|axis| point[axis]).collect();
    let holds = |part: &Part| part.contains(&position);
    let entry = dynamics
        .sides
        .iter()
        .rev()
        .find(|entry| entry.side == side && entry.part.as_ref().is_none_or(holds));
    match entry.map(|entry| &entry.condition) {
        Some(Condition::Symmetry) => End::symmetry(field, side.axis),
        Some(Condition::Antisymmetry) => End::antisymmetry(field, side.axis),
        _ => End::Open,
    }
}

/// Returns the shares of cells in a point source of a field, or of the faces of a side if `axes` omits its axis.
fn shares(
    dynamics: &Dynamics,
    axes: &[usize],
    point: &[f64],
    kernel: Kernel,
    field: Field,
) -> Vec<(usize, f64)> {
    let grid = &dynamics.grid;
    let along: Vec<Axis> = axes
        .iter()
        .map(|&axis| Axis {
            cells: grid.cells[axis],
            ends: [false, true]
                .map(|is_upper| end(dynamics, Side { axis, is_upper }, point, field)),
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

/// Maximum number of cells or faces in the square or cube around a bell kernel.
const MAX_PLACES: f64 = 1e7;

/// Checks that a bell kernel is at most twice as wide as the grid and covers at most [`MAX_PLACES`] cells or faces.
fn check_radius(dynamics: &Dynamics, axes: &[usize], radius: f64, key: &str) -> Result<(), Error> {
    let grid = &dynamics.grid;
    let widest = (0..grid.dimensions()).map(|axis| grid.cells[axis] as f64 * grid.spacing[axis]);
    let widest = 2.0 * widest.fold(0.0, f64::max);
    let places: f64 = axes.iter().map(|&axis| 2.0 * radius / grid.spacing[axis] + 1.0).product();
    if radius <= widest && places <= MAX_PLACES {
        return Ok(());
    }
    let found = format!("found {radius:?}, over {places:.1e} cells");
    let allowed = format!("at most {widest:?}, twice the grid, and {MAX_PLACES:e} cells");
    Err(dynamics.locate(&format!("{key}.radius"), found, allowed).into())
}

impl Place<'_> {
    /// Returns the shares of cells or faces in a point source or point load.
    pub(super) fn shares(
        &self,
        axes: &[usize],
        point: &[f64],
        kernel: Kernel,
        field: Field,
        key: &str,
    ) -> Result<Vec<(usize, f64)>, Error> {
        if let Kernel::Bell { radius } = kernel {
            check_radius(self.dynamics, axes, radius, key)?;
        }
        let shares = shares(self.dynamics, axes, point, kernel, field);
        if shares.iter().all(|own| own.1.abs() < 1e-12) {
            let found = format!("what drives {} is on a plane of symmetry", Component(field));
            let allowed = "its mirror image takes it away: leave that component out, or move it";
            return Err(self.dynamics.locate(&format!("{key}.at"), found, allowed).into());
        }
        Ok(shares)
    }

    /// Creates the solver sources of a source, one for each group of components with equal shares (mirror images of
    /// equal sign).
    pub(super) fn source(&self, index: usize, source: &Inside) -> Result<Vec<Source>, Error> {
        let amplitudes: Vec<(Field, f64)> = match &source.action {
            SourceKind::Force(force) => {
                force.iter().enumerate().map(|(i, f)| (Field::Velocity(i), *f)).collect()
            }
            SourceKind::Couple(couple) => {
                let first = 3 - couple.len();
                couple.iter().enumerate().map(|(k, m)| (Field::Spin(first + k), *m)).collect()
            }
            SourceKind::Moment(moment) => {
                let entries = moment.iter().enumerate().flat_map(|(i, row)| {
                    row.iter().enumerate().map(move |(j, m)| (Field::Stress(i, j), *m))
                });
                let is_classical = self.medium.rotation.is_none();
                let transposed = |i: usize, j: usize| moment[j][i];
                if is_classical
                    && entries.clone().any(|(field, m)| match field {
                        Field::Stress(i, j) => transposed(i, j) != m,
                        _ => false,
                    })
                {
                    let found = "a moment tensor that is not symmetric in a classical solid";
                    let allowed = "a symmetric one; couples need a solid with spin";
                    let key = format!("source[{index}].amplitude");
                    return Err(self.dynamics.locate(&key, found, allowed).into());
                }
                entries.filter(|(field, _)| self.medium.fields.contains(field)).collect()
            }
            // Also out of plane in plane strain.
            SourceKind::Explosion(moment) => {
                (0..3).map(|i| (Field::Stress(i, i), *moment)).collect()
            }
        };
        let time = source.time.clone();
        let signal: Signal = Arc::new(move |t| time.value(t));
        let axes: Vec<usize> = (0..self.dynamics.grid.dimensions()).collect();
        let key = format!("source[{index}]");
        let mut parts: Vec<Source> = Vec::new();
        for own in amplitudes.into_iter().filter(|(_, amplitude)| *amplitude != 0.0) {
            let cells = self.shares(&axes, &source.at, source.kernel, own.0, &key)?;
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
