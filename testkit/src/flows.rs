//! Constants of the granular-flow models by name.

use models::InputError;
use models::flow::{FlowKind, Model};

/// Constants of all flow models; each model uses its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Angle of internal friction φ, rad.
    pub friction_angle: f64,
    /// Angle of dilatancy ν, rad.
    pub dilatancy_angle: f64,
    /// Cohesion c, Pa.
    pub cohesion: f64,
    /// Moment of inertia per unit mass I, m²; Harris–Grekova only.
    pub moment_of_inertia: Option<f64>,
    /// Rotational yield strength m, Pa; Harris–Grekova only.
    pub rotational_strength: Option<f64>,
}

impl Parameters {
    /// Builds the model of `kind`; constants that are `None` here are NaN.
    ///
    /// # Errors
    /// A constant is out of range.
    ///
    /// # Panics
    /// The model has a constant that is not listed here.
    pub fn model(&self, kind: FlowKind) -> Result<Model, InputError> {
        Model::new(kind, &self.constants(kind))
    }

    /// Returns the constants of a model in the order of its registry entry; constants that are `None` here are NaN.
    ///
    /// # Panics
    /// The model has a constant that is not listed here.
    pub fn constants(&self, kind: FlowKind) -> Vec<f64> {
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
