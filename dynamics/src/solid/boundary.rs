//! Boundary conditions, loads on boundaries, and sources inside.

use crate::solid::medium::Medium;
use models::solid::waves::Field;
use std::sync::Arc;

/// A function of time, s, without unit.
pub type Signal = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// Boundary condition of a face for a pair of waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// Velocity (m/s) or spin (rad/s) of the side.
    Velocity(f64),
    /// Traction (Pa) or couple (N/m) on the side: the stress, tension positive, whatever the side.
    Traction(f64),
    /// Non-reflecting: the incoming characteristic is zero, exact at normal incidence.
    NonReflecting,
    /// A plane of symmetry across which the velocity or spin is odd and the stress even: no velocity on it.
    OddVelocity,
    /// A plane of symmetry across which the velocity or spin is even and the stress odd: no traction on it.
    OddStress,
}

impl Condition {
    /// Whether the side reflects, and is not a plane of symmetry.
    pub(crate) fn reflects(&self) -> bool {
        matches!(self, Self::Velocity(_) | Self::Traction(_))
    }
}

/// Boundary condition at an end of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// The opposite side.
    Periodic,
    /// A body that does not move: all velocities and spins vanish.
    Fixed,
    /// Nothing: all tractions and couples vanish.
    Free,
    /// Non-reflecting: incoming characteristics are zero, exact at normal incidence.
    NonReflecting,
    /// A condition for each pair of the axis, in their order.
    Given(Vec<Condition>),
    /// The same for each face of the side: by pair, then by face, the first of the other axes fastest.
    ByFace(Vec<Vec<Condition>>),
}

impl Boundary {
    /// A side in which the medium is mirrored along `axis`: displacement along the normal vanishes, and
    /// so do the tractions across it. Spins are mirrored as axial vectors are, those about the normal
    /// unchanged.
    pub fn symmetry(medium: &Medium, axis: usize) -> Self {
        Self::mirror(medium, axis, true)
    }

    /// A side in which the medium is mirrored with the opposite sign.
    pub fn antisymmetry(medium: &Medium, axis: usize) -> Self {
        Self::mirror(medium, axis, false)
    }

    fn mirror(medium: &Medium, axis: usize, is_even: bool) -> Self {
        let condition = |field: Field| {
            let is_odd = match field {
                Field::Velocity(i) => i == axis,
                Field::Spin(k) => k != axis,
                Field::Stress(..) | Field::Couple(..) | Field::ViscousStrain(..) => false,
            };
            if is_odd == is_even { Condition::OddVelocity } else { Condition::OddStress }
        };
        Self::Given(medium.pairs[axis].iter().map(|pair| condition(pair.velocity)).collect())
    }

    /// The condition of a pair on a face; `None` on periodic sides.
    pub(crate) fn condition(&self, pair: usize, face: usize) -> Option<Condition> {
        Some(match self {
            Self::Periodic => return None,
            Self::Fixed => Condition::Velocity(0.0),
            Self::Free => Condition::Traction(0.0),
            Self::NonReflecting => Condition::NonReflecting,
            Self::Given(conditions) => conditions[pair],
            Self::ByFace(conditions) => conditions[pair][face],
        })
    }
}

/// Values that faces of a side are given in the course of time, added to those of their conditions.
#[derive(Clone)]
pub struct Load {
    /// Axis of the side, from 0.
    pub axis: usize,
    /// 0 for the side at the axis' lower end, 1 for the other one.
    pub end: usize,
    /// The pair of waves, in the order of the medium.
    pub pair: usize,
    /// Faces, the first of the other axes fastest, and amplitudes in the unit of their condition.
    pub faces: Vec<(usize, f64)>,
    /// What they are multiplied by.
    pub signal: Signal,
}

/// A source inside: body force, couple or moment tensor.
#[derive(Clone)]
pub struct Source {
    /// Cells, the first axis running fastest, and their shares, which add up to 1.
    pub cells: Vec<(usize, f64)>,
    /// Components of the force (N, by the velocity that it drives), of the couple (N·m, by the spin) or of
    /// the moment tensor (N·m, by the stress that it relieves); per metre in plane strain.
    pub amplitudes: Vec<(Field, f64)>,
    /// What they are multiplied by.
    pub signal: Signal,
}
