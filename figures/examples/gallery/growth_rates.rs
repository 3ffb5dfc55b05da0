//! Example growth rates against wave number and direction.

use crate::sampling::sample_interval;
use wellposed_figures::{
    AxisMark, Direction, DirectionKind, DirectionsFigure, GrowthFigure, GrowthPanel, LabelledCurve,
    PolarFigure, Spoke, SpokeStyle,
};

pub fn build_growth_figure() -> GrowthFigure {
    let angles = sample_interval(0.0, 180.0, 361);
    let curve = |label: &str, f: &dyn Fn(f64) -> f64, at: &[f64]| LabelledCurve {
        label: label.to_owned(),
        points: at.iter().map(|&x| [x, f(x)]).collect(),
    };
    let squared = |angle: f64, shift: f64| (2.0 * (angle - shift).to_radians()).cos();
    let numbers: Vec<f64> =
        sample_interval(-2.0, 6.0, 161).into_iter().map(|e| 10_f64.powf(e)).collect();
    let models = ["Harris–Grekova", "double-shearing", "plastic potential", "free-rotating"];
    GrowthFigure {
        title: "Growth rate of plane waves, four models on one state".to_owned(),
        subtitle: "k = 10³ m⁻¹ on the left, ψ = 27.5° on the right; φ = 30°, ν = 0, Δ = 20°"
            .to_owned(),
        by_direction: GrowthPanel {
            x_label: "direction of the wave ψ (°)".to_owned(),
            y_label: "growth rate Re ς (1/s)".to_owned(),
            is_x_log: false,
            curves: vec![
                curve(models[0], &|a| -40.0 - 200.0 * squared(a, 30.0).powi(2), &angles),
                curve(models[1], &|a| 1e4 * squared(a, 12.0).abs().powi(3), &angles),
                curve(models[2], &|a| -1e6 * squared(a, 27.5), &angles),
                curve(
                    models[3],
                    &|a| if (70.0..80.0).contains(&a) { f64::NAN } else { -3.0 + squared(a, 60.0) },
                    &angles,
                ),
            ],
            reference_lines: Vec::new(),
            marks: [27.5, 57.5, 62.0, 152.5]
                .map(|x| AxisMark { label: format!("characteristic {x}°"), x })
                .to_vec(),
            is_measured: false,
        },
        by_wave_number: GrowthPanel {
            x_label: "wave number k (1/m)".to_owned(),
            y_label: "growth rate Re ς (1/s)".to_owned(),
            is_x_log: true,
            curves: vec![
                curve(models[0], &|k| 2.0 - 0.04 * k / (1.0 + 1e-4 * k), &numbers),
                curve(models[1], &|k| 0.3 * k.powf(0.75) - 1.0, &numbers),
                curve(
                    models[2],
                    &|k| if k > 3e5 { f64::INFINITY } else { -1e-6 * k * k },
                    &numbers,
                ),
                curve(models[3], &|k| -3.0 - 0.1 * k.sqrt(), &numbers),
            ],
            reference_lines: vec![curve("0.3 k^(3/4)", &|k| 0.3 * k.powf(0.75), &numbers)],
            marks: vec![AxisMark { label: "1/d, grain size".to_owned(), x: 1e3 }],
            is_measured: false,
        },
    }
}

pub fn build_polar_figure() -> PolarFigure {
    let GrowthFigure { title, by_direction, .. } = build_growth_figure();
    let spoke = |label: &str, angle_deg, style| Spoke { label: label.to_owned(), angle_deg, style };
    PolarFigure {
        title,
        subtitle: "k = 10³ m⁻¹; φ = 30°, ν = 0, Δ = 20°".to_owned(),
        symbol: "Re ς".to_owned(),
        unit: "1/s".to_owned(),
        curves: by_direction.curves,
        spokes: vec![
            spoke("stress", 27.5, SpokeStyle::CharacteristicNormal),
            spoke("", 27.5, SpokeStyle::DegenerateDirection),
            spoke("", 57.5, SpokeStyle::DegenerateDirection),
            spoke("velocity", 152.5, SpokeStyle::CharacteristicNormal),
        ],
    }
}

pub fn build_directions_figure() -> DirectionsFigure {
    let direction = |label: &str, angle_deg, multiplicity, style| Direction {
        label: label.to_owned(),
        angle_deg,
        multiplicity,
        kind: style,
    };
    DirectionsFigure {
        title: "Characteristic directions of the steady equations".to_owned(),
        subtitle: "Harris–Grekova model, φ = 30°, ν = 0, ψ = 30°, Δ = 12°".to_owned(),
        directions: vec![
            direction("α", 0.0, 2, DirectionKind::Characteristic),
            direction("β", 60.0, 2, DirectionKind::Characteristic),
            direction("rotation", 72.0, 1, DirectionKind::Characteristic),
            direction("σ₁", 30.0, 1, DirectionKind::StressAxis),
            direction("σ₂", 120.0, 1, DirectionKind::StressAxis),
            direction("d₁", 42.0, 1, DirectionKind::DeformationAxis),
            direction("d₂", 132.0, 1, DirectionKind::DeformationAxis),
            direction("v", 74.0, 1, DirectionKind::Velocity),
        ],
    }
}
