//! Text report and figure of the state of a solid.

use crate::case::{Case, Kind};
use crate::report::Picture;
use crate::report::format::{VALIDITY, case_title, normal_words as at, short};
use crate::setup::solid::normal;
use crate::study::SolidPoint;
use crate::study::words::evidence;
use analysis::growth::Verdict;
use analysis::solids::Hyperbolicity;
use figures::{GrowthFigure, Line, Mark, Panel};
use models::common::elementary::Elementary;
use models::solid::parameters::Theory;
use num_complex::Complex64;
use std::fmt::Write as _;

pub(super) fn text(case: &Case, found: &SolidPoint) -> String {
    let mut text = format!(
        "{}\nmodel: {}, {}\n",
        case_title(case),
        case.medium().title(),
        if found.dimensions == 2 { "plane strain" } else { "in space" }
    );
    yielding(found, &mut text);
    speeds(case, found, &mut text);
    extremes(found, &mut text);
    energy(found, &mut text);
    let wave = case.material.numbers.wave;
    let _ = writeln!(
        text,
        "\nRoots ς at k = {} 1/m {}; {} more are zero",
        short(wave.number),
        at(normal(&wave)),
        found.zero_roots
    );
    for [re, im] in &found.roots {
        let _ = writeln!(text, "  {:>12} {im:>+13.4e} i  1/s", short(*re));
    }
    verdict(found, &mut text);
    let _ = writeln!(text, "Route: {}\n{VALIDITY}", found.route);
    text
}

fn yielding(found: &SolidPoint, text: &mut String) {
    let Some(active) = &found.active else { return };
    let flow = if found.associated { "associated" } else { "non-associated" };
    let _ = writeln!(text, "\nYielding, {flow}");
    for name in active {
        let _ = writeln!(text, "  active: {name}");
    }
    if let Some(stress) = found.stress {
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

fn list(squares: &[[f64; 2]]) -> String {
    let speed = |&[re, im]: &[f64; 2]| {
        let c = Complex64::new(re, im).sqrt();
        match (c.re, c.im.abs()) {
            (real, 0.0) => short(real),
            (0.0, growth) => format!("{}i", short(growth)),
            (real, growth) => format!("{} ± {}i", short(real), short(growth)),
        }
    };
    squares.iter().map(speed).collect::<Vec<_>>().join(", ")
}

fn speeds(case: &Case, found: &SolidPoint, text: &mut String) {
    let _ =
        writeln!(text, "\nCharacteristic speeds {}, m/s", at(normal(&case.material.numbers.wave)));
    let _ = writeln!(text, "  elastic   {}", list(&found.elastic_squared_speeds));
    if found.solid.plastic.is_some() {
        let _ = writeln!(text, "  yielding  {}", list(&found.squared_speeds));
    }
    if matches!(case.material.kind, Kind::Solid(solid) if solid.theory == Theory::Reduced) {
        let _ =
            writeln!(text, "  where 0 is the rotation: without couple stress it does not travel");
    }
    let _ = writeln!(
        text,
        "  and {} of speed zero among {} unknowns: stresses without traction or couple \
         on the front, which no motion relieves",
        found.zero_roots, found.unknowns
    );
}

fn extremes(found: &SolidPoint, text: &mut String) {
    let hyperbolicity = found.assessment.hyperbolicity;
    let _ = writeln!(text, "\nSpeeds over all directions: {}", hyperbolicity.words());
    if let Some(flutter) = found.flutter {
        let [re, im] = flutter.squared_speed;
        let _ = writeln!(
            text,
            "  strongest flutter   c² = {} ± {}i m²/s² {}: short waves grow as {} k",
            short(re),
            short(im.abs()),
            at(flutter.normal.vector),
            short(flutter.growth)
        );
    }
    let slowest = found.slowest;
    let _ = match found.assessment.is_stationary() {
        true => writeln!(
            text,
            "  slowest wave        c² = 0 {}: a stationary discontinuity{}",
            at(slowest.normal.vector),
            match &found.solid.plastic {
                Some(own) if own.set.half_spaces().is_some() => {
                    " (slip along a layer stands still always)"
                }
                _ => ", the onset of a shear band",
            }
        ),
        false => writeln!(
            text,
            "  slowest wave        c² = {} m²/s² {}{}",
            short(slowest.squared_speed),
            match found.solid.plastic {
                Some(_) => at(slowest.normal.vector),
                None => "in all directions".into(),
            },
            if slowest.squared_speed < 0.0 { ": a shear band grows" } else { "" }
        ),
    };
}

fn energy(found: &SolidPoint, text: &mut String) {
    let energy = &found.energy;
    let _ = writeln!(text, "\nEnergy");
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "  {name:<58}{value:.1e}");
    };
    line("least eigenvalue of the symmetriser (unit diagonal)", energy.definiteness);
    line("asymmetry of B, elastic", energy.asymmetry);
    line("asymmetry of Q + Qᵀ, elastic", energy.antisymmetry);
    line("greatest |Re ς|/|ς| of many waves, elastic", energy.elastic_growth);
    if found.solid.plastic.is_some() {
        line("greatest |Re ς|/|ς| of many waves, yielding", energy.growth);
    }
}

fn verdict(found: &SolidPoint, text: &mut String) {
    let assessment = &found.assessment;
    let _ = writeln!(text, "\nVerdict: {}", found.verdict);
    let words = match &assessment.verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let normal = assessment.normal.map_or(String::new(), at);
            format!("Re ς ≈ {} k^{} as k → ∞ {normal}", growth.coefficient, growth.order.value())
        }
        Verdict::WellPosed if found.solid.keeps_energy() => {
            "symmetric-hyperbolic: the energy bounds every wave".into()
        }
        Verdict::WellPosed if found.dimensions == 3 => {
            "all speeds real and none vanishes, over all directions".into()
        }
        verdict => evidence(verdict),
    };
    let _ = writeln!(text, "  {words}");
    if let Some(bound) = found.bound {
        let _ = writeln!(text, "  supremum of Re ς: {} 1/s", short(bound));
    }
    if assessment.hyperbolicity == Hyperbolicity::Hyperbolic
        && matches!(assessment.verdict, Verdict::IllPosed { .. })
    {
        let _ = writeln!(text, "  all speeds are real: the growth comes from terms of lower order");
    }
}

/// Creates the figure of the growth rate against direction and wave number.
pub(super) fn pictures(case: &Case, found: &SolidPoint) -> Vec<Picture> {
    let figure = figure(case, found);
    vec![Picture::new("growth", move |format| figure.draw(format))]
}

fn figure(case: &Case, found: &SolidPoint) -> GrowthFigure {
    let wave = case.material.numbers.wave;
    let along = |[direction, elevation]: [f64; 2]| match elevation {
        0.0 => format!("along {}°", short(direction)),
        up => format!("along {}°, {}° above the plane", short(direction), short(up)),
    };
    let mut curves = vec![Line {
        label: along([wave.direction_deg, wave.elevation_deg]),
        points: found.by_wave_number.clone(),
    }];
    let mut guides = Vec::new();
    if let (Some(direction), Some(elevation)) = (found.direction_deg, found.elevation_deg) {
        curves.push(Line {
            label: format!("{}, where short waves grow fastest", along([direction, elevation])),
            points: found.in_worst_direction.clone(),
        });
        if let (Some(order), Some(coefficient)) = (found.order, found.coefficient) {
            let asymptote = |k: f64| coefficient * k.cr_powf(order);
            guides.push(Line {
                label: "exact asymptote: coefficient · k^order".into(),
                points: found.in_worst_direction.iter().map(|&[k, _]| [k, asymptote(k)]).collect(),
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
            x_label: match (found.dimensions, wave.elevation_deg) {
                (2, _) => "direction of the wave vector (°)".into(),
                (_, 0.0) => "direction in the plane of x₁ and x₂ (°)".into(),
                _ => "direction, measured in the plane of x₁ and x₂ (°)".into(),
            },
            y_label: "growth rate Re ς (1/s)".into(),
            x_log: false,
            curves: vec![Line {
                label: format!("k = {} 1/m{above}", short(wave.number)),
                points: found.by_direction.clone(),
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
