//! File formats of figures, and options of their size and heading.

use crate::page;

/// File format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureFormat {
    /// PNG, by default 1600 pixels wide and usually 1100 pixels high; higher for a large legend or many panels, lower
    /// for a wide field.
    Png,
    /// SVG of the same size in pixels.
    Svg,
    /// PDF with one page of the size of the figure; fonts are embedded.
    Pdf,
}

impl FigureFormat {
    /// Returns the file name extension of the format, without a dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
            Self::Pdf => "pdf",
        }
    }
}

/// Size of a figure. The figure is scaled as a whole, texts included, to fit in the size, and centred in it. Figures less
/// than 154 mm wide are laid out anew, so that the smallest text has 6 points if the height suffices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FigureSize {
    /// Width and height, pixels.
    Pixels([u32; 2]),
    /// Width and height, mm.
    Millimetres([f64; 2]),
    /// Width, mm, with the height that the figure needs.
    MillimetresWide(f64),
}

/// Options of all figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureOptions {
    /// Size; `None` for the natural size of the figure, 1600 pixels wide.
    pub size: Option<FigureSize>,
    /// Resolution of a PNG, dots per inch. Without a size, it determines the number of pixels: figures are 203.2 mm
    /// wide. `None` for [`DEFAULT_DPI`](Self::DEFAULT_DPI), and for [`PRINT_DPI`](Self::PRINT_DPI) with a size in mm.
    pub dpi: Option<f64>,
    /// Whether title and subtitle are drawn. A figure without them is lower.
    pub has_heading: bool,
    /// Whether the file, in any format, is replaced by a list of the texts that cover another text, a curve or a marked
    /// point, one a line; empty if there are none. For tests.
    pub lists_covering_texts: bool,
}

impl Default for FigureOptions {
    fn default() -> Self {
        Self { size: None, dpi: None, has_heading: true, lists_covering_texts: false }
    }
}

impl FigureOptions {
    /// Resolution by default, dots per inch; 1600 pixels are 203.2 mm.
    pub const DEFAULT_DPI: f64 = 200.0;
    /// Resolution by default of a PNG with a size in mm, dots per inch.
    pub const PRINT_DPI: f64 = 300.0;
    /// Largest number of pixels of a PNG.
    pub const MAX_PIXELS: f64 = 1e8;

    /// Returns width and usual height of the page on which figures are laid out, pixels: smaller for figures less than
    /// 154 mm wide, so that the smallest text has 6 points in print.
    pub(crate) fn page_size(&self) -> [f64; 2] {
        /// Resolution at which the smallest text has 6 points, pixels per mm.
        const PIXELS_PER_MILLIMETRE: f64 = page::MIN_TEXT_SIZE / 6.0 * 72.0 / MILLIMETRES_PER_INCH;
        const MIN_SIZE: [f64; 2] = [700.0, 420.0];
        /// Usual height of a figure whose height is not given, in widths.
        const USUAL_HEIGHT: f64 = 0.75;
        let [width, height] = match self.size {
            Some(FigureSize::Millimetres(size)) => size,
            Some(FigureSize::MillimetresWide(width)) => [width, USUAL_HEIGHT * width],
            Some(FigureSize::Pixels(_)) | None => return [page::WIDTH, page::HEIGHT],
        };
        if width * PIXELS_PER_MILLIMETRE >= page::WIDTH {
            return [page::WIDTH, page::HEIGHT];
        }
        let pixels = (width * PIXELS_PER_MILLIMETRE).max(MIN_SIZE[0]);
        [pixels.floor(), (pixels * height / width).clamp(MIN_SIZE[1], page::HEIGHT).floor()]
    }

    /// Computes width and height of a PNG, pixels, from the natural size of the figure, pixels.
    pub(crate) fn pixel_size(&self, natural: [f64; 2]) -> [f64; 2] {
        match self.size {
            Some(FigureSize::Pixels(size)) => size.map(f64::from),
            _ => self
                .printed_size(natural)
                .map(|length| length / MILLIMETRES_PER_INCH * self.resolution()),
        }
        .map(|length| length.round().max(1.0))
    }

    /// Computes width and height of a printed figure, mm, from its natural size, pixels.
    pub(crate) fn printed_size(&self, natural: [f64; 2]) -> [f64; 2] {
        match self.size {
            None => natural.map(|length| length * MILLIMETRES_PER_INCH / Self::DEFAULT_DPI),
            Some(FigureSize::Pixels(size)) => {
                size.map(|length| f64::from(length) * MILLIMETRES_PER_INCH / self.resolution())
            }
            Some(FigureSize::Millimetres(size)) => size,
            Some(FigureSize::MillimetresWide(width)) => [width, width * natural[1] / natural[0]],
        }
    }

    /// Returns the resolution of a PNG, dots per inch.
    pub(crate) fn resolution(&self) -> f64 {
        self.dpi.unwrap_or(match self.size {
            Some(FigureSize::Millimetres(_) | FigureSize::MillimetresWide(_)) => Self::PRINT_DPI,
            Some(FigureSize::Pixels(_)) | None => Self::DEFAULT_DPI,
        })
    }
}

/// Length of an inch, mm.
pub(crate) const MILLIMETRES_PER_INCH: f64 = 25.4;

/// File format and options of a figure to be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureOutput {
    /// File format.
    pub format: FigureFormat,
    /// Size and heading.
    pub options: FigureOptions,
}

impl FigureOutput {
    /// Lays out a picture on a page of the size of the options.
    pub(crate) fn lay_out<T>(&self, lay_out: impl FnOnce() -> T) -> T {
        page::lay_out_on_page(self.options.page_size(), lay_out)
    }
}

impl From<FigureFormat> for FigureOutput {
    fn from(format: FigureFormat) -> Self {
        Self { format, options: FigureOptions::default() }
    }
}
