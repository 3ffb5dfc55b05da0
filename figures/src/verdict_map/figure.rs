//! The data of a verdict map, and their checks.

use crate::error::FigureError;

/// An axis of a map: a uniform grid of at least one point, in either order.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name, symbol and unit.
    pub label: String,
    /// The values at the grid points, in the unit of the label.
    pub values: Vec<f64>,
}

/// Fill style of the cells of a category.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// Nearly white.
    WellPosed,
    /// By the cell's level; plain orange without. A second and further category of this look is
    /// hatched, each in its own direction.
    IllPosed,
    /// Nearly black with white cross-hatching.
    UnboundedAtFiniteWaveNumber,
    /// Green with vertical hatching.
    Marginal,
    /// Grey with dense falling hatching.
    Indeterminate,
    /// Pale grey with sparse rising hatching.
    OutsideModel,
}

/// A category of verdicts of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Category {
    /// Legend text.
    pub label: String,
    /// The fill.
    pub look: Look,
}

/// A line drawn over the map, such as a bound in closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Legend text. Curves of the same label share a style and are listed once.
    pub label: String,
    /// Points in the units of the axes; a point that is not finite interrupts the line.
    pub points: Vec<[f64; 2]>,
}

/// Verdict regions over two parameters, with growth levels where the verdict is ill-posed.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictMap {
    /// Title of the figure.
    pub title: String,
    /// Subtitle: the fixed parameters.
    pub subtitle: String,
    /// Parameter drawn to the right.
    pub x: Axis,
    /// Parameter drawn upwards.
    pub y: Axis,
    /// Categories; those that occur are listed with their share of the area.
    pub categories: Vec<Category>,
    /// Index into `categories` for each cell; x runs fastest.
    pub category: Vec<u8>,
    /// Growth level for each cell, positive, in the unit of `level_label`; NaN where
    /// there is none. x runs fastest. Used in cells that look [`Look::IllPosed`].
    pub level: Vec<f64>,
    /// Name and unit of the level.
    pub level_label: String,
    /// Lines on top.
    pub curves: Vec<Curve>,
}

impl VerdictMap {
    pub(super) fn check_cells(&self) -> Result<(), FigureError> {
        let (columns, rows) = (self.x.values.len(), self.y.values.len());
        for (field, found) in [("category", self.category.len()), ("level", self.level.len())] {
            if found != columns * rows {
                return Err(FigureError::CellCount { field, found, columns, rows });
            }
        }
        let known = self.categories.len();
        match self.category.iter().find(|&&category| usize::from(category) >= known) {
            Some(&found) => Err(FigureError::UnknownCategory { found, known }),
            None => Ok(()),
        }
    }

    /// The cells coloured by level, each with its level.
    pub(super) fn levels(&self) -> impl Iterator<Item = (usize, f64)> {
        let ill_posed =
            |category: u8| self.categories[usize::from(category)].look == Look::IllPosed;
        let cells = self.category.iter().zip(&self.level).enumerate();
        cells
            .filter(move |(_, (category, _))| ill_posed(**category))
            .map(|(cell, (_, l))| (cell, *l))
    }

    /// Number of categories before this one that look the same.
    pub(super) fn variant(&self, category: usize) -> usize {
        let look = self.categories[category].look;
        self.categories[..category].iter().filter(|other| other.look == look).count()
    }

    /// The curve whose look this one shares, counted without repetitions.
    pub(super) fn first_of_label(&self, index: usize) -> usize {
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
