//! Return mapping of single cells by the SIMD kernel of the fused solver, for
//! [`Reference`](crate::solid::reference::Reference): the kernel rounds differently from the scalar projection, and
//! both solvers must agree bit for bit.

use super::SolverReal;
use super::plastic::{ProjectionKernel, YieldSets};
use crate::simd::{InstructionSet, LaneGroup, Number};
use crate::solid::problem::Problem;

/// Yield sets in SIMD lanes, and a buffer of one group.
#[derive(Clone)]
pub(crate) struct CellMapping<T: SolverReal> {
    /// Yield sets in lanes, one pattern per medium.
    yield_sets: YieldSets<T>,
    has_yield_set: Vec<bool>,
    /// Buffer of one group: values by field.
    field_values: Vec<T::Lanes>,
}

impl<T: SolverReal> CellMapping<T> {
    /// Creates the mapping; `None` if the fused solver gives the results of the scalar projection.
    pub(crate) fn new<const D: usize>(problem: &Problem<D>) -> Option<Self> {
        let media = &problem.media;
        let has_overstress = media.iter().any(|own| own.overstress_time.is_some());
        let is_elastic = media.iter().all(|own| own.yield_set.is_none());
        if problem.initial_stress.is_some() || is_elastic || has_overstress {
            return None;
        }
        let patterns: Vec<_> =
            (0..media.len()).map(|medium| vec![medium as u16; T::Lanes::COUNT]).collect();
        Some(Self {
            yield_sets: YieldSets::new(media, &patterns, 1)?,
            has_yield_set: media.iter().map(|own| own.yield_set.is_some()).collect(),
            field_values: vec![T::Lanes::ZERO; media[0].fields.len()],
        })
    }

    /// Maps the stress in the state of a cell of a medium, whose fields are `field_factor` times the physical fields, and
    /// returns the plastic dissipation, J/m³; `None` if the stress is left to the scalar projection.
    pub(crate) fn map_cell(
        &mut self,
        medium: u16,
        field_factor: T,
        state: &mut [T],
    ) -> Option<f64> {
        for (group, value) in self.field_values.iter_mut().zip(state.iter()) {
            *group = T::Lanes::splat(*value);
        }
        let (mut dissipation, mut scalar_lanes) = (vec![0.0; T::Lanes::COUNT], Vec::new());
        let mapping = ProjectionKernel {
            field_data: &mut self.field_values,
            lane_pattern_indices: &[medium.into()],
            yield_sets: &self.yield_sets,
            has_yield_set: &self.has_yield_set,
            field_factor,
            dissipation: &mut dissipation,
            scalar_lanes: &mut scalar_lanes,
        };
        T::map_stresses(mapping, InstructionSet::widest());
        for (group, value) in self.field_values.iter().zip(state) {
            *value = group.lanes()[0];
        }
        scalar_lanes.is_empty().then_some(dissipation[0])
    }
}
