//! Draws every figure from made-up data into the folder given as argument.

use std::error::Error;
use std::path::PathBuf;

use wellposed_figures::{
    Axis, Band, Branch, Category, Curve, Direction, DirectionsFigure, DispersionFigure, FieldAxis,
    FieldFigure, FieldMark, FieldMarkKind, FigureError, Format, GrowthFigure, LedgerFigure,
    LedgerTerm, Level, Line, Look, Mark, Panel, PolarFigure, Response, SeismogramFigure,
    SeismogramPanel, SpeedCurve, SpeedsFigure, SphereFigure, SphereMark, Spoke, SpokeStyle, Style,
    Trace, Vanishing, VerdictMap, animate,
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
    save("directions", &|format| directions().draw(format))?;
    save("dispersion", &|format| dispersion(false).draw(format))?;
    save("dispersion_growth", &|format| dispersion(true).draw(format))?;
    save("field_wave", &|format| field_wave().draw(format))?;
    save("field_materials", &|format| field_materials().draw(format))?;
    save("field_bar", &|format| field_bar().draw(format))?;
    save("field_curves", &|format| field_curves().draw(format))?;
    save("field_hill", &|format| field_hill().draw(format))?;
    save("seismogram", &|format| seismogram([6, 3], 4_000).draw(format))?;
    save("seismogram_long", &|format| seismogram([3, 10], 1_000_000).draw(format))?;
    save("ledger", &|format| ledger(true).draw(format))?;
    save("ledger_residual", &|format| ledger(false).draw(format))?;
    let frames: Vec<FieldFigure> = grid(0.0, 0.4, 25).into_iter().map(moving).collect();
    std::fs::write(folder.join("wave.gif"), animate(&frames, 0.08, 800)?)?;
    save("speeds", &|format| speeds().draw(format))?;
    save("sphere", &|format| sphere(false).draw(format))?;
    save("sphere_growth", &|format| sphere(true).draw(format))
}

fn grid(from: f64, to: f64, points: usize) -> Vec<f64> {
    (0..points).map(|i| from + (to - from) * i as f64 / (points - 1) as f64).collect()
}

fn category(label: &str, look: Look) -> Category {
    Category { label: label.to_owned(), look }
}

/// A field of square cells, one per metre divided by `per_metre`.
fn field(cells: [usize; 2], per_metre: f64, value: impl Fn(f64, f64) -> f64) -> FieldFigure {
    let axis = |label: &str, cells: usize| FieldAxis {
        label: label.to_owned(),
        from: 0.0,
        to: cells as f64 / per_metre,
    };
    let [columns, rows] = cells;
    let place = |index: usize| (index as f64 + 0.5) / per_metre;
    FieldFigure {
        title: "Velocity at the end".to_owned(),
        subtitle: "t = 0.25 s, plane z = 0".to_owned(),
        x: axis("x (m)", columns),
        y: axis("height y (m)", rows),
        columns,
        rows,
        values: (0..columns * rows)
            .map(|cell| value(place(cell % columns), place(cell / columns)))
            .collect(),
        label: "velocity v₂ (m/s)".to_owned(),
        is_signed: true,
        limit: None,
        scale: None,
        curves: None,
        outlines: Vec::new(),
        plastic: Vec::new(),
        marks: Vec::new(),
    }
}

fn field_mark(x: f64, y: f64, name: &str, kind: FieldMarkKind) -> FieldMark {
    FieldMark { at: [x, y], name: name.to_owned(), kind }
}

/// A wave that radiates from a point, with colours that end below its largest value.
fn field_wave() -> FieldFigure {
    let wave = field([1000, 1000], 10.0, |x, y| {
        let r = (x - 40.0).hypot(y - 50.0);
        let envelope = (-((r - 28.0) / 11.0).powi(2)).exp();
        0.031 * (0.9 * r).sin() * envelope * (y - 50.0) / r.max(1.0)
    });
    let marks = vec![
        field_mark(40.0, 50.0, "shot", FieldMarkKind::Source),
        field_mark(60.0, 50.0, "R1", FieldMarkKind::Receiver),
        field_mark(80.0, 50.0, "R2", FieldMarkKind::Receiver),
        field_mark(82.0, 51.0, "R3, beside R2", FieldMarkKind::Receiver),
        field_mark(100.0, 100.0, "corner", FieldMarkKind::Receiver),
        field_mark(120.0, 50.0, "too far", FieldMarkKind::Receiver),
    ];
    FieldFigure { limit: Some(0.02), marks, ..wave }
}

/// Two materials, of which one yields, and some cells that have lost their value.
fn field_materials() -> FieldFigure {
    let upper = |x: f64, y: f64| y > 4.0 + 0.1 * x;
    let mut figure = field([240, 120], 10.0, |x, y| {
        let r = (x - 9.0).hypot(y - 6.0);
        let strength = if upper(x, y) { 1e6 } else { 4.5e5 };
        let is_lost = (x - 21.5).abs() < 0.8 && (y - 9.5).abs() < 0.5;
        if is_lost {
            f64::NAN
        } else {
            strength * (1.4 * x + 0.4 * y).sin() * (-0.02 * r * r).exp()
        }
    });
    figure.outlines = (0..240 * 120)
        .map(|cell| u16::from(upper(0.1 * (cell % 240) as f64, 0.1 * (cell / 240) as f64)))
        .collect();
    figure.plastic = figure.values.iter().map(|value| value.abs() > 6.2e5).collect();
    figure.title = "Stress of two materials".to_owned();
    figure.label = "shear stress σ₁₂ (Pa)".to_owned();
    figure.marks = vec![
        field_mark(9.0, 6.0, "plate", FieldMarkKind::Source),
        field_mark(18.0, 6.0, "gauge 4", FieldMarkKind::Receiver),
    ];
    figure
}

/// A domain too long to be drawn to scale.
fn field_bar() -> FieldFigure {
    let mut bar = field([900, 4], 10.0, |x, _| (0.3 * x).sin().powi(2) * (-0.05 * x).exp());
    let ends = [("foot", 0.0), ("tip", 90.0)];
    let marks = ends.map(|(name, x)| field_mark(x, 0.2, name, FieldMarkKind::Receiver)).to_vec();
    bar.title = "Energy along a bar".to_owned();
    FieldFigure { label: "energy density (J/m³)".to_owned(), is_signed: false, marks, ..bar }
}

/// The stress around a crack with lines of equal value that carry their numbers.
fn field_curves() -> FieldFigure {
    let mut figure = field([300, 200], 10.0, |x, y| {
        let (x, y) = (x - 15.0, y - 10.0);
        let ends = [-4.0, 4.0].map(|end: f64| (x - end) / (1.0 + (x - end).powi(2) + y * y));
        6e4 * (ends[1] - ends[0]) * (1.0 + 0.2 * (0.7 * y).sin()) + 400.0 * x
    });
    figure.title = "Stress around a crack".to_owned();
    figure.label = "shear stress σ₁₂ (Pa)".to_owned();
    figure.curves = Some([-4e4, -2e4, -1e4, -5e3, -2e3, 0.0, 2e3, 5e3, 1e4, 2e4].to_vec());
    figure.marks = vec![
        field_mark(11.0, 10.0, "left tip", FieldMarkKind::Receiver),
        field_mark(19.0, 10.0, "right tip", FieldMarkKind::Receiver),
    ];
    figure
}

/// A quantity without a sign with its lines of equal value.
fn field_hill() -> FieldFigure {
    let figure = field([160, 160], 10.0, |x, y| {
        let hill =
            |a: f64, b: f64, width: f64| (-((x - a).powi(2) + (y - b).powi(2)) / width).exp();
        hill(5.0, 6.0, 14.0) + 0.6 * hill(11.0, 11.0, 9.0)
    });
    FieldFigure {
        title: "Energy of two shots".to_owned(),
        label: "energy density (J/m³)".to_owned(),
        is_signed: false,
        curves: Some((1..10).map(|tenth| 0.1 * f64::from(tenth)).collect()),
        ..figure
    }
}

/// A frame of a wave that comes from a point and is thrown back by a stiffer half.
fn moving(time: f64) -> FieldFigure {
    let pulse = |phase: f64| phase.sin() * (-0.06 * phase * phase).exp();
    let wave = field([300, 180], 10.0, |x, y| {
        let distance = |from: f64| (x - from).hypot(y - 9.0);
        let of =
            |from: f64| pulse(2.2 * (distance(from) - 55.0 * time)) / (1.0 + 0.2 * distance(from));
        let shown = if x < 20.0 { of(10.0) - 0.6 * of(30.0) } else { 0.5 * of(10.0) };
        0.01 * shown
    });
    let marks = vec![
        field_mark(10.0, 9.0, "shot", FieldMarkKind::Source),
        field_mark(17.0, 9.0, "R1", FieldMarkKind::Receiver),
        field_mark(24.0, 14.0, "R2", FieldMarkKind::Receiver),
    ];
    FieldFigure {
        title: "A wave meets a stiffer half".to_owned(),
        subtitle: format!("t = {time:.3} s"),
        scale: Some(0.003),
        outlines: (0..300 * 180).map(|cell| u16::from(cell % 300 >= 200)).collect(),
        plastic: wave.values.iter().map(|value| value.abs() > 0.0025).collect(),
        marks,
        ..wave
    }
}

/// Pulses at receivers; the last quantity does not move, one receiver fails.
fn seismogram([panels, receivers]: [usize; 2], samples: usize) -> SeismogramFigure {
    let labels = [
        "velocity v₁, m/s",
        "velocity v₂, m/s",
        "stress σ₁₁, Pa",
        "stress σ₁₂, Pa",
        "rotation rate Ω₃, 1/s",
        "couple stress μ₃₁, N/m",
    ];
    let times = grid(0.0, 0.8, samples);
    let sizes = [3e-3, 1.4e-3, 2.2e4, 9e3, 4e-7, 0.0];
    let value = |panel: usize, receiver: usize, time: f64| {
        let arrival = 0.12 + 0.11 * receiver as f64;
        let beats = if samples > 100_000 { 4000.0 } else { 90.0 };
        let since = time - arrival;
        let offset = if panel == 2 { -5e4 } else { 0.0 };
        if receiver == 2 && (0.55..0.6).contains(&time) {
            f64::NAN
        } else if since < 0.0 {
            offset
        } else {
            let decay = (-9.0 * since).exp() / (1.0 + 0.5 * receiver as f64);
            offset + sizes[panel] * decay * (beats * since + panel as f64).sin()
        }
    };
    let trace = |panel: usize, receiver: usize| Trace {
        name: format!("receiver R{}", receiver + 1),
        values: times.iter().map(|time| value(panel, receiver, *time)).collect(),
    };
    let panel = |panel: usize| SeismogramPanel {
        label: labels[if panels < 6 && panel == 2 { 5 } else { panel }].to_owned(),
        traces: (0..receivers)
            .map(|receiver| trace(if panels < 6 && panel == 2 { 5 } else { panel }, receiver))
            .collect(),
    };
    SeismogramFigure {
        title: "What the receivers record".to_owned(),
        subtitle: "Cosserat solid, 400 × 300 cells".to_owned(),
        time_label: "time t, s".to_owned(),
        panels: (0..panels).map(panel).collect(),
        times,
    }
}

/// Energies of a shot in a yielding solid, with a balance of percents or a residual.
fn ledger(is_coarse: bool) -> LedgerFigure {
    let times = grid(0.0, 0.5, 2_000);
    let term = |name: &str, value: &dyn Fn(f64) -> f64| LedgerTerm {
        name: name.to_owned(),
        values: times.iter().map(|time| value(*time)).collect(),
    };
    let came = |t: f64| 3200.0 * (1.0 - (-30.0 * t).exp());
    let left = |t: f64| -900.0 * (t - 0.3).max(0.0) / 0.2;
    let lost = |t: f64| 1.0 - (-4.0 * t).exp();
    let swings = |t: f64| 0.5 + 0.5 * (60.0 * t).cos() * (-9.0 * t).exp();
    let all = |t: f64| came(t) + left(t) - 1300.0 * lost(t) - 160.0 * t;
    let balance = if is_coarse {
        term("balance, share of the largest energy", &|t| 0.03 * lost(t))
    } else {
        term("residual, share of the largest energy", &|t| {
            2e-13 * t.sqrt() * ((1e5 * t).sin() + (3e4 * t * t).sin())
        })
    };
    LedgerFigure {
        title: "Where the energy goes".to_owned(),
        subtitle: "Cosserat solid, 400 × 300 cells".to_owned(),
        time_label: "time t, s".to_owned(),
        label: "energy, J/m".to_owned(),
        terms: vec![
            term("kinetic", &|t| all(t) * swings(t)),
            term("stored", &|t| all(t) * (1.0 - swings(t))),
            term("work of the sides", &left),
            term("work of the sources", &came),
            term("released by the initial stress", &|t| 220.0 * t),
            term("plastic dissipation", &|t| 1300.0 * lost(t)),
            term("dissipation of the scheme", &|t| 160.0 * t),
        ],
        times: times.clone(),
        balance,
    }
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

/// Waves in an elastic Cosserat medium; with made-up growth of the transverse ones on logarithmic
/// axes where asked for.
fn dispersion(growing: bool) -> DispersionFigure {
    let [rho, lambda, mu, alpha] = [2700.0, 8.1e9, 8.1e9, 1.005e9_f64];
    let [j, beta, gamma, eta] = [2700.0, 7.75e8, 1.5e8, 3e8_f64];
    let longitudinal = ((lambda + 2.0 * mu) / rho).sqrt();
    let cutoff = (4.0 * alpha / j).sqrt();
    let torsion = |k: f64| (((beta + 2.0 * gamma) * k * k + 4.0 * alpha) / j).sqrt();
    let transverse = move |k: f64, upper: bool| {
        let (shear, bending) = ((mu + alpha) * k * k, (gamma + eta) * k * k);
        let half = 0.5 * (rho * (bending + 4.0 * alpha) + j * shear) / (rho * j);
        let product = (shear * bending + 4.0 * alpha * mu * k * k) / (rho * j);
        let root = (half * half - product).max(0.0).sqrt();
        // Without cancellation for long waves.
        if upper { (half + root).sqrt() } else { (product / (half + root)).sqrt() }
    };
    let numbers: Vec<f64> = if growing {
        grid(-2.0, 2.0, 401).into_iter().map(|exponent| 10_f64.powf(exponent)).collect()
    } else {
        grid(0.0, 3.0, 401)
    };
    let branch = |label: &str, omega: &dyn Fn(f64) -> f64, growth: &dyn Fn(f64) -> f64| {
        let slope = |k: f64| {
            let step = 1e-4 * k.max(1e-3);
            let below = (k - step).max(0.0);
            (omega(k + step) - omega(below)) / (k + step - below)
        };
        let over = |f: &dyn Fn(f64) -> f64| numbers.iter().map(|&k| [k, f(k)]).collect();
        Branch {
            label: label.to_owned(),
            frequency: over(omega),
            group_speed: over(&slope),
            measured: over(omega).into_iter().skip(20).step_by(60).collect(),
            growth: if growing { over(growth) } else { Vec::new() },
        }
    };
    let level = |label: String, value: f64| Level { label, value };
    let speeds = [
        ("cₚ", longitudinal),
        ("√((μ+α)/ρ)", ((mu + alpha) / rho).sqrt()),
        ("cₛ", (mu / rho).sqrt()),
        ("√((γ+η)/j)", ((gamma + eta) / j).sqrt()),
        ("√((β+2γ)/j)", ((beta + 2.0 * gamma) / j).sqrt()),
    ];
    DispersionFigure {
        title: "Plane waves in an elastic Cosserat medium".to_owned(),
        subtitle: "ρ = j = 2700, λ = μ = 8.1×10⁹ Pa, α = 1.005×10⁹ Pa, β = 7.75×10⁸ N, \
                   γ = 1.5×10⁸ N, η = 3×10⁸ N"
            .to_owned(),
        k_label: "wave number k (1/m)".to_owned(),
        frequency_label: "angular frequency ω (rad/s)".to_owned(),
        speed_label: "speed (m/s)".to_owned(),
        growth_label: "growth rate Re ς (1/s)".to_owned(),
        k_log: growing,
        frequency_log: growing,
        branches: vec![
            branch("longitudinal", &|k| longitudinal * k, &|_| -2.0),
            branch("torsion", &torsion, &|k| -0.5 * k),
            branch("transverse, slow (double)", &|k| transverse(k, false), &|k| {
                90.0 * k * k / (1.0 + k * k) - 20.0
            }),
            branch("transverse, fast (double)", &|k| transverse(k, true), &|k| -30.0 * k.sqrt()),
        ],
        bands: vec![Band {
            label: "forbidden band of rotational waves".to_owned(),
            from: if growing { 600.0 } else { 0.0 },
            to: cutoff,
        }],
        cutoffs: vec![level(format!("ω* = {cutoff:.0} rad/s"), cutoff)],
        speed_limits: speeds.map(|(symbol, value)| level(symbol.to_owned(), value)).to_vec(),
    }
}

/// Speeds of a solid that loses hyperbolicity in two directions and flutters in sectors.
fn speeds() -> SpeedsFigure {
    let angles = grid(0.0, 180.0, 721);
    let curve = |label: &str, response, multiplicity, f: &dyn Fn(f64) -> f64| SpeedCurve {
        label: label.to_owned(),
        points: angles.iter().map(|&angle| [angle, f(angle)]).collect(),
        response,
        multiplicity,
    };
    let wave = |angle: f64| (2.0 * (angle - 12.0)).to_radians().cos();
    // Two speeds that meet where their squares would become complex.
    let gap = |angle: f64| (0.55 - wave(angle)).max(0.0).sqrt();
    let pair = |angle: f64, sign: f64| 620.0 + 60.0 * wave(angle) + sign * 150.0 * gap(angle);
    let (elastic, yielding) = (Response::Elastic, Response::Yielding);
    SpeedsFigure {
        title: "Characteristic speeds in the plane of shear".to_owned(),
        subtitle: "Cosserat solid, ρ = 2700 kg/m³, h = 0.08 μ, φ = 35°, ν = 5°".to_owned(),
        speed_label: "characteristic speed c".to_owned(),
        unit: "m/s".to_owned(),
        curves: vec![
            curve("elastic solid", elastic, 1, &|_| 3000.0),
            curve("elastic solid", elastic, 2, &|_| 1836.0),
            curve("elastic solid", elastic, 1, &|_| 631.0),
            curve("yielding: quasi-longitudinal", yielding, 1, &|a| {
                2750.0 - 190.0 * wave(a + 20.0)
            }),
            curve("yielding: quasi-transverse", yielding, 1, &|a| {
                900.0 * ((2.0 * (a - 90.0)).to_radians().cos() - 57_f64.to_radians().cos()).abs()
            }),
            curve("yielding: out of plane", yielding, 2, &|_| 1650.0),
            curve("yielding: rotational", yielding, 1, &|a| pair(a, 1.0)),
            curve("yielding: rotational", yielding, 1, &|a| pair(a, -1.0)),
        ],
        flutter: vec![[-16.2, 40.2]],
        imaginary: vec![[61.5, 118.5]],
        vanishing: vec![
            Vanishing { label: "shear band".to_owned(), angle_deg: 61.5 },
            Vanishing { label: "shear band".to_owned(), angle_deg: 118.5 },
        ],
    }
}

/// The slowest speed over all normals, or the growth where speeds are complex.
fn sphere(growing: bool) -> SphereFigure {
    let (polar, azimuth) = (grid(0.0, 90.0, 91), grid(0.0, 360.0, 361));
    let band = [0.62_f64, 0.0, 0.785];
    let worst = [0.35_f64, 0.75, 0.561];
    let mut values = Vec::new();
    for theta in &polar {
        for phi in &azimuth {
            let (sin, cos) = theta.to_radians().sin_cos();
            let n = [sin * phi.to_radians().cos(), sin * phi.to_radians().sin(), cos];
            let along = |m: [f64; 3]| m.iter().zip(n).map(|(a, b)| a * b).sum::<f64>().powi(2);
            values.push(if growing {
                let level = along(worst) + 0.2 * n[1] * n[1] - 0.75;
                if level > 0.0 { 900.0 * level.sqrt() } else { f64::NAN }
            } else {
                (1.0 - 0.96 * along(band).powi(3) - 0.2 * n[1] * n[1]).max(0.0).sqrt()
            });
        }
    }
    let mark = |label: &str, normal| SphereMark { label: label.to_owned(), normal };
    let mut marks = vec![mark("normal of the shear band", band)];
    if growing {
        marks.push(mark("worst flutter", worst));
        marks.push(mark("intermediate stress axis", [0.0, 1.0, 0.0]));
    }
    let label = if growing {
        "growth rate per wave number |Im c| (m/s)"
    } else {
        "slowest speed, yielding to elastic c/c₀ (1)"
    };
    SphereFigure {
        title: if growing { "Flutter over all wave normals" } else { "Loss of hyperbolicity" }
            .to_owned(),
        subtitle: "Cosserat solid, ρ = 2700 kg/m³, h = 0.08 μ, φ = 35°, ν = 5°".to_owned(),
        polar_deg: polar,
        azimuth_deg: azimuth,
        values,
        value_label: label.to_owned(),
        value_log: false,
        dark_is_low: !growing,
        missing_label: "all speeds are real".to_owned(),
        marks,
    }
}
