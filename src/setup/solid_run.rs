//! Solver problem and initial state of a solid simulation from a case.

mod boundary;
mod geometry;
mod gravity;
mod grid_part;
mod initial;
mod joints;
mod pulse;
mod ranges;
mod source;

use crate::Error;
use crate::case::dynamics::{
    self as case, BoundaryFace, CourantWaves, SolidRun, SolidTime, StateComponent,
};
use crate::case::{Case, CaseError, Material};
use crate::setup::plane_wave::{DashpotStep, create_solver_medium, has_parallel_dashpots};
use crate::setup::solid;
use dynamics::boundary::Boundary;
use dynamics::line::{Slopes, WideOrder};
use dynamics::medium::Medium;
use dynamics::problem::{
    DomainError, Grid, MediumFunction, PlasticStep, Problem, SHEAR_INTERVALS, Scheme, Splitting,
};
use dynamics::simulation::{SolverChoice, TimeSteps};
use dynamics::solid::metric::Metric;
pub(crate) use geometry::{cell_centre, create_probe, find_containing_cell};
use grid_part::GridPart;
use models::common::decimal::ToPlainText;
use models::solid::waves::SolidField;
use std::sync::Arc;

/// Solver problem of a solid with its time steps and initial state, created from a case.
pub(crate) struct SolidSetup<const D: usize> {
    pub(crate) problem: Problem<D>,
    pub(crate) time_steps: TimeSteps,
    /// Fields that are initially nonzero, with their values by cell of this process in SI units.
    pub(crate) initial_fields: Vec<(SolidField, Vec<f64>)>,
}

/// Returns the solver media of a case in the order of its regions, or of the materials of its blocks; if it has
/// neither, the medium of its material.
pub(crate) fn create_media(case: &Case, solid_run: &SolidRun) -> Result<Vec<Medium>, Error> {
    let edges = solid_run.grid.smallest_edges();
    let shortest = edges.iter().copied().fold(f64::INFINITY, f64::min);
    // Each axis has two sweeps per step.
    let distance = 2.0 * solid_run.time.courant_number * shortest;
    let media = create_media_for_step(case, solid_run, DashpotStep::Longest(distance))?;
    let materials = solid_run.materials();
    let mut all = materials.iter().copied().chain([&case.material]);
    if !all.any(|own| own.contacts.as_ref().is_some_and(has_parallel_dashpots)) {
        return Ok(media);
    }
    // The step of all media; with it those with dashpots are at most as fast as in their own longest step.
    let step = compute_time_steps(solid_run, &media)?.step;
    create_media_for_step(case, solid_run, DashpotStep::Given(step))
}

/// Creates the media as [`create_media`], with parallel dashpots for a time step.
fn create_media_for_step(
    case: &Case,
    solid_run: &SolidRun,
    step: DashpotStep,
) -> Result<Vec<Medium>, Error> {
    let dimensions = solid_run.grid.dimensions();
    let medium = |own: &Material| match &own.contacts {
        Some(contacts) => Ok(create_solver_medium(own, contacts, dimensions, step)?),
        None => {
            solid::create_medium(own, dimensions).map_err(|error| own.locate_error(error).into())
        }
    };
    let materials = solid_run.materials();
    if materials.is_empty() {
        return medium(&case.material).map(|medium| vec![medium]);
    }
    let all: Vec<Medium> = materials.iter().map(|own| medium(own)).collect::<Result<_, Error>>()?;
    if let Some(odd) = all.iter().position(|medium| medium.fields != all[0].fields) {
        let kinds = [odd, 0].map(|index| materials[index].kind.name());
        let [own, first] = [odd, 0].map(|index| solid_run.material_section(index));
        let found = format!("found {}, beside {} in {first}", kinds[0], kinds[1]);
        let allowed = "all media of a run need the same fields: solids of one theory";
        return Err(solid_run.key_error(&format!("{own}.model.kind"), found, allowed).into());
    }
    Ok(all)
}

/// Returns the name of a field among the unknowns of the analysis, such as `σ12` for `sigma12` and `ω3` for `w3`.
pub(crate) fn analysis_unknown_name(field: SolidField) -> String {
    StateComponent(field).to_string().replace("sigma", "σ").replace('w', "ω")
}

/// Computes the time steps. Their length is the largest one allowed by the Courant number and the rotation per step,
/// reduced such that it divides the duration.
pub(crate) fn compute_time_steps(
    solid_run: &SolidRun,
    media: &[Medium],
) -> Result<TimeSteps, CaseError> {
    let SolidTime { duration, courant_number, max_rotation_deg: rotation_deg, .. } = solid_run.time;
    let (rotation, spacing) = (rotation_deg.to_radians(), &solid_run.grid.smallest_edges());
    let courant = (courant_number, find_shear_interval(solid_run, media)?);
    let steps = TimeSteps::new(media, spacing, courant, rotation, duration);
    steps.map_err(|error| {
        let allowed = "expected at most 10¹² steps: give a shorter duration, or larger cells";
        solid_run.key_error("time.duration", error.to_string(), allowed)
    })
}

/// Least radius of point sources and loads in cells per step of the longitudinal waves in a step of the shear waves.
const MIN_RADIUS_IN_STRIDES: f64 = 6.0;

/// Returns the number of steps per step of the shear waves: with `time.courant_of = "s"` the ratio of the wave speeds,
/// else 1.
fn find_shear_interval(solid_run: &SolidRun, media: &[Medium]) -> Result<usize, CaseError> {
    /// Relative deviation of the ratio that counts as rounding.
    const RATIO_ROUNDING: f64 = 1e-9;
    if solid_run.time.courant_waves == CourantWaves::Fastest {
        return Ok(1);
    }
    let refuse = |found: String| {
        let allowed =
            "expected c1/c2 = 2 or 3 in all of a classical solid; else leave courant_of out";
        Err(solid_run.key_error("time.courant_of", found, allowed))
    };
    if media.iter().any(|medium| medium.rotation.is_some()) {
        return refuse("the solid has spins".to_owned());
    }
    let mut interval = 0;
    for medium in media {
        let speed = |is_longitudinal: bool| {
            let mut pairs = medium.pairs.iter().flatten();
            let found = pairs.find(|pair| pair.is_longitudinal() == is_longitudinal);
            found.map_or(f64::NAN, |pair| pair.speed())
        };
        let (longitudinal, shear) = (speed(true), speed(false));
        let ratio = longitudinal / shear;
        let nearest = ratio.round();
        if !SHEAR_INTERVALS[1..].contains(&(nearest as usize))
            || (ratio - nearest).abs() > RATIO_ROUNDING * nearest
        {
            return refuse(format!("the ratio c1/c2 = {longitudinal} / {shear} is {ratio}"));
        }
        if interval > 0 && interval != nearest as usize {
            return refuse(format!(
                "the ratio c1/c2 is {interval} in one solid, {ratio} in another"
            ));
        }
        interval = nearest as usize;
    }
    check_kernels(solid_run, interval)?;
    Ok(interval)
}

/// Checks that no source or load is concentrated in few cells if shear waves have steps of their own: a source acts in
/// each step, while waves move by several cells from step to step, so that it excites waves of twice as many cells.
fn check_kernels(solid_run: &SolidRun, interval: usize) -> Result<(), CaseError> {
    let cells = MIN_RADIUS_IN_STRIDES * interval as f64;
    let spacing = solid_run.grid.spacing.iter().copied().fold(0.0, f64::max);
    let of_load = |load: &case::FaceLoad| match load.loaded_area {
        case::LoadedArea::Point { kernel, .. } => Some(kernel),
        case::LoadedArea::WholeFace | case::LoadedArea::Rectangle(_) => None,
    };
    let loads = solid_run.loads.iter().map(of_load).enumerate();
    let sources = solid_run.sources.iter().map(|own| Some(own.kernel)).enumerate();
    let entries = loads.map(|own| ("load", own)).chain(sources.map(|own| ("source", own)));
    for (section, (index, kernel)) in entries {
        let found = match kernel {
            None => continue,
            Some(case::Kernel::Bell { radius }) if radius >= cells * spacing => continue,
            Some(case::Kernel::Bell { radius }) => format!("found a bell of radius {radius} m"),
            Some(case::Kernel::Spline) => "found the kernel spline".to_owned(),
            Some(case::Kernel::Cell) => "found the kernel cell".to_owned(),
        };
        let allowed = format!(
            "with time.courant_of = \"s\" expected a bell of at least {cells} cells, radius {} m: \
             narrower ones excite short waves that the scheme does not damp",
            cells * spacing
        );
        return Err(solid_run.key_error(&format!("{section}[{index}]"), found, allowed));
    }
    Ok(())
}

/// Converts reconstruction, plastic step and splitting of the scheme of a case to those of the solver.
pub(crate) fn convert_scheme(chosen: case::SchemeOptions) -> Scheme {
    Scheme {
        slopes: match chosen.reconstruction {
            case::ReconstructionScheme::FourthOrder => Slopes::FourthOrder,
            case::ReconstructionScheme::SixthOrder => Slopes::Wide(WideOrder::Sixth),
            case::ReconstructionScheme::EighthOrder => Slopes::Wide(WideOrder::Eighth),
            case::ReconstructionScheme::Eno2 => Slopes::Limited,
            case::ReconstructionScheme::Godunov => Slopes::Godunov,
        },
        plastic_step: match chosen.return_mapping_order {
            case::ReturnMappingOrder::SecondOrder => PlasticStep::MidpointReflection,
            case::ReturnMappingOrder::FirstOrder => PlasticStep::ReturnMapping,
        },
        splitting: match chosen.splitting {
            case::DimensionalSplitting::Alternating => Splitting::Alternating,
            case::DimensionalSplitting::TwoCyclic => Splitting::TwoCyclic,
        },
    }
}

/// Creates the solver problem of a case without gravity, initial stress and initial fields. `is_distributed`: whether
/// several ranks hold the cells, of which none lists the media of all.
pub(crate) fn create_problem<const D: usize>(
    solid_run: &SolidRun,
    media: Vec<Medium>,
    steps: &TimeSteps,
    is_distributed: bool,
) -> Result<Problem<D>, Error> {
    let cells: [usize; D] = std::array::from_fn(|axis| solid_run.grid.cells[axis]);
    let mut spacing: [f64; D] = std::array::from_fn(|axis| solid_run.grid.spacing[axis]);
    let metric = solid_run.grid.is_polar().then(|| {
        spacing[0] = spacing[0].to_radians();
        Metric::new_polar(solid_run.grid.origin[1], cells[1], [spacing[0], spacing[1]])
    });
    ranges::check_joints(solid_run, &media, steps.step)?;
    let (of_cell, function) = match is_distributed {
        false => (solid_run.compute_cell_media()?, None),
        true => {
            let medium = solid_run.medium_function();
            // `check_media` checks all cells.
            let medium = move |cell| medium(cell).unwrap_or_default();
            (Vec::new(), Some(Arc::new(medium) as MediumFunction))
        }
    };
    let scheme = convert_scheme(solid_run.scheme);
    let converter = GridConverter { solid_run, first_medium: media[0].clone() };
    let boundaries: [[Boundary; 2]; D] = {
        let mut all = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
        for (axis, axis_boundaries) in all.iter_mut().enumerate() {
            for (end, boundary) in axis_boundaries.iter_mut().enumerate() {
                *boundary = converter.create_boundary(BoundaryFace { axis, is_upper: end == 1 })?;
            }
        }
        all
    };
    let mut loads = Vec::new();
    for (index, load) in solid_run.loads.iter().enumerate() {
        loads.push(converter.create_load(index, load)?);
    }
    let mut sources = Vec::new();
    for (index, source) in solid_run.sources.iter().enumerate() {
        sources.extend(converter.create_sources(index, source)?);
    }
    let integrated = solid_run.output.integrated_components.iter();
    Ok(Problem {
        medium_function: function,
        interlayers: converter.create_interlayers(steps.step)?,
        loads,
        sources,
        integrated_fields: integrated.map(|component| component.0).collect(),
        shear_interval: steps.shear_interval,
        metric,
        ..Problem::new(Grid { cells, spacing }, media, of_cell, boundaries, steps.step, scheme)
    })
}

/// Creates the problem of a case for a plan of its distribution over ranks, and checks that each cell is in one region.
pub(crate) fn create_planned_problem<const D: usize>(
    case: &Case,
    solid_run: &SolidRun,
    media: Vec<Medium>,
) -> Result<Problem<D>, Error> {
    ranges::check_constants(case, solid_run)?;
    let steps = compute_time_steps(solid_run, &media)?;
    let problem = create_problem::<D>(solid_run, media, &steps, true)?;
    let whole = problem.grid.cells.map(|count| 0..count);
    check_media(solid_run, &GridPart::new(&problem.grid.cells, &whole, None))?;
    Ok(problem)
}

impl<const D: usize> SolidSetup<D> {
    /// Creates the problem, and the initial state of the cells of this process; `solver`: the solver of the problem, with
    /// the ranks among which it distributes the cells.
    pub(crate) fn new(
        case: &Case,
        solid_run: &SolidRun,
        media: Vec<Medium>,
        solver: &SolverChoice,
    ) -> Result<Self, Error> {
        ranges::check_constants(case, solid_run)?;
        let wave_range = ranges::WaveRange::new(solid_run, &media);
        ranges::check_amplitudes(&wave_range)?;
        let converter = GridConverter { solid_run, first_medium: media[0].clone() };
        let steps = compute_time_steps(solid_run, &media)?;
        let communicator = solver.communicator().filter(|own| own.size() > 1);
        let mut problem = create_problem::<D>(solid_run, media, &steps, communicator.is_some())?;
        let located = |error| locate_domain_error(solid_run, &error);
        let own_cells = solver.own_cells(&problem).map_err(located)?;
        let part = GridPart::new(&problem.grid.cells, &own_cells, communicator.cloned());
        if communicator.is_some() {
            check_media(solid_run, &part)?;
        }
        let (acceleration, initial_stress) = converter
            .compute_gravity_and_initial_stress(&problem.media, |cell| {
                problem.medium_index(cell)
            })?;
        let layers = initial_stress.as_ref().map_or(&[][..], |(_, layers)| layers);
        wave_range.check_gravity_and_initial_stress(&acceleration, layers)?;
        (problem.acceleration, problem.initial_stress) = (acceleration, initial_stress);
        let initial_fields = converter.create_initial_fields(case, &problem, &wave_range, &part)?;
        problem.validate().map_err(located)?;
        check_initial_stress(solid_run, &problem, &part)?;
        Ok(Self { problem, time_steps: steps, initial_fields })
    }
}

/// Converts a solver error to an error of the case. The reader of case files normally reports the fault earlier.
pub(crate) fn locate_domain_error(solid_run: &SolidRun, error: &DomainError) -> CaseError {
    let key = match error {
        DomainError::Courant { .. } => "time.courant",
        DomainError::ShearInterval(_) => "time.courant_of",
        DomainError::ConditionCount { .. } | DomainError::Periodic(_) => "boundary",
        DomainError::Load(_) => "load",
        DomainError::Source(_) => "source",
        DomainError::InitialStress => "initial_stress",
        DomainError::OutOfMemory { .. } => "grid.cells",
        DomainError::Interlayers { .. } => "joint",
        DomainError::Contacts(_) => "scheme",
        DomainError::WideStencil(_) => "scheme.order",
        DomainError::PartCounts { .. } => "parallel.parts",
        DomainError::RankCount { .. } if solid_run.part_counts.is_some() => "parallel.parts",
        _ => "grid",
    };
    let allowed = match error {
        DomainError::PartCounts { ranks, .. } => {
            &*format!("expected numbers that multiply to {ranks}")
        }
        _ => "docs/case-file.md describes solids in time",
    };
    solid_run.key_error(key, error.to_string(), allowed)
}

/// Checks that the initial stress is in the yield set of each cell, since otherwise the first step would apply the
/// return mapping to it.
fn check_initial_stress<const D: usize>(
    solid_run: &SolidRun,
    problem: &Problem<D>,
    part: &GridPart,
) -> Result<(), CaseError> {
    let Some((axis, layers)) = &problem.initial_stress else { return Ok(()) };
    let stride: usize = problem.grid.cells[..*axis].iter().product();
    let is_beyond = |cell: usize| {
        let stress = layers[cell / stride % problem.grid.cells[*axis]];
        problem.media[problem.medium_index(cell)].project(&stress).stress != stress
    };
    let Some(cell) = part.find_first_cell(is_beyond) else { return Ok(()) };
    let key = if solid_run.gravity.is_some() { "gravity" } else { "initial_stress" };
    let found =
        format!("beyond yield in the cell at {}", cell_centre(solid_run, cell).to_plain_text());
    Err(solid_run.key_error(key, found, "an initial stress within the yield set"))
}

/// Checks that each cell of the ranks is in one region, and that each region contains a cell.
fn check_media(solid_run: &SolidRun, part: &GridPart) -> Result<(), CaseError> {
    let medium = solid_run.medium_function();
    if let Some(cell) = part.find_first_cell(|cell| medium(cell).is_err()) {
        return medium(cell).map(drop);
    }
    let mut is_used = vec![0.0; solid_run.regions.len()];
    if !is_used.is_empty() {
        part.cells().filter_map(|cell| medium(cell).ok()).for_each(|own| {
            is_used[usize::from(own)] = 1.0;
        });
        part.take_greatest(&mut is_used);
    }
    solid_run.check_all_used(&is_used.iter().map(|own| *own > 0.0).collect::<Vec<_>>())
}

/// Converter of positions and conditions of a case to cells, faces and fields of its grid.
struct GridConverter<'a> {
    solid_run: &'a SolidRun,
    /// Solver medium of the first region; all media of a run have the same fields.
    first_medium: Medium,
}
