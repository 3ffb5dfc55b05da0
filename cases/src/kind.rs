//! Kinds of model that a case can name.

use models::flow::{FlowKind as Flow, RotationKind};
use models::registry;
pub use models::solid::SolidKind as Solid;
pub use models::yield_set::YieldSetKind as Yield;

/// What stands for a yield set in a region that stays elastic.
pub(crate) const NO_YIELD: &str = "none";

/// A kind of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A flow of granular material.
    Flow(Flow),
    /// An elastic or elastoplastic solid.
    Solid(Solid),
}

/// A kind of model, and the set within which a solid's stress stays: what decides which keys a case
/// has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Medium {
    /// The model.
    pub kind: Kind,
    /// The yield set; `None` in flows and elastic solids.
    pub yields: Option<Yield>,
}

impl Medium {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        Kind::all().into_iter().flat_map(|kind| {
            let sets = kind.yield_sets().into_iter().map(Some);
            [None].into_iter().chain(sets).map(move |yields| Self { kind, yields })
        })
    }

    /// A kind of model with a yield set.
    ///
    /// # Errors
    /// Such a model has no such set.
    pub fn new(kind: Kind, yields: Option<Yield>) -> Result<Self, NoSuchMedium> {
        match yields.filter(|set| !kind.yield_sets().contains(set)) {
            Some(set) => Err(NoSuchMedium { kind, set }),
            None => Ok(Self { kind, yields }),
        }
    }

    /// Names of the conditions of its yield set by which a case may say what is active.
    pub fn condition_names(self) -> Vec<&'static str> {
        match (self.kind, self.yields) {
            (Kind::Solid(solid), Some(set)) => set.conditions_for(solid.theory),
            _ => Vec::new(),
        }
    }

    /// Name in titles and legends.
    pub fn title(self) -> String {
        match self.yields {
            None => self.kind.title().into(),
            Some(set) => format!("{}, {}", self.kind.title(), set.title),
        }
    }
}

/// A model that cannot have a yield set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} cannot yield by {}; allowed: {}",
    kind.name(),
    set.name,
    match kind.yield_sets().as_slice() {
        [] => "no yield set, flows have their own".to_owned(),
        sets => sets.iter().map(|set| set.name).collect::<Vec<_>>().join(", "),
    }
)]
pub struct NoSuchMedium {
    /// The model.
    pub kind: Kind,
    /// The set.
    pub set: Yield,
}

impl From<Kind> for Medium {
    fn from(kind: Kind) -> Self {
        Self { kind, yields: None }
    }
}

impl Kind {
    /// The yield sets that such a model may have.
    pub fn yield_sets(self) -> Vec<Yield> {
        match self {
            Self::Flow(_) => Vec::new(),
            Self::Solid(solid) => {
                registry::yield_sets().into_iter().filter(|set| set.admits(solid)).collect()
            }
        }
    }

    /// All kinds, flows first, in the order in which they are listed.
    pub fn all() -> Vec<Self> {
        Self::flows().into_iter().chain(Self::solids()).collect()
    }

    /// The flows among them.
    pub fn flows() -> Vec<Self> {
        registry::flows().into_iter().map(Self::Flow).collect()
    }

    /// The solids among them.
    pub fn solids() -> Vec<Self> {
        registry::solids().into_iter().map(Self::Solid).collect()
    }

    /// Name in case files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flow(flow) => flow.name(),
            Self::Solid(solid) => solid.name,
        }
    }

    /// Name in titles and legends.
    pub fn title(self) -> &'static str {
        match self {
            Self::Flow(flow) => flow.title(),
            Self::Solid(solid) => solid.title,
        }
    }

    /// What rotates in a flow that can be run in time: it says which field evolves beside the velocity and what
    /// determines the stress angle. `None` of solids, and of flows that leave the rotation undetermined.
    pub fn rotation_in_time(self) -> Option<RotationKind> {
        match self {
            Self::Flow(flow) => Some(flow.rotation()).filter(|own| *own != RotationKind::Free),
            Self::Solid(_) => None,
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|kind| kind.name() == name)
    }
}

/// The names of some kinds of model, as a list for a reader.
pub fn names(kinds: &[Kind]) -> String {
    kinds.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ")
}
