//! Laws of media whose stiffness depends on the state: granular media, whose contacts open, and porous media, whose pores
//! collapse.
//!
//! Sweeps treat the medium as elastic with closed contacts, the stiffest state. After each sweep the law computes the
//! actual stress from the stress after the sweep and from the history variables. This never increases the energy: the
//! energy Φ is a convex function of the strain whose second derivative is at most the closed stiffness C, so that
//! Φ(ε + Δε) ≤ Φ(ε) + σ:Δε + ½Δε:C:Δε, where the right-hand side is the energy that the sweep accounts for.

use crate::simd::Number;
use models::granular_medium::{
    GranularContact, GranularMedium, KelvinVoigtParticles, KelvinVoigtStep, MaxwellParticles,
    MaxwellStep,
};
use models::porous::{PlasticPoreConeLaw, PoreConeLaw, PoreContact, PoreLaw, PorousMedium};
use models::rheology::relaxation::SymmetricTensor;
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use models::uniaxial::NO_LIMIT;

/// Contact of particles, or of the walls of pores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactLaw {
    /// Granular medium: contact with friction in series with elastic or elastic-plastic particles.
    Granular {
        /// Law of a step.
        law: GranularContact<f64>,
        /// Solid of the closed contacts.
        closed: Isotropic,
        /// Viscous particles.
        particles: Option<ViscousParticles>,
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
    /// Porous medium whose pore walls transmit stresses in a friction cone, in parallel with an elastic skeleton. Without
    /// pores: a heteromodular solid.
    PorousCone {
        /// Law of a step.
        law: PoreConeLaw<f64>,
        /// Solid of the open pores.
        skeleton: Isotropic,
        /// Solid of the collapsed pores.
        closed: Isotropic,
    },
    /// Porous medium whose pore walls transmit stresses in a friction cone, in parallel with a plastic skeleton.
    PorousPlasticCone {
        /// Law of a step.
        law: PlasticPoreConeLaw<f64>,
        /// Elastic solid of the open pores.
        skeleton: Isotropic,
        /// Elastic solid of the collapsed pores.
        closed: Isotropic,
    },
}

/// Viscous particles of a granular medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViscousParticles {
    /// Spring and dashpot in series.
    Maxwell(MaxwellParticles),
    /// Spring and dashpot in parallel; the law of the contact and its closed solid are then the stiffened ones.
    KelvinVoigt {
        /// Law of a step.
        law: KelvinVoigtStep<f64>,
        /// Time step for which the law was made, s.
        step: f64,
        /// Solid of the spring.
        spring: Isotropic,
    },
}

/// Law of viscous particles once per step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ParticleRelaxation<N> {
    /// Relaxation of the stress.
    Maxwell(MaxwellStep<N>),
    /// Release of the dashpot.
    KelvinVoigt(KelvinVoigtStep<N>),
}

impl<N: Number> ParticleRelaxation<N> {
    /// Converts every constant by the function `f`.
    pub(crate) fn map<M>(self, f: impl Fn(N) -> M + Copy) -> ParticleRelaxation<M> {
        match self {
            Self::Maxwell(law) => ParticleRelaxation::Maxwell(law.map(f)),
            Self::KelvinVoigt(law) => ParticleRelaxation::KelvinVoigt(law.map(f)),
        }
    }

    /// Returns the law of fields that are `factor` times the physical ones.
    pub(crate) fn with_field_factor(self, factor: N) -> Self {
        match self {
            Self::Maxwell(law) => Self::Maxwell(law.with_field_factor(factor)),
            Self::KelvinVoigt(law) => Self::KelvinVoigt(law.with_field_factor(factor)),
        }
    }

    /// Applies the law to stress, excess and stress of the spring; also returns the energy lost, J/m³.
    pub(crate) fn apply<const SHEAR_COUNT: usize>(
        &self,
        [stress, excess, spring]: [SymmetricTensor<N, SHEAR_COUNT>; 3],
    ) -> ([SymmetricTensor<N, SHEAR_COUNT>; 3], N) {
        match self {
            Self::Maxwell(law) => {
                let after = law.relax(stress, excess);
                ([after.stress, after.excess, spring], after.energy_loss)
            }
            Self::KelvinVoigt(law) => {
                let after = law.release(stress, excess, spring);
                ([after.stress, after.excess, after.spring_stress], after.energy_loss)
            }
        }
    }
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
            particles: None,
        }
    }
}

impl ContactLaw {
    /// Creates the law of a porous medium. A plastic skeleton beside a spherical contact needs a yield set of its own.
    pub fn from_porous(medium: &PorousMedium) -> Self {
        let own = medium.parameters();
        let skeleton = isotropic(own.bulk_modulus, own.shear_modulus, own.density);
        let closed = |added_shear_modulus| {
            isotropic(
                own.bulk_modulus + own.contact_bulk_modulus,
                own.shear_modulus + added_shear_modulus,
                own.density,
            )
        };
        match own.contact {
            PoreContact::Spherical => {
                Self::Porous { law: PoreLaw::new(medium), skeleton, closed: closed(0.0) }
            }
            PoreContact::Frictional { shear_modulus, .. } => {
                let closed = closed(shear_modulus);
                match (PoreConeLaw::new(medium), PlasticPoreConeLaw::new(medium)) {
                    (Some(law), _) => Self::PorousCone { law, skeleton, closed },
                    (None, Some(law)) => Self::PorousPlasticCone { law, skeleton, closed },
                    // A contact by cone has one of both laws.
                    (None, None) => Self::Porous { law: PoreLaw::new(medium), skeleton, closed },
                }
            }
        }
    }

    /// Creates the law of a granular medium with viscous particles.
    pub fn from_viscous(medium: &GranularMedium, particles: MaxwellParticles) -> Self {
        match Self::from(medium) {
            Self::Granular { law, closed, .. } => {
                let particles = Some(ViscousParticles::Maxwell(particles));
                Self::Granular { law, closed, particles }
            }
            other => other,
        }
    }

    /// Creates the law of a granular medium with particles whose spring and dashpot are parallel, for runs with a time
    /// step, s.
    pub fn from_damped(
        medium: &GranularMedium,
        particles: KelvinVoigtParticles,
        step: f64,
    ) -> Self {
        let own = medium.parameters();
        let law = particles.step(medium, step);
        let [bulk_modulus, shear_modulus] = particles.moduli(medium, step);
        let spring = isotropic(own.bulk_modulus, own.shear_modulus, own.density);
        Self::Granular {
            law: law.contact,
            closed: isotropic(bulk_modulus, shear_modulus, own.density),
            particles: Some(ViscousParticles::KelvinVoigt { law, step, spring }),
        }
    }

    /// Returns the law of viscous particles over a duration, s; `None` for media without them.
    pub(crate) fn relaxation(&self, duration: f64) -> Option<ParticleRelaxation<f64>> {
        match self {
            Self::Granular { law, particles: Some(particles), .. } => Some(match particles {
                ViscousParticles::Maxwell(own) => {
                    ParticleRelaxation::Maxwell(own.step(law, duration))
                }
                ViscousParticles::KelvinVoigt { law, .. } => ParticleRelaxation::KelvinVoigt(*law),
            }),
            _ => None,
        }
    }

    /// Returns the time step, s, for which the law was made, and the solid of the spring of particles with a parallel
    /// dashpot; `None` for other media.
    pub(crate) fn damped_spring(&self) -> Option<(f64, Isotropic)> {
        match self {
            Self::Granular {
                particles: Some(ViscousParticles::KelvinVoigt { step, spring, .. }),
                ..
            } => Some((*step, *spring)),
            _ => None,
        }
    }

    /// Returns the elastic solid of closed contacts, with which the sweeps are made.
    pub fn closed_solid(&self) -> Isotropic {
        match self {
            Self::Granular { closed, .. }
            | Self::Porous { closed, .. }
            | Self::PorousCone { closed, .. }
            | Self::PorousPlasticCone { closed, .. } => *closed,
        }
    }
}

impl ContactLaw {
    /// Returns the solid whose elastic energy the excess stress x of a contact by cone has; `None` for other contacts. With
    /// S = σ + x = (C_a + C_b):ε, the energy of skeleton and spring is ½σ:(C_a + C_b)⁻¹:σ + ½x:D⁻¹:x, where D has the
    /// moduli k_b(k_a + k_b)/k_a and μ_b(μ_a + μ_b)/μ_a. Beside a plastic skeleton x − C_b:εᵖ is in place of x.
    pub(crate) fn excess_solid(&self) -> Option<Isotropic> {
        let (Self::PorousCone { skeleton, closed, .. }
        | Self::PorousPlasticCone { skeleton, closed, .. }) = self
        else {
            return None;
        };
        let bulk_modulus = |solid: &Isotropic| solid.lambda + 2.0 / 3.0 * solid.mu;
        let modulus = |open: f64, closed: f64| (closed - open) * closed / open;
        Some(isotropic(
            modulus(bulk_modulus(skeleton), bulk_modulus(closed)),
            modulus(skeleton.mu, closed.mu),
            closed.density,
        ))
    }

    /// Returns the modulus 2μ_b, Pa, of the deviator of the spring of collapsed pores beside a plastic skeleton; `None`
    /// for other contacts.
    pub(crate) fn plastic_spring_modulus(&self) -> Option<f64> {
        match self {
            Self::PorousPlasticCone { skeleton, closed, .. } => {
                Some(2.0 * (closed.mu - skeleton.mu))
            }
            _ => None,
        }
    }

    /// Whether the law itself lets particles or a skeleton flow plastically.
    pub(crate) fn is_plastic(&self) -> bool {
        match self {
            Self::Granular { law, .. } => law.yield_stress < NO_LIMIT,
            Self::PorousPlasticCone { .. } => true,
            Self::Porous { .. } | Self::PorousCone { .. } => false,
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
