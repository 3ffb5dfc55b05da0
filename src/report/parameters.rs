//! Parameters of a case in the subtitles of figures.

use super::format::{format_short, format_unit_suffix};
use super::symbols::{typeset_symbol, typeset_unit};
use crate::case::{Case, ModelKind, SweepParameter};

/// Returns the symbol of a parameter by its label, such as ρ of "density ρ" and v₁ of `velocity v[0]`; the whole label if it
/// has none.
fn parameter_symbol(label: &str) -> String {
    let (name, component) = match label.strip_suffix(']').and_then(|own| own.split_once('[')) {
        Some((name, "0")) => (name, "₁"),
        Some((name, "1")) => (name, "₂"),
        _ => (label, ""),
    };
    let symbol = match name.rsplit_once(' ') {
        // The couple stresses on the faces of the plane have the first index 3.
        _ if name == "couple stress" => "m₃",
        Some((_, symbol)) if symbol.chars().count() <= 3 => symbol,
        _ => name,
    };
    format!("{symbol}{component}")
}

/// Describes the model and the parameters of [`fixed_parameters`], for the subtitle of a figure; `swept` has the keys of
/// the parameters on the axes.
pub(super) fn format_subtitle(case: &Case, swept: &[&str]) -> String {
    let space = match (case.material.kind, case.material.numbers.dimensions) {
        (ModelKind::Solid(_), 3) => Some("in space".to_owned()),
        (ModelKind::Solid(_), _) => Some("plane strain".to_owned()),
        _ => None,
    };
    let parts = [case.medium().title().to_owned()].into_iter().chain(space);
    parts.chain(fixed_parameters(case, swept)).collect::<Vec<_>>().join(", ")
}

/// Appends the parameters of the case to the subtitle of a figure.
pub(super) fn with_parameters(subtitle: &str, case: &Case) -> String {
    match fixed_parameters(case, &[]) {
        fixed if fixed.is_empty() => subtitle.to_owned(),
        fixed => format!("{subtitle}; {}", fixed.join(", ")),
    }
}

/// Describes the active yield conditions and all parameters of model, yield set, stress and background except those in
/// `swept`, those that are zero and not constants of a flow model, and the deviatoric stress of a solid, which is scaled
/// until the solid yields.
fn fixed_parameters(case: &Case, swept: &[&str]) -> Vec<String> {
    let of_material = SweepParameter::all_parameters().filter_map(|parameter| {
        let name = parameter.name();
        let is_of_state = ["model.", "yield.", "stress.", "background."]
            .iter()
            .any(|section| name.starts_with(section));
        let is_fixed = is_of_state
            && name != "stress.deviatoric_stress"
            && !swept.contains(&name.as_str())
            && parameter.key().is_used_by(case.medium());
        let is_listed_at_zero =
            matches!(case.material.kind, ModelKind::Flow(_)) && name.starts_with("model.");
        let value = parameter
            .value(&case.material.numbers)
            .filter(|value| *value != 0.0 || is_listed_at_zero)?;
        is_fixed.then(|| {
            let symbol = parameter_symbol(&parameter.label());
            format!("{symbol} = {}{}", format_short(value), format_unit_suffix(parameter.unit()))
        })
    });
    let of_equations = case.equations.iter().flat_map(|equations| {
        let values = case.material.numbers.equation_numbers.iter();
        equations.number_names().zip(values).filter_map(|([key, label, unit], value)| {
            let is_fixed = *value != 0.0 && !swept.contains(&key);
            is_fixed.then(|| {
                let [symbol, unit] = [typeset_symbol(label), typeset_unit(unit)];
                format!("{symbol} = {}{}", format_short(*value), format_unit_suffix(&unit))
            })
        })
    });
    let active = case.material.active_conditions.iter().map(|active| {
        let all = case.medium().yield_condition_names();
        let names: Vec<String> = active.iter().map(|&index| typeset_symbol(all[index])).collect();
        format!("active: {}", names.join(" and "))
    });
    active.chain(of_material).chain(of_equations).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_taken_from_labels() {
        for (label, symbol) in [
            ("density ρ", "ρ"),
            ("friction of the layers", "friction of the layers"),
            ("couple stress[0]", "m₃₁"),
            ("couple stress[1]", "m₃₂"),
            ("velocity v[1]", "v₂"),
        ] {
            assert_eq!(parameter_symbol(label), symbol);
        }
    }
}
