//! Tests of figures of records.

use super::*;
use crate::format::FigureFormat;
use crate::tests::check_drawing;

/// Checks a figure of records as [`check_drawing`] does.
pub(crate) fn check_figure(figure: &RecordFigure) {
    check_drawing(&figure.to_picture().unwrap(), |format| figure.draw(format));
}

pub(crate) fn picture_texts(figure: &RecordFigure) -> Vec<String> {
    figure.to_picture().unwrap().texts().map(|text| text.content.clone()).collect()
}

fn create_panel<'a>(label: &'a str, series: Vec<RecordSeries<'a>>) -> RecordPanel<'a> {
    RecordPanel {
        label,
        series_label: "",
        included_values: Vec::new(),
        series,
        min_height: 100.0,
        height_weight: 1.0,
    }
}

fn decimate_by_column(times: &[f64], values: &[f64]) -> Vec<Vec<Point>> {
    decimate(times, values, |t, v| [t, -v], |a, b| a[0].floor() == b[0].floor())
}

#[test]
fn decimation_keeps_ends_and_extremes() {
    let times: Vec<f64> = (0..100_000).map(|index| 1e-3 * f64::from(index)).collect();
    let mut values: Vec<f64> = times.iter().map(|time| (900.0 * time).sin()).collect();
    values[54_321] = 40.0;
    values[54_329] = -30.0;
    let parts = decimate_by_column(&times, &values);
    assert_eq!(parts.len(), 1);
    assert!(parts[0].len() <= 400 && parts[0].len() > 300, "{}", parts[0].len());
    for index in [54_321, 54_329, 0, 99_999] {
        assert!(parts[0].contains(&[times[index], -values[index]]));
    }
    assert!(parts[0].windows(2).all(|pair| pair[0][0] < pair[1][0]));
    // A line with few points is unchanged.
    let times = [0.0, 0.4, 0.9, 1.1, 2.7];
    let values = [1.0, 3.0, 2.0, 2.0, 5.0];
    assert_eq!(super::tests::decimate_by_column(&times, &values)[0].len(), 5);
}

#[test]
fn lines_break_where_values_are_not_finite() {
    let (nan, infinite) = (f64::NAN, f64::INFINITY);
    let times: Vec<f64> = (0..8).map(f64::from).collect();
    let lengths = |values: [f64; 8]| -> Vec<usize> {
        decimate_by_column(&times, &values).iter().map(Vec::len).collect()
    };
    assert_eq!(lengths([1.0, 2.0, nan, 3.0, 3.0, infinite, 1.0, nan]), [2, 2, 1]);
    assert_eq!(lengths([nan; 8]), []);
    assert_eq!(lengths([nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -infinite]), [6]);
}

#[test]
fn only_fast_oscillations_are_dense() {
    let times: Vec<f64> = (0..1000).map(f64::from).collect();
    let wave = |period: f64| -> Vec<f64> {
        times.iter().map(|time| (std::f64::consts::TAU * time / period).sin()).collect()
    };
    // The window has 40 samples; a full oscillation varies by twice its range of 2.
    let range = DENSE_VARIATION * 2.0;
    assert!(is_dense(&times, &wave(33.0), range));
    assert!(!is_dense(&times, &wave(45.0), range));
    assert!(!is_dense(&times, &wave(33.0), 2.0 * range));
    assert!(!is_dense(&times, &times, DENSE_VARIATION * 999.0));
    assert!(!is_dense(&[0.0, 0.0], &[0.0, 1.0], 1.0) && !is_dense(&[0.0], &[1.0], 0.0));
}

/// A record has one style in all panels and in the legend, whatever its values are.
#[test]
fn dense_records_have_one_style() {
    let times: Vec<f64> = (0..1000).map(f64::from).collect();
    let fast: Vec<f64> = times.iter().map(|time| (0.5 * time).sin()).collect();
    let panel = |values| {
        let slow = RecordSeries { name: Some("R1"), values: &times };
        create_panel("velocity", vec![slow, RecordSeries { name: Some("R2"), values }])
    };
    let panels = vec![panel(&times), panel(&fast)];
    let figure = RecordFigure { title: "", subtitle: "", time_label: "", times: &times, panels };
    let widths = ["R1", "R2"].map(|name| figure.line_style(Some(name), &["R1", "R2"]).width);
    // The range of the second panel is that of R1, so that R2 is not dense there.
    assert_eq!(widths, [LineStyle::from_index(0).width, LineStyle::from_index(1).width]);
    let mut figure = figure;
    figure.panels[1].series.remove(0);
    let style = figure.line_style(Some("R2"), &["R1", "R2"]);
    assert!(style.width == DENSE_LINE_WIDTH && style.dashes.is_empty());
    check_figure(&figure);
}

/// Each of several dense records has a panel of its own, named, with the scale that they would share.
#[test]
fn dense_records_do_not_cover_each_other() {
    let times: Vec<f64> = (0..1000).map(f64::from).collect();
    let wave = |size: f64| -> Vec<f64> { times.iter().map(|t| size * (0.5 * t).sin()).collect() };
    let (large, small) = (wave(3.0), wave(2.8));
    let slow: Vec<f64> = times.iter().map(|time| 1e-3 * time).collect();
    let series = [("A", &large), ("B", &slow), ("C", &small)];
    let series = series.map(|(name, values)| RecordSeries { name: Some(name), values });
    let panels = create_panel("v, m/s", series.to_vec()).separate_dense_series(&times);
    let found: Vec<_> = panels.iter().map(|own| (own.series_label, own.series.len())).collect();
    assert_eq!(found, [("B", 1), ("A", 1), ("C", 1)]);
    let scales = [1, 2].map(|index| RecordScale::from_panel(&panels[index], 110.0));
    assert_eq!(scales[0], scales[1]);
    // One dense record hides nothing that is not told apart by its width.
    let single = create_panel("v, m/s", series[..2].to_vec()).separate_dense_series(&times);
    assert_eq!(single.len(), 1);
    let panels = vec![create_panel("v, m/s", series.to_vec())];
    let figure = RecordFigure { title: "", subtitle: "", time_label: "t", times: &times, panels };
    let texts = picture_texts(&figure);
    for name in ["A", "B", "C"] {
        assert_eq!(texts.iter().filter(|text| *text == name).count(), 1, "{texts:?}");
    }
    check_figure(&figure);
}

#[test]
fn every_scale_has_ticks() {
    for exponent in [-300, -12, -3, 0, 5, 200] {
        for step in 0..60 {
            let size = (1.0 + 0.15 * f64::from(step)) * 10_f64.powi(exponent);
            for [low, high] in [[-1.0, 1.0], [0.0, 1.0], [-0.3, 1.0], [5.0, 6.0], [-9.0, -8.7]] {
                let values = [low * size, high * size];
                let series = vec![RecordSeries { name: None, values: &values }];
                let panel = create_panel("", series);
                let scale = RecordScale::from_panel(&panel, 110.0);
                assert!((2..=5).contains(&scale.ticks.len()), "{scale:?}");
                assert!(scale.low <= values[0] && scale.high >= values[1]);
            }
        }
    }
}

#[test]
fn wrong_input_is_refused() {
    let refused = |times: &[f64], values: &[f64]| {
        let series = RecordSeries { name: Some("R1"), values };
        let panels = vec![create_panel("velocity", vec![series])];
        let figure = RecordFigure { title: "", subtitle: "", time_label: "time", times, panels };
        figure.draw(FigureFormat::Svg).unwrap_err().to_string()
    };
    assert_eq!(refused(&[0.0, 1.0], &[1.0]), "the record \"R1\" has 1 values for 2 times");
    assert!(refused(&[], &[]).contains("\"time\" has no values"));
    assert!(refused(&[1.0, 0.0], &[0.0, 0.0]).contains("decrease"));
    assert!(refused(&[0.0, f64::NAN], &[0.0, 0.0]).contains("not a finite number"));
}
