//! Equivalent Cosserat continuum of a blocky medium: constants with their validity, and the case of the continuum.

use crate::Error;
use crate::case::{Case, ContinuumOptions, EquivalentContinuum};
use models::interface::homogenised::Constant;
use serde::Serialize;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Equivalent continuum of a case.
#[derive(Clone, Debug, Serialize)]
pub struct HomogeniseResult {
    /// Kind of the solid.
    pub model: &'static str,
    /// Yield set; `None` for elastic joints.
    #[serde(rename = "yield")]
    pub yield_set: Option<YieldConstants>,
    /// Constants.
    pub constants: Vec<ConstantRow>,
    /// Wave speeds, m/s.
    pub speeds: ContinuumSpeeds,
    /// Natural frequency of the rotation of blocks f* = ω*/2π, Hz: leading order.
    pub natural_frequency_hz: f64,
    /// Ratio K_t h/μ of joint and block stiffness.
    pub stiffness_ratio: f64,
    /// Whether the ratio is small, so that constants of leading order are quantitative.
    #[serde(rename = "blocks_are_rigid")]
    pub has_rigid_blocks: bool,
    /// Side of a block, m.
    pub block_size: f64,
    /// Cells of the grid of the continuum.
    pub cells: Vec<usize>,
    /// What the continuum does not represent, or represents differently.
    pub notes: Vec<String>,
    /// Path of the written case; `None` before it is written.
    #[serde(rename = "written")]
    pub written_path: Option<String>,
    /// The case of the continuum with its text.
    #[serde(skip)]
    pub continuum: EquivalentContinuum,
}

/// A constant of the continuum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ConstantRow {
    /// Name.
    pub name: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// `sure`, `leading order` or `not unique`.
    pub status: &'static str,
    /// Meaning of the status.
    pub meaning: &'static str,
}

/// Constants of the interlayer yield set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct YieldConstants {
    /// Shear strength τ₀ = τ_s, Pa.
    pub shear_strength: f64,
    /// Friction κ_τ = k_s.
    pub shear_friction: f64,
    /// Couple strength μ₀ = κ_μσ_t, N/m.
    pub couple_strength: f64,
    /// Couple friction κ_μ, m.
    pub couple_friction: f64,
    /// Meaning of κ_μ.
    pub couple_limit: &'static str,
}

/// Speeds of plane waves in the continuum, m/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContinuumSpeeds {
    /// Long P wave along an axis: sure.
    pub longitudinal: f64,
    /// Long S wave along an axis: sure.
    pub long_shear: f64,
    /// Short S wave along an axis: leading order.
    pub short_shear: f64,
    /// Long S and P wave along a diagonal: sure.
    pub diagonal: [f64; 2],
}

/// Computes the equivalent continuum of the blocky medium of a case; writes nothing.
///
/// # Errors
/// The case has no equivalent continuum (see [`Case::to_equivalent_continuum`]).
///
/// # Examples
/// ```no_run
/// use wellposed::case::ContinuumOptions;
///
/// let case = wellposed::load("cases/blocky/pulse-breaking.toml", wellposed::NO_SETTINGS)?;
/// let found = wellposed::study::homogenise(&case, &ContinuumOptions::default())?;
/// println!("{}", found.continuum.toml);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn homogenise(case: &Case, options: &ContinuumOptions) -> Result<HomogeniseResult, Error> {
    let continuum = case.to_equivalent_continuum(options)?;
    let constants = &continuum.constants;
    let row = |constant: Constant| ConstantRow {
        name: constant.name(),
        symbol: constant.symbol(),
        value: constants.value(constant),
        unit: constant.unit(),
        status: constant.validity().name(),
        meaning: constant.validity().description(),
    };
    let yield_set = continuum.yield_set.and_then(|set| {
        let couple = set.couple?;
        Some(YieldConstants {
            shear_strength: set.shear_strength,
            shear_friction: set.shear_friction,
            couple_strength: couple.strength,
            couple_friction: couple.friction,
            couple_limit: options.opening_limit.description(),
        })
    });
    Ok(HomogeniseResult {
        model: continuum.case.material.kind.name(),
        yield_set,
        constants: Constant::ALL.map(row).to_vec(),
        speeds: ContinuumSpeeds {
            longitudinal: constants.longitudinal_speed(),
            long_shear: constants.long_shear_speed(),
            short_shear: constants.short_shear_speed(),
            diagonal: constants.long_wave_speeds([FRAC_1_SQRT_2; 2]),
        },
        natural_frequency_hz: constants.natural_frequency / TAU,
        stiffness_ratio: constants.stiffness_ratio,
        has_rigid_blocks: constants.has_rigid_blocks(),
        block_size: continuum.blocks.medium.period,
        cells: continuum.case.solid_run.as_ref().map_or(Vec::new(), |run| run.grid.cells.clone()),
        notes: continuum.notes.clone(),
        written_path: None,
        continuum,
    })
}
