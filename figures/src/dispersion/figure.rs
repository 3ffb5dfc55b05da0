//! The data of a dispersion figure.

use crate::picture::Point;

/// A branch of the dispersion relation. Points are in the units of the axes; NaN
/// interrupts a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Legend text. The branch is numbered there and on its lines.
    pub label: String,
    /// Wave number and angular frequency; the phase speed is drawn from the same points.
    pub frequency: Vec<[f64; 2]>,
    /// Wave number and group speed; may be empty.
    pub group_speed: Vec<[f64; 2]>,
    /// Wave numbers and angular frequencies that were measured, drawn as rings; may be empty. Phase speeds
    /// are drawn from the same points.
    pub measured: Vec<[f64; 2]>,
    /// Wave number and growth rate or attenuation; may be empty. The panel of growth is drawn
    /// where some branch has any.
    pub growth: Vec<[f64; 2]>,
}

/// Frequencies at which no wave of some kind propagates, drawn as a shaded band.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Legend text, such as `forbidden band`. Bands of one label are listed once.
    pub label: String,
    /// Least frequency.
    pub from: f64,
    /// Largest frequency; may be infinite.
    pub to: f64,
}

/// A marked value on a vertical axis, drawn as a thin horizontal line with a label.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// A few words or a symbol with its value.
    pub label: String,
    /// Value, in the unit of the axis. Levels that are not finite are left out.
    pub value: f64,
}

/// Frequencies against the wave number, beside phase and group speeds, and growth rates below
/// where there are some.
///
/// The speeds have a linear axis that covers the group speeds, the limits and the phase speeds of
/// the shortest waves: phase speeds are without bound near a cut-off. Growth rates have a linear
/// axis, over a logarithmic one of wave numbers a linear one about zero and logarithmic beyond.
#[derive(Debug, Clone, PartialEq)]
pub struct DispersionFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name, symbol and unit of the wave number.
    pub k_label: String,
    /// Name, symbol and unit of the frequency.
    pub frequency_label: String,
    /// Name, symbol and unit of the speeds.
    pub speed_label: String,
    /// Name, symbol and unit of the growth rate; unused without growth rates.
    pub growth_label: String,
    /// Whether the wave-number axis is logarithmic; points that are not positive are left out
    /// then.
    pub k_log: bool,
    /// Whether the axis of frequencies is logarithmic.
    pub frequency_log: bool,
    /// The branches; six have colours of their own.
    pub branches: Vec<Branch>,
    /// Frequencies at which waves do not propagate.
    pub bands: Vec<Band>,
    /// Cut-off frequencies, dashed.
    pub cutoffs: Vec<Level>,
    /// Marked speeds such as short-wave limits, dotted.
    pub speed_limits: Vec<Level>,
}

impl DispersionFigure {
    pub(super) fn has_growth(&self) -> bool {
        self.branches.iter().any(|branch| !branch.growth.is_empty())
    }

    /// The phase speeds of a branch.
    pub(super) fn phase(branch: &Branch) -> Vec<Point> {
        Self::phases(&branch.frequency)
    }

    /// Phase speeds from wave numbers and frequencies.
    pub(super) fn phases(points: &[Point]) -> Vec<Point> {
        points.iter().map(|&[k, omega]| [k, omega / k]).collect()
    }
}
