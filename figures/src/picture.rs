//! A picture as a list of shapes, and its rendering.
//!
//! Figures are laid out in pixels with fractions. Rendering multiplies by [`FINENESS`]: the drawing
//! library places on whole pixels and leaves the edges of thick lines jagged, averaging the fine
//! pixels afterwards smooths both.

use std::sync::Once;

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    FontDesc, FontFamily, FontStyle, FontTransform, IntoFont, RGBColor, TextStyle, register_font,
};

use crate::{FigureError, Format};

/// Fine pixels along the edge of a pixel of the finished picture.
const FINENESS: u32 = 3;

/// The name under which the fonts are registered. SVG viewers read it as a list of preferences.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// A place in pixels, from the upper left corner to the right and down.
pub(crate) type Point = [f64; 2];

pub(crate) type Colour = RGBColor;

pub(crate) const INK: Colour = RGBColor(25, 25, 25);
pub(crate) const PALE_INK: Colour = RGBColor(95, 95, 95);
pub(crate) const WHITE: Colour = RGBColor(255, 255, 255);

/// An upright rectangle in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Rectangle {
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn corners(&self) -> [Point; 4] {
        let Self { left, top, right, bottom } = *self;
        [[left, top], [right, top], [right, bottom], [left, bottom]]
    }
}

/// Which part of a text lies at its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    /// A point on the baseline.
    pub at: Point,
    pub content: String,
    /// Size of the font's em square in pixels.
    pub size: f64,
    pub bold: bool,
    pub colour: Colour,
    pub anchor: Anchor,
    /// Whether the text runs upwards instead of to the right.
    pub upwards: bool,
}

impl Text {
    pub fn new(at: Point, anchor: Anchor, size: f64, content: impl Into<String>) -> Self {
        let content = content.into();
        Self { at, content, size, bold: false, colour: INK, anchor, upwards: false }
    }

    /// The room taken by capitals, ascenders and descenders.
    pub fn bounds(&self) -> Rectangle {
        let width = text_width(&self.content, self.size, self.bold);
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let [x, y] = self.at;
        let (above, below) = (0.76 * self.size, 0.24 * self.size);
        if self.upwards {
            let bottom = y + before;
            Rectangle { left: x - above, right: x + below, top: bottom - width, bottom }
        } else {
            let left = x - before;
            Rectangle { left, right: left + width, top: y - above, bottom: y + below }
        }
    }
}

enum Shape {
    Rectangle(Rectangle, Colour),
    Patches(Vec<Rectangle>, Colour),
    Polygon(Vec<Point>, Colour),
    Line { points: Vec<Point>, width: f64, colour: Colour },
    Text(Text),
}

/// A white sheet with shapes on it, later ones above earlier ones.
pub(crate) struct Picture {
    pub width: u32,
    pub height: u32,
    shapes: Vec<Shape>,
}

impl Picture {
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, shapes: Vec::new() }
    }

    pub fn fill(&mut self, area: Rectangle, colour: Colour) {
        self.shapes.push(Shape::Rectangle(area, colour));
    }

    /// Fills many areas at once, with edges on whole fine pixels and none shared: a fifth of the
    /// bytes of single areas in an SVG, and no hairlines between neighbours.
    pub fn patches(&mut self, areas: Vec<Rectangle>, colour: Colour) {
        self.shapes.push(Shape::Patches(areas, colour));
    }

    pub fn polygon(&mut self, points: Vec<Point>, colour: Colour) {
        self.shapes.push(Shape::Polygon(points, colour));
    }

    pub fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.polygon(circle(centre, radius, 24), colour);
    }

    pub fn line(&mut self, points: impl Into<Vec<Point>>, width: f64, colour: Colour) {
        self.shapes.push(Shape::Line { points: points.into(), width, colour });
    }

    pub fn frame(&mut self, area: Rectangle, width: f64, colour: Colour) {
        let corners = area.corners();
        // The first edge is drawn twice so that all four corners are mitred.
        self.line([&corners[..], &corners[..2]].concat(), width, colour);
    }

    /// A line interrupted by gaps: `pattern` holds the lengths of dashes and gaps in turn, in
    /// pixels; without a pattern the line is solid.
    pub fn dashed(&mut self, points: &[Point], pattern: &[f64], width: f64, colour: Colour) {
        if pattern.is_empty() {
            return self.line(points, width, colour);
        }
        for dash in dashes(points, pattern) {
            self.line(dash, width, colour);
        }
    }

    pub fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// The picture as the bytes of a file.
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

    /// The pixels of the picture row by row, three bytes each.
    pub fn pixels(&self) -> Result<Vec<u8>, FigureError> {
        register_fonts();
        let (width, height) = (self.width * FINENESS, self.height * FINENESS);
        let mut fine = vec![255; 3 * width as usize * height as usize];
        self.paint(BitMapBackend::with_buffer(&mut fine, (width, height)), &BITMAP)?;
        Ok(self.averaged(&fine))
    }

    /// The SVG with the paths of the patches in place of the polygons that stand for them.
    fn with_patches(&self, text: &str) -> String {
        let mut whole = String::with_capacity(text.len());
        let mut rest = text;
        for (index, shape) in self.shapes.iter().enumerate() {
            let Shape::Patches(areas, RGBColor(red, green, blue)) = shape else { continue };
            // Quotes within texts are escaped, so that no text holds the words looked for.
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

    /// Averages the fine pixels.
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

    /// The texts of the picture.
    #[cfg(test)]
    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        self.shapes.iter().filter_map(|shape| match shape {
            Shape::Text(text) => Some(text),
            _ => None,
        })
    }

    /// Fails when a text leaves the sheet or lies on another text.
    #[cfg(test)]
    pub fn assert_texts_are_apart(&self) {
        let texts: Vec<&Text> = self.texts().collect();
        for (index, text) in texts.iter().enumerate() {
            let bounds = text.bounds();
            assert!(bounds.left >= 0.0 && bounds.right <= f64::from(self.width), "{text:?}");
            assert!(bounds.top >= 0.0 && bounds.bottom <= f64::from(self.height), "{text:?}");
            for other in &texts[..index] {
                assert!(!bounds.overlaps(&other.bounds()), "{text:?} on {other:?}");
            }
        }
    }
}

/// How a kind of output places text and strokes lines. The two libraries below plotters read the
/// same size and place differently; without the correction the two formats would not agree.
struct Dialect {
    /// The library's font size for an em square of one pixel.
    size_per_em: f64,
    /// Distance from the place handed over to the baseline, in em.
    baseline: f64,
    /// Whether the output is text: a line is given to the library whole, patches become paths.
    is_text: bool,
}

/// The library's size is the height from ascender to descender, 1.164 em in DejaVu Sans.
/// Its polygon of a thick line has holes where a line turns back on itself, so lines are drawn
/// piece by piece.
const BITMAP: Dialect = Dialect { size_per_em: 1.164, baseline: 0.582, is_text: false };
const SVG: Dialect = Dialect { size_per_em: 1.24, baseline: 0.76, is_text: true };

fn refused(error: impl std::fmt::Display) -> FigureError {
    FigureError::Drawing(error.to_string())
}

impl Dialect {
    fn write<B: DrawingBackend>(&self, on: &mut B, text: &Text) -> Result<(), FigureError> {
        let drop = self.baseline * text.size;
        let [x, y] = text.at;
        let (at, turn) = if text.upwards {
            ([x - drop, y], FontTransform::Rotate270)
        } else {
            ([x, y - drop], FontTransform::None)
        };
        let across = match text.anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let size = text.size * self.size_per_em * f64::from(FINENESS);
        let font = font(size, text.bold).transform(turn);
        let style = TextStyle::from(font).color(&text.colour).pos(Pos::new(across, VPos::Top));
        on.draw_text(&text.content, &style, fine(at)).map_err(refused)
    }

    fn stroke<B: DrawingBackend>(
        &self,
        on: &mut B,
        points: &[Point],
        width: f64,
        colour: Colour,
    ) -> Result<(), FigureError> {
        let fine_width = width * f64::from(FINENESS);
        if self.is_text {
            use plotters::style::Color;
            let style = colour.stroke_width(fine_width.round().max(1.0) as u32);
            let points = points.iter().map(|&point| fine(point));
            return on.draw_path(points, &style).map_err(refused);
        }
        for (index, piece) in points.windows(2).enumerate() {
            let ([x0, y0], [x1, y1]) = (piece[0], piece[1]);
            let length = (x1 - x0).hypot(y1 - y0);
            if length > 0.0 {
                let half = 0.5 * width / length;
                let (dx, dy) = (half * (y1 - y0), half * (x0 - x1));
                let corners = [
                    [x0 + dx, y0 + dy],
                    [x1 + dx, y1 + dy],
                    [x1 - dx, y1 - dy],
                    [x0 - dx, y0 - dy],
                ];
                on.fill_polygon(corners.map(fine), &colour).map_err(refused)?;
            }
            // A disc closes the notch between two pieces.
            if index > 0 && width > 1.0 {
                let joint = circle(piece[0], 0.5 * width, 12).into_iter().map(fine);
                on.fill_polygon(joint, &colour).map_err(refused)?;
            }
        }
        Ok(())
    }
}

fn fine([x, y]: Point) -> (i32, i32) {
    let scale = f64::from(FINENESS);
    ((scale * x).round() as i32, (scale * y).round() as i32)
}

/// First coordinate of the polygons that stand for patches in an SVG; far from the sheet.
const PATCHES: i32 = -1_000_000;

/// The corners of a patch in fine pixels; none where it is smaller than one of these.
fn fine_patch(area: &Rectangle) -> Option<([i32; 2], [i32; 2])> {
    let (from, to) = (fine([area.left, area.top]), fine([area.right, area.bottom]));
    (from.0 < to.0 && from.1 < to.1).then_some(([from.0, from.1], [to.0, to.1]))
}

pub(crate) fn circle([x, y]: Point, radius: f64, corners: usize) -> Vec<Point> {
    let turn = std::f64::consts::TAU / corners as f64;
    (0..corners)
        .map(|corner| {
            let (sin, cos) = (corner as f64 * turn).sin_cos();
            [x + radius * cos, y + radius * sin]
        })
        .collect()
}

fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let fonts =
            [(FontStyle::Normal, dejavu::sans::regular()), (FontStyle::Bold, dejavu::sans::bold())];
        for (style, bytes) in fonts {
            // Part of the program, so that a failure is one of the build; text would be refused
            // with a typed error at its first use.
            let _ = register_font(FAMILY, style, bytes);
        }
    });
}

fn font(size: f64, bold: bool) -> FontDesc<'static> {
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    (FontFamily::Name(FAMILY), size, style).into_font()
}

/// Width of a line of text in pixels, `size` being that of the em square.
pub(crate) fn text_width(content: &str, size: f64, bold: bool) -> f64 {
    // Measured large: the library rounds to whole pixels.
    const LARGE: f64 = 200.0;
    register_fonts();
    let layout = font(LARGE * BITMAP.size_per_em, bold).layout_box(content);
    layout.map_or(0.0, |((left, _), (right, _))| f64::from(right - left) * size / LARGE)
}

/// The dashes of a line; `pattern` holds their lengths and those of the gaps in turn.
pub(crate) fn dashes(points: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    let mut dashes = Vec::new();
    let (mut turn, mut left) = (0, pattern[0]);
    let mut dash: Vec<Point> = points.first().copied().into_iter().collect();
    for piece in points.windows(2) {
        let (from, to) = (piece[0], piece[1]);
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let share = done / length;
            let at = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            if turn % 2 == 0 {
                dash.push(at);
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at];
            }
            turn += 1;
            left = pattern[turn % pattern.len()];
        }
        left -= length - done;
        if turn % 2 == 0 {
            dash.push(to);
        }
    }
    if dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

/// The parts of a line inside an area, the line being interrupted where a coordinate is not
/// finite.
pub(crate) fn clip(points: &[Point], area: Rectangle) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for piece in points.windows(2) {
        let Some((from, to)) = clip_piece(piece[0], piece[1], area) else {
            open = false;
            continue;
        };
        match parts.last_mut() {
            Some(part) if open && from == piece[0] => part.push(to),
            _ => parts.push(vec![from, to]),
        }
        open = to == piece[1];
    }
    parts
}

/// The part of a straight piece inside an area (Liang and Barsky 1984).
fn clip_piece(from: Point, to: Point, area: Rectangle) -> Option<(Point, Point)> {
    if !from.iter().chain(&to).all(|coordinate| coordinate.is_finite()) {
        return None;
    }
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (speed, room) in [
        (-dx, from[0] - area.left),
        (dx, area.right - from[0]),
        (-dy, from[1] - area.top),
        (dy, area.bottom - from[1]),
    ] {
        if speed == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            enter = enter.max(room / speed);
        } else {
            leave = leave.min(room / speed);
        }
    }
    let at = |share: f64| [from[0] + share * dx, from[1] + share * dy];
    let start = if enter > 0.0 { at(enter) } else { from };
    let end = if leave < 1.0 { at(leave) } else { to };
    (enter <= leave).then_some((start, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rectangle = Rectangle { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };

    #[test]
    fn lines_are_cut_at_the_edges_and_at_gaps() {
        let through = clip(&[[-5.0, 5.0], [15.0, 5.0]], AREA);
        assert_eq!(through, [[[0.0, 5.0], [10.0, 5.0]]]);
        let inside = [[1.0, 1.0], [2.0, 2.0], [3.0, 1.0]];
        assert_eq!(clip(&inside, AREA), [inside]);
        let gap = [[1.0, 1.0], [2.0, 2.0], [f64::NAN, 3.0], [4.0, 4.0], [5.0, 4.0]];
        assert_eq!(clip(&gap, AREA), [[[1.0, 1.0], [2.0, 2.0]], [[4.0, 4.0], [5.0, 4.0]]]);
        let out_and_in = [[5.0, 5.0], [15.0, 5.0], [5.0, 6.0]];
        assert_eq!(clip(&out_and_in, AREA).len(), 2);
        assert!(clip(&[[-1.0, -1.0], [-2.0, 20.0]], AREA).is_empty());
    }

    #[test]
    fn dashes_have_their_lengths_also_around_corners() {
        let dashes = dashes(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], &[4.0, 0.5]);
        let expected: [&[Point]; 3] = [
            &[[0.0, 0.0], [4.0, 0.0]],
            &[[4.5, 0.0], [5.0, 0.0], [5.0, 3.5]],
            &[[5.0, 4.0], [5.0, 5.0]],
        ];
        assert_eq!(dashes, expected);
    }

    #[test]
    fn every_symbol_of_the_field_is_in_the_fonts() {
        // A missing symbol is drawn as an empty box, which has the width of no other symbol that
        // stands next to it here: compare pictures of single symbols instead of widths.
        let drawn = |symbol: char| {
            let mut picture = Picture::new(40, 40);
            picture.text(Text::new([5.0, 30.0], Anchor::Start, 28.0, symbol));
            picture.render(Format::Png).unwrap()
        };
        let missing = drawn('\u{10fffd}');
        for symbol in "ΔφνςθκψσρλμαβγηΨΣΩω°²³⁻¹⁰⁴⁵⁶⁷⁸⁹₁₂₃−–×¼½⅓∞√∂≤≥|é".chars()
        {
            assert_ne!(drawn(symbol), missing, "{symbol}");
        }
    }

    #[test]
    fn patches_are_drawn_alike_in_both_formats() {
        let mut picture = Picture::new(30, 20);
        let at = |left: f64| Rectangle { left, top: 5.0, right: left + 4.0, bottom: 9.0 };
        picture.text(Text::new([2.0, 18.0], Anchor::Start, 5.0, "points=\"-1000000,1 \"/>"));
        picture.patches(vec![at(3.0), at(7.0), Rectangle { right: 20.0, ..at(20.0) }], INK);
        picture.patches(vec![at(15.0)], WHITE);
        let svg = String::from_utf8(picture.render(Format::Svg).unwrap()).unwrap();
        assert!(
            svg.contains("fill=\"#191919\" d=\"M9 15h12v12h-12zM21 15h12v12h-12z\"/>"),
            "{svg}"
        );
        assert!(svg.contains("fill=\"#FFFFFF\" d=\"M45 15h12v12h-12z\"/>"), "{svg}");
        assert!(!svg.contains("<polygon"));
        let (width, pixels) = crate::tests::pixels(&picture.render(Format::Png).unwrap());
        let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] == 25;
        for (x, y) in (0..30).flat_map(|x| (0..12).map(move |y| (x, y))) {
            assert_eq!(dark(x, y), (3..11).contains(&x) && (5..9).contains(&y), "{x} {y}");
        }
    }

    #[test]
    fn text_lies_within_its_bounds() {
        for upwards in [false, true] {
            let mut picture = Picture::new(300, 300);
            let mut text = Text::new([150.0, 150.0], Anchor::Middle, 30.0, "Hxgpd|10⁴");
            text.upwards = upwards;
            let bounds = text.bounds();
            picture.text(text);
            let bytes = picture.render(Format::Png).unwrap();
            let (_, pixels) = crate::tests::pixels(&bytes);
            let dark = |index: &usize| pixels[3 * index] < 128;
            let (mut ink, mut inside) = (0, 0);
            for index in (0..300 * 300).filter(dark) {
                let (x, y) = ((index % 300) as f64, (index / 300) as f64);
                ink += 1;
                let slack = 2.0;
                inside += usize::from(
                    x > bounds.left - slack
                        && x < bounds.right + slack
                        && y > bounds.top - slack
                        && y < bounds.bottom + slack,
                );
            }
            assert!(ink > 300, "{ink} dark pixels");
            assert_eq!(ink, inside, "upwards: {upwards}");
        }
    }
}
