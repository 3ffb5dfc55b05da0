//! Example fields: waves, materials, a bar and the frames of an animation.

use wellposed_figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind, FieldPairFigure};

/// Builds a field of square cells with edge 1/`cells_per_metre` m; `value` is evaluated at cell centres.
fn build_field(
    cells: [usize; 2],
    cells_per_metre: f64,
    value: impl Fn(f64, f64) -> f64,
) -> FieldFigure {
    let axis = |label: &str, cells: usize| FieldAxis {
        label: label.to_owned(),
        start: 0.0,
        end: cells as f64 / cells_per_metre,
    };
    let [columns, rows] = cells;
    let place = |index: usize| (index as f64 + 0.5) / cells_per_metre;
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
        ..FieldFigure::default()
    }
}

fn build_mark(x: f64, y: f64, name: &str, kind: FieldMarkKind) -> FieldMark {
    FieldMark { position: [x, y], name: name.to_owned(), kind }
}

/// Builds the coarse means of two waves, of which the lower has two thirds of the amplitude.
pub fn build_field_pair() -> FieldPairFigure {
    let build = |title: &str, amplitude: f64| FieldFigure {
        title: title.to_owned(),
        is_signed: true,
        contour_levels: Some(Vec::new()),
        ..build_field([60, 30], 10.0, |x, y| {
            let r = (x - 3.0).hypot(y - 3.0);
            amplitude * (4.0 * r).sin() * (-(r - 1.5).powi(2)).exp()
        })
    };
    FieldPairFigure { upper: build("Blocks", 0.03), lower: build("Continuum", 0.02) }
}

/// Builds a wave radiated from a point; the colour scale is clipped below the largest value.
pub fn build_wave_field() -> FieldFigure {
    let wave = build_field([1000, 1000], 10.0, |x, y| {
        let r = (x - 40.0).hypot(y - 50.0);
        let envelope = (-((r - 28.0) / 11.0).powi(2)).exp();
        0.031 * (0.9 * r).sin() * envelope * (y - 50.0) / r.max(1.0)
    });
    let marks = vec![
        build_mark(40.0, 50.0, "shot", FieldMarkKind::Source),
        build_mark(60.0, 50.0, "R1", FieldMarkKind::Receiver),
        build_mark(80.0, 50.0, "R2", FieldMarkKind::Receiver),
        build_mark(82.0, 51.0, "R3, beside R2", FieldMarkKind::Receiver),
        build_mark(100.0, 100.0, "corner", FieldMarkKind::Receiver),
        build_mark(120.0, 50.0, "too far", FieldMarkKind::Receiver),
    ];
    FieldFigure { limit: Some(0.02), marks, ..wave }
}

/// Builds a stress field in two materials, one of which yields, with some NaN cells.
pub fn build_two_material_field() -> FieldFigure {
    let upper = |x: f64, y: f64| y > 4.0 + 0.1 * x;
    let mut figure = build_field([240, 120], 10.0, |x, y| {
        let r = (x - 9.0).hypot(y - 6.0);
        let strength = if upper(x, y) { 1e6 } else { 4.5e5 };
        let is_missing = (x - 21.5).abs() < 0.8 && (y - 9.5).abs() < 0.5;
        if is_missing {
            f64::NAN
        } else {
            strength * (1.4 * x + 0.4 * y).sin() * (-0.02 * r * r).exp()
        }
    });
    figure.material_indices = (0..240 * 120)
        .map(|cell| u16::from(upper(0.1 * (cell % 240) as f64, 0.1 * (cell / 240) as f64)))
        .collect();
    figure.has_yielded = figure.values.iter().map(|value| value.abs() > 6.2e5).collect();
    figure.title = "Stress of two materials".to_owned();
    figure.label = "shear stress σ₁₂ (Pa)".to_owned();
    figure.marks = vec![
        build_mark(9.0, 6.0, "plate", FieldMarkKind::Source),
        build_mark(18.0, 6.0, "gauge 4", FieldMarkKind::Receiver),
    ];
    figure
}

/// Builds a field whose domain is too elongated to be drawn to scale.
pub fn build_bar_field() -> FieldFigure {
    let mut bar = build_field([900, 4], 10.0, |x, _| (0.3 * x).sin().powi(2) * (-0.05 * x).exp());
    let ends = [("foot", 0.0), ("tip", 90.0)];
    let marks = ends.map(|(name, x)| build_mark(x, 0.2, name, FieldMarkKind::Receiver)).to_vec();
    bar.title = "Energy along a bar".to_owned();
    FieldFigure { label: "energy density (J/m³)".to_owned(), is_signed: false, marks, ..bar }
}

/// Builds the stress field around a crack, with numbered contour lines.
pub fn build_crack_field() -> FieldFigure {
    let mut figure = build_field([300, 200], 10.0, |x, y| {
        let (x, y) = (x - 15.0, y - 10.0);
        let ends = [-4.0, 4.0].map(|end: f64| (x - end) / (1.0 + (x - end).powi(2) + y * y));
        6e4 * (ends[1] - ends[0]) * (1.0 + 0.2 * (0.7 * y).sin()) + 400.0 * x
    });
    figure.title = "Stress around a crack".to_owned();
    figure.label = "shear stress σ₁₂ (Pa)".to_owned();
    figure.contour_levels = Some([-4e4, -2e4, -1e4, -5e3, -2e3, 0.0, 2e3, 5e3, 1e4, 2e4].to_vec());
    figure.marks = vec![
        build_mark(11.0, 10.0, "left tip", FieldMarkKind::Receiver),
        build_mark(19.0, 10.0, "right tip", FieldMarkKind::Receiver),
    ];
    figure
}

/// Builds an unsigned quantity with contour lines.
pub fn build_energy_field() -> FieldFigure {
    let figure = build_field([160, 160], 10.0, |x, y| {
        let hill =
            |a: f64, b: f64, width: f64| (-((x - a).powi(2) + (y - b).powi(2)) / width).exp();
        hill(5.0, 6.0, 14.0) + 0.6 * hill(11.0, 11.0, 9.0)
    });
    FieldFigure {
        title: "Energy of two shots".to_owned(),
        label: "energy density (J/m³)".to_owned(),
        is_signed: false,
        contour_levels: Some((1..10).map(|tenth| 0.1 * f64::from(tenth)).collect()),
        ..figure
    }
}

/// Builds the frame at `time` (s) of a wave that radiates from a point and is partly reflected at the boundary to a
/// stiffer part of the domain.
pub fn build_wave_frame(time: f64) -> FieldFigure {
    let pulse = |phase: f64| phase.sin() * (-0.06 * phase * phase).exp();
    let wave = build_field([300, 180], 10.0, |x, y| {
        let distance = |from: f64| (x - from).hypot(y - 9.0);
        let of =
            |from: f64| pulse(2.2 * (distance(from) - 55.0 * time)) / (1.0 + 0.2 * distance(from));
        let shown = if x < 20.0 { of(10.0) - 0.6 * of(30.0) } else { 0.5 * of(10.0) };
        0.01 * shown
    });
    let marks = vec![
        build_mark(10.0, 9.0, "shot", FieldMarkKind::Source),
        build_mark(17.0, 9.0, "R1", FieldMarkKind::Receiver),
        build_mark(24.0, 14.0, "R2", FieldMarkKind::Receiver),
    ];
    FieldFigure {
        title: "A wave meets a stiffer half".to_owned(),
        subtitle: format!("t = {time:.3} s"),
        fixed_limit: Some(0.003),
        material_indices: (0..300 * 180).map(|cell| u16::from(cell % 300 >= 200)).collect(),
        has_yielded: wave.values.iter().map(|value| value.abs() > 0.0025).collect(),
        marks,
        ..wave
    }
}
