//! Interface of an elastic law, independent of its constants.

use crate::common::DynEq;
use crate::common::kind::impl_shared_law;
use crate::common::rates::RateEquations;
use crate::common::system::RoundedMatrix;
use crate::solid::parameters::Theory;
use crate::solid::stress::{Stress, StressComponent};
use crate::solid::symbol::{UnknownLayout, plane_layout, space_layout};
use crate::solid::waves::{SolidField, SpinRotation, VelocityStressPair, state_fields};
use std::fmt::Debug;
use std::sync::Arc;

/// An elastic law with checked constants. The law is stated twice, independently: by `stiffness` for the analysis, and
/// by `pairs` and `rotation` for time-domain solvers.
pub trait Elasticity: DynEq + Debug + Send + Sync {
    /// Theory of the solid: classical, reduced Cosserat or Cosserat.
    fn theory(&self) -> Theory;

    /// Whether the law is defined in plane strain only, without out-of-plane stress.
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

    /// Natural frequency of the microrotation divided by the shear wave speed in the short-wave limit, 1/m: the inverse
    /// internal length. `None` in classical solids.
    fn characteristic_wave_number(&self) -> Option<f64> {
        None
    }

    /// Stiffness matrix (Hooke's law) between the stress components `stresses`, in their order, Pa or N. A law defined
    /// in plane strain only is given the in-plane components of its layout.
    fn stiffness(&self, stresses: &[StressComponent]) -> RoundedMatrix;

    /// Velocity–stress pairs of the one-dimensional waves along `axis` (from 0), in 2 (plane strain) or 3 dimensions.
    fn pairs(&self, dimensions: usize, axis: usize) -> Vec<VelocityStressPair>;

    /// Source term that couples spins and antisymmetric stress without gradients: a rotation of the vector (spin,
    /// antisymmetric stress). `None` in classical solids.
    fn rotation(&self) -> Option<SpinRotation> {
        None
    }

    /// Elastic energy stored by a stress, J/m³; for a law defined in plane strain only, the energy of the in-plane
    /// stress.
    fn stored_energy(&self, stress: &Stress) -> f64;
}

/// An elastic law with checked constants.
#[derive(Clone, Debug)]
pub struct ElasticLaw(Arc<dyn Elasticity>);

impl_shared_law!(ElasticLaw, Elasticity);

impl ElasticLaw {
    /// Layout of the unknowns in `D` dimensions, and the stiffness matrix between all its stress components;
    /// out-of-plane stresses, if any, are last.
    pub fn layout_and_stiffness<const D: usize>(&self) -> (UnknownLayout, RoundedMatrix) {
        const { assert!(D == 2 || D == 3) };
        let layout = if D == 2 { plane_layout(self.theory()) } else { space_layout(self.theory()) };
        let layout = if self.is_plane() { layout.without_out_of_plane() } else { layout };
        let stresses: Vec<StressComponent> = layout.all_stresses().collect();
        let stiffness = self.stiffness(&stresses);
        (layout, stiffness)
    }

    /// Rate equations in `D` dimensions.
    pub fn rates<const D: usize>(&self) -> RateEquations<D> {
        let (layout, stiffness) = self.layout_and_stiffness::<D>();
        self.rates_with_stiffness(&layout, &stiffness)
    }

    /// Rate equations in `D` dimensions with the out-of-plane stresses among the unknowns.
    pub fn rates_with_out_of_plane<const D: usize>(&self) -> RateEquations<D> {
        let (layout, stiffness) = self.layout_and_stiffness::<D>();
        self.rates_with_stiffness(&layout.with_out_of_plane(), &stiffness)
    }

    /// Rate equations in `D` dimensions with `stiffness` in place of the elastic stiffness, e.g. a tangent stiffness.
    pub(crate) fn rates_with_stiffness<const D: usize>(
        &self,
        layout: &UnknownLayout,
        stiffness: &RoundedMatrix,
    ) -> RateEquations<D> {
        layout.rates(stiffness, self.density(), self.inertia())
    }

    /// State components of time-domain solvers, in 2 (plane strain) or 3 dimensions.
    pub fn state_fields(&self, dimensions: usize) -> Vec<SolidField> {
        state_fields(self.theory(), dimensions)
    }
}
