//! Laws of media whose stiffness depends on the state: granular media, whose contacts open, and porous media, whose pores
//! collapse.
//!
//! Sweeps treat the medium as elastic with closed contacts, the stiffest state. After each sweep the law computes the
//! actual stress from the stress after the sweep and from the history variables. This never increases the energy: the
//! energy Φ is a convex function of the strain whose second derivative is at most the closed stiffness C, so that
//! Φ(ε + Δε) ≤ Φ(ε) + σ:Δε + ½Δε:C:Δε, where the right-hand side is the energy that the sweep accounts for.

use crate::simd::Number;
use models::granular_medium::{GranularContact, GranularMedium};
use models::porous::{PoreContact, PoreLaw, PorousMedium};
use models::rheology::relaxation::SymmetricTensor;
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;

/// Contact of particles, or of the walls of pores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactLaw {
    /// Granular medium: contact with friction in series with elastic or elastic-plastic particles.
    Granular {
        /// Law of a step.
        law: GranularContact<f64>,
        /// Solid of the closed contacts.
        closed: Isotropic,
    },
    /// Porous medium with spherical contact, in parallel with an elastic skeleton. A plastic skeleton has a yield set
    /// of the deviator, which the contact does not change.
    Porous {
        /// Law of a step.
        law: PoreLaw<f64>,
        /// Solid of the open pores.
        skeleton: Isotropic,
        /// Solid of the collapsed pores.
        closed: Isotropic,
    },
}

fn isotropic(bulk_modulus: f64, shear_modulus: f64, density: f64) -> Isotropic {
    let lambda = bulk_modulus - 2.0 / 3.0 * shear_modulus;
    Isotropic { lambda, mu: shear_modulus, density, microrotation: None }
}

impl From<&GranularMedium> for ContactLaw {
    fn from(medium: &GranularMedium) -> Self {
        let own = medium.parameters();
        Self::Granular {
            law: GranularContact::new(medium),
            closed: isotropic(own.bulk_modulus, own.shear_modulus, own.density),
        }
    }
}

impl ContactLaw {
    /// Creates the law of a porous medium; `None` for a contact with friction.
    pub fn from_porous(medium: &PorousMedium) -> Option<Self> {
        let own = medium.parameters();
        let solid = |bulk_modulus| isotropic(bulk_modulus, own.shear_modulus, own.density);
        (own.contact == PoreContact::Spherical).then(|| Self::Porous {
            law: PoreLaw::new(medium),
            skeleton: solid(own.bulk_modulus),
            closed: solid(own.bulk_modulus + own.contact_bulk_modulus),
        })
    }

    /// Returns the elastic solid of closed contacts, with which the sweeps are made.
    pub fn closed_solid(&self) -> Isotropic {
        match self {
            Self::Granular { closed, .. } | Self::Porous { closed, .. } => *closed,
        }
    }
}

/// Places of the stresses in a list of fields.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TensorPlaces {
    pub(crate) normal: [usize; 3],
    /// One shear component in plane strain, three in space.
    pub(crate) shear: Vec<usize>,
}

impl TensorPlaces {
    /// Finds the components that `create` names; `None` if a normal component is missing.
    pub(crate) fn find(
        fields: &[SolidField],
        create: fn(usize, usize) -> SolidField,
    ) -> Option<Self> {
        let index = |i, j| fields.iter().position(|own| *own == create(i, j));
        let shear = [[0, 1], [0, 2], [1, 2]].into_iter().filter_map(|[i, j]| index(i, j));
        Some(Self { normal: [index(0, 0)?, index(1, 1)?, index(2, 2)?], shear: shear.collect() })
    }

    /// Multiplies all places by the distance of two fields.
    pub(crate) fn scaled(self, pitch: usize) -> Self {
        Self {
            normal: self.normal.map(|index| index * pitch),
            shear: self.shear.into_iter().map(|index| index * pitch).collect(),
        }
    }

    /// Reads a tensor; there must be `SHEAR_COUNT` shear components.
    #[inline(always)]
    pub(crate) fn read<N: Number, const SHEAR_COUNT: usize>(
        &self,
        value: impl Fn(usize) -> N,
    ) -> SymmetricTensor<N, SHEAR_COUNT> {
        let mut tensor = SymmetricTensor::ZERO;
        for i in 0..3 {
            tensor.normal[i] = value(self.normal[i]);
        }
        for i in 0..SHEAR_COUNT {
            tensor.shear[i] = value(self.shear[i]);
        }
        tensor
    }
}
