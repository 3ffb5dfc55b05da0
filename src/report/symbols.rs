//! Symbols of figures from the names of parameters and unknowns in case files.

/// Greek letters by their names in case files.
const GREEK_LETTERS: [(&str, &str); 34] = [
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("epsilon", "ε"),
    ("eps", "ε"),
    ("zeta", "ζ"),
    ("eta", "η"),
    ("theta", "θ"),
    ("kappa", "κ"),
    ("lambda", "λ"),
    ("lam", "λ"),
    ("mu", "μ"),
    ("nu", "ν"),
    ("xi", "ξ"),
    ("pi", "π"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("tau", "τ"),
    ("phi", "φ"),
    ("chi", "χ"),
    ("psi", "ψ"),
    ("omega", "ω"),
    ("Gamma", "Γ"),
    ("Delta", "Δ"),
    ("Theta", "Θ"),
    ("Lambda", "Λ"),
    ("Xi", "Ξ"),
    ("Pi", "Π"),
    ("Sigma", "Σ"),
    ("Phi", "Φ"),
    ("Psi", "Ψ"),
    ("Omega", "Ω"),
    ("varsigma", "ς"),
];

/// Sets a name of a case file as a symbol: `mu_s` as μ with the index s, which figures write as `μ_s`, `I0` as I₀,
/// `sigma21` as σ₂₁, and the derivative `d2 v1` as ∂₂v₁. Indices of digits are subscript characters; others follow an
/// underscore, which figures set as an index of a single letter.
pub(super) fn typeset_symbol(name: &str) -> String {
    if let Some((derivative, unknown)) = name.split_once(' ') {
        let axes = derivative.strip_prefix('d').filter(|axes| !axes.is_empty());
        let is_derivative = |axes: &str| axes.chars().all(|c| matches!(c, 't' | '1'..='3'));
        return match axes.filter(|axes| is_derivative(axes)) {
            Some(axes) => {
                let operators = axes.chars().map(|axis| match axis {
                    't' => "∂ₜ".to_owned(),
                    digit => format!("∂{}", to_subscripts(&digit.to_string())),
                });
                operators.collect::<String>() + &typeset_symbol(unknown)
            }
            None => name.to_owned(),
        };
    }
    let letters = name.trim_start_matches(['+', '-']);
    let sign = name[..name.len() - letters.len()].replace('-', "−");
    let (base, index) = match letters.split_once('_') {
        Some((base, index)) => (base, index),
        None => letters.split_at(letters.trim_end_matches(|c: char| c.is_ascii_digit()).len()),
    };
    // A base with digits of its own, such as `s12` in `s12_max`, has them as first index.
    let stem = base.trim_end_matches(|c: char| c.is_ascii_digit());
    if stem.is_empty() {
        return name.to_owned();
    }
    let greek = GREEK_LETTERS.iter().find(|(latin, _)| *latin == stem);
    let stem_symbol = greek.map_or(stem, |(_, letter)| *letter);
    let digits = to_subscripts(&base[stem.len()..]);
    let is_single = stem_symbol.chars().count() == 1;
    let index = match index {
        "" => String::new(),
        digits if digits.chars().all(|c| c.is_ascii_digit()) => to_subscripts(digits),
        other if is_single && digits.is_empty() && other.chars().all(char::is_alphanumeric) => {
            format!("_{other}")
        }
        // Names that are no symbols are kept, since their parts would be unreadable as an index.
        _ => return name.to_owned(),
    };
    format!("{sign}{stem_symbol}{digits}{index}")
}

fn to_subscripts(digits: &str) -> String {
    let subscript = |c: char| c.to_digit(10).and_then(|digit| char::from_u32(0x2080 + digit));
    digits.chars().map(|c| subscript(c).unwrap_or(c)).collect()
}

/// Simplifies the unit of a derivative: `m/s/m` is `1/s`. Other units are returned unchanged.
pub(super) fn typeset_unit(unit: &str) -> String {
    let Some(rest) = unit.strip_prefix("m/") else { return unit.to_owned() };
    match rest.strip_suffix("/m") {
        Some(kept) => format!("1/{kept}"),
        None => unit.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_symbols() {
        for (name, symbol) in [
            ("rho", "ρ"),
            ("rho_s", "ρ_s"),
            ("mu_2", "μ₂"),
            ("I0", "I₀"),
            ("D12", "D₁₂"),
            ("d", "d"),
            ("v1", "v₁"),
            ("d2 v1", "∂₂v₁"),
            ("dt rho_s", "∂ₜρ_s"),
            ("d12 u", "∂₁∂₂u"),
            ("+sigma21", "+σ₂₁"),
            ("-mu31", "−μ₃₁"),
            ("rate", "rate"),
            ("rate0", "rate₀"),
            ("yield_stress", "yield_stress"),
            ("friction of the layers", "friction of the layers"),
            ("", ""),
            ("_", "_"),
        ] {
            assert_eq!(typeset_symbol(name), symbol, "{name}");
        }
    }

    #[test]
    fn units_of_velocity_gradients_are_rates() {
        for (unit, simple) in [("m/s/m", "1/s"), ("Pa/m", "Pa/m"), ("m/s", "m/s"), ("", "")] {
            assert_eq!(typeset_unit(unit), simple);
        }
    }
}
