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

use super::elastic::{COMPONENT_VARIABLE_COUNT, ElasticComponent};
use super::history::{self, accumulate, read_motion, sum_value, write_motion};
use super::opening_line::{LayerMass, OpeningLine};
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Law of the tangential component of a viscous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousComponent<N> {
    /// Mass per area of the layer.
    pub mass: LayerMass<N>,
    /// Instantaneous compliance C₀ = δa₀ ≥ 0, m/Pa.
    pub compliance: N,
    /// Delayed compliance C₁ = δa₁ > 0, m/Pa.
    pub delayed_compliance: N,
    /// Fluidity φ = δ/η > 0, m/(Pa s).
    pub fluidity: N,
}

impl<N: Number> ViscousComponent<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> ViscousComponent<M> {
        ViscousComponent {
            mass: self.mass.map(&f),
            compliance: f(self.compliance),
            delayed_compliance: f(self.delayed_compliance),
            fluidity: f(self.fluidity),
        }
    }

    /// Advances the tangential history variables by `step`, s, and returns the states on both sides.
    #[inline(always)]
    pub fn advance(
        &self,
        incoming: RiemannData<N>,
        step: N,
        history: &mut [N],
    ) -> [FaceState<N>; 2] {
        let old = read_motion(history, history::SHEAR_MOTION);
        let (stress, delayed) = (history[history::SHEAR_STRESS], history[history::DELAYED_STRESS]);
        let line = OpeningLine::new(incoming, self.mass, old, step);
        let rate = (self.compliance + self.compliance) / step;
        let ratio = N::HALF * self.fluidity * step / self.delayed_compliance;
        let share = N::ONE / (N::ONE + ratio);
        let delayed_rate = self.fluidity * share;
        let middle = (rate * stress + delayed_rate * delayed + line.free_opening_rate)
            * (N::ONE / (rate + delayed_rate + line.admittance));
        // Overstress S_mid − s_mid of the dashpot.
        let overstress = (middle - delayed) * share;
        let delayed_change = ratio * overstress;
        accumulate(
            history,
            history::VISCOUS_DISSIPATION,
            step * self.fluidity * overstress * overstress,
        );
        let layer_step = line.complete_step(middle);
        write_motion(history, history::SHEAR_MOTION, layer_step.motion);
        history[history::SHEAR_STRESS] = middle + middle - stress;
        history[history::DELAYED_STRESS] = delayed + (delayed_change + delayed_change);
        layer_step.states
    }

    /// Stored energy ½C₀S² + ½C₁s², J/m².
    #[inline(always)]
    pub fn stored_energy(&self, history: &[N]) -> N {
        let (stress, delayed) = (history[history::SHEAR_STRESS], history[history::DELAYED_STRESS]);
        N::HALF * (self.compliance * stress * stress + self.delayed_compliance * delayed * delayed)
    }
}

/// Law of a layer with an elastic normal and a viscous tangential component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousLayer<N> {
    /// Law of the normal component.
    pub normal: ElasticComponent<N>,
    /// Law of the tangential component.
    pub shear: ViscousComponent<N>,
}

impl<N: Number> ViscousLayer<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> ViscousLayer<M> {
        ViscousLayer { normal: self.normal.map(&f), shear: self.shear.map(&f) }
    }
}

impl<N: Number> FaceLaw<N, 2> for ViscousLayer<N> {
    const HISTORY_VARIABLE_COUNT: usize = history::FLUID_VELOCITY;

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
        history[..COMPONENT_VARIABLE_COUNT].copy_from_slice(&normal);
        [states, self.shear.advance(incoming[1], interval.tangential_step, history)]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let [normal, shear] = [
            read_motion(history, history::NORMAL_MOTION),
            read_motion(history, history::SHEAR_MOTION),
        ];
        FaceEnergy {
            kinetic: self.normal.mass.kinetic_energy(normal)
                + self.shear.mass.kinetic_energy(shear),
            stored: self.normal.stored_energy(history[history::NORMAL_STATE])
                + self.shear.stored_energy(history),
            viscous_dissipation: sum_value(history, history::VISCOUS_DISSIPATION),
            ..FaceEnergy::ZERO
        }
    }
}
