//! Materials by lane pattern: the medium of each cell, and the constants of waves and energy that follow from it.

use super::curvilinear::RowConstants;
use super::layout::Layout;
use super::material_table::{MaterialTable, WavePair};
use crate::simd::{LaneGroup, Real};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::GhostCoefficients;
use crate::solid::medium::{Medium, energy_terms_by_medium};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::shear_steps::ShearSteps;
use models::solid::waves::SolidField;
use std::collections::HashMap;

/// Terms of the energy density: offsets of two fields, and by pattern the coefficient of their product. Kinetic terms
/// come first.
#[derive(Clone)]
pub(super) struct EnergyCoefficients<T: Real> {
    pub(super) field_offsets: Vec<[usize; 2]>,
    pub(super) kinetic_count: usize,
    /// Coefficients by lane pattern, then by term.
    pub(super) factors: Vec<Vec<T::Lanes>>,
}

/// Media of all cells, halo included, and their constants by lane pattern.
#[derive(Clone)]
pub(super) struct Materials<T: Real, const D: usize> {
    pub(super) media: Vec<Medium>,
    /// Components of the state: fields of the media, then history variables.
    pub(super) fields: Vec<SolidField>,
    /// By cell, the index of its medium in `media`.
    pub(super) cell_media: Vec<u16>,
    /// By axis: pairs of waves in sweeps of half a step.
    pub(super) waves: [Vec<WavePair>; D],
    /// By axis: pairs of waves in steps that sweep longitudinal waves only; shear waves have the Courant number 0. Empty
    /// without such steps.
    pub(super) held_shear_waves: [Vec<WavePair>; D],
    /// Pairs of waves along the first axis in a sweep of a quarter of a step, for alternating sweeps; else empty.
    pub(super) quarter_step_waves: Vec<WavePair>,
    pub(super) table: MaterialTable<T>,
    /// Wave constants along rows, if the cell length depends on the layer; else `None`.
    pub(super) row_constants: Option<RowConstants<T>>,
    pub(super) energy_terms: EnergyCoefficients<T>,
    /// By group, the index of its lane pattern: groups of the rows, then ghosts beyond the ends of the swept lines.
    pub(super) lane_pattern_indices: Vec<u32>,
    /// By axis and group: number of next groups along the axis with the same lane pattern, at most 255; empty if there
    /// is only one pattern.
    pub(super) run_lengths: [Vec<u8>; D],
    /// By row, the indices of the lane patterns of its ghosts: at the lower, then at the upper end, nearest first;
    /// empty if there is only one pattern.
    pub(super) ghost_pattern_indices: Vec<[u32; 2 * GHOSTS]>,
}

/// Lane patterns (the medium of each lane of a group) in the order of their first use.
#[derive(Default)]
struct PatternSet {
    indices: HashMap<Vec<u16>, u32>,
    patterns: Vec<Vec<u16>>,
}

impl PatternSet {
    fn insert(&mut self, lanes: Vec<u16>) -> u32 {
        let (patterns, next) = (&mut self.patterns, self.indices.len() as u32);
        *self.indices.entry(lanes).or_insert_with_key(|lanes| {
            patterns.push(lanes.clone());
            next
        })
    }

    /// Inserts the lane patterns of a row. Returns the indices of the patterns of its groups, and of its ghosts at the
    /// lower and the upper end.
    fn insert_row<T: Real>(
        &mut self,
        media: &[u16],
        groups: usize,
        is_periodic: bool,
    ) -> (Vec<u32>, [u32; 2 * GHOSTS]) {
        let (lanes, length, groups) = (T::Lanes::COUNT as isize, media.len(), groups as isize);
        // Beyond the ends: the medium of the mirror image, or of the periodic image. Lanes that hold neither cells nor
        // ghosts get an arbitrary medium.
        let medium_at = |x: isize| {
            let own_medium = usize::try_from(x).ok().and_then(|x| media.get(x));
            let distance =
                if x < 0 { (-1 - x) as usize } else { x as usize - length.min(x as usize) };
            let depth = distance % length;
            let image_index = if (x < 0) == is_periodic { length - 1 - depth } else { depth };
            own_medium.copied().unwrap_or(media[image_index])
        };
        let mut group = |place: isize| {
            self.insert((0..lanes).map(|lane| medium_at(lane * groups + place)).collect())
        };
        let image_index = (0..groups).map(&mut group).collect();
        (image_index, [-1, -2, groups, groups + 1].map(group))
    }
}

/// Returns the index of a value in a list without duplicates; appends the value if it is not there.
fn insert_unique<N: PartialEq>(list: &mut Vec<N>, value: N) -> usize {
    list.iter().position(|own| *own == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

/// Returns by group the number of next groups with the same pattern, at most 255, along lines of `count` groups that
/// are `stride` apart; then zeros for `ghosts` ghosts.
fn compute_run_lengths(
    lane_pattern_indices: &[u32],
    stride: usize,
    count: usize,
    ghosts: usize,
) -> Vec<u8> {
    let mut lengths = vec![0_u8; lane_pattern_indices.len() + ghosts];
    for group in (0..lane_pattern_indices.len()).rev() {
        if group / stride % count + 1 < count
            && lane_pattern_indices[group] == lane_pattern_indices[group + stride]
        {
            lengths[group] = lengths[group + stride].saturating_add(1);
        }
    }
    lengths
}

/// Wave constants by medium; pairs of waves with equal constants share one entry.
struct WaveConstants<'a, T: Real, const D: usize> {
    problem: &'a Problem<D>,
    pitch: usize,
    cell_constants: Vec<Vec<CellConstants<T>>>,
    coupling_ratios: Vec<Vec<f64>>,
}

impl<T: Real, const D: usize> WaveConstants<'_, T, D> {
    /// Creates a pair of waves along an axis, for sweeps of `step_fraction` of the time step.
    fn create_pair(&mut self, axis: usize, pair: usize, step_fraction: f64) -> WavePair {
        let Problem { media, grid, scheme, step, .. } = self.problem;
        let fields = &media[0].fields;
        let index = |field: SolidField| fields.iter().position(|own| *own == field);
        let offset = |field: SolidField| index(field).map_or(0, |index| index * self.pitch);
        // Stresses that are passive in any medium; the coupling ratio is zero in media without that coupling.
        let passive_fields =
            media.iter().flat_map(|medium| &medium.pairs[axis][pair].passive_stresses);
        let mut passive_stresses: Vec<usize> =
            passive_fields.filter_map(|(field, _)| index(*field)).collect();
        passive_stresses.sort_unstable();
        passive_stresses.dedup();
        let cell = |medium: &Medium| {
            let wave_pair = &medium.pairs[axis][pair];
            let courant = wave_pair.speed() * (step_fraction * step / grid.spacing[axis]);
            scheme.slopes.cell_constants(wave_pair, courant, self.problem.has_interfaces())
        };
        let cells: Vec<CellConstants<T>> = media.iter().map(cell).collect();
        let ratio = |medium: &Medium, index: usize| {
            let mut passive_stresses = medium.pairs[axis][pair].passive_stresses.iter();
            passive_stresses.find(|own| own.0 == fields[index]).map_or(0.0, |own| own.1)
        };
        let ratios_of = |&index: &usize| media.iter().map(|medium| ratio(medium, index)).collect();
        let ratios: Vec<Vec<f64>> = passive_stresses.iter().map(ratios_of).collect();
        let wave_pair = &media[0].pairs[axis][pair];
        WavePair {
            velocity: offset(wave_pair.velocity),
            stress: offset(wave_pair.stress),
            constants_index: insert_unique(&mut self.cell_constants, cells),
            ratio_indices: ratios
                .into_iter()
                .map(|ratio| insert_unique(&mut self.coupling_ratios, ratio))
                .collect(),
            passive_stresses: passive_stresses
                .into_iter()
                .map(|index| index * self.pitch)
                .collect(),
        }
    }

    /// Creates the table of the constants of all lane patterns.
    fn create_table(&self, patterns: &[Vec<u16>]) -> MaterialTable<T> {
        let mut table = MaterialTable {
            cells_per_pattern: self.cell_constants.len(),
            ratios_per_pattern: self.coupling_ratios.len(),
            cell_constants: Vec::with_capacity(patterns.len() * self.cell_constants.len()),
            coupling_ratios: Vec::with_capacity(patterns.len() * self.coupling_ratios.len()),
            ghost_coefficients: Vec::new(),
        };
        for pattern in patterns {
            table.cell_constants.extend(
                self.cell_constants.iter().map(|cells| {
                    CellConstants::from_lanes(|lane| cells[usize::from(pattern[lane])])
                }),
            );
            let lanes = |ratio: &Vec<f64>| {
                T::Lanes::from_lanes(|lane| T::from_f64(ratio[usize::from(pattern[lane])]))
            };
            table.coupling_ratios.extend(self.coupling_ratios.iter().map(lanes));
        }
        if table.has_single_pattern() {
            table.ghost_coefficients =
                table.cell_constants.iter().map(GhostCoefficients::new).collect();
        }
        table
    }
}

impl<T: Real, const D: usize> Materials<T, D> {
    /// Creates the materials of the problem of a region, with or without periodic rows, and returns them with the media
    /// in the lanes of each lane pattern.
    pub(super) fn new(
        problem: &Problem<D>,
        layout: &Layout<D>,
        is_periodic: bool,
    ) -> (Self, Vec<Vec<u16>>) {
        let (media, fields) = (problem.media.clone(), problem.fields());
        let mut constants = WaveConstants {
            problem,
            pitch: layout.pitch,
            cell_constants: Vec::new(),
            coupling_ratios: Vec::new(),
        };
        let steps = ShearSteps::new(problem);
        let mut create_pairs = |in_held_steps: usize| -> [Vec<WavePair>; D] {
            std::array::from_fn(|axis| {
                let create = |(index, pair)| {
                    let fraction = steps.sweep_fractions(pair)[in_held_steps];
                    constants.create_pair(axis, index, fraction)
                };
                media[0].pairs[axis].iter().enumerate().map(create).collect()
            })
        };
        let waves = create_pairs(0);
        let held_shear_waves =
            if steps.differ() { create_pairs(1) } else { std::array::from_fn(|_| Vec::new()) };
        let pairs = (0..media[0].pairs[0].len()).filter(|_| problem.scheme.is_alternating());
        let quarter_step_waves = pairs.map(|pair| constants.create_pair(0, pair, 0.25)).collect();

        let mut pattern_set = PatternSet::default();
        let cell_media = problem.cell_media.clone();
        let rows: Vec<_> = cell_media
            .chunks(layout.cells[0])
            .map(|row| pattern_set.insert_row::<T>(row, layout.groups, is_periodic))
            .collect();
        let mut lane_pattern_indices: Vec<u32> =
            rows.iter().flat_map(|row| row.0.iter().copied()).collect();
        // By axis: distance to the next group of a line, and number of groups of a line.
        let lines: [[usize; 2]; D] = std::array::from_fn(|axis| match axis {
            0 => [1, layout.groups],
            _ if axis + 1 == D => [layout.layer_groups(), layout.layers()],
            _ => [layout.groups, layout.cells[axis]],
        });
        let ghosts = 2 * layout.ghosts * layout.ghost_rows() * layout.groups;
        let is_one = pattern_set.patterns.len() == 1;
        let run_lengths = lines.map(|[stride, count]| match is_one {
            true => Vec::new(),
            false => compute_run_lengths(&lane_pattern_indices, stride, count, ghosts),
        });
        lane_pattern_indices.extend(vec![0; ghosts]);
        let ghost_pattern_indices =
            if is_one { Vec::new() } else { rows.iter().map(|row| row.1).collect() };
        let materials = Self {
            cell_media,
            waves,
            held_shear_waves,
            quarter_step_waves,
            table: constants.create_table(&pattern_set.patterns),
            row_constants: None,
            energy_terms: EnergyCoefficients::new(
                &media,
                &fields,
                &pattern_set.patterns,
                layout.pitch,
            ),
            lane_pattern_indices,
            run_lengths,
            ghost_pattern_indices,
            media,
            fields,
        };
        (materials, pattern_set.patterns)
    }

    /// Returns the table of wave constants for sweeps along an axis; along rows that of the current row, if rows
    /// differ.
    #[inline(always)]
    pub(super) fn axis_table(&self, axis: usize) -> &MaterialTable<T> {
        match &self.row_constants {
            Some(rows) if axis == 0 => &rows.table,
            _ => &self.table,
        }
    }

    /// Returns the medium of a cell, given its index among all cells, halo included.
    #[inline(always)]
    pub(super) fn medium(&self, cell: usize) -> &Medium {
        &self.media[usize::from(self.cell_media[cell])]
    }
}

impl<T: Real> EnergyCoefficients<T> {
    fn new(media: &[Medium], fields: &[SolidField], patterns: &[Vec<u16>], pitch: usize) -> Self {
        let (terms, kinetic) = energy_terms_by_medium(media, fields);
        let factors = patterns.iter().map(|pattern| {
            let lane_coefficients = |term: &Vec<f64>| {
                T::Lanes::from_lanes(|lane| T::from_f64(term[usize::from(pattern[lane])]))
            };
            terms.values().map(lane_coefficients).collect()
        });
        Self {
            kinetic_count: kinetic,
            factors: factors.collect(),
            field_offsets: terms.keys().map(|indices| indices.map(|index| index * pitch)).collect(),
        }
    }
}
