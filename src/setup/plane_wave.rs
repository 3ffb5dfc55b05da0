//! Granular and porous media from a case.

use crate::case::plane_wave::{ContactMedium, DashpotArrangement};
use crate::case::{Case, CaseError, Material};
use crate::setup;
use analysis::plane_shocks::PlaneWaveError;
use dynamics::contact_law::ContactLaw;
use dynamics::medium::Medium;
use models::InputError;
use models::common::decimal::ToPlainText;
use models::granular_medium::{
    GranularContact, GranularMedium, GranularParameters, KelvinVoigtParticles, MaxwellParticles,
};
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
/// The case has no such medium, a constant is out of range, or the medium has viscosity.
pub fn create_medium(case: &Case) -> Result<PlaneWaveMedium, CaseError> {
    let contacts = case.require_contacts()?;
    check_without_viscosity(&case.material, contacts)?;
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
        ContactMedium::Granular { friction, yield_stress, intensity_coefficient, .. } => {
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
            ..
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

/// Returns the viscosities η_s and η_v of particles, Pa·s.
fn viscosities(contacts: &ContactMedium) -> [Option<f64>; 2] {
    match contacts {
        ContactMedium::Granular { viscosities, .. } => *viscosities,
        ContactMedium::Porous { .. } => [None; 2],
    }
}

/// Checks that plane waves of a material are known exactly: it has no viscosity.
///
/// # Errors
/// A viscosity is given.
pub(crate) fn check_without_viscosity(
    material: &Material,
    contacts: &ContactMedium,
) -> Result<(), CaseError> {
    let [shear, bulk] = viscosities(contacts);
    let plastic = match contacts {
        ContactMedium::Porous { plastic_viscosity, .. } => *plastic_viscosity,
        ContactMedium::Granular { .. } => None,
    };
    let values =
        [("shear_viscosity", shear), ("bulk_viscosity", bulk), ("plastic_viscosity", plastic)];
    match values.into_iter().find_map(|(key, value)| Some((key, value?))) {
        None => Ok(()),
        Some((input, value)) => Err(material.locate_medium_error(InputError {
            input,
            rejected_value: value.to_plain_text(),
            allowed_values: "leave it out: the waves are known for media without viscosity"
                .to_owned(),
        })),
    }
}

/// Time step for which the law of parallel dashpots is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum DashpotStep {
    /// The longest one in which the fastest waves of the medium travel at most this distance, m.
    Longest(f64),
    /// A time step, s.
    Given(f64),
}

/// Whether the particles of a medium have parallel dashpots, whose law depends on the time step.
pub(crate) fn has_parallel_dashpots(contacts: &ContactMedium) -> bool {
    let dashpot = match contacts {
        ContactMedium::Granular { dashpot, .. } => *dashpot,
        ContactMedium::Porous { .. } => DashpotArrangement::Series,
    };
    dashpot == DashpotArrangement::Parallel
}

/// Creates the solver medium of a granular or porous medium in a grid of `dimensions` axes; `step`: see [`DashpotStep`].
///
/// # Errors
/// A constant is out of range, or plastic flow beside a contact by cone has a viscosity.
pub(crate) fn create_solver_medium(
    material: &Material,
    contacts: &ContactMedium,
    dimensions: usize,
    step: DashpotStep,
) -> Result<Medium, CaseError> {
    match create_material_medium(material, contacts)? {
        PlaneWaveMedium::Granular(medium) => {
            let law = match viscosities(contacts) {
                [None, None] => ContactLaw::from(&medium),
                given if has_parallel_dashpots(contacts) => {
                    let particles = KelvinVoigtParticles::new(given)
                        .map_err(|error| material.locate_medium_error(error))?;
                    let step = match step {
                        DashpotStep::Longest(distance) => particles.longest_step(&medium, distance),
                        DashpotStep::Given(step) => step,
                    };
                    ContactLaw::from_damped(&medium, particles, step)
                }
                given => {
                    let shear_modulus = medium.parameters().shear_modulus;
                    let particles =
                        MaxwellParticles::new(&GranularContact::new(&medium), shear_modulus, given)
                            .map_err(|error| material.locate_medium_error(error))?;
                    ContactLaw::from_viscous(&medium, particles)
                }
            };
            Ok(Medium::with_contact(law, dimensions))
        }
        PlaneWaveMedium::Porous(porous) => {
            let law = ContactLaw::from_porous(&porous);
            let medium = Medium::with_contact(law, dimensions);
            let PorousParameters { shear_modulus, yield_stress, intensity_coefficient, .. } =
                *porous.parameters();
            // √(c² s:s) ≤ τ_s is √(½ s:s) ≤ τ_s/√(2c²).
            let set =
                |limit: f64| Mises::new_von_mises(limit / (2.0 * intensity_coefficient).sqrt());
            let plastic_viscosity = match contacts {
                ContactMedium::Porous { plastic_viscosity, .. } => *plastic_viscosity,
                ContactMedium::Granular { .. } => None,
            };
            if let (ContactLaw::PorousPlasticCone { .. }, Some(viscosity)) =
                (law, plastic_viscosity)
            {
                return Err(material.locate_medium_error(InputError {
                    input: "plastic_viscosity",
                    rejected_value: format!(
                        "{viscosity} beside a contact by cone",
                        viscosity = viscosity.to_plain_text()
                    ),
                    allowed_values: "leave it out, or set porous.contact = \"spherical\""
                        .to_owned(),
                }));
            }
            Ok(match (yield_stress, plastic_viscosity) {
                // A contact by cone has the yield stress in its own law.
                _ if matches!(law, ContactLaw::PorousPlasticCone { .. }) => medium,
                (None, _) => medium,
                (Some(limit), None) => medium.with_yield_set(set(limit)),
                (Some(limit), Some(viscosity)) => {
                    let time = viscosity / (2.0 * shear_modulus * intensity_coefficient);
                    medium.with_yield_set(set(limit)).with_overstress_time(time)
                }
            })
        }
    }
}

/// Converts an error of a plane wave problem to an error at a key of the case.
pub fn locate_plane_wave_error(case: &Case, key: &str, error: PlaneWaveError) -> CaseError {
    let extreme = match error {
        PlaneWaveError::NotFinite => case.find_extreme_number(),
        _ => None,
    };
    if let Some((key, value)) = extreme {
        let size = if value.abs() > 1.0 { "smaller" } else { "larger" };
        let allowed = format!("use a number of {size} magnitude: the waves overflow");
        let found = format!("found {value}", value = value.to_plain_text());
        return case.plane_wave_error(&key, found, allowed);
    }
    let (found, allowed) = match error {
        PlaneWaveError::OutOfRange { quantity, value, allowed } => (
            format!("found {value} for {quantity}", value = value.to_plain_text()),
            allowed.to_owned(),
        ),
        PlaneWaveError::NotFinite => (
            "found a load whose waves are not finite".to_owned(),
            "use numbers that are neither so large nor so small".to_owned(),
        ),
        PlaneWaveError::BeyondDiagram { maximum } => (
            "found a load beyond the diagram".to_owned(),
            format!(
                "expected a pressure of at most {maximum} Pa",
                maximum = maximum.to_plain_text()
            ),
        ),
        PlaneWaveError::NotLoading { pressure, initial } => (
            format!("found {pressure} Pa", pressure = pressure.to_plain_text()),
            format!(
                "expected a pressure above that at rest, {initial} Pa",
                initial = initial.to_plain_text()
            ),
        ),
    };
    case.plane_wave_error(key, found, allowed)
}
