//! Rendering of pictures to PNG and SVG.
//!
//! Pictures are supersampled by [`FINENESS`]: the drawing library rounds coordinates to whole pixels and does not
//! antialias thick lines; averaging the fine pixels does both.

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::RGBColor;

use super::dialect::{BITMAP, Dialect, FINENESS, PATCHES, SVG, fine, fine_patch, refused};
use super::fonts::register_fonts;
use super::geometry::Rectangle;
use super::shapes::{Picture, Shape};
use super::text::WHITE;
use crate::error::FigureError;
use crate::format::Format;

impl Picture {
    /// Renders the picture in a file format and returns the bytes of the file.
    pub fn render(&self, format: Format) -> Result<Vec<u8>, FigureError> {
        register_fonts();
        let (width, height) = (self.width * FINENESS, self.height * FINENESS);
        match format {
            Format::Svg => {
                let mut text = String::new();
                self.paint(SVGBackend::with_string(&mut text, (width, height)), &SVG)?;
                let fine = format!("width=\"{width}\" height=\"{height}\"");
                let nominal = format!("width=\"{}\" height=\"{}\"", self.width, self.height);
                Ok(self.with_patches(&text.replacen(&fine, &nominal, 1)).into_bytes())
            }
            Format::Png => self.compress(&self.pixels()?),
        }
    }

    /// Renders the pixels of the picture row by row, three bytes each.
    pub fn pixels(&self) -> Result<Vec<u8>, FigureError> {
        register_fonts();
        let (width, height) = (self.width * FINENESS, self.height * FINENESS);
        let mut fine = vec![255; 3 * width as usize * height as usize];
        self.paint(BitMapBackend::with_buffer(&mut fine, (width, height)), &BITMAP)?;
        Ok(self.averaged(&fine))
    }

    /// Replaces the placeholder polygons of patches in the SVG by paths.
    fn with_patches(&self, text: &str) -> String {
        let mut whole = String::with_capacity(text.len());
        let mut rest = text;
        for (index, shape) in self.shapes.iter().enumerate() {
            let Shape::Patches(areas, RGBColor(red, green, blue)) = shape else { continue };
            // Quotes in texts are escaped, so that no text contains the placeholder.
            let stand_in = format!("points=\"{PATCHES},{index} \"/>");
            let Some(place) = rest.find(&stand_in) else { continue };
            let start = rest[..place].rfind('<').unwrap_or(place);
            whole.push_str(&rest[..start]);
            let look = format!("fill=\"#{red:02X}{green:02X}{blue:02X}\"");
            whole.push_str(&format!("<path shape-rendering=\"crispEdges\" {look} d=\""));
            for ([left, top], [right, bottom]) in areas.iter().filter_map(fine_patch) {
                let (width, height) = (right - left, bottom - top);
                whole.push_str(&format!("M{left} {top}h{width}v{height}h-{width}z"));
            }
            whole.push_str("\"/>");
            rest = &rest[place + stand_in.len()..];
        }
        whole.push_str(rest);
        whole
    }

    /// Averages the fine pixels of each pixel.
    fn averaged(&self, fine: &[u8]) -> Vec<u8> {
        let fineness = FINENESS as usize;
        let width = 3 * self.width as usize;
        let mut pixels = Vec::with_capacity(width * self.height as usize);
        let mut sums = vec![0_u16; width];
        for rows in fine.chunks_exact(fineness * fineness * width) {
            sums.fill(0);
            for row in rows.chunks_exact(fineness * width) {
                for (sum, block) in sums.chunks_exact_mut(3).zip(row.chunks_exact(3 * fineness)) {
                    for pixel in block.chunks_exact(3) {
                        for (sum, value) in sum.iter_mut().zip(pixel) {
                            *sum += u16::from(*value);
                        }
                    }
                }
            }
            let count = (FINENESS * FINENESS) as u16;
            pixels.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
        }
        pixels
    }

    fn compress(&self, pixels: &[u8]) -> Result<Vec<u8>, FigureError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(pixels)?;
        writer.finish()?;
        Ok(bytes)
    }

    fn paint<B: DrawingBackend>(&self, mut on: B, dialect: &Dialect) -> Result<(), FigureError> {
        let sheet = Rectangle {
            left: 0.0,
            top: 0.0,
            right: f64::from(self.width),
            bottom: f64::from(self.height),
        };
        let background = Shape::Rectangle(sheet, WHITE);
        let shapes = self.shapes.iter().enumerate();
        for (index, shape) in std::iter::once((0, &background)).chain(shapes) {
            match shape {
                Shape::Rectangle(area, colour) => {
                    let (from, to) = (fine([area.left, area.top]), fine([area.right, area.bottom]));
                    on.draw_rect(from, to, colour, true).map_err(refused)?;
                }
                Shape::Patches(_, colour) if dialect.is_text => {
                    let stand_in = [(PATCHES, index as i32)];
                    on.fill_polygon(stand_in, colour).map_err(refused)?;
                }
                Shape::Patches(areas, colour) => {
                    for ([left, top], [right, bottom]) in areas.iter().filter_map(fine_patch) {
                        let (from, to) = ((left, top), (right, bottom));
                        on.draw_rect(from, to, colour, true).map_err(refused)?;
                    }
                }
                Shape::Polygon(points, colour) => {
                    let corners = points.iter().map(|&point| fine(point));
                    on.fill_polygon(corners, colour).map_err(refused)?;
                }
                Shape::Line { points, width, colour } => {
                    dialect.stroke(&mut on, points, *width, *colour)?;
                }
                Shape::Text(line) => dialect.write(&mut on, line)?,
            }
        }
        on.present().map_err(refused)
    }
}
