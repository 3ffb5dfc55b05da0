//! Colours and dash patterns of branches, levels and bands.

use plotters::style::RGBColor;

use crate::colour::CURVE_COLOURS;
use crate::growth::{LINE_WIDTH, LineStyle};
use crate::picture::Colour;

/// Colours of the branches; the numbers on the lines distinguish them too.
const BRANCH_COLOURS: [Colour; 6] = [
    CURVE_COLOURS[0],
    CURVE_COLOURS[1],
    CURVE_COLOURS[2],
    CURVE_COLOURS[3],
    CURVE_COLOURS[4],
    CURVE_COLOURS[5],
];

pub(super) const BAND_COLOUR: Colour = RGBColor(228, 224, 214);
pub(super) const GROUP_SPEED_DASHES: &[f64] = &[13.0, 7.0];
pub(super) const CUTOFF_DASHES: &[f64] = &[9.0, 6.0];
pub(super) const SPEED_LIMIT_DASHES: &[f64] = &[2.5, 5.0];
pub(super) const LEVEL_LINE_WIDTH: f64 = 2.0;

/// Returns the style of the solid line of a branch. In figures with dashed group speeds all branches are solid, those with
/// the colours of earlier ones thinner; in other figures the branches differ in their dashes too, so that coincident
/// lines are both visible.
pub(super) fn branch_style(branch: usize, has_group_speeds: bool) -> LineStyle {
    if !has_group_speeds {
        return LineStyle::from_index(branch);
    }
    let is_first = (branch / BRANCH_COLOURS.len()).is_multiple_of(2);
    LineStyle {
        colour: BRANCH_COLOURS[branch % BRANCH_COLOURS.len()],
        dashes: &[],
        width: if is_first { LINE_WIDTH } else { 0.5 * LINE_WIDTH },
    }
}
