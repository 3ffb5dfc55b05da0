//! The elastic law of a solid, whichever constants state it.

use crate::cosserat::parameters::{Isotropic, PlaneCompliances, Theory};
use crate::cosserat::stress::Stress;
use crate::cosserat::symbol::Layout;
use crate::cosserat::waves::{Field, Pair, Rotation, fields};
use crate::rates::RateEquations;
use crate::system::Matrix;

/// An elastic law with checked constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElasticLaw {
    /// Isotropic, by its moduli; plane strain or space.
    Isotropic(Isotropic),
    /// Cubic, by its compliances; plane strain alone.
    Compliances(PlaneCompliances),
}

impl From<Isotropic> for ElasticLaw {
    fn from(solid: Isotropic) -> Self {
        Self::Isotropic(solid)
    }
}

impl From<PlaneCompliances> for ElasticLaw {
    fn from(solid: PlaneCompliances) -> Self {
        Self::Compliances(solid)
    }
}

impl ElasticLaw {
    /// The theory that it belongs to.
    pub fn theory(&self) -> Theory {
        match self {
            Self::Isotropic(solid) => solid.theory(),
            Self::Compliances(_) => Theory::Cosserat,
        }
    }

    /// Density ρ, kg/m³.
    pub fn density(&self) -> f64 {
        match self {
            Self::Isotropic(solid) => solid.density,
            Self::Compliances(solid) => solid.density,
        }
    }

    /// Moment of inertia per unit volume j, kg/m; 0 in classical solids.
    pub fn inertia(&self) -> f64 {
        match self {
            Self::Isotropic(solid) => solid.microrotation.map_or(0.0, |m| m.inertia),
            Self::Compliances(solid) => solid.inertia,
        }
    }

    /// Modulus α of the antisymmetric strain, Pa; 0 in classical solids.
    pub fn antisymmetric_modulus(&self) -> f64 {
        match self {
            Self::Isotropic(solid) => solid.microrotation.map_or(0.0, |m| m.alpha),
            Self::Compliances(solid) => 0.5 / (solid.a2 + solid.b2),
        }
    }

    /// The unknowns in `D` dimensions, and Hooke's law between their stresses, carried ones last.
    pub fn layout_and_stiffness<const D: usize>(&self) -> (Layout, Matrix) {
        match self {
            Self::Isotropic(solid) => {
                let layout = solid.layout::<D>();
                let stiffness = solid.stiffness(layout.all_stresses());
                (layout, stiffness)
            }
            Self::Compliances(solid) => (solid.layout(), solid.stiffness()),
        }
    }

    /// The rate equations in `D` dimensions.
    pub fn rates<const D: usize>(&self) -> RateEquations<D> {
        let (layout, stiffness) = self.layout_and_stiffness::<D>();
        self.rates_with_stiffness(&layout, &stiffness)
    }

    /// The rate equations in `D` dimensions, with the carried stresses among the unknowns.
    pub fn carried_rates<const D: usize>(&self) -> RateEquations<D> {
        let (layout, stiffness) = self.layout_and_stiffness::<D>();
        match self {
            Self::Isotropic(_) => self.rates_with_stiffness(&layout.carrying(), &stiffness),
            Self::Compliances(_) => self.rates_with_stiffness(&layout, &stiffness),
        }
    }

    /// The rate equations in `D` dimensions with this stiffness between the stresses of the layout in place
    /// of the elastic one.
    pub(super) fn rates_with_stiffness<const D: usize>(
        &self,
        layout: &Layout,
        stiffness: &Matrix,
    ) -> RateEquations<D> {
        layout.rates(stiffness, self.density(), self.inertia())
    }

    /// The components of the state that solvers in time keep, in 2 (plane strain) or 3 dimensions.
    pub fn fields(&self, dimensions: usize) -> Vec<Field> {
        fields(self.theory(), dimensions)
    }

    /// The pairs of waves along `axis`, in 2 (plane strain) or 3 dimensions.
    pub fn pairs(&self, dimensions: usize, axis: usize) -> Vec<Pair> {
        match self {
            Self::Isotropic(solid) => solid.pairs(dimensions, axis),
            Self::Compliances(solid) => solid.pairs(axis),
        }
    }

    /// The rotation of spins against antisymmetric stress; `None` in classical solids.
    pub fn rotation(&self) -> Option<Rotation> {
        match self {
            Self::Isotropic(solid) => solid.rotation(),
            Self::Compliances(solid) => Some(solid.rotation()),
        }
    }

    /// Energy that a stress stores, J/m³; by compliances that of the stress in the plane.
    pub fn stored_energy(&self, stress: &Stress) -> f64 {
        match self {
            Self::Isotropic(solid) => solid.stored_energy(stress),
            Self::Compliances(solid) => solid.stored_energy(stress),
        }
    }

    /// The wave number at which shear waves have the frequency of the natural rotation, 1/m: the inverse of
    /// the solid's internal length. `None` in classical solids, which have none.
    pub fn characteristic_wave_number(&self) -> Option<f64> {
        let (frequency, speed) = match self {
            Self::Isotropic(solid) => {
                (solid.microrotation?.natural_frequency(), solid.speeds().shear)
            }
            Self::Compliances(solid) => {
                let PlaneCompliances { a2, b2, density, inertia, .. } = *solid;
                // 4α = 2/(a₂ + b₂), μ + α = a₂/(a₂² − b₂²).
                let frequency = (2.0 / ((a2 + b2) * inertia)).sqrt();
                (frequency, (a2 / ((a2 - b2) * (a2 + b2) * density)).sqrt())
            }
        };
        Some(frequency / speed)
    }
}
