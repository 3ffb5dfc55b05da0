//! Plane P or S wave with a given waveform as initial state.

use super::time_function::TimeFunction;
use crate::error::CaseError;
use crate::named_enum::named_enum;
use crate::section::{SectionReader, TableWriter};
use models::common::elementary::Elementary;

named_enum! {
    /// Polarisation of a plane wave.
    BodyWaveType {
        /// Longitudinal (P) wave.
        P = "P",
        /// Transverse (S) wave.
        S = "S"
    }
}

/// A plane P or S wave with velocity v = A a g(t − n·(x − x₀)/c) and the stress that belongs to it, with the amplitude
/// A, the unit vector a of the polarisation, the wave normal n, and the wave speed c of the medium at the reference
/// point x₀.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanePulseInput {
    /// Polarisation, which determines the unit vector a. P: a = n. S: a is (−sin α, cos α) with α = `direction_deg`, in
    /// space (−sin α, cos α, 0) rotated about n by `polarization_deg`.
    pub wave_type: BodyWaveType,
    /// Direction of the wave normal n, degrees anticlockwise from x₁.
    pub direction_deg: f64,
    /// Elevation of n above the plane of x₁ and x₂, degrees; 0 in plane strain.
    pub elevation_deg: f64,
    /// For S waves in space the angle of a from the azimuthal towards the elevation direction, degrees; otherwise 0.
    pub polarization_deg: f64,
    /// Reference point x₀, m, at which the velocity of the incident wave is A a g(t).
    pub reference_point: Vec<f64>,
    /// Velocity amplitude A, m/s.
    pub amplitude: f64,
    /// Width of the full amplitude transverse to n, m, with cosine tapers of half the width on either side; `None` if
    /// unbounded.
    pub width: Option<f64>,
    /// Waveform g(t), dimensionless.
    pub waveform: TimeFunction,
}

impl PlanePulseInput {
    /// Computes the taper factor, from 0 to 1, at a distance (m, not negative) from the line through `reference_point`
    /// along n.
    pub fn transverse_taper(&self, distance: f64) -> f64 {
        let Some(width) = self.width else { return 1.0 };
        match distance / width - 0.5 {
            part if part <= 0.0 => 1.0,
            part if part < 0.5 => 0.5 + 0.5 * (std::f64::consts::TAU * part).cr_cos(),
            _ => 0.0,
        }
    }

    /// Reads the keys of the entry except `at` and `time`, whose values (reference point and waveform) are given.
    pub(super) fn read(
        section: &SectionReader,
        at: Vec<f64>,
        time: TimeFunction,
    ) -> Result<Self, CaseError> {
        let polarization = section.read_choice("wave", BodyWaveType::ALL, BodyWaveType::name)?;
        let direction_deg = section.read_or_default("direction_deg")?;
        let (mut elevation_deg, mut polarization_deg) = (0.0, 0.0);
        if section.scope.dimensions() == 3 {
            elevation_deg = section.read_or_default("elevation_deg")?;
            if polarization == BodyWaveType::S {
                polarization_deg = section.read_or_default("polarization_deg")?;
            }
        }
        Ok(Self {
            wave_type: polarization,
            direction_deg,
            elevation_deg,
            polarization_deg,
            reference_point: at,
            amplitude: section.read_required("amplitude")?,
            width: section.read_optional("width")?,
            waveform: time,
        })
    }

    /// Adds all keys of the entry to a table except `kind` and the time function.
    pub(super) fn write_keys(&self, resolved: TableWriter, dimensions: usize) -> TableWriter {
        let mut resolved = resolved
            .with_text("wave", self.wave_type.name())
            .with_number("direction_deg", self.direction_deg);
        if dimensions == 3 {
            resolved = resolved.with_number("elevation_deg", self.elevation_deg);
            if self.wave_type == BodyWaveType::S {
                resolved = resolved.with_number("polarization_deg", self.polarization_deg);
            }
        }
        let resolved = resolved
            .with_number("at", &self.reference_point)
            .with_number("amplitude", self.amplitude);
        match self.width {
            Some(width) => resolved.with_number("width", width),
            None => resolved,
        }
    }
}
