//! Interlayers at regular positions in a domain: blocky media.

use super::medium::Medium;
use crate::simd::Real;
use models::interface::FaceLaw;
use models::interface::elastic::{ElasticInterlayer, ElasticMaterial};
use models::solid::waves::{SolidField, VelocityStressPair};

/// Number of history variables of an interlayer per wave pair: mean velocity V and mean traction S.
pub(crate) const HISTORY_VARIABLES: usize = 2;

/// Interlayers normal to an axis, at the lower faces of cells `offset`, `offset + block_cells`, …
///
/// The thickness of an interlayer enters only its law; geometrically the interlayer is a face.
#[derive(Clone, Debug, PartialEq)]
pub struct Interlayers {
    /// Axis normal to the faces.
    pub axis: usize,
    /// Number of cells below the first interlayer. May be 0 on a periodic axis; on other axes the blocks at both ends
    /// have at least three cells.
    pub offset: usize,
    /// Number of cells per block, from one interlayer to the next.
    pub block_cells: usize,
    /// Face law for each wave pair of the axis.
    pub laws: Vec<ElasticInterlayer<f64>>,
}

impl Interlayers {
    /// Interlayers of one material between blocks of a medium: the normal law for the wave pair whose velocity is along
    /// the axis, the tangential law for the other velocities. Spins are continuous.
    pub fn from_material(
        axis: usize,
        [offset, block_cells]: [usize; 2],
        material: &ElasticMaterial,
        medium: &Medium,
    ) -> Self {
        let pairs = medium.pairs.get(axis).map_or(&[][..], |pairs| pairs);
        let law = |velocity: SolidField| match velocity {
            SolidField::Velocity(along) if along == axis => material.normal_interlayer(),
            SolidField::Velocity(_) => material.tangential_interlayer(),
            _ => ElasticInterlayer { mass: 0.0, compliance: 0.0 },
        };
        let laws = pairs.iter().map(|pair| law(pair.velocity)).collect();
        Self { axis, offset, block_cells, laws }
    }

    /// Returns whether there is an interlayer at the lower face of cell `place` along the axis.
    pub fn has_interlayer_at(&self, place: usize) -> bool {
        place >= self.offset && (place - self.offset).is_multiple_of(self.block_cells.max(1))
    }
}

/// Returns the initial history variables of a stress-free interlayer: mean velocity of the two adjacent cells, zero
/// traction.
pub(crate) fn stress_free_history<T: Real>([front, behind]: [T; 2]) -> [T; HISTORY_VARIABLES] {
    [T::HALF * (front + behind), T::ZERO]
}

/// Returns the lower neighbour of a cell along an axis of a grid of `cells` cells; for the first cell, the last one
/// (periodic).
pub(crate) fn lower_neighbour(cells: &[usize], axis: usize, cell: usize) -> usize {
    let (stride, count) = (cells[..axis].iter().product::<usize>(), cells[axis]);
    match cell / stride % count {
        0 => cell + (count - 1) * stride,
        _ => cell - stride,
    }
}

/// Computes kinetic and stored energy, J, of an interlayer face of area `area`, m², for a wave pair.
pub(crate) fn interlayer_energy<T: Real>(
    law: &ElasticInterlayer<T>,
    history: [T; HISTORY_VARIABLES],
    area: f64,
) -> [f64; 2] {
    let law = ElasticInterlayer { mass: law.mass.to_f64(), compliance: law.compliance.to_f64() };
    let history = history.map(T::to_f64);
    [area * law.kinetic_energy(&history), area * law.stored_energy(&history)]
}

/// Returns the field of a wave pair that corresponds to a non-finite history variable: its velocity or its stress;
/// `None` if both history variables are finite.
pub(crate) fn non_finite_field<T: Real>(
    pair: &VelocityStressPair,
    history: [T; HISTORY_VARIABLES],
) -> Option<SolidField> {
    let [velocity, stress] = history.map(|own| own.to_f64().is_finite());
    match (velocity, stress) {
        (true, true) => None,
        (false, _) => Some(pair.velocity),
        (true, false) => Some(pair.stress),
    }
}
