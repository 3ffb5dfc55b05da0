//! Garvin's problem: a line explosion inside a half-plane.

use super::run::{Frame, Receiver, Settings, compare};
use super::{RICKER, Row, SOLID, half_plane};

const MOMENT: f64 = 1e5;

/// Depth of the explosion, in wavelengths of the Rayleigh wave.
const DEPTH: f64 = 0.5;

/// Names and coordinates (x, upwards) of receivers, in wavelengths of the Rayleigh wave.
const RECEIVERS: [(&str, [f64; 2]); 6] = [
    ("surface1", [0.87, 0.0]),
    ("surface2", [1.94, 0.0]),
    ("surface3", [2.95, 0.0]),
    ("below1", [0.0, -1.5]),
    ("oblique2", [1.6, -1.6]),
    ("shallow3", [2.9, -0.7]),
];

/// Relative errors of the velocities at all receivers.
pub fn rows(settings: &Settings) -> Vec<Row> {
    let wavelength = SOLID.rayleigh_speed() / RICKER.frequency;
    let h = wavelength / settings.cells;
    let frame = Frame::new(2, settings);
    let shift = settings.shift();
    let depth = match shift {
        0.0 => DEPTH * wavelength,
        _ => ((DEPTH * settings.cells).round() + shift) * h,
    };
    // The Rayleigh wave passes the farthest receiver; waves reflected from the boundaries arrive later.
    let duration = 6.2 / RICKER.frequency;
    let reach = SOLID.pressure_speed() * duration / wavelength;
    let half_width = (0.5 * (reach + 3.0) * settings.cells).ceil();
    let bottom = (0.5 * (reach + 2.0 + DEPTH) * settings.cells).ceil();
    let mut case = frame.begin(
        &SOLID,
        h,
        &[2.0 * half_width, bottom],
        &[-half_width - shift, -bottom],
        duration,
    );
    case += &frame.sides("non-reflecting", &[(0, false), (0, true), (1, false)]);
    case += &format!(
        "[[source]]\nkind = \"explosion\"\namplitude = {MOMENT}\nat = {:?}\n{}\
         time = {{ kind = \"ricker\", frequency = {} }}\n",
        frame.place(&[0.0, -depth]),
        settings.kernel(),
        RICKER.frequency
    );
    let receivers = RECEIVERS.map(|(name, at)| {
        Receiver::new(name, &at, at[0].hypot(at[1] + DEPTH), wavelength, (settings, &[shift, 0.0]))
    });
    compare(settings, frame, case, &receivers, |receiver, time| {
        let at = [receiver.at[0], -receiver.at[1]];
        let [along, down] = half_plane::garvin(&SOLID, MOMENT, depth, at, time, RICKER, 1);
        vec![along, down.into_iter().map(|v| -v).collect()]
    })
}
