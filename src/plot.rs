//! `wellposed plot`, and what `wellposed run` draws at its end: pictures from files of results alone.

use crate::Error;
use crate::case::Case;
use crate::case::dynamics::{Dynamics, Picture};
use crate::output::{Growing, ResultFolder};
use crate::words::{case_title, short};
use figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use files::npz::{Array, Values, read};
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

/// Runs the verb.
///
/// # Errors
/// The folder holds no finished run, or a file of it cannot be read or written.
pub fn run(path: &Path, stdout: &mut dyn Write) -> Result<(), Error> {
    let (folder, case) = ResultFolder::finished(path)?;
    draw(&case, case.required_dynamics()?, &folder)?;
    writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
    Ok(())
}

/// Draws all pictures of a run.
pub(crate) fn draw(case: &Case, dynamics: &Dynamics, folder: &ResultFolder) -> Result<(), Error> {
    let fields = Fields::read(&folder.path().join("fields.npz"))?;
    let figure = fields.figure(case, dynamics, dynamics.output.picture);
    folder.write("run.png", &figure.draw(figures::Format::Png)?)?;
    folder.write("run.svg", &figure.draw(figures::Format::Svg)?)?;
    if fields.of("dissipation").is_some() && dynamics.output.picture != Picture::Dissipation {
        let figure = fields.figure(case, dynamics, Picture::Dissipation);
        folder.write("dissipation.png", &figure.draw(figures::Format::Png)?)?;
        folder.write("dissipation.svg", &figure.draw(figures::Format::Svg)?)?;
    }
    Ok(())
}

/// Columns of a table of numbers by name.
pub(crate) fn table(
    folder: &ResultFolder,
    file: Growing,
) -> Result<Vec<(String, Vec<f64>)>, Error> {
    let path = folder.growing(file);
    let unreadable = |cause: String| Error::Unreadable { file: path.display().to_string(), cause };
    let text = std::fs::read_to_string(&path).map_err(|error| unreadable(error.to_string()))?;
    let mut lines = text.lines();
    let mut columns: Vec<(String, Vec<f64>)> = lines
        .next()
        .unwrap_or_default()
        .split(',')
        .map(|name| (name.to_owned(), Vec::new()))
        .collect();
    for (index, line) in lines.enumerate() {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            let number = cell.parse();
            let number = number.map_err(|_| unreadable(format!("line {}: '{cell}'", index + 2)))?;
            column.1.push(number);
        }
    }
    Ok(columns)
}

/// A quantity with its symbol and unit, by its name in files.
pub(crate) fn label(name: &str) -> String {
    let digits: String = name.chars().filter(char::is_ascii_digit).collect();
    let subscript = |c: char| match c {
        '1'..='3' => char::from_u32('₀' as u32 + (c as u32 - '0' as u32)).unwrap_or(c),
        c => c,
    };
    let index: String = digits.chars().map(subscript).collect();
    let (quantity, symbol) = match name.trim_end_matches(|c: char| c.is_ascii_digit()) {
        "v" => ("velocity", "v"),
        "w" => ("spin", "ω"),
        "sigma" => ("stress", "σ"),
        "m" => ("couple stress", "m"),
        "u" => ("displacement", "u"),
        "phi" => ("rotation", "φ"),
        _ => return "plastic dissipation, J/m³".to_owned(),
    };
    format!("{quantity} {symbol}{index}, {}", crate::run::unit(name))
}

/// The fields at the end of a run.
struct Fields(Vec<Array>);

impl Fields {
    fn read(path: &Path) -> Result<Self, Error> {
        let unreadable =
            |cause: String| Error::Unreadable { file: path.display().to_string(), cause };
        let bytes = std::fs::read(path).map_err(|error| unreadable(error.to_string()))?;
        Ok(Self(read(&bytes).map_err(|error| unreadable(error.to_string()))?))
    }

    fn of(&self, name: &str) -> Option<&[f64]> {
        match &self.0.iter().find(|array| array.name == name)?.values {
            Values::F64(values) => Some(values),
            _ => None,
        }
    }

    fn region(&self, cell: usize) -> u16 {
        match self.0.iter().find(|array| array.name == "region").map(|array| &array.values) {
            Some(Values::I32(values)) => values.get(cell).map_or(0, |region| *region as u16),
            _ => 0,
        }
    }

    /// The final state: of a space a section across x₂ through its first source, or its middle.
    fn figure(&self, case: &Case, dynamics: &Dynamics, picture: Picture) -> FieldFigure {
        let time = self.of("time").and_then(|time| time.first().copied()).unwrap_or(0.0);
        let section = Section::new(dynamics);
        let grid = &dynamics.grid;
        let of = |name: &str, cell: usize| {
            self.of(name).and_then(|values| values.get(cell)).copied().unwrap_or(0.0)
        };
        let values = section.cells().map(|cell| match picture {
            Picture::Speed => (1..=grid.dimensions())
                .fold(0.0, |sum, i| f64::hypot(sum, of(&format!("v{i}"), cell))),
            other => of(&other.name(), cell),
        });
        let mut figure = section.figure(case, dynamics, picture, time, values.collect());
        if dynamics.regions.len() > 1 {
            figure.outlines = section.cells().map(|cell| self.region(cell)).collect();
        }
        if let Some(dissipated) = self.of("dissipation").filter(|_| picture != Picture::Dissipation)
        {
            figure.plastic = section.cells().map(|cell| dissipated[cell] > 0.0).collect();
        }
        figure
    }
}

/// The plane that is drawn.
struct Section<'a> {
    dynamics: &'a Dynamics,
    /// Its axes.
    axes: [usize; 2],
    /// Of a space, the layer across x₂.
    layer: Option<usize>,
}

impl<'a> Section<'a> {
    fn new(dynamics: &'a Dynamics) -> Self {
        let grid = &dynamics.grid;
        let layer = (grid.dimensions() == 3).then(|| {
            let [first, last] = grid.extent(1);
            let at = dynamics.sources.first().map_or(0.5 * (first + last), |source| source.at[1]);
            let index = ((at - grid.origin[1]) / grid.spacing[1]).floor().max(0.0) as usize;
            index.min(grid.cells[1] - 1)
        });
        Self { dynamics, axes: if layer.is_none() { [0, 1] } else { [0, 2] }, layer }
    }

    /// Its cells, x₁ running fastest.
    fn cells(&self) -> impl Iterator<Item = usize> {
        let cells = &self.dynamics.grid.cells;
        let [columns, rows] = self.axes.map(|axis| cells[axis]);
        let (layer, depth) = (self.layer, cells[1]);
        (0..rows).flat_map(move |j| {
            (0..columns).map(move |i| match layer {
                None => j * columns + i,
                Some(layer) => (j * depth + layer) * columns + i,
            })
        })
    }

    fn figure(
        &self,
        case: &Case,
        dynamics: &Dynamics,
        picture: Picture,
        time: f64,
        values: Vec<f64>,
    ) -> FieldFigure {
        let grid = &dynamics.grid;
        let mut subtitle = format!("t = {} s", short(time));
        if let Some(layer) = self.layer {
            let _ = write!(subtitle, ", section x₂ = {} m", short(grid.centre(1, layer)));
        }
        let axis = |axis: usize| {
            let [from, to] = grid.extent(axis);
            FieldAxis { label: format!("x{}, m", ["₁", "₂", "₃"][axis]), from, to }
        };
        let mark = |at: &[f64], name: &str, kind: FieldMarkKind| {
            let is_near = self
                .layer
                .is_none_or(|layer| (at[1] - grid.centre(1, layer)).abs() <= 0.5 * grid.spacing[1]);
            let at = self.axes.map(|axis| at[axis]);
            is_near.then(|| FieldMark { at, name: name.to_owned(), kind })
        };
        let receivers = dynamics.receivers.iter();
        let sources = dynamics.sources.iter();
        FieldFigure {
            title: case_title(case),
            subtitle,
            x: axis(self.axes[0]),
            y: axis(self.axes[1]),
            columns: grid.cells[self.axes[0]],
            rows: grid.cells[self.axes[1]],
            values,
            label: match picture {
                Picture::Speed => "speed |v|, m/s".to_owned(),
                _ => label(&picture.name()),
            },
            is_signed: !matches!(picture, Picture::Speed | Picture::Dissipation),
            limit: None,
            outlines: Vec::new(),
            plastic: Vec::new(),
            marks: receivers
                .filter_map(|own| mark(&own.at, &own.name, FieldMarkKind::Receiver))
                .chain(
                    sources
                        .filter_map(|own| mark(&own.at, own.action.name(), FieldMarkKind::Source)),
                )
                .collect(),
        }
    }
}
