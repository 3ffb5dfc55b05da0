//! The section `[load_path]`: strain or stress against time.

use crate::error::CaseError;
use crate::named_enum::named_enum;
use crate::schema::{
    AllowedRange, KeyCondition, KeyGroup, KeySchema, SchemaScope, TableSchema, ValueType,
};
use crate::section::{SectionReader, TableWriter};
use models::common::decimal::ToPlainText;
use models::rheology::load_path::{LoadPath, LoadPathError, MAX_STEPS};
use models::rheology::scheme::LoadControl;

const CONTROL_KEY: &str = "control";
const POINTS_KEY: &str = "points";
const TURNING_VALUES_KEY: &str = "turning_values";
const CYCLES_KEY: &str = "cycles";
const RATE_KEY: &str = "rate";
const STEPS_KEY: &str = "steps";

named_enum! {
    /// Names of the controlled quantity.
    ControlName {
        /// The strain is prescribed.
        Strain = "strain",
        /// The stress is prescribed.
        Stress = "stress"
    }
}

impl ControlName {
    const fn control(self) -> LoadControl {
        match self {
            Self::Strain => LoadControl::Strain,
            Self::Stress => LoadControl::Stress,
        }
    }
}

/// Load path as given in a case file.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadHistory {
    /// Points of time (s) and strain or stress (Pa).
    Points,
    /// Cycles between turning values of strain or stress (Pa).
    Cycles {
        /// Values at which the path turns, in turn.
        turning_values: Vec<f64>,
        /// Number of cycles.
        cycles: usize,
        /// Rate of the value, 1/s or Pa/s.
        rate: f64,
    },
}

/// Condition of keys of paths through points.
const WITH_POINTS: KeyCondition = KeyCondition::Absent(TURNING_VALUES_KEY);
/// Condition of keys of cycles.
const WITH_CYCLES: KeyCondition = KeyCondition::Present(TURNING_VALUES_KEY);

/// Schema of the section `[load_path]`.
pub(super) const LOAD_PATH_SCHEMA: TableSchema = TableSchema {
    // Not in a simulation.
    is_required: false,
    ..TableSchema::new_section(
    "load_path",
    "strain or stress of the rheological scheme against time, linear between points or in cycles, from rest",
    &[
        KeyGroup::new(&[KeySchema::new_with_default(
            CONTROL_KEY,
            ValueType::OneOf(|_: &SchemaScope| {
                ControlName::ALL.iter().map(|own| own.name().to_owned()).collect()
            }),
            "",
            "\"strain\"",
            "prescribed quantity, positive in tension",
        )]),
        KeyGroup::with_conditions(
            &[WITH_POINTS],
            &[KeySchema::new_required(
                POINTS_KEY,
                ValueType::Samples(["[time, value]", "times"]),
                "",
                "[[0.0, 0.0], [1.0, -0.05], [2.0, 0.0]]",
                "pairs of time in s and strain, or stress in Pa; a first value other than 0 is applied as a jump",
            )],
        ),
        KeyGroup::new(&[KeySchema::new_optional(
            TURNING_VALUES_KEY,
            ValueType::NumberList(1, AllowedRange::Finite),
            "",
            "[-0.05, 0.01]",
            "strains, or stresses in Pa, at which a cyclic path turns, from 0 on; in place of points",
        )]),
        KeyGroup::with_conditions(
            &[WITH_CYCLES],
            &[
                KeySchema::new_with_default(
                    CYCLES_KEY,
                    ValueType::WholeNumber(1),
                    "",
                    "1",
                    "how often the turning values are passed",
                ),
                KeySchema::new_required(
                    RATE_KEY,
                    ValueType::Number(AllowedRange::Positive),
                    "1/s or Pa/s",
                    "0.01",
                    "magnitude of the rate of strain or stress",
                ),
            ],
        ),
        KeyGroup::new(&[KeySchema::new_with_default(
            STEPS_KEY,
            ValueType::WholeNumber(1),
            "",
            "200",
            "implicit steps between two points or turning values",
        )]),
    ],
)
.with_remedy("[load_path] with points, or with turning_values and rate")
};

/// Reads the section in `root`.
///
/// # Errors
/// The section or a key is missing, a key is unknown, or a value is invalid.
pub(super) fn read(root: &SectionReader) -> Result<(LoadHistory, LoadPath), CaseError> {
    let section = root.open_required_section(&LOAD_PATH_SCHEMA)?;
    let found = section.read_optional_choice(CONTROL_KEY, ControlName::ALL, ControlName::name)?;
    let control = found.unwrap_or_default().control();
    let steps: usize = section.read_or_default(STEPS_KEY)?;
    let (history, path) = match section.read_optional::<Vec<f64>>(TURNING_VALUES_KEY)? {
        None => {
            let points: Vec<[f64; 2]> = section.read_required(POINTS_KEY)?;
            (LoadHistory::Points, LoadPath::new(control, points, steps))
        }
        Some(turning_values) => {
            let cycles = section.read_or_default(CYCLES_KEY)?;
            let rate = section.read_required(RATE_KEY)?;
            let path = LoadPath::from_cycles(control, &turning_values, cycles, rate, steps);
            (LoadHistory::Cycles { turning_values, cycles, rate }, path)
        }
    };
    let path = path.map_err(|error| locate_path_error(&section, &history, error))?;
    section.finish()?;
    Ok((history, path))
}

fn locate_path_error(
    section: &SectionReader,
    history: &LoadHistory,
    error: LoadPathError,
) -> CaseError {
    match error {
        LoadPathError::StepCount(count) => {
            let allowed = format!("expected at most {MAX_STEPS} steps in total");
            section.key_error(STEPS_KEY, format!("{count} steps in total"), allowed)
        }
        LoadPathError::Rate(rate) => {
            let allowed = "give a rate at which every segment takes a finite time above 0";
            section.key_error(
                RATE_KEY,
                format!("found {rate}", rate = rate.to_plain_text()),
                allowed,
            )
        }
        LoadPathError::TooFewPoints if *history != LoadHistory::Points => {
            let allowed = "give at least one value other than 0";
            section.key_error(TURNING_VALUES_KEY, "found no turning value", allowed)
        }
        error => section.key_error(
            history.values_key(),
            error.to_string(),
            "give increasing times and finite values",
        ),
    }
}

impl LoadHistory {
    /// Returns the key of the prescribed values.
    pub(super) fn values_key(&self) -> &'static str {
        match self {
            Self::Points => POINTS_KEY,
            Self::Cycles { .. } => TURNING_VALUES_KEY,
        }
    }

    /// Formats the section as TOML.
    pub(super) fn to_toml(&self, path: &LoadPath) -> String {
        let control = ControlName::ALL.iter().find(|own| own.control() == path.control());
        let control = control.copied().unwrap_or_default();
        let section = TableWriter::default().with_text(CONTROL_KEY, control.name());
        let section = match self {
            Self::Points => section.with_number(POINTS_KEY, path.points()),
            Self::Cycles { turning_values, cycles, rate } => section
                .with_number(TURNING_VALUES_KEY, turning_values)
                .with_number(CYCLES_KEY, cycles)
                .with_number(RATE_KEY, rate),
        };
        section.with_number(STEPS_KEY, path.steps_per_segment()).to_section_toml(&LOAD_PATH_SCHEMA)
    }
}
