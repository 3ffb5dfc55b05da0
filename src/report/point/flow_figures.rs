//! Figures of the state of a flow.

use crate::case::Case;
use crate::report::Picture;
use crate::report::format::{case_title, order_words, short};
use crate::study::point::{FlowAnalysis, FlowPoint, YieldingState};
use figures::{
    Direction, DirectionsFigure, GrowthFigure, Line, Mark, Panel, PolarFigure, Spoke, SpokeStyle,
    Style,
};
use models::common::elementary::Elementary;

/// Creates the figures of growth rates, if sampled, and of characteristic directions, if the state is fully deforming.
pub(super) fn pictures(case: &Case, found: &FlowPoint) -> Vec<Picture> {
    let shown: Vec<Shown> = found.shown().iter().filter_map(Shown::new).collect();
    let mut pictures = Vec::new();
    if shown.iter().any(|shown| shown.state.has_curves()) {
        let growth = growth_figure(case, &shown);
        pictures.push(Picture::new("growth", move |format| growth.draw(format)));
        let polar = polar_figure(case, &shown);
        pictures.push(Picture::new("polar", move |format| polar.draw(format)));
    }
    if let Some(own) = Shown::new(&found.own) {
        let directions = directions_figure(case, &own);
        pictures.push(Picture::new("directions", move |format| directions.draw(format)));
    }
    pictures
}

/// Model with a fully deforming state.
struct Shown<'a> {
    title: &'static str,
    state: &'a YieldingState,
}

impl<'a> Shown<'a> {
    fn new(analysis: &'a FlowAnalysis) -> Option<Self> {
        Some(Self { title: analysis.kind.title(), state: analysis.yielding()? })
    }

    /// Returns the legend: name of the model, fitted order of growth and exact order by the verdict.
    fn legend(&self) -> String {
        let Self { title, state } = self;
        let exact = match (state.verdict, state.order) {
            (_, Some(order)) => format!("exact {}", order_words(order)),
            ("ill-posed", None) => return format!("{title}: unbounded at all k (upper edge)"),
            ("well-posed", None) => "exact: bounded".into(),
            (verdict, None) => verdict.into(),
        };
        match state.fitted_order {
            Some(fitted) => {
                // Adding 0.0 removes the sign of a negative zero.
                let order = (1e3 * fitted).round() / 1e3 + 0.0;
                let order = format!("{order:.3}").replace('-', "−");
                format!("{title}: fitted order {order}, {exact}")
            }
            None => format!("{title}: no order fitted, {exact}"),
        }
    }
}

/// Returns the models with sampled growth rates.
fn with_curves<'a>(shown: &'a [Shown<'a>]) -> impl Iterator<Item = &'a Shown<'a>> {
    shown.iter().filter(|shown| shown.state.has_curves())
}

/// Returns the degenerate directions of all models, degrees, merged if closer than `apart` degrees.
fn degenerate_directions(shown: &[Shown], apart: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for &angle in with_curves(shown).flat_map(|s| &s.state.evidence.degenerate_directions_deg) {
        if found.iter().all(|other| (other - angle).abs() > apart) {
            found.push(angle);
        }
    }
    found
}

fn growth_figure(case: &Case, shown: &[Shown]) -> GrowthFigure {
    let wave = case.material.numbers.wave;
    let lines = |points: fn(&YieldingState) -> Vec<[f64; 2]>| {
        with_curves(shown)
            .map(|shown| Line { label: shown.legend(), points: points(shown.state) })
            .collect::<Vec<_>>()
    };
    let asymptotes = with_curves(shown).filter_map(|Shown { state, .. }| {
        let (order, coefficient) = (state.order?, state.coefficient?);
        let asymptote = |k: f64| coefficient * k.cr_powf(order);
        let points = state.by_wave_number.iter().map(|at| [at.number, asymptote(at.number)]);
        Some(Line {
            label: "exact asymptote: coefficient · k^order".into(),
            points: points.collect(),
        })
    });
    GrowthFigure {
        title: case_title(case),
        subtitle: format!(
            "greatest Re ς of all roots; left: k = {} 1/m, degenerate directions dashed; right: in \
             the worst direction at each k",
            short(wave.number),
        ),
        by_direction: Panel {
            x_label: "direction of the wave vector (°)".into(),
            y_label: "growth rate Re ς (1/s)".into(),
            x_log: false,
            curves: lines(|state| state.by_direction.clone()),
            guides: Vec::new(),
            marks: degenerate_directions(shown, 0.5)
                .into_iter()
                .map(|x| Mark { label: format!("{}°", short(x)), x })
                .collect(),
        },
        by_wave_number: Panel {
            x_label: "wave number k (1/m)".into(),
            y_label: "max of Re ς over all directions (1/s)".into(),
            x_log: true,
            curves: lines(|state| {
                state.by_wave_number.iter().map(|at| [at.number, at.greatest]).collect()
            }),
            guides: asymptotes.collect(),
            marks: vec![Mark { label: "k".into(), x: wave.number }],
        },
    }
}

/// Creates the polar figure of the growth rate against the direction of the wave vector. Characteristics are curves in
/// physical space, hence their normals are drawn as wave vector directions.
fn polar_figure(case: &Case, shown: &[Shown]) -> PolarFigure {
    let mut spokes: Vec<Spoke> = Vec::new();
    for c in shown.iter().flat_map(|shown| shown.state.characteristics.iter().flatten()) {
        let spoke = Spoke {
            label: c.family.clone(),
            angle_deg: (c.angle_deg + 90.0).rem_euclid(180.0),
            style: SpokeStyle::CharacteristicNormal,
        };
        // Models may share characteristics, within rounding.
        let same =
            |s: &Spoke| s.label == spoke.label && (s.angle_deg - spoke.angle_deg).abs() < 1e-6;
        if !spokes.iter().any(same) {
            spokes.push(spoke);
        }
    }
    spokes.extend(degenerate_directions(shown, 1e-6).into_iter().map(|angle_deg| Spoke {
        label: String::new(),
        angle_deg,
        style: SpokeStyle::Degenerate,
    }));
    PolarFigure {
        title: case_title(case),
        subtitle: format!(
            "greatest growth rate Re ς of all roots at k = {} 1/m; angle: wave vector, anticlockwise \
             from x₁",
            short(case.material.numbers.wave.number)
        ),
        symbol: "Re ς".into(),
        unit: "1/s".into(),
        curves: with_curves(shown)
            .map(|shown| Line {
                label: shown.title.into(),
                points: shown.state.by_direction.clone(),
            })
            .collect(),
        spokes,
    }
}

fn directions_figure(case: &Case, own: &Shown) -> DirectionsFigure {
    let Shown { title, state } = own;
    let mut directions: Vec<Direction> = state
        .characteristics
        .iter()
        .flatten()
        .map(|c| Direction {
            label: c.family.clone(),
            angle_deg: c.angle_deg,
            multiplicity: c.multiplicity,
            style: Style::Characteristic,
        })
        .collect();
    let axis = |label: &str, angle: f64, style| Direction {
        label: label.into(),
        angle_deg: angle.to_degrees().rem_euclid(180.0),
        multiplicity: 1,
        style,
    };
    let flow = &state.flow;
    let angle = flow.stress.angle;
    directions.push(axis("greater principal stress", angle, Style::StressAxis));
    directions.push(axis(
        "greater principal deformation rate",
        angle + flow.noncoaxiality,
        Style::DeformationAxis,
    ));
    if flow.velocity != [0.0; 2] {
        let [v1, v2] = flow.velocity;
        directions.push(axis("velocity", v2.cr_atan2(v1), Style::Velocity));
    }
    let kind = state.steady_type.map_or(String::new(), |kind| format!(", steady equations {kind}"));
    DirectionsFigure {
        title: case_title(case),
        subtitle: format!("{title}: characteristic directions{kind}"),
        directions,
    }
}
