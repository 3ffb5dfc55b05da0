//! Example fields of blocky media: slipped, broken and open joints, and the circulation of a fluid in joints.

use wellposed_figures::{
    FieldArrow, FieldArrows, FieldAxis, FieldFigure, FieldLine, FieldLineSet, FieldLineStyle,
};

/// Number of cells of a block along an axis.
const BLOCK_CELLS: usize = 10;
/// Edge of a block, m.
const BLOCK_EDGE: f64 = 0.05;

/// Builds a field over square blocks; `value` is evaluated at the centres of cells, relative to the middle.
fn build_block_field(blocks: [usize; 2], value: impl Fn(f64, f64) -> f64) -> FieldFigure {
    let axis = |label: &str, count: usize| FieldAxis {
        label: label.to_owned(),
        start: -0.5 * BLOCK_EDGE * count as f64,
        end: 0.5 * BLOCK_EDGE * count as f64,
    };
    let [columns, rows] = blocks.map(|count| BLOCK_CELLS * count);
    let spacing = BLOCK_EDGE / BLOCK_CELLS as f64;
    let place = |index: usize, count: usize| spacing * (index as f64 + 0.5 - 0.5 * count as f64);
    FieldFigure {
        title: "Pulse on part of the upper boundary of a blocky medium".to_owned(),
        subtitle: "t = 0.0008 s".to_owned(),
        x: axis("x₁, m", blocks[0]),
        y: axis("x₂, m", blocks[1]),
        columns,
        rows,
        values: (0..columns * rows)
            .map(|cell| value(place(cell % columns, columns), place(cell / columns, rows)))
            .collect(),
        label: "stress σ₁₂, Pa".to_owned(),
        is_signed: true,
        ..FieldFigure::default()
    }
}

/// Builds the faces between blocks, one per pair of adjacent cells, whose `value` at their centre is positive.
fn build_faces(blocks: [usize; 2], value: impl Fn(f64, f64) -> f64) -> Vec<FieldLine> {
    let cells = blocks.map(|count| BLOCK_CELLS * count);
    let spacing = BLOCK_EDGE / BLOCK_CELLS as f64;
    let mut faces = Vec::new();
    for axis in 0..2 {
        for plane in 1..blocks[axis] {
            for index in 0..cells[1 - axis] {
                let mut centre = [0.0; 2];
                centre[axis] = BLOCK_EDGE * (plane as f64 - 0.5 * blocks[axis] as f64);
                centre[1 - axis] = spacing * (index as f64 + 0.5 - 0.5 * cells[1 - axis] as f64);
                let value = value(centre[0], centre[1]);
                if value > 0.0 {
                    faces.push(FieldLine { axis, centre, length: spacing, value });
                }
            }
        }
    }
    faces
}

/// Builds a stress wave with a zone of slip below the loaded part of the boundary, and fracture in its core.
pub fn build_joint_field(blocks: [usize; 2]) -> FieldFigure {
    let top = 0.5 * BLOCK_EDGE * blocks[1] as f64;
    let size = top;
    let mut figure = build_block_field(blocks, |x, y| {
        let r = x.hypot(y - top);
        let wave = (12.0 * (r - 0.9 * size) / size).sin() * (-6.0 * (r / size - 0.9).powi(2)).exp();
        1.2e6 * x / r.max(0.02) * wave
    });
    let slip = move |x: f64, y: f64| {
        let depth = (top - y) / size;
        4e-5 * (1.2 - depth - 2.5 * (x.abs() / size - 0.45 * depth).abs())
    };
    let opening = move |x: f64, y: f64| {
        let depth = (top - y) / size;
        1e-5 * (0.25 - 3.0 * (depth - 0.55).abs() - (x / size).abs())
    };
    let broken = move |x: f64, y: f64| {
        let depth = (top - y) / size;
        if opening(x, y) > 0.0 { 0.0 } else { slip(x, y) - 3.2e-5 + 1e-5 * depth }
    };
    let only_slip = move |x, y| match broken(x, y) > 0.0 || opening(x, y) > 0.0 {
        true => 0.0,
        false => slip(x, y),
    };
    let set = |style, label: &str, lines: Vec<FieldLine>, limit: f64| FieldLineSet {
        style,
        label: label.to_owned(),
        unit: if limit > 0.0 { "m".to_owned() } else { String::new() },
        lines,
        limit,
    };
    figure.line_sets = vec![
        set(FieldLineStyle::Outline, "joints", build_faces(blocks, |_, _| 1.0), 0.0),
        set(FieldLineStyle::Solid, "slip", build_faces(blocks, only_slip), 4.8e-5),
        set(FieldLineStyle::Dotted, "broken and closed, slip", build_faces(blocks, broken), 4.8e-5),
        set(FieldLineStyle::Gap, "open", build_faces(blocks, opening), 2.5e-6),
    ];
    figure
}

/// Builds the circulation of a fluid around the middle of a medium of square blocks.
pub fn build_circulation_field(blocks: usize) -> FieldFigure {
    let flux = |x: f64, y: f64| {
        let r = x.hypot(y).max(0.5 * BLOCK_EDGE);
        let strength = 2e-4 * (0.1 / r).powf(1.5) * (1.0 + (x * y / (r * r)).powi(2));
        [-strength * y / r, strength * x / r]
    };
    let pressure = |x: f64, y: f64| {
        let r = x.hypot(y).max(0.5 * BLOCK_EDGE);
        4e4 * x * y / (r * r) * (0.1 / r) * (20.0 * r).cos()
    };
    let mut figure = build_block_field([blocks; 2], pressure);
    let half = 0.5 * BLOCK_EDGE * blocks as f64;
    let junctions = (1..blocks).flat_map(|i| (1..blocks).map(move |j| [i, j]));
    let arrows = junctions.map(|index| {
        let position = index.map(|index| BLOCK_EDGE * index as f64 - half);
        FieldArrow { position, vector: flux(position[0], position[1]) }
    });
    figure.arrows = Some(FieldArrows {
        label: "flux of fluid θw".to_owned(),
        magnitude_label: "|θw|".to_owned(),
        unit: "m/s".to_owned(),
        arrows: arrows.collect(),
        magnitudes: build_block_field([blocks; 2], |x, y| {
            let [u, v] = flux(x, y);
            u.hypot(v)
        })
        .values,
    });
    let outlines = build_faces([blocks; 2], |_, _| 1.0);
    figure.line_sets = vec![FieldLineSet {
        style: FieldLineStyle::Outline,
        label: "joints".to_owned(),
        unit: String::new(),
        lines: outlines,
        limit: 0.0,
    }];
    FieldFigure {
        title: "Circulation of fluid around a rotated block".to_owned(),
        label: "pressure p, Pa".to_owned(),
        ..figure
    }
}
