//! Contact with friction in uniaxial strain: projection of the conditional stress onto the Mises–Schleicher cone.

use super::diagram::ContactState;

/// Default coefficient c² of the intensity of shear stress τ² = c² s:s: with it, τ is half of the von Mises stress.
pub(crate) const DEFAULT_INTENSITY_COEFFICIENT: f64 = 0.375;

/// Constants of the intensity of shear stress τ = √(c² s:s) in uniaxial strain.
///
/// The compression strain ε has the deviator ε diag(−2, 1, 1)/3, so that τ = mε and the deviator contributes τ/r to
/// the pressure on the front, with m = 2cμ√(2/3) and r = c√(3/2); m/r = 4μ/3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainIntensity {
    /// Modulus m = 2cμ√(2/3) of the intensity τ = mε, Pa.
    pub intensity_modulus: f64,
    /// Modulus M = 2μc², with which τ²/(2M) is the energy of the deviator, Pa.
    pub energy_modulus: f64,
    /// Ratio r = c√(3/2) of the intensity to the deviatoric part of the pressure on the front.
    pub front_ratio: f64,
}

impl StrainIntensity {
    /// Computes the constants from the shear modulus μ (Pa) and the coefficient c².
    pub fn new(shear_modulus: f64, intensity_coefficient: f64) -> Self {
        Self {
            intensity_modulus: 2.0 * shear_modulus * (intensity_coefficient * 2.0 / 3.0).sqrt(),
            energy_modulus: 2.0 * shear_modulus * intensity_coefficient,
            front_ratio: (1.5 * intensity_coefficient).sqrt(),
        }
    }
}

/// Contact with friction in uniaxial strain: the stress is the projection, in the norm of the elastic energy, of the
/// conditional stress (P, T) onto the cone τ ≤ æp, where P is the mean pressure and T the signed intensity of shear
/// stress that the material would have without opening (Sadovskii & Sadovskaya 2019).
///
/// The conditional stress may not exceed the yield limit: |T| ≤ τ_s for P ≥ τ_s/æ, else |T| ≤ τ_s + Mλ_K with the
/// opening λ_K = (τ_s/æ − P)/(æk).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionCone {
    /// Bulk modulus k, Pa.
    pub bulk_modulus: f64,
    /// Friction æ ≥ 0.
    pub friction: f64,
    /// Constants of the intensity of shear stress.
    pub intensity: StrainIntensity,
}

/// Conditional stress in uniaxial strain as a linear function of the strain, near one strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConditionalStress {
    /// Mean pressure P, Pa.
    pub(crate) pressure: f64,
    /// Signed intensity of shear stress T, Pa; positive in compression.
    pub(crate) intensity: f64,
    /// Derivative dT/dε, Pa; dP/dε is the bulk modulus.
    pub(crate) intensity_rate: f64,
}

impl FrictionCone {
    /// Returns the mean pressure of the projection onto the cone of a conditional stress outside it and its polar cone.
    fn cone_pressure(&self, stress: ConditionalStress) -> f64 {
        let (k, friction, m) = (self.bulk_modulus, self.friction, self.intensity.energy_modulus);
        (m * stress.pressure + friction * k * stress.intensity.abs())
            / (m + friction * friction * k)
    }

    /// Returns the state of the contact.
    pub(crate) fn state(&self, stress: ConditionalStress) -> ContactState {
        let t = stress.intensity.abs();
        if t <= self.friction * stress.pressure {
            ContactState::Closed
        } else if self.friction * self.bulk_modulus * t
            <= -self.intensity.energy_modulus * stress.pressure
        {
            ContactState::Open
        } else {
            ContactState::Sliding
        }
    }

    /// Returns the pressure on the front and its derivative by the strain, Pa; `yield_stress` limits the intensity on
    /// the cone.
    pub(crate) fn front_pressure(
        &self,
        stress: ConditionalStress,
        yield_stress: Option<f64>,
    ) -> [f64; 2] {
        let StrainIntensity { energy_modulus: m, front_ratio: r, .. } = self.intensity;
        let (k, friction) = (self.bulk_modulus, self.friction);
        let sign = if stress.intensity < 0.0 { -1.0 } else { 1.0 };
        match self.state(stress) {
            ContactState::Open => [0.0, 0.0],
            ContactState::Closed => {
                [stress.pressure + stress.intensity / r, k + stress.intensity_rate / r]
            }
            ContactState::Sliding => {
                let factor = 1.0 + sign * friction / r;
                let pressure = self.cone_pressure(stress);
                match yield_stress.filter(|&limit| self.is_at_corner(stress, limit)) {
                    Some(limit) => [limit / friction * factor, 0.0],
                    None => {
                        let rate = (m * k + friction * k * sign * stress.intensity_rate)
                            / (m + friction * friction * k);
                        [pressure * factor, rate * factor]
                    }
                }
            }
        }
    }

    /// Returns whether the projection lies in the corner of the cone and the yield limit.
    pub(crate) fn is_at_corner(&self, stress: ConditionalStress, yield_stress: f64) -> bool {
        // The limit of the conditional stress in the corner is a line of constant cone pressure: rounding decides
        // between both sides of it, and both have the same stress.
        self.friction * self.cone_pressure(stress) >= yield_stress * (1.0 - 1e-12)
    }

    /// Returns the strains at which the state of the contact or the sign of the intensity changes, if the conditional
    /// stress is the given linear function around `strain`.
    pub(crate) fn transition_strains(&self, strain: f64, stress: ConditionalStress) -> Vec<f64> {
        let (k, friction, m) = (self.bulk_modulus, self.friction, self.intensity.energy_modulus);
        // Rounding must not give a line that is parallel to a boundary a distant intersection.
        let zero = |value: f64, slope: f64, scale: f64| {
            (slope.abs() > 1e-12 * scale).then(|| strain - value / slope)
        };
        let (t, rate) = (stress.intensity, stress.intensity_rate);
        let mut strains = vec![zero(t, rate, rate.abs())];
        for sign in [-1.0, 1.0] {
            let [of_pressure, of_intensity] = [friction * k, sign * rate];
            let scale = of_pressure + rate.abs();
            let cone = sign * t - friction * stress.pressure;
            strains.push(zero(cone, of_intensity - of_pressure, scale));
            let [of_pressure, of_intensity] = [m * k, friction * k * sign * rate];
            let scale = of_pressure + of_intensity.abs();
            let apex = friction * k * sign * t + m * stress.pressure;
            strains.push(zero(apex, of_intensity + of_pressure, scale));
        }
        strains.into_iter().flatten().filter(|strain| strain.is_finite()).collect()
    }
}
