//! Panels of curves.

use crate::sampling::sample_interval;
use wellposed_figures::{CurvePanel, LabelledCurve, PanelsFigure};

/// Builds a figure of three panels with curves, chords and marked points.
pub fn build_panels_figure() -> PanelsFigure {
    let panel = |x_label: &str, y_label: &str, value: &dyn Fn(f64, f64) -> f64| {
        let curve = |rate: f64| LabelledCurve {
            label: format!("rate {rate}"),
            points: sample_interval(0.0, 1.0, 50)
                .into_iter()
                .map(|x| [x, value(x, rate)])
                .collect(),
        };
        CurvePanel {
            x_label: x_label.into(),
            y_label: y_label.into(),
            curves: [1.0, 2.0, 3.0].map(curve).to_vec(),
            reference_lines: vec![LabelledCurve {
                label: "chord".into(),
                points: vec![[0.0, value(0.0, 2.0)], [1.0, value(1.0, 2.0)]],
            }],
            points: vec![[0.0, value(0.0, 2.0)], [1.0, value(1.0, 2.0)]],
            ..CurvePanel::default()
        }
    };
    PanelsFigure {
        title: "Panels of curves".into(),
        subtitle: "three rates; the pale lines are chords".into(),
        panels: vec![
            panel("strain, %", "pressure, MPa", &|x, rate| x + rate * x * x),
            panel("position, m", "velocity, m/s", &|x, rate| (-rate * x).exp()),
            panel("position, m", "time, ms", &|x, rate| rate * x),
        ],
    }
}
