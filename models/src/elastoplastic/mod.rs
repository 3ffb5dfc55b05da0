//! Elastoplastic solids: an elastic law with an optional yield set that limits the stress.

mod plastic;

pub use plastic::{PlasticState, scale_onto_yield};

use crate::common::rates::RateEquations;
use crate::common::rounding::Rounded;
use crate::solid::ElasticLaw;
use crate::solid::stress::StressComponent;
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::tangent::{NoResponse, tangent_stiffness};

/// A solid with checked constants: elastic, or elastoplastic at a stress on yield.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Elastic law.
    pub elastic_law: ElasticLaw,
    /// Number of space dimensions: 2 for plane strain, 3 for space.
    pub dimensions: usize,
    /// Yield set and its active conditions; `None` in an elastic solid.
    pub plastic_state: Option<PlasticState>,
}

impl Solid {
    /// Creates a solid in 2 (plane strain) or 3 `dimensions`; if the elastic law is defined in plane strain only,
    /// always in 2.
    pub fn new(elastic: ElasticLaw, dimensions: usize, plastic: Option<PlasticState>) -> Self {
        let dimensions = if elastic.is_plane() { 2 } else { dimensions };
        Self { elastic_law: elastic, dimensions, plastic_state: plastic }
    }

    /// Elastic rate equations in `D` dimensions, without plastic flow.
    pub fn elastic_rates<const D: usize>(&self) -> RateEquations<D> {
        self.elastic_law.rates()
    }

    /// Rate equations in `D` dimensions with the tangent stiffness: plastic loading of all active conditions.
    ///
    /// # Errors
    /// The plastic denominator H + n·Dm of an active condition is not certainly positive; see [`NoResponse`].
    pub fn rates<const D: usize>(&self) -> Result<RateEquations<D>, NoResponse> {
        let Some(plastic) = &self.plastic_state else { return Ok(self.elastic_rates()) };
        let (layout, stiffness) = self.elastic_law.layout_and_stiffness::<D>();
        let stresses: Vec<_> = layout.all_stresses().collect();
        let tangent = tangent_stiffness(&stiffness, &stresses, &plastic.active_conditions)?;
        Ok(self.elastic_law.rates_with_stiffness(&layout, &tangent))
    }

    /// Rate equations including the relaxation R due to plastic flow of the background, with the out-of-plane
    /// stresses among the unknowns; `None` if R is zero: an elastic solid, given active conditions, zero multiplier
    /// rate, or linear conditions.
    ///
    /// # Errors
    /// The plastic denominator H + n·Dm of an active condition is not certainly positive; see [`NoResponse`].
    pub fn damped_rates<const D: usize>(&self) -> Result<Option<RateEquations<D>>, NoResponse> {
        let Some(PlasticState {
            set,
            stress: Some(stress),
            active_conditions: active,
            multiplier_rate: rate,
        }) = &self.plastic_state
        else {
            return Ok(None);
        };
        let (layout, stiffness) = self.elastic_law.layout_and_stiffness::<D>();
        let stresses: Vec<_> = layout.all_stresses().collect();
        let Some(curvature) = set.curvature(stress, &stresses).filter(|_| *rate > 0.0) else {
            return Ok(None);
        };
        let plastic = tangent_stiffness(&stiffness, &stresses, active)?;
        let relaxation = (curvature * *rate).map(Rounded::from_rounded);
        let rates = self.elastic_law.rates_with_stiffness(&layout.with_out_of_plane(), &plastic);
        Ok(Some(RateEquations { relaxation, ..rates }))
    }

    /// Stress components among the unknowns of [`ElasticLaw::rates_with_out_of_plane`] in `D` dimensions.
    pub fn all_stresses<const D: usize>(&self) -> Vec<StressComponent> {
        self.elastic_law.layout_and_stiffness::<D>().0.all_stresses().collect()
    }

    /// Stress components among the unknowns of [`rates`](Self::rates) in `D` dimensions, without out-of-plane stresses.
    pub fn stresses<const D: usize>(&self) -> &'static [StressComponent] {
        self.elastic_law.layout_and_stiffness::<D>().0.stresses
    }

    /// Whether plastic flow, if any, is associated (along the yield normals).
    pub fn is_associated(&self) -> bool {
        self.active_conditions()
            .iter()
            .all(|condition| condition.normal == condition.flow_direction)
    }

    /// Whether the tangent stiffness is symmetric and positive semidefinite, so that the rate equations are
    /// symmetric-hyperbolic: elastic solids, and associated flow without softening.
    pub fn is_symmetric_hyperbolic(&self) -> bool {
        self.is_associated()
            && self.active_conditions().iter().all(|condition| condition.hardening >= 0.0)
    }

    fn active_conditions(&self) -> &[ActiveCondition] {
        self.plastic_state.as_ref().map_or(&[], |plastic| &plastic.active_conditions)
    }
}
