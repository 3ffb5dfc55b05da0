//! The section `[map]`: the parameter sweep of `wellposed map`.

use super::entries::Entries;
use super::error::{CaseError, escape};
use super::flat::wave_number;
use super::keys::{Key, Parameter};
use super::kind::Medium;
use super::numbers::Numbers;
use super::value::{Value, nearest, suggestion};

/// Maximum number of points of a map.
pub const MAX_POINTS: usize = 100_000_000;

/// The two swept parameters of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Sweep along the horizontal axis.
    pub x: Sweep,
    /// Sweep along the vertical axis.
    pub y: Sweep,
}

/// Sweep of one parameter along an axis of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Swept parameter.
    pub parameter: Parameter,
    /// First value, in the unit of the parameter.
    pub from: f64,
    /// Last value, in the unit of the parameter.
    pub to: f64,
    /// Number of values; at least 1. Neighbouring values differ.
    pub points: usize,
}

impl Sweep {
    /// Computes the value at `index` < `points`, evenly spaced from `from` to `to`.
    ///
    /// The only division is the last operation, so that whole-number ends give exact whole numbers between them.
    pub fn value(&self, index: usize) -> f64 {
        if index == 0 || self.points < 2 {
            return self.from;
        }
        let (last, index) = ((self.points - 1) as f64, index as f64);
        let value = (self.from * (last - index) + self.to * index) / last;
        if value.is_finite() {
            value
        } else {
            // The products above overflow for huge ends; the quotients do not.
            self.from * ((last - index) / last) + self.to * (index / last)
        }
    }
}

/// Formats the sweep as an inline TOML table.
impl std::fmt::Display for Sweep {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, points) = (Value::Text(self.parameter.name()), self.points);
        let (from, to) = (Value::Number(self.from), Value::Number(self.to));
        write!(formatter, "{{ parameter = {name}, from = {from}, to = {to}, points = {points} }}")
    }
}

impl Map {
    /// Reads the section `[map]`; `numbers` are the numbers of the case, `has_active` states whether the case declares
    /// active yield conditions.
    pub(super) fn read(
        entries: &Entries,
        medium: Medium,
        numbers: &Numbers,
        has_active: bool,
    ) -> Result<Option<Self>, CaseError> {
        if !entries.has_section("map") {
            return Ok(None);
        }
        let x =
            sweep(entries, medium, ["map.x.parameter", "map.x.from", "map.x.to", "map.x.points"])?;
        let y =
            sweep(entries, medium, ["map.y.parameter", "map.y.from", "map.y.to", "map.y.points"])?;
        if x.parameter == y.parameter {
            return Err(entries.places.error(
                "map.y.parameter",
                format!("found {} on both axes", y.parameter.name()),
                "sweep two different parameters",
            ));
        }
        if x.points.checked_mul(y.points).is_none_or(|points| points > MAX_POINTS) {
            let larger = if x.points > y.points { "map.x.points" } else { "map.y.points" };
            return Err(entries.places.error(
                larger,
                format!("a grid of {} × {} points", x.points, y.points),
                format!("expected at most {MAX_POINTS} points in all"),
            ));
        }
        let map = Self { x, y };
        let swept = [("map.x", map.x), ("map.y", map.y)];
        let of_stress = |sweep: &Sweep| sweep.parameter.key().name.starts_with("stress.");
        if let (Some((axis, sweep)), true) =
            (swept.into_iter().find(|s| of_stress(&s.1)), has_active)
        {
            let found = format!("a sweep of {} beside yield.active", sweep.parameter.name());
            let allowed = "leave yield.active out: either decides what yields";
            return Err(entries.places.error(axis, found, allowed));
        }
        let sweeps_elevation =
            [x, y].iter().any(|sweep| sweep.parameter.name() == "wave.elevation_deg");
        if sweeps_elevation && numbers.dimensions == 2 {
            let allowed = "waves stay in the plane, unless model.dimensions = 3";
            let found = "a sweep of wave.elevation_deg in plane strain";
            return Err(entries.places.error("map", found, allowed));
        }
        Ok(Some(map))
    }
}

fn sweep(
    entries: &Entries,
    medium: Medium,
    [parameter_key, from_key, to_key, points_key]: [&'static str; 4],
) -> Result<Sweep, CaseError> {
    let name = entries.text(parameter_key)?;
    let found = Parameter::find(name).filter(|parameter| parameter.key().is_used_by(medium));
    let Some(parameter) = found else {
        return Err(no_parameter(entries, medium, parameter_key, name));
    };
    let (from, to) = (entries.number(from_key)?, entries.number(to_key)?);
    let points = match entries.require(points_key)? {
        Value::Count(points) => *points,
        _ => 1, // unreachable: the key table declares the key as a count
    };
    if points > 1 && from == to {
        let found = format!("found {to:?} at both ends");
        return Err(entries.places.error(to_key, found, "give two different ends, or 1 point"));
    }
    // Larger counts are reported as a grid with too many points.
    if (2..=MAX_POINTS).contains(&points) {
        check_step(entries, [from_key, to_key, points_key], from, to, points)?;
    }
    if parameter.key().name.starts_with("wave.")
        && parameter.key().unit == "1/m"
        && from.min(to) <= 0.0
    {
        let key = if from <= 0.0 { from_key } else { to_key };
        return Err(wave_number(entries, key, from.min(to)));
    }
    Ok(Sweep { parameter, from, to, points })
}

/// Checks that neighbouring values of a sweep of at least 2 points differ.
fn check_step(
    entries: &Entries,
    [from_key, to_key, points_key]: [&'static str; 3],
    from: f64,
    to: f64,
    points: usize,
) -> Result<(), CaseError> {
    let range = to - from;
    let largest = from.abs().max(to.abs());
    if !range.is_finite() {
        // Report the end of larger magnitude.
        let key = if from.abs() > to.abs() { from_key } else { to_key };
        let found = format!("found {from:?} … {to:?}, whose difference overflows");
        return Err(entries.places.error(key, found, "give ends whose difference is finite"));
    }
    // Rounding changes a value of the sweep by at most 3/2 of this unit, or by the smallest subnormal double.
    let unit = (f64::EPSILON * largest).max(f64::from_bits(1));
    if range.abs() / (points - 1) as f64 <= 4.0 * unit {
        let found =
            format!("found {points} points between {from:?} and {to:?}, too close to differ");
        return Err(entries.places.error(points_key, found, "give fewer points, or a wider range"));
    }
    Ok(())
}

/// Builds the error of a name that is not a sweepable parameter.
fn no_parameter(entries: &Entries, medium: Medium, place: &str, name: &str) -> CaseError {
    let names: Vec<String> = Parameter::all()
        .filter(|parameter| parameter.key().is_used_by(medium))
        .map(Parameter::name)
        .collect();
    let shown = escape(name);
    let component = Parameter::find(name).map(Parameter::key);
    let mut meant = String::new();
    let found = match Key::find(name).or(component) {
        Some(key) if !key.is_for(medium.kind) => {
            format!("'{shown}' is not used by the model {}", medium.kind.name())
        }
        Some(key) if !key.is_used_by(medium) => {
            format!("'{shown}' is not used by {}", medium.title())
        }
        Some(_) => format!("'{shown}' is no single number"),
        None => {
            meant = suggestion(nearest(name, names.iter().map(String::as_str)));
            format!("there is no '{shown}' to sweep")
        }
    };
    entries.places.error(place, found, format!("{meant}allowed: {}", names.join(", ")))
}
