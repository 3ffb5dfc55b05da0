//! What is to be solved: grid, media, sides, what acts, and the choices of the scheme.

use crate::solid::boundary::{Boundary, Condition, Load, Source};
use crate::solid::ghosts::BESIDE;
use crate::solid::interlayers::Interlayers;
use crate::solid::medium::Medium;
use crate::solid::metric::Metric;
use crate::solid::reconstruction::Slopes;
use crate::solid::region::Region;
use models::solid::stress::Stress;
use models::solid::waves::Field;

/// A rectangular grid of `D` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const D: usize> {
    /// Cells along each axis.
    pub cells: [usize; D],
    /// Edges of a cell, m.
    pub spacing: [f64; D],
}

impl<const D: usize> Grid<D> {
    /// Cells in all.
    pub fn count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Volume of a cell, m³; in plane strain of a slice of unit thickness.
    pub fn volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Faces of a side across `axis`.
    pub fn faces(&self, axis: usize) -> usize {
        self.count() / self.cells[axis].max(1)
    }
}

/// How stresses are kept in their yield sets: the place of the return mapping in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlasticStep {
    /// The return mapping P after the elastic step: first order, and the state always in its set. Fronts at which flow begins or
    /// ends are as sharp as the sweeps make them.
    #[default]
    ReturnMapping,
    /// The reflection 2P − I between the halves of the elastic step: second order while the same conditions stay active. If
    /// plastic flow stops abruptly, as behind a shock, the overshoot of the last reflection remains: an error
    /// of one step's plastic strain. The state is in its set in the middle of steps; output is
    /// [`Domain::admissible`](crate::solid::domain::Domain::admissible).
    MidpointReflection,
}

/// The order of the sweeps of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Splitting {
    /// x y z, then z y x, each by half a step (Marchuk 1968; Strang 1968): across each axis two sweeps follow each
    /// other, and waves of Courant number 1 along an axis move by two cells to the bit.
    #[default]
    TwoCyclic,
    /// Sweeps along x alternate with those across it: x, y z, x, z y; which axis x is in space says
    /// [`Problem::first_axis`]. The state is a quarter of a step of the sweep
    /// along x behind its time, which [`Domain::output_cell`](crate::solid::domain::Domain::output_cell) makes up for, and the first sweep
    /// is half as long. As many sweeps, a quarter of the splitting error between x and the other axes; above all on
    /// free sides, where two sweeps in a row across the side let the traction that the sweep along the side makes
    /// grow twice as far before they release it.
    Alternating,
}

/// The choices of the scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// How waves are reconstructed.
    pub slopes: Slopes,
    /// Where the correction stands.
    pub plastic_step: PlasticStep,
    /// The order of sweeps. [`PlasticStep::MidpointReflection`] needs a step with a middle between sweeps:
    /// [`Splitting::TwoCyclic`] is taken.
    pub splitting: Splitting,
}

impl Scheme {
    /// A two-cyclic scheme.
    pub fn new(slopes: Slopes, plastic_step: PlasticStep) -> Self {
        Self { slopes, plastic_step, splitting: Splitting::TwoCyclic }
    }

    /// Whether sweeps alternate.
    pub(crate) fn alternates(&self) -> bool {
        self.splitting == Splitting::Alternating && self.plastic_step == PlasticStep::ReturnMapping
    }

    /// The reconstruction that sweeps compute with.
    pub(crate) fn sweep_slopes(&self) -> Slopes {
        match self.slopes {
            // The weights of their cells are zero.
            Slopes::Godunov => Slopes::FourthOrder,
            own => own,
        }
    }
}

/// What is to be solved.
#[derive(Clone)]
pub struct Problem<const D: usize> {
    /// The grid.
    pub grid: Grid<D>,
    /// The media: all of the same fields, memory variables apart.
    pub media: Vec<Medium>,
    /// Medium of each cell, the first axis running fastest.
    pub of_cell: Vec<u16>,
    /// What lies beyond the sides: by axis, then by end.
    pub boundaries: [[Boundary; 2]; D],
    /// Time step Δt, s.
    pub step: f64,
    /// The choices of the scheme.
    pub scheme: Scheme,
    /// What sides are given in the course of time.
    pub loads: Vec<Load>,
    /// What acts inside.
    pub sources: Vec<Source>,
    /// Acceleration that acts on all cells, m/s².
    pub acceleration: [f64; D],
    /// An initial stress in equilibrium: an axis, and the stress in each layer across it; or none.
    pub initial_stress: Option<(usize, Vec<Stress>)>,
    /// Velocities and spins of which the integrals in time, displacements and rotations, are kept.
    pub integrals: Vec<Field>,
    /// Interlayers between blocks of cells, at most once across each axis.
    pub interlayers: Vec<Interlayers>,
    /// Spacings and curvatures by layer of a block in the plane, if layers differ.
    pub metric: Option<Metric>,
}

impl<const D: usize> Problem<D> {
    /// A problem without loads, sources or initial stress.
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
            of_cell,
            boundaries,
            step,
            scheme,
            loads: Vec::new(),
            sources: Vec::new(),
            acceleration: [0.0; D],
            initial_stress: None,
            integrals: Vec::new(),
            interlayers: Vec::new(),
            metric: None,
        }
    }

    /// The axis that should be swept as the first one. In space, alternating sweeps along one axis alternate
    /// with those along both others, which do not alternate with each other: this is the last axis with
    /// reflecting boundaries, if there is any. Waves along a free boundary have four times the splitting error
    /// if sweeps normal to the boundary do not alternate with tangential ones.
    pub fn first_axis(&self) -> usize {
        let reflects = |side: &Boundary| match side {
            Boundary::Fixed | Boundary::Free => true,
            Boundary::Given(conditions) => conditions.iter().any(Condition::reflects),
            Boundary::ByFace(pairs) => pairs.iter().flatten().any(Condition::reflects),
            Boundary::Periodic | Boundary::NonReflecting => false,
        };
        let axes = 0..if D == 3 && self.scheme.alternates() { D } else { 0 };
        axes.rev().find(|axis| self.boundaries[*axis].iter().any(reflects)).unwrap_or(0)
    }

    /// The components of the state: the fields of the media, then the memory variables of all of them.
    pub fn fields(&self) -> Vec<Field> {
        let mut fields = self.media.first().map_or(Vec::new(), |medium| medium.fields.clone());
        for field in self.media.iter().flat_map(Medium::history) {
            if !fields.contains(&field) {
                fields.push(field);
            }
        }
        fields
    }

    /// Looks whether it can be solved.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn check(&self) -> Result<(), DomainError> {
        self.check_in(&Region::whole(self.grid.cells))
    }

    /// The same of the problem of a region, see [`Self::restricted`].
    pub(crate) fn check_in(&self, region: &Region<D>) -> Result<(), DomainError> {
        let needed = region.count();
        if needed == 0 || self.of_cell.len() != needed {
            return Err(DomainError::Cells { found: self.of_cell.len(), needed });
        }
        let Some(first) = self.media.first() else { return Err(DomainError::Media) };
        let is_sound = |own: &Medium| own.fields == first.fields && own.pairs.len() == D;
        if !self.media.iter().all(is_sound) {
            return Err(DomainError::Media);
        }
        let count = self.media.len();
        if let Some(cell) = self.of_cell.iter().position(|&m| usize::from(m) >= count) {
            let medium = usize::from(self.of_cell[cell]);
            return Err(DomainError::NoSuchMedium { cell, medium, count });
        }
        self.check_metric()?;
        for (axis, sides) in self.boundaries.iter().enumerate() {
            let speeds = self.media.iter().flat_map(|m| &m.pairs[axis]).map(|pair| pair.speed());
            let spacing = match &self.metric {
                Some(metric) if axis == 0 => metric.least_spacing(),
                _ => self.grid.spacing[axis],
            };
            let courant = 0.5 * self.step * speeds.fold(0.0, f64::max) / spacing;
            // A step that was computed from the Courant number may miss it by rounding.
            if courant.is_nan() || courant > 1.0 + 1e-11 {
                return Err(DomainError::Courant { axis, courant });
            }
            for side in sides {
                let found = match side {
                    Boundary::Given(conditions) => conditions.len(),
                    Boundary::ByFace(conditions)
                        if conditions.iter().any(|own| own.len() != region.faces(axis)) =>
                    {
                        0
                    }
                    Boundary::ByFace(conditions) => conditions.len(),
                    _ => continue,
                };
                let needed = first.pairs[axis].len();
                if found != needed {
                    return Err(DomainError::Conditions { axis, found, needed });
                }
            }
            let [one, other] = sides.each_ref().map(|side| *side == Boundary::Periodic);
            if one != other {
                return Err(DomainError::Periodic(axis));
            }
        }
        self.check_interlayers()?;
        self.check_actions(region)
    }

    /// That there are spacings and curvatures for all layers, and nothing that needs one spacing or straight rows.
    fn check_metric(&self) -> Result<(), DomainError> {
        let Some(metric) = &self.metric else { return Ok(()) };
        let is_curved = !metric.curvature.is_empty();
        let yields = self.media.iter().any(|medium| medium.yields.is_some());
        let refuse = |reason| Err(DomainError::Metric(reason));
        if D != 2 {
            return refuse("it is for blocks in the plane");
        }
        if !metric.is_sound(self.grid.cells[D - 1]) {
            return refuse("every layer needs a positive spacing, and a curvature if any has one");
        }
        if self.scheme.alternates() || !self.interlayers.is_empty() {
            return refuse("sweeps must not alternate, and there must be no interlayers");
        }
        if is_curved && (yields || self.initial_stress.is_some()) {
            return refuse("media of curved blocks must not yield, nor have an initial stress");
        }
        if is_curved && self.acceleration != [0.0; D] {
            return refuse("an acceleration has no one direction in a curved block");
        }
        Ok(())
    }

    /// That loads, sources and the initial stress have their places.
    fn check_actions(&self, region: &Region<D>) -> Result<(), DomainError> {
        let is_lost = |load: &Load| {
            load.axis >= D
                || load.end > 1
                || load.pair >= self.media[0].pairs[load.axis].len()
                || load.faces.iter().any(|&(face, _)| face >= region.faces(load.axis))
                || self.boundaries[load.axis][load.end] == Boundary::Periodic
        };
        if let Some(index) = self.loads.iter().position(is_lost) {
            return Err(DomainError::Load(index));
        }
        let fields = &self.media[0].fields;
        let is_lost = |source: &Source| {
            source.cells.iter().any(|&(cell, _)| cell >= self.of_cell.len())
                || source.amplitudes.iter().any(|(field, _)| !fields.contains(field))
        };
        if let Some(index) = self.sources.iter().position(is_lost) {
            return Err(DomainError::Source(index));
        }
        match &self.initial_stress {
            Some((axis, stress)) if self.grid.cells.get(*axis) != Some(&stress.len()) => {
                Err(DomainError::InitialStress)
            }
            _ => Ok(()),
        }
    }
}

impl<const D: usize> Problem<D> {
    /// Whether waves meet other media or interlayers.
    pub(crate) fn is_mixed(&self) -> bool {
        self.media.len() > 1 || !self.interlayers.is_empty()
    }

    /// The interlayers across an axis.
    pub(crate) fn interlayers_across(&self, axis: usize) -> Option<&Interlayers> {
        self.interlayers.iter().find(|own| own.axis == axis)
    }

    /// That all interlayers can be taken.
    pub(crate) fn check_interlayers(&self) -> Result<(), DomainError> {
        for (index, own) in self.interlayers.iter().enumerate() {
            let refuse = |reason| Err(DomainError::Interlayers { index, reason });
            if own.axis >= D {
                return refuse("there is no such axis");
            }
            if self.interlayers[..index].iter().any(|other| other.axis == own.axis) {
                return refuse("there are others across the same axis");
            }
            if own.laws.len() != self.media[0].pairs[own.axis].len() {
                return refuse("a law is needed for each pair of waves");
            }
            let is_sound = |value: f64| value >= 0.0 && value.is_finite();
            if !own.laws.iter().all(|law| is_sound(law.mass) && is_sound(law.compliance)) {
                return refuse("masses and compliances must be finite and not negative");
            }
            if self.scheme.alternates() {
                return refuse("sweeps must not alternate");
            }
            let cells = self.grid.cells[own.axis];
            if own.every == 0 || own.offset >= cells {
                return refuse("blocks must have cells, and there must be an interlayer");
            }
            let behind = (cells - own.offset - 1) % own.every + 1;
            if self.boundaries[own.axis][0] != Boundary::Periodic && own.offset.min(behind) < BESIDE
            {
                return refuse("blocks beside sides that are not periodic must have three cells");
            }
        }
        Ok(())
    }
}

/// A domain that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// Media of different theories or dimensions, or none at all.
    #[error(
        "all media of a domain must have its dimensions and the same fields, and there must be one"
    )]
    Media,
    /// A cell whose medium is not in the list.
    #[error("cell {cell} has medium {medium}, of {count}")]
    NoSuchMedium {
        /// The cell.
        cell: usize,
        /// Its medium.
        medium: usize,
        /// How many there are.
        count: usize,
    },
    /// As many media as cells are needed.
    #[error("{found} cells have a medium, of {needed}")]
    Cells {
        /// Cells given.
        found: usize,
        /// Cells of the grid.
        needed: usize,
    },
    /// A step that is too long: the scheme would be unstable.
    #[error("Courant number {courant} along axis {axis}: at most 1 is stable")]
    Courant {
        /// The axis, from 0.
        axis: usize,
        /// c(Δt/2)/h.
        courant: f64,
    },
    /// As many conditions as pairs are needed, and by face as many as faces.
    #[error("axis {axis}: {found} conditions are given for {needed} pairs of waves")]
    Conditions {
        /// The axis, from 0.
        axis: usize,
        /// Conditions given.
        found: usize,
        /// Pairs of the axis.
        needed: usize,
    },
    /// A load on faces or pairs that are not there, or on a periodic side.
    #[error("load {0} acts on a side, a pair or a face that is not there")]
    Load(usize),
    /// A source on cells or fields that are not there.
    #[error("source {0} acts on a cell or a field that is not there")]
    Source(usize),
    /// As many initial stresses as layers are needed.
    #[error("an initial stress is needed for every layer across its axis")]
    InitialStress,
    /// Parts that are too many or none.
    #[error(
        "{found} parts along axis {axis}: at least 1, and {least} cells in each of several, of {cells}"
    )]
    Parts {
        /// The axis, from 0.
        axis: usize,
        /// Parts asked for.
        found: usize,
        /// Cells along the axis.
        cells: usize,
        /// Cells that a part must have.
        least: usize,
    },
    /// Interlayers that cannot be taken.
    #[error("interlayers {index}: {reason}")]
    Interlayers {
        /// Their number in the list, from 0.
        index: usize,
        /// Why.
        reason: &'static str,
    },
    /// A metric that cannot be taken.
    #[error("metric: {0}")]
    Metric(&'static str),
    /// A periodic side whose opposite is not.
    #[error("both sides of axis {0} must be periodic, or neither")]
    Periodic(usize),
}
