//! The elastic law of a solid, whichever constants state it.

use crate::common::DynEq;
use crate::common::rates::RateEquations;
use crate::common::system::Matrix;
use crate::solid::parameters::Theory;
use crate::solid::stress::{Component, Stress};
use crate::solid::symbol::{Layout, plane, space};
use crate::solid::waves::{Field, Pair, Rotation, fields};
use std::fmt::Debug;
use std::sync::Arc;

/// What an elastic law with checked constants states. Stiffness on the one side, pairs of waves and rotation on
/// the other are independent statements of the same law: the analysis takes the first, solvers in time the second.
pub trait Elasticity: DynEq + Debug + Send + Sync {
    /// The theory that it belongs to.
    fn theory(&self) -> Theory;

    /// Whether it is a law of plane strain alone, and no stress across the plane comes along.
    fn is_plane(&self) -> bool {
        false
    }

    /// Density ρ, kg/m³.
    fn density(&self) -> f64;

    /// Moment of inertia per unit volume j, kg/m; 0 in classical solids.
    fn inertia(&self) -> f64 {
        0.0
    }

    /// Modulus α of the antisymmetric strain, Pa; 0 in classical solids.
    fn antisymmetric_modulus(&self) -> f64 {
        0.0
    }

    /// The wave number at which shear waves have the frequency of the natural rotation, 1/m: the inverse of
    /// the solid's internal length. `None` in classical solids, which have none.
    fn characteristic_wave_number(&self) -> Option<f64> {
        None
    }

    /// Hooke's law between the stresses of the list, Pa or N.
    fn stiffness(&self, stresses: &[Component]) -> Matrix;

    /// The pairs of waves along `axis`, in 2 (plane strain) or 3 dimensions.
    fn pairs(&self, dimensions: usize, axis: usize) -> Vec<Pair>;

    /// The rotation of spins against antisymmetric stress; `None` in classical solids.
    fn rotation(&self) -> Option<Rotation> {
        None
    }

    /// Energy that a stress stores, J/m³; of a law of plane strain that of the stress in the plane.
    fn stored_energy(&self, stress: &Stress) -> f64;
}

/// An elastic law with checked constants.
#[derive(Clone, Debug)]
pub struct ElasticLaw(Arc<dyn Elasticity>);

impl<T: Elasticity> From<T> for ElasticLaw {
    fn from(law: T) -> Self {
        Self(Arc::new(law))
    }
}

impl PartialEq for ElasticLaw {
    fn eq(&self, other: &Self) -> bool {
        self.0.dyn_eq(other.0.as_any())
    }
}

impl std::ops::Deref for ElasticLaw {
    type Target = dyn Elasticity;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl ElasticLaw {
    /// The law as this type, if it is of it.
    pub fn downcast<T: Elasticity>(&self) -> Option<&T> {
        self.0.as_any().downcast_ref()
    }

    /// The unknowns in `D` dimensions, and Hooke's law between their stresses, carried ones last.
    pub fn layout_and_stiffness<const D: usize>(&self) -> (Layout, Matrix) {
        const { assert!(D == 2 || D == 3) };
        let layout = if D == 2 { plane(self.theory()) } else { space(self.theory()) };
        let layout = if self.is_plane() { layout.without_carried() } else { layout };
        let stresses: Vec<Component> = layout.all_stresses().collect();
        let stiffness = self.stiffness(&stresses);
        (layout, stiffness)
    }

    /// The rate equations in `D` dimensions.
    pub fn rates<const D: usize>(&self) -> RateEquations<D> {
        let (layout, stiffness) = self.layout_and_stiffness::<D>();
        self.rates_with_stiffness(&layout, &stiffness)
    }

    /// The rate equations in `D` dimensions, with the carried stresses among the unknowns.
    pub fn carried_rates<const D: usize>(&self) -> RateEquations<D> {
        let (layout, stiffness) = self.layout_and_stiffness::<D>();
        self.rates_with_stiffness(&layout.carrying(), &stiffness)
    }

    /// The rate equations in `D` dimensions with this stiffness between the stresses of the layout in place
    /// of the elastic one.
    pub(crate) fn rates_with_stiffness<const D: usize>(
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
}
