//! Time functions of loads, sources and initial pulses.

use super::reader::SolidReader;
use crate::error::{CaseError, SourcePosition, escape};
use crate::schema::{AllowedRange, KeyCondition, KeyGroup, KeySchema, TableSchema, ValueType};
use crate::section::{SectionReader, TableWriter};
use models::common::decimal::ToPlainText;
use models::common::elementary::Elementary;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

/// Maximum size of a sample file, bytes.
const MAX_SAMPLE_FILE_SIZE: u64 = 8 << 20;

/// Key `time`: time function.
pub(super) const TIME_KEY: KeySchema = KeySchema::new_required(
    "time",
    ValueType::Table(&SCHEMA),
    "",
    "{ kind = \"pulse\", start = 0.0, duration = 0.02 }",
    "time function that multiplies the amplitude",
);

const START_KEY: KeySchema = KeySchema::new_with_default(
    "start",
    ValueType::Number(AllowedRange::Finite),
    "s",
    "0.0",
    "start time",
)
.with_note("start time");
const FREQUENCY_KEY: KeySchema = KeySchema::new_required(
    "frequency",
    ValueType::Number(AllowedRange::Positive),
    "Hz",
    "50.0",
    "frequency; for ricker the peak frequency of the spectrum",
)
.with_note("frequency");

/// Schema of the table `time` of a load, source or plane pulse.
pub(super) const SCHEMA: TableSchema = TableSchema::new_inline_table(
    "time",
    "dimensionless time function",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            "kind",
            ValueType::OneOf(|_| TimeFunction::NAMES.map(str::to_owned).to_vec()),
            "",
            "\"pulse\"",
            "step: 1 from start on, for duration if given; triangle: linear from 0 to 1 and back to 0; pulse: sin²(π(t − start)/duration); ricker: (1 − 2a) exp(−a) with a = (π frequency (t − delay))²; sine: sin(2π frequency (t − start)) from start on; table: linear interpolation of samples, 0 outside",
        )]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["step"])],
            &[
                START_KEY,
                KeySchema::new_optional("duration", ValueType::Number(AllowedRange::Positive), "s", "0.02", "duration; default: unlimited")
                    .with_note("duration"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["triangle", "pulse"])],
            &[
                START_KEY,
                KeySchema::new_required("duration", ValueType::Number(AllowedRange::Positive), "s", "0.02", "duration")
                    .with_note("duration"),
            ],
        ),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["ricker"])],
            &[
                FREQUENCY_KEY,
                KeySchema::new_optional("delay", ValueType::Number(AllowedRange::Finite), "s", "0.03", "time of the maximum; default: 1.5/frequency")
                    .with_note("time of the maximum"),
            ],
        ),
        KeyGroup::with_conditions(&[KeyCondition::HasValue("kind", &["sine"])], &[FREQUENCY_KEY, START_KEY]),
        KeyGroup::with_conditions(
            &[KeyCondition::HasValue("kind", &["table"])],
            &[
                KeySchema::new_optional(
                    "samples",
                    ValueType::Samples(["[time in s, value]", "times"]),
                    "",
                    "[[0.0, 0.0], [0.01, 1.0]]",
                    "pairs of increasing time (s) and value",
                ),
                KeySchema::new_required(
                    "file",
                    ValueType::Text,
                    "",
                    "\"load.csv\"",
                    "CSV file with two columns, time in s and value; path relative to the folder of the case file; replaces samples",
                )
                .with_note(FILE_REQUIREMENT)
                .with_remark(", or samples = [[t, value], ...]")
                .with_conditions(&[KeyCondition::Absent("samples")]),
            ],
        ),
    ],
);

/// Error text for an invalid sample file.
const FILE_REQUIREMENT: &str = "name a CSV file with two columns, time in s and value, by its path relative to the \
                     folder of the case file";

/// A dimensionless time function; times in s, frequencies in Hz.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeFunction {
    /// Step: 1 for `start` ≤ t < `start + duration` (no end without duration), else 0.
    Step {
        /// Start time, s.
        start: f64,
        /// Duration, s; `None` for a step without end.
        duration: Option<f64>,
    },
    /// Triangle: linear from 0 at `start` to 1 and back to 0 at `start + duration`; 0 outside.
    Triangle {
        /// Start time, s.
        start: f64,
        /// Duration, s; positive.
        duration: f64,
    },
    /// Pulse sin²(π(t − start)/duration) for `start` ≤ t < `start + duration`, else 0.
    Pulse {
        /// Start time, s.
        start: f64,
        /// Duration, s; positive.
        duration: f64,
    },
    /// Ricker wavelet (1 − 2a) exp(−a), a = (π·frequency·(t − delay))².
    Ricker {
        /// Peak frequency, Hz; positive.
        frequency: f64,
        /// Time of the maximum, s.
        delay: f64,
    },
    /// Sine sin(2π·frequency·(t − start)) for t ≥ `start`, else 0.
    Sine {
        /// Frequency, Hz; positive.
        frequency: f64,
        /// Start time, s.
        start: f64,
    },
    /// Linear interpolation of samples; 0 outside the sampled interval.
    Table(Samples),
}

/// Samples of a function of one variable: of the time, or of a coordinate for the profile of a load.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Pairs of time (s) or coordinate (m), strictly increasing, and value; shared by all copies of a case.
    samples: Arc<[[f64; 2]]>,
    source_file: SampleFile,
}

/// Path of the sample file, if any; ignored in comparisons.
#[derive(Clone, Debug, Default)]
struct SampleFile(Option<Arc<Path>>);

impl PartialEq for SampleFile {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Samples {
    /// Checks the samples; `None` unless there are at least two, all numbers are finite and times or coordinates
    /// strictly increase.
    pub fn new(samples: Vec<[f64; 2]>) -> Option<Self> {
        let is_finite = samples.iter().flatten().all(|x| x.is_finite());
        let increases = samples.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        (samples.len() >= 2 && is_finite && increases)
            .then(|| Self { samples: samples.into(), source_file: SampleFile::default() })
    }

    /// Returns the file from which the samples were read, if any.
    pub fn source_file(&self) -> Option<&Path> {
        self.source_file.0.as_deref()
    }

    /// Returns the pairs of time (s) or coordinate (m) and value.
    pub fn samples(&self) -> &[[f64; 2]] {
        &self.samples
    }

    /// Returns the largest magnitude of the values; interpolation does not exceed it.
    pub fn max_magnitude(&self) -> f64 {
        self.samples.iter().fold(0.0, |max, [_, value]| max.max(value.abs()))
    }

    /// Interpolates linearly at the time (s) or coordinate (m) `t`; exact at samples, 0 outside the sampled interval.
    pub(super) fn interpolate(&self, t: f64) -> f64 {
        let next = self.samples.partition_point(|[time, _]| *time <= t);
        let Some(&[before, value]) = next.checked_sub(1).and_then(|last| self.samples.get(last))
        else {
            return 0.0;
        };
        match self.samples.get(next) {
            Some(&[after, next]) => {
                let part = (t - before) / (after - before);
                value * (1.0 - part) + next * part
            }
            None if t == before => value,
            None => 0.0,
        }
    }
}

impl TimeFunction {
    /// Names of all time functions in case files.
    pub const NAMES: [&str; 6] = ["step", "triangle", "pulse", "ricker", "sine", "table"];

    /// Builds a tabulated time function; conditions as in [`Samples::new`].
    pub fn from_samples(samples: Vec<[f64; 2]>) -> Option<Self> {
        Samples::new(samples).map(Self::Table)
    }

    /// Evaluates the time function at time `t` (s).
    pub fn evaluate(&self, t: f64) -> f64 {
        // Relative time (t − start)/duration in [0, 1); `None` outside.
        let inside = |start: f64, duration: f64| {
            let part = (t - start) / duration;
            (0.0..1.0).contains(&part).then_some(part)
        };
        match *self {
            Self::Step { start, duration: None } => f64::from(t >= start),
            Self::Step { start, duration: Some(duration) } => {
                f64::from(inside(start, duration).is_some())
            }
            Self::Triangle { start, duration } => {
                inside(start, duration).map_or(0.0, |part| 1.0 - (2.0 * part - 1.0).abs())
            }
            Self::Pulse { start, duration } => {
                inside(start, duration).map_or(0.0, |part| (PI * part).cr_sin().powi(2))
            }
            Self::Ricker { frequency, delay } => {
                let a = (PI * frequency * (t - delay)).powi(2);
                // For huge a the product would be −∞ · 0 = NaN; from a = 700 on its magnitude is below 10⁻³⁰⁰.
                if a < 700.0 { (1.0 - 2.0 * a) * (-a).cr_exp() } else { 0.0 }
            }
            Self::Sine { frequency, start } if t >= start => {
                (2.0 * PI * frequency * (t - start)).cr_sin()
            }
            Self::Sine { .. } => 0.0,
            Self::Table(ref samples) => samples.interpolate(t),
        }
    }

    /// Returns the shortest time scale of the function, s: duration, period or smallest sample interval; `None` for a
    /// step without end.
    pub fn shortest_time_scale(&self) -> Option<f64> {
        match *self {
            Self::Step { duration, .. } => duration,
            Self::Triangle { duration, .. } | Self::Pulse { duration, .. } => Some(duration),
            Self::Ricker { frequency, .. } | Self::Sine { frequency, .. } => Some(1.0 / frequency),
            Self::Table(ref samples) => {
                let times = samples.samples().windows(2).map(|pair| pair[1][0] - pair[0][0]);
                times.reduce(f64::min)
            }
        }
    }

    /// Returns the samples of a tabulated function; `None` for the others, whose magnitude is at most 1.
    pub const fn samples(&self) -> Option<&Samples> {
        match self {
            Self::Table(samples) => Some(samples),
            Self::Step { .. }
            | Self::Triangle { .. }
            | Self::Pulse { .. }
            | Self::Ricker { .. }
            | Self::Sine { .. } => None,
        }
    }

    /// Returns the name of the time function in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Step { .. } => "step",
            Self::Triangle { .. } => "triangle",
            Self::Pulse { .. } => "pulse",
            Self::Ricker { .. } => "ricker",
            Self::Sine { .. } => "sine",
            Self::Table(_) => "table",
        }
    }

    /// Formats the time function as a TOML table.
    pub(super) fn to_table(&self) -> TableWriter {
        let resolved = TableWriter::default().with_text("kind", self.name());
        match self {
            Self::Step { start, duration: None } => resolved.with_number("start", start),
            Self::Step { start, duration: Some(duration) }
            | Self::Triangle { start, duration }
            | Self::Pulse { start, duration } => {
                resolved.with_number("start", start).with_number("duration", duration)
            }
            Self::Ricker { frequency, delay } => {
                resolved.with_number("frequency", frequency).with_number("delay", delay)
            }
            Self::Sine { frequency, start } => {
                resolved.with_number("frequency", frequency).with_number("start", start)
            }
            Self::Table(samples) => resolved.with_number("samples", samples.samples()),
        }
    }
}

impl SolidReader<'_> {
    /// Reads the table `time` of an entry.
    pub(super) fn read_time_function(
        &self,
        section: &SectionReader,
    ) -> Result<TimeFunction, CaseError> {
        let section = section.open_required_table("time")?;
        let kind = section.read_choice("kind", &TimeFunction::NAMES, |name| name)?;
        let function = match kind {
            "step" => TimeFunction::Step {
                start: section.read_or_default("start")?,
                duration: section.read_optional("duration")?,
            },
            "triangle" => TimeFunction::Triangle {
                start: section.read_or_default("start")?,
                duration: section.read_required("duration")?,
            },
            "pulse" => TimeFunction::Pulse {
                start: section.read_or_default("start")?,
                duration: section.read_required("duration")?,
            },
            "ricker" => {
                let frequency: f64 = section.read_required("frequency")?;
                // The default delay 1.5/frequency must be finite as well.
                if !(1.5 / frequency).is_finite() {
                    return Err(section.invalid_value_error("frequency"));
                }
                let delay = section.read_optional("delay")?;
                TimeFunction::Ricker { frequency, delay: delay.unwrap_or(1.5 / frequency) }
            }
            "sine" => TimeFunction::Sine {
                frequency: section.read_required("frequency")?,
                start: section.read_or_default("start")?,
            },
            _ => TimeFunction::Table(self.read_samples(&section)?),
        };
        section.finish()?;
        Ok(function)
    }

    /// Reads the samples given inline, or from the file named by the table.
    fn read_samples(&self, section: &SectionReader) -> Result<Samples, CaseError> {
        const TOO_FEW_SAMPLES: &str = "expected at least two lines with time in s and value";
        if let Some(pairs) = section.read_optional("samples")? {
            return Samples::new(pairs).ok_or_else(|| section.invalid_value_error("samples"));
        }
        let file: String = section.read_required("file")?;
        let path = self.case_folder.join(&file);
        let unreadable = |cause: &str| {
            section.key_error("file", format!("'{}': {cause}", escape(&file)), FILE_REQUIREMENT)
        };
        let bytes = files::read_regular_file_up_to(&path, MAX_SAMPLE_FILE_SIZE)
            .map_err(|error| unreadable(&error.to_string()))?;
        let text = std::str::from_utf8(&bytes).map_err(|_| unreadable("not UTF-8 text"))?;
        let samples = parse_samples(text).map_err(|(line, found, allowed)| CaseError::Key {
            position: SourcePosition::Line { file: path.display().to_string(), line },
            key: section.full_key("file"),
            found,
            allowed: allowed.to_owned(),
        })?;
        let found = format!("'{}' has {}", escape(&file), format_count(samples.len(), "sample"));
        let samples = Samples::new(samples)
            .ok_or_else(|| section.key_error("file", found, TOO_FEW_SAMPLES))?;
        Ok(Samples { source_file: SampleFile(Some(path.into())), ..samples })
    }
}

/// Formats a count with its noun, e.g. `1 sample`, `2 samples`.
pub(super) fn format_count(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Parses the samples of a CSV file. Blank lines, lines that begin with `#` and a header before the first sample are
/// skipped. The error has the line number (from 1), the text found and the text allowed.
fn parse_samples(text: &str) -> Result<Vec<[f64; 2]>, (usize, String, &'static str)> {
    const EXPECTED_LINE: &str =
        "expected two finite numbers separated by a comma, time in s and value";
    let mut samples: Vec<[f64; 2]> = Vec::new();
    let mut may_be_header = true;
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Vec<Option<f64>> =
            line.split(',').map(|field| field.trim().parse().ok()).collect();
        let is_header = may_be_header && numbers.iter().all(Option::is_none);
        may_be_header = false;
        match numbers[..] {
            [Some(time), Some(value)] if time.is_finite() && value.is_finite() => {
                if let Some([before, _]) = samples.last().filter(|[before, _]| *before >= time) {
                    let found = format!(
                        "found the time {time} after {before}",
                        time = time.to_plain_text(),
                        before = before.to_plain_text()
                    );
                    return Err((index + 1, found, "times must increase"));
                }
                samples.push([time, value]);
            }
            _ if is_header => {}
            _ => return Err((index + 1, format!("found '{}'", escape(line)), EXPECTED_LINE)),
        }
    }
    Ok(samples)
}
