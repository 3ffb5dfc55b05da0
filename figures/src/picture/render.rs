//! Rendering of pictures to PNG and SVG; `pdf` renders to PDF.
//!
//! Pictures are supersampled by [`SUPERSAMPLING`]: the drawing library rounds coordinates to whole pixels and does not
//! antialias thick lines; averaging the fine pixels does both.

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::RGBColor;

use super::backend::{
    BITMAP_CONVENTIONS, BackendConventions, PATCH_PLACEHOLDER_X, SUPERSAMPLING, SVG_CONVENTIONS,
    fine_patch_corners, to_figure_error, to_fine_pixels,
};
use super::fonts::register_fonts;
use super::geometry::Rectangle;
use super::shapes::{Picture, PictureShape};
use super::text::WHITE;
use crate::error::FigureError;
use crate::format::{FigureFormat, FigureOptions, FigureOutput, FigureSize, MILLIMETRES_PER_INCH};

/// Largest number of pixels that are rendered at a time; a picture of the natural size is rendered at once.
const MAX_BAND_PIXELS: u32 = 6_000_000;

impl Picture {
    /// Renders the picture and returns the bytes of the file.
    pub fn render(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        register_fonts();
        let FigureOutput { format, options } = output.into();
        if !options.has_heading && !self.headings.is_empty() {
            let options = FigureOptions { has_heading: true, ..options };
            return self.without_headings().render(FigureOutput { format, options });
        }
        if options.lists_covering_texts {
            return Ok(self.find_covering_texts().join("\n").into_bytes());
        }
        match format {
            FigureFormat::Svg => self.render_svg(&options),
            FigureFormat::Png if options == FigureOptions::default() => {
                self.encode_png(&self.render_pixels()?, None)
            }
            FigureFormat::Png => {
                let scaled = self.scaled_to_pixels(&options)?;
                scaled.encode_png(&scaled.render_pixels()?, Some(options.resolution()))
            }
            FigureFormat::Pdf => self.render_pdf(&options),
        }
    }

    fn render_svg(&self, options: &FigureOptions) -> Result<Vec<u8>, FigureError> {
        let (width, height) = (self.width * SUPERSAMPLING, self.height * SUPERSAMPLING);
        let mut text = String::new();
        self.draw_shapes(SVGBackend::with_string(&mut text, (width, height)), &SVG_CONVENTIONS)?;
        let fine = format!("width=\"{width}\" height=\"{height}\"");
        let [width, height] = match options.size {
            None => [self.width, self.height].map(|length| length.to_string()),
            Some(FigureSize::Pixels(size)) => size.map(|length| length.to_string()),
            Some(FigureSize::Millimetres(_) | FigureSize::MillimetresWide(_)) => {
                options.printed_size(self.size()).map(|length| format!("{length}mm"))
            }
        };
        // A viewer fits the view box in this size and centres it.
        let nominal = format!("width=\"{width}\" height=\"{height}\"");
        Ok(self.replace_patch_placeholders(&text.replacen(&fine, &nominal, 1)).into_bytes())
    }

    /// Renders the pixels of the picture row by row, three bytes each.
    pub fn render_pixels(&self) -> Result<Vec<u8>, FigureError> {
        self.render_bands((MAX_BAND_PIXELS / self.width.max(1)).max(1))
    }

    /// Renders the pixels in bands of at most `band_height` rows, so that the fine pixels of one band are in memory.
    pub(super) fn render_bands(&self, band_height: u32) -> Result<Vec<u8>, FigureError> {
        register_fonts();
        let mut pixels = Vec::with_capacity(3 * self.width as usize * self.height as usize);
        let mut top = 0;
        while top < self.height {
            let mut band = Self::new(self.width, band_height.min(self.height - top));
            band.shapes = self.shapes.iter().map(|own| own.shift_down(-f64::from(top))).collect();
            top += band.height;
            pixels.extend(band.render_band()?);
        }
        Ok(pixels)
    }

    fn render_band(&self) -> Result<Vec<u8>, FigureError> {
        let (width, height) = (self.width * SUPERSAMPLING, self.height * SUPERSAMPLING);
        let mut fine = vec![255; 3 * width as usize * height as usize];
        self.draw_shapes(
            BitMapBackend::with_buffer(&mut fine, (width, height)),
            &BITMAP_CONVENTIONS,
        )?;
        Ok(self.average_fine_pixels(&fine))
    }

    /// Replaces the placeholder polygons of patches in the SVG by paths.
    fn replace_patch_placeholders(&self, text: &str) -> String {
        let mut whole = String::with_capacity(text.len());
        let mut rest = text;
        for (index, shape) in self.shapes.iter().enumerate() {
            let PictureShape::Patches(areas, RGBColor(red, green, blue)) = shape else { continue };
            // Quotes in texts are escaped, so that no text contains the placeholder.
            let stand_in = format!("points=\"{PATCH_PLACEHOLDER_X},{index} \"/>");
            let Some(place) = rest.find(&stand_in) else { continue };
            let start = rest[..place].rfind('<').unwrap_or(place);
            whole.push_str(&rest[..start]);
            let fill = format!("fill=\"#{red:02X}{green:02X}{blue:02X}\"");
            whole.push_str(&format!("<path shape-rendering=\"crispEdges\" {fill} d=\""));
            for ([left, top], [right, bottom]) in areas.iter().filter_map(fine_patch_corners) {
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
    fn average_fine_pixels(&self, fine: &[u8]) -> Vec<u8> {
        let fineness = SUPERSAMPLING as usize;
        let width = 3 * self.width as usize;
        let mut pixels = Vec::with_capacity(width * self.height as usize);
        let mut sums = vec![0_u16; width];
        for rows in fine.chunks_exact(fineness * fineness * width) {
            sums.fill(0);
            for row in rows.chunks_exact(fineness * width) {
                // Arrays, not iterators over three colours, which take three times as long.
                let blocks = row.as_chunks::<{ 3 * SUPERSAMPLING as usize }>().0;
                for (sum, block) in sums.as_chunks_mut::<3>().0.iter_mut().zip(blocks) {
                    for (index, value) in block.iter().enumerate() {
                        sum[index % 3] += u16::from(*value);
                    }
                }
            }
            let count = (SUPERSAMPLING * SUPERSAMPLING) as u16;
            pixels.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
        }
        pixels
    }

    /// Encodes pixels as PNG, which states a resolution, dots per inch, if one is given.
    fn encode_png(&self, pixels: &[u8], dpi: Option<f64>) -> Result<Vec<u8>, FigureError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let per_metre = dpi.map(|dpi| (1000.0 * dpi / MILLIMETRES_PER_INCH).round() as u32);
        encoder.set_pixel_dims(per_metre.map(|count| png::PixelDimensions {
            xppu: count,
            yppu: count,
            unit: png::Unit::Meter,
        }));
        let mut writer = encoder.write_header()?;
        writer.write_image_data(pixels)?;
        writer.finish()?;
        Ok(bytes)
    }

    fn draw_shapes<B: DrawingBackend>(
        &self,
        mut backend: B,
        conventions: &BackendConventions,
    ) -> Result<(), FigureError> {
        let page = Rectangle {
            left: 0.0,
            top: 0.0,
            right: f64::from(self.width),
            bottom: f64::from(self.height),
        };
        let background = PictureShape::Rectangle(page, WHITE);
        let shapes = self.shapes.iter().enumerate();
        for (index, shape) in std::iter::once((0, &background)).chain(shapes) {
            match shape {
                PictureShape::Rectangle(area, colour) => {
                    let (from, to) = (
                        to_fine_pixels([area.left, area.top]),
                        to_fine_pixels([area.right, area.bottom]),
                    );
                    backend.draw_rect(from, to, colour, true).map_err(to_figure_error)?;
                }
                PictureShape::Patches(_, colour) if conventions.is_svg => {
                    let stand_in = [(PATCH_PLACEHOLDER_X, index as i32)];
                    backend.fill_polygon(stand_in, colour).map_err(to_figure_error)?;
                }
                PictureShape::Patches(areas, colour) => {
                    for ([left, top], [right, bottom]) in
                        areas.iter().filter_map(fine_patch_corners)
                    {
                        let (from, to) = ((left, top), (right, bottom));
                        backend.draw_rect(from, to, colour, true).map_err(to_figure_error)?;
                    }
                }
                PictureShape::Polygon(points, colour) => {
                    let corners = points.iter().map(|&point| to_fine_pixels(point));
                    backend.fill_polygon(corners, colour).map_err(to_figure_error)?;
                }
                PictureShape::Line { points, width, colour, .. } => {
                    conventions.draw_polyline(&mut backend, points, *width, *colour)?;
                }
                PictureShape::Text(line) => conventions.draw_text(&mut backend, line)?,
            }
        }
        backend.present().map_err(to_figure_error)
    }
}
