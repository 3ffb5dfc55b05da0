//! Constants of the granular-flow models by name.

use crate::random::RandomNumbers;
use models::InputError;
use models::flow::{FlowKind, Model};
use models::registry;
use std::ops::Range;

/// Range of the dilatancy angle ν of a test case; φ is the friction angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DilatancyKind {
    /// ν = 0.
    Zero,
    /// ν > 0.
    Positive,
    /// ν = φ (associated flow), for the plastic potential.
    Associated,
}

/// Returns a random dilatancy angle ν, rad, of the range `dilatancy` for a flow model with the friction angle φ: for a
/// plastic potential, where ν may exceed φ, uniform in `potential_angles`; else ν/φ is uniform in `ratios`.
pub fn random_dilatancy_angle(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
    friction_angle: f64,
    [potential_angles, ratios]: [Range<f64>; 2],
) -> f64 {
    match dilatancy {
        DilatancyKind::Zero => 0.0,
        DilatancyKind::Associated => friction_angle,
        DilatancyKind::Positive if kind == registry::PLASTIC_POTENTIAL => {
            random.uniform(potential_angles.start, potential_angles.end)
        }
        DilatancyKind::Positive => friction_angle * random.uniform(ratios.start, ratios.end),
    }
}

/// Every flow model of the crate `models` with every kind of dilatancy that it admits.
pub const MODEL_CASES: [(FlowKind, DilatancyKind); 9] = [
    (registry::HARRIS_GREKOVA, DilatancyKind::Zero),
    (registry::HARRIS_GREKOVA, DilatancyKind::Positive),
    (registry::DOUBLE_SHEARING, DilatancyKind::Zero),
    (registry::DOUBLE_SHEARING, DilatancyKind::Positive),
    (registry::PLASTIC_POTENTIAL, DilatancyKind::Zero),
    (registry::PLASTIC_POTENTIAL, DilatancyKind::Positive),
    (registry::PLASTIC_POTENTIAL, DilatancyKind::Associated),
    (registry::FREE_ROTATING, DilatancyKind::Zero),
    (registry::FREE_ROTATING, DilatancyKind::Positive),
];

/// The [`MODEL_CASES`] with as many equations as unknowns.
pub const SQUARE_MODEL_CASES: [(FlowKind, DilatancyKind); 7] =
    *MODEL_CASES.first_chunk().expect("seven of nine");

/// Constants of all flow models; a model uses those that its registry entry lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowParameters {
    /// Angle of internal friction φ, rad.
    pub friction_angle: f64,
    /// Angle of dilatancy ν, rad.
    pub dilatancy_angle: f64,
    /// Cohesion c, Pa.
    pub cohesion: f64,
    /// Moment of inertia per unit mass I, m²; used by Harris–Grekova only, else `None`.
    pub moment_of_inertia: Option<f64>,
    /// Rotational yield strength m, Pa; used by Harris–Grekova only, else `None`.
    pub rotational_strength: Option<f64>,
}

impl FlowParameters {
    /// Builds the model of `kind`; constants that are `None` are passed as NaN, which the model rejects.
    ///
    /// # Errors
    /// A constant is out of range.
    ///
    /// # Panics
    /// The model has a constant that is no field of [`FlowParameters`].
    pub fn build_model(&self, kind: FlowKind) -> Result<Model, InputError> {
        Model::new(kind, &self.to_constants(kind))
    }

    /// Returns the constants of the model `kind` in the order of its registry entry; constants that are `None` become
    /// NaN.
    ///
    /// # Panics
    /// The model has a constant that is no field of [`FlowParameters`].
    pub fn to_constants(&self, kind: FlowKind) -> Vec<f64> {
        let value = |name| match name {
            "friction_angle" => self.friction_angle,
            "dilatancy_angle" => self.dilatancy_angle,
            "cohesion" => self.cohesion,
            "moment_of_inertia" => self.moment_of_inertia.unwrap_or(f64::NAN),
            "rotational_strength" => self.rotational_strength.unwrap_or(f64::NAN),
            other => panic!("no constant is called {other}"),
        };
        kind.parameters().iter().map(|own| value(own.name)).collect()
    }
}
