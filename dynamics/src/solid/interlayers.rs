//! Interlayers at regular places inside a domain: blocky media.

use super::medium::Medium;
use crate::simd::Real;
use models::interface::FaceLaw;
use models::interface::elastic::{ElasticInterlayer, ElasticMaterial};
use models::solid::waves::{Field, Pair};

/// V and S of an interlayer for a pair of waves: numbers of its memory.
pub(crate) const MEMORY: usize = 2;

/// Interlayers across an axis, in front of every so many cells: in front of the cells `offset`, `offset + every`, …
///
/// Thickness enters the law alone: the cells on both sides meet in one face.
#[derive(Clone, Debug, PartialEq)]
pub struct Interlayers {
    /// The axis that is normal to the faces.
    pub axis: usize,
    /// Cells in front of the first one. On a periodic axis it may be 0; on others blocks at the ends have three cells at
    /// least.
    pub offset: usize,
    /// Cells of a block.
    pub every: usize,
    /// The law for each pair of waves of the axis.
    pub laws: Vec<ElasticInterlayer<f64>>,
}

impl Interlayers {
    /// Of one material, between blocks of a medium: the law of the normal component for the pair of waves whose velocity is
    /// along the axis, that of tangential components for other velocities. Spins are welded.
    pub fn of_material(
        axis: usize,
        [offset, every]: [usize; 2],
        material: &ElasticMaterial,
        medium: &Medium,
    ) -> Self {
        let pairs = medium.pairs.get(axis).map_or(&[][..], |pairs| pairs);
        let law = |velocity: Field| match velocity {
            Field::Velocity(along) if along == axis => material.normal(),
            Field::Velocity(_) => material.tangential(),
            _ => ElasticInterlayer { mass: 0.0, compliance: 0.0 },
        };
        let laws = pairs.iter().map(|pair| law(pair.velocity)).collect();
        Self { axis, offset, every, laws }
    }

    /// Whether there is one in front of a cell along the axis.
    pub fn is_in_front_of(&self, place: usize) -> bool {
        place >= self.offset && (place - self.offset).is_multiple_of(self.every.max(1))
    }
}

/// The memory of an interlayer that moves with the cells in front of it and behind, of these velocities, without stress.
pub(crate) fn memory_at_start<T: Real>([front, behind]: [T; 2]) -> [T; MEMORY] {
    [T::HALF * (front + behind), T::ZERO]
}

/// The cell in front of a cell of a grid along an axis; in front of the first one is the last one.
pub(crate) fn cell_in_front(cells: &[usize], axis: usize, cell: usize) -> usize {
    let (stride, count) = (cells[..axis].iter().product::<usize>(), cells[axis]);
    match cell / stride % count {
        0 => cell + (count - 1) * stride,
        _ => cell - stride,
    }
}

/// Kinetic and stored energy of a face of this area, m², for a pair of waves, J.
pub(crate) fn energy_of<T: Real>(
    law: &ElasticInterlayer<T>,
    memory: [T; MEMORY],
    area: f64,
) -> [f64; 2] {
    let law = ElasticInterlayer { mass: law.mass.wide(), compliance: law.compliance.wide() };
    let memory = memory.map(T::wide);
    [area * law.kinetic_energy(&memory), area * law.stored_energy(&memory)]
}

/// The field of a pair whose counterpart in a memory is not finite.
pub(crate) fn first_non_finite<T: Real>(pair: &Pair, memory: [T; MEMORY]) -> Option<Field> {
    let [velocity, stress] = memory.map(|own| own.wide().is_finite());
    match (velocity, stress) {
        (true, true) => None,
        (false, _) => Some(pair.velocity),
        (true, false) => Some(pair.stress),
    }
}
