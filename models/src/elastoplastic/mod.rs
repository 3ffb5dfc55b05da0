//! Solids with a state: an elastic law, and the yield set that may limit the stress.

mod plastic;

pub use plastic::{Plastic, scale_onto_yield};

use crate::common::rates::RateEquations;
use crate::common::rounding::Rounded;
use crate::solid::ElasticLaw;
use crate::solid::stress::Component;
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::tangent::{NoResponse, tangent};

/// A solid with checked constants: elastic, or yielding at some stress.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its elasticity.
    pub elastic: ElasticLaw,
    /// 2 for plane strain, 3 for space.
    pub dimensions: usize,
    /// The yield set and what is active of it; `None` in an elastic solid.
    pub plastic: Option<Plastic>,
}

impl Solid {
    /// A solid in 2 (plane strain) or 3 dimensions; that of a law of plane strain is in plane strain.
    pub fn new(elastic: ElasticLaw, dimensions: usize, plastic: Option<Plastic>) -> Self {
        let dimensions = if elastic.is_plane() { 2 } else { dimensions };
        Self { elastic, dimensions, plastic }
    }

    /// The rate equations in `D` dimensions of the solid while it stays elastic.
    pub fn elastic_rates<const D: usize>(&self) -> RateEquations<D> {
        self.elastic.rates()
    }

    /// The rate equations in `D` dimensions; of a yielding solid while its active conditions stay
    /// active.
    ///
    /// # Errors
    /// There is no rate of response.
    pub fn rates<const D: usize>(&self) -> Result<RateEquations<D>, NoResponse> {
        let Some(plastic) = &self.plastic else { return Ok(self.elastic_rates()) };
        let (layout, stiffness) = self.elastic.layout_and_stiffness::<D>();
        let stresses: Vec<_> = layout.all_stresses().collect();
        let tangent = tangent(&stiffness, &stresses, &plastic.active)?;
        Ok(self.elastic.rates_with_stiffness(&layout, &tangent))
    }

    /// The rate equations with what the flow of the background adds, carried stresses among the
    /// unknowns; `None` where it adds nothing.
    ///
    /// # Errors
    /// There is no rate of response.
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

    /// The stresses of [`ElasticLaw::carried_rates`] in `D` dimensions.
    pub fn carried_stresses<const D: usize>(&self) -> Vec<Component> {
        self.elastic.layout_and_stiffness::<D>().0.all_stresses().collect()
    }

    /// The stresses in the rate equations in `D` dimensions.
    pub fn stresses<const D: usize>(&self) -> &'static [Component] {
        self.elastic.layout_and_stiffness::<D>().0.stresses
    }

    /// Whether plastic flow, if any, is along the normals.
    pub fn is_associated(&self) -> bool {
        self.active().iter().all(|active| active.normal == active.flow)
    }

    /// Whether the tangent stiffness is symmetric and not negative, the rate equations
    /// symmetric-hyperbolic: elastic, or associated without softening.
    pub fn keeps_energy(&self) -> bool {
        self.is_associated() && self.active().iter().all(|active| active.hardening >= 0.0)
    }

    fn active(&self) -> &[ActiveCondition] {
        self.plastic.as_ref().map_or(&[], |plastic| &plastic.active)
    }
}
