//! Initial state of a plane pulse.

use super::geometry::{cell_at, centre};
use crate::Error;
use crate::case::dynamics::{Dynamics, PlanePulse as Given, Polarization};
use crate::case::{Case, Wave};
use crate::setup::solid::{elastic_law_and_set, normal};
use dynamics::initial::PlanePulse;
use models::solid::parameters::Isotropic;
use models::solid::waves::Field;

/// Greatest fraction of the amplitude allowed in other media.
const OUTSIDE: f64 = 1e-6;

/// Plane pulse in its medium.
pub(super) struct Incident<'a> {
    given: &'a Given,
    pulse: PlanePulse,
    /// Index of its medium.
    medium: u16,
}

impl<'a> Incident<'a> {
    /// # Errors
    /// The medium has spins, so that its waves are dispersive, or the pulse extends into another medium.
    pub(super) fn new(
        case: &Case,
        dynamics: &Dynamics,
        of_cell: &[u16],
        given: &'a Given,
        key: &str,
    ) -> Result<Self, Error> {
        let medium = of_cell[cell_at(dynamics, &given.at)];
        let region = dynamics.regions.get(usize::from(medium));
        let own = region.map_or(&case.material, |region| &region.material);
        let (elastic, _) = elastic_law_and_set(own).map_err(|error| own.locate(error))?;
        let classical = elastic.downcast::<Isotropic>().filter(|own| own.microrotation.is_none());
        let Some(solid) = classical else {
            let found = format!("a pulse in a solid of kind {}", own.kind.name());
            let allowed = "the kind classical: in others waves change their shape; give pulse \
                           or plane-wave";
            return Err(dynamics.locate(&format!("{key}.kind"), found, allowed).into());
        };
        let wave = Wave {
            number: 1.0,
            direction_deg: given.direction_deg,
            elevation_deg: given.elevation_deg,
            greatest_number: 0.0,
        };
        let n = normal(&wave);
        let pulse = match given.polarization {
            Polarization::P => PlanePulse::longitudinal(solid, n),
            Polarization::S => {
                let [azimuth, elevation, angle] =
                    [given.direction_deg, given.elevation_deg, given.polarization_deg]
                        .map(f64::to_radians);
                PlanePulse::transverse(solid, n, azimuth, elevation, angle)
            }
        };
        let own = Self { given, pulse, medium };
        for (cell, _) in of_cell.iter().enumerate().filter(|other| *other.1 != medium) {
            let x = centre(dynamics, cell);
            if own.shape(&x).abs() > OUTSIDE {
                let found = format!("a pulse that reaches another medium at {x:?}");
                let allowed = "one that begins in one medium: a smaller width, or at and time \
                               farther from the others";
                return Err(dynamics.locate(key, found, allowed).into());
            }
        }
        Ok(own)
    }

    /// Returns the pulse at a point at time 0, relative to its amplitude.
    fn shape(&self, x: &[f64]) -> f64 {
        let from: Vec<f64> = x.iter().zip(&self.given.at).map(|(x, at)| x - at).collect();
        let [along, aside] = self.pulse.distances(&from);
        self.given.time.value(-along / self.pulse.speed()) * self.given.across(aside)
    }

    /// Returns the value of a field at a point of a medium; 0 in other media.
    pub(super) fn value(&self, field: Field, x: &[f64], medium: u16) -> f64 {
        match self.pulse.factor(field).filter(|_| medium == self.medium) {
            Some(factor) => self.given.amplitude * factor * self.shape(x),
            None => 0.0,
        }
    }
}
