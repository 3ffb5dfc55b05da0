//! Standard linear solid (Zener 1948, "Elasticity and anelasticity of metals"; Poynting & Thomson 1902): the deviator
//! of the stress relaxes; the mean stress, the antisymmetric stress and the couple stress are elastic.
//!
//! A Maxwell branch (spring μ₁ in series with a dashpot η = μ₁τ) acts in parallel with a spring of the relaxed shear
//! modulus μ_R. With e the symmetric strain deviator, a the viscous strain of the dashpot, and μ_U = μ_R + μ₁ the
//! unrelaxed modulus,
//!
//! ```text
//! s = 2μ_R e + 2μ₁(e − a) = 2μ_U e − 2μ₁ a,    τ ȧ = e − a.
//! ```
//!
//! The history variable is the symmetric tensor a. The solver splits a step: waves propagate at constant a with the
//! unrelaxed modulus μ_U, then the dashpot relaxes at constant e, exactly over any time t: with
//! d = e − a = s/(2μ_U) − (μ_R/μ_U) a,
//!
//! ```text
//! κ = 1 − exp(−t/τ),    a ← a + κd,    s ← s − 2μ₁κd,    dissipated: ∫ 2μ₁|e − a|²/τ dt = μ₁κ(2 − κ)|d|².
//! ```
//!
//! The energy μ_R|e|² + μ₁|e − a|² of both springs, expressed by the variables s and a of a solver, is
//!
//! ```text
//! |s|²/(4μ_U) + (μ₁μ_R/μ_U)|a|²,
//! ```
//!
//! the elastic energy of s with the unrelaxed modulus plus an energy that depends on a only. So a wave step that does
//! not increase the first term at constant a does not increase the total energy.

use crate::common::decimal::format_distinct;
use crate::common::elementary::Elementary;
use crate::common::input::{InputError, ensure};
use crate::common::number::Number;
use crate::common::parameter::define_parameters;
use crate::solid::parameters::Isotropic;
use crate::solid::stress::{Stress, squared_norm};
use nalgebra::Complex;

define_parameters! {
    /// Parameter: shear modulus μ₁ of the Maxwell branch, Pa.
    pub BRANCH_MODULUS = "branch_mu": "modulus μ₁ of the Maxwell branch" ["Pa"], Required(8.1e8), Positive,
        "shear modulus μ₁ of the Maxwell branch; > 0";
    /// Parameter: relaxation time τ, s.
    pub RELAXATION_TIME = "relaxation_time": "relaxation time τ" ["s"], Required(1e-3), Positive,
        "relaxation time τ of the Maxwell branch at constant strain; > 0";
}

/// Standard linear solid (Zener model): an isotropic solid whose deviatoric stress relaxes through one Maxwell branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardLinearSolid {
    unrelaxed: Isotropic,
    branch_modulus: f64,
    relaxation_time: f64,
}

impl StandardLinearSolid {
    /// Adds a Maxwell branch of modulus μ₁ (Pa) and relaxation time τ (s) to the relaxed elastic solid `relaxed`. The
    /// unrelaxed solid has the same bulk modulus and the shear modulus μ_U = μ_R + μ₁.
    ///
    /// # Errors
    /// μ₁ or τ is not positive and finite, or the unrelaxed moduli are out of range.
    pub fn from_relaxed(
        relaxed: Isotropic,
        branch_modulus: f64,
        relaxation_time: f64,
    ) -> Result<Self, InputError> {
        let Isotropic { lambda, mu, density, microrotation } = relaxed;
        check_constants(branch_modulus, relaxation_time)?;
        let lambda = lambda - 2.0 / 3.0 * branch_modulus;
        let unrelaxed = Isotropic::new(lambda, mu + branch_modulus, density, microrotation)?;
        Ok(Self { unrelaxed, branch_modulus, relaxation_time })
    }

    /// Creates the solid with the unrelaxed moduli of `unrelaxed`; the part μ₁ (Pa) of its shear modulus μ_U relaxes
    /// with the relaxation time τ (s).
    ///
    /// # Errors
    /// μ₁ or τ is not positive and finite, or μ₁ ≥ μ_U, so that the relaxed shear modulus would not be positive.
    pub fn from_unrelaxed(
        unrelaxed: Isotropic,
        branch_modulus: f64,
        relaxation_time: f64,
    ) -> Result<Self, InputError> {
        check_constants(branch_modulus, relaxation_time)?;
        ensure(
            branch_modulus < unrelaxed.mu,
            BRANCH_MODULUS.name,
            std::fmt::from_fn(|formatter| {
                let [branch, unrelaxed] = format_distinct([branch_modulus, unrelaxed.mu]);
                write!(formatter, "μ₁ = {branch}, μ = {unrelaxed}")
            }),
            "the relaxed shear modulus μ − μ₁ must be positive",
        )?;
        Ok(Self { unrelaxed, branch_modulus, relaxation_time })
    }

    /// The unrelaxed elastic solid (instantaneous response), with shear modulus μ_U.
    pub fn unrelaxed(&self) -> Isotropic {
        self.unrelaxed
    }

    /// The relaxed elastic solid (long-time response), with shear modulus μ_R and the same bulk modulus.
    pub fn relaxed(&self) -> Isotropic {
        Isotropic {
            lambda: self.unrelaxed.lambda + 2.0 / 3.0 * self.branch_modulus,
            mu: self.relaxed_shear_modulus(),
            ..self.unrelaxed
        }
    }

    /// Shear modulus μ₁ of the Maxwell branch, Pa.
    pub fn branch_modulus(&self) -> f64 {
        self.branch_modulus
    }

    /// Relaxation time τ, s.
    pub fn relaxation_time(&self) -> f64 {
        self.relaxation_time
    }

    /// Relaxed shear modulus μ_R = μ_U − μ₁, Pa.
    fn relaxed_shear_modulus(&self) -> f64 {
        self.unrelaxed.mu - self.branch_modulus
    }

    /// Complex shear modulus μ(ς) = μ_R + μ₁ςτ/(1 + ςτ), Pa, of modes exp(ςt) with `rate` ς in 1/s; ς = iω for
    /// oscillations.
    pub fn shear_modulus(&self, rate: Complex<f64>) -> Complex<f64> {
        let times = rate * self.relaxation_time;
        times / (times + 1.0) * self.branch_modulus + self.relaxed_shear_modulus()
    }

    /// Complex longitudinal modulus (uniaxial strain) K + 4μ(ς)/3, Pa, of modes exp(ςt) with `rate` ς in 1/s.
    pub fn longitudinal_modulus(&self, rate: Complex<f64>) -> Complex<f64> {
        let bulk = self.unrelaxed.lambda + 2.0 / 3.0 * self.unrelaxed.mu;
        self.shear_modulus(rate) * (4.0 / 3.0) + bulk
    }

    /// Coefficient μ₁μ_R/μ_U, Pa, of |a|² in the stored energy, with the viscous strain a; the other term is the
    /// elastic energy of the stress with the unrelaxed moduli.
    pub fn viscous_strain_modulus(&self) -> f64 {
        self.branch_modulus * (self.relaxed_shear_modulus() / self.unrelaxed.mu)
    }

    /// Elastic energy stored in all springs, including the spring of the Maxwell branch, J/m³; `viscous_strain` is the
    /// viscous strain a.
    pub fn stored_energy(&self, stress: &Stress, viscous_strain: &[[f64; 3]; 3]) -> f64 {
        self.unrelaxed.stored_energy(stress)
            + self.viscous_strain_modulus() * squared_norm(viscous_strain)
    }

    /// Coefficients of the relaxation over `duration` ≥ 0 (s) at constant strain.
    pub fn compute_relaxation(&self, duration: f64) -> Relaxation<f64> {
        // 1 − exp(−x) = 2 sinh(x/2) exp(−x/2) without cancellation; for x ≥ 80 it rounds to 1.
        let half = (0.5 * duration / self.relaxation_time).min(40.0);
        let share = (2.0 * half.cr_sinh() * (-half).cr_exp()).min(1.0);
        Relaxation {
            strain_per_stress: 0.5 / self.unrelaxed.mu,
            strain_per_strain: self.relaxed_shear_modulus() / self.unrelaxed.mu,
            relaxed_fraction: share,
            stress_per_strain: 2.0 * self.branch_modulus,
            dissipation: self.branch_modulus * share * (2.0 - share),
        }
    }

    /// Relaxes stress and viscous strain over `duration` ≥ 0 (s) at constant strain and returns the dissipated energy,
    /// J/m³. Only the symmetric parts of stress and viscous strain enter, and both increments are symmetric.
    pub fn relax(
        &self,
        stress: &mut Stress,
        viscous_strain: &mut [[f64; 3]; 3],
        duration: f64,
    ) -> f64 {
        const SHEAR_INDICES: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];
        let force = &mut stress.force;
        let symmetric = |t: &[[f64; 3]; 3]| SymmetricTensor {
            normal: [t[0][0], t[1][1], t[2][2]],
            shear: SHEAR_INDICES.map(|[i, j]| 0.5 * (t[i][j] + t[j][i])),
        };
        let step = self.compute_relaxation(duration);
        let RelaxationIncrements { stress, viscous_strain: strain, dissipated_energy: dissipated } =
            step.compute_increments(symmetric(force), symmetric(viscous_strain));
        for i in 0..3 {
            force[i][i] += stress.normal[i];
            viscous_strain[i][i] += strain.normal[i];
        }
        for (pair, [i, j]) in SHEAR_INDICES.into_iter().enumerate() {
            for [i, j] in [[i, j], [j, i]] {
                force[i][j] += stress.shear[pair];
                viscous_strain[i][j] += strain.shear[pair];
            }
        }
        dissipated
    }
}

fn check_constants(branch_modulus: f64, relaxation_time: f64) -> Result<(), InputError> {
    BRANCH_MODULUS
        .check(branch_modulus, "the modulus of the Maxwell branch must be μ₁ > 0, in Pa")?;
    RELAXATION_TIME.check(relaxation_time, "the relaxation time must be τ > 0, in s")
}

/// A symmetric tensor by its normal and shear components; one shear component in plane strain, three in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricTensor<N, const SHEAR_COUNT: usize> {
    /// Components 11, 22, 33.
    pub normal: [N; 3],
    /// Shear components: 12 in plane strain; 12, 13, 23 in space.
    pub shear: [N; SHEAR_COUNT],
}

impl<N: Number, const SHEAR_COUNT: usize> SymmetricTensor<N, SHEAR_COUNT> {
    /// The zero tensor.
    pub const ZERO: Self = Self { normal: [N::ZERO; 3], shear: [N::ZERO; SHEAR_COUNT] };

    /// Deviator, from differences of normal components, which avoids cancellation if the mean is much larger.
    #[inline(always)]
    #[must_use]
    pub fn deviator(mut self) -> Self {
        let [a, b, c] = self.normal;
        let (ab, bc, ca) = (a - b, b - c, c - a);
        self.normal = [N::THIRD * (ab - ca), N::THIRD * (bc - ab), N::THIRD * (ca - bc)];
        self
    }

    /// Mean ⅓ tr of the normal components.
    #[inline(always)]
    pub fn mean(&self) -> N {
        let [a, b, c] = self.normal;
        N::THIRD * (a + b + c)
    }

    /// Sum of two tensors.
    #[inline(always)]
    #[must_use]
    pub fn plus(mut self, other: Self) -> Self {
        for i in 0..3 {
            self.normal[i] = self.normal[i] + other.normal[i];
        }
        for i in 0..SHEAR_COUNT {
            self.shear[i] = self.shear[i] + other.shear[i];
        }
        self
    }

    /// Tensor multiplied by a factor.
    #[inline(always)]
    #[must_use]
    pub fn scale(mut self, factor: N) -> Self {
        for i in 0..3 {
            self.normal[i] = self.normal[i] * factor;
        }
        for i in 0..SHEAR_COUNT {
            self.shear[i] = self.shear[i] * factor;
        }
        self
    }

    /// Double contraction A:B; a shear component counts twice, as ij and ji.
    #[inline(always)]
    pub fn contract(&self, other: Self) -> N {
        let mut sum = N::ZERO;
        for i in 0..SHEAR_COUNT {
            sum = sum + self.shear[i] * other.shear[i];
        }
        sum = sum + sum;
        for i in 0..3 {
            sum = sum + self.normal[i] * other.normal[i];
        }
        sum
    }

    /// Squared norm A:A.
    #[inline(always)]
    pub fn squared_norm(&self) -> N {
        self.contract(*self)
    }
}

/// Coefficients of the relaxation over a fixed time t at constant strain; symbols as in the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation<N> {
    /// Coefficient 1/(2μ_U) of the deviatoric stress s in d = e − a, 1/Pa.
    pub strain_per_stress: N,
    /// Coefficient μ_R/μ_U of the negative viscous strain −a in d = e − a.
    pub strain_per_strain: N,
    /// Relaxed fraction κ = 1 − exp(−t/τ).
    pub relaxed_fraction: N,
    /// Decrease of the stress per increment of the viscous strain, 2μ₁, Pa.
    pub stress_per_strain: N,
    /// Dissipated energy per |d|², μ₁κ(2 − κ), Pa.
    pub dissipation: N,
}

/// Increments of a state by relaxation, and the dissipated energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxationIncrements<N, const SHEAR_COUNT: usize> {
    /// Stress increment, Pa.
    pub stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Increment of the viscous strain.
    pub viscous_strain: SymmetricTensor<N, SHEAR_COUNT>,
    /// Dissipated energy, J/m³.
    pub dissipated_energy: N,
}

impl Relaxation<f64> {
    /// Coefficients with zero increments, for an elastic medium.
    pub const ELASTIC: Self = Self {
        strain_per_stress: 0.0,
        strain_per_strain: 0.0,
        relaxed_fraction: 0.0,
        stress_per_strain: 0.0,
        dissipation: 0.0,
    };
}

impl<N: Number> Relaxation<N> {
    /// Computes the increments of the symmetric stress and of the viscous strain; they depend on the deviators only.
    #[inline(always)]
    pub fn compute_increments<const SHEAR_COUNT: usize>(
        &self,
        stress: SymmetricTensor<N, SHEAR_COUNT>,
        viscous_strain: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> RelaxationIncrements<N, SHEAR_COUNT> {
        let (stress, strain) = (stress.deviator(), viscous_strain.deviator());
        let mut increments = RelaxationIncrements {
            stress: SymmetricTensor::ZERO,
            viscous_strain: SymmetricTensor::ZERO,
            dissipated_energy: N::ZERO,
        };
        for i in 0..3 {
            let (change, dissipated) = self.relax_component(stress.normal[i], strain.normal[i]);
            increments.viscous_strain.normal[i] = change;
            increments.stress.normal[i] = -(self.stress_per_strain * change);
            increments.dissipated_energy = increments.dissipated_energy + dissipated;
        }
        for i in 0..SHEAR_COUNT {
            let (change, dissipated) = self.relax_component(stress.shear[i], strain.shear[i]);
            increments.viscous_strain.shear[i] = change;
            increments.stress.shear[i] = -(self.stress_per_strain * change);
            // A shear component occurs twice in the tensor, as ij and ji.
            increments.dissipated_energy = increments.dissipated_energy + (dissipated + dissipated);
        }
        increments
    }

    /// Computes the increment of one component of the viscous strain and its dissipated energy, J/m³.
    #[inline(always)]
    fn relax_component(&self, stress: N, strain: N) -> (N, N) {
        let spring = self.strain_per_stress * stress - self.strain_per_strain * strain;
        (self.relaxed_fraction * spring, self.dissipation * spring * spring)
    }
}
