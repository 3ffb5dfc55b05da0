//! Size of a rendered picture, and removal of its heading.

use super::geometry::{Point, Rectangle};
use super::shapes::{Picture, PictureShape};
use super::text::Text;
use crate::error::FigureError;
use crate::format::FigureOptions;
use std::ops::Range;

/// Title and subtitle of a picture.
#[derive(Clone)]
pub(super) struct Heading {
    /// Indices of its shapes.
    pub shapes: Range<usize>,
    /// Height that the picture loses without its heading, pixels.
    pub height: f64,
}

/// Uniform scaling followed by a translation, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    pub scale: f64,
    pub offset: Point,
}

impl Placement {
    /// Fits a picture in a frame and centres it.
    pub fn fit([width, height]: [f64; 2], frame: [f64; 2]) -> Self {
        let scale = (frame[0] / width).min(frame[1] / height);
        Self {
            scale,
            offset: [0.5 * (frame[0] - scale * width), 0.5 * (frame[1] - scale * height)],
        }
    }

    fn point(self, [x, y]: Point) -> Point {
        [self.offset[0] + self.scale * x, self.offset[1] + self.scale * y]
    }

    fn area(self, area: &Rectangle) -> Rectangle {
        let [left, top] = self.point([area.left, area.top]);
        let [right, bottom] = self.point([area.right, area.bottom]);
        Rectangle { left, top, right, bottom }
    }
}

impl PictureShape {
    /// Scales and moves the shape.
    pub(super) fn place(&self, by: Placement) -> Self {
        let points = |points: &[Point]| points.iter().map(|point| by.point(*point)).collect();
        match self {
            Self::Rectangle(area, colour) => Self::Rectangle(by.area(area), *colour),
            Self::Patches(areas, colour) => {
                Self::Patches(areas.iter().map(|area| by.area(area)).collect(), *colour)
            }
            Self::Polygon(corners, colour) => Self::Polygon(points(corners), *colour),
            Self::Line { points: own, width, colour, is_curve } => Self::Line {
                points: points(own),
                width: by.scale * width,
                colour: *colour,
                is_curve: *is_curve,
            },
            Self::Text(text) => Self::Text(Text {
                anchor_point: by.point(text.anchor_point),
                font_size: by.scale * text.font_size,
                ..text.clone()
            }),
        }
    }

    /// Moves the shape downwards by a distance in pixels.
    pub(super) fn shift_down(&self, offset: f64) -> Self {
        self.place(Placement { scale: 1.0, offset: [0.0, offset] })
    }
}

impl Picture {
    /// Returns the natural size of the picture, pixels.
    pub(super) fn size(&self) -> [f64; 2] {
        [self.width, self.height].map(f64::from)
    }

    /// Returns the picture without its headings; the shapes below a heading are moved upwards by its height.
    pub(super) fn without_headings(&self) -> Self {
        let removed: f64 = self.headings.iter().map(|heading| heading.height).sum();
        let mut picture = Self::new(self.width, (f64::from(self.height) - removed).ceil() as u32);
        for (index, shape) in self.shapes.iter().enumerate() {
            if self.headings.iter().any(|heading| heading.shapes.contains(&index)) {
                continue;
            }
            let above = self.headings.iter().filter(|heading| heading.shapes.end <= index);
            let offset = above.map(|heading| heading.height).sum::<f64>();
            picture.shapes.push(shape.shift_down(-offset));
        }
        picture
    }

    /// Returns the picture scaled to the number of pixels of a PNG.
    ///
    /// # Errors
    /// There would be more than [`FigureOptions::MAX_PIXELS`].
    pub(super) fn scaled_to_pixels(&self, options: &FigureOptions) -> Result<Self, FigureError> {
        let [width, height] = options.pixel_size(self.size());
        if width * height > FigureOptions::MAX_PIXELS {
            return Err(FigureError::TooManyPixels { width, height });
        }
        let by = Placement::fit(self.size(), [width, height]);
        let mut picture = Self::new(width as u32, height as u32);
        picture.shapes = self.shapes.iter().map(|shape| shape.place(by)).collect();
        Ok(picture)
    }
}
