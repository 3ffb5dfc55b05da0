//! Registry of models by name: granular flows, elastic solids, yield sets, layers between blocks.
//!
//! Each list starts with the models of this crate. A program adds models by [`register_flow`], [`register_solid`] or
//! [`register_yield_set`]; case files can name registered models like the built-in models.

use crate::common::input::InputError;
use crate::common::parameter::Parameter;
use crate::flow::{FlowKind, FlowModel};
use crate::flow::{double_shearing, free_rotating, harris_grekova, plastic_potential};
use crate::interface::kinds::{self, LayerKind};
use crate::solid::parameters::Theory;
use crate::solid::{SolidKind, SolidModel, cubic_plane, isotropic};
use crate::yield_set::{YieldSetKind, YieldSetModel, interlayer, mises};
use std::sync::{PoisonError, RwLock};

/// Harris–Grekova model: double shearing with intrinsic spin (Harris & Grekova 2005).
pub const HARRIS_GREKOVA: FlowKind = FlowKind::new(&harris_grekova::MODEL);
/// Double-shearing model (Spencer 1964; Mehrabadi & Cowin 1978 for ν > 0).
pub const DOUBLE_SHEARING: FlowKind = FlowKind::new(&double_shearing::MODEL);
/// Plastic-potential model: coaxial Mohr–Coulomb plasticity with a dilatancy angle ν.
pub const PLASTIC_POTENTIAL: FlowKind = FlowKind::new(&plastic_potential::MODEL);
/// Double-sliding free-rotating model (de Josselin de Jong 1977).
pub const FREE_ROTATING: FlowKind = FlowKind::new(&free_rotating::MODEL);

/// Granular-flow models of this crate, in the order of listings.
pub const STANDARD_FLOWS: [FlowKind; 4] =
    [HARRIS_GREKOVA, DOUBLE_SHEARING, PLASTIC_POTENTIAL, FREE_ROTATING];

/// Classical isotropic elastic solid with the Lamé moduli λ and μ.
pub const CLASSICAL: SolidKind = SolidKind::new(&isotropic::CLASSICAL);
/// Isotropic reduced Cosserat solid with the moduli λ, μ, α: microrotation without couple stress.
pub const REDUCED_COSSERAT: SolidKind = SolidKind::new(&isotropic::REDUCED_COSSERAT);
/// Isotropic Cosserat solid with the moduli λ, μ, α and the couple moduli β, γ, η.
pub const COSSERAT: SolidKind = SolidKind::new(&isotropic::COSSERAT);
/// Cosserat solid in plane strain by its compliances a₁, b₁, a₂, b₂ and its couple modulus α₂.
pub const COSSERAT_COMPLIANCES: SolidKind = SolidKind::new(&cubic_plane::COSSERAT_COMPLIANCES);

/// Elastic solids of this crate, in the order of listings.
pub const STANDARD_SOLIDS: [SolidKind; 4] =
    [CLASSICAL, REDUCED_COSSERAT, COSSERAT, COSSERAT_COMPLIANCES];

/// Interlayer yield set: slip and rolling along the layers between blocks; plane strain.
pub const INTERLAYER: YieldSetKind = YieldSetKind::new(&interlayer::INTERLAYER);
/// von Mises yield set, without friction.
pub const VON_MISES: YieldSetKind = YieldSetKind::new(&mises::VON_MISES);
/// Drucker–Prager yield set, equal to the Mises–Schleicher condition linear in the mean stress.
pub const DRUCKER_PRAGER: YieldSetKind = YieldSetKind::new(&mises::DRUCKER_PRAGER);
/// Cosserat–Mises yield set, which also limits antisymmetric stress and couple stress.
pub const COSSERAT_MISES: YieldSetKind = YieldSetKind::new(&mises::COSSERAT_MISES);

/// Yield sets of this crate, in the order of listings.
pub const STANDARD_YIELD_SETS: [YieldSetKind; 4] =
    [INTERLAYER, VON_MISES, DRUCKER_PRAGER, COSSERAT_MISES];

/// Kinds of layers between blocks, in the order of listings; no others can be added.
pub const LAYERS: [LayerKind; 9] = [
    LayerKind::new(&kinds::ELASTIC),
    LayerKind::new(&kinds::ELASTIC_PLASTIC),
    LayerKind::new(&kinds::VISCOUS),
    LayerKind::new(&kinds::POROUS),
    LayerKind::new(&kinds::SATURATED),
    LayerKind::new(&kinds::CRACKED),
    LayerKind::new(&kinds::BREAKING),
    LayerKind::new(&kinds::POROUS_VISCOUS),
    LayerKind::new(&kinds::POROUS_PLASTIC),
];

static FLOWS: Registry<FlowKind> =
    Registry { standard_entries: &STANDARD_FLOWS, added_entries: RwLock::new(Vec::new()) };
static SOLIDS: Registry<SolidKind> =
    Registry { standard_entries: &STANDARD_SOLIDS, added_entries: RwLock::new(Vec::new()) };
static YIELD_SETS: Registry<YieldSetKind> =
    Registry { standard_entries: &STANDARD_YIELD_SETS, added_entries: RwLock::new(Vec::new()) };

/// Error of registering a model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegistryError {
    /// A model of the contained name is registered already.
    #[error("a model is called {0} already")]
    DuplicateName(&'static str),
    /// A registered model has a parameter of the same name in another unit.
    #[error("{model}: the parameter {parameter} has the unit '{unit}' in other models")]
    UnitMismatch {
        /// Name of the model to be registered.
        model: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Unit of the parameter in the registered models.
        unit: &'static str,
    },
    /// An example value of a constant, used in templates, is out of range.
    #[error("{model}: the examples of its constants are refused: {error}")]
    InvalidExample {
        /// Name of the model to be registered.
        model: &'static str,
        /// Error of the constant out of range.
        error: InputError,
    },
    /// The elastic law built from the example constants of a solid differs from the registry entry of the solid: in
    /// theory, or in whether it is defined in plane strain only.
    #[error("{0}: its elastic law has another theory or other dimensions than its entry")]
    TheoryMismatch(&'static str),
    /// A yield set names conditions, but their number differs from its number of half-spaces.
    #[error(
        "{model}: {names} conditions are named, but the set of a {theory:?} solid has {half_spaces} \
         half-spaces; give each half-space a name, or none"
    )]
    ConditionCountMismatch {
        /// Name of the yield set.
        model: &'static str,
        /// Theory of the solid.
        theory: Theory,
        /// Number of named conditions.
        names: usize,
        /// Number of half-spaces; 0 for a set that is not a polyhedron.
        half_spaces: usize,
    },
}

/// All registered granular-flow models, starting with the models of this crate.
pub fn flows() -> Vec<FlowKind> {
    FLOWS.entries()
}

/// All registered elastic solids, starting with the solids of this crate.
pub fn solids() -> Vec<SolidKind> {
    SOLIDS.entries()
}

/// All registered yield sets, starting with the sets of this crate.
pub fn yield_sets() -> Vec<YieldSetKind> {
    YIELD_SETS.entries()
}

/// The registered granular-flow model called `name`.
pub fn find_flow(name: &str) -> Option<FlowKind> {
    FLOWS.find(name)
}

/// The registered elastic solid called `name`.
pub fn find_solid(name: &str) -> Option<SolidKind> {
    SOLIDS.find(name)
}

/// The registered yield set called `name`.
pub fn find_yield_set(name: &str) -> Option<YieldSetKind> {
    YIELD_SETS.find(name)
}

/// The kind of layer called `name`.
pub fn find_layer(name: &str) -> Option<LayerKind> {
    LAYERS.into_iter().find(|kind| kind.name == name)
}

/// The kind of layer with the given normal and tangential component, words of
/// [`NORMAL_COMPONENT_NAMES`](kinds::NORMAL_COMPONENT_NAMES) and
/// [`TANGENTIAL_COMPONENT_NAMES`](kinds::TANGENTIAL_COMPONENT_NAMES).
pub fn find_layer_by_components(normal: &str, tangential: &str) -> Option<LayerKind> {
    LAYERS.into_iter().find(|kind| kind.components == Some([normal, tangential]))
}

/// Registers a granular-flow model.
///
/// # Errors
/// A flow model or elastic solid of this name is registered already, or one of them has a parameter of the same name in
/// another unit.
pub fn register_flow(model: &'static FlowModel) -> Result<(), RegistryError> {
    let flow = FlowKind::new(model);
    solids().into_iter().try_for_each(|other| check_compatible(flow, other))?;
    FLOWS.add(flow)
}

/// Registers an elastic solid.
///
/// # Errors
/// A flow model or elastic solid of this name is registered already, one of them has a parameter of the same name in
/// another unit, the example constants are out of range, or the elastic law built from them differs from the entry in
/// theory or in whether it is defined in plane strain only.
pub fn register_solid(model: &'static SolidModel) -> Result<(), RegistryError> {
    let solid = SolidKind::new(model);
    let law = solid
        .build_example_law()
        .map_err(|error| RegistryError::InvalidExample { model: model.name, error })?;
    if law.theory() != model.theory || law.is_plane() != model.is_plane {
        return Err(RegistryError::TheoryMismatch(model.name));
    }
    flows().into_iter().try_for_each(|other| check_compatible(solid, other))?;
    SOLIDS.add(solid)
}

/// Registers a yield set.
///
/// # Errors
/// A set of this name is registered already, another set has a parameter of the same name in another unit, the example
/// constants build a set for none of the three theories, or the set names conditions and their number differs from the
/// number of its half-spaces.
pub fn register_yield_set(model: &'static YieldSetModel) -> Result<(), RegistryError> {
    check_conditions(YieldSetKind::new(model))?;
    YIELD_SETS.add(YieldSetKind::new(model))
}

/// Checks that the example constants build a set for at least one theory of the solid, and that a set with named
/// conditions has as many half-spaces as names.
fn check_conditions(kind: YieldSetKind) -> Result<(), RegistryError> {
    let model = kind.name;
    let sets = [Theory::Classical, Theory::Reduced, Theory::Cosserat].map(|theory| {
        let examples: Vec<f64> =
            kind.parameters_for(theory).map(Parameter::example_value).collect();
        (theory, kind.build_set(theory, &examples))
    });
    for (theory, set) in
        sets.iter().filter_map(|(parameter, set)| Some((*parameter, set.as_ref().ok()?)))
    {
        let names = kind.conditions_for(theory).len();
        let half_spaces = set.half_spaces().map_or(0, |parameter| parameter.len());
        if names > 0 && names != half_spaces {
            return Err(RegistryError::ConditionCountMismatch {
                model,
                theory,
                names,
                half_spaces,
            });
        }
    }
    // It suffices that one theory admits the set, so the error of the first theory is returned only if all three fail.
    match sets {
        [(_, Err(error)), (_, Err(_)), (_, Err(_))] => {
            Err(RegistryError::InvalidExample { model, error })
        }
        _ => Ok(()),
    }
}

/// Properties common to the registry entries of all lists.
trait RegistryEntry: Copy + 'static {
    fn name(self) -> &'static str;
    fn parameters(self) -> Vec<&'static Parameter>;
}

impl RegistryEntry for FlowKind {
    fn name(self) -> &'static str {
        FlowKind::name(self)
    }

    fn parameters(self) -> Vec<&'static Parameter> {
        FlowKind::parameters(self).iter().collect()
    }
}

impl RegistryEntry for SolidKind {
    fn name(self) -> &'static str {
        self.name
    }

    fn parameters(self) -> Vec<&'static Parameter> {
        self.parameters.iter().collect()
    }
}

impl RegistryEntry for YieldSetKind {
    fn name(self) -> &'static str {
        self.name
    }

    fn parameters(self) -> Vec<&'static Parameter> {
        self.parameters.iter().map(|parameter| &parameter.0).collect()
    }
}

/// A list of registry entries: built-in entries, then entries added at run time.
struct Registry<K: 'static> {
    standard_entries: &'static [K],
    added_entries: RwLock<Vec<K>>,
}

impl<K: RegistryEntry> Registry<K> {
    fn entries(&self) -> Vec<K> {
        let added = self.added_entries.read().unwrap_or_else(PoisonError::into_inner);
        self.standard_entries.iter().chain(added.iter()).copied().collect()
    }

    fn find(&self, name: &str) -> Option<K> {
        self.entries().into_iter().find(|entry| entry.name() == name)
    }

    fn add(&self, entry: K) -> Result<(), RegistryError> {
        let mut added = self.added_entries.write().unwrap_or_else(PoisonError::into_inner);
        self.standard_entries
            .iter()
            .chain(added.iter())
            .try_for_each(|other| check_compatible(entry, *other))?;
        added.push(entry);
        Ok(())
    }
}

/// Checks that `entry` is compatible with `other`: another name, and equal units of parameters of the same name.
fn check_compatible(
    entry: impl RegistryEntry,
    other: impl RegistryEntry,
) -> Result<(), RegistryError> {
    let model = entry.name();
    if other.name() == model {
        return Err(RegistryError::DuplicateName(model));
    }
    for parameter in entry.parameters() {
        let counterpart =
            other.parameters().into_iter().find(|counterpart| counterpart.name == parameter.name);
        if let Some(Parameter { unit, .. }) =
            counterpart.filter(|counterpart| counterpart.unit != parameter.unit)
        {
            return Err(RegistryError::UnitMismatch { model, parameter: parameter.name, unit });
        }
    }
    Ok(())
}
