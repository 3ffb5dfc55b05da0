//! `wellposed point` on a solid.

use crate::case::{Case, Kind, Wave};
use crate::output::{self, ResultFolder};
use crate::report::format::{
    VALIDITY, case_title, flutter_json, normal_json, normal_words as at, short,
};
use crate::setup;
use crate::setup::solid::normal;
use crate::{Error, Format, Options};
use analysis::bound;
use analysis::energy::{self, Energy};
use analysis::growth::Verdict;
use analysis::solids::{self, AcousticTensorCache, Hyperbolicity, SolidAssessment, SolidAssessor};
use analysis::waves::Waves;
use figures::{GrowthFigure, Line, Mark, Panel};
use models::cosserat::parameters::Theory;
use models::elastoplastic::Solid;
use models::elementary::Elementary;
use models::plasticity::symbol::NoResponse;
use num_complex::Complex64;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::Write;

/// Directions of the curve against direction.
const DIRECTIONS: usize = 720;
/// Wave numbers per decade, and decades to both sides of the case's, of the curve against them.
const PER_DECADE: i32 = 12;
const DECADES: i32 = 4;

/// All that is known of a solid.
struct Analysed {
    solid: Solid,
    assessment: SolidAssessment,
    /// Supremum of Re ς, 1/s, where it is known to be finite.
    bound: Option<f64>,
    waves: Waves,
    roots: Vec<Complex64>,
    elastic: Waves,
    energy: Energy,
    by_direction: Vec<[f64; 2]>,
    by_wave_number: Vec<[f64; 2]>,
    /// The same in the direction in which short waves grow fastest.
    in_worst_direction: Vec<[f64; 2]>,
}

/// Analyses the solid of a case.
///
/// # Errors
/// The case is wrong, or results cannot be written.
pub fn run(
    options: &Options,
    case: &Case,
    folder: &ResultFolder,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let of = analyse(case)?;
    let is_written = |name: &&&str| name.starts_with("point") || name.starts_with("growth.");
    if options.dry_run {
        writeln!(stdout, "would analyse {}", case_title(case))?;
        for name in output::POINT.iter().filter(is_written) {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }
    let json = format!("{:#}\n", report(case, &of));
    let words = words(case, &of);
    let figure = figure(case, &of);
    folder.open()?;
    folder.write("point.json", json.as_bytes())?;
    folder.write("point.txt", words.as_bytes())?;
    folder.write("growth.png", &figure.draw(figures::Format::Png)?)?;
    folder.write("growth.svg", &figure.draw(figures::Format::Svg)?)?;
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
    let located = |error: NoResponse| setup::locate(case, error.into());
    let wave = case.numbers.wave;
    let solid = setup::solid::solid(case).map_err(|error| case.locate(error))?;
    let cache = AcousticTensorCache::default();
    let mut assessor = SolidAssessor::new(&cache);
    let (assessment, of_polynomial) =
        assessor.assess(&solid).map_err(|error| setup::locate(case, error))?;
    let supremum =
        of_polynomial.and_then(|found| bound::supremum(&assessor.plane.pencil, &found, 0.0));
    let bound = match supremum {
        Some(supremum) => Some(supremum.rate),
        None => solid.keeps_energy().then_some(0.0),
    };
    let rate =
        |wave: Wave| solids::growth_rate(&solid, normal(&wave), wave.number).map_err(located);
    let by_direction = (0..=DIRECTIONS)
        .map(|i| {
            let direction_deg = 180.0 * i as f64 / DIRECTIONS as f64;
            Ok([direction_deg, rate(Wave { direction_deg, ..wave })?])
        })
        .collect::<Result<_, Error>>()?;
    let along = |wave: Wave| {
        (-DECADES * PER_DECADE..=DECADES * PER_DECADE)
            .map(|step| {
                let number = wave.number * 10f64.cr_powf(f64::from(step) / f64::from(PER_DECADE));
                Ok([number, rate(Wave { number, ..wave })?])
            })
            .collect::<Result<Vec<_>, Error>>()
    };
    let in_worst_direction = match assessment.direction_deg() {
        Some([direction_deg, elevation_deg]) => {
            along(Wave { direction_deg, elevation_deg, ..wave })?
        }
        None => Vec::new(),
    };
    let energy = match solid.dimensions {
        2 => energy::energy::<2>(
            &solid.elastic_rates(),
            &solid.rates().map_err(located)?,
            wave.number,
        ),
        _ => energy::energy::<3>(
            &solid.elastic_rates(),
            &solid.rates().map_err(located)?,
            wave.number,
        ),
    };
    Ok(Analysed {
        waves: solids::waves(&solid, normal(&wave), false).map_err(located)?,
        roots: solids::roots(&solid, normal(&wave), wave.number).map_err(located)?,
        elastic: solids::waves(&solid, normal(&wave), true).map_err(located)?,
        by_wave_number: along(wave)?,
        in_worst_direction,
        by_direction,
        energy,
        solid,
        assessment,
        bound,
    })
}

/// c² along the wave of the case, by descending real part; zeros of rounding size as zeros.
fn speeds(waves: &Waves) -> Vec<Complex64> {
    let mut all: Vec<Complex64> =
        waves.families.iter().flat_map(|family| family.squared_speeds()).collect();
    let largest = all.iter().map(|c| c.norm()).fold(0.0, f64::max);
    for square in &mut all {
        if square.norm() <= 1e-13 * largest {
            *square = Complex64::from(0.0);
        }
    }
    all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    all
}

fn report(case: &Case, of: &Analysed) -> Value {
    let wave = case.numbers.wave;
    let SolidAssessment { verdict, extremes, hyperbolicity, route, .. } = &of.assessment;
    let growth = match verdict {
        Verdict::IllPosed { growth, .. } => *growth,
        _ => None,
    };
    let pairs = |list: Vec<Complex64>| list.iter().map(|z| json!([z.re, z.im])).collect::<Vec<_>>();
    let normal = of.assessment.direction_deg();
    json!({
        "model": case.kind.name(),
        "yield": case.yields.map(|set| set.name),
        "dimensions": of.solid.dimensions,
        "verdict": verdict.name(),
        "order": growth.map(|growth| growth.order.value()),
        "coefficient": growth.map(|growth| growth.coefficient),
        "direction_deg": normal.map(|angles| angles[0]),
        "elevation_deg": normal.map(|angles| angles[1]),
        "bound": of.bound,
        "hyperbolicity": hyperbolicity.name(),
        "flutter": flutter_json(extremes.flutter),
        "slowest": {
            "squared_speed": extremes.slowest.speed_squared,
            "rounding": extremes.slowest.rounding,
            "normal": normal_json(extremes.slowest.normal),
        },
        "associated": of.solid.is_associated(),
        "active": of.solid.plastic.as_ref().map(|plastic| {
            plastic.active.iter().map(|active| active.name).collect::<Vec<_>>()
        }),
        "stress": of.solid.plastic.as_ref().and_then(|plastic| plastic.stress).map(|stress| json!({
            "force": stress.force, "couple": stress.couple,
        })),
        "wave": {
            "number": wave.number,
            "direction_deg": wave.direction_deg,
            "elevation_deg": wave.elevation_deg,
        },
        "roots": pairs(of.roots.clone()),
        "squared_speeds": pairs(speeds(&of.waves)),
        "elastic_squared_speeds": pairs(speeds(&of.elastic)),
        "energy": {
            "definiteness": of.energy.definiteness,
            "asymmetry": of.energy.asymmetry,
            "antisymmetry": of.energy.antisymmetry,
            "elastic_growth": of.energy.elastic_growth,
            "growth": of.energy.growth,
        },
        "unknowns": of.energy.unknowns,
        "zero_roots": of.energy.zeros,
        "route": route,
    })
}

fn list(squares: &[Complex64]) -> String {
    let speed = |square: &Complex64| {
        let c = square.sqrt();
        match (c.re, c.im.abs()) {
            (real, 0.0) => short(real),
            (0.0, growth) => format!("{}i", short(growth)),
            (real, growth) => format!("{} ± {}i", short(real), short(growth)),
        }
    };
    squares.iter().map(speed).collect::<Vec<_>>().join(", ")
}

fn words(case: &Case, of: &Analysed) -> String {
    let wave = case.numbers.wave;
    let SolidAssessment { verdict, extremes, hyperbolicity, route, .. } = &of.assessment;
    let mut text = format!(
        "{}\nmodel: {}, {}\n",
        case_title(case),
        case.medium().title(),
        if of.solid.dimensions == 2 { "plane strain" } else { "in space" }
    );
    if let Some(plastic) = &of.solid.plastic {
        let flow = if of.solid.is_associated() { "associated" } else { "non-associated" };
        let _ = writeln!(text, "\nYielding, {flow}");
        for active in &plastic.active {
            let _ = writeln!(text, "  active: {}", active.name);
        }
        if let Some(stress) = plastic.stress {
            let rows = |t: &[[f64; 3]; 3]| {
                t.iter()
                    .map(|row| format!("[{}]", row.map(|x| short(x + 0.0)).join(", ")))
                    .collect::<Vec<_>>()
                    .join(" ")
            };
            let _ = writeln!(text, "  stress on yield (second index: face normal)");
            let _ = writeln!(text, "    σ = {} Pa", rows(&stress.force));
            if stress.couple != [[0.0; 3]; 3] {
                let _ = writeln!(text, "    m = {} N/m", rows(&stress.couple));
            }
        }
    }

    let _ = writeln!(text, "\nCharacteristic speeds {}, m/s", at(normal(&wave)));
    let _ = writeln!(text, "  elastic   {}", list(&speeds(&of.elastic)));
    if of.solid.plastic.is_some() {
        let _ = writeln!(text, "  yielding  {}", list(&speeds(&of.waves)));
    }
    let Energy { unknowns, zeros, .. } = of.energy;
    if matches!(case.kind, Kind::Solid(solid) if solid.theory == Theory::Reduced) {
        let _ =
            writeln!(text, "  where 0 is the rotation: without couple stress it does not travel");
    }
    let _ = writeln!(
        text,
        "  and {zeros} of speed zero among {unknowns} unknowns: stresses without traction or couple \
         on the front, which no motion relieves"
    );
    let _ = writeln!(text, "\nSpeeds over all directions: {}", hyperbolicity.words());
    if let Some(flutter) = extremes.flutter {
        let _ = writeln!(
            text,
            "  strongest flutter   c² = {} ± {}i m²/s² {}: short waves grow as {} k",
            short(flutter.speed_squared.re),
            short(flutter.speed_squared.im.abs()),
            at(flutter.normal),
            short(flutter.growth)
        );
    }
    let slowest = extremes.slowest;
    let _ = match of.assessment.is_stationary() {
        true => writeln!(
            text,
            "  slowest wave        c² = 0 {}: a stationary discontinuity{}",
            at(slowest.normal),
            match &of.solid.plastic {
                Some(own) if own.set.half_spaces().is_some() => {
                    " (slip along a layer stands still always)"
                }
                _ => ", the onset of a shear band",
            }
        ),
        false => writeln!(
            text,
            "  slowest wave        c² = {} m²/s² {}{}",
            short(slowest.speed_squared),
            match of.solid.plastic {
                Some(_) => at(slowest.normal),
                None => "in all directions".into(),
            },
            if slowest.speed_squared < 0.0 { ": a shear band grows" } else { "" }
        ),
    };

    let energy = &of.energy;
    let _ = writeln!(text, "\nEnergy");
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "  {name:<58}{value:.1e}");
    };
    line("least eigenvalue of the symmetriser (unit diagonal)", energy.definiteness);
    line("asymmetry of B, elastic", energy.asymmetry);
    line("asymmetry of Q + Qᵀ, elastic", energy.antisymmetry);
    line("greatest |Re ς|/|ς| of many waves, elastic", energy.elastic_growth);
    if of.solid.plastic.is_some() {
        line("greatest |Re ς|/|ς| of many waves, yielding", energy.growth);
    }

    let _ = writeln!(
        text,
        "\nRoots ς at k = {} 1/m {}; {zeros} more are zero",
        short(wave.number),
        at(normal(&wave))
    );
    for root in &of.roots {
        let _ = writeln!(text, "  {:>12} {:>+13.4e} i  1/s", short(root.re), root.im);
    }

    let _ = writeln!(text, "\nVerdict: {}", verdict.name());
    let evidence = match verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let normal = of.assessment.normal.map_or(String::new(), at);
            format!("Re ς ≈ {} k^{} as k → ∞ {normal}", growth.coefficient, growth.order.value())
        }
        Verdict::WellPosed if of.solid.keeps_energy() => {
            "symmetric-hyperbolic: the energy bounds every wave".into()
        }
        Verdict::WellPosed if of.solid.dimensions == 3 => {
            "all speeds real and none vanishes, over all directions".into()
        }
        _ => super::evidence(verdict),
    };
    let _ = writeln!(text, "  {evidence}");
    if let Some(bound) = of.bound {
        let _ = writeln!(text, "  supremum of Re ς: {} 1/s", short(bound));
    }
    if *hyperbolicity == Hyperbolicity::Hyperbolic && matches!(verdict, Verdict::IllPosed { .. }) {
        let _ = writeln!(text, "  all speeds are real: the growth comes from terms of lower order");
    }
    let _ = writeln!(text, "Route: {route}\n{VALIDITY}");
    text
}

fn figure(case: &Case, of: &Analysed) -> GrowthFigure {
    let wave = case.numbers.wave;
    let along = |[direction, elevation]: [f64; 2]| match elevation {
        0.0 => format!("along {}°", short(direction)),
        up => format!("along {}°, {}° above the plane", short(direction), short(up)),
    };
    let mut curves = vec![Line {
        label: along([wave.direction_deg, wave.elevation_deg]),
        points: of.by_wave_number.clone(),
    }];
    let mut guides = Vec::new();
    if let Some(angles) = of.assessment.direction_deg() {
        curves.push(Line {
            label: format!("{}, where short waves grow fastest", along(angles)),
            points: of.in_worst_direction.clone(),
        });
        if let Verdict::IllPosed { growth: Some(growth), .. } = of.assessment.verdict {
            let asymptote = |k: f64| growth.coefficient * k.cr_powf(growth.order.value());
            guides.push(Line {
                label: "exact asymptote: coefficient · k^order".into(),
                points: of.in_worst_direction.iter().map(|&[k, _]| [k, asymptote(k)]).collect(),
            });
        }
    }
    let above = match wave.elevation_deg {
        0.0 => String::new(),
        up => format!(", {}° above the plane", short(up)),
    };
    GrowthFigure {
        title: case_title(case),
        subtitle: format!(
            "{}: greatest Re ς of all roots; left: k = {} 1/m{above}",
            case.medium().title(),
            short(wave.number)
        ),
        by_direction: Panel {
            x_label: match (of.solid.dimensions, wave.elevation_deg) {
                (2, _) => "direction of the wave vector (°)".into(),
                (_, 0.0) => "direction in the plane of x₁ and x₂ (°)".into(),
                _ => "direction, measured in the plane of x₁ and x₂ (°)".into(),
            },
            y_label: "growth rate Re ς (1/s)".into(),
            x_log: false,
            curves: vec![Line {
                label: format!("k = {} 1/m{above}", short(wave.number)),
                points: of.by_direction.clone(),
            }],
            guides: Vec::new(),
            marks: Vec::new(),
        },
        by_wave_number: Panel {
            x_label: "wave number k (1/m)".into(),
            y_label: "growth rate Re ς (1/s)".into(),
            x_log: true,
            curves,
            guides,
            marks: vec![Mark { label: "k".into(), x: wave.number }],
        },
    }
}
