//! Errors of runs with default settings against exact solutions, as tables in Markdown.
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

use reference::run::{Place, Settings};
use reference::{PROBLEMS, Problem, Row};
use std::path::PathBuf;

fn main() {
    let mut program = PathBuf::from(env!("CARGO_BIN_EXE_wellposed"));
    let (mut place, mut sets, mut problems) = (Place::Point, Vec::new(), Vec::new());
    let (mut up, mut kernel, mut is_spread, mut cells) = (None, None, false, Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().unwrap_or_else(|| panic!("{argument} needs a value"));
        match argument.as_str() {
            "--program" => program = value().into(),
            "--set" => sets.push(value()),
            "--up" => up = Some(value().parse::<usize>().expect("an axis from 1") - 1),
            "--cells" => {
                let numbers = value();
                cells = numbers.split(',').map(|n| n.parse().expect("a number")).collect();
            }
            "--before" => {
                let before = ["scheme.order=eno2", "scheme.splitting=two-cyclic", "time.courant=1"];
                sets.extend(before.map(str::to_owned));
                kernel = Some("cell");
            }
            "--spread" => is_spread = true,
            "--receivers" => {
                place = match value().as_str() {
                    "cell" => Place::Cell,
                    "point" => Place::Point,
                    other => panic!("--receivers {other}: allowed are cell, point"),
                }
            }
            "--bench" => {}
            name => match PROBLEMS.iter().find(|problem| problem.name == name) {
                Some(problem) => problems.push(*problem),
                None => {
                    let names = PROBLEMS.map(|problem| problem.name).join(", ");
                    panic!("{name}: no such problem or option; problems are {names}");
                }
            },
        }
    }
    if problems.is_empty() {
        problems = PROBLEMS.to_vec();
    }
    for problem in problems {
        let cells = match (cells.as_slice(), problem.dimensions) {
            ([], 3) => vec![10.0, 20.0],
            ([], _) => vec![10.0, 20.0, 40.0],
            (cells, _) => cells.to_vec(),
        };
        let run = |cells| {
            let settings =
                Settings { program: &program, cells, place, up, kernel, sets: &sets, is_spread };
            (problem.rows)(&settings)
        };
        let tables: Vec<Vec<Row>> = cells.iter().map(|cells| run(*cells)).collect();
        print(&problem, &cells, &tables);
    }
}

/// Prints the table of a problem: L2 and maximum errors, %, by receiver and component on each grid, and the order of
/// the L2 error between the two finest grids; rows are grouped by distance in wavelengths.
fn print(problem: &Problem, cells: &[f64], tables: &[Vec<Row>]) {
    let header = cells.iter().map(|cells| format!(" {cells} |")).collect::<String>();
    println!("\n| {}: L2 (max), % | wavelengths |{header} order |", problem.name);
    println!("|---|---|{}---|", "---|".repeat(cells.len()));
    for group in [0.0, 1.0, 2.0] {
        let own = |row: &&Row| row.distance > group + 1e-9 || (group == 0.0);
        let own = |row: &&Row| own(row) && row.distance <= group + 1.0 + 1e-9;
        for row in tables[0].iter().filter(own) {
            let errors: Vec<_> = tables
                .iter()
                .map(|table| {
                    table.iter().find(|other| other.name == row.name).expect("a row").error
                })
                .collect();
            let numbers: String = errors
                .iter()
                .map(|e| format!(" {:.2} ({:.2}) |", 100.0 * e.l2, 100.0 * e.max))
                .collect();
            let order = match (cells, errors.as_slice()) {
                ([.., coarse, fine], [.., a, b]) => {
                    format!("{:.2}", (a.l2 / b.l2).ln() / (fine / coarse).ln())
                }
                _ => String::new(),
            };
            println!("| {} | {:.2} |{numbers} {order} |", row.name, row.distance);
        }
    }
}
