//! `wellposed point`: everything about one state.

use crate::case::{Case, radians};
use crate::frozen::{Frozen, Workspace};
use crate::output::{self, ResultFolder};
use crate::words::{
    ROUTE, VALIDITY, case_title, coefficient_unit, order_words, short, superscript,
};
use crate::{Error, Format, Options};
use analysis::bound::{self, Place, Supremum};
use analysis::characteristics::{self, Characteristics, Type};
use analysis::growth::{Assessment, Verdict};
use analysis::pencil::Roots;
use figures::{Direction, DirectionsFigure, GrowthFigure, Line, Mark, Panel, Style};
use models::Rounded;
use models::granular_flow::state::{Background, Flow};
use models::granular_flow::{InputError, Kind, Model};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

/// Samples of the growth rate over directions, two per degree; layers around the degenerate ones are
/// sampled in steps of equal ratio.
const DIRECTIONS: usize = 360;
/// Exponents of ten of the distances from a degenerate direction, degrees: first, step, number.
const LAYER: (f64, f64, usize) = (-9.0, 0.1, 90);
/// Samples over wave numbers, and how many decades they reach to both sides of the given one.
const WAVE_NUMBERS: usize = 241;
const DECADES: f64 = 4.0;

/// One model on the state.
struct Analysed {
    kind: Kind,
    model: Model,
    frozen: Frozen,
    /// Of no meaning unless the state flows.
    roots: Roots,
    characteristics: Option<Characteristics>,
    supremum: Option<Supremum>,
    by_direction: Vec<[f64; 2]>,
    by_wave_number: Vec<[f64; 2]>,
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
    // Keys that only a compared kind uses are nothing to this one.
    let own = analyse(&case.for_kind(case.kind))?;
    let noncoaxiality = match &own.frozen {
        Frozen::Flowing { flow, .. } => Some(degrees(flow.noncoaxiality)),
        Frozen::Elsewhere(_) => None,
    };
    let mut compared = Vec::new();
    for &kind in case.compare.iter().flatten() {
        let converted = case.for_kind_with(kind, noncoaxiality);
        let mut other = analyse(&converted.case)?;
        other.lost_noncoaxiality_deg = converted.lost_noncoaxiality_deg;
        compared.push(other);
    }
    let shown: Vec<&Analysed> =
        if compared.is_empty() { vec![&own] } else { compared.iter().collect() };
    let has_curves = shown.iter().any(|a| !a.by_direction.is_empty());
    let has_directions = matches!(own.frozen, Frozen::Flowing { .. });
    if options.dry_run {
        writeln!(stdout, "would analyse {}", case_title(&case))?;
        let written = |name: &&&str| match **name {
            name if name.starts_with("growth") => has_curves,
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
                let _ = writeln!(words, "  (coaxial: Δ = 0 in place of {}°)", short(delta));
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
        let by_direction = csv("direction_deg", &shown, |a| &a.by_direction)?;
        folder.write("growth_by_direction.csv", &by_direction)?;
        let by_wave_number = csv("number", &shown, |a| &a.by_wave_number)?;
        folder.write("growth_by_wave_number.csv", &by_wave_number)?;
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
    let (model, frozen) = workspace.judge(case).map_err(|error| error.locate(case))?;
    let mut analysed = Analysed {
        kind: case.kind,
        model,
        frozen,
        roots: Roots::Singular { rank: 0 },
        characteristics: None,
        supremum: None,
        by_direction: Vec::new(),
        by_wave_number: Vec::new(),
        lost_noncoaxiality_deg: None,
    };
    let Frozen::Flowing { flow, assessment } = &analysed.frozen else { return Ok(analysed) };
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
    if !pencil.is_singular() {
        let step = 180.0 / DIRECTIONS as f64;
        let mut degrees: Vec<f64> = (0..=DIRECTIONS).map(|i| i as f64 * step).collect();
        for centre in assessment.degenerate.iter().map(|d| d.angle.to_degrees()) {
            let (first, ratio, number) = LAYER;
            let offsets = (0..number).map(|i| 10f64.powf(first + ratio * i as f64));
            degrees.extend(offsets.flat_map(|offset| [centre - offset, centre + offset]));
            degrees.push(centre);
        }
        degrees.retain(|d| (0.0..=180.0).contains(d));
        degrees.sort_by(f64::total_cmp);
        analysed.by_direction =
            degrees.iter().map(|&d| [d, workspace.growth(wave.number, d.to_radians())]).collect();
        analysed.by_wave_number = (0..WAVE_NUMBERS)
            .map(|i| {
                let exponent = (2.0 * i as f64 / (WAVE_NUMBERS - 1) as f64 - 1.0) * DECADES;
                let k = wave.number * 10f64.powf(exponent);
                [k, workspace.growth(k, direction)]
            })
            .collect();
    }
    Ok(analysed)
}

fn degrees(x: f64) -> f64 {
    x.to_degrees()
}

/// All that is known of a model on the state, as JSON.
fn report(case: &Case, of: &Analysed) -> Value {
    let wave = case.numbers.wave;
    let background = match &of.frozen {
        Frozen::Elsewhere(background) => background,
        Frozen::Flowing { flow, assessment } => return report_flow(case, of, flow, assessment),
    };
    json!({
        "model": of.kind.name(),
        "region": background.region().name(),
        "verdict": null, "order": null, "coefficient": null, "direction_deg": null,
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
        Frozen::Elsewhere(background) => {
            let _ = writeln!(
                text,
                "region: {}\nThe state is not fully deforming: nothing to analyse.",
                background.region().name()
            );
            return text;
        }
        Frozen::Flowing { flow, .. } => flow,
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
    if of.kind == Kind::HarrisGrekova {
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
    let Frozen::Flowing { assessment, .. } = &of.frozen else {
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

fn csv(
    abscissa: &str,
    shown: &[&Analysed],
    curve: fn(&Analysed) -> &Vec<[f64; 2]>,
) -> Result<Vec<u8>, Error> {
    let rows = shown.iter().flat_map(|a| {
        curve(a).iter().map(|&[x, y]| -> Vec<files::csv::Cell> {
            vec![a.kind.name().into(), x.into(), y.into()]
        })
    });
    Ok(files::csv::table(&["model", abscissa, "growth_rate"], rows)?)
}

fn growth_figure(case: &Case, shown: &[&Analysed]) -> GrowthFigure {
    let wave = case.numbers.wave;
    let curves = |curve: fn(&Analysed) -> &Vec<[f64; 2]>| {
        shown
            .iter()
            .filter(|a| !curve(a).is_empty())
            .map(|a| Line { label: a.kind.title().into(), points: curve(a).clone() })
            .collect::<Vec<_>>()
    };
    let mut marks: Vec<Mark> = Vec::new();
    for a in shown {
        let Frozen::Flowing { assessment, .. } = &a.frozen else { continue };
        for d in &assessment.degenerate {
            let x = degrees(d.angle);
            if marks.iter().all(|m| (m.x - x).abs() > 0.5) {
                marks.push(Mark { label: format!("{}°", short(x)), x });
            }
        }
    }
    GrowthFigure {
        title: case_title(case),
        subtitle: format!(
            "greatest growth rate of all roots; left k = {} 1/m, right {}°; marked: degenerate directions",
            short(wave.number),
            short(wave.direction_deg)
        ),
        by_direction: Panel {
            x_label: "direction of the wave vector (°)".into(),
            y_label: "growth rate Re ς (1/s)".into(),
            x_log: false,
            curves: curves(|a| &a.by_direction),
            marks,
        },
        by_wave_number: Panel {
            x_label: "wave number k (1/m)".into(),
            y_label: "growth rate Re ς (1/s)".into(),
            x_log: true,
            curves: curves(|a| &a.by_wave_number),
            marks: vec![Mark { label: "k".into(), x: wave.number }],
        },
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
    if let Frozen::Flowing { flow, .. } = &of.frozen {
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
            directions.push(axis("velocity", v2.atan2(v1), Style::Velocity));
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
