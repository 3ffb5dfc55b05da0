//! Writes case files, runs a program with them, and compares its seismograms with exact solutions.

use super::{ComponentError, IsotropicSolid, RelativeError, compute_relative_error};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Position of the receivers whose records are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReceiverPlacement {
    /// The given point, between cell centres.
    Point,
    /// Centre of the cell that contains the point.
    CellCentre,
}

/// Solver settings of the reference problems.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceSettings<'a> {
    pub program: &'a Path,
    pub cells_per_wavelength: f64,
    pub receiver_placement: ReceiverPlacement,
    /// Axis normal to the surface or interface, counted from 0; `None`: the last axis.
    pub surface_axis: Option<usize>,
    /// Kernel of point loads and sources; `None`: the default. With `cell` the grid is shifted so that the source is
    /// at the centre of a cell or of its face.
    pub kernel: Option<&'a str>,
    /// Settings passed to the program by `--set`.
    pub overrides: &'a [String],
    /// Whether the exact solution is convolved with the default kernel of the simulation (Lamb's problem).
    pub has_kernel_convolution: bool,
}

impl<'a> ReferenceSettings<'a> {
    /// Creates settings with all defaults.
    pub fn new(program: &'a Path, cells_per_wavelength: f64) -> Self {
        Self {
            program,
            cells_per_wavelength,
            receiver_placement: ReceiverPlacement::Point,
            surface_axis: None,
            kernel: None,
            overrides: &[],
            has_kernel_convolution: false,
        }
    }

    /// Shift of the grid in cells: ½ puts the source at the centre of a cell, for the kernel `cell` and for receivers
    /// at cell centres (older programs).
    pub fn grid_shift(&self) -> f64 {
        if self.kernel == Some("cell") || self.receiver_placement == ReceiverPlacement::CellCentre {
            0.5
        } else {
            0.0
        }
    }

    /// Line of the case file with the kernel; empty for the default kernel.
    pub fn format_kernel(&self) -> String {
        self.kernel.map_or(String::new(), |kernel| format!("kernel = \"{kernel}\"\n"))
    }
}

/// Mapping between coordinates (horizontal ones first, upwards last) and the axes of the case.
#[derive(Clone, Copy, Debug)]
pub struct AxisMapping {
    dimensions: usize,
    surface_axis: usize,
}

impl AxisMapping {
    pub fn new(dimensions: usize, settings: &ReferenceSettings) -> Self {
        Self { dimensions, surface_axis: settings.surface_axis.unwrap_or(dimensions - 1) }
    }

    /// Axis, counted from 0, of each coordinate.
    fn coordinate_axes(self) -> Vec<usize> {
        (0..self.dimensions)
            .filter(|axis| *axis != self.surface_axis)
            .chain([self.surface_axis])
            .collect()
    }

    /// Reorders values given by coordinate into the order of the axes.
    pub fn to_axis_order<T: Copy>(self, values: &[T]) -> Vec<T> {
        let axes = self.coordinate_axes();
        let coordinate = |axis| axes.iter().position(|other| *other == axis).expect("all axes");
        (0..self.dimensions).map(|axis| values[coordinate(axis)]).collect()
    }

    /// Whether the axes have the opposite handedness of the coordinates, in two dimensions.
    pub fn is_mirrored(self) -> bool {
        self.surface_axis == 0
    }

    /// Name of the velocity component along a coordinate.
    pub fn velocity_name(self, coordinate: usize) -> String {
        format!("v{}", self.coordinate_axes()[coordinate] + 1)
    }

    /// Name of the stress component along a coordinate on the boundary normal to the last coordinate.
    pub fn traction_name(self, coordinate: usize) -> String {
        format!("sigma{}{}", self.coordinate_axes()[coordinate] + 1, self.surface_axis + 1)
    }

    /// Name of the boundary normal to a coordinate, at its lower or upper end.
    pub fn boundary_name(self, coordinate: usize, is_upper: bool) -> String {
        format!("x{}{}", self.coordinate_axes()[coordinate] + 1, if is_upper { '+' } else { '-' })
    }

    /// First sections of a case file: solid, grid with `cells` cells of size `spacing` (m) and its lower corner at
    /// `low` (in cells), and duration (s).
    pub fn format_leading_sections(
        self,
        solid: &IsotropicSolid,
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
            format_moduli(solid, "\n") + "\n",
            self.to_axis_order(&count),
            self.to_axis_order(&origin),
        )
    }

    /// Boundary sections of the kind `kind`, for (coordinate, whether upper).
    pub fn format_boundaries(self, kind: &str, sides: &[(usize, bool)]) -> String {
        let entry = |(coordinate, is_upper): &(usize, bool)| {
            let side = self.boundary_name(*coordinate, *is_upper);
            format!("[[boundary]]\nside = \"{side}\"\nkind = \"{kind}\"\n")
        };
        sides.iter().map(entry).collect()
    }
}

/// Moduli and density as keys of a case file.
pub fn format_moduli(solid: &IsotropicSolid, separator: &str) -> String {
    let IsotropicSolid { lambda, mu, density } = solid;
    format!("lambda = {lambda}{separator}mu = {mu}{separator}density = {density}")
}

/// Receiver of a reference problem.
#[derive(Clone, Debug)]
pub struct ReferenceReceiver {
    pub name: &'static str,
    /// Coordinates of the receiver, m; the last one is upwards.
    pub position: Vec<f64>,
    /// Distance from the source (oblique pulses: from the interface), in wavelengths of the problem.
    pub distance: f64,
    /// End of the compared time interval, s; infinite: the complete record is compared.
    pub end_time: f64,
}

impl ReferenceReceiver {
    /// Receiver at coordinates in wavelengths; with [`ReceiverPlacement::CellCentre`] moved to the centre of the cell
    /// that contains the point, on a face to that of the lower cell. A corner of the grid cells is at −`offset`, in
    /// cells.
    pub fn new(
        name: &'static str,
        position: &[f64],
        distance: f64,
        wavelength: f64,
        (settings, offset): (&ReferenceSettings, &[f64]),
    ) -> Self {
        let h = wavelength / settings.cells_per_wavelength;
        let place = |(x, offset): (&f64, &f64)| match settings.receiver_placement {
            ReceiverPlacement::Point => x * wavelength,
            ReceiverPlacement::CellCentre => {
                ((x * settings.cells_per_wavelength + offset - 1e-6).floor() + 0.5 - offset) * h
            }
        };
        let position = position.iter().zip(offset).map(place).collect();
        Self { name, position, distance, end_time: f64::INFINITY }
    }
}

/// Runs a case with receivers and compares the velocities with the exact ones: `exact_velocities` returns those along
/// all coordinates at a receiver and given times. Components that are zero are omitted.
pub fn run_and_compare(
    settings: &ReferenceSettings,
    axes: AxisMapping,
    mut case: String,
    receivers: &[ReferenceReceiver],
    exact_velocities: impl Fn(&ReferenceReceiver, &[f64]) -> Vec<Vec<f64>>,
) -> Vec<ComponentError> {
    for receiver in receivers {
        let fields: Vec<String> = (0..axes.dimensions).map(|c| axes.velocity_name(c)).collect();
        case += &format!(
            "[[receiver]]\nname = \"{}\"\nat = {:?}\nfields = {fields:?}\n",
            receiver.name,
            axes.to_axis_order(&receiver.position)
        );
    }
    let records = run_and_read_receivers(settings, &case);
    let time = &records["time"];
    let mut rows = Vec::new();
    for receiver in receivers {
        let count = time.partition_point(|t| *t <= receiver.end_time);
        let exact_velocities = exact_velocities(receiver, &time[..count]);
        let max = |values: &[f64]| values.iter().fold(0f64, |max, v| max.max(v.abs()));
        let largest = exact_velocities.iter().map(|values| max(values)).fold(0.0, f64::max);
        for (coordinate, exact_velocities) in exact_velocities.iter().enumerate() {
            if max(exact_velocities) > 1e-9 * largest {
                let name = format!("{}.{}", receiver.name, axes.velocity_name(coordinate));
                let error: RelativeError =
                    compute_relative_error(&records[&name][..count], exact_velocities);
                rows.push(ComponentError {
                    name,
                    distance: receiver.distance,
                    relative_error: error,
                });
            }
        }
    }
    rows
}

/// Runs a case and returns the columns of its receiver table by name.
fn run_and_read_receivers(settings: &ReferenceSettings, case: &str) -> HashMap<String, Vec<f64>> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let [file, out] = ["accuracy.toml", "out"].map(|name| folder.path().join(name));
    fs::write(&file, case).expect("a case written");
    let mut command = Command::new(settings.program);
    command.arg("run").arg(&file).arg("--out").arg(&out);
    for setting in settings.overrides {
        command.arg("--set").arg(setting);
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
