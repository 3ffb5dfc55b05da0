//! Entries `[[receiver]]` of a case: a point, a line or a grid of points.

use super::CaseError;
use super::dynamics::read::{check_inside, different};
use super::dynamics::{Interpolation, Receiver};
use super::section::{Node, Section, any_counts, joined, list_of_points, numbers, text};
use std::collections::BTreeMap;
use std::fmt::Display;

/// Most points of an entry.
const MOST_POINTS: usize = 10_000;

/// Where receivers can be.
pub(super) struct Domain<'a> {
    /// First and last coordinate along each axis, m.
    pub(super) extents: Vec<[f64; 2]>,
    /// Its name in messages.
    pub(super) whole: &'a str,
    /// Whether receivers interpolate between cells, or may do without.
    pub(super) interpolates: bool,
}

/// The receivers, which record any of the fields `all`, each of which `find` knows by its name. A line or
/// grid of `name` has the receivers `name-1`, `name-2`, … or `name-1-1`, `name-2-1`, …
///
/// # Errors
/// What is wrong, where, and what is allowed.
pub(super) fn receivers<F: Clone + PartialEq + Display>(
    root: &mut Section,
    all: &[F],
    find: impl Fn(&str) -> Option<F>,
    domain: &Domain,
) -> Result<Vec<Receiver<F>>, CaseError> {
    let words: Vec<String> = all.iter().map(F::to_string).collect();
    let mut receivers = Vec::new();
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    for (index, mut section) in root.tables("receiver")?.into_iter().enumerate() {
        let is_name = |node: &Node| {
            let stands = |c: char| c.is_alphanumeric() || "-_.".contains(c);
            text(node).filter(|name| !name.is_empty() && name.chars().all(stands))
        };
        let expected = "text in quotes (letters, digits, '-', '_' and '.')";
        let name = section.optional("name", expected, is_name)?;
        let name = name.unwrap_or_else(|| format!("r{}", index + 1));
        let points = points(&mut section, domain)?;
        let interpolation = match domain.interpolates {
            true => section
                .optional_choice("interpolation", Interpolation::ALL, Interpolation::name)?
                .unwrap_or_default(),
            false => Interpolation::Nearest,
        };
        let fields = different(&mut section, "fields", &words, &find)?;
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

/// Takes a point that misses a side by rounding onto it.
fn onto_the_grid(at: &mut [f64], extents: &[[f64; 2]]) {
    at.iter_mut().zip(extents).for_each(|(x, [first, last])| *x = x.clamp(*first, *last));
}

/// The points of an entry, with what they add to its name.
fn points(section: &mut Section, domain: &Domain) -> Result<Vec<(String, Vec<f64>)>, CaseError> {
    let d = domain.extents.len();
    let axes: Vec<usize> = (0..d).collect();
    let list = format!("a list of {d} finite numbers in m");
    let is_inside = |section: &Section, key: &str, at: &[f64]| {
        check_inside(section, key, at, &axes, &domain.extents, domain.whole)
    };
    let expected = format!("{list} (a point of the {})", domain.whole);
    let from = section.optional("from", &format!("{list} (the first point)"), numbers(d))?;
    let Some(from) = from else {
        for key in ["to", "count"] {
            if section.get(key).is_some() {
                let allowed = "add from, the first point of a line or grid, or give at, a point";
                return Err(section.error(key, "found without from", allowed));
            }
        }
        let mut at = section.required("at", &expected, numbers(d))?;
        is_inside(section, "at", &at)?;
        onto_the_grid(&mut at, &domain.extents);
        return Ok(vec![(String::new(), at)]);
    };
    if section.get("at").is_some() {
        let allowed = "give one of the two, a point or a line or grid of points";
        return Err(section.error("at", "found beside from", allowed));
    }
    let expected =
        format!("{list} (the last point of a line), or for a grid a list of such corners");
    let to = section.required("to", &expected, list_of_points(d))?;
    let expected = match to.len() {
        1 => "a whole number of at least 2 (points of the line, both ends among them)".to_owned(),
        n => format!(
            "a list of {n} whole numbers of at least 2 (points along each edge of the grid)"
        ),
    };
    let counts = section.required("count", &expected, any_counts(to.len()))?;
    let total = counts.iter().try_fold(1usize, |total, &count| total.checked_mul(count));
    let Some(total) = total.filter(|total| *total <= MOST_POINTS) else {
        let found =
            format!("found {}", joined(&counts.iter().map(usize::to_string).collect::<Vec<_>>()));
        return Err(section.error("count", found, format!("at most {MOST_POINTS} points in all")));
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
