//! Band diagrams of a square lattice of masses and springs.

use std::f64::consts::{PI, SQRT_2};
use wellposed_figures::{BandFamily, BandFigure, BandStyle};

/// Samples the path Γ–X–M–Γ: distance along the path and phase shifts κ₁h, κ₂h of each point.
fn sample_path() -> Vec<(f64, [f64; 2])> {
    let sides: [([f64; 2], [f64; 2]); 3] =
        [([0.0, 0.0], [PI, 0.0]), ([PI, 0.0], [PI, PI]), ([PI, PI], [0.0, 0.0])];
    let (mut points, mut distance) = (Vec::new(), 0.0);
    for (start, end) in sides {
        let length: f64 = (end[0] - start[0]).hypot(end[1] - start[1]);
        points.extend((0..=40).map(|step| {
            let share = f64::from(step) / 40.0;
            let at = [0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis]));
            (distance + share * length, at)
        }));
        distance += length;
    }
    points
}

/// Builds the band diagram of two lattices with springs along and across the links, below and above a band gap, with
/// the long waves of the continuum and, if `is_damped`, decay rates in proportion to the squared frequency.
pub(crate) fn build_band_figure(is_damped: bool) -> BandFigure {
    let path = sample_path();
    let curve = |value: &dyn Fn([f64; 2]) -> f64| -> Vec<[f64; 2]> {
        path.iter().map(|(distance, at)| [*distance, value(*at)]).collect()
    };
    let square = |[x, y]: [f64; 2], along: f64, across: f64| {
        along * (0.5 * x).sin().powi(2) + across * (0.5 * y).sin().powi(2)
    };
    let acoustic =
        |along: f64, across: f64| move |at: [f64; 2]| 8.0 * square(at, along, across).sqrt();
    let optical = |along: f64, across: f64| {
        move |at: [f64; 2]| (900.0 - 60.0 * square(at, along, across)).sqrt()
    };
    let longitudinal = vec![curve(&acoustic(1.0, 0.3)), curve(&optical(1.0, 0.3))];
    let transverse = vec![curve(&acoustic(0.3, 1.0)), curve(&optical(0.2, 0.6))];
    let continuum = vec![
        curve(&|[x, y]| 4.0 * (x * x + 0.3 * y * y).sqrt()),
        curve(&|[x, y]| 4.0 * (0.3 * x * x + y * y).sqrt()),
    ];
    let family = |label: &str, style, curves: Vec<Vec<[f64; 2]>>| BandFamily {
        label: label.to_owned(),
        style,
        curves,
    };
    let decay = |curves: &[Vec<[f64; 2]>]| {
        curves.iter().map(|own| own.iter().map(|&[x, y]| [x, 1e-3 * y * y]).collect()).collect()
    };
    BandFigure {
        title: "Square lattice of masses".to_owned(),
        subtitle: "springs along the links, softer springs across them".to_owned(),
        path_label: "wave vector κ".to_owned(),
        frequency_label: "frequency f (kHz)".to_owned(),
        decay_label: "decay rate (1/ms)".to_owned(),
        vertices: [(0.0, "Γ"), (PI, "X"), (2.0 * PI, "M"), ((2.0 + SQRT_2) * PI, "Γ")]
            .map(|(x, name)| (x, name.to_owned()))
            .to_vec(),
        decay_rates: match is_damped {
            true => vec![
                family("", BandStyle::FirstFamily, decay(&longitudinal)),
                family("", BandStyle::SecondFamily, decay(&transverse)),
            ],
            false => Vec::new(),
        },
        frequencies: vec![
            family("P-like", BandStyle::FirstFamily, longitudinal),
            family("S-like", BandStyle::SecondFamily, transverse),
            family("continuum", BandStyle::Comparison, continuum),
        ],
        gaps: vec![[9.13, 28.6]],
        gap_label: "no waves".to_owned(),
        gap_unit: "kHz".to_owned(),
    }
}
