//! Rows with a cell length that depends on the layer, and the rotation of the state by the curvature of rows: see
//! [`crate::solid::metric`].
//!
//! Wave constants along rows depend on the medium and on the layer. Lines across layers use the table by lane patterns
//! of media, since with constants by layer no two of their cells would share a pattern; rows have a separate table,
//! which is filled for the row that is swept.

use super::contacts::LaneContacts;
use super::layout::RowSegment;
use super::material_table::{MaterialTable, WavePair};
use super::{Domain, SolverReal};
use crate::simd::{LaneGroup, Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::cell_laws::LawInterval;
use crate::solid::ghosts::GhostCoefficients;
use crate::solid::medium::Medium;
use crate::solid::metric::{CurvatureRotation, rotate_pair_by_curvature};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use std::ops::Range;

/// Pairs of waves along rows, and their constants in the current row.
#[derive(Clone)]
pub(super) struct RowConstants<T: Real> {
    /// Cell length along rows by layer, m.
    pub(super) spacing: Vec<f64>,
    pub(super) waves: Vec<WavePair>,
    pub(super) table: MaterialTable<T>,
    /// Wave constants by layer, medium and pair of waves.
    cell_constants: Vec<Vec<Vec<CellConstants<T>>>>,
    /// By lane pattern, the index of the medium of each lane.
    patterns: Vec<Vec<u16>>,
    /// By pattern, the layer for which the table is filled; `usize::MAX` before the first.
    filled_layers: Vec<usize>,
}

impl<T: Real> RowConstants<T> {
    /// Creates the constants of `layers` of a problem (indices in the whole grid) from the waves along rows and the
    /// table for uniform cell lengths; `None` without a metric.
    pub(super) fn new<const D: usize>(
        problem: &Problem<D>,
        (waves, table): (&[WavePair], &MaterialTable<T>),
        patterns: &[Vec<u16>],
        layers: &[usize],
    ) -> Option<Self> {
        let metric = problem.metric.as_ref()?;
        let spacing: Vec<f64> = layers.iter().map(|layer| metric.spacing[*layer]).collect();
        let waves = waves.iter().enumerate();
        let waves: Vec<_> =
            waves.map(|(pair, own)| WavePair { constants_index: pair, ..own.clone() }).collect();
        let cells_of = |spacing: &f64| {
            let medium_constants = |medium: &Medium| {
                let cell = |pair: &models::solid::waves::VelocityStressPair| {
                    let courant = pair.speed() * (0.5 * problem.step / spacing);
                    problem.scheme.slopes.cell_constants(pair, courant, problem.has_interfaces())
                };
                medium.pairs[0].iter().map(cell).collect()
            };
            problem.media.iter().map(medium_constants).collect()
        };
        let count = patterns.len() * waves.len();
        Some(Self {
            table: MaterialTable {
                // Placeholder, overwritten by `fill_table`.
                cell_constants: vec![table.cell_constants[0]; count],
                cells_per_pattern: waves.len(),
                ghost_coefficients: Vec::new(),
                ..table.clone()
            },
            cell_constants: spacing.iter().map(cells_of).collect(),
            patterns: patterns.to_vec(),
            filled_layers: vec![usize::MAX; patterns.len()],
            waves,
            spacing,
        })
    }

    /// Fills the table, and the constants of the faces of contacts, with the constants of a layer, for the lane
    /// patterns that occur in the layer.
    fn fill_table(
        &mut self,
        layer: usize,
        lane_pattern_indices: impl Iterator<Item = u32>,
        contacts: &mut Option<LaneContacts<T>>,
    ) {
        for pattern in lane_pattern_indices.map(|pattern| pattern as usize) {
            if std::mem::replace(&mut self.filled_layers[pattern], layer) == layer {
                continue;
            }
            let (media, cells) = (&self.patterns[pattern], &self.cell_constants[layer]);
            if let Some(contacts) = contacts {
                contacts.fill_row_faces(layer, pattern, media);
            }
            let row_constants = self.table.cell_constants[pattern * self.waves.len()..].iter_mut();
            for (pair, lanes) in row_constants.take(self.waves.len()).enumerate() {
                for (lane, medium) in media.iter().enumerate() {
                    lanes.set_lane(lane, &cells[usize::from(*medium)][pair]);
                }
            }
        }
        if self.table.has_single_pattern() {
            self.table.ghost_coefficients =
                self.table.cell_constants.iter().map(GhostCoefficients::new).collect();
        }
    }
}

/// Rotation plane of the curvature of rows ([`CurvatureRotation`], with its symbols) in SIMD lanes.
#[derive(Clone)]
struct RotationPlane<T: Real> {
    /// Offset of the velocity or spin v in a row, in groups.
    velocity: usize,
    /// Offsets of stresses, and entries of the weights q.
    weights: Vec<(usize, T)>,
    /// Offsets of stresses, and by lane pattern entries of Cq.
    moduli: Vec<(usize, Vec<T::Lanes>)>,
    /// Rotation coefficients by lane pattern, for the layer and the interval of
    /// [`CurvatureRotations::filled_intervals`].
    coefficients: Vec<[T::Lanes; 4]>,
    /// Rotation coefficients by layer, [`LawInterval`] and medium.
    layer_coefficients: Vec<[Vec<[T; 4]>; 2]>,
}

/// Rotation of the state by the curvature of rows.
#[derive(Clone)]
pub(super) struct CurvatureRotations<T: Real> {
    planes: Vec<RotationPlane<T>>,
    patterns: Vec<Vec<u16>>,
    /// By lane pattern, the layer and the interval for which the rotation coefficients are filled; `None` before the
    /// first.
    filled_intervals: Vec<Option<(usize, LawInterval)>>,
}

impl<T: Real> CurvatureRotations<T> {
    /// Creates the rotation in `layers` of a region of a problem (indices in the whole grid); `None` for straight rows.
    /// The offset of a field is its index times `pitch`.
    pub(super) fn new<const D: usize>(
        problem: &Problem<D>,
        patterns: &[Vec<u16>],
        pitch: usize,
        layers: &[usize],
    ) -> Option<Self> {
        let curvature = &problem.metric.as_ref().filter(|own| !own.curvature.is_empty())?.curvature;
        let rotations_by_medium = CurvatureRotation::from_media(&problem.media);
        let plane = |index: usize| {
            let planes: Vec<&CurvatureRotation> =
                rotations_by_medium.iter().map(|own| &own[index]).collect();
            let lanes = |pattern: &Vec<u16>, entry: usize| {
                T::Lanes::from_lanes(|lane| {
                    T::from_f64(planes[usize::from(pattern[lane])].moduli[entry].1)
                })
            };
            let moduli = planes[0].moduli.iter().enumerate().map(|(entry, &(place, _))| {
                (place * pitch, patterns.iter().map(|own| lanes(own, entry)).collect())
            });
            let weights = planes[0].weights.iter();
            let constants = |layer: &usize| {
                LawInterval::evaluate_both(|step_fraction| {
                    let coefficients = |plane: &&CurvatureRotation| {
                        plane
                            .coefficients(curvature[*layer], step_fraction * problem.step)
                            .map(T::from_f64)
                    };
                    planes.iter().map(coefficients).collect()
                })
            };
            RotationPlane {
                velocity: planes[0].velocity * pitch,
                weights: weights.map(|&(place, q)| (place * pitch, T::from_f64(q))).collect(),
                moduli: moduli.collect(),
                coefficients: vec![[T::Lanes::ZERO; 4]; patterns.len()],
                layer_coefficients: layers.iter().map(constants).collect(),
            }
        };
        Some(Self {
            planes: (0..rotations_by_medium[0].len()).map(plane).collect(),
            patterns: patterns.to_vec(),
            filled_intervals: vec![None; patterns.len()],
        })
    }

    /// Fills the rotation coefficients of lane patterns for a layer and an interval.
    fn fill_coefficients(
        &mut self,
        layer: usize,
        interval: LawInterval,
        lane_pattern_indices: &[u32],
    ) {
        for pattern in lane_pattern_indices.iter().map(|pattern| *pattern as usize) {
            let filled = Some((layer, interval));
            if std::mem::replace(&mut self.filled_intervals[pattern], filled) == filled {
                continue;
            }
            for plane in &mut self.planes {
                for (lane, medium) in self.patterns[pattern].iter().enumerate() {
                    let medium_coefficients =
                        plane.layer_coefficients[layer][interval as usize][usize::from(*medium)];
                    for (lanes, value) in
                        plane.coefficients[pattern].iter_mut().zip(medium_coefficients)
                    {
                        lanes.lanes_mut()[lane] = value;
                    }
                }
            }
        }
    }
}

/// Kernel: rotation by the curvature of rows in adjacent groups of a row.
struct CurvatureKernel<'a, T: Real> {
    /// Field values from the first of these groups on.
    field_data: &'a mut [T::Lanes],
    lane_pattern_indices: &'a [u32],
    planes: &'a [RotationPlane<T>],
}

impl<T: Real> SimdKernel<T> for CurvatureKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        for (index, &pattern) in self.lane_pattern_indices.iter().enumerate() {
            let (group, pattern) = (&mut self.field_data[index..], pattern as usize);
            for plane in self.planes {
                let [cos, a, b, c] = &plane.coefficients[pattern];
                let constants = [V::load(cos), V::load(a), V::load(b), V::load(c)];
                let mut y = V::ZERO;
                for (place, weight) in &plane.weights {
                    y = y + <V as Vector<T>>::splat(*weight) * V::load(&group[*place]);
                }
                let v = V::load(&group[plane.velocity]);
                let [v, strain] = rotate_pair_by_curvature(constants, v, y);
                v.store(&mut group[plane.velocity]);
                for (offset, moduli) in &plane.moduli {
                    let stress = V::load(&group[*offset]);
                    (stress - V::load(&moduli[pattern]) * strain).store(&mut group[*offset]);
                }
            }
        }
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Rotates the state by the curvature of rows over `interval`, and completes the strain increment of the rotation in
    /// media with contacts, as after a sweep; in the plane only, where layers are rows.
    pub(super) fn rotate_by_curvature(
        &mut self,
        layers: &Range<usize>,
        tile: &RowSegment,
        interval: LawInterval,
    ) {
        let Some(rotation) = &mut self.lane_laws.curvature_rotations else { return };
        for layer in layers.clone() {
            let (first, groups) = self.layout.segment_groups(layer, tile);
            let lane_pattern_indices = &self.materials.lane_pattern_indices[groups];
            rotation.fill_coefficients(layer, interval, lane_pattern_indices);
            self.instructions.run_kernel::<T>(CurvatureKernel {
                field_data: &mut self.field_data[first..],
                lane_pattern_indices,
                planes: &rotation.planes,
            });
        }
        for layer in layers.clone() {
            self.apply_contact_laws_to_segment(layer, tile);
        }
    }

    /// Fills the wave constants for the sweep of a row, if cell lengths depend on the layer.
    pub(super) fn fill_row_constants(&mut self, row: usize) {
        let Some(spacing) = &mut self.materials.row_constants else { return };
        let groups = row * self.layout.groups..(row + 1) * self.layout.groups;
        let group_patterns = self.materials.lane_pattern_indices[groups].iter().copied();
        let ghosts =
            self.materials.ghost_pattern_indices.get(row).copied().unwrap_or([0; 2 * GHOSTS]);
        // With one lane pattern `ghost_pattern_indices` is empty, and the row has that pattern.
        let ghosts =
            ghosts.into_iter().filter(|_| !self.materials.ghost_pattern_indices.is_empty());
        spacing.fill_table(row, group_patterns.chain(ghosts), &mut self.lane_laws.contacts);
    }
}
