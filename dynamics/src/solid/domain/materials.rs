//! Materials by lane pattern: the medium of each cell, and the constants of waves and energy that follow from it.

use super::curvilinear::RowSpacing;
use super::layout::Layout;
use super::schedule::CHUNK;
use super::table::{Table, WavePair};
use crate::simd::{Group, Real};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::GhostCoefficients;
use crate::solid::medium::{Medium, energy_terms_by_medium};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use models::solid::waves::Field;
use std::collections::HashMap;

/// Terms of the energy density: offsets of two fields, and by pattern the coefficient of their product. Kinetic terms
/// come first.
#[derive(Clone)]
pub(super) struct EnergyTerms<T: Real> {
    pub(super) places: Vec<[usize; 2]>,
    pub(super) kinetic: usize,
    /// Coefficients by pattern and term.
    pub(super) factors: Vec<Vec<T::Lanes>>,
}

/// Media of all cells, halo included, and their constants by lane pattern.
#[derive(Clone)]
pub(super) struct Materials<T: Real, const D: usize> {
    pub(super) media: Vec<Medium>,
    /// Components of the state: fields of the media, then memory variables.
    pub(super) fields: Vec<Field>,
    /// By cell, the index of its medium in `media`.
    pub(super) of_cell: Vec<u16>,
    /// By axis: pairs of waves in sweeps of half a step.
    pub(super) waves: [Vec<WavePair>; D],
    /// Pairs of waves along the first axis in a sweep of a quarter of a step, for alternating sweeps; else empty.
    pub(super) quarter_waves: Vec<WavePair>,
    pub(super) table: Table<T>,
    /// Wave constants along rows, if cell lengths or constants differ from layer to layer.
    pub(super) row_spacing: Option<RowSpacing<T>>,
    pub(super) energy_terms: EnergyTerms<T>,
    /// By group, the number of its lane pattern: groups of the rows, then ghosts beyond the ends of the swept lines.
    pub(super) patterns: Vec<u32>,
    /// By axis and group: number of next groups along the axis with the same pattern, at most 255; empty if there is
    /// only one pattern.
    pub(super) run_lengths: [Vec<u8>; D],
    /// By row, the patterns of its ghosts: at the lower, then at the upper end, nearest first; empty if there is only
    /// one pattern.
    pub(super) row_patterns: Vec<[u32; 2 * GHOSTS]>,
}

/// Lane patterns: the media in the lanes of a group, numbered in the order of their first use.
#[derive(Default)]
struct Patterns {
    known: HashMap<Vec<u16>, u32>,
    all: Vec<Vec<u16>>,
}

impl Patterns {
    fn number(&mut self, lanes: Vec<u16>) -> u32 {
        let (all, next) = (&mut self.all, self.known.len() as u32);
        *self.known.entry(lanes).or_insert_with_key(|lanes| {
            all.push(lanes.clone());
            next
        })
    }

    /// Returns the patterns of the groups of a row, and of its ghosts at the lower and the upper end.
    fn row<T: Real>(
        &mut self,
        media: &[u16],
        groups: usize,
        is_periodic: bool,
    ) -> (Vec<u32>, [u32; 2 * GHOSTS]) {
        let (lanes, length, groups) = (T::Lanes::COUNT as isize, media.len(), groups as isize);
        // Beyond the ends: the medium of the mirror image, or of the periodic one. Lanes that are neither cells nor
        // ghosts get an arbitrary medium.
        let at = |x: isize| {
            let inside = usize::try_from(x).ok().and_then(|x| media.get(x));
            let beyond =
                if x < 0 { (-1 - x) as usize } else { x as usize - length.min(x as usize) };
            let depth = beyond % length;
            let own = if (x < 0) == is_periodic { length - 1 - depth } else { depth };
            inside.copied().unwrap_or(media[own])
        };
        let mut group =
            |place: isize| self.number((0..lanes).map(|lane| at(lane * groups + place)).collect());
        let own = (0..groups).map(&mut group).collect();
        (own, [-1, -2, groups, groups + 1].map(group))
    }
}

/// Returns the index of a value in a list without duplicates; appends the value if it is not there.
fn number<N: PartialEq>(all: &mut Vec<N>, value: N) -> usize {
    all.iter().position(|own| *own == value).unwrap_or_else(|| {
        all.push(value);
        all.len() - 1
    })
}

/// Returns by group the number of next groups with the same pattern, at most 255, along lines of `count` groups that
/// are `stride` apart; then zeros for `ghosts` ghosts.
fn run_lengths(patterns: &[u32], stride: usize, count: usize, ghosts: usize) -> Vec<u8> {
    let mut lengths = vec![0_u8; patterns.len() + ghosts];
    for group in (0..patterns.len()).rev() {
        if group / stride % count + 1 < count && patterns[group] == patterns[group + stride] {
            lengths[group] = lengths[group + stride].saturating_add(1);
        }
    }
    lengths
}

/// Wave constants by medium; pairs of waves with equal constants share one entry.
struct WaveConstants<'a, T: Real, const D: usize> {
    problem: &'a Problem<D>,
    pitch: usize,
    cells: Vec<Vec<CellConstants<T>>>,
    ratios: Vec<Vec<f64>>,
}

impl<T: Real, const D: usize> WaveConstants<'_, T, D> {
    /// Returns a pair of waves along an axis, for sweeps of `share` of the time step.
    fn wave(&mut self, axis: usize, pair: usize, share: f64) -> WavePair {
        let Problem { media, grid, scheme, step, .. } = self.problem;
        let fields = &media[0].fields;
        let index = |field: Field| fields.iter().position(|own| *own == field);
        let place = |field: Field| index(field).map_or(0, |index| index * self.pitch);
        // Passive stresses of any medium; the coupling ratio is zero in media without that coupling.
        let all = media.iter().flat_map(|medium| &medium.pairs[axis][pair].passive_stresses);
        let mut passive_stresses: Vec<usize> = all.filter_map(|(field, _)| index(*field)).collect();
        passive_stresses.sort_unstable();
        passive_stresses.dedup();
        let cell = |medium: &Medium| {
            let own = &medium.pairs[axis][pair];
            let courant = own.speed() * (share * step / grid.spacing[axis]);
            scheme.slopes.cell_of(own, courant, self.problem.is_mixed())
        };
        let cells: Vec<CellConstants<T>> = media.iter().map(cell).collect();
        let ratio = |medium: &Medium, index: usize| {
            let mut own = medium.pairs[axis][pair].passive_stresses.iter();
            own.find(|own| own.0 == fields[index]).map_or(0.0, |own| own.1)
        };
        let ratios_of = |&index: &usize| media.iter().map(|own| ratio(own, index)).collect();
        let ratios: Vec<Vec<f64>> = passive_stresses.iter().map(ratios_of).collect();
        let own = &media[0].pairs[axis][pair];
        WavePair {
            velocity: place(own.velocity),
            stress: place(own.stress),
            constants: number(&mut self.cells, cells),
            ratios: ratios.into_iter().map(|ratio| number(&mut self.ratios, ratio)).collect(),
            passive_stresses: passive_stresses
                .into_iter()
                .map(|index| index * self.pitch)
                .collect(),
        }
    }

    /// Creates the table of the constants of all lane patterns.
    fn table(&self, patterns: &[Vec<u16>]) -> Table<T> {
        let mut table = Table {
            cells_of_pattern: self.cells.len(),
            ratios_of_pattern: self.ratios.len(),
            cells: Vec::with_capacity(patterns.len() * self.cells.len()),
            ratios: Vec::with_capacity(patterns.len() * self.ratios.len()),
            ghost_coefficients: Vec::new(),
        };
        for pattern in patterns {
            table.cells.extend(self.cells.iter().map(|cells| {
                let own = |value: fn(&CellConstants<T>) -> T| {
                    T::Lanes::by_lane(|lane| value(&cells[usize::from(pattern[lane])]))
                };
                CellConstants {
                    impedance: own(|cell| cell.impedance),
                    half_courant: own(|cell| cell.half_courant),
                    to_velocity: own(|cell| cell.to_velocity),
                    mean_slope: own(|cell| cell.mean_slope),
                    steepest: own(|cell| cell.steepest),
                    upwind: own(|cell| cell.upwind),
                    central: own(|cell| cell.central),
                    downwind: own(|cell| cell.downwind),
                }
            }));
            let lanes = |ratio: &Vec<f64>| {
                T::Lanes::by_lane(|lane| T::from_f64(ratio[usize::from(pattern[lane])]))
            };
            table.ratios.extend(self.ratios.iter().map(lanes));
        }
        if table.is_of_one_pattern() {
            table.ghost_coefficients = table.cells.iter().map(GhostCoefficients::new).collect();
        }
        table
    }
}

impl<T: Real, const D: usize> Materials<T, D> {
    /// Creates the materials of the problem of a region, with or without periodic rows, and returns the media in the
    /// lanes of each pattern.
    pub(super) fn new(
        problem: &Problem<D>,
        layout: &Layout<D>,
        is_periodic: bool,
    ) -> (Self, Vec<Vec<u16>>) {
        let (media, fields) = (problem.media.clone(), problem.fields());
        let mut constants =
            WaveConstants { problem, pitch: layout.pitch, cells: Vec::new(), ratios: Vec::new() };
        let waves: [Vec<WavePair>; D] = std::array::from_fn(|axis| {
            (0..media[0].pairs[axis].len()).map(|pair| constants.wave(axis, pair, 0.5)).collect()
        });
        let pairs = (0..media[0].pairs[0].len()).filter(|_| problem.scheme.alternates());
        let quarter_waves = pairs.map(|pair| constants.wave(0, pair, 0.25)).collect();

        let mut known = Patterns::default();
        let of_cell = problem.of_cell.clone();
        let rows: Vec<_> = of_cell
            .chunks(layout.cells[0])
            .map(|row| known.row::<T>(row, layout.groups, is_periodic))
            .collect();
        let mut patterns: Vec<u32> = rows.iter().flat_map(|row| row.0.iter().copied()).collect();
        // By axis: distance to the next group of a line, and number of groups of a line.
        let lines: [[usize; 2]; D] = std::array::from_fn(|axis| match axis {
            0 => [1, layout.groups],
            _ if axis + 1 == D => [layout.layer_groups(), layout.layers()],
            _ => [layout.groups, layout.cells[axis]],
        });
        let ghosts = 2 * GHOSTS * CHUNK * layout.groups;
        let is_one = known.all.len() == 1;
        let run_lengths = lines.map(|[stride, count]| match is_one {
            true => Vec::new(),
            false => run_lengths(&patterns, stride, count, ghosts),
        });
        patterns.extend(vec![0; ghosts]);
        let row_patterns = if is_one { Vec::new() } else { rows.iter().map(|row| row.1).collect() };
        let materials = Self {
            of_cell,
            waves,
            quarter_waves,
            table: constants.table(&known.all),
            row_spacing: None,
            energy_terms: EnergyTerms::new(&media, &fields, &known.all, layout.pitch),
            patterns,
            run_lengths,
            row_patterns,
            media,
            fields,
        };
        (materials, known.all)
    }

    /// Returns the wave constants for sweeps along an axis; along rows those of the current row, if rows differ.
    #[inline(always)]
    pub(super) fn table_along(&self, axis: usize) -> &Table<T> {
        match &self.row_spacing {
            Some(rows) if axis == 0 => &rows.table,
            _ => &self.table,
        }
    }

    /// Returns the medium of a cell, counted with the halo.
    #[inline(always)]
    pub(super) fn of(&self, cell: usize) -> &Medium {
        &self.media[usize::from(self.of_cell[cell])]
    }
}

impl<T: Real> EnergyTerms<T> {
    fn new(media: &[Medium], fields: &[Field], patterns: &[Vec<u16>], pitch: usize) -> Self {
        let (terms, kinetic) = energy_terms_by_medium(media, fields);
        let factors = patterns.iter().map(|pattern| {
            let of = |term: &Vec<f64>| {
                T::Lanes::by_lane(|lane| T::from_f64(term[usize::from(pattern[lane])]))
            };
            terms.values().map(of).collect()
        });
        Self {
            kinetic,
            factors: factors.collect(),
            places: terms.keys().map(|indices| indices.map(|index| index * pitch)).collect(),
        }
    }
}
