//! Line force or line explosion in an unbounded plane.

use super::run::{Frame, Receiver, Settings, compare};
use super::{RICKER, Row, SOLID, full_plane};

const AMPLITUDE: f64 = 1e5;

/// Position of the source relative to a corner of the grid cells, in cells: without symmetry.
const OFFSET: [f64; 2] = [0.2, 0.35];

/// Names, distances (in wavelengths of the S wave) and directions (degrees) of receivers.
const RECEIVERS: [(&str, f64, f64); 6] = [
    ("axis1", 1.0, 0.0),
    ("oblique1", 1.0, 35.0),
    ("diagonal2", 2.0, 45.0),
    ("steep2", 2.0, 65.0),
    ("oblique3", 3.0, 25.0),
    ("across3", 3.0, 90.0),
];

/// Relative errors of the velocities for a force along the first coordinate, or for an explosion.
pub fn rows(settings: &Settings, is_explosion: bool) -> Vec<Row> {
    let wavelength = SOLID.shear_speed() / RICKER.frequency;
    let h = wavelength / settings.cells;
    let frame = Frame::new(2, settings);
    // The S wave passes the farthest receiver; waves reflected from the boundaries arrive later.
    let duration = 5.9 / RICKER.frequency;
    let reach = SOLID.pressure_speed() * duration / wavelength;
    let half = (0.5 * (reach + 3.0) * settings.cells).ceil();
    let source = match settings.shift() {
        0.0 => OFFSET,
        _ => [0.5; 2],
    };
    let low = source.map(|offset| -half - offset);
    let mut case = frame.begin(&SOLID, h, &[2.0 * half; 2], &low, duration);
    case += &frame.sides("non-reflecting", &[(0, false), (0, true), (1, false), (1, true)]);
    case += &match is_explosion {
        true => format!("[[source]]\nkind = \"explosion\"\namplitude = {AMPLITUDE}\n"),
        false => format!(
            "[[source]]\nkind = \"force\"\namplitude = {:?}\n",
            frame.place(&[AMPLITUDE, 0.0])
        ),
    };
    case += &format!(
        "at = [0, 0]\n{}time = {{ kind = \"ricker\", frequency = {} }}\n",
        settings.kernel(),
        RICKER.frequency
    );
    let receivers = RECEIVERS.map(|(name, distance, direction)| {
        let (sin, cos) = f64::to_radians(direction).sin_cos();
        let at = [distance * cos, distance * sin];
        Receiver::new(name, &at, distance, wavelength, (settings, &source))
    });
    compare(settings, frame, case, &receivers, |receiver, time| {
        let at = [receiver.at[0], receiver.at[1]];
        let exact = match is_explosion {
            true => full_plane::explosion(&SOLID, AMPLITUDE, at, time, RICKER, 1),
            false => full_plane::force(&SOLID, [AMPLITUDE, 0.0], at, time, RICKER, 1),
        };
        exact.to_vec()
    })
}
