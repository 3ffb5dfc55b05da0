//! One step of the law of a granular medium: projection of the conditional stress onto the cone of the contact and the
//! yield set of the particles.
//!
//! With the elastic stiffness C, the contact opens by the strain εᶜ = a:(s − σ), where a = C⁻¹ and s = C:(ε − εᵖ) is the
//! conditional stress. An elastic step from σₙ to σ̂ = σₙ + C:Δε gives the trial s̄ = σ̂ + (s − σ)ₙ, with the mean pressure
//! p̄ and the intensity t̄ of shear stress. With M = 2μc², the projection onto τ ≤ æp, τ ≤ τ_s in the norm of a is
//!
//! | case | condition, in this order | p | τ | λ_F |
//! |---|---|---|---|---|
//! | inside | t̄ ≤ æp̄, t̄ ≤ τ_s, p̄ ≥ 0 | p̄ | t̄ | 0 |
//! | apex | æk t̄ ≤ −Mp̄ | 0 | 0 | 0 |
//! | cone | p_c = (Mp̄ + æk t̄)/(M + æ²k), æp_c ≤ τ_s, p̄ < t̄/æ | p_c | æp_c | 0 |
//! | cylinder | p̄ ≥ τ_s/æ | p̄ | τ_s | (t̄ − τ_s)/M |
//! | corner | else | τ_s/æ | τ_s | (t̄ − τ_s)/M − (τ_s/æ − p̄)/(æk) |
//!
//! Plastic flow reduces the deviator of the conditional stress by Mλ_F; opening does not change the conditional stress.

use super::parameters::GranularMedium;
use crate::common::number::Number;
use crate::rheology::relaxation::SymmetricTensor;
use crate::uniaxial::skeleton::NO_LIMIT;

/// Constants of the law of a granular medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GranularContact<N> {
    /// Bulk modulus k, Pa.
    pub bulk_modulus: N,
    /// Modulus M = 2μc² of the energy τ²/(2M) of the deviator, Pa.
    pub energy_modulus: N,
    /// Coefficient c of the intensity τ = c |dev σ|.
    pub intensity_factor: N,
    /// Friction æ.
    pub friction: N,
    /// Yield stress τ_s, Pa; [`NO_LIMIT`] for elastic particles.
    pub yield_stress: N,
    /// Pressure τ_s/æ of the corner of cone and cylinder, Pa.
    pub corner_pressure: N,
    /// 1/M, 1/(M + æ²k) and 1/(æk), 1/Pa, for the projections onto cylinder, cone and corner; the last is 0 without friction,
    /// where there is no corner.
    pub compliances: [N; 3],
}

/// State of a granular medium after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GranularStep<N, const SHEAR_COUNT: usize> {
    /// Stress σ, Pa.
    pub stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Excess s − σ of the conditional stress, Pa: the stress of the strain by which the contact has opened.
    pub excess: SymmetricTensor<N, SHEAR_COUNT>,
    /// Plastic dissipation of the step, J/m³.
    pub plastic_dissipation: N,
    /// Other energy lost in the step, J/m³: that of the projection onto the cone, and the difference between the
    /// projection onto the yield set and the plastic dissipation.
    pub other_loss: N,
}

impl GranularContact<f64> {
    /// Creates the constants of a medium.
    pub fn new(medium: &GranularMedium) -> Self {
        let own = medium.parameters();
        Self::from_moduli(
            own.bulk_modulus,
            2.0 * own.shear_modulus * own.intensity_coefficient,
            own.intensity_coefficient.sqrt(),
            own.friction,
            own.yield_stress,
        )
    }

    /// Creates the constants from the moduli k and M, Pa, the coefficient c of the intensity, the friction æ ≥ 0, and the
    /// yield stress τ_s, Pa; `None` for elastic particles.
    pub fn from_moduli(
        bulk_modulus: f64,
        energy_modulus: f64,
        intensity_factor: f64,
        friction: f64,
        yield_stress: Option<f64>,
    ) -> Self {
        let yield_stress = yield_stress.unwrap_or(NO_LIMIT).min(NO_LIMIT);
        let friction_modulus = friction * bulk_modulus;
        Self {
            bulk_modulus,
            energy_modulus,
            intensity_factor,
            friction,
            yield_stress,
            corner_pressure: (yield_stress / friction).min(NO_LIMIT),
            compliances: [
                1.0 / energy_modulus,
                1.0 / (energy_modulus + friction * friction_modulus),
                if friction > 0.0 { 1.0 / friction_modulus } else { 0.0 },
            ],
        }
    }

    /// Returns whether the cone admits tension under lateral pressure: æ > √(3c²/2).
    pub fn transmits_tension(&self) -> bool {
        self.friction > self.intensity_factor * 1.5f64.sqrt()
    }

    /// Returns the greatest ratio f of the tangential to the normal traction on a plane; `None` if the cone admits any
    /// traction. With normal stresses −P on the plane and −Q along it, and the shear stress T, the cone
    /// c²(⅔(P − Q)² + 2T²) ≤ æ²(P + 2Q)²/9 allows most for Q = P(3c² + æ²)/(3c² − 2æ²): f = æ/√(2c² − 4æ²/3).
    pub fn traction_friction(&self) -> Option<f64> {
        let (c, friction) = (self.intensity_factor, self.friction);
        let square = 2.0 * c * c - 4.0 / 3.0 * friction * friction;
        (square > 0.0).then(|| friction / square.sqrt()).filter(|own| *own < NO_LIMIT)
    }
}

impl<N: Number> GranularContact<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> GranularContact<M> {
        GranularContact {
            bulk_modulus: f(self.bulk_modulus),
            energy_modulus: f(self.energy_modulus),
            intensity_factor: f(self.intensity_factor),
            friction: f(self.friction),
            yield_stress: f(self.yield_stress),
            corner_pressure: f(self.corner_pressure),
            compliances: {
                let [cylinder, cone, corner] = self.compliances;
                [f(cylinder), f(cone), f(corner)]
            },
        }
    }

    /// Completes an elastic step: `stress` is the stress σ̂ after it, `excess` the excess before it, Pa.
    #[inline(always)]
    pub fn complete_step<const SHEAR_COUNT: usize>(
        &self,
        stress: SymmetricTensor<N, SHEAR_COUNT>,
        excess: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> GranularStep<N, SHEAR_COUNT> {
        let Self { bulk_modulus: k, energy_modulus: m, friction, yield_stress, .. } = *self;
        let trial = stress.plus(excess);
        let (pressure, deviator) = (-trial.mean(), trial.deviator());
        let intensity = self.intensity_factor * deviator.squared_norm().sqrt();

        let [cylinder_compliance, cone_compliance, corner_compliance] = self.compliances;
        // The table without cases: the pressure rises to that of the cone, but not beyond that of the corner.
        let cone_pressure = (m * pressure + friction * k * intensity) * cone_compliance;
        let cone_pressure = intensity.select_gt(friction * pressure, cone_pressure, pressure);
        let new_pressure = pressure.max(cone_pressure.max(N::ZERO).min(self.corner_pressure));
        let new_intensity = intensity.min(yield_stress).min(friction * new_pressure);
        let (expansion, lost) = (new_pressure - pressure, intensity - new_intensity);
        // Part Mλ_K of the intensity that opens the contact: all that is lost below the pressure of the corner.
        let opened_at_corner = (m * corner_compliance * expansion).min(lost);
        let opened_intensity = self.corner_pressure.select_gt(new_pressure, lost, opened_at_corner);
        let multiplier = (lost - opened_intensity) * cylinder_compliance;

        let inverse = N::ONE / intensity.max(N::MIN_POSITIVE);
        let kept = new_intensity * inverse;
        let opened = opened_intensity * inverse;
        // Zero where the trial state is admissible.
        let change = expansion.max(lost);
        let mut result = GranularStep {
            stress: trial,
            excess: SymmetricTensor::ZERO,
            plastic_dissipation: new_intensity * multiplier,
            other_loss: N::ZERO,
        };
        // Copied where the state is inside, so that a medium that never opens has the bits of an elastic solid.
        for i in 0..3 {
            let new = deviator.normal[i] * kept - new_pressure;
            result.stress.normal[i] = change.select_gt(N::ZERO, new, trial.normal[i]);
            result.excess.normal[i] = deviator.normal[i] * opened + expansion;
        }
        for i in 0..SHEAR_COUNT {
            let new = deviator.shear[i] * kept;
            result.stress.shear[i] = change.select_gt(N::ZERO, new, trial.shear[i]);
            result.excess.shear[i] = deviator.shear[i] * opened;
        }
        let loss = self.energy_difference(stress, result.stress);
        result.other_loss = loss - result.plastic_dissipation;
        result
    }

    /// Computes the stored energy ½σ:a:σ of a stress less that of another one, J/m³.
    #[inline(always)]
    pub(crate) fn energy_difference<const SHEAR_COUNT: usize>(
        &self,
        first: SymmetricTensor<N, SHEAR_COUNT>,
        second: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> N {
        let [of_mean, of_deviator] = self.doubled_energy_differences(first, second);
        N::HALF * (of_mean + of_deviator)
    }

    /// Computes twice the energy of mean stress and deviator of a stress less those of another one, J/m³.
    #[inline(always)]
    pub(super) fn doubled_energy_differences<const SHEAR_COUNT: usize>(
        &self,
        first: SymmetricTensor<N, SHEAR_COUNT>,
        second: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> [N; 2] {
        let (difference, sum) = (first.plus(second.scale(-N::ONE)), first.plus(second));
        let deviatoric = difference.deviator().contract(sum.deviator());
        let factor = self.intensity_factor;
        [
            difference.mean() * sum.mean() / self.bulk_modulus,
            factor * factor * deviatoric / self.energy_modulus,
        ]
    }
}
