//! Properties of layers for an equivalent continuum: their elastic constants, and the yield set of a blocky medium.
//!
//! A layer with the shear strength τ_s, friction k_s and tensile strength σ_t limits the tractions of the faces of
//! blocks. The equivalent continuum has the interlayer yield set (Sadovskii & Sadovskaya 2019, "Plane strain state")
//! with
//!
//! ```text
//! τ₀ = τ_s,   κ_τ = k_s,   μ₀ = κ_μσ_t,   h/6 ≤ κ_μ ≤ h/2.
//! ```
//!
//! The couple per area μ on a face of length h with the normal stress σ < 0 adds the linear stress 12μy/h², |y| ≤ h/2:
//! the face opens at an edge at |μ| = −σh/6; the block overturns about the edge at |μ| = −σh/2 ([`OpeningLimit`]).

use super::elastic::ElasticMaterial;
use super::parameters::{LayerMaterial, PlasticConstants, TangentialConstants, ViscousConstants};
use crate::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet};

/// Limit of the couple stress on the faces of blocks: the coefficient of rolling friction κ_μ, m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OpeningLimit {
    /// The face opens at an edge, κ_μ = h/6.
    #[default]
    FirstOpening,
    /// The block overturns about an edge, κ_μ = h/2.
    Overturning,
}

impl OpeningLimit {
    /// Returns the coefficient of rolling friction κ_μ, m, of blocks with sides of length h = `period`, m.
    pub fn couple_friction(self, period: f64) -> f64 {
        match self {
            Self::FirstOpening => period / 6.0,
            Self::Overturning => period / 2.0,
        }
    }

    /// Description of the limit for output.
    pub const fn description(self) -> &'static str {
        match self {
            Self::FirstOpening => "κ_μ = h/6: faces open at an edge",
            Self::Overturning => "κ_μ = h/2: blocks overturn about an edge",
        }
    }
}

/// Strength of a layer that slips: cone of shear strength and friction, and tensile strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerStrength {
    /// Shear strength, friction and hardening.
    pub slip: PlasticConstants,
    /// Tensile strength σ_t, Pa: that of a breaking layer, else τ_s/k_s at the apex of the yield cone; `None` if it is
    /// unlimited, without friction.
    pub tensile_strength: Option<f64>,
}

impl LayerStrength {
    /// Returns the interlayer yield set of blocks with sides of length `period`, m, without hardening; `None` if the
    /// tensile strength is unlimited, since the set limits couples and normal stresses together.
    pub fn to_yield_set(&self, period: f64, limit: OpeningLimit) -> Option<InterlayerYieldSet> {
        let friction = limit.couple_friction(period);
        let couple = InterlayerCoupleLimits {
            strength: friction * self.tensile_strength?,
            friction,
            dilatancy: friction,
        };
        Some(InterlayerYieldSet {
            shear_strength: self.slip.shear_strength,
            shear_friction: self.slip.friction,
            shear_dilatancy: self.slip.friction,
            couple: Some(couple),
        })
    }
}

impl LayerMaterial {
    /// Returns the elastic constants of small instantaneous deformations of the layer in its initial state, with open
    /// pores and closed cracks; `None` for saturated layers, whose components have different masses.
    pub fn to_elastic_material(&self) -> Option<ElasticMaterial> {
        match self {
            Self::Elastic(elastic)
            | Self::Plastic(elastic, _)
            | Self::Viscous(elastic, _)
            | Self::Porous(elastic, ..)
            | Self::Cracked(elastic, _)
            | Self::Breaking(elastic, ..) => Some(*elastic),
            Self::Saturated(_) => None,
        }
    }

    /// Returns the constants of the delayed shear of a viscous layer; `None` for other kinds.
    pub fn delayed_shear(&self) -> Option<ViscousConstants> {
        match self {
            Self::Viscous(_, viscous)
            | Self::Porous(_, _, TangentialConstants::Viscous(viscous)) => Some(*viscous),
            Self::Saturated(saturated) => Some(saturated.viscous),
            _ => None,
        }
    }

    /// Returns the strength of an elastic-plastic or breaking layer; `None` for other kinds.
    pub fn strength(&self) -> Option<LayerStrength> {
        match *self {
            Self::Plastic(_, slip) => {
                let apex = slip.shear_strength / slip.friction;
                let tensile_strength = (slip.friction > 0.0).then_some(apex);
                Some(LayerStrength { slip, tensile_strength })
            }
            Self::Breaking(_, slip, tensile_strength) => {
                Some(LayerStrength { slip, tensile_strength: Some(tensile_strength) })
            }
            _ => None,
        }
    }

    /// Describes the state about which the layer is linearised for waves of small amplitude; `None` for elastic layers.
    pub const fn linearisation_note(&self) -> Option<&'static str> {
        match self {
            Self::Elastic(_) => None,
            Self::Plastic(..) => Some("layers within their yield cone: no slip"),
            Self::Viscous(..) => Some("viscous layers: waves are damped"),
            Self::Porous(_, _, TangentialConstants::Viscous(_)) => {
                Some("open pores, none collapses; viscous shear: waves are damped")
            }
            Self::Porous(..) => Some("open pores, none collapses or slips"),
            Self::Saturated(_) => Some(
                "undrained layers with open pores, without flow of the fluid along them; viscous shear: waves are damped",
            ),
            Self::Cracked(..) => Some("closed cracks that do not slip, as under compression"),
            Self::Breaking(..) => Some("layers within their yield cone, unbroken"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELASTIC: ElasticMaterial = ElasticMaterial {
        thickness: 1e-3,
        density: 1500.0,
        longitudinal_speed: 1000.0,
        shear_speed: 500.0,
    };
    const SLIP: PlasticConstants =
        PlasticConstants { shear_strength: 1e6, friction: 0.5, hardening: 0.0 };

    #[test]
    fn breaking_layers_have_an_associated_yield_set() {
        let strength = LayerMaterial::Breaking(ELASTIC, SLIP, 5e5).strength().expect("a strength");
        for (limit, arm) in
            [(OpeningLimit::FirstOpening, 0.05 / 6.0), (OpeningLimit::Overturning, 0.025)]
        {
            let set = strength.to_yield_set(0.05, limit).expect("a set");
            let couple = set.couple.expect("limits of couples");
            assert_eq!([set.shear_strength, set.shear_friction], [1e6, 0.5]);
            assert_eq!([couple.friction, couple.strength], [arm, arm * 5e5]);
            // The flow is associated: dilatancy equals friction.
            assert_eq!([set.shear_dilatancy, couple.dilatancy], [0.5, arm]);
        }
    }

    /// An elastic-plastic layer has the tensile strength τ_s/k_s of the apex of its yield cone, unlimited if k_s = 0.
    #[test]
    fn tensile_strength_of_elastic_plastic_layers_is_that_of_the_apex() {
        let strength = LayerMaterial::Plastic(ELASTIC, SLIP).strength().expect("a strength");
        assert_eq!(strength.tensile_strength, Some(2e6));
        let smooth = PlasticConstants { friction: 0.0, ..SLIP };
        let strength = LayerMaterial::Plastic(ELASTIC, smooth).strength().expect("a strength");
        assert_eq!(strength.to_yield_set(0.05, OpeningLimit::default()), None);
        assert_eq!(LayerMaterial::Elastic(ELASTIC).strength(), None);
        assert_eq!(LayerMaterial::Cracked(ELASTIC, Some(0.5)).strength(), None);
    }
}
