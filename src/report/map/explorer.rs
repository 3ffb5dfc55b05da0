//! Data of the interactive map of the page: verdicts and growth at the points, curves and roots at sampled points.

use super::{figure, tables};
use crate::Error;
use crate::case::Case;
use crate::report::format::{case_title, format_unit_suffix};
use crate::report::page::InteractivePicture;
use crate::study::MapResult;
use crate::study::map::summary::MapAxis;
use crate::study::map::{MapCode, MapNumber, MapSamples, PointStatus, WaveSample};
use analysis::solids::Hyperbolicity;
use serde_json::{Value, json};

/// Largest number of values of fields in the data; a larger map is thinned out.
const MAX_FIELD_VALUES: usize = 56_000;

/// Significant digits of growth rates and roots at sampled points, which a picture and a short table show.
const SAMPLE_DIGITS: usize = 4;

/// Field of the table of a map: name and quantity.
type Field = (&'static str, MapNumber);

/// Fields that the page shows, unless they have no value on the whole map.
const SHOWN_FIELDS: [Field; 6] = [
    ("order", MapNumber::GrowthOrder),
    ("coefficient", MapNumber::GrowthCoefficient),
    ("direction_deg", MapNumber::Direction),
    ("elevation_deg", MapNumber::Elevation),
    ("growth_rate", MapNumber::GrowthRate),
    ("bound", MapNumber::GrowthBound),
];

pub(super) fn create_picture(
    case: &Case,
    found: &MapResult,
    samples: &MapSamples,
) -> Result<InteractivePicture, Error> {
    let figure = figure::create_figure(case, found);
    let description = format!(
        "Map of verdicts of {} over {} and {}: arrow keys move, with Shift by ten points, Enter opens the growth curve",
        case_title(case),
        found.x.label,
        found.y.label
    );
    let area = figure.plot_area()?;
    Ok(InteractivePicture {
        file_stem: "map",
        area,
        description,
        data: create_data(found, samples),
    })
}

fn create_data(found: &MapResult, samples: &MapSamples) -> Value {
    let has_value = |field: &Field| found.points.has_number(field.1);
    let fields: Vec<Field> = SHOWN_FIELDS.into_iter().filter(has_value).collect();
    let (nx, ny) = (found.x.point_count, found.y.point_count);
    let value_count = |step: usize| nx.div_ceil(step) * ny.div_ceil(step) * (1 + fields.len());
    let step = (1..).find(|&step| value_count(step) <= MAX_FIELD_VALUES).unwrap_or(1);
    let indices: Vec<usize> = (0..ny)
        .step_by(step)
        .flat_map(|row| (0..nx).step_by(step).map(move |column| row * nx + column))
        .collect();
    let digits = |which: MapCode| -> String {
        let codes = found.points.codes(which);
        indices.iter().map(|&index| char::from(b'0' + codes[index] as u8)).collect()
    };
    let fields: Vec<Value> = fields
        .iter()
        .map(|(name, field)| {
            let values = indices.iter().map(|&index| number(found.points.number(*field, index)));
            json!({ "name": name, "unit": tables::unit(name), "values": values.collect::<Vec<_>>() })
        })
        .collect();
    let types = found.solid.map(|_| {
        let names = ["none"].into_iter().chain(Hyperbolicity::ALL.map(Hyperbolicity::name));
        let names: Vec<_> = names.collect();
        json!({ "names": names, "digits": digits(MapCode::Hyperbolicity) })
    });
    json!({
        "x": axis(&found.x),
        "y": axis(&found.y),
        "step": step,
        "verdicts": PointStatus::ALL.map(PointStatus::name),
        "verdict": digits(MapCode::Status),
        "types": types,
        "fields": fields,
        "samples": {
            "columns": samples.columns,
            "rows": samples.rows,
            "directions": samples.directions_deg,
            "points": samples.points.iter().map(|own| own.as_ref().map(sample)).collect::<Vec<_>>(),
        },
    })
}

fn axis(axis: &MapAxis) -> Value {
    json!({
        "label": axis.label,
        "unit": format_unit_suffix(axis.unit),
        "values": axis.values,
        "log": axis.spacing.is_some(),
    })
}

fn sample(own: &WaveSample) -> Value {
    let round = |value: f64| number(round_digits(value));
    json!({
        "k": own.wave_number,
        "d": own.direction_deg,
        "g": own.growth_rates.iter().map(|&rate| round(rate)).collect::<Vec<_>>(),
        "r": own.roots.iter().map(|root| root.map(round)).collect::<Vec<_>>(),
    })
}

/// Returns a number for JSON: null for not-a-number, a text for infinities.
fn number(value: f64) -> Value {
    match value {
        f64::INFINITY => "inf".into(),
        f64::NEG_INFINITY => "-inf".into(),
        _ if value.is_nan() => Value::Null,
        // Shorter than `2.0`.
        _ if value.fract() == 0.0 && value.abs() < 1e9 && value.is_sign_positive() => {
            (value as u64).into()
        }
        _ => value.into(),
    }
}

/// Rounds a number to [`SAMPLE_DIGITS`] significant digits.
fn round_digits(value: f64) -> f64 {
    format!("{value:.*e}", SAMPLE_DIGITS - 1).parse().unwrap_or(value)
}
