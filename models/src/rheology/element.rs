//! Elements of rheological schemes: spring, damper, plastic hinge and rigid contact.

use super::polyline::MonotonePolyline;
use crate::common::input::{InputError, ensure};
use crate::common::parameter::define_parameters;

define_parameters! {
    /// Parameter: Young's modulus E of a spring, Pa.
    pub MODULUS = "modulus": "modulus E" ["Pa"], Required(1e6), Positive,
        "modulus E of the spring; > 0";
    /// Parameter: viscosity η of a damper, Pa·s.
    pub VISCOSITY = "viscosity": "viscosity η" ["Pa·s"], Required(1e5), Positive,
        "viscosity η of the damper; > 0";
    /// Parameter: yield stress σ⁺ of a hinge in tension, Pa.
    pub TENSILE_YIELD_STRESS = "tensile_yield_stress": "tensile yield stress σ⁺" ["Pa"], Required(1e4), NotNegative,
        "yield stress σ⁺ of the hinge in tension; ≥ 0";
    /// Parameter: yield stress σ⁻ of a hinge in compression, Pa.
    pub COMPRESSIVE_YIELD_STRESS = "compressive_yield_stress": "compressive yield stress σ⁻" ["Pa"], Required(1e4), NotNegative,
        "yield stress σ⁻ of the hinge in compression; ≥ 0";
    /// Parameter: initial gap θ of a contact, a strain.
    pub GAP = "gap": "gap θ" [""], Default(0.0), NotNegative,
        "initial gap θ of the contact, as a strain; ≥ 0";
}

/// Element of a rheological scheme with its constants. Stresses and strains are positive in tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// Elastic spring: σ = Eε.
    Spring {
        /// Modulus E > 0, Pa.
        modulus: f64,
    },
    /// Viscous damper: σ = η dε/dt.
    Damper {
        /// Viscosity η > 0, Pa·s.
        viscosity: f64,
    },
    /// Plastic hinge: −σ⁻ ≤ σ ≤ σ⁺; the strain grows at σ = σ⁺ and decreases at σ = −σ⁻ only.
    Hinge {
        /// Yield stress σ⁻ ≥ 0 in compression, Pa.
        compressive_yield_stress: f64,
        /// Yield stress σ⁺ ≥ 0 in tension, Pa.
        tensile_yield_stress: f64,
    },
    /// Rigid contact with an initial gap: σ ≤ 0, ε + θ ≥ 0, σ(ε + θ) = 0 (Sadovskii & Sadovskaya 2019).
    Contact {
        /// Gap θ ≥ 0, as a strain.
        gap: f64,
    },
}

/// Name of the spring as a kind of element.
pub const SPRING: &str = "spring";
/// Name of the damper as a kind of element.
pub const DAMPER: &str = "damper";
/// Name of the plastic hinge as a kind of element.
pub const HINGE: &str = "hinge";
/// Name of the rigid contact as a kind of element.
pub const CONTACT: &str = "contact";

impl Element {
    /// Returns the name of the kind of element.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Spring { .. } => SPRING,
            Self::Damper { .. } => DAMPER,
            Self::Hinge { .. } => HINGE,
            Self::Contact { .. } => CONTACT,
        }
    }

    /// Checks the constants.
    ///
    /// # Errors
    /// A constant is negative or not finite, or the modulus or the viscosity is 0.
    pub fn check(&self) -> Result<(), InputError> {
        let not_negative = |input: &'static str, value: f64| {
            ensure(value.is_finite() && value >= 0.0, input, value, "must be at least 0")
        };
        match *self {
            Self::Spring { modulus } => MODULUS.check(modulus, "must be positive"),
            Self::Damper { viscosity } => VISCOSITY.check(viscosity, "must be positive"),
            Self::Hinge { compressive_yield_stress, tensile_yield_stress } => {
                not_negative(COMPRESSIVE_YIELD_STRESS.name, compressive_yield_stress)?;
                not_negative(TENSILE_YIELD_STRESS.name, tensile_yield_stress)
            }
            Self::Contact { gap } => not_negative(GAP.name, gap),
        }
    }

    /// Returns the constants with their parameters.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::Spring { modulus } => vec![(MODULUS.name, modulus)],
            Self::Damper { viscosity } => vec![(VISCOSITY.name, viscosity)],
            Self::Hinge { compressive_yield_stress, tensile_yield_stress } => vec![
                (COMPRESSIVE_YIELD_STRESS.name, compressive_yield_stress),
                (TENSILE_YIELD_STRESS.name, tensile_yield_stress),
            ],
            Self::Contact { gap } => vec![(GAP.name, gap)],
        }
    }

    /// Returns the stored energy per volume, J/m³: σ²/(2E) in a spring.
    pub fn stored_energy(&self, state: &ElementState) -> f64 {
        match *self {
            Self::Spring { modulus } => 0.5 * state.stress * (state.stress / modulus),
            _ => 0.0,
        }
    }

    /// Returns whether the element is a spring or a damper, whose strain and stress determine each other.
    pub(super) fn is_regular(&self) -> bool {
        matches!(self, Self::Spring { .. } | Self::Damper { .. })
    }

    /// Returns the graph of an implicit step of `duration` ≥ 0 (s) from `state`: all pairs of strain increment and
    /// stress with which the step may end. A damper is rigid in a step without duration.
    pub(super) fn step_graph(&self, state: &ElementState, duration: f64) -> MonotonePolyline {
        match *self {
            Self::Spring { modulus } => MonotonePolyline::from_line([0.0, state.stress], modulus),
            Self::Damper { viscosity } => {
                MonotonePolyline::from_line([0.0, 0.0], viscosity / duration)
            }
            Self::Hinge { compressive_yield_stress, tensile_yield_stress } => {
                MonotonePolyline::from_vertices(
                    // Not −0.0, for σ⁻ = 0.
                    vec![[0.0, 0.0 - compressive_yield_stress], [0.0, tensile_yield_stress]],
                    vec![0.0, f64::INFINITY, 0.0],
                )
            }
            Self::Contact { gap } => MonotonePolyline::from_vertices(
                vec![[-(state.strain + gap), 0.0]],
                vec![f64::INFINITY, 0.0],
            ),
        }
    }

    /// Moves the state to the end of a step, a point of the [graph](Self::step_graph).
    pub(super) fn advance(&self, state: &mut ElementState, strain_increment: f64, stress: f64) {
        let work = stress * strain_increment;
        match *self {
            Self::Spring { modulus } => {
                state.step_loss += 0.5 * modulus * strain_increment * strain_increment;
            }
            Self::Damper { .. } | Self::Hinge { .. } => state.dissipated_energy += work,
            Self::Contact { .. } => state.step_loss += work,
        }
        state.strain = match *self {
            // A closed contact has the gap 0 without rounding error.
            Self::Contact { gap } if stress < 0.0 => -gap,
            Self::Contact { gap } => (state.strain + strain_increment).max(-gap),
            _ => state.strain + strain_increment,
        };
        state.stress = stress;
    }
}

/// State of an element, and the energies that it has lost since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementState {
    /// Strain ε.
    pub strain: f64,
    /// Stress σ, Pa.
    pub stress: f64,
    /// Energy dissipated by a damper or a hinge per volume, J/m³.
    pub dissipated_energy: f64,
    /// Loss of the implicit steps per volume, J/m³: ½E(Δε)² in a spring; in a contact σΔε, the work of a step in which
    /// it closes with the stress at the end of the step. It vanishes in the limit of short steps.
    pub step_loss: f64,
}
