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
//! A step has three stages, each of which conserves this energy:
//!
//! - across, normal: the [porous law](super::porous) with m = (ρ_s + ρ_f)δ and S_ext = b_sD;
//! - across, shear: the [viscous law](super::viscous) with m = (ρ_s + ρ_fρ_a/(ρ_f + ρ_a))δ, and
//!   w increases by ΔV₁ρ_a/(ρ_f + ρ_a);
//! - along: the [flow of the fluid](super::fluid), with numerical dissipation.

use super::fluid::FluidConstants;
use super::history::{self, read_motion, sum_value};
use super::porous::PorousComponent;
use super::viscous::ViscousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Law of a fluid-saturated layer. [`FaceLaw::advance`] computes both stages across the layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaturatedLayer<N> {
    /// Law of the normal component.
    pub normal: PorousComponent<N>,
    /// Law of the tangential component, with the effective mass (ρ_s + ρ_fρ_a/(ρ_f + ρ_a))δ.
    pub shear: ViscousComponent<N>,
    /// Constants of the flow of the fluid along the layer.
    pub fluid: FluidConstants<N>,
    /// Partial density of the skeleton ρ_s, kg/m³.
    pub skeleton_density: N,
    /// Partial density of the fluid ρ_f, kg/m³.
    pub fluid_density: N,
    /// Added density ρ_a, kg/m³.
    pub added_density: N,
    /// Ratio ρ_a/(ρ_f + ρ_a) of the velocity change of the fluid to the change of V₁.
    pub fluid_share: N,
}

impl<N: Number> SaturatedLayer<N> {
    /// Converts every constant by the function `f`.
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
            + self.fluid.coupling_stiffness * history[history::FLUID_STRAIN]
    }
}

impl<N: Number> FaceLaw<N, 2> for SaturatedLayer<N> {
    const HISTORY_VARIABLE_COUNT: usize = history::FLUID_DISSIPATION + 2;

    /// The fluid starts with the velocity of the skeleton.
    fn initialise(&self, velocities: &[[N; 2]; 2], history: &mut [N]) {
        history::initialise(velocities, history);
        history[history::FLUID_VELOCITY] = history[history::SHEAR_MOTION];
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; 2],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; 2] {
        let external_stress = self.fluid.coupling_stiffness * history[history::FLUID_STRAIN];
        let (_, normal) = self.normal.advance(incoming[0], external_stress, interval.step, history);
        let old = history[history::SHEAR_MOTION];
        let shear = self.shear.advance(incoming[1], interval.step, history);
        let change = history[history::SHEAR_MOTION] - old;
        history[history::FLUID_VELOCITY] =
            history[history::FLUID_VELOCITY] + self.fluid_share * change;
        [normal, shear]
    }

    /// Returns the energy of a saturated layer. The fluid stores δs₁₁²/(2b_f), so that all energies are ≥ 0.
    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let half_thickness = N::HALF * self.fluid.thickness;
        let [normal_velocity, opening_rate] = read_motion(history, history::NORMAL_MOTION);
        let [shear_velocity, shear_velocity_jump] = read_motion(history, history::SHEAR_MOTION);
        let fluid = self.fluid.state(history);
        let strain = history[history::NORMAL_STATE];
        let relative = fluid.velocity - shear_velocity;
        let jump_energy_term = self.normal.mass.opening_mass * opening_rate * opening_rate
            + self.shear.mass.opening_mass * shear_velocity_jump * shear_velocity_jump;
        let coupled = self.fluid.coupling_stiffness * strain;
        FaceEnergy {
            kinetic: half_thickness
                * self.skeleton_density
                * (shear_velocity * shear_velocity + normal_velocity * normal_velocity)
                + N::HALF * jump_energy_term,
            stored: (self.normal.elasticity.stored_energy(strain)
                - half_thickness * coupled * coupled / self.fluid.stiffness)
                + self.shear.stored_energy(history),
            fluid_kinetic: half_thickness
                * (self.fluid_density
                    * (fluid.velocity * fluid.velocity + normal_velocity * normal_velocity)
                    + self.added_density * relative * relative),
            fluid_stored: half_thickness * fluid.stress * fluid.stress / self.fluid.stiffness,
            viscous_dissipation: sum_value(history, history::VISCOUS_DISSIPATION),
            fluid_dissipation: sum_value(history, history::FLUID_DISSIPATION),
            ..FaceEnergy::ZERO
        }
    }
}
