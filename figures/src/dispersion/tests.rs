//! Tests of dispersion figures.

use super::figure::{DispersionBranch, DispersionFigure, FrequencyBand, ReferenceLevel};
use crate::picture::Point;

use crate::tests::{check_drawing, edge_case_curves};

fn sample_figure(points: &[[f64; 2]], levels: &[f64], log: bool) -> DispersionFigure {
    let branch = |index: usize| DispersionBranch {
        label: format!("branch {index}"),
        frequency: points.to_vec(),
        group_speed: points.to_vec(),
        measured_frequency: points.to_vec(),
        disagreeing_frequency: points.iter().step_by(2).copied().collect(),
        growth_rate: points.to_vec(),
    };
    let level = |&value: &f64| ReferenceLevel { label: format!("ω* = {value} rad/s"), value };
    let band = |pair: &[f64]| FrequencyBand {
        label: "band gap".to_owned(),
        low: pair[0],
        high: pair[pair.len() - 1],
    };
    DispersionFigure {
        title: "Title".to_owned(),
        subtitle: "subtitle".to_owned(),
        wave_number_label: "wave number k (1/m)".to_owned(),
        frequency_label: "frequency ω (rad/s)".to_owned(),
        speed_label: "speed (m/s)".to_owned(),
        growth_label: "growth rate Re ς (1/s)".to_owned(),
        is_wave_number_log: log,
        is_frequency_log: log,
        branches: (0..3).map(branch).collect(),
        bands: levels.chunks(2).map(band).collect(),
        cutoffs: levels.iter().map(level).collect(),
        speed_limits: levels.iter().map(level).collect(),
    }
}

fn check_figure(figure: &DispersionFigure) {
    check_drawing(&figure.to_picture(), |format| figure.draw(format));
}

#[test]
fn any_points_are_drawn() {
    for points in edge_case_curves() {
        for log in [false, true] {
            check_figure(&sample_figure(&points, &[1.0, 3.0], log));
        }
    }
}

#[test]
fn level_labels_do_not_overlap() {
    let points = [[0.1, 1.0], [10.0, 100.0], [20.0, 110.0]];
    let sets: [&[f64]; 4] = [
        &[],
        &[f64::NAN, f64::INFINITY, -3.0, 0.0],
        &[50.0, 50.0, 50.1, 50.2, 51.0, 110.0],
        &[100.0, 20.0, 20.0, f64::INFINITY],
    ];
    for levels in sets {
        check_figure(&sample_figure(&points, levels, false));
        check_figure(&sample_figure(&points, levels, true));
    }
    let mut long = sample_figure(&points, &[20.0, 60.0], false);
    for text in [&mut long.cutoffs[0].label, &mut long.bands[0].label, &mut long.wave_number_label]
    {
        *text = "a frequency of some kind ".repeat(30);
    }
    long.branches = (0..30).map(|index| long.branches[index % 3].clone()).collect();
    check_figure(&long);
    long.branches.clear();
    check_figure(&long);
}

#[test]
fn phase_speeds_near_a_cutoff_do_not_stretch_the_axis() {
    let points: Vec<Point> =
        (1..=1000).map(|i| 0.01 * f64::from(i)).map(|k| [k, (100.0 + k * k).sqrt()]).collect();
    let mut figure = sample_figure(&points, &[], false);
    for branch in &mut figure.branches {
        branch.group_speed = points.iter().map(|&[k, omega]| [k, k / omega]).collect();
    }
    let [_, _, speed, _] = figure.axis_scales();
    assert!(speed.high > 1.4 && speed.high < 2.0 && speed.low == 0.0, "{}", speed.high);
}

/// The legend lists what is drawn: no levels that are infinite or, on a logarithmic axis, not positive.
#[test]
fn legend_lists_drawn_levels_only() {
    let listed = |levels: &[f64], log: bool| {
        let figure = sample_figure(&[[0.1, 1.0], [10.0, 100.0]], levels, log);
        let picture = figure.to_picture();
        let has = |name: &str| picture.texts().any(|text| text.content == name);
        [has("cut-off frequency"), has("limit of the speed as k → ∞")]
    };
    assert_eq!(listed(&[3.0], true), [true, true]);
    assert_eq!(listed(&[0.0], true), [false, true]);
    assert_eq!(listed(&[f64::INFINITY, f64::NAN], false), [false, false]);
    assert_eq!(listed(&[], false), [false, false]);
}

/// Branches of figures without group speeds differ in colour, dashes or width, so that coincident ones stay visible.
#[test]
fn branches_without_group_speeds_have_distinct_styles() {
    let mut figure = sample_figure(&[[0.1, 1.0], [10.0, 100.0]], &[], false);
    figure.branches = (0..10).map(|index| figure.branches[index % 3].clone()).collect();
    for branch in &mut figure.branches {
        branch.group_speed.clear();
    }
    let styles: Vec<_> = (0..10).map(|branch| figure.branch_style(branch)).collect();
    for (index, one) in styles.iter().enumerate() {
        for other in &styles[..index] {
            let is_same =
                (one.dashes, one.width, one.colour) == (other.dashes, other.width, other.colour);
            assert!(!is_same, "{index}");
        }
        let dashes = [&styles[0], one].map(|own| (own.dashes, own.width));
        assert!(index == 0 || index >= 8 || dashes[0] != dashes[1], "{index}");
    }
}

/// Neutral branches, at zero frequency, are above the lower edge of the frame.
#[test]
fn neutral_branches_are_inside_the_frame() {
    let mut figure = sample_figure(&[[0.1, 1.0], [10.0, 100.0]], &[], false);
    let lows = |figure: &DispersionFigure| {
        let [_, frequency, speed, _] = figure.axis_scales();
        [frequency.low, speed.low]
    };
    assert_eq!(lows(&figure), [0.0, 0.0]);
    figure.branches[1].frequency = vec![[0.1, 0.0], [10.0, 0.0]];
    assert!(lows(&figure).iter().all(|low| *low < 0.0), "{:?}", lows(&figure));
}

/// Branches that coincide share the disc of their numbers.
#[test]
fn coincident_branches_share_their_numbers() {
    let mut figure = sample_figure(&[[0.0, 0.0], [1.0, 2.0], [2.0, 3.0]], &[], false);
    for branch in &mut figure.branches {
        branch.group_speed.clear();
        branch.growth_rate.clear();
        branch.measured_frequency.clear();
        branch.disagreeing_frequency.clear();
    }
    figure.branches[1].frequency = vec![[0.0, 0.5], [1.0, 3.0], [2.0, 5.0]];
    let picture = figure.to_picture();
    let count = |text: &str| picture.texts().filter(|own| own.content == text).count();
    // In both panels the pair and the single number; each number once in the legend.
    assert_eq!([count("1, 3"), count("1"), count("2"), count("3")], [2, 1, 3, 1]);
}

/// Both panels have the same ticks of the wave number, although only one has labels of levels beside it.
#[test]
fn panels_beside_each_other_have_the_same_ticks() {
    let mut figure = sample_figure(&[[0.0, 1200.0], [1.2, 1500.0]], &[1220.0], false);
    figure.speed_limits.clear();
    figure.branches[0].group_speed = vec![[0.0, 3.0], [1.2, 4.0]];
    let picture = figure.to_picture();
    let count = |text: &str| picture.texts().filter(|own| own.content == text).count();
    assert_eq!((count("0.5"), count("1.0")), (2, 2));
}
