//! Elastoplastic solids: an elastic law with an optional yield set that limits the stress.

mod plastic;

pub use plastic::{Plastic, scale_onto_yield};

use crate::common::rates::RateEquations;
use crate::common::rounding::Rounded;
use crate::solid::ElasticLaw;
use crate::solid::stress::Component;
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::tangent::{NoResponse, tangent};

/// A solid with checked constants: elastic, or elastoplastic at a stress on yield.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Elastic law.
    pub elastic: ElasticLaw,
    /// Number of space dimensions: 2 for plane strain, 3 for space.
    pub dimensions: usize,
    /// Yield set and its active conditions; `None` in an elastic solid.
    pub plastic: Option<Plastic>,
}

impl Solid {
    /// Creates a solid in 2 (plane strain) or 3 `dimensions`; a law defined in plane strain only always gets 2.
    pub fn new(elastic: ElasticLaw, dimensions: usize, plastic: Option<Plastic>) -> Self {
        let dimensions = if elastic.is_plane() { 2 } else { dimensions };
        Self { elastic, dimensions, plastic }
    }

    /// Elastic rate equations in `D` dimensions, without plastic flow.
    pub fn elastic_rates<const D: usize>(&self) -> RateEquations<D> {
        self.elastic.rates()
    }

    /// Rate equations in `D` dimensions with the tangent stiffness: plastic loading of all active conditions.
    ///
    /// # Errors
    /// H + n·Dm is not positive for an active condition; see [`NoResponse`].
    pub fn rates<const D: usize>(&self) -> Result<RateEquations<D>, NoResponse> {
        let Some(plastic) = &self.plastic else { return Ok(self.elastic_rates()) };
        let (layout, stiffness) = self.elastic.layout_and_stiffness::<D>();
        let stresses: Vec<_> = layout.all_stresses().collect();
        let tangent = tangent(&stiffness, &stresses, &plastic.active)?;
        Ok(self.elastic.rates_with_stiffness(&layout, &tangent))
    }

    /// Rate equations including the relaxation R due to plastic flow of the background, with the carried (out-of-plane)
    /// stresses among the unknowns; `None` if R is zero.
    ///
    /// # Errors
    /// H + n·Dm is not positive for an active condition; see [`NoResponse`].
    pub fn damped_rates<const D: usize>(&self) -> Result<Option<RateEquations<D>>, NoResponse> {
        let Some(Plastic { set, stress: Some(stress), active, rate }) = &self.plastic else {
            return Ok(None);
        };
        let (layout, stiffness) = self.elastic.layout_and_stiffness::<D>();
        let stresses: Vec<_> = layout.all_stresses().collect();
        let Some(curvature) = set.curvature(stress, &stresses).filter(|_| *rate > 0.0) else {
            return Ok(None);
        };
        let plastic = tangent(&stiffness, &stresses, active)?;
        let relaxation = (curvature * *rate).map(Rounded::given);
        let rates = self.elastic.rates_with_stiffness(&layout.carrying(), &plastic);
        Ok(Some(RateEquations { relaxation, ..rates }))
    }

    /// Stress components of [`ElasticLaw::carried_rates`] in `D` dimensions.
    pub fn carried_stresses<const D: usize>(&self) -> Vec<Component> {
        self.elastic.layout_and_stiffness::<D>().0.all_stresses().collect()
    }

    /// Stress components among the unknowns of the rate equations in `D` dimensions.
    pub fn stresses<const D: usize>(&self) -> &'static [Component] {
        self.elastic.layout_and_stiffness::<D>().0.stresses
    }

    /// Whether plastic flow, if any, is associated (along the yield normals).
    pub fn is_associated(&self) -> bool {
        self.active().iter().all(|active| active.normal == active.flow)
    }

    /// Whether the tangent stiffness is symmetric and positive semidefinite, so that the rate equations are
    /// symmetric-hyperbolic: elastic solids, and associated flow without softening.
    pub fn keeps_energy(&self) -> bool {
        self.is_associated() && self.active().iter().all(|active| active.hardening >= 0.0)
    }

    fn active(&self) -> &[ActiveCondition] {
        self.plastic.as_ref().map_or(&[], |plastic| &plastic.active)
    }
}
