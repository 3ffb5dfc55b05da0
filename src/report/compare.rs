//! Report on the comparison of two runs.

use super::format::format_short;
use super::run::axis_label;
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::compare::{
    BlockMeans, ComparedRun, ComparisonResult, FRONT_SHARE, MeanFields, RAY_DIRECTIONS_DEG,
    SnapshotDifference,
};
use figures::{FieldAxis, FieldFigure, FieldPairFigure, SeismogramFigure, SeismogramPanel, Trace};
use files::csv::CsvCell;
use std::fmt::Write as _;
use std::path::Path;

/// Function that returns the means of one quantity.
type MeanSelector = fn(&BlockMeans) -> &Vec<f64>;

/// Columns of the table.
const COLUMNS: [&str; 10] = [
    "time",
    "sigma22",
    "sigma12",
    "rotation_rate",
    "front_0_first",
    "front_0_second",
    "front_45_first",
    "front_45_second",
    "dissipated_first",
    "dissipated_second",
];

/// Returns a path as a word of a shell command, in quotes if it has characters with a meaning in a shell.
fn quote_path(path: &Path) -> String {
    let text = path.to_string_lossy();
    let is_plain = |c: char| c.is_alphanumeric() || "-_./".contains(c);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => text.into_owned(),
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

impl Report for ComparisonResult {
    const NAME: &'static str = "compare";
    const UNITS: &'static [(&'static str, &'static str)] =
        &[("time", "s"), ("fronts", "m"), ("size", "m"), ("dissipated", "J/m")];

    fn to_arguments(&self, _case: &Case) -> String {
        let name = |run: &ComparedRun| run.folder.as_deref().map_or("DIR".to_owned(), quote_path);
        self.runs.each_ref().map(name).join(" ")
    }

    fn to_text(&self, _case: &Case) -> String {
        let mut text = "Comparison of two runs\n".to_owned();
        for (name, run) in ["first", "second"].iter().zip(&self.runs) {
            let _ =
                writeln!(text, "  {name:<6}  {}: {}", run.title, describe_medium(run, run.model));
        }
        let [width, height] = self.averaging.size.map(format_short);
        let _ = writeln!(
            text,
            "\nRelative L2 differences of means over {} {} of {width} × {height} m. Fronts: last point on a ray at {}° and {}°\n\
             to the {} where the speed exceeds {} % of its maximum along the ray.",
            self.averaging.count,
            self.averaging.over,
            RAY_DIRECTIONS_DEG[0],
            RAY_DIRECTIONS_DEG[1],
            self.rays.reference,
            100.0 * FRONT_SHARE,
        );
        let has_dissipation = self.has_dissipation();
        let _ = write!(
            text,
            "{:>12} {:>8} {:>8} {:>8} {:>24} {:>24}",
            "t, s", "σ₂₂", "σ₁₂", "ω₃", "front at 0°, m", "front at 45°, m"
        );
        text.push_str(match has_dissipation {
            true => "           dissipated, J/m\n",
            false => "\n",
        });
        for snapshot in &self.snapshots {
            write_snapshot(&mut text, snapshot, has_dissipation);
        }
        text
    }

    fn create_pictures(&self, _case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let figure = create_time_figure(self);
        let mut pictures = vec![ReportPicture::new("compare", move |format| figure.draw(format))];
        let shown: [(&'static str, &str, MeanSelector); 3] = [
            ("compare-sigma22", "sigma22", |means| &means.normal_stress),
            ("compare-sigma12", "sigma12", |means| &means.shear_stress),
            ("compare-rotation", "w3", |means| &means.rotation_rate),
        ];
        for (stem, quantity, select) in shown {
            if self.final_means.means.iter().any(|means| select(means).is_empty()) {
                continue;
            }
            let figures = [0, 1].map(|run| create_mean_figure(self, run, quantity, select));
            let [upper, lower] = figures;
            let pair = FieldPairFigure { upper, lower };
            pictures.push(ReportPicture::new(stem, move |format| pair.draw(format)));
        }
        Ok(pictures)
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        let row = |own: &SnapshotDifference| -> Vec<CsvCell> {
            let [[front_0_first, front_0_second], [front_45_first, front_45_second]] = own.fronts;
            let [first, second] = own.dissipated.map(Some);
            let values = [
                Some(own.time),
                own.sigma22,
                own.sigma12,
                own.rotation_rate,
                front_0_first,
                front_0_second,
                front_45_first,
                front_45_second,
                first,
                second,
            ];
            values.map(|value| CsvCell::Number(value.unwrap_or(f64::NAN))).to_vec()
        };
        Ok(vec![(
            "compare.csv",
            DataFile::table("compare.csv", COLUMNS, self.snapshots.iter().map(row)),
        )])
    }
}

impl ComparisonResult {
    fn has_dissipation(&self) -> bool {
        self.dissipation.energies.iter().flatten().any(|energy| *energy > 0.0)
    }
}

/// Describes the medium and the grid of a run; `continuum` is the word for a medium without blocks.
fn describe_medium(run: &ComparedRun, continuum: &str) -> String {
    let cells: Vec<String> = run.cells.iter().map(usize::to_string).collect();
    let cells = cells.join(" × ");
    match run.blocks {
        Some(blocks) => format!("{blocks} blocks, {cells} cells"),
        None => format!("{continuum}, {cells} cells"),
    }
}

/// Writes a line of the table of differences; values that do not exist are dashes.
fn write_snapshot(text: &mut String, own: &SnapshotDifference, has_dissipation: bool) {
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.4}"));
    let percent = |value: Option<f64>| {
        value.map_or(String::new(), |value| format!(" ({:+.1} %)", 100.0 * value))
    };
    let front = |ray: usize| {
        let position =
            |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.3}"));
        let [first, second] = own.fronts[ray].map(position);
        format!("{first} / {second}{}", percent(own.front_difference(ray)))
    };
    let _ = write!(
        text,
        "{:>12} {:>8} {:>8} {:>8} {:>24} {:>24}",
        format_short(own.time),
        number(own.sigma22),
        number(own.sigma12),
        number(own.rotation_rate),
        front(0),
        front(1),
    );
    if has_dissipation {
        let [first, second] = own.dissipated.map(format_short);
        let _ = write!(text, "   {first} / {second}{}", percent(own.dissipation_difference()));
    }
    text.push('\n');
}

/// Creates the figure of differences, fronts and dissipated energies against time.
fn create_time_figure(result: &ComparisonResult) -> SeismogramFigure {
    let snapshots = &result.snapshots;
    // Without a ledger of joints or plasticity the times of the snapshots suffice.
    let has_dissipation = result.has_dissipation();
    let all_times: Vec<f64> = match has_dissipation {
        true => result.dissipation.times.clone(),
        false => snapshots.iter().map(|own| own.time).collect(),
    };
    // Nothing moves in the first snapshot.
    let start = snapshots.iter().find(|own| own.sigma22.is_some()).map_or(0.0, |own| own.time);
    let first_index = all_times.partition_point(|time| *time < start);
    let times = all_times[first_index..].to_vec();
    let trace = |name: &str, value: &dyn Fn(&SnapshotDifference) -> Option<f64>| Trace {
        name: name.to_owned(),
        values: times.iter().map(|time| interpolate_snapshots(snapshots, *time, value)).collect(),
    };
    // Both runs have the styles of the first two traces: solid, and dashed above it, so that equal values show both.
    let [first_name, second_name] = ["first run", "second run"];
    let fronts = |ray: usize| SeismogramPanel {
        label: format!("front position at {}° (m)", format_short(RAY_DIRECTIONS_DEG[ray])),
        traces: vec![
            trace(first_name, &|own| own.fronts[ray][0]),
            trace(second_name, &|own| own.fronts[ray][1]),
        ],
    };
    let mut panels = vec![fronts(0), fronts(1)];
    if has_dissipation {
        let [first, second] =
            [0, 1].map(|run| result.dissipation.energies[run][first_index..].to_vec());
        panels.push(SeismogramPanel {
            label: "dissipated energy (J/m)".to_owned(),
            traces: vec![
                Trace { name: first_name.to_owned(), values: first },
                Trace { name: second_name.to_owned(), values: second },
            ],
        });
    }
    panels.push(SeismogramPanel {
        label: "relative L2 difference of means".to_owned(),
        traces: vec![
            trace("σ₂₂", &|own| own.sigma22),
            trace("σ₁₂", &|own| own.sigma12),
            trace("ω₃", &|own| own.rotation_rate),
        ],
    });
    // The legend has the traces: those without values, such as rotations of classical solids, would not be drawn.
    for panel in &mut panels {
        panel.traces.retain(|trace| trace.values.iter().any(|value| value.is_finite()));
    }
    if panels.iter().any(|panel| !panel.traces.is_empty()) {
        panels.retain(|panel| !panel.traces.is_empty());
    }
    let [first, second] = &result.runs;
    SeismogramFigure {
        title: "Comparison of two runs".to_owned(),
        subtitle: format!("first: {}; second: {}", first.title, second.title),
        time_label: "time t (s)".to_owned(),
        panels,
        times,
    }
}

/// Interpolates a value of the snapshots linearly in time; not-a-number between snapshots one of which has no value.
fn interpolate_snapshots(
    snapshots: &[SnapshotDifference],
    time: f64,
    value: &dyn Fn(&SnapshotDifference) -> Option<f64>,
) -> f64 {
    let at = |index: usize| snapshots.get(index).and_then(value).unwrap_or(f64::NAN);
    let upper = snapshots.partition_point(|own| own.time < time);
    if upper == 0 || upper == snapshots.len() {
        let is_exact = snapshots.get(upper).is_some_and(|own| own.time == time);
        return if is_exact { at(upper) } else { f64::NAN };
    }
    let [from, to] = [snapshots[upper - 1].time, snapshots[upper].time];
    let share = (time - from) / (to - from);
    match share {
        1.0 => at(upper),
        share => at(upper - 1) + share * (at(upper) - at(upper - 1)),
    }
}

/// Creates the figure of the means of one run at the last time.
fn create_mean_figure(
    result: &ComparisonResult,
    run: usize,
    quantity: &str,
    select: MeanSelector,
) -> FieldFigure {
    let MeanFields { time, cells, bounds, means } = &result.final_means;
    let axis = |index: usize, label: &str| FieldAxis {
        label: label.to_owned(),
        start: bounds[index][0],
        end: bounds[index][1],
    };
    let described = &result.runs[run];
    FieldFigure {
        title: described.title.clone(),
        subtitle: format!(
            "{}, means over areas of {}, t = {} s",
            describe_medium(described, "continuum"),
            result.averaging.over,
            format_short(*time)
        ),
        x: axis(0, "x₁ (m)"),
        y: axis(1, "x₂ (m)"),
        columns: cells[0],
        rows: cells[1],
        values: select(&means[run]).clone(),
        label: axis_label(quantity),
        is_signed: true,
        ..FieldFigure::default()
    }
}
