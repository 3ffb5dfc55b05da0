//! Figures of the state of a flow.

use crate::case::Case;
use crate::report::ReportPicture;
use crate::report::format::{case_title, format_angle, format_short, format_superscript};
use crate::report::parameters::with_parameters;
use crate::study::point::{FlowAnalysis, FlowModelAnalysis, YieldingState};
use figures::{
    AxisMark, Direction, DirectionKind, DirectionsFigure, GrowthFigure, GrowthPanel, LabelledCurve,
    PolarFigure, Spoke, SpokeStyle,
};
use models::common::elementary::Elementary;

/// Creates the figures of growth rates, if sampled, and of characteristic directions, if the state is fully deforming.
pub(super) fn create_pictures(case: &Case, found: &FlowAnalysis) -> Vec<ReportPicture> {
    let models: Vec<PlottedModel> =
        found.select_plotted_models().iter().filter_map(PlottedModel::new).collect();
    let mut pictures = Vec::new();
    if models.iter().any(|models| models.yielding_state.has_curves()) {
        let growth = create_growth_figure(case, &models);
        pictures.push(ReportPicture::new("growth", move |format| growth.draw(format)));
        let polar = create_polar_figure(case, &models);
        pictures.push(ReportPicture::new("polar", move |format| polar.draw(format)));
    }
    if let Some(own) = PlottedModel::new(&found.analysis) {
        let directions = create_directions_figure(case, &own);
        pictures.push(ReportPicture::new("directions", move |format| directions.draw(format)));
    }
    pictures
}

/// Title of a model and its analysis of a fully deforming state, for plotting.
struct PlottedModel<'a> {
    model_title: &'static str,
    yielding_state: &'a YieldingState,
}

impl<'a> PlottedModel<'a> {
    fn new(analysis: &'a FlowModelAnalysis) -> Option<Self> {
        Some(Self {
            model_title: analysis.kind.title(),
            yielding_state: analysis.yielding_state()?,
        })
    }

    /// Returns the legend: name of the model, growth of short waves from the verdict, and the slope of the curve from the
    /// fit.
    fn format_legend(&self) -> String {
        let Self { model_title: title, yielding_state: state } = self;
        let exact = match (state.verdict, state.growth_order) {
            (_, Some(order)) => format!("short waves grow as k{}", format_superscript(order)),
            ("ill-posed", None) => return format!("{title}: unbounded at all k (upper edge)"),
            ("well-posed", None) => "growth bounded for all k".into(),
            (verdict, None) => verdict.into(),
        };
        match state.fitted_order {
            Some(fitted) => {
                // Adding 0.0 removes the sign of a negative zero.
                let slope = (1e3 * fitted).round() / 1e3 + 0.0;
                let slope = format!("{slope:.3}").replace('-', "−");
                format!("{title}: {exact} (fitted exponent of |Re ς|: {slope})")
            }
            None => format!("{title}: {exact}"),
        }
    }
}

/// Returns the models with sampled growth rates.
fn select_models_with_curves<'a>(
    models: &'a [PlottedModel<'a>],
) -> impl Iterator<Item = &'a PlottedModel<'a>> {
    models.iter().filter(|models| models.yielding_state.has_curves())
}

/// Returns the degenerate directions of all models, degrees, merged if closer than `min_separation` degrees.
fn collect_degenerate_directions(models: &[PlottedModel], min_separation: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for &angle in select_models_with_curves(models)
        .flat_map(|s| &s.yielding_state.evidence.degenerate_directions_deg)
    {
        if found.iter().all(|other| (other - angle).abs() > min_separation) {
            found.push(angle);
        }
    }
    found
}

fn create_growth_figure(case: &Case, models: &[PlottedModel]) -> GrowthFigure {
    let wave = case.material.numbers.wave;
    let lines = |points: fn(&YieldingState) -> Vec<[f64; 2]>| {
        select_models_with_curves(models)
            .map(|models| LabelledCurve {
                label: models.format_legend(),
                points: points(models.yielding_state),
            })
            .collect::<Vec<_>>()
    };
    let asymptotes = select_models_with_curves(models).filter_map(
        |PlottedModel { yielding_state: state, .. }| {
            let (order, coefficient) = (state.growth_order?, state.growth_coefficient?);
            let asymptote = |k: f64| coefficient * k.cr_powf(order);
            let points = state
                .growth_by_wave_number
                .iter()
                .map(|at| [at.wave_number, asymptote(at.wave_number)]);
            Some(LabelledCurve {
                label: "exact asymptote: coefficient · k^order".into(),
                points: points.collect(),
            })
        },
    );
    GrowthFigure {
        title: case_title(case),
        subtitle: with_parameters(
            &format!(
                "maximum Re ς over all roots; against the direction: k = {} 1/m, degenerate \
                 directions dashed; against k: worst direction at each k",
                format_short(wave.wave_number),
            ),
            case,
        ),
        by_direction: GrowthPanel {
            x_label: "direction of the wave vector (°)".into(),
            y_label: "growth rate Re ς (1/s)".into(),
            is_x_log: false,
            curves: lines(|state| state.growth_by_direction.clone()),
            reference_lines: Vec::new(),
            marks: collect_degenerate_directions(models, 0.5)
                .into_iter()
                .map(|x| AxisMark { label: format_angle(x), x })
                .collect(),
            is_measured: false,
        },
        by_wave_number: GrowthPanel {
            x_label: "wave number k (1/m)".into(),
            y_label: "max Re ς, all directions (1/s)".into(),
            is_x_log: true,
            curves: lines(|state| {
                state
                    .growth_by_wave_number
                    .iter()
                    .map(|at| [at.wave_number, at.max_growth_rate])
                    .collect()
            }),
            reference_lines: asymptotes.collect(),
            marks: vec![mark_wave_number(wave.wave_number)],
            is_measured: false,
        },
    }
}

/// Marks the wave number of the panel of directions, 1/m.
pub(super) fn mark_wave_number(wave_number: f64) -> AxisMark {
    AxisMark { label: format!("k = {} 1/m", format_short(wave_number)), x: wave_number }
}

/// Creates the polar figure of the growth rate against the direction of the wave vector. Characteristics are curves in
/// physical space, hence their normals are drawn as wave vector directions.
fn create_polar_figure(case: &Case, models: &[PlottedModel]) -> PolarFigure {
    let mut spokes: Vec<Spoke> = Vec::new();
    for c in models.iter().flat_map(|models| models.yielding_state.characteristics.iter().flatten())
    {
        let spoke = Spoke {
            label: c.family.clone(),
            angle_deg: (c.angle_deg + 90.0).rem_euclid(180.0),
            style: SpokeStyle::CharacteristicNormal,
        };
        // Several models may have the same characteristic, within rounding.
        let same =
            |s: &Spoke| s.label == spoke.label && (s.angle_deg - spoke.angle_deg).abs() < 1e-6;
        if !spokes.iter().any(same) {
            spokes.push(spoke);
        }
    }
    spokes.extend(collect_degenerate_directions(models, 1e-6).into_iter().map(|angle_deg| Spoke {
        label: String::new(),
        angle_deg,
        style: SpokeStyle::DegenerateDirection,
    }));
    PolarFigure {
        title: case_title(case),
        subtitle: with_parameters(
            &format!(
                "maximum growth rate Re ς over all roots at k = {} 1/m; angle: wave vector, \
                 anticlockwise from x₁",
                format_short(case.material.numbers.wave.wave_number)
            ),
            case,
        ),
        symbol: "Re ς".into(),
        unit: "1/s".into(),
        curves: select_models_with_curves(models)
            .map(|models| LabelledCurve {
                label: models.model_title.into(),
                points: models.yielding_state.growth_by_direction.clone(),
            })
            .collect(),
        spokes,
    }
}

fn create_directions_figure(case: &Case, own: &PlottedModel) -> DirectionsFigure {
    let PlottedModel { model_title: title, yielding_state: state } = own;
    let mut directions: Vec<Direction> = state
        .characteristics
        .iter()
        .flatten()
        .map(|c| Direction {
            label: c.family.clone(),
            angle_deg: c.angle_deg,
            multiplicity: c.multiplicity,
            kind: DirectionKind::Characteristic,
        })
        .collect();
    let axis = |label: &str, angle: f64, style| Direction {
        label: label.into(),
        angle_deg: angle.to_degrees().rem_euclid(180.0),
        multiplicity: 1,
        kind: style,
    };
    let flow = &state.flow;
    let angle = flow.stress.angle;
    directions.push(axis("major principal stress", angle, DirectionKind::StressAxis));
    directions.push(axis(
        "major principal deformation rate",
        angle + flow.noncoaxiality,
        DirectionKind::DeformationAxis,
    ));
    if flow.velocity != [0.0; 2] {
        let [v1, v2] = flow.velocity;
        directions.push(axis("velocity", v2.cr_atan2(v1), DirectionKind::Velocity));
    }
    let kind = state.steady_type.map_or(String::new(), |kind| format!(", steady equations {kind}"));
    DirectionsFigure {
        title: case_title(case),
        subtitle: with_parameters(&format!("{title}: characteristic directions{kind}"), case),
        directions,
    }
}
