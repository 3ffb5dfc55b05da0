//! Layers linearised about the initial stress-free state, as the analysis describes them.

use analysis::bloch::cell::{Joint, JointComponent, JointDelay};
use analysis::bloch::chain::LayerCompliance;
use models::interface::opening_line::LayerMass;
use models::interface::parameters::{
    LayerMaterial, MassDistribution, PlasticConstants, PorousConstants, TangentialConstants,
    ViscousConstants,
};

/// Layer between blocks: material, and how its mass is distributed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Kind of the layer with its constants.
    pub material: LayerMaterial,
    /// Distribution of the mass of the layer: box scheme or lumped.
    pub mass: MassDistribution,
}

/// Linear law of one traction component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearComponent {
    /// Mass per area, kg/m².
    pub mass: LayerMass<f64>,
    /// Instantaneous and delayed compliance, m/Pa.
    pub compliance: LayerCompliance,
}

/// Linear range of the tractions of a layer; a bound is `None` if the traction is not bounded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LinearRange {
    /// Shear strength τ, Pa, and friction coefficient k: the range is |S_t| + k|S_n| < τ.
    pub shear_bounds: Option<[f64; 2]>,
    /// Largest normal traction |S_n|, Pa: tensile strength, or traction at which pores collapse.
    pub max_normal_traction: Option<f64>,
}

/// Layer linearised about the initial stress-free state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearLayer {
    /// Linear laws of the normal and of the tangential traction component.
    pub components: [LinearComponent; 2],
    pub(super) linear_range: LinearRange,
    /// Strain across the layer per normal traction, 1/Pa, of porous layers, whose history contains the strain.
    pub(super) strain_per_stress: Option<f64>,
}

/// Reason why cracked layers are not compared.
const CRACKED_REJECTION: &str =
    "cracked layers: their initial state is the corner between open and closed";
/// Reason why fluid-saturated layers are not compared.
const SATURATED_REJECTION: &str = "saturated layers: the analysis has no fluid along layers";
/// Reason why layers without strength are not compared.
const ZERO_STRENGTH_REJECTION: &str = "layers without strength: they yield at any stress";
/// Reason why porous layers of porosity 0 are not compared.
const ZERO_POROSITY_REJECTION: &str =
    "porous layers of porosity 0: their initial state is a corner";

impl Layer {
    /// Linearises the layer about its initial stress-free state: elastic and viscous layers, plastic and breaking ones
    /// below their strength, porous ones with open pores.
    ///
    /// # Errors
    /// The layer is not linear about that state: cracked and saturated layers, layers without strength or pores. The
    /// error is the reason.
    pub fn linearise(&self) -> Result<LinearLayer, &'static str> {
        let mut delay = None;
        let mut range = LinearRange::default();
        let mut open_stiffness = None;
        let shear_range = |strength: f64, friction: f64| match strength > 0.0 {
            true => Ok(Some([strength, friction])),
            false => Err(ZERO_STRENGTH_REJECTION),
        };
        let plastic_range = |own: &PlasticConstants| shear_range(own.shear_strength, own.friction);
        match &self.material {
            LayerMaterial::Elastic(_) => {}
            LayerMaterial::Plastic(_, plastic) => range.shear_bounds = plastic_range(plastic)?,
            LayerMaterial::Viscous(_, viscous) => delay = Some(*viscous),
            LayerMaterial::Porous(elastic, PorousConstants { porosity, .. }, tangential) => {
                if *porosity == 0.0 {
                    return Err(ZERO_POROSITY_REJECTION);
                }
                let stiffness = elastic.thickness / elastic.normal_compliance();
                range.max_normal_traction = Some(stiffness * porosity);
                open_stiffness = Some(stiffness);
                match tangential {
                    TangentialConstants::Elastic => {}
                    TangentialConstants::Viscous(viscous) => delay = Some(*viscous),
                    TangentialConstants::Plastic { shear_strength, .. } => {
                        range.shear_bounds = shear_range(*shear_strength, 0.0)?;
                    }
                }
            }
            LayerMaterial::Saturated(_) => return Err(SATURATED_REJECTION),
            LayerMaterial::Cracked(..) => return Err(CRACKED_REJECTION),
            LayerMaterial::Breaking(_, plastic, tensile_strength) => {
                if *tensile_strength == 0.0 {
                    return Err(ZERO_STRENGTH_REJECTION);
                }
                range.shear_bounds = plastic_range(plastic)?;
                range.max_normal_traction = Some(*tensile_strength);
            }
        }
        let (masses, stiffnesses) = (self.material.masses(), self.material.stiffnesses());
        let component = |index: usize| LinearComponent {
            mass: match self.mass {
                MassDistribution::Box => LayerMass::new_box(masses[index]),
                MassDistribution::Lumped => LayerMass::new_lumped(masses[index]),
            },
            compliance: LayerCompliance::new_elastic(1.0 / stiffnesses[index]),
        };
        let [normal, mut tangential] = [component(0), component(1)];
        if let Some(ViscousConstants { delayed_compliance, viscosity }) = delay {
            tangential.compliance.delayed = self.material.thickness() * delayed_compliance;
            tangential.compliance.retardation_time = viscosity * delayed_compliance;
        }
        Ok(LinearLayer {
            components: [normal, tangential],
            linear_range: range,
            strain_per_stress: open_stiffness.map(|stiffness| 1.0 / stiffness),
        })
    }
}

impl LinearComponent {
    /// Converts the component for the Galerkin analysis of a period.
    fn to_joint(self) -> JointComponent {
        let LayerCompliance { elastic, delayed, retardation_time } = self.compliance;
        let delay = (delayed > 0.0).then_some(JointDelay { compliance: delayed, retardation_time });
        JointComponent { mass: self.mass, stiffness: 1.0 / elastic, delay }
    }

    /// Whether the component has a delayed compliance.
    pub(super) fn is_viscous(&self) -> bool {
        self.compliance.delayed > 0.0
    }
}

impl LinearLayer {
    /// Converts the layer for the Galerkin analysis of a period.
    pub(super) fn to_joint(self) -> Joint {
        let [normal, tangential] = self.components.map(LinearComponent::to_joint);
        Joint { normal, tangential }
    }
}

impl LinearRange {
    /// Fraction of the linear range that a normal and a shear traction (Pa) reach.
    pub(super) fn used_fraction(&self, normal: f64, shear: f64) -> f64 {
        let of_shear = self
            .shear_bounds
            .map_or(0.0, |[strength, friction]| (shear + friction * normal) / strength);
        of_shear.max(self.max_normal_traction.map_or(0.0, |limit| normal / limit))
    }
}
