//! Text report and tables of the state of a flow.

use crate::Error;
use crate::case::{Case, ModelKind};
use crate::report::DataFile;
use crate::report::format::{
    VALIDITY_NOTE, case_title, coefficient_unit, format_coaxial_note, format_order, format_short,
    format_superscript,
};
use crate::study::point::flow_state::{SupremumLocation, WaveLimit};
use crate::study::point::{FlowAnalysis, FlowModelAnalysis, FlowState, YieldingState};
use models::Rounded;
use models::flow::RotationKind;
use std::fmt::Write as _;

impl FlowAnalysis {
    /// Returns the models shown in pictures and tables: the compared models, or the model of the case if none is
    /// compared.
    pub(super) fn select_plotted_models(&self) -> &[FlowModelAnalysis] {
        match self.compared_analyses.as_slice() {
            [] => std::slice::from_ref(&self.analysis),
            compared => compared,
        }
    }
}

impl YieldingState {
    /// Returns whether growth rates were sampled, which requires that the equations determine their unknowns.
    pub(super) fn has_curves(&self) -> bool {
        !self.growth_by_direction.is_empty()
    }
}

pub(super) fn format_text(case: &Case, found: &FlowAnalysis) -> String {
    let own = &found.analysis;
    let mut text = format!("{}\nmodel: {}\n", case_title(case), own.kind.title());
    match &own.state {
        FlowState::Yielding(state) => {
            write_background(own.kind, state, &mut text);
            write_characteristics(own.kind, state, &mut text);
            write_roots(state, &mut text);
            let _ = write!(text, "\n{}", format_verdict(own));
            let _ = writeln!(text, "Route: {}\n{VALIDITY_NOTE}", state.evidence.route);
        }
        FlowState::NotYielding(state) => {
            let _ = writeln!(
                text,
                "region: {}\nThe state is not fully deforming: nothing to analyse.",
                state.yield_region
            );
        }
    }
    for other in found.compared_analyses.iter().filter(|other| other.kind != own.kind) {
        let _ = write!(text, "\nCompared: {}\n", other.kind.title());
        if let Some(delta) = other.replaced_noncoaxiality_deg {
            let _ = writeln!(text, "  {}", format_coaxial_note(delta));
        }
        text += &format_verdict(other);
    }
    text
}

fn format_pair(values: [f64; 2]) -> String {
    format!("({}, {})", format_short(values[0]), format_short(values[1]))
}

/// Formats a pair; components that vanish within rounding are printed as zero.
fn format_rounded_pair(values: [Rounded; 2]) -> String {
    format_pair(values.map(|x| if x.sign().is_some() { x.value } else { 0.0 }))
}

fn has_spin(kind: ModelKind) -> bool {
    matches!(kind, ModelKind::Flow(kind) if kind.rotation() == RotationKind::IntrinsicSpin)
}

fn write_background(kind: ModelKind, state: &YieldingState, text: &mut String) {
    let YieldingState { flow, background, stress, .. } = state;
    let _ = writeln!(text, "region: {}", state.yield_region);
    let _ = writeln!(
        text,
        "internal power: {} W/m³{}",
        format_short(state.internal_power),
        if state.internal_power < 0.0 { " (negative)" } else { "" }
    );
    let _ = writeln!(text, "\nBackground (given and derived)");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<36}{value}");
    };
    line("deviatoric stress q", format!("{} Pa", format_short(stress.deviatoric_stress)));
    if has_spin(kind) {
        line("rotational stress r", format!("{} Pa", format_short(stress.rotational_stress)));
    }
    line(
        "stress (second index: face normal)",
        format!("[{}, {}] Pa", format_pair(stress.tensor[0]), format_pair(stress.tensor[1])),
    );
    line("non-coaxiality Δ", format!("{}°", format_short(background.noncoaxiality_deg)));
    let gradient = flow.velocity_gradient;
    line(
        "velocity gradient ∂ⱼVᵢ",
        format!("[{}, {}] 1/s", format_rounded_pair(gradient[0]), format_rounded_pair(gradient[1])),
    );
    if let Some(spin) = flow.spin {
        // A spin that vanishes within rounding is printed as zero.
        let spin = spin.sign().map_or(0.0, |_| spin.value);
        line("spin Ω", format!("{} rad/s", format_short(spin)));
    }
    for slip in state.slip.iter().flatten() {
        let reversed = if slip.rate < 0.0 { " (reversed)" } else { "" };
        line(
            &format!("slip along {}°", format_short(slip.angle_deg)),
            format!("{} 1/s{reversed}", format_short(slip.rate)),
        );
    }
    line(
        "acceleration minus body force",
        format!("{} m/s²", format_rounded_pair(flow.acceleration)),
    );
    if let Some(moment) = background.body_moment {
        line("body moment per unit mass", format!("{} m²/s²", format_short(moment)));
    }
    if let Some(rate) = background.stress_angle_rate_deg {
        line("rate of the stress angle", format!("{} °/s", format_short(rate)));
    }
}

fn write_characteristics(kind: ModelKind, state: &YieldingState, text: &mut String) {
    let _ = writeln!(text, "\nSteady characteristic directions");
    let Some(real) = &state.characteristics else {
        let _ = writeln!(text, "  the steady equations do not determine their unknowns");
        return;
    };
    for c in real {
        let _ = writeln!(
            text,
            "  {:>9}°  multiplicity {}  {}",
            format_short(c.angle_deg),
            c.multiplicity,
            c.family
        );
    }
    for complex in state.complex_characteristics.iter().flatten() {
        let [re, im] = complex.tangent;
        let _ = writeln!(
            text,
            "  complex, tan = {} {} {}i  {}",
            format_short(re),
            if im < 0.0 { "−" } else { "+" },
            format_short(im.abs()),
            complex.family
        );
    }
    // Harris & Grekova (2005), section 8: the spin stays finite where the velocity jumps. The jump is along these lines for
    // ν = 0, else at the angle ν to them.
    if let (true, Some([first, second])) = (has_spin(kind), state.slip) {
        let _ = writeln!(
            text,
            "  the velocity may jump along {}° and {}° only, not along streamlines",
            format_short(first.angle_deg),
            format_short(second.angle_deg)
        );
    }
    let arbitrary = state.arbitrary_characteristics.as_deref().unwrap_or_default();
    for family in arbitrary {
        let _ = writeln!(text, "  every direction  {family} (no convection)");
    }
    if let Some(kind) = state.steady_type {
        let aside = if arbitrary.is_empty() { "" } else { " (without fields at rest)" };
        let _ = writeln!(text, "  type: {kind}{aside}");
    }
}

fn write_roots(state: &YieldingState, text: &mut String) {
    let wave = state.wave;
    let _ = writeln!(
        text,
        "\nDispersion roots ς at k = {} 1/m, direction {}°",
        format_short(wave.wave_number),
        format_short(wave.direction_deg)
    );
    for [re, im] in state.dispersion_roots.iter().flatten() {
        let _ = writeln!(text, "  {:>12} {im:>+13.4e} i  1/s", format_short(*re));
    }
    if let Some(infinite) = state.infinite_root_count {
        let _ = writeln!(text, "  and {infinite} infinite ones (algebraic equations)");
    }
    if let Some(rank) = state.equation_rank {
        let _ = writeln!(text, "  every ς is a root (rank {rank})");
    }
    if state.gradient_wave_number > 0.0 {
        let length = format_short(wave.wave_number / state.gradient_wave_number);
        let _ = writeln!(text, "  k × length scale of the background = {length}");
    }
}

fn format_verdict(analysis: &FlowModelAnalysis) -> String {
    let Some(state) = analysis.yielding_state() else { return "Not fully deforming.\n".into() };
    let evidence = &state.evidence;
    let mut text = format!("Verdict: {}\n  {}\n", state.verdict, evidence.description);
    if let (Some(order), Some(coefficient)) = (state.growth_order, state.growth_coefficient) {
        let _ = writeln!(
            text,
            "  order {}, coefficient {coefficient} {}",
            format_order(order),
            coefficient_unit(order)
        );
    }
    if let (Some(order), Some([from, to])) = (state.fitted_order, state.fitted_wave_numbers) {
        let _ = writeln!(
            text,
            "  fitted order {:.3}: maximum Re ς over all directions, k from {} to {} 1/m",
            (1e3 * order).round() / 1e3 + 0.0,
            format_short(from),
            format_short(to)
        );
    }
    if !evidence.orders.is_empty() {
        let list: Vec<String> = evidence
            .orders
            .iter()
            .map(|counted| {
                format!("{} × k{}", counted.root_count, format_superscript(counted.growth_order))
            })
            .collect();
        let _ = writeln!(text, "  unbounded roots in a general direction: {}", list.join(", "));
    }
    if !evidence.degenerate_directions_deg.is_empty() {
        let list: Vec<String> = evidence
            .degenerate_directions_deg
            .iter()
            .map(|&d| format!("{}°", format_short(d)))
            .collect();
        let _ = writeln!(text, "  degenerate directions of the wave vector: {}", list.join(", "));
    }
    if let (Some(rate), Some(place)) = (state.growth_bound, state.supremum_location) {
        let _ = writeln!(
            text,
            "  supremum of Re ς: {} 1/s, {}, direction {}°",
            format_short(rate),
            format_supremum_location(&place),
            format_short(place.direction_deg)
        );
    }
    if let Some(bound) = state.noncoaxiality_bound_deg {
        let _ = writeln!(
            text,
            "  bound on |Δ| for the leading order of growth: {}°",
            format_short(bound)
        );
    }
    text
}

fn format_supremum_location(place: &SupremumLocation) -> String {
    match (place.wave_number, place.limit) {
        (Some(number), _) => format!("at k = {} 1/m", format_short(number)),
        (None, Some(WaveLimit::LongWaves)) => "approached by the longest waves".into(),
        (None, _) => "approached as k → ∞".into(),
    }
}

/// Renders the tables of sampled growth rates; empty if none were sampled.
pub(super) fn create_tables(
    found: &FlowAnalysis,
) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
    const DIRECTION_TABLE: &str = "growth_by_direction.csv";
    const WAVE_NUMBER_TABLE: &str = "growth_by_wave_number.csv";
    let curves: Vec<(&str, &YieldingState)> = found
        .select_plotted_models()
        .iter()
        .filter_map(|shown| Some((shown.kind.name(), shown.yielding_state()?)))
        .filter(|(_, state)| state.has_curves())
        .collect();
    if curves.is_empty() {
        return Ok(Vec::new());
    }
    let by_direction = curves.clone().into_iter().flat_map(|(model, state)| {
        state.growth_by_direction.iter().map(
            move |&[direction, rate]| -> Vec<files::csv::CsvCell> {
                vec![model.into(), direction.into(), rate.into()]
            },
        )
    });
    let by_wave_number = curves.into_iter().flat_map(|(model, state)| {
        state.growth_by_wave_number.iter().map(move |at| -> Vec<files::csv::CsvCell> {
            vec![
                model.into(),
                at.wave_number.into(),
                at.growth_rate.into(),
                at.max_growth_rate.into(),
                at.max_growth_direction.to_degrees().into(),
            ]
        })
    });
    let of_direction = ["model", "direction_deg", "growth_rate"];
    let of_wave_number =
        ["model", "number", "growth_rate", "greatest_growth_rate", "greatest_direction_deg"];
    Ok(vec![
        (DIRECTION_TABLE, DataFile::table(DIRECTION_TABLE, of_direction, by_direction)),
        (WAVE_NUMBER_TABLE, DataFile::table(WAVE_NUMBER_TABLE, of_wave_number, by_wave_number)),
    ])
}
