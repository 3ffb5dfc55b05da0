//! Input of a dispersion figure.

use super::styles::branch_style;
use crate::growth::LineStyle;
use crate::picture::Point;

/// A branch of the dispersion relation. Points are in the units of the axes; NaN interrupts a line.
#[derive(Debug, Clone, PartialEq)]
pub struct DispersionBranch {
    /// Legend text. The branch number is shown in the legend and on the lines.
    pub label: String,
    /// Pairs of wave number and angular frequency; the phase speed is drawn from the same points.
    pub frequency: Vec<[f64; 2]>,
    /// Pairs of wave number and group speed; may be empty.
    pub group_speed: Vec<[f64; 2]>,
    /// Measured pairs of wave number and angular frequency, drawn as rings, with their phase speeds in the panel of
    /// speeds; may be empty.
    pub measured_frequency: Vec<[f64; 2]>,
    /// Those of the measured pairs that disagree with the prediction, marked by red crosses; may be empty.
    pub disagreeing_frequency: Vec<[f64; 2]>,
    /// Pairs of wave number and growth rate; may be empty. The panel of growth rates is drawn if at least one branch
    /// has growth rates.
    pub growth_rate: Vec<[f64; 2]>,
}

/// Band gap: frequency interval in which a kind of wave does not propagate, drawn shaded.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyBand {
    /// Legend text, e.g. `band gap`. Bands with the same label are listed once.
    pub label: String,
    /// Lower frequency, in the unit of the frequency axis.
    pub low: f64,
    /// Upper frequency, in the unit of the frequency axis; may be infinite.
    pub high: f64,
}

/// A marked value on the frequency or speed axis, drawn as a thin horizontal line with a label.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceLevel {
    /// Label: a few words, or a symbol with its value.
    pub label: String,
    /// Value, in the unit of the axis. Non-finite levels are not drawn.
    pub value: f64,
}

/// Dispersion diagram: frequencies against the wave number, with growth rates below if there are any, beside phase and
/// group speeds.
///
/// The speed axis is linear; its range covers the group speeds, the marked speeds and the phase speeds of the shortest
/// wave of each branch only, since phase speeds are unbounded near a cut-off. The growth-rate axis is linear if the
/// wave-number axis is linear, and symmetric logarithmic if it is logarithmic.
#[derive(Debug, Clone, PartialEq)]
pub struct DispersionFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name, symbol and unit of the wave number.
    pub wave_number_label: String,
    /// Name, symbol and unit of the frequency.
    pub frequency_label: String,
    /// Name, symbol and unit of the speeds.
    pub speed_label: String,
    /// Name, symbol and unit of the growth rate; unused if no branch has growth rates.
    pub growth_label: String,
    /// Whether the wave-number axis is logarithmic; non-positive wave numbers are then omitted.
    pub is_wave_number_log: bool,
    /// Whether the frequency axis is logarithmic; non-positive frequencies are then omitted.
    pub is_frequency_log: bool,
    /// Branches; the first six have distinct colours.
    pub branches: Vec<DispersionBranch>,
    /// Frequency bands without propagating waves.
    pub bands: Vec<FrequencyBand>,
    /// Cut-off frequencies; dashed lines.
    pub cutoffs: Vec<ReferenceLevel>,
    /// Marked speeds, e.g. short-wave limits; dotted lines.
    pub speed_limits: Vec<ReferenceLevel>,
}

impl DispersionFigure {
    pub(super) fn has_group_speeds(&self) -> bool {
        self.branches.iter().any(|branch| !branch.group_speed.is_empty())
    }

    pub(super) fn branch_style(&self, branch: usize) -> LineStyle {
        branch_style(branch, self.has_group_speeds())
    }

    pub(super) fn has_growth(&self) -> bool {
        self.branches.iter().any(|branch| !branch.growth_rate.is_empty())
    }

    /// Computes the pairs of wave number and phase speed ω/k of a branch.
    pub(super) fn branch_phase_speeds(branch: &DispersionBranch) -> Vec<Point> {
        Self::phase_speeds(&branch.frequency)
    }

    /// Computes the pairs of wave number and phase speed ω/k from pairs of wave number and frequency.
    pub(super) fn phase_speeds(points: &[Point]) -> Vec<Point> {
        points.iter().map(|&[k, omega]| [k, omega / k]).collect()
    }
}
