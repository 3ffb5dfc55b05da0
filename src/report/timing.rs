//! Report on the time of steps against the number of blocks.

use super::format::{case_title, format_short};
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::timing::{MARKED_DEVIATION, TimingResult, TimingRow};
use figures::{CurvePanel, LabelledCurve, PanelsFigure};
use files::csv::CsvCell;
use models::common::elementary::Elementary;
use std::fmt::Write as _;

const MILLISECOND: f64 = 1e-3;

impl Report for TimingResult {
    const NAME: &'static str = "time";
    const UNITS: &'static [(&'static str, &'static str)] =
        &[("cell_time", "s"), ("step_time", "s"), ("model_time", "s"), ("messages", "s, bytes/s")];

    fn to_arguments(&self, _case: &Case) -> String {
        let list = |number: fn(&TimingRow) -> usize| {
            let mut numbers: Vec<usize> = self.rows.iter().map(number).collect();
            numbers.sort_unstable();
            numbers.dedup();
            numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(",")
        };
        let blocks = list(|row| row.blocks);
        // Processes are started by a launcher.
        let ranks = match self.rows.iter().any(|row| row.are_processes) {
            true => String::new(),
            false => format!(" --ranks {}", list(|row| row.ranks)),
        };
        let Self { steps, thread_count, .. } = self;
        format!("case.toml --blocks {blocks}{ranks} --steps {steps} --threads {thread_count}")
    }

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!(
            "{}\nfastest of 3 rounds of {} steps; threads of each rank: {}\n\n",
            case_title(case),
            self.steps,
            self.thread_count,
        );
        let _ = writeln!(
            text,
            "  {:>5}  {:>6}  {:>10}  {:>12}  {:>10}  {:>9}  {:>14}",
            "ranks", "blocks", "cells", "ms per step", "model, ms", "deviation", "crossing, s"
        );
        for row in &self.rows {
            let mark = if row.deviation().abs() > MARKED_DEVIATION { "  deviates" } else { "" };
            let _ = writeln!(
                text,
                "  {:>5}  {:>6}  {:>10}  {:>12}  {:>10}  {:>7.1} %  {:>14}{mark}",
                row.ranks,
                format!("{}²", row.blocks),
                row.cells,
                format_short(row.step_time / MILLISECOND),
                format_short(row.model_time / MILLISECOND),
                100.0 * row.deviation(),
                format_short(row.crossing_time()),
            );
        }
        let _ = writeln!(
            text,
            "\nmodel: cells·t_cell + messages·latency + bytes/bandwidth of the rank with the most"
        );
        for row in self.last_rows() {
            let place = match row.are_processes {
                true => "processes of a launcher",
                false => "threads of one process",
            };
            let constants = row.messages.map_or(String::new(), |[latency, bandwidth]| {
                format!(
                    ", latency {} μs, bandwidth {} GB/s",
                    format_short(1e6 * latency),
                    format_short(1e-9 * bandwidth)
                )
            });
            let cell_time = format_short(1e9 * row.cell_time);
            let ranks = row.ranks;
            let _ = writeln!(text, "ranks {ranks}: {place}, t_cell {cell_time} ns{constants}");
        }
        for (ranks, exponent) in &self.exponents {
            let _ = writeln!(
                text,
                "ranks {ranks}: a wave crosses the medium in a time T ∝ N^{exponent:.2} (N² cells, N steps: 3)"
            );
        }
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let panel = self.create_panel();
        let figure = PanelsFigure {
            title: case_title(case),
            subtitle: "time in which a wave crosses the medium; points: measured".to_owned(),
            panels: vec![panel],
        };
        Ok(vec![ReportPicture::new(Self::NAME, move |output| figure.draw(output))])
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let header = [
            "ranks",
            "processes",
            "blocks",
            "cells",
            "step_time",
            "model_time",
            "deviation",
            "crossing_steps",
            "crossing_time",
        ];
        let rows = self.rows.iter().map(|row| {
            [
                row.ranks as f64,
                f64::from(u8::from(row.are_processes)),
                row.blocks as f64,
                row.cells as f64,
                row.step_time,
                row.model_time,
                row.deviation(),
                row.crossing_steps as f64,
                row.crossing_time(),
            ]
            .map(CsvCell::from)
            .to_vec()
        });
        Ok(vec![("time.csv", DataFile::table("time.csv", header, rows))])
    }
}

impl TimingResult {
    /// Returns the last row of each number of ranks.
    fn last_rows(&self) -> impl Iterator<Item = &TimingRow> {
        let next = self.rows.iter().skip(1).map(Some).chain([None]);
        let rows = self.rows.iter().zip(next);
        rows.filter(|(row, next)| next.is_none_or(|own| own.ranks != row.ranks)).map(|own| own.0)
    }

    /// Creates the panel of crossing times: measured points, their lines of least squares, and the model.
    fn create_panel(&self) -> CurvePanel {
        let place = |row: &TimingRow, time: f64| {
            [(row.blocks as f64).cr_log10(), time.max(f64::MIN_POSITIVE).cr_log10()]
        };
        let mut panel = CurvePanel {
            x_label: "log₁₀ of the number N of blocks along each axis".to_owned(),
            y_label: "log₁₀ of the time T (s)".to_owned(),
            points: self.rows.iter().map(|row| place(row, row.crossing_time())).collect(),
            ..CurvePanel::default()
        };
        for last in self.last_rows() {
            let own = || self.rows.iter().filter(|row| row.ranks == last.ranks);
            let model = |row: &TimingRow| row.model_time * row.crossing_steps as f64;
            panel.curves.push(LabelledCurve {
                label: format!("model, ranks: {}", last.ranks),
                points: own().map(|row| place(row, model(row))).collect(),
            });
            let exponent = self.exponents.iter().find(|found| found.0 == last.ranks);
            if let Some((_, slope)) = exponent {
                let count = own().count() as f64;
                let mean = |axis: usize| {
                    own().map(|row| place(row, row.crossing_time())[axis]).sum::<f64>() / count
                };
                let [x, y] = [mean(0), mean(1)];
                let point = |row| {
                    let at = place(row, 1.0)[0];
                    [at, y + slope * (at - x)]
                };
                panel.curves.push(LabelledCurve {
                    label: format!("fitted, ranks: {}, exponent {slope:.2}", last.ranks),
                    points: own().map(point).collect(),
                });
            }
        }
        panel
    }
}
