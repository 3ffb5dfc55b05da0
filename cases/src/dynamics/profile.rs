//! Factors of a load along its side.

use super::Samples;
use super::read::along;
use crate::CaseError;
use crate::section::{Node, Resolved, Section, count, number, numbers, positive, rows};
use models::elementary::Elementary;
use std::f64::consts::{PI, TAU};

/// A factor of a load, by the position on its side.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// cos(2πx/wavelength + phase) along an axis.
    Cos {
        /// The axis, from 0.
        axis: usize,
        /// Wavelength, m; positive.
        wavelength: f64,
        /// Phase, degrees.
        phase_deg: f64,
    },
    /// ½(1 + cos(πr/radius)) about a point, 0 beyond.
    Bell {
        /// The point along the axes of the side ascending, m.
        at: Vec<f64>,
        /// Radius, m; positive.
        radius: f64,
    },
    /// Straight lines between samples along an axis, 0 outside.
    Table {
        /// The axis, from 0.
        axis: usize,
        /// Coordinates, m, and values.
        samples: Samples,
    },
}

impl Profile {
    const NAMES: [&str; 3] = ["cos", "bell", "table"];

    /// The factor at a position along some axes; `distance` is that of two such positions, m.
    pub fn value(
        &self,
        axes: &[usize],
        position: &[f64],
        distance: impl Fn(&[f64], &[f64]) -> f64,
    ) -> f64 {
        let coordinate = |axis: &usize| {
            let place = axes.iter().position(|own| own == axis);
            place.and_then(|place| position.get(place)).copied().unwrap_or(0.0)
        };
        match self {
            Self::Cos { axis, wavelength, phase_deg } => {
                (TAU * coordinate(axis) / wavelength + phase_deg.to_radians()).cr_cos()
            }
            Self::Bell { at, radius } => match distance(position, at) / radius {
                part if part < 1.0 => 0.5 + 0.5 * (PI * part).cr_cos(),
                _ => 0.0,
            },
            Self::Table { axis, samples } => samples.value(coordinate(axis)),
        }
    }

    /// The table `profile` of a load on a side with these axes.
    pub(super) fn read(section: &mut Section, axes: &[usize]) -> Result<Option<Self>, CaseError> {
        let Some(mut section) = section.table("profile")? else { return Ok(None) };
        let axis = |section: &mut Section| match axes {
            [axis] => Ok(*axis),
            _ => {
                let numbers: Vec<String> = axes.iter().map(|axis| (axis + 1).to_string()).collect();
                let expected = format!("{} (an axis of the side)", numbers.join(" or "));
                let own = |node: &Node| count(node)?.checked_sub(1).filter(|a| axes.contains(a));
                section.required("axis", &expected, own)
            }
        };
        let profile = match section.choice("kind", &Self::NAMES, |name| name)? {
            "cos" => {
                let phase = section.optional("phase_deg", "a finite number in degrees", number)?;
                Self::Cos {
                    axis: axis(&mut section)?,
                    wavelength: section.required(
                        "wavelength",
                        "a positive number in m",
                        positive,
                    )?,
                    phase_deg: phase.unwrap_or(0.0),
                }
            }
            "bell" => Self::Bell {
                at: {
                    let expected = along(axes, "where it is 1");
                    section.required("at", &expected, numbers(axes.len()))?
                },
                radius: section.required("radius", "a positive number in m", positive)?,
            },
            _ => Self::Table {
                axis: axis(&mut section)?,
                samples: {
                    let expected = "a list of at least two pairs [coordinate in m, value], \
                                    coordinates increasing";
                    section.required("samples", expected, |node| Samples::new(rows(node)?))?
                },
            },
        };
        section.finish()?;
        Ok(Some(profile))
    }

    /// As TOML; of a side with one axis that goes without saying.
    pub(super) fn resolved(&self, dimensions: usize) -> Resolved {
        let with_axis = |resolved: Resolved, axis: &usize| match dimensions {
            2 => resolved,
            _ => resolved.number("axis", axis + 1),
        };
        let resolved = Resolved::default();
        match self {
            Self::Cos { axis, wavelength, phase_deg } => {
                with_axis(resolved.text("kind", "cos"), axis)
                    .number("wavelength", wavelength)
                    .number("phase_deg", phase_deg)
            }
            Self::Bell { at, radius } => {
                resolved.text("kind", "bell").number("at", at).number("radius", radius)
            }
            Self::Table { axis, samples } => {
                with_axis(resolved.text("kind", "table"), axis).number("samples", samples.samples())
            }
        }
    }
}
