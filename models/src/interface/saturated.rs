//! Fluid-saturated porous layer (Sadovskii & Sadovskaya, kind 5; energy after Biot 1962).
//!
//! Per volume of the layer, with V₁ along and V₂ across it, the velocity w of the fluid along it, the strain ε across
//! it and the strain D of the fluid along it,
//!
//! ```text
//! kinetic  ½ρ_sV₁² + ½ρ_fw² + ½ρ_a(w − V₁)² + ½(ρ_s + ρ_f)V₂²,
//! W = ½b₀ε² + ½b₁ min(θ₀ + ε, 0)² + b_sεD + ½b_fD²,    S₂₂ = ∂W/∂ε,  s₁₁ = ∂W/∂D = b_sε + b_fD.
//! ```
//!
//! Three stages conserve this energy each by itself:
//!
//! - across, normal: the [porous law](super::porous) with m = (ρ_s + ρ_f)δ and S_ext = b_sD;
//! - across, shear: the [viscous law](super::viscous) with m = (ρ_s + ρ_fρ_a/(ρ_f + ρ_a))δ, and
//!   w increases by ΔV₁ρ_a/(ρ_f + ρ_a);
//! - along: the [flow of the fluid](super::fluid), with numerical dissipation.

use super::fluid::FluidConstants;
use super::history::{self, inertia, sum_value};
use super::porous::PorousComponent;
use super::viscous::ViscousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Fluid-saturated layer. [`FaceLaw::advance`] computes both stages across the layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaturatedLayer<N> {
    /// Normal component.
    pub normal: PorousComponent<N>,
    /// Tangential component, with the mass that moves against the fluid.
    pub shear: ViscousComponent<N>,
    /// Flow along the layer.
    pub fluid: FluidConstants<N>,
    /// Density of the skeleton ρ_s, kg/m³.
    pub skeleton_density: N,
    /// Density of the fluid ρ_f, kg/m³.
    pub fluid_density: N,
    /// Added density ρ_a, kg/m³.
    pub added_density: N,
    /// Share ρ_a/(ρ_f + ρ_a) of the change of V₁ by which the fluid moves along.
    pub fluid_share: N,
}

impl<N: Number> SaturatedLayer<N> {
    /// Converts the constants by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> SaturatedLayer<M> {
        SaturatedLayer {
            normal: self.normal.map(&f),
            shear: self.shear.map(&f),
            fluid: self.fluid.map(&f),
            skeleton_density: f(self.skeleton_density),
            fluid_density: f(self.fluid_density),
            added_density: f(self.added_density),
            fluid_share: f(self.fluid_share),
        }
    }

    /// Porosity θ = max(θ₀ + ε, 0).
    #[inline(always)]
    pub fn porosity(&self, history: &[N]) -> N {
        self.normal.elasticity.current_porosity(history[history::NORMAL_STATE])
    }

    /// Pressure p = −s₁₁/θ of the fluid, Pa; 0 in collapsed pores.
    #[inline(always)]
    pub fn pressure(&self, history: &[N]) -> N {
        let porosity = self.porosity(history);
        let divisor = porosity.select_gt(N::ZERO, porosity, N::ONE);
        porosity.select_gt(N::ZERO, -(self.fluid.stress(history) / divisor), N::ZERO)
    }

    /// Traction S₂₂ = ∂W/∂ε across the layer, Pa.
    #[inline(always)]
    pub fn normal_stress(&self, history: &[N]) -> N {
        self.normal.elasticity.stress(history[history::NORMAL_STATE])
            + self.fluid.coupling * history[history::FLUID_STRAIN]
    }
}

impl<N: Number> FaceLaw<N, 2> for SaturatedLayer<N> {
    const HISTORY_VARIABLES: usize = history::FLUID_DISSIPATION + 2;

    /// The fluid starts with the velocity of the skeleton.
    fn initialise(&self, velocities: &[[N; 2]; 2], history: &mut [N]) {
        history::initialise(velocities, history);
        history[history::FLUID_VELOCITY] = history[history::SHEAR_INERTIA];
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; 2],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; 2] {
        let external = self.fluid.coupling * history[history::FLUID_STRAIN];
        let (_, normal) = self.normal.advance(incoming[0], external, interval.step, history);
        let old = history[history::SHEAR_INERTIA];
        let shear = self.shear.advance(incoming[1], interval.step, history);
        let change = history[history::SHEAR_INERTIA] - old;
        history[history::FLUID_VELOCITY] =
            history[history::FLUID_VELOCITY] + self.fluid_share * change;
        [normal, shear]
    }

    /// The energy of a saturated layer; with s₁₁²/(2b_f) as the energy stored by the fluid, all energies are ≥ 0.
    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let half_thickness = N::HALF * self.fluid.thickness;
        let [across, across_jump] = inertia(history, history::NORMAL_INERTIA);
        let [along, along_jump] = inertia(history, history::SHEAR_INERTIA);
        let fluid = self.fluid.state(history);
        let strain = history[history::NORMAL_STATE];
        let relative = fluid.velocity - along;
        let jumps = self.normal.mass.opening_mass * across_jump * across_jump
            + self.shear.mass.opening_mass * along_jump * along_jump;
        let coupled = self.fluid.coupling * strain;
        FaceEnergy {
            kinetic: half_thickness * self.skeleton_density * (along * along + across * across)
                + N::HALF * jumps,
            stored: (self.normal.elasticity.stored_energy(strain)
                - half_thickness * coupled * coupled / self.fluid.stiffness)
                + self.shear.stored_energy(history),
            fluid_kinetic: half_thickness
                * (self.fluid_density * (fluid.velocity * fluid.velocity + across * across)
                    + self.added_density * relative * relative),
            fluid_stored: half_thickness * fluid.stress * fluid.stress / self.fluid.stiffness,
            viscous: sum_value(history, history::VISCOUS),
            fluid_dissipation: sum_value(history, history::FLUID_DISSIPATION),
            ..FaceEnergy::ZERO
        }
    }
}
