//! Kinds of model that a case can name.

use models::cosserat::parameters::Theory;
use models::granular_flow::{Kind as Flow, RotationKind};

/// A kind of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A flow of granular material.
    Flow(Flow),
    /// An elastic or elastoplastic solid.
    Solid(Solid),
}

/// A solid by its constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Solid {
    /// Classical elasticity: λ, μ.
    Classical,
    /// Reduced Cosserat: λ, μ, α and rotation without couple stress.
    ReducedCosserat,
    /// Cosserat: λ, μ, α, β, γ, η.
    Cosserat,
    /// Cosserat in plane strain by its compliances a₁, b₁, a₂, b₂, α₂.
    CosseratCompliances,
}

impl Solid {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 4] =
        [Self::Classical, Self::ReducedCosserat, Self::Cosserat, Self::CosseratCompliances];

    /// Whether it has a rotation of its own, and couple stress.
    pub const fn theory(self) -> Theory {
        match self {
            Self::Classical => Theory::Classical,
            Self::ReducedCosserat => Theory::Reduced,
            Self::Cosserat | Self::CosseratCompliances => Theory::Cosserat,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Classical => "classical",
            Self::ReducedCosserat => "reduced-cosserat",
            Self::Cosserat => "cosserat",
            Self::CosseratCompliances => "cosserat-compliances",
        }
    }

    const fn title(self) -> &'static str {
        match self {
            Self::Classical => "classical solid",
            Self::ReducedCosserat => "reduced Cosserat solid",
            Self::Cosserat => "Cosserat solid",
            Self::CosseratCompliances => "Cosserat solid by compliances",
        }
    }
}

/// A yield set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Yield {
    /// Slip and rolling along the layers between blocks; plane strain.
    Interlayer,
    /// von Mises.
    VonMises,
    /// Drucker & Prager, which is Mises & Schleicher.
    DruckerPrager,
    /// With antisymmetric stress and couple stress.
    CosseratMises,
}

impl Yield {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 4] =
        [Self::Interlayer, Self::VonMises, Self::DruckerPrager, Self::CosseratMises];

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Interlayer => "interlayer",
            Self::VonMises => "von-mises",
            Self::DruckerPrager => "drucker-prager",
            Self::CosseratMises => "cosserat-mises",
        }
    }

    /// Name in titles.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Interlayer => "interlayer slip",
            Self::VonMises => "von Mises",
            Self::DruckerPrager => "Drucker–Prager",
            Self::CosseratMises => "Cosserat–Mises",
        }
    }

    /// The set of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|set| set.name() == name)
    }
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
            let sets = kind.yield_sets().iter().copied().map(Some);
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

    /// Name in titles and legends.
    pub fn title(self) -> String {
        match self.yields {
            None => self.kind.title().into(),
            Some(set) => format!("{}, {}", self.kind.title(), set.title()),
        }
    }
}

/// A model that cannot have a yield set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} cannot yield by {}; allowed: {}",
    kind.name(),
    set.name(),
    match kind.yield_sets() {
        [] => "no yield set, flows have their own".to_owned(),
        sets => sets.iter().map(|set| set.name()).collect::<Vec<_>>().join(", "),
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
    pub const fn yield_sets(self) -> &'static [Yield] {
        match self {
            Self::Flow(_) => &[],
            Self::Solid(Solid::Classical) => {
                &[Yield::Interlayer, Yield::VonMises, Yield::DruckerPrager]
            }
            Self::Solid(Solid::ReducedCosserat | Solid::Cosserat) => &Yield::ALL,
            Self::Solid(Solid::CosseratCompliances) => &[Yield::Interlayer],
        }
    }

    /// All kinds, flows first, in the order in which they are listed.
    pub fn all() -> Vec<Self> {
        Self::flows().into_iter().chain(Self::solids()).collect()
    }

    /// The flows among them.
    pub fn flows() -> Vec<Self> {
        Flow::all().into_iter().map(Self::Flow).collect()
    }

    /// The solids among them.
    pub fn solids() -> Vec<Self> {
        Solid::ALL.into_iter().map(Self::Solid).collect()
    }

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flow(flow) => flow.name(),
            Self::Solid(solid) => solid.name(),
        }
    }

    /// Name in titles and legends.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Flow(flow) => flow.title(),
            Self::Solid(solid) => solid.title(),
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
