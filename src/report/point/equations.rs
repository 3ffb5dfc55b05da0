//! Text report and tables of the state of a model given as equations.

use crate::Error;
use crate::case::Case;
use crate::report::format::{
    VALIDITY_NOTE, case_title, coefficient_unit, format_order, format_short,
};
use crate::report::{DataArray, DataFile};
use crate::study::point::equations::{EquationsAnalysis, LinearisedEntry, format_components};
use crate::study::point::flow_state::WaveLimit;
use std::fmt::Write as _;

pub(super) fn format_text(case: &Case, found: &EquationsAnalysis) -> String {
    let mut text = format!("{}\n", case_title(case));
    let linearised = &found.linearised;
    let _ = writeln!(
        text,
        "model given as equations; equations: {}, unknowns: {}, dimensions: {}",
        linearised.equations.len(),
        linearised.unknowns.len(),
        found.dimensions
    );
    write_background(found, &mut text);
    write_system(found, &mut text);
    write_roots(found, &mut text);
    write_verdict(found, &mut text);
    for name in &found.unused_parameters {
        let _ = writeln!(text, "Warning: the parameter {name} is used by no equation.");
    }
    text
}

fn write_background(found: &EquationsAnalysis, text: &mut String) {
    text.push_str("\nBackground\n");
    for own in &found.background {
        let name = match own.derivative.as_str() {
            "value" => own.unknown.to_owned(),
            derivative => format!("{derivative} {}", own.unknown),
        };
        let note = if own.is_solved { "  (from the equations)" } else { "" };
        let _ = writeln!(text, "  {name:<24}{}{note}", format_short(own.value));
    }
    text.push_str("\nResiduals at the background, in units of the largest term of the equation\n");
    for own in &found.residuals {
        let note = if own.is_driven { "  (balanced by a body force)" } else { "" };
        let _ = writeln!(text, "  {:<24}{}{note}", own.equation, format_short(own.relative));
    }
}

/// Formats the powers of ς and κ that a coefficient multiplies: `ς κ₁²`; `1` for none.
fn format_powers(entry: &LinearisedEntry) -> String {
    let superscript = |power: u8| match power {
        1 => String::new(),
        2 => "²".into(),
        3 => "³".into(),
        other => format!("^{other}"),
    };
    let mut factors = Vec::new();
    if entry.time_power > 0 {
        factors.push(format!("ς{}", superscript(entry.time_power)));
    }
    for (axis, &power) in ["κ₁", "κ₂", "κ₃"].iter().zip(&entry.space_powers) {
        if power > 0 {
            factors.push(format!("{axis}{}", superscript(power)));
        }
    }
    if factors.is_empty() { "1".into() } else { factors.join(" ") }
}

fn write_system(found: &EquationsAnalysis, text: &mut String) {
    let linearised = &found.linearised;
    text.push_str("\nLinearised equations, ∂t → ς, ∂i → κi = i ki");
    if linearised.velocity.iter().any(|own| *own != 0.0) {
        let velocity: Vec<String> =
            linearised.velocity.iter().map(|own| format_short(*own)).collect();
        let _ = write!(text, ", in the frame of the velocity ({}) m/s", velocity.join(", "));
    }
    text.push('\n');
    let mut equation = "";
    for entry in &linearised.entries {
        if entry.equation != equation {
            equation = entry.equation;
            let _ = writeln!(text, "  {equation}");
        }
        let factor = format!("{} {}", format_powers(entry), entry.unknown);
        let _ = writeln!(
            text,
            "    {factor:<16} {:>12}  = {}",
            format_short(entry.value),
            entry.expression
        );
    }
}

fn write_roots(found: &EquationsAnalysis, text: &mut String) {
    let wave = found.wave;
    let _ = write!(text, "\nDispersion roots ς at k = {} 1/m", format_short(wave.wave_number));
    if found.dimensions > 1 {
        let _ = write!(text, ", direction {}°", format_short(wave.direction_deg));
    }
    if found.dimensions > 2 {
        let _ = write!(text, ", elevation {}°", format_short(wave.elevation_deg));
    }
    if found.linearised.velocity.iter().any(|own| *own != 0.0) {
        text.push_str(", in the frame at rest");
    }
    text.push('\n');
    for [re, im] in found.dispersion_roots.iter().flatten() {
        let _ = writeln!(text, "  {:>12} {im:>+13.4e} i  1/s", format_short(*re));
    }
    match found.infinite_root_count {
        Some(infinite) => {
            let _ = writeln!(text, "  and {infinite} infinite ones (algebraic equations)");
        }
        None => text.push_str("  every ς is a root\n"),
    }
}

fn write_verdict(found: &EquationsAnalysis, text: &mut String) {
    let _ = write!(text, "\nVerdict: {}\n  {}\n", found.verdict, found.evidence.description);
    if let (Some(order), Some(coefficient)) = (found.growth_order, found.growth_coefficient) {
        let _ = writeln!(
            text,
            "  order {}, coefficient {coefficient} {}",
            format_order(order),
            coefficient_unit(order)
        );
    }
    if let Some(direction) = found.direction.as_ref().filter(|own| own.len() == 2) {
        let _ = writeln!(text, "  direction ({})", format_components(direction));
    }
    if let Some(step) = found.resolution_deg {
        let _ = writeln!(
            text,
            "  directions in space: exact in planes through x₃ and x₁ at steps of {}°",
            format_short(step)
        );
    }
    if let (Some(bound), Some(at)) = (found.growth_bound, found.supremum_location) {
        let place = match (at.wave_number, at.limit) {
            (Some(number), _) => format!("at k = {} 1/m", format_short(number)),
            (None, Some(WaveLimit::ShortWaves)) => "approached by the shortest waves".to_owned(),
            (None, _) => "approached by the longest waves".to_owned(),
        };
        let direction = match found.supremum_direction.as_deref() {
            Some(own) if own.len() > 1 => format!(", direction ({})", format_components(own)),
            _ => String::new(),
        };
        let _ = write!(text, "  growth rate at most {} 1/s", format_short(bound));
        // No wave is singled out by a rate of zero.
        text.push_str(&if bound == 0.0 { "\n".into() } else { format!(", {place}{direction}\n") });
    }
    let _ = writeln!(text, "Route: {}\n{VALIDITY_NOTE}", found.evidence.route);
}

/// Creates the arrays of the linearised equations: matrices A, B and C by rows, and the list of all coefficients.
pub(super) fn create_tables(
    found: &EquationsAnalysis,
) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
    let linearised = &found.linearised;
    let (rows, columns) = (linearised.equations.len(), linearised.unknowns.len());
    let matrix_axes = [("equation", rows), ("unknown", columns)];
    let flat = |matrix: &[Vec<f64>]| matrix.iter().flatten().copied().collect::<Vec<f64>>();
    let b: Vec<f64> = linearised.b.iter().flat_map(|own| flat(own)).collect();
    let b_axes = [("direction", found.dimensions), matrix_axes[0], matrix_axes[1]];
    let index = |names: &[&str], name: &str| {
        names.iter().position(|own| *own == name).map_or(f64::NAN, |index| index as f64)
    };
    // Row, column, power of ς, powers of κ₁, κ₂, κ₃, value, rounding bound.
    let terms: Vec<f64> = linearised
        .entries
        .iter()
        .flat_map(|own| {
            let power = |axis: usize| own.space_powers.get(axis).map_or(0.0, |p| f64::from(*p));
            [
                index(&linearised.equations, own.equation),
                index(&linearised.unknowns, own.unknown),
                own.time_power.into(),
                power(0),
                power(1),
                power(2),
                own.value,
                own.rounding,
            ]
        })
        .collect();
    let term_axes = [("term", linearised.entries.len()), ("part", 8)];
    let arrays = vec![
        DataArray::numbers("A", &matrix_axes, "", flat(&linearised.a)),
        DataArray::numbers("C", &matrix_axes, "", flat(&linearised.c)),
        DataArray::numbers("B", &b_axes, "", b),
        DataArray::numbers("terms", &term_axes, "", terms),
    ];
    Ok(vec![("linearised.npz", DataFile::Arrays(arrays))])
}
