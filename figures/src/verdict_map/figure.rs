//! Input of a verdict map, and its validation.

use std::sync::Arc;

use crate::error::FigureError;

/// Axis of a verdict map: a uniform grid of at least one point, ascending or descending; of a logarithmic axis, the
/// logarithms are uniformly spaced.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictMapAxis {
    /// Name, symbol and unit.
    pub label: String,
    /// Values at the grid points, in the unit of the label.
    pub values: Vec<f64>,
    /// Whether the axis is logarithmic; its values are then positive.
    pub is_log: bool,
}

/// Hatching of ill-posed cells, in pairs of a white and a dark line, which are visible on every shade.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hatching {
    /// No hatching.
    Plain,
    /// Lines that rise to the right.
    Rising,
    /// Lines that fall to the right.
    Falling,
    /// Horizontal lines.
    Horizontal,
    /// Vertical lines.
    Vertical,
    /// Horizontal and vertical lines. Rising and falling ones stand for unbounded growth at a finite wave number.
    Grid,
}

/// Fill style of the cells of a category.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FillStyle {
    /// Well-posed: nearly white.
    WellPosed,
    /// Ill-posed: coloured by the level of the cell, or orange without levels, and hatched. The hatching stands for the
    /// kind of growth.
    IllPosed(Hatching),
    /// Unbounded growth at a finite wave number: nearly black with white cross-hatching.
    UnboundedAtFiniteWaveNumber,
    /// Marginal: green with vertical hatching.
    Marginal,
    /// Indeterminate: grey with dense falling hatching.
    Indeterminate,
    /// Outside the model: pale grey with sparse rising hatching.
    OutsideModel,
}

impl FillStyle {
    pub(super) fn is_ill_posed(self) -> bool {
        matches!(self, Self::IllPosed(_))
    }
}

/// Number of parts of the step between neighbouring cells in which places of boundaries are given.
pub const STEP_PARTS: u8 = 32;

/// A category of verdicts.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictCategory {
    /// Legend text.
    pub label: String,
    /// Fill style.
    pub fill_style: FillStyle,
    /// Factor of the growth levels of the cells of the category.
    pub level_factor: f64,
}

/// A curve over the map, e.g. a bound in closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCurve {
    /// Legend text. Curves with the same label share a style and are listed once.
    pub label: String,
    /// Points in the units of the axes; a non-finite point interrupts the curve.
    pub points: Vec<[f64; 2]>,
}

/// Map of verdicts over two parameters, with growth levels where the verdict is ill-posed.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictMap {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Horizontal axis: first parameter.
    pub x: VerdictMapAxis,
    /// Vertical axis: second parameter.
    pub y: VerdictMapAxis,
    /// Categories; those present are listed with their share of the area.
    pub categories: Vec<VerdictCategory>,
    /// Index into `categories` for each cell; x varies fastest.
    pub category_indices: Vec<u8>,
    /// Growth level of each cell, positive or infinite, in the unit of `level_label` if it is multiplied by the
    /// [factor](VerdictCategory::level_factor) of its category; NaN if there is none. x varies fastest. Used in cells with
    /// a style [`FillStyle::IllPosed`]; empty if no cell has a level.
    pub growth_levels: Arc<Vec<f64>>,
    /// Name and unit of the growth level.
    pub level_label: String,
    /// Places of the boundaries between neighbouring cells of different categories, along x and along y: for each cell
    /// the distance of the boundary to the next cell, of whose step there are [`STEP_PARTS`] parts. Boundaries are in the
    /// middle where the number is larger or missing.
    pub boundaries: [Arc<Vec<u8>>; 2],
    /// Whether each cell belongs to a set without area, which is drawn as a line through its points; empty if none does.
    pub is_line: Arc<Vec<bool>>,
    /// Curves drawn over the map.
    pub curves: Vec<MapCurve>,
}

impl VerdictMap {
    pub(super) fn validate(&self) -> Result<(), FigureError> {
        let (columns, rows) = (self.x.values.len(), self.y.values.len());
        let level_count = self.growth_levels.len();
        let fields =
            [("category", self.category_indices.len(), false), ("level", level_count, true)];
        for (field, found, may_be_empty) in fields {
            if found != columns * rows && !(may_be_empty && found == 0) {
                return Err(FigureError::CellCount { field, found, columns, rows });
            }
        }
        let known = self.categories.len();
        match self.category_indices.iter().find(|&&category| usize::from(category) >= known) {
            Some(&found) => Err(FigureError::UnknownCategory { found, known }),
            None => Ok(()),
        }
    }

    /// Returns for each cell whether it is drawn as part of a line or as a single point. Single points of a category that
    /// has cells elsewhere too, such as at the tip of an area, are drawn as areas.
    pub(super) fn line_cells(&self) -> Vec<bool> {
        let (columns, rows) = (self.x.values.len(), self.y.values.len());
        let category = |cell: usize| usize::from(self.category_indices[cell]);
        let is_line = |cell: usize| self.is_line.get(cell).copied().unwrap_or(false);
        let mut has_areas = vec![false; self.categories.len()];
        let mut has_lines = vec![false; self.categories.len()];
        let mut is_joined = vec![false; columns * rows];
        for cell in 0..columns * rows {
            has_areas[category(cell)] |= !is_line(cell);
            if !is_line(cell) {
                continue;
            }
            let (i, j) = (cell % columns, cell / columns);
            for (i, j) in [(i + 1, j), (i, j + 1), (i + 1, j + 1), (i.wrapping_sub(1), j + 1)] {
                if i >= columns || j >= rows {
                    continue;
                }
                let next = j * columns + i;
                if is_line(next) && category(next) == category(cell) {
                    (is_joined[cell], is_joined[next]) = (true, true);
                    has_lines[category(cell)] = true;
                }
            }
        }
        let is_drawn = |cell: usize| {
            let is_alone = !has_areas[category(cell)] && !has_lines[category(cell)];
            is_line(cell) && (is_joined[cell] || is_alone)
        };
        (0..columns * rows).map(is_drawn).collect()
    }

    /// Returns the cells coloured by level, each with its level.
    pub(super) fn ill_posed_levels(&self) -> impl Iterator<Item = (usize, f64)> {
        let ill_posed =
            |category: u8| self.categories[usize::from(category)].fill_style.is_ill_posed();
        let cells = self.category_indices.iter().enumerate();
        cells
            .filter(move |(_, category)| ill_posed(**category))
            .map(|(cell, _)| (cell, self.growth_level(cell)))
    }

    /// Returns the growth level of a cell, in the unit of `level_label`; NaN if there is none.
    pub(super) fn growth_level(&self, cell: usize) -> f64 {
        let category = &self.categories[usize::from(self.category_indices[cell])];
        self.growth_levels.get(cell).map_or(f64::NAN, |level| level * category.level_factor)
    }

    /// Returns the index of a curve's label among the distinct labels, which determines the style.
    pub(super) fn style_index(&self, index: usize) -> usize {
        let mut labels: Vec<&str> = Vec::new();
        for curve in &self.curves[..=index] {
            if !labels.contains(&curve.label.as_str()) {
                labels.push(&curve.label);
            }
        }
        let label = &self.curves[index].label;
        labels.iter().position(|other| other == label).unwrap_or(0)
    }
}
