//! Bloch waves of a periodic blocky medium, beside its equivalent Cosserat continuum.

use super::{ProgressCallback, report_progress};
use crate::Error;
use crate::case::{Case, PeriodicBlocks};
use crate::setup::blocky::BlochProblem;
use analysis::bloch::BlochError;
use analysis::bloch::bands::{BandSolver, PathPoint, WavesAt, follow_branches, sample_path};
use analysis::bloch::cell::{CellModel, DegreeControl, Joint};
use analysis::bloch::chain::ChainPolarisation;
use analysis::bloch::continuum::continuum_frequencies;
use analysis::bloch::zone::ZonePoint;
use models::InputError;
use models::common::elementary::Elementary;
use models::interface::homogenised::HomogenisedConstants;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;

/// Number of branches per block of the cell.
const BRANCHES_PER_BLOCK: usize = 8;
/// Steps on each side of the path.
const SAMPLES_PER_SIDE: usize = 20;
/// Wave vectors along half of each axis of the zone, for the band gaps, and the largest degree there.
const GAP_SAMPLES: usize = 6;
const GAP_DEGREE: usize = 6;
/// Requested relative accuracy of frequencies, and the largest numbers of unknowns, without and with viscosity.
const TOLERANCE: f64 = 1e-3;
const MAX_UNKNOWNS: usize = 200;
const MAX_DAMPED_UNKNOWNS: usize = 100;
/// Directions of long waves, degrees.
const DIRECTIONS_DEG: [f64; 3] = [0.0, 22.5, 45.0];
/// Points between two progress reports.
const CHUNK: usize = 8;

/// Band structure of a blocky medium.
#[derive(Clone, Debug, Serialize)]
pub struct BlochResult {
    /// `blocky`.
    pub model: &'static str,
    /// Blocks.
    pub blocks: BlockSummary,
    /// Joints normal to x₁ and to x₂.
    pub joints: [JointSummary; 2],
    /// Name of the verdict.
    pub verdict: &'static str,
    /// Whether no wave grows.
    #[serde(rename = "stable")]
    pub is_stable: bool,
    /// Supremum of Re ς over the computed wave vectors, 1/s; 0 for stable media.
    #[serde(rename = "bound")]
    pub growth_bound: f64,
    /// Evidence of the verdict.
    pub evidence: BlochEvidence,
    /// Vertices of the path in the Brillouin zone.
    pub path: Vec<PathVertex>,
    /// Total band gaps among the computed branches: lower and upper frequency, rad/s; `None` with viscosity.
    #[serde(rename = "forbidden_bands")]
    pub band_gaps: Option<Vec<[f64; 2]>>,
    /// Speeds of long waves by direction.
    pub long_waves: Vec<LongWave>,
    /// Degree of the polynomials in each block.
    pub degree: usize,
    /// Estimate of the largest relative error of a frequency at the vertices of the path; infinite (null in JSON) if the
    /// cell is too large for an estimate.
    #[serde(rename = "accuracy")]
    pub achieved_accuracy: f64,
    /// Ratio K_t h/μ of joint and block stiffness; `None` without continuum.
    pub stiffness_ratio: Option<f64>,
    /// Reason why there is no equivalent continuum; `None` if there is one.
    #[serde(rename = "no_continuum")]
    pub missing_continuum: Option<String>,
    /// Constants of the continuum.
    #[serde(skip)]
    pub continuum: Option<HomogenisedConstants>,
    /// Points of the path.
    #[serde(skip)]
    pub points: Vec<PathPoint>,
    /// Waves at these points.
    #[serde(skip)]
    pub waves: Vec<WavesAt>,
    /// Frequencies of the continuum at these points, rad/s, three each; empty without continuum.
    #[serde(skip)]
    pub continuum_frequencies: Vec<Vec<f64>>,
    /// Frequencies of chains along x₁ on the first side of the path.
    #[serde(skip)]
    pub chains: Vec<ChainCurve>,
}

/// Blocks of a medium.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlockSummary {
    /// Density, kg/m³.
    pub density: f64,
    /// Longitudinal wave speed, m/s.
    pub longitudinal_speed: f64,
    /// Shear wave speed, m/s.
    pub shear_speed: f64,
    /// Sides, m.
    pub size: [f64; 2],
    /// Shift of every second row, m.
    pub row_shift: f64,
    /// Whether the blocks have a yield set; waves are elastic.
    #[serde(rename = "yields")]
    pub can_yield: bool,
}

/// Joints normal to an axis; normal and tangential component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointSummary {
    /// Kind of layer.
    pub kind: &'static str,
    /// Masses per area, kg/m².
    pub mass: [f64; 2],
    /// Stiffnesses for fast loads, Pa/m.
    pub stiffness: [f64; 2],
    /// Retardation time of viscous shear, s.
    pub retardation_time: Option<f64>,
    /// State about which the law is linearised; `None` for elastic layers.
    pub linearisation: Option<&'static str>,
}

/// Evidence that all frequencies are real or damped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlochEvidence {
    /// Number of wave vectors on the path.
    pub wave_vectors: usize,
    /// Least ω² over all waves of the discretisation at these wave vectors, rad²/s²; `None` with viscosity.
    pub least_squared_frequency: Option<f64>,
    /// Largest growth rate of a mode, those within rounding included, 1/s.
    pub largest_growth: f64,
    /// Bound on its rounding, 1/s.
    pub growth_rounding: f64,
    /// Whether the stored energy is positive: all stiffnesses of joints are at least zero.
    #[serde(rename = "energy_is_positive")]
    pub has_positive_energy: bool,
}

/// Vertex of the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathVertex {
    /// Name.
    pub name: &'static str,
    /// Distance along the path, 1/m.
    pub distance: f64,
    /// Wave vector, 1/m.
    pub wave_vector: [f64; 2],
}

/// Speeds of the two long waves in a direction, m/s, the slower first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LongWave {
    /// Direction from x₁, degrees.
    pub direction_deg: f64,
    /// Speeds in the medium; with viscosity those of slow waves.
    pub medium: [f64; 2],
    /// Speeds in the continuum.
    pub continuum: Option<[f64; 2]>,
    /// Speeds in the continuum relative to those in the medium, minus 1.
    pub difference: Option<[f64; 2]>,
}

/// Branches of a chain along x₁.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainCurve {
    /// `P` or `S`.
    pub name: &'static str,
    /// Curves of the branches: distance along the path, 1/m, and frequency, rad/s.
    pub curves: Vec<Vec<[f64; 2]>>,
}

/// Computes the Bloch waves of the blocky medium of a case. Progress counts wave vectors.
///
/// # Errors
/// The case is not a periodic blocky medium, or an iteration for eigenvalues does not converge; [`Error::Cancelled`].
///
/// # Examples
/// ```no_run
/// use wellposed::study::ignore_progress;
///
/// let case = wellposed::load("cases/blocky/pulse-breaking.toml", wellposed::NO_SETTINGS)?;
/// let found = wellposed::study::compute_bloch_waves(&case, &ignore_progress)?;
/// assert!(found.is_stable);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn compute_bloch_waves(
    case: &Case,
    on_progress: ProgressCallback,
) -> Result<BlochResult, Error> {
    let problem = BlochProblem::new(case)?;
    let located = |error: BlochError| -> Error {
        let error = match error {
            BlochError::Input(error) => error,
            other => InputError {
                input: "model",
                rejected_value: format!("numbers whose Bloch waves cannot be computed: {other}"),
                allowed_values: "moduli, densities and lengths of ordinary size".into(),
            },
        };
        case.locate_error(error).into()
    };
    let path = problem.cell.standard_path();
    let (points, distances) = sample_path(&path, SAMPLES_PER_SIDE).map_err(located)?;
    report_progress(on_progress, 0, points.len())?;
    let (count, control) = resolution(&problem);
    let solver = BandSolver::new(&problem.cell, &path, count, &control).map_err(located)?;
    let mut waves = Vec::with_capacity(points.len());
    for chunk in points.chunks(CHUNK) {
        let solved: Result<Vec<WavesAt>, BlochError> =
            chunk.par_iter().map(|point| solver.solve(point.wave_vector)).collect();
        waves.extend(solved.map_err(located)?);
        report_progress(on_progress, waves.len(), points.len())?;
    }
    let is_viscous = problem.cell.is_viscous();
    if is_viscous {
        follow_branches(&points, &distances, &mut waves);
    }
    let band_gaps = match is_viscous {
        true => None,
        false => {
            let model = CellModel::new(&problem.cell, solver.degree().min(GAP_DEGREE));
            let gaps = model.total_gaps(count, GAP_SAMPLES).map_err(located)?;
            Some(gaps.iter().map(|gap| [gap.lower.0, gap.upper.0]).collect())
        }
    };
    let evidence = collect_evidence(&problem, &waves);
    let is_stable = waves.iter().all(WavesAt::is_stable);
    let continuum = problem.continuum.as_ref().ok().copied();
    let largest = largest_frequency(&waves);
    Ok(BlochResult {
        model: "blocky",
        blocks: BlockSummary::from(&problem.blocks),
        joints: [0, 1].map(|axis| summarise_joint(&problem, axis)),
        // Blocks are symmetric-hyperbolic, and joints couple velocities and tractions locally: growth is bounded.
        verdict: "well-posed",
        is_stable,
        growth_bound: if is_stable { 0.0 } else { evidence.largest_growth },
        evidence,
        long_waves: compute_long_waves(&problem, solver.degree()).map_err(located)?,
        degree: solver.degree(),
        achieved_accuracy: solver.achieved,
        band_gaps,
        stiffness_ratio: continuum.map(|own| own.stiffness_ratio),
        missing_continuum: problem.continuum.as_ref().err().cloned(),
        continuum_frequencies: match &continuum {
            Some(own) => points
                .iter()
                .map(|point| continuum_frequencies(&own.solid, point.wave_vector))
                .collect(),
            None => Vec::new(),
        },
        chains: compute_chains(&problem, &points, largest),
        path: path.iter().zip(distances).map(PathVertex::from).collect(),
        continuum,
        points,
        waves,
    })
}

/// Number of branches and control of the degree.
fn resolution(problem: &BlochProblem) -> (usize, DegreeControl) {
    let rows = problem.cell.rows().len();
    let unknowns = if problem.cell.is_viscous() { MAX_DAMPED_UNKNOWNS } else { MAX_UNKNOWNS };
    let fits = |degree: &usize| 2 * (degree + 1) * (degree + 1) * rows <= unknowns;
    let largest = (2..=10).step_by(2).filter(fits).last().unwrap_or(2);
    // The accuracy is estimated from three degrees.
    let first = largest.saturating_sub(4).max(2);
    let control = DegreeControl { tolerance: TOLERANCE, first, largest };
    (BRANCHES_PER_BLOCK * rows, control)
}

fn collect_evidence(problem: &BlochProblem, waves: &[WavesAt]) -> BlochEvidence {
    let stiffnesses = problem
        .joints
        .iter()
        .flat_map(|joint| [joint.normal.stiffness, joint.tangential.stiffness]);
    let least = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min);
    let largest = |value: fn(&WavesAt) -> f64| waves.iter().map(value).fold(0.0, f64::max);
    BlochEvidence {
        wave_vectors: waves.len(),
        least_squared_frequency: least(&mut waves.iter().filter_map(|at| at.least_square)),
        largest_growth: largest(|at| at.largest_growth),
        growth_rounding: largest(|at| at.growth_rounding),
        has_positive_energy: stiffnesses.into_iter().all(|stiffness| stiffness >= 0.0),
    }
}

fn summarise_joint(problem: &BlochProblem, axis: usize) -> JointSummary {
    let (law, joint) = (&problem.blocks.joints[axis], &problem.joints[axis]);
    JointSummary {
        kind: law.kind.name,
        mass: [joint.normal.mass.mass, joint.tangential.mass.mass],
        stiffness: [joint.normal.stiffness, joint.tangential.stiffness],
        retardation_time: joint.tangential.delay.map(|delay| delay.retardation_time),
        linearisation: law.material.linearisation_note(),
    }
}

fn compute_long_waves(problem: &BlochProblem, degree: usize) -> Result<Vec<LongWave>, BlochError> {
    let slow = problem.cell.map_joints(Joint::relaxed);
    let along = |&direction_deg: &f64| {
        let (sin, cos) = direction_deg.to_radians().cr_sin_cos();
        let medium = slow.long_wave_speeds([cos, sin], degree)?.speeds;
        let continuum = problem.continuum.as_ref().ok().map(|own| own.long_wave_speeds([cos, sin]));
        let difference = continuum.map(|own| [0, 1].map(|wave| own[wave] / medium[wave] - 1.0));
        Ok(LongWave { direction_deg, medium, continuum, difference })
    };
    DIRECTIONS_DEG.par_iter().map(along).collect()
}

fn largest_frequency(waves: &[WavesAt]) -> f64 {
    let all = waves.iter().flat_map(|at| &at.waves).map(|wave| wave.frequency);
    all.fold(0.0, f64::max)
}

/// Branches of the chains along x₁ on the side of the path from Γ to X, up to a frequency.
fn compute_chains(problem: &BlochProblem, points: &[PathPoint], largest: f64) -> Vec<ChainCurve> {
    let period = problem.blocks.size[0];
    let side: Vec<&PathPoint> =
        points.iter().take_while(|point| point.wave_vector[1] == 0.0).collect();
    let kinds = [("P", ChainPolarisation::Longitudinal), ("S", ChainPolarisation::Transverse)];
    let curves = |(name, polarisation)| {
        let chain = problem.chain(polarisation)?;
        let mut curves: Vec<Vec<[f64; 2]>> = Vec::new();
        for point in &side {
            let shift = (point.wave_vector[0] * period).min(PI);
            let own = chain.frequencies_below(shift, largest).unwrap_or_default();
            curves.resize(curves.len().max(own.len()), Vec::new());
            for (curve, frequency) in curves.iter_mut().zip(own) {
                curve.push([point.distance, frequency]);
            }
        }
        Some(ChainCurve { name, curves })
    };
    kinds.into_iter().filter_map(curves).collect()
}

impl From<&PeriodicBlocks> for BlockSummary {
    fn from(own: &PeriodicBlocks) -> Self {
        Self {
            density: own.material.density,
            longitudinal_speed: own.material.longitudinal_speed,
            shear_speed: own.material.shear_speed,
            size: own.size,
            row_shift: own.row_shift,
            can_yield: own.has_yielding_blocks,
        }
    }
}

impl From<(&ZonePoint, f64)> for PathVertex {
    fn from((point, distance): (&ZonePoint, f64)) -> Self {
        Self { name: point.name, distance, wave_vector: point.wave_vector }
    }
}
