//! Certified map: verdicts proved for all states of cells, which are boxes of the two parameters.

use crate::Error;
use crate::case::{Case, MapAxes, SweepParameter};
use crate::study::certified::{BoxAssessor, CellVerdict, Proof};
use crate::study::{ProgressCallback, report_progress};
use models::InputError;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Largest number of halvings of a cell along each axis: parts of an eighth of the step.
const MAX_HALVINGS: u32 = 3;

/// Number of parts of a cell along each axis.
pub const CELL_PARTS: usize = 1 << MAX_HALVINGS;

/// Verdicts proved for the cells between the points of a map, with refinement of those that are not decided.
#[derive(Clone, Debug, Serialize)]
pub struct CertifiedMap {
    /// Method of the proof and its assumptions.
    pub method: String,
    /// Numbers of cells along x and y.
    pub cells: [usize; 2],
    /// Numbers of cells all of whose parts have the same verdict, by its name; the others count as not decided.
    #[serde(serialize_with = "super::summary::serialize_as_object")]
    pub cell_counts: [(&'static str, usize); 4],
    /// Shares of the area of the map, of its logarithms on logarithmic axes, by the name of the verdict of its parts.
    #[serde(serialize_with = "super::summary::serialize_as_object")]
    pub area_shares: [(&'static str, f64); 4],
    /// Boxes that are not decided: lower and upper x, lower and upper y. The boundary of the verdict lies in their union.
    #[serde(rename = "undecided_boxes")]
    pub undecided: Vec<[f64; 4]>,
    /// Codes of the parts of all cells, places of [`CellVerdict::ALL`], with x fastest: [`CELL_PARTS`] parts of each cell
    /// along each axis.
    #[serde(skip)]
    pub parts: Vec<u8>,
}

/// What is known of a row of cells.
struct CellRow {
    /// Codes of the parts, with x fastest.
    parts: Vec<u8>,
    undecided: Vec<[f64; 4]>,
}

/// Computes the certified map of a case on the rayon thread pool in which it is called.
///
/// # Errors
/// The case has no map, an axis of it has one point or varies a number over which nothing is proved, or no proof is known
/// for the material or its state; [`Error::Cancelled`].
pub fn certify_map(case: &Case, progress: ProgressCallback) -> Result<CertifiedMap, Error> {
    let map = case.require_map()?;
    let proof = Proof::find(case).map_err(|error| case.locate_error(error))?;
    for (key, sweep) in [("map.x", &map.x), ("map.y", &map.y)] {
        let name = sweep.parameter.name();
        let (rejected_value, allowed_values) = if sweep.point_count < 2 {
            ("one point".into(), "expected two or more points: cells lie between them".into())
        } else if !proof.allows(&name) {
            (name, format!("a certified map varies {}", proof.allowed_names()))
        } else {
            continue;
        };
        return Err(case
            .locate_error(InputError { input: key, rejected_value, allowed_values })
            .into());
    }
    let cells = [map.x.point_count - 1, map.y.point_count - 1];
    let axes = [&map.x, &map.y].map(|sweep| Some(sweep.parameter));
    let done = AtomicUsize::new(0);
    let rows: Vec<CellRow> = (0..cells[1])
        .into_par_iter()
        .map_init(
            || RowAssessor { map, boxes: BoxAssessor::new(case, axes, proof) },
            |assessor, row| {
                let own = assessor.assess_row(row, cells[0]);
                report_progress(progress, done.fetch_add(1, Ordering::Relaxed) + 1, cells[1])?;
                Ok(own)
            },
        )
        .collect::<Result<_, Error>>()?;
    Ok(CertifiedMap::new(proof, case, cells, rows))
}

impl CertifiedMap {
    fn new(proof: Proof, case: &Case, cells: [usize; 2], rows: Vec<CellRow>) -> Self {
        let axes = case.map.iter().flat_map(|map| [&map.x, &map.y]);
        let axes: Vec<SweepParameter> = axes.map(|sweep| sweep.parameter).collect();
        let names = proof.verdict_names(case, &axes);
        let width = cells[0] * CELL_PARTS;
        let mut parts = Vec::with_capacity(width * cells[1] * CELL_PARTS);
        let mut undecided = Vec::new();
        for row in rows {
            parts.extend(row.parts);
            undecided.extend(row.undecided);
        }
        let (mut cell_counts, mut part_counts) = ([0; 4], [0_usize; 4]);
        parts.iter().for_each(|&code| part_counts[usize::from(code)] += 1);
        for row in 0..cells[1] {
            for column in 0..cells[0] {
                let first = row * CELL_PARTS * width + column * CELL_PARTS;
                let lines =
                    (0..CELL_PARTS).map(|line| &parts[first + line * width..][..CELL_PARTS]);
                let code = parts[first];
                let is_uniform = lines.flatten().all(|&own| own == code);
                let place =
                    if is_uniform { usize::from(code) } else { CellVerdict::NotDecided as usize };
                cell_counts[place] += 1;
            }
        }
        let all = parts.len() as f64;
        let shares = part_counts.map(|count| count as f64 / all);
        Self {
            method: proof.method() + proof.scope(case, &axes),
            cells,
            cell_counts: std::array::from_fn(|code| (names[code], cell_counts[code])),
            area_shares: std::array::from_fn(|code| (names[code], shares[code])),
            undecided,
            parts,
        }
    }
}

/// Position along an axis, in steps, of a place in a cell in parts of the step.
fn position(cell: usize, place: usize) -> f64 {
    cell as f64 + place as f64 / CELL_PARTS as f64
}

/// Assessor of rows of cells, one per thread.
struct RowAssessor<'a> {
    map: &'a MapAxes,
    boxes: BoxAssessor,
}

/// A square part of a cell: place of its lower corner and size, in parts of the step.
#[derive(Clone, Copy)]
struct CellPart {
    cell: [usize; 2],
    place: [usize; 2],
    size: usize,
}

impl RowAssessor<'_> {
    /// Proves verdicts over the cells of a row, and where that fails, over their quarters and the quarters of these.
    fn assess_row(&mut self, row: usize, columns: usize) -> CellRow {
        let mut own =
            CellRow { parts: vec![0; columns * CELL_PARTS * CELL_PARTS], undecided: Vec::new() };
        for column in 0..columns {
            let cell = CellPart { cell: [column, row], place: [0; 2], size: CELL_PARTS };
            if self.assess_part(cell, &mut own) == Some(CellVerdict::NotDecided) {
                own.undecided.push(self.corners(cell));
            }
        }
        own
    }

    /// Writes the codes of a part; adds the undecided boxes if it has several verdicts, and returns it if it has one.
    fn assess_part(&mut self, part: CellPart, row: &mut CellRow) -> Option<CellVerdict> {
        let verdict = self.boxes.assess(&self.ends(part)).verdict;
        let is_final = matches!(verdict, CellVerdict::WellPosed | CellVerdict::IllPosed);
        if is_final || part.size == 1 {
            let width = row.parts.len() / CELL_PARTS;
            for line in part.place[1]..part.place[1] + part.size {
                let start = line * width + part.cell[0] * CELL_PARTS + part.place[0];
                row.parts[start..start + part.size].fill(verdict as u8);
            }
            return Some(verdict);
        }
        let size = part.size / 2;
        let quarters = [[0, 0], [size, 0], [0, size], [size, size]].map(|[right, up]| CellPart {
            place: [part.place[0] + right, part.place[1] + up],
            size,
            ..part
        });
        let verdicts = quarters.map(|quarter| self.assess_part(quarter, row));
        if verdicts.iter().all(|own| *own == verdicts[0]) {
            return verdicts[0];
        }
        for (quarter, verdict) in quarters.into_iter().zip(verdicts) {
            if verdict == Some(CellVerdict::NotDecided) {
                row.undecided.push(self.corners(quarter));
            }
        }
        None
    }

    /// Lower and upper end of a part along both axes.
    fn ends(&self, part: CellPart) -> [[f64; 2]; 2] {
        let CellPart { cell, place, size } = part;
        [0, 1].map(|axis| {
            let sweep = if axis == 0 { &self.map.x } else { &self.map.y };
            [place[axis], place[axis] + size].map(|own| sweep.value_at(position(cell[axis], own)))
        })
    }

    /// Lower and upper x, lower and upper y of a part.
    fn corners(&self, part: CellPart) -> [f64; 4] {
        let [[left, right], [low, high]] = self.ends(part);
        [left, right, low, high]
    }
}
