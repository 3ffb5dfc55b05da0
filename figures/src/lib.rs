//! Figures of verdicts, growth rates, directions and simulations, for publication.
//!
//! Input are plain structs, output the bytes of a PNG, SVG, PDF, GIF or APNG file. The crate depends on no solver and no physics:
//! names, units and symbols are passed as labels. Equal structs give equal bytes. Figures are legible in greyscale:
//! information given by colour is also given by lightness, hatching, dash patterns or markers. Fonts are embedded; no
//! system fonts are used.
//!
//! To add a figure, write a file here with a struct and its `draw`, and a line in `examples/gallery`. `picture` is the
//! canvas, `page` has the page elements (heading, axes, legend), `scale` the axis scales.

#![deny(missing_docs)]

mod animation;
mod bands;
mod colour;
mod contour;
mod diagram;
mod directions;
mod dispersion;
mod error;
mod field;
mod format;
mod growth;
mod hemisphere;
mod ledger;
mod note;
mod page;
mod panels;
mod picture;
mod polar;
mod record;
mod scale;
mod seismogram;
mod spectrum;
mod speeds;
mod sphere;
mod verdict_map;

pub use animation::{Animation, AnimationFormat, AnimationOptions, FrameFigure, animate};
pub use bands::{BandFamily, BandFigure, BandStyle};
pub use diagram::{DiagramCurve, DiagramFigure};
pub use directions::{Direction, DirectionKind, DirectionsFigure};
pub use dispersion::{DispersionBranch, DispersionFigure, FrequencyBand, ReferenceLevel};
pub use error::FigureError;
pub use field::{
    FieldArrow, FieldArrows, FieldAxis, FieldBody, FieldFigure, FieldLine, FieldLineSet,
    FieldLineStyle, FieldMark, FieldMarkKind, FieldOutline, FieldPairFigure,
};
pub use format::{FigureFormat, FigureOptions, FigureOutput, FigureSize};
pub use growth::{AxisMark, GrowthFigure, GrowthPanel, LabelledCurve};
pub use ledger::{LedgerFigure, LedgerTerm};
pub use note::NoteFigure;
pub use panels::{CurveMark, CurvePanel, PanelsFigure};
pub use polar::{PolarFigure, Spoke, SpokeStyle};
pub use seismogram::{SeismogramFigure, SeismogramPanel, Trace};
pub use spectrum::SpectrumFigure;
pub use speeds::{SolidResponse, SpeedCurve, SpeedsFigure, ZeroSpeedNormal};
pub use sphere::{SphereFigure, SphereMark};
pub use verdict_map::{
    FillStyle, Hatching, MapCurve, STEP_PARTS, VerdictCategory, VerdictMap, VerdictMapAxis,
};

#[cfg(test)]
mod tests {
    /// Returns width and height from the header of a PNG file.
    pub(crate) fn png_size(bytes: &[u8]) -> [u32; 2] {
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        [reader.info().width, reader.info().height]
    }

    /// Asserts that no texts of a picture overlap, and that its files are valid and reproducible.
    pub(crate) fn check_drawing(
        picture: &crate::picture::Picture,
        draw: impl Fn(crate::FigureFormat) -> Result<Vec<u8>, crate::FigureError>,
    ) {
        use crate::FigureFormat::{Png, Svg};
        picture.assert_texts_do_not_overlap();
        assert_eq!(png_size(&draw(Png).unwrap())[0], 1600);
        // Both formats have one layout; drawing an SVG once more takes less time than a PNG.
        let svg = draw(Svg).unwrap();
        assert_eq!(svg, draw(Svg).unwrap());
        let svg = String::from_utf8(svg).unwrap();
        assert!(svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
    }

    /// Returns curves that every figure must be able to draw: empty, single points, constants, non-finite values, and
    /// values at the limits of the range of doubles.
    pub(crate) fn edge_case_curves() -> Vec<Vec<[f64; 2]>> {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        vec![
            vec![],
            vec![[1.0, 1.0]],
            vec![[0.0, 0.0], [1.0, 0.0]],
            vec![[0.0, 7.0], [90.0, 7.0], [180.0, 7.0]],
            vec![[nan, nan], [1.0, nan]],
            vec![[1.0, inf], [2.0, -inf], [inf, 1.0]],
            vec![[1.0, -1e6], [10.0, 1e4], [100.0, 3e-7]],
            vec![[1e-300, 1e-300], [1e300, 1e300], [f64::MAX, f64::MAX], [1.0, f64::MIN]],
            vec![[0.0, f64::MAX], [90.0, f64::MIN], [180.0, 1e299]],
            vec![[1.0, 5e-324], [5e-324, 1.0], [2.0, 5e-324]],
            vec![[1000.0, 1.0], [1000.0000000001, 2.0]],
        ]
    }

    /// Returns the width and the pixels, three bytes each, of a PNG file.
    pub(crate) fn decode_png(bytes: &[u8]) -> (usize, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (reader.info().width as usize, pixels)
    }
}
