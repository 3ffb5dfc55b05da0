//! A granular-flow model: its entry in the registry, and the model with checked constants.

use super::background::complete_background;
use super::state::{
    Background, DeformingFlow, FlowRule, MaterialRotation, MaterialState, MohrCoulomb,
};
use crate::common::elementary::Elementary;
use crate::common::input::InputError;
use crate::common::kind::impl_kind_by_name;
use crate::common::parameter::Parameter;
use crate::common::rounding::Rounded;
use crate::common::system::LinearisedSystem;
use crate::common::taylor_model::TaylorModel;
use crate::flow::closed_form::ClosedFormVerdict;
use std::f64::consts::FRAC_PI_4;
use std::fmt;
use std::sync::Arc;

/// A granular-flow model as the [registry](crate::registry) lists it.
pub struct FlowModel {
    /// Name of the flow model in case files, e.g. `harris-grekova`.
    pub name: &'static str,
    /// Name in titles and legends.
    pub title: &'static str,
    /// Constants of the model. Constants of the same name in different flow models and solids must have the same unit.
    pub parameters: &'static [Parameter],
    /// Kind of material rotation in the flow rule.
    pub rotation: RotationKind,
    /// Constructor from the constants in the order of `parameters`, in SI units and rad.
    pub constructor: FlowConstructor,
}

/// Constructor of a flow law: checks a list of constants and returns the law.
pub type FlowConstructor = fn(&[f64]) -> Result<Arc<dyn FlowLaw>, InputError>;

/// Kind of material rotation in the flow rule of a model; it determines which quantities a state has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RotationKind {
    /// Intrinsic spin with its own balance equation.
    IntrinsicSpin,
    /// Rotation rate of the principal stress axes.
    StressAxes,
    /// Spin without an equation that determines it.
    Free,
    /// No rotation: stress and deformation rate are coaxial by definition.
    None,
}

/// Equations of a granular-flow model with checked constants.
pub trait FlowLaw: fmt::Debug + Send + Sync {
    /// Replaces the constants, in the order of [`FlowModel::parameters`], in SI units and rad.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range; the model is unchanged.
    fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError>;

    /// Mohr–Coulomb yield condition of the model.
    fn coulomb(&self) -> &MohrCoulomb;

    /// Coefficients of the flow rule.
    fn flow_rule(&self) -> FlowRule;

    /// Material rotation in the flow rule.
    fn rotation(&self) -> MaterialRotation;

    /// Writes the linearised equations about `flow` into `system`.
    fn write_symbol(&self, flow: &DeformingFlow, system: &mut LinearisedSystem<2>);

    /// Closed-form verdict on `flow`; `None` if no formula decides it with certainty.
    fn closed_form_verdict(&self, flow: &DeformingFlow) -> Option<ClosedFormVerdict> {
        let _ = flow;
        None
    }

    /// Names and enclosures of the conditions for well-posedness over a box of states: a state is well-posed if all conditions are
    /// positive, and ill-posed if one is negative. The box is that of these enclosures of the constants, in the order of
    /// [`FlowModel::parameters`], and of the non-coaxiality Δ, rad. All states of the box are fully deforming; `flow` is
    /// one of them and has their gradients and accelerations; no number that varies over the box may be taken from it or
    /// from `self`. `None` if no formula is known for them.
    fn box_conditions(
        &self,
        flow: &DeformingFlow,
        constants: &[TaylorModel],
        noncoaxiality: TaylorModel,
    ) -> Option<Vec<(&'static str, TaylorModel)>> {
        let _ = (flow, constants, noncoaxiality);
        None
    }

    /// Bound on the non-coaxiality |Δ|, rad, below which the leading growth rate is not positive in any direction;
    /// `None` for a model whose verdict does not depend on the non-coaxiality.
    fn noncoaxiality_bound(&self) -> Option<f64> {
        None
    }

    /// Enclosure of [`noncoaxiality_bound`](Self::noncoaxiality_bound), rad, over a box of constants, in the order of
    /// [`FlowModel::parameters`].
    fn box_noncoaxiality_bound(&self, constants: &[TaylorModel]) -> Option<TaylorModel> {
        let _ = constants;
        None
    }
}

/// Reference to a registry entry of a flow model; equality compares names.
#[derive(Clone, Copy)]
pub struct FlowKind(&'static FlowModel);

impl FlowKind {
    /// A reference to the registry entry `model`.
    pub const fn new(model: &'static FlowModel) -> Self {
        Self(model)
    }

    /// Name of the model in case files.
    pub const fn name(self) -> &'static str {
        self.0.name
    }

    /// Name in titles and legends.
    pub const fn title(self) -> &'static str {
        self.0.title
    }

    /// Constants of the model.
    pub const fn parameters(self) -> &'static [Parameter] {
        self.0.parameters
    }

    /// Kind of material rotation in the flow rule.
    pub const fn rotation(self) -> RotationKind {
        self.0.rotation
    }

    /// Whether stress and deformation rate are coaxial by definition.
    pub const fn is_coaxial(self) -> bool {
        matches!(self.0.rotation, RotationKind::None)
    }
}

impl_kind_by_name!(FlowKind);

/// Slip on a family of parallel slip lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slip {
    /// Angle of the slip lines from x₁, rad.
    pub angle: f64,
    /// Rate k of slip, 1/s: difference of velocity over distance, of lines with dilatancy along the direction at the angle
    /// ν to them. Positive in the sense of the shear stress on the lines, negative if reversed.
    pub rate: Rounded,
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
    /// Creates a model of `kind` from its constants, in the order of the kind's parameters, in SI units and rad.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range; the error names the first such constant.
    pub fn new(kind: FlowKind, constants: &[f64]) -> Result<Self, InputError> {
        Ok(Self { kind, law: (kind.0.constructor)(constants)? })
    }

    /// Replaces the constants, in the order of the kind's parameters, in SI units and rad; allocates only if a clone of
    /// this model shares its memory.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range; the model is unchanged.
    pub fn set_constants(&mut self, constants: &[f64]) -> Result<(), InputError> {
        match Arc::get_mut(&mut self.law) {
            Some(law) => law.set_constants(constants)?,
            None => self.law = (self.kind.0.constructor)(constants)?,
        }
        Ok(())
    }

    /// Registry entry of the model.
    pub fn kind(&self) -> FlowKind {
        self.kind
    }

    /// Whether the density evolves: ν > 0.
    pub fn is_dilatant(&self) -> bool {
        self.flow_rule().is_dilatant
    }

    /// Completes `state` to a background by the flow rule of the model and the balance laws.
    ///
    /// # Errors
    /// An input is out of range or not finite, is not used by the model, or contradicts the flow rule or a balance law;
    /// in the last case the error gives the residual of the violated equation.
    pub fn background(&self, state: &MaterialState) -> Result<Background, InputError> {
        complete_background(self.coulomb(), &self.flow_rule(), self.rotation(), state)
    }

    /// Slip on both families of slip lines, those at ψ − ε and ψ + ε with ε = π/4 + φ/2; `None` for a coaxial model. The
    /// rates are the shear strengths k of Harris & Grekova (2005), eq. 38, by the flow rule with the material rotation ω
    ///
    /// ```text
    /// k₁ + k₂ = 2 Q_D cos 2Δ / cos(φ − ν),   k₁ − k₂ = 2 (ω − s₂₁) / cos ν.
    /// ```
    pub fn slips(&self, flow: &DeformingFlow) -> Option<[Slip; 2]> {
        if self.rotation() == MaterialRotation::None {
            return None;
        }
        let rule = self.flow_rule();
        let mean = Rounded::from_rounded(flow.shear_rate)
            * (2.0 * flow.rounded_noncoaxiality()).cos()
            / rule.volume_coefficient;
        let half_difference = flow.relative_rotation / rule.shear_coefficient;
        let epsilon = FRAC_PI_4 + 0.5 * self.coulomb().friction_angle;
        Some([
            Slip { angle: flow.stress.angle - epsilon, rate: mean + half_difference },
            Slip { angle: flow.stress.angle + epsilon, rate: mean - half_difference },
        ])
    }

    /// Computes the wave number of the variation of the background, 1/m: the maximum of |∇p| sin φ/q, |∇Ψ_Σ|, |∇ρ|/ρ,
    /// |∇Ω|/Q_D and |∇I|/I (symbols as in [`MaterialState`]); 0 for a uniform background. The frozen-coefficient
    /// analysis is valid for wave numbers much larger than this one.
    pub fn gradient_wave_number(&self, flow: &DeformingFlow) -> f64 {
        let size = |g: [f64; 2]| g[0].root_sum_square(g[1]);
        let inertia = match self.rotation() {
            MaterialRotation::IntrinsicSpin { moment_of_inertia, .. } => {
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
