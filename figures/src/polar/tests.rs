//! Tests of polar diagrams.

use super::figure::{PolarFigure, Spoke, SpokeStyle};
use super::labels::{SpokeLabel, build_labels};
use super::radial_scale::{HOLE_FRACTION, RadialScale};
use crate::format::FigureFormat;
use crate::growth::LabelledCurve;

use crate::tests::{check_drawing, edge_case_curves};

fn sample_figure(points: &[[f64; 2]], spokes: &[f64]) -> PolarFigure {
    let spoke = |(index, &angle_deg): (usize, &f64)| Spoke {
        label: format!("spoke {index}"),
        angle_deg,
        style: SpokeStyle::ALL[index % 2],
    };
    PolarFigure {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        symbol: "Re ς".to_owned(),
        unit: "1/s".to_owned(),
        curves: vec![LabelledCurve { label: "model".to_owned(), points: points.to_vec() }],
        spokes: spokes.iter().enumerate().map(spoke).collect(),
    }
}

fn check_figure(figure: &PolarFigure) {
    check_drawing(&figure.to_picture(), |format| figure.draw(format));
}

#[test]
fn any_points_are_drawn() {
    for points in edge_case_curves() {
        check_figure(&sample_figure(&points, &[15.0, 75.0]));
    }
}

#[test]
fn labels_do_not_overlap_for_any_spokes() {
    let points = [[0.0, -1e6], [180.0, 1e4]];
    let sets: [&[f64]; 6] = [
        &[],
        &[f64::NAN, f64::INFINITY, 1e300, -720.0],
        &[0.0, 0.0, 90.0, 180.0, -90.0],
        &[14.95, 15.0, 75.0, 75.05, 30.0, 29.0],
        &[85.0, 88.0, 89.0, 90.0, 91.0, 92.0, 95.0],
        &[15.0, 15.0, 45.0, 75.0, 75.0, 111.8, 135.0],
    ];
    for spokes in sets {
        check_figure(&sample_figure(&points, spokes));
    }
    let many: Vec<f64> = (0..60).map(|angle| 3.0 * f64::from(angle)).collect();
    check_figure(&sample_figure(&points, &many));
    let mut long = sample_figure(&points, &[10.0, 20.0, 100.0]);
    long.spokes[0].label = "a direction of some kind ".repeat(30);
    long.unit = "metres ".repeat(100);
    check_figure(&long);
}

#[test]
fn spokes_with_equal_angles_share_a_label() {
    let [right, left] =
        build_labels(sample_figure(&[], &[15.0, 195.0, 105.0, -1e-9]).finite_spokes());
    let label_text =
        |labels: &[SpokeLabel]| -> Vec<String> { labels.iter().map(SpokeLabel::to_text).collect() };
    assert_eq!(label_text(&right), ["15° spoke 0, spoke 1", "0° spoke 3"]);
    assert_eq!(label_text(&left), ["105° spoke 2"]);
}

#[test]
fn growth_lies_outside_the_neutral_circle_and_decay_inside() {
    let curve = LabelledCurve { label: String::new(), points: vec![[0.0, 1e5], [90.0, -1e3]] };
    let radial = RadialScale::from_curves(&[curve], 400.0);
    let neutral = radial.growth_radius(0.0);
    let radii = [f64::NEG_INFINITY, -1e3, -10.0, 0.0, 10.0, 1e5, f64::INFINITY];
    let radii = radii.map(|growth| radial.growth_radius(growth));
    assert!(radii.windows(2).all(|pair| pair[0] < pair[1]), "{radii:?}");
    assert!(radii[0] > HOLE_FRACTION * 400.0 && radii[6] < 400.0 && radii[3] == neutral);
    // Decades have equal widths.
    let step = radial.growth_radius(1e5) - radial.growth_radius(1e4);
    assert!((radial.growth_radius(1e4) - radial.growth_radius(1e3) - step).abs() < 1e-9);
}

#[test]
fn the_angle_is_anticlockwise_and_the_circle_is_full() {
    // Growth only in a sector about 45°: black pixels in the upper right and lower left quarters only.
    let points: Vec<[f64; 2]> = (35..=55).map(|angle| [f64::from(angle), 1e3]).collect();
    let figure = sample_figure(&points, &[]);
    let (width, pixels) = crate::tests::decode_png(&figure.draw(FigureFormat::Png).unwrap());
    let dark = |x: usize, y: usize| pixels[3 * (y * width + x)] < 20;
    let count = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        columns.flat_map(|x| rows.clone().map(move |y| (x, y))).filter(|&(x, y)| dark(x, y)).count()
    };
    // Rows between heading and legend, above and below the centre.
    let (upper, lower) = (160..510, 590..900);
    assert!(count(810..1200, upper.clone()) > 200 && count(400..790, lower.clone()) > 200);
    assert_eq!(count(400..790, upper), 0);
    assert_eq!(count(810..1200, lower), 0);
}

/// The axis of the radius begins with the labelled ring of decay, and an angle on the rim gives way only to a spoke there.
#[test]
fn rings_of_decay_and_angles_are_labelled() {
    let points = [[0.0, -1e3], [90.0, 1e4], [180.0, -1e3]];
    let texts = |spokes: &[f64]| -> Vec<String> {
        let picture = sample_figure(&points, spokes).to_picture();
        picture.texts().map(|text| text.content.clone()).collect()
    };
    let found = texts(&[75.0, 85.0]);
    assert!(found.iter().any(|text| text.starts_with("−10")), "{found:?}");
    for angle in (0..12).map(|step| format!("{}°", 30 * step)) {
        assert!(found.contains(&angle), "{angle} not in {found:?}");
    }
    assert!(!texts(&[60.0]).contains(&"60°".to_owned()));
}
