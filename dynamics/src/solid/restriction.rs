//! Restriction of a problem to a region of its grid.

use crate::solid::boundary::{Boundary, Load, Source};
use crate::solid::problem::Problem;
use crate::solid::region::Region;
use std::borrow::Cow;

impl<const D: usize> Problem<D> {
    /// Returns the region of the whole grid for passes of `max_pass_steps` steps; on a periodic last axis that is not
    /// idle it has a halo of copies of the layers at the opposite end.
    pub(crate) fn whole_region(&self, max_pass_steps: usize) -> Region<D> {
        let width =
            if self.wraps_around(D - 1) { max_pass_steps * self.scheme.slopes.halo() } else { 0 };
        let cells = self.grid.cells;
        let halo = std::array::from_fn(|axis| [if axis + 1 == D { width } else { 0 }; 2]);
        Region::new(cells, cells.map(|count| 0..count), halo)
    }

    /// Restricts the problem to a region: media, conditions by face, loads and sources are renumbered to the cells and
    /// faces of the region. The grid, the layers of the initial stress and of the metric, and the interlayers remain
    /// those of the whole problem.
    #[must_use]
    pub fn restrict_to(&self, region: &Region<D>) -> Cow<'_, Self> {
        if *region == Region::from_grid(self.grid.cells) && self.medium_function.is_none() {
            return Cow::Borrowed(self);
        }
        let restrict_boundary = |axis: usize, boundary: &Boundary| match boundary {
            Boundary::ByFace(pairs) => {
                let faces = region.global_faces(axis);
                let restrict_conditions =
                    |own: &Vec<_>| faces.iter().map(|face| own[*face]).collect();
                Boundary::ByFace(pairs.iter().map(restrict_conditions).collect())
            }
            _ => boundary.clone(),
        };
        let load = |load: &Load| {
            let faces = load.faces.iter();
            let shares = faces.flat_map(|&(face, amplitude)| {
                let faces = region.region_faces(load.axis, face).into_iter();
                faces.map(move |face| (face, amplitude))
            });
            Load { faces: shares.collect(), ..load.clone() }
        };
        let source = |source: &Source| {
            let cells = source.cells.iter();
            let shares = cells.flat_map(|&(cell, share)| {
                region.region_cells(cell).into_iter().map(move |cell| (cell, share))
            });
            Source { cells: shares.collect(), ..source.clone() }
        };
        let medium = |cell: usize| self.medium_index(cell) as u16; // an index of `cell_media`
        Cow::Owned(Self {
            grid: self.grid,
            media: self.media.clone(),
            cell_media: region.global_cell_iter().map(medium).collect(),
            medium_function: None,
            boundaries: std::array::from_fn(|axis| {
                self.boundaries[axis].each_ref().map(|own| restrict_boundary(axis, own))
            }),
            step: self.step,
            scheme: self.scheme,
            loads: self.loads.iter().map(load).collect(),
            sources: self.sources.iter().map(source).collect(),
            acceleration: self.acceleration,
            initial_stress: self.initial_stress.clone(),
            integrated_fields: self.integrated_fields.clone(),
            interlayers: self.interlayers.clone(),
            metric: self.metric.clone(),
            shear_interval: self.shear_interval,
        })
    }
}
