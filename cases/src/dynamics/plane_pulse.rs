//! A plane wave of finite length, as an initial state.

use super::function::TimeFunction;
use crate::error::CaseError;
use crate::named_enum::named_enum;
use crate::section::{Resolved, Section};
use models::common::elementary::Elementary;

named_enum! {
    /// Kind of a plane wave.
    Polarization {
        /// Longitudinal.
        P = "P",
        /// Transverse.
        S = "S"
    }
}

/// A plane P or S wave of the medium around a point, v = amplitude·a g(t − n·(x − at)/c), with its stress.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanePulse {
    /// P: a = n; S: a is n turned by 90° anticlockwise, in space about n by the angle below.
    pub polarization: Polarization,
    /// Direction of n from x₁ anticlockwise, degrees.
    pub direction_deg: f64,
    /// Angle of n above the plane of x₁ and x₂, degrees; 0 in plane strain.
    pub elevation_deg: f64,
    /// Of S waves in space: the angle from the direction of growing azimuth to that of growing elevation,
    /// degrees; else 0.
    pub polarization_deg: f64,
    /// Where the velocity is amplitude·g(t) as long as nothing else arrives, m.
    pub at: Vec<f64>,
    /// m/s.
    pub amplitude: f64,
    /// Width of the full amplitude across n, m; it falls to 0 over half of it on either side. `None`: without end.
    pub width: Option<f64>,
    /// g.
    pub time: TimeFunction,
}

impl PlanePulse {
    /// The factor at a distance from the line through `at` along n, m.
    pub fn across(&self, distance: f64) -> f64 {
        let Some(width) = self.width else { return 1.0 };
        match distance / width - 0.5 {
            part if part <= 0.0 => 1.0,
            part if part < 0.5 => 0.5 + 0.5 * (std::f64::consts::TAU * part).cr_cos(),
            _ => 0.0,
        }
    }

    /// The entry, of which place and function of time are read.
    pub(super) fn read(
        section: &Section,
        at: Vec<f64>,
        time: TimeFunction,
    ) -> Result<Self, CaseError> {
        let polarization = section.choice("wave", Polarization::ALL, Polarization::name)?;
        let direction_deg = section.or_default("direction_deg")?;
        let (mut elevation_deg, mut polarization_deg) = (0.0, 0.0);
        if section.scope.dimensions() == 3 {
            elevation_deg = section.or_default("elevation_deg")?;
            if polarization == Polarization::S {
                polarization_deg = section.or_default("polarization_deg")?;
            }
        }
        Ok(Self {
            polarization,
            direction_deg,
            elevation_deg,
            polarization_deg,
            at,
            amplitude: section.required("amplitude")?,
            width: section.optional("width")?,
            time,
        })
    }

    /// The entry as TOML, but for its function of time.
    pub(super) fn resolved(&self, resolved: Resolved, dimensions: usize) -> Resolved {
        let mut resolved = resolved
            .text("wave", self.polarization.name())
            .number("direction_deg", self.direction_deg);
        if dimensions == 3 {
            resolved = resolved.number("elevation_deg", self.elevation_deg);
            if self.polarization == Polarization::S {
                resolved = resolved.number("polarization_deg", self.polarization_deg);
            }
        }
        let resolved = resolved.number("at", &self.at).number("amplitude", self.amplitude);
        match self.width {
            Some(width) => resolved.number("width", width),
            None => resolved,
        }
    }
}
