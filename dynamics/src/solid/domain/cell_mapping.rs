//! Return mapping of single cells in the lanes of this solver: for [`Reference`](crate::solid::reference::Reference),
//! since its rounding differs from that of the scalar projection.

use super::SolverReal;
use super::plastic::{Correct, Sets};
use crate::simd::{Group, Instructions, Number};
use crate::solid::problem::Problem;

/// Yield sets in lanes, and a buffer of one group.
#[derive(Clone)]
pub(crate) struct CellMapping<T: SolverReal> {
    /// Yield sets by medium.
    sets: Sets<T>,
    yields: Vec<bool>,
    /// Buffer of one group: values by field.
    data: Vec<T::Lanes>,
}

impl<T: SolverReal> CellMapping<T> {
    /// Creates the mapping; `None` if the solver maps stresses as the scalar projection does.
    pub(crate) fn new<const D: usize>(problem: &Problem<D>) -> Option<Self> {
        let media = &problem.media;
        if problem.initial_stress.is_some() || media.iter().all(|own| own.yields.is_none()) {
            return None;
        }
        let patterns: Vec<_> =
            (0..media.len()).map(|medium| vec![medium as u16; T::Lanes::COUNT]).collect();
        Some(Self {
            sets: Sets::new(media, &patterns, 1)?,
            yields: media.iter().map(|own| own.yields.is_some()).collect(),
            data: vec![T::Lanes::ZERO; media[0].fields.len()],
        })
    }

    /// Maps the stress of a state of a medium and returns the plastic dissipation, J/m³; `None` if the stress is left
    /// to the scalar projection.
    pub(crate) fn map(&mut self, medium: u16, state: &mut [T]) -> Option<f64> {
        for (group, value) in self.data.iter_mut().zip(state.iter()) {
            *group = T::Lanes::all(*value);
        }
        let (mut dissipated, mut left) = (vec![0.0; T::Lanes::COUNT], Vec::new());
        let mapping = Correct {
            data: &mut self.data,
            patterns: &[medium.into()],
            sets: &self.sets,
            yields: &self.yields,
            dissipated: &mut dissipated,
            left: &mut left,
        };
        T::correct(mapping, Instructions::best());
        for (group, value) in self.data.iter().zip(state) {
            *value = group.lanes()[0];
        }
        left.is_empty().then_some(dissipated[0])
    }
}
