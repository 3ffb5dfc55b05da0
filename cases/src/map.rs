//! The section `[map]`: the parameter sweep of `wellposed map`.

use super::entries::CaseEntries;
use super::error::{CaseError, escape};
use super::key_positions::KeyPositions;
use super::keys::{Key, SweepParameter};
use super::kind::MediumKind;
use super::named_enum::named_enum;
use super::numbers::CaseNumbers;
use super::scalar_keys::wave_number_error;
use super::value::{CaseValue, find_similar_name, format_allowed};
use models::common::decimal::{format_distinct, format_exact};
use models::common::elementary::Elementary;

/// Maximum number of points of a map.
pub const MAX_MAP_POINTS: usize = 100_000_000;

/// The two swept parameters of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapAxes {
    /// Sweep along the horizontal axis.
    pub x: ParameterSweep,
    /// Sweep along the vertical axis.
    pub y: ParameterSweep,
}

named_enum! {
    /// Spacing of the values along an axis of a map.
    SweepSpacing {
        /// Equal differences.
        Linear = "linear",
        /// Equal ratios, between positive ends.
        Log = "log"
    }
}

/// Sweep of one parameter along an axis of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterSweep {
    /// Swept parameter.
    pub parameter: SweepParameter,
    /// First value, in the unit of the parameter.
    pub first_value: f64,
    /// Last value, in the unit of the parameter.
    pub last_value: f64,
    /// Number of values; at least 1. Neighbouring values differ.
    pub point_count: usize,
    /// Spacing of the values; the ends are positive if it is logarithmic.
    pub spacing: SweepSpacing,
}

impl ParameterSweep {
    /// Computes the value with the number `index` < `point_count`; the values are evenly spaced from `first_value` to
    /// `last_value`, on a logarithmic axis their logarithms.
    ///
    /// The only division is the last operation, so that whole numbers between two whole-number ends are exact, and
    /// powers of ten between two powers of ten on a logarithmic axis.
    pub fn sweep_value(&self, index: usize) -> f64 {
        self.value_at(index as f64)
    }

    /// Computes the value at a position between two numbers of [`sweep_value`](Self::sweep_value), such as 2.5 in the
    /// middle between the values with the numbers 2 and 3.
    pub fn value_at(&self, position: f64) -> f64 {
        if position == 0.0 || self.point_count < 2 {
            return self.first_value;
        }
        let (last, index) = ((self.point_count - 1) as f64, position);
        if self.spacing == SweepSpacing::Log {
            if index == last {
                return self.last_value;
            }
            let [from, to] = [self.first_value, self.last_value].map(Elementary::cr_log10);
            return 10_f64.cr_powf((from * (last - index) + to * index) / last);
        }
        let value = (self.first_value * (last - index) + self.last_value * index) / last;
        if value.is_finite() {
            value
        } else {
            // The products above overflow for huge ends; the quotients do not.
            self.first_value * ((last - index) / last) + self.last_value * (index / last)
        }
    }
}

/// Formats the sweep as an inline TOML table.
impl std::fmt::Display for ParameterSweep {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, points) = (CaseValue::Text(self.parameter.name()), self.point_count);
        let (from, to) = (CaseValue::Number(self.first_value), CaseValue::Number(self.last_value));
        write!(formatter, "{{ parameter = {name}, from = {from}, to = {to}, points = {points}")?;
        match self.spacing {
            SweepSpacing::Linear => formatter.write_str(" }"),
            SweepSpacing::Log => write!(formatter, ", spacing = \"{}\" }}", self.spacing.name()),
        }
    }
}

impl MapAxes {
    /// Reads the section `[map]`; `numbers` are the numbers of the case, `has_active` states whether the case declares
    /// active yield conditions.
    pub(super) fn read(
        entries: &CaseEntries,
        medium: MediumKind,
        numbers: &CaseNumbers,
        has_active: bool,
    ) -> Result<Option<Self>, CaseError> {
        if !entries.has_section("map") {
            return Ok(None);
        }
        let x = read_sweep(
            entries,
            medium,
            ["map.x.parameter", "map.x.from", "map.x.to", "map.x.points", "map.x.spacing"],
        )?;
        let y = read_sweep(
            entries,
            medium,
            ["map.y.parameter", "map.y.from", "map.y.to", "map.y.points", "map.y.spacing"],
        )?;
        let map = Self { x, y };
        map.check(&entries.positions)?;
        let swept = [("map.x", map.x), ("map.y", map.y)];
        let of_stress = |sweep: &ParameterSweep| sweep.parameter.key().name.starts_with("stress.");
        if let (Some((axis, sweep)), true) =
            (swept.into_iter().find(|s| of_stress(&s.1)), has_active)
        {
            let found = format!("a sweep of {} beside yield.active", sweep.parameter.name());
            let allowed =
                "leave yield.active out: it and [stress] both determine the active conditions";
            return Err(entries.positions.key_error(axis, found, allowed));
        }
        let sweeps_elevation =
            [x, y].iter().any(|sweep| sweep.parameter.name() == "wave.elevation_deg");
        if sweeps_elevation && numbers.dimensions == 2 {
            let allowed = "set model.dimensions = 3: waves of plane strain have elevation 0";
            let found = "a sweep of wave.elevation_deg in plane strain";
            return Err(entries.positions.key_error("map", found, allowed));
        }
        Ok(Some(map))
    }

    /// Checks that the axes sweep different parameters and that the map has not too many points, and the ends of each
    /// axis.
    pub(super) fn check(&self, positions: &KeyPositions) -> Result<(), CaseError> {
        let Self { x, y } = *self;
        if x.parameter == y.parameter {
            return Err(positions.key_error(
                "map.y.parameter",
                format!("found {} on both axes", y.parameter.name()),
                "expected two different parameters",
            ));
        }
        if x.point_count.checked_mul(y.point_count).is_none_or(|points| points > MAX_MAP_POINTS) {
            let larger =
                if x.point_count > y.point_count { "map.x.points" } else { "map.y.points" };
            return Err(positions.key_error(
                larger,
                format!("found a map of {} × {} points", x.point_count, y.point_count),
                format!("expected at most {MAX_MAP_POINTS} points in total"),
            ));
        }
        check_ends(positions, "map.x", &x)?;
        check_ends(positions, "map.y", &y)
    }
}

/// Checks the ends of a sweep.
fn check_ends(
    positions: &KeyPositions,
    axis: &str,
    sweep: &ParameterSweep,
) -> Result<(), CaseError> {
    let ParameterSweep { first_value: from, last_value: to, point_count: points, .. } = *sweep;
    let [from_key, to_key, points_key] =
        ["from", "to", "points"].map(|name| format!("{axis}.{name}"));
    if points > 1 && from >= to {
        let [from, to] = format_distinct([from, to]);
        let (found, allowed) = match from == to {
            true => (
                format!("found from = {from} and to = {to}"),
                "expected from < to, or points = 1".into(),
            ),
            false => (
                format!("found from = {from} and to = {to}"),
                "expected from < to: exchange them".to_owned(),
            ),
        };
        // The option that set one of the ends, rather than the line of the other.
        let key = if positions.has_option(&from_key) { from_key } else { to_key };
        return Err(positions.key_error(&key, found, allowed));
    }
    if sweep.spacing == SweepSpacing::Log && from.min(to) < f64::MIN_POSITIVE {
        let (key, end) = if from < f64::MIN_POSITIVE { (from_key, from) } else { (to_key, to) };
        let found = format!("found {}", format_exact(end));
        let allowed = "expected a number > 0, since the spacing of the axis is log";
        return Err(positions.key_error(&key, found, allowed));
    }
    // Larger counts are reported as a grid with too many points.
    if (2..=MAX_MAP_POINTS).contains(&points) {
        check_spacing(positions, [&from_key, &to_key, &points_key], sweep)?;
    }
    if sweep.parameter.key().name.starts_with("wave.")
        && sweep.parameter.key().unit == "1/m"
        && from.min(to) <= 0.0
    {
        let key = if from <= 0.0 { from_key } else { to_key };
        return Err(wave_number_error(positions, &key, from.min(to)));
    }
    Ok(())
}

fn read_sweep(
    entries: &CaseEntries,
    medium: MediumKind,
    [parameter_key, from_key, to_key, points_key, spacing_key]: [&'static str; 5],
) -> Result<ParameterSweep, CaseError> {
    let name = entries.require_text(parameter_key)?;
    let found =
        SweepParameter::find_by_name(name).filter(|parameter| parameter.key().is_used_by(medium));
    let Some(parameter) = found else {
        return Err(unknown_parameter_error(entries, medium, parameter_key, name));
    };
    let (from, to) = (entries.require_number(from_key)?, entries.require_number(to_key)?);
    let points = match entries.require_value(points_key)? {
        CaseValue::Count(points) => *points,
        _ => 1, // unreachable: the key table declares the key as a count
    };
    let spacing = match entries.value(spacing_key) {
        Some(CaseValue::Text(name)) => {
            SweepSpacing::ALL.iter().find(|own| own.name() == name).copied().ok_or_else(|| {
                let names: Vec<&str> = SweepSpacing::ALL.iter().map(|own| own.name()).collect();
                let found = format!("found '{}'", escape(name));
                let near = find_similar_name(name, names.iter().copied());
                let allowed = format_allowed("allowed", near, &names);
                entries.positions.key_error(spacing_key, found, allowed)
            })?
        }
        _ => SweepSpacing::default(),
    };
    Ok(ParameterSweep {
        parameter,
        first_value: from,
        last_value: to,
        point_count: points,
        spacing,
    })
}

/// Checks that neighbouring values of a sweep with at least two values differ.
fn check_spacing(
    positions: &KeyPositions,
    [from_key, to_key, points_key]: [&str; 3],
    sweep: &ParameterSweep,
) -> Result<(), CaseError> {
    let ParameterSweep { first_value: from, last_value: to, point_count: points, .. } = *sweep;
    let is_too_close = match sweep.spacing {
        SweepSpacing::Linear => {
            let range = to - from;
            let largest = from.abs().max(to.abs());
            if !range.is_finite() {
                // Report the end of larger magnitude.
                let key = if from.abs() > to.abs() { from_key } else { to_key };
                let found = format!(
                    "found {} … {}, whose difference overflows",
                    format_exact(from),
                    format_exact(to)
                );
                let allowed = "expected ends whose difference is finite";
                return Err(positions.key_error(key, found, allowed));
            }
            // Rounding changes a value of the sweep by at most 3/2 of `unit`: ε times the largest magnitude, but at
            // least the smallest subnormal double.
            let unit = (f64::EPSILON * largest).max(f64::from_bits(1));
            range.abs() / (points - 1) as f64 <= 4.0 * unit
        }
        SweepSpacing::Log => {
            // Rounding changes a logarithm as it changes a value above.
            let [low, high] = [from, to].map(Elementary::cr_log10);
            let unit = f64::EPSILON * low.abs().max(high.abs()).max(1.0);
            (high - low) / (points - 1) as f64 <= 4.0 * unit
        }
    };
    if is_too_close {
        let found = format!(
            "found {points} points between {} and {}, too close to differ",
            format_exact(from),
            format_exact(to)
        );
        return Err(positions.key_error(
            points_key,
            found,
            "expected fewer points, or a wider range",
        ));
    }
    Ok(())
}

/// Builds the error of a name that is not a sweepable parameter.
fn unknown_parameter_error(
    entries: &CaseEntries,
    medium: MediumKind,
    key: &str,
    name: &str,
) -> CaseError {
    let names: Vec<String> = SweepParameter::all_parameters()
        .filter(|parameter| parameter.key().is_used_by(medium))
        .map(SweepParameter::name)
        .collect();
    let shown = escape(name);
    let component = SweepParameter::find_by_name(name).map(SweepParameter::key);
    let mut meant = None;
    let found = match Key::find_by_name(name).or(component) {
        Some(key) if !key.is_used_by_kind(medium.kind) => {
            format!("found '{shown}', not used by the model {}", medium.kind.name())
        }
        Some(key) if !key.is_used_by(medium) => {
            format!("found '{shown}', not used by {}", medium.title())
        }
        Some(_) => {
            meant = names.iter().map(String::as_str).find(|own| own.starts_with(name));
            format!("found '{shown}', not a single number")
        }
        None => {
            meant = find_similar_name(name, names.iter().map(String::as_str));
            format!("found '{shown}'")
        }
    };
    entries.positions.key_error(key, found, format_allowed("allowed", meant, &names))
}
