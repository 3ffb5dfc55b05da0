//! What a case says of a run in time: grid, media, sides, loads, initial state and what is recorded.
//!
//! SI units, angles in degrees; coordinates and lengths in m. Axes are counted from 0 here and from 1
//! in case files. In plane strain forces are per unit thickness.

mod component;
mod function;
pub(crate) mod read;
pub use read::COURANT;
mod write;

pub use component::Component;
pub use function::{Samples, TimeFunction};
pub use plane_pulse::{PlanePulse, Polarization};
pub use profile::Profile;

use super::place::Places;
use super::{Case, CaseError};
use models::elementary::Elementary;
use std::fmt;

/// Most cells of a grid.
pub const MOST_CELLS: usize = 4_000_000_000;

/// Most regions of a case.
pub const MOST_REGIONS: usize = u16::MAX as usize;

/// The sections of a case that say how it is run in time.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// The cells.
    pub grid: Grid,
    /// How long, and in which steps.
    pub time: Time,
    /// The choices of the scheme.
    pub scheme: Scheme,
    /// Parts of other media; empty: the case's own is everywhere.
    pub regions: Vec<Region>,
    /// Conditions on sides. What no entry names is free; of two that overlap the later one holds.
    pub sides: Vec<SideCondition>,
    /// Loads on sides; they add up, over the conditions.
    pub loads: Vec<Load>,
    /// Loads inside.
    pub sources: Vec<Source>,
    /// What the initial state is made of; the parts add up.
    pub initial: Vec<Initial>,
    /// Uniform initial stress: all stresses of the case, Pa and N/m.
    pub initial_stress: Vec<(Component, f64)>,
    /// Weight.
    pub gravity: Option<Gravity>,
    /// Points at which the state is recorded.
    pub receivers: Vec<Receiver>,
    /// What else is recorded.
    pub output: Output,
    places: Places,
}

/// A rectangular grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Cells along each axis: two in plane strain, three in space.
    pub cells: Vec<usize>,
    /// Edges of a cell, m.
    pub spacing: Vec<f64>,
    /// The corner of least coordinates, m.
    pub origin: Vec<f64>,
}

impl Grid {
    /// 2 for plane strain, 3 for space.
    pub fn dimensions(&self) -> usize {
        self.cells.len()
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.cells.iter().product()
    }

    /// First and last coordinate along an axis, m.
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let first = self.origin[axis];
        [first, first + self.cells[axis] as f64 * self.spacing[axis]]
    }

    /// Centre along an axis of the cell of that index, m.
    pub fn centre(&self, axis: usize, index: usize) -> f64 {
        self.origin[axis] + (index as f64 + 0.5) * self.spacing[axis]
    }

    /// Whether a point is inside or on a side.
    pub fn contains(&self, point: &[f64]) -> bool {
        point.iter().enumerate().all(|(axis, x)| {
            let [first, last] = self.extent(axis);
            (first..=last).contains(x)
        })
    }
}

/// Duration and step.
#[derive(Clone, Debug, PartialEq)]
pub struct Time {
    /// Duration, s; positive.
    pub duration: f64,
    /// Courant number of a sweep along an axis, at most; in (0, 1].
    pub courant: f64,
    /// Angle by which a step turns spins against antisymmetric stress, degrees, at most; in (0, 180].
    pub rotation_deg: f64,
}

/// The choices of the scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scheme {
    /// Reconstruction of waves.
    pub order: Order,
    /// Accuracy in time of plastic flow.
    pub correction: Correction,
    /// Order of the sweeps.
    pub splitting: Splitting,
    /// Numbers of the state.
    pub precision: Precision,
    /// What is kept of the energy.
    pub ledger: Ledger,
}

/// An enumeration whose variants have names in case files; the first one is the default.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident {
        $(#[$first_doc:meta])* $first:ident = $first_word:literal
        $(, $(#[$other_doc:meta])* $other:ident = $other_word:literal)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            #[default]
            $(#[$first_doc])* $first,
            $($(#[$other_doc])* $other),*
        }

        impl $name {
            /// All of them, the default first.
            pub const ALL: &[Self] = &[Self::$first $(, Self::$other)*];

            /// Name in case files.
            pub const fn name(self) -> &'static str {
                match self {
                    Self::$first => $first_word,
                    $(Self::$other => $other_word),*
                }
            }
        }
    };
}

// After the macro that they use.
mod plane_pulse;
mod profile;

words! {
    /// Reconstruction of waves.
    Order {
        /// Fourth order, linear: for waves that are smooth on the grid.
        FourthOrder = "fourth-order",
        /// Second order, limited: for fronts.
        Eno2 = "eno2",
        /// First order.
        Godunov = "godunov"
    }
}

words! {
    /// Order of the sweeps of a step.
    Splitting {
        /// Those along one axis alternate with the others.
        Alternating = "alternating",
        /// Forth and back through all axes.
        TwoCyclic = "two-cyclic"
    }
}

words! {
    /// Accuracy in time of plastic flow.
    Correction {
        /// After each step.
        FirstOrder = "first-order",
        /// In the middle of a step.
        SecondOrder = "second-order"
    }
}

words! {
    /// Numbers of the state.
    Precision {
        /// 64 bits.
        F64 = "f64",
        /// 32 bits: half the memory.
        F32 = "f32"
    }
}

words! {
    /// What is kept of the energy.
    Ledger {
        /// The energies alone.
        Light = "light",
        /// Also what the scheme and plastic flow dissipate.
        Full = "full"
    }
}

words! {
    /// How the record of a receiver comes from cells.
    Interpolation {
        /// Polynomials of degree 3 along each axis through cells of the medium at the receiver.
        Cubic = "cubic",
        /// The cell, or of a flow the point of the grid, that is nearest.
        Nearest = "none"
    }
}

/// A part of the grid with its own medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Where it is: the cells whose centres are in it.
    pub shape: Shape,
    /// Kind, yield set and numbers of its medium, with the places of the region; no dynamics.
    pub case: Case,
}

/// A part of space.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// from ≤ x < to along each axis.
    Box {
        /// Corner of least coordinates, m.
        from: Vec<f64>,
        /// Corner of greatest coordinates, m.
        to: Vec<f64>,
    },
    /// A disc or ball; without its surface.
    Ball {
        /// Centre, m.
        center: Vec<f64>,
        /// Radius, m; positive.
        radius: f64,
    },
    /// from ≤ x < to along one axis.
    Layer {
        /// The axis, from 0.
        axis: usize,
        /// First coordinate, m.
        from: f64,
        /// Last coordinate, m.
        to: f64,
    },
    /// What lies on the side of a plane (in two dimensions a line) into which the normal points. Two
    /// of opposite normals share the plane so that each of its points is in one of them.
    HalfSpace {
        /// A point of the plane, m.
        point: Vec<f64>,
        /// The normal, of any length but 0.
        normal: Vec<f64>,
    },
    /// What no other region holds.
    Rest,
    /// All of it.
    Everywhere,
}

impl Shape {
    /// Name in case files of 2 or 3 dimensions.
    pub const fn name(&self, dimensions: usize) -> &'static str {
        match (self, dimensions) {
            (Self::Box { .. }, _) => "box",
            (Self::Ball { .. }, 2) => "circle",
            (Self::Ball { .. }, _) => "sphere",
            (Self::Layer { .. }, _) => "layer",
            (Self::HalfSpace { .. }, 2) => "half-plane",
            (Self::HalfSpace { .. }, _) => "half-space",
            (Self::Rest, _) => "rest",
            (Self::Everywhere, _) => "everywhere",
        }
    }

    /// Whether a point is in it; nothing is in [`Shape::Rest`], which depends on the other regions.
    pub fn contains(&self, x: &[f64]) -> bool {
        match self {
            Self::Box { from, to } => {
                x.iter().zip(from.iter().zip(to)).all(|(x, (from, to))| (from..to).contains(&x))
            }
            Self::Ball { center, radius } => {
                let distance =
                    x.iter().zip(center).fold(0f64, |sum, (x, c)| sum.root_sum_square(x - c));
                distance < *radius
            }
            Self::Layer { axis, from, to } => x.get(*axis).is_some_and(|x| (from..to).contains(&x)),
            Self::HalfSpace { point, normal } => {
                let terms = x.iter().zip(point.iter().zip(normal)).map(|(x, (p, n))| (x - p) * n);
                let side: f64 = terms.sum();
                let leading = normal.iter().copied().find(|n| *n != 0.0).unwrap_or(0.0);
                side > 0.0 || (side == 0.0 && leading > 0.0)
            }
            Self::Rest => false,
            Self::Everywhere => true,
        }
    }
}

/// A side of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Side {
    /// The axis of its normal, from 0.
    pub axis: usize,
    /// Whether the coordinate is the greatest there, not the least.
    pub is_upper: bool,
}

impl Side {
    /// All sides in 2 or 3 dimensions.
    pub fn all(dimensions: usize) -> Vec<Self> {
        let both = |axis| [false, true].map(|is_upper| Self { axis, is_upper });
        (0..dimensions).flat_map(both).collect()
    }

    /// Name in case files: `x1-`.
    pub fn name(self) -> String {
        format!("x{}{}", self.axis + 1, if self.is_upper { '+' } else { '-' })
    }

    /// The side across.
    pub fn opposite(self) -> Self {
        Self { is_upper: !self.is_upper, ..self }
    }

    /// The other axes, ascending: those along which positions on the side are given.
    pub fn axes(self, dimensions: usize) -> Vec<usize> {
        (0..dimensions).filter(|&axis| axis != self.axis).collect()
    }
}

/// A rectangle of a side, from ≤ x < to along its axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Least coordinates along the other axes ascending, m.
    pub from: Vec<f64>,
    /// Greatest coordinates along the other axes ascending, m.
    pub to: Vec<f64>,
}

impl Part {
    /// Whether a position on the side, along its axes ascending, is in it.
    pub fn contains(&self, position: &[f64]) -> bool {
        let ends = self.from.iter().zip(&self.to);
        position.iter().zip(ends).all(|(x, (from, to))| (from..to).contains(&x))
    }
}

/// A condition on a side or a part of one. Sides that no entry names are free; where two entries of
/// a side overlap the later one holds.
#[derive(Clone, Debug, PartialEq)]
pub struct SideCondition {
    /// The side.
    pub side: Side,
    /// What holds there.
    pub condition: Condition,
    /// Where on the side; `None`: on all of it.
    pub part: Option<Part>,
}

/// What holds on a side.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// No traction.
    Free,
    /// No velocity and no spin.
    Fixed,
    /// The solid is mirrored there.
    Symmetry,
    /// The solid is mirrored there with the opposite sign.
    Antisymmetry,
    /// The side across follows.
    Periodic,
    /// Waves along the normal leave.
    NonReflecting,
    /// Some velocities and spins vanish, and the tractions and couples of all others.
    Mixed {
        /// The velocities and spins that vanish.
        held: Vec<Component>,
    },
}

impl Condition {
    /// All names in case files.
    pub const NAMES: [&str; 7] =
        ["free", "fixed", "symmetry", "antisymmetry", "periodic", "non-reflecting", "mixed"];

    /// Name in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Fixed => "fixed",
            Self::Symmetry => "symmetry",
            Self::Antisymmetry => "antisymmetry",
            Self::Periodic => "periodic",
            Self::NonReflecting => "non-reflecting",
            Self::Mixed { .. } => "mixed",
        }
    }
}

/// A load on a side.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// The side.
    pub side: Side,
    /// A velocity or spin of the side, or a stress or couple stress on it; stresses are the
    /// components themselves, tension positive on either side.
    pub field: Component,
    /// What is multiplied by the function of time: m/s, rad/s, Pa or N/m. At a point it is the
    /// integral over the side: N or N·m, in plane strain per m.
    pub amplitude: f64,
    /// Where.
    pub action: Action,
    /// By what it is multiplied along the side; not at a point.
    pub profile: Option<Profile>,
    /// When.
    pub time: TimeFunction,
}

/// Where a load acts on a side.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// On all of it.
    Whole,
    /// On a part.
    Part(Part),
    /// About a point.
    Point {
        /// Coordinates along the other axes ascending, m.
        at: Vec<f64>,
        /// Over which it is spread.
        kernel: Kernel,
    },
}

/// A load inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// What acts.
    pub action: SourceKind,
    /// Where, m; inside the grid.
    pub at: Vec<f64>,
    /// Over which it is spread.
    pub kernel: Kernel,
    /// When.
    pub time: TimeFunction,
}

/// The kernel by which what acts at a point is spread over cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kernel {
    /// A smooth kernel of a few cells, exact for polynomials, without the waves of two cells.
    #[default]
    Spline,
    /// A bell.
    Bell {
        /// Its radius, m; positive.
        radius: f64,
    },
    /// The cell or face nearest to the point.
    Cell,
}

impl Kernel {
    /// All names in case files.
    pub const NAMES: [&str; 3] = ["spline", "bell", "cell"];

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Spline => "spline",
            Self::Bell { .. } => "bell",
            Self::Cell => "cell",
        }
    }
}

/// What a source does; amplitudes are multiplied by the function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum SourceKind {
    /// A force, N, by components.
    Force(Vec<f64>),
    /// A couple, N·m: one number about x₃ in plane strain, three components in space.
    Couple(Vec<f64>),
    /// A moment tensor by rows, N·m: the stress glut.
    Moment(Vec<Vec<f64>>),
    /// An isotropic moment, N·m.
    Explosion(f64),
}

impl SourceKind {
    /// All names in case files.
    pub const NAMES: [&str; 4] = ["force", "couple", "moment", "explosion"];

    /// Name in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Force(_) => "force",
            Self::Couple(_) => "couple",
            Self::Moment(_) => "moment",
            Self::Explosion(_) => "explosion",
        }
    }
}

/// A part of the initial state.
#[derive(Clone, Debug, PartialEq)]
pub enum Initial {
    /// A bell exp(−(r/radius)²) of one field.
    Pulse {
        /// The field.
        field: Component,
        /// Its greatest value, in its unit.
        amplitude: f64,
        /// Where it is greatest.
        centre: Centre,
        /// Radius, m; positive.
        radius: f64,
    },
    /// A plane wave of the case's own medium.
    PlaneWave {
        /// Its branch, from 1: the greatest frequency.
        branch: usize,
        /// Direction from x₁ anticlockwise, degrees.
        direction_deg: f64,
        /// Angle above the plane of x₁ and x₂, degrees; 0 in plane strain.
        elevation_deg: f64,
        /// Wavelength, m; positive.
        wavelength: f64,
        /// Greatest velocity, m/s.
        amplitude: f64,
    },
    /// A plane wave of finite length.
    PlanePulse(PlanePulse),
    /// A microrotation.
    Rotation {
        /// Where.
        shape: Shape,
        /// Angle, degrees, anticlockwise about the axis.
        angle_deg: f64,
        /// The axis, from 0; 2 in plane strain.
        axis: usize,
    },
    /// A uniform value of one field.
    Uniform {
        /// Where.
        shape: Shape,
        /// The field.
        field: Component,
        /// Its value, in its unit.
        amplitude: f64,
    },
}

impl Initial {
    /// All names in case files.
    pub const NAMES: [&str; 5] = ["pulse", "plane-wave", "plane-pulse", "rotation", "uniform"];

    /// Name in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pulse { .. } => "pulse",
            Self::PlaneWave { .. } => "plane-wave",
            Self::PlanePulse(_) => "plane-pulse",
            Self::Rotation { .. } => "rotation",
            Self::Uniform { .. } => "uniform",
        }
    }
}

/// What the distance r of a pulse is measured from.
#[derive(Clone, Debug, PartialEq)]
pub enum Centre {
    /// A point, m.
    Point(Vec<f64>),
    /// A plane normal to an axis.
    Plane {
        /// The axis, from 0.
        axis: usize,
        /// The coordinate of the plane, m.
        at: f64,
    },
}

/// Weight.
#[derive(Clone, Debug, PartialEq)]
pub struct Gravity {
    /// Acceleration by components, m/s².
    pub acceleration: Vec<f64>,
    /// Whether an initial stress balances it; then it is along one axis.
    pub is_balanced: bool,
    /// Ratio of the normal stresses across the weight to that along it in the initial stress; ≥ 0.
    pub lateral_ratio: f64,
}

/// A point at which the state is recorded, of a solid or, with its own kind of field, of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct Receiver<F = Recorded> {
    /// Names its record; no other receiver has it.
    pub name: String,
    /// Where, m; inside the grid.
    pub at: Vec<f64>,
    /// How cells make up the record.
    pub interpolation: Interpolation,
    /// What is recorded.
    pub fields: Vec<F>,
}

/// A quantity that a receiver records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Recorded {
    /// A component of the state.
    Component(Component),
    /// The integral in time of a velocity or spin.
    Integral(Component),
}

/// The name in case files.
impl fmt::Display for Recorded {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Component(component) => component.fmt(formatter),
            Self::Integral(component) => {
                formatter.write_str(&component.integral().unwrap_or_default())
            }
        }
    }
}

/// What else is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Time between two lines of the energy ledger, s; 0: so that there are at most 1000.
    pub ledger_interval: f64,
    /// Time between two snapshots of all fields, s; 0: none.
    pub snapshot_interval: f64,
    /// Velocities and spins whose integrals in time, displacements and rotations, are kept.
    pub integrals: Vec<Component>,
    /// What pictures show.
    pub picture: Picture,
    /// Values of it on which lines are drawn, in its unit; `None`: as suits the picture.
    pub contours: Option<Vec<f64>>,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Picture {
    /// The magnitude of the velocity.
    #[default]
    Speed,
    /// A component of the state.
    Component(Component),
    /// The integral in time of a velocity or spin.
    Integral(Component),
    /// Plastic dissipation per volume.
    Dissipation,
}

impl Picture {
    /// Name in case files.
    pub fn name(self) -> String {
        match self {
            Self::Speed => "speed".to_owned(),
            Self::Component(component) => component.to_string(),
            Self::Integral(component) => component.integral().unwrap_or_default(),
            Self::Dissipation => "dissipation".to_owned(),
        }
    }
}

impl Dynamics {
    /// An error at a key of these sections, as in `load[0].amplitude`; indices from 0.
    pub fn locate(
        &self,
        path: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> CaseError {
        self.places.error(path, found, allowed)
    }

    /// The region of each cell, by its place in [`regions`](Self::regions), the first axis running
    /// fastest; all 0 without regions. A cell belongs to the region that holds its centre.
    ///
    /// # Errors
    /// Two regions hold the same cell, a cell is in none, a region holds none, or memory is short.
    pub fn media_of_cells(&self) -> Result<Vec<u16>, CaseError> {
        let count = self.grid.count();
        let mut media = Vec::new();
        if media.try_reserve_exact(count).is_err() {
            let found = format!("no memory for {count} cells");
            return Err(self.places.error("grid.cells", found, "ask for fewer"));
        }
        if self.regions.is_empty() {
            media.resize(count, 0);
            return Ok(media);
        }
        let mut is_used = vec![false; self.regions.len()];
        let rest = self.regions.iter().position(|region| region.shape == Shape::Rest);
        let mut index = vec![0; self.grid.dimensions()];
        let mut centre: Vec<f64> = (0..index.len()).map(|axis| self.grid.centre(axis, 0)).collect();
        for _ in 0..count {
            let medium = self.region_at(&centre)?.or(rest);
            let Some(medium) = medium else {
                return Err(self.places.error(
                    "region",
                    format!("no region holds the cell at {centre:?}"),
                    "add [[region]] with shape = \"rest\", or make the regions larger",
                ));
            };
            is_used[medium] = true;
            media.push(medium as u16); // at most MOST_REGIONS are read
            for axis in 0..index.len() {
                index[axis] = (index[axis] + 1) % self.grid.cells[axis];
                centre[axis] = self.grid.centre(axis, index[axis]);
                if index[axis] > 0 {
                    break;
                }
            }
        }
        match is_used.iter().position(|is_used| !is_used) {
            Some(unused) => Err(self.places.error(
                &format!("region[{unused}]"),
                "no cell has its centre in it",
                "make it larger than a cell, move it into the grid, or leave it out",
            )),
            None => Ok(media),
        }
    }

    /// The one region that holds a point, that of the rest aside.
    fn region_at(&self, x: &[f64]) -> Result<Option<usize>, CaseError> {
        let mut holders =
            (0..self.regions.len()).filter(|&region| self.regions[region].shape.contains(x));
        let first = holders.next();
        match (first, holders.next()) {
            (Some(first), Some(second)) => {
                let place = self.places.of(&format!("region[{first}]"));
                let found = format!("overlaps region[{first}] ({place}) in the cell at {x:?}");
                let allowed = "give every cell to one region: move or shrink one of the two";
                Err(self.places.error(&format!("region[{second}]"), found, allowed))
            }
            _ => Ok(first),
        }
    }
}
