//! `wellposed point`: everything about one state.

mod solid;

use crate::case::{Case, Kind, radians};
use crate::output::{self, ResultFolder};
use crate::report::format::{
    ROUTE, VALIDITY, case_title, coaxial_words, coefficient_unit, order_words, short, superscript,
};
use crate::{Error, Format, Options, setup};
use analysis::bound::{self, Place, Supremum};
use analysis::characteristics::{self, Characteristics, Type};
use analysis::flows::growth_curves::{self as curves, AtWaveNumber, FittedOrder};
use analysis::flows::{FrozenState, Workspace};
use analysis::growth::{Assessment, Verdict};
use analysis::pencil::Roots;
use figures::{
    Direction, DirectionsFigure, GrowthFigure, Line, Mark, Panel, PolarFigure, Spoke, SpokeStyle,
    Style,
};
use models::Rounded;
use models::elementary::Elementary;
use models::granular_flow::state::{Background, Flow};
use models::granular_flow::{InputError, Model, RotationKind};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

/// One model on the state.
struct Analysed {
    kind: Kind,
    model: Model,
    frozen: FrozenState,
    workspace: Workspace,
    /// Of no meaning unless the state flows.
    roots: Roots,
    characteristics: Option<Characteristics>,
    supremum: Option<Supremum>,
    by_direction: Vec<[f64; 2]>,
    by_wave_number: Vec<AtWaveNumber>,
    fitted: Option<FittedOrder>,
    /// Non-coaxiality of the compared state that this model, being coaxial, cannot have.
    lost_noncoaxiality_deg: Option<f64>,
}

/// Analyses the state of a case.
///
/// # Errors
/// The case is wrong, or results cannot be written.
pub fn run(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    if let Kind::Solid(_) = case.kind {
        return solid::run(options, &case, &folder, stdout);
    }
    // Keys that only a compared kind uses are nothing to this one.
    let mut own = analyse(&case.for_kind(case.kind))?;
    let noncoaxiality = match &own.frozen {
        FrozenState::Yielding { flow, .. } => Some(degrees(flow.noncoaxiality)),
        FrozenState::NotYielding(_) => None,
    };
    let mut compared = Vec::new();
    for &kind in case.compare.iter().flatten() {
        let converted = case.for_kind_with(kind, noncoaxiality);
        let mut other = analyse(&converted.case)?;
        other.lost_noncoaxiality_deg = converted.lost_noncoaxiality_deg;
        compared.push(other);
    }
    add_curves(&case, &mut own, &mut compared);
    let shown: Vec<&Analysed> =
        if compared.is_empty() { vec![&own] } else { compared.iter().collect() };
    let has_curves = shown.iter().any(|a| a.regular().is_some());
    let has_directions = matches!(own.frozen, FrozenState::Yielding { .. });
    if options.dry_run {
        writeln!(stdout, "would analyse {}", case_title(&case))?;
        let written = |name: &&&str| match **name {
            name if name.starts_with("growth") || name.starts_with("polar") => has_curves,
            name if name.starts_with("directions") => has_directions,
            _ => true,
        };
        for name in output::POINT.iter().filter(written) {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }

    let mut value = report(&case, &own);
    if !compared.is_empty() {
        value["compare"] = compared.iter().map(|other| report(&case, other)).collect();
    }
    let json = format!("{value:#}\n");
    let mut words = words(&case, &own);
    for other in &compared {
        if other.kind != own.kind {
            let _ = write!(words, "\nCompared: {}\n", other.kind.title());
            if let Some(delta) = other.lost_noncoaxiality_deg {
                let _ = writeln!(words, "  {}", coaxial_words(delta));
            }
            words += &verdict_words(other);
        }
    }

    folder.open()?;
    folder.write("point.json", json.as_bytes())?;
    folder.write("point.txt", words.as_bytes())?;
    if has_curves {
        let growth = growth_figure(&case, &shown);
        folder.write("growth.png", &growth.draw(figures::Format::Png)?)?;
        folder.write("growth.svg", &growth.draw(figures::Format::Svg)?)?;
        let polar = polar_figure(&case, &shown);
        folder.write("polar.png", &polar.draw(figures::Format::Png)?)?;
        folder.write("polar.svg", &polar.draw(figures::Format::Svg)?)?;
        folder.write("growth_by_direction.csv", &direction_csv(&shown)?)?;
        folder.write("growth_by_wave_number.csv", &wave_number_csv(&shown)?)?;
    }
    if has_directions {
        let directions = directions_figure(&case, &own);
        folder.write("directions.png", &directions.draw(figures::Format::Png)?)?;
        folder.write("directions.svg", &directions.draw(figures::Format::Svg)?)?;
    }
    match options.format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            writeln!(stdout, "results: {}", folder.path().display())?;
        }
    }
    Ok(())
}

fn analyse(case: &Case) -> Result<Analysed, Error> {
    let mut workspace = Workspace::default();
    let (model, frozen) =
        setup::flow::assess(case, &mut workspace).map_err(|error| setup::locate(case, error))?;
    let mut analysed = Analysed {
        kind: case.kind,
        model,
        frozen,
        workspace,
        roots: Roots::Singular { rank: 0 },
        characteristics: None,
        supremum: None,
        by_direction: Vec::new(),
        by_wave_number: Vec::new(),
        fitted: None,
        lost_noncoaxiality_deg: None,
    };
    let FrozenState::Yielding { flow, assessment } = &analysed.frozen else { return Ok(analysed) };
    let (model, workspace) = (&analysed.model, &analysed.workspace);
    let wave = case.numbers.wave;
    let direction = radians(wave.direction_deg);
    let pencil = &workspace.pencil;
    let out_of_reach = |key, found: f64, allowed: &str| {
        case.locate(InputError { key, found: format!("{found:?}"), allowed: allowed.into() })
    };
    if !pencil.is_singular() && !workspace.reaches(wave.number) {
        let allowed =
            "a wave number that far from the state's own scale leaves the range of doubles";
        return Err(out_of_reach("wave.number", wave.number, allowed).into());
    }
    analysed.roots = pencil.roots(wave.number, direction);
    if let Roots::Regular { finite, .. } = &analysed.roots
        && finite.iter().any(|root| !root.is_finite())
    {
        let allowed = "k·V leaves the range of doubles";
        return Err(out_of_reach("background.velocity", flow.velocity[0], allowed).into());
    }
    analysed.characteristics = characteristics::characteristics(&workspace.system).ok();
    analysed.supremum = bound::supremum(pencil, assessment, model.gradient_wave_number(flow));
    Ok(analysed)
}

/// Samples the growth rates of all models, over the same wave numbers.
fn add_curves(case: &Case, own: &mut Analysed, compared: &mut [Analysed]) {
    let wave = case.numbers.wave;
    let direction = radians(wave.direction_deg);
    let decades = std::iter::once(&*own)
        .chain(&*compared)
        .filter_map(|a| Some(curves::decades(&a.workspace, a.regular()?, wave.number)))
        .max();
    let Some(decades) = decades else { return };
    for a in std::iter::once(own).chain(compared) {
        let Some(assessment) = a.regular() else { continue };
        let by_direction = curves::by_direction(&a.workspace, assessment, wave.number);
        let by_wave_number =
            curves::by_wave_number(&a.workspace, assessment, wave.number, direction, decades);
        a.fitted = curves::fitted_order(&by_wave_number);
        (a.by_direction, a.by_wave_number) = (by_direction, by_wave_number);
    }
}

impl Analysed {
    /// The assessment of a state whose equations determine their unknowns.
    fn regular(&self) -> Option<&Assessment> {
        match &self.frozen {
            FrozenState::Yielding { assessment, .. } if !self.workspace.pencil.is_singular() => {
                Some(assessment)
            }
            _ => None,
        }
    }

    /// The name of the model, and the order of its growth as fitted and as the verdict has it.
    fn legend(&self) -> String {
        let exact = match self.regular().map(|assessment| &assessment.verdict) {
            Some(Verdict::IllPosed { growth: Some(growth), .. }) => {
                format!("exact {}", order_words(growth.order.value()))
            }
            Some(Verdict::IllPosed { growth: None, .. }) => {
                return format!("{}: unbounded at all k (upper edge)", self.kind.title());
            }
            Some(Verdict::WellPosed) => "exact: bounded".into(),
            Some(verdict) => verdict.name().into(),
            None => return self.kind.title().into(),
        };
        match self.fitted {
            Some(fitted) => {
                // No sign on a zero.
                let order = (1e3 * fitted.order).round() / 1e3 + 0.0;
                let order = format!("{order:.3}").replace('-', "−");
                format!("{}: fitted order {order}, {exact}", self.kind.title())
            }
            None => format!("{}: no order fitted, {exact}", self.kind.title()),
        }
    }
}

fn degrees(x: f64) -> f64 {
    x.to_degrees()
}

/// All that is known of a model on the state, as JSON.
fn report(case: &Case, of: &Analysed) -> Value {
    let wave = case.numbers.wave;
    let background = match &of.frozen {
        FrozenState::NotYielding(background) => background,
        FrozenState::Yielding { flow, assessment } => {
            return report_flow(case, of, flow, assessment);
        }
    };
    json!({
        "model": of.kind.name(),
        "region": background.region().name(),
        "verdict": null, "order": null, "coefficient": null, "direction_deg": null,
        "fitted_order": null, "fitted_wave_numbers": null,
        "bound": null, "bound_at": null, "noncoaxiality_bound_deg": null,
        "power": null, "roots": null, "infinite_roots": null, "characteristics": null,
        "wave": { "number": wave.number, "direction_deg": wave.direction_deg },
        "stress": stress(background),
        "words": "the state is not fully deforming: nothing to analyse",
    })
}

fn stress(background: &Background) -> Value {
    let stress = background.stress();
    json!({
        "pressure": stress.pressure,
        "deviatoric_stress": stress.deviator.value,
        "rotational_stress": stress.rotational,
        "stress_angle_deg": degrees(stress.angle),
        "tensor": stress.tensor(),
    })
}

fn report_flow(case: &Case, of: &Analysed, flow: &Flow, assessment: &Assessment) -> Value {
    let wave = case.numbers.wave;
    let (mut order, mut coefficient, mut direction) = (Value::Null, Value::Null, Value::Null);
    if let Verdict::IllPosed { growth, direction: angle } = &assessment.verdict {
        direction = degrees(*angle).into();
        if let Some(growth) = growth {
            (order, coefficient) = (growth.order.value().into(), growth.coefficient.into());
        }
    }
    let (roots, infinite) = match &of.roots {
        Roots::Regular { finite, infinite } => (
            finite.iter().map(|r| json!([r.re, r.im])).collect::<Vec<_>>().into(),
            (*infinite).into(),
        ),
        Roots::Singular { .. } => (Value::Null, Value::Null),
    };
    let characteristics = of.characteristics.as_ref().map(|c| {
        c.real
            .iter()
            .map(|c| {
                json!({
                    "angle_deg": degrees(c.angle), "multiplicity": c.multiplicity,
                    "family": c.family,
                })
            })
            .collect::<Vec<_>>()
    });
    let complex = of.characteristics.as_ref().map(|c| {
        c.complex
            .iter()
            .map(|(tangent, family)| json!({ "tangent": [tangent.re, tangent.im], "family": family }))
            .collect::<Vec<_>>()
    });
    let gradient = of.model.gradient_wave_number(flow);
    json!({
        "model": of.kind.name(),
        "verdict": assessment.verdict.name(),
        "order": order,
        "coefficient": coefficient,
        "direction_deg": direction,
        "fitted_order": of.fitted.map(|fitted| fitted.order),
        "fitted_wave_numbers": of.fitted.map(|fitted| fitted.numbers),
        "bound": of.supremum.map(|s| s.rate),
        "bound_at": of.supremum.map(|s| json!({
            "number": match s.place { Place::At(k) => Some(k), _ => None },
            "direction_deg": degrees(s.direction),
            "limit": match s.place {
                Place::At(_) => None,
                Place::LongWaves => Some("longest waves"),
                Place::ShortWaves => Some("shortest waves"),
            },
        })),
        "bound_tolerance": of.supremum.map(|_| bound::TOLERANCE),
        "noncoaxiality_bound_deg": of.model.noncoaxiality_bound().map(degrees),
        "region": "fully-deforming",
        "power": flow.power,
        "wave": { "number": wave.number, "direction_deg": wave.direction_deg },
        "roots": roots,
        "infinite_roots": infinite,
        "characteristics": characteristics,
        "complex_characteristics": complex,
        "arbitrary_characteristics": of.characteristics.as_ref().map(|c| c.arbitrary.clone()),
        "steady_type": of.characteristics.as_ref().and_then(|c| c.kind).map(type_name),
        "evidence": {
            "words": evidence(&assessment.verdict),
            "orders": assessment.orders.iter().map(|(order, count)| json!({
                "order": order.value(), "roots": count,
            })).collect::<Vec<_>>(),
            "degenerate_directions_deg":
                assessment.degenerate.iter().map(|d| degrees(d.angle)).collect::<Vec<_>>(),
            "route": ROUTE,
        },
        "background": {
            "density": flow.density,
            "shear_rate": flow.shear_rate,
            "noncoaxiality_deg": degrees(flow.noncoaxiality),
            "velocity": flow.velocity,
            "half_vorticity": flow.half_vorticity,
            "velocity_gradient": flow.velocity_gradient.map(|row| row.map(|x| x.value)),
            "spin": flow.spin.map(|s| s.value),
            "acceleration": flow.acceleration.map(|a| a.value + 0.0),
            "body_moment": flow.body_moment,
            "stress_angle_rate_deg": flow.stress_angle_rate.map(degrees),
        },
        "stress": stress(&Background::FullyDeforming(*flow)),
        "gradient_wave_number": gradient,
    })
}

fn type_name(kind: Type) -> &'static str {
    match kind {
        Type::Hyperbolic => "hyperbolic",
        Type::Mixed => "mixed",
        Type::Elliptic => "elliptic",
    }
}

/// What a verdict rests on, in words.
fn evidence(verdict: &Verdict) -> String {
    match verdict {
        Verdict::WellPosed => {
            "no root grows without bound as k → ∞ in any direction, layers around the degenerate \
             directions included"
                .into()
        }
        Verdict::IllPosed { growth: Some(growth), direction } => {
            let order = growth.order.value();
            format!(
                "Re ς ≈ {} k{} as k → ∞, for wave vectors at {}°",
                short(growth.coefficient),
                superscript(order),
                short(degrees(*direction))
            )
        }
        Verdict::IllPosed { growth: None, direction } => format!(
            "the growth rate is unbounded at finite wave numbers already: the coefficient of the \
             highest power of ς vanishes and changes sign for wave vectors at {}°",
            short(degrees(*direction))
        ),
        Verdict::Marginal { quantity, value, rounding } => format!(
            "the {quantity} is {value:.1e} with a rounding bound of {rounding:.1e} (scaled): no \
             sign can be asserted"
        ),
        Verdict::Indeterminate { rank, unknowns } => {
            format!("the equations determine {rank} of {unknowns} unknowns: every ς is a root")
        }
    }
}

fn pair(values: [f64; 2]) -> String {
    format!("({}, {})", short(values[0]), short(values[1]))
}

/// Pairs whose components vanish within rounding are printed as zeros.
fn pair_of(values: [Rounded; 2]) -> String {
    pair(values.map(|x| if x.sign().is_some() { x.value } else { 0.0 }))
}

fn words(case: &Case, of: &Analysed) -> String {
    let mut text = format!("{}\nmodel: {}\n", case_title(case), of.kind.title());
    let flow = match &of.frozen {
        FrozenState::NotYielding(background) => {
            let _ = writeln!(
                text,
                "region: {}\nThe state is not fully deforming: nothing to analyse.",
                background.region().name()
            );
            return text;
        }
        FrozenState::Yielding { flow, .. } => flow,
    };
    let tensor = flow.stress.tensor();
    let gradient = flow.velocity_gradient;
    let _ = writeln!(text, "region: fully-deforming");
    let _ = writeln!(
        text,
        "internal power: {} W/m³{}",
        short(flow.power),
        if flow.power < 0.0 { " (negative)" } else { "" }
    );
    let _ = writeln!(text, "\nBackground (given and derived)");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<36}{value}");
    };
    line("deviatoric stress q", format!("{} Pa", short(flow.stress.deviator.value)));
    if of.model.kind().rotation() == RotationKind::IntrinsicSpin {
        line("rotational stress r", format!("{} Pa", short(flow.stress.rotational)));
    }
    line(
        "stress (second index: face normal)",
        format!("[{}, {}] Pa", pair(tensor[0]), pair(tensor[1])),
    );
    line("non-coaxiality Δ", format!("{}°", short(degrees(flow.noncoaxiality))));
    line(
        "velocity gradient ∂ⱼVᵢ",
        format!("[{}, {}] 1/s", pair_of(gradient[0]), pair_of(gradient[1])),
    );
    if let Some(spin) = flow.spin {
        line("spin Ω", format!("{} rad/s", short(spin.value)));
    }
    line("acceleration less body force", format!("{} m/s²", pair_of(flow.acceleration)));
    if let Some(moment) = flow.body_moment {
        line("body moment per unit mass", format!("{} m²/s²", short(moment)));
    }
    if let Some(rate) = flow.stress_angle_rate {
        line("rate of the stress angle", format!("{} °/s", short(degrees(rate))));
    }

    let _ = writeln!(text, "\nSteady characteristic directions");
    match &of.characteristics {
        None => {
            let _ = writeln!(text, "  the steady equations do not determine their unknowns");
        }
        Some(found) => {
            for c in &found.real {
                let _ = writeln!(
                    text,
                    "  {:>9}°  multiplicity {}  {}",
                    short(degrees(c.angle)),
                    c.multiplicity,
                    c.family
                );
            }
            for (tangent, family) in &found.complex {
                let _ = writeln!(
                    text,
                    "  complex, tan = {} {} {}i  {family}",
                    short(tangent.re),
                    if tangent.im < 0.0 { "−" } else { "+" },
                    short(tangent.im.abs())
                );
            }
            for family in &found.arbitrary {
                let _ = writeln!(text, "  every direction  {family} (no convection)");
            }
            if let Some(kind) = found.kind {
                let aside =
                    if found.arbitrary.is_empty() { "" } else { " (fields at rest left aside)" };
                let _ = writeln!(text, "  type: {}{aside}", type_name(kind));
            }
        }
    }

    let wave = case.numbers.wave;
    let _ = writeln!(
        text,
        "\nDispersion roots ς at k = {} 1/m, direction {}°",
        short(wave.number),
        short(wave.direction_deg)
    );
    match &of.roots {
        Roots::Regular { finite, infinite } => {
            for root in finite {
                let _ = writeln!(text, "  {:>12} {:>+13.4e} i  1/s", short(root.re), root.im);
            }
            let _ = writeln!(text, "  and {infinite} infinite ones (algebraic equations)");
        }
        Roots::Singular { rank } => {
            let _ = writeln!(text, "  every ς is a root (rank {rank})");
        }
    }
    let gradient = of.model.gradient_wave_number(flow);
    if gradient > 0.0 {
        let _ =
            writeln!(text, "  k × length of the background = {}", short(wave.number / gradient));
    }
    let _ = write!(text, "\n{}", verdict_words(of));
    let _ = writeln!(text, "Route: {ROUTE}\n{VALIDITY}");
    text
}

fn verdict_words(of: &Analysed) -> String {
    let FrozenState::Yielding { assessment, .. } = &of.frozen else {
        return "Not fully deforming.\n".into();
    };
    let verdict = &assessment.verdict;
    let mut text = format!("Verdict: {}\n  {}\n", verdict.name(), evidence(verdict));
    if let Verdict::IllPosed { growth: Some(growth), .. } = verdict {
        let order = growth.order.value();
        let _ = writeln!(
            text,
            "  order {}, coefficient {} {}",
            order_words(order),
            growth.coefficient,
            coefficient_unit(order)
        );
    }
    if let Some(FittedOrder { order, numbers: [from, to] }) = of.fitted {
        let _ = writeln!(
            text,
            "  fitted order {:.3}: greatest Re ς over all directions, k from {} to {} 1/m",
            (1e3 * order).round() / 1e3 + 0.0,
            short(from),
            short(to)
        );
    }
    if !assessment.orders.is_empty() {
        let list: Vec<String> = assessment
            .orders
            .iter()
            .map(|(order, count)| format!("{count} × k{}", superscript(order.value())))
            .collect();
        let _ = writeln!(text, "  unbounded roots in a general direction: {}", list.join(", "));
    }
    if !assessment.degenerate.is_empty() {
        let list: Vec<String> =
            assessment.degenerate.iter().map(|d| format!("{}°", short(degrees(d.angle)))).collect();
        let _ = writeln!(text, "  degenerate directions of the wave vector: {}", list.join(", "));
    }
    if let Some(supremum) = of.supremum {
        let place = match supremum.place {
            Place::At(k) => format!("at k = {} 1/m", short(k)),
            Place::LongWaves => "approached by the longest waves".into(),
            Place::ShortWaves => "approached as k → ∞".into(),
        };
        let _ = writeln!(
            text,
            "  supremum of Re ς: {} 1/s, {place}, direction {}°",
            short(supremum.rate),
            short(degrees(supremum.direction))
        );
    }
    if let Some(bound) = of.model.noncoaxiality_bound() {
        let _ = writeln!(
            text,
            "  bound on |Δ| for the leading order of growth: {}°",
            short(degrees(bound))
        );
    }
    text
}

fn direction_csv(shown: &[&Analysed]) -> Result<Vec<u8>, Error> {
    let rows = shown.iter().flat_map(|a| {
        a.by_direction.iter().map(|&[direction, rate]| -> Vec<files::csv::Cell> {
            vec![a.kind.name().into(), direction.into(), rate.into()]
        })
    });
    Ok(files::csv::table(&["model", "direction_deg", "growth_rate"], rows)?)
}

fn wave_number_csv(shown: &[&Analysed]) -> Result<Vec<u8>, Error> {
    let columns =
        ["model", "number", "growth_rate", "greatest_growth_rate", "greatest_direction_deg"];
    let rows = shown.iter().flat_map(|a| {
        a.by_wave_number.iter().map(|at| -> Vec<files::csv::Cell> {
            vec![
                a.kind.name().into(),
                at.number.into(),
                at.growth_rate.into(),
                at.greatest.into(),
                degrees(at.direction).into(),
            ]
        })
    });
    Ok(files::csv::table(&columns, rows)?)
}

/// The degenerate directions of all models, degrees, each once.
fn degenerate_directions(shown: &[&Analysed], apart: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for d in shown.iter().filter_map(|a| a.regular()).flat_map(|a| &a.degenerate) {
        let angle = degrees(d.angle);
        if found.iter().all(|other| (other - angle).abs() > apart) {
            found.push(angle);
        }
    }
    found
}

fn growth_figure(case: &Case, shown: &[&Analysed]) -> GrowthFigure {
    let wave = case.numbers.wave;
    let lines = |points: fn(&Analysed) -> Vec<[f64; 2]>| {
        let with_curves = shown.iter().filter(|a| !a.by_direction.is_empty());
        with_curves.map(|a| Line { label: a.legend(), points: points(a) }).collect::<Vec<_>>()
    };
    let asymptotes = shown.iter().filter_map(|a| {
        let Verdict::IllPosed { growth: Some(growth), .. } = &a.regular()?.verdict else {
            return None;
        };
        let asymptote = |k: f64| growth.coefficient * k.cr_powf(growth.order.value());
        let points = a.by_wave_number.iter().map(|at| [at.number, asymptote(at.number)]);
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
            curves: lines(|a| a.by_direction.clone()),
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
            curves: lines(|a| a.by_wave_number.iter().map(|at| [at.number, at.greatest]).collect()),
            guides: asymptotes.collect(),
            marks: vec![Mark { label: "k".into(), x: wave.number }],
        },
    }
}

/// Growth against the direction of the wave vector. Characteristics are curves in space: it is their
/// normals that are directions of wave vectors.
fn polar_figure(case: &Case, shown: &[&Analysed]) -> PolarFigure {
    let mut spokes: Vec<Spoke> = Vec::new();
    for c in shown.iter().filter_map(|a| a.characteristics.as_ref()).flat_map(|c| &c.real) {
        let spoke = Spoke {
            label: c.family.clone(),
            angle_deg: (degrees(c.angle) + 90.0).rem_euclid(180.0),
            style: SpokeStyle::CharacteristicNormal,
        };
        // Models may share them, within rounding.
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
    let with_curves = shown.iter().filter(|a| !a.by_direction.is_empty());
    PolarFigure {
        title: case_title(case),
        subtitle: format!(
            "greatest growth rate Re ς of all roots at k = {} 1/m; angle: wave vector, anticlockwise \
             from x₁",
            short(case.numbers.wave.number)
        ),
        symbol: "Re ς".into(),
        unit: "1/s".into(),
        curves: with_curves
            .map(|a| Line { label: a.kind.title().into(), points: a.by_direction.clone() })
            .collect(),
        spokes,
    }
}

fn directions_figure(case: &Case, of: &Analysed) -> DirectionsFigure {
    let mut directions: Vec<Direction> = of
        .characteristics
        .iter()
        .flat_map(|found| &found.real)
        .map(|c| Direction {
            label: c.family.clone(),
            angle_deg: degrees(c.angle),
            multiplicity: c.multiplicity,
            style: Style::Characteristic,
        })
        .collect();
    if let FrozenState::Yielding { flow, .. } = &of.frozen {
        let axis = |label: &str, angle: f64, style| Direction {
            label: label.into(),
            angle_deg: degrees(angle).rem_euclid(180.0),
            multiplicity: 1,
            style,
        };
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
    }
    let kind = of
        .characteristics
        .as_ref()
        .and_then(|c| c.kind)
        .map_or(String::new(), |kind| format!(", steady equations {}", type_name(kind)));
    DirectionsFigure {
        title: case_title(case),
        subtitle: format!("{}: characteristic directions{kind}", of.kind.title()),
        directions,
    }
}
