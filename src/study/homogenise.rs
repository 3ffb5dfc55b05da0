//! Equivalent Cosserat continuum of a blocky medium: its constants with their validity, and its case.

use crate::Error;
use crate::case::{Case, ContinuumOptions, EquivalentContinuum};
use models::interface::homogenised::EquivalentConstant;
use serde::Serialize;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Cosserat continuum that is equivalent to the blocky medium of a case.
#[derive(Clone, Debug, Serialize)]
pub struct HomogeniseResult {
    /// Kind of the equivalent solid, as named in case files.
    pub model: &'static str,
    /// Constants of the interlayer yield set; `None` for elastic joints.
    #[serde(rename = "yield")]
    pub yield_set: Option<YieldConstants>,
    /// Elastic constants and inertias of the continuum, with their validity.
    pub constants: Vec<ReportedConstant>,
    /// Speeds of plane waves in the continuum, m/s.
    #[serde(rename = "speeds")]
    pub wave_speeds: ContinuumSpeeds,
    /// Natural frequency of the rotation of blocks, f* = ω*/2π, Hz; of leading order in `stiffness_ratio`.
    pub natural_frequency_hz: f64,
    /// Ratio K_t h/μ of the tangential stiffness of the joints, K_t, times the block size h to the shear modulus μ of
    /// the blocks.
    pub stiffness_ratio: f64,
    /// Whether `stiffness_ratio` is so small that constants of leading order are quantitative.
    #[serde(rename = "blocks_are_rigid")]
    pub has_rigid_blocks: bool,
    /// Side length h of a block, m.
    pub block_size: f64,
    /// Number of cells of the grid of the continuum along each axis.
    #[serde(rename = "cells")]
    pub cell_counts: Vec<usize>,
    /// Notes on effects of the blocky medium that the continuum omits or represents differently.
    #[serde(rename = "notes")]
    pub differences_from_blocks: Vec<String>,
    /// Path of the written case; `None` before it is written.
    #[serde(rename = "written")]
    pub written_path: Option<String>,
    /// Case of the continuum, with its text as TOML.
    #[serde(skip)]
    pub continuum_case: EquivalentContinuum,
}

/// Constant of the equivalent continuum, as reported.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReportedConstant {
    /// Name of the constant.
    pub name: &'static str,
    /// Symbol of the constant.
    pub symbol: &'static str,
    /// Value of the constant in `unit`.
    pub value: f64,
    /// Unit of the constant.
    pub unit: &'static str,
    /// Validity of the value: `sure`, `leading order` or `not unique`.
    #[serde(rename = "status")]
    pub validity: &'static str,
    /// Explanation of what `validity` means.
    #[serde(rename = "meaning")]
    pub validity_description: &'static str,
}

/// Constants of the interlayer yield set, which limits shear stress and couple stress on planes parallel to the joints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct YieldConstants {
    /// Shear strength τ₀ = τ_s, Pa.
    pub shear_strength: f64,
    /// Coefficient of shear friction κ_τ = k_s.
    pub shear_friction: f64,
    /// Couple strength μ₀ = κ_μσ_t, N/m.
    pub couple_strength: f64,
    /// Couple friction κ_μ, the ratio of the limit of the couple stress to the normal stress, m.
    pub couple_friction: f64,
    /// State of the blocks that limits the couple stress and so determines κ_μ.
    #[serde(rename = "couple_limit")]
    pub couple_friction_meaning: &'static str,
}

/// Speeds of plane waves in the equivalent continuum, m/s; an axis is normal to a side of the blocks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContinuumSpeeds {
    /// Speed of long P waves along an axis, m/s; exact.
    #[serde(rename = "longitudinal")]
    pub longitudinal_speed: f64,
    /// Speed of long S waves along an axis, m/s; exact.
    #[serde(rename = "long_shear")]
    pub long_shear_speed: f64,
    /// Speed of short S waves along an axis, m/s; of leading order.
    #[serde(rename = "short_shear")]
    pub short_shear_speed: f64,
    /// Speeds of the long S and P waves along a diagonal, m/s; exact.
    #[serde(rename = "diagonal")]
    pub diagonal_speeds: [f64; 2],
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
/// println!("{}", found.continuum_case.toml);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn homogenise(case: &Case, options: &ContinuumOptions) -> Result<HomogeniseResult, Error> {
    let continuum = case.to_equivalent_continuum(options)?;
    let constants = &continuum.constants;
    let row = |constant: EquivalentConstant| ReportedConstant {
        name: constant.name(),
        symbol: constant.symbol(),
        value: constants.value(constant),
        unit: constant.unit(),
        validity: constant.validity().name(),
        validity_description: constant.validity().description(),
    };
    let yield_set = continuum.yield_set.and_then(|set| {
        let couple = set.couple?;
        Some(YieldConstants {
            shear_strength: set.shear_strength,
            shear_friction: set.shear_friction,
            couple_strength: couple.strength,
            couple_friction: couple.friction,
            couple_friction_meaning: options.opening_limit.description(),
        })
    });
    Ok(HomogeniseResult {
        model: continuum.case.material.kind.name(),
        yield_set,
        constants: EquivalentConstant::ALL.map(row).to_vec(),
        wave_speeds: ContinuumSpeeds {
            longitudinal_speed: constants.longitudinal_speed(),
            long_shear_speed: constants.long_shear_speed(),
            short_shear_speed: constants.short_shear_speed(),
            diagonal_speeds: constants.long_wave_speeds([FRAC_1_SQRT_2; 2]),
        },
        natural_frequency_hz: constants.natural_frequency / TAU,
        stiffness_ratio: constants.stiffness_ratio,
        has_rigid_blocks: constants.has_rigid_blocks(),
        block_size: continuum.blocks.medium.period,
        cell_counts: continuum
            .case
            .solid_run
            .as_ref()
            .map_or(Vec::new(), |run| run.grid.cells.clone()),
        differences_from_blocks: continuum.notes.clone(),
        written_path: None,
        continuum_case: continuum,
    })
}
