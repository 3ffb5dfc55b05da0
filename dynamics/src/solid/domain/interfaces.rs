//! Interlayers of a domain: their faces, and their history variables V and S ([`ElasticInterlayer`]).
//!
//! A sweep evaluates some faces more than once: the face between the last group of a lane and the first group of the
//! next lane at both ends of a row, the face between both ends of a periodic line twice, faces near a cut in both
//! subdomains. Each evaluation has its own copy of the history variables. All copies are updated from the same states
//! and thus stay equal to the bit; in halo layers they are exchanged with the fields. Energy and output use the copy at
//! the lower face of the cell above the interlayer, in the subdomain that owns the cell.
//!
//! Elastic laws dissipate nothing: a dissipative law would need a term of the ledger, from the copies used for energy
//! only.

use super::layout::Layout;
use crate::simd::{Group, Number, Real};
use crate::solid::boundary::Boundary;
use crate::solid::interlayers::{MEMORY, energy_of};
use crate::solid::ledger::EnergySums;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::region::Region;
use models::interface::elastic::ElasticInterlayer;
use std::ops::Range;

/// Lower face of a group on the path of a sweep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Face {
    /// Mask of the lanes with an interlayer: the reconstruction does not use differences across it.
    pub(super) lanes: u16,
    /// Mask of those of these lanes whose face belongs to the line, and so has history variables.
    pub(super) active: u16,
    /// Offset of the history variables from those of the first face of the line, if any lane is active.
    pub(super) start: usize,
}

/// Interlayers across an axis.
#[derive(Clone)]
struct Across<T: Real> {
    laws: Vec<ElasticInterlayer<T>>,
    /// By coordinate of a cell, whether its lower face has an interlayer; along the last axis by layer, halo included.
    has_interlayer: Vec<bool>,
    is_periodic: bool,
    /// Lower faces of the groups of a line, from the farther ghost at the lower end to the farther ghost at the upper
    /// end.
    faces: Vec<Face>,
    /// Index of the first history variable of this axis.
    first: usize,
    /// Distance between the history variables of two lines.
    line: usize,
    /// Number of groups of history variables at one place: for one line along rows, for all lines across other axes.
    slot: usize,
}

/// All interlayers and their history variables.
#[derive(Clone)]
pub(super) struct Interfaces<T: Real, const D: usize> {
    across: [Option<Across<T>>; D],
    /// History variables; empty in a subdomain without interlayers.
    pub(super) memory: Vec<T::Lanes>,
    /// Buffer: faces on the path of a sweep.
    pub(super) path: Vec<Face>,
}

/// Location of the history variables of an own face for a pair of waves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) axis: usize,
    pub(super) pair: usize,
    /// Cell at the upper side of the face, counted with the halo.
    pub(super) cell: usize,
    /// Group that holds V; the next group holds S.
    group: usize,
    lane: usize,
}

impl<T: Real> Across<T> {
    /// Returns the coordinate of the face at a place, periodic images included, if it has an interlayer.
    fn coordinate(&self, place: isize) -> Option<usize> {
        let count = self.has_interlayer.len();
        let around = match self.is_periodic {
            true => place.rem_euclid(count as isize),
            false => place,
        };
        let around = usize::try_from(around).ok()?;
        (around < count && self.has_interlayer[around]).then_some(around)
    }
}

impl<T: Real, const D: usize> Interfaces<T, D> {
    /// Creates the interlayers of a region of a problem.
    pub(super) fn new(problem: &Problem<D>, layout: &Layout<D>, region: &Region<D>) -> Self {
        let mut memories = 0;
        let across = std::array::from_fn(|axis| {
            let own = problem.interlayers_across(axis)?;
            let coordinates = region.coordinates(axis).into_iter();
            let has_interlayer = coordinates.map(|place| own.is_in_front_of(place)).collect();
            let is_periodic =
                problem.boundaries[axis][0] == Boundary::Periodic && region.halo(axis) == [0, 0];
            let (pairs, ends) = (own.laws.len(), (has_interlayer, is_periodic));
            let across = match axis {
                0 => Self::along_rows(pairs, layout, ends),
                _ => Self::across_rows(axis, pairs, layout, ends),
            };
            let laws = own.laws.iter().map(ElasticInterlayer::to_number).collect();
            let across = Across { laws, first: memories, ..across };
            let lines = match axis {
                0 => layout.layers() * layout.rows * across.line,
                _ => across.faces.iter().filter(|face| face.active != 0).count() * across.slot,
            };
            memories += lines;
            Some(across)
        });
        Self { across, memory: vec![T::Lanes::ZERO; memories], path: Vec::new() }
    }

    /// Creates the faces across the first axis, where the lanes of a group are different cells of a row, for `pairs`
    /// pairs of waves. Given are the cells with an interlayer at their lower face, and whether rows are periodic.
    fn along_rows(
        pairs: usize,
        layout: &Layout<D>,
        (has_interlayer, is_periodic): (Vec<bool>, bool),
    ) -> Across<T> {
        let (count, groups) = (layout.cells[0] as isize, layout.groups as isize);
        let mut across = Across {
            laws: Vec::new(),
            has_interlayer,
            is_periodic,
            faces: Vec::new(),
            first: 0,
            line: 0,
            slot: MEMORY * pairs,
        };
        let beyond = GHOSTS as isize;
        for place in -beyond..groups + beyond {
            let mut face = Face { start: across.line, ..Face::default() };
            for lane in 0..T::Lanes::COUNT {
                let x = lane as isize * groups + place;
                if x < -beyond || x > count + beyond || across.coordinate(x).is_none() {
                    continue;
                }
                face.lanes |= 1 << lane;
                if (0..=groups).contains(&place) && (0..=count).contains(&x) {
                    face.active |= 1 << lane;
                }
            }
            if face.active != 0 {
                across.line += across.slot;
            }
            across.faces.push(face);
        }
        across
    }

    /// Creates the faces across another axis, where all lanes of a group have an interlayer or none.
    fn across_rows(
        axis: usize,
        pairs: usize,
        layout: &Layout<D>,
        (has_interlayer, is_periodic): (Vec<bool>, bool),
    ) -> Across<T> {
        let lines = match axis + 1 == D {
            true => layout.layer_groups(),
            false => layout.layers() * layout.groups,
        };
        let mut across = Across {
            laws: Vec::new(),
            has_interlayer,
            is_periodic,
            faces: Vec::new(),
            first: 0,
            line: MEMORY * pairs,
            slot: MEMORY * pairs * lines,
        };
        let (count, beyond) = (across.has_interlayer.len() as isize, GHOSTS as isize);
        let all = ((1_u32 << T::Lanes::COUNT) - 1) as u16;
        let mut start = 0;
        for place in -beyond..count + beyond {
            let mut face = Face { start, ..Face::default() };
            if across.coordinate(place).is_some() {
                face.lanes = all;
                if (0..=count).contains(&place) {
                    face.active = all;
                    start += across.slot;
                }
            }
            across.faces.push(face);
        }
        across
    }

    /// Whether the whole problem has interlayers: if so, all subdomains exchange history variables, even those without
    /// interlayers.
    pub(super) fn is_any(&self) -> bool {
        self.across.iter().any(Option::is_some)
    }

    /// Whether there are interlayers across an axis.
    pub(super) fn has(&self, axis: usize) -> bool {
        self.across[axis].is_some()
    }

    /// Returns the laws across an axis, by pair of waves; the index of the history variables of a line; the distance
    /// between lines.
    pub(super) fn lines(
        &self,
        axis: usize,
        line: usize,
    ) -> Option<(&[ElasticInterlayer<T>], usize, usize)> {
        let own = self.across[axis].as_ref()?;
        Some((&own.laws, own.first + line * own.line, own.line))
    }

    /// Returns the lower faces of the groups at consecutive places of a line.
    pub(super) fn faces(&self, axis: usize, places: Range<isize>) -> impl Iterator<Item = Face> {
        let own = self.across[axis].as_ref();
        places.map(move |place| {
            let face = usize::try_from(place + GHOSTS as isize);
            let face = face.ok().and_then(|index| own?.faces.get(index));
            face.copied().unwrap_or_default()
        })
    }

    /// Returns group and lane of the history variables of a face of a line for a pair: `place` is the coordinate along
    /// the axis; `line` is the line of groups and its lane. Along rows these are the row and any lane.
    fn site(
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
        let start = own.first + line * own.line + face.start;
        (face.active >> lane & 1 == 1).then_some((start + MEMORY * pair, lane))
    }

    /// Returns the history variables of the face at a place of a line for a pair, the upper face of the last cell
    /// included.
    fn memory_at(
        &self,
        layout: &Layout<D>,
        (axis, pair): (usize, usize),
        place: isize,
        line: (usize, usize),
    ) -> Option<[T; MEMORY]> {
        let around = self.across[axis].as_ref()?.coordinate(place)?;
        let (group, lane) = self.site(layout, (axis, pair), around, line)?;
        Some([0, 1].map(|index| self.memory[group + index].lanes()[lane]))
    }

    /// Returns the sites of the faces of a layer across the last axis: by axis, face and pair of waves.
    fn sites(&self, layout: &Layout<D>, layer: usize) -> Vec<Site> {
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
                        self.site(layout, (axis, pair), place, (line, lane))
                    {
                        sites.push(Site { axis, pair, cell, group, lane });
                    }
                }
            }
        }
        sites
    }

    /// Returns the sites of the own cells, layer by layer.
    pub(super) fn own_sites(&self, layout: &Layout<D>) -> Vec<Site> {
        self.sites_in(layout, &layout.own)
    }

    /// Returns the sites of the cells in a box, layer by layer.
    pub(super) fn sites_in(&self, layout: &Layout<D>, cells: &[Range<usize>; D]) -> Vec<Site> {
        if !self.is_any() {
            return Vec::new();
        }
        let is_inside = |site: &Site| {
            let mut rest = site.cell;
            cells.iter().zip(layout.cells).all(|(range, count)| {
                let place = rest % count;
                rest /= count;
                range.contains(&place)
            })
        };
        let sites = cells[D - 1].clone().flat_map(|layer| self.sites(layout, layer));
        sites.filter(is_inside).collect()
    }

    /// Returns V and S of a site.
    pub(super) fn get(&self, site: &Site) -> [T; MEMORY] {
        [0, 1].map(|index| self.memory[site.group + index].lanes()[site.lane])
    }

    /// Sets V and S of a site.
    pub(super) fn set(&mut self, site: &Site, memory: [T; MEMORY]) {
        for (index, value) in memory.into_iter().enumerate() {
            self.memory[site.group + index].lanes_mut()[site.lane] = value;
        }
    }

    /// Adds the energy of the interlayers at own cells; `area` is the area of a face across each axis, m².
    pub(super) fn add_energy(&self, layout: &Layout<D>, area: [f64; D], sums: &mut EnergySums) {
        for site in self.own_sites(layout) {
            let Some(own) = &self.across[site.axis] else { continue };
            let (law, memory) = (&own.laws[site.pair], self.get(&site));
            let [kinetic, stored] = energy_of(law, memory, area[site.axis]);
            sums.interlayer_kinetic.add(kinetic);
            sums.interlayer_stored.add(stored);
        }
    }

    /// Copies the history variables of faces to the other copies in this subdomain; copies in the halo are overwritten
    /// by the exchange.
    pub(super) fn copy_to_other_places(&mut self, layout: &Layout<D>) {
        let own_layers = layout.own_layers();
        if let Some(across) = self.across[0].clone() {
            let rows = own_layers.start * layout.rows..own_layers.end * layout.rows;
            for (index, face) in across.faces.iter().enumerate() {
                for lane in (0..T::Lanes::COUNT).filter(|lane| face.active >> lane & 1 == 1) {
                    let x = lane * layout.groups + index - GHOSTS;
                    for row in rows.clone() {
                        for pair in 0..across.laws.len() {
                            let found = self.memory_at(layout, (0, pair), x as isize, (row, 0));
                            let start =
                                across.first + row * across.line + face.start + MEMORY * pair;
                            let Some(memory) = found else { continue };
                            for (index, value) in memory.into_iter().enumerate() {
                                self.memory[start + index].lanes_mut()[lane] = value;
                            }
                        }
                    }
                }
            }
        }
        for across in self.across[1..D - 1].iter().flatten() {
            let count = across.has_interlayer.len();
            let [front, behind] = [0, count].map(|place| across.faces[place + GHOSTS]);
            if behind.active != 0 {
                let from = across.first + front.start;
                self.memory.copy_within(from..from + across.slot, across.first + behind.start);
            }
        }
    }

    /// Returns the ranges of all history variables of rows of a layer.
    pub(super) fn stored(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> Vec<Range<usize>> {
        let mut stored: Vec<_> = self.across_last(layout, layer, rows).into_iter().collect();
        if let Some(own) = &self.across[0] {
            let [from, to] = [rows.start, rows.end].map(|row| layer * layout.rows + row);
            stored.push(own.first + from * own.line..own.first + to * own.line);
        }
        for own in self.across[1..D - 1].iter().flatten() {
            let is_end = rows.end == own.has_interlayer.len();
            for place in rows.start..rows.end + usize::from(is_end) {
                let face = own.faces[place + GHOSTS];
                if face.active != 0 {
                    let start = own.first + face.start + layer * layout.groups * own.line;
                    stored.push(start..start + layout.groups * own.line);
                }
            }
        }
        stored
    }

    /// Returns the range of the history variables of rows of a layer across the last axis, if the layer has an
    /// interlayer.
    fn across_last(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> Option<Range<usize>> {
        let own = self.across[D - 1].as_ref()?;
        let face = own.faces[layer + GHOSTS];
        let [from, to] = [rows.start, rows.end].map(|row| row * layout.groups * own.line);
        let start = own.first + face.start;
        (face.active != 0).then_some(start + from..start + to)
    }

    /// Returns the ranges of the history variables of rows of a layer that are copied into a halo along the last axis:
    /// those of interlayers across the last axis, and in the plane also across the first axis, since passes have
    /// several steps there.
    pub(super) fn pieces(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T, D> {
        let in_row = match (D, &self.across[0]) {
            (2, Some(own)) => {
                Some(own.first + layer * own.line..own.first + (layer + 1) * own.line)
            }
            _ => None,
        };
        self.across_last(layout, layer, rows).into_iter().chain(in_row)
    }
}
