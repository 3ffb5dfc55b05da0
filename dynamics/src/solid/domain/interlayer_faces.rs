//! Interlayers of a domain: their faces, and their history variables, mean velocity V and mean traction S
//! ([`ElasticInterlayer`]).
//!
//! A sweep evaluates some faces more than once: the face between the last group of a lane and the first group of the
//! next lane at both ends of a row, the face between both ends of a periodic line twice, faces near the boundary
//! between two subdomains in both of them. Each evaluation has its own copy of the history variables. All copies are
//! updated from the same states and thus stay equal bit for bit; in halo layers they are exchanged with the fields.
//! Energy and output use the copy at the lower face of the cell above the interlayer, in the subdomain that owns the
//! cell.
//!
//! Elastic laws dissipate nothing: a dissipative law would need a term of the ledger, computed from the copies used for
//! energy only.

use super::layout::Layout;
use crate::simd::{LaneGroup, Number, Real};
use crate::solid::boundary::Boundary;
use crate::solid::interlayers::{HISTORY_VARIABLES, interlayer_energy};
use crate::solid::ledger::EnergySums;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::region::Region;
use models::interface::elastic::ElasticInterlayer;
use std::ops::Range;

/// Lower face of a group on the path of a sweep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GroupFace {
    /// Mask of the lanes with an interlayer: the reconstruction does not use differences across it.
    pub(super) interlayer_lanes: u16,
    /// Mask of the lanes with an interlayer whose face is not one between two ghosts, and therefore has history
    /// variables.
    pub(super) history_lanes: u16,
    /// Offset of the history variables from those of the first face of the line, if `history_lanes` is not 0.
    pub(super) history_offset: usize,
}

/// Interlayers normal to an axis.
#[derive(Clone)]
struct AxisInterlayers<T: Real> {
    laws: Vec<ElasticInterlayer<T>>,
    /// By coordinate of a cell, whether its lower face has an interlayer; along the last axis by layer, halo included.
    has_interlayer: Vec<bool>,
    is_periodic: bool,
    /// Lower faces of the groups of a line, from the farther ghost at the lower end to the farther ghost at the upper
    /// end.
    faces: Vec<GroupFace>,
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
    /// Buffer: faces on the path of a sweep.
    pub(super) path_faces: Vec<GroupFace>,
}

/// Location of the history variables of an owned face for a pair of waves.
#[derive(Clone, Copy, Debug)]
pub(super) struct HistorySite {
    pub(super) axis: usize,
    pub(super) pair: usize,
    /// Cell above the face (index among all cells, halo included).
    pub(super) cell: usize,
    /// Index of the group that holds V; the next group holds S.
    group: usize,
    lane: usize,
}

impl<T: Real> AxisInterlayers<T> {
    /// Creates the interlayers normal to an axis, without laws and faces. `has_interlayer`: by cell, whether its lower
    /// face has an interlayer.
    fn new(
        (has_interlayer, is_periodic): (Vec<bool>, bool),
        [history_stride, groups_per_face]: [usize; 2],
    ) -> Self {
        let (laws, faces) = (Vec::new(), Vec::new());
        Self {
            laws,
            has_interlayer,
            is_periodic,
            faces,
            history_start: 0,
            history_stride,
            groups_per_face,
        }
    }

    /// Returns the coordinate of the face at a place along the axis, wrapped around a periodic axis; `None` if the face
    /// has no interlayer.
    fn face_coordinate(&self, place: isize) -> Option<usize> {
        let count = self.has_interlayer.len();
        let around = match self.is_periodic {
            true => place.rem_euclid(count as isize),
            false => place,
        };
        let around = usize::try_from(around).ok()?;
        (around < count && self.has_interlayer[around]).then_some(around)
    }
}

impl<T: Real, const D: usize> LaneInterlayers<T, D> {
    /// Creates the interlayers of a region of a problem.
    pub(super) fn new(problem: &Problem<D>, layout: &Layout<D>, region: &Region<D>) -> Self {
        let mut history_count = 0;
        let across = std::array::from_fn(|axis| {
            let own = problem.interlayers_across(axis)?;
            let coordinates = region.coordinates(axis).into_iter();
            let has_interlayer = coordinates.map(|place| own.has_interlayer_at(place)).collect();
            let is_periodic =
                problem.boundaries[axis][0] == Boundary::Periodic && region.halo(axis) == [0, 0];
            let (pairs, ends) = (own.laws.len(), (has_interlayer, is_periodic));
            let across = match axis {
                0 => Self::new_along_rows(pairs, layout, ends),
                _ => Self::new_across_rows(axis, pairs, layout, ends),
            };
            let laws = own.laws.iter().map(ElasticInterlayer::to_number).collect();
            let across = AxisInterlayers { laws, history_start: history_count, ..across };
            let lines = match axis {
                0 => layout.layers() * layout.rows * across.history_stride,
                _ => {
                    across.faces.iter().filter(|face| face.history_lanes != 0).count()
                        * across.groups_per_face
                }
            };
            history_count += lines;
            Some(across)
        });
        Self { across, history: vec![T::Lanes::ZERO; history_count], path_faces: Vec::new() }
    }

    /// Creates the faces across the first axis, where the lanes of a group are different cells of a row. `pairs`:
    /// number of pairs of waves; `ends`: by cell whether its lower face has an interlayer, and whether rows are
    /// periodic.
    fn new_along_rows(
        pairs: usize,
        layout: &Layout<D>,
        ends: (Vec<bool>, bool),
    ) -> AxisInterlayers<T> {
        let (count, groups) = (layout.cells[0] as isize, layout.groups as isize);
        let mut across = AxisInterlayers::new(ends, [0, HISTORY_VARIABLES * pairs]);
        let beyond = GHOSTS as isize;
        for place in -beyond..groups + beyond {
            let mut face =
                GroupFace { history_offset: across.history_stride, ..GroupFace::default() };
            for lane in 0..T::Lanes::COUNT {
                let x = lane as isize * groups + place;
                if x < -beyond || x > count + beyond || across.face_coordinate(x).is_none() {
                    continue;
                }
                face.interlayer_lanes |= 1 << lane;
                if (0..=groups).contains(&place) && (0..=count).contains(&x) {
                    face.history_lanes |= 1 << lane;
                }
            }
            if face.history_lanes != 0 {
                across.history_stride += across.groups_per_face;
            }
            across.faces.push(face);
        }
        across
    }

    /// Creates the faces across another axis, where either all lanes of a group have an interlayer or none; arguments
    /// as for [`Self::new_along_rows`].
    fn new_across_rows(
        axis: usize,
        pairs: usize,
        layout: &Layout<D>,
        ends: (Vec<bool>, bool),
    ) -> AxisInterlayers<T> {
        let lines = match axis + 1 == D {
            true => layout.layer_groups(),
            false => layout.layers() * layout.groups,
        };
        let variables = HISTORY_VARIABLES * pairs;
        let mut across = AxisInterlayers::new(ends, [variables, variables * lines]);
        let (count, beyond) = (across.has_interlayer.len() as isize, GHOSTS as isize);
        let all = ((1_u32 << T::Lanes::COUNT) - 1) as u16;
        let mut start = 0;
        for place in -beyond..count + beyond {
            let mut face = GroupFace { history_offset: start, ..GroupFace::default() };
            if across.face_coordinate(place).is_some() {
                face.interlayer_lanes = all;
                if (0..=count).contains(&place) {
                    face.history_lanes = all;
                    start += across.groups_per_face;
                }
            }
            across.faces.push(face);
        }
        across
    }

    /// Whether the whole problem has interlayers: if so, all subdomains exchange history variables, even those without
    /// interlayers.
    pub(super) fn has_interlayers(&self) -> bool {
        self.across.iter().any(Option::is_some)
    }

    /// Whether there are interlayers normal to an axis.
    pub(super) fn has_interlayers_across(&self, axis: usize) -> bool {
        self.across[axis].is_some()
    }

    /// Returns the laws of the interlayers normal to an axis, by pair of waves; the index of the history variables of a
    /// line; and the distance between those of two lines. `None` without interlayers.
    pub(super) fn line_history(
        &self,
        axis: usize,
        line: usize,
    ) -> Option<(&[ElasticInterlayer<T>], usize, usize)> {
        let own = self.across[axis].as_ref()?;
        Some((&own.laws, own.history_start + line * own.history_stride, own.history_stride))
    }

    /// Returns the lower faces of the groups at consecutive places of a line; ghosts at the lower end have negative
    /// places.
    pub(super) fn path_faces(
        &self,
        axis: usize,
        places: Range<isize>,
    ) -> impl Iterator<Item = GroupFace> {
        let own = self.across[axis].as_ref();
        places.map(move |place| {
            let face = usize::try_from(place + GHOSTS as isize);
            let face = face.ok().and_then(|index| own?.faces.get(index));
            face.copied().unwrap_or_default()
        })
    }

    /// Returns group and lane of the history variables of a face for a pair of waves; `None` if it has none. `place`:
    /// coordinate of the face along the axis; `line` and `lane`: line of groups and lane of the line of cells, along
    /// rows the row and any lane.
    fn find_site(
        &self,
        layout: &Layout<D>,
        (axis, pair): (usize, usize),
        place: usize,
        (line, lane): (usize, usize),
    ) -> Option<(usize, usize)> {
        let own = self.across[axis].as_ref()?;
        let (at, lane) = match axis {
            0 => (place % layout.groups, place / layout.groups),
            _ => (place, lane),
        };
        let face = own.faces.get(at + GHOSTS)?;
        let start = own.history_start + line * own.history_stride + face.history_offset;
        (face.history_lanes >> lane & 1 == 1).then_some((start + HISTORY_VARIABLES * pair, lane))
    }

    /// Returns the history variables of the face at a place of a line for a pair of waves; `None` if it has none.
    /// `place` may be that of the upper face of the last cell; `line`: line of groups and lane.
    fn history_at(
        &self,
        layout: &Layout<D>,
        (axis, pair): (usize, usize),
        place: isize,
        line: (usize, usize),
    ) -> Option<[T; HISTORY_VARIABLES]> {
        let around = self.across[axis].as_ref()?.face_coordinate(place)?;
        let (group, lane) = self.find_site(layout, (axis, pair), around, line)?;
        Some([0, 1].map(|index| self.history[group + index].lanes()[lane]))
    }

    /// Returns the sites of the history variables at the lower faces of the cells of a layer across the last axis: by
    /// axis, cell and pair of waves.
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
                if !own.has_interlayer[place] {
                    continue;
                }
                let (row, x) = (cell / layout.cells[0], cell % layout.cells[0]);
                let (group, lane) = (x % layout.groups, x / layout.groups);
                let line = match axis {
                    0 => row,
                    _ if axis + 1 == D => row % layout.rows * layout.groups + group,
                    _ => layer * layout.groups + group,
                };
                for pair in 0..own.laws.len() {
                    if let Some((group, lane)) =
                        self.find_site(layout, (axis, pair), place, (line, lane))
                    {
                        sites.push(HistorySite { axis, pair, cell, group, lane });
                    }
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

    /// Returns the history variables V and S of a site.
    pub(super) fn history(&self, site: &HistorySite) -> [T; HISTORY_VARIABLES] {
        [0, 1].map(|index| self.history[site.group + index].lanes()[site.lane])
    }

    /// Sets the history variables V and S of a site.
    pub(super) fn set_history(&mut self, site: &HistorySite, history: [T; HISTORY_VARIABLES]) {
        for (index, value) in history.into_iter().enumerate() {
            self.history[site.group + index].lanes_mut()[site.lane] = value;
        }
    }

    /// Adds the energy of the interlayers at the lower faces of owned cells; `area`: area of a face by axis, m².
    pub(super) fn add_energy(&self, layout: &Layout<D>, area: [f64; D], sums: &mut EnergySums) {
        for site in self.owned_sites(layout) {
            let Some(own) = &self.across[site.axis] else { continue };
            let (law, history) = (&own.laws[site.pair], self.history(&site));
            let [kinetic, stored] = interlayer_energy(law, history, area[site.axis]);
            sums.interlayer_kinetic.add(kinetic);
            sums.interlayer_stored.add(stored);
        }
    }

    /// Copies the history variables at the lower faces of cells to the other copies in this subdomain; copies in the
    /// halo are overwritten by the exchange.
    pub(super) fn synchronise_copies(&mut self, layout: &Layout<D>) {
        let owned_layers = layout.owned_layers();
        if let Some(across) = self.across[0].clone() {
            let rows = owned_layers.start * layout.rows..owned_layers.end * layout.rows;
            for (index, face) in across.faces.iter().enumerate() {
                for lane in (0..T::Lanes::COUNT).filter(|lane| face.history_lanes >> lane & 1 == 1)
                {
                    let x = lane * layout.groups + index - GHOSTS;
                    for row in rows.clone() {
                        for pair in 0..across.laws.len() {
                            let found = self.history_at(layout, (0, pair), x as isize, (row, 0));
                            let start = across.history_start
                                + row * across.history_stride
                                + face.history_offset
                                + HISTORY_VARIABLES * pair;
                            let Some(history) = found else { continue };
                            for (index, value) in history.into_iter().enumerate() {
                                self.history[start + index].lanes_mut()[lane] = value;
                            }
                        }
                    }
                }
            }
        }
        for across in self.across[1..D - 1].iter().flatten() {
            let count = across.has_interlayer.len();
            let [front, behind] = [0, count].map(|place| across.faces[place + GHOSTS]);
            if behind.history_lanes != 0 {
                let from = across.history_start + front.history_offset;
                self.history.copy_within(
                    from..from + across.groups_per_face,
                    across.history_start + behind.history_offset,
                );
            }
        }
    }

    /// Returns the ranges of all history variables of `rows` of a layer.
    pub(super) fn history_ranges(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> Vec<Range<usize>> {
        let mut stored: Vec<_> = self.last_axis_range(layout, layer, rows).into_iter().collect();
        if let Some(own) = &self.across[0] {
            let [from, to] = [rows.start, rows.end].map(|row| layer * layout.rows + row);
            stored.push(
                own.history_start + from * own.history_stride
                    ..own.history_start + to * own.history_stride,
            );
        }
        for own in self.across[1..D - 1].iter().flatten() {
            let is_end = rows.end == own.has_interlayer.len();
            for place in rows.start..rows.end + usize::from(is_end) {
                let face = own.faces[place + GHOSTS];
                if face.history_lanes != 0 {
                    let start = own.history_start
                        + face.history_offset
                        + layer * layout.groups * own.history_stride;
                    stored.push(start..start + layout.groups * own.history_stride);
                }
            }
        }
        stored
    }

    /// Returns the range of the history variables of the interlayer below a layer across the last axis, for `rows` of
    /// the layer; `None` if there is no interlayer.
    fn last_axis_range(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> Option<Range<usize>> {
        let own = self.across[D - 1].as_ref()?;
        let face = own.faces[layer + GHOSTS];
        let [from, to] = [rows.start, rows.end].map(|row| row * layout.groups * own.history_stride);
        let start = own.history_start + face.history_offset;
        (face.history_lanes != 0).then_some(start + from..start + to)
    }

    /// Returns the ranges of the history variables of rows of a layer that are copied into a halo along the last axis:
    /// those of interlayers across the last axis, and in the plane also across the first axis, since passes have
    /// several steps there.
    pub(super) fn exchanged_ranges(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T, D> {
        let in_row = match (D, &self.across[0]) {
            (2, Some(own)) => Some(
                own.history_start + layer * own.history_stride
                    ..own.history_start + (layer + 1) * own.history_stride,
            ),
            _ => None,
        };
        self.last_axis_range(layout, layer, rows).into_iter().chain(in_row)
    }
}
