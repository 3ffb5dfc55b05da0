//! Energy ledger of a simulation against time.

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::record::{RecordFigure, RecordPanel, RecordSeries};

/// A term of the energy ledger, or the residual of the energy balance.
#[derive(Debug, Clone, PartialEq)]
pub struct LedgerTerm {
    /// Legend text; for the residual the title of its panel.
    pub name: String,
    /// One value per time of the figure. Non-finite values interrupt the line.
    pub values: Vec<f64>,
}

/// Energy ledger of a simulation against time: stored energies, work and dissipation, with the residual of the balance
/// in a separate panel.
#[derive(Debug, Clone, PartialEq)]
pub struct LedgerFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name, symbol and unit of the time axis.
    pub time_label: String,
    /// Name and unit of the energies, e.g. `energy, J/m`.
    pub energy_label: String,
    /// Times of the values, non-decreasing, in the unit of the time label.
    pub times: Vec<f64>,
    /// Energies, in the unit of the label; the first eight have distinct styles.
    pub terms: Vec<LedgerTerm>,
    /// Residual of the energy balance, in the unit given in its name; without values its panel is omitted.
    pub residual: LedgerTerm,
}

/// Minimum heights of the frames of the terms and of the residual, pixels.
const MIN_FRAME_HEIGHTS: [f64; 2] = [420.0, 120.0];

impl LedgerFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// There are no times, a time is not finite or decreases, a term does not have one value per time, or rendering or
    /// encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        self.to_record_figure().draw(output)
    }

    fn to_record_figure(&self) -> RecordFigure<'_> {
        let terms = self.terms.iter();
        let terms =
            terms.map(|LedgerTerm { name, values }| RecordSeries { name: Some(name), values });
        let mut panels = vec![RecordPanel {
            label: &self.energy_label,
            series_label: "",
            // Small differences of large energies belong to the residual, not to the scale.
            included_values: vec![0.0],
            series: terms.collect(),
            min_height: MIN_FRAME_HEIGHTS[0],
            height_weight: 4.0,
        }];
        let LedgerTerm { name, values } = &self.residual;
        if !values.is_empty() {
            let series = vec![RecordSeries { name: None, values }];
            panels.push(RecordPanel {
                label: name,
                series_label: "",
                included_values: Vec::new(),
                series,
                min_height: MIN_FRAME_HEIGHTS[1],
                height_weight: 1.0,
            });
        }
        RecordFigure {
            title: &self.title,
            subtitle: &self.subtitle,
            time_label: &self.time_label,
            times: &self.times,
            panels,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::{check_figure, picture_texts};

    fn sample_figure(terms: usize, samples: usize, balance: impl Fn(f64) -> f64) -> LedgerFigure {
        let times: Vec<f64> = (0..samples).map(|index| 0.01 * index as f64).collect();
        let term = |index: usize| LedgerTerm {
            name: format!("energy of kind {index}"),
            values: times.iter().map(|time| time * (1.0 - index as f64)).collect(),
        };
        LedgerFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            time_label: "time t, s".to_owned(),
            energy_label: "energy, J/m".to_owned(),
            terms: (0..terms).map(term).collect(),
            residual: LedgerTerm {
                name: "balance, share of the energy".to_owned(),
                values: times.iter().map(|time| balance(*time)).collect(),
            },
            times,
        }
    }

    #[test]
    fn ledgers_of_all_kinds_are_drawn() {
        let check = |terms: usize, samples: usize, size: f64| {
            let figure = sample_figure(terms, samples, |time| size * (40.0 * time).sin());
            check_figure(&figure.to_record_figure());
        };
        for (terms, samples) in [(0, 1), (9, 30), (3, 200_000)] {
            check(terms, samples, 0.03);
        }
        for size in [0.0, 1e-13, 0.03, f64::NAN] {
            check(1, 1, size);
            check(7, 400, size);
        }
    }

    /// Two nearly constant energies are compared with zero, not with their difference.
    #[test]
    fn scale_of_the_terms_includes_zero() {
        let mut figure = sample_figure(2, 50, |_| 0.0);
        for (term, sign) in figure.terms.iter_mut().zip([1.0, -1.0]) {
            term.values = figure.times.iter().map(|time| 0.25 + sign * 1e-6 * time).collect();
        }
        let texts = picture_texts(&figure.to_record_figure());
        assert!(texts.contains(&"0".to_owned()), "{texts:?}");
        assert!(texts.contains(&"energy, J/m".to_owned()), "{texts:?}");
    }

    #[test]
    fn residual_has_its_own_panel_and_scale() {
        let residual = sample_figure(3, 500, |time| 3e-13 * (9.0 * time).sin());
        let texts = picture_texts(&residual.to_record_figure());
        assert!(texts.contains(&"2".to_owned()), "{texts:?}");
        assert!(texts.contains(&"balance, share of the energy (×10⁻¹³)".to_owned()), "{texts:?}");
        let mut without = residual;
        without.residual.values.clear();
        assert!(
            !picture_texts(&without.to_record_figure())
                .contains(&"balance, share of the energy".to_owned())
        );
        check_figure(&without.to_record_figure());
        assert!(
            picture_texts(&sample_figure(2, 50, |_| 0.0).to_record_figure())
                .contains(&"zero".to_owned())
        );
    }
}
