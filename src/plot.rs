//! `wellposed plot`, and what `wellposed run` draws at its end: pictures from files of results alone.

mod flow;

use crate::Error;
use crate::case::dynamics::{Component, Dynamics, Picture};
use crate::case::{Case, InTime};
use crate::output::{AppendedFile, OutputError, ResultFolder, SNAPSHOTS};
use crate::report::format::{case_title, short, unit_of};
use figures::{
    Animation, FieldAxis, FieldFigure, FieldMark, FieldMarkKind, FigureError, LedgerFigure,
    LedgerTerm, SeismogramFigure, SeismogramPanel, Trace,
};
use files::npz::{Array, Values, read};
use models::cosserat::waves::Field;
use models::elementary::Elementary;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

/// Runs the verb.
///
/// # Errors
/// The folder holds no finished run, or a file of it cannot be read or written.
pub fn run(path: &Path, stdout: &mut dyn Write) -> Result<(), Error> {
    let (folder, case) = ResultFolder::finished(path)?;
    draw(&case, &folder)?;
    writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
    Ok(())
}

/// Draws all pictures of a run.
pub(crate) fn draw(case: &Case, folder: &ResultFolder) -> Result<(), Error> {
    let fields = Fields::read(&folder.path().join("fields.npz"))?;
    match case.in_time()? {
        InTime::Solid(dynamics) => draw_solid(case, dynamics, &fields, folder),
        InTime::Flow(run) => flow::draw(case, run, &fields, folder),
    }
}

fn draw_solid(
    case: &Case,
    dynamics: &Dynamics,
    fields: &Fields,
    folder: &ResultFolder,
) -> Result<(), Error> {
    let figure = fields.figure(case, dynamics, dynamics.output.picture);
    write(folder, "run", |format| figure.draw(format))?;
    if !dynamics.receivers.is_empty() {
        seismograms(case, folder)?;
    }
    let words = |name: &str| match name {
        "kinetic" => "kinetic energy",
        "stored" => "stored energy",
        "sides" => "work at the sides",
        "sources" => "work of sources and weight",
        "initial_stress" => "released by the initial stress",
        "plastic" => "plastic dissipation",
        "numerical" => "dissipation of the scheme",
        "residual" => "left over",
        _ => "balance: the scheme's, not counted",
    };
    let unit = if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" };
    ledger(case, folder, unit, table(folder, AppendedFile::Ledger)?, words)?;
    if dynamics.output.snapshot_interval > 0.0 {
        let section = Section::new(dynamics);
        let picture = dynamics.output.picture;
        let of_snapshot = |bytes: &[u8]| section.of_snapshot(bytes, picture);
        animation(folder, of_snapshot, |time, values| {
            section.figure(case, dynamics, picture, time, values)
        })?;
    }
    if fields.of("dissipation").is_some() && dynamics.output.picture != Picture::Dissipation {
        let figure = fields.figure(case, dynamics, Picture::Dissipation);
        write(folder, "dissipation", |format| figure.draw(format))?;
    }
    Ok(())
}

/// Writes a picture in both formats.
fn write(
    folder: &ResultFolder,
    name: &str,
    draw: impl Fn(figures::Format) -> Result<Vec<u8>, FigureError>,
) -> Result<(), Error> {
    folder.write(&format!("{name}.png"), &draw(figures::Format::Png)?)?;
    Ok(folder.write(&format!("{name}.svg"), &draw(figures::Format::Svg)?)?)
}

/// Receivers that a picture names: of many some, evenly spread from the first to the last.
fn some_of(count: usize) -> impl Iterator<Item = usize> {
    /// As many as a legend tells apart.
    const MOST: usize = 8;
    let named = count.min(MOST);
    (0..named).map(move |index| index * (count - 1) / (named - 1).max(1))
}

/// What the receivers saw: a panel for each quantity that one of them recorded.
fn seismograms(case: &Case, folder: &ResultFolder) -> Result<(), Error> {
    /// Panels of a page; of more quantities the first.
    const MOST: usize = 8;
    let columns = table(folder, AppendedFile::Receivers)?;
    let mut receivers: Vec<&str> =
        columns.iter().filter_map(|own| Some(own.0.rsplit_once('.')?.0)).collect();
    receivers.dedup();
    let drawn: Vec<&str> = some_of(receivers.len()).map(|index| receivers[index]).collect();
    let mut panels: Vec<(String, Vec<Trace>)> = Vec::new();
    for (column, values) in columns.iter().skip(1) {
        let Some((receiver, name)) = column.rsplit_once('.') else { continue };
        if !drawn.contains(&receiver) {
            continue;
        }
        let trace = Trace { name: receiver.to_owned(), values: values.clone() };
        match panels.iter_mut().find(|panel| panel.0 == name) {
            Some(panel) => panel.1.push(trace),
            None => panels.push((name.to_owned(), vec![trace])),
        }
    }
    let all = panels.len();
    panels.truncate(MOST);
    let figure = SeismogramFigure {
        title: case_title(case),
        subtitle: match (all > MOST, receivers.len() > drawn.len()) {
            (true, false) => format!("the first {MOST} of {all} quantities in receivers.csv"),
            (false, true) => format!("{} of {} receivers", drawn.len(), receivers.len()),
            (true, true) => format!(
                "the first {MOST} of {all} quantities in receivers.csv, {} of {} receivers",
                drawn.len(),
                receivers.len()
            ),
            (false, false) => String::new(),
        },
        time_label: "time t, s".to_owned(),
        panels: panels
            .into_iter()
            .map(|(name, traces)| SeismogramPanel { label: label(&name), traces })
            .collect(),
        times: columns.into_iter().next().map(|column| column.1).unwrap_or_default(),
    };
    write(folder, "seismograms", |format| figure.draw(format))
}

/// Where the energy was, and what became of it: columns of the ledger, the last one what is left over,
/// by their `words`.
fn ledger(
    case: &Case,
    folder: &ResultFolder,
    unit: &str,
    columns: Vec<(String, Vec<f64>)>,
    words: impl Fn(&str) -> &'static str,
) -> Result<(), Error> {
    let mut columns = columns.into_iter();
    let times = columns.next().map(|column| column.1).unwrap_or_default();
    let mut terms: Vec<LedgerTerm> = columns
        .map(|(name, values)| LedgerTerm { name: words(&name).to_owned(), values })
        .collect();
    let Some(balance) = terms.pop() else { return Ok(()) };
    terms.retain(|term| term.values.iter().any(|value| *value != 0.0));
    let figure = LedgerFigure {
        title: case_title(case),
        subtitle: String::new(),
        time_label: "time t, s".to_owned(),
        label: format!("energy, {unit}"),
        times,
        terms,
        balance,
    };
    write(folder, "ledger", |format| figure.draw(format))
}

/// The snapshots one after the other, in one scale of colours: their values, or why there are none, and
/// the figure of these at a time.
fn animation(
    folder: &ResultFolder,
    of_snapshot: impl Fn(&[u8]) -> Result<Vec<f64>, String>,
    figure: impl Fn(f64, Vec<f64>) -> FieldFigure,
) -> Result<(), Error> {
    const SECONDS_PER_FRAME: f64 = 0.1;
    const WIDTH: u32 = 800;
    const ANIMATION: &str = "animation.gif";
    let list = folder.path().join(SNAPSHOTS);
    let text = std::fs::read_to_string(&list).map_err(|e| OutputError::unreadable(&list, &e))?;
    let names = files::vti::collected(&text);
    if names.len() < 2 {
        return Ok(());
    }
    // Twice through all, not to hold them all.
    let values = |name: &str| -> Result<(f64, Vec<f64>), Error> {
        let path = folder.path().join(name);
        let unusable = |cause: String| OutputError::unusable(&path, cause);
        let bytes = std::fs::read(&path).map_err(|e| OutputError::unreadable(&path, &e))?;
        let time =
            files::vti::plain_time(&bytes).ok_or_else(|| unusable("has no time".to_owned()))?;
        Ok((time, of_snapshot(&bytes).map_err(unusable)?))
    };
    let mut greatest = 0.0f64;
    for name in &names {
        greatest = values(name)?.1.iter().fold(greatest, |sum, value| sum.max(value.abs()));
    }
    if greatest == 0.0 {
        // There may be one of another picture.
        return Ok(folder.remove_result(ANIMATION)?);
    }
    let mut animation = Animation::new(Vec::new(), SECONDS_PER_FRAME, WIDTH)?;
    for name in &names {
        let (time, values) = values(name)?;
        let mut figure = figure(time, values);
        figure.scale = Some(greatest);
        animation.add(&figure)?;
    }
    Ok(folder.write(ANIMATION, &animation.finish()?)?)
}

/// So many numbers of each cell in a snapshot by the name of the array, or why there are none.
fn array(bytes: &[u8], name: &str, cells: usize) -> Result<Vec<f64>, String> {
    match files::vti::plain_values(bytes, name) {
        None => Err(format!("no array {name}")),
        Some(all) if all.len() < cells => Err(format!("too few values of {name}")),
        Some(all) => Ok(all),
    }
}

/// Columns of a table of numbers by name.
pub(crate) fn table(
    folder: &ResultFolder,
    file: AppendedFile,
) -> Result<Vec<(String, Vec<f64>)>, Error> {
    let path = folder.path_of(file);
    let text =
        std::fs::read_to_string(&path).map_err(|error| OutputError::unreadable(&path, &error))?;
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
            let odd = |_| OutputError::unusable(&path, format!("line {}: '{cell}'", index + 2));
            column.1.push(number.map_err(odd)?);
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
        "psi_deg" => return "stress angle ψ, °".to_owned(),
        "p" => ("pressure", "p"),
        "shear_rate" => ("shear rate", "Q_D"),
        _ => return "plastic dissipation, J/m³".to_owned(),
    };
    format!("{quantity} {symbol}{index}, {}", unit_of(name))
}

/// The fields at the end of a run.
struct Fields(Vec<Array>);

impl Fields {
    fn read(path: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(path).map_err(|error| OutputError::unreadable(path, &error))?;
        Ok(Self(read(&bytes).map_err(|error| OutputError::unusable(path, error))?))
    }

    fn of(&self, name: &str) -> Option<&[f64]> {
        match &self.0.iter().find(|array| array.name == name)?.values {
            Values::F64(values) => Some(values),
            _ => None,
        }
    }

    fn time(&self) -> f64 {
        self.of("time").and_then(|time| time.first().copied()).unwrap_or(0.0)
    }

    fn region(&self, cell: usize) -> u16 {
        match self.0.iter().find(|array| array.name == "region").map(|array| &array.values) {
            Some(Values::I32(values)) => values.get(cell).map_or(0, |region| *region as u16),
            _ => 0,
        }
    }

    /// The final state: of a space a section across x₂ through its first source, or its middle.
    fn figure(&self, case: &Case, dynamics: &Dynamics, picture: Picture) -> FieldFigure {
        let time = self.time();
        let section = Section::new(dynamics);
        let grid = &dynamics.grid;
        let of = |name: &str, cell: usize| {
            self.of(name).and_then(|values| values.get(cell)).copied().unwrap_or(0.0)
        };
        let values = section.cells().map(|cell| match picture {
            Picture::Speed => (1..=grid.dimensions())
                .fold(0.0, |sum, i| Elementary::root_sum_square(sum, of(&format!("v{i}"), cell))),
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

    /// What a snapshot has of the picture, or why it has nothing.
    fn of_snapshot(&self, bytes: &[u8], picture: Picture) -> Result<Vec<f64>, String> {
        let name = match picture {
            Picture::Speed | Picture::Component(Component(Field::Velocity(_))) => {
                "velocity [m/s]".to_owned()
            }
            _ => format!("{} [{}]", picture.name(), unit_of(&picture.name())),
        };
        let all = array(bytes, &name, self.dynamics.grid.count())?;
        let of = |cell: usize| match picture {
            Picture::Speed => all[3 * cell..3 * cell + 3]
                .iter()
                .fold(0.0, |s, v| Elementary::root_sum_square(s, *v)),
            Picture::Component(Component(Field::Velocity(i))) => all[3 * cell + i],
            _ => all[cell],
        };
        Ok(self.cells().map(of).collect())
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
        let named: Vec<usize> = some_of(dynamics.receivers.len()).collect();
        let name = |index: usize| match named.contains(&index) {
            true => dynamics.receivers[index].name.as_str(),
            false => "",
        };
        let receivers = dynamics.receivers.iter().enumerate();
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
            scale: None,
            // They are values of the picture of the case.
            curves: dynamics.output.contours.clone().filter(|_| picture == dynamics.output.picture),
            outlines: Vec::new(),
            plastic: Vec::new(),
            marks: receivers
                .filter_map(|(index, own)| mark(&own.at, name(index), FieldMarkKind::Receiver))
                .chain(
                    sources
                        .filter_map(|own| mark(&own.at, own.action.name(), FieldMarkKind::Source)),
                )
                .collect(),
        }
    }
}
