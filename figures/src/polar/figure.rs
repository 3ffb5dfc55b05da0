//! The data of a polar diagram.

use plotters::style::RGBColor;

use crate::growth::Line;
use crate::picture::{PALE_INK, Picture, Point};
use crate::scale::plain;

/// Kind of a spoke of a polar diagram, which determines its style.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpokeStyle {
    /// Normal to a characteristic of the steady equations: a wide pale band.
    CharacteristicNormal,
    /// A direction in which a leading coefficient vanishes: thin dashes, to be seen on a band too.
    Degenerate,
}

impl SpokeStyle {
    pub(super) const ALL: [Self; 2] = [Self::CharacteristicNormal, Self::Degenerate];

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::CharacteristicNormal => "normal to a characteristic of the steady equations",
            Self::Degenerate => "degenerate direction",
        }
    }

    pub(crate) fn draw(self, picture: &mut Picture, points: &[Point]) {
        match self {
            Self::CharacteristicNormal => picture.line(points, 11.0, RGBColor(203, 205, 214)),
            Self::Degenerate => picture.dashed(points, &[11.0, 7.0], 2.0, PALE_INK),
        }
    }
}

/// A marked direction of the wave vector; opposite directions are the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Spoke {
    /// A few words, written behind the angle; may be empty. Spokes on one angle share a label.
    pub label: String,
    /// Angle from x₁, anticlockwise, in degrees. Directions that are not finite are left out.
    pub angle_deg: f64,
    /// Kind, which determines the style.
    pub style: SpokeStyle,
}

/// Growth rates against the direction of the wave vector, over the full circle.
///
/// The radius is linear about zero and logarithmic on both sides beyond; a bold circle is where
/// waves neither grow nor decay.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Symbol of the growth rate, for the legend.
    pub symbol: String,
    /// Unit of the radius, written on the outermost ring.
    pub unit: String,
    /// The lines, one per model, over directions in degrees from 0 to 180; opposite directions grow
    /// alike.
    pub curves: Vec<Line>,
    /// Marked directions.
    pub spokes: Vec<Spoke>,
}

impl Spoke {
    /// The angle of the end in the upper half, in degrees; one that rounds to 180° is 0°.
    pub(super) fn upper_angle(&self) -> f64 {
        let angle = self.angle_deg.rem_euclid(180.0);
        if angle >= 179.995 { 0.0 } else { angle }
    }

    /// The angle in words, to a hundredth of a degree.
    pub(super) fn words(&self) -> String {
        format!("{}°", plain((100.0 * self.upper_angle()).round() / 100.0))
    }
}
