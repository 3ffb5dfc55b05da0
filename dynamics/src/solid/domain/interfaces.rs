//! Interlayers in a domain: at which faces they stand, and their history variables V and S ([`ElasticInterlayer`]).
//!
//! A sweep evaluates some faces in more than one place: the face between the last group of a lane and the first group of
//! the next lane at both ends of a row, the face between both ends of a periodic line twice, faces near a cut in both
//! parts. Each place keeps a copy of the history. All copies see the same states, and so they stay equal to the bit; in
//! halo layers they are exchanged with the fields. The copy that counts, for energy and output, is that at the lower face
//! of the cell above it, in the part that owns the cell.
//!
//! Elastic laws dissipate nothing: a law that does needs a term of the ledger, from the copies that count alone.

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

/// The lower face of a group on the path of a sweep.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Face {
    /// Lanes with an interlayer, by bits: the reconstruction does not look across it.
    pub(super) lanes: u16,
    /// Lanes of these whose memory is that of a face of the line.
    pub(super) active: u16,
    /// Where the memories stand behind that of the first face of the line, if any is active.
    pub(super) start: usize,
}

/// Interlayers across an axis.
#[derive(Clone)]
struct Across<T: Real> {
    laws: Vec<ElasticInterlayer<T>>,
    /// By coordinate of the cell whose lower face it is; along the last axis by layer, those of the halo included.
    has_interlayer: Vec<bool>,
    is_periodic: bool,
    /// By place of a group on a line, from the farther ghost in front of it to that behind it.
    faces: Vec<Face>,
    /// Where their memories begin.
    first: usize,
    /// From the memories of a line to those of the next one.
    line: usize,
    /// Memories of one place.
    slot: usize,
}

/// All interlayers, and their memories.
#[derive(Clone)]
pub(super) struct Interfaces<T: Real, const D: usize> {
    across: [Option<Across<T>>; D],
    /// Empty in a part without any.
    pub(super) memory: Vec<T::Lanes>,
    /// Buffer: the faces on the path of a sweep.
    pub(super) path: Vec<Face>,
}

/// The memory of an own face for a pair of waves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) axis: usize,
    pub(super) pair: usize,
    /// The cell behind the face, among all of the domain.
    pub(super) cell: usize,
    /// Where V stands; S is in the next group.
    group: usize,
    lane: usize,
}

impl<T: Real> Across<T> {
    /// The coordinate of the face that has an interlayer at a place, if it has.
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
    /// The interlayers of a region of a problem.
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

    /// Across the first axis: lanes follow each other along rows. Given are where interlayers stand, and whether rows are
    /// periodic.
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

    /// Across another axis: all lanes of a group have the same.
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

    /// Whether there are any in the whole domain: its parts exchange their memories, be there none.
    pub(super) fn is_any(&self) -> bool {
        self.across.iter().any(Option::is_some)
    }

    /// Whether there are any across an axis.
    pub(super) fn has(&self, axis: usize) -> bool {
        self.across[axis].is_some()
    }

    /// The laws across an axis, by pair; where the memories of a line begin; and from a line to the next one.
    pub(super) fn lines(
        &self,
        axis: usize,
        line: usize,
    ) -> Option<(&[ElasticInterlayer<T>], usize, usize)> {
        let own = self.across[axis].as_ref()?;
        Some((&own.laws, own.first + line * own.line, own.line))
    }

    /// The faces in front of groups at places of a line that follow each other.
    pub(super) fn faces(&self, axis: usize, places: Range<isize>) -> impl Iterator<Item = Face> {
        let own = self.across[axis].as_ref();
        places.map(move |place| {
            let face = usize::try_from(place + GHOSTS as isize);
            let face = face.ok().and_then(|index| own?.faces.get(index));
            face.copied().unwrap_or_default()
        })
    }

    /// The memory of a face of a line for a pair: the coordinate along the axis; the group of the line of groups among all,
    /// and its lane. Along rows these are the row and any lane.
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

    /// The memory of the face at a place of a line, the face behind it included, for a pair.
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

    /// The memories of the faces of a layer across the last axis: by axis, face and pair.
    fn sites(&self, layout: &Layout<D>, layer: usize) -> Vec<Site> {
        let mut sites = Vec::new();
        let (first, cells) = (layer * layout.layer_cells(), layout.layer_cells());
        for (axis, own) in self.across.iter().enumerate() {
            let Some(own) = own else { continue };
            let stride: usize = layout.cells[..axis].iter().product();
            for cell in first..first + cells {
                // The last axis counts layers.
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

    /// Those of the own cells, layer by layer.
    pub(super) fn own_sites(&self, layout: &Layout<D>) -> Vec<Site> {
        self.sites_in(layout, &layout.own)
    }

    /// Those of the cells in a box, layer by layer.
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

    /// V and S.
    pub(super) fn get(&self, site: &Site) -> [T; MEMORY] {
        [0, 1].map(|index| self.memory[site.group + index].lanes()[site.lane])
    }

    /// Sets V and S.
    pub(super) fn set(&mut self, site: &Site, memory: [T; MEMORY]) {
        for (index, value) in memory.into_iter().enumerate() {
            self.memory[site.group + index].lanes_mut()[site.lane] = value;
        }
    }

    /// Adds the energy of the faces of own cells, whose areas across the axes are given, m².
    pub(super) fn add_energy(&self, layout: &Layout<D>, area: [f64; D], sums: &mut EnergySums) {
        for site in self.own_sites(layout) {
            let Some(own) = &self.across[site.axis] else { continue };
            let (law, memory) = (&own.laws[site.pair], self.get(&site));
            let [kinetic, stored] = energy_of(law, memory, area[site.axis]);
            sums.interlayer_kinetic.add(kinetic);
            sums.interlayer_stored.add(stored);
        }
    }

    /// Copies the memories of faces into their other places; those of the halo come with it.
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

    /// All memories that stand with rows of a layer.
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

    /// The memories of rows of a layer across the last axis, if it has an interlayer.
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

    /// The memories of rows of a layer that a neighbour needs of its halo, or the layer itself of its own one: across the
    /// last axis, and in the plane along the row, since there passes have several steps.
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
