//! Constants of thin layers between blocks, with keys, units, ranges and checks.
//!
//! A layer has thickness δ and mass per area m = ρ′δ; its laws are per traction component, the normal one (n) and the
//! tangential one (t), with the compliances C_n = δ/(ρ′c₁′²) and C_t = δ/(ρ′c₂′²). Materials after
//! Sadovskii & Sadovskaya (blocky media with compliant interlayers), formulas derived anew.

use super::elastic::ElasticMaterial;
use crate::common::decimal::ShortNumber;
use crate::common::input::{InputError, ensure};
use crate::common::parameter::Parameter;
use crate::common::range::AllowedRange;

pub(super) const THICKNESS: Parameter = Parameter::new_required(
    ["thickness", "thickness δ", "m"],
    "thickness δ of the layer; > 0. It gives stiffness and mass; the faces of the layer coincide",
    1e-3,
)
.with_range(AllowedRange::Positive);
pub(super) const DENSITY: Parameter = Parameter::new_required(
    ["density", "density ρ′", "kg/m3"],
    "density ρ′ of the layer; > 0",
    1500.0,
)
.with_range(AllowedRange::Positive);
pub(super) const LONGITUDINAL_SPEED: Parameter = Parameter::new_required(
    ["longitudinal_speed", "longitudinal speed c₁′", "m/s"],
    "longitudinal wave speed c₁′ of the layer; > 0. Its normal compliance is δ/(ρ′c₁′²)",
    1000.0,
)
.with_range(AllowedRange::Positive);
pub(super) const SHEAR_SPEED: Parameter = Parameter::new_required(
    ["shear_speed", "shear speed c₂′", "m/s"],
    "shear wave speed c₂′ of the layer; > 0. Its (instantaneous) shear compliance is δ/(ρ′c₂′²)",
    500.0,
)
.with_range(AllowedRange::Positive);

pub(super) const SHEAR_STRENGTH: Parameter = Parameter::new_required(
    ["shear_strength", "shear strength τ_s", "Pa"],
    "shear strength τ_s of the layer without normal stress; ≥ 0",
    1e6,
)
.with_range(AllowedRange::NotNegative);
pub(super) const SHEAR_FRICTION: Parameter = Parameter::new_required(
    ["shear_friction", "friction k_s", ""],
    "friction k_s of |S_t| ≤ τ_s − k_s S_n; ≥ 0",
    0.5,
)
.with_range(AllowedRange::NotNegative);
pub(super) const SLIP_HARDENING: Parameter = Parameter::with_default(
    ["slip_hardening", "slip hardening H", "Pa/m"],
    "increase H of the shear strength per slip; ≥ 0",
    0.0,
)
.with_range(AllowedRange::NotNegative);
pub(super) const CONTACT_FRICTION: Parameter = Parameter::new_optional(
    ["shear_friction", "friction k_s", ""],
    "friction k_s of closed faces, |S_t| ≤ −k_s S_n; ≥ 0; without it closed faces do not slip",
)
.with_range(AllowedRange::NotNegative);
pub(super) const TENSILE_STRENGTH: Parameter = Parameter::new_required(
    ["tensile_strength", "tensile strength σ_t", "Pa"],
    "normal stress σ_t at which the layer breaks; ≥ 0, at most τ_s/k_s",
    0.5e6,
)
.with_range(AllowedRange::NotNegative);

pub(super) const INSTANTANEOUS_COMPLIANCE: Parameter = Parameter::new_required(
    ["instantaneous_compliance", "instantaneous compliance a₀", "1/Pa"],
    "instantaneous shear compliance a₀ of the layer; > 0",
    1.0 / 3.75e8,
)
.with_range(AllowedRange::Positive);
pub(super) const DELAYED_COMPLIANCE: Parameter = Parameter::new_required(
    ["delayed_compliance", "delayed compliance a₁", "1/Pa"],
    "delayed shear compliance a₁ of the layer; > 0",
    2.0 / 3.75e8,
)
.with_range(AllowedRange::Positive);
pub(super) const VISCOSITY: Parameter = Parameter::new_required(
    ["viscosity", "viscosity η", "Pa s"],
    "viscosity η of the delayed shear; > 0. The retardation time is ηa₁",
    7500.0,
)
.with_range(AllowedRange::Positive);

pub(super) const COLLAPSE_STIFFNESS: Parameter = Parameter::new_required(
    ["collapse_stiffness", "stiffness of collapsed pores b₁", "Pa"],
    "stiffness b₁ that is added when the pores have collapsed; ≥ 0",
    1.35e10,
)
.with_range(AllowedRange::NotNegative);
pub(super) const POROSITY: Parameter = Parameter::new_required(
    ["porosity", "porosity θ₀", ""],
    "initial porosity θ₀: the pores collapse at the strain −θ₀; ≥ 0 and < 1",
    0.1,
)
.with_range(AllowedRange::NotNegativeBelow(1.0));

pub(super) const SKELETON_DENSITY: Parameter = Parameter::new_required(
    ["skeleton_density", "partial density ρ_s of the skeleton", "kg/m3"],
    "mass ρ_s of the skeleton per volume of the layer; > 0",
    1300.0,
)
.with_range(AllowedRange::Positive);
pub(super) const FLUID_DENSITY: Parameter = Parameter::new_required(
    ["fluid_density", "partial density ρ_f of the fluid", "kg/m3"],
    "mass ρ_f of the fluid per volume of the layer; > 0",
    250.0,
)
.with_range(AllowedRange::Positive);
pub(super) const ADDED_DENSITY: Parameter = Parameter::new_required(
    ["added_density", "added density ρ_a", "kg/m3"],
    "added mass ρ_a of the relative motion of fluid and skeleton along the layer; ≥ 0",
    100.0,
)
.with_range(AllowedRange::NotNegative);
pub(super) const FLUID_STIFFNESS: Parameter = Parameter::new_required(
    ["fluid_stiffness", "stiffness of the fluid b_f", "Pa"],
    "stiffness b_f of the fluid along the layer at fixed faces; > 0",
    0.7e9,
)
.with_range(AllowedRange::Positive);
pub(super) const COUPLING_STIFFNESS: Parameter = Parameter::new_required(
    ["coupling_stiffness", "coupling stiffness b_s", "Pa"],
    "coupling stiffness b_s of opening and fluid; b₀b_f > b_s²",
    0.45e9,
);
pub(super) const UNDRAINED_STIFFNESS: Parameter = Parameter::new_required(
    ["undrained_stiffness", "undrained stiffness b₀", "Pa"],
    "stiffness b₀ across the layer with open pores at fixed fluid content; > 0",
    1.5e9,
)
.with_range(AllowedRange::Positive);

/// Strength of a layer that slips: |S_t| ≤ τ_s + Hχ − k_s S_n with the slip χ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticConstants {
    /// Shear strength τ_s without normal stress, Pa; ≥ 0.
    pub shear_strength: f64,
    /// Friction k_s; ≥ 0.
    pub friction: f64,
    /// Slip hardening H, Pa/m; ≥ 0.
    pub hardening: f64,
}

/// Constants of delayed shear, δ a₁ṡ = δ(S − s)/η.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousConstants {
    /// Delayed compliance a₁, 1/Pa; > 0.
    pub delayed_compliance: f64,
    /// Viscosity η, Pa s; > 0.
    pub viscosity: f64,
}

/// Constants of pores that collapse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousConstants {
    /// Stiffness b₁ added by collapsed pores, Pa; ≥ 0.
    pub collapse_stiffness: f64,
    /// Initial porosity θ₀; ≥ 0.
    pub porosity: f64,
}

/// Constants of the tangential law of a porous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TangentialConstants {
    /// Elastic shear.
    Elastic,
    /// Viscous shear.
    Viscous(ViscousConstants),
    /// Elastic-plastic shear without friction, k_s = 0.
    Plastic {
        /// Shear strength τ_s, Pa; ≥ 0.
        shear_strength: f64,
        /// Slip hardening H, Pa/m; ≥ 0.
        hardening: f64,
    },
}

/// Constants of a fluid-saturated porous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaturatedMaterial {
    /// Thickness δ, m.
    pub thickness: f64,
    /// Partial density of the skeleton ρ_s, kg/m³; > 0.
    pub skeleton_density: f64,
    /// Partial density of the fluid ρ_f, kg/m³; > 0.
    pub fluid_density: f64,
    /// Added density ρ_a, kg/m³; ≥ 0.
    pub added_density: f64,
    /// Stiffness b₀ across the layer at fixed fluid content, Pa; > 0.
    pub undrained_stiffness: f64,
    /// Constants of the collapsing pores.
    pub pores: PorousConstants,
    /// Coupling stiffness b_s, Pa; b₀b_f > b_s².
    pub coupling_stiffness: f64,
    /// Stiffness of the fluid b_f, Pa; > 0.
    pub fluid_stiffness: f64,
    /// Instantaneous shear compliance a₀, 1/Pa; > 0.
    pub instantaneous_compliance: f64,
    /// Constants of the delayed shear.
    pub viscous: ViscousConstants,
}

/// Distribution of the mass of a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassDistribution {
    /// Box scheme: the mass moves with the mean velocity of both faces.
    #[default]
    Box,
    /// Half of the mass moves with each face.
    Lumped,
}

impl MassDistribution {
    /// Returns the distribution of the given name, `box` or `lumped`, a value of the option `mass`; `None` for others.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "box" => Some(Self::Box),
            "lumped" => Some(Self::Lumped),
            _ => None,
        }
    }
}

/// Constants of a layer of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayerMaterial {
    /// Elastic in both components.
    Elastic(ElasticMaterial),
    /// Elastic-plastic: slip and opening under Coulomb friction with cohesion, associated.
    Plastic(ElasticMaterial, PlasticConstants),
    /// Elastic normal component, viscoelastic shear.
    Viscous(ElasticMaterial, ViscousConstants),
    /// Normal component with collapsing pores, b₀ = ρ′c₁′².
    Porous(ElasticMaterial, PorousConstants, TangentialConstants),
    /// Fluid-saturated porous layer.
    Saturated(SaturatedMaterial),
    /// Layer without tensile strength; closed faces do not slip, or slip with friction k_s.
    Cracked(ElasticMaterial, Option<f64>),
    /// Elastic-plastic until the normal stress reaches the tensile strength σ_t, Pa, then cracked with friction k_s.
    Breaking(ElasticMaterial, PlasticConstants, f64),
}

impl PlasticConstants {
    fn check(&self) -> Result<(), InputError> {
        SHEAR_STRENGTH.check(self.shear_strength, "the shear strength must be τ_s ≥ 0, in Pa")?;
        SHEAR_FRICTION.check(self.friction, "the friction must be k_s ≥ 0")?;
        SLIP_HARDENING.check(self.hardening, "the hardening must be H ≥ 0, in Pa/m")
    }
}

impl ViscousConstants {
    fn check(&self) -> Result<(), InputError> {
        let compliance = self.delayed_compliance;
        DELAYED_COMPLIANCE.check(compliance, "the compliance must be a₁ > 0, in 1/Pa")?;
        VISCOSITY.check(self.viscosity, "the viscosity must be η > 0, in Pa s")
    }
}

impl PorousConstants {
    fn check(&self) -> Result<(), InputError> {
        let stiffness = self.collapse_stiffness;
        COLLAPSE_STIFFNESS.check(stiffness, "the stiffness must be b₁ ≥ 0, in Pa")?;
        POROSITY.check(self.porosity, "the porosity must be 0 ≤ θ₀ < 1")
    }
}

impl TangentialConstants {
    fn check(&self) -> Result<(), InputError> {
        match *self {
            Self::Elastic => Ok(()),
            Self::Viscous(viscous) => viscous.check(),
            Self::Plastic { shear_strength, hardening } => {
                PlasticConstants { shear_strength, friction: 0.0, hardening }.check()
            }
        }
    }
}

impl SaturatedMaterial {
    /// Checks the constants of the layer.
    ///
    /// # Errors
    /// A constant is out of range, or the energy is not positive, b₀b_f ≤ b_s².
    pub fn check(&self) -> Result<(), InputError> {
        THICKNESS.check(self.thickness, "the thickness must be δ > 0, in m")?;
        SKELETON_DENSITY.check(self.skeleton_density, "the density must be ρ_s > 0, in kg/m3")?;
        FLUID_DENSITY.check(self.fluid_density, "the density must be ρ_f > 0, in kg/m3")?;
        ADDED_DENSITY.check(self.added_density, "the density must be ρ_a ≥ 0, in kg/m3")?;
        let [b0, bs, bf] =
            [self.undrained_stiffness, self.coupling_stiffness, self.fluid_stiffness];
        UNDRAINED_STIFFNESS.check(b0, "the stiffness must be b₀ > 0, in Pa")?;
        self.pores.check()?;
        FLUID_STIFFNESS.check(bf, "the stiffness must be b_f > 0, in Pa")?;
        COUPLING_STIFFNESS.check(bs, "a finite number is needed")?;
        ensure(
            b0 * bf > bs * bs,
            COUPLING_STIFFNESS.name,
            bs,
            format_args!("the energy must be positive: b_s² < b₀b_f = {}", ShortNumber(b0 * bf)),
        )?;
        let compliance = self.instantaneous_compliance;
        INSTANTANEOUS_COMPLIANCE.check(compliance, "the compliance must be a₀ > 0, in 1/Pa")?;
        self.viscous.check()
    }

    /// Effective density ρ̂ = ρ_f + ρ_sρ_a/(ρ_s + ρ_a) of the fluid, whose skeleton is free to move along the layer,
    /// kg/m³.
    pub fn free_fluid_density(&self) -> f64 {
        let [skeleton, added] = [self.skeleton_density, self.added_density];
        self.fluid_density + skeleton * added / (skeleton + added)
    }

    /// Speed √(b_f/ρ̂) of waves of the fluid along the layer, m/s.
    pub fn fluid_speed(&self) -> f64 {
        (self.fluid_stiffness / self.free_fluid_density()).sqrt()
    }
}

impl LayerMaterial {
    /// Returns the layer without fracture: a breaking layer becomes elastic-plastic, other kinds are unchanged.
    pub fn without_fracture(self) -> Self {
        match self {
            Self::Breaking(elastic, plastic, _) => Self::Plastic(elastic, plastic),
            other => other,
        }
    }

    /// Checks that the constants are in range.
    ///
    /// # Errors
    /// A constant is out of range, the energy of a saturated layer is not positive, or the tensile strength is above
    /// τ_s/k_s; the error names the constant.
    pub fn check(self) -> Result<Self, InputError> {
        match &self {
            Self::Elastic(elastic) => elastic.check()?,
            Self::Plastic(elastic, plastic) => {
                elastic.check()?;
                plastic.check()?;
            }
            Self::Viscous(elastic, viscous) => {
                elastic.check()?;
                viscous.check()?;
            }
            Self::Porous(elastic, pores, tangential) => {
                elastic.check()?;
                pores.check()?;
                tangential.check()?;
            }
            Self::Saturated(saturated) => saturated.check()?,
            Self::Cracked(elastic, friction) => {
                elastic.check()?;
                if let Some(friction) = friction {
                    CONTACT_FRICTION.check(*friction, "the friction must be k_s ≥ 0")?;
                }
            }
            Self::Breaking(elastic, plastic, tensile_strength) => {
                elastic.check()?;
                plastic.check()?;
                check_tensile_strength(*tensile_strength, plastic)?;
            }
        }
        Ok(self)
    }

    /// Thickness δ, m.
    pub fn thickness(&self) -> f64 {
        self.elastic().map_or_else(|saturated| saturated.thickness, |elastic| elastic.thickness)
    }

    /// Masses per area of the normal and the tangential component, kg/m²; the fluid of a saturated layer moves with the
    /// normal component only.
    pub fn masses(&self) -> [f64; 2] {
        let masses = |saturated: &SaturatedMaterial| {
            let [skeleton, fluid, added] =
                [saturated.skeleton_density, saturated.fluid_density, saturated.added_density];
            [skeleton + fluid, skeleton + fluid * added / (fluid + added)]
                .map(|density| density * saturated.thickness)
        };
        self.elastic().map_or_else(masses, |elastic| [elastic.mass(); 2])
    }

    /// Stiffnesses K of the normal and the tangential component for small instantaneous deformation, Pa/m: of open
    /// pores, of an undrained layer, of a closed crack.
    pub fn stiffnesses(&self) -> [f64; 2] {
        self.elastic().map_or_else(
            |saturated| {
                [saturated.undrained_stiffness, 1.0 / saturated.instantaneous_compliance]
                    .map(|modulus| modulus / saturated.thickness)
            },
            |elastic| [1.0 / elastic.normal_compliance(), 1.0 / elastic.tangential_compliance()],
        )
    }

    /// Returns the elastic constants; for a saturated layer its constants as the error.
    fn elastic(&self) -> Result<&ElasticMaterial, &SaturatedMaterial> {
        match self {
            Self::Elastic(elastic)
            | Self::Plastic(elastic, _)
            | Self::Viscous(elastic, _)
            | Self::Porous(elastic, ..)
            | Self::Cracked(elastic, _)
            | Self::Breaking(elastic, ..) => Ok(elastic),
            Self::Saturated(saturated) => Err(saturated),
        }
    }
}

/// Checks 0 ≤ σ_t ≤ τ_s/k_s: the layer breaks before it reaches the apex of its yield cone.
fn check_tensile_strength(strength: f64, plastic: &PlasticConstants) -> Result<(), InputError> {
    TENSILE_STRENGTH.check(strength, "the tensile strength must be σ_t ≥ 0, in Pa")?;
    ensure(
        strength * plastic.friction <= plastic.shear_strength * (1.0 + 4.0 * f64::EPSILON),
        TENSILE_STRENGTH.name,
        strength,
        format_args!(
            "the tensile strength must be at most τ_s/k_s = {}, in Pa",
            ShortNumber(plastic.shear_strength / plastic.friction)
        ),
    )
}
