//! The list of granular-flow models.

use super::state::{self, Background, Coulomb, Flow, FlowRule, Rotation, State};
use crate::closed_form::ClosedForm;
use crate::double_shearing::{self, parameters::DoubleShearing};
use crate::elementary::Elementary;
use crate::free_rotating;
use crate::harris_grekova::{self, parameters::HarrisGrekova};
use crate::input::InputError;
use crate::plastic_potential::{self, parameters::PlasticPotential};
use crate::system::LinearisedSystem;

/// The granular-flow models by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Harris & Grekova (2005).
    HarrisGrekova,
    /// Spencer (1964); Mehrabadi & Cowin (1978) for ν > 0.
    DoubleShearing,
    /// Coaxial plastic potential with its own dilatancy angle.
    PlasticPotential,
    /// Double-sliding free-rotating (de Josselin de Jong 1977).
    FreeRotating,
}

impl Kind {
    /// All models, in the order in which they are listed.
    pub const ALL: [Self; 4] =
        [Self::HarrisGrekova, Self::DoubleShearing, Self::PlasticPotential, Self::FreeRotating];

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::HarrisGrekova => "harris-grekova",
            Self::DoubleShearing => "double-shearing",
            Self::PlasticPotential => "plastic-potential",
            Self::FreeRotating => "free-rotating",
        }
    }

    /// Name in titles and legends.
    pub const fn title(self) -> &'static str {
        match self {
            Self::HarrisGrekova => "Harris–Grekova",
            Self::DoubleShearing => "double shearing",
            Self::PlasticPotential => "plastic potential",
            Self::FreeRotating => "double-sliding free-rotating",
        }
    }

    /// The model of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// Material constants as a case names them; unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Angle of internal friction φ, rad; 0 < φ < π/2.
    pub friction_angle: f64,
    /// Angle of dilatancy ν, rad; 0 ≤ ν < φ, for the plastic potential 0 ≤ ν < π/2.
    pub dilatancy_angle: f64,
    /// Cohesion c, Pa; ≥ 0.
    pub cohesion: f64,
    /// Moment of inertia per unit mass I, m²; > 0. Harris–Grekova alone, required there.
    pub moment_of_inertia: Option<f64>,
    /// Rotational yield strength m, Pa; ≥ 0. Harris–Grekova alone, required there.
    pub rotational_strength: Option<f64>,
}

/// A granular-flow model with checked constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model {
    /// See [`harris_grekova`].
    HarrisGrekova(HarrisGrekova),
    /// See [`double_shearing`].
    DoubleShearing(DoubleShearing),
    /// See [`plastic_potential`].
    PlasticPotential(PlasticPotential),
    /// See [`free_rotating`]; its constants are those of double shearing.
    FreeRotating(DoubleShearing),
}

impl Model {
    /// Checks the constants.
    ///
    /// # Errors
    /// The first constant out of range, or missing, by the key of the case file.
    pub fn new(kind: Kind, given: &Parameters) -> Result<Self, InputError> {
        let coulomb = Coulomb::new(given.friction_angle, given.cohesion)?;
        let nu = given.dilatancy_angle;
        match kind {
            Kind::HarrisGrekova => HarrisGrekova::new(
                coulomb,
                nu,
                required("model.moment_of_inertia", given.moment_of_inertia)?,
                required("model.rotational_strength", given.rotational_strength)?,
            )
            .map(Self::HarrisGrekova),
            Kind::DoubleShearing => DoubleShearing::new(coulomb, nu).map(Self::DoubleShearing),
            Kind::FreeRotating => DoubleShearing::new(coulomb, nu).map(Self::FreeRotating),
            Kind::PlasticPotential => {
                PlasticPotential::new(coulomb, nu).map(Self::PlasticPotential)
            }
        }
    }

    /// Which model this is.
    pub fn kind(&self) -> Kind {
        match self {
            Self::HarrisGrekova(_) => Kind::HarrisGrekova,
            Self::DoubleShearing(_) => Kind::DoubleShearing,
            Self::PlasticPotential(_) => Kind::PlasticPotential,
            Self::FreeRotating(_) => Kind::FreeRotating,
        }
    }

    /// The yield condition.
    pub fn coulomb(&self) -> &Coulomb {
        match self {
            Self::HarrisGrekova(m) => &m.coulomb,
            Self::DoubleShearing(m) | Self::FreeRotating(m) => &m.coulomb,
            Self::PlasticPotential(m) => &m.coulomb,
        }
    }

    /// The coefficients of the flow rule.
    pub fn flow_rule(&self) -> FlowRule {
        match self {
            Self::HarrisGrekova(m) => m.flow_rule(),
            Self::DoubleShearing(m) | Self::FreeRotating(m) => m.flow_rule(),
            Self::PlasticPotential(m) => m.flow_rule(),
        }
    }

    /// What the model takes for the rotation of the material.
    pub fn rotation(&self) -> Rotation {
        match self {
            Self::HarrisGrekova(m) => Rotation::IntrinsicSpin {
                moment_of_inertia: m.moment_of_inertia,
                strength: m.rotational_strength,
            },
            Self::DoubleShearing(_) => Rotation::StressAxes,
            Self::PlasticPotential(_) => Rotation::None,
            Self::FreeRotating(_) => Rotation::Free,
        }
    }

    /// Whether the density evolves: ν > 0.
    pub fn is_dilatant(&self) -> bool {
        self.flow_rule().dilatant
    }

    /// The background that a state and this model's flow rule and balance laws determine.
    ///
    /// # Errors
    /// An input out of range, one that the model does not use, or one that contradicts the flow
    /// rule or a balance law, with the residual of the equation that it breaks.
    pub fn background(&self, state: &State) -> Result<Background, InputError> {
        state::background(self.coulomb(), &self.flow_rule(), self.rotation(), state)
    }

    /// Writes the linearised equations about `flow` into `system`.
    pub fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>) {
        match self {
            Self::HarrisGrekova(m) => harris_grekova::symbol::write(m, flow, system),
            Self::DoubleShearing(m) => double_shearing::symbol::write(m, flow, system),
            Self::PlasticPotential(m) => plastic_potential::symbol::write(m, flow, system),
            Self::FreeRotating(m) => free_rotating::symbol::write(m, flow, system),
        }
    }

    /// The verdict on `flow` where a formula decides it beyond doubt; `None` where only the
    /// linearised equations can.
    pub fn closed_form(&self, flow: &Flow) -> Option<ClosedForm> {
        match self {
            Self::HarrisGrekova(m) => harris_grekova::closed_form::closed_form(m, flow),
            Self::DoubleShearing(m) => double_shearing::closed_form::closed_form(m, flow),
            Self::PlasticPotential(m) => plastic_potential::closed_form::closed_form(m, flow),
            Self::FreeRotating(m) => Some(free_rotating::closed_form::closed_form(m)),
        }
    }

    /// The greatest wave number on which the background itself varies, 1/m: frozen coefficients
    /// say something of waves much shorter than that. 0 for a uniform background.
    pub fn gradient_wave_number(&self, flow: &Flow) -> f64 {
        let size = |g: [f64; 2]| g[0].root_sum_square(g[1]);
        let inertia = match self {
            Self::HarrisGrekova(m) => size(flow.inertia_gradient) / m.moment_of_inertia,
            _ => 0.0,
        };
        [
            size(flow.pressure_gradient) * self.coulomb().friction_angle.cr_sin()
                / flow.stress.deviator.value,
            size(flow.stress_angle_gradient),
            size(flow.density_gradient) / flow.density,
            size(flow.spin_gradient) / flow.shear_rate,
            inertia,
        ]
        .into_iter()
        .fold(0.0, f64::max)
    }

    /// The bound on |Δ| inside which the leading growth rate is nowhere positive, rad; `None` for
    /// a model whose verdict does not turn on the non-coaxiality.
    pub fn noncoaxiality_bound(&self) -> Option<f64> {
        match self {
            Self::HarrisGrekova(m) => Some(m.noncoaxiality_bound()),
            _ => None,
        }
    }
}

fn required(key: &'static str, value: Option<f64>) -> Result<f64, InputError> {
    value.ok_or_else(|| InputError {
        key,
        found: "nothing".into(),
        allowed: "this model needs a number here".into(),
    })
}
