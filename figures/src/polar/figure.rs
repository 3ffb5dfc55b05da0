//! Input of a polar diagram.

use plotters::style::RGBColor;

use crate::growth::LabelledCurve;
use crate::picture::{PALE_INK, Picture, Point};

/// Kind of a spoke of a polar diagram, which determines its style.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpokeStyle {
    /// Normal to a characteristic of the steady equations: drawn as a wide pale band.
    CharacteristicNormal,
    /// Degenerate direction, in which a leading coefficient of the dispersion relation at large wave numbers vanishes:
    /// thin dashes, visible also on a band.
    DegenerateDirection,
}

impl SpokeStyle {
    pub(super) const ALL: [Self; 2] = [Self::CharacteristicNormal, Self::DegenerateDirection];

    pub(super) fn description(self) -> &'static str {
        match self {
            Self::CharacteristicNormal => "normal to a characteristic of the steady equations",
            Self::DegenerateDirection => "degenerate direction",
        }
    }

    pub(crate) fn draw(self, picture: &mut Picture, points: &[Point]) {
        match self {
            Self::CharacteristicNormal => picture.draw_line(points, 11.0, RGBColor(203, 205, 214)),
            Self::DegenerateDirection => {
                picture.draw_dashed_line(points, &[11.0, 7.0], 2.0, PALE_INK)
            }
        }
    }
}

/// A marked direction of the wave vector; opposite directions are equivalent.
#[derive(Debug, Clone, PartialEq)]
pub struct Spoke {
    /// Label of a few words, written after the angle; may be empty. Spokes with the same angle share a label.
    pub label: String,
    /// Angle from x₁, degrees anticlockwise. Spokes with a non-finite angle are not drawn.
    pub angle_deg: f64,
    /// Kind, which determines the style.
    pub style: SpokeStyle,
}

/// Polar diagram of growth rates against the direction of the wave vector, over the full circle.
///
/// The radius is symmetric logarithmic: linear near zero and logarithmic at larger magnitudes. A bold circle marks zero
/// growth rate.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Symbol of the growth rate, for the axis of the radius and the legend.
    pub symbol: String,
    /// Unit of the growth rate.
    pub unit: String,
    /// Curves, one per model, over directions from 0 to 180 degrees; opposite directions have the same growth rate.
    pub curves: Vec<LabelledCurve>,
    /// Marked directions of the wave vector.
    pub spokes: Vec<Spoke>,
}

impl Spoke {
    /// Returns the angle of the upper end, degrees in [0, 180); an angle that rounds to 180° gives 0°.
    pub(super) fn upper_angle(&self) -> f64 {
        let angle = self.angle_deg.rem_euclid(180.0);
        if angle >= 179.995 { 0.0 } else { angle }
    }

    /// Formats the angle, rounded to 0.01°.
    pub(super) fn format_angle(&self) -> String {
        let text = format!("{:.2}", self.upper_angle());
        format!("{}°", text.trim_end_matches('0').trim_end_matches('.'))
    }
}
