//! Tests of lines, arrows and level curves on a field.

use super::*;
use crate::field::{FieldArrow, FieldArrows, FieldLine, FieldLineSet, FieldLineStyle};
use crate::picture::WHITE;

/// Field of zeros over 12 m × 8 m.
fn blank_figure() -> FieldFigure {
    sample_figure(120, 80, |_, _| 0.0)
}

fn sample_set(style: FieldLineStyle, lines: Vec<FieldLine>) -> FieldLineSet {
    FieldLineSet { style, label: "slip".to_owned(), unit: "m".to_owned(), lines, limit: 2.0 }
}

/// Vertical line through the middle of the field.
fn middle_line(value: f64) -> FieldLine {
    FieldLine { axis: 0, centre: [6.0, 4.0], length: 4.0, value }
}

/// Colours of 41 pixels about the middle of the field, across or along the middle line.
fn middle_colours(figure: &FieldFigure, axis: usize) -> Vec<[u8; 3]> {
    let drawn = RenderedField::new(figure);
    let frame = drawn.frame;
    let middle = [0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom)];
    (-20..=20)
        .map(|offset| {
            let mut place = middle;
            place[axis] += f64::from(offset);
            drawn.pixel(place[0], place[1])
        })
        .collect()
}

fn count_colour(colours: &[[u8; 3]], colour: Colour) -> usize {
    colours.iter().filter(|own| **own == channels(colour)).count()
}

#[test]
fn thickness_of_lines_grows_with_their_value() {
    let mut figure = blank_figure();
    let widths = [0.1, 0.9, 2.0, 7.0].map(|value| {
        figure.line_sets = vec![sample_set(FieldLineStyle::Solid, vec![middle_line(value)])];
        check_figure(&figure);
        count_colour(&middle_colours(&figure, 0), INK)
    });
    assert!(widths[0] >= 1 && widths[0] < widths[1] && widths[1] < widths[2], "{widths:?}");
    // Values beyond the limit have the largest width.
    assert_eq!(widths[2], widths[3]);
    assert!(has_text(&figure, "slip up to 2 m"));
    figure.line_sets[0].lines.clear();
    assert!(!has_text(&figure, "slip"));
}

/// Verifies that styles are distinguished without colours: a solid line is ink, a gap is white between two lines of
/// ink, a dashed line changes along its length, an outline is grey.
#[test]
fn styles_of_lines_differ_in_shape() {
    let mut figure = blank_figure();
    let mut draw = |style, axis| {
        figure.line_sets = vec![sample_set(style, vec![middle_line(2.0)])];
        check_figure(&figure);
        middle_colours(&figure, axis)
    };
    let solid = draw(FieldLineStyle::Solid, 1);
    assert_eq!(count_colour(&solid, INK), solid.len());
    let gap = draw(FieldLineStyle::Gap, 0);
    let ink: Vec<usize> = (0..gap.len()).filter(|place| gap[*place][0] < 100).collect();
    let [first, last] = [ink[0], ink[ink.len() - 1]];
    assert!(first < 18 && last > 22 && gap[20] == channels(WHITE), "{gap:?}");
    let dashed = draw(FieldLineStyle::Dotted, 1);
    let dark = count_colour(&dashed, INK);
    assert!((20..30).contains(&dark), "{dark} of {}", dashed.len());
    let outline = draw(FieldLineStyle::Outline, 0);
    assert_eq!(count_colour(&outline, INK), 0);
    assert!(outline.iter().any(|own| own[0] < 200));
}

#[test]
fn dense_lines_differ_in_darkness_and_lose_their_outlines() {
    let line = |index: u32, value: f64| FieldLine {
        axis: 0,
        centre: [0.08 * f64::from(index), 4.0],
        length: 8.0,
        value,
    };
    let all = |value: f64| (1..150).map(|index| line(index, value)).collect::<Vec<_>>();
    let mut figure = blank_figure();
    let mean_grey = |figure: &FieldFigure| {
        let colours = middle_colours(figure, 0);
        colours.iter().map(|own| f64::from(own[0])).sum::<f64>() / colours.len() as f64
    };
    let greys = [0.1, 1.0, 2.0].map(|value| {
        figure.line_sets = vec![
            FieldLineSet {
                label: "joints".to_owned(),
                ..sample_set(FieldLineStyle::Outline, all(0.0))
            },
            sample_set(FieldLineStyle::Solid, all(value)),
        ];
        mean_grey(&figure)
    });
    assert!(greys[0] > greys[1] + 5.0 && greys[1] > greys[2] + 5.0, "{greys:?}");
    assert!(has_text(&figure, "joints not drawn: too close together"));
    check_figure(&figure);
    // Lines further apart have outlines.
    figure.line_sets[0].lines = (1..10).map(|index| line(15 * index, 0.0)).collect();
    figure.line_sets[1].lines.clear();
    assert!(!has_text(&figure, "not drawn"));
    check_figure(&figure);
}

/// Verifies that coloured lines have the colours of their values, that the scale covers these values, and that lines with
/// small values leave the outlines below them visible.
#[test]
fn coloured_lines_have_the_colours_of_the_scale() {
    use crate::field::colour_map::{ColourScale, SHADE_COUNT};
    let outline = FieldLineSet {
        label: "joints".to_owned(),
        ..sample_set(FieldLineStyle::Outline, vec![middle_line(0.0)])
    };
    let mut figure = blank_figure();
    let largest = FieldLine { centre: [2.0, 4.0], ..middle_line(-8.0) };
    for is_signed in [true, false] {
        figure.is_signed = is_signed;
        // An unsigned quantity with negative values would become signed.
        let largest = FieldLine { value: if is_signed { -8.0 } else { 8.0 }, ..largest };
        for (value, step) in [(8.0, SHADE_COUNT), (4.0, SHADE_COUNT / 2), (2.0, SHADE_COUNT / 4)] {
            let lines = vec![middle_line(value), largest];
            figure.line_sets = vec![outline.clone(), sample_set(FieldLineStyle::Coloured, lines)];
            let scale = ColourScale::from_figure(&figure);
            assert_eq!((scale.limit, scale.is_signed), (8.0, is_signed));
            let colour = scale.step_colour(step);
            assert!((4..8).contains(&count_colour(&middle_colours(&figure, 0), colour)), "{value}");
            check_figure(&figure);
        }
    }
    assert!(has_text(&figure, "slip, above 0.4 m/s") && !has_text(&figure, "everywhere"));
    let pale = sample_set(FieldLineStyle::Coloured, vec![middle_line(0.2), largest]);
    figure.line_sets = vec![outline.clone(), pale];
    let is_grey = |own: &[u8; 3]| own[0] < 200 && own[0] == own[1] && own[1] == own[2];
    assert!(middle_colours(&figure, 0).iter().any(is_grey));
    // Lines of zeros alone are said to be zero.
    let zeros = sample_set(FieldLineStyle::Coloured, vec![middle_line(0.0)]);
    figure.line_sets = vec![outline, zeros];
    assert!(has_text(&figure, "zero everywhere"));
}

#[test]
fn adjacent_lines_are_joined() {
    let faces = (0..80).rev().map(|index| FieldLine {
        axis: 1,
        centre: [0.1 * f64::from(index) + 2.05, 4.0],
        length: 0.1,
        value: 1.0,
    });
    let mut figure = blank_figure();
    let whole = FieldLine { axis: 1, centre: [6.0, 4.0], length: 8.0, value: 1.0 };
    let files = [faces.collect(), vec![whole]].map(|lines| {
        figure.line_sets = vec![sample_set(FieldLineStyle::Dotted, lines)];
        String::from_utf8(figure.draw(FigureFormat::Svg).unwrap()).unwrap()
    });
    assert_eq!(files[0], files[1]);
}

#[test]
fn fixed_scale_reserves_the_legend_of_lines() {
    let mut figure = blank_figure();
    figure.fixed_limit = Some(1.0);
    figure.line_sets = vec![sample_set(FieldLineStyle::Solid, Vec::new())];
    let empty = arrange_figure(&figure).1.layout;
    assert!(has_text(&figure, "slip up to 2 m"));
    figure.line_sets[0].lines.push(middle_line(1.0));
    let full = arrange_figure(&figure).1.layout;
    assert_eq!((empty.frame, empty.height), (full.frame, full.height));
}

fn sample_arrows(count: [i32; 2], vector: impl Fn(f64, f64) -> [f64; 2]) -> FieldArrows {
    let place = |index: i32, count: i32| f64::from(2 * index + 1) / f64::from(2 * count);
    let points = (0..count[0]).flat_map(|i| (0..count[1]).map(move |j| [i, j]));
    let arrows = points.map(|[i, j]| {
        let position = [12.0 * place(i, count[0]), 8.0 * place(j, count[1])];
        FieldArrow { position, vector: vector(position[0], position[1]) }
    });
    FieldArrows {
        label: "flux w".to_owned(),
        magnitude_label: "|w|".to_owned(),
        unit: "m/s".to_owned(),
        arrows: arrows.collect(),
        magnitudes: Vec::new(),
    }
}

/// Verifies that arrows point upwards for a positive second component: the head, which is wider, is above the middle.
#[test]
fn arrows_have_direction_and_scale() {
    for (vector, is_upward) in [([0.0, 3.0], true), ([0.0, -3.0], false)] {
        let mut figure = blank_figure();
        figure.arrows = Some(sample_arrows([1, 1], |_, _| vector));
        let drawn = RenderedField::new(&figure);
        let frame = drawn.frame;
        let [x, y] = [0.5 * (frame.left + frame.right), 0.5 * (frame.top + frame.bottom)];
        let ink = |sign: f64| {
            let places =
                (1..60).flat_map(|j| (-15..=15).map(move |i| [f64::from(i), f64::from(j)]));
            let dark = |[i, j]: &[f64; 2]| drawn.pixel(x + i, y + sign * j) == channels(INK);
            places.filter(dark).count()
        };
        assert_eq!(ink(-1.0) > ink(1.0) + 10, is_upward, "{} {}", ink(-1.0), ink(1.0));
        assert!(has_text(&figure, "flux w: ") && has_text(&figure, "largest 3"));
        check_figure(&figure);
    }
}

#[test]
fn crowded_arrows_are_thinned_out() {
    let mut figure = blank_figure();
    figure.arrows = Some(sample_arrows([12, 8], |x, y| [y - 4.0, 6.0 - x]));
    assert!(!has_text(&figure, "at every"));
    figure.arrows = Some(sample_arrows([120, 80], |x, y| [y - 4.0, 6.0 - x]));
    assert!(has_text(&figure, "at every 4th junction") || has_text(&figure, "at every 3rd"));
    check_figure(&figure);
}

#[test]
fn level_curves_of_the_magnitude_are_numbered() {
    let mut figure = blank_figure();
    let speed = |x: f64, y: f64| 0.03 * (-0.1 * ((x - 6.0).powi(2) + (y - 4.0).powi(2))).exp();
    let magnitudes = sample_figure(120, 80, speed).values;
    figure.values[4000] = -1.0;
    figure.arrows =
        Some(FieldArrows { magnitudes, ..sample_arrows([12, 8], |x, y| [speed(x, y), 0.0]) });
    let texts = picture_texts(&figure);
    for level in ["0.02", "0.01", "0.005"] {
        assert!(texts.iter().any(|text| text == level), "{level} {texts:?}");
    }
    assert!(has_text(&figure, "level curves of |w|, m/s, as numbered"));
    // The curves are not those of the values.
    assert!(has_text(&figure, "negative") && !has_text(&figure, "at 0."));
    check_figure(&figure);
}

#[test]
fn any_lines_and_arrows_are_drawn() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let odd = [0.0, -1.0, 5e-324, 1e300, nan, inf, -inf];
    let mut figure = blank_figure();
    let mut lines = Vec::new();
    for value in odd {
        lines.extend([
            FieldLine { value, ..middle_line(1.0) },
            FieldLine { centre: [value, 4.0], ..middle_line(1.0) },
            FieldLine { length: value, ..middle_line(1.0) },
        ]);
    }
    for limit in odd {
        let set = FieldLineSet { limit, ..sample_set(FieldLineStyle::Dotted, lines.clone()) };
        let styled = |style| FieldLineSet { style, ..set.clone() };
        figure.line_sets =
            vec![set.clone(), styled(FieldLineStyle::Gap), styled(FieldLineStyle::Coloured)];
        check_figure(&figure);
    }
    figure.line_sets.clear();
    for value in odd {
        let arrow = |position, vector| FieldArrow { position, vector };
        let mut arrows = sample_arrows([4, 3], |x, _| [x, 1.0]);
        arrows.arrows.push(arrow([3.0, 3.0], [value, 1.0]));
        arrows.arrows.push(arrow([value, 3.0], [1.0, 1.0]));
        arrows.magnitudes = vec![value; 9600];
        figure.arrows = Some(arrows);
        check_figure(&figure);
    }
    figure.arrows = Some(FieldArrows::default());
    check_figure(&figure);
    figure.arrows = Some(FieldArrows { magnitudes: vec![1.0], ..FieldArrows::default() });
    let refused = figure.draw(FigureFormat::Svg).unwrap_err().to_string();
    assert!(refused.contains("magnitudes has 1"), "{refused}");
}

/// A loaded part of the boundary is drawn outside the frame, where it hides no values, and is listed in the legend.
#[test]
fn loads_lie_outside_the_field() {
    let mut figure = blank_figure();
    let [left, right, top] = [figure.x.start, figure.x.end, figure.y.end];
    let at = |share: f64| left + share * (right - left);
    figure.loaded_lines = vec![vec![[at(0.25), top], [at(0.75), top]]];
    check_figure(&figure);
    assert!(has_text(&figure, "loaded part of the boundary"));
    let frame = figure.compute_arrangement(&ColourScale::from_figure(&figure), FigureFormat::Png);
    let frame = frame.layout.frame;
    let curve = &figure.loaded_curves(frame)[0];
    assert!(curve.iter().all(|point| point[1] < frame.top), "{curve:?} {frame:?}");
    assert!((curve[1][0] - curve[0][0] - 0.5 * frame.width()).abs() < 1e-9);
    // A curve inside the domain stays where it is.
    let middle = 0.5 * (figure.y.start + top);
    figure.loaded_lines = vec![vec![[at(0.4), middle], [at(0.5), top]]];
    let inside = &figure.loaded_curves(frame)[0];
    assert!((inside[0][1] - 0.5 * (frame.top + frame.bottom)).abs() < 1e-9, "{inside:?}");
}

/// The legend lists contour lines of the signs that occur, and remarks after all that is drawn.
#[test]
fn legend_lists_what_is_drawn() {
    let positive = sample_figure(60, 40, |x, y| (-(x - 3.0).powi(2) - (y - 2.0).powi(2)).exp());
    assert!(has_text(&positive, "at 0.25 and 0.5 m/s") && !has_text(&positive, "at −"));
    let both = sample_figure(60, 40, |x, y| (3.0 * x).sin() * (2.0 * y).cos());
    assert!(has_text(&both, "at 0.25 and 0.5 m/s") && has_text(&both, "at −0.5 and −0.25 m/s"));
    let mut crowded = both;
    crowded.marks =
        vec![sample_mark(3.0, 2.0, "a long name of a receiver", FieldMarkKind::Receiver); 90];
    let texts = picture_texts(&crowded);
    let place = |word: &str| texts.iter().position(|text| text.contains(word)).unwrap();
    assert!(place("names left out") > place("at −0.5"), "{texts:?}");
    assert!(texts.iter().filter(|text| *text == "receiver").count() == 1);
}
