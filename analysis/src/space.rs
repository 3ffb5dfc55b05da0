//! Verdict on equations in three space dimensions: exact analysis of waves in planes, and a search over the planes.
//!
//! In each plane of wave vectors the analysis is that of two dimensions: exact in the direction inside the plane,
//! layers included. Planes are taken through the axes x₃ and x₁, at steps of [`PLANE_STEP_DEG`]; every wave vector lies
//! within half a step of one of them. Around the plane of fastest growth the angle is refined by golden-section search.

use crate::AnalysisError;
use crate::growth::{self, Assessment, Verdict};
use crate::line_search::search_golden_section;
use crate::newton_polygon::GrowthOrder;
use crate::pencil::Pencil;
use models::LinearisedSystem;
use models::common::elementary::Elementary;
use std::f64::consts::PI;

/// Number of planes through each of the two axes.
const PLANE_COUNT: usize = 24;

/// Angle between neighbouring planes, degrees.
pub const PLANE_STEP_DEG: f64 = 180.0 / PLANE_COUNT as f64;

/// Verdict in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceAssessment {
    /// Assessment of the plane that decides: that of the fastest growth, else one that is undecided, else any. Its
    /// direction is the angle inside this plane.
    pub assessment: Assessment,
    /// Unit vectors that span this plane.
    pub plane: [[f64; 3]; 2],
    /// Unit wave vector of the fastest growth; `None` unless ill-posed.
    pub direction: Option<[f64; 3]>,
}

/// Reusable memory of [`assess_space`]; after a call the pencil of the plane that decides.
#[derive(Clone, Debug, Default)]
pub struct SpaceWorkspace {
    plane_system: LinearisedSystem<2>,
    /// Pencil of waves in the plane that decides.
    pub pencil: Pencil,
}

/// Plane of wave vectors at the angle `angle` around the axis x₃ (`family` 0) or x₁ (`family` 1).
fn span_plane(family: usize, angle: f64) -> [[f64; 3]; 2] {
    let (sin, cos) = angle.cr_sin_cos();
    match family {
        0 => [[cos, sin, 0.0], [0.0, 0.0, 1.0]],
        _ => [[0.0, cos, sin], [1.0, 0.0, 0.0]],
    }
}

/// Unit vector at the angle `angle` from the first of the unit vectors `plane`.
pub fn direction_in_plane(plane: &[[f64; 3]; 2], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.cr_sin_cos();
    std::array::from_fn(|i| cos * plane[0][i] + sin * plane[1][i])
}

/// Assesses a linearised system over all directions in space.
///
/// # Errors
/// See [`AnalysisError`].
pub fn assess_space(
    system: &LinearisedSystem<3>,
    workspace: &mut SpaceWorkspace,
) -> Result<SpaceAssessment, AnalysisError> {
    let mut best: Option<(Rank, usize, f64, Assessment)> = None;
    for family in 0..2 {
        for index in 0..PLANE_COUNT {
            let angle = PI * index as f64 / PLANE_COUNT as f64;
            let found = assess_plane(system, family, angle, workspace)?;
            let rank = Rank::new(&found.verdict);
            let is_singular = matches!(found.verdict, Verdict::Indeterminate { .. });
            if best.as_ref().is_none_or(|own| rank.is_above(&own.0)) {
                best = Some((rank, family, angle, found));
            }
            // A system whose numbers of equations and unknowns differ is singular in every plane.
            if is_singular && system.equations.len() != system.unknowns.len() {
                break;
            }
        }
    }
    let Some((mut rank, family, mut angle, mut assessment)) = best else {
        return Err(AnalysisError::TooLarge(0));
    };
    if let Rank::Growth { order, coefficient } = rank {
        let step = PI / PLANE_COUNT as f64;
        let rate = |at: f64| {
            let mut own = SpaceWorkspace::default();
            match assess_plane(system, family, at, &mut own).map(|own| Rank::new(&own.verdict)) {
                Ok(Rank::Growth { order: found, coefficient }) if found == order => coefficient,
                _ => 0.0,
            }
        };
        let refined = locate_maximum(rate, angle - step, angle + step);
        let found = assess_plane(system, family, refined, workspace)?;
        let own = Rank::new(&found.verdict);
        if matches!(own, Rank::Growth { order: found, coefficient: c } if found == order && c > coefficient)
        {
            (rank, angle, assessment) = (own, refined, found);
        }
    }
    // Leave the pencil of the plane that decides in the workspace.
    assess_plane(system, family, angle, workspace)?;
    let plane = span_plane(family, angle);
    let direction = match (&rank, &assessment.verdict) {
        (Rank::Growth { .. } | Rank::Unbounded, Verdict::IllPosed { direction, .. }) => {
            Some(to_upper_half(direction_in_plane(&plane, *direction)))
        }
        _ => None,
    };
    Ok(SpaceAssessment { assessment, plane, direction })
}

/// Argument of the maximum of a function with one maximum, to 1e-7: enough for a coefficient to 1e-13.
fn locate_maximum(f: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    search_golden_section(f, [low, high], 34, None).midpoint()
}

/// The unit vector or its opposite whose last component that is not zero is positive.
fn to_upper_half(direction: [f64; 3]) -> [f64; 3] {
    let last = direction.iter().rev().find(|own| own.abs() > 1e-12).copied().unwrap_or(1.0);
    direction.map(|own| if last < 0.0 { -own } else { own } + 0.0)
}

fn assess_plane(
    system: &LinearisedSystem<3>,
    family: usize,
    angle: f64,
    workspace: &mut SpaceWorkspace,
) -> Result<Assessment, AnalysisError> {
    system.restrict_to_plane(&span_plane(family, angle), &mut workspace.plane_system);
    workspace.pencil.update(&workspace.plane_system)?;
    Ok(growth::assess(&workspace.pencil))
}

/// How much a verdict in one plane decides the verdict in space.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rank {
    WellPosed,
    Marginal,
    Growth { order: GrowthOrder, coefficient: f64 },
    Unbounded,
    Indeterminate,
}

impl Rank {
    fn new(verdict: &Verdict) -> Self {
        match verdict {
            Verdict::WellPosed => Self::WellPosed,
            Verdict::Marginal { .. } => Self::Marginal,
            Verdict::IllPosed { growth: Some(growth), .. } => {
                Self::Growth { order: growth.order, coefficient: growth.coefficient }
            }
            Verdict::IllPosed { growth: None, .. } => Self::Unbounded,
            Verdict::Indeterminate { .. } => Self::Indeterminate,
        }
    }

    fn is_above(&self, other: &Self) -> bool {
        let level = |own: &Self| match own {
            Self::WellPosed => 0,
            // A pencil that is singular in single planes only decides less than one that is not.
            Self::Indeterminate => 1,
            Self::Marginal => 2,
            Self::Growth { .. } => 3,
            Self::Unbounded => 4,
        };
        match (self, other) {
            (
                Self::Growth { order: a, coefficient: x },
                Self::Growth { order: b, coefficient: y },
            ) => (a, x) > (b, y),
            _ => level(self) > level(other),
        }
    }
}
