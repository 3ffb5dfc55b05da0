//! Report on the distribution of the cells of a solid over ranks.

use super::format::{case_title, format_short};
use super::run::PolarRaster;
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::case::dynamics::SolidGrid;
use crate::study::simulate::{Bytes, RankRow, SplitResult};
use figures::{FieldAxis, FieldFigure};
use files::csv::CsvCell;
use std::fmt::Write as _;

/// Largest number of ranks in the text report; the table has all.
const MAX_LISTED_RANKS: usize = 100;

/// Largest number of cells of a picture along an axis.
const MAX_PICTURE_CELLS: usize = 800;

/// Pairs of axes of the sections that are drawn in space, and the names of their pictures.
const SECTIONS: [([usize; 2], &str); 3] =
    [([0, 1], "split-x1x2"), ([0, 2], "split-x1x3"), ([1, 2], "split-x2x3")];

const SUBSCRIPTS: [char; 3] = ['₁', '₂', '₃'];

impl Report for SplitResult {
    const NAME: &'static str = "split";
    const UNITS: &'static [(&'static str, &'static str)] = &[
        ("work_imbalance", "mean work of the ranks"),
        ("relative_work", "mean work of the ranks"),
        ("memory_bytes", "bytes"),
        ("surface_faces", "faces of cells"),
        ("messages_per_step", "1/step"),
        ("bytes_per_step", "bytes/step"),
    ];

    fn to_arguments(&self, _case: &Case) -> String {
        format!("case.toml --ranks {} --threads {}", self.ranks.len(), self.thread_count)
    }

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!(
            "{}\n{} cells in {} parts; threads of each rank: {}\n\n",
            case_title(case),
            join(&self.cell_counts),
            join(&self.part_counts),
            self.thread_count,
        );
        let axes = self.cell_counts.len();
        let width = self.cell_counts.iter().map(|own| 2 * own.to_string().len() + 3).max();
        let width = width.unwrap_or(0).max(8);
        let mut head = format!("  {:>6}", "rank");
        for subscript in &SUBSCRIPTS[..axes] {
            let _ = write!(head, "  {:>width$}", format!("along x{subscript}"));
        }
        let _ = writeln!(
            text,
            "{head}  {:>10}  {:>5}  {:>10}  {:>8}  {:>10}  {:>9}  {:>13}",
            "cells", "work", "memory", "surface", "neighbours", "messages", "sent per step"
        );
        for row in self.ranks.iter().take(MAX_LISTED_RANKS) {
            let _ = write!(text, "  {:>6}", row.rank);
            for [first, end] in &row.cells {
                let _ = write!(text, "  {:>width$}", format!("{first} … {}", end - 1));
            }
            let _ = writeln!(
                text,
                "  {:>10}  {:>5.3}  {:>10}  {:>8}  {:>10}  {:>9}  {:>13}",
                row.cell_count,
                row.relative_work,
                row.memory().to_string(),
                row.surface_faces,
                row.neighbours,
                format_short(row.messages_per_step),
                Bytes(row.bytes_per_step).to_string(),
            );
        }
        if let Some(more) = self.ranks.len().checked_sub(MAX_LISTED_RANKS).filter(|own| *own > 0) {
            let _ = writeln!(text, "  and {more} more ranks: split.csv");
        }
        let _ = writeln!(
            text,
            "\nwork: relative to the mean of all ranks; the greatest is {:.3}",
            self.work_imbalance
        );
        let _ = writeln!(
            text,
            "surface: faces of cells at cuts; messages and bytes: sent in a step, means over a pass"
        );
        if self.has_joints {
            let _ = writeln!(text, "the work of joints is not counted");
        }
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let Some(run) = &case.solid_run else { return Ok(Vec::new()) };
        let picture = |axes: [usize; 2], name: &'static str| {
            let figure = self.create_figure(case, &run.grid, axes);
            ReportPicture::new(name, move |output| figure.draw(output))
        };
        Ok(match run.grid.dimensions() {
            2 => vec![picture([0, 1], Self::NAME)],
            _ => SECTIONS.into_iter().map(|(axes, name)| picture(axes, name)).collect(),
        })
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let mut header = vec!["rank".to_owned()];
        for axis in 1..=self.cell_counts.len() {
            header.extend([format!("first_cell_x{axis}"), format!("end_cell_x{axis}")]);
        }
        header.extend(
            [
                "cells",
                "stored_cells",
                "relative_work",
                "memory_bytes",
                "surface_faces",
                "neighbours",
                "messages_per_step",
                "bytes_per_step",
            ]
            .map(str::to_owned),
        );
        let cells = |row: &RankRow| -> Vec<CsvCell> {
            let ends = row.cells.iter().flatten().map(|own| *own as f64);
            std::iter::once(row.rank as f64)
                .chain(ends)
                .chain([
                    row.cell_count as f64,
                    row.stored_cell_count as f64,
                    row.relative_work,
                    row.memory_bytes,
                    row.surface_faces as f64,
                    row.neighbours as f64,
                    row.messages_per_step,
                    row.bytes_per_step,
                ])
                .map(CsvCell::from)
                .collect()
        };
        let rows: Vec<Vec<CsvCell>> = self.ranks.iter().map(cells).collect();
        Ok(vec![("split.csv", DataFile::table("split.csv", header, rows.into_iter()))])
    }
}

impl SplitResult {
    /// Returns the rank that has a cell.
    fn find_rank(&self, cell: &[usize]) -> usize {
        let has_cell = |row: &&RankRow| {
            row.cells.iter().zip(cell).all(|(own, place)| (own[0]..own[1]).contains(place))
        };
        self.ranks.iter().find(has_cell).map_or(0, |row| row.rank)
    }

    /// Returns the rank by number of the cell along each of two axes; in space, of the section through the middle.
    fn section_ranks(&self, [x, y]: [usize; 2]) -> impl Fn([usize; 2]) -> usize {
        // Parts are between the same cuts everywhere: the rank follows from the parts along both axes.
        let mut middle: Vec<usize> = self.cell_counts.iter().map(|own| own / 2).collect();
        let parts = |axis: usize| {
            let mut starts: Vec<usize> = self.ranks.iter().map(|row| row.cells[axis][0]).collect();
            starts.sort_unstable();
            starts.dedup();
            starts
        };
        let starts = [x, y].map(parts);
        let mut ranks = Vec::new();
        for second in &starts[1] {
            for first in &starts[0] {
                (middle[x], middle[y]) = (*first, *second);
                ranks.push(self.find_rank(&middle));
            }
        }
        move |cell: [usize; 2]| {
            let part = |axis: usize| starts[axis].partition_point(|own| *own <= cell[axis]) - 1;
            ranks[part(1) * starts[0].len() + part(0)]
        }
    }

    /// Creates the picture of the parts in a plane of two axes: the number of the rank, with lines between parts.
    fn create_figure(&self, case: &Case, grid: &SolidGrid, axes: [usize; 2]) -> FieldFigure {
        let rank_of = self.section_ranks(axes);
        let mut subtitle =
            format!("{} cells in {} parts", join(&self.cell_counts), join(&self.part_counts));
        if let Some(third) = (0..self.cell_counts.len()).find(|axis| !axes.contains(axis)) {
            let place = grid.cell_centre(third, grid.cells[third] / 2);
            let _ =
                write!(subtitle, ", section x{} = {} m", SUBSCRIPTS[third], format_short(place));
        }
        let of_cells = |counts: [usize; 2], cell: &dyn Fn(usize, usize) -> usize| -> Vec<usize> {
            (0..counts[0] * counts[1])
                .map(|index| rank_of([cell(0, index % counts[0]), cell(1, index / counts[0])]))
                .collect()
        };
        let whole = axes.map(|axis| grid.cells[axis]);
        let (figure, ranks) = match PolarRaster::new(grid) {
            Some(polar) => {
                let ranks = polar.nearest(&of_cells(whole, &|_, place| place), 0);
                let figure = FieldFigure {
                    body: Some(polar.body()),
                    columns: polar.columns,
                    rows: polar.rows,
                    x: polar.x,
                    y: polar.y,
                    ..FieldFigure::default()
                };
                (figure, ranks)
            }
            None => {
                let counts = whole.map(|own| own.min(MAX_PICTURE_CELLS));
                let ranks = of_cells(counts, &|axis, place| {
                    (2 * place + 1) * whole[axis] / (2 * counts[axis])
                });
                let axis = |axis: usize| {
                    let [start, end] = grid.axis_bounds(axis);
                    FieldAxis { label: format!("x{} (m)", SUBSCRIPTS[axis]), start, end }
                };
                let figure = FieldFigure {
                    columns: counts[0],
                    rows: counts[1],
                    x: axis(axes[0]),
                    y: axis(axes[1]),
                    ..FieldFigure::default()
                };
                (figure, ranks)
            }
        };
        FieldFigure {
            title: case_title(case),
            subtitle,
            label: "number of the rank".to_owned(),
            // Neighbouring ranks differ modulo 2¹⁶ too.
            material_indices: ranks.iter().map(|own| *own as u16).collect(),
            border_label: "cut between ranks".to_owned(),
            values: ranks.into_iter().map(|own| own as f64).collect(),
            ..figure
        }
    }
}

/// Formats numbers along axes: `4 × 2`.
fn join(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ")
}
