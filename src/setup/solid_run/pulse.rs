//! Initial state of a plane P or S pulse in a classical medium.

use super::geometry::{cell_centre, find_containing_cell};
use super::grid_part::GridPart;
use crate::Error;
use crate::case::dynamics::{BodyWaveType, PlanePulseInput, SolidRun};
use crate::case::{Case, WaveNumbers};
use crate::setup::solid::{create_elastic_law_and_set, wave_normal};
use dynamics::initial::PlanePulse;
use dynamics::problem::Problem;
use models::common::decimal::ToPlainText;
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;

/// Largest fraction of the pulse amplitude that is allowed at cell centres outside the medium in which the pulse
/// begins.
const MAX_OUTSIDE_FRACTION: f64 = 1e-6;

/// Plane pulse and the medium in which it begins.
pub(super) struct IncidentPulse<'a> {
    case_pulse: &'a PlanePulseInput,
    pulse: PlanePulse,
    /// Index of the medium in which the pulse begins, in the order of the regions.
    medium_index: usize,
}

impl<'a> IncidentPulse<'a> {
    /// Creates the pulse `case_pulse` in the medium at its reference point, in the media of a problem, whose cells the
    /// ranks check by part; `key` is the entry of the pulse in the case.
    ///
    /// # Errors
    /// A constant of the medium is out of range, the medium is not an isotropic solid without microrotation, in which
    /// alone a plane pulse keeps its shape, or the pulse extends into another medium.
    pub(super) fn new<const D: usize>(
        case: &Case,
        solid_run: &SolidRun,
        (problem, part): (&Problem<D>, &GridPart),
        case_pulse: &'a PlanePulseInput,
        key: &str,
    ) -> Result<Self, Error> {
        let medium =
            problem.medium_index(find_containing_cell(solid_run, &case_pulse.reference_point));
        let own = solid_run.materials().get(medium).copied().unwrap_or(&case.material);
        let (elastic, _) =
            create_elastic_law_and_set(own).map_err(|error| own.locate_error(error))?;
        let classical = elastic.downcast::<Isotropic>().filter(|own| own.microrotation.is_none());
        let Some(solid) = classical else {
            let found = format!("a pulse in a solid of kind {}", own.kind.name());
            let allowed = "the kind classical: in others waves change their shape; give pulse \
                           or plane-wave";
            return Err(solid_run.key_error(&format!("{key}.kind"), found, allowed).into());
        };
        let wave = WaveNumbers {
            wave_number: 1.0,
            direction_deg: case_pulse.direction_deg,
            elevation_deg: case_pulse.elevation_deg,
            max_wave_number: 0.0,
        };
        let n = wave_normal(&wave);
        let pulse = match case_pulse.wave_type {
            BodyWaveType::P => PlanePulse::new_longitudinal(solid, n),
            BodyWaveType::S => {
                let [azimuth, elevation, angle] = [
                    case_pulse.direction_deg,
                    case_pulse.elevation_deg,
                    case_pulse.polarization_deg,
                ]
                .map(f64::to_radians);
                PlanePulse::new_transverse(solid, n, azimuth, elevation, angle)
            }
        };
        let own = Self { case_pulse, pulse, medium_index: medium };
        let is_reached = |cell: usize| {
            problem.medium_index(cell) != medium
                && own.relative_amplitude(&cell_centre(solid_run, cell)).abs()
                    > MAX_OUTSIDE_FRACTION
        };
        if let Some(cell) = part.find_first_cell(is_reached) {
            let x = cell_centre(solid_run, cell);
            let found =
                format!("a pulse that reaches another medium at {x}", x = x.to_plain_text());
            let allowed = "one that begins in one medium: a smaller width, or at and time \
                           farther from the others";
            return Err(solid_run.key_error(key, found, allowed).into());
        }
        Ok(own)
    }

    /// Returns the pulse at a point x, m, at time 0, relative to its amplitude: the waveform times the transverse
    /// taper.
    fn relative_amplitude(&self, x: &[f64]) -> f64 {
        let from: Vec<f64> =
            x.iter().zip(&self.case_pulse.reference_point).map(|(x, at)| x - at).collect();
        let [along, aside] = self.pulse.distances(&from);
        self.case_pulse.waveform.evaluate(-along / self.pulse.speed())
            * self.case_pulse.transverse_taper(aside)
    }

    /// Returns the value of a field at a point in the medium of index `medium`; 0 if the pulse is in another medium or
    /// does not change the field.
    pub(super) fn field_value(&self, field: SolidField, x: &[f64], medium: usize) -> f64 {
        match self.pulse.field_per_velocity(field).filter(|_| medium == self.medium_index) {
            Some(factor) => self.case_pulse.amplitude * factor * self.relative_amplitude(x),
            None => 0.0,
        }
    }
}
