//! The part of a problem that stands in a region of its grid.

use crate::solid::boundary::{Boundary, Load, Source};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::HALO;
use crate::solid::region::Region;

/// By index in a whole, where it stands in a part: at several places where a halo comes round.
struct Places(Vec<(usize, usize)>);

impl Places {
    fn new(of_part: &[usize]) -> Self {
        let mut places: Vec<_> =
            of_part.iter().enumerate().map(|(place, index)| (*index, place)).collect();
        places.sort_unstable();
        Self(places)
    }

    /// The values of some of the whole, by their places in the part; the order of the list is kept.
    fn restrict(&self, values: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let of = |&(index, value): &(usize, f64)| {
            let first = self.0.partition_point(|own| own.0 < index);
            let own = self.0[first..].iter().take_while(move |own| own.0 == index);
            own.map(move |own| (own.1, value))
        };
        values.iter().flat_map(of).collect()
    }
}

impl<const D: usize> Problem<D> {
    /// All cells of its grid, for passes of so many steps: layers across a periodic last axis are each other's halo.
    pub(crate) fn uncut_region(&self, most_steps: usize) -> Region<D> {
        let comes_round = self.boundaries[D - 1][0] == Boundary::Periodic;
        let width = if comes_round { most_steps * HALO } else { 0 };
        let cells = self.grid.cells;
        let halo = std::array::from_fn(|axis| [if axis + 1 == D { width } else { 0 }; 2]);
        Region::new(cells, cells.map(|count| 0..count), halo)
    }

    /// The problem of a region: media, conditions by face, loads and sources are those of its cells and faces, by their
    /// numbers in the region. The grid is the whole one; layers of the initial stress and interlayers count along it.
    #[must_use]
    pub fn restricted(&self, region: &Region<D>) -> Self {
        let cells = region.global_cells();
        let places = Places::new(&cells);
        let faces: [Vec<usize>; D] = std::array::from_fn(|axis| region.global_faces(axis));
        let places_of_faces = faces.each_ref().map(|faces| Places::new(faces));
        let side = |axis: usize, side: &Boundary| match side {
            Boundary::ByFace(pairs) => {
                let of = |own: &Vec<_>| faces[axis].iter().map(|face| own[*face]).collect();
                Boundary::ByFace(pairs.iter().map(of).collect())
            }
            _ => side.clone(),
        };
        let load = |own: &Load| Load {
            faces: places_of_faces[own.axis].restrict(&own.faces),
            ..own.clone()
        };
        let source = |own: &Source| Source { cells: places.restrict(&own.cells), ..own.clone() };
        Self {
            grid: self.grid,
            media: self.media.clone(),
            of_cell: cells.iter().map(|cell| self.of_cell[*cell]).collect(),
            boundaries: std::array::from_fn(|axis| {
                self.boundaries[axis].each_ref().map(|own| side(axis, own))
            }),
            step: self.step,
            scheme: self.scheme,
            loads: self.loads.iter().map(load).collect(),
            sources: self.sources.iter().map(source).collect(),
            acceleration: self.acceleration,
            initial_stress: self.initial_stress.clone(),
            integrals: self.integrals.clone(),
            interlayers: self.interlayers.clone(),
            metric: self.metric.clone(),
        }
    }
}
