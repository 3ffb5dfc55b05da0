//! Tests of figures of growth rates.

use super::*;
use crate::format::FigureFormat;
use crate::tests::{check_drawing, edge_case_curves};

fn sample_panel(x_log: bool, points: &[[f64; 2]], marks: &[f64]) -> GrowthPanel {
    GrowthPanel {
        x_label: if x_log { "wave number k (1/m)" } else { "direction θ (°)" }.to_owned(),
        y_label: "growth rate Re ς (1/s)".to_owned(),
        is_x_log: x_log,
        curves: vec![LabelledCurve { label: "model".to_owned(), points: points.to_vec() }],
        reference_lines: vec![LabelledCurve {
            label: "asymptote".to_owned(),
            points: points.to_vec(),
        }],
        marks: marks.iter().map(|&x| AxisMark { label: format!("θ = {x}°"), x }).collect(),
        is_measured: x_log,
    }
}

fn sample_figure(points: &[[f64; 2]], marks: &[f64]) -> GrowthFigure {
    GrowthFigure {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        by_direction: sample_panel(false, points, marks),
        by_wave_number: sample_panel(true, points, &[]),
    }
}

fn check_figure(figure: &GrowthFigure) {
    check_drawing(&figure.to_picture(), |format| figure.draw(format));
}

#[test]
fn any_points_are_drawn() {
    for points in edge_case_curves() {
        check_figure(&sample_figure(&points, &[]));
    }
}

#[test]
fn mark_labels_do_not_overlap() {
    let points = [[0.0, -1e6], [180.0, 1e4]];
    check_figure(&sample_figure(&points, &[0.0, 27.5, 57.5, 62.0, 117.5, 152.5, 180.0]));
    check_figure(&sample_figure(&points, &[90.0, 90.0, 90.5, 91.0, 170.0, 171.0]));
    check_figure(&sample_figure(&[], &[f64::NAN, 45.0, f64::INFINITY]));
    let mut long = sample_figure(&points, &[10.0, 20.0]);
    for mark in &mut long.by_direction.marks {
        mark.label = "a characteristic direction of the steady equations ".repeat(5);
    }
    long.by_direction.curves[0].label = "model ".repeat(100);
    long.by_direction.y_label = "growth rate ".repeat(50);
    check_figure(&long);
}

#[test]
fn mark_lines_cross_no_labels() {
    let panel = sample_panel(false, &[[0.0, 0.0], [180.0, 1.0]], &[27.5, 57.5, 62.0, 117.5, 152.5]);
    let frame = Rectangle { left: 0.0, top: 0.0, right: 600.0, bottom: 600.0 };
    let placed = place_marks(&panel, &GrowthScales::from_panel(&panel), frame);
    assert_eq!(placed.len(), 5);
    for mark in &placed {
        for other in placed.iter().filter(|other| other.row < mark.row) {
            let right = other.label_left + text_width(&other.label, MARK_LABEL_SIZE, false);
            assert!(
                mark.line_x < other.label_left || mark.line_x > right,
                "{} {}",
                mark.label,
                other.label
            );
        }
    }
}

#[test]
fn infinite_growth_is_drawn_at_the_upper_edge() {
    let drawn = |last: f64| {
        let figure = sample_figure(&[[1.0, 1.0], [2.0, 100.0], [3.0, last], [4.0, last]], &[]);
        let (width, pixels) = crate::tests::decode_png(&figure.draw(FigureFormat::Png).unwrap());
        // Counts black pixels in the left panel just below the upper edge of the frame.
        let frame_top = (0..).find(|y| pixels[3 * (y * width + 400)] < 60 && *y > 150).unwrap();
        let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] < 60;
        (300..750).filter(|&x| (4..12).any(|below| dark(x, frame_top + below))).count()
    };
    assert!(drawn(f64::INFINITY) > drawn(f64::NAN) + 100);
}

#[test]
fn values_of_one_sign_have_a_logarithmic_axis() {
    let scales = |values: [f64; 3]| {
        let points = [[100.0, values[0]], [1e3, values[1]], [99_856.0, values[2]]];
        GrowthScales::from_panel(&sample_panel(true, &points, &[]))
    };
    for sign in [1.0, -1.0] {
        let of = scales([0.3, 2.0, 500.0].map(|size| sign * size));
        assert!(of.is_y_log && sign * of.y_low > 0.0 && sign * of.y_high > 0.0);
        // Equal ratios are equal distances, and ticks are at their values.
        let place = |size: f64| of.y_scale.to_position(sign * size);
        assert!((place(2.0) - place(0.2) - (place(500.0) - place(50.0))).abs() < 1e-12);
        let ticks = of.y_ticks(600.0);
        let label = if sign > 0.0 { "10²" } else { "−10²" };
        let tick = ticks.iter().find(|(_, own)| own == label).unwrap();
        assert!((tick.0 - place(100.0)).abs() < 1e-12);
        // The horizontal axis ends at the power of ten next to the last point.
        assert_eq!([of.x_low, of.x_high], [2.0, 5.0]);
    }
    assert!(!scales([0.0, 2.0, 500.0]).is_y_log);
    assert!(!scales([-1.0, 2.0, 500.0]).is_y_log);
    assert!(!scales([1.0, 1.2, 1.5]).is_y_log);
}

/// The legend explains the linear part only where there is one.
#[test]
fn legend_names_the_linear_part_of_axes_that_have_one() {
    let texts = |points: &[[f64; 2]]| -> Vec<String> {
        let picture = sample_figure(points, &[]).to_picture();
        picture.texts().map(|text| text.content.clone()).collect()
    };
    let names = |texts: &[String]| texts.iter().any(|text| text.starts_with("linear scale"));
    assert!(!names(&texts(&[[1.0, 1.0], [10.0, 30.0]])));
    assert!(names(&texts(&[[1.0, -1.0], [10.0, 30.0]])));
}

#[test]
fn lines_with_equal_labels_share_a_style() {
    let mut figure = sample_figure(&[[1.0, 1.0], [2.0, 3.0]], &[]);
    figure
        .by_wave_number
        .curves
        .push(LabelledCurve { label: "other".to_owned(), points: vec![[1.0, 2.0]] });
    assert_eq!(figure.distinct_labels(), ["model", "other"]);
    // Curves without points are not in the legend.
    figure.by_wave_number.curves[1].points = vec![[1.0, f64::NAN]];
    assert_eq!(figure.distinct_labels(), ["model"]);
    for count in [0, 1, 4, 9] {
        figure.by_direction.curves = (0..count)
            .map(|index| LabelledCurve {
                label: format!("model {index}"),
                points: vec![[1.0, 2.0]],
            })
            .collect();
        check_figure(&figure);
    }
}
