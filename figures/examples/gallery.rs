//! Draws every figure from made-up data into the folder given as argument.

use std::error::Error;
use std::path::PathBuf;

use wellposed_figures::{
    Axis, Category, Curve, Direction, DirectionsFigure, FigureError, Format, GrowthFigure, Line,
    Look, Mark, Panel, PolarFigure, Spoke, SpokeStyle, Style, VerdictMap,
};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: gallery FOLDER")?;
    let folder = PathBuf::from(folder);
    std::fs::create_dir_all(&folder)?;
    let save = |name: &str, draw: &dyn Fn(Format) -> Result<Vec<u8>, FigureError>| {
        for (format, ending) in [(Format::Png, "png"), (Format::Svg, "svg")] {
            std::fs::write(folder.join(name).with_extension(ending), draw(format)?)?;
        }
        Ok::<(), Box<dyn Error>>(())
    };
    save("noncoaxiality", &|format| noncoaxiality().draw(format))?;
    save("every_verdict", &|format| every_verdict().draw(format))?;
    save("growth", &|format| growth().draw(format))?;
    save("polar", &|format| polar().draw(format))?;
    save("directions", &|format| directions().draw(format))
}

fn grid(from: f64, to: f64, points: usize) -> Vec<f64> {
    (0..points).map(|i| from + (to - from) * i as f64 / (points - 1) as f64).collect()
}

fn category(label: &str, look: Look) -> Category {
    Category { label: label.to_owned(), look }
}

/// A bound at 45° with growth that increases towards it.
fn noncoaxiality() -> VerdictMap {
    let (x, y) = (grid(-90.0, 90.0, 361), grid(1.0, 60.0, 237));
    let (mut cells, mut level) = (Vec::new(), Vec::new());
    for friction in &y {
        for delta in &x {
            let cos = (2.0 * delta).to_radians().cos();
            let sin = friction.to_radians().sin();
            cells.push(if delta.abs() == 45.0 { 2 } else { u8::from(delta.abs() > 45.0) });
            level.push(if delta.abs() > 45.0 {
                12.0 * (1.0 + 8.0 * sin) / cos.abs()
            } else {
                f64::NAN
            });
        }
    }
    let bound = |at: f64| Curve {
        label: "bound |Δ| = 45°".to_owned(),
        points: vec![[at, -10.0], [at, 100.0]],
    };
    VerdictMap {
        title: "Harris–Grekova model, ν = 0: where is it well-posed?".to_owned(),
        subtitle: "p = 10 kPa, ρ = 1600 kg/m³, Q = 1 s⁻¹, ψ = 30°, m/p = 0.1".to_owned(),
        x: Axis { label: "non-coaxiality Δ (°)".to_owned(), values: x },
        y: Axis { label: "friction angle φ (°)".to_owned(), values: y },
        categories: vec![
            category("well-posed", Look::WellPosed),
            category("ill-posed, order 1", Look::IllPosed),
            category("marginal", Look::Marginal),
        ],
        category: cells,
        level,
        level_label: "growth coefficient lim Re ς / k (m/s)".to_owned(),
        curves: vec![bound(-45.0), bound(45.0)],
    }
}

/// All looks on one map, with two orders of growth and levels over many decades.
fn every_verdict() -> VerdictMap {
    let (x, y) = (grid(-90.0, 90.0, 241), grid(0.0, 40.0, 161));
    let (mut cells, mut level) = (Vec::new(), Vec::new());
    for dilatancy in &y {
        for delta in &x {
            let radius = (delta / 60.0).hypot((dilatancy - 14.0) / 12.0);
            let (cell, value) = match () {
                () if *dilatancy > 34.0 => (6, f64::NAN),
                () if *delta > 62.0 => (4, f64::NAN),
                () if *delta < -66.0 => (5, f64::NAN),
                () if radius < 0.6 => (0, f64::NAN),
                () if radius < 0.63 => (3, f64::NAN),
                () if *delta > 0.0 => (1, 1e-2 * (9.0 * radius).exp()),
                () if radius > 1.7 => (2, f64::INFINITY),
                () => (2, 3.0 * (4.0 * radius).exp() * (1.2 + (0.1 * dilatancy).sin())),
            };
            cells.push(cell);
            level.push(value);
        }
    }
    let bound = |scale: f64, label: &str| {
        let point = |t: f64| {
            let (sin, cos) = t.to_radians().sin_cos();
            [60.0 * scale * cos, 14.0 + 12.0 * scale * sin]
        };
        let points = grid(0.0, 360.0, 181).into_iter().map(point).collect();
        Curve { label: label.to_owned(), points }
    };
    VerdictMap {
        title: "Dilatant domain: every answer the program can give".to_owned(),
        subtitle: "Made-up verdicts over non-coaxiality and dilatancy angle; φ = 35°, \
                   p = 10 kPa, ρ = 1600 kg/m³, Q = 1 s⁻¹"
            .to_owned(),
        x: Axis { label: "non-coaxiality Δ (°)".to_owned(), values: x },
        y: Axis { label: "dilatancy angle ν (°)".to_owned(), values: y },
        categories: vec![
            category("well-posed", Look::WellPosed),
            category("ill-posed, order 1", Look::IllPosed),
            category("ill-posed, order ½", Look::IllPosed),
            category("marginal", Look::Marginal),
            category("unbounded at finite k", Look::UnboundedAtFiniteWaveNumber),
            category("indeterminate", Look::Indeterminate),
            category("outside the model", Look::OutsideModel),
        ],
        category: cells,
        level,
        level_label: "growth coefficient lim Re ς / kᵐ (mᵐ/s)".to_owned(),
        curves: vec![bound(0.615, "bound in closed form"), bound(1.05, "sufficient condition")],
    }
}

fn growth() -> GrowthFigure {
    let angles = grid(0.0, 180.0, 361);
    let curve = |label: &str, f: &dyn Fn(f64) -> f64, at: &[f64]| Line {
        label: label.to_owned(),
        points: at.iter().map(|&x| [x, f(x)]).collect(),
    };
    let squared = |angle: f64, shift: f64| (2.0 * (angle - shift).to_radians()).cos();
    let numbers: Vec<f64> = grid(-2.0, 6.0, 161).into_iter().map(|e| 10_f64.powf(e)).collect();
    let models = ["Harris–Grekova", "double-shearing", "plastic potential", "free-rotating"];
    GrowthFigure {
        title: "Growth rate of plane waves, four models on one state".to_owned(),
        subtitle: "k = 10³ m⁻¹ on the left, ψ = 27.5° on the right; φ = 30°, ν = 0, Δ = 20°"
            .to_owned(),
        by_direction: Panel {
            x_label: "direction of the wave ψ (°)".to_owned(),
            y_label: "growth rate Re ς (1/s)".to_owned(),
            x_log: false,
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
            guides: Vec::new(),
            marks: [27.5, 57.5, 62.0, 152.5]
                .map(|x| Mark { label: format!("characteristic {x}°"), x })
                .to_vec(),
        },
        by_wave_number: Panel {
            x_label: "wave number k (1/m)".to_owned(),
            y_label: "growth rate Re ς (1/s)".to_owned(),
            x_log: true,
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
            guides: vec![curve("0.3 k^(3/4)", &|k| 0.3 * k.powf(0.75), &numbers)],
            marks: vec![Mark { label: "1/d, grain size".to_owned(), x: 1e3 }],
        },
    }
}

fn polar() -> PolarFigure {
    let GrowthFigure { title, by_direction, .. } = growth();
    let spoke = |label: &str, angle_deg, style| Spoke { label: label.to_owned(), angle_deg, style };
    PolarFigure {
        title,
        subtitle: "k = 10³ m⁻¹; φ = 30°, ν = 0, Δ = 20°".to_owned(),
        symbol: "Re ς".to_owned(),
        unit: "1/s".to_owned(),
        curves: by_direction.curves,
        spokes: vec![
            spoke("stress", 27.5, SpokeStyle::CharacteristicNormal),
            spoke("", 27.5, SpokeStyle::Degenerate),
            spoke("", 57.5, SpokeStyle::Degenerate),
            spoke("velocity", 152.5, SpokeStyle::CharacteristicNormal),
        ],
    }
}

fn directions() -> DirectionsFigure {
    let direction = |label: &str, angle_deg, multiplicity, style| Direction {
        label: label.to_owned(),
        angle_deg,
        multiplicity,
        style,
    };
    DirectionsFigure {
        title: "Characteristic directions of the steady equations".to_owned(),
        subtitle: "Harris–Grekova model, φ = 30°, ν = 0, ψ = 30°, Δ = 12°".to_owned(),
        directions: vec![
            direction("α", 0.0, 2, Style::Characteristic),
            direction("β", 60.0, 2, Style::Characteristic),
            direction("rotation", 72.0, 1, Style::Characteristic),
            direction("σ₁", 30.0, 1, Style::StressAxis),
            direction("σ₂", 120.0, 1, Style::StressAxis),
            direction("d₁", 42.0, 1, Style::DeformationAxis),
            direction("d₂", 132.0, 1, Style::DeformationAxis),
            direction("v", 74.0, 1, Style::Velocity),
        ],
    }
}
