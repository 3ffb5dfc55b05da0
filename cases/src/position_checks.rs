//! Checks of positions in a grid or box.

use crate::error::CaseError;
use crate::section::{SectionReader, join_with_commas};
use models::common::decimal::ToPlainText;

/// Tolerance for positions outside the grid, relative to the extent of the grid along the axis: the computed bound
/// origin + cells × spacing differs from the intended decimal number by rounding (100 × 0.29 < 29).
const RELATIVE_TOLERANCE: f64 = 1e-12;

/// Domain of positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PositionDomain {
    /// Rectangular grid.
    Grid,
    /// Polar grid, with the angle in degrees along the first axis.
    PolarGrid,
    /// Box of a flow.
    Box,
}

impl PositionDomain {
    /// Returns the name in messages.
    const fn name(self) -> &'static str {
        match self {
            Self::Grid | Self::PolarGrid => "grid",
            Self::Box => "box",
        }
    }
}

/// Checks that a position, the value of `key` along `axes`, is within the `bounds` of the grid or box.
pub(crate) fn check_position(
    section: &SectionReader,
    key: &str,
    position: &[f64],
    axes: &[usize],
    bounds: &[[f64; 2]],
    domain: PositionDomain,
) -> Result<(), CaseError> {
    let domain_name = domain.name();
    let is_inside = |(x, [first, last]): (&f64, &[f64; 2])| {
        let tolerance = RELATIVE_TOLERANCE * (last - first);
        (first - tolerance..=last + tolerance).contains(x)
    };
    if position.iter().zip(bounds).all(is_inside) {
        return Ok(());
    }
    // Values that differ from 0 only by rounding errors are printed as 0.
    let round_to_zero = |x: f64, length: f64| match x.abs() < RELATIVE_TOLERANCE * length {
        true => 0.0,
        false => format!("{x:.11e}").parse().unwrap_or(x),
    };
    let axis_ranges: Vec<String> = axes
        .iter()
        .zip(bounds)
        .map(|(axis, [first, last])| {
            let [from, to] = [first, last].map(|x| round_to_zero(*x, last - first));
            let unit =
                if domain == PositionDomain::PolarGrid && *axis == 0 { "degrees" } else { "m" };
            format!("x{} from {} to {} {unit}", axis + 1, from.to_plain_text(), to.to_plain_text())
        })
        .collect();
    let found =
        format!("found {position}, outside the {domain_name}", position = position.to_plain_text());
    Err(section.key_error(
        key,
        found,
        format!("the {domain_name} has {}", join_with_commas(&axis_ranges)),
    ))
}

/// Checks that `from` < `to` along each axis.
pub(crate) fn check_order(
    section: &SectionReader,
    from: &[f64],
    to: &[f64],
) -> Result<(), CaseError> {
    if from.iter().zip(to).all(|(from, to)| from < to) {
        return Ok(());
    }
    let [from, to] = [from, to].map(|end| match end {
        [one] => one.to_plain_text(),
        all => all.to_plain_text(),
    });
    let found = format!("found {to} with from = {from}");
    Err(section.key_error("to", found, "to must be greater than from along each axis"))
}
