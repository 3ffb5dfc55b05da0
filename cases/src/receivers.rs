//! The sections `[[receiver]]`: a point, a line or a grid of receivers.

use super::error::CaseError;
use super::named_enum::named_enum;
use super::position::check_inside;
use super::section::{Resolved, Section, joined};
use super::value::{count, list};
use crate::schema::{Condition, Form, Item, Length, Type};
use std::collections::BTreeMap;
use std::fmt::Display;

/// Maximum number of points of one entry.
const MAX_POINTS: usize = 10_000;

/// Maximum number of points of all entries.
const MAX_RECEIVERS: usize = 100_000;

const LINE: &[Condition] = &[Condition::Present("from")];

/// Key `name` of a receiver.
pub(super) const NAME: Item = Item::optional(
    "name",
    Type::Name,
    "",
    "\"surface\"",
    "names the record; of a line name-1, name-2, …, of a grid name-1-1, name-2-1, …; default r1, r2, …",
)
.note("letters, digits, '-', '_' and '.'");

/// Builds the key `at` of a point; `note` describes the point in messages.
pub(super) const fn at(note: &'static str, example: &'static str, meaning: &'static str) -> Item {
    Item::required("at", Type::Numbers(Length::Axes), "m", example, meaning)
        .note(note)
        .when(&[Condition::Absent("from")])
}

/// Key `from`: first point of a line or grid of receivers.
pub(super) const FROM: Item = Item::optional(
    "from",
    Type::Numbers(Length::Axes),
    "m",
    "[0.0, 0.0]",
    "in place of at: the first point of a line or grid of points",
)
.note("the first point");

/// Key `to`: last point of a line of receivers, or list of the other corners of a grid.
pub(super) const TO: Item = Item::required(
    "to",
    Type::Points,
    "m",
    "[0.05, 0.0]",
    "the last point of the line; of a grid a list of the corners beside the first one",
)
.note("the last point of a line")
.remark(", or for a grid a list of such corners")
.when(LINE);

/// Key `count`: number of points of a line, or along each edge of a grid.
pub(super) const COUNT: Item = Item::required(
    "count",
    Type::Divisions,
    "",
    "5",
    "points of the line, both ends among them; of a grid a list of the points along each edge",
)
.note("points of the line, both ends among them")
.when(LINE);

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
pub struct Receiver<F> {
    /// Name of the record; unique.
    pub name: String,
    /// Position, m; inside the grid.
    pub at: Vec<f64>,
    /// Interpolation between cells.
    pub interpolation: Interpolation,
    /// Recorded fields.
    pub fields: Vec<F>,
}

impl<F: Display> Receiver<F> {
    /// Builds the table of the entry, without the keys that only solids have.
    pub(super) fn resolved(&self) -> Resolved {
        Resolved::default()
            .text("name", &self.name)
            .number("at", &self.at)
            .texts("fields", &self.fields)
    }
}

/// Domain in which receivers are placed.
pub(super) struct Domain<'a> {
    /// Schema of the entries.
    pub(super) form: &'static Form,
    /// Lower and upper bound along each axis, m.
    pub(super) extents: Vec<[f64; 2]>,
    /// Name of the domain in messages.
    pub(super) whole: &'a str,
    /// Whether receivers have the key `interpolation`.
    pub(super) interpolates: bool,
}

/// Reads the receivers, which record fields among `all`; `find` finds a field by name. A line or grid called `name` has
/// the receivers `name-1`, `name-2`, … or `name-1-1`, `name-2-1`, …
///
/// # Errors
/// A key is unknown or missing, or a value is invalid.
pub(super) fn receivers<F: Clone + PartialEq + Display>(
    root: &Section,
    all: &[F],
    find: impl Fn(&str) -> Option<F>,
    domain: &Domain,
) -> Result<Vec<Receiver<F>>, CaseError> {
    let words: Vec<String> = all.iter().map(F::to_string).collect();
    let mut receivers = Vec::new();
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    for (index, section) in root.list(domain.form)?.into_iter().enumerate() {
        let name: Option<String> = section.optional("name")?;
        let name = name.unwrap_or_else(|| format!("r{}", index + 1));
        let points = points(&section, domain)?;
        let count = receivers.len() + points.len();
        if count > MAX_RECEIVERS {
            let found = format!("{count} points with those of this entry");
            return Err(root.error("receiver", found, format!("at most {MAX_RECEIVERS} in all")));
        }
        let interpolation = match domain.interpolates {
            true => section
                .optional_choice("interpolation", Interpolation::ALL, Interpolation::name)?
                .unwrap_or_default(),
            false => Interpolation::Nearest,
        };
        let fields = section.different("fields", &words, &find)?;
        if fields.as_ref().is_some_and(Vec::is_empty) {
            let allowed = format!("name at least one of {}", joined(&words));
            return Err(section.error("fields", "an empty list", allowed));
        }
        let fields = fields.unwrap_or_else(|| all.to_vec());
        for (suffix, at) in points {
            let name = format!("{name}{suffix}");
            if let Some(first) = taken.insert(name.clone(), index) {
                let place = root.place(&format!("receiver[{first}]"));
                let found = format!("found '{name}', the name of receiver[{first}] ({place})");
                return Err(section.error("name", found, "give each receiver its own name"));
            }
            receivers.push(Receiver { name, at, interpolation, fields: fields.clone() });
        }
        section.finish()?;
    }
    Ok(receivers)
}

/// Clamps a point to the grid bounds, which it may exceed by rounding.
fn onto_the_grid(at: &mut [f64], extents: &[[f64; 2]]) {
    at.iter_mut().zip(extents).for_each(|(x, [first, last])| *x = x.clamp(*first, *last));
}

/// Computes the points of an entry, with the suffixes of their names.
fn points(section: &Section, domain: &Domain) -> Result<Vec<(String, Vec<f64>)>, CaseError> {
    let d = domain.extents.len();
    let axes: Vec<usize> = (0..d).collect();
    let is_inside = |section: &Section, key: &str, at: &[f64]| {
        check_inside(section, key, at, &axes, &domain.extents, domain.whole)
    };
    let from: Option<Vec<f64>> = section.optional("from")?;
    let Some(from) = from else {
        for key in ["to", "count"] {
            if section.has(key) {
                let allowed = "add from, the first point of a line or grid, or give at, a point";
                return Err(section.error(key, "found without from", allowed));
            }
        }
        let mut at: Vec<f64> = section.required("at")?;
        is_inside(section, "at", &at)?;
        onto_the_grid(&mut at, &domain.extents);
        return Ok(vec![(String::new(), at)]);
    };
    if section.has("at") {
        let allowed = "give one of the two, a point or a line or grid of points";
        return Err(section.error("at", "found beside from", allowed));
    }
    let to: Vec<Vec<f64>> = section.required("to")?;
    let counts: Vec<usize> = match to.len() {
        1 => section.required("count")?,
        n => {
            let expected = format!(
                "a list of {n} whole numbers of at least 2 (points along each edge of the grid)"
            );
            section.required_as("count", &expected, |value| {
                let counts = list(value, n, count)?;
                counts.iter().all(|count| *count >= 2).then_some(counts)
            })?
        }
    };
    if counts.len() != to.len() {
        return Err(section.wrong("count"));
    }
    let total = counts.iter().try_fold(1usize, |total, &count| total.checked_mul(count));
    let Some(total) = total.filter(|total| *total <= MAX_POINTS) else {
        let found =
            format!("found {}", joined(&counts.iter().map(usize::to_string).collect::<Vec<_>>()));
        return Err(section.error("count", found, format!("at most {MAX_POINTS} points in all")));
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
        onto_the_grid(&mut at, &domain.extents);
        points.push((suffix, at));
    }
    Ok(points)
}
