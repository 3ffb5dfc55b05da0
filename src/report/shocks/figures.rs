//! Figures of plane waves: diagram with chords, plane of position and time, profiles of pressure and velocity.

use crate::case::Case;
use crate::report::format::{case_title, format_short};
use crate::study::shocks::{PistonResult, ProfilePoint, ShocksResult, SpallResult, WaveRow};
use ::figures::{CurvePanel, LabelledCurve, PanelsFigure};
use models::uniaxial::UniaxialDiagram;

const MEGAPASCAL: f64 = 1e6;
const PERCENT: f64 = 1e-2;
const MILLISECOND: f64 = 1e-3;

const STRAIN_LABEL: &str = "compression strain ε (%)";
const PRESSURE_LABEL: &str = "pressure p (MPa)";
const TIME_LABEL: &str = "time t (ms)";

/// Creates the figure of the waves behind a piston.
pub(super) fn create_piston_figure(
    case: &Case,
    found: &ShocksResult,
    piston: &PistonResult,
) -> PanelsFigure {
    let release = piston.release.iter().flat_map(|own| &own.waves);
    let waves: Vec<&WaveRow> = piston.waves.iter().chain(release).collect();
    let time = format_short(piston.profile_time / MILLISECOND);
    let profiles = [(format!("profile at t = {time} ms"), piston.profile.as_slice())];
    PanelsFigure {
        title: case_title(case),
        subtitle: format!(
            "piston of {} MPa and {} m/s",
            format_short(piston.pressure / MEGAPASCAL),
            format_short(piston.speed),
        ),
        panels: vec![
            create_diagram_panel(found, piston, &waves),
            create_plane_panel(piston),
            profile_panel("position x (m)", PRESSURE_LABEL, &profiles, |own| {
                own.state.pressure / MEGAPASCAL
            }),
            profile_panel("position x (m)", "velocity v (m/s)", &profiles, |own| {
                own.state.velocity
            }),
        ],
    }
}

/// Creates the panel of the diagram: segments by the state of the medium, chords of the waves, and states.
fn create_diagram_panel(
    found: &ShocksResult,
    piston: &PistonResult,
    waves: &[&WaveRow],
) -> CurvePanel {
    let end = piston.strain + 0.15 * (piston.strain - piston.initial_strain);
    let low =
        waves.iter().map(|wave| wave.behind.strain).fold(piston.initial_strain.min(0.0), f64::min);
    let mut curves = segment_curves(&found.loading_diagram, "", [piston.initial_strain, end]);
    // A reversible medium unloads along the same diagram.
    let unloading = piston.unloading_diagram.as_ref();
    if let Some(unloading) = unloading.filter(|own| **own != found.loading_diagram) {
        curves.extend(segment_curves(unloading, "unloading: ", [low, piston.strain]));
    }
    let chord = |wave: &&WaveRow| LabelledCurve {
        label: "chords of the waves".into(),
        points: [wave.ahead, wave.behind]
            .map(|own| [own.strain / PERCENT, own.pressure / MEGAPASCAL])
            .to_vec(),
    };
    let states = waves.iter().flat_map(|wave| [wave.ahead, wave.behind]);
    CurvePanel {
        x_label: STRAIN_LABEL.into(),
        y_label: PRESSURE_LABEL.into(),
        curves,
        reference_lines: waves.iter().map(chord).collect(),
        points: states.map(|own| [own.strain / PERCENT, own.pressure / MEGAPASCAL]).collect(),
        point_label: "states ahead of and behind the waves".into(),
        ..CurvePanel::default()
    }
}

/// Returns the segments of a diagram between two strains, labelled by the state of the medium.
fn segment_curves(
    diagram: &UniaxialDiagram,
    prefix: &str,
    [low, high]: [f64; 2],
) -> Vec<LabelledCurve> {
    let corners = diagram.corners();
    let mut curves = Vec::new();
    for (index, segment) in diagram.segments().iter().enumerate() {
        let from = index.checked_sub(1).map_or(low, |below| corners[below].strain).max(low);
        let to = corners.get(index).map_or(high, |corner| corner.strain).min(high);
        if from < to {
            let point = |strain: f64| [strain / PERCENT, diagram.pressure(strain) / MEGAPASCAL];
            curves.push(LabelledCurve {
                label: format!("{prefix}{}", segment.state.name()),
                points: vec![point(from), point(to)],
            });
        }
    }
    curves
}

/// Creates the panel of the waves in the plane of position and time.
fn create_plane_panel(piston: &PistonResult) -> CurvePanel {
    let end = 1.3 * piston.profile_time;
    let line = |wave: &WaveRow, start: f64, stop: f64| LabelledCurve {
        label: format!("{}, {:.0} m/s", wave.kind, wave.speed),
        points: [start, stop]
            .map(|time| [wave.speed * (time - start), time / MILLISECOND])
            .to_vec(),
    };
    let overtaking = piston.release.as_ref().and_then(|own| own.overtaking);
    // The waves are known until the first release wave overtakes the last loading wave.
    let known = overtaking.map_or(end, |own| own.time.min(end));
    let last = piston.waves.len().saturating_sub(1);
    let loading = piston
        .waves
        .iter()
        .enumerate()
        .map(|(index, wave)| line(wave, 0.0, if index == last { known } else { end }));
    let release = piston.release.iter().flat_map(|own| {
        own.waves
            .iter()
            .enumerate()
            .map(|(index, wave)| line(wave, own.duration, if index == 0 { known } else { end }))
    });
    CurvePanel {
        x_label: "position x (m)".into(),
        y_label: TIME_LABEL.into(),
        curves: loading.chain(release).collect(),
        level: Some(("time of the profiles".into(), piston.profile_time / MILLISECOND)),
        ..CurvePanel::default()
    }
}

/// Creates the panel of a quantity in profiles with labels.
fn profile_panel(
    x_label: &str,
    y_label: &str,
    profiles: &[(String, &[ProfilePoint])],
    value: impl Fn(&ProfilePoint) -> f64,
) -> CurvePanel {
    let curve = |(label, points): &(String, &[ProfilePoint])| LabelledCurve {
        label: label.clone(),
        points: points.iter().map(|own| [own.position, value(own)]).collect(),
    };
    CurvePanel {
        x_label: x_label.into(),
        y_label: y_label.into(),
        curves: profiles.iter().map(curve).collect(),
        ..CurvePanel::default()
    }
}

/// Creates the figure of the reflection of a pulse at a free end.
pub(super) fn create_spall_figure(
    case: &Case,
    found: &ShocksResult,
    spall: &SpallResult,
) -> PanelsFigure {
    let (c, thickness, duration) = (spall.sound_speed, spall.thickness, spall.duration);
    let strain = spall.pulse_velocity / c;
    let path = |label: &str, points: &[[f64; 2]]| LabelledCurve {
        label: label.into(),
        points: points.iter().map(|&[x, t]| [x, t / MILLISECOND]).collect(),
    };
    let late = spall.profile_time.max(duration);
    let mut paths = vec![
        path("front of the pulse", &[[2.0 * thickness, -duration], [0.0, 0.0]]),
        path("end of the pulse", &[[2.0 * thickness, 0.0], [thickness, 0.5 * duration]]),
        path("release wave", &[[0.0, 0.0], [thickness, 0.5 * duration]]),
    ];
    if spall.shape == "rectangle" {
        paths.push(path("gap", &[[thickness, 0.5 * duration], [thickness, late]]));
    }
    let diagram = CurvePanel {
        x_label: STRAIN_LABEL.into(),
        y_label: PRESSURE_LABEL.into(),
        curves: segment_curves(&found.loading_diagram, "", [-strain, 2.0 * strain]),
        reference_lines: vec![LabelledCurve {
            label: "chord of the pulse".into(),
            points: vec![[0.0, 0.0], [strain / PERCENT, spall.pressure / MEGAPASCAL]],
        }],
        points: vec![[0.0, 0.0], [strain / PERCENT, spall.pressure / MEGAPASCAL]],
        point_label: "states ahead of and in the pulse".into(),
        ..CurvePanel::default()
    };
    let plane = CurvePanel {
        x_label: "distance from the end d (m)".into(),
        y_label: TIME_LABEL.into(),
        curves: paths,
        ..CurvePanel::default()
    };
    let distance = "distance from the end d (m)";
    let label = |time: f64| format!("profile at t = {} ms", format_short(time / MILLISECOND));
    let profiles: Vec<(String, &[ProfilePoint])> =
        spall.profiles.iter().map(|(time, points)| (label(*time), points.as_slice())).collect();
    PanelsFigure {
        title: case_title(case),
        subtitle: format!(
            "{} of {} m/s and {} ms at a free end",
            spall.shape,
            format_short(spall.pulse_velocity),
            format_short(duration / MILLISECOND),
        ),
        panels: vec![
            diagram,
            plane,
            profile_panel(distance, PRESSURE_LABEL, &profiles, |own| {
                own.state.pressure / MEGAPASCAL
            }),
            profile_panel(distance, "velocity v (m/s)", &profiles, |own| own.state.velocity),
        ],
    }
}
