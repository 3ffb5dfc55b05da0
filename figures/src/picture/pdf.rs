//! Rendering of pictures to PDF: one page, vector shapes, and text in embedded subsets of the fonts.

use super::fonts::split_into_runs;
use super::scaling::Placement;
use super::shapes::{Picture, PictureShape};
use super::text::{Anchor, Colour, Text};
use crate::error::FigureError;
use crate::format::{FigureOptions, MILLIMETRES_PER_INCH};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{
    CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo, UnicodeCmap,
};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use std::collections::BTreeMap;
use std::io::Write as _;
use subsetter::GlyphRemapper;
use ttf_parser::{Face, GlyphId};

/// PDF units per inch.
const UNITS_PER_INCH: f64 = 72.0;
/// Margin by which adjacent patches overlap, pixels; viewers show a white hairline between patches that only touch.
const PATCH_OVERLAP: f64 = 0.3;
const SYSTEM_INFO: SystemInfo =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// Font with the glyphs that the texts of a picture need.
struct EmbeddedFont {
    bytes: &'static [u8],
    face: Face<'static>,
    resource_name: &'static [u8],
    /// Name in the PDF; six letters mark a subset (ISO 32000-1, 9.6.4).
    base_name: &'static [u8],
    glyphs: GlyphRemapper,
    /// Characters of the glyphs of the subset.
    characters: BTreeMap<u16, char>,
}

impl EmbeddedFont {
    fn new(
        bytes: &'static [u8],
        resource_name: &'static [u8],
        base_name: &'static [u8],
    ) -> Result<Self, FigureError> {
        let face = Face::parse(bytes, 0).map_err(to_drawing_error)?;
        let (glyphs, characters) = (GlyphRemapper::new(), BTreeMap::new());
        Ok(Self { bytes, face, resource_name, base_name, glyphs, characters })
    }

    /// Returns the glyph of a character in the font; glyph 0 if it has none.
    fn glyph(&self, character: char) -> GlyphId {
        self.face.glyph_index(character).unwrap_or(GlyphId(0))
    }

    /// Returns the advance of a glyph, em.
    fn advance(&self, glyph: GlyphId) -> f64 {
        let units = self.face.glyph_hor_advance(glyph).unwrap_or(0);
        f64::from(units) / f64::from(self.face.units_per_em())
    }

    /// Computes the width of a text, em.
    fn width(&self, text: &str) -> f64 {
        text.chars().map(|character| self.advance(self.glyph(character))).sum()
    }

    /// Adds the glyphs of a text to the subset, and returns their numbers in it, two bytes each.
    fn encode(&mut self, text: &str) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(2 * text.len());
        for character in text.chars() {
            let number = self.glyphs.remap(self.glyph(character).0);
            self.characters.insert(number, character);
            bytes.extend(number.to_be_bytes());
        }
        bytes
    }

    /// Writes the font with its metrics, its characters and its subset.
    fn write(&self, pdf: &mut Pdf, own: Ref, next: &mut Ref) -> Result<(), FigureError> {
        let [cid_font, descriptor, characters, file] = std::array::from_fn(|_| next.bump());
        let base = Name(self.base_name);
        pdf.type0_font(own)
            .base_font(base)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid_font)
            .to_unicode(characters);
        let mut font = pdf.cid_font(cid_font);
        font.subtype(CidFontType::Type2).base_font(base).system_info(SYSTEM_INFO);
        font.font_descriptor(descriptor).default_width(0.0);
        font.cid_to_gid_map_predefined(Name(b"Identity"));
        let advances = self.glyphs.remapped_gids().map(|glyph| self.advance(GlyphId(glyph)));
        font.widths().consecutive(0, advances.map(|advance| (1000.0 * advance) as f32));
        font.finish();
        let per_mille = 1000.0 / f32::from(self.face.units_per_em());
        let convert = |units: i16| f32::from(units) * per_mille;
        let bounds = self.face.global_bounding_box();
        pdf.font_descriptor(descriptor)
            .name(base)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(
                convert(bounds.x_min),
                convert(bounds.y_min),
                convert(bounds.x_max),
                convert(bounds.y_max),
            ))
            .italic_angle(0.0)
            .ascent(convert(self.face.ascender()))
            .descent(convert(self.face.descender()))
            .cap_height(convert(self.face.capital_height().unwrap_or(self.face.ascender())))
            // Not in the font; viewers use it only if they replace the font.
            .stem_v(80.0)
            .font_file2(file);
        let mut map = UnicodeCmap::new(Name(b"Custom"), SYSTEM_INFO);
        self.characters.iter().for_each(|(number, character)| map.pair(*number, *character));
        pdf.cmap(characters, &map.finish());
        let subset = subsetter::subset(self.bytes, 0, &self.glyphs).map_err(to_drawing_error)?;
        write_compressed(pdf, file, &subset)
    }
}

fn to_drawing_error(error: impl std::fmt::Display) -> FigureError {
    FigureError::Drawing(error.to_string())
}

fn write_compressed(pdf: &mut Pdf, own: Ref, bytes: &[u8]) -> Result<(), FigureError> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).map_err(to_drawing_error)?;
    let compressed = encoder.finish().map_err(to_drawing_error)?;
    pdf.stream(own, &compressed).filter(Filter::FlateDecode);
    Ok(())
}

/// Rounds a coordinate to thousandths of a pixel, which shortens the file.
fn round(value: f64) -> f32 {
    ((1000.0 * value).round() / 1000.0) as f32
}

impl Picture {
    /// Renders the picture as a PDF with one page.
    pub(super) fn render_pdf(&self, options: &FigureOptions) -> Result<Vec<u8>, FigureError> {
        let page_size = options
            .printed_size(self.size())
            .map(|length| length / MILLIMETRES_PER_INCH * UNITS_PER_INCH);
        let Placement { scale, offset } = Placement::fit(self.size(), page_size);
        let mut fonts = [
            EmbeddedFont::new(dejavu::sans::regular(), b"R", b"WPFIGA+DejaVuSans")?,
            EmbeddedFont::new(dejavu::sans::bold(), b"B", b"WPFIGB+DejaVuSans-Bold")?,
        ];
        let mut content = Content::new();
        // Coordinates of pictures increase downwards.
        content.transform(
            [scale, 0.0, 0.0, -scale, offset[0], page_size[1] - offset[1]]
                .map(|value| value as f32),
        );
        content.set_line_join(LineJoinStyle::RoundJoin).set_line_cap(LineCapStyle::ButtCap);
        for shape in &self.shapes {
            draw_shape(&mut content, shape, &mut fonts);
        }
        let mut next = Ref::new(1);
        let [catalogue, tree, page, stream, regular, bold] = std::array::from_fn(|_| next.bump());
        let mut pdf = Pdf::new();
        pdf.catalog(catalogue).pages(tree);
        pdf.pages(tree).kids([page]).count(1);
        let mut own = pdf.page(page);
        own.media_box(Rect::new(0.0, 0.0, page_size[0] as f32, page_size[1] as f32));
        own.parent(tree).contents(stream);
        let references = [regular, bold];
        {
            let mut resources = own.resources();
            let mut list = resources.fonts();
            for (font, reference) in fonts.iter().zip(references) {
                list.pair(Name(font.resource_name), reference);
            }
        }
        own.finish();
        write_compressed(&mut pdf, stream, &content.finish())?;
        for (font, reference) in fonts.iter().zip(references) {
            font.write(&mut pdf, reference, &mut next)?;
        }
        Ok(pdf.finish())
    }
}

fn set_fill(content: &mut Content, colour: Colour) {
    let [red, green, blue] = components(colour);
    content.set_fill_rgb(red, green, blue);
}

/// Returns red, green and blue from 0 to 1.
fn components(colour: Colour) -> [f32; 3] {
    [colour.0, colour.1, colour.2].map(|value| round(f64::from(value) / 255.0))
}

fn draw_shape(content: &mut Content, shape: &PictureShape, fonts: &mut [EmbeddedFont; 2]) {
    match shape {
        PictureShape::Rectangle(area, colour) => {
            set_fill(content, *colour);
            content.rect(
                round(area.left),
                round(area.top),
                round(area.width()),
                round(area.height()),
            );
            content.fill_nonzero();
        }
        PictureShape::Patches(areas, colour) => {
            set_fill(content, *colour);
            for area in areas {
                content.rect(
                    round(area.left),
                    round(area.top),
                    round(area.width() + PATCH_OVERLAP),
                    round(area.height() + PATCH_OVERLAP),
                );
            }
            content.fill_nonzero();
        }
        PictureShape::Polygon(points, colour) if !points.is_empty() => {
            set_fill(content, *colour);
            draw_path(content, points);
            content.close_path().fill_nonzero();
        }
        PictureShape::Line { points, width, colour, .. } if points.len() > 1 => {
            let [red, green, blue] = components(*colour);
            content.set_stroke_rgb(red, green, blue).set_line_width(round(*width));
            draw_path(content, points);
            content.stroke();
        }
        PictureShape::Polygon(..) | PictureShape::Line { .. } => {}
        PictureShape::Text(text) => draw_text(content, text, fonts),
    }
}

fn draw_path(content: &mut Content, points: &[[f64; 2]]) {
    for (index, [x, y]) in points.iter().enumerate() {
        match index {
            0 => content.move_to(round(*x), round(*y)),
            _ => content.line_to(round(*x), round(*y)),
        };
    }
}

fn draw_text(content: &mut Content, text: &Text, fonts: &mut [EmbeddedFont; 2]) {
    let font = &mut fonts[usize::from(text.is_bold)];
    let runs = split_into_runs(&text.content);
    let width: f64 =
        runs.iter().map(|run| run.scale * text.font_size * font.width(&run.content)).sum();
    let mut along = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -0.5 * width,
        Anchor::End => -width,
    };
    set_fill(content, text.colour);
    content.begin_text();
    let [x, y] = text.anchor_point;
    for run in runs {
        let size = run.scale * text.font_size;
        let above = run.rise * text.font_size;
        // The second row points from the baseline to the top of the letters.
        let matrix = match text.is_vertical {
            false => [1.0, 0.0, 0.0, -1.0, x + along, y - above],
            true => [0.0, -1.0, -1.0, 0.0, x - above, y - along],
        };
        content.set_font(Name(font.resource_name), round(size));
        content.set_text_matrix(matrix.map(round));
        content.show(Str(&font.encode(&run.content)));
        along += size * font.width(&run.content);
    }
    content.end_text();
}
