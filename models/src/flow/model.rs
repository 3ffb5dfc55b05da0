//! A granular-flow model: its entry in the registry, and the model with checked constants.

use super::background::background;
use super::state::{Background, Coulomb, Flow, FlowRule, Rotation, State};
use crate::common::elementary::Elementary;
use crate::common::input::InputError;
use crate::common::parameter::Parameter;
use crate::common::system::LinearisedSystem;
use crate::flow::closed_form::ClosedForm;
use std::fmt;
use std::sync::Arc;

/// A granular-flow model as the [registry](crate::registry) lists it.
pub struct FlowModel {
    /// Name in case files, as in `harris-grekova`.
    pub name: &'static str,
    /// Name in titles and legends.
    pub title: &'static str,
    /// Its constants. Those named like a constant of another flow model must have the same unit.
    pub parameters: &'static [Parameter],
    /// What it takes for the rotation of the material.
    pub rotation: RotationKind,
    /// Checks the constants, which are in the order of `parameters`, in SI units and rad.
    pub build: Build,
}

/// From a list of constants to a model that has checked them.
pub type Build = fn(&[f64]) -> Result<Arc<dyn FlowLaw>, InputError>;

/// What a model takes for the rotation of the material: decides which numbers a state has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationKind {
    /// An intrinsic spin with a balance of its own.
    IntrinsicSpin,
    /// The rotation of the principal axes of stress.
    StressAxes,
    /// A spin that nothing determines.
    Free,
    /// None: stress and deformation rate are coaxial by definition.
    None,
}

/// A granular-flow model with checked constants: what its equations are made of.
pub trait FlowLaw: fmt::Debug + Send + Sync {
    /// Takes other constants, as [`FlowModel::build`] does.
    ///
    /// # Errors
    /// The constant that is out of range; the model stays as it was.
    fn set(&mut self, constants: &[f64]) -> Result<(), InputError>;

    /// The yield condition.
    fn coulomb(&self) -> &Coulomb;

    /// The coefficients of the flow rule.
    fn flow_rule(&self) -> FlowRule;

    /// What the model takes for the rotation of the material.
    fn rotation(&self) -> Rotation;

    /// Writes the linearised equations about `flow` into `system`.
    fn symbol(&self, flow: &Flow, system: &mut LinearisedSystem<2>);

    /// The verdict on `flow` where a formula decides it beyond doubt; `None` where only the
    /// linearised equations can.
    fn closed_form(&self, flow: &Flow) -> Option<ClosedForm> {
        let _ = flow;
        None
    }

    /// The bound on |Δ| inside which the leading growth rate is nowhere positive, rad; `None` for
    /// a model whose verdict does not turn on the non-coaxiality.
    fn noncoaxiality_bound(&self) -> Option<f64> {
        None
    }
}

/// An entry of the registry by reference; two are equal if they have the same name.
#[derive(Clone, Copy)]
pub struct FlowKind(&'static FlowModel);

impl FlowKind {
    /// An entry of the registry.
    pub const fn new(model: &'static FlowModel) -> Self {
        Self(model)
    }

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        self.0.name
    }

    /// Name in titles and legends.
    pub const fn title(self) -> &'static str {
        self.0.title
    }

    /// Its constants.
    pub const fn parameters(self) -> &'static [Parameter] {
        self.0.parameters
    }

    /// What it takes for the rotation of the material.
    pub const fn rotation(self) -> RotationKind {
        self.0.rotation
    }

    /// Whether stress and deformation rate are coaxial by definition.
    pub const fn is_coaxial(self) -> bool {
        matches!(self.0.rotation, RotationKind::None)
    }
}

impl PartialEq for FlowKind {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for FlowKind {}

impl std::hash::Hash for FlowKind {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name().hash(state);
    }
}

impl fmt::Debug for FlowKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A granular-flow model with checked constants.
#[derive(Clone, Debug)]
pub struct Model {
    kind: FlowKind,
    law: Arc<dyn FlowLaw>,
}

impl std::ops::Deref for Model {
    type Target = dyn FlowLaw;

    fn deref(&self) -> &Self::Target {
        &*self.law
    }
}

impl Model {
    /// Checks the constants, which are in the order of the kind's parameters, in SI units and rad.
    ///
    /// # Errors
    /// The first constant out of range.
    pub fn new(kind: FlowKind, constants: &[f64]) -> Result<Self, InputError> {
        Ok(Self { kind, law: (kind.0.build)(constants)? })
    }

    /// Takes other constants, in the memory that it has unless a clone has it as well.
    ///
    /// # Errors
    /// The first constant out of range; the model stays as it was.
    pub fn set(&mut self, constants: &[f64]) -> Result<(), InputError> {
        match Arc::get_mut(&mut self.law) {
            Some(law) => law.set(constants)?,
            None => self.law = (self.kind.0.build)(constants)?,
        }
        Ok(())
    }

    /// Which model this is.
    pub fn kind(&self) -> FlowKind {
        self.kind
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
        background(self.coulomb(), &self.flow_rule(), self.rotation(), state)
    }

    /// The greatest wave number on which the background itself varies, 1/m: frozen coefficients
    /// say something of waves much shorter than that. 0 for a uniform background.
    pub fn gradient_wave_number(&self, flow: &Flow) -> f64 {
        let size = |g: [f64; 2]| g[0].root_sum_square(g[1]);
        let inertia = match self.rotation() {
            Rotation::IntrinsicSpin { moment_of_inertia, .. } => {
                size(flow.inertia_gradient) / moment_of_inertia
            }
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
}
