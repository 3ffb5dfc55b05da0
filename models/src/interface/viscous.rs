//! Viscous layer: delayed shear, and elastic normal component (Sadovskii & Sadovskaya, kind 3).
//!
//! A spring of compliance C₀ = δa₀ in series with a Kelvin element of compliance C₁ = δa₁ and viscosity η; with the
//! traction S of the layer and the traction s of the delayed spring,
//!
//! ```text
//! d = C₀Ṡ + C₁ṡ,    C₁ṡ = φ(S − s),    φ = δ/η.
//! ```
//!
//! Compliance at angular frequency ω: δ[a₀ + a₁/(1 + iωηa₁)]. Midpoint rule with r = φΔt/(2C₁):
//!
//! ```text
//! S_mid = [2C₀S/Δt + φs/(1 + r) + d₀]/[2C₀/Δt + φ/(1 + r) + g],    s_mid = (s + rS_mid)/(1 + r).
//! ```
//!
//! Stored energy ½C₀S² + ½C₁s², dissipated Δtφ(S_mid − s_mid)² ≥ 0.

use super::elastic::{COMPONENT_VARIABLES, ElasticComponent};
use super::history::{self, accumulate, inertia, set_inertia, sum_value};
use super::opening_line::{LayerMass, OpeningLine};
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Viscous law of the tangential component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousComponent<N> {
    /// Mass of the layer.
    pub mass: LayerMass<N>,
    /// Instantaneous compliance C₀ = δa₀ ≥ 0, m/Pa.
    pub compliance: N,
    /// Delayed compliance C₁ = δa₁ > 0, m/Pa.
    pub delayed_compliance: N,
    /// Fluidity φ = δ/η > 0, m/(Pa s).
    pub fluidity: N,
}

impl<N: Number> ViscousComponent<N> {
    /// Converts the constants by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> ViscousComponent<M> {
        ViscousComponent {
            mass: self.mass.map(&f),
            compliance: f(self.compliance),
            delayed_compliance: f(self.delayed_compliance),
            fluidity: f(self.fluidity),
        }
    }

    /// Advances the shear variables of the history by `step`, s, and returns the states on both sides.
    #[inline(always)]
    pub fn advance(
        &self,
        incoming: RiemannData<N>,
        step: N,
        history: &mut [N],
    ) -> [FaceState<N>; 2] {
        let old = inertia(history, history::SHEAR_INERTIA);
        let (stress, delayed) = (history[history::SHEAR_STRESS], history[history::DELAYED_STRESS]);
        let line = OpeningLine::new(incoming, self.mass, old, step);
        let rate = (self.compliance + self.compliance) / step;
        let ratio = N::HALF * self.fluidity * step / self.delayed_compliance;
        let share = N::ONE / (N::ONE + ratio);
        let delayed_rate = self.fluidity * share;
        let middle = (rate * stress + delayed_rate * delayed + line.free_rate)
            * (N::ONE / (rate + delayed_rate + line.admittance));
        // Overstress S_mid − s_mid of the dashpot.
        let overstress = (middle - delayed) * share;
        let delayed_change = ratio * overstress;
        accumulate(history, history::VISCOUS, step * self.fluidity * overstress * overstress);
        let moved = line.finish(middle);
        set_inertia(history, history::SHEAR_INERTIA, moved.inertia);
        history[history::SHEAR_STRESS] = middle + middle - stress;
        history[history::DELAYED_STRESS] = delayed + (delayed_change + delayed_change);
        moved.states
    }

    /// Stored energy ½C₀S² + ½C₁s², J/m².
    #[inline(always)]
    pub fn stored_energy(&self, history: &[N]) -> N {
        let (stress, delayed) = (history[history::SHEAR_STRESS], history[history::DELAYED_STRESS]);
        N::HALF * (self.compliance * stress * stress + self.delayed_compliance * delayed * delayed)
    }
}

/// Layer with an elastic normal and a viscous tangential component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousLayer<N> {
    /// Normal component.
    pub normal: ElasticComponent<N>,
    /// Tangential component.
    pub shear: ViscousComponent<N>,
}

impl<N: Number> ViscousLayer<N> {
    /// Converts the constants by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> ViscousLayer<M> {
        ViscousLayer { normal: self.normal.map(&f), shear: self.shear.map(&f) }
    }
}

impl<N: Number> FaceLaw<N, 2> for ViscousLayer<N> {
    const HISTORY_VARIABLES: usize = history::FLUID_VELOCITY;

    fn initialise(&self, velocities: &[[N; 2]; 2], history: &mut [N]) {
        history::initialise(velocities, history);
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; 2],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; 2] {
        let mut normal = [history[0], history[1], history[2]];
        let states = self.normal.advance(incoming[0], interval.step, &mut normal);
        history[..COMPONENT_VARIABLES].copy_from_slice(&normal);
        [states, self.shear.advance(incoming[1], interval.step, history)]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let [normal, shear] =
            [inertia(history, history::NORMAL_INERTIA), inertia(history, history::SHEAR_INERTIA)];
        FaceEnergy {
            kinetic: self.normal.mass.kinetic_energy(normal)
                + self.shear.mass.kinetic_energy(shear),
            stored: self.normal.stored_energy(history[history::NORMAL_STATE])
                + self.shear.stored_energy(history),
            viscous: sum_value(history, history::VISCOUS),
            ..FaceEnergy::ZERO
        }
    }
}
