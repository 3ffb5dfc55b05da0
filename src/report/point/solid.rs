//! Text report and figure of the state of a solid.

use super::flow_figures::mark_wave_number;
use crate::case::{Case, ModelKind};
use crate::report::ReportPicture;
use crate::report::format::{
    VALIDITY_NOTE, case_title, format_normal as at, format_short, format_superscript,
};
use crate::report::parameters::with_parameters;
use crate::setup::solid::wave_normal;
use crate::study::SolidAnalysis;
use crate::study::format::describe_evidence;
use analysis::growth::Verdict;
use analysis::solids::Hyperbolicity;
use figures::{GrowthFigure, GrowthPanel, LabelledCurve};
use models::common::elementary::Elementary;
use models::solid::parameters::Theory;
use num_complex::Complex64;
use std::fmt::Write as _;

pub(super) fn format_text(case: &Case, found: &SolidAnalysis) -> String {
    let case = &case.with_block_material();
    let mut text = format!(
        "{}\nmodel: {}, {}\n",
        case_title(case),
        case.medium().title(),
        if found.dimensions == 2 { "plane strain" } else { "in space" }
    );
    if found.analysed_part.is_some() {
        text.push_str(
            "part: the solid of the blocks, without joints; wellposed dispersion computes the waves of \
             blocks with joints\n",
        );
    }
    write_yielding(found, &mut text);
    write_speeds(case, found, &mut text);
    write_extremes(found, &mut text);
    write_energy(found, &mut text);
    let wave = case.material.numbers.wave;
    let _ = writeln!(
        text,
        "\nRoots ς at k = {} 1/m {}; {} more {} zero",
        format_short(wave.wave_number),
        at(wave_normal(&wave)),
        found.zero_root_count,
        if found.zero_root_count == 1 { "is" } else { "are" },
    );
    for [re, im] in &found.dispersion_roots {
        let _ = writeln!(text, "  {:>12} {im:>+13.4e} i  1/s", format_short(*re));
    }
    write_verdict(found, &mut text);
    let _ = writeln!(text, "Route: {}\n{VALIDITY_NOTE}", found.route);
    text
}

fn write_yielding(found: &SolidAnalysis, text: &mut String) {
    let Some(active) = &found.active_conditions else { return };
    let flow = if found.is_associated { "associated" } else { "non-associated" };
    let _ = writeln!(text, "\nYielding, {flow}");
    for name in active {
        let _ = writeln!(text, "  active: {name}");
    }
    if let Some(stress) = found.stress {
        let rows = |t: &[[f64; 3]; 3]| {
            t.iter()
                .map(|row| format!("[{}]", row.map(|x| format_short(x + 0.0)).join(", ")))
                .collect::<Vec<_>>()
                .join(" ")
        };
        let _ = writeln!(text, "  stress at yield (second index: face normal)");
        let _ = writeln!(text, "    σ = {} Pa", rows(&stress.force));
        if stress.couple != [[0.0; 3]; 3] {
            let _ = writeln!(text, "    m = {} N/m", rows(&stress.couple));
        }
    }
}

fn format_speeds(squares: &[[f64; 2]]) -> String {
    let speed = |&[re, im]: &[f64; 2]| {
        let c = Complex64::new(re, im).sqrt();
        match (c.re, c.im.abs()) {
            (real, 0.0) => format_short(real),
            (0.0, growth) => format!("{}i", format_short(growth)),
            (real, growth) => format!("{} ± {}i", format_short(real), format_short(growth)),
        }
    };
    squares.iter().map(speed).collect::<Vec<_>>().join(", ")
}

fn write_speeds(case: &Case, found: &SolidAnalysis, text: &mut String) {
    let _ = writeln!(
        text,
        "\nCharacteristic speeds {}, m/s",
        at(wave_normal(&case.material.numbers.wave))
    );
    let _ = writeln!(text, "  elastic   {}", format_speeds(&found.elastic_squared_speeds));
    if found.solid.plastic_state.is_some() {
        let _ = writeln!(text, "  yielding  {}", format_speeds(&found.squared_speeds));
    }
    if matches!(case.material.kind, ModelKind::Solid(solid) if solid.theory == Theory::Reduced) {
        let _ = writeln!(
            text,
            "  speed 0 is the rotation, which does not propagate without couple stress"
        );
    }
    let _ = writeln!(
        text,
        "  and {} of speed zero among {} unknowns: stresses without traction or couple \
         on the front, which do not propagate",
        found.zero_root_count, found.unknown_count
    );
}

fn write_extremes(found: &SolidAnalysis, text: &mut String) {
    let hyperbolicity = found.assessment.hyperbolicity;
    let _ = writeln!(text, "\nSpeeds over all directions: {}", hyperbolicity.description());
    if let Some(flutter) = found.strongest_flutter {
        let [re, im] = flutter.squared_speed;
        let _ = writeln!(
            text,
            "  strongest flutter   c² = {} ± {}i m²/s² {}: short waves grow as {} k",
            format_short(re),
            format_short(im.abs()),
            at(flutter.wave_normal.vector),
            format_short(flutter.max_imaginary_speed)
        );
    }
    let slowest = found.slowest_wave;
    let _ = match found.assessment.is_stationary() {
        true => writeln!(
            text,
            "  slowest wave        c² = 0 {}: a stationary discontinuity{}",
            at(slowest.wave_normal.vector),
            match &found.solid.plastic_state {
                Some(own) if own.set.half_spaces().is_some() => {
                    " (slip along a layer always has zero speed)"
                }
                _ => ", the onset of a shear band",
            }
        ),
        false => writeln!(
            text,
            "  slowest wave        c² = {} m²/s² {}{}",
            format_short(slowest.squared_speed),
            match found.solid.plastic_state {
                Some(_) => at(slowest.wave_normal.vector),
                None => "in all directions".into(),
            },
            if slowest.squared_speed < 0.0 { ": a shear band grows" } else { "" }
        ),
    };
}

fn write_energy(found: &SolidAnalysis, text: &mut String) {
    let energy = &found.energy_defects;
    let _ = writeln!(text, "\nEnergy");
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "  {name:<58}{value:.1e}");
    };
    line(
        "smallest eigenvalue of the symmetriser (unit diagonal)",
        energy.min_symmetriser_eigenvalue,
    );
    line("asymmetry of B, elastic", energy.asymmetry);
    line("asymmetry of Q + Qᵀ, elastic", energy.antisymmetry_defect);
    line("maximum |Re ς|/|ς| over sampled waves, elastic", energy.elastic_growth);
    if found.solid.plastic_state.is_some() {
        line("maximum |Re ς|/|ς| over sampled waves, yielding", energy.yielding_growth);
    }
}

fn write_verdict(found: &SolidAnalysis, text: &mut String) {
    let assessment = &found.assessment;
    let _ = writeln!(text, "\nVerdict: {}", found.verdict);
    let evidence = match &assessment.verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let normal = assessment.normal.map_or(String::new(), at);
            format!(
                "Re ς ≈ {} k{} as k → ∞ {normal}",
                format_short(growth.coefficient),
                format_superscript(growth.order.to_f64())
            )
        }
        Verdict::WellPosed if found.solid.is_symmetric_hyperbolic() => {
            "symmetric-hyperbolic: the energy bounds every wave".into()
        }
        Verdict::WellPosed if found.dimensions == 3 => {
            "all speeds real and none vanishes, over all directions".into()
        }
        verdict => describe_evidence(verdict),
    };
    let _ = writeln!(text, "  {evidence}");
    if let Some(bound) = found.growth_bound {
        let _ = writeln!(text, "  supremum of Re ς: {} 1/s", format_short(bound));
    }
    if assessment.hyperbolicity == Hyperbolicity::Hyperbolic
        && matches!(assessment.verdict, Verdict::IllPosed { .. })
    {
        let _ = writeln!(text, "  all speeds are real: the growth comes from terms of lower order");
    }
}

/// Creates the figure of the growth rate against direction and wave number.
pub(super) fn create_pictures(case: &Case, found: &SolidAnalysis) -> Vec<ReportPicture> {
    let figure = create_figure(&case.with_block_material(), found);
    vec![ReportPicture::new("growth", move |format| figure.draw(format))]
}

fn create_figure(case: &Case, found: &SolidAnalysis) -> GrowthFigure {
    let wave = case.material.numbers.wave;
    let along = |[direction, elevation]: [f64; 2]| match elevation {
        0.0 => format!("along {}°", format_short(direction)),
        up => format!("along {}°, {}° above the plane", format_short(direction), format_short(up)),
    };
    let mut curves = vec![LabelledCurve {
        label: along([wave.direction_deg, wave.elevation_deg]),
        points: found.growth_by_wave_number.clone(),
    }];
    let mut guides = Vec::new();
    if let (Some(direction), Some(elevation)) = (found.direction_deg, found.elevation_deg) {
        curves.push(LabelledCurve {
            label: format!("{}, where short waves grow fastest", along([direction, elevation])),
            points: found.growth_in_fastest_direction.clone(),
        });
        if let (Some(order), Some(coefficient)) = (found.growth_order, found.growth_coefficient) {
            let asymptote = |k: f64| coefficient * k.cr_powf(order);
            guides.push(LabelledCurve {
                label: "exact asymptote: coefficient · k^order".into(),
                points: found
                    .growth_in_fastest_direction
                    .iter()
                    .map(|&[k, _]| [k, asymptote(k)])
                    .collect(),
            });
        }
    }
    let above = match wave.elevation_deg {
        0.0 => String::new(),
        up => format!(", {}° above the plane", format_short(up)),
    };
    GrowthFigure {
        title: case_title(case),
        subtitle: with_parameters(
            &format!(
                "{}: maximum Re ς over all roots; against the direction: k = {} 1/m{above}",
                case.medium().title(),
                format_short(wave.wave_number)
            ),
            case,
        ),
        by_direction: GrowthPanel {
            x_label: match (found.dimensions, wave.elevation_deg) {
                (2, _) => "direction of the wave vector (°)".into(),
                (_, 0.0) => "direction in the plane of x₁ and x₂ (°)".into(),
                _ => "direction, measured in the plane of x₁ and x₂ (°)".into(),
            },
            y_label: "growth rate Re ς (1/s)".into(),
            is_x_log: false,
            curves: vec![LabelledCurve {
                label: format!("k = {} 1/m{above}", format_short(wave.wave_number)),
                points: found.growth_by_direction.clone(),
            }],
            reference_lines: Vec::new(),
            marks: Vec::new(),
            is_measured: false,
        },
        by_wave_number: GrowthPanel {
            x_label: "wave number k (1/m)".into(),
            y_label: "growth rate Re ς (1/s)".into(),
            is_x_log: true,
            curves,
            reference_lines: guides,
            marks: vec![mark_wave_number(wave.wave_number)],
            is_measured: false,
        },
    }
}
