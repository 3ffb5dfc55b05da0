//! The sections `[[receiver]]`: a point, a line or a grid of receivers.

use super::error::CaseError;
use super::named_enum::named_enum;
use super::position_checks::{PositionDomain, check_position};
use super::section::{SectionReader, TableWriter, join_with_commas};
use super::value::{parse_count, parse_list};
use crate::schema::{KeyCondition, KeySchema, ListLength, TableSchema, ValueType};
use std::collections::BTreeMap;
use std::fmt::Display;

/// Maximum number of points of one entry.
const MAX_POINTS_PER_ENTRY: usize = 10_000;

/// Maximum number of points of all entries.
const MAX_RECEIVERS: usize = 100_000;

const LINE_CONDITION: &[KeyCondition] = &[KeyCondition::Present("from")];

/// Key `name` of a receiver.
pub(super) const NAME_KEY: KeySchema = KeySchema::new_optional(
    "name",
    ValueType::Name,
    "",
    "\"surface\"",
    "name of the record; points of a line are named name-1, name-2, …, points of a grid name-1-1, name-2-1, …; default: r1, r2, …",
)
.with_note("letters, digits, '-', '_' and '.'");

/// Builds the key `at` of a point; `note` describes the point in messages.
pub(super) const fn new_position_key(
    note: &'static str,
    example: &'static str,
    meaning: &'static str,
) -> KeySchema {
    KeySchema::new_required("at", ValueType::Numbers(ListLength::GridAxes), "m", example, meaning)
        .with_note(note)
        .with_conditions(&[KeyCondition::Absent("from")])
}

/// Key `from`: first point of a line or grid of receivers.
pub(super) const FIRST_POINT_KEY: KeySchema = KeySchema::new_optional(
    "from",
    ValueType::Numbers(ListLength::GridAxes),
    "m",
    "[0.0, 0.0]",
    "first point of a line or grid of points; replaces at",
)
.with_note("first point of a line or grid");

/// Key `to`: last point of a line of receivers, or list of the corners of a grid that are adjacent to the first point.
pub(super) const LAST_POINT_KEY: KeySchema = KeySchema::new_required(
    "to",
    ValueType::PointList,
    "m",
    "[0.05, 0.0]",
    "last point of the line; for a grid a list of the corners adjacent to the first point",
)
.with_note("last point of a line")
.with_remark(", or for a grid a list of the adjacent corners")
.with_conditions(LINE_CONDITION);

/// Key `count`: number of points of a line, or along each edge of a grid.
pub(super) const POINT_COUNT_KEY: KeySchema = KeySchema::new_required(
    "count",
    ValueType::PointCounts,
    "",
    "5",
    "number of points of the line, ends included; for a grid a list of the numbers along each edge",
)
.with_note("number of points of the line, ends included")
.with_conditions(LINE_CONDITION);

named_enum! {
    /// Interpolation of recorded fields between cells.
    Interpolation {
        /// Cubic polynomials along each axis through cells of the medium at the receiver.
        Cubic = "cubic",
        /// Value of the nearest cell, in a flow of the nearest grid point.
        Nearest = "none"
    }
}

/// A receiver: a point at which the fields `F` of a solid or flow are recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceiverPoint<F> {
    /// Name of the record; unique.
    pub name: String,
    /// Position, m; inside the grid or box, or on its boundary.
    pub position: Vec<f64>,
    /// Interpolation between cells; always [`Interpolation::Nearest`] in a flow.
    pub interpolation: Interpolation,
    /// Recorded fields.
    pub fields: Vec<F>,
}

impl<F: Display> ReceiverPoint<F> {
    /// Builds the TOML table of the receiver, without the keys that only solids have.
    pub(super) fn to_table(&self) -> TableWriter {
        TableWriter::default()
            .with_text("name", &self.name)
            .with_number("at", &self.position)
            .with_text_list("fields", &self.fields)
    }
}

/// Domain in which receivers are placed.
pub(super) struct ReceiverDomain {
    /// Schema of the entries.
    pub(super) schema: &'static TableSchema,
    /// Lower and upper bound along each axis, m.
    pub(super) bounds: Vec<[f64; 2]>,
    pub(super) domain: PositionDomain,
    /// Whether receivers have the key `interpolation`.
    pub(super) has_interpolation: bool,
}

/// Reads the receivers, which record fields among `recorded_fields`; `find_field` finds a field by name. A line or grid
/// called `name` has the receivers `name-1`, `name-2`, … or `name-1-1`, `name-2-1`, …
///
/// # Errors
/// A key is unknown or missing, or a value is invalid.
pub(super) fn read_receivers<F: Clone + PartialEq + Display>(
    root: &SectionReader,
    recorded_fields: &[F],
    find_field: impl Fn(&str) -> Option<F>,
    domain: &ReceiverDomain,
) -> Result<Vec<ReceiverPoint<F>>, CaseError> {
    let names: Vec<String> = recorded_fields.iter().map(F::to_string).collect();
    let mut receivers = Vec::new();
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    for (index, section) in root.open_list(domain.schema)?.into_iter().enumerate() {
        let name: Option<String> = section.read_optional("name")?;
        let name = name.unwrap_or_else(|| format!("r{}", index + 1));
        let points = compute_points(&section, domain)?;
        let count = receivers.len() + points.len();
        if count > MAX_RECEIVERS {
            let found = format!("{count} points including this entry");
            return Err(root.key_error(
                "receiver",
                found,
                format!("expected at most {MAX_RECEIVERS} in total"),
            ));
        }
        let interpolation = match domain.has_interpolation {
            true => section
                .read_optional_choice("interpolation", Interpolation::ALL, Interpolation::name)?
                .unwrap_or_default(),
            false => Interpolation::Nearest,
        };
        let fields = section.read_distinct_list("fields", &names, &find_field)?;
        if fields.as_ref().is_some_and(Vec::is_empty) {
            let allowed = format!("name at least one of {}", join_with_commas(&names));
            return Err(section.key_error("fields", "an empty list", allowed));
        }
        let fields = fields.unwrap_or_else(|| recorded_fields.to_vec());
        for (suffix, at) in points {
            let name = format!("{name}{suffix}");
            if let Some(first) = taken.insert(name.clone(), index) {
                let position = root.locate(&format!("receiver[{first}]"));
                let found = format!("found '{name}', the name of receiver[{first}] ({position})");
                return Err(section.key_error("name", found, "give each receiver a unique name"));
            }
            receivers.push(ReceiverPoint {
                name,
                position: at,
                interpolation,
                fields: fields.clone(),
            });
        }
        section.finish()?;
    }
    Ok(receivers)
}

/// Clamps a point to the grid bounds, which it may exceed by rounding.
fn clamp_to_bounds(at: &mut [f64], extents: &[[f64; 2]]) {
    at.iter_mut().zip(extents).for_each(|(x, [first, last])| *x = x.clamp(*first, *last));
}

/// Computes the points of an entry, with the suffixes of their names.
fn compute_points(
    section: &SectionReader,
    domain: &ReceiverDomain,
) -> Result<Vec<(String, Vec<f64>)>, CaseError> {
    let d = domain.bounds.len();
    let axes: Vec<usize> = (0..d).collect();
    let is_inside = |section: &SectionReader, key: &str, at: &[f64]| {
        check_position(section, key, at, &axes, &domain.bounds, domain.domain)
    };
    let from: Option<Vec<f64>> = section.read_optional("from")?;
    let Some(from) = from else {
        for key in ["to", "count"] {
            if section.has_key(key) {
                let allowed =
                    "add from, the first point of a line or grid, or give at for a single point";
                return Err(section.key_error(key, "found without from", allowed));
            }
        }
        let mut at: Vec<f64> = section.read_required("at")?;
        is_inside(section, "at", &at)?;
        clamp_to_bounds(&mut at, &domain.bounds);
        return Ok(vec![(String::new(), at)]);
    };
    if section.has_key("at") {
        let allowed = "give either at (a point) or from (a line or grid of points), not both";
        return Err(section.key_error("at", "found beside from", allowed));
    }
    let to: Vec<Vec<f64>> = section.read_required("to")?;
    let counts: Vec<usize> = match to.len() {
        1 => section.read_required("count")?,
        n => {
            let expected = format!(
                "a list of {n} whole numbers of at least 2 (points along each edge of the grid)"
            );
            section.read_required_with("count", &expected, |value| {
                let counts = parse_list(value, n, parse_count)?;
                counts.iter().all(|count| *count >= 2).then_some(counts)
            })?
        }
    };
    if counts.len() != to.len() {
        return Err(section.invalid_value_error("count"));
    }
    let total = counts.iter().try_fold(1usize, |total, &count| total.checked_mul(count));
    let Some(total) = total.filter(|total| *total <= MAX_POINTS_PER_ENTRY) else {
        let found = format!(
            "found {}",
            join_with_commas(&counts.iter().map(usize::to_string).collect::<Vec<_>>())
        );
        return Err(section.key_error(
            "count",
            found,
            format!("expected at most {MAX_POINTS_PER_ENTRY} points in total"),
        ));
    };
    let mut points = Vec::with_capacity(total);
    for index in 0..total {
        let (mut rest, mut at, mut suffix) = (index, from.clone(), String::new());
        for (&count, corner) in counts.iter().zip(&to) {
            let own = rest % count;
            rest /= count;
            suffix += &format!("-{}", own + 1);
            let part = own as f64 / (count - 1) as f64;
            for (axis, x) in at.iter_mut().enumerate() {
                *x += match own + 1 == count && to.len() == 1 {
                    true => corner[axis] - *x,
                    false => part * (corner[axis] - from[axis]),
                };
            }
        }
        let key = if index == 0 { "from" } else { "to" };
        is_inside(section, key, &at)?;
        clamp_to_bounds(&mut at, &domain.bounds);
        points.push((suffix, at));
    }
    Ok(points)
}
