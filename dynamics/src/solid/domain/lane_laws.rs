//! Constants of the cell laws, which act in a cell between sweeps, by lane pattern: rotation of spins against
//! antisymmetric stress, relaxation, rotation by the curvature of rows, yield sets.
//!
//! A new law needs changes in [`crate::solid::cell_laws`] (formula, `MAX_FIELDS`); here and in a new file (constants by
//! lane pattern, kernel, [`has_coupled_fields`]); `step` (position in the time step);
//! [`Medium`](crate::solid::medium::Medium) (history fields, energy); `models::solid::waves::SolidField`, a new variant
//! of which the compiler requires in every `match`; [`crate::solid::ledger`] and `output` if it dissipates;
//! [`crate::solid::reference`], with which tests compare the results. Layout, halo, snapshot and output of its fields
//! need no change. If the yield set depends on the history, the return mapping must be changed as well.

use super::contacts::LaneContacts;
use super::curvilinear::CurvatureRotations;
use super::materials::Materials;
use super::plastic::YieldSets;
use super::relaxation::LaneRelaxations;
use super::total_stress::{
    InitialStress, TotalStressSets, blocks_per_group, create_initial_stress_blocks,
};
use crate::simd::{LaneGroup, Real};
use crate::solid::cell_laws::{self, LawInterval, SpinStressRotation, spin_stress_rotation};
use crate::solid::problem::{PlasticStep, Problem};
use models::solid::stress::Stress;
use models::solid::waves::SolidField;

/// Constants of the cell laws by lane pattern.
#[derive(Clone)]
pub(super) struct LaneLaws<T: Real> {
    /// Rotations of spins against antisymmetric stress, by pattern and [`LawInterval`].
    pub(super) spin_rotations: Vec<[SpinStressRotation<T::Lanes>; 2]>,
    /// Offsets of each spin and of the two stresses that rotate against it.
    pub(super) rotated_offsets: Vec<[usize; 3]>,
    /// Relaxation of stresses; `None` if no medium relaxes.
    pub(super) relaxations: Option<LaneRelaxations<T>>,
    /// Laws of contacts; `None` if no medium has any.
    pub(super) contacts: Option<LaneContacts<T>>,
    /// By pattern, whether any lane has a yield set.
    pub(super) has_yield_set: Vec<bool>,
    /// Yield sets in lanes if all are of one kind (see [`YieldSets`]), for the return mapping without initial stress;
    /// else `None`.
    pub(super) yield_sets: Option<YieldSets<T>>,
    /// Axis along which the initial stress varies, and the stress by layer across that axis.
    pub(super) initial_stress: Option<(usize, Vec<Stress>)>,
    /// Initial stress by block of a row, if it varies along the first axis; else empty.
    pub(super) initial_stress_blocks: Vec<InitialStress>,
    /// Yield sets in lanes for total stresses, for reflections, and for sets of several kinds.
    pub(super) total_stress_sets: TotalStressSets,
    /// Rotation of the state by the curvature of rows; `None` for straight rows.
    pub(super) curvature_rotations: Option<CurvatureRotations<T>>,
    /// Whether the return mapping of total stresses is scalar, cell by cell, and not in lanes, as in media whose overstress
    /// relaxes; results do not depend on it.
    pub(super) uses_scalar_mapping: bool,
    /// Ratio of the fields to the physical fields by layer; empty if it is 1.
    pub(super) field_factors: Vec<f64>,
}

/// Whether the second sweep of a step along the last axis depends on all fields of a cell, not only on those that it
/// reads and those that rotate with them: relaxation, contacts and the reflection in the middle of the step couple all
/// fields.
pub(super) fn has_coupled_fields<const D: usize>(problem: &Problem<D>) -> bool {
    let Problem { media, scheme, .. } = problem;
    let is_plastic = media.iter().any(|medium| medium.yield_set.is_some());
    media.iter().any(|medium| medium.relaxation.is_some() || medium.contact.is_some())
        || (is_plastic && scheme.plastic_step == PlasticStep::MidpointReflection)
}

/// Returns the offsets of each spin and of the two stresses that rotate with it, for fields `pitch` groups apart.
pub(super) fn rotated_field_offsets(fields: &[SolidField], pitch: usize) -> Vec<[usize; 3]> {
    cell_laws::rotated_fields(fields)
        .into_iter()
        .map(|own| own.map(|index| index * pitch))
        .collect()
}

impl<T: Real> LaneLaws<T> {
    /// Creates the laws of materials by lane pattern, without those of contacts, in rows of `groups` groups, for a time step `step`, s.
    /// `reflects`: whether the return mapping is the reflection 2P − I; `initial_stress`: the initial stress of this
    /// subdomain; `whole_initial_stress`: that of all subdomains.
    pub(super) fn new<const D: usize>(
        materials: &Materials<T, D>,
        patterns: &[Vec<u16>],
        (groups, pitch): (usize, usize),
        (step, reflects): (f64, bool),
        (initial_stress, whole_initial_stress): (Option<(usize, Vec<Stress>)>, &[Stress]),
    ) -> Self {
        let (media, fields) = (&materials.media, &materials.fields);
        let rotations = patterns.iter().map(|pattern| {
            LawInterval::evaluate_both(|step_fraction| {
                [0, 1, 2].map(|which| {
                    let rotation = |lane: usize| {
                        spin_stress_rotation(
                            &media[usize::from(pattern[lane])],
                            step_fraction,
                            step,
                        )
                    };
                    T::Lanes::from_lanes(|lane| T::from_f64(rotation(lane)[which]))
                })
            })
        });
        let has_yield_set = |medium: &u16| media[usize::from(*medium)].yield_set.is_some();
        let is_plastic = media.iter().any(|medium| medium.yield_set.is_some());
        let has_overstress = media.iter().any(|medium| medium.overstress_time.is_some());
        let uses_lanes = is_plastic && !has_overstress;
        let yield_sets = YieldSets::new(media, patterns, pitch).filter(|_| uses_lanes);
        let needs_total_stress_sets =
            uses_lanes && (yield_sets.is_none() || reflects || initial_stress.is_some());
        Self {
            total_stress_sets: match needs_total_stress_sets {
                true => TotalStressSets::new(media, patterns, whole_initial_stress),
                false => TotalStressSets::default(),
            },
            initial_stress_blocks: match &initial_stress {
                Some((0, layers)) if needs_total_stress_sets => {
                    create_initial_stress_blocks::<T>(layers, groups)
                }
                _ => Vec::new(),
            },
            curvature_rotations: None,
            uses_scalar_mapping: has_overstress,
            field_factors: Vec::new(),
            spin_rotations: rotations.collect(),
            rotated_offsets: rotated_field_offsets(fields, pitch),
            contacts: None,
            relaxations: LaneRelaxations::new(media, patterns, fields, pitch, step),
            has_yield_set: patterns
                .iter()
                .map(|pattern| pattern.iter().any(has_yield_set))
                .collect(),
            yield_sets,
            initial_stress,
        }
    }

    /// Returns the ratio of the fields in a layer to the physical fields.
    pub(super) fn field_factor(&self, layer: usize) -> f64 {
        self.field_factors.get(layer).copied().unwrap_or(1.0)
    }

    /// Whether the return mapping needs a buffer in double precision, as for domains in single precision.
    pub(super) fn has_double_blocks(&self) -> bool {
        blocks_per_group::<T>() > 1 && self.total_stress_sets != TotalStressSets::default()
    }
}
