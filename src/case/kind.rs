//! Kinds of model that a case can name.

use models::granular_flow::Kind as Flow;

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

impl Kind {
    /// All kinds, in the order in which they are listed.
    pub const ALL: [Self; 8] = [
        Self::Flow(Flow::HarrisGrekova),
        Self::Flow(Flow::DoubleShearing),
        Self::Flow(Flow::PlasticPotential),
        Self::Flow(Flow::FreeRotating),
        Self::Solid(Solid::Classical),
        Self::Solid(Solid::ReducedCosserat),
        Self::Solid(Solid::Cosserat),
        Self::Solid(Solid::CosseratCompliances),
    ];

    /// The flows among them.
    pub const FLOWS: [Self; 4] = {
        let [a, b, c, d, ..] = Self::ALL;
        [a, b, c, d]
    };

    /// The solids among them.
    pub const SOLIDS: [Self; 4] = {
        let [.., a, b, c, d] = Self::ALL;
        [a, b, c, d]
    };

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

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}
