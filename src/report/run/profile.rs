//! Curves of fields over a single row or column of cells.

use figures::{
    CurveMark, CurvePanel, FieldAxis, FieldFigure, FieldLine, FieldLineSet, FieldLineStyle,
    LabelledCurve, PanelsFigure,
};

/// Legend text of borders between materials, as in pictures of fields.
const BORDER_LABEL: &str = "border between materials";
/// Largest number of faces of joints of one kind that are drawn: more could not be told apart.
const MAX_FACES: usize = 150;

/// Creates the curve of a field over a grid with a single row or column of cells, which does not depend on the other
/// coordinate; `None` for other grids. Materials, joints across the row, sources and receivers are marked. `y_values` are
/// the least and the greatest value of the vertical axis, or `None` for those of the field.
pub(super) fn create_profile(
    figure: &FieldFigure,
    y_values: Option<[f64; 2]>,
) -> Option<PanelsFigure> {
    let (along, axis) = match [figure.columns, figure.rows] {
        [count, 1] if count > 1 => (0, &figure.x),
        [1, count] if count > 1 => (1, &figure.y),
        _ => return None,
    };
    if figure.body.is_some() {
        return None;
    }
    let across = |set: &FieldLineSet| -> Vec<FieldLine> {
        set.lines.iter().filter(|line| line.axis == along).copied().collect()
    };
    let coloured = figure.line_sets.iter().find(|set| set.style == FieldLineStyle::Coloured);
    // Where the faces of joints are plotted, the cells have no values.
    let curve = || {
        let points = figure.values.iter().enumerate();
        LabelledCurve {
            label: String::new(),
            points: points
                .map(|(cell, value)| [cell_edge(figure, axis, cell as f64 + 0.5), *value])
                .collect(),
        }
    };
    let mut positions = Vec::new();
    let borders = material_borders(figure, axis);
    if !borders.is_empty() {
        positions.push((BORDER_LABEL.to_owned(), borders));
    }
    for set in figure.line_sets.iter().filter(|set| set.style != FieldLineStyle::Coloured) {
        let places: Vec<f64> = across(set).iter().map(|line| line.centre[along]).collect();
        if (1..=MAX_FACES).contains(&places.len()) {
            positions.push((set.label.clone(), places));
        }
    }
    for outline in &figure.outlines {
        let pairs = outline.is_inside.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]);
        let edges: Vec<f64> =
            pairs.map(|(cell, _)| cell_edge(figure, axis, cell as f64 + 1.0)).collect();
        if (1..=MAX_FACES).contains(&edges.len()) {
            positions.push((outline.label.clone(), edges));
        }
    }
    let marks = figure.marks.iter().map(|mark| CurveMark {
        x: mark.position[along],
        name: mark.name.clone(),
        kind: mark.kind,
    });
    // A load along the row acts at all of its points and is not drawn.
    let loaded = figure.loaded_lines.iter().filter(|line| line[0][along] == line[1][along]);
    Some(PanelsFigure {
        title: figure.title.clone(),
        subtitle: figure.subtitle.clone(),
        panels: vec![CurvePanel {
            x_label: axis.label.clone(),
            y_label: figure.label.clone(),
            curves: if coloured.is_none() { vec![curve()] } else { Vec::new() },
            points: coloured
                .map(|set| {
                    across(set).iter().map(|line| [line.centre[along], line.value]).collect()
                })
                .unwrap_or_default(),
            x_ends: Some([axis.start, axis.end]),
            y_values,
            positions,
            loaded_ends: loaded.map(|line| line[0][along]).collect(),
            marks: marks.collect(),
            ..CurvePanel::default()
        }],
    })
}

/// Returns the position at a number of cells from the start of the axis.
fn cell_edge(figure: &FieldFigure, axis: &FieldAxis, cells: f64) -> f64 {
    axis.start + (axis.end - axis.start) * cells / figure.values.len() as f64
}

/// Returns the positions at which the material changes.
fn material_borders(figure: &FieldFigure, axis: &FieldAxis) -> Vec<f64> {
    let pairs = figure.material_indices.windows(2).enumerate();
    let borders = pairs.filter(|(_, pair)| pair[0] != pair[1]);
    borders.map(|(cell, _)| cell_edge(figure, axis, cell as f64 + 1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use figures::{FieldMark, FieldMarkKind};

    fn row() -> FieldFigure {
        FieldFigure {
            x: FieldAxis { label: "x₁ (m)".to_owned(), start: 2.0, end: 6.0 },
            y: FieldAxis { label: "x₂ (m)".to_owned(), start: 0.0, end: 0.5 },
            columns: 4,
            rows: 1,
            values: vec![1.0, -2.0, 3.0, 0.5],
            label: "velocity v₁ (m/s)".to_owned(),
            material_indices: vec![0, 0, 0, 1],
            marks: vec![FieldMark {
                position: [2.5, 0.25],
                name: "R".to_owned(),
                kind: FieldMarkKind::Receiver,
            }],
            ..FieldFigure::default()
        }
    }

    #[test]
    fn rows_and_columns_are_curves_at_the_centres_of_cells() {
        let figure = row();
        let [panel] = &create_profile(&figure, None).unwrap().panels[..] else { panic!() };
        assert_eq!(panel.curves[0].points, [[2.5, 1.0], [3.5, -2.0], [4.5, 3.0], [5.5, 0.5]]);
        assert_eq!((panel.x_label.as_str(), panel.x_ends), ("x₁ (m)", Some([2.0, 6.0])));
        assert_eq!(panel.positions, [(BORDER_LABEL.to_owned(), vec![5.0])]);
        assert_eq!((panel.marks[0].x, panel.marks[0].name.as_str()), (2.5, "R"));
        let swap = |axis: &FieldAxis, other: &FieldAxis| (other.clone(), axis.clone());
        let (x, y) = swap(&figure.x, &figure.y);
        let mut column = FieldFigure { x, y, columns: 1, rows: 4, ..figure.clone() };
        column.marks[0].position = [0.25, 2.5];
        let turned = create_profile(&column, Some([-9.0, 9.0])).unwrap();
        let mut expected = panel.clone();
        expected.y_values = Some([-9.0, 9.0]);
        assert_eq!(turned.panels, [expected]);
        let plane = FieldFigure { columns: 2, rows: 2, ..figure };
        assert!(create_profile(&plane, None).is_none());
    }

    /// Faces of joints across the row are lines or, if they are plotted, points; those along the row are left out.
    #[test]
    fn joints_of_a_row_are_marked() {
        let line = |axis: usize, place: f64, value: f64| FieldLine {
            axis,
            centre: [place, 0.25],
            length: 0.5,
            value,
        };
        let set = |style, label: &str| FieldLineSet {
            style,
            label: label.to_owned(),
            unit: "m".to_owned(),
            lines: vec![line(0, 3.0, 1e-3), line(1, 3.5, 9.0), line(0, 5.0, 2e-3)],
            limit: 2e-3,
        };
        let mut figure = row();
        figure.line_sets = vec![set(FieldLineStyle::Solid, "slipped")];
        let profile = create_profile(&figure, None).unwrap();
        assert_eq!(profile.panels[0].positions[1], ("slipped".to_owned(), vec![3.0, 5.0]));
        figure.line_sets = vec![set(FieldLineStyle::Coloured, "slip")];
        let panel = &create_profile(&figure, None).unwrap().panels[0];
        assert!(panel.curves.is_empty());
        assert_eq!(panel.points, [[3.0, 1e-3], [5.0, 2e-3]]);
    }
}
