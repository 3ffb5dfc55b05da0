//! Verdict on equations in three space dimensions: exact analysis of waves in planes, and a search over the planes.
//!
//! In each plane of wave vectors the analysis is that of two dimensions: exact in the direction inside the plane,
//! layers included. Planes are taken through the axes x₃ and x₁, at steps of [`PLANE_STEP_DEG`]; every wave vector lies
//! within half a step of one of them. Around the plane of fastest growth the angle is refined by golden-section search.
//! Where the planes cross curves on which a leading coefficient vanishes, up to [`MAX_CURVE_POINTS`] of the crossings are
//! assessed in the planes normal to the curve too, since a plane that touches a curve resolves its layer badly. If no
//! plane shows growth, waves beside these points are searched by brute force to k = 1e8 in the scaled unit; growth found
//! there alone leaves the verdict open: marginal.

use crate::AnalysisError;
use crate::bound::{self, Supremum};
use crate::brute_force::{self, sample_growth_order};
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

/// Largest number of points on curves of vanishing coefficients at which the plane normal to the curve is assessed.
pub const MAX_CURVE_POINTS: usize = 64;

/// Angle to the neighbouring plane by which the tangent of a curve is found, rad.
const TANGENT_STEP: f64 = 1e-3;

/// Planes and, in each, directions and wave numbers at which the search of the supremum starts.
const SUPREMUM_SAMPLES: [usize; 3] = [12, 8, 16];

/// Number of planes in which the supremum is searched one after another.
const SUPREMUM_PLANES: usize = 4;

/// Angles from the direction found, rad, at which growth is sampled before the normal plane is searched.
const NEIGHBOUR_ANGLES: [f64; 4] = [-0.1, -0.01, 0.01, 0.1];

/// Unit vectors that span a plane of wave vectors.
type Plane = [[f64; 3]; 2];

/// Verdict in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceAssessment {
    /// Assessment of the plane that decides: that of the fastest growth, else one that is undecided, else any. Its
    /// direction is the angle inside this plane.
    pub assessment: Assessment,
    /// Unit vectors that span this plane.
    pub plane: Plane,
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
fn span_plane(family: usize, angle: f64) -> Plane {
    let (sin, cos) = angle.cr_sin_cos();
    match family {
        0 => [[cos, sin, 0.0], [0.0, 0.0, 1.0]],
        _ => [[0.0, cos, sin], [1.0, 0.0, 0.0]],
    }
}

/// Unit vector at the angle `angle` from the first of the unit vectors `plane`.
pub fn direction_in_plane(plane: &Plane, angle: f64) -> [f64; 3] {
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
    let mut curve_points: Vec<CurvePoint> = Vec::new();
    for family in 0..2 {
        for index in 0..PLANE_COUNT {
            let angle = PI * index as f64 / PLANE_COUNT as f64;
            let plane = span_plane(family, angle);
            let found = assess_plane(system, &plane, workspace)?;
            let rank = Rank::new(&found.verdict);
            let is_singular = matches!(found.verdict, Verdict::Indeterminate { .. });
            curve_points.extend(found.degenerate_directions.iter().map(|own| CurvePoint {
                direction: direction_in_plane(&plane, own.angle),
                family,
                angle,
            }));
            if best.as_ref().is_none_or(|own| rank.is_above(&own.0)) {
                best = Some((rank, family, angle, found));
            }
            // A system whose numbers of equations and unknowns differ is singular in every plane.
            if is_singular && system.equations.len() != system.unknowns.len() {
                break;
            }
        }
    }
    let Some((mut rank, family, angle, mut assessment)) = best else {
        return Err(AnalysisError::TooLarge(0));
    };
    let mut plane = span_plane(family, angle);
    if let Rank::Growth { order, coefficient } = rank {
        let step = PI / PLANE_COUNT as f64;
        let rate = |at: f64| {
            let mut own = SpaceWorkspace::default();
            let found = assess_plane(system, &span_plane(family, at), &mut own);
            match found.map(|own| Rank::new(&own.verdict)) {
                Ok(Rank::Growth { order: found, coefficient }) if found == order => coefficient,
                _ => 0.0,
            }
        };
        let refined = span_plane(family, locate_maximum(rate, angle - step, angle + step));
        let found = assess_plane(system, &refined, workspace)?;
        let own = Rank::new(&found.verdict);
        if matches!(own, Rank::Growth { order: found, coefficient: c } if found == order && c > coefficient)
        {
            (rank, plane, assessment) = (own, refined, found);
        }
    }
    // Evenly spaced crossings: each plane meets a curve in few points.
    let skipped = curve_points.len().div_ceil(MAX_CURVE_POINTS).max(1);
    let mut sampled: Option<(f64, Plane)> = None;
    for point in curve_points.iter().step_by(skipped) {
        let Some(normal) = point.normal_plane(system, workspace)? else { continue };
        let found = assess_plane(system, &normal, workspace)?;
        let own = Rank::new(&found.verdict);
        if own.is_above(&rank) {
            (rank, plane, assessment) = (own, normal, found);
        }
        if rank == Rank::WellPosed {
            let order = sample_growth_order(&workspace.pencil, 0.0);
            if order > sampled.map_or(0.0, |(largest, _)| largest) {
                sampled = Some((order, normal));
            }
        }
    }
    if let Some((order, normal)) = sampled.filter(|_| rank == Rank::WellPosed) {
        plane = normal;
        assessment.verdict = Verdict::Marginal {
            quantity:
                "order of growth beside a curve of vanishing coefficients, by brute force only"
                    .to_owned(),
            value: order,
            rounding: brute_force::LEAST_ORDER,
        };
    }
    // Leave the pencil of the plane that decides in the workspace.
    assess_plane(system, &plane, workspace)?;
    let direction = match (&rank, &assessment.verdict) {
        (Rank::Growth { .. } | Rank::Unbounded, Verdict::IllPosed { direction, .. }) => {
            Some(to_upper_half(direction_in_plane(&plane, *direction)))
        }
        _ => None,
    };
    Ok(SpaceAssessment { assessment, plane, direction })
}

/// A point at which a plane of one of both families crosses a curve on which a leading coefficient vanishes.
struct CurvePoint {
    direction: [f64; 3],
    family: usize,
    /// Angle of the plane.
    angle: f64,
}

impl CurvePoint {
    /// The plane through the point normal to the curve, whose tangent is that to the crossing of a neighbouring plane;
    /// `None` if there is no curve, but a point, or the plane lies in the curve.
    fn normal_plane(
        &self,
        system: &LinearisedSystem<3>,
        workspace: &mut SpaceWorkspace,
    ) -> Result<Option<Plane>, AnalysisError> {
        let beside = span_plane(self.family, self.angle + TANGENT_STEP);
        let found = assess_plane(system, &beside, workspace)?;
        let nearest = found
            .degenerate_directions
            .iter()
            .flat_map(|own| {
                let other = direction_in_plane(&beside, own.angle);
                [other, other.map(|x| -x)]
            })
            .map(|other| subtract(other, self.direction))
            .min_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)));
        let Some(tangent) = nearest else { return Ok(None) };
        let length = dot(tangent, tangent).sqrt();
        // Farther crossings are those of another curve; a point shared by the planes lies on their axis.
        if !(1e-3 * TANGENT_STEP..=30.0 * TANGENT_STEP).contains(&length) {
            return Ok(None);
        }
        Ok(span_with(self.direction, cross(self.direction, tangent)))
    }
}

/// The plane of the unit vector `direction` and of another vector; `None` if both are parallel.
fn span_with(direction: [f64; 3], other: [f64; 3]) -> Option<Plane> {
    let along = dot(direction, other);
    let normal = subtract(other, direction.map(|x| along * x));
    let length = dot(normal, normal).sqrt();
    (length > 1e-9 * dot(other, other).sqrt()).then(|| [direction, normal.map(|x| x / length)])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Supremum of Re ς over all waves of a well-posed system in space, and the unit wave vector at which it is attained or
/// approached; `None` for other verdicts. The search starts from samples over directions and wave numbers and from the
/// plane of `assessment`, and continues in planes through the best direction found, each normal to the one before.
///
/// # Errors
/// See [`AnalysisError`].
pub fn locate_supremum(
    system: &LinearisedSystem<3>,
    assessment: &SpaceAssessment,
) -> Result<Option<(Supremum, [f64; 3])>, AnalysisError> {
    if assessment.assessment.verdict != Verdict::WellPosed {
        return Ok(None);
    }
    let mut workspace = SpaceWorkspace::default();
    let mut best: Option<(Supremum, [f64; 3])> = None;
    let mut search = |plane: &Plane, best: &mut Option<(Supremum, [f64; 3])>| {
        let found = assess_plane(system, plane, &mut workspace)?;
        if let Some(supremum) = bound::locate_supremum(&workspace.pencil, &found, 0.0)
            && best.is_none_or(|(own, _)| supremum.growth_rate > own.growth_rate)
        {
            *best = Some((supremum, direction_in_plane(plane, supremum.direction)));
        }
        Ok::<(), AnalysisError>(())
    };
    search(&assessment.plane, &mut best)?;
    let mut plane = assessment.plane;
    let mut samples = SpaceWorkspace::default();
    let mut sample = |plane: &Plane, angle: f64| {
        system.restrict_to_plane(plane, &mut samples.plane_system);
        samples.pencil.update(&samples.plane_system)?;
        Ok::<f64, AnalysisError>(bound::sample_growth(&samples.pencil, angle, SUPREMUM_SAMPLES[2]))
    };
    let fastest = sample_fastest_direction(system)?;
    let known = match best {
        Some((supremum, _)) => sample(&plane, supremum.direction)?,
        None => f64::NEG_INFINITY,
    };
    if let Some((_, sampled)) = fastest.filter(|(rate, _)| is_faster(*rate, known)) {
        // A plane through the sample and any axis that is not parallel to it.
        plane = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
            .into_iter()
            .find_map(|axis| span_with(sampled, axis))
            .unwrap_or(plane);
        search(&plane, &mut best)?;
    }
    for _ in 1..SUPREMUM_PLANES {
        let Some((before, direction)) = best else { break };
        plane = span_with(direction, cross(plane[0], plane[1])).unwrap_or(plane);
        // The search costs as much as thousands of samples: only where growth rises beside the direction.
        let here = sample(&plane, 0.0)?;
        let mut rises = false;
        for angle in NEIGHBOUR_ANGLES {
            rises |= is_faster(sample(&plane, angle)?, here);
        }
        if !rises {
            break;
        }
        search(&plane, &mut best)?;
        // A maximum in two planes normal to each other is one over directions.
        if best.is_none_or(|(own, _)| own.growth_rate <= before.growth_rate) {
            break;
        }
    }
    Ok(best.map(|(supremum, direction)| (supremum, to_upper_half(direction))))
}

/// Whether a sampled growth rate exceeds another one by more than the rounding of multiple roots.
fn is_faster(rate: f64, other: f64) -> bool {
    rate > other + 1e-6 * other.abs()
}

/// Largest Re ς among samples over directions and wave numbers, and its direction.
fn sample_fastest_direction(
    system: &LinearisedSystem<3>,
) -> Result<Option<(f64, [f64; 3])>, AnalysisError> {
    let [planes, directions, wave_numbers] = SUPREMUM_SAMPLES;
    let mut workspace = SpaceWorkspace::default();
    let mut best: Option<(f64, [f64; 3])> = None;
    for index in 0..planes {
        let plane = span_plane(0, PI * (index as f64 + 0.5) / planes as f64);
        system.restrict_to_plane(&plane, &mut workspace.plane_system);
        workspace.pencil.update(&workspace.plane_system)?;
        for own in 0..directions {
            let angle = PI * (own as f64 + 0.5) / directions as f64;
            let rate = bound::sample_growth(&workspace.pencil, angle, wave_numbers);
            if best.is_none_or(|(largest, _)| rate > largest) {
                best = Some((rate, direction_in_plane(&plane, angle)));
            }
        }
    }
    Ok(best)
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
    plane: &Plane,
    workspace: &mut SpaceWorkspace,
) -> Result<Assessment, AnalysisError> {
    system.restrict_to_plane(plane, &mut workspace.plane_system);
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
