//! Writes case files, runs a program with them, and compares its seismograms with exact solutions.

use super::{Error, Row, Solid, error};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Position of the compared receivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// The given point.
    Point,
    /// Centre of the cell that contains the point.
    Cell,
}

/// Solver settings of the problems.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    pub program: &'a Path,
    /// Cells per wavelength.
    pub cells: f64,
    pub place: Place,
    /// Axis normal to the surface or interface, counted from 0; `None`: the last axis.
    pub up: Option<usize>,
    /// Kernel of point loads and sources; `None`: the default. With `cell` the grid is shifted so that the source is
    /// at the centre of a cell or of its face.
    pub kernel: Option<&'a str>,
    /// Settings passed to the program by `--set`.
    pub sets: &'a [String],
    /// Whether the exact solution is convolved with the default kernel of the simulation (Lamb's problem).
    pub is_spread: bool,
}

impl<'a> Settings<'a> {
    /// Settings with all defaults.
    pub fn new(program: &'a Path, cells: f64) -> Self {
        let sets = &[];
        Self { program, cells, place: Place::Point, up: None, kernel: None, sets, is_spread: false }
    }

    /// Shift of the grid in cells: ½ puts the source at the centre of a cell, for the kernel `cell` and for receivers
    /// in cell centres (older programs).
    pub fn shift(&self) -> f64 {
        if self.kernel == Some("cell") || self.place == Place::Cell { 0.5 } else { 0.0 }
    }

    /// Line of the case file with the kernel; empty for the default kernel.
    pub fn kernel(&self) -> String {
        self.kernel.map_or(String::new(), |kernel| format!("kernel = \"{kernel}\"\n"))
    }
}

/// Mapping between coordinates (horizontal ones first, upwards last) and the axes of the case.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    dimensions: usize,
    up: usize,
}

impl Frame {
    pub fn new(dimensions: usize, settings: &Settings) -> Self {
        Self { dimensions, up: settings.up.unwrap_or(dimensions - 1) }
    }

    /// Axis, counted from 0, of each coordinate.
    fn axes(self) -> Vec<usize> {
        (0..self.dimensions).filter(|axis| *axis != self.up).chain([self.up]).collect()
    }

    /// Reorders values given by coordinate into the order of the axes.
    pub fn place<T: Copy>(self, values: &[T]) -> Vec<T> {
        let axes = self.axes();
        let place = |axis| axes.iter().position(|own| *own == axis).expect("all axes");
        (0..self.dimensions).map(|axis| values[place(axis)]).collect()
    }

    /// Whether the axes have the opposite handedness of the coordinates, in two dimensions.
    pub fn is_mirrored(self) -> bool {
        self.up == 0
    }

    /// Name of the velocity component along a coordinate.
    pub fn velocity(self, coordinate: usize) -> String {
        format!("v{}", self.axes()[coordinate] + 1)
    }

    /// Name of the stress component along a coordinate on the boundary normal to the last coordinate.
    pub fn traction(self, coordinate: usize) -> String {
        format!("sigma{}{}", self.axes()[coordinate] + 1, self.up + 1)
    }

    /// Name of the boundary normal to a coordinate, at its lower or upper end.
    pub fn side(self, coordinate: usize, is_upper: bool) -> String {
        format!("x{}{}", self.axes()[coordinate] + 1, if is_upper { '+' } else { '-' })
    }

    /// First sections of a case file: solid, grid with `cells` cells of size `spacing` (m) and its lower corner at
    /// `low` (in cells), and duration (s).
    pub fn begin(
        self,
        solid: &Solid,
        spacing: f64,
        cells: &[f64],
        low: &[f64],
        duration: f64,
    ) -> String {
        let count: Vec<u32> = cells.iter().map(|count| *count as u32).collect();
        let origin: Vec<f64> = low.iter().map(|x| x * spacing).collect();
        format!(
            "title = \"Accuracy\"\n[model]\nkind = \"classical\"\ndimensions = {}\n{}[grid]\n\
             cells = {:?}\nspacing = {spacing}\norigin = {:?}\n[time]\nduration = {duration}\n",
            self.dimensions,
            moduli(solid, "\n") + "\n",
            self.place(&count),
            self.place(&origin),
        )
    }

    /// Boundary sections of the kind `kind`, for (coordinate, whether upper).
    pub fn sides(self, kind: &str, sides: &[(usize, bool)]) -> String {
        let entry = |(coordinate, is_upper): &(usize, bool)| {
            let side = self.side(*coordinate, *is_upper);
            format!("[[side]]\nside = \"{side}\"\nkind = \"{kind}\"\n")
        };
        sides.iter().map(entry).collect()
    }
}

/// Moduli and density as keys of a case file.
pub fn moduli(solid: &Solid, separator: &str) -> String {
    let Solid { lambda, mu, density } = solid;
    format!("lambda = {lambda}{separator}mu = {mu}{separator}density = {density}")
}

/// Receiver of a problem.
#[derive(Clone, Debug)]
pub struct Receiver {
    pub name: &'static str,
    /// Coordinates, m, upwards last.
    pub at: Vec<f64>,
    /// Distance from the source, in wavelengths.
    pub distance: f64,
    /// End of the compared time interval, s.
    pub until: f64,
}

impl Receiver {
    /// Receiver at coordinates in wavelengths; with [`Place::Cell`] moved to the centre of the cell that contains the
    /// point, on a face to that of the lower cell. A corner of the grid cells is at −`offset`, in cells.
    pub fn new(
        name: &'static str,
        at: &[f64],
        distance: f64,
        wavelength: f64,
        (settings, offset): (&Settings, &[f64]),
    ) -> Self {
        let h = wavelength / settings.cells;
        let place = |(x, offset): (&f64, &f64)| match settings.place {
            Place::Point => x * wavelength,
            Place::Cell => ((x * settings.cells + offset - 1e-6).floor() + 0.5 - offset) * h,
        };
        let at = at.iter().zip(offset).map(place).collect();
        Self { name, at, distance, until: f64::INFINITY }
    }
}

/// Runs a case with receivers and compares the velocities with the exact ones: `exact` returns the velocities along
/// all coordinates at a receiver. Components that are zero are omitted.
pub fn compare(
    settings: &Settings,
    frame: Frame,
    mut case: String,
    receivers: &[Receiver],
    exact: impl Fn(&Receiver, &[f64]) -> Vec<Vec<f64>>,
) -> Vec<Row> {
    for receiver in receivers {
        let fields: Vec<String> = (0..frame.dimensions).map(|c| frame.velocity(c)).collect();
        case += &format!(
            "[[receiver]]\nname = \"{}\"\nat = {:?}\nfields = {fields:?}\n",
            receiver.name,
            frame.place(&receiver.at)
        );
    }
    let records = records(settings, &case);
    let time = &records["time"];
    let mut rows = Vec::new();
    for receiver in receivers {
        let count = time.partition_point(|t| *t <= receiver.until);
        let exact = exact(receiver, &time[..count]);
        let max = |values: &[f64]| values.iter().fold(0f64, |max, v| max.max(v.abs()));
        let greatest = exact.iter().map(|own| max(own)).fold(0.0, f64::max);
        for (coordinate, exact) in exact.iter().enumerate() {
            if max(exact) > 1e-9 * greatest {
                let name = format!("{}.{}", receiver.name, frame.velocity(coordinate));
                let error: Error = error(&records[&name][..count], exact);
                rows.push(Row { name, distance: receiver.distance, error });
            }
        }
    }
    rows
}

/// Runs a case and returns the columns of its receiver table by name.
fn records(settings: &Settings, case: &str) -> HashMap<String, Vec<f64>> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let [file, out] = ["accuracy.toml", "out"].map(|name| folder.path().join(name));
    fs::write(&file, case).expect("a case written");
    let mut command = Command::new(settings.program);
    command.arg("run").arg(&file).arg("--out").arg(&out);
    for set in settings.sets {
        command.arg("--set").arg(set);
    }
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{}\n{case}", String::from_utf8_lossy(&output.stderr));
    let table = fs::read_to_string(out.join("receivers.csv")).expect("a table of receivers");
    let mut lines = table.lines();
    let names = lines.next().expect("a header").split(',');
    let mut columns: Vec<(String, Vec<f64>)> =
        names.map(|name| (name.to_owned(), Vec::new())).collect();
    for line in lines {
        for ((_, column), number) in columns.iter_mut().zip(line.split(',')) {
            column.push(number.parse().expect("a number"));
        }
    }
    columns.into_iter().collect()
}
