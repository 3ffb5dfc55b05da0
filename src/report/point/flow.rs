//! Text report and tables of the state of a flow.

use crate::Error;
use crate::case::{Case, Kind};
use crate::report::format::{
    VALIDITY, case_title, coaxial_words, coefficient_unit, order_words, short, superscript,
};
use crate::study::point::flow_state::{SupremumPlace, WaveLimit};
use crate::study::point::{FlowAnalysis, FlowPoint, FlowState, YieldingState};
use models::Rounded;
use models::flow::RotationKind;
use std::fmt::Write as _;

impl FlowPoint {
    /// Returns the models in pictures and tables: the compared models, or else the model of the case.
    pub(super) fn shown(&self) -> &[FlowAnalysis] {
        match self.compare.as_slice() {
            [] => std::slice::from_ref(&self.own),
            compared => compared,
        }
    }
}

impl YieldingState {
    /// Returns whether growth rates were sampled, which requires that the equations determine their unknowns.
    pub(super) fn has_curves(&self) -> bool {
        !self.by_direction.is_empty()
    }
}

pub(super) fn text(case: &Case, found: &FlowPoint) -> String {
    let own = &found.own;
    let mut text = format!("{}\nmodel: {}\n", case_title(case), own.kind.title());
    match &own.state {
        FlowState::Yielding(state) => {
            background(own.kind, state, &mut text);
            characteristics(state, &mut text);
            roots(state, &mut text);
            let _ = write!(text, "\n{}", verdict(own));
            let _ = writeln!(text, "Route: {}\n{VALIDITY}", state.evidence.route);
        }
        FlowState::NotYielding(state) => {
            let _ = writeln!(
                text,
                "region: {}\nThe state is not fully deforming: nothing to analyse.",
                state.region
            );
        }
    }
    for other in found.compare.iter().filter(|other| other.kind != own.kind) {
        let _ = write!(text, "\nCompared: {}\n", other.kind.title());
        if let Some(delta) = other.lost_noncoaxiality_deg {
            let _ = writeln!(text, "  {}", coaxial_words(delta));
        }
        text += &verdict(other);
    }
    text
}

fn pair(values: [f64; 2]) -> String {
    format!("({}, {})", short(values[0]), short(values[1]))
}

/// Formats a pair; components that vanish within rounding are printed as zero.
fn pair_of(values: [Rounded; 2]) -> String {
    pair(values.map(|x| if x.sign().is_some() { x.value } else { 0.0 }))
}

fn background(kind: Kind, state: &YieldingState, text: &mut String) {
    let YieldingState { flow, background, stress, .. } = state;
    let _ = writeln!(text, "region: {}", state.region);
    let _ = writeln!(
        text,
        "internal power: {} W/m³{}",
        short(state.power),
        if state.power < 0.0 { " (negative)" } else { "" }
    );
    let _ = writeln!(text, "\nBackground (given and derived)");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<36}{value}");
    };
    line("deviatoric stress q", format!("{} Pa", short(stress.deviatoric_stress)));
    if matches!(kind, Kind::Flow(kind) if kind.rotation() == RotationKind::IntrinsicSpin) {
        line("rotational stress r", format!("{} Pa", short(stress.rotational_stress)));
    }
    line(
        "stress (second index: face normal)",
        format!("[{}, {}] Pa", pair(stress.tensor[0]), pair(stress.tensor[1])),
    );
    line("non-coaxiality Δ", format!("{}°", short(background.noncoaxiality_deg)));
    let gradient = flow.velocity_gradient;
    line(
        "velocity gradient ∂ⱼVᵢ",
        format!("[{}, {}] 1/s", pair_of(gradient[0]), pair_of(gradient[1])),
    );
    if let Some(spin) = background.spin {
        line("spin Ω", format!("{} rad/s", short(spin)));
    }
    line("acceleration less body force", format!("{} m/s²", pair_of(flow.acceleration)));
    if let Some(moment) = background.body_moment {
        line("body moment per unit mass", format!("{} m²/s²", short(moment)));
    }
    if let Some(rate) = background.stress_angle_rate_deg {
        line("rate of the stress angle", format!("{} °/s", short(rate)));
    }
}

fn characteristics(state: &YieldingState, text: &mut String) {
    let _ = writeln!(text, "\nSteady characteristic directions");
    let Some(real) = &state.characteristics else {
        let _ = writeln!(text, "  the steady equations do not determine their unknowns");
        return;
    };
    for c in real {
        let _ = writeln!(
            text,
            "  {:>9}°  multiplicity {}  {}",
            short(c.angle_deg),
            c.multiplicity,
            c.family
        );
    }
    for complex in state.complex_characteristics.iter().flatten() {
        let [re, im] = complex.tangent;
        let _ = writeln!(
            text,
            "  complex, tan = {} {} {}i  {}",
            short(re),
            if im < 0.0 { "−" } else { "+" },
            short(im.abs()),
            complex.family
        );
    }
    let arbitrary = state.arbitrary_characteristics.as_deref().unwrap_or_default();
    for family in arbitrary {
        let _ = writeln!(text, "  every direction  {family} (no convection)");
    }
    if let Some(kind) = state.steady_type {
        let aside = if arbitrary.is_empty() { "" } else { " (fields at rest left aside)" };
        let _ = writeln!(text, "  type: {kind}{aside}");
    }
}

fn roots(state: &YieldingState, text: &mut String) {
    let wave = state.wave;
    let _ = writeln!(
        text,
        "\nDispersion roots ς at k = {} 1/m, direction {}°",
        short(wave.number),
        short(wave.direction_deg)
    );
    for [re, im] in state.roots.iter().flatten() {
        let _ = writeln!(text, "  {:>12} {im:>+13.4e} i  1/s", short(*re));
    }
    if let Some(infinite) = state.infinite_roots {
        let _ = writeln!(text, "  and {infinite} infinite ones (algebraic equations)");
    }
    if let Some(rank) = state.rank {
        let _ = writeln!(text, "  every ς is a root (rank {rank})");
    }
    if state.gradient_wave_number > 0.0 {
        let length = short(wave.number / state.gradient_wave_number);
        let _ = writeln!(text, "  k × length of the background = {length}");
    }
}

fn verdict(analysis: &FlowAnalysis) -> String {
    let Some(state) = analysis.yielding() else { return "Not fully deforming.\n".into() };
    let evidence = &state.evidence;
    let mut text = format!("Verdict: {}\n  {}\n", state.verdict, evidence.words);
    if let (Some(order), Some(coefficient)) = (state.order, state.coefficient) {
        let _ = writeln!(
            text,
            "  order {}, coefficient {coefficient} {}",
            order_words(order),
            coefficient_unit(order)
        );
    }
    if let (Some(order), Some([from, to])) = (state.fitted_order, state.fitted_wave_numbers) {
        let _ = writeln!(
            text,
            "  fitted order {:.3}: greatest Re ς over all directions, k from {} to {} 1/m",
            (1e3 * order).round() / 1e3 + 0.0,
            short(from),
            short(to)
        );
    }
    if !evidence.orders.is_empty() {
        let list: Vec<String> = evidence
            .orders
            .iter()
            .map(|counted| format!("{} × k{}", counted.roots, superscript(counted.order)))
            .collect();
        let _ = writeln!(text, "  unbounded roots in a general direction: {}", list.join(", "));
    }
    if !evidence.degenerate_directions_deg.is_empty() {
        let list: Vec<String> =
            evidence.degenerate_directions_deg.iter().map(|&d| format!("{}°", short(d))).collect();
        let _ = writeln!(text, "  degenerate directions of the wave vector: {}", list.join(", "));
    }
    if let (Some(rate), Some(place)) = (state.bound, state.bound_at) {
        let _ = writeln!(
            text,
            "  supremum of Re ς: {} 1/s, {}, direction {}°",
            short(rate),
            place_words(&place),
            short(place.direction_deg)
        );
    }
    if let Some(bound) = state.noncoaxiality_bound_deg {
        let _ = writeln!(text, "  bound on |Δ| for the leading order of growth: {}°", short(bound));
    }
    text
}

fn place_words(place: &SupremumPlace) -> String {
    match (place.number, place.limit) {
        (Some(number), _) => format!("at k = {} 1/m", short(number)),
        (None, Some(WaveLimit::LongWaves)) => "approached by the longest waves".into(),
        (None, _) => "approached as k → ∞".into(),
    }
}

/// Renders the tables of sampled growth rates, if any.
pub(super) fn tables(found: &FlowPoint) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
    let curves: Vec<(&str, &YieldingState)> = found
        .shown()
        .iter()
        .filter_map(|shown| Some((shown.kind.name(), shown.yielding()?)))
        .filter(|(_, state)| state.has_curves())
        .collect();
    if curves.is_empty() {
        return Ok(Vec::new());
    }
    let by_direction = curves.iter().flat_map(|(model, state)| {
        state.by_direction.iter().map(|&[direction, rate]| -> Vec<files::csv::Cell> {
            vec![(*model).into(), direction.into(), rate.into()]
        })
    });
    let by_wave_number = curves.iter().flat_map(|(model, state)| {
        state.by_wave_number.iter().map(|at| -> Vec<files::csv::Cell> {
            vec![
                (*model).into(),
                at.number.into(),
                at.growth_rate.into(),
                at.greatest.into(),
                at.direction.to_degrees().into(),
            ]
        })
    });
    let of_direction = ["model", "direction_deg", "growth_rate"];
    let of_wave_number =
        ["model", "number", "growth_rate", "greatest_growth_rate", "greatest_direction_deg"];
    Ok(vec![
        ("growth_by_direction.csv", files::csv::table(&of_direction, by_direction)?),
        ("growth_by_wave_number.csv", files::csv::table(&of_wave_number, by_wave_number)?),
    ])
}
