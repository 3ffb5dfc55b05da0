//! Bloch waves of a periodic blocky medium, compared with the waves of its equivalent Cosserat continuum.

use super::{ProgressCallback, report_progress};
use crate::Error;
use crate::case::{Case, PeriodicBlocks};
use crate::setup::blocky::BlochProblem;
use analysis::bloch::BlochError;
use analysis::bloch::bands::{
    BandSolver, PathPoint, WavesAtWaveVector, follow_branches, sample_path,
};
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

/// Number of computed branches (frequencies per wave vector) per block of the periodic cell.
const BRANCHES_PER_BLOCK: usize = 8;
/// Number of steps on each straight side of the path through the Brillouin zone.
const STEPS_PER_PATH_SIDE: usize = 20;
/// Number of wave vectors along half of each axis of the Brillouin zone at which band gaps are searched; the next
/// constant is the largest polynomial degree used for them.
const GAP_WAVE_VECTORS_PER_HALF_AXIS: usize = 6;
const MAX_GAP_DEGREE: usize = 6;
/// Requested relative accuracy of frequencies; the next two constants are the largest numbers of unknowns of the
/// eigenvalue problem, without and with viscosity.
const FREQUENCY_TOLERANCE: f64 = 1e-3;
const MAX_UNDAMPED_UNKNOWNS: usize = 200;
const MAX_DAMPED_UNKNOWNS: usize = 100;
/// Directions of the wave vector, measured from x₁, for which speeds of long waves are reported, degrees.
const LONG_WAVE_DIRECTIONS_DEG: [f64; 3] = [0.0, 22.5, 45.0];
/// Number of wave vectors that are solved between two progress reports.
const POINTS_PER_PROGRESS_REPORT: usize = 8;

/// Band structure of a periodic blocky medium: frequencies of its Bloch waves along a path of wave vectors.
#[derive(Clone, Debug, Serialize)]
pub struct BandStructureResult {
    /// Kind of the model: always `blocky`.
    pub model: &'static str,
    /// Material and geometry of the blocks.
    pub blocks: BlockSummary,
    /// Laws of the joints normal to x₁ and to x₂.
    pub joints: [JointLawSummary; 2],
    /// Name of the verdict on well-posedness.
    #[serde(rename = "verdict")]
    pub verdict_name: &'static str,
    /// Whether no Bloch wave on the path grows in time.
    #[serde(rename = "stable")]
    pub is_stable: bool,
    /// Supremum of the growth rate Re ς over the computed wave vectors, 1/s; 0 for stable media.
    #[serde(rename = "bound")]
    pub growth_bound: f64,
    /// Numbers on which verdict and stability are based.
    pub evidence: BlochEvidence,
    /// Vertices of the path of wave vectors in the Brillouin zone.
    #[serde(rename = "path")]
    pub path_vertices: Vec<PathVertex>,
    /// Total band gaps between the computed branches, as lower and upper angular frequency, rad/s; `None` with
    /// viscosity.
    #[serde(rename = "forbidden_bands")]
    pub band_gaps: Option<Vec<[f64; 2]>>,
    /// Speeds of long waves in the blocky medium and in the continuum, by direction.
    pub long_waves: Vec<LongWaveSpeeds>,
    /// Degree of the polynomials that approximate the displacement in each block.
    #[serde(rename = "degree")]
    pub polynomial_degree: usize,
    /// Estimate of the largest relative error of a frequency at the vertices of the path; infinite (null in JSON) if
    /// the cell is too large for an estimate.
    #[serde(rename = "accuracy")]
    pub achieved_accuracy: f64,
    /// Ratio K_t h/μ of the tangential stiffness of the joints, K_t, times the block size h to the shear modulus μ of
    /// the blocks; `None` without equivalent continuum.
    pub stiffness_ratio: Option<f64>,
    /// Reason why there is no equivalent continuum; `None` if there is one.
    #[serde(rename = "no_continuum")]
    pub missing_continuum: Option<String>,
    /// Constants of the equivalent continuum; `None` if there is none.
    #[serde(skip)]
    pub continuum_constants: Option<HomogenisedConstants>,
    /// Wave vectors along the path, with their distance from its start.
    #[serde(skip)]
    pub path_points: Vec<PathPoint>,
    /// Bloch waves at each of the `path_points`.
    #[serde(skip)]
    pub path_waves: Vec<WavesAtWaveVector>,
    /// Angular frequencies of the three waves of the continuum at each of the `path_points`, rad/s; empty without
    /// continuum.
    #[serde(skip)]
    pub continuum_frequencies: Vec<Vec<f64>>,
    /// Exact branches of one-dimensional chains of blocks along x₁, on the first side of the path.
    #[serde(skip)]
    pub chain_branches: Vec<ChainBranches>,
}

/// Material and geometry of the blocks of a periodic medium.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlockSummary {
    /// Density of the block material, kg/m³.
    pub density: f64,
    /// Longitudinal wave speed of the block material, m/s.
    pub longitudinal_speed: f64,
    /// Shear wave speed of the block material, m/s.
    pub shear_speed: f64,
    /// Side lengths of a block along x₁ and x₂, m.
    #[serde(rename = "size")]
    pub side_lengths: [f64; 2],
    /// Shift of every second row of blocks along x₁, m.
    pub row_shift: f64,
    /// Whether the blocks have a yield set; Bloch waves are those of the elastic blocks even so.
    #[serde(rename = "yields")]
    pub can_yield: bool,
}

/// Law of the joints normal to an axis; each pair holds the normal and the tangential component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointLawSummary {
    /// Kind of the layer that fills the joint, as named in case files.
    #[serde(rename = "kind")]
    pub layer_kind: &'static str,
    /// Masses per joint area, kg/m².
    #[serde(rename = "mass")]
    pub areal_masses: [f64; 2],
    /// Joint stiffnesses under loads that are fast compared with the retardation time, Pa/m.
    #[serde(rename = "stiffness")]
    pub fast_stiffnesses: [f64; 2],
    /// Retardation time of the viscous shear of the joint, s; `None` without viscosity.
    pub retardation_time: Option<f64>,
    /// Note on the state about which the joint law is linearised; `None` for elastic layers.
    #[serde(rename = "linearisation")]
    pub linearisation_note: Option<&'static str>,
}

/// Evidence that all frequencies are real or belong to damped waves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BlochEvidence {
    /// Number of wave vectors on the path at which waves were computed.
    #[serde(rename = "wave_vectors")]
    pub wave_vector_count: usize,
    /// Smallest squared frequency ω² over all waves of the discretised medium at these wave vectors, rad²/s²; `None`
    /// with viscosity.
    #[serde(rename = "least_squared_frequency")]
    pub min_squared_frequency: Option<f64>,
    /// Largest growth rate of a mode at these wave vectors, 1/s; modes that grow only by rounding errors are included.
    #[serde(rename = "largest_growth")]
    pub max_growth_rate: f64,
    /// Bound on the rounding error of `max_growth_rate`, 1/s.
    #[serde(rename = "growth_rounding")]
    pub growth_rate_rounding: f64,
    /// Whether the stored energy is positive: no stiffness of the joints is negative.
    #[serde(rename = "energy_is_positive")]
    pub has_positive_energy: bool,
}

/// Vertex of the path of wave vectors in the Brillouin zone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathVertex {
    /// Name of the vertex, such as Γ or X.
    pub name: &'static str,
    /// Distance from the start of the path to this vertex, in units of the wave number, 1/m.
    pub distance: f64,
    /// Wave vector at this vertex, 1/m.
    pub wave_vector: [f64; 2],
}

/// Speeds of the S wave and the P wave of long wavelength in one direction, m/s, the slower wave first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LongWaveSpeeds {
    /// Direction of the wave vector from x₁, degrees.
    pub direction_deg: f64,
    /// Speeds in the blocky medium, m/s; with viscosity, those of waves that are slow compared with the retardation
    /// time.
    #[serde(rename = "medium")]
    pub medium_speeds: [f64; 2],
    /// Speeds in the equivalent continuum, m/s; `None` without continuum.
    #[serde(rename = "continuum")]
    pub continuum_speeds: Option<[f64; 2]>,
    /// Speed in the continuum divided by that in the blocky medium, minus 1; `None` without continuum.
    #[serde(rename = "difference")]
    pub relative_differences: Option<[f64; 2]>,
}

/// Branches of a one-dimensional chain of blocks and joints along x₁, with one polarisation.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainBranches {
    /// Name of the polarisation: `P` for longitudinal or `S` for transverse waves.
    pub name: &'static str,
    /// One curve per branch: points of distance along the path, 1/m, and angular frequency, rad/s.
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
) -> Result<BandStructureResult, Error> {
    let problem = BlochProblem::new(case)?;
    let locate_error = |error: BlochError| -> Error {
        let error = match error {
            BlochError::Input(error) => error,
            other => InputError {
                input: "model",
                rejected_value: format!("numbers whose Bloch waves cannot be computed: {other}"),
                allowed_values: "expected moduli, densities and lengths of physical magnitude"
                    .into(),
            },
        };
        case.locate_error(error).into()
    };
    let path = problem.periodic_cell.standard_path();
    let (points, distances) = sample_path(&path, STEPS_PER_PATH_SIDE).map_err(locate_error)?;
    report_progress(on_progress, 0, points.len())?;
    let (count, control) = choose_resolution(&problem);
    let solver =
        BandSolver::new(&problem.periodic_cell, &path, count, &control).map_err(locate_error)?;
    let mut waves = Vec::with_capacity(points.len());
    for chunk in points.chunks(POINTS_PER_PROGRESS_REPORT) {
        let solved: Result<Vec<WavesAtWaveVector>, BlochError> =
            chunk.par_iter().map(|point| solver.solve(point.wave_vector)).collect();
        waves.extend(solved.map_err(locate_error)?);
        report_progress(on_progress, waves.len(), points.len())?;
    }
    let is_viscous = problem.periodic_cell.is_viscous();
    if is_viscous {
        follow_branches(&points, &distances, &mut waves);
    }
    let band_gaps = match is_viscous {
        true => None,
        false => {
            let model = CellModel::new(&problem.periodic_cell, solver.degree().min(MAX_GAP_DEGREE));
            let gaps =
                model.total_gaps(count, GAP_WAVE_VECTORS_PER_HALF_AXIS).map_err(locate_error)?;
            Some(gaps.iter().map(|gap| [gap.lower.0, gap.upper.0]).collect())
        }
    };
    let evidence = collect_evidence(&problem, &waves);
    let is_stable = waves.iter().all(WavesAtWaveVector::is_stable);
    let continuum = problem.continuum_constants.as_ref().ok().copied();
    let largest = max_branch_frequency(&waves);
    Ok(BandStructureResult {
        model: "blocky",
        blocks: BlockSummary::from(&problem.periodic_blocks),
        joints: [0, 1].map(|axis| summarise_joint(&problem, axis)),
        // Blocks are symmetric-hyperbolic, and joints couple velocities and tractions locally: growth is bounded.
        verdict_name: "well-posed",
        is_stable,
        growth_bound: if is_stable { 0.0 } else { evidence.max_growth_rate },
        evidence,
        long_waves: compute_long_waves(&problem, solver.degree()).map_err(locate_error)?,
        polynomial_degree: solver.degree(),
        achieved_accuracy: solver.frequency_error,
        band_gaps,
        stiffness_ratio: continuum.map(|own| own.stiffness_ratio),
        missing_continuum: problem.continuum_constants.as_ref().err().cloned(),
        continuum_frequencies: match &continuum {
            Some(own) => points
                .iter()
                .map(|point| continuum_frequencies(&own.solid, point.wave_vector))
                .collect(),
            None => Vec::new(),
        },
        chain_branches: compute_chains(&problem, &points, largest),
        path_vertices: path.iter().zip(distances).map(PathVertex::from).collect(),
        continuum_constants: continuum,
        path_points: points,
        path_waves: waves,
    })
}

/// Returns the number of branches to be computed, and the range of polynomial degrees and the tolerance of the solver.
fn choose_resolution(problem: &BlochProblem) -> (usize, DegreeControl) {
    let rows = problem.periodic_cell.rows().len();
    let unknowns = if problem.periodic_cell.is_viscous() {
        MAX_DAMPED_UNKNOWNS
    } else {
        MAX_UNDAMPED_UNKNOWNS
    };
    let fits = |degree: &usize| 2 * (degree + 1) * (degree + 1) * rows <= unknowns;
    let largest = (2..=10).step_by(2).filter(fits).last().unwrap_or(2);
    // The accuracy is estimated by comparing results of three polynomial degrees.
    let first = largest.saturating_sub(4).max(2);
    let control = DegreeControl {
        tolerance: FREQUENCY_TOLERANCE,
        first_degree: first,
        largest_degree: largest,
    };
    (BRANCHES_PER_BLOCK * rows, control)
}

fn collect_evidence(problem: &BlochProblem, waves: &[WavesAtWaveVector]) -> BlochEvidence {
    let stiffnesses = problem
        .joint_laws
        .iter()
        .flat_map(|joint| [joint.normal.stiffness, joint.tangential.stiffness]);
    let least = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min);
    let largest =
        |value: fn(&WavesAtWaveVector) -> f64| waves.iter().map(value).fold(0.0, f64::max);
    BlochEvidence {
        wave_vector_count: waves.len(),
        min_squared_frequency: least(&mut waves.iter().filter_map(|at| at.min_squared_frequency)),
        max_growth_rate: largest(|at| at.max_growth_rate),
        growth_rate_rounding: largest(|at| at.growth_rounding),
        has_positive_energy: stiffnesses.into_iter().all(|stiffness| stiffness >= 0.0),
    }
}

fn summarise_joint(problem: &BlochProblem, axis: usize) -> JointLawSummary {
    let (law, joint) = (&problem.periodic_blocks.joints[axis], &problem.joint_laws[axis]);
    JointLawSummary {
        layer_kind: law.kind.name,
        areal_masses: [joint.normal.mass.mass, joint.tangential.mass.mass],
        fast_stiffnesses: [joint.normal.stiffness, joint.tangential.stiffness],
        retardation_time: joint.tangential.delay.map(|delay| delay.retardation_time),
        linearisation_note: law.material.linearisation_note(),
    }
}

fn compute_long_waves(
    problem: &BlochProblem,
    degree: usize,
) -> Result<Vec<LongWaveSpeeds>, BlochError> {
    let slow = problem.periodic_cell.map_joints(Joint::relaxed);
    let along = |&direction_deg: &f64| {
        let (sin, cos) = direction_deg.to_radians().cr_sin_cos();
        let medium = slow.long_wave_speeds([cos, sin], degree)?.speeds;
        let continuum =
            problem.continuum_constants.as_ref().ok().map(|own| own.long_wave_speeds([cos, sin]));
        let difference = continuum.map(|own| [0, 1].map(|wave| own[wave] / medium[wave] - 1.0));
        Ok(LongWaveSpeeds {
            direction_deg,
            medium_speeds: medium,
            continuum_speeds: continuum,
            relative_differences: difference,
        })
    };
    LONG_WAVE_DIRECTIONS_DEG.par_iter().map(along).collect()
}

fn max_branch_frequency(waves: &[WavesAtWaveVector]) -> f64 {
    let all = waves.iter().flat_map(|at| &at.waves).map(|wave| wave.frequency);
    all.fold(0.0, f64::max)
}

/// Computes the branches of the chains along x₁, up to the angular frequency `largest`, rad/s, on the side of the path
/// from Γ to X.
fn compute_chains(
    problem: &BlochProblem,
    points: &[PathPoint],
    largest: f64,
) -> Vec<ChainBranches> {
    let period = problem.periodic_blocks.size[0];
    let side: Vec<&PathPoint> =
        points.iter().take_while(|point| point.wave_vector[1] == 0.0).collect();
    let kinds = [("P", ChainPolarisation::Longitudinal), ("S", ChainPolarisation::Transverse)];
    let curves = |(name, polarisation)| {
        let chain = problem.create_chain(polarisation)?;
        let mut curves: Vec<Vec<[f64; 2]>> = Vec::new();
        for point in &side {
            let shift = (point.wave_vector[0] * period).min(PI);
            let own = chain.frequencies_below(shift, largest).unwrap_or_default();
            curves.resize(curves.len().max(own.len()), Vec::new());
            for (curve, frequency) in curves.iter_mut().zip(own) {
                curve.push([point.distance, frequency]);
            }
        }
        Some(ChainBranches { name, curves })
    };
    kinds.into_iter().filter_map(curves).collect()
}

impl From<&PeriodicBlocks> for BlockSummary {
    fn from(own: &PeriodicBlocks) -> Self {
        Self {
            density: own.material.density,
            longitudinal_speed: own.material.longitudinal_speed,
            shear_speed: own.material.shear_speed,
            side_lengths: own.size,
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
