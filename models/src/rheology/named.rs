//! Rheological schemes with names: granular and porous media (Sadovskii & Sadovskaya 2019), Poynting–Thomson solid.
//!
//! The elastic-viscoplastic porous scheme is ours: the source names it without its tree.

use super::element::{self, Element};
use super::scheme::{NamedElement, RheologicalScheme, SchemeError};
use crate::common::input::InputError;
use crate::common::parameter::{Parameter, define_parameters, to_constant_array};

define_parameters! {
    /// Parameter: yield stress of a symmetric hinge, Pa.
    pub YIELD_STRESS = "yield_stress": "yield stress σ_s" ["Pa"], Required(1e4), NotNegative,
        "yield stress σ_s of the hinge; ≥ 0";
    /// Parameter: modulus of the skeleton of a porous medium, Pa.
    pub SKELETON_MODULUS = "skeleton_modulus": "skeleton modulus a" ["Pa"], Required(1e6), Positive,
        "modulus a of the spring that acts with open pores; > 0";
    /// Parameter: modulus that a closed contact adds, Pa.
    pub CONTACT_MODULUS = "contact_modulus": "contact modulus b" ["Pa"], Required(3e6), Positive,
        "modulus b of the spring in series with the contact; > 0";
    /// Parameter: strain at which the pores close.
    pub POROSITY = "porosity": "porosity θ₀" [""], Required(0.02), NotNegative,
        "compressive strain θ₀ at which the contact closes; ≥ 0";
    /// Parameter: modulus 1/a₁ of the delayed spring, Pa.
    pub DELAYED_MODULUS = "delayed_modulus": "delayed modulus 1/a₁" ["Pa"], Required(1e6), Positive,
        "modulus 1/a₁ of the spring in parallel with the damper; > 0";
}

/// Rheological scheme with a name and parameters.
pub struct NamedScheme {
    /// Name, also in case files.
    pub name: &'static str,
    /// Name for titles.
    pub title: &'static str,
    /// Notation of the tree, with the names of the elements.
    pub tree: &'static str,
    /// Constants, in the order in which [`build`](Self::build) takes them.
    pub parameters: &'static [Parameter],
    elements: fn(&[f64]) -> Result<Vec<NamedElement>, InputError>,
}

/// Reason why a named scheme cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NamedSchemeError {
    /// A constant is invalid, or their number is wrong.
    #[error(transparent)]
    Constant(#[from] InputError),
    /// The scheme is invalid.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
}

impl NamedScheme {
    /// Builds the scheme from its constants in SI units.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn build(&self, constants: &[f64]) -> Result<RheologicalScheme, NamedSchemeError> {
        for (parameter, value) in self.parameters.iter().zip(constants) {
            parameter.check(*value, parameter.meaning)?;
        }
        Ok(RheologicalScheme::parse((self.elements)(constants)?, self.tree)?)
    }
}

fn spring(name: &str, modulus: f64) -> NamedElement {
    NamedElement::new(name, Element::Spring { modulus })
}

fn damper(viscosity: f64) -> NamedElement {
    NamedElement::new("damper", Element::Damper { viscosity })
}

fn hinge([compressive_yield_stress, tensile_yield_stress]: [f64; 2]) -> NamedElement {
    NamedElement::new("hinge", Element::Hinge { compressive_yield_stress, tensile_yield_stress })
}

fn contact(gap: f64) -> NamedElement {
    NamedElement::new("contact", Element::Contact { gap })
}

/// Ideal granular medium with elastic particles.
pub static GRANULAR_ELASTIC: NamedScheme = NamedScheme {
    name: "granular-elastic",
    title: "ideal granular medium with elastic particles",
    tree: "spring - contact",
    parameters: &[element::MODULUS],
    elements: |given| {
        let [modulus] = to_constant_array(given)?;
        Ok(vec![spring("spring", modulus), contact(0.0)])
    },
};

/// Heteromodular elastic medium, which is stiffer in compression than in tension.
pub static HETEROMODULAR: NamedScheme = NamedScheme {
    name: "heteromodular",
    title: "heteromodular elastic medium",
    tree: "skeleton | (particles - contact)",
    parameters: &[SKELETON_MODULUS, CONTACT_MODULUS],
    elements: |given| {
        let [a, b] = to_constant_array(given)?;
        Ok(vec![spring("skeleton", a), spring("particles", b), contact(0.0)])
    },
};

/// Granular medium with elastic-plastic particles.
pub static GRANULAR_PLASTIC: NamedScheme = NamedScheme {
    name: "granular-plastic",
    title: "granular medium with elastic-plastic particles",
    tree: "spring - contact - hinge",
    parameters: &[element::MODULUS, YIELD_STRESS],
    elements: |given| {
        let [modulus, yield_stress] = to_constant_array(given)?;
        Ok(vec![spring("spring", modulus), contact(0.0), hinge([yield_stress; 2])])
    },
};

/// Granular medium with viscoelastic particles of Maxwell type.
pub static GRANULAR_MAXWELL: NamedScheme = NamedScheme {
    name: "granular-maxwell",
    title: "granular medium with viscoelastic particles, Maxwell",
    tree: "spring - damper - contact",
    parameters: &[element::MODULUS, element::VISCOSITY],
    elements: |given| {
        let [modulus, viscosity] = to_constant_array(given)?;
        Ok(vec![spring("spring", modulus), damper(viscosity), contact(0.0)])
    },
};

/// Granular medium with viscoelastic particles of Kelvin–Voigt type.
pub static GRANULAR_KELVIN_VOIGT: NamedScheme = NamedScheme {
    name: "granular-kelvin-voigt",
    title: "granular medium with viscoelastic particles, Kelvin–Voigt",
    tree: "(spring | damper) - contact",
    parameters: &[element::MODULUS, element::VISCOSITY],
    elements: |given| {
        let [modulus, viscosity] = to_constant_array(given)?;
        Ok(vec![spring("spring", modulus), damper(viscosity), contact(0.0)])
    },
};

/// Porous medium with an elastic skeleton.
pub static POROUS_ELASTIC: NamedScheme = NamedScheme {
    name: "porous-elastic",
    title: "porous medium with elastic skeleton",
    tree: "skeleton | (particles - contact)",
    parameters: &[SKELETON_MODULUS, CONTACT_MODULUS, POROSITY],
    elements: |given| {
        let [a, b, porosity] = to_constant_array(given)?;
        Ok(vec![spring("skeleton", a), spring("particles", b), contact(porosity)])
    },
};

/// Porous medium with an elastic-plastic skeleton.
pub static POROUS_PLASTIC: NamedScheme = NamedScheme {
    name: "porous-plastic",
    title: "porous medium with elastic-plastic skeleton",
    tree: "(skeleton - hinge) | (particles - contact)",
    parameters: &[
        SKELETON_MODULUS,
        CONTACT_MODULUS,
        POROSITY,
        element::COMPRESSIVE_YIELD_STRESS,
        element::TENSILE_YIELD_STRESS,
    ],
    elements: |given| {
        let [a, b, porosity, compressive, tensile] = to_constant_array(given)?;
        Ok(vec![
            spring("skeleton", a),
            hinge([compressive, tensile]),
            spring("particles", b),
            contact(porosity),
        ])
    },
};

/// Porous medium with an elastic-viscoplastic skeleton.
pub static POROUS_VISCOPLASTIC: NamedScheme = NamedScheme {
    name: "porous-viscoplastic",
    title: "porous medium with elastic-viscoplastic skeleton",
    tree: "(skeleton - (hinge | damper)) | (particles - contact)",
    parameters: &[
        SKELETON_MODULUS,
        CONTACT_MODULUS,
        POROSITY,
        element::COMPRESSIVE_YIELD_STRESS,
        element::TENSILE_YIELD_STRESS,
        element::VISCOSITY,
    ],
    elements: |given| {
        let [a, b, porosity, compressive, tensile, viscosity] = to_constant_array(given)?;
        Ok(vec![
            spring("skeleton", a),
            hinge([compressive, tensile]),
            damper(viscosity),
            spring("particles", b),
            contact(porosity),
        ])
    },
};

/// Poynting–Thomson solid (Poynting & Thomson 1902), without granular elements.
pub static POYNTING_THOMSON: NamedScheme = NamedScheme {
    name: "poynting-thomson",
    title: "Poynting–Thomson solid",
    tree: "spring - (delayed | damper)",
    parameters: &[element::MODULUS, DELAYED_MODULUS, element::VISCOSITY],
    elements: |given| {
        let [modulus, delayed, viscosity] = to_constant_array(given)?;
        Ok(vec![spring("spring", modulus), spring("delayed", delayed), damper(viscosity)])
    },
};

/// All schemes with names, in the order of listings; no others can be added: any other tree is given by its elements.
pub static NAMED_SCHEMES: [&NamedScheme; 9] = [
    &GRANULAR_ELASTIC,
    &HETEROMODULAR,
    &GRANULAR_PLASTIC,
    &GRANULAR_MAXWELL,
    &GRANULAR_KELVIN_VOIGT,
    &POROUS_ELASTIC,
    &POROUS_PLASTIC,
    &POROUS_VISCOPLASTIC,
    &POYNTING_THOMSON,
];

/// Finds the scheme `name`.
pub fn find_named_scheme(name: &str) -> Option<&'static NamedScheme> {
    NAMED_SCHEMES.into_iter().find(|scheme| scheme.name == name)
}
