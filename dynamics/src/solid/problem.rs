//! Problem definition: grid, media, boundary conditions, sources, initial stress and scheme.

use crate::solid::boundary::{Boundary, Condition, Load, Source};
use crate::solid::contact_law::ContactLaw;
use crate::solid::fluid_network::MAX_FLUID_SUBSTEPS;
use crate::solid::interlayers::Interlayers;
use crate::solid::medium::Medium;
use crate::solid::metric::Metric;
use crate::solid::reconstruction::Slopes;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use std::sync::Arc;

pub use crate::solid::shear_steps::SHEAR_INTERVALS;

mod validation;

/// Uniform rectangular grid of `D` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const D: usize> {
    /// Number of cells along each axis.
    pub cells: [usize; D],
    /// Edge lengths of a cell, m; in a polar block the first one is an angle, rad (see [`Metric::new_polar`]).
    pub spacing: [f64; D],
}

impl<const D: usize> Grid<D> {
    /// Returns the total number of cells.
    pub fn count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Returns the volume of a cell, m³; in plane strain per unit thickness.
    pub fn volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Returns the number of faces of a boundary normal to `axis`.
    pub fn faces(&self, axis: usize) -> usize {
        self.count() / self.cells[axis].max(1)
    }
}

/// Position of the return mapping in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlasticStep {
    /// Return mapping P after the elastic step: first order; the stress is in its yield set after each step.
    /// Elastic–plastic fronts are as sharp as the sweeps permit.
    #[default]
    ReturnMapping,
    /// Reflection 2P − I between the halves of the elastic step: second order while the set of active yield conditions
    /// does not change. If plastic flow stops abruptly, as behind a shock, the overshoot of the last reflection
    /// remains: an error of the plastic strain of one step. The stress is in its yield set at mid-step; for output use
    /// [`Domain::to_admissible`](crate::solid::domain::Domain::to_admissible).
    MidpointReflection,
}

/// Order of the sweeps of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Splitting {
    /// Sweeps x y z, then z y x, each by half a step (Marchuk 1968; Strang 1968). Two successive sweeps along an axis
    /// shift waves of Courant number 1 by two cells exactly.
    #[default]
    TwoCyclic,
    /// Sweeps along x alternate with those along the other axes: x, y z, x, z y; x is the axis [`Problem::first_axis`].
    /// The state lacks the last quarter of a step along x, which
    /// [`Domain::output_cell`](crate::solid::domain::Domain::output_cell) adds; the very first sweep is half as long as
    /// the others. Same number of sweeps, a quarter of the splitting error between x and the other axes. The gain is
    /// largest at free boundaries, where two-cyclic splitting lets two tangential sweeps produce traction before a
    /// normal sweep releases it.
    Alternating,
}

/// Limits of a pass of the fused solver over memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassLimits {
    /// Width of the halo for each step, cells: [`Slopes::halo`].
    pub halo: usize,
    /// Width of the halo along the first axis in addition to that for each step, cells.
    pub first_axis_halo: usize,
    /// Largest number of steps of a pass.
    pub max_steps: usize,
}

/// Numerical scheme: reconstruction, return mapping and splitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// Reconstruction of the waves at faces: slopes in cells, and limiter.
    pub slopes: Slopes,
    /// Position of the return mapping in a step.
    pub plastic_step: PlasticStep,
    /// Order of the sweeps. [`PlasticStep::MidpointReflection`] requires a step with a middle between sweeps and
    /// therefore always uses [`Splitting::TwoCyclic`].
    pub splitting: Splitting,
}

impl Scheme {
    /// Creates a scheme with two-cyclic splitting.
    pub fn new(slopes: Slopes, plastic_step: PlasticStep) -> Self {
        Self { slopes, plastic_step, splitting: Splitting::TwoCyclic }
    }

    /// Whether sweeps alternate: they do not with [`PlasticStep::MidpointReflection`], whatever the splitting.
    pub(crate) fn is_alternating(&self) -> bool {
        self.splitting == Splitting::Alternating && self.plastic_step == PlasticStep::ReturnMapping
    }

    /// Returns the reconstruction by which the kernels sweep: for first order the fourth-order one, with zero weights.
    pub(crate) fn sweep_slopes(&self) -> Slopes {
        match self.slopes {
            // First order: the weights in the cell constants are zero, see
            // `CellConstants::with_constant_reconstruction`.
            Slopes::Godunov => Slopes::FourthOrder,
            own => own,
        }
    }
}

/// Function that returns the index of the medium of a cell (first axis fastest).
pub type MediumFunction = Arc<dyn Fn(usize) -> u16 + Send + Sync>;

/// Problem definition of a solid, from which a solver is created.
#[derive(Clone)]
pub struct Problem<const D: usize> {
    /// Grid of the cells.
    pub grid: Grid<D>,
    /// Media, all with the same fields except history variables.
    pub media: Vec<Medium>,
    /// Index of the medium of each cell (first axis fastest); empty if `medium_function` gives them.
    pub cell_media: Vec<u16>,
    /// Media of the cells of a grid that no process stores as a whole.
    pub medium_function: Option<MediumFunction>,
    /// Boundary conditions, by axis and end.
    pub boundaries: [[Boundary; 2]; D],
    /// Time step Δt, s.
    pub step: f64,
    /// Numerical scheme of the solver.
    pub scheme: Scheme,
    /// Time-dependent loads on boundaries.
    pub loads: Vec<Load>,
    /// Sources in the interior: forces, couples and moments.
    pub sources: Vec<Source>,
    /// Uniform acceleration (gravity), m/s².
    pub acceleration: [f64; D],
    /// Initial stress in equilibrium: an axis, and the stress of each layer normal to it.
    pub initial_stress: Option<(usize, Vec<Stress>)>,
    /// Velocities and spins whose time integrals (displacements, rotations) are computed.
    pub integrated_fields: Vec<SolidField>,
    /// Interlayers between blocks of cells, at most one set per axis.
    pub interlayers: Vec<Interlayers>,
    /// Cell lengths and curvatures by layer of a plane block, if not uniform.
    pub metric: Option<Metric>,
    /// Number n of steps per step of the shear waves, one of [`SHEAR_INTERVALS`]: they are swept in one of n steps, by n
    /// steps at once. The state is complete after each multiple of n steps.
    pub shear_interval: usize,
}

/// Number of cells from which on rows along an axis fill most SIMD lanes.
const MIN_ROW_CELLS: usize = 8;

/// Returns the axis of a grid of `cells` cells that should be swept first, along which rows lie in memory.
///
/// In three dimensions with alternating sweeps (`is_alternating`) it is the last axis of several cells with reflecting
/// boundaries (`has_reflecting_end`), if there is one: sweeps along the first axis alternate with those along both others,
/// which do not alternate with each other, and waves along a free boundary have four times the splitting error unless sweeps
/// normal to the boundary alternate with tangential ones. Else it is the first axis with at least eight cells, or axis 0.
pub fn choose_first_axis(
    cells: &[usize],
    has_reflecting_end: impl Fn(usize) -> bool,
    is_alternating: bool,
) -> usize {
    let reflecting = match cells.len() == 3 && is_alternating {
        true => (0..3).rev().find(|&axis| cells[axis] > 1 && has_reflecting_end(axis)),
        false => None,
    };
    let long = || cells.iter().position(|count| *count >= MIN_ROW_CELLS);
    reflecting.or_else(long).unwrap_or(0)
}

impl<const D: usize> Problem<D> {
    /// Creates a problem without loads, sources, acceleration, initial stress, time integrals, interlayers and metric,
    /// with the same step for all waves.
    pub fn new(
        grid: Grid<D>,
        media: Vec<Medium>,
        of_cell: Vec<u16>,
        boundaries: [[Boundary; 2]; D],
        step: f64,
        scheme: Scheme,
    ) -> Self {
        Self {
            grid,
            media,
            cell_media: of_cell,
            medium_function: None,
            boundaries,
            step,
            scheme,
            loads: Vec::new(),
            sources: Vec::new(),
            acceleration: [0.0; D],
            initial_stress: None,
            integrated_fields: Vec::new(),
            interlayers: Vec::new(),
            metric: None,
            shear_interval: 1,
        }
    }

    /// Returns the axis that should be swept first, see [`choose_first_axis`].
    pub fn first_axis(&self) -> usize {
        let reflects = |condition: &Boundary| match condition {
            Boundary::Fixed | Boundary::Free => true,
            Boundary::ByPair(conditions) => conditions.iter().any(Condition::is_reflecting),
            Boundary::ByFace(pairs) => pairs.iter().flatten().any(Condition::is_reflecting),
            Boundary::Periodic | Boundary::NonReflecting => false,
        };
        // The layers of a metric are normal to the second axis, and faces of interlayers are numbered in the order of the axes.
        if self.metric.is_some() || !self.interlayers.is_empty() {
            return 0;
        }
        let has_reflecting_end = |axis: usize| self.boundaries[axis].iter().any(reflects);
        choose_first_axis(&self.grid.cells, has_reflecting_end, self.scheme.is_alternating())
    }

    /// Whether sweeps along an axis change nothing: on a periodic axis of one cell all faces have the same state. Laws of
    /// faces may act there: interlayers, contacts.
    pub(crate) fn is_idle(&self, axis: usize) -> bool {
        self.grid.cells[axis] == 1
            && self.boundaries[axis][0] == Boundary::Periodic
            && self.interlayers.is_empty()
            && self.metric.is_none()
            && !self.has_contacts()
    }

    /// Whether a sweep along an axis passes from one end of the grid to the other: the axis is periodic and not idle.
    pub(crate) fn wraps_around(&self, axis: usize) -> bool {
        self.boundaries[axis][0] == Boundary::Periodic && !self.is_idle(axis)
    }

    /// Returns the index of the medium of a cell.
    pub fn medium_index(&self, cell: usize) -> usize {
        let index = match &self.medium_function {
            Some(function) => function(cell),
            None => self.cell_media[cell],
        };
        usize::from(index)
    }

    /// Returns the fields of the state: those of the media, then the history variables of all media.
    pub fn fields(&self) -> Vec<SolidField> {
        Medium::state_fields(&self.media)
    }
}

impl<const D: usize> Problem<D> {
    /// Returns the ratio of the fields in a layer to the physical fields (see [`Metric`]).
    pub fn field_factor(&self, layer: usize) -> f64 {
        let factors = self.metric.as_ref().map_or(&[][..], |metric| &metric.field_factors);
        factors.get(layer).copied().unwrap_or(1.0)
    }

    /// Returns the ratio of the fields in a cell to the physical fields.
    pub fn field_factor_of_cell(&self, cell: usize) -> f64 {
        let layer: usize = self.grid.cells[..D - 1].iter().product();
        self.field_factor(cell / layer)
    }

    /// Whether fields differ from the physical fields by a factor in any layer.
    pub(crate) fn has_field_factors(&self) -> bool {
        self.metric.as_ref().is_some_and(|metric| !metric.field_factors.is_empty())
    }

    /// Whether the problem has several media or interlayers.
    pub(crate) fn has_interfaces(&self) -> bool {
        self.media.len() > 1 || !self.interlayers.is_empty()
    }

    /// Whether any medium has contacts of particles or of walls of pores.
    pub(crate) fn has_contacts(&self) -> bool {
        self.media.iter().any(|medium| medium.contact.is_some())
    }

    /// Whether any medium separates at faces.
    pub(crate) fn separates(&self) -> bool {
        let separates = |medium: &Medium| match &medium.contact {
            Some(ContactLaw::Granular { law, .. }) => law.traction_friction().is_some(),
            _ => false,
        };
        self.media.iter().any(separates)
    }

    /// Returns the reconstruction beside physical boundaries, first order standing for mirror images: if any medium
    /// separates at faces, since one-sided reconstruction would continue the difference across an open face beyond the
    /// boundary, and for wide stencils, which are stable with mirror images.
    pub(crate) fn boundary_slopes(&self) -> Slopes {
        match self.scheme.slopes {
            own if self.separates() || own.is_wide() => Slopes::Godunov,
            own => own,
        }
    }

    /// Whether there are saturated interlayers.
    pub(crate) fn has_fluid(&self) -> bool {
        self.interlayers.iter().any(|own| own.fluid_speed().is_some())
    }

    /// Whether saturated layers that run along an axis are open where they end at a boundary.
    pub(crate) fn has_open_layers_along(&self, axis: usize) -> bool {
        self.interlayers.iter().any(|own| own.axis + axis == 1 && own.has_open_ends)
    }

    /// Returns the halo width and the number of steps to which passes of the fused solver are limited.
    pub fn pass_limits(&self) -> PassLimits {
        // With alternating sweeps, output requires one more sweep along the first axis, and its stencil more halo
        // cells. Sub-steps of the fluid need as many.
        let needs_more = self.scheme.is_alternating() || self.has_fluid();
        PassLimits {
            halo: self.scheme.slopes.halo(),
            first_axis_halo: if needs_more { self.scheme.slopes.ghosts() } else { 0 },
            max_steps: if self.has_fluid() { 1 } else { usize::MAX },
        }
    }

    /// Returns the interlayers normal to an axis.
    pub(crate) fn interlayers_across(&self, axis: usize) -> Option<&Interlayers> {
        self.interlayers.iter().find(|own| own.axis == axis)
    }

    /// Checks axes, laws and positions of the interlayers, and that sweeps do not alternate.
    pub(crate) fn check_interlayers(&self) -> Result<(), DomainError> {
        for (index, own) in self.interlayers.iter().enumerate() {
            let refuse = |reason| Err(DomainError::Interlayers { index, reason });
            if own.axis >= D {
                return refuse("there is no such axis");
            }
            if self.interlayers[..index].iter().any(|other| other.axis == own.axis) {
                return refuse("there are others across the same axis");
            }
            if self.scheme.is_alternating() {
                return refuse("sweeps must not alternate");
            }
            let along =
                self.grid.spacing.get(1_usize.wrapping_sub(own.axis)).copied().unwrap_or(1.0);
            let courant = own.fluid_speed().unwrap_or(0.0) * self.step / along;
            if courant > MAX_FLUID_SUBSTEPS as f64 {
                return refuse("waves of the fluid pass more than two cells in a step");
            }
            let is_periodic = self.boundaries[own.axis][0] == Boundary::Periodic;
            let pairs = self.media[0].pairs[own.axis].len();
            own.check(self.grid.cells[own.axis], self.grid.faces(own.axis), (pairs, is_periodic))
                .map_err(|reason| DomainError::Interlayers { index, reason })?;
        }
        Ok(())
    }
}

/// Error: an invalid problem, or one that does not fit into memory.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// The fields, or the dissipation by cell, do not fit into memory.
    #[error("no memory for fields of {bytes} bytes: take fewer cells")]
    OutOfMemory {
        /// Bytes requested by the allocation that failed.
        bytes: usize,
    },
    /// Media of different theories or dimensions, or no medium.
    #[error(
        "all media of a domain must have its dimensions and the same fields, and there must be one"
    )]
    Media,
    /// A cell whose medium is not in the list.
    #[error("cell {cell} has medium {medium}, of {count}")]
    UnknownMedium {
        /// Index of the cell.
        cell: usize,
        /// Index of the medium of the cell.
        medium: usize,
        /// Number of media in the list.
        count: usize,
    },
    /// The number of cells with a medium differs from that of cells of the grid, or the grid has no cells.
    #[error("{actual} cells have a medium, of {expected}")]
    CellCount {
        /// Number of cells with a medium.
        actual: usize,
        /// Number of cells of the grid.
        expected: usize,
    },
    /// A time step beyond the stability limit, or not a number.
    #[error("Courant number {courant} along axis {axis}: at most 1 is stable")]
    Courant {
        /// First axis along which sweeps exceed the Courant number 1, from 0.
        axis: usize,
        /// Courant number c(Δt/2)/h of the fastest wave along the axis.
        courant: f64,
    },
    /// The number of conditions differs from that of wave pairs, or the number of conditions by face from that of
    /// faces.
    #[error("axis {axis}: {actual} conditions are given for {expected} pairs of waves")]
    ConditionCount {
        /// Axis normal to the boundary, from 0.
        axis: usize,
        /// Number of conditions given; 0 if the number of conditions by face is wrong.
        actual: usize,
        /// Number of wave pairs of the axis.
        expected: usize,
    },
    /// A load (its index) on a missing axis, end, face or wave pair, or on a periodic boundary.
    #[error("load {0} acts on a side, a pair or a face that is not there")]
    Load(usize),
    /// A source (its index) in missing cells or fields.
    #[error("source {0} acts on a cell or a field that is not there")]
    Source(usize),
    /// The number of initial stresses differs from that of layers, or their axis does not exist.
    #[error("an initial stress is needed for every layer across its axis")]
    InitialStress,
    /// An invalid number of subdomains along an axis.
    #[error(
        "{actual} parts along axis {axis}: at least 1, and {min_cells} cells in each of several, of {cells}"
    )]
    SubdomainCount {
        /// Axis along which the grid is decomposed, from 0.
        axis: usize,
        /// Number of subdomains requested.
        actual: usize,
        /// Number of cells along the axis.
        cells: usize,
        /// Minimum number of cells of a subdomain.
        min_cells: usize,
    },
    /// A number of ranks into as many parts of which the grid cannot be cut.
    #[error(
        "{ranks} ranks for {cells} cells: a part needs the cells of its neighbour's halo along each axis that is cut; \
         start fewer ranks"
    )]
    RankCount {
        /// Number of ranks.
        ranks: usize,
        /// Number of cells of the grid.
        cells: usize,
    },
    /// Numbers of parts along the axes that do not multiply to the number of ranks.
    #[error("{} parts for {ranks} ranks", format_product(parts))]
    PartCounts {
        /// Numbers of parts along the axes of the problem.
        parts: Vec<usize>,
        /// Number of ranks.
        ranks: usize,
    },
    /// Another rank has no memory for its part of the domain.
    #[error("rank {rank} has no memory for its part: take fewer cells, or more ranks")]
    OtherRank {
        /// First rank without memory.
        rank: usize,
    },
    /// A number of steps per step of the shear waves that is not possible, with the reason.
    #[error("number of steps per step of the shear waves: {0}")]
    ShearInterval(&'static str),
    /// Invalid interlayers.
    #[error("interlayers {index}: {reason}")]
    Interlayers {
        /// Index of the interlayers in the list of the problem.
        index: usize,
        /// Reason why they are invalid.
        reason: &'static str,
    },
    /// A wide stencil ([`Slopes::Wide`]) in a problem that excludes it, with the reason.
    #[error("reconstruction of sixth or eighth order: {0}")]
    WideStencil(&'static str),
    /// Media with contacts in a problem that excludes them, with the reason.
    #[error("media with contacts: {0}")]
    Contacts(&'static str),
    /// An invalid relaxation time of the overstress, with the reason.
    #[error("relaxation time of the overstress: {0}")]
    Overstress(&'static str),
    /// An invalid metric, with the reason.
    #[error("metric: {0}")]
    Metric(&'static str),
    /// An axis (from 0) with a periodic boundary at one end only.
    #[error("both sides of axis {0} must be periodic, or neither")]
    Periodic(usize),
}

/// Formats factors of a product: `4 × 2`.
fn format_product(factors: &[usize]) -> String {
    factors.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ")
}
