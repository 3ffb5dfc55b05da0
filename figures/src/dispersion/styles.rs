//! Colours and dash patterns of branches, levels and bands.

use plotters::style::RGBColor;

use crate::growth::LINE_WIDTH;
use crate::picture::Colour;

/// Colours after Okabe and Ito (2008), darkened for lines. In greyscale the numbers on the lines distinguish the
/// branches.
pub(super) const BRANCH_COLOURS: [Colour; 6] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 138, 100),
    RGBColor(176, 80, 140),
    RGBColor(150, 110, 0),
];

pub(super) const BAND_COLOUR: Colour = RGBColor(228, 224, 214);
pub(super) const GROUP_SPEED_DASHES: &[f64] = &[13.0, 7.0];
pub(super) const CUTOFF_DASHES: &[f64] = &[9.0, 6.0];
pub(super) const SPEED_LIMIT_DASHES: &[f64] = &[2.5, 5.0];
pub(super) const LEVEL_LINE_WIDTH: f64 = 2.0;

/// Returns the width of the lines of a branch, pixels: branches with the colours of earlier ones are thinner.
pub(super) fn branch_width(branch: usize) -> f64 {
    if (branch / BRANCH_COLOURS.len()).is_multiple_of(2) { LINE_WIDTH } else { 0.5 * LINE_WIDTH }
}
