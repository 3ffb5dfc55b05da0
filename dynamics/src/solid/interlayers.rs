//! Interlayers at regular places inside a domain: blocky media.

use super::boundary::Boundary;
use super::ghosts::BESIDE;
use super::medium::Medium;
use super::problem::{DomainError, Problem};
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

impl<const D: usize> Problem<D> {
    /// The interlayers across an axis.
    pub(crate) fn interlayers_across(&self, axis: usize) -> Option<&Interlayers> {
        self.interlayers.iter().find(|own| own.axis == axis)
    }

    /// That all interlayers can be taken.
    pub(crate) fn check_interlayers(&self) -> Result<(), DomainError> {
        for (index, own) in self.interlayers.iter().enumerate() {
            let refuse = |reason| Err(DomainError::Interlayers { index, reason });
            if own.axis >= D {
                return refuse("there is no such axis");
            }
            if self.interlayers[..index].iter().any(|other| other.axis == own.axis) {
                return refuse("there are others across the same axis");
            }
            if own.laws.len() != self.media[0].pairs[own.axis].len() {
                return refuse("a law is needed for each pair of waves");
            }
            let is_sound = |value: f64| value >= 0.0 && value.is_finite();
            if !own.laws.iter().all(|law| is_sound(law.mass) && is_sound(law.compliance)) {
                return refuse("masses and compliances must be finite and not negative");
            }
            if self.scheme.alternates() {
                return refuse("sweeps must not alternate");
            }
            let cells = self.grid.cells[own.axis];
            if own.every == 0 || own.offset >= cells {
                return refuse("blocks must have cells, and there must be an interlayer");
            }
            let behind = (cells - own.offset - 1) % own.every + 1;
            if self.boundaries[own.axis][0] != Boundary::Periodic && own.offset.min(behind) < BESIDE
            {
                return refuse("blocks beside sides that are not periodic must have three cells");
            }
        }
        Ok(())
    }
}
