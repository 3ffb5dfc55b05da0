//! Interlayers of a domain: their faces, and their history variables.
//!
//! A sweep evaluates some faces more than once: the face between the last group of a lane and the first group of the
//! next lane at both ends of a row, the face between both ends of a periodic line twice, faces near the boundary
//! between two subdomains in both of them. Each evaluation has its own copy of the history variables. All copies are
//! updated from the same states and thus stay equal bit for bit; in halo layers they are exchanged with the fields.
//! Energy, dissipation and output use the copy at the lower face of the cell above the interlayer, in the subdomain
//! that owns the cell.

mod history_ranges;
mod stencils;

use super::layout::Layout;
use super::materials::Materials;
use crate::simd::{LaneGroup, Number, Real};
use crate::solid::boundary::Boundary;
use crate::solid::interlayers::{InterlayerLaw, Interlayers, face_energy};
use crate::solid::ledger::InterlayerSums;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::{GHOSTS, InterlayerStencil};
use crate::solid::region::Region;
use std::ops::Range;

/// Interlayers in the lanes of the lower face of a group.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FacePattern {
    /// Mask of the lanes with an interlayer: the reconstruction does not use differences across it.
    pub(crate) interlayer_lanes: u16,
    /// Mask of the lanes with an interlayer whose face is not one between two ghosts, and therefore has history
    /// variables.
    pub(crate) history_lanes: u16,
    /// Indices of the laws of the lanes with history variables, each with the mask of its lanes.
    pub(crate) laws: Vec<(u16, u16)>,
}

impl FacePattern {
    /// Adds interlayers with the law `law_index` in the lanes of a mask.
    fn add(&mut self, law_index: u16, lanes: u16, has_history: bool) {
        self.interlayer_lanes |= lanes;
        if !has_history {
            return;
        }
        self.history_lanes |= lanes;
        match self.laws.iter_mut().find(|own| own.0 == law_index) {
            Some(own) => own.1 |= lanes,
            None => self.laws.push((law_index, lanes)),
        }
    }

    /// Returns the law of a lane with history variables.
    fn law(&self, lane: usize) -> Option<usize> {
        let own = self.laws.iter().find(|own| own.1 >> lane & 1 == 1)?;
        Some(usize::from(own.0))
    }
}

/// Interlayers normal to an axis.
#[derive(Clone)]
struct AxisInterlayers<T: Real> {
    laws: Vec<InterlayerLaw<T>>,
    /// Number of pairs of waves along the axis.
    pairs: usize,
    /// Number of history variables of a face.
    variables: usize,
    /// By coordinate of a cell, whether some lower faces there have an interlayer; along the last axis by layer, halo
    /// included.
    has_plane: Vec<bool>,
    is_periodic: bool,
    /// Patterns that occur.
    patterns: Vec<FacePattern>,
    /// Index of the pattern of the lower face of each group of a line, from the farther ghost at the lower end to the
    /// farther ghost at the upper end: for all lines, or line by line.
    pattern_indices: Vec<u32>,
    /// Distance between two lines in `pattern_indices`: 0 if all lines have the same patterns.
    pattern_stride: usize,
    /// By the same places, index of the stencil of the face; 0 without interlayers.
    stencil_indices: Vec<u32>,
    /// Stencils of faces that occur in a domain of one medium, by stencil and wave constants; empty for several media.
    stencils: Vec<InterlayerStencil<T::Lanes>>,
    /// Number of wave constants of a stencil.
    cells_per_stencil: usize,
    /// By the same places, offset of the history variables of the face from those of the first face of the line; the
    /// places without history variables have any.
    history_offsets: Vec<usize>,
    /// Index of the first history variable of this axis.
    history_start: usize,
    /// Distance between the history variables of two lines, in groups.
    history_stride: usize,
    /// Number of groups of history variables of a face: of one row for faces across the first axis, of all lines for
    /// others.
    groups_per_face: usize,
}

/// All interlayers and their history variables.
#[derive(Clone)]
pub(super) struct LaneInterlayers<T: Real, const D: usize> {
    across: [Option<AxisInterlayers<T>>; D],
    /// History variables; empty in a subdomain without interlayers.
    pub(super) history: Vec<T::Lanes>,
}

/// Interlayers on the path of a sweep.
#[derive(Clone, Copy)]
pub(crate) struct PathFaces<'a, T: Real> {
    pub(crate) laws: &'a [InterlayerLaw<T>],
    /// Number of history variables of a face.
    pub(crate) variable_count: usize,
    pub(crate) patterns: &'a [FacePattern],
    /// Indices of the patterns of the lower faces of the groups of the path, first line first.
    pub(crate) pattern_indices: &'a [u32],
    pub(crate) pattern_stride: usize,
    /// Indices of the stencils of the same faces: 0 if none of the three faces between the four groups around the face
    /// has an interlayer.
    pub(crate) stencil_indices: &'a [u32],
    /// Stencils by index and wave constants; empty for several media.
    pub(crate) stencils: &'a [InterlayerStencil<T::Lanes>],
    /// Number of wave constants of a stencil.
    pub(crate) cells_per_stencil: usize,
    /// By group of the path, offset of the history variables of its lower face.
    pub(crate) history_offsets: &'a [usize],
    /// Index of the first history variable of the first line.
    pub(crate) first_history_index: usize,
    /// Distance between the history variables of two lines.
    pub(crate) history_stride: usize,
}

/// Location of the history variables of an owned face.
#[derive(Clone, Copy, Debug)]
pub(super) struct HistorySite {
    pub(super) axis: usize,
    /// Cell above the face (index among all cells, halo included).
    pub(super) cell: usize,
    /// Index of the law among those of the axis.
    pub(super) law: usize,
    /// Index of the group that holds the first history variable; the others follow.
    group: usize,
    lane: usize,
}

/// Coordinates of the cells of a region in the whole grid, by axis.
struct RegionCoordinates<const D: usize> {
    grid_cells: [usize; D],
    coordinates: [Vec<usize>; D],
}

impl<const D: usize> RegionCoordinates<D> {
    /// Returns the index of the lower face of a cell in its plane normal to an axis of the whole grid; `None` for a
    /// padding lane.
    fn face_in_plane(&self, axis: usize, cell: [usize; D]) -> Option<usize> {
        let (mut face, mut stride) = (0, 1);
        for other in (0..D).filter(|other| *other != axis) {
            face += self.coordinates[other].get(cell[other])? * stride;
            stride *= self.grid_cells[other];
        }
        Some(face)
    }
}

impl<T: Real> AxisInterlayers<T> {
    /// Returns the coordinate of the face at a place along the axis, wrapped around a periodic axis; `None` if no face
    /// there has an interlayer.
    fn face_coordinate(&self, place: isize) -> Option<usize> {
        let count = self.has_plane.len();
        let around = match self.is_periodic {
            true => place.rem_euclid(count as isize),
            false => place,
        };
        let around = usize::try_from(around).ok()?;
        (around < count && self.has_plane[around]).then_some(around)
    }

    /// Returns the pattern of the lower face of the group at a place of a line; ghosts at the lower end have negative
    /// places.
    fn pattern(&self, line: usize, place: isize) -> &FacePattern {
        let index = (place + GHOSTS as isize) as usize + line * self.pattern_stride;
        &self.patterns[self.pattern_indices[index] as usize]
    }

    /// Returns the index of the first history variable of the face at a place of a line.
    fn history_index(&self, line: usize, place: usize) -> usize {
        self.history_start + line * self.history_stride + self.history_offsets[place + GHOSTS]
    }

    /// Returns the index of an equal pattern, which is added if there is none.
    fn pattern_index(&mut self, pattern: FacePattern) -> u32 {
        let found = self.patterns.iter().position(|own| *own == pattern);
        let index = found.unwrap_or_else(|| {
            self.patterns.push(pattern);
            self.patterns.len() - 1
        });
        index as u32
    }
}

impl<T: Real, const D: usize> LaneInterlayers<T, D> {
    /// Creates the interlayers of a region of a problem.
    pub(super) fn new(
        problem: &Problem<D>,
        layout: &Layout<D>,
        region: &Region<D>,
        materials: &Materials<T, D>,
    ) -> Self {
        let mut own = Self::without_stencils(problem, layout, region);
        for (axis, across) in own.across.iter_mut().enumerate() {
            // Along rows of different cell lengths the constants change from row to row.
            let is_uniform = axis > 0 || materials.row_constants.is_none();
            if let Some(across) = across {
                across.set_stencils(is_uniform.then(|| materials.axis_table(axis)));
            }
        }
        own
    }

    /// Creates the interlayers of a region of a problem for the numbers of history variables alone.
    pub(super) fn without_stencils(
        problem: &Problem<D>,
        layout: &Layout<D>,
        region: &Region<D>,
    ) -> Self {
        let coordinates = RegionCoordinates {
            grid_cells: problem.grid.cells,
            coordinates: std::array::from_fn(|axis| region.coordinates(axis)),
        };
        let mut history_count = 0;
        let across = std::array::from_fn(|axis| {
            let own = problem.interlayers_across(axis)?;
            let is_periodic =
                problem.boundaries[axis][0] == Boundary::Periodic && region.halo(axis) == [0, 0];
            let pairs = problem.media[0].pairs[axis].len();
            let mut across = Self::new_across(own, (pairs, is_periodic), layout, &coordinates);
            across.history_start = history_count;
            history_count += match axis {
                0 => layout.layers() * layout.rows * across.history_stride,
                _ => across.planes_with_history() * across.groups_per_face,
            };
            Some(across)
        });
        Self { across, history: vec![T::Lanes::ZERO; history_count] }
    }

    /// Creates the interlayers normal to an axis. `pairs`: number of pairs of waves.
    fn new_across(
        own: &Interlayers,
        (pairs, is_periodic): (usize, bool),
        layout: &Layout<D>,
        coordinates: &RegionCoordinates<D>,
    ) -> AxisInterlayers<T> {
        let axis = own.axis;
        let along = &coordinates.coordinates[axis];
        let variables = own.history_variables(pairs);
        let lines = match axis {
            0 => layout.layers() * layout.rows,
            _ if axis + 1 == D => layout.layer_groups(),
            _ => layout.layers() * layout.groups,
        };
        let mut across = AxisInterlayers {
            laws: own.laws.iter().map(|law| law.map(T::from_f64)).collect(),
            pairs,
            variables,
            has_plane: along.iter().map(|place| own.plane(*place).is_some()).collect(),
            is_periodic,
            patterns: vec![FacePattern::default()],
            pattern_indices: Vec::new(),
            pattern_stride: 0,
            stencil_indices: Vec::new(),
            stencils: Vec::new(),
            cells_per_stencil: 0,
            history_offsets: Vec::new(),
            history_start: 0,
            history_stride: variables,
            groups_per_face: if axis == 0 { variables } else { variables * lines },
        };
        let places = if axis == 0 { layout.groups } else { along.len() };
        let (beyond, count) = (GHOSTS as isize, along.len() as isize);
        let range = -beyond..places as isize + beyond;
        let is_uniform = own.is_uniform();
        let mut end = 0;
        for line in 0..if is_uniform { 1 } else { lines } {
            for place in range.clone() {
                let mut pattern = FacePattern::default();
                let mut has_history = false;
                for lane in 0..T::Lanes::COUNT {
                    // Place of the face along the axis.
                    let face = match axis {
                        0 => (lane * layout.groups) as isize + place,
                        _ => place,
                    };
                    if face < -beyond || face > count + beyond {
                        continue;
                    }
                    let Some(around) = across.face_coordinate(face) else { continue };
                    let own_history =
                        (0..=places as isize).contains(&place) && (0..=count).contains(&face);
                    has_history |= own_history;
                    let plane = own.plane(along[around]);
                    let in_plane = match is_uniform {
                        true => Some(0),
                        false => {
                            coordinates.face_in_plane(axis, local_cell(layout, axis, (line, lane)))
                        }
                    };
                    let law = in_plane.and_then(|face| plane?.law(face));
                    if let Some(law) = law {
                        pattern.add(law, 1 << lane, own_history);
                    }
                }
                let index = across.pattern_index(pattern);
                across.pattern_indices.push(index);
                if line == 0 {
                    across.history_offsets.push(end);
                    end += if has_history { across.groups_per_face } else { 0 };
                }
            }
        }
        if !is_uniform {
            across.pattern_stride = range.len();
        }
        if axis == 0 {
            across.history_stride = end;
        }
        across
    }

    /// Whether the whole problem has interlayers: if so, all subdomains exchange history variables, even those without
    /// interlayers.
    pub(super) fn has_interlayers(&self) -> bool {
        self.across.iter().any(Option::is_some)
    }

    /// Returns the interlayers on a path along an axis: lower faces of the groups at `places`, ghosts at the lower end
    /// with negative ones, of lines from `line` on. `None` without interlayers.
    pub(super) fn path_faces(
        &self,
        axis: usize,
        line: usize,
        places: Range<isize>,
    ) -> Option<PathFaces<'_, T>> {
        let own = self.across[axis].as_ref()?;
        let [start, end] =
            [places.start, places.end].map(|place| (place + GHOSTS as isize) as usize);
        Some(PathFaces {
            laws: &own.laws,
            variable_count: own.variables,
            patterns: &own.patterns,
            pattern_indices: &own.pattern_indices[line * own.pattern_stride + start..],
            pattern_stride: own.pattern_stride,
            stencil_indices: &own.stencil_indices[line * own.pattern_stride + start..],
            stencils: &own.stencils,
            cells_per_stencil: own.cells_per_stencil,
            history_offsets: &own.history_offsets[start..end],
            first_history_index: own.history_start + line * own.history_stride,
            history_stride: own.history_stride,
        })
    }

    /// Returns the site of the history variables of a face; `None` if it has none. `place`: coordinate of the face
    /// along the axis; `line` and `lane`: line of groups and lane of the line of cells, along rows the row and any
    /// lane.
    fn find_site(
        &self,
        layout: &Layout<D>,
        axis: usize,
        place: usize,
        (line, lane): (usize, usize),
    ) -> Option<(usize, usize, usize)> {
        let own = self.across[axis].as_ref()?;
        let (at, lane) = match axis {
            0 => (place % layout.groups, place / layout.groups),
            _ => (place, lane),
        };
        let law = own.pattern(line, at as isize).law(lane)?;
        Some((own.history_index(line, at), lane, law))
    }

    /// Returns the sites of the history variables at the lower faces of the cells of a layer across the last axis: by
    /// axis and cell.
    fn layer_sites(&self, layout: &Layout<D>, layer: usize) -> Vec<HistorySite> {
        let mut sites = Vec::new();
        let (first, cells) = (layer * layout.layer_cells(), layout.layer_cells());
        for (axis, own) in self.across.iter().enumerate() {
            let Some(own) = own else { continue };
            let stride: usize = layout.cells[..axis].iter().product();
            for cell in first..first + cells {
                // Along the last axis the place is the layer.
                let place = match axis + 1 == D {
                    true => layer,
                    false => cell / stride % layout.cells[axis],
                };
                if !own.has_plane[place] {
                    continue;
                }
                let (row, x) = (cell / layout.cells[0], cell % layout.cells[0]);
                let (group, lane) = (x % layout.groups, x / layout.groups);
                let line = match axis {
                    0 => row,
                    _ if axis + 1 == D => row % layout.rows * layout.groups + group,
                    _ => layer * layout.groups + group,
                };
                if let Some((group, lane, law)) = self.find_site(layout, axis, place, (line, lane))
                {
                    sites.push(HistorySite { axis, cell, law, group, lane });
                }
            }
        }
        sites
    }

    /// Returns the sites of the history variables at the lower faces of owned cells, layer by layer.
    pub(super) fn owned_sites(&self, layout: &Layout<D>) -> Vec<HistorySite> {
        self.sites_in_box(layout, &layout.owned)
    }

    /// Returns the sites of the history variables at the lower faces of the cells in a box, layer by layer.
    pub(super) fn sites_in_box(
        &self,
        layout: &Layout<D>,
        cells: &[Range<usize>; D],
    ) -> Vec<HistorySite> {
        if !self.has_interlayers() {
            return Vec::new();
        }
        let is_inside = |site: &HistorySite| {
            let mut rest = site.cell;
            cells.iter().zip(layout.cells).all(|(range, count)| {
                let place = rest % count;
                rest /= count;
                range.contains(&place)
            })
        };
        let sites = cells[D - 1].clone().flat_map(|layer| self.layer_sites(layout, layer));
        sites.filter(is_inside).collect()
    }

    /// Returns the number of history variables of a face normal to an axis.
    pub(super) fn variables(&self, axis: usize) -> usize {
        self.across[axis].as_ref().map_or(0, |own| own.variables)
    }

    /// Returns the law of a site.
    pub(super) fn law(&self, site: &HistorySite) -> Option<&InterlayerLaw<T>> {
        self.across[site.axis].as_ref()?.laws.get(site.law)
    }

    /// Returns the history variables of a site.
    pub(super) fn history(&self, site: &HistorySite) -> impl Iterator<Item = T> {
        let groups = site.group..site.group + self.variables(site.axis);
        self.history[groups].iter().map(|group| group.lanes()[site.lane])
    }

    /// Sets the history variables of a site to the next numbers.
    pub(super) fn set_history(
        &mut self,
        site: &HistorySite,
        history: &mut impl Iterator<Item = T>,
    ) {
        let groups = site.group..site.group + self.variables(site.axis);
        for (group, value) in self.history[groups].iter_mut().zip(history) {
            group.lanes_mut()[site.lane] = value;
        }
    }

    /// Returns the sums of the energies of the interlayers at the lower faces of owned cells; `area`: area of a face by
    /// axis, m².
    pub(super) fn sum_energies(&self, layout: &Layout<D>, area: [f64; D]) -> InterlayerSums {
        let mut sums = InterlayerSums::default();
        let laws = self.across.each_ref().map(|own| {
            let laws = own.as_ref().map_or(&[][..], |own| &own.laws);
            laws.iter().map(|law| law.map(T::to_f64)).collect::<Vec<_>>()
        });
        let mut history = Vec::new();
        for site in self.owned_sites(layout) {
            let Some(own) = &self.across[site.axis] else { continue };
            history.clear();
            history.extend(self.history(&site).map(T::to_f64));
            let energy = face_energy(&laws[site.axis][site.law], own.pairs, &history);
            sums.add(&energy, area[site.axis]);
        }
        sums
    }

    /// Copies the history variables at the lower faces of cells to the other copies in this subdomain.
    pub(super) fn synchronise_copies(&mut self, layout: &Layout<D>) {
        let Self { across, history } = self;
        if let Some(own) = &across[0] {
            for row in 0..layout.layers() * layout.rows {
                for place in 0..=layout.groups {
                    let lanes = own.pattern(row, place as isize).history_lanes;
                    for lane in (0..T::Lanes::COUNT).filter(|lane| lanes >> lane & 1 == 1) {
                        let face = (lane * layout.groups + place) as isize;
                        let Some(from) = own.face_coordinate(face) else { continue };
                        let (from_place, from_lane) = (from % layout.groups, from / layout.groups);
                        let from = own.history_index(row, from_place);
                        let to = own.history_index(row, place);
                        for index in 0..own.variables {
                            let value = history[from + index].lanes()[from_lane];
                            history[to + index].lanes_mut()[lane] = value;
                        }
                    }
                }
            }
        }
        for own in across[1..D - 1].iter().flatten() {
            let count = own.has_plane.len();
            if own.has_history_at(count) {
                let [from, to] = [0, count].map(|place| own.history_index(0, place));
                history.copy_within(from..from + own.groups_per_face, to);
            }
        }
    }
}

impl<T: Real> AxisInterlayers<T> {
    /// Whether some faces at a place, which may be that of the upper face of the last cell, have history variables.
    fn has_history_at(&self, place: usize) -> bool {
        self.face_coordinate(place as isize).is_some()
    }

    /// Returns the number of places with history variables along the axis, both ends of a periodic one included.
    fn planes_with_history(&self) -> usize {
        (0..=self.has_plane.len()).filter(|place| self.has_history_at(*place)).count()
    }
}

/// Returns the coordinates in the region of a cell in a lane of a line of groups along an axis; the coordinate along
/// the axis is arbitrary, and that along the first axis may be of a padding lane.
fn local_cell<const D: usize>(
    layout: &Layout<D>,
    axis: usize,
    (line, lane): (usize, usize),
) -> [usize; D] {
    let mut cell = [0; D];
    if axis == 0 {
        cell[D - 1] = line / layout.rows;
        if D == 3 {
            cell[1] = line % layout.rows;
        }
        return cell;
    }
    cell[0] = lane * layout.groups + line % layout.groups;
    if D == 3 {
        cell[if axis == 1 { 2 } else { 1 }] = line / layout.groups;
    }
    cell
}
