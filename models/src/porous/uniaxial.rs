//! Uniaxial strain of a porous medium: the pressures of the skeleton and of the collapsed pores add.

use super::parameters::{PoreContact, PorousMedium};
use crate::uniaxial::cone::ConditionalStress;
use crate::uniaxial::{
    ContactState, DiagramSegment, FrictionCone, SegmentState, SkeletonState, StrainIntensity,
    UniaxialDiagram,
};

/// Deviator of the skeleton on a monotone path: elastic between two strains, at the yield limits outside.
#[derive(Clone, Copy, Debug)]
struct ElasticRange {
    /// Strain at which the skeleton yields in extension, and in compression; may be infinite.
    yield_strains: [f64; 2],
    /// Strain without deviator, at the middle of the range.
    neutral_strain: f64,
}

impl PorousMedium {
    /// Returns the diagram of monotone loading from the natural state: compression for ε > 0, extension for ε < 0.
    pub fn loading_diagram(&self) -> UniaxialDiagram {
        let limit = self.yield_strain();
        self.diagram(ElasticRange { yield_strains: [-limit, limit], neutral_strain: 0.0 })
    }

    /// Returns the diagram of monotone unloading from the strain `strain` ≥ 0 of [`loading_diagram`]; for greater
    /// strains it is that of renewed loading.
    ///
    /// [`loading_diagram`]: Self::loading_diagram
    pub fn unloading_diagram(&self, strain: f64) -> UniaxialDiagram {
        let limit = self.yield_strain();
        if strain <= limit {
            return self.loading_diagram();
        }
        let neutral_strain = strain - limit;
        let yield_strains = [strain - 2.0 * limit, strain];
        self.diagram(ElasticRange { yield_strains, neutral_strain })
    }

    /// Returns the pressure on the front that collapsed pores add, its derivative by the strain, Pa, and the state of
    /// the contact; `None` without contact.
    fn contact_pressure(&self, strain: f64) -> Option<([f64; 2], ContactState)> {
        let own = self.parameters();
        let modulus = own.contact_bulk_modulus;
        match own.contact {
            _ if modulus == 0.0 => None,
            PoreContact::Spherical => Some(match strain > own.porosity {
                true => ([modulus * (strain - own.porosity), modulus], ContactState::Closed),
                false => ([0.0, 0.0], ContactState::Open),
            }),
            PoreContact::Frictional { shear_modulus, friction } => {
                let cone = self.contact_cone(shear_modulus, friction);
                let stress = self.conditional_contact_stress(&cone, strain);
                Some((cone.front_pressure(stress, None), cone.state(stress)))
            }
        }
    }

    /// Returns the strains at which the state of the contact changes.
    fn contact_strains(&self) -> Vec<f64> {
        let own = self.parameters();
        match own.contact {
            _ if own.contact_bulk_modulus == 0.0 => Vec::new(),
            PoreContact::Spherical => vec![own.porosity],
            PoreContact::Frictional { shear_modulus, friction } => {
                let cone = self.contact_cone(shear_modulus, friction);
                cone.transition_strains(0.0, self.conditional_contact_stress(&cone, 0.0))
            }
        }
    }

    fn contact_cone(&self, shear_modulus: f64, friction: f64) -> FrictionCone {
        let own = self.parameters();
        FrictionCone {
            bulk_modulus: own.contact_bulk_modulus,
            friction,
            intensity: StrainIntensity::new(shear_modulus, own.intensity_coefficient),
        }
    }

    fn conditional_contact_stress(&self, cone: &FrictionCone, strain: f64) -> ConditionalStress {
        let rate = cone.intensity.intensity_modulus;
        ConditionalStress {
            pressure: cone.bulk_modulus * (strain - self.parameters().porosity),
            intensity: rate * strain,
            intensity_rate: rate,
        }
    }

    fn diagram(&self, range: ElasticRange) -> UniaxialDiagram {
        let bulk_modulus = self.parameters().bulk_modulus;
        let StrainIntensity { intensity_modulus: m, front_ratio: r, .. } = self.intensity();
        let [low, high] = range.yield_strains;
        let segment_at = |strain: f64| {
            let is_plastic = strain < low || strain > high;
            let contact = self.contact_pressure(strain);
            DiagramSegment {
                state: SegmentState {
                    skeleton: match is_plastic {
                        true => SkeletonState::Plastic,
                        false => SkeletonState::Elastic,
                    },
                    contact: contact.map(|own| own.1),
                },
                slope: bulk_modulus
                    + if is_plastic { 0.0 } else { m / r }
                    + contact.map_or(0.0, |own| own.0[1]),
            }
        };
        let pressure_at = |strain: f64| {
            let deviatoric = m / r * (strain.clamp(low, high) - range.neutral_strain);
            let contact = self.contact_pressure(strain).map_or(0.0, |own| own.0[0]);
            bulk_modulus * strain + deviatoric + contact
        };
        let mut strains = range.yield_strains.to_vec();
        strains.extend(self.contact_strains());
        UniaxialDiagram::from_functions(strains, segment_at, pressure_at)
    }
}
