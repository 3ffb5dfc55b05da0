//! Errors of runs with default settings against exact solutions.
//!
//! `cargo bench --bench accuracy -- [PROBLEM] [--program PATH] [--receivers cell|point]
//! [--set key=value]`. Problems: `lamb-vertical`, `lamb-horizontal`; none: all.

#[path = "../tests/reference/lamb.rs"]
mod lamb;
#[path = "../tests/reference/mod.rs"]
mod reference;

use lamb::Place;
use std::path::PathBuf;

fn main() {
    let mut program = PathBuf::from(env!("CARGO_BIN_EXE_wellposed"));
    let (mut place, mut sets, mut problems) = (Place::Point, Vec::new(), Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().unwrap_or_else(|| panic!("{argument} needs a value"));
        match argument.as_str() {
            "--program" => program = value().into(),
            "--set" => sets.push(value()),
            "--receivers" => {
                place = match value().as_str() {
                    "cell" => Place::Cell,
                    "point" => Place::Point,
                    other => panic!("--receivers {other}: allowed are cell, point"),
                }
            }
            "--bench" => {}
            "lamb-vertical" | "lamb-horizontal" => problems.push(argument),
            other => panic!("{other}: no such problem; there are lamb-vertical, lamb-horizontal"),
        }
    }
    if problems.is_empty() {
        problems = ["lamb-vertical", "lamb-horizontal"].map(str::to_owned).to_vec();
    }
    for problem in problems {
        let tables = [10.0, 20.0, 40.0]
            .map(|n| lamb::errors(&program, problem == "lamb-vertical", n, place, &sets));
        println!("\n| {problem}, L2 (max), % | 10 | 20 | 40 | order |\n|---|---|---|---|---|");
        for (index, (name, at_10)) in tables[0].iter().enumerate() {
            let [at_20, at_40] = [tables[1][index].1, tables[2][index].1];
            let cells = [*at_10, at_20, at_40]
                .map(|e| format!("{:.2} ({:.2})", 100.0 * e.l2, 100.0 * e.max));
            let order = (at_20.l2 / at_40.l2).log2();
            println!("| {name} | {} | {order:.2} |", cells.join(" | "));
        }
    }
}
