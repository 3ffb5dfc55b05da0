//! Model texts used by several tests.

use wellposed_models::equations::{
    JetVariable, ModelText, NamedText, Quantity, TextModel, TextState,
};
use wellposed_models::{LinearisedSystem, Rounded};

/// Builds a model text from its parts; a unit of "-" is none.
pub fn model_text(
    dimensions: usize,
    unknowns: &[(&str, &str)],
    velocity: &[&str],
    parameters: &[(&str, &str)],
    definitions: &[(&str, &str)],
    equations: &[(&str, &str)],
) -> ModelText {
    let quantities = |list: &[(&str, &str)]| {
        list.iter()
            .map(|(name, unit)| Quantity {
                name: (*name).to_owned(),
                unit: (*unit != "-").then(|| (*unit).to_owned()),
            })
            .collect()
    };
    let texts = |list: &[(&str, &str)]| {
        list.iter()
            .map(|(name, text)| NamedText { name: (*name).into(), text: (*text).into() })
            .collect()
    };
    ModelText {
        dimensions,
        unknowns: quantities(unknowns),
        velocity: velocity.iter().map(|own| (*own).to_owned()).collect(),
        parameters: quantities(parameters),
        definitions: texts(definitions),
        equations: texts(equations),
        driven: Vec::new(),
    }
}

/// The incompressible μ(I) rheology of Jop, Forterre & Pouliquen (2006).
pub fn granular_rheology() -> ModelText {
    model_text(
        2,
        &[("v1", "m/s"), ("v2", "m/s"), ("p", "Pa")],
        &["v1", "v2"],
        &[
            ("rho", "kg/m^3"),
            ("rho_s", "kg/m^3"),
            ("d", "m"),
            ("mu_s", ""),
            ("mu_2", ""),
            ("I0", ""),
        ],
        &[
            ("D12", "(d2(v1) + d1(v2))/2"),
            ("rate", "sqrt(2*(d1(v1)^2 + 2*D12^2 + d2(v2)^2))"),
            ("I", "rate*d*sqrt(rho_s/p)"),
            ("mu", "mu_s + (mu_2 - mu_s)/(1 + I0/I)"),
            ("eta", "mu*p/rate"),
            ("s11", "-p + 2*eta*d1(v1)"),
            ("s12", "2*eta*D12"),
            ("s22", "-p + 2*eta*d2(v2)"),
        ],
        &[
            ("momentum 1", "rho*D(v1) = d1(s11) + d2(s12)"),
            ("momentum 2", "rho*D(v2) = d1(s12) + d2(s22)"),
            ("volume", "d1(v1) + d2(v2) = 0"),
        ],
    )
}

/// A jet variable.
pub fn jet(model: &TextModel, unknown: &str, orders: [u8; 4]) -> JetVariable {
    JetVariable { unknown: model.find_unknown(unknown).expect("an unknown"), orders }
}

/// A state with values of the parameters in the order of the model, and background values.
pub fn state(
    model: &TextModel,
    parameters: &[f64],
    background: &[(&str, [u8; 4], f64)],
) -> TextState {
    TextState {
        parameters: parameters.to_vec(),
        background: background
            .iter()
            .map(|&(name, orders, value)| (jet(model, name, orders), Rounded::from_rounded(value)))
            .collect(),
        solved: Vec::new(),
    }
}

/// Coefficient of the term with the given powers of ς and κ in a linearised system.
pub fn coefficient<const D: usize>(
    system: &LinearisedSystem<D>,
    at: (usize, usize),
    time: u8,
    space: [u8; D],
) -> Rounded {
    let first = space.iter().position(|own| *own == 1);
    match (time, space.iter().sum::<u8>()) {
        (0, 0) => system.c[at],
        (1, 0) => system.a[at],
        (0, 1) => system.b[first.expect("one axis")][at],
        _ => system
            .higher_terms
            .iter()
            .filter(|own| (own.row, own.column) == at)
            .find(|own| own.time_power == time && own.space_powers == space)
            .map_or(Rounded::ZERO, |own| own.coefficient),
    }
}
