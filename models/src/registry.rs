//! The list of models by name: granular flows, elastic solids, yield sets.
//!
//! The first of each list are those of this crate. A program adds its own by [`register_flow`], [`register_solid`] or
//! [`register_yield_set`]; from then on they can be named in case files and are treated like the others.

use crate::common::input::InputError;
use crate::common::parameter::Parameter;
use crate::flow::{FlowKind, FlowModel};
use crate::flow::{double_shearing, free_rotating, harris_grekova, plastic_potential};
use crate::solid::parameters::Theory;
use crate::solid::{SolidKind, SolidModel, cubic_plane, isotropic};
use crate::yield_set::{YieldSetKind, YieldSetModel, interlayer, mises};
use std::sync::{PoisonError, RwLock};

/// Harris & Grekova (2005).
pub const HARRIS_GREKOVA: FlowKind = FlowKind::new(&harris_grekova::MODEL);
/// Spencer (1964); Mehrabadi & Cowin (1978) for ν > 0.
pub const DOUBLE_SHEARING: FlowKind = FlowKind::new(&double_shearing::MODEL);
/// Coaxial plastic potential with its own dilatancy angle.
pub const PLASTIC_POTENTIAL: FlowKind = FlowKind::new(&plastic_potential::MODEL);
/// Double-sliding free-rotating (de Josselin de Jong 1977).
pub const FREE_ROTATING: FlowKind = FlowKind::new(&free_rotating::MODEL);

/// The granular flows of this crate, in the order in which they are listed.
pub const STANDARD_FLOWS: [FlowKind; 4] =
    [HARRIS_GREKOVA, DOUBLE_SHEARING, PLASTIC_POTENTIAL, FREE_ROTATING];

/// Classical elasticity: λ, μ.
pub const CLASSICAL: SolidKind = SolidKind::new(&isotropic::CLASSICAL);
/// Reduced Cosserat: λ, μ, α and rotation without couple stress.
pub const REDUCED_COSSERAT: SolidKind = SolidKind::new(&isotropic::REDUCED_COSSERAT);
/// Cosserat: λ, μ, α, β, γ, η.
pub const COSSERAT: SolidKind = SolidKind::new(&isotropic::COSSERAT);
/// Cosserat in plane strain by its compliances a₁, b₁, a₂, b₂, α₂.
pub const COSSERAT_COMPLIANCES: SolidKind = SolidKind::new(&cubic_plane::COSSERAT_COMPLIANCES);

/// The elastic solids of this crate, in the order in which they are listed.
pub const STANDARD_SOLIDS: [SolidKind; 4] =
    [CLASSICAL, REDUCED_COSSERAT, COSSERAT, COSSERAT_COMPLIANCES];

/// Slip and rolling along the layers between blocks; plane strain.
pub const INTERLAYER: YieldSetKind = YieldSetKind::new(&interlayer::INTERLAYER);
/// von Mises.
pub const VON_MISES: YieldSetKind = YieldSetKind::new(&mises::VON_MISES);
/// Drucker & Prager, which is Mises & Schleicher.
pub const DRUCKER_PRAGER: YieldSetKind = YieldSetKind::new(&mises::DRUCKER_PRAGER);
/// With antisymmetric stress and couple stress.
pub const COSSERAT_MISES: YieldSetKind = YieldSetKind::new(&mises::COSSERAT_MISES);

/// The yield sets of this crate, in the order in which they are listed.
pub const STANDARD_YIELD_SETS: [YieldSetKind; 4] =
    [INTERLAYER, VON_MISES, DRUCKER_PRAGER, COSSERAT_MISES];

static FLOWS: List<FlowKind> = List { standard: &STANDARD_FLOWS, added: RwLock::new(Vec::new()) };
static SOLIDS: List<SolidKind> =
    List { standard: &STANDARD_SOLIDS, added: RwLock::new(Vec::new()) };
static YIELD_SETS: List<YieldSetKind> =
    List { standard: &STANDARD_YIELD_SETS, added: RwLock::new(Vec::new()) };

/// A model that cannot be added.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegistryError {
    /// Its name is taken.
    #[error("a model is called {0} already")]
    NameTaken(&'static str),
    /// Another model has a parameter of the same name in another unit.
    #[error("{model}: the parameter {parameter} has the unit '{unit}' in other models")]
    OtherUnit {
        /// The model.
        model: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Its unit in the models that are listed already.
        unit: &'static str,
    },
    /// The examples of its constants, of which templates are made, are out of range.
    #[error("{model}: the examples of its constants are refused: {error}")]
    Example {
        /// The model.
        model: &'static str,
        /// The constant that is out of range.
        error: InputError,
    },
    /// The law of a solid is of another theory, or for other dimensions, than its entry says.
    #[error("{0}: its elastic law has another theory or other dimensions than its entry")]
    OtherTheory(&'static str),
    /// A yield set names conditions, but is no polyhedron with a half-space for each name.
    #[error(
        "{model}: {names} conditions are named, but the set of a {theory:?} solid has {half_spaces} \
         half-spaces; give each half-space a name, or none"
    )]
    NamedConditions {
        /// The yield set.
        model: &'static str,
        /// The theory of the solid.
        theory: Theory,
        /// The number of named conditions.
        names: usize,
        /// The number of half-spaces; 0 of a set that is no polyhedron.
        half_spaces: usize,
    },
}

/// All granular flows, those of this crate first.
pub fn flows() -> Vec<FlowKind> {
    FLOWS.all()
}

/// All elastic solids, those of this crate first.
pub fn solids() -> Vec<SolidKind> {
    SOLIDS.all()
}

/// All yield sets, those of this crate first.
pub fn yield_sets() -> Vec<YieldSetKind> {
    YIELD_SETS.all()
}

/// The granular flow of that name.
pub fn flow(name: &str) -> Option<FlowKind> {
    FLOWS.find(name)
}

/// The elastic solid of that name.
pub fn solid(name: &str) -> Option<SolidKind> {
    SOLIDS.find(name)
}

/// The yield set of that name.
pub fn yield_set(name: &str) -> Option<YieldSetKind> {
    YIELD_SETS.find(name)
}

/// Adds a granular-flow model.
///
/// # Errors
/// Its name is taken, or a parameter has another unit in another model.
pub fn register_flow(model: &'static FlowModel) -> Result<(), RegistryError> {
    let flow = FlowKind::new(model);
    solids().into_iter().try_for_each(|other| check(flow, other))?;
    FLOWS.add(flow)
}

/// Adds an elastic solid.
///
/// # Errors
/// Its name is taken, or a parameter has another unit in another model; the examples of its constants are out of
/// range, or make a law of another theory than the entry's.
pub fn register_solid(model: &'static SolidModel) -> Result<(), RegistryError> {
    let solid = SolidKind::new(model);
    let law =
        solid.example().map_err(|error| RegistryError::Example { model: model.name, error })?;
    if law.theory() != model.theory || law.is_plane() != model.is_plane {
        return Err(RegistryError::OtherTheory(model.name));
    }
    flows().into_iter().try_for_each(|other| check(solid, other))?;
    SOLIDS.add(solid)
}

/// Adds a yield set.
///
/// # Errors
/// Its name is taken, or a parameter has another unit in another set; the examples of its constants are out of range
/// for solids of any theory; it names conditions, but has not as many half-spaces.
pub fn register_yield_set(model: &'static YieldSetModel) -> Result<(), RegistryError> {
    check_conditions(YieldSetKind::new(model))?;
    YIELD_SETS.add(YieldSetKind::new(model))
}

/// That a set which names its conditions has a half-space for each of them, and that its examples make a set.
fn check_conditions(kind: YieldSetKind) -> Result<(), RegistryError> {
    let model = kind.name;
    let sets = [Theory::Classical, Theory::Reduced, Theory::Cosserat].map(|theory| {
        let examples: Vec<f64> = kind.parameters_for(theory).map(Parameter::example).collect();
        (theory, kind.set(theory, &examples))
    });
    for (theory, set) in sets.iter().filter_map(|(own, set)| Some((*own, set.as_ref().ok()?))) {
        let names = kind.conditions_for(theory).len();
        let half_spaces = set.half_spaces().map_or(0, |own| own.len());
        if names > 0 && names != half_spaces {
            return Err(RegistryError::NamedConditions { model, theory, names, half_spaces });
        }
    }
    // Of a theory that the set does not admit nothing is asked.
    match sets {
        [(_, Err(error)), (_, Err(_)), (_, Err(_))] => Err(RegistryError::Example { model, error }),
        _ => Ok(()),
    }
}

/// What all entries of a list have.
trait Entry: Copy + 'static {
    fn name(self) -> &'static str;
    fn parameters(self) -> Vec<&'static Parameter>;
}

impl Entry for FlowKind {
    fn name(self) -> &'static str {
        FlowKind::name(self)
    }

    fn parameters(self) -> Vec<&'static Parameter> {
        FlowKind::parameters(self).iter().collect()
    }
}

impl Entry for SolidKind {
    fn name(self) -> &'static str {
        self.name
    }

    fn parameters(self) -> Vec<&'static Parameter> {
        self.parameters.iter().collect()
    }
}

impl Entry for YieldSetKind {
    fn name(self) -> &'static str {
        self.name
    }

    fn parameters(self) -> Vec<&'static Parameter> {
        self.parameters.iter().map(|own| &own.0).collect()
    }
}

/// Entries of this crate, and those that a program has added.
struct List<K: 'static> {
    standard: &'static [K],
    added: RwLock<Vec<K>>,
}

impl<K: Entry> List<K> {
    fn all(&self) -> Vec<K> {
        let added = self.added.read().unwrap_or_else(PoisonError::into_inner);
        self.standard.iter().chain(added.iter()).copied().collect()
    }

    fn find(&self, name: &str) -> Option<K> {
        self.all().into_iter().find(|entry| entry.name() == name)
    }

    fn add(&self, entry: K) -> Result<(), RegistryError> {
        let mut added = self.added.write().unwrap_or_else(PoisonError::into_inner);
        self.standard.iter().chain(added.iter()).try_for_each(|other| check(entry, *other))?;
        added.push(entry);
        Ok(())
    }
}

/// That an entry can be listed beside another one.
fn check(entry: impl Entry, other: impl Entry) -> Result<(), RegistryError> {
    let model = entry.name();
    if other.name() == model {
        return Err(RegistryError::NameTaken(model));
    }
    for own in entry.parameters() {
        let same = other.parameters().into_iter().find(|same| same.name == own.name);
        if let Some(Parameter { unit, .. }) = same.filter(|same| same.unit != own.unit) {
            return Err(RegistryError::OtherUnit { model, parameter: own.name, unit });
        }
    }
    Ok(())
}
