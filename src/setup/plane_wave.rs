//! Granular and porous media from a case.

use crate::case::plane_wave::ContactMedium;
use crate::case::{Case, CaseError, Material};
use crate::setup;
use analysis::plane_shocks::PlaneWaveError;
use dynamics::contact_law::ContactLaw;
use dynamics::medium::Medium;
use models::InputError;
use models::granular_medium::{GranularMedium, GranularParameters};
use models::porous::{PoreContact, PorousMedium, PorousParameters};
use models::solid::parameters::Isotropic;
use models::uniaxial::UniaxialDiagram;
use models::yield_set::parameters::Mises;

/// Granular or porous medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneWaveMedium {
    /// Granular medium.
    Granular(GranularMedium),
    /// Porous medium.
    Porous(PorousMedium),
}

impl PlaneWaveMedium {
    /// Returns the density, kg/m³.
    pub fn density(&self) -> f64 {
        match self {
            Self::Granular(medium) => medium.parameters().density,
            Self::Porous(medium) => medium.parameters().density,
        }
    }

    /// Returns the diagram of loading from the natural state.
    pub fn loading_diagram(&self) -> UniaxialDiagram {
        match self {
            Self::Granular(medium) => medium.loading_diagram(),
            Self::Porous(medium) => medium.loading_diagram(),
        }
    }

    /// Returns the diagram of unloading from a strain of the loading diagram.
    pub fn unloading_diagram(&self, strain: f64) -> UniaxialDiagram {
        match self {
            Self::Granular(medium) => medium.unloading_diagram(strain),
            Self::Porous(medium) => medium.unloading_diagram(strain),
        }
    }
}

/// Creates the granular or porous medium of a case.
///
/// # Errors
/// The case has no such medium, or a constant is out of range.
pub fn create_medium(case: &Case) -> Result<PlaneWaveMedium, CaseError> {
    let contacts = case.require_contacts()?;
    create_material_medium(&case.material, contacts)
}

/// Creates the granular or porous medium of a material with these contacts.
///
/// # Errors
/// A constant is out of range.
pub(crate) fn create_material_medium(
    material: &Material,
    contacts: &ContactMedium,
) -> Result<PlaneWaveMedium, CaseError> {
    let law = setup::solid::create_elastic_law_and_set(material)
        .map_err(|error| material.locate_error(error))?
        .0;
    let elastic = law.downcast::<Isotropic>().ok_or_else(|| {
        material.locate_error(InputError {
            input: "kind",
            rejected_value: "a solid that is not isotropic".to_owned(),
            allowed_values: "expected classical".to_owned(),
        })
    })?;
    let (density, shear_modulus) = (elastic.density, elastic.mu);
    let bulk_modulus = elastic.lambda + 2.0 / 3.0 * elastic.mu;
    let created = match *contacts {
        ContactMedium::Granular { friction, yield_stress, intensity_coefficient } => {
            let parameters = GranularParameters {
                density,
                bulk_modulus,
                shear_modulus,
                friction,
                yield_stress,
                intensity_coefficient,
            };
            GranularMedium::new(parameters).map(PlaneWaveMedium::Granular)
        }
        ContactMedium::Porous {
            porosity,
            yield_stress,
            contact_bulk_modulus,
            contact_cone,
            intensity_coefficient,
        } => {
            let contact = match contact_cone {
                None => PoreContact::Spherical,
                Some([shear_modulus, friction]) => {
                    PoreContact::Frictional { shear_modulus, friction }
                }
            };
            let parameters = PorousParameters {
                density,
                bulk_modulus,
                shear_modulus,
                yield_stress,
                intensity_coefficient,
                contact_bulk_modulus,
                porosity,
                contact,
            };
            PorousMedium::new(parameters).map(PlaneWaveMedium::Porous)
        }
    };
    created.map_err(|error| material.locate_medium_error(error))
}

/// Creates the solver medium of a granular or porous medium in a grid of `dimensions` axes.
///
/// # Errors
/// A constant is out of range, or the walls of pores have friction.
pub(crate) fn create_solver_medium(
    material: &Material,
    contacts: &ContactMedium,
    dimensions: usize,
) -> Result<Medium, CaseError> {
    match create_material_medium(material, contacts)? {
        PlaneWaveMedium::Granular(medium) => {
            Ok(Medium::with_contact(ContactLaw::from(&medium), dimensions))
        }
        PlaneWaveMedium::Porous(porous) => {
            let Some(law) = ContactLaw::from_porous(&porous) else {
                return Err(
                    material.locate_medium_error(InputError {
                        input: "contact",
                        rejected_value: "cone".to_owned(),
                        allowed_values:
                            "expected spherical: runs have no friction of the walls of pores"
                                .to_owned(),
                    }),
                );
            };
            let medium = Medium::with_contact(law, dimensions);
            let PorousParameters { yield_stress, intensity_coefficient, .. } = *porous.parameters();
            Ok(match yield_stress {
                // √(c² s:s) ≤ τ_s is √(½ s:s) ≤ τ_s/√(2c²).
                Some(limit) => medium.with_yield_set(Mises::new_von_mises(
                    limit / (2.0 * intensity_coefficient).sqrt(),
                )),
                None => medium,
            })
        }
    }
}

/// Converts an error of a plane wave problem to an error at a key of the case.
pub fn locate_plane_wave_error(case: &Case, key: &str, error: PlaneWaveError) -> CaseError {
    let (found, allowed) = match error {
        PlaneWaveError::OutOfRange { quantity, value, allowed } => {
            (format!("found {value:?} for {quantity}"), allowed.to_owned())
        }
        PlaneWaveError::NotFinite => (
            "found a load whose waves are not finite".to_owned(),
            "use numbers that are neither so large nor so small".to_owned(),
        ),
        PlaneWaveError::BeyondDiagram { maximum } => (
            "found a load beyond the diagram".to_owned(),
            format!("expected a pressure of at most {maximum:?} Pa"),
        ),
        PlaneWaveError::NotLoading { pressure, initial } => (
            format!("found {pressure:?} Pa"),
            format!("expected a pressure above that at rest, {initial:?} Pa"),
        ),
    };
    case.plane_wave_error(key, found, allowed)
}
