//! Interlayers at regular places inside a domain: blocky media.

use super::medium::Medium;
use models::interface::elastic::{ElasticInterlayer, ElasticMaterial};
use models::solid::waves::Field;

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
