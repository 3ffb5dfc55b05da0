//! Kinds of model and media of a case.

use crate::equations::EQUATIONS_KIND;
use models::common::parameter::Parameter;
use models::flow::{FlowKind, RotationKind};
use models::registry;
pub use models::solid::SolidKind;
pub use models::yield_set::YieldSetKind;

/// Name in case files of the absent yield set, for a region that stays elastic.
pub(crate) const NO_YIELD_NAME: &str = "none";

/// A kind of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ModelKind {
    /// A flow of granular material.
    Flow(FlowKind),
    /// An elastic or elastoplastic solid.
    Solid(SolidKind),
    /// A uniaxial rheological scheme, which has a section `[rheology]` in place of `[model]` and no registry entry;
    /// only `wellposed diagram` takes it. Not among [`all_kinds`](Self::all_kinds).
    Rheology,
    /// A model given as equations in the case file, without a registry entry. Not among
    /// [`all_kinds`](Self::all_kinds).
    Equations,
}

/// A medium: kind of model and yield set, which determine the keys of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MediumKind {
    /// Kind of model.
    pub kind: ModelKind,
    /// Yield set; `None` in flows and elastic solids.
    pub yield_set: Option<YieldSetKind>,
}

impl MediumKind {
    /// Returns all media: every kind without a yield set and with every admissible yield set.
    pub fn all_media() -> impl Iterator<Item = Self> {
        ModelKind::all_kinds().into_iter().flat_map(|kind| {
            let sets = kind.admissible_yield_sets().into_iter().map(Some);
            [None].into_iter().chain(sets).map(move |yields| Self { kind, yield_set: yields })
        })
    }

    /// Combines a kind of model with a yield set.
    ///
    /// # Errors
    /// The kind of model does not admit the yield set.
    pub fn new(kind: ModelKind, yields: Option<YieldSetKind>) -> Result<Self, YieldSetError> {
        match yields.filter(|set| !kind.admissible_yield_sets().contains(set)) {
            Some(set) => Err(YieldSetError { kind, set }),
            None => Ok(Self { kind, yield_set: yields }),
        }
    }

    /// Returns the names of the yield conditions that a case may declare active.
    pub fn yield_condition_names(self) -> Vec<&'static str> {
        match (self.kind, self.yield_set) {
            (ModelKind::Solid(solid), Some(set)) => set.conditions_for(solid.theory),
            _ => Vec::new(),
        }
    }

    /// Returns the name for titles and legends.
    pub fn title(self) -> String {
        match self.yield_set {
            None => self.kind.title().into(),
            Some(set) => format!("{}, {}", self.kind.title(), set.title),
        }
    }
}

/// Error: a kind of model does not admit a yield set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "found {} with the model {}; {}",
    set.name,
    kind.name(),
    match kind.admissible_yield_sets().as_slice() {
        [] => "leave it out: the model has its own yield condition".to_owned(),
        sets => {
            let names: Vec<&str> = sets.iter().map(|set| set.name).collect();
            format!("allowed: {}", names.join(", "))
        }
    }
)]
pub struct YieldSetError {
    /// Kind of model.
    pub kind: ModelKind,
    /// Yield set.
    pub set: YieldSetKind,
}

impl From<ModelKind> for MediumKind {
    fn from(kind: ModelKind) -> Self {
        Self { kind, yield_set: None }
    }
}

impl ModelKind {
    /// Returns the yield sets admitted by the kind of model.
    pub fn admissible_yield_sets(self) -> Vec<YieldSetKind> {
        match self {
            Self::Flow(_) | Self::Rheology | Self::Equations => Vec::new(),
            Self::Solid(solid) => {
                registry::yield_sets().into_iter().filter(|set| set.is_compatible(solid)).collect()
            }
        }
    }

    /// Kinds without a registry entry, whose cases have sections of their own.
    pub const WITHOUT_ENTRY: [Self; 2] = [Self::Equations, Self::Rheology];

    /// Returns all kinds that a section `[model]` can name, flows first, in the order of listings.
    pub fn all_kinds() -> Vec<Self> {
        Self::flow_kinds().into_iter().chain(Self::solid_kinds()).collect()
    }

    /// Returns all kinds of flows.
    pub fn flow_kinds() -> Vec<Self> {
        registry::flows().into_iter().map(Self::Flow).collect()
    }

    /// Returns all kinds of solids.
    pub fn solid_kinds() -> Vec<Self> {
        registry::solids().into_iter().map(Self::Solid).collect()
    }

    /// Returns the name of the kind of model in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flow(flow) => flow.name(),
            Self::Solid(solid) => solid.name,
            Self::Rheology => "rheology",
            Self::Equations => EQUATIONS_KIND,
        }
    }

    /// Returns the name for titles and legends.
    pub fn title(self) -> &'static str {
        match self {
            Self::Flow(flow) => flow.title(),
            Self::Solid(solid) => solid.title,
            Self::Rheology => "rheological scheme",
            Self::Equations => "model given as equations",
        }
    }

    /// Returns the constants of the registry entry; none without an entry.
    pub fn parameters(self) -> &'static [Parameter] {
        match self {
            Self::Flow(flow) => flow.parameters(),
            Self::Solid(solid) => solid.parameters,
            Self::Rheology | Self::Equations => &[],
        }
    }

    /// Returns the kind of material rotation of a flow with a time-domain solver; it determines which field evolves
    /// with the velocity and the equation of the stress angle. `None` for solids and for flows with undetermined
    /// rotation.
    pub fn simulation_rotation(self) -> Option<RotationKind> {
        match self {
            Self::Flow(flow) => Some(flow.rotation()).filter(|own| *own != RotationKind::Free),
            Self::Solid(_) | Self::Rheology | Self::Equations => None,
        }
    }

    /// Finds the kind of model `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all_kinds().into_iter().find(|kind| kind.name() == name)
    }
}

/// Joins the names of `kinds` with commas.
pub fn join_names(kinds: &[ModelKind]) -> String {
    kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ")
}
