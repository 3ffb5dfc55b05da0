//! Prints errors of runs with default settings against exact solutions, as tables in Markdown.
//!
//! `cargo bench --bench accuracy -- [PROBLEM …] [--before] [--program PATH] [--cells N,N,…] [--receivers cell|point]
//! [--up AXIS] [--set key=value] [--spread]`. PROBLEM: a name from `tests/reference`; default: all problems.
//!
//! `--before`: limited slopes, two-cyclic splitting at Courant number 1, forces and sources applied to a single cell;
//! boundaries as by default. For older programs without interpolating receivers: `--program PATH --receivers cell`.
//! `--up`: the axis normal to the surface. `--spread`: compares Lamb's problem with the exact field of the force
//! spread over the default kernel.

#[path = "../tests/reference/mod.rs"]
mod reference;

use reference::comparison::{ReceiverPlacement, ReferenceSettings};
use reference::{ComponentError, REFERENCE_PROBLEMS, ReferenceProblem};
use std::path::PathBuf;

fn main() {
    let mut program = PathBuf::from(env!("CARGO_BIN_EXE_wellposed"));
    let (mut receiver_placement, mut overrides, mut problems) =
        (ReceiverPlacement::Point, Vec::new(), Vec::new());
    let (mut surface_axis, mut kernel, mut has_kernel_convolution) = (None, None, false);
    let mut cell_counts = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().unwrap_or_else(|| panic!("{argument} needs a value"));
        match argument.as_str() {
            "--program" => program = value().into(),
            "--set" => overrides.push(value()),
            "--up" => surface_axis = Some(value().parse::<usize>().expect("an axis from 1") - 1),
            "--cells" => {
                let numbers = value();
                cell_counts = numbers.split(',').map(|n| n.parse().expect("a number")).collect();
            }
            "--before" => {
                let settings =
                    ["scheme.order=eno2", "scheme.splitting=two-cyclic", "time.courant=1"];
                overrides.extend(settings.map(str::to_owned));
                kernel = Some("cell");
            }
            "--spread" => has_kernel_convolution = true,
            "--receivers" => {
                receiver_placement = match value().as_str() {
                    "cell" => ReceiverPlacement::CellCentre,
                    "point" => ReceiverPlacement::Point,
                    other => panic!("--receivers {other}: allowed are cell, point"),
                }
            }
            "--bench" => {}
            name => match REFERENCE_PROBLEMS.iter().find(|problem| problem.name == name) {
                Some(problem) => problems.push(*problem),
                None => {
                    let names = REFERENCE_PROBLEMS.map(|problem| problem.name).join(", ");
                    panic!("{name}: no such problem or option; problems are {names}");
                }
            },
        }
    }
    if problems.is_empty() {
        problems = REFERENCE_PROBLEMS.to_vec();
    }
    for problem in problems {
        let cell_counts = match (cell_counts.as_slice(), problem.dimensions) {
            ([], 3) => vec![10.0, 20.0],
            ([], _) => vec![10.0, 20.0, 40.0],
            (counts, _) => counts.to_vec(),
        };
        let run = |cells_per_wavelength| {
            let settings = ReferenceSettings {
                program: &program,
                cells_per_wavelength,
                receiver_placement,
                surface_axis,
                kernel,
                overrides: &overrides,
                has_kernel_convolution,
            };
            (problem.compute_errors)(&settings)
        };
        let tables: Vec<Vec<ComponentError>> =
            cell_counts.iter().map(|count| run(*count)).collect();
        print_table(&problem, &cell_counts, &tables);
    }
}

/// Prints the table of a problem: L2 and maximum errors, %, by receiver and component on each grid, and the order of
/// the L2 error between the two finest grids; rows are grouped by distance in wavelengths.
fn print_table(problem: &ReferenceProblem, cell_counts: &[f64], tables: &[Vec<ComponentError>]) {
    let header = cell_counts.iter().map(|count| format!(" {count} |")).collect::<String>();
    println!("\n| {}: L2 (max), % | wavelengths |{header} order |", problem.name);
    println!("|---|---|{}---|", "---|".repeat(cell_counts.len()));
    for group in [0.0, 1.0, 2.0] {
        let is_in_group = |row: &&ComponentError| {
            (row.distance > group + 1e-9 || group == 0.0) && row.distance <= group + 1.0 + 1e-9
        };
        for row in tables[0].iter().filter(is_in_group) {
            let errors: Vec<_> = tables
                .iter()
                .map(|table| {
                    table.iter().find(|other| other.name == row.name).expect("a row").relative_error
                })
                .collect();
            let numbers: String = errors
                .iter()
                .map(|e| format!(" {:.2} ({:.2}) |", 100.0 * e.l2_error, 100.0 * e.max_error))
                .collect();
            let order = match (cell_counts, errors.as_slice()) {
                ([.., coarse, fine], [.., a, b]) => {
                    format!("{:.2}", (a.l2_error / b.l2_error).ln() / (fine / coarse).ln())
                }
                _ => String::new(),
            };
            println!("| {} | {:.2} |{numbers} {order} |", row.name, row.distance);
        }
    }
}
