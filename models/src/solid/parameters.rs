//! Moduli of elastic solids, their checks, and wave speeds in closed form.
//!
//! The elastic energy density in terms of the strain Λ and the curvature M, with the rates Λ̇ᵢⱼ = ∂ⱼvᵢ + εᵢⱼₖωₖ and
//! Ṁᵢⱼ = ∂ⱼωᵢ of velocity v and spin ω, is (Frobenius norms, s and a for the symmetric and antisymmetric parts)
//!
//! ```text
//! ½λ (tr Λ)² + μ|Λˢ|² + α|Λᵃ|² + ½β (tr M)² + γ|Mˢ|² + η|Mᵃ|².
//! ```

use super::stress::{Stress, StressShape, Tensor};
use crate::common::decimal::{ShortNumber, format_distinct};
use crate::common::input::{InputError, ensure};
use crate::common::number::Number;
use crate::common::parameter::define_parameters;

define_parameters! {
    pub(super) LAMBDA = "lambda": "Lamé modulus λ" ["Pa"], Required(8.1e9), Finite,
        "Lamé modulus λ; 3λ + 2μ > 0";
    pub(super) MU = "mu": "shear modulus μ" ["Pa"], Required(8.1e9), Positive,
        "shear modulus μ; > 0";
    pub(super) ALPHA = "alpha": "Cosserat modulus α" ["Pa"], Required(1.005e9), Positive,
        "modulus α of the antisymmetric strain; > 0";
    pub(super) BETA = "beta": "Cosserat modulus β" ["N"], Required(7.75e8), Finite,
        "couple modulus β; 3β + 2γ > 0";
    pub(super) GAMMA = "gamma": "Cosserat modulus γ" ["N"], Required(1.5e8), Positive,
        "couple modulus γ; > 0";
    pub(super) ETA = "eta": "Cosserat modulus η" ["N"], Required(3e8), Positive,
        "couple modulus η; > 0";
    pub(super) DENSITY = "density": "density ρ" ["kg/m³"], Required(2700.0), Positive,
        "density ρ; > 0";
    pub(super) INERTIA = "inertia": "moment of inertia j" ["kg/m"], Required(2700.0), Positive,
        "moment of inertia per unit volume j; > 0";
    pub(super) ALPHA2 = "alpha2": "couple modulus α₂" ["N"], Required(4.5e8), Positive,
        "couple modulus α₂; > 0";
}

/// An isotropic elastic solid: classical without `microrotation`, reduced Cosserat with microrotation but without
/// couple stress, else Cosserat. The three theories have different unknowns; none is a singular limit of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isotropic {
    /// Lamé modulus λ, Pa; 3λ + 2μ > 0.
    pub lambda: f64,
    /// Shear modulus μ, Pa; > 0.
    pub mu: f64,
    /// Density ρ, kg/m³; > 0.
    pub density: f64,
    /// Constants of the microrotation; `None` in classical solids.
    pub microrotation: Option<Microrotation>,
}

/// Constants of the microrotation (independent particle rotation) of a Cosserat solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microrotation {
    /// Modulus α of the antisymmetric strain, Pa; > 0.
    pub alpha: f64,
    /// Moment of inertia per unit volume j, kg/m; > 0.
    pub inertia: f64,
    /// Moduli of the couple stress; `None` in the reduced Cosserat solid.
    pub couple: Option<CoupleModuli>,
}

/// Moduli of the couple stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupleModuli {
    /// Couple modulus β, N; 3β + 2γ > 0.
    pub beta: f64,
    /// Couple modulus γ, N; > 0.
    pub gamma: f64,
    /// Couple modulus η, N; > 0.
    pub eta: f64,
}

/// Theory of an elastic solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Theory {
    /// Classical elasticity: no microrotation.
    Classical,
    /// Reduced Cosserat: microrotation without couple stress.
    Reduced,
    /// Cosserat: microrotation and couple stress.
    Cosserat,
}

/// Wave speeds of an isotropic solid, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveSpeeds {
    /// Longitudinal waves, c_p² = (λ + 2μ)/ρ.
    pub longitudinal: f64,
    /// Shear waves in the short-wave limit, c_s² = (μ + α)/ρ (classical: μ/ρ).
    pub shear: f64,
    /// Longitudinal microrotation waves (torsion, axis along the wave vector), c_m² = (β + 2γ)/j; `None` without couple
    /// stress.
    pub torsion: Option<f64>,
    /// Transverse microrotation waves (axis normal to the wave vector), c_ω² = (γ + η)/j; `None` without couple stress.
    pub rotation: Option<f64>,
}

impl Isotropic {
    /// Creates the solid after checking the inequalities that make the elastic energy positive definite.
    ///
    /// # Errors
    /// An inequality is violated or a constant is not finite; the error gives the inequality with the numbers.
    pub fn new(
        lambda: f64,
        mu: f64,
        density: f64,
        microrotation: Option<Microrotation>,
    ) -> Result<Self, InputError> {
        const BULK_CONDITION: &str = "the energy is positive definite only for 3λ + 2μ > 0";
        MU.check(mu, "the energy is positive definite only for μ > 0, in Pa")?;
        check_sum([("lambda", lambda), ("mu", mu)], "3λ + 2μ")?;
        check_positive("lambda", 3.0 * lambda + 2.0 * mu, "3λ + 2μ", BULK_CONDITION)?;
        DENSITY.check(density, "the density must be positive, ρ > 0, in kg/m³")?;
        if let Some(Microrotation { alpha, inertia, couple }) = microrotation {
            const ALPHA_CONDITION: &str = "the energy is positive definite only for α > 0, in Pa; without \
                                   microrotation the solid is classical";
            ALPHA.check(alpha, ALPHA_CONDITION)?;
            INERTIA.check(inertia, "the moment of inertia must be j > 0, in kg/m")?;
            if let Some(CoupleModuli { beta, gamma, eta }) = couple {
                const TORSION_CONDITION: &str =
                    "the energy is positive definite only for 3β + 2γ > 0";
                GAMMA.check(gamma, "the energy is positive definite only for γ > 0, in N")?;
                check_sum([("beta", beta), ("gamma", gamma)], "3β + 2γ")?;
                check_positive("beta", 3.0 * beta + 2.0 * gamma, "3β + 2γ", TORSION_CONDITION)?;
                ETA.check(eta, "the energy is positive definite only for η > 0, in N")?;
            }
        }
        Ok(Self { lambda, mu, density, microrotation })
    }

    /// Theory of the solid.
    pub fn theory(&self) -> Theory {
        match self.microrotation {
            None => Theory::Classical,
            Some(Microrotation { couple: None, .. }) => Theory::Reduced,
            Some(_) => Theory::Cosserat,
        }
    }

    /// Moduli of the couple stress; `None` in classical and reduced Cosserat solids.
    pub fn couple(&self) -> Option<CoupleModuli> {
        self.microrotation.and_then(|m| m.couple)
    }

    /// Elastic energy of a stress, J/m³: ½σ·C·σ + ½m·C′·m with the compliances C of the force stress σ and C′ of the
    /// couple stress m. Parts of the stress for which the solid has no modulus store no energy.
    pub fn stored_energy(&self, stress: &Stress) -> f64 {
        stored_energy(StressShape::GENERAL, &stress.force, &stress.couple, &self.energy_moduli())
    }

    /// Moduli of the elastic energy: μ, α and 3λ + 2μ (Pa) for symmetric deviator, antisymmetric part and mean of the
    /// force stress; γ, η and 3β + 2γ (N) for the same parts of the couple stress. Infinite if the solid has no such
    /// modulus.
    pub fn energy_moduli(&self) -> [[f64; 3]; 2] {
        let alpha = self.microrotation.map_or(0.0, |m| m.alpha);
        let couple = self.couple().map_or([0.0; 3], |c| [c.beta, c.gamma, c.eta]);
        [[self.lambda, self.mu, alpha], couple].map(|[trace, symmetric, antisymmetric]| {
            [symmetric, antisymmetric, 3.0 * trace + 2.0 * symmetric]
                .map(|modulus| if modulus > 0.0 { modulus } else { f64::INFINITY })
        })
    }

    /// Wave speeds in closed form; they equal the characteristic speeds of the rate equations.
    pub fn speeds(&self) -> WaveSpeeds {
        let alpha = self.microrotation.map_or(0.0, |m| m.alpha);
        let rotational = |modulus: fn(CoupleModuli) -> f64| {
            self.microrotation.and_then(|m| Some((modulus(m.couple?) / m.inertia).sqrt()))
        };
        WaveSpeeds {
            longitudinal: ((self.lambda + 2.0 * self.mu) / self.density).sqrt(),
            shear: ((self.mu + alpha) / self.density).sqrt(),
            torsion: rotational(|c| c.beta + 2.0 * c.gamma),
            rotation: rotational(|c| c.gamma + c.eta),
        }
    }
}

impl Microrotation {
    /// Natural frequency of the microrotation without displacement, ω* = √(4α/j), rad/s.
    pub fn natural_frequency(&self) -> f64 {
        (4.0 * self.alpha / self.inertia).sqrt()
    }
}

/// A Cosserat solid in plane strain by its compliances (Sadovskii & Sadovskaya 2019, "Plane strain state"), with
/// velocity v, spin ω, force stress σ and couple stress m:
///
/// ```text
/// a₁σ̇₁₁ − b₁σ̇₂₂ = v₁,₁    a₂σ̇₂₁ − b₂σ̇₁₂ = v₂,₁ − ω₃    ṁ₃₁ = α₂ω₃,₁
/// a₁σ̇₂₂ − b₁σ̇₁₁ = v₂,₂    a₂σ̇₁₂ − b₂σ̇₂₁ = v₁,₂ + ω₃    ṁ₃₂ = α₂ω₃,₂
/// ```
///
/// The solid is isotropic exactly if a₁ + b₁ = a₂ − b₂ (= 1/2μ), else cubic: wave speeds depend on direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneCompliances {
    /// Compliance a₁, 1/Pa; > |b₁|.
    pub a1: f64,
    /// Compliance b₁, 1/Pa.
    pub b1: f64,
    /// Compliance a₂, 1/Pa; > |b₂|.
    pub a2: f64,
    /// Compliance b₂, 1/Pa.
    pub b2: f64,
    /// Couple modulus α₂, N; > 0.
    pub alpha2: f64,
    /// Density ρ₀, kg/m³; > 0.
    pub density: f64,
    /// Moment of inertia per unit volume J₀, kg/m; > 0.
    pub inertia: f64,
}

impl PlaneCompliances {
    /// Checks the inequalities that make the elastic energy positive definite.
    ///
    /// # Errors
    /// An inequality is violated or a constant is not finite; the error gives the inequality with the numbers.
    pub fn check(self) -> Result<Self, InputError> {
        let Self { a1, b1, a2, b2, alpha2, density, inertia } = self;
        check_positive(
            "a1",
            a1 - b1.abs(),
            "a₁ − |b₁|",
            "the energy is positive definite only for a₁ > |b₁|",
        )?;
        check_positive(
            "a2",
            a2 - b2.abs(),
            "a₂ − |b₂|",
            "the energy is positive definite only for a₂ > |b₂|",
        )?;
        ALPHA2.check(alpha2, "the energy is positive definite only for α₂ > 0, in N")?;
        DENSITY.check(density, "the density must be positive, ρ₀ > 0, in kg/m³")?;
        INERTIA.check(inertia, "the moment of inertia must be J₀ > 0, in kg/m")?;
        Ok(self)
    }

    /// Elastic energy of the in-plane stress, J/m³.
    pub fn stored_energy(&self, stress: &Stress) -> f64 {
        let pair = |a: f64, b: f64, x: f64, y: f64| 0.5 * a * (x * x + y * y) - b * x * y;
        let (force, couple) = (&stress.force, &stress.couple[2]);
        pair(self.a1, self.b1, force[0][0], force[1][1])
            + pair(self.a2, self.b2, force[0][1], force[1][0])
            + 0.5 * (couple[0] * couple[0] + couple[1] * couple[1]) / self.alpha2
    }

    /// Compliances of an isotropic Cosserat solid; `None` without couple stress.
    pub fn from_isotropic(solid: &Isotropic) -> Option<Self> {
        let Microrotation { alpha, inertia, couple } = solid.microrotation?;
        let CoupleModuli { gamma, eta, .. } = couple?;
        let (lambda, mu) = (solid.lambda, solid.mu);
        Some(Self {
            a1: (lambda + 2.0 * mu) / (4.0 * mu * (lambda + mu)),
            b1: lambda / (4.0 * mu * (lambda + mu)),
            a2: (mu + alpha) / (4.0 * mu * alpha),
            b2: (mu - alpha) / (4.0 * mu * alpha),
            alpha2: gamma + eta,
            density: solid.density,
            inertia,
        })
    }

    /// Anisotropy (a₁ + b₁)/(a₂ − b₂) − 1: zero exactly for isotropic solids.
    pub fn anisotropy(&self) -> f64 {
        (self.a1 + self.b1) / (self.a2 - self.b2) - 1.0
    }

    /// Moduli λ, μ and α (Pa) of the isotropic solid with these compliances in plane strain.
    ///
    /// # Errors
    /// The solid is cubic, not isotropic: |anisotropy| > 1e-12.
    pub fn isotropic_moduli(&self) -> Result<[f64; 3], InputError> {
        let Self { a1, b1, a2, b2, .. } = *self;
        ensure(
            self.anisotropy().abs() <= 1e-12,
            "a1",
            std::fmt::from_fn(|formatter| {
                let [shear, other] = format_distinct([a1 + b1, a2 - b2]);
                write!(formatter, "a₁ + b₁ = {shear}, a₂ − b₂ = {other}")
            }),
            "λ, μ and α exist only where a₁ + b₁ = a₂ − b₂: this solid is cubic",
        )?;
        let mu = 0.5 / (a1 + b1);
        Ok([b1 / ((a1 - b1) * (a1 + b1)), mu, 0.5 / (a2 + b2)])
    }
}

/// Computes the elastic energy of a stress, J/m³; `moduli` as returned by [`Isotropic::energy_moduli`]: μ, α, 3λ + 2μ
/// of the force stress and γ, η, 3β + 2γ of the couple stress, infinite if absent.
#[inline(always)]
pub fn stored_energy<N: Number>(
    shape: StressShape,
    force: &Tensor<N>,
    couple: &Tensor<N>,
    moduli: &[[N; 3]; 2],
) -> N {
    let sum = stored_tensor_energy(shape, 0, force, &moduli[0]);
    match shape.has_couples {
        true => sum + stored_tensor_energy(shape, 1, couple, &moduli[1]),
        false => sum,
    }
}

/// Elastic energy of the force stress (`tensor_index` = 0) or couple stress (1), J/m³, with the moduli of its symmetric
/// deviator, antisymmetric part and mean.
#[inline(always)]
fn stored_tensor_energy<N: Number>(
    shape: StressShape,
    tensor_index: usize,
    tensor: &Tensor<N>,
    [symmetric, antisymmetric, mean]: &[N; 3],
) -> N {
    let (mean_stress, deviator, antisymmetric_part) = shape.split(tensor);
    let mut sum = N::QUARTER * shape.squared_norm(tensor_index, &deviator) / *symmetric;
    if !shape.is_symmetric {
        sum = sum
            + N::QUARTER * shape.squared_norm_antisymmetric(tensor_index, &antisymmetric_part)
                / *antisymmetric;
    }
    sum + (N::ONE + N::HALF) * mean_stress * mean_stress / *mean
}

/// Checks that 3a + 2b, called `name`, does not overflow for two finite moduli a and b with their keys; an overflow is
/// the fault of the larger one.
fn check_sum(
    [(first, a), (second, b)]: [(&'static str, f64); 2],
    name: &str,
) -> Result<(), InputError> {
    let (key, value) = if a.abs() > b.abs() { (first, a) } else { (second, b) };
    ensure(
        !(a.is_finite() && b.is_finite()) || (3.0 * a + 2.0 * b).is_finite(),
        key,
        value,
        format_args!("a modulus so large that {name} overflows is not allowed"),
    )
}

fn check_positive(
    key: &'static str,
    value: f64,
    name: &str,
    allowed: &str,
) -> Result<(), InputError> {
    ensure(
        value > 0.0 && value.is_finite(),
        key,
        format_args!("{name} = {}", ShortNumber(value)),
        allowed,
    )
}
