//! Equivalent Cosserat continuum of a blocky medium: square elastic blocks of period h in plane strain, separated in
//! both directions by the same elastic layers of stiffnesses K_n = ρ′c₁′²/δ and K_t = ρ′c₂′²/δ (Pa/m).
//!
//! Under a homogeneous stress the strain and rotation of every block and the opening of every joint are homogeneous, so
//! the compliances of blocks and joints add. In the notation of [`PlaneCompliances`] (Sadovskii & Sadovskaya 2019,
//! "Plane strain state", "Blocky medium"), with the speeds c₁, c₂ and the density ρ of the rock,
//!
//! ```text
//! a₁ = c₁²/[4ρc₂²(c₁² − c₂²)] + 1/(hK_n),   b₁ = (c₁² − 2c₂²)/[4ρc₂²(c₁² − c₂²)],
//! a₂ = 1/(4ρc₂²) + 1/(hK_t),                b₂ = −1/(4ρc₂²),      α₂ = h²/(12a₁),
//! ρ₀ = ρ + 2ρ′δ/h,                          J₀ = (h²/6)(ρ + ρ′δ/h).
//! ```
//!
//! So α = 1/[2(a₂ + b₂)] = ½hK_t and 1/μ = 2(a₂ − b₂) = 1/(ρc₂²) + 2/(hK_t), and the natural frequency of the rotation
//! of blocks is ω*² = 4α/J₀ = 12K_t/[h(ρ + ρ′δ/h)]. Both faces of a layer have the same coordinates: the period is the
//! side of a block, and δ enters through stiffness and mass only. [`Validity`] says how far each constant is justified.

use super::elastic::ElasticMaterial;
use crate::common::decimal::ShortNumber;
use crate::common::input::{InputError, ensure};
use crate::solid::parameters::PlaneCompliances;

/// Isotropic elastic material of the blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockMaterial {
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Longitudinal wave speed c₁, m/s.
    pub longitudinal_speed: f64,
    /// Shear wave speed c₂, m/s.
    pub shear_speed: f64,
}

impl BlockMaterial {
    /// Checks that all constants are positive and finite, and that the elastic energy is positive definite.
    ///
    /// # Errors
    /// A constant is not positive and finite, or 3c₁² ≤ 4c₂².
    pub fn check(&self) -> Result<(), InputError> {
        let Self { density, longitudinal_speed, shear_speed } = *self;
        for (name, value) in [
            ("density", density),
            ("longitudinal_speed", longitudinal_speed),
            ("shear_speed", shear_speed),
        ] {
            ensure(value > 0.0 && value.is_finite(), name, value, "expected a positive number")?;
        }
        ensure(
            3.0 * (longitudinal_speed / shear_speed).powi(2) > 4.0,
            "longitudinal_speed",
            longitudinal_speed,
            format_args!(
                "expected more than 2c₂/√3 = {} m/s: the energy is positive definite only for 3c₁² > 4c₂²",
                ShortNumber(2.0 * shear_speed / 3.0_f64.sqrt())
            ),
        )
    }

    /// Shear modulus μ = ρc₂², Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.density * self.shear_speed * self.shear_speed
    }

    /// Lamé modulus λ = ρ(c₁² − 2c₂²), Pa.
    pub fn lame_modulus(&self) -> f64 {
        self.longitudinal_modulus() - 2.0 * self.shear_modulus()
    }

    /// Modulus of longitudinal waves λ + 2μ = ρc₁², Pa.
    pub fn longitudinal_modulus(&self) -> f64 {
        self.density * self.longitudinal_speed * self.longitudinal_speed
    }
}

/// Blocky medium of square blocks with the same elastic layers in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockyMedium {
    /// Material of the blocks.
    pub block: BlockMaterial,
    /// Material and thickness of the layers.
    pub layer: ElasticMaterial,
    /// Period h, m: the side of a block.
    pub period: f64,
}

/// A constant of the equivalent Cosserat continuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EquivalentConstant {
    /// Compliance a₁, 1/Pa.
    A1,
    /// Compliance b₁, 1/Pa.
    B1,
    /// Difference of compliances a₂ − b₂ = 1/(2μ), 1/Pa.
    A2MinusB2,
    /// Compliance a₂, 1/Pa, which alone is less certain than a₂ − b₂.
    A2,
    /// Compliance b₂, 1/Pa, which alone is less certain than a₂ − b₂.
    B2,
    /// Couple modulus α₂, N.
    Alpha2,
    /// Density ρ₀, kg/m³.
    Density,
    /// Moment of inertia per unit volume J₀, kg/m.
    Inertia,
    /// Natural frequency ω* of the rotation of blocks, rad/s.
    NaturalFrequency,
    /// Modulus of the antisymmetric strain α, Pa.
    Alpha,
    /// Shear modulus μ, Pa.
    Mu,
}

impl EquivalentConstant {
    /// All constants of the equivalent continuum.
    pub const ALL: [Self; 11] = [
        Self::A1,
        Self::B1,
        Self::A2MinusB2,
        Self::A2,
        Self::B2,
        Self::Alpha2,
        Self::Density,
        Self::Inertia,
        Self::NaturalFrequency,
        Self::Alpha,
        Self::Mu,
    ];

    /// Symbol of the constant for output.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::A1 => "a₁",
            Self::B1 => "b₁",
            Self::A2MinusB2 => "a₂ − b₂",
            Self::A2 => "a₂",
            Self::B2 => "b₂",
            Self::Alpha2 => "α₂",
            Self::Density => "ρ₀",
            Self::Inertia => "J₀",
            Self::NaturalFrequency => "ω*",
            Self::Alpha => "α",
            Self::Mu => "μ",
        }
    }

    /// Name of the constant: the key of case files if they have the constant.
    pub const fn name(self) -> &'static str {
        match self {
            Self::A1 => "a1",
            Self::B1 => "b1",
            Self::A2MinusB2 => "a2_minus_b2",
            Self::A2 => "a2",
            Self::B2 => "b2",
            Self::Alpha2 => "alpha2",
            Self::Density => "density",
            Self::Inertia => "inertia",
            Self::NaturalFrequency => "natural_frequency",
            Self::Alpha => "alpha",
            Self::Mu => "mu",
        }
    }

    /// Unit of the constant.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::A1 | Self::B1 | Self::A2MinusB2 | Self::A2 | Self::B2 => "1/Pa",
            Self::Alpha2 => "N",
            Self::Density => "kg/m³",
            Self::Inertia => "kg/m",
            Self::NaturalFrequency => "rad/s",
            Self::Alpha | Self::Mu => "Pa",
        }
    }

    /// Validity of the value of the constant.
    pub const fn validity(self) -> Validity {
        match self {
            Self::A1 | Self::B1 | Self::A2MinusB2 | Self::Density | Self::Mu => Validity::Exact,
            Self::A2 | Self::B2 | Self::Inertia | Self::NaturalFrequency | Self::Alpha => {
                Validity::LeadingOrder
            }
            Self::Alpha2 => Validity::NotUnique,
        }
    }
}

/// Validity of a constant of the equivalent continuum: exact, approximate or not unique.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Validity {
    /// Exact in the limit of long waves: it determines their speeds, which are those of the blocky medium in every
    /// direction.
    Exact,
    /// Leading order in the ratio K_t h/μ of joint and block stiffness, accurate for blocks that move almost rigidly;
    /// it affects long waves only at the next order in the wave number.
    LeadingOrder,
    /// Not unique: the value depends on how moments are averaged over a cell, so couple stresses are only qualitative.
    NotUnique,
}

impl Validity {
    /// Short name for output: `sure`, `leading order` or `not unique`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "sure",
            Self::LeadingOrder => "leading order",
            Self::NotUnique => "not unique",
        }
    }

    /// Description of the validity for output.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Exact => "exact for long waves",
            Self::LeadingOrder => "leading order in K_t h/μ of the blocks",
            Self::NotUnique => "not unique: depends on the averaging of moments",
        }
    }
}

/// Constants of the equivalent Cosserat continuum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomogenisedConstants {
    /// Compliances, couple modulus, density and moment of inertia of the equivalent solid.
    pub solid: PlaneCompliances,
    /// Modulus of the antisymmetric strain α = ½hK_t, Pa.
    pub alpha: f64,
    /// Shear modulus μ of long waves, Pa.
    pub mu: f64,
    /// Natural frequency of the rotation of blocks ω*, rad/s.
    pub natural_frequency: f64,
    /// Ratio K_t h/μ of joint and block stiffness; constants of [`Validity::LeadingOrder`] need a small ratio.
    pub stiffness_ratio: f64,
}

impl BlockyMedium {
    /// Checks the constants of blocks, layers and period.
    ///
    /// # Errors
    /// A constant is not positive and finite, or the elastic energy of the blocks is not positive definite.
    pub fn check(&self) -> Result<(), InputError> {
        self.block.check()?;
        self.layer.check()?;
        let period = self.period;
        ensure(period > 0.0 && period.is_finite(), "period", period, "expected a positive number")
    }

    /// Stiffnesses K_n = ρ′c₁′²/δ and K_t = ρ′c₂′²/δ of a layer, Pa/m.
    pub fn layer_stiffness(&self) -> [f64; 2] {
        [1.0 / self.layer.normal_compliance(), 1.0 / self.layer.tangential_compliance()]
    }

    /// The constants of the equivalent Cosserat continuum; formulas in the [module](self).
    ///
    /// # Errors
    /// A constant of the medium is rejected by [`check`](Self::check), or an equivalent constant overflows.
    pub fn homogenise(&self) -> Result<HomogenisedConstants, InputError> {
        self.check()?;
        let (block, h) = (&self.block, self.period);
        let [normal, tangential] =
            [self.layer.normal_compliance() / h, self.layer.tangential_compliance() / h];
        let mu = block.shear_modulus();
        // 4μ(λ + μ)/(λ + 2μ) and λ + μ from the speeds.
        let ratio = (block.shear_speed / block.longitudinal_speed).powi(2);
        let denominator = 4.0 * mu * (1.0 - ratio);
        let a1 = 1.0 / denominator + normal;
        let rotating_density = block.density + self.layer.mass() / h;
        let solid = PlaneCompliances {
            a1,
            b1: (1.0 - 2.0 * ratio) / denominator,
            a2: 0.25 / mu + tangential,
            b2: -0.25 / mu,
            alpha2: h * h / (12.0 * a1),
            density: block.density + 2.0 * self.layer.mass() / h,
            inertia: h * h / 6.0 * rotating_density,
        }
        .check()?;
        Ok(HomogenisedConstants {
            solid,
            alpha: 0.5 / tangential,
            mu: 1.0 / (1.0 / mu + 2.0 * tangential),
            natural_frequency: (12.0 / (tangential * h * h * rotating_density)).sqrt(),
            stiffness_ratio: 1.0 / (tangential * mu),
        })
    }
}

impl HomogenisedConstants {
    /// Largest ratio K_t h/μ at which constants of [`Validity::LeadingOrder`] are taken as quantitative: their relative
    /// error is of the order of the ratio.
    pub const SMALL_STIFFNESS_RATIO: f64 = 0.2;

    /// Value of a constant in its [unit](EquivalentConstant::unit).
    pub const fn value(&self, constant: EquivalentConstant) -> f64 {
        let solid = &self.solid;
        match constant {
            EquivalentConstant::A1 => solid.a1,
            EquivalentConstant::B1 => solid.b1,
            EquivalentConstant::A2MinusB2 => solid.a2 - solid.b2,
            EquivalentConstant::A2 => solid.a2,
            EquivalentConstant::B2 => solid.b2,
            EquivalentConstant::Alpha2 => solid.alpha2,
            EquivalentConstant::Density => solid.density,
            EquivalentConstant::Inertia => solid.inertia,
            EquivalentConstant::NaturalFrequency => self.natural_frequency,
            EquivalentConstant::Alpha => self.alpha,
            EquivalentConstant::Mu => self.mu,
        }
    }

    /// Whether the blocks are so much stiffer than the joints that constants of [`Validity::LeadingOrder`] are
    /// quantitative: K_t h/μ ≤ 0.2.
    pub fn has_rigid_blocks(&self) -> bool {
        self.stiffness_ratio <= Self::SMALL_STIFFNESS_RATIO
    }

    /// Speed of long waves along an axis with longitudinal polarisation, c² = a₁/[(a₁² − b₁²)ρ₀], m/s.
    pub fn longitudinal_speed(&self) -> f64 {
        let PlaneCompliances { a1, b1, density, .. } = self.solid;
        (a1 / ((a1 - b1) * (a1 + b1) * density)).sqrt()
    }

    /// Speed of long transverse waves along an axis, c² = μ/ρ₀, m/s: [`Validity::Exact`].
    pub fn long_shear_speed(&self) -> f64 {
        (self.mu / self.solid.density).sqrt()
    }

    /// Speed of short transverse waves of the continuum, c² = a₂/[(a₂² − b₂²)ρ₀], m/s: [`Validity::LeadingOrder`].
    pub fn short_shear_speed(&self) -> f64 {
        let PlaneCompliances { a2, b2, density, .. } = self.solid;
        (a2 / ((a2 - b2) * (a2 + b2) * density)).sqrt()
    }

    /// Speeds of long waves along the unit vector `normal`, m/s, the slower wave first: those of the cubic solid with
    /// C₁₁ = a₁/(a₁² − b₁²), C₁₂ = b₁/(a₁² − b₁²) and C₆₆ = μ; the microrotation follows the displacement.
    pub fn long_wave_speeds(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let PlaneCompliances { a1, b1, density, .. } = self.solid;
        let determinant = (a1 - b1) * (a1 + b1);
        let [c11, c12] = [a1 / determinant, b1 / determinant];
        // Acoustic tensor [p, r; r, q].
        let (p, q) = (c11 * x * x + self.mu * y * y, c11 * y * y + self.mu * x * x);
        let r = (c12 + self.mu) * x * y;
        let (mean, half) = (0.5 * (p + q), 0.5 * (p - q));
        let radius = (half * half + r * r).sqrt();
        let largest = mean + radius;
        // The smaller eigenvalue from the determinant, without cancellation.
        [((p * q - r * r) / largest / density).sqrt(), (largest / density).sqrt()]
    }
}
