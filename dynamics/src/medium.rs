//! What a solid is to the sweeps.

use models::cosserat::parameters::{Isotropic, PlaneCompliances, Theory};
use models::cosserat::waves::{Field, Pair, Rotation, fields};

/// An elastic solid as pairs of waves along the axes and a rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// The components of its state.
    pub fields: Vec<Field>,
    /// Pairs by axis; the same velocities and stresses in the same order for all media of a theory.
    pub pairs: Vec<Vec<Pair>>,
    /// Coupling of spins and antisymmetric stress.
    pub rotation: Option<Rotation>,
}

impl Medium {
    /// An isotropic solid in 2 (plane strain) or 3 dimensions.
    pub fn isotropic(solid: &Isotropic, dimensions: usize) -> Self {
        Self {
            fields: fields(solid.theory(), dimensions),
            pairs: (0..dimensions).map(|axis| solid.pairs(dimensions, axis)).collect(),
            rotation: solid.rotation(),
        }
    }

    /// A solid by its compliances in plane strain; stresses across the plane stay zero.
    pub fn compliances(solid: &PlaneCompliances) -> Self {
        Self {
            fields: fields(Theory::Cosserat, 2),
            pairs: (0..2).map(|axis| solid.pairs(axis)).collect(),
            rotation: Some(solid.rotation()),
        }
    }

    /// The greatest speed, m/s.
    pub fn greatest_speed(&self) -> f64 {
        self.pairs.iter().flatten().map(Pair::speed).fold(0.0, f64::max)
    }
}
