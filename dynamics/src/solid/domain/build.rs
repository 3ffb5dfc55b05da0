//! Construction of a domain, or of a subdomain, from a problem.

use super::boundaries::Boundaries;
use super::buffers::{Buffers, allocate_zeros};
use super::contacts::LaneContacts;
use super::curvilinear::{CurvatureRotations, RowConstants};
use super::diagnostics::Diagnostics;
use super::fluid::FluidStage;
use super::interlayer_faces::LaneInterlayers;
use super::lane_laws::{LaneLaws, has_coupled_fields, rotated_field_offsets};
use super::layout::{Layout, groups_per_row, pitch};
use super::materials::Materials;
use super::schedule::{Schedule, TileSizes};
use super::sources::{CellSource, Sources};
use super::{Domain, SolverReal};
use crate::simd::{InstructionSet, LaneGroup, Real};
use crate::solid::problem::{DomainError, Grid, PlasticStep, Problem, Scheme};
use crate::solid::region::Region;
use crate::solid::shear_steps::ShearSteps;
use models::solid::waves::SolidField;
use std::ops::Range;

impl<const D: usize> Layout<D> {
    /// Creates the layout of a region of a problem.
    pub(super) fn new<T: Real>(problem: &Problem<D>, region: &Region<D>) -> Self {
        let cells = region.cells();
        let owned: [Range<usize>; D] = std::array::from_fn(|axis| {
            let [lower, upper] = region.halo(axis);
            lower..cells[axis] - upper
        });
        let groups = groups_per_row::<T, D>(problem, cells[0]);
        let lanes = |group: usize| {
            let is_owned = |lane: usize| owned[0].contains(&(lane * groups + group));
            (0..T::Lanes::COUNT).map(|lane| u16::from(is_owned(lane)) << lane).sum()
        };
        let pitch = pitch(groups);
        Self {
            cells,
            owned_lanes: (0..groups).map(lanes).collect(),
            owned,
            is_periodic_in_place: region.halo(D - 1) != [0, 0]
                && region.has_neighbours(D - 1) == [false; 2],
            field_count: problem.fields().len(),
            groups,
            ghosts: problem.scheme.slopes.ghosts(),
            pitch,
            rows: cells[1..D - 1].iter().product(),
            exchanged_fields: exchanged_fields(problem, pitch),
        }
    }
}

/// Returns the fields, as ranges of a row, that the halo of a neighbour along the last axis needs.
///
/// In a pass of one step these are the fields that the second sweep along the last axis reads, and the fields that
/// rotate with them. All fields are exchanged in the plane, where a pass may have two steps, for alternating sweeps,
/// and if a cell law couples all fields ([`has_coupled_fields`]).
fn exchanged_fields<const D: usize>(problem: &Problem<D>, pitch: usize) -> Vec<Range<usize>> {
    let Problem { media, scheme, .. } = problem;
    let fields = &problem.fields();
    let whole_state = D == 2 || scheme.is_alternating() || has_coupled_fields(problem);
    let offset =
        |field: SolidField| fields.iter().position(|own| *own == field).map(|own| own * pitch);
    let is_read = |field_offset: &usize| {
        let mut pairs = media[0].pairs[D - 1].iter();
        pairs.any(|pair| {
            [pair.velocity, pair.stress]
                .into_iter()
                .any(|field| offset(field) == Some(*field_offset))
        })
    };
    let rotated = rotated_field_offsets(fields, pitch);
    let is_rotated_with_read = |offset: &usize| {
        rotated.iter().any(|triple| triple.contains(offset) && triple.iter().any(is_read))
    };
    let mut exchanged: Vec<Range<usize>> = Vec::new();
    for offset in (0..fields.len()).map(|index| index * pitch) {
        if whole_state || is_read(&offset) || is_rotated_with_read(&offset) {
            match exchanged.last_mut() {
                Some(last) if last.end == offset => last.end += pitch,
                _ => exchanged.push(offset..offset + pitch),
            }
        }
    }
    exchanged
}

/// Whether an axis is periodic without exchange of a halo.
fn is_periodic_in_place<const D: usize>(
    problem: &Problem<D>,
    region: &Region<D>,
    axis: usize,
) -> bool {
    problem.wraps_around(axis) && region.halo(axis) == [0, 0]
}

/// Selects the tile sizes of a region.
pub(super) fn select_tile_sizes<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    layout: &Layout<D>,
    region: &Region<D>,
) -> TileSizes {
    let row = layout.row_size() * size_of::<T::Lanes>();
    match D {
        3 => TileSizes::new_in_space(row, is_periodic_in_place(problem, region, 1), layout.ghosts),
        _ => TileSizes::PLANE_TILES,
    }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Creates a subdomain at rest: the domain of `region`, from the problem restricted to that region
    /// ([`Problem::restrict_to`]), for passes of at most `max_pass_steps` steps.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new_subdomain(
        problem: &Problem<D>,
        region: &Region<D>,
        max_pass_steps: usize,
    ) -> Result<Self, DomainError> {
        problem.validate_in_region(region)?;
        Self::new_unchecked(problem, region, max_pass_steps)
    }

    /// Creates a subdomain as [`Self::new_subdomain`] does, from a problem that has already been checked.
    ///
    /// # Errors
    /// There is not enough memory.
    pub(crate) fn new_unchecked(
        problem: &Problem<D>,
        region: &Region<D>,
        max_pass_steps: usize,
    ) -> Result<Self, DomainError> {
        // `SolverReal` compiles the kernels for two and three dimensions only.
        const { assert!(D == 2 || D == 3) }
        let layout = Layout::new::<T>(problem, region);
        // Allocated first, since the fields take most of the memory.
        let field_data = allocate_zeros(
            (layout.layers() * layout.rows + 2 * layout.ghosts * layout.ghost_rows())
                * layout.row_size(),
        )?;
        let is_periodic = is_periodic_in_place(problem, region, 0);
        let (mut materials, patterns) = Materials::new(problem, &layout, is_periodic);
        let layers = region.coordinates(D - 1);
        let along_rows = (&*materials.waves[0], &materials.table);
        materials.row_constants = RowConstants::new(problem, along_rows, &patterns, &layers);
        let fields = &materials.fields;
        let whole = problem.initial_stress.as_ref().map_or(&[][..], |own| &own.1);
        let initial_stress = problem.initial_stress.as_ref().map(|(axis, stress)| {
            let coordinates = region.coordinates(*axis).into_iter();
            (*axis, coordinates.map(|place| stress[place]).collect())
        });
        let reflects = problem.scheme.plastic_step == PlasticStep::MidpointReflection;
        let mut law = LaneLaws::new(
            &materials,
            &patterns,
            (layout.groups, layout.pitch),
            (problem.step, reflects),
            (initial_stress, whole),
        );
        let row_sizes = (layout.groups, layout.pitch);
        law.contacts = LaneContacts::new(problem, &patterns, row_sizes, &layers);
        if problem.has_field_factors() {
            law.field_factors = layers.iter().map(|layer| problem.field_factor(*layer)).collect();
            // The kernel for total stresses has thresholds by lane pattern only.
            law.uses_scalar_mapping = true;
        }
        law.curvature_rotations =
            CurvatureRotations::new(problem, &patterns, layout.pitch, &layers);
        let source = |own| CellSource::new(own, fields, &layout, 2 * max_pass_steps);
        let sources = Sources {
            cell_sources: problem.sources.iter().map(source).collect(),
            acceleration: problem.acceleration,
        };
        let tile_sizes = select_tile_sizes::<T, D>(problem, &layout, region);
        let pairs = std::array::from_fn(|axis| materials.waves[axis].len());
        let interfaces = LaneInterlayers::new(problem, &layout, region, &materials);
        Ok(Self {
            fluid: FluidStage::new(problem, &layout, region, &interfaces),
            interfaces,
            grid: Grid { cells: region.owned_counts(), spacing: problem.grid.spacing },
            step: problem.step,
            scheme: Scheme { slopes: problem.scheme.sweep_slopes(), ..problem.scheme },
            is_idle: std::array::from_fn(|axis| problem.is_idle(axis)),
            shear_steps: ShearSteps::new(problem),
            instructions: InstructionSet::widest(),
            boundaries: Boundaries::new(problem, region, &layout, max_pass_steps),
            sources,
            schedule: Schedule::new(max_pass_steps, tile_sizes),
            field_data,
            diagnostics: Diagnostics::new::<T, D>(&layout, problem, fields, max_pass_steps)?,
            buffers: Buffers::new(&layout, pairs, 2 * max_pass_steps, law.has_double_blocks()),
            lane_laws: law,
            layout,
            materials,
        })
    }
}
