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
    /// Constants.
    pub material: LayerMaterial,
    /// Distribution of the mass.
    pub mass: MassDistribution,
}

/// Linear law of one traction component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearComponent {
    /// Mass.
    pub mass: LayerMass<f64>,
    /// Compliance of the instantaneous and of the delayed deformation.
    pub compliance: LayerCompliance,
}

/// Bounds of the linear range of a layer; `None` where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LinearRange {
    /// Strength τ, Pa, and friction k of |S_t| + k|S_n| < τ.
    pub shear: Option<[f64; 2]>,
    /// Largest |S_n|, Pa: tensile strength, or traction at which pores collapse.
    pub normal: Option<f64>,
}

/// Layer linearised about the initial stress-free state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearLayer {
    /// Normal and tangential component.
    pub components: [LinearComponent; 2],
    pub(super) range: LinearRange,
    /// Strain across the layer per normal traction, 1/Pa, of layers whose history contains the strain.
    pub(super) strain_per_stress: Option<f64>,
}

/// Reason why a layer of a kind without linear state is not measured.
const CRACKED: &str = "cracked layers: their initial state is the corner between open and closed";
/// Same for saturated layers.
const SATURATED: &str = "saturated layers: the analysis has no fluid along layers";
/// Same for layers whose linear range is empty.
const WITHOUT_STRENGTH: &str = "layers without strength: they yield at any stress";
/// Same for collapsed pores.
const WITHOUT_PORES: &str = "porous layers of porosity 0: their initial state is a corner";

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
            false => Err(WITHOUT_STRENGTH),
        };
        let of_plastic = |own: &PlasticConstants| shear_range(own.shear_strength, own.friction);
        match &self.material {
            LayerMaterial::Elastic(_) => {}
            LayerMaterial::Plastic(_, plastic) => range.shear = of_plastic(plastic)?,
            LayerMaterial::Viscous(_, viscous) => delay = Some(*viscous),
            LayerMaterial::Porous(elastic, PorousConstants { porosity, .. }, tangential) => {
                if *porosity == 0.0 {
                    return Err(WITHOUT_PORES);
                }
                let stiffness = elastic.thickness / elastic.normal_compliance();
                range.normal = Some(stiffness * porosity);
                open_stiffness = Some(stiffness);
                match tangential {
                    TangentialConstants::Elastic => {}
                    TangentialConstants::Viscous(viscous) => delay = Some(*viscous),
                    TangentialConstants::Plastic { shear_strength, .. } => {
                        range.shear = shear_range(*shear_strength, 0.0)?;
                    }
                }
            }
            LayerMaterial::Saturated(_) => return Err(SATURATED),
            LayerMaterial::Cracked(..) => return Err(CRACKED),
            LayerMaterial::Breaking(_, plastic, tensile_strength) => {
                if *tensile_strength == 0.0 {
                    return Err(WITHOUT_STRENGTH);
                }
                range.shear = of_plastic(plastic)?;
                range.normal = Some(*tensile_strength);
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
            range,
            strain_per_stress: open_stiffness.map(|stiffness| 1.0 / stiffness),
        })
    }
}

impl LinearComponent {
    /// The component for the analysis of a cell.
    fn to_joint(self) -> JointComponent {
        let LayerCompliance { elastic, delayed, retardation_time } = self.compliance;
        let delay = (delayed > 0.0).then_some(JointDelay { compliance: delayed, retardation_time });
        JointComponent { mass: self.mass, stiffness: 1.0 / elastic, delay }
    }

    /// Whether the component is viscous.
    pub(super) fn is_viscous(&self) -> bool {
        self.compliance.delayed > 0.0
    }
}

impl LinearLayer {
    /// The layer for the analysis of a cell.
    pub(super) fn to_joint(self) -> Joint {
        let [normal, tangential] = self.components.map(LinearComponent::to_joint);
        Joint { normal, tangential }
    }
}

impl LinearRange {
    /// Share of the range that the tractions of a wave use.
    pub(super) fn usage(&self, normal: f64, shear: f64) -> f64 {
        let of_shear =
            self.shear.map_or(0.0, |[strength, friction]| (shear + friction * normal) / strength);
        of_shear.max(self.normal.map_or(0.0, |limit| normal / limit))
    }
}
