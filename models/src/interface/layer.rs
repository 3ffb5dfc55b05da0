//! Laws of layers of all kinds in one type, chosen at run time.

use super::breaking::BreakingLayer;
use super::cracked::CrackedLayer;
use super::elastic::{ElasticComponent, ElasticLayer, ElasticMaterial};
use super::fluid::FluidConstants;
use super::history;
use super::opening_line::LayerMass;
use super::parameters::{
    LayerMaterial, MassDistribution, PlasticConstants, PorousConstants, SaturatedMaterial,
    TangentialConstants, ViscousConstants,
};
use super::plastic::{PlasticLayer, YieldCone};
use super::porous::{PorousComponent, PorousElasticity, PorousLayer, TangentialComponent};
use super::saturated::SaturatedLayer;
use super::viscous::{ViscousComponent, ViscousLayer};
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

pub use super::history::MAX_HISTORY_VARIABLES;

/// Law of a layer with a normal and a tangential component. All lanes of a [`Number`] obey the same law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LayerLaw<N> {
    /// Elastic in both components.
    Elastic(ElasticLayer<N, 2>),
    /// Elastic-plastic: slip and opening with associated flow.
    Plastic(PlasticLayer<N>),
    /// Elastic normal component, viscous shear.
    Viscous(ViscousLayer<N>),
    /// Normal component with collapsing pores.
    Porous(PorousLayer<N>),
    /// Porous and fluid-saturated.
    Saturated(SaturatedLayer<N>),
    /// Cracked: without tensile strength.
    Cracked(CrackedLayer<N>),
    /// Breaking: elastic-plastic until fracture, then cracked.
    Breaking(BreakingLayer<N>),
}

/// State of a face of a layer for output; quantities that its law does not have are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceRecord<N> {
    /// Slip χ, m.
    pub slip: N,
    /// Opening u of a crack, m.
    pub opening: N,
    /// Time of first slip, s; 0 if there was none.
    pub slip_time: N,
    /// Time of fracture, s; 0 if there was none.
    pub fracture_time: N,
    /// Normal traction S_n, Pa.
    pub normal_stress: N,
    /// Tangential traction S_t, Pa.
    pub shear_stress: N,
    /// Porosity θ of open pores.
    pub porosity: N,
    /// Pressure p of the fluid, Pa.
    pub pressure: N,
    /// Velocity w of the fluid along the layer, m/s.
    pub fluid_velocity: N,
}

impl LayerMaterial {
    /// Builds the law of the layer with its mass distributed as `distribution`.
    pub fn to_law(&self, distribution: MassDistribution) -> LayerLaw<f64> {
        let new_mass = |mass: f64| match distribution {
            MassDistribution::Box => LayerMass::new_box(mass),
            MassDistribution::Lumped => LayerMass::new_lumped(mass),
        };
        let elastic = |material: &ElasticMaterial| {
            let compliance = [material.normal_compliance(), material.tangential_compliance()];
            (new_mass(material.mass()), compliance)
        };
        match self {
            Self::Elastic(material) => {
                let (mass, compliance) = elastic(material);
                let components = compliance.map(|compliance| ElasticComponent { mass, compliance });
                LayerLaw::Elastic(ElasticLayer { components })
            }
            Self::Plastic(material, plastic) => {
                let (mass, compliance) = elastic(material);
                LayerLaw::Plastic(PlasticLayer {
                    mass,
                    compliance,
                    cone: plastic.build_yield_cone(),
                })
            }
            Self::Viscous(material, viscous) => {
                let (mass, [normal, shear]) = elastic(material);
                let normal = ElasticComponent { mass, compliance: normal };
                let shear = viscous.build_component(mass, shear, material.thickness);
                LayerLaw::Viscous(ViscousLayer { normal, shear })
            }
            Self::Porous(material, pores, tangential) => {
                let (mass, [_, shear]) = elastic(material);
                let elasticity =
                    pores.build_elasticity(material.thickness, normal_modulus(material));
                let elastic = ElasticComponent { mass, compliance: shear };
                let shear = match *tangential {
                    TangentialConstants::Elastic => TangentialComponent::Elastic(elastic),
                    TangentialConstants::Viscous(viscous) => TangentialComponent::Viscous(
                        viscous.build_component(mass, shear, material.thickness),
                    ),
                    TangentialConstants::Plastic { shear_strength, hardening } => {
                        let cone = YieldCone { strength: shear_strength, friction: 0.0, hardening };
                        TangentialComponent::Plastic(elastic, cone)
                    }
                };
                let normal = PorousComponent { mass, elasticity };
                LayerLaw::Porous(PorousLayer { normal, shear })
            }
            Self::Saturated(material) => LayerLaw::Saturated(material.build_layer(new_mass)),
            Self::Cracked(material, friction) => {
                let (mass, [_, shear_compliance]) = elastic(material);
                let normal = PorousComponent { mass, elasticity: crack_elasticity(material) };
                LayerLaw::Cracked(CrackedLayer { normal, shear_compliance, friction: *friction })
            }
            Self::Breaking(material, plastic, tensile_strength) => {
                let (mass, compliance) = elastic(material);
                LayerLaw::Breaking(BreakingLayer {
                    crack: PorousComponent { mass, elasticity: crack_elasticity(material) },
                    compliance,
                    cone: plastic.build_yield_cone(),
                    tensile_strength: *tensile_strength,
                })
            }
        }
    }
}

/// Modulus ρ′c₁′² of the layer under uniaxial strain, Pa.
fn normal_modulus(material: &ElasticMaterial) -> f64 {
    material.density * material.longitudinal_speed * material.longitudinal_speed
}

/// Elasticity of a crack: b₀ = 0, θ₀ = 0, b₁ = ρ′c₁′².
fn crack_elasticity(material: &ElasticMaterial) -> PorousElasticity<f64> {
    PorousConstants { collapse_stiffness: normal_modulus(material), porosity: 0.0 }
        .build_elasticity(material.thickness, 0.0)
}

impl PlasticConstants {
    fn build_yield_cone(&self) -> YieldCone<f64> {
        let Self { shear_strength, friction, hardening } = *self;
        YieldCone { strength: shear_strength, friction, hardening }
    }
}

impl PorousConstants {
    fn build_elasticity(&self, thickness: f64, open_stiffness: f64) -> PorousElasticity<f64> {
        let Self { collapse_stiffness, porosity } = *self;
        PorousElasticity { thickness, open_stiffness, collapse_stiffness, porosity }
    }
}

impl ViscousConstants {
    fn build_component(
        &self,
        mass: LayerMass<f64>,
        compliance: f64,
        thickness: f64,
    ) -> ViscousComponent<f64> {
        ViscousComponent {
            mass,
            compliance,
            delayed_compliance: thickness * self.delayed_compliance,
            fluidity: thickness / self.viscosity,
        }
    }
}

impl SaturatedMaterial {
    fn build_layer(&self, new_mass: impl Fn(f64) -> LayerMass<f64>) -> SaturatedLayer<f64> {
        let [skeleton, fluid, added] =
            [self.skeleton_density, self.fluid_density, self.added_density];
        let thickness = self.thickness;
        let [normal_mass, shear_mass] = LayerMaterial::Saturated(*self).masses();
        let density = self.free_fluid_density();
        SaturatedLayer {
            normal: PorousComponent {
                mass: new_mass(normal_mass),
                elasticity: self.pores.build_elasticity(thickness, self.undrained_stiffness),
            },
            shear: self.viscous.build_component(
                new_mass(shear_mass),
                thickness * self.instantaneous_compliance,
                thickness,
            ),
            fluid: FluidConstants {
                thickness,
                density,
                stiffness: self.fluid_stiffness,
                coupling_stiffness: self.coupling_stiffness,
                impedance: (density * self.fluid_stiffness).sqrt(),
                speed: self.fluid_speed(),
                skeleton_share: added / (skeleton + added),
            },
            skeleton_density: skeleton,
            fluid_density: fluid,
            added_density: added,
            fluid_share: added / (fluid + added),
        }
    }
}

/// Evaluates `$body` with the law of the current kind as `$law`.
macro_rules! for_each_kind {
    ($layer:expr, $law:ident => $body:expr) => {
        match $layer {
            LayerLaw::Elastic($law) => $body,
            LayerLaw::Plastic($law) => $body,
            LayerLaw::Viscous($law) => $body,
            LayerLaw::Porous($law) => $body,
            LayerLaw::Saturated($law) => $body,
            LayerLaw::Cracked($law) => $body,
            LayerLaw::Breaking($law) => $body,
        }
    };
}

impl LayerLaw<f64> {
    /// Converts the constants to the number type `N` (f32, f64 or SIMD lanes).
    pub fn to_number<N: Number>(self) -> LayerLaw<N> {
        self.map(N::from_f64)
    }
}

/// Number of history variables that a layer of type `L` uses.
const fn count_variables<N: Number, L: FaceLaw<N, 2>>(_: &L) -> usize {
    L::HISTORY_VARIABLE_COUNT
}

impl<N: Number> LayerLaw<N> {
    /// Converts every constant by the function `f`, e.g. from scalars to SIMD lanes.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> LayerLaw<M> {
        match self {
            Self::Elastic(law) => LayerLaw::Elastic(law.map(f)),
            Self::Plastic(law) => LayerLaw::Plastic(law.map(f)),
            Self::Viscous(law) => LayerLaw::Viscous(law.map(f)),
            Self::Porous(law) => LayerLaw::Porous(law.map(f)),
            Self::Saturated(law) => LayerLaw::Saturated(law.map(f)),
            Self::Cracked(law) => LayerLaw::Cracked(law.map(f)),
            Self::Breaking(law) => LayerLaw::Breaking(law.map(f)),
        }
    }

    /// Number of history variables of a face of this law, at most [`MAX_HISTORY_VARIABLES`].
    pub fn history_variable_count(&self) -> usize {
        for_each_kind!(self, law => count_variables::<N, _>(law))
    }

    /// Number of history variables of the normal component, which come first, if the components are independent;
    /// `None` if they are coupled.
    pub fn normal_variable_count(&self) -> Option<usize> {
        match self {
            Self::Elastic(_) | Self::Viscous(_) | Self::Porous(_) => Some(history::SHEAR_MOTION),
            Self::Plastic(_) | Self::Saturated(_) | Self::Cracked(_) | Self::Breaking(_) => None,
        }
    }

    /// Constants of the flow of the fluid along the layer; `None` unless it is saturated.
    pub fn fluid(&self) -> Option<&FluidConstants<N>> {
        match self {
            Self::Saturated(law) => Some(&law.fluid),
            _ => None,
        }
    }

    /// Returns the state of a face for output.
    pub fn to_face_record(&self, history: &[N]) -> FaceRecord<N> {
        let zero = N::ZERO;
        let state = history[history::NORMAL_STATE];
        let mut record = FaceRecord {
            slip: zero,
            opening: zero,
            slip_time: zero,
            fracture_time: zero,
            normal_stress: state,
            shear_stress: history[history::SHEAR_STRESS],
            porosity: zero,
            pressure: zero,
            fluid_velocity: zero,
        };
        match self {
            Self::Elastic(_) | Self::Plastic(_) | Self::Viscous(_) => {}
            Self::Porous(law) => {
                record.normal_stress = law.normal.elasticity.stress(state);
                record.porosity = law.normal.elasticity.current_porosity(state);
            }
            Self::Saturated(law) => {
                record.normal_stress = law.normal_stress(history);
                record.porosity = law.porosity(history);
                record.pressure = law.pressure(history);
                record.fluid_velocity = history[history::FLUID_VELOCITY];
            }
            Self::Cracked(law) => {
                record.normal_stress = law.normal.elasticity.stress(state);
                record.opening = law.normal.elasticity.thickness * state.max(zero);
            }
            Self::Breaking(law) => {
                record.normal_stress = law.normal_stress(history);
                record.fracture_time = history[history::FRACTURE_TIME];
                record.opening = law.compliance[0] * (state - record.normal_stress);
            }
        }
        if self.has_slip() {
            record.slip = history[history::SLIP];
            record.slip_time = history[history::SLIP_TIME];
        }
        record
    }

    fn has_slip(&self) -> bool {
        match self {
            Self::Plastic(_) | Self::Breaking(_) => true,
            Self::Cracked(law) => law.friction.is_some(),
            Self::Porous(law) => matches!(law.shear, TangentialComponent::Plastic(..)),
            Self::Elastic(_) | Self::Viscous(_) | Self::Saturated(_) => false,
        }
    }
}

impl<N: Number> FaceLaw<N, 2> for LayerLaw<N> {
    const HISTORY_VARIABLE_COUNT: usize = MAX_HISTORY_VARIABLES;

    fn initialise(&self, velocities: &[[N; 2]; 2], history: &mut [N]) {
        for_each_kind!(self, law => law.initialise(velocities, history));
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; 2],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; 2] {
        for_each_kind!(self, law => law.advance(incoming, interval, history))
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        for_each_kind!(self, law => law.energy(history))
    }
}
