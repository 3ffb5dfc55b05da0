//! Boundary conditions, loads on boundaries, and sources.
//!
//! To add a condition, add a variant of [`Condition`], its signs and shifts to `GhostRule::new` in `ghosts`, and the
//! variant to `CONDITIONS` in `contraction`, which tests that no state gains energy; its keys are in
//! `cases::dynamics::boundary`, its translation in `setup::solid_run::boundary` of the program.

use crate::solid::medium::Medium;
use models::solid::waves::SolidField;
use std::sync::Arc;

/// Dimensionless function of the time, s, that multiplies the amplitudes of a load or source.
pub type Signal = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// Boundary condition of a wave pair on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// Prescribed velocity, m/s, or spin, rad/s.
    Velocity(f64),
    /// Prescribed stress, Pa, or couple stress, N/m; tension positive at both ends of the axis.
    Traction(f64),
    /// Non-reflecting: the incoming characteristic is zero, which is exact at normal incidence.
    NonReflecting,
    /// Symmetry plane with odd velocity or spin and even stress: the velocity vanishes on it.
    OddVelocity,
    /// Symmetry plane with even velocity or spin and odd stress: the traction vanishes on it.
    OddStress,
}

impl Condition {
    /// Whether velocity or traction is prescribed, so that the face reflects without being a symmetry plane.
    pub(crate) fn is_reflecting(&self) -> bool {
        matches!(self, Self::Velocity(_) | Self::Traction(_))
    }
}

/// Boundary condition at an end of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// Periodic: the grid continues at the opposite end of the axis.
    Periodic,
    /// Rigid: all velocities and spins vanish.
    Fixed,
    /// Free: all tractions and couples vanish.
    Free,
    /// Non-reflecting: incoming characteristics are zero, which is exact at normal incidence.
    NonReflecting,
    /// One condition per wave pair of the axis, in their order.
    ByPair(Vec<Condition>),
    /// Conditions by wave pair, then by face (first of the other axes fastest).
    ByFace(Vec<Vec<Condition>>),
}

impl Boundary {
    /// Symmetry plane normal to `axis`: normal displacement and shear tractions vanish. Spins transform as axial
    /// vectors: the component along the normal is even.
    pub fn new_symmetry(medium: &Medium, axis: usize) -> Self {
        Self::new_mirror_plane(medium, axis, true)
    }

    /// Antisymmetry plane normal to `axis`: fields continue as the mirror image with the opposite sign.
    pub fn new_antisymmetry(medium: &Medium, axis: usize) -> Self {
        Self::new_mirror_plane(medium, axis, false)
    }

    fn new_mirror_plane(medium: &Medium, axis: usize, is_even: bool) -> Self {
        let condition = |field: SolidField| {
            let is_odd = match field {
                SolidField::Velocity(i) => i == axis,
                SolidField::Spin(k) => k != axis,
                _ => false,
            };
            if is_odd == is_even { Condition::OddVelocity } else { Condition::OddStress }
        };
        Self::ByPair(medium.pairs[axis].iter().map(|pair| condition(pair.velocity)).collect())
    }

    /// Whether any face is non-reflecting, for any wave pair.
    pub(crate) fn has_open_faces(&self) -> bool {
        let is_open = |own: &Condition| *own == Condition::NonReflecting;
        match self {
            Self::Periodic | Self::Fixed | Self::Free => false,
            Self::NonReflecting => true,
            Self::ByPair(conditions) => conditions.iter().any(is_open),
            Self::ByFace(conditions) => conditions.iter().flatten().any(is_open),
        }
    }

    /// Returns the condition of a wave pair on a face; `None` on periodic boundaries.
    pub(crate) fn condition(&self, pair: usize, face: usize) -> Option<Condition> {
        Some(match self {
            Self::Periodic => return None,
            Self::Fixed => Condition::Velocity(0.0),
            Self::Free => Condition::Traction(0.0),
            Self::NonReflecting => Condition::NonReflecting,
            Self::ByPair(conditions) => conditions[pair],
            Self::ByFace(conditions) => conditions[pair][face],
        })
    }
}

/// Time-dependent velocities or tractions on faces of a boundary, added to those of the conditions of the faces;
/// without effect on non-reflecting faces.
#[derive(Clone)]
pub struct Load {
    /// Axis normal to the boundary, from 0.
    pub axis: usize,
    /// End of the axis: 0 lower, 1 upper.
    pub end: usize,
    /// Index of the wave pair, in the order of the medium.
    pub pair: usize,
    /// Faces (first of the other axes fastest), and amplitudes in the unit of the condition of the face.
    pub faces: Vec<(usize, f64)>,
    /// Time function that multiplies the amplitudes.
    pub signal: Signal,
}

/// A source in the interior: body force, couple or moment tensor.
#[derive(Clone)]
pub struct Source {
    /// Cells (first axis fastest) and their shares of the source; the shares add up to 1, or to another value if the
    /// source extends beyond a plane of symmetry or antisymmetry (see [`point_kernel`](crate::solid::point_kernel)).
    pub cells: Vec<(usize, f64)>,
    /// Components of the force (N, by velocity), of the couple (N·m, by spin) or of the moment tensor (N·m, by stress,
    /// which the moment reduces); per metre in plane strain.
    pub amplitudes: Vec<(SolidField, f64)>,
    /// Time function that multiplies the amplitudes.
    pub signal: Signal,
}
