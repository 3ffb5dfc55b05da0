//! Two fields of one quantity with a common colour scale.

use super::colour_map::ColourScale;
use super::figure::FieldFigure;
use crate::error::FigureError;
use crate::format::{FigureFormat, FigureOutput};
use crate::picture::Picture;
use crate::scale::FINITE_LIMIT;

/// Two fields of one quantity, one above the other, with one colour scale: its limit is the largest magnitude of both. The
/// scale is signed if either field is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldPairFigure {
    /// Upper field; its limits of the colour scale have no effect.
    pub upper: FieldFigure,
    /// Lower field; its limits of the colour scale have no effect.
    pub lower: FieldFigure,
}

impl FieldPairFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// A field is refused by [`FieldFigure::draw`], or rendering or encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        let output = output.into();
        self.to_picture(output.format)?.render(output)
    }

    fn to_picture(&self, format: FigureFormat) -> Result<Picture, FigureError> {
        let values = self.upper.values.iter().chain(&self.lower.values);
        let finite = values.map(|value| value.abs()).filter(|value| *value < FINITE_LIMIT);
        let limit = Some(finite.fold(0.0, f64::max)).filter(|limit| *limit > 0.0);
        let is_signed = self.upper.is_signed || self.lower.is_signed;
        let draw = |figure: &FieldFigure| {
            let figure =
                FieldFigure { limit: None, fixed_limit: limit, is_signed, ..figure.clone() };
            figure.validate()?;
            let scale = ColourScale::from_figure(&figure).without_values_beyond();
            Ok::<_, FigureError>(figure.draw_with_scale(&scale, format))
        };
        let mut picture = draw(&self.upper)?;
        picture.append_below(draw(&self.lower)?);
        Ok(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::FieldAxis;
    use super::*;
    use crate::tests::check_drawing;

    fn sample_field(title: &str, amplitude: f64) -> FieldFigure {
        let axis = |label: &str, end: f64| FieldAxis { label: label.to_owned(), start: 0.0, end };
        FieldFigure {
            title: title.to_owned(),
            x: axis("x, m", 2.0),
            y: axis("y, m", 1.0),
            columns: 20,
            rows: 10,
            values: (0..200).map(|cell| amplitude * (0.1 * f64::from(cell)).sin()).collect(),
            label: "stress, Pa".to_owned(),
            is_signed: true,
            ..FieldFigure::default()
        }
    }

    #[test]
    fn both_fields_have_the_scale_of_the_larger_one() {
        let pair = FieldPairFigure { upper: sample_field("A", 1.0), lower: sample_field("B", 4.0) };
        for format in [FigureFormat::Png, FigureFormat::Svg] {
            check_drawing(&pair.to_picture(format).unwrap(), |format| pair.draw(format));
        }
        let picture = pair.to_picture(FigureFormat::Png).unwrap();
        let texts: Vec<&str> = picture.texts().map(|text| text.content.as_str()).collect();
        for title in ["A", "B"] {
            assert!(texts.contains(&title), "{texts:?}");
        }
        // The ticks of both colour bars are those of the larger field.
        let count = |content: &str| texts.iter().filter(|text| **text == content).count();
        assert_eq!(count("3.5"), 2, "{texts:?}");
        let half = crate::tests::png_size(&pair.upper.draw(FigureFormat::Png).unwrap())[1];
        assert!(picture.height > half);
        assert!(
            !texts.iter().any(|text| text.contains('≥') || text.contains("beyond")),
            "{texts:?}"
        );
        // Fields without values have no scale; refused fields are named.
        let zero = FieldPairFigure { upper: sample_field("A", 0.0), lower: sample_field("B", 0.0) };
        check_drawing(&zero.to_picture(FigureFormat::Png).unwrap(), |format| zero.draw(format));
        let mut wrong = pair;
        wrong.lower.values.pop();
        assert!(wrong.draw(FigureFormat::Png).unwrap_err().to_string().contains("199 values"));
    }
}
