//! Kinds of layers by name: constants, options and constructors.

use super::elastic::ElasticMaterial;
use super::parameters::{
    ADDED_DENSITY, COLLAPSE_STIFFNESS, CONTACT_FRICTION, COUPLING_STIFFNESS, DELAYED_COMPLIANCE,
    DENSITY, FLUID_DENSITY, FLUID_STIFFNESS, INSTANTANEOUS_COMPLIANCE, LONGITUDINAL_SPEED,
    LayerMaterial, POROSITY, PlasticConstants, PorousConstants, SHEAR_FRICTION, SHEAR_SPEED,
    SHEAR_STRENGTH, SKELETON_DENSITY, SLIP_HARDENING, SaturatedMaterial, TENSILE_STRENGTH,
    THICKNESS, TangentialConstants, UNDRAINED_STIFFNESS, VISCOSITY, ViscousConstants,
};
use crate::common::input::InputError;
use crate::common::parameter::{Parameter, to_constant_array};
use std::fmt;

/// An option of a layer: a key whose value is one of several names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerOption {
    /// Key of the option in case files.
    pub name: &'static str,
    /// Meaning of the option, in one line.
    pub meaning: &'static str,
    /// Allowed values; the first one is the default.
    pub allowed_values: &'static [&'static str],
}

/// Option of all kinds: the distribution of mass, `box` or `lumped`
/// ([`MassDistribution`](super::parameters::MassDistribution)).
pub const MASS_OPTION: LayerOption = LayerOption {
    name: "mass",
    meaning: "distribution of the mass of the layer: box scheme, or half of it lumped at each face",
    allowed_values: &["box", "lumped"],
};

/// Option of breaking layers: whether they break in tension, a boolean.
pub const FRACTURE_OPTION: LayerOption = LayerOption {
    name: "fracture",
    meaning: "whether the layer breaks at its tensile strength; else it is elastic-plastic only",
    allowed_values: &["true", "false"],
};

/// Names of the laws of the normal component of a layer.
pub const NORMAL_COMPONENT_NAMES: [&str; 2] = ["elastic", "porous"];
/// Names of the laws of the tangential component of a layer.
pub const TANGENTIAL_COMPONENT_NAMES: [&str; 3] = ["elastic", "viscous", "plastic"];

/// Kind of a layer as the [registry](crate::registry) lists it.
pub struct LayerModel {
    /// Name of the kind in case files, e.g. `elastic-plastic`.
    pub name: &'static str,
    /// Name of the kind in titles.
    pub title: &'static str,
    /// Constants of the layer. Constants of the same name in different kinds have the same unit.
    pub parameters: &'static [Parameter],
    /// Names of the normal and the tangential law, from [`NORMAL_COMPONENT_NAMES`] and [`TANGENTIAL_COMPONENT_NAMES`],
    /// if the kind is a combination of components.
    pub components: Option<[&'static str; 2]>,
    /// Options besides the distribution of mass.
    pub options: &'static [LayerOption],
    /// Constructor from the constants in the order of `parameters`, in SI units; NaN for an absent optional constant.
    pub constructor: fn(&[f64]) -> Result<LayerMaterial, InputError>,
}

/// Reference to a registry entry of a kind of layer; equality compares names.
#[derive(Clone, Copy)]
pub struct LayerKind(&'static LayerModel);

impl LayerKind {
    /// A reference to the registry entry `model`.
    pub const fn new(model: &'static LayerModel) -> Self {
        Self(model)
    }

    /// Builds a layer from its constants, in the order of `parameters`, in SI units; NaN for an absent optional
    /// constant.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn build(self, constants: &[f64]) -> Result<LayerMaterial, InputError> {
        (self.0.constructor)(constants)?.check()
    }
}

impl std::ops::Deref for LayerKind {
    type Target = LayerModel;

    fn deref(&self) -> &LayerModel {
        self.0
    }
}

impl PartialEq for LayerKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for LayerKind {}

impl fmt::Debug for LayerKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

fn elastic_material(
    [thickness, density, longitudinal_speed, shear_speed]: [f64; 4],
) -> ElasticMaterial {
    ElasticMaterial { thickness, density, longitudinal_speed, shear_speed }
}

/// Elastic layer.
pub static ELASTIC: LayerModel = LayerModel {
    name: "elastic",
    title: "elastic layers",
    parameters: &[THICKNESS, DENSITY, LONGITUDINAL_SPEED, SHEAR_SPEED],
    components: Some(["elastic", "elastic"]),
    options: &[],
    constructor: |given| Ok(LayerMaterial::Elastic(elastic_material(to_constant_array(given)?))),
};

/// Elastic-plastic layer: slip with friction and cohesion.
pub static ELASTIC_PLASTIC: LayerModel = LayerModel {
    name: "elastic-plastic",
    title: "elastic-plastic layers",
    parameters: &[
        THICKNESS,
        DENSITY,
        LONGITUDINAL_SPEED,
        SHEAR_SPEED,
        SHEAR_STRENGTH,
        SHEAR_FRICTION,
        SLIP_HARDENING,
    ],
    components: Some(["elastic", "plastic"]),
    options: &[],
    constructor: |given| {
        let [
            thickness,
            density,
            longitudinal_speed,
            shear_speed,
            shear_strength,
            friction,
            hardening,
        ] = to_constant_array(given)?;
        let plastic = PlasticConstants { shear_strength, friction, hardening };
        Ok(LayerMaterial::Plastic(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            plastic,
        ))
    },
};

/// Viscous layer: delayed shear.
pub static VISCOUS: LayerModel = LayerModel {
    name: "viscous",
    title: "viscous layers",
    parameters: &[
        THICKNESS,
        DENSITY,
        LONGITUDINAL_SPEED,
        SHEAR_SPEED,
        DELAYED_COMPLIANCE,
        VISCOSITY,
    ],
    components: Some(["elastic", "viscous"]),
    options: &[],
    constructor: |given| {
        let [thickness, density, longitudinal_speed, shear_speed, delayed_compliance, viscosity] =
            to_constant_array(given)?;
        let viscous = ViscousConstants { delayed_compliance, viscosity };
        Ok(LayerMaterial::Viscous(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            viscous,
        ))
    },
};

/// Porous layer with elastic shear.
pub static POROUS: LayerModel = LayerModel {
    name: "porous",
    title: "porous layers",
    parameters: &[
        THICKNESS,
        DENSITY,
        LONGITUDINAL_SPEED,
        SHEAR_SPEED,
        COLLAPSE_STIFFNESS,
        POROSITY,
    ],
    components: Some(["porous", "elastic"]),
    options: &[],
    constructor: |given| {
        let [thickness, density, longitudinal_speed, shear_speed, collapse_stiffness, porosity] =
            to_constant_array(given)?;
        let pores = PorousConstants { collapse_stiffness, porosity };
        let tangential = TangentialConstants::Elastic;
        Ok(LayerMaterial::Porous(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            pores,
            tangential,
        ))
    },
};

/// Porous layer with viscous shear.
pub static POROUS_VISCOUS: LayerModel = LayerModel {
    name: "porous-viscous",
    title: "porous viscous layers",
    parameters: &[
        THICKNESS,
        DENSITY,
        LONGITUDINAL_SPEED,
        SHEAR_SPEED,
        COLLAPSE_STIFFNESS,
        POROSITY,
        DELAYED_COMPLIANCE,
        VISCOSITY,
    ],
    components: Some(["porous", "viscous"]),
    options: &[],
    constructor: |given| {
        let [
            thickness,
            density,
            longitudinal_speed,
            shear_speed,
            collapse_stiffness,
            porosity,
            delayed_compliance,
            viscosity,
        ] = to_constant_array(given)?;
        let pores = PorousConstants { collapse_stiffness, porosity };
        let viscous = ViscousConstants { delayed_compliance, viscosity };
        let tangential = TangentialConstants::Viscous(viscous);
        Ok(LayerMaterial::Porous(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            pores,
            tangential,
        ))
    },
};

/// Porous layer with elastic-plastic shear without friction.
pub static POROUS_PLASTIC: LayerModel = LayerModel {
    name: "porous-plastic",
    title: "porous elastic-plastic layers",
    parameters: &[
        THICKNESS,
        DENSITY,
        LONGITUDINAL_SPEED,
        SHEAR_SPEED,
        COLLAPSE_STIFFNESS,
        POROSITY,
        SHEAR_STRENGTH,
        SLIP_HARDENING,
    ],
    components: Some(["porous", "plastic"]),
    options: &[],
    constructor: |given| {
        let [
            thickness,
            density,
            longitudinal_speed,
            shear_speed,
            collapse_stiffness,
            porosity,
            shear_strength,
            hardening,
        ] = to_constant_array(given)?;
        let pores = PorousConstants { collapse_stiffness, porosity };
        let tangential = TangentialConstants::Plastic { shear_strength, hardening };
        Ok(LayerMaterial::Porous(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            pores,
            tangential,
        ))
    },
};

/// Fluid-saturated porous layer.
pub static SATURATED: LayerModel = LayerModel {
    name: "saturated",
    title: "fluid-saturated layers",
    parameters: &[
        THICKNESS,
        SKELETON_DENSITY,
        FLUID_DENSITY,
        ADDED_DENSITY,
        UNDRAINED_STIFFNESS,
        COLLAPSE_STIFFNESS,
        POROSITY,
        COUPLING_STIFFNESS,
        FLUID_STIFFNESS,
        INSTANTANEOUS_COMPLIANCE,
        DELAYED_COMPLIANCE,
        VISCOSITY,
    ],
    components: None,
    options: &[],
    constructor: |given| {
        let [
            thickness,
            skeleton_density,
            fluid_density,
            added_density,
            undrained_stiffness,
            collapse_stiffness,
            porosity,
            coupling_stiffness,
            fluid_stiffness,
            instantaneous_compliance,
            delayed_compliance,
            viscosity,
        ] = to_constant_array(given)?;
        Ok(LayerMaterial::Saturated(SaturatedMaterial {
            thickness,
            skeleton_density,
            fluid_density,
            added_density,
            undrained_stiffness,
            pores: PorousConstants { collapse_stiffness, porosity },
            coupling_stiffness,
            fluid_stiffness,
            instantaneous_compliance,
            viscous: ViscousConstants { delayed_compliance, viscosity },
        }))
    },
};

/// Cracked layer: no tensile strength, closed faces stick or slip with friction.
pub static CRACKED: LayerModel = LayerModel {
    name: "cracked",
    title: "cracked layers",
    parameters: &[THICKNESS, DENSITY, LONGITUDINAL_SPEED, SHEAR_SPEED, CONTACT_FRICTION],
    components: None,
    options: &[],
    constructor: |given| {
        let [thickness, density, longitudinal_speed, shear_speed, friction] =
            to_constant_array(given)?;
        let friction = (!friction.is_nan()).then_some(friction);
        Ok(LayerMaterial::Cracked(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            friction,
        ))
    },
};

/// Breaking layer: elastic-plastic, then cracked.
pub static BREAKING: LayerModel = LayerModel {
    name: "breaking",
    title: "breaking layers",
    parameters: &[
        THICKNESS,
        DENSITY,
        LONGITUDINAL_SPEED,
        SHEAR_SPEED,
        SHEAR_STRENGTH,
        SHEAR_FRICTION,
        SLIP_HARDENING,
        TENSILE_STRENGTH,
    ],
    components: None,
    options: &[FRACTURE_OPTION],
    constructor: |given| {
        let [
            thickness,
            density,
            longitudinal_speed,
            shear_speed,
            shear_strength,
            friction,
            hardening,
            tensile_strength,
        ] = to_constant_array(given)?;
        let plastic = PlasticConstants { shear_strength, friction, hardening };
        Ok(LayerMaterial::Breaking(
            elastic_material([thickness, density, longitudinal_speed, shear_speed]),
            plastic,
            tensile_strength,
        ))
    },
};
