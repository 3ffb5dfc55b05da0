//! Seismograms: recorded quantities at receivers against time.

use crate::error::FigureError;
use crate::format::FigureOutput;
use crate::record::{RecordFigure, RecordPanel, RecordSeries};

/// Trace of one quantity at one receiver.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Name of the receiver, listed in the legend. Traces with the same name share a style in all panels.
    pub name: String,
    /// One value per time of the figure, in the unit of the panel's label. Non-finite values interrupt the line.
    pub values: Vec<f64>,
}

/// Panel of one quantity at all receivers, with its own scale.
#[derive(Debug, Clone, PartialEq)]
pub struct SeismogramPanel {
    /// Name, symbol and unit of the quantity, e.g. `velocity v₁, m/s`.
    pub label: String,
    /// Traces of the receivers; the first eight have distinct styles.
    pub traces: Vec<Trace>,
}

/// Seismograms of the receivers: one panel per quantity, one above the other, with a common time axis.
///
/// If there are more samples than pixels, the extrema within each pixel column are drawn, so that no peak is lost. The
/// figure is higher than usual for more than about five panels.
#[derive(Debug, Clone, PartialEq)]
pub struct SeismogramFigure {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Name, symbol and unit of the time axis.
    pub time_label: String,
    /// Panels from top to bottom.
    pub panels: Vec<SeismogramPanel>,
    /// Times of the samples, non-decreasing, in the unit of the time label.
    pub times: Vec<f64>,
}

/// Minimum height of the frame of a panel, pixels.
const MIN_PANEL_HEIGHT: f64 = 110.0;

impl SeismogramFigure {
    /// Renders the figure and returns the bytes of the file.
    ///
    /// # Errors
    /// There are no times, a time is not finite or decreases, a trace does not have one value per time, or rendering or
    /// encoding fails.
    pub fn draw(&self, output: impl Into<FigureOutput>) -> Result<Vec<u8>, FigureError> {
        self.to_record_figure().draw(output)
    }

    fn to_record_figure(&self) -> RecordFigure<'_> {
        let panels = self.panels.iter().map(|SeismogramPanel { label, traces }| {
            let traces = traces.iter();
            let series = traces
                .map(|Trace { name, values }| RecordSeries { name: Some(name), values })
                .collect();
            RecordPanel {
                label,
                series_label: "",
                included_values: Vec::new(),
                series,
                min_height: MIN_PANEL_HEIGHT,
                height_weight: 1.0,
            }
        });
        RecordFigure {
            title: &self.title,
            subtitle: &self.subtitle,
            time_label: &self.time_label,
            times: &self.times,
            panels: panels.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::FigureFormat;
    use crate::record::tests::{check_figure, picture_texts};

    fn sample_figure(
        [panels, receivers, samples]: [usize; 3],
        value: impl Fn(usize, usize, f64) -> f64,
    ) -> SeismogramFigure {
        let times: Vec<f64> = (0..samples).map(|index| 1e-3 * index as f64).collect();
        let trace = |panel: usize, receiver: usize| Trace {
            name: format!("R{receiver}"),
            values: times.iter().map(|time| value(panel, receiver, *time)).collect(),
        };
        let panels = (0..panels).map(|panel| SeismogramPanel {
            label: format!("velocity v₁ of kind {panel}, m/s"),
            traces: (0..receivers).map(|receiver| trace(panel, receiver)).collect(),
        });
        SeismogramFigure {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            time_label: "time t, s".to_owned(),
            panels: panels.collect(),
            times,
        }
    }

    #[test]
    fn any_number_of_panels_and_receivers_is_drawn() {
        let wave = |panel: usize, receiver: usize, time: f64| {
            (10.0 * time + panel as f64).sin() * (1.0 + receiver as f64)
        };
        for size in [[0, 0, 3], [1, 0, 3], [1, 1, 1], [1, 1, 300], [6, 3, 500], [14, 20, 90]] {
            let figure = sample_figure(size, wave);
            check_figure(&figure.to_record_figure());
            let height = crate::tests::png_size(&figure.draw(FigureFormat::Png).unwrap())[1];
            assert_eq!(height > 1100, size[0] > 5, "{size:?} {height}");
        }
    }

    #[test]
    fn any_values_are_drawn() {
        let values = [f64::NAN, 1e308, f64::MIN, 9e299, -9e299, 5e-324, f64::INFINITY, 1e-200];
        for kinds in 1..=values.len() {
            let figure = sample_figure([2, 2, 50], |panel, receiver, time| {
                values[((1e3 * time) as usize + panel + receiver) % kinds]
            });
            check_figure(&figure.to_record_figure());
        }
        let constant = sample_figure([3, 2, 20], |panel, _, _| [1e5, -3.0, 7e-9][panel]);
        check_figure(&constant.to_record_figure());
        assert!(picture_texts(&constant.to_record_figure()).contains(&"−3".to_owned()));
        let offset = sample_figure([1, 1, 2000], |_, _, time| 1e5 + 1e-3 * time);
        check_figure(&offset.to_record_figure());
    }

    #[test]
    fn panels_without_motion_are_labelled() {
        let still = sample_figure([3, 2, 20], |panel, _, time| match panel {
            0 => -0.0,
            1 if time > 0.005 => f64::NAN,
            1 => 0.0,
            _ => f64::INFINITY,
        });
        let texts = picture_texts(&still.to_record_figure());
        for label_text in ["zero", "zero wherever it is finite", "no finite values"] {
            assert!(texts.iter().any(|text| text == label_text), "{label_text} {texts:?}");
        }
        assert!(texts.contains(&"not a finite number (56.7 %)".to_owned()), "{texts:?}");
        // No line is drawn, so that the legend has none.
        assert!(!texts.iter().any(|text| text.starts_with('R')), "{texts:?}");
        check_figure(&still.to_record_figure());
        assert!(
            picture_texts(&sample_figure([0, 0, 1], |_, _, _| 0.0).to_record_figure())
                .contains(&"nothing recorded".to_owned())
        );
        assert!(
            picture_texts(&sample_figure([1, 0, 1], |_, _, _| 0.0).to_record_figure())
                .contains(&"no values".to_owned())
        );
    }

    #[test]
    fn single_sample_of_a_long_record_is_drawn() {
        let mut figure = sample_figure([1, 1, 1_000_000], |_, _, time| 1e-3 * (70.0 * time).sin());
        figure.panels[0].traces[0].values[617_283] = 1.0;
        let (width, pixels) = crate::tests::decode_png(&figure.draw(FigureFormat::Png).unwrap());
        let ink = |x: usize, y: usize| pixels[3 * (y * width + x)] < 128;
        // A vertical line above the middle of the figure, away from texts and the frame.
        let column = (900..1100).find(|&x| (400..500).all(|y| ink(x, y)));
        assert!(column.is_some());
        assert!(figure.draw(FigureFormat::Svg).unwrap().len() < 200_000);
    }

    #[test]
    fn long_texts_stay_within_the_picture() {
        let mut figure = sample_figure([3, 12, 30], |_, receiver, time| time + receiver as f64);
        let long = "a rather long description of what is meant ".repeat(40);
        for panel in &mut figure.panels {
            panel.label.clone_from(&long);
            panel.traces[3].name.clone_from(&long);
        }
        let SeismogramFigure { title, subtitle, time_label, .. } = &mut figure;
        for text in [title, subtitle, time_label] {
            text.clone_from(&long);
        }
        check_figure(&figure.to_record_figure());
    }
}
