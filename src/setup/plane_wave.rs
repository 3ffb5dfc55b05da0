//! Granular and porous media from a case.

use crate::case::plane_wave::{ContactMedium, PlaneWaveOptions};
use crate::case::{Case, CaseError};
use crate::setup;
use analysis::plane_shocks::PlaneWaveError;
use models::granular_medium::{GranularMedium, GranularParameters};
use models::porous::{PoreContact, PorousMedium, PorousParameters};
use models::solid::parameters::Isotropic;
use models::uniaxial::UniaxialDiagram;

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
    let PlaneWaveOptions { medium, .. } = case.require_plane_wave()?;
    let solid =
        setup::solid::create_solid(&case.material).map_err(|error| case.locate_error(error))?;
    let elastic = solid.elastic_law.downcast::<Isotropic>().ok_or_else(|| {
        let found = "found a solid that is not isotropic".to_owned();
        case.plane_wave_error("model.kind", found, "expected classical".to_owned())
    })?;
    let (density, shear_modulus) = (elastic.density, elastic.mu);
    let bulk_modulus = elastic.lambda + 2.0 / 3.0 * elastic.mu;
    let created = match *medium {
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
    created.map_err(|error| case.locate_medium_error(error))
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
